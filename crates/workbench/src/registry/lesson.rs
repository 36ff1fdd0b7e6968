//! Lessons, read with what they say of commands, and the commands that they may run.
//!
//! A lesson is a file that anyone may have written, so it runs only commands that show, step, and try: none that signs, trusts
//! a key, opens or saves a file, or changes the library or the settings.

use serde_json::Value;

use crate::command::Command;
use crate::host::RemoteError;
use crate::lesson::{Lesson, LessonError};
use crate::registry::{by_id, from_json};
use crate::state::AppState;

/// Groups of commands that lessons may run, and single commands.
const ALLOWED: [&str; 13] = [
    "draw.",
    "execute.",
    "go.",
    "plan.",
    "play.",
    "program.",
    "review.run",
    "search.",
    "strategy.",
    "terrain.",
    "view.fit",
    "view.panel",
    "view.workspace",
];

/// Those of these groups that open or save files, or change the text at the next click.
const REFUSED: [&str; 8] = [
    "execute.save",
    "execute.replay",
    "terrain.video",
    "terrain.location",
    "terrain.circle",
    "terrain.polygon",
    "terrain.wall",
    "terrain.vehicle",
];

fn is_allowed(id: &str) -> bool {
    let is_named = |name: &&str| if name.ends_with('.') { id.starts_with(*name) } else { id == *name };
    ALLOWED.iter().any(is_named) && !REFUSED.contains(&id)
}

/// Reads a lesson, with what is wrong in it by line, commands that it may not run included.
pub fn read_lesson(name: &str, text: &str) -> (Lesson, Vec<LessonError>) {
    let (lesson, mut errors) = Lesson::read(name, text);
    let wrong = lesson.commands().filter_map(|(line, id)| {
        let what = match by_id(id) {
            None => format!("unknown command {id}"),
            Some(_) if !is_allowed(id) => format!("a lesson may not run {id}"),
            Some(_) => return None,
        };
        Some(LessonError::new(line, what))
    });
    errors.extend(wrong);
    errors.sort();
    (lesson, errors)
}

/// The command of this name with these arguments, for a lesson.
pub fn command_of_lesson(state: &AppState, id: &str, arguments: &Value) -> Result<Command, RemoteError> {
    if by_id(id).is_some() && !is_allowed(id) {
        let reason = "a lesson may not run it".to_owned();
        return Err(RemoteError::Unavailable { command: id.to_owned(), reason });
    }
    from_json(state, id, arguments)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::all_commands;

    #[test]
    fn lessons_run_nothing_that_signs_or_saves() {
        for (id, allowed) in [
            ("review.run", true),
            ("program.know", true),
            ("plan.pin", true),
            ("review.trust", false),
            ("review.removeKey", false),
            ("review.approve", false),
            ("file.save", false),
            ("export.csv", false),
            ("edit.setSource", false),
            ("execute.replay", false),
            ("terrain.wall", false),
            ("execute.save", false),
            ("view.saveLayout", false),
        ] {
            assert!(by_id(id).is_some(), "{id}");
            assert_eq!(is_allowed(id), allowed, "{id}");
        }
        for spec in all_commands().filter(|spec| spec.id.starts_with("review.")) {
            assert_eq!(is_allowed(spec.id), spec.id == "review.run", "{}", spec.id);
        }
    }
}
