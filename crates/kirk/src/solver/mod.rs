//! A conflict-driven solver for choices, causal links and orderings over difference constraints (SPEC 5.6): lazy clause
//! generation (Ohrimenko, Stuckey and Codish 2009) over the bounds of times.
//!
//! Choice points are alternatives of decisions, carriers of requirements, and orders of conflicting pairs; each
//! alternative of one is a literal, and so is every bound of a time. Theories make bounds follow from bounds and say why
//! when they are asked: differences, open choices, intervals that exclude each other. A conflict is traced back to
//! the one literal of its level that all of it went through, becomes a clause, and is undone as far as the clause still
//! tells something. What has to do with conflicts is decided first, as it was decided last; at times the search starts
//! over with all it has learned. Pairs of conflicting intervals become choice points once a solution puts them
//! in each other's way.
//!
//! A further theory has three duties: to propagate what the trail's new events mean to it, through [`Trail::set`]; to
//! give the reason of what it has set, from literals that held before (at once with [`Trail::note`], or later by a
//! [`Cause`] of its own); and to forget what it has waiting when events are taken back. It keeps no other state that
//! depends on the trail.
//!
//! The same problem is always solved in the same steps.

mod activity;
mod alternatives;
mod analysis;
mod best_first;
mod clauses;
mod control;
mod cumulative;
mod difference;
mod disjunctive;
mod dispatch;
mod enclosure;
mod encode;
mod goals;
mod growth;
mod instants;
mod interchangeable;
mod interval;
mod lasting;
mod leaf;
mod linear;
mod lists;
mod literal;
mod neighborhood;
mod premise;
mod queue;
mod record;
mod refutation;
mod relaxation;
mod resources;
mod simplex;
mod solution;
mod spread;
mod sweeps;
mod touching;
mod tours;
mod trail;
mod work;

use tpn::LabelId;
use typed_index_collections::TiVec;

use crate::ids::{ChoicePointId, EventId};
use crate::options::Stats;
use crate::trace::Event;
use activity::Activity;
use alternatives::Alternatives;
use analysis::Analysis;
use clauses::Clauses;
use cumulative::Cumulatives;
use difference::{Difference, Differences};
use disjunctive::Disjunctives;
use linear::{LinearKind, Linears};
use lists::Lists;
use literal::{Literal, Side, Variable};
use neighborhood::Neighborhood;
use premise::Premise;
use record::Origin;
use refutation::Derivations;
use resources::Sharing;
use sweeps::Sweeps;
use tours::Tours;
use trail::{Conflict, Trail};

pub(crate) use best_first::{Frontier, MinSums, Visit};
pub(crate) use encode::{Part, Problem};
pub(crate) use goals::GoalSums;
pub(crate) use growth::{Growth, Unencoded};
pub(crate) use instants::turns;
pub(crate) use record::Record;
pub(crate) use solution::Solution;
pub(crate) use touching::Touching;

/// How a search came to an end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    /// Everything is decided, and the least values of all times fit.
    Solved,
    /// There is no solution.
    Unsolvable,
    Stopped,
}

