//! Lessons: Markdown files that a lecturer writes, read into stops with what each of them shows and asks.
//!
//! `docs/lessons.md` says how a lesson is written. Reading one cannot fail: it gives a lesson and what is wrong with
//! it, by line. Nothing here is drawn, and nothing here is done: `state::lesson` does what a stop asks for.

mod ask;
mod course;
mod expression;
pub mod facts;
mod glossary;
mod head;
mod prose;
mod show;

use std::sync::Arc;

use kirk::Search as SearchKind;
use markdown::{Block, Content, Document, plain};

use crate::mission_file;

pub use ask::{Action, Answer, Ask, Choice, Forecast};
pub use course::{COURSE, Chapter, CourseLesson, TOUR, course_lesson};
pub use expression::{Expression, Operator, Value};
pub use glossary::{Glossary, Term};
pub use prose::filled;
pub use show::{Show, StepKind, StepTarget, Which};

/// A lesson, read.
#[derive(Clone, Debug, PartialEq)]
pub struct Lesson {
    /// Its name in addresses and commands.
    pub name: String,
    pub title: String,
    /// What it is about, in a sentence; empty if it does not say.
    pub about: String,
    /// The mission that it begins with.
    pub mission: LessonMission,
    /// How its mission is searched.
    pub search: LessonSearch,
    /// What comes of its mission before anybody changes it.
    pub expects: Expectation,
    /// The stops; at least one.
    pub stops: Vec<Stop>,
}

/// The mission of a lesson.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LessonMission {
    /// An example, by name.
    Example(&'static str),
    /// A text that is in the lesson.
    Text(Arc<str>),
}

/// How the mission of a lesson is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LessonSearch {
    One(SearchKind),
    /// By both, side by side.
    Both,
}

/// What comes of a lesson's mission before anybody changes it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Expectation {
    /// A plan that holds.
    #[default]
    Plan,
    NoPlan,
    /// Errors in the text.
    Errors,
    /// It is a control program.
    Program,
}

/// A stop: prose beside what it shows, and at most one question.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stop {
    pub title: String,
    /// The line of its heading, from 1.
    pub line: u32,
    /// The mission from this stop on, if it is another one than before.
    pub mission: Option<LessonMission>,
    /// What it says; `{{…}}` represents what is computed.
    pub prose: Vec<Block>,
    pub show: Show,
    pub ask: Option<Ask>,
}

/// Something wrong in a lesson, for its author.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct LessonError {
    /// The line, from 1.
    pub line: u32,
    /// What is wrong, and what would be right.
    pub message: String,
}

impl LessonError {
    pub(crate) fn new(line: u32, message: impl Into<String>) -> Self {
        Self { line, message: message.into() }
    }
}

impl LessonMission {
    /// The Markdown text of the lesson.
    pub fn source(&self) -> &str {
        match self {
            Self::Example(name) => mission_file::example(name).map_or("", |example| example.source),
            Self::Text(text) => text,
        }
    }
}

impl Lesson {
    /// Reads a lesson, with what is wrong in it by line. `name` is what addresses and commands call it.
    pub fn read(name: &str, text: &str) -> (Self, Vec<LessonError>) {
        let document = Document::parse(text);
        let mut errors = Vec::new();
        let mut lesson = Self {
            name: name.to_owned(),
            title: String::new(),
            about: String::new(),
            mission: LessonMission::Text("".into()),
            search: LessonSearch::One(SearchKind::Chronological),
            expects: Expectation::default(),
            stops: Vec::new(),
        };
        let mut has_mission = head::read(&mut lesson, document.head.as_ref(), &mut errors);
        for block in document.blocks {
            match &block.content {
                Content::Heading { level: 1, text } if lesson.stops.is_empty() => {
                    lesson.title = plain(text);
                    lesson.stops.push(Stop { title: plain(text), line: block.line, ..Stop::default() });
                }
                Content::Heading { level: 1 | 2, text } => {
                    lesson.stops.push(Stop { title: plain(text), line: block.line, ..Stop::default() });
                }
                Content::Code { info, text } if is_mission(info) && !has_mission => {
                    has_mission = true;
                    lesson.mission = LessonMission::Text(text.as_str().into());
                    lesson.take_shown(block);
                }
                Content::Code { info, text } if is_mission(info) && has_word(info, "mission") => {
                    if let Some(stop) = lesson.stops.last_mut() {
                        stop.mission = Some(LessonMission::Text(text.as_str().into()));
                    }
                    lesson.take_shown(block);
                }
                _ => lesson.take(block, &mut errors),
            }
        }
        if lesson.title.is_empty() {
            errors.push(LessonError::new(
                1,
                "a lesson must start with its title, such as `# Why the planner backtracks`",
            ));
            lesson.stops.insert(0, Stop { line: 1, ..Stop::default() });
        }
        if !has_mission {
            let message = "a lesson needs a mission: name an example in its head (`mission: enroute`), or write one between \
                           ```rmpl and ``` at the beginning";
            errors.push(LessonError::new(1, message));
        }
        errors.sort();
        (lesson, errors)
    }

