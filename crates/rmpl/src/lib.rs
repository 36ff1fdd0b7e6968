//! The Reactive Model-based Programming Language: trees, names, diagnostics and editor queries, for both notations.
//!
//! Parsing never fails: every stage returns a result and its diagnostics. Nothing here knows of networks or plans.

mod analysis;
pub mod call_cycles;
pub mod control;
mod copies;
pub mod diagnostic;
pub mod diagnostics;
pub mod editor;
mod edits;
pub mod explanation;
pub mod files;
pub mod fleet;
pub mod format;
mod lower;
pub mod parse;
mod parser;
pub mod program;
pub mod rule;
pub mod span;
pub mod spans;
pub mod syntax;

pub use diagnostic::{Code, Diagnostic, Edit, Fix, MAX_LISTED, Severity, listed};
pub use diagnostics::explain;
pub use edits::{Journal, Shift};
pub use explanation::Explanation;
pub use format::format;
pub use parse::{Parse, parse};
pub use span::{LineColumn, LineIndex, Span};