/// A choice point.
#[derive(Clone, Debug)]
struct ChoicePoint {
    /// It counts where these hold.
    when: Vec<Literal>,
    kind: ChoicePointKind,
    /// One of these must hold; the one taken last is tried first again.
    options: Vec<Literal>,
    last: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ChoicePointKind {
    /// Alternatives, in textual order.
    Alternatives,
    /// Assertions that may carry a requirement.
    Carriers { ask: LabelId },
    /// Two orders of a conflicting pair.
    Orders { left: LabelId, right: LabelId },
    /// Two orders of changes that exclude each other.
    Sides,
    /// Orders of uses, one of which fixes what takes too much of a resource.
    Resolvers,
}

#[derive(Clone, Debug)]
pub(crate) struct Solver {
    trail: Trail,
    clauses: Clauses,
    differences: Differences,
    alternatives: Alternatives,
    disjunctives: Disjunctives,
    cumulatives: Cumulatives,
    linears: Linears,
    tours: Tours,
    /// By side of a Boolean: sides that follow.
    implied: Lists<Side, Side>,
    /// The choice point whose options exclude each other, of variables that have one.
    exclusive: TiVec<Variable, Option<ChoicePointId>>,
    /// Further sets of Booleans of which at most one holds, and those that a variable is in.
    at_most_one: Vec<Vec<Literal>>,
    at_most_one_of: Lists<Variable, u32>,
    choice_points: TiVec<ChoicePointId, ChoicePoint>,
    /// The choice points that a variable belongs to.
    choice_points_of: Lists<Variable, ChoicePointId>,
    /// By side of a Boolean: choice points that begin to count.
    reached: Lists<Side, ChoicePointId>,
    activity: Activity,
    /// Whether it has not searched yet.
    is_new: bool,
    /// How many events have been propagated along clauses and choice points.
    head: usize,
    /// How many have been propagated to the theories.
    theory_head: usize,
    /// The same when the decision of each level was made: of several decisions at once, all events are propagated in the last
    /// one's level, and again when that is left.
    theory_heads: Vec<usize>,
    sweeps: Sweeps,
    /// So many decisions are made before what they mean for times is looked at: all of them, until that fails.
    burst: usize,
    /// How many decisions were made one by one since many at once failed.
    single_decisions: u32,
    /// What propagation has done since it last looked whether to stop.
    steps: u32,
    /// Whether a propagation was stopped before its end.
    is_interrupted: bool,
    analysis: Analysis,
    is_contradictory: bool,
    /// What is decided first, until it is refuted.
    assumption: Option<Literal>,
    /// What is decided next, as in an earlier solution.
    neighborhood: Neighborhood,
    /// The decisions that led to the last solution that broke something, and how many of them the search may still make
    /// again on its way to where it leaves them.
    left: Vec<Literal>,
    num_left: usize,
    /// Whether it is not known yet where that is.
    is_returning: bool,
    /// Whether what the solution broke has been counted as a failure already.
    is_failure_counted: bool,
    conflicts_until_restart: u64,
    restarts: u64,
    max_learned: usize,
    /// Whether choice points are decided in the order in which they were added, each with its first option that is left:
    /// then the first solution is the first one in that order.
    pub(crate) is_in_textual_order: bool,
    pub(crate) stats: Stats,
    /// What is told of the search, if anybody wants to know.
    pub(crate) record: Option<Box<Record>>,
    /// What was derived from what, if anybody wants to know.
    derivations: Option<Box<Derivations>>,
    /// What the last conflict came from.
    origin: Origin,
}

/// Whether what a decision means is looked at before the next one is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Deciding {
    OneByOne,
    AtOnce,
}

/// Whether propagation came to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Propagated {
    Wholly,
    /// It was stopped; what it leaves out is looked at next time.
    InPart,
}

/// Steps of propagation between two looks at whether to stop.
const STEPS_BETWEEN_LOOKS: u32 = 1 << 13;
/// What a look at a set of tasks counts as.
const STEPS_OF_SETS: u32 = 1 << 6;

/// After many decisions at once have failed, so many are made one by one.
const SINGLE_DECISIONS: u32 = 16;

/// Conflicts in the unit of the restart sequence.
const RESTART_UNIT: u64 = 64;

impl Solver {
    fn new() -> Self {
        let mut solver = Self {
            trail: Trail::new(),
            clauses: Clauses::new(),
            differences: Differences::default(),
            alternatives: Alternatives::default(),
            disjunctives: Disjunctives::default(),
            cumulatives: Cumulatives::default(),
            linears: Linears::default(),
            tours: Tours::default(),
            implied: Lists::default(),
            exclusive: TiVec::new(),
            at_most_one: Vec::new(),
            at_most_one_of: Lists::default(),
            choice_points: TiVec::new(),
            choice_points_of: Lists::default(),
            reached: Lists::default(),
            activity: Activity::new(),
            is_new: true,
            head: 0,
            theory_head: 0,
            theory_heads: Vec::new(),
            sweeps: Sweeps::default(),
            burst: usize::MAX,
            single_decisions: 0,
            steps: 0,
            is_interrupted: false,
            analysis: Analysis::default(),
            is_contradictory: false,
            assumption: None,
            neighborhood: Neighborhood::default(),
            left: Vec::new(),
            num_left: 0,
            is_returning: false,
            is_failure_counted: false,
            conflicts_until_restart: RESTART_UNIT,
            restarts: 0,
            max_learned: 4_000,
            is_in_textual_order: false,
            stats: Stats::default(),
            record: None,
            derivations: None,
            origin: Origin::Other,
        };
        solver.resize();
        solver
    }

