//! Summarizes a declaration: collects what it declares and uses.

use std::hash::{Hash as _, Hasher as _};

use exact::{Bound, Rational, Time};
use rustc_hash::FxHasher;
use smol_str::SmolStr;

use super::constant;
use super::index::Namespace;
use super::names::{Names, Symbol};
use super::summary::{
    Call, ComponentState, Definition, Equipment, Literal, Origin, Summary, Use, UseKind, Vehicle,
};
use crate::control::component_modes;
use crate::lower::{Item, OptionValue, VehiclesDecl};
use crate::program::{
    Argument, ArgumentValue, Bounds, Change, Condition, ControlDecl, Expr, ExprKind, HeaderBound,
    HeaderBounds, LabelMode, ModelDecl, Name, ObstacleKind, PrimitiveDecl, Statement, StatementKind, Supply,
    VEHICLE_MODELS, state_of_component,
};
use crate::span::Span;

/// Summarizes what was lowered. `bare_names` are the starts of names that stand alone as statements.
pub(crate) fn summarize(item: Option<&Item>, bare_names: &[u32], names: &mut Names) -> Summary {
    let mut collector = Collector { names, bare_names, formals: Vec::new(), summary: Summary::default() };
    if let Some(item) = item {
        collector.item(item);
    }
    let mut summary = collector.summary;
    let mut hasher = FxHasher::default();
    for call in &summary.calls {
        // Hashing zeros gives what hashing nothing gives.
        (call.name.index() + 1, call.is_bare).hash(&mut hasher);
    }
    summary.call_fingerprint = hasher.finish();
    summary
}

struct Collector<'a> {
    names: &'a mut Names,
    bare_names: &'a [u32],
    formals: Vec<SmolStr>,
    summary: Summary,
}

