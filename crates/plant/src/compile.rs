//! From the model part of a text that passes all checks to a [`Model`] (SPEC 2.2).

use std::collections::BTreeMap;

use num_integer::gcd;
use rmpl::control::{
    Constraint, ControlFile, Initial, MergedClass, MergedTransition, Name, PlantComponent, PlantComponents,
    merge_all,
};
use rmpl::diagnostics::constraint::impossible_guard;
use rmpl::diagnostics::{ambiguous, probability as probabilities};
use rmpl::{Code, Diagnostic, Severity, Span};
use smol_str::{SmolStr, ToSmolStr as _, format_smolstr};

use crate::arc_check::{check_arcs, check_reach};
use crate::assignment::{Found, are_equal, describe, satisfying};
use crate::behavior::written_out;
use crate::belief::Belief;
use crate::check::check;
use crate::formula::Formula;
use crate::guard_check::check_guards;
use crate::model::{
    Choice, CommandVariable, CommandVariableId, Component, ComponentId, Fault, Mode, Model, PlantVariable,
    Transition, VariableId,
};
use crate::probability;
use crate::value_set::ValueSet;

/// Of the states in which a plant may start, at most this many are tried one by one for modes that can hold together; after
/// that, such a state is searched for.
const CHECKED_STATES: usize = 1000;

/// Compiles the classes and components of a file that parsed without errors.
///
/// The model is `None` when there are errors or no components.
pub fn compile(file: &ControlFile) -> (Option<Model>, Vec<Diagnostic>) {
    let (classes, found) = merge_all(file);
    if has_errors(&found) {
        return compile_modes(file, &classes, found);
    }
    match written_out(file, &classes) {
        None => compile_modes(file, &classes, found),
        Some((_, diagnostics)) if has_errors(&diagnostics) => (None, diagnostics),
        Some((written, _)) => {
            let (classes, found) = merge_all(&written);
            compile_modes(&written, &classes, found)
        }
    }
}

fn has_errors(diagnostics: &[Diagnostic]) -> bool {
    diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
}

/// The same where all classes have modes; `diagnostics` are those of merging the classes.
fn compile_modes(
    file: &ControlFile,
    classes: &Classes<'_>,
    mut diagnostics: Vec<Diagnostic>,
) -> (Option<Model>, Vec<Diagnostic>) {
    let components = PlantComponents::new(file, classes);
    check(file, classes, &components, &mut diagnostics);
    if has_errors(&diagnostics) {
        diagnostics.sort_by_key(|diagnostic| (diagnostic.span, diagnostic.code));
        return (None, diagnostics);
    }
    let mut model = assembled(classes, &units(&components, classes), &mut diagnostics);
    for id in model.component_ids() {
        check_arcs(&model, id, &mut diagnostics);
    }
    // Classes without components are checked by themselves, with components of their ports' classes.
    for class in file.classes.iter().map(|class| &class.name.text) {
        if !components.all().iter().any(|component| component.class.text == *class) {
            let alone = assembled(classes, &units_of_class(class, classes), &mut diagnostics);
            check_arcs(&alone, ComponentId(0), &mut diagnostics);
        }
    }
    if has_errors(&diagnostics) || file.instances.is_empty() {
        diagnostics.sort_by_key(|diagnostic| (diagnostic.span, diagnostic.code));
        return (None, diagnostics);
    }
    model.prepare();
    if Belief::initial(&model, CHECKED_STATES).is_none() {
        let with_prior = file
            .instances
            .iter()
            .find(|instance| matches!(instance.initial, Initial::Prior(_) | Initial::AnyMode));
        let span = with_prior.map_or(Span::default(), |instance| instance.span);
        diagnostics.push(
            Diagnostic::error(
                Code("E-CONSTRAINT"),
                span,
                "the modes in which the components may start are inconsistent",
            )
            .with_hint(
                "in at least one combination of these modes, all of their constraints must hold together",
            ),
        );
        return (None, diagnostics);
    }
    check_guards(&model, &mut diagnostics);
    check_reach(&model, &mut diagnostics);
    if let Some(cycle) = crate::order::cycle(&model) {
        let names: Vec<&str> =
            cycle.iter().filter_map(|id| Some(model.component(*id)?.name.as_str())).collect();
        let span = cycle
            .first()
            .and_then(|id| model.component(*id))
            .map_or(Span::default(), |component| component.span);
        let message = format!("these components depend on each other in a cycle: {}", names.join(", "));
        diagnostics.push(Diagnostic::warning(Code("E-RECURSION"), span, message).with_hint(
            "estimation still works, but commands are then found by search instead of in causal order",
        ));
    }
    diagnostics.sort_by_key(|diagnostic| (diagnostic.span, diagnostic.code));
    (Some(model), diagnostics)
}

