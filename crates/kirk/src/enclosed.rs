//! Parts of a mission whose assertions conflict only with each other: how long they take in any order.
//!
//! Such a part touches the rest of its plan only in its first and its last event, so all that the rest can do to it is
//! to bound its duration. Trying every order of its assertions once, before the search, gives the durations that it
//! can have, or shows that it fits in no order. Touching intervals count as ordered where that is entailed already
//! (SPEC 5.3); where a bounded duration could entail it, touching is tried as a possibility of its own, so that what is
//! found here loses no plan.

use tpn::{ArcId, LabelId, NodeId};

use typed_index_collections::TiVec;

use crate::model::{INFINITE, Model, node};

/// Larger parts are left to the search.
const MAX_LABELS: usize = 6;
const MAX_POINTS: usize = 64;
const MAX_STATES: u32 = 4_000;

/// An enclosed part without choices.
#[derive(Clone, Debug)]
pub(crate) struct Enclosed {
    /// Its nodes; the first two are its first and last event.
    points: Vec<NodeId>,
    arcs: Vec<ArcId>,
    /// Its conflicting pairs of labels, in textual order.
    pairs: Vec<(LabelId, LabelId)>,
}

/// The durations found for an enclosed part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Durations {
    /// It fits in no order.
    Never,
    Between(i64, i64),
    /// Too many orders to try.
    Unknown,
}

impl Enclosed {
    /// The part of `arcs` between two nodes, of a network with these numbers of arcs at its nodes; `None` if something else
    /// touches its inside, or if there is nothing to find out about it. Takes as long as the part is large.
    pub(crate) fn new(
        model: &Model,
        num_arcs_at: &TiVec<NodeId, u32>,
        (start, end): (NodeId, NodeId),
        mut arcs: Vec<ArcId>,
    ) -> Option<Self> {
        let conditions = &model.conditions;
        arcs.sort_unstable();
        arcs.dedup();
        let mut points = vec![start, end];
        let mut labels: Vec<LabelId> = Vec::new();
        for &arc in &arcs {
            labels.extend_from_slice(conditions.labels_of(arc));
            for node in [model.arcs[arc].from, model.arcs[arc].to] {
                if !points.contains(&node) {
                    points.push(node);
                }
            }
            if labels.len() > MAX_LABELS || points.len() > MAX_POINTS || start == end {
                return None;
            }
        }
        labels.sort_unstable();
        let is_enclosed = |&label: &LabelId| {
            let label = &conditions.labels[label];
            let others = &conditions.variables[label.variable].labels;
            !label.is_ask && others.iter().all(|other| labels.binary_search(other).is_ok())
        };
        // An arc at an inner node that the blocks do not account for could lead anywhere.
        let own_at = |node: NodeId| {
            let ends = arcs.iter().flat_map(|&arc| [model.arcs[arc].from, model.arcs[arc].to]);
            ends.filter(|&end| end == node).count() as u32
        };
        let is_accounted_for = |&node: &NodeId| own_at(node) == num_arcs_at[node];
        if !labels.iter().all(is_enclosed) || !points[2..].iter().all(is_accounted_for) {
            return None;
        }
        let arc = |label: LabelId| conditions.labels[label].arc;
        let mut pairs = Vec::new();
        for (position, &left) in labels.iter().enumerate() {
            for &right in &labels[position + 1..] {
                if conditions.conflict(left, right) && arc(left) != arc(right) {
                    pairs.push((left, right));
                }
            }
        }
        (!pairs.is_empty()).then_some(Self { points, arcs, pairs })
    }

    /// The durations that the part can have in any order of its assertions.
    pub(crate) fn durations(&self, model: &Model) -> Durations {
        self.find_durations(model).unwrap_or(Durations::Unknown)
    }

    /// `None` if times do not fit or there are too many orders.
    fn find_durations(&self, model: &Model) -> Option<Durations> {
        let mut distances = Distances::new(self.points.len());
        for &arc in &self.arcs {
            let arc = &model.arcs[arc];
            let (from, to) = (self.local(arc.from)?, self.local(arc.to)?);
            let is_possible = (arc.upper == INFINITE || distances.insert(from, to, arc.upper)?)
                && distances.insert(to, from, arc.lower.checked_neg()?)?;
            if !is_possible {
                return Some(Durations::Never);
            }
        }
        let mut orders = Orders { part: self, model, states: 0, found: None };
        orders.try_from(0, &distances)?;
        Some(match orders.found {
            Some((lower, upper)) => Durations::Between(lower, upper),
            None => Durations::Never,
        })
    }

