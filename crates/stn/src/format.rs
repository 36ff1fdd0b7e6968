//! The plain-text format of simple temporal networks that the CSTNU community uses.
//!
//! A file lists sections, each opened by a line that starts with `#`: the kind (`STN`), the number of time points, the
//! number of edges, the names, and the edges. An edge `X w Y` means `Y − X ≤ w`.

use std::collections::BTreeMap;
use std::fmt;

use crate::network::{Inconsistency, PointId, Stn};

/// A network as written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Document {
    /// The names of the time points; the first is the origin.
    pub names: Vec<String>,
    /// The edges, in textual order.
    pub edges: Vec<DocumentEdge>,
}

/// `to − from ≤ weight`
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DocumentEdge {
    /// Where the edge starts.
    pub from: PointId,
    /// Where it ends.
    pub to: PointId,
    /// Its weight.
    pub weight: i64,
}

/// What is wrong with a file, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParseError {
    /// The line, from 1.
    pub line: usize,
    /// What is wrong.
    pub message: String,
}

impl fmt::Display for ParseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.message)
    }
}

impl std::error::Error for ParseError {}

impl Document {
    /// The network, or the document's contradiction: the edges of a negative cycle are in [`Stn::cycle`], tagged with
    /// their positions in [`Document::edges`].
    pub fn to_stn(&self) -> (Stn, Result<(), Inconsistency>) {
        let mut stn = Stn::new(self.names.len());
        stn.reserve(self.edges.len());
        for (position, edge) in (0..).zip(&self.edges) {
            if let Err(inconsistency) = stn.insert(edge.from, edge.to, edge.weight, position) {
                return (stn, Err(inconsistency));
            }
        }
        (stn, Ok(()))
    }
}

/// Reads a file of the format.
pub fn parse(text: &str) -> Result<Document, ParseError> {
    let mut sections: Vec<Vec<(usize, &str)>> = Vec::new();
    for (line, content) in text.lines().enumerate().map(|(index, content)| (index + 1, content.trim())) {
        if content.starts_with('#') {
            sections.push(Vec::new());
        } else if !content.is_empty() {
            let Some(section) = sections.last_mut() else {
                return Err(ParseError {
                    line,
                    message: "expected a section, opened by a line with `#`".into(),
                });
            };
            section.push((line, content));
        }
    }
    let end = text.lines().count().max(1);
    let section = |index: usize, what: &str| {
        let missing = || ParseError { line: end, message: format!("expected a section with {what}") };
        sections.get(index).ok_or_else(missing)
    };
    let (line, kind) = single(section(0, "the kind of network")?, end)?;
    if kind != "STN" {
        return Err(ParseError { line, message: format!("only networks of kind STN are read, not {kind}") });
    }
    let num_points = count(section(1, "the number of time points")?, end)?;
    let num_edges = count(section(2, "the number of edges")?, end)?;
    let names = section(3, "the names of the time points")?;
    let edges = sections.get(4).map_or(&[][..], Vec::as_slice);
    let (names, by_name) = read_names(names, num_points, end)?;
    let edges = read_edges(edges, &by_name)?;
    if edges.len() != num_edges {
        let message = format!("{num_edges} edges are announced, but {} are listed", edges.len());
        return Err(ParseError { line: end, message });
    }
    Ok(Document { names, edges })
}

fn single<'a>(section: &[(usize, &'a str)], end: usize) -> Result<(usize, &'a str), ParseError> {
    match section {
        [only] => Ok(*only),
        [] => Err(ParseError { line: end, message: "a section is empty".into() }),
        [_, (line, _), ..] => Err(ParseError { line: *line, message: "expected the next section".into() }),
    }
}

fn count(section: &[(usize, &str)], end: usize) -> Result<usize, ParseError> {
    let (line, text) = single(section, end)?;
    text.parse().map_err(|_| ParseError { line, message: format!("expected a number, not {text}") })
}

type Names = (Vec<String>, BTreeMap<String, PointId>);

fn read_names(section: &[(usize, &str)], num_points: usize, end: usize) -> Result<Names, ParseError> {
    let mut names = Vec::new();
    let mut by_name = BTreeMap::new();
    for &(line, content) in section {
        for name in content.split_whitespace() {
            if by_name.insert(name.to_owned(), PointId(names.len() as u32)).is_some() {
                return Err(ParseError { line, message: format!("{name} is named twice") });
            }
            names.push(name.to_owned());
        }
    }
    if names.len() != num_points {
        let message = format!("{num_points} time points are announced, but {} are named", names.len());
        return Err(ParseError { line: section.last().map_or(end, |&(line, _)| line), message });
    }
    Ok((names, by_name))
}

fn read_edges(
    section: &[(usize, &str)],
    by_name: &BTreeMap<String, PointId>,
) -> Result<Vec<DocumentEdge>, ParseError> {
    let mut edges = Vec::new();
    for &(line, content) in section {
        let words: Vec<&str> = content.split_whitespace().collect();
        let [from, weight, to] = words[..] else {
            return Err(ParseError { line, message: "expected an edge: a name, a number, a name".into() });
        };
        let point = |name: &str| {
            let unknown = || ParseError { line, message: format!("{name} is not a time point") };
            by_name.get(name).copied().ok_or_else(unknown)
        };
        let not_a_weight = |_| ParseError { line, message: format!("expected a whole number, not {weight}") };
        edges.push(DocumentEdge {
            from: point(from)?,
            to: point(to)?,
            weight: weight.parse().map_err(not_a_weight)?,
        });
    }
    Ok(edges)
}
