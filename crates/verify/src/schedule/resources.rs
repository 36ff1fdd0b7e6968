//! Resources in a schedule (SPEC 11): how much is used at each time at least, and the level after each instant, whatever the
//! order of what happens at it.

use exact::{Bound, Time};

use super::Schedule;
use crate::amounts::{ScaledSupply, Shared, Taken, list};
use crate::{Rule, Violation};

/// What happens to a reusable resource at one time, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Step {
    End,
    /// A use without length: it counts beside what began before and ends after.
    Instant,
    Start,
}

impl Schedule<'_> {
    pub(super) fn check_resources(&self, violations: &mut Vec<Violation>) {
        let Some(all) = Shared::all(self.network, self.plan) else {
            let message =
                "the amounts are too large, or their denominators too different, to be added exactly";
            violations.push(Violation::new(Rule::Form, message));
            return;
        };
        for shared in &all {
            match shared.supply {
                ScaledSupply::Reusable { capacity } => self.check_reusable(shared, capacity, violations),
                ScaledSupply::Reservoir { least, greatest, level } => {
                    self.check_reservoir(shared, [least, greatest, level], violations);
                }
            }
        }
    }

    fn check_reusable(&self, shared: &Shared, capacity: i128, violations: &mut Vec<Violation>) {
        let mut steps: Vec<(Time, Step, Taken)> = Vec::with_capacity(2 * shared.uses.len());
        for &it in &shared.uses {
            let (start, end) = (self.time(it.start), self.time(it.end));
            if start == end {
                steps.push((start, Step::Instant, it));
            } else {
                steps.push((start, Step::Start, it));
                steps.push((end, Step::End, it));
            }
        }
        steps.sort_by_key(|&(time, step, it)| (time, step, it.used));
        let mut running: Vec<Taken> = Vec::new();
        let mut sum: i128 = 0;
        for (time, step, it) in steps {
            let is_alone = running.is_empty();
            match step {
                Step::End => {
                    running.retain(|other| other.used != it.used);
                    sum -= it.amount;
                    continue;
                }
                Step::Instant if is_alone => continue,
                Step::Instant | Step::Start => running.push(it),
            }
            sum += it.amount;
            if sum > capacity {
                let message = format!(
                    "{} use {} at {}: {} of {}",
                    list(self.network, shared, &running),
                    shared.name(self.network),
                    Bound::Finite(time),
                    shared.show(sum),
                    shared.show(capacity)
                );
                violations.push(self.violation_of(message, &running));
            }
            if step == Step::Instant {
                running.pop();
                sum -= it.amount;
            }
        }
    }

    /// The level after each instant, for every amount that drives may take.
    fn check_reservoir(
        &self,
        shared: &Shared,
        [least, greatest, level]: [i128; 3],
        violations: &mut Vec<Violation>,
    ) {
        // The amounts of drives have a minimum and a maximum: the level is between these two.
        let [mut low, mut high] = [level; 2];
        // What conditions on the level ask depends on the order within instants.
        let mut events: Vec<Taken> = shared.uses.iter().filter(|it| it.level.is_none()).copied().collect();
        events.sort_by_key(|it| (self.time(it.moment()), it.used));
        for events in events.chunk_by(|one, other| self.time(one.moment()) == self.time(other.moment())) {
            for it in events {
                let [less, more] = it.changes();
                low += less;
                high += more;
            }
            let (level, wrong) = if low < least {
                (low, format!("below {}", shared.show(least)))
            } else if high > greatest {
                (high, format!("above {}", shared.show(greatest)))
            } else {
                continue;
            };
            let message = format!(
                "{} is at {} after {}, {wrong}: {}",
                shared.name(self.network),
                shared.show(level),
                Bound::Finite(self.time(events[0].moment())),
                list(self.network, shared, events)
            );
            violations.push(self.violation_of(message, events));
        }
    }

    fn violation_of(&self, message: String, uses: &[Taken]) -> Violation {
        let names = uses.iter().map(|it| self.network.use_name(it.used)).collect();
        Violation::new(Rule::Resource, message).with_intervals(names)
    }
}
