//! The head of a lesson: what its mission is, and how it is planned.

use kirk::Search as SearchKind;
use markdown::Head;

use super::{Expectation, Lesson, LessonError, LessonMission, LessonSearch, entries};
use crate::mission_file;

/// Reads the head into the lesson. Returns whether it names a mission.
pub(super) fn read(lesson: &mut Lesson, head: Option<&Head>, errors: &mut Vec<LessonError>) -> bool {
    let Some(head) = head else { return false };
    let mut has_mission = false;
    let mut others = Vec::new();
    let entries = entries(&head.text, head.line, |line, text| others.push((line, text)));
    for (line, text) in others {
        errors.push(LessonError::new(
            line,
            format!("expected a line of the form `key: value`, found `{text}`"),
        ));
    }
    for (line, key, value) in entries {
        match key {
            "about" => lesson.about = value,
            "mission" => {
                has_mission = true;
                match mission_file::example(&value) {
                    Some(example) => lesson.mission = LessonMission::Example(example.name),
                    None => errors.push(LessonError::new(line, format!("unknown example `{value}`"))),
                }
            }
            "search" => {
                if let Some(search) = search(&value) {
                    lesson.search = search;
                } else {
                    let message =
                        "`search` must be `chronological`, `conflict-directed`, `best-first` or `both`";
                    errors.push(LessonError::new(line, message));
                }
            }
            "expects" => {
                if let Some(expects) = expectation(&value) {
                    lesson.expects = expects;
                } else {
                    let message = "`expects` must be `plan`, `no plan`, `errors` or `program`";
                    errors.push(LessonError::new(line, message));
                }
            }
            other => {
                let message = format!(
                    "unknown key `{other}` in the head of a lesson; use `about`, `mission`, `search` or `expects`"
                );
                errors.push(LessonError::new(line, message));
            }
        }
    }
    has_mission
}

fn search(value: &str) -> Option<LessonSearch> {
    if value == "both" {
        return Some(LessonSearch::Both);
    }
    SearchKind::ALL.into_iter().find(|kind| kind.name() == value).map(LessonSearch::One)
}

fn expectation(value: &str) -> Option<Expectation> {
    match value {
        "plan" => Some(Expectation::Plan),
        "no plan" => Some(Expectation::NoPlan),
        "errors" => Some(Expectation::Errors),
        "program" => Some(Expectation::Program),
        _ => None,
    }
}