    /// Adds a variable; [`Solver::resize`] must follow before it is used.
    fn variable(&mut self, least: i64, most: i64, presence: Literal) -> Variable {
        self.trail.add(least, most, presence)
    }

    fn boolean(&mut self) -> Literal {
        self.variable(0, 1, Literal::TRUE).holds()
    }

    fn resize(&mut self) {
        let count = self.trail.num_variables();
        self.clauses.resize(count);
        self.differences.resize(count);
        self.alternatives.queue.resize(count);
        self.disjunctives.queue.resize(count);
        self.cumulatives.queue.resize(count);
        self.implied.resize(count * 2);
        self.reached.resize(count * 2);
        self.exclusive.resize(count, None);
        self.at_most_one_of.resize(count);
        self.choice_points_of.resize(count);
        self.linears.queue.resize(count);
        self.tours.queue.resize(count);
    }

    /// `left` implies `right`, both Booleans. At the root.
    fn imply(&mut self, left: Literal, right: Literal) {
        if right == Literal::TRUE || left == right {
            return;
        }
        self.implied.push(left.side, right.side);
        self.implied.push((!right).side, (!left).side);
        if self.trail.holds(left) {
            self.assert_since(right, &[left]);
        } else if self.trail.fails(right) {
            self.assert_since(!left, &[!right]);
        }
    }

    /// Makes a literal hold whatever is decided. At the root.
    fn assert(&mut self, literal: Literal) {
        self.assert_since(literal, &[]);
    }

    /// The same where that follows from others.
    fn assert_since(&mut self, literal: Literal, others: &[Literal]) {
        let event = self.trail.events.next_key();
        let set = self.trail.set(literal, trail::Cause::Decision);
        self.told_unit(event, others);
        if let Err(conflict) = set {
            self.refute(&conflict);
        }
    }

    /// There is no solution, for these literals hold and cannot, by what is being told. At the root.
    fn refute(&mut self, conflict: &[Literal]) {
        self.is_contradictory = true;
        self.told_refutation(conflict);
    }

    /// At least one literal holds. At the root.
    fn at_least_one(&mut self, literals: impl IntoIterator<Item = Literal>) {
        let (mut open, mut held): (Vec<Literal>, Vec<Literal>) = (Vec::new(), Vec::new());
        for literal in literals {
            if self.trail.holds(literal) {
                return;
            }
            if self.trail.fails(literal) {
                held.push(!literal);
            } else if !open.contains(&literal) {
                open.push(literal);
            }
        }
        match open.as_slice() {
            [] => self.refute(&held),
            &[only] => self.assert_since(only, &held),
            _ => {
                if self.takes_nothing_for_granted() {
                    open.extend(held.into_iter().map(|literal| !literal));
                }
                let clause = self.clauses.add(open, None);
                self.told_clause(clause);
            }
        }
    }

    fn add_choice_point(&mut self, choice_point: ChoicePoint, initial_activity: f64) {
        let id = self.choice_points.next_key();
        for option in &choice_point.options {
            let variable = option.side.variable();
            if self.choice_points_of.last(variable) != Some(id) {
                self.choice_points_of.push(variable, id);
            }
        }
        for when in &choice_point.when {
            self.reached.push(when.side, id);
        }
        let counts = choice_point.when.iter().all(|&when| self.trail.holds(when));
        self.choice_points.push(choice_point);
        self.activity.add(initial_activity);
        if counts {
            self.activity.insert(id);
        }
    }

    /// Adds a choice point of which at most one option holds.
    fn add_exclusive_choice_point(&mut self, choice_point: ChoicePoint) {
        let id = self.choice_points.next_key();
        for option in &choice_point.options {
            self.exclusive[option.side.variable()] = Some(id);
        }
        self.add_choice_point(choice_point, 0.0);
    }

    /// Adds `to − from ≤ weight`: a step and its mirror, each with the literal under which it carries. At the root.
    fn difference(&mut self, from: Variable, to: Variable, weight: i64, when: [Literal; 2]) {
        let [forward, backward] = when;
        self.differences.add(Difference { from: from.upper(), to: to.upper(), weight, when: forward });
        self.differences.add(Difference { from: to.lower(), to: from.lower(), weight, when: backward });
        self.told_difference();
    }

    /// Carries on the present bounds along what has been added since `first`. At the root.
    fn check_differences(&mut self, first: usize) {
        for id in self.differences.since(first) {
            if let Err(conflict) = self.differences.check(&mut self.trail, id) {
                self.refute(&conflict);
                return;
            }
        }
    }

