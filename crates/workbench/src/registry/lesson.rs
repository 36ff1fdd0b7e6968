//! Lessons, read with what they say of commands.

use crate::lesson::{Lesson, LessonError};
use crate::registry::by_id;

/// Reads a lesson, with what is wrong in it by line, commands that do not exist included.
pub fn read_lesson(name: &str, text: &str) -> (Lesson, Vec<LessonError>) {
    let (lesson, mut errors) = Lesson::read(name, text);
    let unknown = lesson.commands().filter(|(_, id)| by_id(id).is_none());
    errors.extend(unknown.map(|(line, id)| LessonError::new(line, format!("unknown command {id}"))));
    errors.sort();
    (lesson, errors)
}
