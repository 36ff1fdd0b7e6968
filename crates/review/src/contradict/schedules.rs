//! Schedules of a plan to try its lines with: the earliest and the latest one, and those in which some events are at the ends
//! of their windows, or anywhere in them.

use std::collections::BTreeSet;

use exact::Time;
use executive::plan_network::{ADDED, PlanNetwork};
use plant::Random;
use stn::INFINITE;
use tpn::{Network, Plan};

/// Makes one schedule after the other.
pub(super) struct Schedules {
    network: PlanNetwork,
    num_nodes: usize,
    chance: Random,
    made: usize,
    /// The ticks of all that were made.
    known: BTreeSet<Vec<i64>>,
}

/// A schedule, if it could be made.
pub(super) enum Made {
    /// The time of each node that the plan selects.
    New(Vec<Option<Time>>),
    /// One that was made before.
    Known,
    /// Times do not fit.
    Overflow,
}

/// Events that one schedule fixes at most.
const MAX_PINS: u64 = 5;

impl Schedules {
    /// `None` where times do not fit.
    pub(super) fn new(network: &Network, plan: &Plan, seed: u64) -> Option<Self> {
        let num_nodes = network.nodes.len();
        let network = PlanNetwork::new(network, plan).ok()?;
        Some(Self { network, num_nodes, chance: Random::new(seed), made: 0, known: BTreeSet::new() })
    }

    /// Makes the next one.
    pub(super) fn make(&mut self) -> Made {
        let Some(ticks) = self.next_ticks() else { return Made::Overflow };
        if self.known.contains(&ticks) {
            return Made::Known;
        }
        let mut times = vec![None; self.num_nodes];
        for point in self.network.all_points() {
            times[self.network.node(point).index()] = Some(self.network.time(ticks[point.index()]));
        }
        self.known.insert(ticks);
        Made::New(times)
    }

    fn next_ticks(&mut self) -> Option<Vec<i64>> {
        let before = self.network.stn.checkpoint();
        let number = self.made;
        self.made += 1;
        if number > 1 {
            for _ in 0..=self.chance.below(MAX_PINS) {
                self.pin()?;
            }
        }
        let (earliest, latest) = self.bounds()?;
        self.network.stn.rollback(before);
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
