//! Schedules of a plan to try its lines with: the earliest and the latest one, and those in which some events are at the ends
//! of their windows, or anywhere in them.

use exact::Time;
use executive::plan_network::{ADDED, PlanNetwork};
use stn::INFINITE;
use tpn::{Network, Plan};

/// Makes one schedule after the other.
pub(super) struct Schedules {
    network: PlanNetwork,
    num_nodes: usize,
    chance: Chance,
    made: usize,
}

/// Events that one schedule fixes at most.
const MAX_PINS: u64 = 5;

impl Schedules {
    /// `None` where times do not fit.
    pub(super) fn new(network: &Network, plan: &Plan, seed: u64) -> Option<Self> {
        let num_nodes = network.nodes.len();
        let network = PlanNetwork::new(network, plan).ok()?;
        Some(Self { network, num_nodes, chance: Chance(seed), made: 0 })
    }

    /// The time of each node that the plan selects; `None` where times do not fit.
    pub(super) fn next(&mut self) -> Option<Vec<Option<Time>>> {
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
        let ticks = if number % 2 == 1 && has_latest { latest } else { earliest };
        let mut times = vec![None; self.num_nodes];
        for point in self.network.all_points() {
            times[self.network.node(point).index()] = Some(self.network.time(ticks[point.index()]));
        }
        Some(times)
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

/// Numbers that look like chance (`SplitMix64`, Steele, Lea and Flood 2014).
struct Chance(u64);

impl Chance {
    /// Below `count`, which is not 0.
    fn below(&mut self, count: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (mixed ^ (mixed >> 31)) % count
    }
}
