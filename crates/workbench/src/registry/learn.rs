//! Lessons and the manual.

use serde_json::Value;

use super::arguments::{number_argument, text_argument};
use super::available::{with_lesson, with_question, with_solution};
use super::spec::{PLAIN, SHIFT, called, keys, plain, when};
use crate::command::Command;
use crate::command::chord::Key;
use crate::host::FileKind;
use crate::lesson::TOUR;
use crate::manual;
use crate::registry::spec::{CommandSpec, Group, Scope};
use crate::state::lesson::LessonCommand;
use crate::state::manual::ManualCommand;
use crate::state::window::WindowCommand;

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    plain("learn.lessons", "Show lessons", Group::Help, &[keys(PLAIN, Key::L)], Scope::NotTyping, |_| {
        Command::Lesson(LessonCommand::Show)
    }),
    plain("learn.tour", "Take the tour", Group::Help, &[], Scope::Everywhere, |_| {
        Command::Lesson(LessonCommand::Open(TOUR.name.into(), 0))
    }),
    plain("learn.contents", "Show course contents", Group::Help, &[], Scope::Everywhere, |_| {
        Command::Lesson(LessonCommand::Contents)
    }),
    when(
        plain("learn.next", "Go to next step", Group::Help, &[keys(PLAIN, Key::N)], Scope::NotTyping, |_| {
            Command::Lesson(LessonCommand::Turn(true))
        }),
        with_lesson,
    ),
    when(
        plain(
            "learn.previous",
            "Go to previous step",
            Group::Help,
            &[keys(SHIFT, Key::N)],
            Scope::NotTyping,
            |_| Command::Lesson(LessonCommand::Turn(false)),
        ),
        with_lesson,
    ),
    when(
        plain("learn.showAgain", "Reset view to step", Group::Help, &[], Scope::Everywhere, |_| {
            Command::Lesson(LessonCommand::ShowAgain)
        }),
        with_lesson,
    ),
    when(
        plain("learn.restore", "Reset lesson text", Group::Help, &[], Scope::Everywhere, |_| {
            Command::Lesson(LessonCommand::Restore)
        }),
        with_lesson,
    ),
    when(
        plain("learn.solve", "Solve task", Group::Help, &[], Scope::Everywhere, |_| {
            Command::Lesson(LessonCommand::Solve)
        }),
        with_solution,
    ),
    when(
        plain("learn.leave", "Close lesson", Group::Help, &[], Scope::Everywhere, |_| {
            Command::Lesson(LessonCommand::Leave)
        }),
        with_lesson,
    ),
    plain("learn.openFile", "Open lesson file…", Group::Help, &[], Scope::Everywhere, |_| {
        Command::Window(WindowCommand::OpenFile(FileKind::Lesson))
    }),
    plain("help.manual", "Open manual", Group::Help, &[], Scope::Everywhere, |_| {
        Command::Manual(ManualCommand::Contents)
    }),
    plain(
        "help.panel",
        "Show panel help",
        Group::Help,
        &[keys(SHIFT, Key::F1)],
        Scope::Everywhere,
        |state| Command::Manual(ManualCommand::About(state.window.active_panel)),
    ),
    called("learn.open", "Open lesson", Group::Help, |state, arguments| {
        let name = text_argument(arguments, "name")?;
        let is_known =
            crate::lesson::course_lesson(name).is_some() || state.lesson.own().any(|(own, _)| own == name);
        let stop = number_argument(arguments, "stop").unwrap_or(1.0).max(1.0) as usize;
        is_known
            .then(|| Command::Lesson(LessonCommand::Open(name.into(), stop - 1)))
            .ok_or_else(|| format!("unknown lesson \"{name}\""))
    }),
    when(
        called("learn.goTo", "Go to lesson step", Group::Help, |_, arguments| {
            let stop = number_argument(arguments, "stop")?.max(1.0) as usize;
            Ok(Command::Lesson(LessonCommand::GoTo(stop - 1)))
        }),
        with_lesson,
    ),
    when(
        called("learn.answer", "Answer question", Group::Help, |_, arguments| {
            let answer = text_argument(arguments, "answer")?;
            Ok(Command::Lesson(LessonCommand::Answer(answer.to_owned())))
        }),
        with_question,
    ),
    called("help.page", "Open manual page", Group::Help, |_, arguments| {
        let page = text_argument(arguments, "page")?;
        let section = arguments.get("section").and_then(Value::as_str).unwrap_or_default();
        let page = manual::page_named(page).ok_or_else(|| format!("unknown manual page \"{page}\""))?;
        if !section.is_empty() && page.document.heading(section).is_none() {
            return Err(format!("unknown section \"{section}\""));
        }
        Ok(Command::Manual(ManualCommand::Open(page.name, section.to_owned())))
    }),
    called("help.search", "Search the manual", Group::Help, |_, arguments| {
        let words = text_argument(arguments, "words")?;
        Ok(Command::Manual(ManualCommand::Search(words.to_owned())))
    }),
];
