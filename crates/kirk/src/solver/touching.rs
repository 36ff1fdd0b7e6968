//! Which conflicting intervals may touch (SPEC 5.3): those of which the selected arcs and the chosen links put one before
//! the other, before anything is ordered. All others are kept apart by the gap.
//!
//! Whether a pair may touch thus follows from alternatives and links alone, and is a literal. It is seldom needed: the
//! search first assumes that every pair it orders is kept apart, and lets that go where it proves that there is no plan
//! then. From there on a pair may touch where the literal holds, and a solution in which it holds without need teaches
//! which choices would have to be others.

use std::collections::BTreeMap;

use stn::Stn;
use tpn::LabelId;

use super::Solver;
use super::encode::Problem;
use super::literal::Literal;
use super::refutation::Premise;
use crate::model::UNBOUNDED_BELOW;
use crate::model::{Context, INFINITE, Model, ModelArc, point};
use crate::trace::Event;

/// What a search assumes about pairs that touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Touching {
    /// Nothing: a gap of 0 is kept by what touches.
    Always,
    /// None does, until that is refuted.
    Unneeded,
    /// Each pair may or may not.
    Where,
    /// Each pair may, whatever is chosen: the loosest reading, for parts of a mission, in which less follows.
    Loosely,
}

/// What the solver knows of pairs that touch.
#[derive(Clone, Debug)]
pub(crate) struct Touches {
    pub(super) rule: Touching,
    /// That every pair is kept apart that is ordered.
    pub(super) none: Literal,
    /// By pair: that it may touch.
    literals: BTreeMap<(LabelId, LabelId), Literal>,
}

impl Touches {
    pub(super) fn new(solver: &mut Solver, rule: Touching) -> Self {
        let none = if rule == Touching::Always { !Literal::TRUE } else { solver.boolean() };
        Self { rule, none, literals: BTreeMap::new() }
    }
}

