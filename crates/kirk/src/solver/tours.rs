//! Movements of one vehicle in any order: all of them take at least as long as the quickest way through their places
//! (dynamic programming over sets; Held and Karp 1962).

use typed_index_collections::TiVec;

use super::interval::Interval;
use super::literal::Literal;
use super::premise::Premise;
use super::queue::PropagationQueue;
use super::trail::{Conflict, Trail};
use crate::ids::TourId;

/// Of more movements nothing is said: there would be too many sets of them.
pub(super) const MAX_MOVEMENTS: usize = 15;
/// No way leads there.
const NO_WAY: i64 = i64::MAX / 4;

/// A set of movements, by their positions.
type Set = usize;

#[derive(Clone, Debug)]
struct Tour {
    movements: Vec<Interval>,
    /// The least time from the first start to the last end of each set.
    least: Vec<i64>,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Tours {
    all: TiVec<TourId, Tour>,
    pub(super) queue: PropagationQueue<TourId>,
}

impl Tours {
    /// Adds movements of which no two overlap, with the least duration of each (second) right after each other one (first);
    /// the last row is where the vehicle is at first. `None` where none can be right after the other. Answers the quickest
    /// order of all of them.
    pub(super) fn add(&mut self, movements: Vec<Interval>, durations: &[Vec<Option<i64>>]) -> Vec<usize> {
        let sides = |it: &Interval| [it.start.lower(), it.end.upper(), it.presence.side];
        self.queue.add(movements.iter().flat_map(sides));
        let (least, order) = min_of_sets(movements.len(), durations);
        self.all.push(Tour { movements, least });
        order
    }

    /// Looks at one tour that waits. `false` if none does.
    pub(crate) fn propagate(&mut self, trail: &mut Trail) -> Result<bool, Conflict> {
        let Some(id) = self.queue.pop() else { return Ok(false) };
        let tour = &self.all[id];
        // A tour's durations come from all movements and all ways between them.
        trail.premise = Premise::Unknown;
        let movements = tour.movements.iter().enumerate();
        let (present, open): (Vec<usize>, Vec<usize>) = movements
            .filter(|(_, it)| !trail.fails(it.presence))
            .map(|(at, _)| at)
            .partition(|&at| trail.holds(tour.movements[at].presence));
        let least = |at: &usize| trail.least(tour.movements[*at].start);
        let most = |at: &usize| trail.most(tour.movements[*at].end);
        let mut windows: Vec<(i64, i64, Set)> = Vec::new();
        for begun in different(present.iter().map(least)) {
            for over in different(present.iter().map(most)) {
                let is_within = |at: &&usize| least(at) >= begun && most(at) <= over;
                let set = present.iter().filter(is_within).fold(0, |set, &at| set | 1 << at);
                if set == 0 {
                    continue;
                }
                if tour.is_too_much(set, begun, over) {
                    return Err(tour.reason(set, None, begun, over));
                }
                windows.push((begun, over, set));
            }
        }
        let mut excluded: Vec<(usize, Conflict)> = Vec::new();
        for at in open {
            let wider =
                |&(begun, over, set): &(i64, i64, Set)| (begun.min(least(&at)), over.max(most(&at)), set);
            let broken = windows
                .iter()
                .map(wider)
                .find(|&(begun, over, set)| tour.is_too_much(set | 1 << at, begun, over));
            if let Some((begun, over, set)) = broken {
                excluded.push((at, tour.reason(set, Some(at), begun, over)));
            }
        }
        for (at, reason) in excluded {
            let cause = trail.note(reason);
            trail.set(!self.all[id].movements[at].presence, cause)?;
        }
        Ok(true)
    }
}

impl Tour {
    /// Returns whether a set of movements does not fit between two times.
    fn is_too_much(&self, set: Set, begun: i64, over: i64) -> bool {
        begun.saturating_add(self.least[set]) > over
    }

