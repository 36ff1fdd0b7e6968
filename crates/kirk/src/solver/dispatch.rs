//! Dispatching: a first schedule in the order of time. Of the uses that compete for the resource that can end a use first, the
//! one starts that must start soonest (Giffler and Thompson 1960).

use std::collections::BTreeMap;

use fixedbitset::FixedBitSet;
use tpn::{NodeId, UseId};

use super::Solver;
use super::encode::Problem;
use super::literal::{Literal, Variable};
use super::resources::Task;
use crate::demands::ModelSupply;
use crate::ids::ChoicePointId;
use crate::trace::TreeChoice;

/// Orders of fewer uses are soon gone through.
const MIN_USES: usize = 20;

/// From so many uses on what starts mean is looked at after many of them.
pub(super) const CROWD: usize = 1_000;

/// More uses are not dispatched: each looks at all.
const MAX_USES: usize = 5_000;

/// Where bounds put more uses before others, they are not dispatched.
const MAX_BEFORE: usize = 2_000_000;

/// Starts that are decided before their consequences are looked at.
const BURST: usize = 64;

/// Failures after which the search goes on in its own order.
const MAX_FAILURES: u64 = 20;

/// What dispatching has to know of the uses.
#[derive(Clone, Debug)]
pub(super) struct Dispatching {
    /// The greatest number of conflicts at which it goes on.
    until: u64,
    /// The number of conflicts of the last look: after another one, uses may not have started any more.
    conflicts: u64,
    resources: Vec<Pool>,
    /// By use: those that end before it starts.
    before: BTreeMap<UseId, Vec<Task>>,
    /// The uses of one activity, by when it starts and that it happens: which ones of which resources.
    together: BTreeMap<(Variable, Literal), Vec<(usize, usize)>>,
}

/// A reusable resource.
#[derive(Clone, Debug)]
struct Pool {
    capacity: i64,
    tasks: Vec<Waiting>,
    /// What has started, by its end.
    started: Vec<Started>,
}

/// A use that may start.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    task: Task,
    /// There was no room for it before.
    earliest: i64,
    is_started: bool,
}

#[derive(Clone, Copy, Debug)]
struct Started {
    start: i64,
    end: i64,
    amount: i64,
}

/// A use that has not started.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    task: Task,
    resource: usize,
    start: i64,
    end: i64,
}

