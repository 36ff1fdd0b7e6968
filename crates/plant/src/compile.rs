//! From the model part of a text that passes all checks to a [`Model`] (SPEC 2.2).

use std::collections::BTreeMap;

use num_integer::lcm;
use rmpl::control::{
    Constraint, ConstraintKind, ControlFile, Initial, Instance, MergedClass, MergedVariable, Name, merge_all,
};
use rmpl::{Code, Diagnostic, Severity, Span};
use smol_str::{SmolStr, ToSmolStr as _, format_smolstr};

use crate::belief::Belief;
use crate::check::check;
use crate::formula::Formula;
use crate::guard_check::check_guards;
use crate::model::{
    CommandVariable, CommandVariableId, Component, ComponentId, Fault, Mode, Model, PlantVariable,
    Transition, VariableId,
};
use crate::probability;

/// Of the states in which a plant may start so many are looked at for one whose modes can hold together, before it is
/// searched for.
const CHECKED_STATES: usize = 1000;

/// Compiles the classes and components of a file that parsed without errors.
///
/// The model is `None` when there are errors or no components.
pub fn compile(file: &ControlFile) -> (Option<Model>, Vec<Diagnostic>) {
    let (classes, mut diagnostics) = merge_all(file);
    check(file, &classes, &mut diagnostics);
    diagnostics.sort_by_key(|diagnostic| (diagnostic.span, diagnostic.code));
    if diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
        || file.instances.is_empty()
    {
        return (None, diagnostics);
    }
    let mut compiler = Compiler { file, classes, model: empty(), offsets: Vec::new() };
    compiler.declare();
    compiler.fill();
    let mut model = compiler.model;
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
                "the modes in which the components may start contradict each other",
            )
            .with_hint(
                "in at least one combination of these modes, all of their constraints must hold together",
            ),
        );
        return (None, diagnostics);
    }
    check_guards(&model, &mut diagnostics);
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
    (Some(model), diagnostics)
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
fn prior(instance: &Instance, class: &MergedClass<'_>) -> Vec<(u8, u64)> {
    let mut prior: Vec<(u8, u64)> = match &instance.initial {
        Initial::FirstMode => vec![(0, 1)],
        Initial::Mode(mode) => vec![(class.mode(&mode.text).unwrap_or(0) as u8, 1)],
        Initial::AnyMode => (0..class.modes.len() as u8).map(|mode| (mode, 1)).collect(),
        Initial::Prior(_) => {
            let weights = instance.prior().into_iter();
            weights.filter_map(|(mode, weight)| Some((class.mode(mode)? as u8, weight))).collect()
        }
    };
    prior.sort_unstable();
    prior
}

struct Compiler<'file> {
    file: &'file ControlFile,
    classes: BTreeMap<SmolStr, MergedClass<'file>>,
    model: Model,
    /// Per component, its first variable and command variable.
    offsets: Vec<(u32, u32)>,
}

