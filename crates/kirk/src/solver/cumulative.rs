//! Resources that several tasks share at a time: what is surely taken leaves too little for others, and work that does not
//! fit between two times (time-tabling and overload checking; Aggoun and Beldiceanu 1993, explained as by Schutt and others
//! 2011).
//!
//! Only tasks that exist for sure count. Everything is told for one direction of time and done for both.

use std::collections::BTreeMap;

use typed_index_collections::TiVec;

use super::interval::Interval;
use super::literal::{Literal, Side};
use super::premise::Premise;
use super::queue::PropagationQueue;
use super::trail::{Conflict, Trail};
use crate::ids::CumulativeId;

/// Larger sets are left to the orders of those that are too much together.
const MAX_TASKS: usize = 4_000;

/// The work of more tasks is only added up before anything is decided: each end is compared with each task.
const MANY_TASKS: usize = 500;

#[derive(Clone, Debug)]
struct Shared {
    capacity: i64,
    tasks: Vec<(Interval, i64)>,
    premise: Premise,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Cumulatives {
    all: TiVec<CumulativeId, Shared>,
    pub(super) queue: PropagationQueue<CumulativeId>,
    /// Room for what counts at the moment.
    present: Vec<Task>,
    profile: Vec<Segment>,
}

/// A task seen along one direction of time.
#[derive(Clone, Copy, Debug)]
struct Task {
    /// It starts no earlier than the negated bound of this side, and no later than the bound of the next one.
    starts_after: Side,
    starts_by: Side,
    ends_after: Side,
    ends_by: Side,
    earliest_start: i64,
    latest_start: i64,
    earliest_end: i64,
    latest_end: i64,
    duration: i64,
    amount: i64,
    presence: Literal,
}

/// What is surely taken from one time to another.
#[derive(Clone, Copy, Debug)]
struct Segment {
    from: i64,
    to: i64,
    taken: i64,
}

impl Task {
    fn new(trail: &Trail, task: &Interval, amount: i64, is_forward: bool) -> Self {
        let (start, end) = (task.start, task.end);
        let (starts, ends) = if is_forward {
            ((start.lower(), start.upper()), (end.lower(), end.upper()))
        } else {
            ((end.upper(), end.lower()), (start.upper(), start.lower()))
        };
        Self {
            starts_after: starts.0,
            starts_by: starts.1,
            ends_after: ends.0,
            ends_by: ends.1,
            earliest_start: -trail.bound(starts.0),
            latest_start: trail.bound(starts.1),
            earliest_end: -trail.bound(ends.0),
            latest_end: trail.bound(ends.1),
            duration: task.duration,
            amount,
            presence: task.presence,
        }
    }

    /// Returns whether it continues at a time, whenever it starts and ends.
    const fn is_on(&self, time: i64) -> bool {
        self.latest_start <= time && time < self.earliest_end
    }

    /// That it continues at a time.
    fn reason_on(&self, time: i64) -> [Literal; 3] {
        let ends = Literal::new(self.ends_after, -(time + 1));
        [Literal::new(self.starts_by, time), ends, self.presence]
    }
}

impl Cumulatives {
    /// Adds tasks with what each takes; together never more than `capacity`.
    pub(super) fn add(&mut self, capacity: i64, tasks: Vec<(Interval, i64)>, premise: Premise) {
        if tasks.len() < 2 || tasks.len() > MAX_TASKS {
            return;
        }
        let sides = |(task, _): &(Interval, i64)| {
            let times = [task.start, task.end].map(|time| [time.lower(), time.upper()]);
            times.into_iter().flatten().chain([task.presence.side])
        };
        self.queue.add(tasks.iter().flat_map(sides));
        self.all.push(Shared { capacity, tasks, premise });
    }

    /// Looks at one resource that waits. `false` if none does.
    pub(crate) fn propagate(&mut self, trail: &mut Trail) -> Result<bool, Conflict> {
        let Some(id) = self.queue.pop() else { return Ok(false) };
        let Shared { capacity, tasks, premise } = &self.all[id];
        trail.premise = *premise;
        for is_forward in [true, false] {
            self.present.clear();
            let present = tasks.iter().filter(|(task, _)| trail.holds(task.presence));
            self.present.extend(present.map(|(task, amount)| Task::new(trail, task, *amount, is_forward)));
            if is_forward {
                self.present.sort_by_key(|task| std::cmp::Reverse(task.earliest_start));
                let is_root = trail.level() == 0;
                if is_root || self.present.len() <= MANY_TASKS {
                    check_work(&self.present, *capacity, is_root)?;
                }
            }
            find_profile(&self.present, &mut self.profile);
            let mut sure = Sure::new(&self.present);
            if let Some(over) = self.profile.iter().find(|segment| segment.taken > *capacity) {
                return Err(sure.reason(over.from, *capacity, None));
            }
            for task in &self.present {
                push(trail, task, &mut sure, &self.profile, *capacity)?;
            }
        }
        Ok(true)
    }
}

/// What tasks that continue for sure take, over time.
fn find_profile(tasks: &[Task], profile: &mut Vec<Segment>) {
    let sure = tasks.iter().filter(|task| task.latest_start < task.earliest_end);
    let mut changes: Vec<(i64, i64)> =
        sure.flat_map(|task| [(task.latest_start, task.amount), (task.earliest_end, -task.amount)]).collect();
    changes.sort_unstable();
    profile.clear();
    let mut taken = 0;
    for (index, &(time, change)) in changes.iter().enumerate() {
        taken += change;
        if let Some(&(next, _)) = changes.get(index + 1).filter(|(next, _)| *next > time)
            && taken > 0
        {
            profile.push(Segment { from: time, to: next, taken });
        }
    }
}

/// A task starts when what is surely taken, and leaves too little for it, is over.
fn push(
    trail: &mut Trail,
    task: &Task,
    sure: &mut Sure<'_>,
    profile: &[Segment],
    capacity: i64,
) -> Result<(), Conflict> {
    let first = profile.partition_point(|segment| segment.to <= task.earliest_start);
    let in_its_way = profile[first..].iter().take_while(|segment| segment.from < task.earliest_end);
    let leaves_too_little = |segment: &&Segment| {
        let own = if task.is_on(segment.from) { task.amount } else { 0 };
        segment.taken - own + task.amount > capacity
    };
    let Some(segment) = in_its_way.filter(leaves_too_little).last() else { return Ok(()) };
    let time = segment.to.min(task.earliest_end) - 1;
    if time < task.earliest_start || task.is_on(time) {
        return Ok(());
    }
    let mut reason = sure.reason(time, capacity - task.amount, Some(task));
    reason.extend([Literal::new(task.ends_after, -(time + 1)), task.presence]);
    reason.retain(|literal| *literal != Literal::TRUE);
    let cause = trail.note(reason);
    trail.set(Literal::new(task.starts_after, -(time + 1)), cause)
}

/// The tasks that go on at some time whenever they start and end.
struct Sure<'a> {
    tasks: Vec<&'a Task>,
    /// Those at one time, the largest first, of the times that were asked for.
    at: BTreeMap<i64, Vec<&'a Task>>,
}

