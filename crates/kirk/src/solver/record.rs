//! The record of a search: what is decided, what follows from what, what fails and what is learned, in the terms of the
//! plan (SPEC 5.6).
//!
//! Reasons are told as choices alone. What the solver knows of single times is traced back to the choices that it follows
//! from, and so is what is ruled out; what a conflict teaches stays true by that, though it may say less than the clause.
//! Recording decides nothing: the same plan is found with and without it. Only what no one watches makes many decisions
//! before it looks at their times.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

use exact::Rational;
use stn::{Inconsistency, Stn};
use tpn::UseId;

use super::encode::Problem;
use super::literal::{Literal, Side};
use super::trail::{Cause, Conflict};
use super::{ChoicePointKind, Solver};
use crate::ids::EventId;
use crate::model::UNBOUNDED_BELOW;
use crate::model::{INFINITE, Model, node, point};
use crate::precedence;
use crate::trace::{
    Constraint, CycleMember, Event, Recorder, SearchRound, Trace, TreeChoice, TreeNodeId, TreeStatus,
};

/// A search being recorded.
#[derive(Clone, Debug)]
pub(crate) struct Record {
    recorder: Recorder,
    /// The state of each level.
    path: Vec<TreeNodeId>,
    /// What a Boolean says, by the side that is decided when it holds.
    names: BTreeMap<Side, Vec<TreeChoice>>,
    /// What decided bounds of times say.
    starts: BTreeMap<Literal, TreeChoice>,
    /// How many events of the trail have been told.
    seen: usize,
    /// The states on the way to the one that was left last.
    left: Vec<TreeNodeId>,
    /// What is told once it is known where the search goes back to from there.
    held: Option<Vec<(TreeNodeId, Event)>>,
    /// The state of the last plan.
    solution: TreeNodeId,
    /// Whether better and better plans are looked for, in searches of their own.
    has_goals: bool,
    /// Of a best-first search, which comes to a state more than once: what has been told in each.
    told: Option<BTreeMap<TreeNodeId, BTreeSet<Side>>>,
}

/// What a conflict comes from, where that is not told by its literals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Origin {
    #[default]
    Other,
    /// A sum that must stay below its limit.
    Goal,
}

impl Record {
    pub(crate) fn new(limit: usize, has_goals: bool) -> Self {
        Self {
            recorder: Recorder::new(limit),
            path: vec![0],
            names: BTreeMap::new(),
            starts: BTreeMap::new(),
            seen: 0,
            left: Vec::new(),
            held: None,
            solution: 0,
            has_goals,
            told: None,
        }
    }

    pub(crate) fn into_trace(self) -> Trace {
        self.recorder.trace
    }

    const fn is_full(&self) -> bool {
        self.recorder.trace.is_truncated
    }

    /// The present state.
    fn at(&self) -> TreeNodeId {
        self.path.last().copied().unwrap_or(0)
    }

    pub(crate) fn tell(&mut self, event: Event) {
        let at = self.at();
        match &mut self.held {
            Some(held) => held.push((at, event)),
            None => self.recorder.record(at, event),
        }
    }

    /// The plan of the last state in which one was found, at a position among the plans.
    pub(crate) fn tell_plan(&mut self, plan: u32) {
        self.recorder.record(self.solution, Event::Solution { plan });
    }

    /// What the plan in the last such state is worth.
    pub(crate) fn tell_improvement(&mut self, values: Vec<Rational>) {
        self.recorder.record(self.solution, Event::Improve { values });
    }

    /// Nothing was found.
    pub(crate) fn fail(&mut self) {
        self.recorder.set_status(0, TreeStatus::Failed);
    }

    fn enter(&mut self, choice: Option<TreeChoice>) {
        let parent = self.at();
        self.path.extend(self.recorder.enter(parent, choice));
    }

    fn set_status(&mut self, status: TreeStatus) {
        // What becomes of the root is known at the end of all searches.
        if self.at() != 0 || status == TreeStatus::Solution {
            self.recorder.set_status(self.at(), status);
        }
    }

    /// Takes note that it is told in the present state what a side says; `false` if that is known there.
    fn is_news(&mut self, side: Side) -> bool {
        let at = self.at();
        let Some(told) = &mut self.told else { return true };
        let is_known =
            self.path.iter().any(|state| told.get(state).is_some_and(|sides| sides.contains(&side)));
        !is_known && told.entry(at).or_default().insert(side)
    }

