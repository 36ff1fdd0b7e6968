//! Signature help: the parameters of the call around the cursor, and which one is being written.

use crate::parse::Parse;
use crate::span::Span;
use crate::syntax::{SyntaxKind, SyntaxNode};

use super::cursor::declaration_at_cursor;
use super::hover::header;

/// The signature of the call around the cursor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signature {
    /// The activity's header, such as `primitive Drive(from, to)[20,30]`.
    pub label: String,
    /// Where each parameter is in the label, in bytes.
    pub parameters: Vec<Span>,
    /// The parameter that the cursor is at; may be past the last.
    pub active: u32,
    /// The comment above the declaration.
    pub documentation: String,
}

/// Returns what is written in the brackets around `offset`: the arguments of a call whose activity is declared, bounds,
/// or the numbers, parameters and values of a declaration.
pub fn signature_at(parse: &Parse, offset: u32) -> Option<Signature> {
    match open_bracket(parse, offset) {
        Some((bracket, owner, first, active)) => {
            of_call(parse, offset).filter(|_| bracket == "(").or_else(|| {
                let (label, documentation) = of_declaration(&bracket, &owner, &first)?;
                let (label, documentation) = (label.to_owned(), documentation.to_owned());
                Some(Signature { parameters: parameters(&label, &bracket), label, active, documentation })
            })
        }
        None => of_call(parse, offset),
    }
}

/// The innermost bracket that is open at `offset`, the words before it and at the start of the declaration, and how many
/// commas follow it.
fn open_bracket(parse: &Parse, offset: u32) -> Option<(String, String, String, u32)> {
    let root = declaration_at_cursor(parse, offset)?;
    let tokens: Vec<_> =
        root.tokens().filter(|token| !token.kind.is_trivia() && token.span.end <= offset).collect();
    let mut open: Vec<(usize, u32)> = Vec::new();
    for (at, token) in tokens.iter().enumerate() {
        match token.kind {
            SyntaxKind::LeftParen | SyntaxKind::LeftBracket | SyntaxKind::LeftBrace => open.push((at, 0)),
            SyntaxKind::RightParen | SyntaxKind::RightBracket | SyntaxKind::RightBrace => {
                open.pop();
            }
            SyntaxKind::Comma => {
                if let Some((_, commas)) = open.last_mut() {
                    *commas += 1;
                }
            }
            _ => {}
        }
    }
    let &(at, commas) = open.last()?;
    let owner = at.checked_sub(1).and_then(|before| tokens.get(before)).map_or("", |token| token.text);
    let first = tokens.first().map_or("", |token| token.text);
    Some((tokens[at].text.to_owned(), owner.to_owned(), first.to_owned(), commas))
}

/// Returns what a declaration, or bounds, want in a bracket after the word `owner`, where the declaration begins with
/// `first`.
fn of_declaration(bracket: &str, owner: &str, first: &str) -> Option<(&'static str, &'static str)> {
    Some(match (bracket, owner, first) {
        ("[", ..) => ("[MIN, MAX]", "Minimum and maximum duration; `inf` for no maximum."),
        ("(", "speed", _) => ("speed (MINIMUM, MAXIMUM)", "Minimum and maximum speed, in meters per second."),
        ("(", "origin", _) => ("origin (EAST, NORTH)", "Position of the map's south-west corner, in meters."),
        ("(", "circle", _) => ("circle (EAST, NORTH, RADIUS)", "Center and radius, in meters."),
        ("(", "polygon", _) => ("polygon (EAST, NORTH, …)", "Corners in order, in meters."),
        ("(", _, "location") => ("location NAME (EAST, NORTH)", "Position, in meters."),
        ("(", _, "primitive") => ("primitive NAME(PARAMETER, …)", "Parameters of a call."),
        ("{", _, "var" | "state") => ("{VALUE, …}", "Allowed values."),
        _ => return None,
    })
}

/// The signature of the innermost call whose parentheses surround `offset`, if its activity is declared.
fn of_call(parse: &Parse, offset: u32) -> Option<Signature> {
    let root = declaration_at_cursor(parse, offset)?;
    let inside = |arguments: &SyntaxNode<'_>| {
        let open = arguments.token(SyntaxKind::LeftParen).map(|token| token.span.end);
        let close = arguments.token(SyntaxKind::RightParen).map(|token| token.span.start);
        open.is_some_and(|open| open <= offset) && close.is_none_or(|close| offset <= close)
    };
    let calls = root.descendants().filter(|node| node.kind() == SyntaxKind::Call);
    let (name, arguments) = calls
        .filter_map(|call| Some((call.token(SyntaxKind::Name)?, call.child(SyntaxKind::Arguments)?)))
        .filter(|(_, arguments)| inside(arguments) && arguments.span().start < offset)
        .last()?;
    let active = arguments
        .own_tokens()
        .filter(|token| token.kind == SyntaxKind::Comma && token.span.end <= offset)
        .count() as u32;
    let declaration = parse.declarations().find(|root| {
        root.children().next().is_some_and(|declaration| {
            matches!(declaration.kind(), SyntaxKind::PrimitiveDecl | SyntaxKind::ActivityDecl)
                && declaration.token(SyntaxKind::Name).is_some_and(|own| own.text == name.text)
        })
    })?;
    let (label, documentation) = header(declaration)?;
    Some(Signature { parameters: parameters(&label, "("), label, active, documentation })
}

/// The parts between the first bracket of this kind and the one that closes it.
fn parameters(label: &str, bracket: &str) -> Vec<Span> {
    let close = match bracket {
        "[" => ']',
        "{" => '}',
        _ => ')',
    };
    let (Some(open), Some(close)) = (label.find(bracket), label.find(close)) else { return Vec::new() };
    let mut found = Vec::new();
    let mut start = open + 1;
    for part in label.get(open + 1..close).unwrap_or("").split(',') {
        let lead = part.len() - part.trim_start().len();
        let name = part.trim();
        if !name.is_empty() {
            found.push(Span::new((start + lead) as u32, (start + lead + name.len()) as u32));
        }
        start += part.len() + 1;
    }
    found
}