impl Compiler<'_> {
    /// Declares components, variables and commands, so that constraints can speak of any of them.
    fn declare(&mut self) {
        for (at, instance) in self.file.instances.iter().enumerate() {
            let id = ComponentId(at as u32);
            let Some(class) = self.classes.get(&instance.class.text) else { continue };
            self.offsets.push((self.model.variables.len() as u32, self.model.command_variables.len() as u32));
            for variable in &class.variables {
                let shows = variable
                    .shows
                    .as_ref()
                    .and_then(|shows| variable.values.iter().position(|value| *value == shows.text));
                self.model.variables.push(PlantVariable {
                    name: format_smolstr!("{}.{}", instance.name.text, variable.name.text),
                    component: id,
                    values: variable.values.clone(),
                    observable: variable.observable,
                    shows: shows.unwrap_or(0) as u8,
                });
            }
            let first = self.model.command_variables.len() as u32;
            for command in &class.commands {
                self.model.command_variables.push(CommandVariable {
                    name: format_smolstr!("{}.{}", instance.name.text, command.name.text),
                    component: id,
                    values: command.values.clone(),
                });
            }
            let ports = instance.ports.iter().filter_map(|(port, component)| {
                let at = self.file.instances.iter().position(|known| known.name.text == component.text)?;
                Some((port.text.clone(), ComponentId(at as u32)))
            });
            let prior = prior(instance, class);
            self.model.components.push(Component {
                name: instance.name.text.clone(),
                class: instance.class.text.clone(),
                modes: Vec::new(),
                // Of several greatest ones the last is taken.
                initial: prior.iter().rev().max_by_key(|(_, weight)| weight).map_or(0, |(mode, _)| *mode),
                prior,
                ports: ports.collect(),
                commands: (first..self.model.command_variables.len() as u32).map(CommandVariableId).collect(),
                span: instance.span,
            });
        }
    }

    /// Gives every component its modes, transitions and faults.
    fn fill(&mut self) {
        let bits = |count: usize| if count >= 64 { u64::MAX } else { (1 << count) - 1 };
        let classes: Vec<&MergedClass<'_>> = self
            .file
            .instances
            .iter()
            .filter_map(|instance| self.classes.get(&instance.class.text))
            .collect();
        let modes = classes.iter().map(|class| bits(class.modes.len()));
        let variables = self.model.variables.iter().map(|variable| bits(variable.values.len()));
        let commands = self.model.command_variables.iter().map(|command| bits(command.values.len()));
        self.model.full = modes.chain(variables).chain(commands).collect();
        let mut all = Vec::with_capacity(classes.len());
        for (at, class) in classes.iter().enumerate() {
            all.push(self.modes(ComponentId(at as u32), class));
        }
        for (component, modes) in self.model.components.iter_mut().zip(all) {
            component.modes = modes;
        }
    }

    fn modes(&self, id: ComponentId, class: &MergedClass<'_>) -> Vec<Mode> {
        let mode = |(name, constraints): &(&Name, Vec<&Constraint>)| {
            let transitions = class.transitions.iter().filter(|(from, ..)| from.text == name.text);
            let faults: Vec<(u8, u64, u64, SmolStr)> = class
                .faults
                .iter()
                .filter(|(from, ..)| from.text == name.text)
                .filter_map(|(_, to, given)| {
                    let (numerator, denominator) = probability::parse(&given.text)?;
                    Some((class.mode(&to.text)? as u8, numerator, denominator, given.text.clone()))
                })
                .filter(|(_, numerator, ..)| *numerator > 0)
                .collect();
            let common = faults.iter().fold(1, |common, fault| lcm(common, fault.2));
            Mode {
                name: name.text.clone(),
                constraint: Formula::All(
                    constraints.iter().map(|constraint| self.formula(id, constraint)).collect(),
                ),
                transitions: transitions
                    .filter_map(|(_, to, guard)| {
                        let to = class.mode(&to.text)? as u8;
                        Some(Transition {
                            to,
                            guard: self.formula(id, guard),
                            label: guard.to_smolstr(),
                            span: guard.span,
                        })
                    })
                    .collect(),
                faults: faults
                    .into_iter()
                    .map(|(to, numerator, denominator, label)| Fault {
                        to,
                        numerator: numerator * (common / denominator),
                        label,
                    })
                    .collect(),
                denominator: common,
                span: name.span,
            }
        };
        class.modes.iter().map(mode).collect()
    }

    fn formula(&self, id: ComponentId, constraint: &Constraint) -> Formula {
        let full = |symbol: u32| self.model.full.get(symbol as usize).copied().unwrap_or(0);
        match &constraint.kind {
            ConstraintKind::True => Formula::Constant(true),
            ConstraintKind::Not(inner) => self.formula(id, inner).negated(&full),
            ConstraintKind::And(parts) => {
                Formula::All(parts.iter().map(|part| self.formula(id, part)).collect())
            }
            ConstraintKind::Or(parts) => {
                Formula::Any(parts.iter().map(|part| self.formula(id, part)).collect())
            }
            ConstraintKind::Equals { variable, value } => self.member(id, &variable.text, &value.text),
            _ => Formula::Constant(false),
        }
    }

    fn member(&self, id: ComponentId, name: &str, value: &str) -> Formula {
        let found = self.field(id, name, value).or_else(|| {
            let component = self.model.component(id)?;
            let at_port =
                |port: &str| component.ports.iter().find(|(known, _)| known == port).map(|(_, other)| *other);
            if let Some(other) = at_port(name) {
                let class = self.classes.get(&self.model.component(other)?.class)?;
                return Some((Model::mode_symbol(other), class.mode(value)?));
            }
            let (port, field) = name.split_once('.')?;
            self.field(at_port(port)?, field, value)
        });
        found.map_or(Formula::Constant(false), |(symbol, value)| Formula::Member { symbol, set: 1 << value })
    }

    /// The symbol of a component's own variable or command, and the number of one of its values.
    fn field(&self, id: ComponentId, name: &str, value: &str) -> Option<(u32, usize)> {
        let class = self.classes.get(&self.model.component(id)?.class)?;
        let (variables, commands) = *self.offsets.get(id.0 as usize)?;
        let place = |fields: &[MergedVariable]| fields.iter().position(|known| known.name.text == name);
        let number = |values: &[SmolStr]| values.iter().position(|known| known == value);
        if let Some(at) = place(&class.variables) {
            let id = VariableId(variables + at as u32);
            return Some((self.model.variable_symbol(id), number(&class.variables.get(at)?.values)?));
        }
        let at = place(&class.commands)?;
        let id = CommandVariableId(commands + at as u32);
        Some((self.model.command_symbol(id), number(&class.commands.get(at)?.values)?))
    }
}