    /// Events of levels above this one are gone, and those of the trail beyond `num_events`.
    pub(super) fn retract(&mut self, level: u32, num_events: usize) {
        self.path.truncate(level as usize + 1);
        self.seen = self.seen.min(num_events);
    }

    fn last_learned(&self) -> Vec<TreeChoice> {
        let mut last = self.recorder.trace.events.iter().rev();
        last.find_map(|entry| match &entry.event {
            Event::Learn { choices } => Some(choices.clone()),
            _ => None,
        })
        .unwrap_or_default()
    }

    /// Returns what a literal says, if it is a choice that is made.
    fn name(&self, literal: Literal) -> Option<TreeChoice> {
        let named = self.names.get(&literal.side).and_then(|names| names.first());
        named.or_else(|| self.starts.get(&literal)).copied()
    }
}

impl Solver {
    /// The record, while there is one that has room.
    fn recording(&mut self) -> Option<&mut Record> {
        self.record.as_deref_mut().filter(|record| !record.is_full())
    }

    pub(super) const fn is_recording(&self) -> bool {
        match &self.record {
            Some(record) => !record.is_full(),
            None => false,
        }
    }

    /// Tells an event of the present state.
    pub(super) fn tell(&mut self, event: impl FnOnce() -> Event) {
        if let Some(record) = self.recording() {
            record.tell(event());
        }
    }

    /// Continues with a record in a new search, at its root.
    pub(crate) fn begin_record(
        &mut self,
        problem: &Problem<'_>,
        record: Option<Box<Record>>,
        round: SearchRound,
    ) {
        self.record = record;
        let Some(record) = self.recording() else { return };
        record.path.truncate(1);
        record.seen = 0;
        record.held = None;
        record.told = round.is_best_first.then(BTreeMap::new);
        record.tell(Event::Begin(round));
        self.name_choices(problem);
        let given = Literal::TRUE.side;
        let Some(record) = self.recording() else { return };
        for choice in record.names.get(&given).cloned().unwrap_or_default() {
            record.tell(Event::Imply { choice, holds: true, because: Vec::new() });
        }
    }

    fn name_choices(&mut self, problem: &Problem<'_>) {
        let Some(record) = self.recording() else { return };
        record.names.clear();
        for (literal, choice) in problem.names() {
            record.names.entry(literal.side).or_default().push(choice);
        }
    }

    /// Takes note of choice points that were added at the root.
    pub(crate) fn record_choice_points(&mut self, problem: &Problem<'_>) {
        self.name_choices(problem);
    }

    /// Tells that the search goes back to its root, where there may be new choice points.
    pub(crate) fn record_restart(&mut self, problem: &Problem<'_>) {
        if self.is_recording() {
            self.name_choices(problem);
            self.tell(|| Event::Restart);
        }
    }

    /// Takes note of the way to a state in which everything is decided.
    pub(super) fn record_leaf(&mut self) {
        if let Some(record) = self.recording() {
            record.left.clone_from(&record.path);
        }
    }

    /// The present state was a solution that broke something. It is told where the search goes back to once that is known:
    /// it makes the same decisions again as far as it can.
    pub(super) fn record_return(&mut self, problem: &Problem<'_>) {
        self.name_choices(problem);
        if let Some(record) = self.recording() {
            record.held = Some(Vec::new());
        }
    }

    /// Tells where the search has gone back to from the state that it left: to the present one, where what was decided at a
    /// position among its decisions has become impossible, or else to the start. What followed meanwhile is told after that.
    pub(super) fn record_end_of_return(&mut self, impossible: Option<usize>) {
        if !self.is_recording() {
            return;
        }
        let literal = impossible.map(|position| self.left[position]);
        let behind = literal.map(|literal| self.literals_behind(&[!literal], None)).unwrap_or_default();
        let levels: Vec<u32> = behind.iter().map(|&literal| self.level_of(literal)).collect();
        let is_failure_told = self.is_failure_counted;
        let Some(record) = self.recording() else { return };
        let held = record.held.take().unwrap_or_default();
        let from = record.left.last().copied().unwrap_or(0);
        let state = |level: usize| record.left.get(level).copied();
        let taken_back = impossible.and_then(|position| state(position + 1));
        if let (Some(taken_back), Some(literal)) = (taken_back, literal) {
            let to = record.at();
            let choices: Vec<TreeChoice> =
                behind.iter().chain([&literal]).filter_map(|&it| record.name(it)).collect();
            let states = levels.into_iter().filter_map(|level| state(level as usize));
            let because = states.chain([taken_back]).collect();
            // What becomes of the root is known at the end of all searches.
            if from != 0 {
                record.recorder.set_status(from, TreeStatus::Failed);
            }
            if !is_failure_told {
                record.recorder.record(from, Event::Clash { choices: choices.clone() });
            }
            let mut last = record.recorder.trace.events.iter().rev();
            let is_told = last.next().is_some_and(|it| matches!(it.event, Event::Uncontrollable { .. }));
            if !is_told {
                record.recorder.record(from, Event::Learn { choices });
            }
            record.recorder.record(from, Event::Backjump { to, because });
        } else {
            record.recorder.record(0, Event::Restart);
        }
        for (state, event) in held {
            record.recorder.record(state, event);
        }
    }

