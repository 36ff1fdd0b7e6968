//! Dispatching: a first schedule in the order of time. Of the uses that compete for the resource that can end a use first, the
//! one starts that must start soonest (Giffler and Thompson 1960).

use std::collections::BTreeMap;

use fixedbitset::FixedBitSet;
use tpn::{NodeId, UseId};

use super::Solver;
use super::encode::Problem;
use super::literal::Literal;
use super::resources::Task;
use super::trail::Cause;
use crate::demands::ModelSupply;
use crate::ids::ChoicePointId;

/// Where dispatching takes more looks at uses than this, it is left out.
const MAX_LOOKS: usize = 200_000_000;

/// Failures after which the search goes on in its own order.
const MAX_FAILURES: u64 = 20;

/// What dispatching has to know of the uses.
#[derive(Clone, Debug)]
pub(super) struct Dispatching {
    /// The greatest number of conflicts at which it goes on.
    until: u64,
    resources: Vec<Pool>,
    /// By use: those that end before it starts.
    before: BTreeMap<UseId, Vec<Task>>,
}

/// A reusable resource.
#[derive(Clone, Debug)]
struct Pool {
    capacity: i64,
    tasks: Vec<Task>,
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
    /// Begins to dispatch, unless there are too many uses, or nature chooses durations: times that fit say nothing then.
    pub(crate) fn begin_dispatch(&mut self, solver: &mut Solver) {
        if self.faces_nature {
            return;
        }
        let resources = self.shares.tasks().into_iter().filter_map(|(supply, tasks)| match supply {
            ModelSupply::Reusable { capacity } => Some(Pool { capacity, tasks }),
            ModelSupply::Reservoir { .. } => None,
        });
        let resources: Vec<Pool> = resources.collect();
        let count: usize = resources.iter().map(|pool| pool.tasks.len()).sum();
        let looks: usize =
            resources.iter().map(|pool| pool.tasks.len().saturating_mul(pool.tasks.len())).sum();
        let looks = looks + self.model.arcs.len();
        if looks.saturating_mul(count) > MAX_LOOKS {
            return;
        }
        self.exclude_all(solver);
        let before = self.earlier_uses(&resources);
        let until = solver.stats.conflicts + MAX_FAILURES;
        self.dispatching = Some(Dispatching { until, resources, before });
    }

    /// By use: those that bounds make end before it starts.
    fn earlier_uses(&self, resources: &[Pool]) -> BTreeMap<UseId, Vec<Task>> {
        let mut from: Vec<Vec<NodeId>> = vec![Vec::new(); self.model.num_nodes];
        for arc in self.model.arcs.iter().filter(|arc| arc.lower >= 0 && arc.to != self.model.start) {
            from[arc.from.index()].push(arc.to);
        }
        let tasks: Vec<Task> = resources.iter().flat_map(|pool| &pool.tasks).copied().collect();
        let mut starting: BTreeMap<NodeId, Vec<UseId>> = BTreeMap::new();
        for task in &tasks {
            starting.entry(task.start).or_default().push(task.id);
        }
        let mut before: BTreeMap<UseId, Vec<Task>> = BTreeMap::new();
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
                open.extend(&from[node.index()]);
            }
        }
        before
    }

    /// Decides that the next use happens, what it comes after, or when it starts. `false` if all have started.
    pub(super) fn dispatch(&mut self, solver: &mut Solver) -> bool {
        let Some(dispatching) = &self.dispatching else { return false };
        let next = if solver.stats.conflicts > dispatching.until { None } else { dispatching.next(solver) };
        let Some(Candidate { task, resource, start, .. }) = next else {
            self.dispatching = None;
            return false;
        };
        if solver.trail.is_open(task.interval.presence) {
            solver.decide_on(task.interval.presence);
            return true;
        }
        let others = dispatching.resources[resource].tasks.iter().filter(|other| other.id != task.id);
        let order = others.filter(|other| is_started(solver, other)).find_map(|other| {
            let is_before = solver.trail.least(other.interval.end) <= start;
            let (first, then) = if is_before { (other.id, task.id) } else { (task.id, other.id) };
            self.order_of_uses(first, then).filter(|&order| solver.trail.is_open(order))
        });
        if let Some(order) = order {
            solver.decide_on(order);
            return true;
        }
        let begins = task.interval.start;
        let is_later = solver.trail.least(begins) < start;
        let option =
            if is_later { Literal::new(begins.lower(), -start) } else { Literal::new(begins.upper(), start) };
        solver.trail.open_level();
        // An open bound can be decided.
        let _ = solver.trail.set(option, Cause::Decision);
        solver.stats.expanded += 1;
        solver.record_start(option, (task.id, self.model.time(start)));
        true
    }
}

impl Dispatching {
    /// The use that starts next.
    fn next(&self, solver: &Solver) -> Option<Candidate> {
        let mut candidates: Vec<Candidate> = Vec::new();
        for (resource, pool) in self.resources.iter().enumerate() {
            let present = pool.tasks.iter().filter(|task| !solver.trail.fails(task.interval.presence));
            let (started, open): (Vec<&Task>, Vec<&Task>) =
                present.partition(|task| is_started(solver, task));
            for &task in open.iter().filter(|task| self.may_start(solver, task)) {
                let start = earliest(solver, task, &started, pool.capacity);
                if start <= solver.trail.most(task.interval.start) {
                    let end = start + task.interval.duration;
                    candidates.push(Candidate { task: *task, resource, start, end });
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

    /// Whether all has started that ends before a use.
    fn may_start(&self, solver: &Solver, task: &Task) -> bool {
        let mut earlier = self.before.get(&task.id).into_iter().flatten();
        earlier.all(|it| solver.trail.fails(it.interval.presence) || is_started(solver, it))
    }
}

fn is_started(solver: &Solver, task: &Task) -> bool {
    let start = task.interval.start;
    solver.trail.holds(task.interval.presence) && solver.trail.least(start) == solver.trail.most(start)
}

/// The earliest start at which a resource has room for a use beside those that have started.
fn earliest(solver: &Solver, task: &Task, started: &[&Task], capacity: i64) -> i64 {
    let times = |task: &&Task| {
        (solver.trail.least(task.interval.start), solver.trail.least(task.interval.end), task.amount)
    };
    let least = solver.trail.least(task.interval.start);
    let placed: Vec<(i64, i64, i64)> = started.iter().map(times).filter(|it| it.1 > least).collect();
    let mut starts: Vec<i64> = placed.iter().map(|it| it.1).chain([least]).collect();
    starts.sort_unstable();
    let has_room = |&start: &i64| {
        let end = start + task.interval.duration.max(1);
        let overlapping = placed.iter().filter(|it| it.0 < end && it.1 > start);
        overlapping.map(|it| it.2).sum::<i64>() + task.amount <= capacity
    };
    starts.into_iter().find(has_room).unwrap_or(least)
}
