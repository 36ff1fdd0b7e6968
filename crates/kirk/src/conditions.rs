//! Labeled intervals by variable, so that conflicts and supports are found without looking at every pair.

use std::collections::HashMap;

use rmpl::program::LabelMode;
use tpn::{ArcId, Extent, LabelId, Literal, Network, ValueId, ValueSet, VariableId};
use typed_index_collections::TiVec;

use crate::ids::LiteralId;

/// The labels of a network, and which literals of a variable conflict or support each other.
#[derive(Clone, Debug)]
pub(crate) struct Conditions {
    pub(crate) labels: TiVec<LabelId, ModelLabel>,
    pub(crate) variables: TiVec<VariableId, VariableIndex>,
    /// Labels of arcs that carry a contradiction within themselves.
    pub(crate) self_conflicting: Vec<(LabelId, LabelId)>,
    /// The labels of arc `a` are `arc_labels[arc_start[a]..arc_start[a + 1]]`.
    arc_start: Vec<u32>,
    arc_labels: Vec<LabelId>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct ModelLabel {
    pub(crate) arc: ArcId,
    pub(crate) variable: VariableId,
    /// The literal among the distinct literals of its variable.
    literal: LiteralId,
    /// The position among the labels of its variable.
    position: u32,
    /// Whether it is a requirement of a variable that is known only where it is asserted.
    pub(crate) is_ask: bool,
    /// Whether its variable keeps its value (SPEC 10); all else here leaves such labels out.
    pub(crate) is_lasting: bool,
    pub(crate) is_changing: bool,
    /// Of a change: the value that it gives.
    pub(crate) value: Option<ValueId>,
    /// Whether it is only about the instant at which its arc begins.
    pub(crate) is_at_start: bool,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct VariableIndex {
    /// In textual order.
    pub(crate) labels: Vec<LabelId>,
    num_literals: usize,
    /// Square: whether two literals conflict.
    conflicts: Vec<bool>,
    /// Square: whether asserting the first makes the second hold.
    supports: Vec<bool>,
}

impl VariableIndex {
    /// Returns where the squares have a pair of literals.
    fn cell(&self, left: LiteralId, right: LiteralId) -> usize {
        usize::from(left) * self.num_literals + usize::from(right)
    }

    /// Returns which literals conflict with one.
    fn conflicts_of(&self, literal: LiteralId) -> &[bool] {
        let first = usize::from(literal) * self.num_literals;
        &self.conflicts[first..first + self.num_literals]
    }
}

impl Conditions {
    pub(crate) fn new(network: &Network) -> Self {
        let mut variables: TiVec<VariableId, VariableIndex> =
            vec![VariableIndex::default(); network.variables.len()].into();
        let mut literals: TiVec<VariableId, TiVec<LiteralId, &Literal>> =
            vec![TiVec::new(); network.variables.len()].into();
        let mut known: HashMap<&Literal, LiteralId> = HashMap::with_capacity(network.labels.len());
        let mut labels = TiVec::with_capacity(network.labels.len());
        for label in &network.labels {
            let variable = label.literal.variable;
            let literal = *known
                .entry(&label.literal)
                .or_insert_with(|| literals[variable].push_and_get_key(&label.literal));
            let position = variables[variable].labels.len() as u32;
            let is_lasting = network.variables[usize::from(variable)].is_lasting;
            let id = labels.push_and_get_key(ModelLabel {
                arc: label.arc,
                variable,
                literal,
                position,
                is_ask: label.mode == LabelMode::Ask && !is_lasting,
                is_lasting,
                is_changing: label.is_changing(),
                value: match &label.literal.values {
                    ValueSet::In(values) if is_lasting => values.first().copied(),
                    _ => None,
                },
                is_at_start: matches!(label.extent, Extent::Start | Extent::Initial),
            });
            if !is_lasting {
                variables[variable].labels.push(id);
            }
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
            arc_labels.extend_from_slice(&arc.labels);
        }
        arc_start.push(arc_labels.len() as u32);
        let mut conditions = Self { labels, variables, self_conflicting: Vec::new(), arc_start, arc_labels };
        for arc in network.arcs.iter().filter(|arc| arc.labels.len() > 1) {
            for (at, left) in arc.labels.iter().enumerate() {
                let others = arc.labels[at + 1..].iter().filter(|&&right| conditions.conflict(*left, right));
                let pairs: Vec<(LabelId, LabelId)> = others.map(|&right| (*left, right)).collect();
                conditions.self_conflicting.extend(pairs);
            }
        }
        conditions
    }

    /// Returns whether two labels cannot hold together.
    pub(crate) fn conflict(&self, left: LabelId, right: LabelId) -> bool {
        let (left, right) = (&self.labels[left], &self.labels[right]);
        let variable = &self.variables[left.variable];
        left.variable == right.variable
            && !left.is_lasting
            && variable.conflicts[variable.cell(left.literal, right.literal)]
    }

    /// Returns whether one change of a variable that keeps its value must be over before another begins (SPEC 10.2).
    pub(crate) fn exclude(&self, left: LabelId, right: LabelId) -> bool {
        let (left, right) = (&self.labels[left], &self.labels[right]);
        left.variable == right.variable
            && (left.is_changing || right.is_changing || left.literal != right.literal)
    }

    /// Returns whether no value of a variable that keeps its value is accepted by both of two requirements.
    pub(crate) fn contradict(&self, left: LabelId, right: LabelId) -> bool {
        let (left, right) = (&self.labels[left], &self.labels[right]);
        let variable = &self.variables[left.variable];
        left.variable == right.variable && variable.conflicts[variable.cell(left.literal, right.literal)]
    }

    /// Returns whether a change gives its variable a value that requirement `ask` accepts.
    pub(crate) fn gives(&self, change: LabelId, ask: LabelId) -> bool {
        let (change, ask) = (&self.labels[change], &self.labels[ask]);
        let variable = &self.variables[ask.variable];
        change.variable == ask.variable && variable.supports[variable.cell(change.literal, ask.literal)]
    }

    /// Returns whether a change gives its variable this value.
    pub(crate) fn gives_value(&self, change: LabelId, value: ValueId) -> bool {
        self.labels[change].value == Some(value)
    }

    /// Returns whether requirement `ask` cannot continue during or after a change.
    pub(crate) fn breaks(&self, change: LabelId, ask: LabelId) -> bool {
        self.labels[change].is_changing || !self.gives(change, ask)
    }

    /// Returns whether `tell` is an assertion that makes requirement `ask` hold.
    pub(crate) fn supports(&self, tell: LabelId, ask: LabelId) -> bool {
        let (tell, ask) = (&self.labels[tell], &self.labels[ask]);
        let variable = &self.variables[ask.variable];
        tell.variable == ask.variable
            && !tell.is_ask
            && ask.is_ask
            && variable.supports[variable.cell(tell.literal, ask.literal)]
    }

    /// The assertions that would make requirement `ask` hold, selected or not, in textual order.
    pub(crate) fn supporters(&self, ask: LabelId) -> impl Iterator<Item = LabelId> + '_ {
        let required = &self.labels[ask];
        let variable = &self.variables[required.variable];
        variable.labels.iter().copied().filter(move |&tell| {
            let tell = &self.labels[tell];
            !tell.is_ask && variable.supports[variable.cell(tell.literal, required.literal)]
        })
    }

    /// The labels of an arc.
    pub(crate) fn labels_of(&self, arc: ArcId) -> &[LabelId] {
        let arc = arc.index();
        &self.arc_labels[self.arc_start[arc] as usize..self.arc_start[arc + 1] as usize]
    }

    /// The labels after `label`, in textual order, that conflict with it, selected or not.
    pub(crate) fn later_conflicts(&self, label: LabelId) -> impl Iterator<Item = LabelId> + '_ {
        let own = &self.labels[label];
        let variable = &self.variables[own.variable];
        let row = variable.conflicts_of(own.literal);
        let later = variable.labels.get(own.position as usize + 1..).unwrap_or_default();
        later.iter().copied().filter(move |&other| row[usize::from(self.labels[other].literal)])
    }
}
