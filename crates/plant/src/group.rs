//! Groups of components that nothing ties together: each is a plant by itself, and is estimated apart (SPEC3 17.2).

use std::collections::BTreeMap;
use std::sync::Arc;

use smol_str::SmolStr;

use crate::belief::State;
use crate::formula::Formula;
use crate::island;
use crate::model::{
    Choice, CommandVariable, CommandVariableId, Commands, Component, ComponentId, Fault, Mode, Model,
    Observation, PlantVariable, VariableId,
};

/// Components that ports tie together, as a plant of their own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// Its components in their order.
    pub components: Arc<[ComponentId]>,
    /// Its variables in their order.
    pub variables: Vec<VariableId>,
    /// Its command variables in their order.
    pub commands: Vec<CommandVariableId>,
    /// These alone; what is the nth of them here has the number n there.
    pub model: Model,
}

impl Group {
    /// The part of a state of the whole plant.
    pub fn state(&self, whole: &State) -> State {
        State(self.components.iter().map(|component| whole.mode(*component)).collect())
    }

    /// The part of the commands to the whole plant.
    pub fn commands(&self, whole: &Commands) -> Commands {
        let part = self.commands.iter().map(|id| whole.0.get(id.0 as usize).copied().unwrap_or(0));
        Commands(part.collect())
    }

    /// The part of an observation of the whole plant.
    pub fn observation(&self, whole: &Observation) -> Observation {
        let part = (0..).map(VariableId).zip(&self.variables);
        Observation(part.filter_map(|(own, id)| Some((own, *whole.0.get(id)?))).collect())
    }
}

/// The groups of a plant, by their first components.
pub fn groups(model: &Model) -> Vec<Group> {
    let count = model.components.len();
    let mut parents: Vec<usize> = (0..count).collect();
    let mut join = |left: usize, right: usize| {
        let (left, right) = (island::root(&mut parents, left), island::root(&mut parents, right));
        parents[left.max(right)] = left.min(right);
    };
    // Whatever a constraint or a guard speaks of is the component's own or at a port.
    for (at, component) in model.components.iter().enumerate() {
        component.ports.iter().for_each(|(_, other)| join(at, other.0 as usize));
    }
    let mut members: BTreeMap<usize, Vec<ComponentId>> = BTreeMap::new();
    for id in model.component_ids() {
        members.entry(island::root(&mut parents, id.0 as usize)).or_default().push(id);
    }
    // By component, variable and command variable, its group and its number there.
    let mut places = vec![(0, 0); model.full.len()];
    for (group, members) in members.values().enumerate() {
        for (own, id) in (0..).zip(members) {
            places[id.0 as usize] = (group, own);
        }
    }
    let mut variables: Vec<Vec<VariableId>> = vec![Vec::new(); members.len()];
    for (id, variable) in (0..).map(VariableId).zip(&model.variables) {
        let group = places[variable.component.0 as usize].0;
        places[model.variable_symbol(id) as usize] = (group, variables[group].len() as u32);
        variables[group].push(id);
    }
    let mut commands: Vec<Vec<CommandVariableId>> = vec![Vec::new(); members.len()];
    for (id, command) in (0..).map(CommandVariableId).zip(&model.command_variables) {
        let group = places[command.component.0 as usize].0;
        places[model.command_symbol(id) as usize] = (group, commands[group].len() as u32);
        commands[group].push(id);
    }
    let parts = members.into_values().zip(variables).zip(commands);
    parts
        .map(|((components, variables), commands)| {
            let part = Part { model, places: &places, counts: (components.len(), variables.len()) };
            let model = part.model(&components, &variables, &commands);
            Group { components: components.into(), variables, commands, model }
        })
        .collect()
}

/// A group on its way to a model of its own.
struct Part<'model> {
    model: &'model Model,
    /// By symbol, its group and its number there among its kind.
    places: &'model [(usize, u32)],
    /// How many components and variables the group has.
    counts: (usize, usize),
}

impl Part<'_> {
    fn model(
        &self,
        components: &[ComponentId],
        variables: &[VariableId],
        commands: &[CommandVariableId],
    ) -> Model {
        let whole = self.model;
        let full = components
            .iter()
            .map(|id| id.0)
            .chain(variables.iter().map(|id| whole.variable_symbol(*id)))
            .chain(commands.iter().map(|id| whole.command_symbol(*id)))
            .map(|symbol| whole.full[symbol as usize]);
        let mut model = Model {
            components: components
                .iter()
                .filter_map(|id| Some(self.component(whole.component(*id)?)))
                .collect(),
            variables: variables
                .iter()
                .filter_map(|id| whole.variables.get(id.0 as usize))
                .map(|data| PlantVariable { component: self.own(data.component), ..data.clone() })
                .collect(),
            command_variables: commands
                .iter()
                .filter_map(|id| whole.command_variables.get(id.0 as usize))
                .map(|data| CommandVariable { component: self.own(data.component), ..data.clone() })
                .collect(),
            islands: Vec::new(),
            watchers: Vec::new(),
            led_by_commands: Vec::new(),
            full: full.collect(),
        };
        model.prepare();
        model
    }

    fn own(&self, component: ComponentId) -> ComponentId {
        ComponentId(self.places[component.0 as usize].1)
    }

    fn component(&self, component: &Component) -> Component {
        let commands = component.commands.iter();
        Component {
            modes: component.modes.iter().map(|mode| self.mode(mode)).collect(),
            ports: component
                .ports
                .iter()
                .map(|(port, other): &(SmolStr, ComponentId)| (port.clone(), self.own(*other)))
                .collect(),
            commands: commands
                .map(|id| CommandVariableId(self.places[self.model.command_symbol(*id) as usize].1))
                .collect(),
            ..component.clone()
        }
    }

    fn mode(&self, mode: &Mode) -> Mode {
        let choice = |choice: &Choice| Choice { guard: self.formula(&choice.guard), ..choice.clone() };
        let fault = |fault: &Fault| Fault { guard: self.formula(&fault.guard), ..fault.clone() };
        Mode {
            constraint: self.formula(&mode.constraint),
            choices: mode.choices.iter().map(choice).collect(),
            faults: mode.faults.iter().map(fault).collect(),
            ..mode.clone()
        }
    }

    fn formula(&self, formula: &Formula) -> Formula {
        let all = |parts: &[Formula]| parts.iter().map(|part| self.formula(part)).collect();
        match formula {
            Formula::Constant(value) => Formula::Constant(*value),
            Formula::Member { symbol, set } => Formula::Member { symbol: self.symbol(*symbol), set: *set },
            Formula::All(parts) => Formula::All(all(parts)),
            Formula::Any(parts) => Formula::Any(all(parts)),
        }
    }

    fn symbol(&self, symbol: u32) -> u32 {
        let own = self.places[symbol as usize].1;
        if (symbol as usize) < self.model.components.len() {
            own
        } else if self.model.symbol_variable(symbol).is_some() {
            self.counts.0 as u32 + own
        } else {
            (self.counts.0 + self.counts.1) as u32 + own
        }
    }
}
