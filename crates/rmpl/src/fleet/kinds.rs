//! What parameters represent (SPEC 17): what is written, otherwise what their uses require; and whether uses and
//! arguments agree with it.
//!
//! Only vehicles, locations, numbers and resources are inferred. A name may well be a value and a location, or an atom
//! and a location, so that such uses decide nothing.

use std::collections::{BTreeMap, BTreeSet};

use smol_str::SmolStr;

use super::{GroupKind, Groups, is_of};
use crate::diagnostic::Diagnostic;
use crate::diagnostics::kind as wording;
use crate::program::{
    ArgumentValue, Bounds, Condition, Expr, ExprKind, HeaderBound, HeaderBounds, Members, Name, Program,
    Statement, StatementKind, VEHICLE_MODELS, World, component_of_state,
};
use crate::span::Span;

/// What a parameter represents.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Kind {
    /// A vehicle, whatever its model.
    Vehicle,
    /// Of this model, or of one that extends it.
    VehicleOf(SmolStr),
    Location,
    Number,
    Resource,
    Condition,
    /// A value of this variable.
    ValueOf(SmolStr),
}

impl Kind {
    fn one(&self) -> String {
        match self {
            Self::Vehicle => "a vehicle".to_owned(),
            Self::VehicleOf(model) => format!("a vehicle of the model `{model}`"),
            Self::Location => "a location".to_owned(),
            Self::Number => "a number".to_owned(),
            Self::Resource => "a resource".to_owned(),
            Self::Condition => "a condition".to_owned(),
            Self::ValueOf(state) => format!("a value of `{state}`"),
        }
    }

    /// Returns whether what is of this kind can be used as `needed`.
    fn fits(&self, needed: &Self, world: &World) -> bool {
        match (self, needed) {
            (Self::VehicleOf(own), Self::VehicleOf(model)) => is_of(world, own, model),
            (Self::VehicleOf(_), Self::Vehicle) => true,
            // The same name may be both.
            _ => self == needed || !is_strong(self) || !is_strong(needed),
        }
    }
}

/// Returns whether a kind excludes others: the same name may well be a value, or stand in a condition.
const fn is_strong(kind: &Kind) -> bool {
    !matches!(kind, Kind::Condition | Kind::ValueOf(_))
}

/// A parameter: the activity or primitive, by its position among both, and the position in its header.
type Parameter = (usize, usize);

/// A use of a parameter that needs a kind, and where.
#[derive(Clone, Debug)]
struct Use {
    kind: Kind,
    span: Span,
}

/// The header of an activity or a primitive.
struct Header<'program> {
    name: &'program Name,
    formals: &'program [Name],
    kinds: &'program [Option<Name>],
}

pub(super) fn check(program: &Program, groups: &Groups) -> Vec<Diagnostic> {
    let headers: Vec<Header<'_>> = (program.primitives.iter())
        .map(|it| Header { name: &it.name, formals: &it.formals, kinds: &it.kinds })
        .chain(program.activities.iter().map(|it| Header {
            name: &it.name,
            formals: &it.formals,
            kinds: &it.kinds,
        }))
        .collect();
    let mut by_name = BTreeMap::new();
    for (index, header) in headers.iter().enumerate() {
        by_name.entry(header.name.text.as_str()).or_insert(index);
    }
    let mut kinds = Kinds {
        program,
        groups,
        known: Known::new(program),
        headers,
        by_name,
        decided: BTreeMap::new(),
        uses: BTreeMap::new(),
        handed: BTreeMap::new(),
        calls: Vec::new(),
        here: None,
        variables: Vec::new(),
        found: Vec::new(),
    };
    kinds.written();
    kinds.collect();
    kinds.infer();
    kinds.check_uses();
    kinds.check_arguments();
    kinds.found
}

/// What the names of a mission are.
struct Known<'program> {
    vehicles: BTreeMap<&'program str, &'program str>,
    locations: BTreeSet<&'program str>,
    resources: BTreeSet<&'program str>,
    constants: BTreeSet<&'program str>,
    domains: BTreeMap<&'program str, BTreeSet<&'program str>>,
}

impl<'program> Known<'program> {
    fn new(program: &'program Program) -> Self {
        let World { vehicles, locations, .. } = &program.world;
        Self {
            vehicles: vehicles.iter().map(|it| (it.name.text.as_str(), it.model.text.as_str())).collect(),
            locations: locations.iter().map(|it| it.name.text.as_str()).collect(),
            resources: program.resources.iter().map(|it| it.name.text.as_str()).collect(),
            constants: program.constants.iter().map(|it| it.name.text.as_str()).collect(),
            domains: (program.variables.iter())
                .map(|it| {
                    let values = it.values.iter().map(|value| value.text.as_str()).collect();
                    (it.name.text.as_str(), values)
                })
                .collect(),
        }
    }