    /// Searches until everything is decided. `stop` is asked once per decision and conflict.
    pub(crate) fn solve(
        &mut self,
        problem: &mut Problem<'_>,
        stop: &mut dyn FnMut(&Stats) -> bool,
    ) -> Answer {
        if std::mem::take(&mut self.is_new) && self.is_contradictory {
            self.stats.conflicts += 1;
            self.record_contradiction(problem);
        }
        loop {
            if self.is_contradictory {
                self.record_implied();
                self.end_return();
                self.record_exhausted();
                return Answer::Unsolvable;
            }
            if stop(&self.stats) {
                self.retract(0);
                return Answer::Stopped;
            }
            let propagated = self.propagate(stop);
            if propagated == Ok(Propagated::InPart) {
                self.retract(0);
                return Answer::Stopped;
            }
            if let Err(conflict) = propagated {
                self.record_implied();
                self.end_return();
                self.record_failure(problem, &conflict);
                self.stats.conflicts += 1;
                self.conflicts_until_restart = self.conflicts_until_restart.saturating_sub(1);
                if !self.learn(&conflict) {
                    self.is_contradictory = true;
                }
            } else {
                self.record_implied();
                if self.conflicts_until_restart == 0 {
                    self.restart();
                    self.record_restart(problem);
                }
                self.decide_many(stop);
                if self.is_interrupted {
                    self.retract(0);
                    return Answer::Stopped;
                }
                if problem.dispatch(self) || self.decide(Deciding::OneByOne) {
                    self.single_decisions += 1;
                    if self.burst == 0 && self.single_decisions >= SINGLE_DECISIONS {
                        (self.burst, self.single_decisions) = (1, 0);
                    }
                } else {
                    self.stats.leaves += 1;
                    self.end_return();
                    let left = self.trail.decisions();
                    self.record_leaf();
                    let conflicts = self.stats.conflicts;
                    let is_broken = self.is_broken(problem);
                    let sharing = if is_broken { Sharing::Restarted } else { problem.share(self) };
                    if sharing == Sharing::Restarted {
                        self.leave(left, conflicts);
                        self.record_return(problem);
                    } else if sharing == Sharing::Fits {
                        debug_assert!(self.is_solution(problem), "the least times fit");
                        let stats = self.stats;
                        match problem.withstand(self, &mut || stop(&stats)) {
                            Some(false) => return Answer::Solved,
                            Some(true) => {
                                self.leave(left, conflicts);
                                self.record_return(problem);
                            }
                            None => {
                                self.retract(0);
                                return Answer::Stopped;
                            }
                        }
                    }
                }
            }
        }
    }

    /// Adds what the present solution breaks, in which everything is decided. `false` if it breaks nothing.
    fn is_broken(&mut self, problem: &mut Problem<'_>) -> bool {
        self.add_pairs(problem) || problem.refute_touches(self) || problem.break_circles(self)
    }

    /// Propagates what follows without decisions, unless that is known already to fail.
    fn propagate_at_root(&mut self, stop: &mut dyn FnMut() -> bool) -> Result<(), Unencoded> {
        if self.is_contradictory {
            return Ok(());
        }
        match self.propagate(&mut |_| stop()) {
            Ok(Propagated::Wholly) => {}
            Ok(Propagated::InPart) => return Err(Unencoded::Stopped),
            Err(conflict) => self.is_contradictory = !self.learn(&conflict),
        }
        Ok(())
    }

    /// Returns whether propagation alone shows that there is no solution; `None` if it was stopped before. What it
    /// finds stays.
    pub(crate) fn is_refuted_at_root(&mut self, stop: &mut dyn FnMut() -> bool) -> Option<bool> {
        self.propagate_at_root(stop).ok()?;
        Some(self.is_contradictory)
    }

    /// Returns whether to stop, by a look at that from time to time; so many steps were made since the last one.
    fn is_stopped_after(&mut self, steps: u32, stop: &mut dyn FnMut(&Stats) -> bool) -> bool {
        self.steps += steps;
        if self.steps < STEPS_BETWEEN_LOOKS {
            return false;
        }
        self.steps = 0;
        self.is_interrupted = stop(&self.stats);
        self.is_interrupted
    }

