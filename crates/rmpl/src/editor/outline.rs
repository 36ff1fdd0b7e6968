//! The outline of a mission text: its declarations.

use crate::parse::Parse;
use crate::span::Span;
use crate::syntax::{SyntaxKind, SyntaxNode, SyntaxToken};

/// What an entry of the outline is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OutlineKind {
    /// A variable that is known where it is asserted.
    Variable,
    /// A variable that keeps its value.
    State,
    Resource,
    Primitive,
    /// An activity with a definition.
    Activity,
    Scenario,
    Constant,
    Option,
    Terrain,
    Location,
    Obstacle,
    Vehicle,
    /// A vehicle model.
    Model,
    /// A group, or vehicles that one declaration numbers.
    Group,
}

/// A declaration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutlineItem {
    /// What it declares.
    pub kind: OutlineKind,
    pub name: String,
    /// What follows the name in the declaration, on one line: parameters, bounds, domain, coordinates.
    pub detail: String,
    /// Where the name is.
    pub name_span: Span,
    /// The whole declaration.
    pub span: Span,
}

/// The declarations that have a name, in textual order.
pub fn outline(parse: &Parse) -> Vec<OutlineItem> {
    parse.declarations().flat_map(|root| root.children().find_map(items).unwrap_or_default()).collect()
}

fn items(node: SyntaxNode<'_>) -> Option<Vec<OutlineItem>> {
    if node.kind() == SyntaxKind::VehicleDecl {
        Some(vehicles(node))
    } else {
        item(node).map(|item| vec![item])
    }
}

/// The vehicles and fleets of one declaration.
fn vehicles(node: SyntaxNode<'_>) -> Vec<OutlineItem> {
    let colon = node.token(SyntaxKind::Colon).map_or(node.span().end, |colon| colon.span.start);
    let shared = node.text().get((colon - node.span().start) as usize..).unwrap_or("");
    let shared: Vec<&str> = shared.trim_matches([';', ' ', '\n']).split_whitespace().collect();
    let names = node.own_tokens().filter(|token| token.kind == SyntaxKind::Name && token.span.end <= colon);
    let ranges = || node.children().filter(|child| child.kind() == SyntaxKind::FleetRange);
    // The first name is the word `vehicle` itself.
    let item = |name: SyntaxToken<'_>| {
        let range = ranges().find(|range| range.span().start == name.span.end);
        let detail = range.map(SyntaxNode::text).into_iter().chain(shared.iter().copied());
        OutlineItem {
            kind: if range.is_some() { OutlineKind::Group } else { OutlineKind::Vehicle },
            name: name.text.to_owned(),
            detail: detail.collect::<Vec<_>>().join(" "),
            name_span: name.span,
            span: node.span(),
        }
    };
    names.skip(1).map(item).collect()
}

fn item(node: SyntaxNode<'_>) -> Option<OutlineItem> {
    // World declarations begin with a name that serves as their keyword.
    let (kind, nth) = match node.kind() {
        SyntaxKind::VariableDecl => (OutlineKind::Variable, 0),
        SyntaxKind::StateDecl => (OutlineKind::State, 1),
        SyntaxKind::ResourceDecl => (OutlineKind::Resource, 1),
        SyntaxKind::PrimitiveDecl => (OutlineKind::Primitive, 0),
        SyntaxKind::ActivityDecl => (OutlineKind::Activity, 0),
        SyntaxKind::ScenarioDecl => (OutlineKind::Scenario, 0),
        SyntaxKind::ConstantDecl => (OutlineKind::Constant, 1),
        SyntaxKind::OptionDecl => (OutlineKind::Option, 0),
        SyntaxKind::TerrainDecl => (OutlineKind::Terrain, 0),
        SyntaxKind::LocationDecl => (OutlineKind::Location, 1),
        SyntaxKind::ObstacleDecl => (OutlineKind::Obstacle, 1),
        SyntaxKind::ModelDecl => (OutlineKind::Model, 1),
        SyntaxKind::GroupDecl => (OutlineKind::Group, 1),
        _ => return None,
    };
    let wanted = if kind == OutlineKind::Terrain { SyntaxKind::String } else { SyntaxKind::Name };
    // The name of a component's state has two parts.
    let dotted = node.child(SyntaxKind::Dotted).filter(|_| kind == OutlineKind::State);
    let own =
        || node.own_tokens().filter(|token| token.kind == wanted).nth(nth).map(|name| (name.text, name.span));
    let (name, name_span) = dotted.map_or_else(own, |dotted| Some((dotted.text(), dotted.span())))?;
    let body = node.child(SyntaxKind::Block).map(SyntaxNode::span);
    let brace = node.token(SyntaxKind::LeftBrace).filter(|_| kind == OutlineKind::Model);
    let end = body.or(brace.map(|brace| brace.span)).map_or(node.span().end, |body| body.start);
    let start = node.span().start;
    let rest = node.text().get((name_span.end - start) as usize..(end - start) as usize).unwrap_or("");
    let detail: Vec<&str> = rest.trim_matches([';', '=', ' ', '\n']).split_whitespace().collect();
    Some(OutlineItem {
        kind,
        name: name.trim_matches('"').to_owned(),
        detail: detail.join(" "),
        name_span,
        span: node.span(),
    })
}
