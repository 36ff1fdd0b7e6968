//! What dead ends rest on, kept for explanations, and negative cycles in the network's terms.

use tpn::{ArcId, CausalLink, LabelId, NodeId, Ordering};

use crate::failure::{FailureKind, Member};
use crate::levels::Kind;
use crate::search::{Engine, LEVEL_TAG};
use crate::trace::{Constraint, CycleMember};

/// A failure of every completion of some choices.
#[derive(Clone, Debug)]
pub(crate) struct DeadEnd {
    pub(crate) kind: FailureKind,
    pub(crate) choices: Vec<(u32, u32)>,
    /// Bounds and conditions that together fail; not minimal.
    pub(crate) members: Vec<Member>,
    /// The first contradiction among the bounds.
    pub(crate) cycle: Vec<CycleMember>,
}

/// The dead ends of a search, and the one being met.
#[derive(Clone, Debug, Default)]
pub(crate) struct DeadEnds {
    pub(crate) found: Vec<DeadEnd>,
    kind: Option<FailureKind>,
    members: Vec<Member>,
    cycle: Vec<CycleMember>,
}

impl DeadEnds {
    pub(crate) fn meet(&mut self, kind: FailureKind) {
        self.kind = self.kind.max(Some(kind));
    }

    pub(crate) fn add_label(&mut self, label: u32) {
        self.members.push(Member::Condition(LabelId(label)));
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

    /// Ends the dead end being met, if there is one.
    pub(crate) fn flush(&mut self, choices: Vec<(u32, u32)>) -> Option<DeadEnd> {
        let mut members = std::mem::take(&mut self.members);
        let cycle = std::mem::take(&mut self.cycle);
        members.sort_unstable();
        members.dedup();
        Some(DeadEnd { kind: self.kind.take()?, choices, members, cycle })
    }
}

/// The negative cycle that the search has just met.
pub(crate) fn cycle_of(engine: &Engine<'_>) -> Vec<CycleMember> {
    let members = engine.stn.cycle().iter().filter_map(|edge| {
        let constraint = if edge.tag >= LEVEL_TAG {
            let level = engine.levels.get((edge.tag - LEVEL_TAG) as usize)?;
            match &level.kind {
                Kind::Decision { .. } => return None,
                Kind::Link { ask, tells, .. } => {
                    let tell = *tells.get(level.next.checked_sub(1)? as usize)?;
                    Constraint::Link(CausalLink { ask: LabelId(*ask), tell: LabelId(tell) })
                }
                &Kind::Threat { left, right, .. } => {
                    let (first, then) = if level.next == 1 { (left, right) } else { (right, left) };
                    Constraint::Order(Ordering { first: LabelId(first), then: LabelId(then) })
                }
            }
        } else {
            let arc = &engine.model.arcs[edge.tag as usize];
            let is_upper = edge.from.0 == arc.from && edge.weight == arc.upper;
            if is_upper { Constraint::Upper(ArcId(edge.tag)) } else { Constraint::Lower(ArcId(edge.tag)) }
        };
        Some(CycleMember {
            constraint,
            from: NodeId(edge.from.0),
            to: NodeId(edge.to.0),
            weight: engine.model.time(edge.weight),
        })
    });
    members.collect()
}
