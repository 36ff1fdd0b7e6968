//! What a mission text means as a whole: names, their uses, and the diagnostics that follow from them.
//!
//! Each declaration is summarized once, when it is parsed; the index counts what all summaries declare and use; a
//! declaration is checked again only when something that it mentions has changed.

mod alike;
mod check;
mod collect;
pub(crate) mod constant;
mod index;
mod literal;
pub(crate) mod local;
mod names;
mod recursion;
mod structure;
mod summary;

pub(crate) use alike::edit_distance_at_most;
pub(crate) use check::{Checked, Meaning, check};
pub(crate) use collect::summarize;
pub(crate) use index::{DeclarationKey, Index, Namespace};
pub(crate) use names::{Names, Symbol};
pub(crate) use recursion::recursion;
pub(crate) use summary::{Call, Definition, Literal, Origin, Summary, UseKind};