    fn local(&self, node: NodeId) -> Option<usize> {
        self.points.iter().position(|&known| known == node)
    }
}

/// A walk through the orders of a part.
struct Orders<'m> {
    part: &'m Enclosed,
    model: &'m Model,
    states: u32,
    /// The least and greatest duration so far.
    found: Option<(i64, i64)>,
}

impl Orders<'_> {
    /// Tries all orders of the pairs from `position` on. `None` if that is too much.
    fn try_from(&mut self, position: usize, distances: &Distances) -> Option<()> {
        self.states += 1;
        if self.states > MAX_STATES {
            return None;
        }
        let Some(&(left, right)) = self.part.pairs.get(position) else {
            let lower = distances.least_duration()?;
            let upper = distances.get(0, 1);
            let (least, greatest) = self.found.unwrap_or((lower, upper));
            self.found = Some((least.min(lower), greatest.max(upper)));
            return Some(());
        };
        let directions = [self.direction(left, right)?, self.direction(right, left)?];
        if directions.iter().any(|&(from, to, touching)| distances.get(from, to) <= touching) {
            return self.try_from(position + 1, distances);
        }
        for (from, to, touching) in directions {
            let apart = -self.model.gap;
            self.try_with(position, distances, (from, to, apart))?;
            // Touching is tried by itself although it allows for more: being apart may entail other orders.
            if touching > apart && distances.may_entail(from, to, touching)? {
                self.try_with(position, distances, (from, to, touching))?;
            }
        }
        Some(())
    }

    /// Tries the orders that are left once the pair at `position` has an edge.
    fn try_with(
        &mut self,
        position: usize,
        distances: &Distances,
        (from, to, weight): (usize, usize, i64),
    ) -> Option<()> {
        let mut ordered = distances.clone();
        if ordered.insert(from, to, weight)? { self.try_from(position + 1, &ordered) } else { Some(()) }
    }

    /// The edge that puts one interval before another, with the weight that counts as ordered if it is entailed.
    fn direction(&self, first: LabelId, then: LabelId) -> Option<(usize, usize, i64)> {
        let (_, first_end) = self.model.interval(first);
        let (then_start, _) = self.model.interval(then);
        Some((
            self.part.local(node(then_start))?,
            self.part.local(node(first_end))?,
            -self.model.gap_after[first],
        ))
    }
}

/// The distances of a small network; the first two points are its only connections to others.
#[derive(Clone, Debug)]
struct Distances {
    count: usize,
    rows: Vec<i64>,
}

impl Distances {
    fn new(count: usize) -> Self {
        let mut rows = vec![INFINITE; count * count];
        for point in 0..count {
            rows[point * count + point] = 0;
        }
        Self { count, rows }
    }

    fn get(&self, from: usize, to: usize) -> i64 {
        self.rows[from * self.count + to]
    }

    /// Adds `to − from ≤ weight`; `false` if that is a contradiction, `None` if times do not fit.
    fn insert(&mut self, from: usize, to: usize, weight: i64) -> Option<bool> {
        if self.get(from, to) <= weight {
            return Some(true);
        }
        if sum(self.get(to, from), weight)? < 0 {
            return Some(false);
        }
        for before in 0..self.count {
            let reached = sum(self.get(before, from), weight)?;
            if reached == INFINITE {
                continue;
            }
            for after in 0..self.count {
                let through = sum(reached, self.get(to, after))?;
                let known = &mut self.rows[before * self.count + after];
                *known = through.min(*known);
            }
        }
        Some(true)
    }

    fn least_duration(&self) -> Option<i64> {
        let distance = self.get(1, 0);
        if distance == INFINITE { None } else { distance.checked_neg() }
    }

    /// Whether bounds on the whole duration that are consistent with it could entail `to − from ≤ weight`.
    ///
    /// A lower bound on the duration is at most the greatest one, and an upper bound at least the least one.
    fn may_entail(&self, from: usize, to: usize, weight: i64) -> Option<bool> {
        let by_end = sum(self.get(from, 1), self.get(0, to))?;
        let through_lower = by_end != INFINITE
            && (self.get(0, 1) == INFINITE || by_end.checked_sub(self.get(0, 1))? <= weight);
        let least = self.least_duration()?;
        let by_start = sum(self.get(from, 0), self.get(1, to))?;
        let through_upper = by_start != INFINITE && by_start.checked_add(least)? <= weight;
        Some(through_lower || through_upper)
    }
}

fn sum(left: i64, right: i64) -> Option<i64> {
    if left == INFINITE || right == INFINITE { Some(INFINITE) } else { left.checked_add(right) }
}