impl Problem<'_> {
    /// Assumes what the rule says. At the root.
    pub(super) fn begin_touching(&mut self, solver: &mut Solver) {
        match self.touches.rule {
            Touching::Always => {}
            Touching::Unneeded => solver.assumption = Some(self.touches.none),
            Touching::Where | Touching::Loosely => {
                solver.tell_structure();
                solver.assert(!self.touches.none);
            }
        }
    }

    /// The literal that a pair may touch; `None` if it never may, or always does as it is.
    pub(super) fn touch(&mut self, solver: &mut Solver, pair: (LabelId, LabelId)) -> Option<Literal> {
        if self.gap_between(pair.0, pair.1) == 0 && self.gap_between(pair.1, pair.0) == 0 {
            return None;
        }
        if self.touches.rule != Touching::Always && self.never_touches(pair) {
            return None;
        }
        if let Some(&known) = self.touches.literals.get(&pair) {
            return Some(known);
        }
        let touch = solver.boolean();
        solver.resize();
        solver.tell_structure();
        solver.imply(self.touches.none, !touch);
        self.touches.literals.insert(pair, touch);
        Some(touch)
    }

    /// What must not be assumed of the present solution, in which everything is decided: pairs that touch without need.
    /// `false` if there are none.
    pub(super) fn refute_touches(&self, solver: &mut Solver) -> bool {
        if self.touches.rule == Touching::Loosely {
            return false;
        }
        let touching = self.touches.literals.iter().filter(|&(_, &touch)| solver.trail.holds(touch));
        let touching: Vec<((LabelId, LabelId), Literal)> =
            touching.map(|(&pair, &touch)| (pair, touch)).collect();
        if touching.is_empty() {
            return false;
        }
        let mut unordered = self.unordered(solver);
        let mut clauses: Vec<Vec<Literal>> = Vec::new();
        for (pair, touch) in touching {
            if unordered.relates(self.model, pair) {
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
        solver.tell(|| Event::NoRoomForGap);
        solver.retract(0);
        solver.tell_from_premises([Premise::Unknown]);
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
        for (arc, &(lower, upper)) in model.arcs.iter().zip(&model.given_bounds) {
            if self.is_present(solver, arc) {
                push(&mut stn, arc, (lower, upper));
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

    /// Whether no choice of alternatives and links can make a pair touch: the loosest network of all that is not inside an
    /// alternative leaves room between them. `false` if that is not known.
    pub(super) fn never_touches(&mut self, pair: (LabelId, LabelId)) -> bool {
        let context = |label: LabelId| self.model.arcs[self.model.conditions.labels[label].arc].context;
        if context(pair.0).is_some() || context(pair.1).is_some() {
            return false;
        }
        let model = self.model;
        let loosest = self.loosest.get_or_insert_with(|| Unordered::loosest(model));
        loosest.as_mut().is_some_and(|loosest| !loosest.relates(model, pair))
    }
}

/// Arcs and links without any order.
#[derive(Clone, Debug)]
pub(crate) struct Unordered {
    stn: Stn,
    is_consistent: bool,
}

impl Unordered {
    /// What holds of everything outside of alternatives, whatever is chosen: each decision takes what all its alternatives
    /// can take. `None` where they have nothing in common, or where something reaches into an alternative.
    pub(crate) fn loosest(model: &Model) -> Option<Self> {
        let structure = model.structure.as_ref().filter(|_| !model.decisions.is_empty());
        if structure.is_none() && !model.decisions.is_empty() {
            return None;
        }
        let mut stn = Stn::new(model.num_nodes);
        stn.set_origin(point(model.start));
        for (arc, &(lower, upper)) in model.arcs.iter().zip(&model.given_bounds) {
            match (arc.context, arc.other_context) {
                (None, None) => push(&mut stn, arc, (lower, upper)),
                (_, Some(_)) => return None,
                (Some(_), None) => {}
            }
        }
        if let Some(structure) = structure {
            for (decision, described) in model.decisions.iter_enumerated() {
                if described.context.is_none() {
                    let (lower, upper) = structure.common_bounds(decision)?;
                    let (from, to, ..) = structure.initial_bounds(decision);
                    if upper != INFINITE {
                        stn.push(point(from), point(to), upper, 0);
                    }
                    stn.push(point(to), point(from), -lower, 0);
                }
            }
        }
        let labels = &model.conditions.labels;
        let context = |label: LabelId| -> Context { model.arcs[labels[label].arc].context };
        for ask in labels.keys().filter(|&ask| labels[ask].is_ask && !labels[ask].is_lasting) {
            for tell in model.conditions.supporters(ask) {
                if labels[ask].arc == labels[tell].arc {
                    continue;
                }
                match (context(ask), context(tell)) {
                    (None, None) => push_link(model, &mut stn, ask, tell),
                    (Some(_), _) | (_, Some(_)) => return None,
                }
            }
        }
        // What contradicts itself tells nothing.
        stn.settle(&model.order).is_ok().then_some(Self { stn, is_consistent: true })
    }

    /// Whether one of two intervals is over before the other begins, in every schedule. Of what contradicts itself
    /// everything follows.
    pub(super) fn relates(&mut self, model: &Model, (left, right): (LabelId, LabelId)) -> bool {
        !self.is_consistent || self.is_before(model, left, right) || self.is_before(model, right, left)
    }

    fn is_before(&mut self, model: &Model, first: LabelId, then: LabelId) -> bool {
        let (end, start) = (model.interval(first).1, model.interval(then).0);
        let gap = model.gap_before(then, model.gap_after[first]);
        let times = self.stn.schedule();
        if times[start.index()] - times[end.index()] < gap {
            return false;
        }
        // What does not fit any more is no longer entailed either.
        !matches!(self.stn.admits(end, start, gap - 1, 0), Ok(()))
    }
}

fn push(stn: &mut Stn, arc: &ModelArc, (lower, upper): (i64, i64)) {
    let (from, to) = (point(arc.from), point(arc.to));
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
