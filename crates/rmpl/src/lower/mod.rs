//! From the syntax tree to meaning: the pieces of [`crate::program`], with what is broken left out.

pub(crate) mod bounds;
mod clause;
pub(crate) mod condition;
mod contingent;
mod declaration;
mod fleet;
mod lasting;
mod statement;

use exact::Rational;
use smol_str::SmolStr;

use crate::diagnostic::Diagnostic;
use crate::program::{
    ActivityDecl, ConstantDecl, ConstrainDecl, ControlDecl, FleetDecl, GroupDecl, ImportDecl, LocationDecl,
    ModelDecl, Name, ObjectiveDecl, ObstacleDecl, PrimitiveDecl, ResourceDecl, ScenarioDecl, TerrainDecl,
    VariableDecl, VehicleDecl,
};
use crate::span::Span;
use crate::syntax::{SyntaxKind, SyntaxNode, SyntaxToken, is_dash};

/// What one declaration declares.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Item {
    Constant(ConstantDecl),
    Variable(VariableDecl),
    Resource(Box<ResourceDecl>),
    Objective(ObjectiveDecl),
    Primitive(Box<PrimitiveDecl>),
    Activity(Box<ActivityDecl>),
    Scenario(Box<ScenarioDecl>),
    Constrain(Box<ConstrainDecl>),
    Import(ImportDecl),
    Option(OptionDecl),
    Control(ControlDecl),
    Terrain(Box<TerrainDecl>),
    Location(LocationDecl),
    Obstacle(ObstacleDecl),
    Vehicles(Box<VehiclesDecl>),
    Model(Box<ModelDecl>),
    Group(GroupDecl),
}

/// `vehicle R1, S[1..4] : MODEL at LOCATION;`
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct VehiclesDecl {
    /// The vehicles, those of fleets included, in textual order.
    pub(crate) vehicles: Vec<VehicleDecl>,
    pub(crate) fleets: Vec<FleetDecl>,
    pub(crate) model: Name,
    pub(crate) start: Name,
}

/// `option name = value;`
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct OptionDecl {
    pub(crate) name: Name,
    pub(crate) value: OptionValue,
    pub(crate) value_span: Span,
}

/// What an option is set to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum OptionValue {
    Number(Rational),
    Name(SmolStr),
}

/// What lowering needs to know of the rest of the file, and what it finds on its way.
pub(crate) struct Lowering<'a> {
    /// Whether a bare name is an activity or a primitive of the file (SPEC 1.3).
    pub(crate) is_callable: &'a dyn Fn(&str) -> bool,
    /// Starts of the names that stand alone as statements, in textual order.
    pub(crate) bare_names: Vec<u32>,
    /// Conditions that cannot be asserted as they are written, or that make the text too large.
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// How many statements `or` has copied in this declaration.
    copied: usize,
}

impl<'a> Lowering<'a> {
    pub(crate) const fn new(is_callable: &'a dyn Fn(&str) -> bool) -> Self {
        Self { is_callable, bare_names: Vec::new(), diagnostics: Vec::new(), copied: 0 }
    }
}

impl Lowering<'_> {
    /// Returns what the declaration under `root` declares, if enough of it is there.
    pub(crate) fn item(&mut self, root: SyntaxNode<'_>) -> Option<Item> {
        self.copied = 0;
        let node = root.children().find(|child| child.kind().is_declaration())?;
        match node.kind() {
            SyntaxKind::ConstantDecl => declaration::constant(node).map(Item::Constant),
            SyntaxKind::VariableDecl => declaration::variable(node).map(Item::Variable),
            SyntaxKind::PrimitiveDecl => self.primitive(node).map(|decl| Item::Primitive(Box::new(decl))),
            SyntaxKind::StateDecl => lasting::state(node).map(Item::Variable),
            SyntaxKind::ResourceDecl => lasting::resource(node).map(|decl| Item::Resource(Box::new(decl))),
            SyntaxKind::ObjectiveDecl => lasting::objective(node).map(Item::Objective),
            SyntaxKind::OptionDecl => declaration::option(node).map(Item::Option),
            SyntaxKind::ActivityDecl => self.activity(node).map(|decl| Item::Activity(Box::new(decl))),
            SyntaxKind::ScenarioDecl => self.scenario(node).map(|decl| Item::Scenario(Box::new(decl))),
            SyntaxKind::ConstrainDecl => self.constrain(node).map(|decl| Item::Constrain(Box::new(decl))),
            SyntaxKind::ImportDecl => declaration::import(node).map(Item::Import),
            SyntaxKind::ControlDecl => declaration::control(node).map(Item::Control),
            SyntaxKind::TerrainDecl => declaration::terrain(node).map(|decl| Item::Terrain(Box::new(decl))),
            SyntaxKind::LocationDecl => declaration::location(node).map(Item::Location),
            SyntaxKind::ObstacleDecl => declaration::obstacle(node).map(Item::Obstacle),
            SyntaxKind::ModelDecl => fleet::model(node).map(|decl| Item::Model(Box::new(decl))),
            SyntaxKind::GroupDecl => fleet::group(node).map(Item::Group),
            _ => fleet::vehicles(node).map(|decl| Item::Vehicles(Box::new(decl))),
        }
    }
}

/// A name as it was meant: dashes that represent a hyphen have been reported.
fn name_of(token: SyntaxToken<'_>) -> Name {
    let text = if token.text.is_ascii() {
        SmolStr::new(token.text)
    } else {
        token.text.chars().map(|letter| if is_dash(letter) { '-' } else { letter }).collect()
    };
    Name { text, span: token.span }
}

/// The variable of a condition or an effect, or the resource of a use: of two parts with a dot it is one name, as `V.at`.
fn variable_in(node: SyntaxNode<'_>) -> Option<Name> {
    match node.child(SyntaxKind::Dotted) {
        Some(parts) => dotted(parts),
        None => names(node).next(),
    }
}

/// The name of two parts that a node is, if it is whole.
fn dotted(dotted: SyntaxNode<'_>) -> Option<Name> {
    let mut parts = names(dotted);
    let (owner, part) = (parts.next()?, parts.next()?);
    // What is between them has been reported, and is part of no name.
    if owner.span.end + 1 != part.span.start {
        return None;
    }
    let text = SmolStr::from_iter([owner.text.as_str(), ".", part.text.as_str()]);
    Some(Name { text, span: owner.span.cover(part.span) })
}

/// The names that stand directly in `node`, in textual order.
fn names(node: SyntaxNode<'_>) -> impl Iterator<Item = Name> {
    node.own_tokens().filter(|token| token.kind == SyntaxKind::Name).map(name_of)
}
