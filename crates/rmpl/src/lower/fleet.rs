//! Vehicles and their models, groups, and statements for their members (SPEC 17).

use exact::Rational;

use super::{Lowering, VehiclesDecl, lasting, names};
use crate::program::{
    FleetDecl, GroupDecl, Members, MembersForm, ModelDecl, Name, Property, PropertyDecl, Statement,
    StatementKind, VehicleDecl,
};
use crate::span::Span;
use crate::syntax::{Element, SyntaxKind, SyntaxNode};

pub(super) fn vehicles(node: SyntaxNode<'_>) -> Option<VehiclesDecl> {
    let mut written: Vec<(Name, Option<SyntaxNode<'_>>)> = Vec::new();
    let mut model = None;
    let mut is_behind_colon = false;
    // The first name is the word `vehicle` itself.
    let mut is_word = true;
    for element in node.elements() {
        match element {
            Element::Token(token) if token.kind == SyntaxKind::Colon => is_behind_colon = true,
            Element::Token(token) if token.kind == SyntaxKind::Name => {
                if std::mem::take(&mut is_word) {
                    continue;
                }
                let name = super::name_of(token);
                if is_behind_colon {
                    model = model.or(Some(name));
                } else {
                    written.push((name, None));
                }
            }
            Element::Node(range) if range.kind() == SyntaxKind::FleetRange => {
                if let Some((_, last)) = written.last_mut() {
                    *last = Some(range);
                }
            }
            _ => {}
        }
    }
    let model = model?;
    let start = names(node.child(SyntaxKind::At)?).nth(1)?;
    let mut decl =
        VehiclesDecl { vehicles: Vec::new(), fleets: Vec::new(), model: model.clone(), start: start.clone() };
    let vehicle =
        |name: Name| VehicleDecl { name, model: model.clone(), start: start.clone(), span: node.span() };
    for (name, range) in written {
        let Some(range) = range else {
            decl.vehicles.push(vehicle(name));
            continue;
        };
        let Some([first, last]) = numbers(range) else { continue };
        let span = name.span;
        let fleet = FleetDecl { name, first, last, range_span: range.span() };
        decl.vehicles.extend(fleet.members().map(|text| vehicle(Name { text, span })));
        decl.fleets.push(fleet);
    }
    Some(decl)
}

fn numbers(range: SyntaxNode<'_>) -> Option<[u32; 2]> {
    let mut numbers = range.own_tokens().filter(|token| token.kind == SyntaxKind::Number);
    let mut next = || numbers.next()?.text.parse().ok();
    Some([next()?, next()?])
}

pub(super) fn model(node: SyntaxNode<'_>) -> Option<ModelDecl> {
    let of = |kind: SyntaxKind| node.children().filter(move |child| child.kind() == kind);
    Some(ModelDecl {
        // The first name is the word `model` itself.
        name: names(node).nth(1)?,
        parent: node.child(SyntaxKind::Extends).and_then(|parent| names(parent).nth(1)),
        properties: of(SyntaxKind::Property).filter_map(property).collect(),
        resources: of(SyntaxKind::ResourceDecl).filter_map(lasting::resource).collect(),
        states: of(SyntaxKind::StateDecl)
            .filter_map(lasting::state)
            .filter(|state| !state.is_from_plant)
            .collect(),
        span: node.span(),
    })
}

fn property(node: SyntaxNode<'_>) -> Option<PropertyDecl> {
    let word = names(node).next()?;
    let mut quantities = node.children().filter(|child| child.kind() == SyntaxKind::Quantity);
    let first = quantity(quantities.next()?)?;
    let second = quantities.next().and_then(quantity);
    let property = match word.text.as_str() {
        "body" => Property::Body { length_m: first.to_f64(), width_m: second?.to_f64() },
        "speed" => Property::Speed { min_mps: first, max_mps: second? },
        "slope" => Property::Slope { angle_rad: angle_rad(node, first) },
        "clearance" => Property::Clearance { size_m: first.to_f64() },
        "turning" => Property::Turning { radius_m: first.to_f64() },
        "mast" => Property::Mast { height_m: first.to_f64() },
        _ => Property::Flies { altitude_band_m: [first.to_f64(), second?.to_f64()] },
    };
    Some(PropertyDecl { property, span: node.span() })
}

/// A length in meters, a speed in meters per second, or an angle in its own unit.
fn quantity(node: SyntaxNode<'_>) -> Option<Rational> {
    let magnitude: Rational = node.token(SyntaxKind::Number)?.text.parse().ok()?;
    let unit: String = names(node).map(|unit| unit.text.to_string()).collect::<Vec<_>>().join("/");
    let (above, below) = match unit.as_str() {
        "cm" => (1, 100),
        "mm" => (1, 1000),
        "km" => (1000, 1),
        "km/h" => (5, 18),
        _ => (1, 1),
    };
    let value = magnitude.checked_mul(Rational::new(above, below)?)?;
    if node.token(SyntaxKind::Minus).is_some() { value.checked_neg() } else { Some(value) }
}

fn angle_rad(property: SyntaxNode<'_>, value: Rational) -> f64 {
    let is_radian = property
        .child(SyntaxKind::Quantity)
        .is_some_and(|quantity| names(quantity).any(|unit| unit.text == "rad"));
    if is_radian { value.to_f64() } else { value.to_f64().to_radians() }
}

pub(super) fn group(node: SyntaxNode<'_>) -> Option<GroupDecl> {
    // The first name is the word `group` itself.
    let mut words = names(node).skip(1);
    let name = words.next()?;
    Some(GroupDecl { name, members: words.collect(), span: node.span() })
}

impl Lowering<'_> {
    /// `any r in G unit` or `each r in G unit`
    pub(super) fn members(&mut self, node: SyntaxNode<'_>) -> Option<StatementKind> {
        let mut words = names(node);
        let (word, variable) = (words.next()?, words.next()?);
        let group = words.nth(1)?;
        let form = match words.next() {
            _ if word.text == "any" => MembersForm::Any,
            None => MembersForm::Parallel,
            Some(order) if order.text == "unordered" => MembersForm::Unordered,
            Some(_) => MembersForm::Sequence,
        };
        let unit = self.statement(node.child(SyntaxKind::Statement)?)?;
        let body = if form == MembersForm::Parallel { delayed(unit, word.span) } else { unit };
        Some(StatementKind::Members(Members { form, variable, group, body: Box::new(body) }))
    }
}

/// Returns what starts when it likes, as `free` says.
fn delayed(unit: Statement, word: Span) -> Statement {
    let delay = Statement { kind: StatementKind::Delay, bounds: None, span: word };
    let span = word.cover(unit.span);
    Statement { kind: StatementKind::Sequence(vec![delay, unit]), bounds: None, span }
}
