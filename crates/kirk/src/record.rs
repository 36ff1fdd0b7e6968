//! What failures rest on, kept for explanations, and negative cycles in the network's terms.

use tpn::{CausalLink, Choice, LabelId, Ordering};

use crate::failure::{FailureKind, Member};
use crate::levels::Kind;
use crate::model::node;
use crate::search::{Engine, Origin};
use crate::trace::{Constraint, CycleMember};

/// A failure of every completion of some choices.
#[derive(Clone, Debug)]
pub(crate) struct RecordedFailure {
    pub(crate) kind: FailureKind,
    pub(crate) choices: Vec<Choice>,
    /// Bounds and conditions that together fail; not minimal.
    pub(crate) members: Vec<Member>,
    /// The first contradiction among the bounds.
    pub(crate) cycle: Vec<CycleMember>,
}

/// The failures of a search, and the one being met.
#[derive(Clone, Debug, Default)]
pub(crate) struct FailureRecorder {
    pub(crate) found: Vec<RecordedFailure>,
    kind: Option<FailureKind>,
    members: Vec<Member>,
    cycle: Vec<CycleMember>,
}

impl FailureRecorder {
    pub(crate) fn meet(&mut self, kind: FailureKind) {
        self.kind = self.kind.max(Some(kind));
    }

    pub(crate) fn add_label(&mut self, label: LabelId) {
        self.members.push(Member::Condition(label));
    }

    pub(crate) fn add_cycle(&mut self, cycle: Vec<CycleMember>) {
        let bounds = cycle.iter().map(|member| member.constraint);
        let is_bound =
            |constraint: &Constraint| matches!(constraint, Constraint::Lower(_) | Constraint::Upper(_));
        self.members.extend(bounds.filter(is_bound).map(Member::Bound));
        if self.cycle.is_empty() {
            self.cycle = cycle;
        }
    }

    /// Ends the failure being met, if there is one.
    pub(crate) fn flush(&mut self, choices: Vec<Choice>) -> Option<RecordedFailure> {
        let mut members = std::mem::take(&mut self.members);
        let cycle = std::mem::take(&mut self.cycle);
        members.sort_unstable();
        members.dedup();
        Some(RecordedFailure { kind: self.kind.take()?, choices, members, cycle })
    }
}

/// The negative cycle that the search has just met.
pub(crate) fn cycle_of(engine: &Engine<'_>) -> Vec<CycleMember> {
    let members = engine.stn.cycle().iter().filter_map(|edge| {
        let constraint = match Origin::of(edge.tag) {
            Origin::Level(level) => {
                let level = engine.levels.get(level)?;
                match &level.kind {
                    Kind::Decision { .. } => return None,
                    Kind::Link { ask, tells, .. } => {
                        let tell = *tells.get(level.next.checked_sub(1)? as usize)?;
                        Constraint::Link(CausalLink { ask: *ask, tell })
                    }
                    &Kind::Threat { left, right, .. } => {
                        let (first, then) = if level.next == 1 { (left, right) } else { (right, left) };
                        Constraint::Order(Ordering { first, then })
                    }
                }
            }
            Origin::Arc(id) => {
                let arc = &engine.model.arcs[id];
                let is_upper = node(edge.from) == arc.from && edge.weight == arc.upper;
                if is_upper { Constraint::Upper(id) } else { Constraint::Lower(id) }
            }
        };
        Some(CycleMember {
            constraint,
            from: node(edge.from),
            to: node(edge.to),
            weight: engine.model.time(edge.weight),
        })
    });
    members.collect()
}
