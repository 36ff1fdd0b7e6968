//! Whether two stretches of movements can be under way at once in some schedule of a plan, and a schedule in which they are.
//!
//! What two events have between them in all schedules are the distances of the plan's temporal network. Once these are known,
//! a time within them for some events can always be extended to a schedule (Dechter, Meiri and Pearl 1991), so the few events
//! of two movements are all that is looked at. A driver keeps an even pace over its traverse and may be early, never late: it
//! is at a share of its way no earlier than that share of the least duration after the start, and no later than that share of
//! the time between start and end.

use std::collections::{BTreeMap, BTreeSet};

use exact::Bound;
use review::distances::Distances;
use tpn::{Network, NodeId, Plan};

/// When a vehicle is on a stretch of its way, or stands somewhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    /// It is there at the earliest so long after this event, in mission units.
    pub(super) from: NodeId,
    pub(super) after: f64,
    /// It is there at the latest at this share of the time between two events.
    pub(super) until: [NodeId; 2],
    pub(super) share: f64,
}

/// The times of some events in one schedule, in mission units.
pub(super) type Times = BTreeMap<NodeId, f64>;

/// How long it is at least between any two of some events in all schedules.
pub(super) struct Gaps {
    start: NodeId,
    least: BTreeMap<(NodeId, NodeId), f64>,
}

/// Where nothing bounds an event from above, schedules are looked at in which it comes at most so much later than it could.
const LONG: f64 = 1e5;
/// Rounding of times in mission units.
const TOLERANCE: f64 = 1e-6;

impl Gaps {
    /// Between the events of a plan that are in one of `sets`, and between these and the start of the plan; `None` where times do not
    /// fit, which planning would already have said.
    pub(super) fn new(
        network: &Network,
        plan: &Plan,
        sets: impl Iterator<Item = Vec<NodeId>>,
    ) -> Option<Self> {
        let mut distances = Distances::new(network, plan)?;
        let mut pairs: BTreeSet<(NodeId, NodeId)> = BTreeSet::new();
        for mut events in sets {
            events.push(network.start);
            let of_one = |&one: &NodeId| events.iter().map(move |&other| (one, other));
            pairs.extend(events.iter().flat_map(of_one).filter(|(one, other)| one < other));
        }
        let pairs: Vec<(NodeId, NodeId)> = pairs.into_iter().collect();
        let ranges = distances.between(&pairs);
        let mut least: BTreeMap<(NodeId, NodeId), f64> = BTreeMap::new();
        for (&(one, other), range) in pairs.iter().zip(&ranges) {
            let Some(range) = range else { continue };
            least.insert((one, other), range.least.to_f64());
            if let Bound::Finite(greatest) = range.greatest {
                least.insert((other, one), -greatest.to_f64());
            }
        }
        Some(Self { start: network.start, least })
    }

    /// Returns how much later the second event is than the first at least.
    fn least(&self, first: NodeId, then: NodeId) -> f64 {
        if first == then { 0.0 } else { self.least.get(&(first, then)).copied().unwrap_or(f64::NEG_INFINITY) }
    }

    /// Returns whether one stretch is over before the other one begins, whatever the schedule. `false` proves nothing.
    pub(super) fn is_before(&self, first: &Stretch, then: &Stretch) -> bool {
        let [start, end] = first.until;
        let weighted = |share: f64, event: NodeId| {
            if share > 0.0 { share * self.least(event, then.from) } else { 0.0 }
        };
        weighted(1.0 - first.share, start) + weighted(first.share, end) + then.after >= -TOLERANCE
    }

    /// A schedule in which both are under way at once, and when; `None` if there is none.
    ///
    /// Two stretches are at once in some schedule just if they are in one between two corners of all schedules, and those
    /// are found by giving each event its earliest or latest time after the ones before it, in every order.
    pub(super) fn meeting(&self, one: &Stretch, other: &Stretch) -> Option<(Times, f64)> {
        let mut events: Vec<NodeId> =
            [one, other].iter().flat_map(|it| [it.from, it.until[0], it.until[1]]).collect();
        events.sort_unstable();
        events.dedup();
        events.retain(|&event| event != self.start);
        let mut corners: Vec<(Times, [f64; 2])> = Vec::new();
        for order in orders(&events) {
            for sides in 0..1_u32 << order.len() {
                let times = self.corner(&order, sides);
                // How long before the end of each the other one begins.
                let room = [
                    leaves(one, &times) - arrives(other, &times),
                    leaves(other, &times) - arrives(one, &times),
                ];
                if room.iter().all(|&room| room >= 0.0) {
                    return Some(at_once(one, other, times));
                }
                corners.push((times, room));
            }
        }
        // Between two corners, one on each side, where both have as much room: the most of it is on some edge.
        let with_room = |side: usize| corners.iter().filter(move |(_, room)| room[side] >= 0.0);
        let mixed = with_room(0).flat_map(|early| with_room(1).map(move |late| (early, late)));
        let most = mixed.map(|((early, [a, b]), (late, [c, d]))| {
            let part = (a - b) / ((a - b) - (c - d));
            (a + (c - a) * part, part, early, late)
        });
        let (room, part, early, late) = most.max_by(|one, other| one.0.total_cmp(&other.0))?;
        let between = |(&event, &time): (&NodeId, &f64)| (event, time + (late[&event] - time) * part);
        (room >= -TOLERANCE).then(|| at_once(one, other, early.iter().map(between).collect()))
    }

