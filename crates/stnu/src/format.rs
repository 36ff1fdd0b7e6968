//! Files of networks: the plain text of the CSTNU community, and the `GraphML` of the CSTNU Tool.

mod graphml;
mod plain;

use std::fmt;

use crate::network::{Network, PointId};

/// A network with the names of its time points.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Document {
    /// The names, by time point; the first is the origin.
    pub names: Vec<String>,
    /// What they are names in.
    pub network: Network,
}

/// What is wrong with a file, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParseError {
    /// The line, from 1.
    pub line: usize,
    /// What is wrong.
    pub message: String,
}

impl ParseError {
    fn new(line: usize, message: impl Into<String>) -> Self {
        Self { line, message: message.into() }
    }
}

impl fmt::Display for ParseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.message)
    }
}

impl std::error::Error for ParseError {}

/// How a file is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// Sections that start with `#`.
    Plain,
    /// XML.
    GraphMl,
}

impl Document {
    /// Whether a text is to be read here rather than as a plain STN: it is `GraphML`, or its kind is `STNU`.
    pub fn is_uncertain(text: &str) -> bool {
        let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
        Layout::of(text) == Layout::GraphMl
            || lines.next().is_some_and(|kind| kind.eq_ignore_ascii_case("STNU"))
    }

    /// Reads a file in either layout: `GraphML` begins with `<`.
    pub fn parse(text: &str) -> Result<Self, ParseError> {
        match Layout::of(text) {
            Layout::Plain => plain::parse(text),
            Layout::GraphMl => graphml::parse(text),
        }
    }

    /// The file's text.
    pub fn write(&self, layout: Layout) -> String {
        match layout {
            Layout::Plain => plain::write(self),
            Layout::GraphMl => graphml::write(self),
        }
    }

    /// The name of a time point.
    pub fn name(&self, point: PointId) -> &str {
        &self.names[point.index()]
    }
}

impl Layout {
    /// The layout that a text must be in.
    pub fn of(text: &str) -> Self {
        if text.trim_start_matches('\u{feff}').trim_start().starts_with('<') {
            Self::GraphMl
        } else {
            Self::Plain
        }
    }
}
