//! The lesson and the manual.

use markdown::Block;
use serde::Serialize;
#[cfg(test)]
use ts_rs::TS;

use crate::lesson::{Answer, COURSE};
use crate::state::AppState;
use crate::state::lesson::Prediction;

/// The lessons; `open` is `null` while the contents of the course are shown.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Lessons {
    /// The names of the course's lessons, in order.
    pub course: Vec<&'static str>,
    /// Steps whose questions the user answered correctly: `negative-cycle/2`.
    pub learned: Vec<String>,
    /// Whether the panels are arranged for the lesson.
    pub beside: bool,
    pub open: Option<OpenLesson>,
}

/// The open lesson, at its current step.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct OpenLesson {
    pub name: String,
    pub title: String,
    /// From 1.
    pub stop: usize,
    pub stops: usize,
    pub stop_title: String,
    /// Whether Enroute is still calculating what the step shows.
    pub is_due: bool,
    /// The text of the step, without its format.
    pub prose: String,
    pub question: Option<Question>,
    /// The errors in the lesson's file, by line.
    pub errors: Vec<LessonMistake>,
}

/// The question of a step.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct Question {
    #[cfg_attr(test, ts(type = "\"choice\" | \"number\" | \"word\" | \"task\" | \"prediction\""))]
    pub kind: &'static str,
    pub text: String,
    pub choices: Vec<String>,
    /// The last answer; of a prediction, the last one whose result has been shown.
    pub given: Option<String>,
    /// Whether that answer is right; of a task, whether it is done.
    pub is_right: Option<bool>,
    /// The predictions at this step, if the step asks for them.
    pub predictions: Option<PredictionCounts>,
}

/// The number of predictions, and of right ones.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct PredictionCounts {
    pub made: usize,
    pub right: usize,
    /// Whether nothing is left to predict.
    pub is_over: bool,
}

/// An error in a lesson.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct LessonMistake {
    /// From 1.
    pub line: u32,
    pub message: String,
}

/// The open page of the manual, and its search.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Manual {
    /// `null` while its contents are shown.
    pub page: Option<&'static str>,
    pub section: String,
    pub query: String,
    /// The sections that contain the query: `page#section`.
    pub found: Vec<String>,
}

pub(super) fn lessons(state: &AppState) -> Lessons {
    Lessons {
        course: COURSE.iter().flat_map(|chapter| chapter.lessons).map(|lesson| lesson.name).collect(),
        learned: state.settings.learned.iter().cloned().collect(),
        beside: state.lesson.is_beside(),
        open: open(state),
    }
}

fn open(state: &AppState) -> Option<OpenLesson> {
    let (lesson, stop) = (state.lesson.open()?, state.lesson.stop()?);
    let errors = state.lesson.errors().iter();
    let predictions = state.lesson.predictions();
    let last = predictions.made().last();
    Some(OpenLesson {
        name: lesson.name.clone(),
        title: lesson.title.clone(),
        stop: state.lesson.at() + 1,
        stops: lesson.stops.len(),
        stop_title: stop.title.clone(),
        is_due: state.lesson.is_due(),
        prose: state.lesson_prose().iter().map(Block::plain).collect::<Vec<_>>().join("\n"),
        question: stop.ask.as_ref().map(|ask| Question {
            kind: match ask.answer {
                Answer::Choice(_) => "choice",
                Answer::Number(..) => "number",
                Answer::Word(_) => "word",
                Answer::Task(_) => "task",
                Answer::Prediction(_) => "prediction",
            },
            text: state.lesson_line(&ask.text),
            choices: match &ask.answer {
                Answer::Choice(choices) => choices.iter().map(|it| state.lesson_line(&it.text)).collect(),
                Answer::Prediction(_) => state.forecasts(),
                Answer::Number(..) | Answer::Word(_) | Answer::Task(_) => Vec::new(),
            },
            given: last.map(|last| last.given.clone()).or_else(|| Some(state.lesson.given()?.text.clone())),
            is_right: last.map(Prediction::is_right).or_else(|| Some(state.lesson.given()?.is_right)),
            predictions: matches!(ask.answer, Answer::Prediction(_)).then(|| PredictionCounts {
                made: predictions.made().len(),
                right: predictions.right(),
                is_over: predictions.is_over(),
            }),
        }),
        errors: errors.map(|it| LessonMistake { line: it.line, message: it.message.clone() }).collect(),
    })
}

pub(super) fn manual(state: &AppState) -> Manual {
    let place = state.manual.place();
    let found = state.manual.found().iter();
    Manual {
        page: place.map(|(page, _)| page),
        section: place.map(|(_, section)| section.to_owned()).unwrap_or_default(),
        query: state.manual.query().to_owned(),
        found: found.map(|it| format!("{}#{}", it.page, it.section)).collect(),
    }
}
