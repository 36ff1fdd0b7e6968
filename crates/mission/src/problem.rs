//! A diagnostic as data that crosses threads, files and the page's API, with its line and column.

use rmpl::{Diagnostic, LineIndex, Severity, Span};
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

/// One thing to tell the author about one place of the text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Problem {
    /// The stable code, such as `E-BOUNDS`.
    pub code: SmolStr,
    /// How grave it is.
    pub severity: Severity,
    /// What is wrong, in the author's terms.
    pub message: String,
    /// The smallest span at fault.
    pub span: Span,
    /// The line of the span's start, from 1.
    pub line: u32,
    /// Its column in characters, from 1.
    pub column: u32,
    /// What would help.
    pub hint: Option<String>,
    /// Changes of the text that mend it.
    pub fixes: Vec<TextFix>,
}

/// A change that mends a problem.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TextFix {
    /// What it does, as an imperative.
    pub label: String,
    /// Disjoint edits in textual order.
    pub edits: Vec<TextEdit>,
}

/// A replacement of part of the text.
pub type TextEdit = rmpl::Edit;

impl Problem {
    /// The diagnostic, placed in the text it is about.
    pub fn new(diagnostic: &Diagnostic, text: &str, lines: &LineIndex) -> Self {
        let place = lines.line_column(text, diagnostic.span.start);
        Self {
            code: SmolStr::new(diagnostic.code.0),
            severity: diagnostic.severity,
            message: diagnostic.message.clone(),
            span: diagnostic.span,
            line: place.line,
            column: place.column,
            hint: diagnostic.hint.clone(),
            fixes: diagnostic
                .fixes
                .iter()
                .map(|fix| TextFix { label: fix.label.clone(), edits: fix.edits.clone() })
                .collect(),
        }
    }

    /// All of `diagnostics`, in textual order.
    pub fn all(diagnostics: &[Diagnostic], text: &str) -> Vec<Self> {
        let lines = LineIndex::new(text);
        let mut problems: Vec<Self> =
            diagnostics.iter().map(|found| Self::new(found, text, &lines)).collect();
        problems.sort_by_key(|problem| (problem.span, problem.severity));
        problems
    }
}