    /// The schedule in which each event comes as early or as late as those before it in `order` leave it.
    fn corner(&self, order: &[NodeId], sides: u32) -> Times {
        let mut times = Times::from([(self.start, 0.0)]);
        for (index, &event) in order.iter().enumerate() {
            let earliest = times.iter().map(|(&before, time)| time + self.least(before, event));
            let earliest = earliest.fold(f64::NEG_INFINITY, f64::max);
            let latest = times.iter().map(|(&before, time)| time - self.least(event, before));
            let latest = latest.fold(earliest.max(0.0) + LONG, f64::min);
            times.insert(event, if (sides >> index) & 1 == 0 { earliest } else { latest });
        }
        times
    }
}

fn arrives(stretch: &Stretch, times: &Times) -> f64 {
    times.get(&stretch.from).copied().unwrap_or_default() + stretch.after
}

fn leaves(stretch: &Stretch, times: &Times) -> f64 {
    let [start, end] = stretch.until.map(|event| times.get(&event).copied().unwrap_or_default());
    start + (end - start) * stretch.share
}

/// A schedule with the middle of the time in which both are under way.
fn at_once(one: &Stretch, other: &Stretch, times: Times) -> (Times, f64) {
    let since = arrives(one, &times).max(arrives(other, &times));
    let until = leaves(one, &times).min(leaves(other, &times));
    (times, 0.5 * (since + until))
}

/// All orders of some events.
fn orders(events: &[NodeId]) -> Vec<Vec<NodeId>> {
    let Some((&first, rest)) = events.split_first() else { return vec![Vec::new()] };
    let with_first = |order: Vec<NodeId>| {
        (0..=order.len()).map(move |at| {
            let mut order = order.clone();
            order.insert(at, first);
            order
        })
    };
    orders(rest).into_iter().flat_map(with_first).collect()
}

#[cfg(test)]
mod tests {
    use terrain::Random;

    use super::*;

    /// Bounds on some events that leave room around one schedule, and follow from each other.
    fn gaps(random: &mut Random, events: usize) -> Gaps {
        let own: Vec<f64> = (0..events).map(|_| random.range(0.0, 10.0).round()).collect();
        let mut least = vec![vec![0.0; events]; events];
        for (one, row) in least.iter_mut().enumerate() {
            for (other, least) in row.iter_mut().enumerate().filter(|(other, _)| *other != one) {
                *least = own[other] - own[one] - random.range(0.0, 6.0).round();
            }
        }
        for middle in 0..events {
            for one in 0..events {
                for other in 0..events {
                    let by_way = least[one][middle] + least[middle][other];
                    least[one][other] = least[one][other].max(by_way);
                }
            }
        }
        let node = NodeId::from_index;
        let pairs = (0..events).flat_map(|one| (0..events).map(move |other| (one, other)));
        let least = pairs.map(|(one, other)| ((node(one), node(other)), least[one][other])).collect();
        Gaps { start: node(0), least }
    }

    /// A schedule by chance: each event at some time that those before it leave it.
    fn schedule(gaps: &Gaps, random: &mut Random, events: usize) -> Times {
        let mut order: Vec<NodeId> = (1..events).map(NodeId::from_index).collect();
        for at in (1..order.len()).rev() {
            order.swap(at, random.below(at as u32 + 1) as usize);
        }
        let mut times = Times::from([(gaps.start, 0.0)]);
        for event in order {
            let earliest = times.iter().map(|(&before, time)| time + gaps.least(before, event));
            let latest = times.iter().map(|(&before, time)| time - gaps.least(event, before));
            let range = [earliest.fold(f64::NEG_INFINITY, f64::max), latest.fold(f64::INFINITY, f64::min)];
            times.insert(event, range[0] + (range[1] - range[0]) * random.range(0.0, 1.0));
        }
        times
    }

    #[test]
    fn stretches_that_are_at_once_in_some_schedule_are_found_and_no_others() {
        let mut random = Random::from_seed(1);
        let (mut found, mut proven) = (0, 0);
        for _ in 0..400 {
            let gaps = gaps(&mut random, 5);
            let mut stretch = |[from, end]: [usize; 2]| {
                let [from, end] = [from, end].map(NodeId::from_index);
                let share = random.range(0.0, 1.0);
                Stretch { from, after: random.range(0.0, 3.0), until: [from, end], share }
            };
            let (one, other) = (stretch([1, 2]), stretch([3, 4]));
            let is_at_once = |times: &Times| {
                leaves(&one, times) - arrives(&other, times) > 1e-9
                    && leaves(&other, times) - arrives(&one, times) > 1e-9
            };
            let some = (0..300).map(|_| schedule(&gaps, &mut random, 5)).find(|times| is_at_once(times));
            if let Some((times, _)) = gaps.meeting(&one, &other) {
                let is_kept = |(&(first, then), least): (&(NodeId, NodeId), &f64)| {
                    times[&then] - times[&first] >= least - 1e-6
                };
                assert!(gaps.least.iter().all(is_kept), "{times:?}");
                assert!(leaves(&one, &times) - arrives(&other, &times) >= -1e-5, "{times:?}");
                assert!(leaves(&other, &times) - arrives(&one, &times) >= -1e-5, "{times:?}");
                found += 1;
            } else {
                assert_eq!(some, None, "{one:?} {other:?} {:?}", gaps.least);
                proven += 1;
            }
        }
        assert!(found > 50 && proven > 50, "{found} found, {proven} proven to be apart");
    }
}
