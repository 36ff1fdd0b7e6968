//! The lesson: prose beside the live drawings, what it asks, and the contents of the course.
//!
//! What a stop shows is done by the workbench; this shows what it says, and sends answers.

mod contents;
mod question;

use egui::{Button, Frame, Margin, ProgressBar, RichText, ScrollArea, Ui};
use markdown::Block;
use theme::icon::{self, Icon};
use theme::{Prose, space};
use workbench::command::{Command, CommandSender};
use workbench::lesson::{Glossary, Lesson};
use workbench::manual;
use workbench::state::lesson::LessonCommand;
use workbench::state::manual::ManualCommand;

use crate::{Context, Panel};

/// The panel, with what concerns only it: what is being typed as an answer.
#[derive(Default)]
pub struct LessonPanel {
    /// The answer that is typed, of which lesson and stop.
    typed: (String, usize, String),
    /// The stop that was shown last: another one begins at its top.
    shown: (String, usize),
}

/// Room for the row of buttons at the bottom.
const BUTTONS: f32 = 44.0;
/// Lines are not longer than can be read well.
const WIDEST: f32 = 620.0;

impl Panel for LessonPanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let Some(lesson) = context.state.lesson.open() else {
            contents::show(ui, context, commands);
            return;
        };
        let at = context.state.lesson.at();
        header(ui, context, lesson, at, commands);
        let room = ui.available_rect_before_wrap();
        let (upper, lower) = room.split_top_bottom_at_y(room.bottom() - BUTTONS);
        let is_new = self.shown != (lesson.name.clone(), at);
        self.shown = (lesson.name.clone(), at);
        if self.typed.0 != lesson.name || self.typed.1 != at {
            self.typed = (lesson.name.clone(), at, String::new());
        }
        ui.scope_builder(egui::UiBuilder::new().max_rect(upper), |ui| {
            let mut area = ScrollArea::vertical().id_salt("prose").auto_shrink([false, false]);
            if is_new {
                area = area.vertical_scroll_offset(0.0);
            }
            area.show(ui, |ui| {
                Frame::new().inner_margin(Margin::symmetric(14, 6)).show(ui, |ui| {
                    ui.set_width(ui.available_width().min(WIDEST));
                    self.stop(ui, context, commands);
                });
            });
        });
        ui.scope_builder(egui::UiBuilder::new().max_rect(lower), |ui| {
            buttons(ui, context, lesson, at, commands);
        });
        ui.advance_cursor_after_rect(room);
    }
}

impl LessonPanel {
    /// The stop: its heading, what it says, what it asks.
    fn stop(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let Some(stop) = context.state.lesson.stop() else { return };
        mistakes(ui, context);
        let prose = prose(context);
        let heading = Block {
            line: stop.line,
            content: markdown::Content::Heading {
                level: 2,
                text: vec![markdown::Run { text: stop.title.clone(), ..markdown::Run::default() }],
            },
        };
        prose.show(ui, &[heading]);
        let clicked = prose.show(ui, &context.state.lesson_prose());
        follow_link(clicked, "lessons", commands);
        if let Some(ask) = &stop.ask {
            question::show(ui, context, ask, &mut self.typed.2, commands);
        }
        if context.state.lesson.is_due() {
            ui.label(RichText::new("Planning…").color(context.tokens.text_muted));
        }
        ui.add_space(space::XL);
    }
}

/// Returns how lessons and the manual look: terms of the glossary tell what they mean.
pub(crate) fn prose<'a>(context: &'a Context<'_>) -> Prose<'a> {
    Prose {
        tokens: context.tokens,
        hover: &|link| Glossary::get().linked(link).map(|term| term.meaning.as_slice()),
    }
}

/// Opens what a link leads to: a term, or a place of the manual.
pub(crate) fn follow_link(link: Option<String>, here: &str, commands: &mut CommandSender) {
    let Some(link) = link else { return };
    let target = match Glossary::get().linked(&link) {
        Some(term) => Some((manual::GLOSSARY, markdown::anchor(&term.heading()))),
        None => manual::target(&link, here),
    };
    if let Some((page, section)) = target {
        commands.send(Command::Manual(ManualCommand::Open(page, section)));
    }
}

