//! What people of the board do: who they are, what they acknowledge, comment and approve.

use std::collections::BTreeSet;

use egui::{Button, ComboBox, Frame, Margin, RichText, TextEdit, Ui};
use review::record::{Act, Entry, LineKey};
use review::{Line, Section, Standing};
use theme::icon::{self, Icon};
use theme::{space, strong};
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;
use workbench::state::review::{Person, ReviewCommand};

use super::verdict::moment;
use super::{header, row};
use crate::Context;

/// What was typed and not sent yet.
#[derive(Default)]
pub(super) struct People {
    name: Option<String>,
    role: String,
    comment: String,
    /// Whether the comment is about the whole mission even though something is selected.
    is_about_mission: bool,
    /// What goes with an approval.
    approval: String,
    /// What is being said about a line or an entry.
    answer: Option<Answer>,
}

/// Words that are being written about something.
struct Answer {
    about: About,
    text: String,
}

/// What words are about.
#[derive(Clone, PartialEq)]
enum About {
    /// A line for attention, which is acknowledged.
    Line(LineKey),
    /// A comment, which is resolved.
    Resolved(String),
    /// A comment, which is opened again.
    Reopened(String),
    /// An entry, which is taken back.
    Withdrawn(String),
}

impl About {
    /// The word on the button that sends it, and what the field asks for.
    const fn words(&self) -> (&'static str, &'static str) {
        match self {
            Self::Line(_) => ("Acknowledge", "Why is this acceptable?"),
            Self::Resolved(_) => ("Resolve", "How was it resolved?"),
            Self::Reopened(_) => ("Reopen", "Why is it reopened?"),
            Self::Withdrawn(_) => ("Withdraw", "Reason for withdrawing"),
        }
    }

    fn act(self, text: String) -> Act {
        match self {
            Self::Line(line) => Act::Acknowledge { line, text },
            Self::Resolved(of) => Act::Resolve { of, text },
            Self::Reopened(of) => Act::Reopen { of, text },
            Self::Withdrawn(of) => Act::Withdraw { of, text },
        }
    }
}

impl People {
    /// Who it is that acts: a name, and a role where the board has several.
    pub(super) fn identity(&mut self, ui: &mut Ui, context: &Context<'_>) {
        let settings = &context.state.settings;
        if self.name.is_none() {
            self.name = Some(settings.reviewer.clone());
            self.role.clone_from(&settings.reviewer_role);
        }
        let board = &context.state.review.record().rules().board;
        if !board.iter().any(|seat| seat.role == self.role) {
            self.role = board.first().map(|seat| seat.role.clone()).unwrap_or_default();
        }
        ui.horizontal_wrapped(|ui| {
            row::quiet_word(ui, "Your name");
            let name = self.name.get_or_insert_default();
            let width = 180.0_f32.min(ui.available_width());
            let field = TextEdit::singleline(name).hint_text("Your name").desired_width(width);
            ui.add(field).accessible_name("Your name");
            if board.len() > 1 {
                row::quiet_word(ui, "as");
                let combo =
                    ComboBox::from_id_salt("role").selected_text(self.role.as_str()).show_ui(ui, |ui| {
                        for seat in board {
                            ui.selectable_value(&mut self.role, seat.role.clone(), &seat.role);
                        }
                    });
                combo.response.accessible_name("Your role");
            }
        });
    }

    fn person(&self) -> Person {
        Person { name: self.name.clone().unwrap_or_default(), role: self.role.clone() }
    }

    fn has_name(&self) -> bool {
        self.name.as_ref().is_some_and(|name| !name.trim().is_empty())
    }

