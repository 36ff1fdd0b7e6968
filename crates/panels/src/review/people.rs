//! What people add: comments and the sign-off, and their way into files.

use std::collections::BTreeSet;

use egui::{Button, Frame, Margin, RichText, TextEdit, Ui};
use mission::review::record::Comment;
use theme::icon::{self, Icon};
use theme::{space, strong};
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;
use workbench::state::review::{ReviewCommand, Signed, may_sign};

use super::{header, row, verdict};
use crate::Context;

/// What was typed and not sent yet.
#[derive(Default)]
pub(super) struct People {
    name: Option<String>,
    words: String,
    /// Whether the comment is about the whole mission even though something is selected.
    is_about_mission: bool,
}

impl People {
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        closed: &mut BTreeSet<&'static str>,
        commands: &mut CommandSender,
    ) {
        if self.name.is_none() {
            self.name = Some(context.state.settings.reviewer.clone());
        }
        if let Some(reason) = context.state.review.unkept() {
            unkept(ui, context, reason, commands);
        }
        let count = context.state.review.record().comments.len();
        let note = if count == 0 { "none yet".to_owned() } else { format!("{count}") };
        if header(ui, context, closed, "Comments", None, &note) {
            self.comments(ui, context, commands);
        }
        let note = match context.state.review.signed() {
            Signed::Never => "not signed off",
            Signed::Current(_) => "signed off",
            Signed::Stale(_) => "stale",
        };
        if header(ui, context, closed, "Sign-off", None, note) {
            self.sign_off(ui, context, commands);
        }
    }

    fn comments(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let hash = context.state.review.hash().unwrap_or_default();
        for (index, comment) in context.state.review.record().comments.iter().enumerate() {
            ui.push_id(index, |ui| show_comment(ui, context, index, comment, hash, commands));
        }
        let network = context.snapshot.and_then(|snapshot| snapshot.network.as_deref());
        let selected = context.state.selection.name(network);
        indented(ui, |ui| {
            self.name_field(ui, "Your name");
            let words = TextEdit::multiline(&mut self.words)
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
            let is_ready = !self.words.trim().is_empty() && self.has_name();
            if ui.add_enabled(is_ready, Button::new("Add the comment")).clicked() {
                commands.send(Command::Review(ReviewCommand::Comment {
                    author: self.name.clone().unwrap_or_default(),
                    about: is_about_selected.then_some(selected),
                    text: std::mem::take(&mut self.words),
                }));
            }
        });
    }

    fn sign_off(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let state = context.state;
        let reason = match state.current_review() {
            Some(review) => may_sign(review),
            None if state.review.is_running() => Err("the review is being made"),
            None => Err("the review is not of the present text: review again first"),
        };
        let signed = state.review.signed();
        indented(ui, |ui| {
            if let Signed::Current(by) = signed {
                ui.horizontal_wrapped(|ui| {
                    icon::label(ui, Icon::Check, context.tokens.good);
                    ui.label(format!("Signed off by {}, {}", by.name, verdict::moment(&by.time)));
                });
                if ui.button("Take the sign-off back").clicked() {
                    commands.send(Command::Review(ReviewCommand::Withdraw));
                }
            } else {
                self.name_field(ui, "Name of who signs");
                let is_ready = reason.is_ok() && self.has_name();
                let button = ui.add_enabled(is_ready, Button::new("Sign off"));
                if button.clicked() {
                    let name = self.name.clone().unwrap_or_default();
                    commands.send(Command::Review(ReviewCommand::Sign { name }));
                }
                let why = match reason {
                    Err(reason) => Some(format!("Cannot be signed off: {reason}.")),
                    Ok(()) if !self.has_name() => Some("Enter your name to sign off.".to_owned()),
                    Ok(()) => None,
                };
                if let Some(why) = why {
                    ui.label(RichText::new(why).small().color(context.tokens.text_muted));
                }
            }
            ui.add_space(space::S);
            ui.horizontal_wrapped(|ui| {
                let is_empty = state.review.record().is_empty();
                let save = ui.add_enabled(!is_empty, Button::new("Save to a file"));
                if save.on_hover_text("Comments and sign-offs as a JSON file").clicked() {
                    commands.send(Command::Review(ReviewCommand::SaveRecord));
                }
                let open = ui.button("Add from a file…");
                if open.on_hover_text("Adds the comments and sign-offs of a JSON file to these").clicked() {
                    commands.send(Command::Review(ReviewCommand::OpenRecord));
                }
            });
        });
    }

    fn name_field(&mut self, ui: &mut Ui, label: &str) {
        let name = self.name.get_or_insert_default();
        let field = TextEdit::singleline(name).hint_text(label).desired_width(220.0);
        ui.add(field).accessible_name(label);
    }

    fn has_name(&self) -> bool {
        self.name.as_ref().is_some_and(|name| !name.trim().is_empty())
    }
}

pub(super) fn indented(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    let margin = Margin { left: row::INDENT as i8, right: 0, top: 2, bottom: 4 };
    Frame::new().inner_margin(margin).show(ui, |ui| {
        ui.set_width(ui.available_width());
        add(ui);
    });
}

fn show_comment(
    ui: &mut Ui,
    context: &Context<'_>,
    index: usize,
    comment: &Comment,
    hash: &str,
    commands: &mut CommandSender,
) {
    let tokens = context.tokens;
    let margin = Margin { left: row::INDENT as i8, right: 4, top: 2, bottom: 4 };
    Frame::new().inner_margin(margin).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal_wrapped(|ui| {
            ui.label(strong(&comment.author).color(tokens.text));
            let is_stale = comment.content_hash != hash;
            let age = if is_stale { ", on other content" } else { "" };
            let when = format!("{}{age}", verdict::moment(&comment.time));
            ui.label(RichText::new(when).small().color(tokens.text_muted));
            if icon::button(ui, tokens, Icon::Close, "Remove the comment").clicked() {
                commands.send(Command::Review(ReviewCommand::RemoveComment(index)));
            }
        });
        if let Some(about) = &comment.about {
            let found = context.snapshot.and_then(|snapshot| Selection::by_name(snapshot, about));
            let link = ui.add_enabled(found.is_some(), egui::Button::new(about).small());
            if link.on_disabled_hover_text("the mission has nothing of this name any more").clicked()
                && let Some(found) = found
            {
                commands.send(Command::SelectAndReveal(found));
            }
        }
        ui.label(&comment.text);
    });
}

/// Says that what was said and signed is only in this window's memory.
fn unkept(ui: &mut Ui, context: &Context<'_>, reason: &str, commands: &mut CommandSender) {
    let tokens = context.tokens;
    ui.add_space(space::S);
    let frame = Frame::new().fill(tokens.soft[2]).corner_radius(6.0).inner_margin(Margin::symmetric(10, 8));
    frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal_wrapped(|ui| {
            icon::label(ui, Icon::Warning, tokens.error);
            ui.label(strong("Comments and sign-offs are not kept").color(tokens.error));
        });
        let text =
            format!("{reason}. They are lost when this window closes, unless they are saved to a file.");
        ui.label(RichText::new(crate::review::lines::sentence(&text)).color(tokens.text));
        if ui.button("Save them to a file").clicked() {
            commands.send(Command::Review(ReviewCommand::SaveRecord));
        }
    });
}
