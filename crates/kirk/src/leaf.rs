//! Phase 2 at a complete choice: the requirements to close and the conflicting pairs to order (SPEC 5.2, 5.3).

use stn::{Inconsistency, Overflow, PointId};
use tpn::LabelId;

use crate::failure::FailureKind;
use crate::model::{INFINITE, point};
use crate::search::{Engine, Origin};
use crate::structure::Relation;
use crate::unplannable::Unplannable;

/// What the present complete choice has to satisfy.
#[derive(Clone, Debug, Default)]
pub(crate) struct Leaf {
    /// Whether the rest belongs to the present choice.
    pub(crate) is_ready: bool,
    /// Selected requirements, in textual order.
    pub(crate) asks: Vec<LabelId>,
    /// Conflicting pairs of selected labels, in textual order.
    pub(crate) pairs: Vec<(LabelId, LabelId)>,
    has_pairs: bool,
    /// For each pair that has been passed: whether the second comes first.
    pub(crate) is_swapped: Vec<bool>,
    /// Distances from and to the start with all links and no order yet: still bounds with orders.
    from_start: Vec<i64>,
    to_start: Vec<i64>,
    pub(crate) has_windows: bool,
    /// How many edges the network had then.
    num_edges: usize,
    /// Times that fit all links and no order yet: orders that they break are seen at once not to follow.
    pub(crate) schedule: Vec<i64>,
}

impl Leaf {
    /// Distances from and to the start with all links and no order, once they are found.
    pub(crate) fn windows(&self) -> (&[i64], &[i64]) {
        (&self.from_start, &self.to_start)
    }
}

