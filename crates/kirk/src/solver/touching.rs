//! Which conflicting intervals may touch (SPEC 5.3): those of which the selected arcs and the chosen links put one before
//! the other, before anything is ordered. All others are kept apart by the gap.
//!
//! Whether a pair may touch thus follows from alternatives and links alone, and is a literal. It is seldom needed: the
//! search first assumes that every pair it orders is kept apart, and lets that go where it proves that there is no plan
//! then. From there on a pair may touch where the literal holds, and a solution in which it holds without need teaches
//! which choices would have to be others.

use std::collections::BTreeMap;

use stn::Stn;
use tpn::{LabelId, Ordering};

use super::Solver;
use super::encode::Problem;
use super::literal::{Literal, Side};
use crate::model::UNBOUNDED_BELOW;
use crate::model::{INFINITE, Model, ModelArc, point};
use crate::trace::{Event, TreeChoice};

/// What a search assumes about pairs that touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Touching {
    /// Nothing: a gap of 0 is kept by what touches.
    Always,
    /// None does, until that is refuted.
    Unneeded,
    /// Each pair may or may not.
    Where,
}

/// What the solver knows of pairs that touch.
#[derive(Clone, Debug)]
pub(crate) struct Touches {
    pub(super) rule: Touching,
    /// That every pair is kept apart that is ordered.
    pub(super) none: Literal,
    /// By pair, the one that comes first in front: that the other comes after it, and may touch it.
    literals: BTreeMap<(LabelId, LabelId), Literal>,
}

impl Touches {
    pub(super) fn new(solver: &mut Solver, rule: Touching) -> Self {
        let none = if rule == Touching::Always { !Literal::TRUE } else { solver.boolean() };
        Self { rule, none, literals: BTreeMap::new() }
    }

    /// Returns what the literals say in a record.
    pub(super) fn names(&self) -> impl Iterator<Item = (Literal, TreeChoice)> + '_ {
        let name = |(first, then)| TreeChoice::Order(Ordering { first, then });
        let assumed = (self.rule == Touching::Unneeded).then_some((self.none, TreeChoice::Apart));
        assumed.into_iter().chain(self.literals.iter().map(move |(&pair, &touch)| (touch, name(pair))))
    }

    /// Returns whether a side says that a pair touches.
    pub(super) fn has(&self, side: Side) -> bool {
        self.literals.values().any(|touch| touch.side == side)
    }
}

