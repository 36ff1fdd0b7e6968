//! Sets of intervals that exclude each other: too many of them in too little time, and which must come last or first
//! (overload checking and edge finding; Carlier and Pinson 1989, Vilím 2004).
//!
//! Only intervals that exist for sure count. Everything is told for one direction of time and done for both.

use typed_index_collections::TiVec;

use super::interval::Interval;
use super::literal::{Literal, Side};
use super::premise::Premise;
use super::queue::PropagationQueue;
use super::trail::{Conflict, Trail};
use crate::ids::ExclusionId;

/// In larger sets only overloads are looked for.
const MAX_EDGE_FINDING: usize = 24;
/// Larger sets are left to the pairs.
pub(super) const MAX_TASKS: usize = 200;

#[derive(Clone, Debug)]
struct Exclusion {
    tasks: Vec<Interval>,
    /// The least time between one and the next, where `when` holds.
    gap: i64,
    when: Literal,
    premise: Premise,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Disjunctives {
    sets: TiVec<ExclusionId, Exclusion>,
    pub(super) queue: PropagationQueue<ExclusionId>,
    /// Room for the tasks that count at the moment.
    present: Vec<Task>,
}

/// A task seen along one direction of time.
#[derive(Clone, Copy, Debug)]
struct Task {
    /// It starts no earlier than the negated bound of this side.
    start: Side,
    /// It ends no later than the bound of this side.
    end: Side,
    earliest: i64,
    latest: i64,
    duration: i64,
    presence: Literal,
}

/// The least time between one task and the next, and what makes it due.
#[derive(Clone, Copy, Debug)]
struct Gap {
    gap: i64,
    when: Literal,
}

impl Disjunctives {
    /// Adds a set of intervals of which no two overlap, `gap` between each two where `when` holds.
    pub(crate) fn add_apart(&mut self, tasks: Vec<Interval>, (gap, when): (i64, Literal), premise: Premise) {
        self.add_set(Exclusion { tasks, gap, when, premise });
    }

    /// Adds a set of intervals of which no two overlap.
    pub(crate) fn add_tasks(&mut self, mut tasks: Vec<Interval>, premise: Premise) {
        tasks.retain(|task| task.duration > 0);
        if tasks.len() > 2 && tasks.len() <= MAX_TASKS {
            self.add_set(Exclusion { tasks, gap: 0, when: Literal::TRUE, premise });
        }
    }

    fn add_set(&mut self, set: Exclusion) {
        let sides = |task: &Interval| [task.start.lower(), task.end.upper(), task.presence.side];
        self.queue.add(set.tasks.iter().flat_map(sides).chain([set.when.side]));
        self.sets.push(set);
    }

    /// Looks at one set that waits. `false` if none does.
    pub(crate) fn propagate(&mut self, trail: &mut Trail) -> Result<bool, Conflict> {
        let Some(id) = self.queue.pop() else { return Ok(false) };
        let set = &self.sets[id];
        trail.premise = set.premise;
        let gap = if trail.holds(set.when) { set.gap } else { 0 };
        let gap = Gap { gap, when: if gap > 0 { set.when } else { Literal::TRUE } };
        for is_forward in [true, false] {
            self.present.clear();
            for task in set.tasks.iter().filter(|task| trail.holds(task.presence)) {
                let (start, end) = if is_forward {
                    (task.start.lower(), task.end.upper())
                } else {
                    (task.end.upper(), task.start.lower())
                };
                self.present.push(Task {
                    start,
                    end,
                    earliest: -trail.bound(start),
                    latest: trail.bound(end),
                    duration: task.duration,
                    presence: task.presence,
                });
            }
            self.present.sort_by_key(|task| std::cmp::Reverse(task.earliest));
            if is_forward {
                check_load(&self.present, gap)?;
            }
            if self.present.len() <= MAX_EDGE_FINDING {
                find_last(trail, &self.present, gap)?;
            }
        }
        Ok(true)
    }
}

/// Whether tasks between two times need more than there is between them. Tasks come latest first.
fn check_load(tasks: &[Task], Gap { gap, when }: Gap) -> Result<(), Conflict> {
    for limit in tasks.iter().map(|task| task.latest) {
        let mut needed = -gap;
        for task in tasks {
            if task.latest > limit {
                continue;
            }
            needed += task.duration + gap;
            if task.earliest + needed > limit {
                return Err(within(tasks, task.earliest, limit, when));
            }
        }
    }
    Ok(())
}

/// Tasks that must come after all of some others start when these can be over. Tasks come latest first.
fn find_last(trail: &mut Trail, tasks: &[Task], Gap { gap, when }: Gap) -> Result<(), Conflict> {
    for limit in tasks.iter().map(|task| task.latest) {
        if !is_tight(tasks, limit, gap) {
            continue;
        }
        for last in tasks.iter().filter(|task| task.latest > limit) {
            let (mut needed, mut over, mut over_from) = (0, i64::MIN, 0);
            let mut found = None;
            for task in tasks.iter().filter(|task| task.latest <= limit) {
                needed += task.duration + gap;
                if task.earliest + needed > over {
                    (over, over_from) = (task.earliest + needed, task.earliest);
                }
                let begin = task.earliest.min(last.earliest);
                if begin + needed + last.duration > limit {
                    found = Some((task.earliest, begin, over, over_from));
                    break;
                }
            }
            if let Some((from, begin, over, over_from)) = found
                && over > last.earliest
            {
                let mut reason = within(tasks, from, limit, when);
                reason.extend(within(tasks, over_from, limit, Literal::TRUE));
                reason.push(Literal::new(last.start, -begin));
                reason.push(last.presence);
                reason.retain(|literal| *literal != Literal::TRUE);
                let cause = trail.note(reason);
                trail.set(Literal::new(last.start, -over), cause)?;
            }
        }
    }
    Ok(())
}

/// Returns whether the tasks that end by a time leave less room than the longest other one needs: otherwise none must
/// come last.
fn is_tight(tasks: &[Task], limit: i64, gap: i64) -> bool {
    let (mut needed, mut over, mut longest) = (0, i64::MIN, i64::MIN);
    for task in tasks {
        if task.latest <= limit {
            needed += task.duration + gap;
            over = over.max(task.earliest + needed);
        } else {
            longest = longest.max(task.duration);
        }
    }
    longest != i64::MIN && over + longest > limit
}

/// That all tasks that lie between two times do, and the gap between them is due.
fn within(tasks: &[Task], from: i64, limit: i64, when: Literal) -> Conflict {
    let mut reason = vec![when];
    for task in tasks.iter().filter(|task| task.earliest >= from && task.latest <= limit) {
        reason.push(Literal::new(task.start, -from));
        reason.push(Literal::new(task.end, limit));
        reason.push(task.presence);
    }
    reason.retain(|literal| *literal != Literal::TRUE);
    reason
}