impl Engine<'_> {
    /// Prepares phase 2. `false` if the selection is inconsistent, or contradicts itself on one arc.
    pub(crate) fn make_leaf(&mut self) -> Result<bool, Unplannable> {
        self.stats.leaves += 1;
        self.look_harder();
        self.conflict.clear();
        self.leaf.has_pairs = false;
        self.leaf.has_windows = false;
        if self.has_structure() || self.setup.is_checking {
            self.select_chosen();
            if !self.settle_selected()? {
                self.meet_failure(FailureKind::Temporal);
                return Ok(false);
            }
        }
        let model = self.model;
        self.leaf.asks.clear();
        for label in model.conditions.labels.keys() {
            if model.conditions.labels[label].is_ask && self.is_selected_label(label) && self.is_active(label)
            {
                self.leaf.asks.push(label);
            }
        }
        for &(left, right) in &model.conditions.self_conflicting {
            if self.is_selected_label(left) && self.is_active(left) && self.is_active(right) {
                self.add_context_to_conflict(self.context(model.conditions.labels[left].arc));
                self.failures.add_label(left);
                self.failures.add_label(right);
                self.meet_failure(FailureKind::Threat);
                return Ok(false);
            }
        }
        self.leaf.is_ready = true;
        Ok(true)
    }

    /// The first pair at `from` or later that is in neither order yet, with its position.
    pub(crate) fn next_threat(&mut self, from: u32) -> Result<Option<(u32, LabelId, LabelId)>, Unplannable> {
        self.find_pairs();
        for position in from..self.leaf.pairs.len() as u32 {
            let (left, right) = self.leaf.pairs[position as usize];
            match self.relation(left, right)? {
                Relation::Before => self.leaf.is_swapped[position as usize] = false,
                Relation::After => self.leaf.is_swapped[position as usize] = true,
                Relation::Open => return Ok(Some((position, left, right))),
            }
        }
        Ok(None)
    }

    /// Whether the plan that the search stands at leaves room for the gap between all pairs that nesting does not order:
    /// then none of them rests on being forced to touch.
    pub(crate) fn has_room_for_gaps(&mut self) -> Result<bool, Unplannable> {
        let (checkpoint, tag) = (self.stn.checkpoint(), self.next_tag());
        let mut inserted = Ok(());
        for position in 0..self.leaf.pairs.len() {
            let (left, right) = self.leaf.pairs[position];
            let (first, then) = if self.leaf.is_swapped[position] { (right, left) } else { (left, right) };
            let arc = |label: LabelId| self.model.conditions.labels[label].arc;
            let is_nested = |structure: &crate::structure::Structure| {
                structure.relation(arc(first), arc(then)) != Relation::Open
            };
            if inserted.is_ok() && !self.model.structure.as_ref().is_some_and(is_nested) {
                let (first_end, then_start) = (self.model.interval(first).1, self.model.interval(then).0);
                inserted = self.stn.insert(then_start, first_end, -self.model.gap, tag);
            }
        }
        self.stn.rollback(checkpoint);
        match inserted {
            Ok(()) => Ok(true),
            Err(Inconsistency::NegativeCycle) => Ok(false),
            Err(Inconsistency::Overflow(overflow)) => Err(overflow.into()),
        }
    }

    /// Every conflicting pair, with the one that comes first in front. A pair that is in both orders at once, as
    /// intervals of no length at one instant are where no gap is asked for, is in the textual one: what the search met
    /// last on its way may have forced them together.
    pub(crate) fn conflict_order(&mut self) -> Result<Vec<(LabelId, LabelId)>, Unplannable> {
        let mut ordered = self.leaf.pairs.clone();
        for (position, pair) in ordered.iter_mut().enumerate() {
            let (left, right) = *pair;
            let ((_, left_end), (right_start, _)) = (self.model.interval(left), self.model.interval(right));
            if self.leaf.is_swapped[position]
                && !self.is_entailed(left_end, right_start, self.model.gap_after[left])?
            {
                *pair = (right, left);
            }
        }
        ordered.sort_by_key(|&(first, then)| (first.min(then), first.max(then)));
        Ok(ordered)
    }

    /// All selected arcs of the present choices, pushed but not propagated.
    fn select_chosen(&mut self) {
        let model = self.model;
        self.deselect(0, 0);
        self.prepare_stn();
        self.stn.clear();
        if let Some(lookahead) = &self.lookahead {
            // Times that fit what the look-ahead knows leave little to move for links.
            self.stn.propose(lookahead.likely_times(model));
        } else {
            self.stn.propose(self.setup.proposed.iter().copied());
        }
        let mut stack = vec![model.start];
        self.select_node(model.start, None);
        while let Some(node) = stack.pop() {
            let arcs = match model.decision_of[node] {
                None => model.out_arcs(node),
                Some(decision) => {
                    let taken = self.chosen[decision].map(|taken| taken as usize);
                    taken.map_or(&[][..], |taken| &model.decisions[decision].alternatives[taken..=taken])
                }
            };
            for &arc in arcs {
                self.is_selected_arc[arc] = true;
                self.selected_arcs.push(arc);
                self.push_arc(arc);
                let target = model.arcs[arc].to;
                if self.select_node(target, None) {
                    stack.push(target);
                }
            }
        }
    }

    /// Finds the conflicting pairs, if they are not known yet.
    pub(crate) fn find_pairs(&mut self) {
        if std::mem::replace(&mut self.leaf.has_pairs, true) {
            return;
        }
        self.leaf.schedule.clear();
        self.leaf.schedule.extend_from_slice(self.stn.schedule());
        self.leaf.pairs.clear();
        let conditions = &self.model.conditions;
        for left in conditions.labels.keys() {
            if !self.is_selected_label(left) || !self.is_active(left) {
                continue;
            }
            for right in conditions.later_conflicts(left) {
                if self.is_selected_label(right) && self.is_active(right) {
                    self.leaf.pairs.push((left, right));
                }
            }
        }
        if self.setup.orders_touching_last {
            // What only touches may be ordered by what follows from the others.
            let mut pairs = std::mem::take(&mut self.leaf.pairs);
            pairs.sort_by_key(|&(left, right)| self.only_touch(left, right));
            self.leaf.pairs = pairs;
        }
        self.leaf.is_swapped.clear();
        self.leaf.is_swapped.resize(self.leaf.pairs.len(), false);
    }

    /// Which of two intervals is over before the other begins, in every schedule (SPEC 5.3).
    pub(crate) fn relation(&mut self, left: LabelId, right: LabelId) -> Result<Relation, Unplannable> {
        let nested = self.nested_relation(left, right);
        if nested != Relation::Open {
            return Ok(nested);
        }
        let (left_start, left_end) = self.model.interval(left);
        let (right_start, right_end) = self.model.interval(right);
        let (gap_after_left, gap_after_right) = (self.model.gap_after[left], self.model.gap_after[right]);
        self.find_windows()?;
        if self.ends_by(left_end, right_start, gap_after_left) {
            return Ok(Relation::Before);
        }
        // Two instants at one time are each before the other where no gap is asked for: the first one counts as such.
        if self.is_entailed(left_end, right_start, gap_after_left)? {
            return Ok(Relation::Before);
        }
        if self.ends_by(right_end, left_start, gap_after_right) {
            return Ok(Relation::After);
        }
        if self.is_entailed(right_end, left_start, gap_after_right)? {
            return Ok(Relation::After);
        }
        Ok(Relation::Open)
    }

    /// Which of two intervals nesting alone puts before the other.
    fn nested_relation(&self, left: LabelId, right: LabelId) -> Relation {
        let Some(structure) = &self.model.structure else { return Relation::Open };
        let arc = |label: LabelId| self.model.conditions.labels[label].arc;
        match structure.relation(arc(left), arc(right)) {
            Relation::Before if self.model.gap_after[left] == 0 => Relation::Before,
            Relation::After if self.model.gap_after[right] == 0 => Relation::After,
            _ => Relation::Open,
        }
    }

    /// Which of two intervals nesting or windows put before the other, once there are windows.
    pub(crate) fn ordered_by_windows(&self, left: LabelId, right: LabelId) -> Relation {
        let nested = self.nested_relation(left, right);
        if nested != Relation::Open {
            return nested;
        }
        let (left_start, left_end) = self.model.interval(left);
        let (right_start, right_end) = self.model.interval(right);
        if self.ends_by(left_end, right_start, self.model.gap_after[left]) {
            Relation::Before
        } else if self.ends_by(right_end, left_start, self.model.gap_after[right]) {
            Relation::After
        } else {
            Relation::Open
        }
    }

    /// Whether the times that are given leave less than the gap between two intervals.
    fn only_touch(&self, left: LabelId, right: LabelId) -> bool {
        let Some(order) = self.assumed_order(left, right) else { return false };
        let (first, then) = if order == 0 { (left, right) } else { (right, left) };
        let times = self.setup.assumed.as_ref().map_or(&[][..], |assumed| &assumed.times);
        let (end, start) = (self.model.interval(first).1, self.model.interval(then).0);
        times[start.index()] - times[end.index()] < self.model.gap
    }

    /// Which of two intervals comes first, by the times that are given: 0 for the left one.
    pub(crate) fn assumed_order(&self, left: LabelId, right: LabelId) -> Option<u32> {
        let times =
            self.setup.assumed.as_ref().map(|assumed| &assumed.times).filter(|times| !times.is_empty())?;
        let room = |first: LabelId, then: LabelId| {
            let (end, start) = (self.model.interval(first).1, self.model.interval(then).0);
            times[start.index()] - times[end.index()]
        };
        Some(u32::from(room(right, left) > room(left, right)))
    }

    /// The tag of an edge that is only asked about.
    fn next_tag(&self) -> stn::Tag {
        Origin::Level(self.levels.next_key()).tag()
    }

    pub(crate) fn find_windows(&mut self) -> Result<(), Unplannable> {
        if self.leaf.has_windows {
            return Ok(());
        }
        self.leaf.has_windows = true;
        let start = point(self.model.start);
        let Self { stn, leaf, model, .. } = self;
        leaf.num_edges = stn.num_edges();
        Ok(stn.sweep_distances(start, &model.order, &mut leaf.from_start, &mut leaf.to_start)?)
    }

    /// The present distances of all nodes from and to the start.
    pub(crate) fn windows_now(&mut self) -> Result<(Vec<i64>, Vec<i64>), Unplannable> {
        self.find_windows()?;
        let Self { stn, leaf, model, .. } = self;
        let (mut from_start, mut to_start) = (leaf.from_start.clone(), leaf.to_start.clone());
        stn.tighten_distances(leaf.num_edges, &model.order, &mut from_start, &mut to_start)?;
        Ok((from_start, to_start))
    }

    /// Whether windows alone put `end` at least `gap` before `start`.
    fn ends_by(&self, end: PointId, start: PointId, gap: i64) -> bool {
        let latest_end = self.leaf.from_start[end.index()];
        let earliest_start = self.leaf.to_start[start.index()];
        latest_end != INFINITE
            && earliest_start != INFINITE
            && latest_end.checked_add(gap).is_some_and(|time| time <= -earliest_start)
    }

    /// Whether every schedule has `start − end ≥ gap`.
    fn is_entailed(&mut self, end: PointId, start: PointId, gap: i64) -> Result<bool, Unplannable> {
        let tag = self.next_tag();
        let schedule = self.stn.schedule();
        if schedule[start.index()].checked_sub(schedule[end.index()]).ok_or(Overflow { point: start })? < gap
        {
            return Ok(false);
        }
        match self.stn.admits(end, start, gap - 1, tag) {
            Ok(()) => Ok(false),
            Err(Inconsistency::NegativeCycle) => Ok(true),
            Err(Inconsistency::Overflow(overflow)) => Err(overflow.into()),
        }
    }
}
