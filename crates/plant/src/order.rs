//! The causal order of components: who must be right before whom can move (SPEC 9.2).

use crate::model::{ComponentId, Model};

/// The components on which each component's transitions depend, and a numbering downstream first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CausalOrder {
    /// Per component its direct causes, in their order.
    pub causes: Vec<Vec<ComponentId>>,
    /// Per component its number: a component has a lower number than its causes.
    pub numbers: Vec<u32>,
    /// Whether some components depend on each other in a cycle; then numbers are only a tie-break.
    pub is_cyclic: bool,
}

impl CausalOrder {
    /// Reads the causal graph off the guards of a model's transitions.
    pub fn new(model: &Model) -> Self {
        let causes = causes(model);
        let mut effects_left: Vec<usize> = vec![0; causes.len()];
        causes.iter().flatten().for_each(|cause| effects_left[cause.0 as usize] += 1);
        let mut numbers = vec![u32::MAX; causes.len()];
        let mut next = 0;
        while let Some(at) = (0..causes.len()).find(|&at| numbers[at] == u32::MAX && effects_left[at] == 0) {
            numbers[at] = next;
            next += 1;
            for cause in &causes[at] {
                effects_left[cause.0 as usize] -= 1;
            }
        }
        let is_cyclic = numbers.contains(&u32::MAX);
        for number in numbers.iter_mut().filter(|number| **number == u32::MAX) {
            *number = next;
            next += 1;
        }
        Self { causes, numbers, is_cyclic }
    }

    /// A component and everything it depends on, directly or not, in their order.
    pub fn ancestors(&self, component: ComponentId) -> Vec<ComponentId> {
        let mut found = vec![component];
        let mut at = 0;
        while let Some(next) = found.get(at).copied() {
            at += 1;
            for cause in self.causes.get(next.0 as usize).into_iter().flatten() {
                if !found.contains(cause) {
                    found.push(*cause);
                }
            }
        }
        found.sort_unstable();
        found
    }

    /// The component's number, low for those far downstream.
    pub fn number(&self, component: ComponentId) -> u32 {
        self.numbers.get(component.0 as usize).copied().unwrap_or(u32::MAX)
    }
}

/// Components that depend on each other in a cycle, if there are any.
pub(crate) fn cycle(model: &Model) -> Option<Vec<ComponentId>> {
    let order = CausalOrder::new(model);
    if !order.is_cyclic {
        return None;
    }
    let on_cycle = |id: &ComponentId| {
        order
            .causes
            .get(id.0 as usize)
            .into_iter()
            .flatten()
            .any(|cause| order.ancestors(*cause).contains(id))
    };
    Some(model.component_ids().filter(on_cycle).collect())
}

fn causes(model: &Model) -> Vec<Vec<ComponentId>> {
    model
        .component_ids()
        .map(|id| {
            let mut causes = Vec::new();
            let modes = model.component(id).map_or(&[][..], |component| component.modes.as_slice());
            for choice in modes.iter().flat_map(|mode| &mode.choices) {
                choice.guard.symbols(&mut |symbol| causes.extend(owner(model, symbol)));
            }
            causes.sort_unstable();
            causes.dedup();
            causes.retain(|cause| *cause != id);
            causes
        })
        .collect()
}

/// The component that a guard speaks of by a symbol; for commands, the one that takes them.
fn owner(model: &Model, symbol: u32) -> Option<ComponentId> {
    if (symbol as usize) < model.components.len() {
        return Some(ComponentId(symbol));
    }
    if let Some(variable) = model.symbol_variable(symbol) {
        return model.variables.get(variable.0 as usize).map(|variable| variable.component);
    }
    let command = model.symbol_command(symbol)?;
    model.command_variables.get(command.0 as usize).map(|command| command.component)
}
