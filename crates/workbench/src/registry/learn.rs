//! Lessons and the manual.

use serde_json::Value;

use super::arguments::{number_argument, text_argument};
use super::available::{with_lesson, with_question, with_solution};
use super::spec::{PLAIN, SHIFT, called, keys, plain, when};
use crate::command::Command;
use crate::command::chord::Key;
use crate::host::FileKind;
use crate::manual;
use crate::registry::spec::{CommandSpec, Group, Scope};
use crate::state::lesson::LessonCommand;
use crate::state::manual::ManualCommand;
use crate::state::window::WindowCommand;

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    plain("learn.lessons", "Lessons", Group::Help, &[keys(PLAIN, Key::L)], Scope::NotTyping, |_| {
        Command::Lesson(LessonCommand::Show)
    }),
    plain("learn.contents", "Contents of the course", Group::Help, &[], Scope::Everywhere, |_| {
        Command::Lesson(LessonCommand::Contents)
    }),
    when(
        plain(
            "learn.next",
            "Next stop of the lesson",
            Group::Help,
            &[keys(PLAIN, Key::N)],
            Scope::NotTyping,
            |_| Command::Lesson(LessonCommand::Turn(true)),
        ),
        with_lesson,
    ),
    when(
        plain(
            "learn.previous",
            "Previous stop of the lesson",
            Group::Help,
            &[keys(SHIFT, Key::N)],
            Scope::NotTyping,
            |_| Command::Lesson(LessonCommand::Turn(false)),
        ),
        with_lesson,
    ),
    when(
        plain("learn.showAgain", "Show what the stop shows", Group::Help, &[], Scope::Everywhere, |_| {
            Command::Lesson(LessonCommand::ShowAgain)
        }),
        with_lesson,
    ),
    when(
        plain("learn.restore", "Take the lesson's text again", Group::Help, &[], Scope::Everywhere, |_| {
            Command::Lesson(LessonCommand::Restore)
        }),
        with_lesson,
    ),
    when(
        plain("learn.solve", "Do the lesson's task", Group::Help, &[], Scope::Everywhere, |_| {
            Command::Lesson(LessonCommand::Solve)
        }),
        with_solution,
    ),
    when(
        plain("learn.leave", "Leave the lesson", Group::Help, &[], Scope::Everywhere, |_| {
            Command::Lesson(LessonCommand::Leave)
        }),
        with_lesson,
    ),
    plain("learn.openFile", "Open a lesson file…", Group::Help, &[], Scope::Everywhere, |_| {
        Command::Window(WindowCommand::OpenFile(FileKind::Lesson))
    }),
    plain("help.manual", "Manual", Group::Help, &[], Scope::Everywhere, |_| {
        Command::Manual(ManualCommand::Contents)
    }),
    plain(
        "help.panel",
        "About this panel",
        Group::Help,
        &[keys(SHIFT, Key::F1)],
        Scope::Everywhere,
        |state| Command::Manual(ManualCommand::About(state.window.active_panel)),
    ),
    called("learn.open", "Open a lesson", Group::Help, |state, arguments| {
        let name = text_argument(arguments, "name")?;
        let is_known =
            crate::lesson::course_lesson(name).is_some() || state.lesson.own().any(|(own, _)| own == name);
        let stop = number_argument(arguments, "stop").unwrap_or(1.0).max(1.0) as usize;
        is_known
            .then(|| Command::Lesson(LessonCommand::Open(name.into(), stop - 1)))
            .ok_or_else(|| format!("there is no lesson \"{name}\""))
    }),
    when(
        called("learn.goTo", "Go to a stop of the lesson", Group::Help, |_, arguments| {
            let stop = number_argument(arguments, "stop")?.max(1.0) as usize;
            Ok(Command::Lesson(LessonCommand::GoTo(stop - 1)))
        }),
        with_lesson,
    ),
    when(
        called("learn.answer", "Answer the question of the stop", Group::Help, |_, arguments| {
            let answer = text_argument(arguments, "answer")?;
            Ok(Command::Lesson(LessonCommand::Answer(answer.to_owned())))
        }),
        with_question,
    ),
    called("help.page", "Open a page of the manual", Group::Help, |_, arguments| {
        let page = text_argument(arguments, "page")?;
        let section = arguments.get("section").and_then(Value::as_str).unwrap_or_default();
        let page = manual::page_named(page).ok_or_else(|| format!("the manual has no page \"{page}\""))?;
        if !section.is_empty() && page.document.heading(section).is_none() {
            return Err(format!("the page has no section \"{section}\""));
        }
        Ok(Command::Manual(ManualCommand::Open(page.name, section.to_owned())))
    }),
    called("help.search", "Look for words in the manual", Group::Help, |_, arguments| {
        let words = text_argument(arguments, "words")?;
        Ok(Command::Manual(ManualCommand::Search(words.to_owned())))
    }),
];
