//! Declarations.

use exact::Rational;
use smol_str::SmolStr;

use super::bounds::{bounds_in, expression, header_bounds_in};
use super::statement::signed;
use super::{Lowering, OptionDecl, OptionValue, name_of, names};
use crate::program::{
    ActivityDecl, Bounds, ConstantDecl, ConstrainDecl, ControlDecl, EventName, ImportDecl, LocationDecl,
    Moves, Name, ObstacleDecl, ObstacleKind, ObstacleShape, ScenarioDecl, TerrainDecl, VariableDecl,
};
use crate::span::Span;
use crate::syntax::{Element, KEEPOUT, SyntaxKind, SyntaxNode};

impl Lowering<'_> {
    pub(super) fn activity(&mut self, node: SyntaxNode<'_>) -> Option<ActivityDecl> {
        let name = names(node).next()?;
        self.no_contingent(node, &format!("the activity `{}`", name.text));
        Some(ActivityDecl {
            name,
            formals: formals(node),
            kinds: kinds(node),
            bounds: header_bounds_in(node),
            body: self.block(node.child(SyntaxKind::Block)?),
            span: node.span(),
        })
    }

    pub(super) fn scenario(&mut self, node: SyntaxNode<'_>) -> Option<ScenarioDecl> {
        self.no_contingent(node, "the scenario");
        let bounds = bounds_in(node).map(|bounds| Bounds { is_contingent: false, ..bounds });
        Some(ScenarioDecl {
            name: names(node).next()?,
            bounds,
            body: self.block(node.child(SyntaxKind::Block)?),
            span: node.span(),
        })
    }
}

impl Lowering<'_> {
    /// A bound between two events; the word by which the environment would choose it is reported.
    pub(super) fn constrain(&mut self, node: SyntaxNode<'_>) -> Option<ConstrainDecl> {
        self.no_contingent(node, "the time between two events");
        let bounds = bounds_in(node).map(|bounds| Bounds { is_contingent: false, ..bounds })?;
        let mut events = node.children().filter(|child| child.kind() == SyntaxKind::EventName);
        let (from, to) = (event_name(events.next()?)?, event_name(events.next()?)?);
        Some(ConstrainDecl { from, to, bounds, span: node.span() })
    }
}

fn event_name(node: SyntaxNode<'_>) -> Option<EventName> {
    let mut parts = names(node);
    let (name, event) = (parts.next()?, parts.next()?);
    Some(EventName { name, is_end: event.text == "end", span: node.span() })
}

pub(super) fn import(node: SyntaxNode<'_>) -> Option<ImportDecl> {
    let file = node.token(SyntaxKind::String)?;
    let text = file.text.trim_matches('"');
    Some(ImportDecl { file: SmolStr::new(text), file_span: file.span, span: node.span() })
}

pub(super) fn formals(node: SyntaxNode<'_>) -> Vec<Name> {
    node.child(SyntaxKind::Formals).map(|formals| names(formals).collect()).unwrap_or_default()
}

/// Returns what is written of the kinds of parameters, one for each.
pub(super) fn kinds(node: SyntaxNode<'_>) -> Vec<Option<Name>> {
    let mut kinds = Vec::new();
    for element in node.child(SyntaxKind::Formals).into_iter().flat_map(SyntaxNode::elements) {
        match element {
            Element::Token(token) if token.kind == SyntaxKind::Name => kinds.push(None),
            Element::Node(kind) if kind.kind() == SyntaxKind::ParameterKind => {
                if let Some(last) = kinds.last_mut() {
                    *last = names(kind).next();
                }
            }
            _ => {}
        }
    }
    kinds
}

pub(super) fn constant(node: SyntaxNode<'_>) -> Option<ConstantDecl> {
    // The first name is the word `const` itself.
    let name = names(node).nth(1)?;
    let value = expression(node.children().find(|child| child.kind() != SyntaxKind::Skipped)?)?;
    Some(ConstantDecl { name, value, span: node.span() })
}

pub(super) fn variable(node: SyntaxNode<'_>) -> Option<VariableDecl> {
    let name = names(node).next()?;
    let values = names(node.child(SyntaxKind::Domain)?).collect();
    Some(VariableDecl { name, values, initial: None, is_from_plant: false, span: node.span() })
}

/// The text between the braces of a control block.
pub(super) fn control(node: SyntaxNode<'_>) -> Option<ControlDecl> {
    let token = node.token(SyntaxKind::ControlText)?;
    let open = token.text.find('{')? + 1;
    let inner = &token.text[open..];
    let inner = inner.strip_suffix('}').unwrap_or(inner);
    let start = token.span.start + open as u32;
    let span = Span::new(start, start + inner.len() as u32);
    Some(ControlDecl { text: inner.into(), text_span: span, span: token.span })
}

