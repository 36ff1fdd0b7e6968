//! What a kind of diagnostic means, for readers: `enroute explain E-BOUNDS` and the problem list show it.

use crate::diagnostic::{Code, Severity};

/// The manual page of one kind of diagnostic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Explanation {
    pub code: Code,
    /// How grave it is; `E-` codes are errors, `W-` codes warnings.
    pub severity: Severity,
    /// What is wrong, in a few words.
    pub title: &'static str,
    /// What it means and why it matters, in Markdown paragraphs.
    pub meaning: &'static str,
    /// A mission text that has exactly this one problem.
    pub example: &'static str,
    /// What to do about it.
    pub fix: &'static str,
    /// The example, fixed.
    pub mended: &'static str,
}

impl Explanation {
    /// The page as Markdown.
    pub fn markdown(&self) -> String {
        format!(
            "# {}: {}\n\n{}\n\n## Example\n\n```rmpl\n{}\n```\n\n## What to do\n\n{}\n\n```rmpl\n{}\n```\n",
            self.code,
            self.title,
            self.meaning,
            self.example.trim(),
            self.fix,
            self.mended.trim()
        )
    }
}
