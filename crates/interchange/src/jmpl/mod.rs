//! JMPL, the language of Livingstone's models: classes of components as a plant model in the prefix notation.
//!
//! Attributes become variables, commands or parts, and relations are written out where they are called. What cannot be
//! meant is left out and listed; what may be meant otherwise is remarked.

mod error;
mod evaluate;
mod formula;
mod harness;
mod lexer;
mod parser;
mod syntax;
mod write;

use crate::Translation;

pub use error::JmplError;

/// A file by its name and its text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SourceFile {
    pub name: String,
    pub text: String,
}

/// Returns whether a file is JMPL, or one of the files beside it, by the end of its name.
pub fn is_jmpl(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    [".jmpl", ".hrn", ".ini"].iter().any(|end| name.ends_with(end))
}

/// Reads the classes of `files` as a plant model, with what they need from `library`. Each of their classes that is not a
/// part of another one gets a component. A harness and initial modes may be among `files`.
pub fn translate(files: &[SourceFile], library: &[SourceFile]) -> Result<Translation, JmplError> {
    let mut harness = harness::Harness::default();
    let (mut names, mut parsed, mut unread) = (Vec::new(), Vec::new(), Vec::new());
    for file in files {
        if harness::is_harness(&file.text) {
            harness.read(&file.name, &file.text)?;
        } else {
            parsed.push(parser::parse(&file.text, &file.name, parsed.len())?);
            names.push(file.name.as_str());
        }
    }
    let asked = parsed.len();
    for file in library {
        match parser::parse(&file.text, &file.name, parsed.len()) {
            Ok(file) => parsed.push(file),
            Err(error) => {
                unread.push(error.to_string());
                continue;
            }
        }
        names.push(file.name.as_str());
    }
    if parsed.iter().take(asked).all(|file| file.classes.is_empty()) {
        let name = files.first().map_or("the file", |file| &file.name);
        return Err(JmplError::NoClass { file: name.to_owned() });
    }
    write::Writer::new(&names, &parsed, asked, &harness, unread).write()
}

#[cfg(test)]
mod tests;