    fn propagate(&mut self, stop: &mut dyn FnMut(&Stats) -> bool) -> Result<Propagated, Conflict> {
        if std::mem::take(&mut self.is_interrupted) {
            (self.head, self.theory_head) = (0, 0);
            self.alternatives.queue.push_all();
            self.disjunctives.queue.push_all();
            self.cumulatives.queue.push_all();
            self.linears.queue.push_all();
            self.tours.queue.push_all();
        }
        self.differences.begin();
        self.alternatives.begin();
        self.origin = Origin::Other;
        loop {
            self.trail.premise = Premise::Structure;
            self.propagate_choices()?;
            while self.theory_head < self.trail.events.len() {
                let event = EventId::from(self.theory_head);
                self.theory_head += 1;
                if self.is_stopped_after(1, stop) {
                    return Ok(Propagated::InPart);
                }
                let side = self.trail.events[event].side;
                if !self.sweeps.is_settled(usize::from(event)) {
                    self.differences.moved(&mut self.trail, event)?;
                }
                self.alternatives.queue.moved(side);
                self.disjunctives.queue.moved(side);
                self.cumulatives.queue.moved(side);
                self.linears.queue.moved(side);
                self.tours.queue.moved(side);
            }
            if self.head < self.trail.events.len() {
                continue;
            }
            if self.differences.propagate(&mut self.trail)? {
                continue;
            }
            self.alternatives.propagate(&mut self.trail)?;
            if self.head < self.trail.events.len() {
                continue;
            }
            if let Err((kind, conflict)) = self.linears.propagate(&mut self.trail) {
                if kind == LinearKind::Goal {
                    self.origin = Origin::Goal;
                }
                return Err(conflict);
            }
            if self.head < self.trail.events.len() {
                continue;
            }
            let has_looked = self.disjunctives.propagate(&mut self.trail)?
                || self.cumulatives.propagate(&mut self.trail)?
                || self.tours.propagate(&mut self.trail)?;
            if !has_looked {
                return Ok(Propagated::Wholly);
            }
            if self.is_stopped_after(STEPS_OF_SETS, stop) {
                return Ok(Propagated::InPart);
            }
        }
    }

    /// Propagates what new events mean to clauses and choice points.
    fn propagate_choices(&mut self) -> Result<(), Conflict> {
        while self.head < self.trail.events.len() {
            let event = EventId::from(self.head);
            self.head += 1;
            let side = self.trail.events[event].side;
            self.clauses.propagate(&mut self.trail, event)?;
            for implied in self.implied.iter(side) {
                self.trail.set(implied.decided(), trail::Cause::Implied(side))?;
            }
            self.exclude_others(side)?;
            for choice_point in self.reached.iter(side) {
                self.activity.insert(choice_point);
            }
        }
        Ok(())
    }

    /// Makes decisions one after the other before anything is looked at but clauses and choice points: where times leave
    /// room, their bounds move once for many decisions. If that ends in a failure, everything is taken back.
    fn decide_many(&mut self, stop: &mut dyn FnMut(&Stats) -> bool) {
        if !self.is_in_textual_order || self.burst == 0 || self.record.is_some() {
            return;
        }
        let level = self.trail.level();
        let before = BeforeBurst {
            expanded: self.stats.expanded,
            backtracks: self.stats.backtracks,
            conflicts: self.stats.conflicts,
            num_left: self.num_left,
            is_returning: self.is_returning,
        };
        for _ in 0..self.burst {
            if !self.decide(Deciding::AtOnce) {
                break;
            }
            if self.propagate_choices().is_err() {
                return self.give_up_burst(level, &before);
            }
        }
        self.trail.premise = Premise::Structure;
        let swept = self.sweeps.sweep_new(&self.differences, &mut self.trail, self.theory_head);
        match swept.and_then(|()| self.propagate(stop)) {
            Ok(_) => self.burst = self.burst.saturating_mul(2),
            Err(_) => self.give_up_burst(level, &before),
        }
    }

    fn give_up_burst(&mut self, level: u32, before: &BeforeBurst) {
        self.stats.expanded = before.expanded;
        self.stats.backtracks = before.backtracks;
        self.stats.conflicts = before.conflicts;
        (self.num_left, self.is_returning) = (before.num_left, before.is_returning);
        self.retract(level);
        // The next few decisions are made one by one.
        self.burst = 0;
    }

