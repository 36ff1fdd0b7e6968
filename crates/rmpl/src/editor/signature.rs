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
    /// Where each parameter stands in the label, in bytes.
    pub parameters: Vec<Span>,
    /// The parameter that the cursor is at; may be past the last.
    pub active: u32,
    /// The comment above the declaration.
    pub documentation: String,
}

/// The signature of the innermost call whose parentheses surround `offset`, if its activity is declared.
pub fn signature_at(parse: &Parse, offset: u32) -> Option<Signature> {
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
    Some(Signature { parameters: parameters(&label), label, active, documentation })
}

fn parameters(label: &str) -> Vec<Span> {
    let (Some(open), Some(close)) = (label.find('('), label.find(')')) else { return Vec::new() };
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