    /// Tells the decision just made, which opened a level.
    pub(super) fn record_decision(&mut self, option: Literal) {
        let Some(record) = self.recording() else { return };
        let choice = record.name(option);
        record.enter(choice);
        let event = match choice {
            Some(TreeChoice::Decision { decision, alternative }) => Event::Decide { decision, alternative },
            Some(TreeChoice::Link(link)) => Event::TryLink { link },
            Some(TreeChoice::Order(order)) => Event::TryOrder { order },
            Some(TreeChoice::UseOrder(order)) => Event::TryUseOrder { order },
            // All that is decided is one of these.
            Some(TreeChoice::Start { used, by }) => Event::TryStart { used, by },
            Some(
                TreeChoice::NoLink { .. }
                | TreeChoice::Later { .. }
                | TreeChoice::Departure(_)
                | TreeChoice::Apart,
            )
            | None => return,
        };
        record.tell(event);
    }

    /// Tells the decision just made, when a use starts.
    pub(super) fn record_start(&mut self, option: Literal, choice: TreeChoice) {
        if let Some(record) = self.recording() {
            record.starts.insert(option, choice);
        }
        self.record_decision(option);
    }

    /// Tells what has followed since the last time.
    pub(super) fn record_implied(&mut self) {
        if !self.is_recording() {
            return;
        }
        let level = self.trail.level();
        let from = self.record.as_ref().map_or(0, |record| record.seen);
        for position in from..self.trail.events.len() {
            let id = EventId::from(position);
            let event = self.trail.events[id];
            // A Boolean that would be both is a conflict.
            let is_contradicted = self.trail.bound(event.side.opposite()) < -event.most;
            let Some(record) = self.record.as_deref().filter(|_| !is_contradicted) else { continue };
            let is_decision = event.cause == Cause::Decision && level > 0;
            let own = record.names.get(&event.side).cloned().unwrap_or_default();
            let ruled_out = record.names.get(&event.side.opposite()).and_then(|names| names.first()).copied();
            let ruled_out = ruled_out.filter(|choice| {
                let is_told = matches!(choice, TreeChoice::Decision { .. } | TreeChoice::Link(_));
                // That another one is taken goes without saying.
                is_told && own.is_empty() && !matches!(event.cause, Cause::Implied(_))
            });
            if own.is_empty() && ruled_out.is_none() {
                continue;
            }
            if !self.recording().is_some_and(|record| record.is_news(event.side)) {
                continue;
            }
            let literal = Literal::new(event.side, event.most);
            let because = if is_decision {
                own.first().copied().into_iter().collect()
            } else {
                let mut reason = Vec::new();
                self.reason_of(literal, id, &mut reason);
                self.choices_behind(&reason, None)
            };
            let Some(record) = self.recording() else { return };
            for (at, choice) in own.into_iter().enumerate() {
                if !is_decision || at > 0 {
                    record.tell(Event::Imply { choice, holds: true, because: because.clone() });
                }
            }
            if let Some(choice) = ruled_out {
                record.tell(Event::Imply { choice, holds: false, because });
            }
        }
        let seen = self.trail.events.len();
        if let Some(record) = self.recording() {
            record.seen = seen;
        }
    }

