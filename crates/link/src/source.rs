//! The text of a request, and how it came from one that the core has.

use std::ops::Deref;
use std::sync::Arc;

use rmpl::{Edit, Shift};
use serde::{Deserialize, Serialize};

/// A text that the core is to compute with. Its bytes are only what tells it from others: the text itself, or the edits
/// that lead to it, travels beside the request ([`crate::wire`]).
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    print: Print,
    #[serde(skip)]
    text: Arc<str>,
    /// How it was reached, if that is known.
    #[serde(skip)]
    pub since: Option<Since>,
}

/// What tells a text from others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Print {
    bytes: u32,
    crc: u32,
}

/// The edits that led to a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Since {
    /// The revision that they were made to.
    pub revision: u64,
    /// In order, each of the text that those before it left.
    pub edits: Vec<Edit>,
}

impl Print {
    fn of(text: &str) -> Self {
        Self { bytes: text.len() as u32, crc: crc32fast::hash(text.as_bytes()) }
    }
}

impl Source {
    /// A text that was reached by edits of an earlier one, if these are known.
    pub fn edited(text: impl Into<Arc<str>>, since: Option<Since>) -> Self {
        let text = text.into();
        Self { print: Print::of(&text), text, since }
    }

    /// The text, shared.
    pub const fn text(&self) -> &Arc<str> {
        &self.text
    }

    /// Returns whether this is its text.
    pub(crate) fn is(&self, text: &str) -> bool {
        self.print == Print::of(text)
    }

    /// Holds its text, which has come beside it.
    pub(crate) fn hold(&mut self, text: Arc<str>, since: Option<Since>) {
        (self.text, self.since) = (text, since);
    }

    /// Returns how it came from the text of a revision, if that is known.
    pub fn shift_from(&self, revision: Option<u64>) -> Option<Shift> {
        let since = self.since.as_ref().filter(|since| Some(since.revision) == revision)?;
        Some(Shift::of(&since.edits))
    }
}

impl<T: Into<Arc<str>>> From<T> for Source {
    fn from(text: T) -> Self {
        Self::edited(text, None)
    }
}

impl Deref for Source {
    type Target = str;

    fn deref(&self) -> &str {
        &self.text
    }
}
