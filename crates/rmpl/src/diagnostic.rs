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

/// A change that fixes a diagnostic, offered to the author as a quick fix.
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
    pub code: Code,
    /// How grave it is.
    pub severity: Severity,
    /// The smallest span at fault.
    pub span: Span,
    /// What is wrong, in the author's terms.
    pub message: String,
    /// What would help, if something is known to.
    pub hint: Option<String>,
    /// Changes that fix it.
    pub fixes: Vec<Fix>,
    /// How many more of its severity there are after it, which no one lists.
    pub more: u32,
}

/// Of each severity, so many diagnostics of one text are listed; the last one says how many more there are.
pub const MAX_LISTED: usize = 500;

/// Characters of a word that are shown in messages: longer ones, such as names of a thousand letters, are cut.
const MAX_WORD_CHARS: usize = 80;

/// Characters of a message.
const MAX_MESSAGE_CHARS: usize = 1000;

impl Diagnostic {
    /// An error without hint or fixes.
    pub fn error(code: Code, span: Span, message: impl Into<String>) -> Self {
        let message = legible(message.into());
        Self { code, severity: Severity::Error, span, message, hint: None, fixes: Vec::new(), more: 0 }
    }

    /// A warning without hint or fixes.
    pub fn warning(code: Code, span: Span, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, span, message) }
    }

    /// Adds it to `known`, unless a diagnostic with the same code and span is there.
    pub fn add_once_to(self, known: &mut Vec<Self>) {
        if !known.iter().any(|other| other.span == self.span && other.code == self.code) {
            known.push(self);
        }
    }

    /// The same with a hint.
    pub fn with_hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(legible(hint.into()));
        self
    }

    /// The same with one more fix.
    pub fn with_fix(mut self, fix: Fix) -> Self {
        self.fixes.push(Fix { label: legible(fix.label), ..fix });
        self
    }

    /// The message, with how many more there are.
    pub fn full_message(&self) -> String {
        let what = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        };
        match self.more {
            0 => self.message.clone(),
            1 => format!("{}; and 1 more {what}", self.message),
            more => format!("{}; and {more} more {what}s", self.message),
        }
    }
}

/// At most [`MAX_LISTED`] of each severity, the first ones; the last of each says how many more there are.
pub fn listed(all: impl IntoIterator<Item = Diagnostic>) -> Vec<Diagnostic> {
    let mut listed = Listed::default();
    for found in all {
        listed.add(&found, 0);
    }
    listed.list
}

/// Diagnostics that are listed, and those that are only counted.
#[derive(Debug, Default)]
pub(crate) struct Listed {
    pub(crate) list: Vec<Diagnostic>,
    counts: [usize; 3],
    last: [usize; 3],
}

impl Listed {
    /// One more, moved by `offset`.
    pub(crate) fn add(&mut self, found: &Diagnostic, offset: u32) {
        let kind = found.severity as usize;
        if self.counts[kind] < MAX_LISTED {
            self.counts[kind] += 1;
            self.last[kind] = self.list.len();
            self.list.push(found.clone().moved(offset));
        } else if let Some(last) = self.list.get_mut(self.last[kind]) {
            last.more = last.more.saturating_add(1).saturating_add(found.more);
        }
    }
}

/// Returns what can be read: long words lose their middle, and a long message its end.
fn legible(text: String) -> String {
    if text.len() <= MAX_WORD_CHARS {
        return text;
    }
    let words = text.split_inclusive(char::is_whitespace);
    let is_long = |word: &str| word.chars().count() > MAX_WORD_CHARS;
    let mut told = String::with_capacity(text.len().min(2 * MAX_MESSAGE_CHARS));
    let mut count = 0;
    for word in words {
        let from = told.len();
        if is_long(word) {
            let end = word.char_indices().rev().nth(MAX_WORD_CHARS / 4 - 1).map_or(0, |(at, _)| at);
            told.extend(word.chars().take(MAX_WORD_CHARS / 2).chain(['…']));
            told.push_str(&word[end..]);
        } else {
            told.push_str(word);
        }
        count += told[from..].chars().count();
        if count > MAX_MESSAGE_CHARS {
            told.push('…');
            break;
        }
    }
    told
}

/// The first of `names`, and how many more there are.
pub(crate) fn some_of(names: &[&str]) -> String {
    const SHOWN: usize = 20;
    let shown = names.get(..SHOWN).unwrap_or(names).join(", ");
    match names.len().saturating_sub(SHOWN) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// The diagnostics that have been given: what is compiled several times is told once.
#[derive(Debug, Default)]
pub(crate) struct Known(FxHashSet<(Code, Span, String)>);

impl Known {
    /// Returns whether nothing of the kind has been said at this place, which from now on it has.
    pub(crate) fn is_new(&mut self, found: &Diagnostic) -> bool {
        self.0.insert((found.code, found.span, found.message.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(count: usize, severity: Severity) -> impl Iterator<Item = Diagnostic> {
        let code = Code("X-TEST");
        (0..count).map(move |at| Diagnostic {
            severity,
            ..Diagnostic::error(code, Span::new(at as u32, at as u32 + 1), format!("number {at}"))
        })
    }

    #[test]
    fn what_is_not_listed_is_counted_once_however_often_lists_are_joined() {
        let first = listed(told(700, Severity::Warning).chain(told(3, Severity::Error)));
        assert_eq!(first.len(), MAX_LISTED + 3);
        assert_eq!(first[MAX_LISTED - 1].more, 200);
        assert_eq!(first[MAX_LISTED - 1].full_message(), "number 499; and 200 more warnings");
        let joined = listed(first.into_iter().chain(listed(told(700, Severity::Warning))));
        let sum: usize = joined.iter().map(|found| 1 + found.more as usize).sum();
        assert_eq!((joined.len(), sum), (MAX_LISTED + 3, 1403));
    }

    #[test]
    fn long_names_and_long_messages_are_cut() {
        let name = "a".repeat(70_000);
        let found = Diagnostic::error(Code("X"), Span::default(), format!("no `{name}` is declared"));
        assert!(found.message.chars().count() < 100, "{}", found.message);
        assert!(found.message.ends_with("aaa` is declared"), "{}", found.message);
        let many = found.with_hint("one of A, B, ".repeat(10_000)).hint.unwrap_or_default();
        assert!(many.chars().count() < MAX_MESSAGE_CHARS + 100);
        let short = Diagnostic::error(Code("X"), Span::default(), "as it is,  with its blanks ".repeat(5));
        assert_eq!(short.message, "as it is,  with its blanks ".repeat(5));
    }
}
