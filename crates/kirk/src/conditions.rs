//! Labelled intervals by variable, so that conflicts and supports are found without looking at every pair.

use std::collections::HashMap;

use tpn::{Literal, Network};

use crate::model::is_ask;

/// The labels of a network, and which literals of a variable conflict or support each other.
#[derive(Clone, Debug)]
pub(crate) struct Conditions {
    pub(crate) labels: Vec<ModelLabel>,
    pub(crate) variables: Vec<VariableIndex>,
    /// Labels of arcs that carry a contradiction within themselves.
    pub(crate) self_conflicting: Vec<(u32, u32)>,
    /// The labels of arc `a` are `arc_labels[arc_start[a]..arc_start[a + 1]]`.
    arc_start: Vec<u32>,
    arc_labels: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct ModelLabel {
    pub(crate) arc: u32,
    pub(crate) variable: u32,
    /// The literal among the distinct literals of its variable.
    literal: u32,
    /// The position among the labels of its variable.
    position: u32,
    pub(crate) is_ask: bool,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct VariableIndex {
    /// In textual order.
    pub(crate) labels: Vec<u32>,
    num_literals: usize,
    /// Square: whether two literals conflict.
    conflicts: Vec<bool>,
    /// Square: whether asserting the first makes the second hold.
    supports: Vec<bool>,
}

impl Conditions {
    pub(crate) fn new(network: &Network) -> Self {
        let mut variables = vec![VariableIndex::default(); network.variables.len()];
        let mut literals: Vec<Vec<&Literal>> = vec![Vec::new(); network.variables.len()];
        let mut numbers: HashMap<&Literal, u32> = HashMap::new();
        let mut labels = Vec::with_capacity(network.labels.len());
        for (id, label) in (0..).zip(&network.labels) {
            let variable = label.literal.variable.index();
            let known = &mut literals[variable];
            let literal = *numbers.entry(&label.literal).or_insert_with(|| {
                known.push(&label.literal);
                known.len() as u32 - 1
            });
            let position = variables[variable].labels.len() as u32;
            variables[variable].labels.push(id);
            labels.push(ModelLabel {
                arc: label.arc.0,
                variable: variable as u32,
                literal,
                position,
                is_ask: is_ask(label.mode),
            });
        }
        for (variable, literals) in variables.iter_mut().zip(&literals) {
            variable.num_literals = literals.len();
            for left in literals {
                variable.conflicts.extend(literals.iter().map(|right| left.conflicts(right)));
                variable.supports.extend(literals.iter().map(|right| left.supports(right)));
            }
        }
        let mut arc_start = Vec::with_capacity(network.arcs.len() + 1);
        let mut arc_labels = Vec::with_capacity(network.labels.len());
        for arc in &network.arcs {
            arc_start.push(arc_labels.len() as u32);
            arc_labels.extend(arc.labels.iter().map(|label| label.0));
        }
        arc_start.push(arc_labels.len() as u32);
        let mut conditions = Self { labels, variables, self_conflicting: Vec::new(), arc_start, arc_labels };
        for arc in network.arcs.iter().filter(|arc| arc.labels.len() > 1) {
            for (at, left) in arc.labels.iter().enumerate() {
                let others = arc.labels[at + 1..].iter().filter(|right| conditions.conflict(left.0, right.0));
                let pairs: Vec<(u32, u32)> = others.map(|right| (left.0, right.0)).collect();
                conditions.self_conflicting.extend(pairs);
            }
        }
        conditions
    }

    /// Whether two labels cannot hold together.
    pub(crate) fn conflict(&self, left: u32, right: u32) -> bool {
        let (left, right) = (&self.labels[left as usize], &self.labels[right as usize]);
        let variable = &self.variables[left.variable as usize];
        left.variable == right.variable
            && variable.conflicts[left.literal as usize * variable.num_literals + right.literal as usize]
    }

    /// Whether `tell` is an assertion that makes requirement `ask` hold.
    pub(crate) fn supports(&self, tell: u32, ask: u32) -> bool {
        let (tell, ask) = (&self.labels[tell as usize], &self.labels[ask as usize]);
        let variable = &self.variables[ask.variable as usize];
        tell.variable == ask.variable
            && !tell.is_ask
            && ask.is_ask
            && variable.supports[tell.literal as usize * variable.num_literals + ask.literal as usize]
    }

    /// The assertions that would make requirement `ask` hold, selected or not, in textual order.
    pub(crate) fn supporters(&self, ask: u32) -> impl Iterator<Item = u32> + '_ {
        let required = &self.labels[ask as usize];
        let variable = &self.variables[required.variable as usize];
        variable.labels.iter().copied().filter(move |&tell| {
            let tell = &self.labels[tell as usize];
            !tell.is_ask
                && variable.supports
                    [tell.literal as usize * variable.num_literals + required.literal as usize]
        })
    }

    /// The labels of an arc.
    pub(crate) fn labels_of(&self, arc: u32) -> &[u32] {
        let arc = arc as usize;
        &self.arc_labels[self.arc_start[arc] as usize..self.arc_start[arc + 1] as usize]
    }

    /// The labels that conflict with `label`, selected or not.
    pub(crate) fn conflicts(&self, label: u32) -> impl Iterator<Item = u32> + '_ {
        let own = &self.labels[label as usize];
        let variable = &self.variables[own.variable as usize];
        let row = own.literal as usize * variable.num_literals;
        let row = &variable.conflicts[row..row + variable.num_literals];
        variable
            .labels
            .iter()
            .copied()
            .filter(move |&other| row[self.labels[other as usize].literal as usize])
    }

    /// The labels after `label`, in textual order, that conflict with it, selected or not.
    pub(crate) fn later_conflicts(&self, label: u32) -> impl Iterator<Item = u32> + '_ {
        let own = &self.labels[label as usize];
        let variable = &self.variables[own.variable as usize];
        let row = own.literal as usize * variable.num_literals;
        let row = &variable.conflicts[row..row + variable.num_literals];
        variable.labels[own.position as usize + 1..]
            .iter()
            .copied()
            .filter(move |&other| row[self.labels[other as usize].literal as usize])
    }
}