/// A component to be compiled.
struct Unit {
    name: SmolStr,
    class: SmolStr,
    /// Its ports, each with the place of what is connected there.
    ports: Vec<(SmolStr, usize)>,
    /// Modes in which it may start, in the order of its class, with their weights.
    prior: Vec<(u8, u64)>,
    span: Span,
}

/// The components of a plant, in their order.
fn units(components: &PlantComponents<'_>, classes: &Classes<'_>) -> Vec<Unit> {
    let unit = |component: &PlantComponent<'_>| {
        let class = classes.get(&component.class.text);
        Unit {
            name: component.name.clone(),
            class: component.class.text.clone(),
            ports: component.neighbors.iter().map(|(name, at)| ((*name).clone(), *at)).collect(),
            prior: class.map_or_else(Vec::new, |class| prior(component.initial, class)),
            span: component.span,
        }
    };
    components.all().iter().map(unit).collect()
}

/// In a class without components, names in constraints lead over at most this many ports and parts.
const MAX_PATH: usize = 3;

/// A component made up for a class that has none, with components at its ports.
fn units_of_class(name: &SmolStr, classes: &Classes<'_>) -> Vec<Unit> {
    let mut units = Vec::new();
    add_unit(name.clone(), name, classes, MAX_PATH, &mut units);
    units
}

fn add_unit(
    name: SmolStr,
    class: &SmolStr,
    classes: &Classes<'_>,
    depth: usize,
    units: &mut Vec<Unit>,
) -> usize {
    let at = units.len();
    units.push(Unit {
        name,
        class: class.clone(),
        ports: Vec::new(),
        prior: vec![(0, 1)],
        span: Span::default(),
    });
    if depth == 0 {
        return at;
    }
    let Some(merged) = classes.get(class) else { return at };
    let ports = merged.ports.iter().map(|(port, class)| (port, class));
    let neighbors = ports.chain(merged.parts.iter().map(|part| (&part.name, &part.class)));
    for (neighbor, class) in neighbors {
        let name = if at == 0 {
            neighbor.text.clone()
        } else {
            format_smolstr!("{}.{}", units[at].name, neighbor.text)
        };
        let number = add_unit(name, &class.text, classes, depth - 1, units);
        units[at].ports.push((neighbor.text.clone(), number));
    }
    at
}

/// Classes with what they inherit, by name.
type Classes<'file> = BTreeMap<SmolStr, MergedClass<'file>>;

/// The model of some components; errors of its transitions and faults are added to `diagnostics`.
fn assembled(classes: &Classes<'_>, units: &[Unit], diagnostics: &mut Vec<Diagnostic>) -> Model {
    let mut compiler = Compiler { units, classes, model: empty(), offsets: Vec::new(), found: Vec::new() };
    compiler.declare();
    compiler.fill();
    for diagnostic in compiler.found {
        diagnostic.add_once_to(diagnostics);
    }
    compiler.model
}