impl Problem<'_> {
    /// Begins to dispatch from the start, where there are enough uses for it to matter.
    pub(crate) fn begin_dispatch(&mut self, solver: &mut Solver) {
        if self.shares.num_uses() >= MIN_USES && self.can_dispatch() {
            self.exclude_all(solver);
            self.go_on_dispatching(solver);
        }
    }

    /// Returns whether uses can be dispatched: not too many, and not where nature chooses durations, because times that
    /// fit say nothing then.
    pub(super) fn can_dispatch(&self) -> bool {
        !self.faces_nature && self.shares.num_uses() <= MAX_USES
    }

    /// Dispatches what has not started.
    pub(super) fn go_on_dispatching(&mut self, solver: &Solver) {
        let waiting = |task| Waiting { task, earliest: i64::MIN, is_started: false };
        let resources = self.shares.tasks().into_iter().filter_map(|(supply, tasks)| match supply {
            ModelSupply::Reusable { capacity } => {
                let tasks = tasks.into_iter().filter(|task| task.is_active).map(waiting).collect();
                Some(Pool { capacity, tasks, started: Vec::new() })
            }
            ModelSupply::Reservoir { .. } => None,
        });
        let resources: Vec<Pool> = resources.collect();
        let Some(before) = self.earlier_uses(&resources) else { return };
        let mut together: BTreeMap<(Variable, Literal), Vec<(usize, usize)>> = BTreeMap::new();
        for (resource, pool) in resources.iter().enumerate() {
            for (at, it) in pool.tasks.iter().enumerate() {
                together.entry(activity(&it.task)).or_default().push((resource, at));
            }
        }
        let conflicts = solver.stats.conflicts;
        let until = conflicts + MAX_FAILURES;
        self.dispatching = Some(Dispatching { until, conflicts, resources, before, together });
    }

    /// By use: those that bounds make end before it starts. `None` if these are too many.
    fn earlier_uses(&self, resources: &[Pool]) -> Option<BTreeMap<UseId, Vec<Task>>> {
        let mut from: Vec<Vec<NodeId>> = vec![Vec::new(); self.model.num_nodes];
        for arc in self.model.arcs.iter().filter(|arc| arc.lower >= 0 && arc.to != self.model.start) {
            from[arc.from.index()].push(arc.to);
        }
        let tasks: Vec<Task> = resources.iter().flat_map(|pool| &pool.tasks).map(|it| it.task).collect();
        let mut starting: BTreeMap<NodeId, Vec<UseId>> = BTreeMap::new();
        for task in &tasks {
            starting.entry(task.start).or_default().push(task.id);
        }
        let mut before: BTreeMap<UseId, Vec<Task>> = BTreeMap::new();
        let mut left = MAX_BEFORE;
        for task in tasks.iter().filter(|task| task.start != task.end) {
            let mut reached = FixedBitSet::with_capacity(self.model.num_nodes);
            let mut open = vec![task.end];
            while let Some(node) = open.pop() {
                if reached.put(node.index()) {
                    continue;
                }
                for &used in starting.get(&node).into_iter().flatten() {
                    before.entry(used).or_default().push(*task);
                }
                left = left.checked_sub(1)?;
                open.extend(&from[node.index()]);
            }
        }
        Some(before)
    }

    /// Decides that the next use happens, what it comes after, or when it starts; of uses that wait for nothing but their
    /// resource the starts of many. `false` if all have started.
    pub(super) fn dispatch(&mut self, solver: &mut Solver) -> bool {
        let Some(mut dispatching) = self.dispatching.take() else { return false };
        if solver.stats.conflicts > dispatching.until {
            // What dispatching tried last says little of what to try now.
            solver.restart();
            solver.record_restart(self);
            self.prefer_short(solver);
            return false;
        }
        let mut has_decided = false;
        let burst = if self.shares.num_uses() < CROWD { 1 } else { BURST };
        for _ in 0..burst {
            let Some(Candidate { task, resource, start, .. }) = dispatching.next(solver) else { break };
            let is_open = solver.trail.is_open(task.interval.presence);
            let others = dispatching.resources[resource].tasks.iter().filter(|other| other.is_started);
            let order = others.map(|other| other.task).find_map(|other| {
                let is_before = solver.trail.least(other.interval.end) <= start;
                let (first, then) = if is_before { (other.id, task.id) } else { (task.id, other.id) };
                self.order_of_uses(first, then).filter(|&order| solver.trail.is_open(order))
            });
            let is_free = !is_open && order.is_none() && !dispatching.before.contains_key(&task.id);
            if has_decided && !is_free {
                break;
            }
            has_decided = true;
            if is_open {
                solver.decide_on(task.interval.presence);
            } else if let Some(order) = order {
                solver.decide_on(order);
            } else {
                self.start_at(solver, &task, start);
                dispatching.start(&task, start);
            }
            if !is_free {
                break;
            }
        }
        self.dispatching = has_decided.then_some(dispatching);
        has_decided
    }

    /// Decides that a use starts at a time: not before, where that is possible, and not after.
    pub(super) fn start_at(&self, solver: &mut Solver, task: &Task, start: i64) {
        let (used, begins) = (task.id, task.interval.start);
        let later = TreeChoice::Later { used, than: self.model.time(start - 1) };
        let by = TreeChoice::Start { used, by: self.model.time(start) };
        for (option, choice) in
            [(Literal::new(begins.lower(), -start), later), (Literal::new(begins.upper(), start), by)]
        {
            if solver.trail.is_open(option) {
                solver.open_level_for(option);
                solver.num_left = 0;
                solver.stats.expanded += 1;
                solver.record_start(option, choice);
            }
        }
    }
}