    /// At most one of these Booleans holds. At the root.
    fn add_at_most_one(&mut self, literals: Vec<Literal>) {
        let id = self.at_most_one.len() as u32;
        for literal in &literals {
            self.at_most_one_of.push(literal.side.variable(), id);
        }
        self.at_most_one.push(literals);
    }

    /// Of alternatives at most one is taken.
    fn exclude_others(&mut self, side: Side) -> Result<(), Conflict> {
        if side != side.variable().lower() {
            return Ok(());
        }
        for id in self.at_most_one_of.iter(side.variable()) {
            for &other in &self.at_most_one[id as usize] {
                if other.side != side {
                    self.trail.set(!other, trail::Cause::Implied(side))?;
                }
            }
        }
        let Some(choice_point) = self.exclusive[side.variable()] else { return Ok(()) };
        for &other in &self.choice_points[choice_point].options {
            if other.side != side {
                self.trail.set(!other, trail::Cause::Implied(side))?;
            }
        }
        Ok(())
    }

    /// Learns from a conflict and goes back. `false` if there is no solution.
    fn learn(&mut self, conflict: &[Literal]) -> bool {
        self.begin_derivation(conflict);
        let conflict = &self.before_crossing(conflict);
        self.conclude_from(conflict);
        let highest = conflict.iter().map(|&literal| self.level_of(literal)).max().unwrap_or(0);
        if highest < self.trail.level() {
            self.retract(highest);
        }
        self.num_left = 0;
        let Some(learned) = self.analyze(conflict) else {
            self.concluded_refutation();
            return false;
        };
        self.stats.backtracks += 1;
        self.stats.jumped_over += u64::from(self.trail.level() - learned.level - 1);
        self.record_learned(&learned.clause, learned.level);
        self.retract(learned.level);
        let decisive = learned.clause[0];
        let (cause, clause) = if learned.clause.len() == 1 {
            (trail::Cause::Decision, None)
        } else {
            self.stats.nogoods += 1;
            let clause = self.clauses.add(learned.clause, Some(learned.num_levels));
            (trail::Cause::Clause(clause), Some(clause))
        };
        self.concluded(clause, self.trail.events.next_key());
        self.activity.decay();
        self.clauses.decay();
        // What contradicts it below is found by the next propagation's conflict.
        match self.trail.set(decisive, cause) {
            Ok(()) => true,
            Err(conflict) => {
                self.record_refusal(&conflict, |choices| Event::Clash { choices });
                self.learn(&conflict)
            }
        }
    }

    /// A conflict whose last event left a variable no value, as the reasons of that event; it is taken back.
    fn before_crossing(&mut self, conflict: &[Literal]) -> Conflict {
        let Some((event, &trail::Event { side, most, .. })) = self.trail.events.last_key_value() else {
            return conflict.to_vec();
        };
        let last = Literal::new(side, most);
        if !self.trail.holds(!last) || !conflict.contains(&last) {
            return conflict.to_vec();
        }
        let mut reason: Conflict = conflict.iter().copied().filter(|&literal| literal != last).collect();
        self.explain(last, event, &mut reason);
        self.conclude_by(event, &reason);
        self.trail.undo_last();
        self.head = self.head.min(self.trail.events.len());
        self.theory_head = self.theory_head.min(self.trail.events.len());
        if let Some(record) = &mut self.record {
            record.retract(self.trail.level(), self.trail.events.len());
        }
        reason
    }

    fn restart(&mut self) {
        self.restarts += 1;
        self.conflicts_until_restart = RESTART_UNIT * luby(self.restarts);
        self.retract(0);
        if self.clauses.num_learned() > self.max_learned && !self.takes_nothing_for_granted() {
            self.clauses.forget_half();
            self.max_learned += self.max_learned / 10;
        }
    }

    fn retract(&mut self, level: u32) {
        let Self { trail, choice_points, choice_points_of, activity, .. } = self;
        trail.retract(level, |event| {
            let variable = event.side.variable();
            for choice_point in choice_points_of.iter(variable) {
                activity.insert(choice_point);
                let ChoicePoint { options, last, .. } = &mut choice_points[choice_point];
                if let Some(option) = options.iter().position(|option| option.side == event.side) {
                    *last = Some(option as u32);
                }
            }
        });
        self.neighborhood.retract(level);
        self.head = self.head.min(self.trail.events.len());
        self.theory_head = self.theory_head.min(self.trail.events.len());
        if let Some(&head) = self.theory_heads.get(level as usize) {
            self.theory_head = self.theory_head.min(head);
            self.theory_heads.truncate(level as usize);
        }
        if let Some(record) = &mut self.record {
            record.retract(self.trail.level(), self.trail.events.len());
        }
        self.sweeps.forget();
        self.alternatives.queue.forget();
        self.disjunctives.queue.forget();
        self.cumulatives.queue.forget();
        self.linears.queue.forget();
        self.tours.queue.forget();
    }

