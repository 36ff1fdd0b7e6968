//! What people of the board do: who they are, what they acknowledge, comment and approve.

use std::collections::BTreeSet;

use egui::{Button, ComboBox, Frame, Margin, RichText, TextEdit, Ui};
use review::check::is_concerned;
use review::keys::PublicKey;
use review::record::{Act, Entry, LineKey};
use review::{Check, Line, Section, Standing, WaiverState};
use theme::icon::{self, Icon};
use theme::{space, strong};
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;
use workbench::state::keys::KeyChange;
use workbench::state::review::{Person, ReviewCommand};

use super::verdict::moment;
use super::{header, row};
use crate::Context;

/// What was typed and not sent yet.
#[derive(Default)]
pub(super) struct People {
    /// The owner of the key that signs, and the key.
    me: Option<(String, PublicKey)>,
    /// The name of a key that is to be created.
    new_name: String,
    role: String,
    comment: String,
    /// Who is to answer the comment, if someone is.
    addressee: Option<(String, PublicKey)>,
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
    /// The day on which a waiver lapses.
    until: String,
}

/// What words are about.
#[derive(Clone, PartialEq)]
enum About {
    /// An item that needs attention, which is acknowledged.
    Line(LineKey),
    /// An item that needs attention, which is waived.
    Waived(LineKey),
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
            Self::Waived(_) => ("Waive", "Why is this acceptable until then?"),
            Self::Resolved(_) => ("Resolve", "How was it resolved?"),
            Self::Reopened(_) => ("Reopen", "Why is it reopened?"),
            Self::Withdrawn(_) => ("Withdraw", "Reason for withdrawing"),
        }
    }

    fn act(self, text: String, until: String) -> Act {
        match self {
            Self::Line(line) => Act::Acknowledge { line, text },
            Self::Waived(line) => Act::Waive { line, text, until },
            Self::Resolved(of) => Act::Resolve { of, text },
            Self::Reopened(of) => Act::Reopen { of, text },
            Self::Withdrawn(of) => Act::Withdraw { of, text },
        }
    }
}

impl People {
    /// Who it is that acts: the owner of a key, and a role where the board has several.
    pub(super) fn identity(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let settings = &context.state.settings;
        if self.role.is_empty() {
            self.role.clone_from(&settings.reviewer_role);
        }
        let board = &context.state.review.record().rules().board;
        if !board.iter().any(|seat| seat.role == self.role) {
            self.role = board.first().map(|seat| seat.role.clone()).unwrap_or_default();
        }
        let ring = context.state.keys.ring();
        let known = ring.own_named(&settings.reviewer).or_else(|| ring.own().next());
        self.me = known.map(|person| (person.name.clone(), person.key.clone()));
        let Some((mut name, _)) = self.me.clone() else {
            self.new_key(ui, "Create a key to sign with", commands);
            return;
        };
        ui.horizontal_wrapped(|ui| {
            row::muted_word(ui, "Sign as");
            let combo = ComboBox::from_id_salt("signer").selected_text(name.clone()).show_ui(ui, |ui| {
                theme::structure::options(ui, "Your key");
                for person in ring.own() {
                    theme::structure::option_value(ui, &mut name, person.name.clone(), &person.name);
                }
            });
            combo.response.accessible_name("Your key");
            if name != settings.reviewer {
                commands.send(Command::Review(ReviewCommand::SignAs(name)));
            }
            if board.len() > 1 {
                row::muted_word(ui, "as");
                let combo =
                    ComboBox::from_id_salt("role").selected_text(self.role.as_str()).show_ui(ui, |ui| {
                        theme::structure::options(ui, "Your role");
                        for seat in board {
                            let role = seat.role.clone();
                            theme::structure::option_value(ui, &mut self.role, role, &seat.role);
                        }
                    });
                combo.response.accessible_name("Your role");
            }
        });
    }