/// The lesson's title with what leads out of it, and how far the stop is.
fn header(ui: &mut Ui, context: &Context<'_>, lesson: &Lesson, at: usize, commands: &mut CommandSender) {
    let tokens = context.tokens;
    Frame::new().inner_margin(Margin::symmetric(14, 6)).show(ui, |ui| {
        ui.horizontal(|ui| {
            let contents = ui.add(Button::new("Contents"));
            if contents.on_hover_text("Close this lesson and list the course").clicked() {
                commands.send(Command::Lesson(LessonCommand::Contents));
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let is_edited = context.state.lesson.text() != Some(context.state.document.text());
                let again = ui.add_enabled(is_edited, Button::new("Reset text"));
                if again.on_hover_text("Restore the lesson's original text (can be undone)").clicked() {
                    commands.send(Command::Lesson(LessonCommand::Restore));
                }
            });
        });
        ui.add_space(space::S);
        if at > 0 {
            let title = RichText::new(&lesson.title).color(tokens.text_muted);
            ui.add(egui::Label::new(title).wrap());
        }
        let stops = lesson.stops.len().max(1);
        let bar = ProgressBar::new((at + 1) as f32 / stops as f32).desired_height(3.0).fill(tokens.accent);
        ui.add(bar);
    });
}

/// What is wrong in a lesson's file.
fn mistakes(ui: &mut Ui, context: &Context<'_>) {
    let errors = context.state.lesson.errors();
    if errors.is_empty() {
        return;
    }
    let tokens = context.tokens;
    Frame::new().fill(tokens.soft[2]).corner_radius(4.0).inner_margin(Margin::same(8)).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.label(theme::strong("This lesson has errors"));
        for error in errors {
            ui.horizontal_top(|ui| {
                icon::label(ui, Icon::Error, tokens.error);
                ui.add(egui::Label::new(format!("Line {}: {}", error.line, error.message)).wrap());
            });
        }
    });
    ui.add_space(space::M);
}

/// The row at the bottom: back, again, next.
fn buttons(ui: &mut Ui, context: &Context<'_>, lesson: &Lesson, at: usize, commands: &mut CommandSender) {
    let state = &context.state.lesson;
    ui.painter().hline(
        ui.max_rect().x_range(),
        ui.max_rect().top(),
        egui::Stroke::new(1.0, context.tokens.line),
    );
    let is_first = at == 0 && state.neighbor(false).is_none();
    let is_last = at + 1 >= lesson.stops.len();
    ui.horizontal_centered(|ui| {
        ui.add_space(space::L);
        let back = ui.add_enabled(!is_first, Button::new("Previous"));
        if back.on_hover_text("Previous step (Shift+N)").clicked() {
            commands.send(Command::Lesson(LessonCommand::Turn(false)));
        }
        let (title, hint, turn) = match (is_last, state.neighbor(true)) {
            (false, _) => ("Next", "Next step (N)", LessonCommand::Turn(true)),
            (true, Some(_)) => ("Next lesson", "Next step (N)", LessonCommand::Turn(true)),
            (true, None) => ("Back to contents", "List all lessons of the course", LessonCommand::Contents),
        };
        let next = Button::new(RichText::new(title).color(context.tokens.text_on_accent))
            .fill(context.tokens.accent);
        if ui.add(next).on_hover_text(hint).clicked() {
            commands.send(Command::Lesson(turn));
        }
        let again = ui.button("Reset view");
        if again.on_hover_text("Reset the view to this step").clicked() {
            commands.send(Command::Lesson(LessonCommand::ShowAgain));
        }
        // The line above the text says it too, where there is no room beside the buttons.
        let text = format!("{} of {}", at + 1, lesson.stops.len());
        let font = egui::TextStyle::Body.resolve(ui.style());
        let galley = ui.painter().layout_no_wrap(text, font, context.tokens.text_muted);
        if galley.size().x + space::L + space::S <= ui.available_width() {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.add_space(space::L);
                ui.label(galley);
            });
        }
    });
}