const fn empty() -> Model {
    Model {
        components: Vec::new(),
        variables: Vec::new(),
        command_variables: Vec::new(),
        islands: Vec::new(),
        watchers: Vec::new(),
        led_by_commands: Vec::new(),
        full: Vec::new(),
    }
}

/// The modes in which a component may start, in the order of its class, with their weights.
fn prior(initial: &Initial, class: &MergedClass<'_>) -> Vec<(u8, u64)> {
    let mut prior: Vec<(u8, u64)> = match initial {
        Initial::FirstMode => vec![(0, 1)],
        Initial::Mode(mode) => vec![(class.mode(&mode.text).unwrap_or(0) as u8, 1)],
        Initial::AnyMode => (0..=u8::MAX).zip(&class.modes).map(|(mode, _)| (mode, 1)).collect(),
        Initial::Prior(_) => {
            let weights = initial.prior().into_iter();
            weights.filter_map(|(mode, weight)| Some((class.mode(mode)? as u8, weight))).collect()
        }
    };
    prior.sort_unstable();
    prior
}

struct Compiler<'compile, 'file> {
    units: &'compile [Unit],
    classes: &'compile Classes<'file>,
    model: Model,
    /// Per component, its first variable and command variable.
    offsets: Vec<(u32, u32)>,
    /// What is wrong with arcs.
    found: Vec<Diagnostic>,
}

/// A symbol that a constraint speaks of, and its values.
struct Named<'class> {
    symbol: u32,
    values: Vec<&'class SmolStr>,
}

impl Compiler<'_, '_> {
    /// Declares components, variables and commands, so that constraints can speak of any of them.
    fn declare(&mut self) {
        for (id, unit) in (0..).map(ComponentId).zip(self.units) {
            let Some(class) = self.classes.get(&unit.class) else { continue };
            self.offsets.push((self.model.variables.len() as u32, self.model.command_variables.len() as u32));
            for variable in &class.variables {
                let shows = variable.shows.as_ref();
                let shows =
                    shows.and_then(|shows| variable.values.iter().position(|value| *value == shows.text));
                let error = variable.error.as_ref().and_then(|error| probability::parse(&error.text));
                self.model.variables.push(PlantVariable {
                    name: format_smolstr!("{}.{}", unit.name, variable.name.text),
                    component: id,
                    values: variable.values.clone(),
                    observable: variable.observable,
                    shows: shows.map(|value| value as u8),
                    error,
                });
            }
            let first = self.model.command_variables.len() as u32;
            for command in &class.commands {
                self.model.command_variables.push(CommandVariable {
                    name: format_smolstr!("{}.{}", unit.name, command.name.text),
                    component: id,
                    values: command.values.clone(),
                });
            }
            let ports = unit.ports.iter().map(|(port, at)| (port.clone(), ComponentId(*at as u32)));
            self.model.components.push(Component {
                name: unit.name.clone(),
                class: unit.class.clone(),
                modes: Vec::new(),
                // Of several greatest ones the last is taken.
                initial: unit
                    .prior
                    .iter()
                    .rev()
                    .max_by_key(|(_, weight)| weight)
                    .map_or(0, |(mode, _)| *mode),
                prior: unit.prior.clone(),
                ports: ports.collect(),
                commands: (first..self.model.command_variables.len() as u32).map(CommandVariableId).collect(),
                span: unit.span,
            });
        }
    }

    /// Gives every component its modes, transitions and faults.
    fn fill(&mut self) {
        let classes: Vec<&MergedClass<'_>> =
            self.units.iter().filter_map(|unit| self.classes.get(&unit.class)).collect();
        let modes = classes.iter().map(|class| ValueSet::first_values(class.modes.len()));
        let variables =
            self.model.variables.iter().map(|variable| ValueSet::first_values(variable.values.len()));
        let commands =
            self.model.command_variables.iter().map(|command| ValueSet::first_values(command.values.len()));
        self.model.full = modes.chain(variables).chain(commands).collect();
        let mut all = Vec::with_capacity(classes.len());
        for (id, class) in (0..).map(ComponentId).zip(classes) {
            let modes = self.modes(id, class);
            if !has_common_denominator(&modes) {
                let span = class.modes.first().map_or(Span::default(), |(name, _)| name.span);
                self.found
                    .push(probabilities::digits(class.lineage.first().map_or("?", SmolStr::as_str), span));
            }
            all.push(modes);
        }
        for (component, modes) in self.model.components.iter_mut().zip(all) {
            component.modes = modes;
        }
    }

