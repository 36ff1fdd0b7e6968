//! The plain layout: sections, each opened by a line that starts with `#`, in this order: the kind (`STNU`), the numbers
//! of time points, ordinary edges and contingent links, the names, the edges, the links. An edge `u w v` means
//! `v − u ≤ w`; a link `A x y C` lasts from x to y after A.

use std::collections::BTreeMap;

use super::{Document, Draft, DraftEdge, DraftLink, ParseError, time, weight};
use crate::network::PointId;

type Section<'a> = Vec<(usize, &'a str)>;

pub(super) fn parse(text: &str) -> Result<Document, ParseError> {
    let sections = sections(text)?;
    let end = text.lines().count().max(1);
    let section = |index: usize, what: &str| {
        sections.get(index).ok_or_else(|| ParseError::new(end, format!("expected a section with {what}")))
    };
    let (line, kind) = single(section(0, "the kind of network")?, end)?;
    let has_links = match kind.to_ascii_uppercase().as_str() {
        "STN" => false,
        "STNU" => true,
        _ => {
            return Err(ParseError::new(
                line,
                format!("only networks of type STN or STNU are supported, not {kind}"),
            ));
        }
    };
    let num_points = count(section(1, "the number of time points")?, end)?;
    let num_edges = count(section(2, "the number of ordinary edges")?, end)?;
    let num_links = if has_links { count(section(3, "the number of contingent links")?, end)? } else { 0 };
    let at = if has_links { 4 } else { 3 };
    let names = section(at, "the names of the time points")?;
    let (names, by_name) = read_names(names, num_points, end)?;
    let (mut edges, mut links) = (Vec::new(), Vec::new());
    let rest = |index: usize| sections.get(index).map_or(&[][..], Vec::as_slice);
    for &(line, content) in rest(at + 1) {
        let words: Vec<&str> = content.split_whitespace().collect();
        let [from, bound, to] = words[..] else {
            return Err(ParseError::new(line, "expected an edge: a name, a number, a name"));
        };
        let (from, to) = (point(&by_name, line, from)?, point(&by_name, line, to)?);
        edges.push(DraftEdge { line, from, to, weight: weight(line, bound)? });
    }
    announced(num_edges, "edges", edges.len(), end)?;
    for &(line, content) in rest(at + 2) {
        let words: Vec<&str> = content.split_whitespace().collect();
        let [activation, lower, upper, ending] = words[..] else {
            return Err(ParseError::new(line, "expected a contingent link: a name, two numbers, a name"));
        };
        links.push(DraftLink {
            line,
            activation: point(&by_name, line, activation)?,
            end: point(&by_name, line, ending)?,
            lower: time(line, lower)?,
            upper: time(line, upper)?,
        });
    }
    announced(num_links, "contingent links", links.len(), end)?;
    Draft { names, edges, links }.finish()
}

pub(super) fn write(document: &Document) -> String {
    let Document { names, network, .. } = document;
    let mut text = format!(
        "# KIND OF NETWORK\nSTNU\n# Num Time-Points\n{}\n# Num Ordinary Edges\n{}\n# Num Contingent Links\n{}\n\
         # Names of Time-Points\n{}\n# Ordinary Edges\n",
        names.len(),
        network.edges().len(),
        network.links().len(),
        names.join(" "),
    );
    for edge in network.edges() {
        let weight = document.time(edge.weight);
        text.push_str(&format!("{} {weight} {}\n", document.name(edge.from), document.name(edge.to)));
    }
    text.push_str("# Contingent Links\n");
    for link in network.links() {
        let (activation, end) = (document.name(link.activation), document.name(link.end));
        let (lower, upper) = (document.time(link.lower), document.time(link.upper));
        text.push_str(&format!("{activation} {lower} {upper} {end}\n"));
    }
    text
}

fn sections(text: &str) -> Result<Vec<Section<'_>>, ParseError> {
    let mut sections: Vec<Section<'_>> = Vec::new();
    for (line, content) in text.lines().enumerate().map(|(index, content)| (index + 1, content.trim())) {
        if content.starts_with('#') {
            sections.push(Vec::new());
        } else if !content.is_empty() {
            let Some(section) = sections.last_mut() else {
                return Err(ParseError::new(line, "expected a section that starts with a line with `#`"));
            };
            section.push((line, content));
        }
    }
    Ok(sections)
}

fn single<'a>(section: &[(usize, &'a str)], end: usize) -> Result<(usize, &'a str), ParseError> {
    match section {
        [only] => Ok(*only),
        [] => Err(ParseError::new(end, "a section must not be empty")),
        [_, (line, _), ..] => Err(ParseError::new(*line, "expected the next section")),
    }
}

fn count(section: &[(usize, &str)], end: usize) -> Result<usize, ParseError> {
    let (line, text) = single(section, end)?;
    text.parse().map_err(|_| ParseError::new(line, format!("expected a number, not {text}")))
}

fn announced(expected: usize, what: &str, found: usize, end: usize) -> Result<(), ParseError> {
    if expected == found {
        return Ok(());
    }
    Err(ParseError::new(end, format!("the header says {expected} {what}, but {found} are listed")))
}

fn read_names(
    section: &[(usize, &str)],
    num_points: usize,
    end: usize,
) -> Result<(Vec<String>, BTreeMap<String, PointId>), ParseError> {
    let mut names = Vec::new();
    let mut by_name = BTreeMap::new();
    for &(line, content) in section {
        for name in content.split_whitespace() {
            // The other layout is XML, which has no way to write these.
            if let Some(letter) = name.chars().find(|&it| it < ' ' || matches!(it, '\u{fffe}' | '\u{ffff}')) {
                let message = format!("a name cannot contain the character {}", letter.escape_unicode());
                return Err(ParseError::new(line, message));
            }
            if by_name.insert(name.to_owned(), PointId(names.len() as u32)).is_some() {
                return Err(ParseError::new(line, format!("duplicate name {name}")));
            }
            names.push(name.to_owned());
        }
    }
    let line = section.last().map_or(end, |&(line, _)| line);
    if names.len() != num_points {
        let message = format!("the header says {num_points} time points, but {} are named", names.len());
        return Err(ParseError::new(line, message));
    }
    Ok((names, by_name))
}

fn point(by_name: &BTreeMap<String, PointId>, line: usize, name: &str) -> Result<PointId, ParseError> {
    by_name.get(name).copied().ok_or_else(|| ParseError::new(line, format!("{name} is not a time point")))
}
