//! The contents of the course, the lessons that were opened as files, and how to open one.

use egui::{Button, Frame, Margin, RichText, ScrollArea, Ui};
use theme::icon::{self, Icon};
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::host::FileKind;
use workbench::lesson::{COURSE, CourseLesson, Lesson, TOUR};
use workbench::state::lesson::LessonCommand;
use workbench::state::manual::ManualCommand;
use workbench::state::window::WindowCommand;

use crate::Context;

/// Shows the contents.
pub(super) fn show(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        Frame::new().inner_margin(Margin::symmetric(14, 10)).show(ui, |ui| {
            theme::structure::mark_heading(&ui.heading("Lessons"), 2);
            ui.label(
                RichText::new("A course from your first RMPL line to a complete mission.")
                    .color(tokens.text_muted),
            );
            ui.add_space(space::M);
            entry(ui, context, None, &TOUR, commands);
            let mut number = 0;
            for chapter in COURSE {
                ui.add_space(space::L);
                ui.label(theme::strong(chapter.title));
                for lesson in chapter.lessons {
                    number += 1;
                    entry(ui, context, Some(number), lesson, commands);
                }
            }
            if let [made @ 1..=u32::MAX, right] = context.state.settings.predictions {
                ui.add_space(space::L);
                let text = format!("Predictions: {right} of {made} correct");
                ui.label(RichText::new(text).color(tokens.text_muted));
            }
            ui.add_space(space::L);
            ui.label(theme::strong("Your lessons"));
            for (name, title) in context.state.lesson.own() {
                if ui.add(Button::new(title).frame_when_inactive(false).wrap()).clicked() {
                    commands.send(Command::Lesson(LessonCommand::Open(name.clone(), 0)));
                }
            }
            ui.horizontal_wrapped(|ui| {
                if ui.button("Open lesson file…").clicked() {
                    commands.send(Command::Window(WindowCommand::OpenFile(FileKind::Lesson)));
                }
                if ui.button("Write your own lesson").clicked() {
                    commands.send(Command::Manual(ManualCommand::Open("lessons", String::new())));
                }
            });
            ui.add_space(space::XL);
        });
    });
}

fn entry(
    ui: &mut Ui,
    context: &Context<'_>,
    number: Option<usize>,
    lesson: &CourseLesson,
    commands: &mut CommandSender,
) {
    let (read, about, questions) = summary(ui, lesson);
    let learned = questions.iter().filter(|&&stop| context.state.is_learned(lesson.name, stop)).count();
    ui.horizontal(|ui| {
        let is_done = !questions.is_empty() && learned == questions.len();
        let color = if is_done { context.tokens.good } else { context.tokens.text_faint };
        icon::label(ui, if is_done { Icon::Check } else { Icon::ChevronRight }, color);
        let title = number.map_or_else(|| read.clone(), |number| format!("{number}. {read}"));
        let button = Button::new(title).frame_when_inactive(false).wrap();
        let hover = format!("{about}\n{learned} of {} questions answered", questions.len());
        if ui.add(button).on_hover_text(hover).clicked() {
            commands.send(Command::Lesson(LessonCommand::Open(lesson.name.into(), 0)));
        }
    });
}

/// Title, what it is about, and the stops that ask something; read once.
fn summary(ui: &Ui, lesson: &CourseLesson) -> (String, String, Vec<usize>) {
    let id = egui::Id::unique(("lesson", lesson.name));
    if let Some(kept) = ui.data(|data| data.get_temp::<(String, String, Vec<usize>)>(id)) {
        return kept;
    }
    let (read, _) = Lesson::read(lesson.name, lesson.text);
    let asks = read.stops.iter().enumerate().filter(|(_, stop)| stop.ask.is_some());
    let made = (read.title.clone(), read.about.clone(), asks.map(|(at, _)| at).collect::<Vec<usize>>());
    ui.data_mut(|data| data.insert_temp(id, made.clone()));
    made
}