impl Dispatching {
    /// The use that starts next.
    fn next(&mut self, solver: &Solver) -> Option<Candidate> {
        if self.conflicts != solver.stats.conflicts {
            self.conflicts = solver.stats.conflicts;
            for pool in &mut self.resources {
                pool.started.clear();
                for it in &mut pool.tasks {
                    (it.is_started, it.earliest) = (false, i64::MIN);
                }
            }
        }
        for pool in &mut self.resources {
            pool.note_started(solver);
        }
        let mut candidates: Vec<Candidate> = Vec::new();
        for resource in 0..self.resources.len() {
            for at in 0..self.resources[resource].tasks.len() {
                let Waiting { task, is_started, .. } = self.resources[resource].tasks[at];
                let mut before = self.before.get(&task.id).into_iter().flatten();
                if is_started
                    || solver.trail.fails(task.interval.presence)
                    || !before.all(|it| is_over(solver, it))
                {
                    continue;
                }
                let start = self.earliest(solver, (resource, at));
                if start <= solver.trail.most(task.interval.start) {
                    let end = start + task.interval.duration;
                    candidates.push(Candidate { task, resource, start, end });
                }
            }
        }
        // Of alternatives those that can end first.
        let choice = |candidate: &Candidate| {
            let presence = candidate.task.interval.presence;
            solver.exclusive[presence.side.variable()].filter(|_| solver.trail.is_open(presence))
        };
        let mut first_ends: BTreeMap<ChoicePointId, i64> = BTreeMap::new();
        for candidate in &candidates {
            if let Some(choice) = choice(candidate) {
                let first = first_ends.entry(choice).or_insert(candidate.end);
                *first = candidate.end.min(*first);
            }
        }
        let is_first = |it: &&Candidate| choice(it).is_none_or(|choice| it.end <= first_ends[&choice]);
        let candidates = || candidates.iter().filter(is_first);
        let (end, resource) = candidates().map(|it| (it.end, it.resource)).min()?;
        let competing =
            candidates().filter(|it| it.resource == resource && (it.start < end || it.end == end));
        competing.min_by_key(|it| (solver.trail.most(it.task.interval.start), it.start, it.task.id)).copied()
    }

    /// The earliest time at which all resources of what a use belongs to have room.
    fn earliest(&mut self, solver: &Solver, (resource, at): (usize, usize)) -> i64 {
        let task = self.resources[resource].tasks[at].task;
        let mut start = solver.trail.least(task.interval.start);
        let together = self.together.get(&activity(&task)).map_or(&[] as &[_], Vec::as_slice);
        loop {
            let before = start;
            for &(resource, at) in together {
                start = self.resources[resource].earliest(at, start);
            }
            if start == before {
                return start;
            }
        }
    }

    /// All uses of the activity of a use have started.
    fn start(&mut self, task: &Task, start: i64) {
        for &(resource, at) in self.together.get(&activity(task)).into_iter().flatten() {
            self.resources[resource].start(at, start);
        }
    }
}

impl Pool {
    fn note_started(&mut self, solver: &Solver) {
        for at in 0..self.tasks.len() {
            let Waiting { task, is_started: is_known, .. } = self.tasks[at];
            if !is_known && is_started(solver, &task) {
                self.start(at, solver.trail.least(task.interval.start));
            }
        }
    }

    fn start(&mut self, at: usize, start: i64) {
        self.tasks[at].is_started = true;
        let Task { interval, amount, .. } = self.tasks[at].task;
        let end = start + interval.duration;
        let after = self.started.partition_point(|other| other.end <= end);
        self.started.insert(after, Started { start, end, amount });
    }

    /// The earliest start from a time on at which there is room for a use beside those that have started.
    fn earliest(&mut self, at: usize, from: i64) -> i64 {
        let Waiting { task, earliest, .. } = self.tasks[at];
        let least = from.max(earliest);
        let placed = &self.started[self.started.partition_point(|other| other.end <= least)..];
        let has_room = |&start: &i64| {
            let end = start + task.interval.duration.max(1);
            let later = &placed[placed.partition_point(|other| other.end <= start)..];
            let taken: i64 = later.iter().filter(|other| other.start < end).map(|other| other.amount).sum();
            taken + task.amount <= self.capacity
        };
        let mut starts = std::iter::once(least).chain(placed.iter().map(|other| other.end));
        let start = starts.find(has_room).unwrap_or(least);
        if from <= earliest {
            self.tasks[at].earliest = start;
        }
        start
    }
}

/// Returns what a use is a part of.
const fn activity(task: &Task) -> (Variable, Literal) {
    (task.interval.start, task.interval.presence)
}

/// Returns whether an earlier use is in nobody's way any more.
fn is_over(solver: &Solver, task: &Task) -> bool {
    solver.trail.fails(task.interval.presence) || is_started(solver, task)
}

fn is_started(solver: &Solver, task: &Task) -> bool {
    let start = task.interval.start;
    solver.trail.holds(task.interval.presence) && solver.trail.least(start) == solver.trail.most(start)
}
