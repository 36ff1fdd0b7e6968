//! A diagnostic as data that crosses threads, files and the page's API, with its line and column.

use rmpl::files::Files;
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
    /// The smallest span at fault, in the whole text.
    pub span: Span,
    /// The file that it is in; `None` for the mission's first one.
    #[serde(default)]
    pub file: Option<SmolStr>,
    /// Where that file's text begins in the whole text.
    #[serde(default)]
    pub file_start: u32,
    /// The line of the span's start in its file, from 1.
    pub line: u32,
    /// Its column in characters, from 1.
    pub column: u32,
    /// What would help.
    pub hint: Option<String>,
    /// Changes of the text that fix it.
    pub fixes: Vec<TextFix>,
    /// How many more of its severity there are, which are not listed.
    #[serde(default)]
    pub more: u32,
}

/// A change that fixes a problem.
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
    pub fn new(diagnostic: &Diagnostic, text: &str, lines: &LineIndex, files: &Files) -> Self {
        let place = files.line_column(text, lines, diagnostic.span.start);
        let file = files.at(diagnostic.span.start);
        Self {
            code: SmolStr::new(diagnostic.code.0),
            severity: diagnostic.severity,
            message: diagnostic.full_message(),
            span: diagnostic.span,
            file: (file.start > 0).then(|| SmolStr::new(&file.name)),
            file_start: file.start,
            line: place.line,
            column: place.column,
            hint: diagnostic.hint.clone(),
            fixes: diagnostic
                .fixes
                .iter()
                .map(|fix| TextFix { label: fix.label.clone(), edits: fix.edits.clone() })
                .collect(),
            more: diagnostic.more,
        }
    }

    /// All of `diagnostics`, in textual order, as far as they are listed.
    pub fn all(diagnostics: &[Diagnostic], text: &str) -> Vec<Self> {
        let (lines, files) = (LineIndex::new(text), Files::of(text));
        let mut sorted: Vec<&Diagnostic> = diagnostics.iter().collect();
        sorted.sort_by_key(|found| (found.span, found.severity));
        let listed = rmpl::listed(sorted.into_iter().cloned());
        listed.iter().map(|found| Self::new(found, text, &lines, &files)).collect()
    }

    /// The span in the text of its own file.
    pub const fn span_in_file(&self) -> Span {
        let start = self.file_start;
        Span::new(self.span.start.saturating_sub(start), self.span.end.saturating_sub(start))
    }
}