    /// Makes the next decision. `false` if everything that counts is decided, or if the next decision goes by times that
    /// others made at once have not moved yet.
    fn decide(&mut self, deciding: Deciding) -> bool {
        if let Some(assumed) = self.assumption.filter(|&assumed| self.trail.is_open(assumed)) {
            self.decide_on(assumed);
            return true;
        }
        if let Some(kept) = self.neighborhood.decide(&self.trail, &self.choice_points) {
            self.decide_on(kept);
            return true;
        }
        while let Some(id) = self.activity.pop() {
            let choice_point = &self.choice_points[id];
            let counts = choice_point.when.iter().all(|&when| self.trail.holds(when));
            if !counts || choice_point.options.iter().any(|&option| self.trail.holds(option)) {
                continue;
            }
            if deciding == Deciding::AtOnce && choice_point.kind == ChoicePointKind::Resolvers {
                self.activity.insert(id);
                return false;
            }
            let Some(option) = self.preferred(choice_point) else { continue };
            self.decide_on(option);
            return true;
        }
        false
    }

    fn decide_on(&mut self, option: Literal) {
        self.open_level_for(option);
        self.follow(option);
    }

    /// Makes an open literal hold in a new level.
    fn open_level_for(&mut self, option: Literal) {
        // Levels that were opened elsewhere begin with everything propagated.
        self.theory_heads.resize(self.trail.level() as usize, usize::MAX);
        self.theory_heads.push(self.theory_head);
        self.trail.open_level();
        // What is open can be either.
        let _ = self.trail.set(option, trail::Cause::Decision);
    }

    /// The decisions are taken back that led to a solution which broke something, before which so many conflicts were counted.
    fn leave(&mut self, decisions: Vec<Literal>, conflicts: u64) {
        self.is_failure_counted = self.stats.conflicts > conflicts;
        self.num_left = decisions.len();
        self.left = decisions;
        self.is_returning = true;
    }

    /// It is known where the search goes back to: where one of the decisions that it left has become impossible, or else to
    /// the start.
    fn end_return(&mut self) {
        if !std::mem::take(&mut self.is_returning) {
            return;
        }
        let impossible = self.left.iter().position(|&literal| self.trail.fails(literal));
        self.stats.backtracks += u64::from(impossible.is_some());
        // A solution with these decisions breaks something whatever else is chosen.
        self.stats.conflicts += u64::from(impossible.is_some() && !self.is_failure_counted);
        self.record_end_of_return(impossible);
    }

    /// Takes note of the decision just made. One that is made again, on the way to where the search leaves what it did last,
    /// is not counted again.
    fn follow(&mut self, decided: Literal) {
        let level = self.trail.level() as usize;
        let is_again = level <= self.num_left && self.left[level - 1] == decided;
        if !is_again {
            self.num_left = 0;
            self.end_return();
        }
        if is_again {
            self.record_again_at(level);
        } else if self.assumption == Some(decided) {
            let state = self.recorded_state();
            self.record_again(state);
        } else {
            self.stats.expanded += 1;
            self.record_decision(decided);
        }
    }

    fn bump(&mut self, literal: Literal) {
        if self.is_in_textual_order {
            return;
        }
        for choice_point in self.choice_points_of.iter(literal.side.variable()) {
            self.activity.bump(choice_point);
        }
    }
}

/// What a burst of decisions changes beside the trail.
struct BeforeBurst {
    expanded: u64,
    backtracks: u64,
    conflicts: u64,
    num_left: usize,
    is_returning: bool,
}

/// The restart sequence of Luby, Sinclair and Zuckerman: 1, 1, 2, 1, 1, 2, 4, …
fn luby(position: u64) -> u64 {
    let mut position = position;
    loop {
        let power = u64::BITS - (position + 1).leading_zeros();
        if position + 1 == 1 << (power - 1) {
            return (1 << (power - 1)) / 2;
        }
        position -= (1 << (power - 1)) - 1;
    }
}
