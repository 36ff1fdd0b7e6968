//! How low and how high a resource can be at an instant, over all executions: exactly.
//!
//! The events that have come hold with each all that surely comes before it. The set that takes most is a closure of
//! greatest worth (Picard 1976), found by a maximum flow, as for the envelopes of resources (Muscettola 2002).

use std::collections::VecDeque;

use exact::Rational;
use rmpl::program::Change as Changes;
use rmpl::rule::Order;
use tpn::Use;

use super::cases::Case;
use super::cut::{Edge, Times};

/// What a level is to be like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Wanted {
    /// Which of the resources.
    pub(super) resource: usize,
    /// Above the amount; otherwise below.
    pub(super) is_above: bool,
    pub(super) amount: Rational,
    /// Whether the amount itself will do.
    pub(super) may_equal: bool,
    /// Whether it is looked at an instant where something starts or ends, which what starts there does not count at.
    pub(super) is_instant: bool,
}

impl Wanted {
    /// That a resource compares so with an amount.
    pub(super) const fn new(resource: usize, order: Order, amount: Rational, is_instant: bool) -> Self {
        let (is_above, may_equal) = match order {
            Order::Below => (false, false),
            Order::AtMost => (false, true),
            Order::Above => (true, false),
            Order::AtLeast => (true, true),
        };
        Self { resource, is_above, amount, may_equal, is_instant }
    }

    /// Returns how the resource compares with the amount.
    pub(super) const fn order(&self) -> Order {
        match (self.is_above, self.may_equal) {
            (false, false) => Order::Below,
            (false, true) => Order::AtMost,
            (true, false) => Order::Above,
            (true, true) => Order::AtLeast,
        }
    }

    pub(super) const fn negated(self) -> Self {
        Self { is_above: !self.is_above, may_equal: !self.may_equal, ..self }
    }

    /// Returns whether a level is like this.
    pub(super) fn is_met_by(&self, level: Rational) -> bool {
        (self.may_equal && level == self.amount)
            || if self.is_above { level > self.amount } else { level < self.amount }
    }
}

/// A resource as a plan uses it.
#[derive(Clone, Debug)]
pub(super) struct Resource {
    /// Before anything has come.
    pub(super) first: Rational,
    pub(super) changes: Vec<Change>,
}

/// What an event does to a level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Change {
    pub(super) node: tpn::NodeId,
    /// How much more there is from then on, at least and at most.
    pub(super) more: [Rational; 2],
    /// It is the start of something, which comes behind what ends at the same instant.
    pub(super) is_start: bool,
    /// It frees what the change before it in the list has taken.
    pub(super) is_release: bool,
}

impl Change {
    /// Returns what a use does to a level.
    pub(super) fn of_use(used: &Use) -> Vec<Self> {
        if used.amount.is_zero() {
            return Vec::new();
        }
        let change = |node, more, is_start| Self { node, more, is_start, is_release: false };
        if used.change == Changes::Uses {
            let less = used.amount.checked_neg().unwrap_or(Rational::ZERO);
            let release = Self { is_release: true, ..change(used.end, [less; 2], false) };
            return vec![change(used.start, [used.amount; 2], true), release];
        }
        vec![change(used.moment(), used.level_changes(), used.change == Changes::Consumes)]
    }

    pub(super) fn has_come(&self, is_instant: bool) -> Edge {
        Edge::past(self.node, !(is_instant && self.is_start))
    }

    /// The change of the level: the greatest possible one if `is_above`, otherwise the least.
    pub(super) const fn toward(&self, is_above: bool) -> Rational {
        self.more[is_above as usize]
    }

    /// Returns whether it makes the level higher.
    pub(super) fn is_gain(&self) -> bool {
        self.more[1].is_positive()
    }

    /// By how much it changes the level, in whichever direction.
    pub(super) fn size(&self, is_above: bool) -> Option<Rational> {
        let more = self.toward(is_above);
        if more.is_negative() { more.checked_neg() } else { Some(more) }
    }

    /// Returns whether it can have come at an instant of `case`, and whether it can still be to come.
    fn can_come_or_wait(&self, times: &mut Times, case: &Case, is_instant: bool) -> (bool, bool) {
        let past = self.has_come(is_instant);
        let can_come = case.future.iter().all(|&future| times.fits(past, future));
        let can_wait = case.past.iter().all(|&other| times.fits(other, past.negated()));
        (can_come, can_wait)
    }
}

