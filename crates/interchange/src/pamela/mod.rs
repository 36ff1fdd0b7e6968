//! Pamela: the methods of classes as a mission, or their modes and transitions as a plant model.
//!
//! A file in which a method has a body is a mission; one with transitions and without such a method is a plant model.
//! A method with a body becomes an activity, or a scenario if no other method calls it; a primitive method becomes a primitive.
//! Fields and modes that conditions mention become states. What a mission cannot mean is left out and listed.

mod classes;
mod instances;
mod mission;
mod names;
mod plant;
mod tree;

use crate::Translation;

/// Why a file cannot become a mission: it is not Pamela, or not well formed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}, line {line}: {what}")]
pub struct PamelaError {
    pub file: String,
    pub line: u32,
    pub what: String,
}

/// Returns whether a file is Pamela, by the end of its name.
pub fn is_pamela(name: &str) -> bool {
    name.to_ascii_lowercase().ends_with(".pamela")
}

/// Reads a file as a mission or a plant model.
pub fn translate(name: &str, text: &str) -> Result<Translation, PamelaError> {
    let trees = tree::Tree::read(text, name)?;
    let classes = classes::read(&trees, name)?;
    if classes.is_empty() {
        let what = "the file has no classes".to_owned();
        return Err(PamelaError { file: name.to_owned(), line: 1, what });
    }
    let classes = classes::merged(&classes);
    let has_body = classes.iter().flat_map(|class| &class.methods).any(|method| method.body.is_some());
    if !has_body && classes.iter().any(|class| !class.transitions.is_empty()) {
        return Ok(plant::Writer::new(&classes, name).write());
    }
    let instances = instances::Instances::new(&classes, name)?;
    Ok(mission::Writer::new(&instances, name).write())
}

#[cfg(test)]
mod tests;
