//! The order of events within one instant (SPEC 10.4) where everything is decided: what happens before what has no circle,
//! or one of the literals along it must not hold.

use std::collections::BTreeMap;

use rmpl::program::Change;
use tpn::{LabelId, NodeId};
use typed_index_collections::TiVec;

use super::Solver;
use super::encode::Problem;
use super::literal::Literal;
use super::premise::Premise;
use crate::demands::ModelSupply;
use crate::instants::{self, Before, Turn};
use crate::model::{Model, node};
use crate::trace::Event;

/// Events in an order by time and within instants, of the solution looked at last.
#[derive(Clone, Debug, Default)]
pub(crate) struct Instants {
    turn: TiVec<NodeId, Turn>,
    positions: TiVec<NodeId, u32>,
}

impl Instants {
    pub(super) fn new(model: &Model) -> Self {
        Self { turn: turns(model), positions: vec![0; model.num_nodes].into() }
    }

    /// Returns where an event stands.
    pub(super) fn position(&self, node: NodeId) -> u32 {
        self.positions[node]
    }
}

/// Whose turn each event is: ends of uses and productions give, starts of uses and consumptions take.
pub(crate) fn turns(model: &Model) -> TiVec<NodeId, Turn> {
    let mut turn: TiVec<NodeId, Option<Turn>> = vec![None; model.num_nodes].into();
    let mut add = |node: NodeId, own: Turn| {
        turn[node] = Some(if turn[node].is_none_or(|known| known == own) { own } else { Turn::Neither });
    };
    for resource in &model.demands.resources {
        for used in resource.uses.iter().filter(|used| used.level.is_none()) {
            match (resource.supply, used.change) {
                (ModelSupply::Reusable { .. }, _) => {
                    add(used.start, Turn::Takes);
                    add(used.end, Turn::Gives);
                }
                (_, Change::Produces) => add(used.end, Turn::Gives),
                _ => add(used.start, Turn::Takes),
            }
        }
    }
    turn.into_iter().map(Option::unwrap_or_default).collect()
}

impl Problem<'_> {
    /// Orders the events of the present solution, or forbids a circle among what happens before what. `false` if there is
    /// none.
    pub(super) fn break_circles(&mut self, solver: &mut Solver) -> bool {
        let demands = &self.model.demands;
        if demands.variables.is_empty() && demands.resources.is_empty() {
            return false;
        }
        let times = self.model.order.iter().map(|&point| node(point));
        let mut at: TiVec<NodeId, Option<i64>> = vec![None; self.model.num_nodes].into();
        for node in times {
            let time = self.times[node];
            at[node] = solver.trail.holds(solver.trail.presence(time)).then(|| solver.trail.least(time));
        }
        match instants::order(&at, &self.happens_before(solver), &self.instants.turn) {
            Ok(positions) => {
                self.instants.positions = positions;
                false
            }
            Err(circle) => {
                let mut circle: Vec<Literal> =
                    circle.into_iter().flatten().filter(|&literal| literal != Literal::TRUE).collect();
                circle.sort_unstable();
                circle.dedup();
                solver.stats.conflicts += 1;
                solver.record_refusal(&circle, |orders| Event::Circle { orders });
                solver.retract(0);
                solver.tell_from_premises([Premise::Unknown]);
                solver.at_least_one(circle.into_iter().map(|literal| !literal));
                true
            }
        }
    }

    /// Returns what happens before what in the present solution, with the literals that it rests on.
    pub(super) fn happens_before(&self, solver: &Solver) -> Vec<Before<[Literal; 2]>> {
        let model = self.model;
        let mut before = Vec::with_capacity(model.arcs.len());
        for arc in &self.enclosures.mission().arcs {
            // What leads back to the start says when something was, and not before what.
            if arc.lower >= 0 && arc.to != model.start && self.is_present(solver, arc) {
                let reason = [self.presence(arc.context), self.presence(arc.other_context)];
                before.push(Before { first: arc.from, then: arc.to, reason });
            }
        }
        let mut add = |first: NodeId, then: NodeId, literal: Literal| {
            if solver.trail.holds(literal) {
                before.push(Before { first, then, reason: [literal, Literal::TRUE] });
            }
        };
        let interval = |label: LabelId| {
            let (start, end) = model.interval(label);
            (node(start), node(end))
        };
        for (ask, options) in &self.sides.carriers {
            for &(change, link) in options {
                let (start, end) = interval(change);
                let ready = if model.conditions.labels[change].is_changing { end } else { start };
                let asked = interval(*ask).0;
                if solver.trail.holds(self.intervals[*ask].presence) && ready != asked {
                    add(ready, asked, link);
                }
            }
        }
        for (&(left, right), &[left_first, right_first]) in &self.sides.orders {
            let is_present = |label: LabelId| solver.trail.holds(self.intervals[label].presence);
            if is_present(left) && is_present(right) {
                add(interval(left).1, interval(right).0, left_first);
                add(interval(right).1, interval(left).0, right_first);
            }
        }
        for &(order, after) in &self.sides.kept_before {
            add(interval(order.first).1, interval(order.then).0, after);
        }
        let uses: BTreeMap<_, _> = (model.demands.resources.iter())
            .flat_map(|resource| resource.uses.iter().map(move |used| (used.id, (resource.supply, used))))
            .collect();
        for (&(first, then), &order) in self.shares.pairs() {
            let (Some((supply, first)), Some((_, then))) = (uses.get(&first), uses.get(&then)) else {
                continue;
            };
            match supply {
                ModelSupply::Reusable { .. } => add(first.end, then.start, order),
                ModelSupply::Reservoir { .. } => add(first.last_moment(), then.moment(), order),
            }
        }
        before
    }
}