    /// Returns why a set does not fit between two times, with one more that is not told to exist: as few of them as it
    /// takes.
    fn reason(&self, mut set: Set, more: Option<usize>, begun: i64, over: i64) -> Conflict {
        let all = |set: Set| more.map_or(set, |at| set | 1 << at);
        for at in 0..self.movements.len() {
            let without = set & !(1 << at);
            if without != set && self.is_too_much(all(without), begun, over) {
                set = without;
            }
        }
        let latest = begun.saturating_add(self.least[all(set)]) - 1;
        let mut reason = Vec::new();
        for (at, it) in self.movements.iter().enumerate().filter(|(at, _)| all(set) & 1 << at != 0) {
            reason.push(Literal::new(it.start.lower(), -begun));
            reason.push(Literal::new(it.end.upper(), latest));
            if Some(at) != more {
                reason.push(it.presence);
            }
        }
        reason
    }
}

/// Different numbers, in order.
fn different(numbers: impl Iterator<Item = i64>) -> Vec<i64> {
    let mut numbers: Vec<i64> = numbers.collect();
    numbers.sort_unstable();
    numbers.dedup();
    numbers
}

/// The least time from the first start to the last end of each set of movements, whatever others come before, between and
/// after them; and the order of all that takes least.
fn min_of_sets(count: usize, durations: &[Vec<Option<i64>>]) -> (Vec<i64>, Vec<usize>) {
    let direct = |from: usize, to: usize| durations[from][to].unwrap_or(NO_WAY);
    // Between two there may be others, which take their time.
    let mut between: Vec<Vec<i64>> =
        (0..count).map(|from| (0..count).map(|to| direct(from, to)).collect()).collect();
    for middle in 0..count {
        for from in 0..count {
            for to in 0..count {
                let around = between[from][middle].saturating_add(between[middle][to]).min(NO_WAY);
                between[from][to] = between[from][to].min(around);
            }
        }
    }
    // By set and first movement: from the end of that one on.
    let mut rests = vec![NO_WAY; count << count];
    let mut least = vec![0; 1 << count];
    for set in 1..1_usize << count {
        let members = || (0..count).filter(|at| set & 1 << at != 0);
        let mut shortest = NO_WAY;
        for first in members() {
            let others = set & !(1 << first);
            let then = members().filter(|&at| at != first);
            let rest = then.map(|at| between[first][at].saturating_add(rests[others * count + at])).min();
            let rest = if others == 0 { 0 } else { rest.unwrap_or(NO_WAY).min(NO_WAY) };
            rests[set * count + first] = rest;
            // What comes right before the first of them is none of them.
            let before =
                (0..=count).filter(|from| set & 1 << from == 0).map(|from| direct(from, first)).min();
            shortest = shortest.min(before.unwrap_or(NO_WAY).saturating_add(rest));
        }
        least[set] = shortest;
    }
    let mut order: Vec<usize> = Vec::with_capacity(count);
    let mut left = (1 << count) - 1;
    while left != 0 {
        let from = order.last().copied();
        let time = |at: usize| {
            let to = from.map_or_else(|| direct(count, at), |from| between[from][at]);
            to.saturating_add(rests[left * count + at])
        };
        let Some(next) = (0..count).filter(|at| left & (1 << at) != 0).min_by_key(|&at| time(at)) else {
            break;
        };
        order.push(next);
        left &= !(1 << next);
    }
    (least, order)
}

#[cfg(test)]
mod tests {
    use super::{NO_WAY, min_of_sets};

    #[test]
    fn a_set_takes_its_quickest_order() {
        // On a line at 1, 5 and 9; the vehicle is at 0.
        let places = [1_i64, 5, 9, 0];
        let durations: Vec<Vec<Option<i64>>> = (0..4)
            .map(|from| (0..3).map(|to| (from != to).then(|| (places[from] - places[to]).abs())).collect())
            .collect();
        let (least, order) = min_of_sets(3, &durations);
        assert_eq!((least[0b111], order), (9, vec![0, 1, 2]));
        // The first of two may start where the third one ends.
        assert_eq!(least[0b110], 4 + 4);
        assert_eq!(least[0b001], 1);
    }

    #[test]
    fn others_in_between_make_ways_and_cannot_make_them_longer() {
        let durations = vec![
            vec![None, Some(9), Some(2)],
            vec![Some(9), None, Some(3)],
            vec![Some(2), Some(3), None],
            vec![Some(1); 3],
        ];
        let (least, _) = min_of_sets(3, &durations);
        assert_eq!(least[0b011], 1 + 2 + 3);
        let stuck = vec![vec![None; 3]; 4];
        assert_eq!(min_of_sets(3, &stuck).0[0b111], NO_WAY);
    }
}