    fn modes(&mut self, id: ComponentId, class: &MergedClass<'_>) -> Vec<Mode> {
        let mut modes = Vec::with_capacity(class.modes.len());
        for (number, (name, constraints)) in (0..=u8::MAX).zip(&class.modes) {
            let (faults, denominator) = self.faults(id, class, &name.text);
            let constraint = constraints.iter().map(|constraint| self.formula(id, constraint, true));
            let constraint = Formula::All(constraint.collect());
            let leaving: Vec<&MergedTransition<'_>> =
                class.transitions.iter().filter(|transition| transition.from.text == name.text).collect();
            let transition = |transition: &&MergedTransition<'_>| {
                Some(Transition {
                    to: class.mode(&transition.to.text)? as u8,
                    label: transition.guard.to_smolstr(),
                    probability: transition.probability.map(|given| given.text.clone()),
                    span: transition.guard.span,
                })
            };
            modes.push(Mode {
                name: name.text.clone(),
                constraint,
                transitions: leaving.iter().filter_map(transition).collect(),
                choices: self.choices(id, class, number, &leaving),
                faults,
                denominator,
                span: name.span,
            });
        }
        modes
    }

    /// The faults that leave a mode, over their common denominator.
    fn faults(&self, id: ComponentId, class: &MergedClass<'_>, mode: &str) -> (Vec<Fault>, u64) {
        let leaving = class.faults.iter().filter(|fault| fault.from.text == mode);
        let known = leaving.filter_map(|fault| {
            let (numerator, denominator) = probability::parse(&fault.probability.text)?;
            let fault = Fault {
                to: class.mode(&fault.to.text)? as u8,
                numerator,
                guard: fault.guard.map_or(Formula::Constant(true), |guard| self.formula(id, guard, true)),
                label: fault.probability.text.clone(),
                condition: fault.guard.map(smol_str::ToSmolStr::to_smolstr),
                span: fault.probability.span,
            };
            Some((fault, denominator))
        });
        let mut known: Vec<(Fault, u64)> = known.collect();
        let common = known.iter().try_fold(1, |common, (_, denominator)| checked_lcm(common, *denominator));
        // Without a common denominator, which is reported, the numbers mean nothing.
        let common = common.unwrap_or(0);
        for (fault, denominator) in &mut known {
            fault.numerator = fault.numerator.saturating_mul(common / *denominator);
        }
        (known.into_iter().map(|(fault, _)| fault).collect(), common)
    }

    /// Returns where the transitions that leave a mode lead: those with equal guards are outcomes of one choice.
    fn choices(
        &mut self,
        id: ComponentId,
        class: &MergedClass<'_>,
        from: u8,
        leaving: &[&MergedTransition<'_>],
    ) -> Vec<Choice> {
        let mut sets = self.model.full.clone();
        sets[Model::mode_symbol(id) as usize] = ValueSet::one(from);
        let mut grouped: Vec<(Formula, Vec<&MergedTransition<'_>>)> = Vec::new();
        for transition in leaving {
            let guard = self.guard(id, transition);
            let written = self.formula(id, transition.guard, true);
            if satisfying(&[&written], &mut self.model.full.clone()) == Found::Nothing {
                self.found.push(impossible_guard(transition.guard.span));
            }
            let same = grouped.iter_mut().find(|(known, _)| are_equal(&self.model, known, &guard, &mut sets));
            match same {
                Some((_, outcomes)) => outcomes.push(transition),
                None => grouped.push((guard, vec![transition])),
            }
        }
        let choice = |(guard, outcomes): (Formula, Vec<&MergedTransition<'_>>)| {
            self.choice(class, from, guard, &outcomes, &mut sets)
        };
        grouped.into_iter().filter_map(choice).collect()
    }

    /// Returns what enables a transition: its guard, and none of the guards that take precedence.
    fn guard(&self, id: ComponentId, transition: &MergedTransition<'_>) -> Formula {
        let guard = self.formula(id, transition.guard, true);
        if transition.unless.is_empty() {
            return guard;
        }
        let unless = transition.unless.iter().map(|other| self.formula(id, other, false));
        Formula::All(std::iter::once(guard).chain(unless).collect())
    }

    /// Returns where one guard leads. One outcome without a probability has the rest; without such an outcome the mode
    /// stays.
    fn choice(
        &mut self,
        class: &MergedClass<'_>,
        from: u8,
        guard: Formula,
        outcomes: &[&MergedTransition<'_>],
        sets: &mut [ValueSet],
    ) -> Option<Choice> {
        let span = outcomes.first()?.guard.span;
        let mode = class.modes.get(usize::from(from))?.0;
        let mut rest: Option<&Name> = None;
        let mut parts: Vec<(u8, u64, u64)> = Vec::new();
        for outcome in outcomes {
            let to = class.mode(&outcome.to.text)? as u8;
            match (outcome.probability, rest) {
                (Some(given), _) => {
                    let (numerator, denominator) = probability::parse(&given.text)?;
                    parts.push((to, numerator, denominator));
                }
                (None, Some(first)) if first.text != outcome.to.text => {
                    let place = match satisfying(&[&guard], sets) {
                        Found::Assignment(assignment) => describe(&self.model, &assignment),
                        Found::Nothing | Found::Undecided => SmolStr::new_static("in the same steps"),
                    };
                    let (first, second) = (&first.text, &outcome.to.text);
                    let found = ambiguous::outcomes(&mode.text, first, second, &place, outcome.guard.span);
                    self.found.push(found);
                }
                (None, _) => rest = Some(outcome.to),
            }
        }
        let common = parts.iter().try_fold(1_u64, |common, part| checked_lcm(common, part.2));
        let weighted = common.and_then(|common| {
            let weight = |part: &(u8, u64, u64)| Some((part.0, part.1.checked_mul(common / part.2)?));
            Some((common, parts.iter().map(weight).collect::<Option<Vec<_>>>()?))
        });
        let Some((denominator, mut weights)) = weighted else {
            self.found.push(probabilities::digits(class.lineage.first().map_or("?", SmolStr::as_str), span));
            return None;
        };
        let sum = weights.iter().map(|(_, weight)| u128::from(*weight)).sum::<u128>();
        let Some(left) = u128::from(denominator).checked_sub(sum) else {
            let last = outcomes.iter().rev().find_map(|outcome| outcome.probability);
            self.found.push(probabilities::outcomes(&mode.text, last.map_or(span, |given| given.span)));
            return None;
        };
        let to = rest.map_or(Some(from), |to| Some(class.mode(&to.text)? as u8))?;
        // In the text's order, of which the first of equally likely outcomes is nominal.
        let at = outcomes.iter().position(|outcome| outcome.probability.is_none()).unwrap_or(weights.len());
        weights.insert(at.min(weights.len()), (to, left as u64));
        let mut joined: Vec<(u8, u64)> = Vec::with_capacity(weights.len());
        for (to, weight) in weights.into_iter().filter(|(_, weight)| *weight > 0) {
            match joined.iter_mut().find(|(known, _)| *known == to) {
                Some((_, known)) => *known += weight,
                None => joined.push((to, weight)),
            }
        }
        let leaving = joined.iter().rev().filter(|(to, _)| *to != from);
        let nominal = leaving.max_by_key(|(_, weight)| *weight).map_or(from, |(to, _)| *to);
        Some(Choice { guard, outcomes: joined, denominator, nominal, span })
    }

    /// The formula of a constraint, or of its opposite.
    fn formula(&self, id: ComponentId, constraint: &Constraint, wanted: bool) -> Formula {
        Formula::of(constraint, wanted, &|name, value, wanted| {
            self.equality(id, name, value, wanted).unwrap_or(Formula::Constant(false))
        })
    }

    /// That a name has a value, or the value of another name, or that it has not.
    fn equality(&self, id: ComponentId, name: &str, value: &str, wanted: bool) -> Option<Formula> {
        let left = self.named(id, name)?;
        let full = |symbol: u32| self.model.full.get(symbol as usize).copied().unwrap_or_default();
        let member = |symbol: u32, value: usize, wanted: bool| {
            let set = ValueSet::one(value as u8);
            Formula::Member { symbol, set: if wanted { set } else { full(symbol) & !set } }
        };
        if let Some(at) = left.values.iter().position(|known| *known == value) {
            return Some(member(left.symbol, at, wanted));
        }
        let right = self.named(id, value)?;
        let each = left.values.iter().enumerate().map(|(at, value)| {
            let first = member(left.symbol, at, true);
            let second = match right.values.iter().position(|known| known == value) {
                Some(other) => member(right.symbol, other, wanted),
                None => Formula::Constant(!wanted),
            };
            Formula::All(vec![first, second])
        });
        Some(Formula::Any(each.collect()).given(&|_| None))
    }

    /// Returns what a name represents in the constraints of a component.
    fn named(&self, id: ComponentId, name: &str) -> Option<Named<'_>> {
        self.field(id, name).or_else(|| {
            if let Some(other) = self.reached(id, name) {
                let class = self.classes.get(&self.model.component(other)?.class)?;
                let values = class.modes.iter().map(|(mode, _)| &mode.text).collect();
                return Some(Named { symbol: Model::mode_symbol(other), values });
            }
            let (path, field) = name.rsplit_once('.')?;
            self.field(self.reached(id, path)?, field)
        })
    }

    /// The component that a path of ports and parts leads to.
    fn reached(&self, from: ComponentId, path: &str) -> Option<ComponentId> {
        path.split('.').try_fold(from, |at, step| {
            let ports = &self.model.component(at)?.ports;
            ports.iter().find(|(known, _)| known == step).map(|(_, other)| *other)
        })
    }

    /// A component's own variable or command.
    fn field(&self, id: ComponentId, name: &str) -> Option<Named<'_>> {
        let class = self.classes.get(&self.model.component(id)?.class)?;
        let (variables, commands) = *self.offsets.get(id.0 as usize)?;
        if let Some(at) = class.variables.iter().position(|known| known.name.text == name) {
            let id = VariableId(variables + at as u32);
            let values = class.variables.get(at)?.values.iter().collect();
            return Some(Named { symbol: self.model.variable_symbol(id), values });
        }
        let at = class.commands.iter().position(|known| known.name.text == name)?;
        let id = CommandVariableId(commands + at as u32);
        let values = class.commands.get(at)?.values.iter().collect();
        Some(Named { symbol: self.model.command_symbol(id), values })
    }
}

/// Returns whether all that a component may do can be weighed over one denominator.
fn has_common_denominator(modes: &[Mode]) -> bool {
    let each = modes.iter().flat_map(|mode| {
        let choices = mode.choices.iter().map(|choice| choice.denominator);
        choices.chain([1]).map(|denominator| denominator.checked_mul(mode.denominator))
    });
    each.into_iter().try_fold(1, |common, one| checked_lcm(common, one.filter(|one| *one > 0)?)).is_some()
}

/// The least common multiple, if it is not too long.
fn checked_lcm(left: u64, right: u64) -> Option<u64> {
    (left / gcd(left, right).max(1)).checked_mul(right)
}
