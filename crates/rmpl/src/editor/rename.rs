//! Renaming a name everywhere it stands.

use std::fmt;

use crate::diagnostic::Edit;
use crate::parse::Parse;
use crate::span::Span;
use crate::syntax::SyntaxKind;

use super::definition::references_of;
use super::name::{NameKind, NameUse, name_at, names_in};

/// Why a name cannot be changed as asked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RenameProblem {
    /// There is no name at the place.
    NothingHere,
    /// The name belongs to the language: an option, a vehicle model, or a value of an option.
    Fixed,
    /// The new name is not a name: it needs letters, digits, `_` and single hyphens, and begins with a letter or `_`.
    NoName,
    /// The new name is a word of the language.
    Keyword,
    /// The new name has a hyphen and is used in bounds, where a hyphen is minus.
    HyphenInBounds,
    /// Something of the same kind has the new name already.
    Taken,
}

impl fmt::Display for RenameProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NothingHere => "nothing to rename at the cursor",
            Self::Fixed => "names that belong to the language cannot be renamed",
            Self::NoName => {
                "a name must start with a letter and may contain letters, digits, `_` and single hyphens"
            }
            Self::Keyword => "this is a reserved word",
            Self::HyphenInBounds => "a name used in bounds cannot contain hyphens, which mean minus there",
            Self::Taken => "this name is already in use",
        })
    }
}

impl std::error::Error for RenameProblem {}

/// The name at `offset` that [`rename`] would change: where it stands and what it is.
pub fn prepare_rename(parse: &Parse, offset: u32) -> Result<(Span, String), RenameProblem> {
    let name = name_at(parse, offset).ok_or(RenameProblem::NothingHere)?;
    match name.kind {
        // The built-in models are declared nowhere.
        NameKind::Model if references_of(parse, &name).iter().any(|place| place.is_definition) => {
            Ok((name.span, name.text.to_string()))
        }
        NameKind::Model | NameKind::Option | NameKind::OptionValue => Err(RenameProblem::Fixed),
        _ => Ok((name.span, name.text.to_string())),
    }
}

/// The edits that give the name at `offset` the name `new_name` everywhere, in textual order.
pub fn rename(parse: &Parse, offset: u32, new_name: &str) -> Result<Vec<Edit>, RenameProblem> {
    prepare_rename(parse, offset)?;
    let name = name_at(parse, offset).ok_or(RenameProblem::NothingHere)?;
    check(&name, new_name)?;
    if new_name != name.text && is_taken(parse, &name, new_name) {
        return Err(RenameProblem::Taken);
    }
    let places = references_of(parse, &name).into_iter();
    Ok(places.map(|place| Edit { span: place.span, text: new_name.to_owned() }).collect())
}

fn check(name: &NameUse, new_name: &str) -> Result<(), RenameProblem> {
    let parts_are_words = new_name.split('-').all(|part| {
        !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
    });
    if !parts_are_words || new_name.starts_with(|letter: char| letter.is_ascii_digit()) {
        return Err(RenameProblem::NoName);
    }
    if SyntaxKind::keyword(new_name).is_some() {
        return Err(RenameProblem::Keyword);
    }
    if name.kind == NameKind::BoundName && new_name.contains('-') {
        return Err(RenameProblem::HyphenInBounds);
    }
    Ok(())
}

fn is_taken(parse: &Parse, name: &NameUse, new_name: &str) -> bool {
    let in_scope = |name: &NameUse, other: &NameUse| match &name.kind {
        NameKind::Parameter | NameKind::BoundName => other.kind.is_local(),
        kind => other.kind == *kind && (other.is_definition || *kind == NameKind::Variable),
    };
    parse
        .declarations()
        .filter(|root| !name.kind.is_local() || root.span() == name.declaration)
        .filter(|root| root.text().contains(new_name))
        .flat_map(|root| names_in(parse, root))
        .any(|other| other.text == new_name && in_scope(name, &other))
}
