//! What the names in a text represent: the base of highlighting, navigation and renaming.

use smol_str::SmolStr;

use crate::analysis::{Meaning, Namespace};
use crate::parse::Parse;
use crate::program::VEHICLE_MODELS;
use crate::span::Span;
use crate::syntax::{Element, SyntaxKind, SyntaxNode, SyntaxToken};

/// What a name represents.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NameKind {
    /// An activity or a primitive.
    Activity,
    /// A state variable or an atom, declared or not.
    Variable,
    /// A value of this variable.
    Value(SmolStr),
    /// A parameter of the declaration.
    Parameter,
    /// A name of the header's bounds.
    BoundName,
    Constant,
    Scenario,
    Location,
    Obstacle,
    Vehicle,
    /// A group or a fleet.
    Group,
    Resource,
    /// A resource or a state that each vehicle of a model has.
    Equipment,
    /// An occurrence that `as` names.
    Occurrence,
    /// A vehicle model.
    Model,
    Option,
    OptionValue,
    ControlProgram,
    /// An argument that is nothing of the above: a symbol for the activity that it is handed to.
    Symbol,
}

impl NameKind {
    /// Returns whether the name means nothing outside its declaration.
    pub const fn is_local(&self) -> bool {
        matches!(self, Self::Parameter | Self::BoundName)
    }
}

/// A name in the text. `X_V` that represents `X=V` is two of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NameUse {
    pub span: Span,
    pub text: SmolStr,
    /// What it represents.
    pub kind: NameKind,
    /// Whether it is declared here.
    pub is_definition: bool,
    /// The declaration that it is in.
    pub declaration: Span,
}

/// The name at `offset`, or the one that ends there.
pub fn name_at(parse: &Parse, offset: u32) -> Option<NameUse> {
    let here = parse.declaration_at(offset).map(|root| names_in(parse, root)).unwrap_or_default();
    let found = here.into_iter().rfind(|name| name.span.touches(offset));
    // At the boundary of two declarations the name may end the earlier one.
    found.or_else(|| {
        let before = parse.declaration_at(offset.checked_sub(1)?)?;
        names_in(parse, before).into_iter().rfind(|name| name.span.touches(offset))
    })
}

/// All names of one declaration, in textual order.
pub(super) fn names_in(parse: &Parse, root: SyntaxNode<'_>) -> Vec<NameUse> {
    let mut collector = Collector {
        meaning: parse.meaning(),
        declaration: root.span(),
        is_model: root.child(SyntaxKind::ModelDecl).is_some(),
        parameters: Vec::new(),
        found: Vec::new(),
    };
    for node in root.descendants() {
        collector.node(node);
    }
    collector.found.sort_by_key(|name| name.span);
    collector.found
}

/// Returns whether `C.mode` stands here: component and modes are names of the control block.
fn is_mode(dotted: SyntaxNode<'_>) -> bool {
    dotted
        .own_tokens()
        .filter(|token| token.kind == SyntaxKind::Name)
        .nth(1)
        .is_some_and(|part| part.text == "mode")
}

/// Returns what `V.at` or a state of a vehicle is compared with.
fn value_kind(dotted: SyntaxNode<'_>) -> NameKind {
    match dotted.own_tokens().filter(|token| token.kind == SyntaxKind::Name).nth(1) {
        Some(part) if part.text != "at" => NameKind::Value(part.text.into()),
        _ => NameKind::Location,
    }
}

struct Collector<'a> {
    meaning: Meaning<'a>,
    declaration: Span,
    /// Resources and states are those of a model's vehicles.
    is_model: bool,
    parameters: Vec<&'a str>,
    found: Vec<NameUse>,
}