impl Resource {
    /// The level of `case` that is the furthest where `wanted` looks, and which changes have come then; `None` where figures
    /// are too large.
    pub(super) fn furthest(
        &self,
        times: &mut Times,
        case: &Case,
        wanted: &Wanted,
    ) -> Option<(Rational, Vec<bool>)> {
        let mut has_come = vec![false; self.changes.len()];
        let mut free: Vec<usize> = Vec::new();
        let mut can_take = false;
        for (index, change) in self.changes.iter().enumerate() {
            let (can_come, can_wait) = change.can_come_or_wait(times, case, wanted.is_instant);
            // What begins and ends at the instant is not in use at it: it frees only what it has taken.
            if can_come && can_wait && (!change.is_release || can_take) {
                free.push(index);
            } else {
                has_come[index] = can_come && !can_wait;
            }
            if change.is_release && can_come && !can_wait && free.last() == Some(&(index - 1)) {
                free.pop();
                has_come[index - 1] = true;
            }
            can_take = can_come;
        }
        // What leads where `wanted` looks is gained, and the rest is lost.
        let leads = |index: &&usize| self.changes[**index].is_gain() == wanted.is_above;
        let (gains, losses): (Vec<usize>, Vec<usize>) = free.iter().partition(leads);
        let size = |&index: &usize| self.changes[index].size(wanted.is_above);
        let mut flow = Flow {
            gives: gains.iter().map(size).collect::<Option<_>>()?,
            takes: losses.iter().map(size).collect::<Option<_>>()?,
            needs: Vec::with_capacity(gains.len()),
            passed: vec![vec![Rational::ZERO; losses.len()]; gains.len()],
        };
        for &gain in &gains {
            let past = self.changes[gain].has_come(wanted.is_instant);
            let needed = losses.iter().map(|&loss| {
                if self.changes[gain].is_release && loss + 1 == gain {
                    return true;
                }
                let waits = self.changes[loss].has_come(wanted.is_instant).negated();
                !times.fits(past, waits)
            });
            flow.needs.push(needed.collect());
        }
        let (gained, lost) = flow.best()?;
        for (at, index) in gains.iter().enumerate().filter(|(at, _)| gained[*at]) {
            has_come[*index] = gained[at];
        }
        for (at, index) in losses.iter().enumerate().filter(|(at, _)| lost[*at]) {
            has_come[*index] = lost[at];
        }
        Some((self.level(&has_come, wanted.is_above)?, has_come))
    }

    /// The changes that may have come at an instant of `case`, and may be to come.
    pub(super) fn open(&self, times: &mut Times, case: &Case, is_instant: bool) -> Vec<&Change> {
        let changes = self.changes.iter();
        let is_open = |change: &&Change| change.can_come_or_wait(times, case, is_instant) == (true, true);
        changes.filter(is_open).collect()
    }

    /// The greatest or least level once these changes have come.
    fn level(&self, has_come: &[bool], is_max: bool) -> Option<Rational> {
        let counts = |&(index, change): &(usize, &Change)| {
            has_come[index] && (!change.is_release || has_come[index - 1])
        };
        let mut come = self.changes.iter().enumerate().filter(counts);
        come.try_fold(self.first, |level, (_, change)| level.checked_add(change.toward(is_max)))
    }

    /// Returns whether a level once these changes have come is as all of these want it.
    pub(super) fn meets(&self, has_come: &[bool], all: &[Wanted]) -> bool {
        let ends = [false, true].map(|is_max| self.level(has_come, is_max));
        let [Some(least), Some(greatest)] = ends else { return false };
        let mut levels: Vec<Rational> = vec![least, greatest];
        levels.extend(all.iter().map(|it| it.amount).filter(|it| (least..=greatest).contains(it)));
        levels.sort_unstable();
        // What is wanted holds on whole stretches between its amounts.
        let middles = levels
            .windows(2)
            .filter_map(|pair| pair[0].checked_add(pair[1])?.checked_mul(Rational::new(1, 2)?));
        let middles: Vec<Rational> = middles.collect();
        levels.iter().chain(&middles).any(|&level| all.iter().all(|it| it.is_met_by(level)))
    }
}

/// Gains, each of which needs some of the losses.
struct Flow {
    gives: Vec<Rational>,
    takes: Vec<Rational>,
    needs: Vec<Vec<bool>>,
    passed: Vec<Vec<Rational>>,
}

impl Flow {
    /// Returns which gains are worth their losses, and these losses: passes on as much as possible, along shortest
    /// paths.
    fn best(mut self) -> Option<(Vec<bool>, Vec<bool>)> {
        loop {
            let (gains, losses) = (self.gives.len(), self.takes.len());
            let mut via: Vec<Option<usize>> = vec![None; losses];
            let mut back: Vec<Option<usize>> = vec![None; gains];
            let mut is_seen: Vec<bool> = self.gives.iter().map(|left| left.is_positive()).collect();
            let mut open: VecDeque<usize> = (0..gains).filter(|&gain| is_seen[gain]).collect();
            let mut last = None;
            while let Some(gain) = open.pop_front().filter(|_| last.is_none()) {
                let mut reached = (0..losses).filter(|&loss| self.needs[gain][loss]);
                while let Some(loss) = reached.find(|&loss| via[loss].is_none()) {
                    via[loss] = Some(gain);
                    if self.takes[loss].is_positive() {
                        last = Some(loss);
                        break;
                    }
                    for other in 0..gains {
                        if !is_seen[other] && self.passed[other][loss].is_positive() {
                            is_seen[other] = true;
                            back[other] = Some(loss);
                            open.push_back(other);
                        }
                    }
                }
            }
            let Some(last) = last else {
                return Some((is_seen, via.iter().map(Option::is_some).collect()));
            };
            let mut path = Vec::new();
            let mut loss = last;
            let mut amount = self.takes[last];
            let first = loop {
                let gain = via[loss]?;
                path.push((gain, loss));
                match back[gain] {
                    Some(before) => {
                        amount = amount.min(self.passed[gain][before]);
                        loss = before;
                    }
                    None => break gain,
                }
            };
            amount = amount.min(self.gives[first]);
            self.gives[first] = self.gives[first].checked_sub(amount)?;
            self.takes[last] = self.takes[last].checked_sub(amount)?;
            for &(gain, loss) in &path {
                self.passed[gain][loss] = self.passed[gain][loss].checked_add(amount)?;
                if let Some(before) = back[gain] {
                    self.passed[gain][before] = self.passed[gain][before].checked_sub(amount)?;
                }
            }
        }
    }
}