    /// Tells the failure of the present state.
    pub(super) fn record_failure(&mut self, problem: &Problem<'_>, conflict: &[Literal]) {
        if !self.is_recording() {
            return;
        }
        self.record_implied();
        let choices = self.choices_behind(conflict, None);
        let cycle = self.cycle_in_force(problem);
        let event = if !cycle.is_empty() {
            Event::Inconsistent { cycle }
        } else if let Some(event) = self.exhausted_choice_point() {
            event
        } else if self.rests_on_goal(conflict) {
            Event::NotBetter { choices }
        } else {
            Event::Clash { choices }
        };
        if let Some(record) = self.recording() {
            record.tell(event);
            record.set_status(TreeStatus::Failed);
        }
    }

    /// Tells that there is no plan whatever is chosen, and why if bounds alone contradict each other.
    pub(super) fn record_contradiction(&mut self, problem: &Problem<'_>) {
        if !self.is_recording() {
            return;
        }
        let cycle = self.cycle_in_force(problem);
        let is_of_bounds = !cycle.is_empty();
        self.tell(|| {
            if is_of_bounds { Event::Inconsistent { cycle } } else { Event::Clash { choices: Vec::new() } }
        });
    }

    /// Tells that a solution of the solver is none: what is wrong with it, and the literals that must not all hold.
    pub(super) fn record_refusal(
        &mut self,
        literals: &[Literal],
        event: impl FnOnce(Vec<TreeChoice>) -> Event,
    ) {
        if !self.is_recording() {
            return;
        }
        let choices = self.choices_behind(literals, None);
        if let Some(record) = self.recording() {
            record.tell(event(choices));
            record.set_status(TreeStatus::Failed);
        }
    }

    /// Tells what a conflict has taught, and where the search goes back to. The clause is false still.
    pub(super) fn record_learned(&mut self, clause: &[Literal], level: u32) {
        if !self.is_recording() {
            return;
        }
        let conflict: Conflict = clause.iter().map(|&literal| !literal).collect();
        let literals = self.literals_behind(&conflict, Some(self.trail.level()));
        let mut levels: Vec<u32> = literals.iter().map(|&literal| self.level_of(literal)).collect();
        levels.sort_unstable();
        levels.dedup();
        let Some(record) = self.recording() else { return };
        let choices = literals.iter().filter_map(|&literal| record.name(literal)).collect();
        let state = |level: u32| record.path.get(level as usize).copied().unwrap_or(0);
        let because = levels.into_iter().map(state).collect();
        let to = state(level);
        record.tell(Event::Learn { choices });
        // A best-first search continues where it is best.
        if record.told.is_none() {
            record.tell(Event::Backjump { to, because });
        }
    }

    /// The present state, if there is room for it.
    pub(super) fn recorded_state(&self) -> Option<TreeNodeId> {
        self.record.as_ref().filter(|record| !record.is_full()).map(|record| record.at())
    }

    /// A state beside the present one, in which the use starts later than it does here.
    pub(super) fn record_later(&mut self, start: Literal) -> Option<TreeNodeId> {
        let record = self.recording()?;
        let Some(&TreeChoice::Start { used, by }) = record.starts.get(&start) else { return None };
        let later = TreeChoice::Later { used, than: by };
        record.starts.insert(!start, later);
        let beside = record.path.iter().rev().nth(1).copied().unwrap_or(0);
        let state = record.recorder.enter(beside, Some(later))?;
        record.recorder.set_status(state, TreeStatus::Unexplored);
        Some(state)
    }

    /// Takes note that the decision of a level is made again that the search left last.
    pub(super) fn record_again_at(&mut self, level: usize) {
        if let Some(record) = self.recording() {
            record.path.extend(record.left.get(level).copied());
        }
    }

    /// Takes note that a decision is made again.
    pub(super) fn record_again(&mut self, state: Option<TreeNodeId>) {
        if let Some(record) = self.recording() {
            record.path.extend(state);
        }
    }

    /// Tells that the search continues with the present state, what the goals may become in it, and how many others wait.
    pub(super) fn record_visit(&mut self, problem: &Problem<'_>, least: &[i64], waiting: usize) {
        if let Some(record) = self.recording() {
            record.set_status(TreeStatus::Decision);
            record.tell(Event::Visit { values: problem.goal_values(least), waiting: waiting as u32 });
        }
    }

    /// Tells what the goals may become in the present state, which now waits.
    pub(super) fn record_bound(&mut self, problem: &Problem<'_>, least: &[i64]) {
        if let Some(record) = self.recording() {
            record.set_status(TreeStatus::Unexplored);
            record.tell(Event::Bound { values: problem.goal_values(least) });
        }
    }