    /// The mission that a stop begins with: its own, or that of a stop before it.
    pub fn mission_at(&self, stop: usize) -> &LessonMission {
        let before = self.stops.iter().take(stop.saturating_add(1)).rev();
        before.into_iter().find_map(|stop| stop.mission.as_ref()).unwrap_or(&self.mission)
    }

    /// The commands that its stops and solutions do, by name, with their lines.
    pub fn commands(&self) -> impl Iterator<Item = (u32, &str)> {
        let shown =
            self.stops.iter().flat_map(|stop| &stop.show.commands).map(|(line, id, _)| (*line, id.as_str()));
        let solutions = self.stops.iter().filter_map(|stop| stop.ask.as_ref()).flat_map(|ask| &ask.solution);
        shown.chain(solutions.filter_map(|action| match action {
            Action::Command(line, id, _) => Some((*line, id.as_str())),
            Action::Replace(..) => None,
        }))
    }

    /// The text of a mission is in the prose too where its fence says `shown`.
    fn take_shown(&mut self, block: Block) {
        if let (Content::Code { info, .. }, Some(stop)) = (&block.content, self.stops.last_mut())
            && has_word(info, "shown")
        {
            stop.prose.push(block);
        }
    }

    /// Takes a block of the stop that was started last.
    fn take(&mut self, block: Block, errors: &mut Vec<LessonError>) {
        let Some(stop) = self.stops.last_mut() else {
            if !matches!(block.content, Content::Rule) {
                errors.push(LessonError::new(block.line, "the title must come first: `# …`"));
            }
            return;
        };
        match &block.content {
            Content::Code { info, text } if first_word(info) == "show" => {
                stop.show = show::read(text, block.line, errors);
                stop.mission = stop.show.mission.map(LessonMission::Example).or(stop.mission.take());
            }
            Content::Code { info, text } if first_word(info) == "ask" => {
                if stop.ask.is_some() {
                    errors.push(LessonError::new(
                        block.line,
                        "a step can ask only one question; start another step with `##`",
                    ));
                }
                stop.ask = ask::read(text, block.line, errors);
            }
            _ => {
                prose::check(&block, errors);
                stop.prose.push(block);
            }
        }
    }
}

/// Returns whether a fence holds a mission or a control program.
fn is_mission(info: &str) -> bool {
    first_word(info) == "rmpl"
}

fn has_word(info: &str, word: &str) -> bool {
    info.split_whitespace().any(|it| it == word)
}

fn first_word(info: &str) -> &str {
    info.split_whitespace().next().unwrap_or_default()
}

/// The lines `key: value` of a directive, each with its number from 1. A line that begins with spaces continues with the
/// one before; lines of other forms are given to `other`.
fn entries<'a>(
    text: &'a str,
    fence: u32,
    mut other: impl FnMut(u32, &'a str),
) -> Vec<(u32, &'a str, String)> {
    let mut entries: Vec<(u32, &str, String)> = Vec::new();
    // A line that begins with spaces continues with the one before, whatever that is.
    let mut is_other = false;
    for (line, number) in text.lines().zip(fence + 1..) {
        if line.trim().is_empty() {
            continue;
        }
        let is_key = |key: &str| {
            !key.is_empty() && key.chars().all(|letter| letter.is_ascii_lowercase() || letter == '-')
        };
        match (line.split_once(':').filter(|(key, _)| is_key(key)), entries.last_mut()) {
            (_, Some((_, _, value))) if line.starts_with(' ') && !is_other => {
                value.push(' ');
                value.push_str(line.trim());
            }
            (Some((key, value)), _) => {
                is_other = false;
                entries.push((number, key, value.trim().to_owned()));
            }
            (None, _) => {
                is_other = true;
                other(number, line);
            }
        }
    }
    entries
}

#[cfg(test)]
mod tests;