impl Collector<'_> {
    fn item(&mut self, item: &Item) {
        match item {
            Item::Constant(decl) => {
                self.define(Namespace::Constant, &decl.name, 0, None, Vec::new());
                self.expression(&decl.value);
            }
            Item::Variable(decl) => {
                let values = decl.values.iter().map(|value| self.names.intern(&value.text)).collect();
                self.define(Namespace::Variable, &decl.name, 0, None, values);
                if let Some(initial) = &decl.initial {
                    self.begins_with(initial);
                }
                if let Some(definition) = &mut self.summary.definition {
                    definition.is_from_plant = decl.is_from_plant;
                }
            }
            Item::Resource(decl) => {
                self.define(Namespace::Resource, &decl.name, 0, None, Vec::new());
                self.supply(&decl.supply);
            }
            Item::Objective(decl) => {
                let word = "objective";
                let span = Span::new(decl.span.start, decl.span.start + word.len() as u32);
                let name = Name { text: SmolStr::new_static(word), span };
                self.define(Namespace::Objective, &name, 0, None, Vec::new());
            }
            Item::Primitive(decl) => {
                let bounds = decl.bounds.as_ref().and_then(constant::interval);
                self.define(Namespace::Callable, &decl.name, decl.formals.len(), bounds, Vec::new());
                if let Some(definition) = self.summary.definition.as_mut().filter(|_| decl.moves.is_some()) {
                    definition.moves = true;
                    definition.fingerprint ^= 1 << 2;
                }
                let is_contingent = decl.bounds.as_ref().is_some_and(|bounds| bounds.is_contingent);
                if let Some(definition) = self.summary.definition.as_mut().filter(|_| is_contingent) {
                    definition.is_contingent = true;
                    definition.fingerprint ^= 1 << 3;
                }
                self.formals = decl.formals.iter().map(|formal| formal.text.clone()).collect();
                self.summary.numbers.clone_from(&decl.formals);
                self.bounds(decl.bounds.as_ref());
                for vehicle in decl.moves.iter().flat_map(|moves| &moves.vehicles) {
                    if self.formals.contains(&vehicle.text) {
                        self.summary.moves_a_parameter = true;
                    } else {
                        self.name_use(UseKind::Vehicle, &vehicle.text, vehicle.span);
                    }
                }
                self.clauses(decl);
            }
            Item::Activity(decl) => {
                let bounds = header_interval(&decl.bounds);
                self.define(Namespace::Callable, &decl.name, decl.formals.len(), bounds, Vec::new());
                self.summary.start = decl.span.start;
                if let Some(definition) = &mut self.summary.definition {
                    definition.is_activity = true;
                    definition.fingerprint ^= 1;
                }
                self.formals = decl.formals.iter().map(|formal| formal.text.clone()).collect();
                self.summary.numbers.clone_from(&decl.formals);
                self.header(&decl.bounds);
                self.statement(&decl.body);
            }
            Item::Scenario(decl) => {
                self.define(Namespace::Scenario, &decl.name, 0, None, Vec::new());
                self.summary.start = decl.span.start;
                self.bounds(decl.bounds.as_ref());
                self.statement(&decl.body);
            }
            Item::Option(decl) => {
                self.define(Namespace::Option, &decl.name, 0, None, Vec::new());
                if decl.name.text == "strict" {
                    self.summary.strict =
                        Some(matches!(decl.value, OptionValue::Number(value) if value == Rational::ONE));
                }
            }
            Item::Terrain(decl) => {
                let name = Name { text: SmolStr::new_static("terrain"), span: decl.asset_span };
                self.define(Namespace::Terrain, &name, 0, None, Vec::new());
            }
            Item::Constrain(decl) => {
                for event in [&decl.from, &decl.to] {
                    self.name_use(UseKind::Occurrence, &event.name.text, event.name.span);
                }
                self.bounds(Some(&decl.bounds));
            }
            Item::Control(decl) => self.components(decl),
            Item::Import(_) => {}
            Item::Location(decl) => self.define(Namespace::Location, &decl.name, 0, None, Vec::new()),
            Item::Obstacle(decl) => {
                self.define(Namespace::Obstacle, &decl.name, 0, None, Vec::new());
                if let ObstacleKind::KeepOut { closed_to } = &decl.kind {
                    for name in closed_to {
                        self.name_use(UseKind::ClosedTo, &name.text, name.span);
                    }
                }
            }
            Item::Vehicles(decl) => self.vehicles(decl),
            Item::Model(decl) => self.model(decl),
            Item::Group(decl) => {
                self.define(Namespace::Group, &decl.name, 0, None, Vec::new());
                for member in &decl.members {
                    self.name_use(UseKind::Member, &member.text, member.span);
                }
            }
        }
    }

    fn vehicles(&mut self, decl: &VehiclesDecl) {
        let model = self.names.intern(&decl.model.text);
        let mut all = Vec::new();
        for vehicle in &decl.vehicles {
            self.define(Namespace::Vehicle, &vehicle.name, 0, None, Vec::new());
            self.begins_with(&decl.start);
            if let Some(mut definition) = self.summary.definition.take() {
                definition.model = (!VEHICLE_MODELS.contains(&decl.model.text.as_str())).then_some(model);
                all.push(definition);
            }
        }
        for fleet in &decl.fleets {
            self.define(Namespace::Group, &fleet.name, 0, None, Vec::new());
            all.extend(self.summary.definition.take());
        }
        let mut all = all.into_iter();
        self.summary.definition = all.next();
        self.summary.others = all.collect();
        self.name_use(UseKind::Start, &decl.start.text, decl.start.span);
        self.name_use(UseKind::Model, &decl.model.text, decl.model.span);
    }

    fn model(&mut self, decl: &ModelDecl) {
        self.define(Namespace::Model, &decl.name, 0, None, Vec::new());
        let parent = decl.parent.as_ref().map(|parent| self.names.intern(&parent.text));
        let mut equipment = Vec::new();
        for resource in &decl.resources {
            let name = self.names.intern(&resource.name.text);
            equipment.push(Equipment { name, values: Vec::new(), initial: None });
            self.supply(&resource.supply);
        }
        for state in &decl.states {
            let name = self.names.intern(&state.name.text);
            let values = state.values.iter().map(|value| self.names.intern(&value.text)).collect();
            let initial = state.initial.as_ref().map(|initial| self.names.intern(&initial.text));
            equipment.push(Equipment { name, values, initial });
        }
        if let Some(definition) = &mut self.summary.definition {
            (definition.model, definition.equipment) = (parent, equipment);
        }
        if let Some(parent) = &decl.parent {
            self.name_use(UseKind::Model, &parent.text, parent.span);
        }
    }

    fn supply(&mut self, supply: &Supply) {
        match supply {
            Supply::Reusable { capacity } => capacity.iter().for_each(|it| self.expression(it)),
            Supply::Reservoir { least, greatest, level } => {
                for level in [least, greatest, level] {
                    self.expression(level);
                }
            }
        }
    }

    /// A use of a resource; what a parameter represents, or whose vehicle it does, is known at the call.
    fn resource(&mut self, kind: UseKind, name: &Name) {
        let owner = name.text.split_once('.').map(|(owner, _)| SmolStr::new(owner));
        let is_formal = |name: &SmolStr| self.formals.contains(name);
        if !is_formal(&name.text) && !owner.as_ref().is_some_and(is_formal) {
            self.name_use(kind, &name.text, name.span);
        }
    }

    /// What the declared variable is at first.
    fn components(&mut self, decl: &ControlDecl) {
        let components = component_modes(&crate::control::parse(&decl.text).file);
        let states = components.into_iter().map(|component| ComponentState {
            name: self.names.intern(&state_of_component(&component.name)),
            modes: component.modes.iter().map(|mode| self.names.intern(mode)).collect(),
            initial: self.names.intern(&component.initial),
        });
        self.summary.components = states.collect();
    }

    fn begins_with(&mut self, initial: &Name) {
        let symbol = self.names.intern(&initial.text);
        if let Some(definition) = &mut self.summary.definition {
            definition.initial = Some(symbol);
            definition.fingerprint ^= (symbol.index() as u64 + 1) << 8;
        }
    }

    fn clauses(&mut self, decl: &PrimitiveDecl) {
        self.summary.start = decl.span.start;
        for requirement in &decl.requires {
            self.literal(LabelMode::Ask, &requirement.condition, Origin::Written, false);
        }
        for effect in &decl.sets {
            let condition = Condition {
                variable: effect.variable.clone(),
                values: vec![effect.value.clone()],
                sees: None,
                level: None,
                negated: false,
                span: effect.span,
            };
            self.literal(LabelMode::Tell, &condition, Origin::Effect, false);
        }
        for used in &decl.uses {
            self.resource(UseKind::Resource(used.change), &used.resource);
        }
        let amounts = decl.uses.iter().filter_map(|used| used.amount.as_ref()).chain(&decl.costs);
        for expression in amounts.map(|amount| &amount.value).chain(&decl.rewards) {
            self.expression(expression);
        }
        if let Some(aborts) = &decl.aborts {
            self.expression(&aborts.lower);
            self.expression(&aborts.upper);
        }
    }

    fn define(
        &mut self,
        namespace: Namespace,
        name: &Name,
        arity: usize,
        bounds: Option<(Time, Bound)>,
        values: Vec<Symbol>,
    ) {
        let symbol = self.names.intern(&name.text);
        let mut hasher = FxHasher::default();
        (namespace, arity, bounds, &values).hash(&mut hasher);
        self.summary.definition = Some(Definition {
            namespace,
            name: symbol,
            span: name.span,
            arity: arity as u32,
            bounds,
            is_contingent: false,
            values,
            initial: None,
            is_from_plant: false,
            is_activity: false,
            moves: false,
            model: None,
            equipment: Vec::new(),
            // The lowest bit says activity or primitive.
            fingerprint: (hasher.finish() & !1) | 2,
        });
    }

    fn name_use(&mut self, kind: UseKind, text: &SmolStr, span: Span) {
        let name = self.names.intern(text);
        self.summary.uses.push(Use { kind, name, span });
    }

    /// The names of a header's bounds represent numbers in the body, unless they are constants: which they are is
    /// known once the whole file is.
    fn header(&mut self, bounds: &HeaderBounds) {
        let HeaderBounds::Sides { lower, upper, .. } = bounds else { return };
        for side in [lower, upper] {
            if let HeaderBound::Parameter(name) = side {
                self.summary.numbers.push(name.clone());
                self.name_use(UseKind::HeaderBound, &name.text, name.span);
            }
        }
        for side in [lower, upper] {
            if let HeaderBound::Limit(limit) = side {
                self.expression(limit);
            }
        }
    }

    fn bounds(&mut self, bounds: Option<&Bounds>) {
        self.summary.has_contingents |= bounds.is_some_and(|bounds| bounds.is_contingent);
        for side in bounds.iter().flat_map(|bounds| [&bounds.lower, &bounds.upper]) {
            self.expression(side);
        }
    }

    fn expression(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Name(text) => {
                if self.summary.numbers.iter().all(|name| name.text != *text) {
                    self.name_use(UseKind::Number, text, expr.span);
                }
            }
            ExprKind::Percent(inner) => self.expression(inner),
            ExprKind::Binary(_, left, right) => {
                self.expression(left);
                self.expression(right);
            }
            ExprKind::Number(_) | ExprKind::Duration(..) | ExprKind::Infinity => {}
        }
    }

    fn statement(&mut self, statement: &Statement) {
        self.bounds(statement.bounds.as_ref());
        match &statement.kind {
            StatementKind::Sequence(parts)
            | StatementKind::Parallel(parts)
            | StatementKind::Choose(parts)
            | StatementKind::Unordered(parts) => {
                for part in parts {
                    self.statement(part);
                }
            }
            StatementKind::Maintaining(body, condition) => {
                self.statement(body);
                self.literal(LabelMode::Ask, condition, Origin::Written, false);
            }
            StatementKind::Watching(body, condition) => {
                self.statement(body);
                let denied = Condition { negated: !condition.negated, ..condition.clone() };
                self.literal(LabelMode::Tell, &denied, Origin::Watched, false);
            }
            StatementKind::IfThennext(condition, body) => {
                self.literal(LabelMode::Ask, condition, Origin::Written, false);
                self.statement(body);
            }
            StatementKind::Named(body, name) => {
                let symbol = self.names.intern(&name.text);
                self.summary.occurrences.push(symbol);
                self.statement(body);
            }
            StatementKind::Repeat(count, body) => {
                self.expression(count);
                self.statement(body);
            }
            StatementKind::Members(members) => {
                if !self.formals.contains(&members.group.text) {
                    self.name_use(UseKind::Group, &members.group.text, members.group.span);
                }
                // What represents a member is like a parameter.
                self.formals.push(members.variable.text.clone());
                self.summary.numbers.push(members.variable.clone());
                self.statement(&members.body);
                self.formals.pop();
                self.summary.numbers.pop();
            }
            StatementKind::Telling(body, condition) => {
                self.statement(body);
                self.literal(LabelMode::Tell, condition, Origin::Written, false);
            }
            StatementKind::Using(body, resource, amount) => {
                self.statement(body);
                self.resource(UseKind::Resource(Change::Uses), resource);
                if let Some(amount) = amount {
                    self.expression(amount);
                }
            }
            StatementKind::Call(name, arguments) => {
                let call = self.summary.calls.len() as u32;
                for argument in arguments {
                    match &argument.value {
                        ArgumentValue::Name(text) if !self.formals.contains(text) => {
                            let owner = owner_of_equipment(text).map(SmolStr::new);
                            if owner.is_none_or(|owner| !self.formals.contains(&owner)) {
                                self.name_use(UseKind::Argument(call), text, argument.span);
                            }
                        }
                        ArgumentValue::Expression(expr) => self.expression(expr),
                        // What it is used for, asked or told, is known where the parameter is.
                        ArgumentValue::Condition(condition) => {
                            self.literal(LabelMode::Tell, condition, Origin::Argument, false);
                        }
                        ArgumentValue::Name(_) | ArgumentValue::Number(_) => {}
                    }
                }
                let is_formal = |argument: &Argument| matches!(&argument.value, ArgumentValue::Name(text) if self.formals.contains(text));
                let has_formal_argument = arguments.iter().any(is_formal);
                self.call(name, arguments.len(), statement, false);
                if let Some(call) = self.summary.calls.last_mut() {
                    call.has_formal_argument = has_formal_argument;
                }
            }
            StatementKind::Condition(mode, condition) => {
                let is_bare = self.bare_names.binary_search(&condition.variable.span.start).is_ok();
                if is_bare {
                    self.call(&condition.variable, 0, statement, true);
                }
                self.literal(*mode, condition, Origin::Written, is_bare);
            }
            StatementKind::Delay => {}
        }
    }

    fn call(&mut self, name: &Name, arguments: usize, statement: &Statement, is_bare: bool) {
        if is_bare && self.formals.contains(&name.text) {
            return;
        }
        let bounds = statement.bounds.as_ref();
        let end = bounds.map_or(statement.span.end, |bounds| bounds.span.start);
        let call = Call {
            name: self.names.intern(&name.text),
            span: name.span,
            with_arguments: Span::new(name.span.start, end.max(name.span.end)),
            arguments: arguments as u32,
            has_formal_argument: false,
            bounds: bounds.and_then(|bounds| Some((constant::interval(bounds)?, bounds.span))),
            contingent: bounds.filter(|bounds| bounds.is_contingent).map(|bounds| bounds.span),
            is_bare,
        };
        self.summary.calls.push(call);
    }

    fn literal(&mut self, mode: LabelMode, condition: &Condition, origin: Origin, is_bare: bool) {
        let text = &condition.variable.text;
        if let Some(level) = &condition.level {
            self.resource(UseKind::Level, &condition.variable);
            self.expression(&level.bound);
            return;
        }
        let vehicle = text.strip_suffix(".at").map(|owner| {
            // What is written may be longer than what is meant, where a dash represents a hyphen.
            let Span { start, end } = condition.variable.span;
            let owner = SmolStr::new(owner);
            Vehicle {
                name: self.names.intern(&owner),
                span: Span::new(start, end - ".at".len() as u32),
                is_formal: self.formals.contains(&owner),
            }
        });
        let places = condition.values.iter().filter(|_| vehicle.is_some());
        for value in places.chain(&condition.sees) {
            if !self.formals.contains(&value.text) {
                self.name_use(UseKind::Place, &value.text, value.span);
            }
        }
        let is_atom = condition.values.is_empty() && condition.sees.is_none();
        let split = text.rsplit_once('_').filter(|_| is_atom);
        let split = split.filter(|(variable, value)| !variable.is_empty() && !value.is_empty());
        let literal = Literal {
            mode,
            variable: self.names.intern(text),
            variable_span: condition.variable.span,
            values: condition
                .values
                .iter()
                .map(|value| (self.names.intern(&value.text), value.span))
                .collect(),
            split: split.map(|(variable, value)| {
                (self.names.intern(&SmolStr::new(variable)), self.names.intern(&SmolStr::new(value)))
            }),
            negated: condition.negated,
            span: condition.span,
            variable_is_formal: self.formals.contains(text)
                || owner_of_equipment(text).is_some_and(|owner| self.formals.contains(&SmolStr::new(owner))),
            value_is_formal: condition.values.iter().any(|value| self.formals.contains(&value.text)),
            is_sight: condition.sees.is_some(),
            is_bare,
            origin,
            vehicle,
        };
        self.summary.literals.push(literal);
    }
}

/// The vehicle or component that owns the state of this name; `None` for the place of a vehicle.
fn owner_of_equipment(variable: &str) -> Option<&str> {
    variable.split_once('.').filter(|(_, part)| *part != "at").map(|(owner, _)| owner)
}

fn header_interval(bounds: &HeaderBounds) -> Option<(Time, Bound)> {
    let HeaderBounds::Sides { lower, upper, .. } = bounds else { return None };
    let lower = match lower {
        HeaderBound::Parameter(_) => Time::ZERO,
        HeaderBound::Limit(limit) => constant::evaluate(limit).ok()?.finite()?,
    };
    let upper = match upper {
        HeaderBound::Parameter(_) => Bound::Infinite,
        HeaderBound::Limit(limit) => constant::evaluate(limit).ok()?,
    };
    (lower >= Time::ZERO && Bound::Finite(lower) <= upper).then_some((lower, upper))
}
