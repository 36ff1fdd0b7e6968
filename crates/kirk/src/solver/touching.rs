//! Which conflicting intervals may touch (SPEC 5.3): those of which the selected arcs and the chosen links put one before
//! the other, before anything is ordered. All others are kept apart by the gap.
//!
//! Whether a pair may touch thus follows from alternatives and links alone, and is a literal. It is seldom needed: the
//! search first assumes that every pair it orders is kept apart, and lets that go where it proves that there is no plan
//! then. From there on a pair may touch where the literal holds, and a solution in which it holds without need teaches
//! which choices would have to be others.

use std::collections::BTreeMap;

use stn::{PointId, Stn};
use tpn::{LabelId, Ordering};

use super::Solver;
use super::encode::Problem;
use super::literal::{Literal, Side};
use crate::model::UNBOUNDED_BELOW;
use crate::model::{Context, INFINITE, Model, ModelArc, point};
use crate::trace::{Event, TreeChoice};

/// Decisions with more different durations together are not looked into.
const MAX_NETWORKS: usize = 64;

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

    /// What the literals say in a record.
    pub(super) fn names(&self) -> impl Iterator<Item = (Literal, TreeChoice)> + '_ {
        let name = |(first, then)| TreeChoice::Order(Ordering { first, then });
        let assumed = (self.rule == Touching::Unneeded).then_some((self.none, TreeChoice::Apart));
        assumed.into_iter().chain(self.literals.iter().map(move |(&pair, &touch)| (touch, name(pair))))
    }

    /// Whether a side says that a pair touches.
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
            || self.never_touches(pair)
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

    /// What must not be assumed of the present solution, in which everything is decided: pairs that touch without need.
    /// `false` if there are none.
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
        !loosest.is_empty() && !loosest.iter_mut().any(|unordered| unordered.relates(model, pair))
    }
}

/// Arcs and links without any order.
#[derive(Clone, Debug)]
pub(crate) struct Unordered {
    stn: Stn,
    is_consistent: bool,
}

impl Unordered {
    /// What holds of everything outside of alternatives, for all durations that its decisions may have. Empty where that is
    /// too much, or where something reaches into an alternative.
    pub(crate) fn loosest(model: &Model) -> Vec<Self> {
        Self::loosest_networks(model).unwrap_or_default()
    }

    fn loosest_networks(model: &Model) -> Option<Vec<Self>> {
        let mut stn = Stn::new(model.num_nodes);
        stn.set_origin(point(model.start));
        for (arc, &(lower, upper)) in model.arcs.iter().zip(&model.given_bounds) {
            match (arc.context, arc.other_context) {
                (None, None) => push(&mut stn, arc, (lower, upper)),
                (_, Some(_)) => return None,
                (Some(_), None) => {}
            }
        }
        let mut networks = vec![stn];
        for (decision, described) in model.decisions.iter_enumerated() {
            if described.context.is_some() {
                continue;
            }
            let structure = model.structure.as_ref()?;
            let (from, to, ..) = structure.initial_bounds(decision);
            let durations = structure.durations(decision)?;
            let mut longer = Vec::with_capacity(networks.len() * durations.len());
            for stn in &networks {
                for &(lower, upper) in &durations {
                    let mut stn = stn.clone();
                    if upper != INFINITE {
                        stn.push(point(from), point(to), upper, 0);
                    }
                    stn.push(point(to), point(from), -lower, 0);
                    longer.push(stn);
                }
            }
            networks = longer;
            if networks.len() > MAX_NETWORKS {
                return None;
            }
        }
        // What contradicts itself is no plan.
        networks.retain_mut(|stn| stn.settle(&model.order).is_ok());
        for (ask_start, ask_end, tell) in possible_links(model)? {
            let (tell_start, tell_end) = model.interval(tell);
            for stn in &mut networks {
                stn.insert(ask_start, tell_start, 0, 0).ok()?;
                stn.insert(tell_end, ask_end, 0, 0).ok()?;
            }
        }
        Some(networks.into_iter().map(|stn| Self { stn, is_consistent: true }).collect())
    }

    /// Whether one of two intervals is over before the other begins. What contradicts itself, as the whole mission may where a
    /// part of it is looked at, puts nothing before anything.
    pub(super) fn relates(&mut self, model: &Model, (left, right): (LabelId, LabelId)) -> bool {
        self.puts_before(model, left, right) || self.puts_before(model, right, left)
    }

    /// Whether an interval is over before another begins, in every schedule.
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

/// What each assertion would contain if it carried all that it may carry: what is required inside a decision counts as all of
/// it, which is more. `None` where an assertion is inside a decision itself.
fn possible_links(model: &Model) -> Option<Vec<(PointId, PointId, LabelId)>> {
    let labels = &model.conditions.labels;
    let context = |label: LabelId| -> Context { model.arcs[labels[label].arc].context };
    let mut links = Vec::new();
    for ask in labels.keys().filter(|&ask| labels[ask].is_ask && !labels[ask].is_lasting) {
        let mut outermost = context(ask);
        while let Some(choice) = outermost
            && let Some(outer) = model.decisions[choice.decision].context
        {
            outermost = Some(outer);
        }
        let (start, end) = match outermost {
            None => model.interval(ask),
            Some(choice) => {
                let (from, to, ..) = model.structure.as_ref()?.initial_bounds(choice.decision);
                (point(from), point(to))
            }
        };
        for tell in model.conditions.supporters(ask).filter(|&tell| labels[tell].arc != labels[ask].arc) {
            if context(tell).is_some() {
                return None;
            }
            links.push((start, end, tell));
        }
    }
    Some(links)
}
