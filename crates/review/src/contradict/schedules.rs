//! Schedules of a plan to try its lines with: the earliest and the latest one, those in which an activity takes the least or
//! greatest time that it is declared with, and those in which some events are at the ends of their windows, or anywhere in
//! them.

use std::collections::BTreeSet;

use exact::Bound;
use exact::Time;
use executive::plan_network::{ADDED, PlanNetwork};
use plant::Random;
use smol_str::SmolStr;
use stn::{INFINITE, PointId};
use tpn::{Network, Plan};

use crate::plan_lines::declared_durations;

/// Makes one schedule after the other.
pub(super) struct Schedules {
    network: PlanNetwork,
    num_nodes: usize,
    chance: Random,
    made: usize,
    /// Declared extremes of durations that were not tried yet, the next one last.
    extremes: Vec<Extreme>,
    /// The ticks of all that were made.
    known: BTreeSet<Vec<i64>>,
}

/// The least or greatest declared duration of an activity.
struct Extreme {
    activity: SmolStr,
    ends: [PointId; 2],
    ticks: i64,
}

/// A schedule, if it could be made.
pub(super) enum Made {
    /// The time of each node that the plan selects, and whether an activity has an extreme of its duration for a purpose.
    New { times: Vec<Option<Time>>, is_extreme: bool },
    /// One that was made before, and the same.
    Known { is_extreme: bool },
    /// In no schedule this activity takes so long, although it is declared with that.
    Impossible(SmolStr, Time),
    /// Times do not fit.
    Overflow,
}

/// Events that one schedule fixes at most.
const MAX_PINS: u64 = 5;

impl Schedules {
    /// `None` where times do not fit.
    pub(super) fn new(network: &Network, plan: &Plan, seed: u64) -> Option<Self> {
        let num_nodes = network.nodes.len();
        let points = PlanNetwork::new(network, plan).ok()?;
        let extremes = extremes(network, plan, &points);
        let (chance, known) = (Random::new(seed), BTreeSet::new());
        Some(Self { network: points, num_nodes, chance, made: 0, extremes, known })
    }

    /// Makes the next one.
    pub(super) fn make(&mut self) -> Made {
        let number = self.made;
        self.made += 1;
        let extreme = if number > 1 && number.is_multiple_of(2) { self.extremes.pop() } else { None };
        let before = self.network.stn.checkpoint();
        let ticks = match &extreme {
            Some(Extreme { ends: [start, end], ticks, .. }) => {
                let kept = self.network.stn.constrain(*start, *end, *ticks, Some(*ticks), ADDED).ok();
                kept.and_then(|()| self.bounds()).map(|(earliest, _)| earliest)
            }
            None => self.by_chance(number),
        };
        self.network.stn.rollback(before);
        let Some(ticks) = ticks else {
            let impossible = |it: Extreme| Made::Impossible(it.activity, self.network.time(it.ticks));
            return extreme.map_or(Made::Overflow, impossible);
        };
        let is_extreme = extreme.is_some();
        if self.known.contains(&ticks) {
            return Made::Known { is_extreme };
        }
        let mut times = vec![None; self.num_nodes];
        for point in self.network.all_points() {
            times[self.network.node(point).index()] = Some(self.network.time(ticks[point.index()]));
        }
        self.known.insert(ticks);
        Made::New { times, is_extreme }
    }

    fn by_chance(&mut self, number: usize) -> Option<Vec<i64>> {
        if number > 1 {
            for _ in 0..=self.chance.below(MAX_PINS) {
                self.pin()?;
            }
        }
        let (earliest, latest) = self.bounds()?;
        let has_latest = latest.iter().all(|&ticks| ticks != INFINITE);
        Some(if number % 2 == 1 && has_latest { latest } else { earliest })
    }

    /// The earliest and the latest ticks of each point.
    fn bounds(&mut self) -> Option<(Vec<i64>, Vec<i64>)> {
        let origin = self.network.origin();
        let (mut to, mut from) = (Vec::new(), Vec::new());
        self.network.stn.distances_to(origin, &mut to).ok()?;
        self.network.stn.distances_from(origin, &mut from).ok()?;
        // An event that nothing bounds from below comes no earlier than the start.
        let earliest = to.iter().map(|&ticks| if ticks == INFINITE { 0 } else { -ticks }).collect();
        Some((earliest, from))
    }

    /// Fixes some event at an end of its window, or inside.
    fn pin(&mut self) -> Option<()> {
        let (earliest, latest) = self.bounds()?;
        let at = self.chance.below(earliest.len() as u64) as usize;
        let first = earliest[at];
        let last = match latest[at] {
            // Without an end it may be as late as anything else that has one, and later.
            INFINITE => {
                latest.iter().copied().filter(|&ticks| ticks != INFINITE).max()?.max(first).checked_add(1)?
            }
            last => last,
        };
        let span = last.checked_sub(first)?;
        let ticks = match self.chance.below(3) {
            0 => first,
            1 => last,
            _ => first.checked_add(self.chance.below(span.unsigned_abs().checked_add(1)?) as i64)?,
        };
        let (origin, point) = (self.network.origin(), self.network.all_points().nth(at)?);
        self.network.stn.constrain(origin, point, ticks, Some(ticks), ADDED).ok()
    }
}

/// The least and greatest declared durations of activities, those of the first one in the text last.
fn extremes(network: &Network, plan: &Plan, points: &PlanNetwork) -> Vec<Extreme> {
    let own = declared_durations(network, plan).into_iter().rev().filter_map(|(occurrence, lower, upper)| {
        let ends = [points.point(occurrence.start)?, points.point(occurrence.end)?];
        let greatest = match upper {
            Bound::Finite(upper) if upper > lower => Some(upper),
            _ => None,
        };
        let durations = greatest.into_iter().chain([lower]);
        let ticks = durations.filter_map(move |it| points.scale().ticks(it).ok());
        Some(ticks.map(move |ticks| Extreme { activity: occurrence.name.clone(), ends, ticks }))
    });
    own.flatten().collect()
}
