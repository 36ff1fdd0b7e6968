//! Go to definition and find references.

use smol_str::SmolStr;

use crate::files::{Files, resolve};
use crate::parse::Parse;
use crate::span::Span;
use crate::syntax::SyntaxKind;

use super::name::{NameUse, name_at, names_in};

/// A place where a name is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reference {
    pub span: Span,
    /// Whether it is declared here.
    pub is_definition: bool,
}

/// Returns where the name at `offset` is declared; on a name that is declared there, that place itself.
pub fn definition(parse: &Parse, offset: u32) -> Option<Span> {
    if let Some(file) = imported_at(parse, offset) {
        return Some(file);
    }
    let name = name_at(parse, offset)?;
    references_of(parse, &name).into_iter().find(|place| place.is_definition).map(|place| place.span)
}

/// Returns where the file begins that is imported at `offset`.
fn imported_at(parse: &Parse, offset: u32) -> Option<Span> {
    let import = parse.declaration_at(offset)?.child(SyntaxKind::ImportDecl)?;
    let written = import.token(SyntaxKind::String).filter(|written| written.span.touches(offset))?;
    let files = Files::of(parse.text());
    let name = resolve(&files.at(written.span.start).name, written.text.trim_matches('"'))?;
    files.named(&name).map(|file| Span::new(file.start, file.start))
}

/// Every place of the name at `offset`, in textual order; for what is not declared, all its uses.
pub fn references(parse: &Parse, offset: u32) -> Vec<Reference> {
    name_at(parse, offset).map(|name| references_of(parse, &name)).unwrap_or_default()
}

pub(super) fn references_of(parse: &Parse, name: &NameUse) -> Vec<Reference> {
    let mut found = Vec::new();
    for root in parse.declarations() {
        let span = root.span();
        let is_concerned =
            if name.kind.is_local() { span == name.declaration } else { mentions(root.text(), &name.text) };
        if is_concerned {
            let here = names_in(parse, root).into_iter().filter(|other| is_same(name, other));
            found
                .extend(here.map(|other| Reference { span: other.span, is_definition: other.is_definition }));
        }
    }
    found
}

/// A quick look: most declarations do not hold the name at all.
fn mentions(text: &str, name: &SmolStr) -> bool {
    text.contains(name.as_str())
}

fn is_same(one: &NameUse, other: &NameUse) -> bool {
    one.text == other.text && one.kind == other.kind
}