impl<'a> Collector<'a> {
    fn node(&mut self, node: SyntaxNode<'a>) {
        let names = || node.own_tokens().filter(|token| token.kind == SyntaxKind::Name);
        match node.kind() {
            SyntaxKind::VariableDecl => self.variable(node, names().next()),
            // The first name is the word `state` itself.
            SyntaxKind::StateDecl => self.variable(node, names().nth(1)),
            SyntaxKind::ResourceDecl => {
                let kind = if self.is_model { NameKind::Equipment } else { NameKind::Resource };
                self.define(names().nth(1), kind);
            }
            SyntaxKind::ResourceUse => self.resource(names().next()),
            // `using` and the resource; other words of `do` are keywords.
            SyntaxKind::Do => self.resource(names().nth(1)),
            SyntaxKind::Dotted if !is_mode(node) => {
                self.vehicle(names().next());
                self.refer(names().nth(1).filter(|part| part.text != "at"), NameKind::Equipment);
            }
            SyntaxKind::Naming => self.define(names().nth(1), NameKind::Occurrence),
            SyntaxKind::EventName => self.refer(names().next(), NameKind::Occurrence),
            SyntaxKind::Effect => self.effect(node),
            SyntaxKind::ConstantDecl => self.define(names().nth(1), NameKind::Constant),
            SyntaxKind::PrimitiveDecl => self.define(names().next(), NameKind::Activity),
            SyntaxKind::ActivityDecl => {
                self.define(names().next(), NameKind::Activity);
                let bounds = node.child(SyntaxKind::Bounds).into_iter().flat_map(SyntaxNode::children);
                for side in bounds.filter(|side| side.kind() == SyntaxKind::Operand) {
                    let name =
                        side.token(SyntaxKind::Name).filter(|_| side.token(SyntaxKind::Number).is_none());
                    if name.is_some_and(|name| self.is_declared(Namespace::Constant, name.text)) {
                        self.refer(name, NameKind::Constant);
                    } else {
                        self.define(name, NameKind::BoundName);
                    }
                }
            }
            SyntaxKind::ScenarioDecl => self.define(names().next(), NameKind::Scenario),
            SyntaxKind::OptionDecl => {
                let mut names = names();
                self.define(names.next(), NameKind::Option);
                self.refer(names.next(), NameKind::OptionValue);
            }
            SyntaxKind::LocationDecl => self.define(names().nth(1), NameKind::Location),
            SyntaxKind::ObstacleDecl => self.define(names().nth(1), NameKind::Obstacle),
            SyntaxKind::VehicleDecl => self.vehicles(node),
            SyntaxKind::ModelDecl => self.define(names().nth(1), NameKind::Model),
            SyntaxKind::Extends => self.refer(names().nth(1), NameKind::Model),
            SyntaxKind::GroupDecl => {
                let mut names = names().skip(1);
                self.define(names.next(), NameKind::Group);
                names.for_each(|member| self.member(member));
            }
            SyntaxKind::ParameterKind => self.kind(names().next()),
            SyntaxKind::Members => {
                let mut names = names().skip(1);
                let (variable, group) = (names.next(), names.nth(1));
                self.define(variable, NameKind::Parameter);
                self.parameters.extend(variable.map(|variable| variable.text));
                if let Some(group) = group {
                    self.refer_to(group, NameKind::Group);
                }
            }
            SyntaxKind::ClosedTo => names().skip(1).for_each(|name| self.closed_to(name)),
            SyntaxKind::At => self.refer(names().nth(1), NameKind::Location),
            SyntaxKind::Runs => self.refer(names().nth(1), NameKind::ControlProgram),
            SyntaxKind::Moves => {
                for name in names().skip(1) {
                    self.vehicle(Some(name));
                }
            }
            SyntaxKind::Formals => {
                for name in names() {
                    self.parameters.push(name.text);
                    self.define(Some(name), NameKind::Parameter);
                }
            }
            SyntaxKind::Operand => self.operand(node),
            SyntaxKind::Call => self.refer(names().next(), NameKind::Activity),
            SyntaxKind::Argument => self.argument(names().next()),
            SyntaxKind::BareName => self.bare(names().next()),
            SyntaxKind::Condition => self.condition(node),
            SyntaxKind::Visible => {
                if let Some(location) = names().nth(1) {
                    self.refer_to(location, NameKind::Location);
                }
            }
            _ => {}
        }
    }

    fn add(&mut self, span: Span, text: &str, kind: NameKind, is_definition: bool) {
        let declaration = self.declaration;
        self.found.push(NameUse { span, text: text.into(), kind, is_definition, declaration });
    }

    fn define(&mut self, name: Option<SyntaxToken<'_>>, kind: NameKind) {
        if let Some(name) = name {
            self.add(name.span, name.text, kind, true);
        }
    }

    fn refer(&mut self, name: Option<SyntaxToken<'_>>, kind: NameKind) {
        if let Some(name) = name {
            self.add(name.span, name.text, kind, false);
        }
    }

    /// A parameter if the name is one, otherwise a name of this kind.
    fn refer_to(&mut self, name: SyntaxToken<'_>, kind: NameKind) {
        let is_parameter = self.parameters.contains(&name.text);
        self.refer(Some(name), if is_parameter { NameKind::Parameter } else { kind });
    }

    /// `var` and `state` with their values.
    fn variable(&mut self, node: SyntaxNode<'a>, name: Option<SyntaxToken<'a>>) {
        self.define(name, if self.is_model { NameKind::Equipment } else { NameKind::Variable });
        let Some(variable) = name else { return };
        let kind = || NameKind::Value(variable.text.into());
        let values = |kind: SyntaxKind| node.child(kind).into_iter().flat_map(SyntaxNode::own_tokens);
        for value in values(SyntaxKind::Domain).filter(|token| token.kind == SyntaxKind::Name) {
            self.add(value.span, value.text, kind(), true);
        }
        let initial = values(SyntaxKind::Initial).find(|token| token.kind == SyntaxKind::Name);
        self.refer(initial, kind());
    }