    /// Returns what a name is, for messages; nothing if it may be anything.
    fn describe(&self, name: &str) -> Option<&'static str> {
        if self.vehicles.contains_key(name) {
            Some("a vehicle")
        } else if self.locations.contains(name) {
            Some("a location")
        } else if self.resources.contains(name) {
            Some("a resource")
        } else if self.constants.contains(name) {
            Some("a constant")
        } else {
            None
        }
    }

    /// Returns whether a name is of a kind.
    fn is(&self, name: &str, kind: &Kind, world: &World) -> bool {
        match kind {
            Kind::Vehicle => self.vehicles.contains_key(name),
            Kind::VehicleOf(model) => self.vehicles.get(name).is_some_and(|own| is_of(world, own, model)),
            Kind::Location => self.locations.contains(name),
            Kind::Number => self.constants.contains(name),
            Kind::Resource => self.resources.contains(name),
            Kind::Condition => self.describe(name).is_none(),
            Kind::ValueOf(state) => {
                self.domains.get(state.as_str()).is_none_or(|domain| domain.contains(name))
            }
        }
    }
}

/// A call with the parameters and variables that mean something there.
struct Call<'program> {
    callee: usize,
    arguments: &'program [crate::program::Argument],
    /// The activity around it.
    here: Option<usize>,
    /// What represents members there, each with the group.
    variables: Vec<(&'program str, &'program str)>,
}

struct Kinds<'program> {
    program: &'program Program,
    groups: &'program Groups,
    known: Known<'program>,
    headers: Vec<Header<'program>>,
    by_name: BTreeMap<&'program str, usize>,
    /// What is known of parameters, and the place that says it.
    decided: BTreeMap<Parameter, Use>,
    /// The uses of each parameter that need a kind, in textual order.
    uses: BTreeMap<Parameter, Vec<Use>>,
    /// By parameter, the parameters that are handed on to it, and where.
    handed: BTreeMap<Parameter, Vec<(Parameter, Span)>>,
    calls: Vec<Call<'program>>,
    /// The declaration being read.
    here: Option<usize>,
    /// What represents members there, each with the group.
    variables: Vec<(&'program str, &'program str)>,
    found: Vec<Diagnostic>,
}

impl<'program> Kinds<'program> {
    /// Reads the kinds that are written.
    fn written(&mut self) {
        let world = &self.program.world;
        for (at, header) in self.headers.iter().enumerate() {
            for (index, written) in header.kinds.iter().enumerate() {
                let Some(written) = written else { continue };
                let text = written.text.as_str();
                let is_model = VEHICLE_MODELS.contains(&text)
                    || world.models.iter().any(|model| model.name.text == text);
                let kind = match text {
                    "vehicle" => Kind::Vehicle,
                    "location" => Kind::Location,
                    "number" => Kind::Number,
                    "resource" => Kind::Resource,
                    "condition" => Kind::Condition,
                    _ if is_model => Kind::VehicleOf(written.text.clone()),
                    _ if self.known.domains.contains_key(text) => Kind::ValueOf(written.text.clone()),
                    _ => {
                        self.found.push(wording::unknown(written));
                        continue;
                    }
                };
                self.decided.insert((at, index), Use { kind, span: written.span });
            }
        }
    }

    /// Collects what uses need, and all calls.
    fn collect(&mut self) {
        let program = self.program;
        for (at, primitive) in program.primitives.iter().enumerate() {
            self.here = Some(at);
            for vehicle in primitive.moves.iter().flat_map(|moves| &moves.vehicles) {
                self.needs(&vehicle.text, Kind::Vehicle, vehicle.span);
            }
            self.bounds(primitive.bounds.as_ref());
            for required in &primitive.requires {
                self.condition(&required.condition);
            }
            for effect in &primitive.sets {
                self.variable(&effect.variable);
                if effect.variable.text.ends_with(".at") {
                    self.needs(&effect.value.text, Kind::Location, effect.value.span);
                }
            }
            for used in &primitive.uses {
                self.resource(&used.resource);
                used.amount.iter().for_each(|amount| self.expression(&amount.value));
            }
            primitive.costs.iter().for_each(|amount| self.expression(&amount.value));
            primitive.rewards.iter().for_each(|reward| self.expression(reward));
            self.bounds(primitive.aborts.as_deref());
        }
        for (index, activity) in program.activities.iter().enumerate() {
            self.here = Some(program.primitives.len() + index);
            if let HeaderBounds::Sides { lower, upper, .. } = &activity.bounds {
                for side in [lower, upper] {
                    if let HeaderBound::Limit(limit) = side {
                        self.expression(limit);
                    }
                }
            }
            self.statement(&activity.body);
        }
        self.here = None;
        for scenario in &program.scenarios {
            self.statement(&scenario.body);
        }
    }