    /// Takes note that a state is left for those below it.
    pub(super) fn record_tried(&mut self, state: TreeNodeId) {
        if let Some(record) = self.recording() {
            record.recorder.set_status(state, TreeStatus::Decision);
        }
    }

    /// Tells that a state contains what has been learned: of a decision on the way to it that has become impossible, or else
    /// what was learned last.
    pub(super) fn record_known(&mut self, state: Option<TreeNodeId>, impossible: Option<Literal>) {
        let Some(state) = state.filter(|_| self.is_recording()) else { return };
        let choices = match impossible {
            Some(literal) => {
                let mut choices = self.choices_behind(&[!literal], None);
                choices.extend(self.record.as_deref().and_then(|record| record.name(literal)));
                choices
            }
            None => self.record.as_deref().map(Record::last_learned).unwrap_or_default(),
        };
        self.record_refused(state, Event::Known { choices });
    }

    /// Tells why nothing is looked for in a state.
    pub(super) fn record_refused(&mut self, state: TreeNodeId, event: Event) {
        if let Some(record) = self.recording() {
            let is_left_out = matches!(event, Event::NotBetter { .. });
            let status = if is_left_out { TreeStatus::Excluded } else { TreeStatus::Failed };
            record.recorder.record(state, event);
            record.recorder.set_status(state, status);
        }
    }

    /// Tells that there is no further solution.
    pub(super) fn record_exhausted(&mut self) {
        if let Some(record) = self.recording() {
            record.path.truncate(1);
            record.tell(Event::Exhausted);
        }
    }

    /// Tells that everything is decided and the times fit; `event` says what a plan keeps of that.
    pub(crate) fn record_solution(&mut self, event: impl FnOnce() -> Event) {
        if let Some(record) = self.recording() {
            if record.has_goals && record.at() == 0 {
                // Other searches begin at the root, too.
                record.enter(None);
            }
            record.tell(event());
            record.set_status(TreeStatus::Solution);
            record.solution = record.at();
        }
    }

    /// The choices that literals which hold follow from.
    fn choices_behind(&self, literals: &[Literal], level: Option<u32>) -> Vec<TreeChoice> {
        let Some(record) = self.record.as_deref() else { return Vec::new() };
        let literals = self.literals_behind(literals, level);
        literals.into_iter().filter_map(|literal| record.name(literal)).collect()
    }

    /// The choices, as literals and the last one first, that literals which hold follow from: the next ones on the way
    /// back, or of `level`, if given, only the one that everything went through.
    fn literals_behind(&self, literals: &[Literal], level: Option<u32>) -> Vec<Literal> {
        let Some(record) = self.record.as_deref() else { return Vec::new() };
        let mut open: BinaryHeap<(EventId, Reverse<i64>)> = BinaryHeap::new();
        let meet = |literal: Literal, open: &mut BinaryHeap<(EventId, Reverse<i64>)>| {
            let event = self.trail.implying_event(literal);
            if let Some(event) = event.filter(|&event| self.trail.events[event].level > 0) {
                open.push((event, Reverse(literal.most)));
            }
        };
        for &literal in literals {
            meet(literal, &mut open);
        }
        let mut found = Vec::new();
        let mut reason = Vec::new();
        while let Some((id, Reverse(mut most))) = open.pop() {
            while let Some(&(same, Reverse(other))) = open.peek()
                && same == id
            {
                most = most.min(other);
                open.pop();
            }
            let event = self.trail.events[id];
            let literal = Literal::new(event.side, most);
            let is_last_of_level = || {
                let next = open.peek().map(|&(next, _)| self.trail.events[next].level);
                next.is_none_or(|next| Some(next) != level)
            };
            let is_stop = Some(event.level) != level || is_last_of_level();
            if event.cause == Cause::Decision {
                // As it was decided, even where less would do.
                found.push(Literal::new(event.side, event.most));
                continue;
            }
            if is_stop && record.name(literal).is_some() {
                found.push(literal);
                continue;
            }
            reason.clear();
            self.reason_of(literal, id, &mut reason);
            for &literal in &reason {
                meet(literal, &mut open);
            }
        }
        found
    }

