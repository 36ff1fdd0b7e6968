//! A plant model as flat data: components with modes, transitions and faults (SPEC 9.1).

use std::collections::BTreeMap;

use rmpl::Span;
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

use crate::formula::Formula;
use crate::island::Island;
use crate::value_set::ValueSet;

/// Index of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ComponentId(pub u32);

/// Index of a plant variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct VariableId(pub u32);

/// Index of a command variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct CommandVariableId(pub u32);

/// A component of the plant.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Component {
    /// What it is called.
    pub name: SmolStr,
    pub class: SmolStr,
    /// Its modes; a state gives each component the index of its mode.
    pub modes: Vec<Mode>,
    /// The mode in which it most likely starts; of equally likely ones the first.
    pub initial: u8,
    /// The modes in which it may start, in their order, with their weights.
    pub prior: Vec<(u8, u64)>,
    pub ports: Vec<(SmolStr, ComponentId)>,
    pub commands: Vec<CommandVariableId>,
    /// Where it is declared.
    pub span: Span,
}

/// A mode of a component.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Mode {
    /// What it is called.
    pub name: SmolStr,
    /// What holds in it.
    pub constraint: Formula,
    /// The commanded transitions that leave it, as written.
    pub transitions: Vec<Transition>,
    /// Where its transitions lead: one for each guard.
    pub choices: Vec<Choice>,
    /// The faults that leave it.
    pub faults: Vec<Fault>,
    /// The common denominator of its faults' probabilities.
    pub denominator: u64,
    /// Where it is declared, in its class or the nearest class that declares it.
    pub span: Span,
}

impl Mode {
    /// The guards that decide what comes after it: those of its transitions and of its faults.
    pub(crate) fn guards(&self) -> impl Iterator<Item = &Formula> {
        let choices = self.choices.iter().map(|choice| &choice.guard);
        choices.chain(self.faults.iter().map(|fault| &fault.guard))
    }
}

/// A commanded transition.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Transition {
    /// The mode that it enters.
    pub to: u8,
    /// Its guard in the short form of drawings.
    pub label: SmolStr,
    /// Its probability as written, if it is one of several outcomes.
    pub probability: Option<SmolStr>,
    /// Where it is declared.
    pub span: Span,
}

/// Where the transitions with equal guards lead.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Choice {
    /// What enables them.
    pub guard: Formula,
    /// The modes that may be entered, the one that is left among them, with their weights in parts of `denominator`.
    pub outcomes: Vec<(u8, u64)>,
    pub denominator: u64,
    /// The likeliest of these modes that differs from the one that is left, of equally likely ones the first.
    pub nominal: u8,
    /// Where the guard is first written.
    pub span: Span,
}

/// A fault that a component may have, with its probability.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fault {
    /// The mode that it enters.
    pub to: u8,
    /// Its probability per step, in parts of its mode's denominator.
    pub numerator: u64,
    /// In which steps it is possible.
    pub guard: Formula,
    /// Its probability as written.
    pub label: SmolStr,
    /// Its guard in the short form of drawings, if it has one.
    pub condition: Option<SmolStr>,
    /// Where its probability is written.
    pub span: Span,
}

/// A variable of the plant.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlantVariable {
    /// Its full name, such as `EngineA.thrust`.
    pub name: SmolStr,
    /// The component that declares it.
    pub component: ComponentId,
    pub values: Vec<SmolStr>,
    /// Whether it is observed.
    pub observable: bool,
    /// What the simulated plant shows where the modes leave it open, if the text says so.
    pub shows: Option<u8>,
    /// The probability that another value than the true one is observed, as a fraction; `None` if that never happens.
    pub error: Option<(u64, u64)>,
}

/// A command variable; its first value is the idle one.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CommandVariable {
    /// Its full name, such as `EngineA.cmd`.
    pub name: SmolStr,
    /// The component that takes it.
    pub component: ComponentId,
    pub values: Vec<SmolStr>,
}

/// The values of all command variables in one step.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Commands(pub Vec<u8>);

/// What is observed in one step: values of some plant variables.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Observation(pub BTreeMap<VariableId, u8>);

/// The model of a plant: its components, variables and constraints.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Model {
    pub components: Vec<Component>,
    pub variables: Vec<PlantVariable>,
    pub command_variables: Vec<CommandVariable>,
    /// Parts whose mode constraints share nothing with those of other parts.
    pub(crate) islands: Vec<Island>,
    /// Per symbol the places, in its island, of the components whose modes speak of it.
    pub(crate) watchers: Vec<Vec<u32>>,
    /// Per component its modes in which only commands decide where it goes.
    pub(crate) led_by_commands: Vec<ValueSet>,
    /// Per symbol all its values.
    pub(crate) full: Vec<ValueSet>,
}

impl Model {
    /// The component of this id, if the plant has it.
    pub fn component(&self, id: ComponentId) -> Option<&Component> {
        self.components.get(id.0 as usize)
    }

    /// The component called `name`.
    pub fn component_named(&self, name: &str) -> Option<ComponentId> {
        self.components.iter().position(|component| component.name == name).map(|at| ComponentId(at as u32))
    }

    /// The variable called `name`, such as `EngineA.thrust`.
    pub fn variable_named(&self, name: &str) -> Option<VariableId> {
        self.variables.iter().position(|variable| variable.name == name).map(|at| VariableId(at as u32))
    }

    /// The index of a component's mode.
    pub fn mode_named(&self, component: ComponentId, mode: &str) -> Option<u8> {
        self.component(component)?.modes.iter().position(|known| known.name == mode).map(|at| at as u8)
    }

    /// The name of a component's mode.
    pub fn mode_name(&self, component: ComponentId, mode: u8) -> &str {
        let mode = self.component(component).and_then(|component| component.modes.get(mode as usize));
        mode.map_or("?", |mode| mode.name.as_str())
    }

    /// The modes in which the components most likely start, each by itself.
    pub fn initial_state(&self) -> crate::State {
        crate::State(self.components.iter().map(|component| component.initial).collect())
    }

    /// All command variables at their idle values.
    pub fn idle(&self) -> Commands {
        Commands(vec![0; self.command_variables.len()])
    }

    /// Ids of all components.
    pub fn component_ids(&self) -> impl Iterator<Item = ComponentId> + use<> {
        (0..self.components.len() as u32).map(ComponentId)
    }

    /// Index of a component's mode among the symbols.
    pub(crate) const fn mode_symbol(component: ComponentId) -> u32 {
        component.0
    }

    pub(crate) fn variable_symbol(&self, variable: VariableId) -> u32 {
        self.components.len() as u32 + variable.0
    }

    pub(crate) fn command_symbol(&self, command: CommandVariableId) -> u32 {
        (self.components.len() + self.variables.len()) as u32 + command.0
    }

    /// Returns whether only commands decide where a component goes from a mode.
    pub(crate) fn is_led_by_commands(&self, component: ComponentId, mode: u8) -> bool {
        self.led_by_commands.get(component.0 as usize).is_some_and(|modes| modes.contains(mode))
    }

    /// The variable of a symbol, if it is one.
    pub(crate) fn symbol_variable(&self, symbol: u32) -> Option<VariableId> {
        let at = (symbol as usize).checked_sub(self.components.len())?;
        (at < self.variables.len()).then_some(VariableId(at as u32))
    }

    /// The command variable of a symbol, if it is one.
    pub(crate) fn symbol_command(&self, symbol: u32) -> Option<CommandVariableId> {
        let at = (symbol as usize).checked_sub(self.components.len() + self.variables.len())?;
        (at < self.command_variables.len()).then_some(CommandVariableId(at as u32))
    }
}
