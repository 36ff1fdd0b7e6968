//! What the front end tells an author: a code, a severity, a place, a message and help (SPEC 1.7).

use std::fmt;

use rustc_hash::FxHashSet;
use serde::{Deserialize, Serialize};

use crate::span::Span;

/// How grave a diagnostic is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The mission cannot be compiled as written.
    Error,
    /// The mission compiles, but probably does not say what the author means.
    Warning,
    /// Worth knowing.
    Note,
}

/// The stable name of a kind of diagnostic, such as `E-BOUNDS`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Code(pub &'static str);

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }
}

/// A replacement of the text in `span` by `text`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Edit {
    /// What is replaced; empty for an insertion.
    pub span: Span,
    /// What it becomes.
    pub text: String,
}

/// A change that mends a diagnostic, offered to the author as a quick fix.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fix {
    /// What the change does, as an imperative.
    pub label: String,
    /// The edits, disjoint and in textual order.
    pub edits: Vec<Edit>,
}

/// One thing to tell the author about one place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// The kind.
    pub code: Code,
    /// How grave it is.
    pub severity: Severity,
    /// The smallest span at fault.
    pub span: Span,
    /// What is wrong, in the author's terms.
    pub message: String,
    /// What would help, if something is known to.
    pub hint: Option<String>,
    /// Changes that mend it.
    pub fixes: Vec<Fix>,
}

impl Diagnostic {
    /// An error without hint or fixes.
    pub fn error(code: Code, span: Span, message: impl Into<String>) -> Self {
        Self { code, severity: Severity::Error, span, message: message.into(), hint: None, fixes: Vec::new() }
    }

    /// A warning without hint or fixes.
    pub fn warning(code: Code, span: Span, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, span, message) }
    }

    /// The same with a hint.
    pub fn with_hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// The same with one more fix.
    pub fn with_fix(mut self, fix: Fix) -> Self {
        self.fixes.push(fix);
        self
    }
}

/// The diagnostics that have been given: what is compiled several times is told once.
#[derive(Debug, Default)]
pub(crate) struct Known(FxHashSet<(Code, Span, String)>);

impl Known {
    /// Whether nothing of the kind has been said at this place, which from now on it has.
    pub(crate) fn is_new(&mut self, found: &Diagnostic) -> bool {
        self.0.insert((found.code, found.span, found.message.clone()))
    }
}