    /// A field for a name, and the button that creates a key under it.
    pub(super) fn new_key(&mut self, ui: &mut Ui, label: &str, commands: &mut CommandSender) {
        ui.horizontal_wrapped(|ui| {
            row::muted_word(ui, label);
            let width = 180.0_f32.min(ui.available_width());
            let field = TextEdit::singleline(&mut self.new_name).hint_text("Your name").desired_width(width);
            ui.add(field).accessible_name("Your name");
            let is_ready = !self.new_name.trim().is_empty();
            if ui.add_enabled(is_ready, Button::new("Create key")).clicked() {
                let name = std::mem::take(&mut self.new_name);
                commands.send(Command::Review(ReviewCommand::ChangeKeys(KeyChange::Create(name))));
            }
        });
    }

    fn person(&self) -> Person {
        let name = self.me.as_ref().map(|(name, _)| name.clone()).unwrap_or_default();
        Person { name, role: self.role.clone() }
    }

    fn has_key(&self) -> bool {
        self.me.is_some()
    }

    /// Returns whether an entry was signed with the key that signs here.
    fn is_own(&self, entry: &Entry) -> bool {
        self.me.as_ref().is_some_and(|(_, key)| entry.key.as_ref() == Some(key))
    }

    /// Below an item that needs attention: who acknowledged it, or how to.
    pub(super) fn acknowledgment(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        (section, line): (Section, &Line),
        known: Option<&Entry>,
        commands: &mut CommandSender,
    ) {
        let Some(entry) = known else {
            let key = LineKey::new(section, line);
            let (acknowledged, waived) = (About::Line(key.clone()), About::Waived(key));
            indented(ui, |ui| {
                ui.horizontal_wrapped(|ui| {
                    if !line.needs_waiver {
                        self.ask(ui, &acknowledged, "Acknowledge…", &line.text);
                    }
                    self.ask(ui, &waived, "Waive…", &line.text);
                });
                self.answer(ui, context, &acknowledged, commands);
                self.answer(ui, context, &waived, commands);
            });
            return;
        };
        let about = About::Withdrawn(entry.digest().to_owned());
        let done = match &entry.act {
            Act::Waive { until, .. } => format!("Waived until {until}"),
            _ => "Acknowledged".to_owned(),
        };
        let words = format!("{done} by {}: {}", who(entry), entry.act.text());
        indented(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                icon::label(ui, Icon::Check, context.tokens.good);
                ui.label(RichText::new(words).small().color(context.tokens.text_muted));
                if self.is_own(entry) {
                    self.ask(ui, &about, "Withdraw…", &line.text);
                }
            });
            self.answer(ui, context, &about, commands);
        });
    }

    /// The waivers: those in force, those about to lapse, and those that have lapsed.
    pub(super) fn waivers(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        closed: &mut BTreeSet<&'static str>,
        commands: &mut CommandSender,
    ) {
        let waivers = context.state.review.record().waivers();
        if waivers.is_empty() {
            return;
        }
        let count = |state| waivers.iter().filter(|waiver| waiver.state == state).count();
        let states = [WaiverState::InForce, WaiverState::AboutToLapse, WaiverState::Lapsed];
        let notes = states.into_iter().filter(|&state| count(state) > 0);
        let note = notes.map(|state| format!("{} {}", count(state), state.name())).collect::<Vec<_>>();
        if !header(ui, context, closed, "Waivers", None, &note.join(", ")) {
            return;
        }
        let tokens = context.tokens;
        for waiver in waivers {
            let (sign, color) = match waiver.state {
                WaiverState::InForce => (Icon::Check, tokens.good),
                WaiverState::AboutToLapse => (Icon::Warning, tokens.warning),
                WaiverState::Lapsed => (Icon::Error, tokens.error),
            };
            let about = About::Withdrawn(waiver.entry.digest().to_owned());
            ui.push_id(("waiver", waiver.entry.digest()), |ui| {
                indented(ui, |ui| {
                    ui.horizontal_wrapped(|ui| {
                        icon::label(ui, sign, color);
                        ui.label(strong(format!("{}, {}", waiver.state.name(), waiver.until)).color(color));
                        let font = egui::TextStyle::Body.resolve(ui.style());
                        let line = workbench::sentence(&waiver.line.text);
                        ui.label(crate::inline_code::job(&line, &font, tokens.text, ui.available_width()));
                    });
                    let words = format!("{}: {}", who(waiver.entry), waiver.entry.act.text());
                    ui.label(RichText::new(words).small().color(tokens.text_muted));
                    if self.is_own(waiver.entry) {
                        self.ask(ui, &about, "Withdraw…", &waiver.line.text);
                    }
                    self.answer(ui, context, &about, commands);
                });
            });
        }
    }

    /// A button that begins words about something.
    fn ask(&mut self, ui: &mut Ui, about: &About, label: &str, of: &str) {
        let is_open = self.answer.as_ref().is_some_and(|answer| answer.about == *about);
        if !is_open && ui.button(label).accessible_name(format!("{label} {of}")).clicked() {
            let (text, until) = (String::new(), String::new());
            self.answer = Some(Answer { about: about.clone(), text, until });
        }
    }

    /// The words about something, if they are being written.
    fn answer(&mut self, ui: &mut Ui, context: &Context<'_>, about: &About, commands: &mut CommandSender) {
        let has_key = self.has_key();
        let Some(answer) = self.answer.as_mut().filter(|answer| answer.about == *about) else { return };
        let (send, hint) = about.words();
        let field = TextEdit::singleline(&mut answer.text).hint_text(hint).desired_width(f32::INFINITY);
        let field = ui.add(field).accessible_name(hint);
        if answer.text.is_empty() && !crate::keyboard_navigation::has_focus(ui) {
            field.request_focus();
        }
        let is_waiver = matches!(about, About::Waived(_));
        if is_waiver {
            let day = TextEdit::singleline(&mut answer.until).hint_text("2026-01-31").desired_width(120.0);
            ui.horizontal_wrapped(|ui| {
                row::muted_word(ui, "Lapses on");
                ui.add(day).accessible_name("Lapses on");
            });
        }
        let needs_words = is_waiver || matches!(about, About::Line(_) | About::Resolved(_));
        let is_dated = !is_waiver || context.state.review.record().may_lapse_on(answer.until.trim());
        let is_ready = has_key && is_dated && !(needs_words && answer.text.trim().is_empty());
        let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        let (mut is_sent, mut is_left) = (is_entered && is_ready, false);
        ui.horizontal_wrapped(|ui| {
            let button = ui.add_enabled(is_ready, Button::new(send));
            let why = match (has_key, is_dated) {
                (false, _) => "create a key first",
                (true, false) => "enter a date after today, such as 2026-01-31",
                (true, true) => "enter a reason first",
            };
            is_sent |= button.on_disabled_hover_text(why).clicked();
            is_left = ui.button("Cancel").clicked();
            if !has_key {
                row::muted_word(ui, "Create a key at the top first.");
            }
        });
        if is_sent && let Some(Answer { about, text, until }) = self.answer.take() {
            let act = about.act(text.trim().to_owned(), until.trim().to_owned());
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
        let is_comment = |(entry, _): &(&Entry, &Check)| matches!(entry.act, Act::Comment { .. });
        let comments: Vec<(&Entry, &Check)> = record.checked().filter(is_comment).collect();
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
        let (first, then): (Vec<_>, Vec<_>) = comments.into_iter().partition(|(entry, _)| is_open(entry));
        for (entry, check) in first.into_iter().chain(then) {
            let state = match withdrawn.get(entry.digest()) {
                _ if !check.counts() => format!("does not count: {}", check.words()),
                Some(by) => format!("withdrawn by {}", who(by)),
                None if is_open(entry) => "open".to_owned(),
                None => resolution(context, entry),
            };
            let can_change = check.counts() && !withdrawn.contains_key(entry.digest());
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
        let Act::Comment { about, to, text } = &entry.act else { return };
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
            if let Some(to) = to {
                let mut people = context.state.keys.ring().people().iter();
                let name = people.find(|person| person.key == *to);
                let name = name.map_or_else(|| to.fingerprint(), |person| person.name.clone());
                row::muted_word(ui, &format!("To {name}"));
            }
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
                let is_concerned = self.me.as_ref().is_some_and(|(_, key)| is_concerned(key, entry));
                ui.horizontal_wrapped(|ui| {
                    if is_concerned {
                        self.ask(ui, &change, label, text);
                    }
                    if self.is_own(entry) {
                        self.ask(ui, &About::Withdrawn(id.clone()), "Withdraw…", text);
                    }
                });
                self.answer(ui, context, &change, commands);
                self.answer(ui, context, &About::Withdrawn(id), commands);
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
            self.addressee(ui, context);
            let has_words = !self.comment.trim().is_empty();
            let button = ui.add_enabled(has_words && self.has_key(), Button::new("Add comment"));
            if button.clicked() {
                let text = std::mem::take(&mut self.comment).trim().to_owned();
                let about = is_about_selected.then_some(selected);
                let to = self.addressee.take().map(|(_, key)| key);
                let act = Act::Comment { about, to, text };
                commands.send(Command::Review(ReviewCommand::Say { by: self.person(), act }));
            }
            if has_words && !self.has_key() {
                row::muted_word(ui, "Create a key at the top to comment.");
            }
        });
    }

    /// Who is to answer the comment that is being written.
    fn addressee(&mut self, ui: &mut Ui, context: &Context<'_>) {
        let me = self.me.as_ref().map(|(_, key)| key);
        let people = context.state.keys.ring().people().iter();
        let others: Vec<_> = people.filter(|person| Some(&person.key) != me).collect();
        if others.is_empty() {
            return;
        }
        ui.horizontal_wrapped(|ui| {
            row::muted_word(ui, "To");
            let shown = self.addressee.as_ref().map_or("everyone", |(name, _)| name.as_str());
            let combo = ComboBox::from_id_salt("addressee").selected_text(shown.to_owned());
            let combo = combo.show_ui(ui, |ui| {
                theme::structure::options(ui, "Addressee");
                theme::structure::option_value(ui, &mut self.addressee, None, "everyone");
                for person in others {
                    let to = Some((person.name.clone(), person.key.clone()));
                    theme::structure::option_value(ui, &mut self.addressee, to, &person.name);
                }
            });
            combo.response.accessible_name("Addressee");
        });
    }

    /// Who has approved and who has to, and what is in the way.
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
                            if self.is_own(entry) {
                                self.ask(ui, &about, "Withdraw…", &entry.by);
                            }
                        });
                        self.answer(ui, context, &about, commands);
                    });
                }
            }
            ui.add_space(space::S);
            for blocker in standing.blockers() {
                ui.horizontal_wrapped(|ui| {
                    icon::label(ui, Icon::Warning, tokens.warning);
                    ui.label(RichText::new(format!("Approval blocked: {blocker}")).color(tokens.text));
                });
            }
            let words = TextEdit::singleline(&mut self.approval)
                .hint_text("Comments for the approval (optional)")
                .desired_width(f32::INFINITY);
            ui.add(words).accessible_name("Comments for the approval");
            let person = self.person();
            let refused = match &self.me {
                Some((_, key)) => standing.may_approve(key, &person.role),
                None => Err("create a key at the top to approve".to_owned()),
            };
            let label = if self.approval.trim().is_empty() { "Approve" } else { "Approve with comments" };
            ui.horizontal_wrapped(|ui| {
                let button = ui.add_enabled(refused.is_ok(), Button::new(label));
                if button.clicked() {
                    let text = std::mem::take(&mut self.approval);
                    commands.send(Command::Review(ReviewCommand::Approve { by: person, text }));
                }
                match &refused {
                    Err(_) if !standing.blockers().is_empty() => {}
                    Err(reason) => row::muted_word(ui, &workbench::sentence(&format!("{reason}."))),
                    Ok(()) => {}
                }
            });
        });
    }
}

/// Returns how a comment that is not open came to be so.
fn resolution(context: &Context<'_>, comment: &Entry) -> String {
    let record = context.state.review.record();
    let resolved = record
        .counted()
        .rev()
        .find(|entry| matches!(&entry.act, Act::Resolve { of, .. } if of == comment.digest()));
    match resolved.map(|entry| (who(entry), entry.act.text())) {
        None => "resolved".to_owned(),
        Some((by, "")) => format!("resolved by {by}"),
        Some((by, text)) => format!("resolved by {by}: {text}"),
    }
}

/// Returns who made an entry, with the role.
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