    fn parameter(&self, here: Option<usize>, name: &str) -> Option<Parameter> {
        let at = here?;
        Some((at, self.headers[at].formals.iter().position(|formal| formal.text == name)?))
    }

    /// Notes that a name is used as `kind`, if it is a parameter; checks what `any` and `each` range over at once.
    fn needs(&mut self, name: &str, kind: Kind, span: Span) {
        if let Some((_, group)) = self.variables.iter().rev().find(|(variable, _)| *variable == name) {
            let own = match self.groups.kind(group) {
                Some(GroupKind::Vehicles) => Kind::Vehicle,
                Some(GroupKind::Locations) => Kind::Location,
                _ => return,
            };
            if !own.fits(&kind, &self.program.world) {
                let (first, second) = (own.one(), kind.one());
                let [error, _] = wording::two_uses(name, (&first, span), (&second, span));
                self.found.push(error);
            }
            return;
        }
        if let Some(parameter) = self.parameter(self.here, name) {
            self.uses.entry(parameter).or_default().push(Use { kind, span });
        }
    }

    /// The owner of `r.battery` is a vehicle.
    fn variable(&mut self, name: &Name) {
        if component_of_state(&name.text).is_none()
            && let Some((owner, _)) = name.text.split_once('.')
        {
            let span = Span::new(name.span.start, name.span.start + owner.len() as u32);
            self.needs(owner, Kind::Vehicle, span);
        }
    }

    fn resource(&mut self, name: &Name) {
        if name.text.contains('.') {
            self.variable(name);
        } else {
            self.needs(&name.text, Kind::Resource, name.span);
        }
    }

    fn condition(&mut self, condition: &Condition) {
        if let Some(level) = &condition.level {
            self.resource(&condition.variable);
            self.expression(&level.bound);
            return;
        }
        self.variable(&condition.variable);
        let is_place = condition.variable.text.ends_with(".at");
        for place in condition.values.iter().filter(|_| is_place).chain(&condition.sees) {
            self.needs(&place.text, Kind::Location, place.span);
        }
    }