    /// A vehicle, a model, or an activity after `for` of a keep-out area.
    fn closed_to(&mut self, name: SyntaxToken<'a>) {
        if let Some((fleet, _)) = name.text.split_once('[') {
            self.fleet(name, fleet);
            return;
        }
        let kind = if self.is_declared(Namespace::Vehicle, name.text) {
            NameKind::Vehicle
        } else if self.is_declared(Namespace::Callable, name.text) {
            NameKind::Activity
        } else {
            NameKind::Model
        };
        self.refer(Some(name), kind);
    }

    /// A vehicle; of a fleet's, the name of the fleet.
    fn vehicle(&mut self, name: Option<SyntaxToken<'_>>) {
        let Some(name) = name else { return };
        match name.text.split_once('[') {
            Some((fleet, _)) => self.fleet(name, fleet),
            None => self.refer_to(name, NameKind::Vehicle),
        }
    }

    fn fleet(&mut self, name: SyntaxToken<'_>, fleet: &str) {
        let start = name.span.start;
        self.add(Span::new(start, start + fleet.len() as u32), fleet, NameKind::Group, false);
    }

    fn resource(&mut self, name: Option<SyntaxToken<'_>>) {
        if let Some(name) = name {
            self.refer_to(name, NameKind::Resource);
        }
    }

    /// `vehicle R1, S[1..4] : MODEL at PLACE`
    fn vehicles(&mut self, node: SyntaxNode<'_>) {
        let mut elements =
            node.elements().skip_while(|element| matches!(element, Element::Node(_))).skip(1).peekable();
        let mut is_behind_colon = false;
        while let Some(element) = elements.next() {
            let Element::Token(token) = element else { continue };
            match token.kind {
                SyntaxKind::Colon => is_behind_colon = true,
                SyntaxKind::Name if is_behind_colon => self.refer(Some(token), NameKind::Model),
                SyntaxKind::Name => {
                    let is_fleet = matches!(elements.peek(), Some(Element::Node(next)) if next.kind() == SyntaxKind::FleetRange);
                    self.define(Some(token), if is_fleet { NameKind::Group } else { NameKind::Vehicle });
                }
                _ => {}
            }
        }
    }

    /// A member of a group.
    fn member(&mut self, name: SyntaxToken<'_>) {
        if let Some((fleet, _)) = name.text.split_once('[') {
            self.fleet(name, fleet);
            return;
        }
        let namespaces = [
            (Namespace::Vehicle, NameKind::Vehicle),
            (Namespace::Group, NameKind::Group),
            (Namespace::Location, NameKind::Location),
        ];
        let declared = namespaces.into_iter().find(|(namespace, _)| self.is_declared(*namespace, name.text));
        self.refer(Some(name), declared.map_or(NameKind::Symbol, |(_, kind)| kind));
    }

    /// What a parameter represents, if it is the name of something.
    fn kind(&mut self, name: Option<SyntaxToken<'_>>) {
        let Some(name) = name else { return };
        if self.is_declared(Namespace::Model, name.text) || VEHICLE_MODELS.contains(&name.text) {
            self.refer(Some(name), NameKind::Model);
        } else if self.is_declared(Namespace::Variable, name.text) {
            self.refer(Some(name), NameKind::Variable);
        }
    }

    /// `X=V` after `sets`
    fn effect(&mut self, node: SyntaxNode<'a>) {
        let mut names = node.own_tokens().filter(|token| token.kind == SyntaxKind::Name);
        if let Some(dotted) = node.child(SyntaxKind::Dotted) {
            if !is_mode(dotted) {
                let kind = value_kind(dotted);
                names.for_each(|value| self.refer_to(value, kind.clone()));
            }
            return;
        }
        let (Some(variable), value) = (names.next(), names.next()) else { return };
        self.refer_to(variable, NameKind::Variable);
        if let Some(value) = value {
            self.refer_to(value, NameKind::Value(variable.text.into()));
        }
    }

    fn is_declared(&self, namespace: Namespace, text: &str) -> bool {
        let symbol = self.meaning.names.find(text);
        symbol.is_some_and(|symbol| self.meaning.index.facts(symbol).definition(namespace).is_some())
    }