pub(super) fn moves(node: SyntaxNode<'_>) -> Option<Moves> {
    // The first name is the word `moves` itself.
    let vehicles: Vec<Name> = names(node).skip(1).collect();
    let speeds = node.child(SyntaxKind::Speed).and_then(|speed| speed.child(SyntaxKind::Coordinates));
    let speeds: Vec<_> = speeds.map(numbers).unwrap_or_default();
    let signed = |&(is_negative, magnitude, _): &(bool, Rational, Span)| {
        if is_negative { Rational::ZERO.checked_sub(magnitude) } else { Some(magnitude) }
    };
    let speed_mps = match speeds.as_slice() {
        [least, greatest] => signed(least).zip(signed(greatest)),
        _ => None,
    };
    let is_kinodynamic = node.child(SyntaxKind::Kinodynamic).is_some();
    (!vehicles.is_empty()).then_some(Moves { vehicles, speed_mps, is_kinodynamic, span: node.span() })
}

pub(super) fn option(node: SyntaxNode<'_>) -> Option<OptionDecl> {
    let mut tokens = node.own_tokens().filter(|token| token.kind != SyntaxKind::OptionKeyword);
    let name = name_of(tokens.next().filter(|token| token.kind == SyntaxKind::Name)?);
    let value = tokens.find(|token| matches!(token.kind, SyntaxKind::Number | SyntaxKind::Name))?;
    let meaning = match value.kind {
        SyntaxKind::Number => OptionValue::Number(value.text.parse().ok()?),
        _ => OptionValue::Name(SmolStr::new(value.text)),
    };
    Some(OptionDecl { name, value: meaning, value_span: value.span })
}

/// The numbers in `node`: whether each is negative, its magnitude, and where it stands with its sign.
fn numbers(node: SyntaxNode<'_>) -> Vec<(bool, Rational, Span)> {
    let mut found = Vec::new();
    let mut minus: Option<Span> = None;
    for token in node.own_tokens() {
        match token.kind {
            SyntaxKind::Minus => minus = Some(token.span),
            SyntaxKind::Number => {
                if let Ok(magnitude) = token.text.parse() {
                    let span = minus.map_or(token.span, |sign| sign.cover(token.span));
                    found.push((minus.is_some(), magnitude, span));
                }
                minus = None;
            }
            _ => minus = None,
        }
    }
    found
}

/// The meters in `( … )`, and the span inside the parentheses.
fn coordinates(node: SyntaxNode<'_>) -> Option<(Vec<f64>, Span)> {
    let node = node.child(SyntaxKind::Coordinates)?;
    let open = node.token(SyntaxKind::LeftParen)?;
    let end = node.token(SyntaxKind::RightParen).map_or(node.span().end, |close| close.span.start);
    let meters =
        numbers(node).into_iter().map(|(negative, magnitude, _)| signed(negative, magnitude)).collect();
    Some((meters, Span::new(open.span.end, end)))
}

pub(super) fn terrain(node: SyntaxNode<'_>) -> Option<TerrainDecl> {
    let asset = node.token(SyntaxKind::String)?;
    let cell = node.child(SyntaxKind::Cell).and_then(|cell| numbers(cell).first().copied());
    let origin = node.child(SyntaxKind::Origin).and_then(coordinates);
    let origin_m = match origin.as_ref().map(|(meters, _)| meters.as_slice()) {
        Some(&[east, north]) => Some([east, north]),
        _ => None,
    };
    Some(TerrainDecl {
        asset: SmolStr::new(asset.text.trim_matches('"')),
        asset_span: asset.span,
        cell_m: cell.map(|(negative, magnitude, _)| signed(negative, magnitude)),
        origin_m,
        span: node.span(),
    })
}

pub(super) fn location(node: SyntaxNode<'_>) -> Option<LocationDecl> {
    // The first name is the word `location` itself.
    let name = names(node).nth(1)?;
    let (meters, numbers_span) = coordinates(node)?;
    let &[east, north] = meters.as_slice() else { return None };
    Some(LocationDecl { name, position_m: [east, north], numbers_span, span: node.span() })
}

pub(super) fn obstacle(node: SyntaxNode<'_>) -> Option<ObstacleDecl> {
    let mut words = names(node).skip(1);
    let (name, shape) = (words.next()?, words.next()?);
    let (meters, numbers_span) = coordinates(node)?;
    let shape = match (shape.text.as_str(), meters.as_slice()) {
        ("circle", &[east, north, radius_m]) => ObstacleShape::Circle { center_m: [east, north], radius_m },
        ("polygon", corners) if corners.len() >= 6 && corners.len() % 2 == 0 => ObstacleShape::Polygon {
            corners_m: corners
                .chunks_exact(2)
                .filter_map(|corner| <[f64; 2]>::try_from(corner).ok())
                .collect(),
        },
        _ => return None,
    };
    let kind = if names(node).next()?.text == KEEPOUT {
        let closed_to = node.child(SyntaxKind::ClosedTo).into_iter().flat_map(|it| names(it).skip(1));
        ObstacleKind::KeepOut { closed_to: closed_to.collect() }
    } else {
        ObstacleKind::Solid
    };
    Some(ObstacleDecl { name, kind, shape, numbers_span, span: node.span() })
}
