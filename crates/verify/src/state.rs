//! What a plan selects of each state variable (SPEC 10.2): who gives it a value, and who requires one.

use rmpl::program::LabelMode;
use tpn::{Extent, LabelId, Network, NodeId, Plan, ValueSet, VariableId};

use crate::labels::{self, interval};

/// What gives a state variable a value: its initial value, an assertion, or the effect of an activity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Producer {
    pub(crate) label: LabelId,
    pub(crate) start: NodeId,
    pub(crate) end: NodeId,
    /// From here on the variable has the value.
    pub(crate) ready: NodeId,
    /// From start to end the variable has no value.
    pub(crate) is_changing: bool,
    pub(crate) is_initial: bool,
}

/// What requires a state variable to have one of some values, from start to end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Requirement {
    pub(crate) label: LabelId,
    pub(crate) start: NodeId,
    pub(crate) end: NodeId,
}

/// A state variable with what a plan selects of it, in textual order.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub(crate) variable: VariableId,
    pub(crate) producers: Vec<Producer>,
    pub(crate) requirements: Vec<Requirement>,
}

/// The state variables that the plan's labels are about.
pub(crate) fn selected(network: &Network, plan: &Plan) -> Vec<State> {
    let mut states: Vec<State> = (0..network.variables.len())
        .map(|index| State {
            variable: VariableId::from_index(index),
            producers: Vec::new(),
            requirements: Vec::new(),
        })
        .collect();
    for label in labels::selected(network, plan) {
        if !labels::is_lasting(network, label) {
            continue;
        }
        let of = &network.labels[label.index()];
        let Some(state) = states.get_mut(of.literal.variable.index()) else { continue };
        let (start, end) = (interval(network, label).start, interval(network, label).end);
        match of.mode {
            LabelMode::Ask => state.requirements.push(Requirement { label, start, end }),
            LabelMode::Tell => {
                let is_changing = of.extent == Extent::Effect;
                state.producers.push(Producer {
                    label,
                    start,
                    end,
                    ready: if is_changing { end } else { start },
                    is_changing,
                    is_initial: of.extent == Extent::Initial,
                });
            }
        }
    }
    states.retain(|state| !state.producers.is_empty() || !state.requirements.is_empty());
    states
}

impl Producer {
    fn values<'network>(&self, network: &'network Network) -> &'network ValueSet {
        &network.labels[self.label.index()].literal.values
    }

    /// Returns whether rule 2 keeps the two apart: one of them is changing, or their values differ.
    pub(crate) fn excludes(&self, other: &Self, network: &Network) -> bool {
        self.is_changing || other.is_changing || self.values(network) != other.values(network)
    }

    /// Returns whether it can make a requirement hold: its value is one that is required, and nothing rests on its own
    /// effect.
    pub(crate) fn supports(&self, requirement: &Requirement, network: &Network) -> bool {
        self.has_value_of(requirement, network) && !is_own_effect(network, self.label, requirement.label)
    }

    fn has_value_of(&self, requirement: &Requirement, network: &Network) -> bool {
        self.values(network).is_subset(&network.labels[requirement.label.index()].literal.values)
    }

    /// Returns whether rule 1 keeps it away from a requirement that another producer supports.
    pub(crate) fn threatens(&self, requirement: &Requirement, network: &Network) -> bool {
        self.is_changing || !self.has_value_of(requirement, network)
    }
}

/// Returns whether a label is the effect of the very activity that another one is required for.
pub(crate) fn is_own_effect(network: &Network, effect: LabelId, required: LabelId) -> bool {
    let (effect, required) = (&network.labels[effect.index()], &network.labels[required.index()]);
    effect.extent == Extent::Effect && effect.arc == required.arc
}

/// Returns who a labeled interval belongs to, for people: `Deploy#1`, or the interval's own name.
pub(crate) fn owner_name(network: &Network, label: LabelId) -> String {
    match network.labels[label.index()].owner.and_then(|owner| network.occurrences.get(owner.index())) {
        Some(owner) => owner.name.to_string(),
        None => network.label_name(label),
    }
}