    /// Below a line for attention: who acknowledged it, or how to.
    pub(super) fn acknowledgement(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        (section, line): (Section, &Line),
        known: Option<&Entry>,
        commands: &mut CommandSender,
    ) {
        let Some(entry) = known else {
            let about = About::Line(LineKey::new(section, line));
            indented(ui, |ui| {
                self.ask(ui, &about, "Acknowledge…", &line.text);
                self.answer(ui, &about, commands);
            });
            return;
        };
        let about = About::Withdrawn(entry.digest().to_owned());
        let words = format!("Acknowledged by {}: {}", who(entry), entry.act.text());
        indented(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                icon::label(ui, Icon::Check, context.tokens.good);
                ui.label(RichText::new(words).small().color(context.tokens.text_muted));
                self.ask(ui, &about, "Withdraw…", &line.text);
            });
            self.answer(ui, &about, commands);
        });
    }

    /// A button that begins words about something.
    fn ask(&mut self, ui: &mut Ui, about: &About, label: &str, of: &str) {
        let is_open = self.answer.as_ref().is_some_and(|answer| answer.about == *about);
        if !is_open && ui.button(label).accessible_name(format!("{label} {of}")).clicked() {
            self.answer = Some(Answer { about: about.clone(), text: String::new() });
        }
    }

    /// The words about something, if they are being written.
    fn answer(&mut self, ui: &mut Ui, about: &About, commands: &mut CommandSender) {
        let has_name = self.has_name();
        let Some(answer) = self.answer.as_mut().filter(|answer| answer.about == *about) else { return };
        let (send, hint) = about.words();
        let field = TextEdit::singleline(&mut answer.text).hint_text(hint).desired_width(f32::INFINITY);
        let field = ui.add(field).accessible_name(hint);
        if answer.text.is_empty() && !crate::keyboard_navigation::has_focus(ui) {
            field.request_focus();
        }
        let needs_words = matches!(about, About::Line(_));
        let is_ready = has_name && !(needs_words && answer.text.trim().is_empty());
        let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        let (mut is_sent, mut is_left) = (is_entered && is_ready, false);
        ui.horizontal_wrapped(|ui| {
            let button = ui.add_enabled(is_ready, Button::new(send));
            let why = if has_name { "enter a reason first" } else { "enter your name at the top first" };
            is_sent |= button.on_disabled_hover_text(why).clicked();
            is_left = ui.button("Cancel").clicked();
            if !has_name {
                row::quiet_word(ui, "Enter your name at the top first.");
            }
        });
        if is_sent && let Some(Answer { about, text }) = self.answer.take() {
            let act = about.act(text.trim().to_owned());
            commands.send(Command::Review(ReviewCommand::Say { by: self.person(), act }));
        } else if is_left {
            self.answer = None;
        }
    }

    /// The comments, the open ones first.
    pub(super) fn comments(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        standing: Option<&Standing<'_>>,
        closed: &mut BTreeSet<&'static str>,
        commands: &mut CommandSender,
    ) {
        let record = context.state.review.record();
        let is_comment = |entry: &&Entry| matches!(entry.act, Act::Comment { .. });
        let comments: Vec<&Entry> = record.entries().iter().filter(is_comment).collect();
        let open: &[&Entry] = standing.map_or(&[], |standing| &standing.open_comments);
        let note = match (comments.len(), open.len()) {
            (0, _) => "none".to_owned(),
            (all, open) => format!("{open} open of {all}"),
        };
        if !header(ui, context, closed, "Comments", None, &note) {
            return;
        }
        let withdrawn = record.withdrawn();
        let is_open = |entry: &Entry| open.iter().any(|it| it.digest() == entry.digest());
        let (first, then): (Vec<&Entry>, Vec<&Entry>) =
            comments.into_iter().partition(|entry| is_open(entry));
        for entry in first.iter().chain(&then) {
            let state = match withdrawn.get(entry.digest()) {
                Some(by) => format!("withdrawn by {}", who(by)),
                None if is_open(entry) => "open".to_owned(),
                None => resolution(context, entry),
            };
            let can_change = !withdrawn.contains_key(entry.digest());
            ui.push_id(entry.digest(), |ui| {
                self.comment(ui, context, entry, &state, (is_open(entry), can_change), commands);
            });
        }
        self.new_comment(ui, context, commands);
    }

    fn comment(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        entry: &Entry,
        state: &str,
        (is_open, can_change): (bool, bool),
        commands: &mut CommandSender,
    ) {
        let Act::Comment { about, text } = &entry.act else { return };
        let tokens = context.tokens;
        let id = entry.digest().to_owned();
        indented(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                let (sign, color) =
                    if is_open { (Icon::Warning, tokens.warning) } else { (Icon::Check, tokens.text_muted) };
                icon::label(ui, sign, color);
                ui.label(strong(who(entry)).color(tokens.text));
                let is_stale = context.state.review.hash() != Some(entry.content_hash.as_str());
                let age = if is_stale { ", on different content" } else { "" };
                let when = format!("{}{age}: {state}", moment(&entry.time));
                ui.label(RichText::new(when).small().color(tokens.text_muted));
            });
            if let Some(about) = about {
                let found = context.snapshot.and_then(|snapshot| Selection::by_name(snapshot, about));
                let link = ui.add_enabled(found.is_some(), egui::Button::new(about));
                if link.on_disabled_hover_text("nothing in the mission has this name").clicked()
                    && let Some(found) = found
                {
                    commands.send(Command::SelectAndReveal(found));
                }
            }
            ui.label(text);
            if can_change {
                let (change, label) = if is_open {
                    (About::Resolved(id.clone()), "Resolve…")
                } else {
                    (About::Reopened(id.clone()), "Reopen…")
                };
                ui.horizontal_wrapped(|ui| {
                    self.ask(ui, &change, label, text);
                    self.ask(ui, &About::Withdrawn(id.clone()), "Withdraw…", text);
                });
                self.answer(ui, &change, commands);
                self.answer(ui, &About::Withdrawn(id), commands);
            }
        });
    }

    fn new_comment(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let network = context.snapshot.and_then(|snapshot| snapshot.network.as_deref());
        let selected = context.state.selection.name(network);
        indented(ui, |ui| {
            let words = TextEdit::multiline(&mut self.comment)
                .hint_text("Comment")
                .desired_rows(2)
                .desired_width(f32::INFINITY);
            ui.add(words).accessible_name("Comment");
            let is_about_selected = !selected.is_empty() && !self.is_about_mission;
            if !selected.is_empty() {
                let mut is_about = is_about_selected;
                if ui.checkbox(&mut is_about, format!("About {selected}")).changed() {
                    self.is_about_mission = !is_about;
                }
            }
            let has_words = !self.comment.trim().is_empty();
            let button = ui.add_enabled(has_words && self.has_name(), Button::new("Add comment"));
            if button.clicked() {
                let text = std::mem::take(&mut self.comment).trim().to_owned();
                let about = is_about_selected.then_some(selected);
                let act = Act::Comment { about, text };
                commands.send(Command::Review(ReviewCommand::Say { by: self.person(), act }));
            }
            if has_words && !self.has_name() {
                row::quiet_word(ui, "Enter your name at the top to comment.");
            }
        });
    }

    /// Who has approved and who has to, and what stands in the way.
    pub(super) fn approval(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        standing: &Standing<'_>,
        closed: &mut BTreeSet<&'static str>,
        commands: &mut CommandSender,
    ) {
        if !header(ui, context, closed, "Approval", None, &standing.seats_in_words()) {
            return;
        }
        let tokens = context.tokens;
        indented(ui, |ui| {
            for seat in &standing.seats {
                let is_full = seat.given.len() >= seat.wanted;
                let (sign, color) =
                    if is_full { (Icon::Check, tokens.good) } else { (Icon::Nothing, tokens.text_muted) };
                ui.horizontal_wrapped(|ui| {
                    icon::label(ui, sign, color);
                    ui.label(strong(format!("{}: {} of {}", seat.role, seat.given.len(), seat.wanted)));
                });
                for entry in &seat.given {
                    let words = match entry.act.text() {
                        "" => format!("{}, {}", entry.by, moment(&entry.time)),
                        text => format!("{}, {}: {text}", entry.by, moment(&entry.time)),
                    };
                    let about = About::Withdrawn(entry.digest().to_owned());
                    ui.push_id(entry.digest(), |ui| {
                        ui.horizontal_wrapped(|ui| {
                            ui.label(words);
                            self.ask(ui, &about, "Withdraw…", &entry.by);
                        });
                        self.answer(ui, &about, commands);
                    });
                }
            }
            ui.add_space(space::S);
            for blocker in standing.blockers() {
                ui.horizontal_wrapped(|ui| {
                    icon::label(ui, Icon::Warning, tokens.warning);
                    ui.label(RichText::new(format!("Blocked by: {blocker}")).color(tokens.text));
                });
            }
            let words = TextEdit::singleline(&mut self.approval)
                .hint_text("Comments for the approval (optional)")
                .desired_width(f32::INFINITY);
            ui.add(words).accessible_name("Comments for the approval");
            let person = self.person();
            let refused = standing.may_approve(&person.name, &person.role);
            let label = if self.approval.trim().is_empty() { "Approve" } else { "Approve with comments" };
            ui.horizontal_wrapped(|ui| {
                let button = ui.add_enabled(refused.is_ok(), Button::new(label));
                if button.clicked() {
                    let text = std::mem::take(&mut self.approval);
                    commands.send(Command::Review(ReviewCommand::Approve { by: person, text }));
                }
                match &refused {
                    Err(_) if !standing.blockers().is_empty() => {}
                    Err(_) if !self.has_name() => {
                        row::quiet_word(ui, "Enter your name at the top to approve.");
                    }
                    Err(reason) => row::quiet_word(ui, &super::capital::sentence(&format!("{reason}."))),
                    Ok(()) => {}
                }
            });
        });
    }
}

/// How a comment that is not open came to be so.
fn resolution(context: &Context<'_>, comment: &Entry) -> String {
    let entries = context.state.review.record().entries();
    let resolved = entries
        .iter()
        .rev()
        .find(|entry| matches!(&entry.act, Act::Resolve { of, .. } if of == comment.digest()));
    match resolved.map(|entry| (who(entry), entry.act.text())) {
        None => "resolved".to_owned(),
        Some((by, "")) => format!("resolved by {by}"),
        Some((by, text)) => format!("resolved by {by}: {text}"),
    }
}

/// Who made an entry, with the role.
pub(super) fn who(entry: &Entry) -> String {
    match (entry.by.as_str(), entry.role.as_str()) {
        ("", _) => "someone".to_owned(),
        (name, "") => name.to_owned(),
        (name, role) => format!("{name} ({role})"),
    }
}

pub(super) fn indented(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    let margin = Margin { left: row::INDENT as i8, right: 0, top: 2, bottom: 4 };
    Frame::new().inner_margin(margin).show(ui, |ui| {
        ui.set_width(ui.available_width());
        add(ui);
    });
}