    fn expression(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Name(name) => self.needs(name, Kind::Number, expr.span),
            ExprKind::Percent(inner) => self.expression(inner),
            ExprKind::Binary(_, left, right) => {
                self.expression(left);
                self.expression(right);
            }
            ExprKind::Number(_) | ExprKind::Duration(..) | ExprKind::Infinity => {}
        }
    }

    fn bounds(&mut self, bounds: Option<&Bounds>) {
        for side in bounds.iter().flat_map(|bounds| [&bounds.lower, &bounds.upper]) {
            self.expression(side);
        }
    }

    fn statement(&mut self, statement: &'program Statement) {
        self.bounds(statement.bounds.as_ref());
        match &statement.kind {
            StatementKind::Maintaining(_, condition)
            | StatementKind::Watching(_, condition)
            | StatementKind::Telling(_, condition)
            | StatementKind::IfThennext(condition, _)
            | StatementKind::Condition(_, condition) => self.condition(condition),
            StatementKind::Repeat(count, _) => self.expression(count),
            StatementKind::Using(_, resource, amount) => {
                self.resource(resource);
                if let Some(amount) = amount {
                    self.expression(amount);
                }
            }
            StatementKind::Call(name, arguments) => {
                for argument in arguments {
                    match &argument.value {
                        ArgumentValue::Condition(condition) => self.condition(condition),
                        ArgumentValue::Expression(expr) => self.expression(expr),
                        ArgumentValue::Name(text) => {
                            self.variable(&Name { text: text.clone(), span: argument.span });
                        }
                        ArgumentValue::Number(_) => {}
                    }
                }
                let is_formal = self.parameter(self.here, &name.text).is_some();
                if let Some(&callee) = self.by_name.get(name.text.as_str()).filter(|_| !is_formal) {
                    let (here, variables) = (self.here, self.variables.clone());
                    self.calls.push(Call { callee, arguments, here, variables });
                }
            }
            StatementKind::Members(Members { variable, group, body, .. }) => {
                self.variables.push((variable.text.as_str(), group.text.as_str()));
                self.statement(body);
                self.variables.pop();
                return;
            }
            _ => {}
        }
        statement.parts().iter().for_each(|part| self.statement(part));
    }

    /// Finds out what parameters represent from their first use, or from that of the parameter that they are handed to.
    fn infer(&mut self) {
        for call in &self.calls {
            for (index, argument) in call.arguments.iter().enumerate() {
                if let ArgumentValue::Name(name) = &argument.value
                    && call.variables.iter().all(|(variable, _)| *variable != name.as_str())
                    && let Some(parameter) = self.parameter(call.here, name)
                {
                    self.handed.entry((call.callee, index)).or_default().push((parameter, argument.span));
                }
            }
        }
        let mut open: Vec<Parameter> = self.decided.keys().copied().collect();
        for (&parameter, uses) in &self.uses {
            if let Some(first) = uses.first()
                && !self.decided.contains_key(&parameter)
            {
                self.decided.insert(parameter, first.clone());
                open.push(parameter);
            }
        }
        while let Some(parameter) = open.pop() {
            let kind = self.decided[&parameter].kind.clone();
            for &(outer, span) in self.handed.get(&parameter).into_iter().flatten() {
                let used = Use { kind: kind.clone(), span };
                self.uses.entry(outer).or_default().push(used.clone());
                let is_written = self.headers[outer.0].kinds.get(outer.1).is_some_and(Option::is_some);
                let known = self.decided.get(&outer).map(|known| &known.kind);
                // What is inferred is as narrow as all uses together.
                let is_narrower = known.is_none_or(|known| {
                    !is_written && *known != kind && kind.fits(known, &self.program.world) && is_strong(known)
                });
                if is_narrower {
                    self.decided.insert(outer, used);
                    open.push(outer);
                }
            }
        }
    }

    /// Uses of one parameter that need different kinds.
    fn check_uses(&mut self) {
        for (parameter, uses) in &self.uses {
            let Some(decided) = self.decided.get(parameter) else { continue };
            let name = &self.headers[parameter.0].formals[parameter.1].text;
            let world = &self.program.world;
            // One mistake is told once, however many uses follow it.
            if let Some(other) = uses.iter().find(|used| !decided.kind.fits(&used.kind, world)) {
                let (first, second) = (decided.kind.one(), other.kind.one());
                self.found.extend(wording::two_uses(name, (&first, decided.span), (&second, other.span)));
            }
        }
    }

    /// Arguments that are not what their parameters represent.
    fn check_arguments(&mut self) {
        for call in &self.calls {
            let header = &self.headers[call.callee];
            for (index, argument) in call.arguments.iter().enumerate().take(header.formals.len()) {
                let Some(decided) = self.decided.get(&(call.callee, index)) else { continue };
                let is_written = header.kinds.get(index).is_some_and(Option::is_some);
                let Some((text, is)) = self.mismatch(call, &argument.value, &decided.kind, is_written) else {
                    continue;
                };
                let (parameter, kind) = (&header.formals[index].text, decided.kind.one());
                let callee = (header.name.text.as_str(), parameter.as_str(), kind.as_str());
                let argument_is = (text.as_str(), is);
                self.found.extend(wording::argument(argument_is, callee, argument.span, decided.span));
            }
        }
    }

    /// An argument that is not of `kind`, and what it is.
    fn mismatch(
        &self,
        call: &Call<'_>,
        argument: &ArgumentValue,
        kind: &Kind,
        is_written: bool,
    ) -> Option<(SmolStr, Option<&'static str>)> {
        let world = &self.program.world;
        match argument {
            ArgumentValue::Name(name) => {
                if let Some((_, group)) = call.variables.iter().rev().find(|(it, _)| *it == name.as_str()) {
                    let members = self.groups.members(group).unwrap_or_default();
                    let other = members.iter().find(|member| !self.known.is(member, kind, world))?;
                    return Some((other.clone(), self.known.describe(other)));
                }
                let is_owned = name.split_once('.').is_some_and(|(owner, _)| {
                    self.parameter(call.here, owner).is_some()
                        || call.variables.iter().any(|(variable, _)| *variable == owner)
                });
                if is_owned || self.parameter(call.here, name).is_some() || self.known.is(name, kind, world) {
                    return None;
                }
                let is = self.known.describe(name);
                (is_written || is.is_some()).then(|| (name.clone(), is))
            }
            ArgumentValue::Number(number) => {
                let text = SmolStr::from(number.to_string());
                let fits = match kind {
                    Kind::Number => true,
                    Kind::ValueOf(_) => self.known.is(&text, kind, world),
                    _ => false,
                };
                (!fits).then_some((text, Some("a number")))
            }
            ArgumentValue::Expression(_) => {
                (*kind != Kind::Number).then_some(("this".into(), Some("a number")))
            }
            ArgumentValue::Condition(condition) => {
                (*kind != Kind::Condition).then(|| (condition.variable.text.clone(), Some("in a condition")))
            }
        }
    }
}
