//! The lesson that is open: at which stop it is, what was answered, and which panels stand beside it.
//!
//! A stop is shown as soon as the core has answered for the text that is there: its step is a step of that search.

mod prediction;

use std::collections::BTreeMap;
use std::sync::Arc;

use smol_str::SmolStr;

use crate::lesson::{Answer, COURSE, Lesson, LessonError, LessonMission, Stop};
use crate::panel_kind::PanelKind;
use crate::state::settings::PlanSettings;

pub use prediction::{Prediction, Predictions};

/// What can be asked of the lessons.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LessonCommand {
    /// Shows the lessons: the one that is open, or the contents of the course.
    Show,
    /// Shows the contents of the course.
    Contents,
    /// Opens a lesson at a stop, from 0.
    Open(SmolStr, usize),
    /// Goes to a stop of the lesson, from 0.
    GoTo(usize),
    /// To the next stop, or the next lesson of the course (`true`), or back.
    Turn(bool),
    /// Shows what the stop shows again.
    ShowAgain,
    /// Gives the mission the text that the lesson begins with, as an edit.
    Restore,
    /// Answers the stop's question: the number of a choice from 0, a number, or a word.
    Answer(String),
    /// Does the stop's task.
    Solve,
    /// Leaves the lesson; its mission stays open.
    Leave,
}

/// The lesson that is open, and the answers given so far.
#[derive(Debug, Default)]
pub struct LessonState {
    pub(crate) open: Option<Arc<Lesson>>,
    pub(crate) errors: Arc<[LessonError]>,
    pub(crate) stop: usize,
    /// The mission that was opened for the stop.
    pub(crate) opened: Option<LessonMission>,
    /// Whether what the stop shows is still to be shown.
    pub(crate) is_due: bool,
    /// Samples that are to be drawn as soon as the core has found them.
    pub(crate) samples_due: Option<u32>,
    /// Whether the task is to be solved as soon as the run is there.
    pub(crate) is_solution_due: bool,
    /// Whether the panels stand as the lesson wants them.
    pub(crate) is_beside: bool,
    /// The panels beside the lesson: rows of columns of tabs.
    pub(crate) panels: Vec<Vec<Vec<PanelKind>>>,
    /// What was answered last, by lesson and stop, and whether it was right.
    pub(crate) answers: BTreeMap<(String, usize), Given>,
    /// What was predicted at the stop where the lesson is.
    pub(crate) predictions: Predictions,
    /// Lessons that were opened as files, by name.
    pub(crate) own: BTreeMap<SmolStr, (Arc<Lesson>, Arc<[LessonError]>)>,
    /// How planning was set before the lesson, which sets it for itself.
    pub(crate) plan_settings: Option<PlanSettings>,
    /// Whether long lines of text were wrapped before the lesson, which wraps them.
    pub(crate) wraps_before: Option<bool>,
}

/// An answer that was given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Given {
    /// What was answered.
    pub text: String,
    pub is_right: bool,
}

impl LessonState {
    /// The lesson that is open.
    pub fn open(&self) -> Option<&Arc<Lesson>> {
        self.open.as_ref()
    }

    /// Returns what is wrong in it, by line.
    pub fn errors(&self) -> &[LessonError] {
        &self.errors
    }

    /// Returns where the lesson is, from 0.
    pub const fn at(&self) -> usize {
        self.stop
    }

    /// The stop where the lesson is.
    pub fn stop(&self) -> Option<&Stop> {
        self.open.as_ref()?.stops.get(self.stop)
    }

    /// Returns whether what the stop shows is still to be shown: the core is at work for it.
    pub const fn is_due(&self) -> bool {
        self.is_due
    }

    /// Returns whether the panels stand as the lesson, or the contents of the course, want them.
    pub const fn is_beside(&self) -> bool {
        self.is_beside
    }

    /// The panels beside the lesson: rows of columns of tabs.
    pub fn panels(&self) -> &[Vec<Vec<PanelKind>>] {
        &self.panels
    }

    /// The lessons that were opened as files, by name and title.
    pub fn own(&self) -> impl Iterator<Item = (&SmolStr, &str)> {
        self.own.iter().map(|(name, (lesson, _))| (name, lesson.title.as_str()))
    }

    /// The text that the stop begins with.
    pub fn text(&self) -> Option<&str> {
        self.opened.as_ref().map(LessonMission::source)
    }

    /// Returns what was answered last at the stop where the lesson is.
    pub fn given(&self) -> Option<&Given> {
        self.answers.get(&(self.open.as_ref()?.name.clone(), self.stop))
    }

    /// Returns how the last answer at the stop where the lesson is was judged, in words; nothing before one was given.
    pub fn verdict(&self) -> Option<String> {
        let answer = &self.stop()?.ask.as_ref()?.answer;
        if let Answer::Prediction(_) = answer {
            return self.predictions.made.last().map(Prediction::verdict);
        }
        let words = match (self.given()?.is_right, answer) {
            (true, Answer::Task(_)) => "Done.",
            (true, _) => "Correct.",
            (false, _) => "Incorrect. Try again.",
        };
        Some(words.to_owned())
    }

    /// Returns what was predicted at the stop where the lesson is.
    pub const fn predictions(&self) -> &Predictions {
        &self.predictions
    }

    /// The lesson before the open one in the course, or after it.
    pub fn neighbor(&self, forwards: bool) -> Option<&'static str> {
        let names: Vec<&str> = COURSE.iter().flat_map(|chapter| chapter.lessons).map(|it| it.name).collect();
        let at =
            names.iter().position(|name| Some(*name) == self.open.as_ref().map(|it| it.name.as_str()))?;
        let at = if forwards { at + 1 } else { at.checked_sub(1)? };
        names.get(at).copied()
    }

    /// Another mission was opened: the lesson is not about it.
    pub(crate) fn leave_mission(&mut self) {
        (self.open, self.opened, self.is_due, self.is_beside) = (None, None, false, false);
        self.errors = Arc::default();
    }

    /// The user turned to a workspace: its panels stand as it wants them. The lesson stays open.
    pub(crate) const fn put_away(&mut self) {
        self.is_beside = false;
    }
}

/// Returns what a right answer is remembered under.
pub(crate) fn learned_key(lesson: &str, stop: usize) -> String {
    format!("{lesson}/{}", stop + 1)
}