    /// Returns whether what a conflict comes from has to do with a limit on a goal.
    fn rests_on_goal(&self, conflict: &[Literal]) -> bool {
        let level = self.trail.level();
        let is_limited = |literal: Literal| {
            let event = self.trail.implying_event(literal).map(|event| self.trail.events[event]);
            event.is_some_and(|event| {
                event.level == level
                    && matches!(event.cause, Cause::Noted(note) if self.trail.is_of_goal(note))
            })
        };
        self.origin == Origin::Goal || conflict.iter().copied().any(is_limited)
    }

    /// A choice point that counts and has no option left.
    fn exhausted_choice_point(&self) -> Option<Event> {
        let record = self.record.as_deref()?;
        let is_exhausted = |choice_point: &&super::ChoicePoint| {
            choice_point.when.iter().all(|&when| self.trail.holds(when))
                && choice_point.options.iter().all(|&option| self.trail.fails(option))
        };
        let choice_point = self.choice_points.iter().find(is_exhausted)?;
        let names = || choice_point.options.iter().filter_map(|&option| record.name(option));
        Some(match choice_point.kind {
            ChoicePointKind::Alternatives => match names().next()? {
                TreeChoice::Decision { decision, .. } => Event::NoAlternative { decision },
                _ => return None,
            },
            ChoicePointKind::Carriers { ask } => Event::Unclosable { ask },
            ChoicePointKind::Orders { left, right } => Event::Unresolvable { left, right },
            ChoicePointKind::Sides => match names().next()? {
                TreeChoice::Order(order) => Event::Unresolvable { left: order.first, right: order.then },
                _ => return None,
            },
            ChoicePointKind::Resolvers => {
                let mut uses: Vec<UseId> = Vec::new();
                for choice in names() {
                    if let TreeChoice::UseOrder(order) = choice {
                        uses.extend([order.first, order.then]);
                    }
                }
                uses.sort_unstable();
                uses.dedup();
                Event::Unsharable { uses }
            }
        })
    }

    /// A contradiction among the bounds, links and orders in force, if there is one.
    fn cycle_in_force(&self, problem: &Problem<'_>) -> Vec<CycleMember> {
        let Some(record) = self.record.as_deref() else { return Vec::new() };
        let model = problem.model;
        let mut constraints: Vec<Constraint> = Vec::new();
        let mut stn = Stn::new(model.num_nodes);
        for (id, arc) in model.arcs.iter_enumerated() {
            if !problem.is_present(self, arc) {
                continue;
            }
            let (from, to) = (point(arc.from), point(arc.to));
            if arc.upper != INFINITE {
                stn.push(from, to, arc.upper, constraints.len() as u32);
                constraints.push(Constraint::Upper(id));
            }
            if arc.lower != UNBOUNDED_BELOW {
                stn.push(to, from, -arc.lower, constraints.len() as u32);
                constraints.push(Constraint::Lower(id));
            }
        }
        for (&side, names) in &record.names {
            // What touches keeps no gap.
            if !self.trail.holds(side.decided()) || problem.touches.has(side) {
                continue;
            }
            for &choice in names {
                let Some(constraint) = constraint(choice) else { continue };
                for (from, to, weight) in precedence::edges(model, choice) {
                    stn.push(from, to, weight, constraints.len() as u32);
                    constraints.push(constraint);
                }
            }
        }
        match stn.settle(&model.order) {
            Err(Inconsistency::NegativeCycle) => {
                let member = |edge: &stn::CycleEdge| told(model, &constraints, edge);
                stn.cycle().iter().filter_map(member).collect()
            }
            Ok(()) | Err(Inconsistency::Overflow(_)) => Vec::new(),
        }
    }
}

fn told(model: &Model, constraints: &[Constraint], edge: &stn::CycleEdge) -> Option<CycleMember> {
    Some(CycleMember {
        constraint: *constraints.get(edge.tag as usize)?,
        from: node(edge.from),
        to: node(edge.to),
        weight: model.time(edge.weight),
    })
}

/// Returns what a choice adds to the network.
const fn constraint(choice: TreeChoice) -> Option<Constraint> {
    match choice {
        TreeChoice::Decision { .. }
        | TreeChoice::NoLink { .. }
        | TreeChoice::Start { .. }
        | TreeChoice::Later { .. }
        | TreeChoice::Apart => None,
        TreeChoice::Link(link) => Some(Constraint::Link(link)),
        TreeChoice::Order(order) => Some(Constraint::Order(order)),
        TreeChoice::UseOrder(order) => Some(Constraint::UseOrder(order)),
        TreeChoice::Departure(departing) => Some(Constraint::Departure(departing)),
    }
}
