//! Activities that differ only in a vehicle or a location (SPEC 17): one activity with a parameter says the same.

use std::collections::{BTreeMap, BTreeSet};

use crate::diagnostic::{Diagnostic, Edit, Fix};
use crate::diagnostics::copy;
use crate::files::MARK;
use crate::parse::Parse;
use crate::span::Span;
use crate::syntax::{SyntaxKind, SyntaxNode, SyntaxToken};

/// Of more activities nothing is told.
const MAX_ACTIVITIES: usize = 1_000;
/// What parameters are called, by what they represent.
const VEHICLE_NAMES: [&str; 3] = ["r", "rover", "v"];
const LOCATION_NAMES: [&str; 3] = ["site", "place", "goal"];

/// A primitive or an activity.
struct Activity<'a> {
    tokens: Vec<SyntaxToken<'a>>,
    /// Which of the tokens is its name.
    name: usize,
}

/// The names that a parameter can represent.
struct Subjects<'a> {
    vehicles: BTreeSet<&'a str>,
    locations: BTreeSet<&'a str>,
}

/// A note for each set of copies, with the fix that merges them. For missions of one file without errors.
pub(crate) fn check(parse: &Parse) -> Vec<Diagnostic> {
    if parse.text().contains(MARK) {
        return Vec::new();
    }
    let mut by_shape: BTreeMap<Vec<u8>, Vec<Activity<'_>>> = BTreeMap::new();
    for (count, activity) in declarations(parse).filter_map(Activity::new).enumerate() {
        if count >= MAX_ACTIVITIES {
            return Vec::new();
        }
        let shape = activity.tokens.iter().map(|token| token.kind as u8).collect();
        by_shape.entry(shape).or_default().push(activity);
    }
    if by_shape.values().all(|alike| alike.len() < 2) {
        return Vec::new();
    }
    let subjects = Subjects::new(parse);
    let lists: Vec<Vec<SyntaxToken<'_>>> = declarations(parse).map(tokens).collect();
    let taken: BTreeSet<&str> = lists.iter().flatten().filter(|it| is_name(it)).map(|it| it.text).collect();
    let mut found = Vec::new();
    for mut alike in by_shape.into_values() {
        while alike.len() > 1 {
            let first = alike.remove(0);
            let mut own = None;
            let mut copies: Vec<(usize, &str)> = Vec::new();
            for (at, other) in alike.iter().enumerate() {
                if let Some((one, another)) = first.difference(other, &subjects)
                    && *own.get_or_insert(one) == one
                {
                    copies.push((at, another));
                }
            }
            let Some(own) = own else { continue };
            let others: Vec<(&Activity<'_>, &str)> =
                copies.iter().map(|&(at, it)| (&alike[at], it)).collect();
            let merger = Merger {
                parse,
                first: &first,
                own,
                others: &others,
                subjects: &subjects,
                lists: &lists,
                taken: &taken,
            };
            found.extend(merger.note());
            for (at, _) in copies.into_iter().rev() {
                alike.remove(at);
            }
        }
    }
    found
}

fn declarations(parse: &Parse) -> impl Iterator<Item = SyntaxNode<'_>> {
    parse.declarations().filter_map(|root| root.children().find(|child| child.kind().is_declaration()))
}

fn tokens(node: SyntaxNode<'_>) -> Vec<SyntaxToken<'_>> {
    node.tokens().filter(|token| !token.kind.is_trivia()).collect()
}

fn is_name(token: &SyntaxToken<'_>) -> bool {
    token.kind == SyntaxKind::Name
}

impl<'a> Activity<'a> {
    fn new(node: SyntaxNode<'a>) -> Option<Self> {
        if !matches!(node.kind(), SyntaxKind::PrimitiveDecl | SyntaxKind::ActivityDecl) {
            return None;
        }
        let tokens = tokens(node);
        let name = tokens.iter().position(is_name)?;
        // What has no parentheses has errors of its own.
        (tokens.get(name + 1)?.kind == SyntaxKind::LeftParen).then_some(Self { tokens, name })
    }

    fn text(&self) -> &'a str {
        self.tokens[self.name].text
    }

    fn has(&self, text: &str) -> bool {
        self.tokens.iter().any(|token| token.text == text)
    }

    /// The one vehicle or location by which another activity of the same shape differs, and that of the other.
    fn difference(&self, other: &Self, subjects: &Subjects<'a>) -> Option<(&'a str, &'a str)> {
        let mut pair = None;
        for (at, (one, another)) in self.tokens.iter().zip(&other.tokens).enumerate() {
            if at == self.name || one.text == another.text {
                continue;
            }
            let texts = (one.text, another.text);
            if !subjects.are_alike(texts) || *pair.get_or_insert(texts) != texts {
                return None;
            }
        }
        let (own, others) = pair?;
        let is_apart = self.text() != other.text() && !self.has(others) && !other.has(own);
        is_apart.then_some((own, others))
    }

    fn span(&self) -> Span {
        let (first, last) = (self.tokens[0].span, self.tokens[self.tokens.len() - 1].span);
        Span::new(first.start, last.end)
    }

    /// The parameters with their parentheses.
    fn header(&self) -> &[SyntaxToken<'a>] {
        let rest = &self.tokens[self.name + 1..];
        let end = rest.iter().position(|token| token.kind == SyntaxKind::RightParen).unwrap_or(rest.len());
        &rest[..end]
    }
}

impl<'a> Subjects<'a> {
    fn new(parse: &'a Parse) -> Self {
        let mut subjects = Self { vehicles: BTreeSet::new(), locations: BTreeSet::new() };
        for node in declarations(parse) {
            let names = node.own_tokens().take_while(|token| token.kind != SyntaxKind::Colon).filter(is_name);
            // The first name is the word that begins the declaration.
            match node.kind() {
                SyntaxKind::VehicleDecl => subjects.vehicles.extend(names.skip(1).map(|name| name.text)),
                SyntaxKind::LocationDecl => {
                    subjects.locations.extend(names.skip(1).take(1).map(|name| name.text));
                }
                _ => {}
            }
        }
        subjects
    }