    fn argument(&mut self, name: Option<SyntaxToken<'_>>) {
        let Some(name) = name else { return };
        if let Some((fleet, _)) = name.text.split_once('[') {
            self.fleet(name, fleet);
            return;
        }
        let kind = if self.parameters.contains(&name.text) {
            NameKind::Parameter
        } else if self.is_declared(Namespace::Location, name.text) {
            NameKind::Location
        } else if self.is_declared(Namespace::Variable, name.text) {
            NameKind::Variable
        } else if self.is_declared(Namespace::Constant, name.text) {
            NameKind::Constant
        } else if self.is_declared(Namespace::Vehicle, name.text) {
            NameKind::Vehicle
        } else if self.is_declared(Namespace::Resource, name.text) {
            NameKind::Resource
        } else {
            NameKind::Symbol
        };
        self.refer(Some(name), kind);
    }

    /// A name in an expression; what follows a number is a unit.
    fn operand(&mut self, node: SyntaxNode<'_>) {
        let Some(name) = node.token(SyntaxKind::Name) else { return };
        let is_unit = node.token(SyntaxKind::Number).is_some();
        if is_unit || self.found.iter().any(|found| found.span == name.span) {
            return;
        }
        let kind = if self.parameters.contains(&name.text) {
            NameKind::Parameter
        } else if self.is_declared(Namespace::Constant, name.text) {
            NameKind::Constant
        } else {
            NameKind::BoundName
        };
        self.refer(Some(name), kind);
    }

    fn bare(&mut self, name: Option<SyntaxToken<'a>>) {
        let Some(name) = name else { return };
        if !self.parameters.contains(&name.text) && self.is_declared(Namespace::Callable, name.text) {
            self.refer(Some(name), NameKind::Activity);
        } else {
            self.literal(name, None);
        }
    }

    fn condition(&mut self, node: SyntaxNode<'a>) {
        if node.token(SyntaxKind::Order).is_some() {
            // Of a vehicle's own resource the parts are named where its name is.
            if node.child(SyntaxKind::Dotted).is_none() {
                self.resource(node.token(SyntaxKind::Name));
            }
            return;
        }
        if let Some(dotted) = node.child(SyntaxKind::Dotted) {
            if is_mode(dotted) {
                return;
            }
            if node.child(SyntaxKind::Visible).is_some() {
                return;
            }
            let domain = node.child(SyntaxKind::Domain);
            let places = domain.unwrap_or(node).own_tokens().filter(|token| token.kind == SyntaxKind::Name);
            let kind = value_kind(dotted);
            places.for_each(|value| self.refer_to(value, kind.clone()));
            return;
        }
        if let Some(domain) = node.child(SyntaxKind::Domain) {
            self.membership(node, domain);
            return;
        }
        let mut tokens = node.own_tokens().filter(|token| token.kind == SyntaxKind::Name);
        if let Some(variable) = tokens.next() {
            let is_variable = node.own_tokens().all(|token| {
                !matches!(token.kind, SyntaxKind::Equals | SyntaxKind::NotEquals)
                    || token.span.start >= variable.span.end
            });
            if is_variable {
                self.literal(variable, tokens.next());
            }
        }
    }

    /// `X in {V, W}`
    fn membership(&mut self, node: SyntaxNode<'a>, domain: SyntaxNode<'a>) {
        let Some(variable) = node.token(SyntaxKind::Name) else { return };
        self.refer_to(variable, NameKind::Variable);
        for value in domain.own_tokens().filter(|token| token.kind == SyntaxKind::Name) {
            self.refer_to(value, NameKind::Value(variable.text.into()));
        }
    }

    fn literal(&mut self, variable: SyntaxToken<'_>, value: Option<SyntaxToken<'_>>) {
        if self.parameters.contains(&variable.text) {
            self.refer(Some(variable), NameKind::Parameter);
        } else if let Some(stem) = value.is_none().then(|| self.split(variable.text)).flatten() {
            let middle = variable.span.start + stem.len() as u32;
            self.add(Span::new(variable.span.start, middle), stem, NameKind::Variable, false);
            let value = variable.text.get(stem.len() + 1..).unwrap_or("");
            let span = Span::new(middle + 1, variable.span.end);
            self.add(span, value, NameKind::Value(stem.into()), false);
        } else {
            self.refer(Some(variable), NameKind::Variable);
        }
        if let Some(value) = value {
            self.refer_to(value, NameKind::Value(variable.text.into()));
        }
    }

    /// The variable of a condition written `X_V` (SPEC 1.3).
    fn split<'t>(&self, text: &'t str) -> Option<&'t str> {
        let names = self.meaning.names;
        let (variable, value) = text.rsplit_once('_')?;
        let whole = names.find(text)?;
        self.meaning.splits(whole, (names.find(variable)?, names.find(value)?)).then_some(variable)
    }
}
