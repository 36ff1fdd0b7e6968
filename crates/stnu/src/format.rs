//! Files of networks: the plain text of the CSTNU community, and the `GraphML` of the CSTNU Tool.

mod graphml;
mod plain;

use std::fmt;

use exact::{Bound, Scale, Time};

use crate::network::{Link, Network, PointId};

/// A network with the names of its time points.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Document {
    /// The names, by time point; the first is the origin.
    pub names: Vec<String>,
    /// What they are names in.
    pub network: Network,
    /// How many of the network's ticks are one unit of the file: more than one where it has decimals.
    pub scale: Scale,
    /// Whether times were rounded to that scale, for they have none in common within 64 bits. What is controllable then
    /// is so in the file's times, too.
    pub is_rounded: bool,
}

const BILLIONTHS: Scale = Scale::of(1_000_000_000);

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

/// A file's network before it is known how fine its times are.
#[derive(Default)]
struct Draft {
    names: Vec<String>,
    edges: Vec<DraftEdge>,
    links: Vec<DraftLink>,
}

struct DraftEdge {
    line: usize,
    from: PointId,
    to: PointId,
    /// An infinite one constrains nothing.
    weight: Bound,
}

struct DraftLink {
    line: usize,
    activation: PointId,
    end: PointId,
    lower: Time,
    upper: Time,
}

impl Draft {
    /// The network in the coarsest ticks that count all its times; where sums of them may leave 64 bits, in billionths, with every constraint rounded to the tighter side and every link to the wider one.
    fn finish(self) -> Result<Document, ParseError> {
        let (scale, is_rounded) = match Scale::common(self.times()) {
            Ok(scale) if self.fits(scale) => (scale, false),
            _ => (BILLIONTHS, true),
        };
        let too_large = |line| ParseError::new(line, "a time is too large to represent exactly");
        let mut network = Network::new(self.names.len());
        for DraftEdge { line, from, to, weight } in self.edges {
            if let Some(weight) = weight.finite() {
                network.add_edge(from, to, scale.floor_tick(weight).ok_or_else(|| too_large(line))?);
            }
        }
        for DraftLink { line, activation, end, lower, upper } in self.links {
            let lower = scale.floor_tick(lower).ok_or_else(|| too_large(line))?;
            let upper = scale.ceiling_tick(upper).ok_or_else(|| too_large(line))?;
            let link = Link { activation, end, lower, upper };
            network.add_link(link).map_err(|error| ParseError::new(line, error.to_string()))?;
        }
        Ok(Document { names: self.names, network, scale, is_rounded })
    }

    /// Returns whether whatever is summed along paths stays within 64 bits.
    fn fits(&self, scale: Scale) -> bool {
        scale == Scale::UNITS
            || self
                .times()
                .try_fold(0_u64, |sum, time| sum.checked_add(scale.ticks(time).ok()?.unsigned_abs()))
                .is_some_and(|sum| sum < i64::MAX as u64 / 4)
    }

    fn times(&self) -> impl Iterator<Item = Time> {
        let weights = self.edges.iter().filter_map(|edge| edge.weight.finite());
        weights.chain(self.links.iter().flat_map(|link| [link.lower, link.upper]))
    }
}

/// A time of a file: exact, with decimals.
fn time(line: usize, text: &str) -> Result<Time, ParseError> {
    text.trim().parse().map_err(|error: exact::ReadError| ParseError::new(line, error.to_string()))
}

/// The weight of an edge: a time, or infinity.
fn weight(line: usize, text: &str) -> Result<Bound, ParseError> {
    text.trim().parse().map_err(|error: exact::ReadError| ParseError::new(line, error.to_string()))
}

/// How a file is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// Sections that start with `#`.
    Plain,
    GraphMl,
}

impl Document {
    /// Returns whether a text is to be read here rather than as a plain STN: it is `GraphML`, or its kind is `STNU`.
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

    /// A number of the network's ticks in the file's units.
    pub fn time(&self, ticks: i64) -> Time {
        self.scale.time(ticks)
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