    fn are_alike(&self, (one, another): (&str, &str)) -> bool {
        [&self.vehicles, &self.locations].iter().any(|names| names.contains(one) && names.contains(another))
    }
}

/// Makes one activity of several.
struct Merger<'m, 'a> {
    parse: &'a Parse,
    first: &'m Activity<'a>,
    /// What the parameter replaces in the first activity.
    own: &'a str,
    /// The others, each with what it has instead.
    others: &'m [(&'m Activity<'a>, &'a str)],
    subjects: &'m Subjects<'a>,
    /// The tokens of each declaration.
    lists: &'m [Vec<SyntaxToken<'a>>],
    /// All names in the text.
    taken: &'m BTreeSet<&'a str>,
}

impl Merger<'_, '_> {
    /// The note; nothing where an activity is more than called, or no name is free.
    fn note(&self) -> Option<Diagnostic> {
        if self.first.header().iter().any(|token| token.text == self.own) {
            return None;
        }
        let is_vehicle = self.subjects.vehicles.contains(self.own);
        let names = if is_vehicle { VEHICLE_NAMES } else { LOCATION_NAMES };
        let parameter = names.into_iter().find(|name| !self.taken.contains(name))?;
        let name = self.name();
        let mut edits = self.calls(name)?;
        edits.extend(self.declaration(name, parameter));
        edits.extend(self.others.iter().map(|(other, _)| self.removal(other)));
        edits.sort_by_key(|edit| edit.span);
        let activities: Vec<&str> = std::iter::once(self.first)
            .chain(self.others.iter().map(|(other, _)| *other))
            .map(Activity::text)
            .collect();
        let subjects: Vec<&str> =
            std::iter::once(self.own).chain(self.others.iter().map(|(_, subject)| *subject)).collect();
        let fix = Fix { label: format!("Replace with `{name}({parameter}…)`"), edits };
        let span = self.first.tokens[self.first.name].span;
        Some(copy::copies(&activities, &subjects, span).with_fix(fix))
    }

    /// Returns what all names begin with, if that is free; otherwise the name of the first.
    fn name(&self) -> &str {
        let first = self.first.text();
        let common = self.others.iter().fold(first.len(), |length, (other, _)| {
            let alike = first.bytes().zip(other.text().bytes()).take_while(|(one, another)| one == another);
            length.min(alike.count())
        });
        let is_end = |letter: char| letter == '-' || letter == '_' || letter.is_ascii_digit();
        let stem = first.get(..common).unwrap_or("");
        let is_letter_next = |name: &str| name.as_bytes().get(common).is_some_and(u8::is_ascii_alphabetic);
        let is_inside_word =
            is_letter_next(first) || self.others.iter().any(|(other, _)| is_letter_next(other.text()));
        let stem = if is_inside_word { stem.rfind(['-', '_']).map_or("", |at| &stem[..at]) } else { stem };
        let name = stem.trim_end_matches(is_end);
        let is_free = !name.is_empty() && !self.taken.contains(name) && SyntaxKind::keyword(name).is_none();
        if is_free { name } else { first }
    }

    /// The edits of all calls outside the copies. `None` where a name represents anything but a call.
    fn calls(&self, name: &str) -> Option<Vec<Edit>> {
        let mut edits = Vec::new();
        let removed: Vec<Span> = self.others.iter().map(|(other, _)| other.span()).collect();
        for list in self.lists {
            for (at, token) in list.iter().enumerate().filter(|(_, token)| is_name(token)) {
                let is_first = token.text == self.first.text();
                let other = self.others.iter().find(|(other, _)| other.text() == token.text);
                let subject = match other {
                    Some((_, subject)) => *subject,
                    None if is_first => self.own,
                    None => continue,
                };
                let is_own = token.span == self.first.tokens[self.first.name].span;
                if is_own || removed.iter().any(|span| span.contains(token.span)) {
                    continue;
                }
                let opening = list.get(at + 1).filter(|next| next.kind == SyntaxKind::LeftParen)?;
                edits.push(Edit { span: token.span, text: name.to_owned() });
                edits.push(first_in(subject, *opening, list.get(at + 2)));
            }
        }
        Some(edits)
    }

    /// The first activity with its parameter.
    fn declaration(&self, name: &str, parameter: &str) -> Vec<Edit> {
        let Activity { tokens, name: at } = self.first;
        let mut edits = vec![
            Edit { span: tokens[*at].span, text: name.to_owned() },
            first_in(parameter, tokens[at + 1], tokens.get(at + 2)),
        ];
        let used = tokens.iter().filter(|token| token.text == self.own);
        edits.extend(used.map(|token| Edit { span: token.span, text: parameter.to_owned() }));
        edits
    }

    fn removal(&self, other: &Activity<'_>) -> Edit {
        let Span { start, end } = other.span();
        let ends_line = self.parse.text().get(end as usize..).is_some_and(|rest| rest.starts_with('\n'));
        Edit { span: Span::new(start, end + u32::from(ends_line)), text: String::new() }
    }
}

/// Puts a name first between parentheses.
fn first_in(name: &str, opening: SyntaxToken<'_>, next: Option<&SyntaxToken<'_>>) -> Edit {
    let is_only = next.is_none_or(|next| next.kind == SyntaxKind::RightParen);
    let text = if is_only { name.to_owned() } else { format!("{name}, ") };
    Edit { span: Span::new(opening.span.end, opening.span.end), text }
}