impl Problem<'_> {
    /// Assumes what the rule says. At the root.
    pub(super) fn begin_touching(&mut self, solver: &mut Solver) {
        match self.touches.rule {
            Touching::Always => {}
            Touching::Unneeded => solver.assumption = Some(self.touches.none),
            Touching::Where => {
                solver.tell_structure();
                solver.assert(!self.touches.none);
            }
        }
    }

    /// The literals that one of a pair is over before the other, touching it, the left one first; none if the pair must
    /// never touch, or always may.
    pub(super) fn touch(&mut self, solver: &mut Solver, pair: (LabelId, LabelId)) -> Vec<Literal> {
        let (left, right) = pair;
        if (self.gap_between(left, right) == 0 && self.gap_between(right, left) == 0)
            || self.enclosures.never_orders(pair)
        {
            return Vec::new();
        }
        let mut literals = Vec::with_capacity(2);
        for (first, then) in [(left, right), (right, left)] {
            let touch = solver.boolean();
            solver.resize();
            let [one, other] = [first, then].map(|label| self.intervals[label]);
            solver.imply(touch, one.presence);
            solver.imply(touch, other.presence);
            solver.imply(self.touches.none, !touch);
            let gap = self.model.gap_before(then, self.gap_after(first));
            solver.difference(other.start, one.end, -gap, [touch; 2]);
            self.touches.literals.insert((first, then), touch);
            literals.push(touch);
        }
        literals
    }

    /// Returns what must not be assumed of the present solution, in which everything is decided: pairs that touch
    /// without need. `false` if there are none.
    pub(super) fn refute_touches(&self, solver: &mut Solver) -> bool {
        let touching = self.touches.literals.iter().filter(|&(_, &touch)| solver.trail.holds(touch));
        let touching: Vec<((LabelId, LabelId), Literal)> =
            touching.map(|(&pair, &touch)| (pair, touch)).collect();
        if touching.is_empty() {
            return false;
        }
        let mut unordered = self.unordered(solver);
        let mut clauses: Vec<Vec<Literal>> = Vec::new();
        for ((first, then), touch) in touching {
            if unordered.puts_before(self.model, first, then) {
                continue;
            }
            // Only with other alternatives or links they may.
            let chosen = self.chosen(solver).map(|taken| !taken);
            let links = self.carriers.iter().flat_map(|(_, options)| options.iter().map(|&(_, link)| link));
            let unused = links.filter(|&link| solver.trail.fails(link));
            clauses.push(chosen.chain(unused).chain([!touch]).collect());
        }
        if clauses.is_empty() {
            return false;
        }
        solver.stats.conflicts += 1;
        solver.tell(|| Event::NoRoomForGap);
        solver.retract(0);
        // That nothing makes a pair touch rests on the whole mission, and on no part of it.
        solver.tell_structure();
        for clause in clauses {
            solver.at_least_one(clause);
        }
        true
    }

    /// The selected arcs and chosen links of the present solution.
    pub(super) fn unordered(&self, solver: &Solver) -> Unordered {
        let model = self.model;
        let mut stn = Stn::new(model.num_nodes);
        stn.set_origin(point(model.start));
        stn.propose(self.times.iter().map(|&time| solver.trail.least(time)));
        for arc in &self.enclosures.mission().arcs {
            if self.is_present(solver, arc) {
                push(&mut stn, arc);
            }
        }
        for (ask, options) in &self.carriers {
            if !solver.trail.holds(self.intervals[*ask].presence) {
                continue;
            }
            for &(tell, link) in options {
                if solver.trail.holds(link) {
                    push_link(model, &mut stn, *ask, tell);
                }
            }
        }
        let is_consistent = stn.settle(&model.order).is_ok();
        Unordered { stn, is_consistent }
    }
}

/// Arcs and links without any order.
#[derive(Clone, Debug)]
pub(crate) struct Unordered {
    stn: Stn,
    is_consistent: bool,
}

impl Unordered {
    /// Returns whether one of two intervals is over before the other begins. What contradicts itself, as the whole
    /// mission may where a part of it is looked at, puts nothing before anything.
    pub(super) fn relates(&mut self, model: &Model, (left, right): (LabelId, LabelId)) -> bool {
        self.puts_before(model, left, right) || self.puts_before(model, right, left)
    }

    /// Returns whether an interval is over before another begins, in every schedule.
    pub(super) fn puts_before(&mut self, model: &Model, first: LabelId, then: LabelId) -> bool {
        self.is_consistent && self.is_before(model, first, then)
    }

    fn is_before(&mut self, model: &Model, first: LabelId, then: LabelId) -> bool {
        let (end, start) = (model.interval(first).1, model.interval(then).0);
        let gap = model.gap_before(then, model.gap_after[first]);
        let times = self.stn.schedule();
        if times[start.index()] - times[end.index()] < gap {
            return false;
        }
        // Times are small enough here for every sum to fit.
        self.stn.admits(end, start, gap - 1, 0).is_err()
    }
}

fn push(stn: &mut Stn, arc: &ModelArc) {
    let (from, to, lower, upper) = (point(arc.from), point(arc.to), arc.lower, arc.upper);
    if upper != INFINITE {
        stn.push(from, to, upper, 0);
    }
    if lower != UNBOUNDED_BELOW {
        stn.push(to, from, -lower, 0);
    }
}

fn push_link(model: &Model, stn: &mut Stn, ask: LabelId, tell: LabelId) {
    let ((ask_start, ask_end), (tell_start, tell_end)) = (model.interval(ask), model.interval(tell));
    stn.push(ask_start, tell_start, 0, 0);
    stn.push(tell_end, ask_end, 0, 0);
}