impl<'a> Sure<'a> {
    fn new(tasks: &'a [Task]) -> Self {
        let tasks = tasks.iter().filter(|task| task.latest_start < task.earliest_end).collect();
        Self { tasks, at: BTreeMap::new() }
    }

    /// That tasks continue at a time which together take more than `room`: as few as suffice.
    fn reason(&mut self, time: i64, room: i64, besides: Option<&Task>) -> Conflict {
        let on = self.at.entry(time).or_insert_with(|| {
            let mut on: Vec<&Task> = self.tasks.iter().copied().filter(|task| task.is_on(time)).collect();
            on.sort_by_key(|task| (std::cmp::Reverse(task.amount), task.starts_after));
            on
        });
        let mut taken = 0;
        let mut reason = Vec::new();
        // Not by its start: branches of one block begin at one event.
        for task in on.iter().filter(|task| besides.is_none_or(|besides| !std::ptr::eq(besides, **task))) {
            if taken > room {
                break;
            }
            taken += task.amount;
            reason.extend(task.reason_on(time));
        }
        reason.retain(|literal| *literal != Literal::TRUE);
        reason
    }
}

/// Whether tasks that lie between two times are more work than fits there: as they are, and as what goes with none of a
/// least amount counts for all there is, where smaller ones count for nothing (dual feasible functions; Carlier, Clautiaux
/// and Moukrim 2007). Tasks come latest first.
fn check_work(tasks: &[Task], capacity: i64, is_thorough: bool) -> Result<(), Conflict> {
    let mut thresholds = vec![0];
    if is_thorough {
        thresholds.extend(tasks.iter().map(|task| task.amount).filter(|amount| amount * 2 <= capacity));
        // Of two that exclude each other either counts for all.
        thresholds.push(capacity / 2 + 1);
        thresholds.sort_unstable();
        thresholds.dedup();
    }
    // What begins and ends when, and how much work it is.
    let mut counting: Vec<(i64, i64, i64)> = Vec::with_capacity(tasks.len());
    let mut limits: Vec<i64> = Vec::with_capacity(tasks.len());
    for threshold in thresholds {
        let counted = |task: &Task| {
            let amount = match task.amount {
                amount if amount < threshold => 0,
                amount if amount > capacity - threshold => capacity,
                amount => amount,
            };
            task.duration.saturating_mul(amount)
        };
        let work = tasks.iter().map(|task| (task.earliest_start, task.latest_end, counted(task)));
        counting.clear();
        counting.extend(work.filter(|&(_, _, work)| work > 0));
        limits.clear();
        limits.extend(counting.iter().map(|&(_, end, _)| end));
        limits.sort_unstable();
        limits.dedup();
        for &limit in &limits {
            let mut sum = 0_i64;
            for &(from, _, work) in counting.iter().filter(|&&(_, end, _)| end <= limit) {
                sum = sum.saturating_add(work);
                let room = capacity.saturating_mul(limit - from);
                if sum > room {
                    return Err(too_much(tasks, (from, limit), sum - room, counted));
                }
            }
        }
    }
    Ok(())
}

/// That tasks lie between two times, less those that are not needed for what is too much.
fn too_much(
    tasks: &[Task],
    (from, limit): (i64, i64),
    mut excess: i64,
    counted: impl Fn(&Task) -> i64,
) -> Conflict {
    let lies_between =
        |task: &&Task| task.earliest_start >= from && task.latest_end <= limit && counted(task) > 0;
    let mut between: Vec<&Task> = tasks.iter().filter(lies_between).collect();
    between.sort_by_key(|task| (counted(task), task.starts_after));
    between.retain(|task| {
        let is_needed = counted(task) >= excess;
        if !is_needed {
            excess -= counted(task);
        }
        is_needed
    });
    let mut reason: Conflict = between
        .into_iter()
        .flat_map(|task| {
            [Literal::new(task.starts_after, -from), Literal::new(task.ends_by, limit), task.presence]
        })
        .collect();
    reason.retain(|literal| *literal != Literal::TRUE);
    reason
}
