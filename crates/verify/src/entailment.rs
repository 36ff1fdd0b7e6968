//! What all schedules of a plan keep: exact windows, distances, and which events and intervals happen before which.

use tpn::NodeId;

use crate::distance::Distances;
use crate::instant::InstantOrder;

/// The closed temporal network of a plan.
pub(crate) struct Entailment {
    distances: Distances,
    order: InstantOrder,
    /// Per node: the latest time after the start, if bounded.
    pub(crate) latest: Vec<Option<i128>>,
    /// Per node: the earliest time after the start, if bounded.
    pub(crate) earliest: Vec<Option<i128>>,
}

impl Entailment {
    pub(crate) fn new(distances: Distances, order: InstantOrder, start: NodeId) -> Self {
        let latest = distances.row(start.0);
        let earliest = distances.column(start.0).into_iter().map(|distance| distance.map(|to| -to)).collect();
        Self { distances, order, latest, earliest }
    }

    /// Returns whether `later − earlier ≥ least` in every schedule.
    pub(crate) fn is_at_least(&self, earlier: NodeId, later: NodeId, least: i128) -> bool {
        if let (Some(at_least), Some(at_most)) = (self.earliest[later.index()], self.latest[earlier.index()])
            && at_least - at_most >= least
        {
            return true;
        }
        self.distances.between(later.0, earlier.0).is_some_and(|distance| distance <= -least)
    }

    /// Returns whether one event happens before another in the plan (SPEC 10.4).
    pub(crate) fn happens_before(&self, earlier: NodeId, later: NodeId) -> bool {
        self.order.is_before(earlier, later).unwrap_or_else(|| self.is_at_least(earlier, later, 0))
    }

    /// Returns whether one event happens before another, if the windows and the order of their instant alone tell.
    fn is_before_by_windows(&self, earlier: NodeId, later: NodeId) -> Option<bool> {
        if let Some(is_before) = self.order.is_before(earlier, later) {
            return Some(is_before);
        }
        let (one, other) = (earlier.index(), later.index());
        if let (Some(at_least), Some(at_most)) = (self.earliest[other], self.latest[one])
            && at_least >= at_most
        {
            return Some(true);
        }
        // Some schedule has `later` at its earliest time, and some has `earlier` at its latest.
        let is_refuted_early =
            matches!((self.earliest[one], self.earliest[other]), (Some(one), Some(other)) if other < one);
        let is_refuted_late = match (self.latest[one], self.latest[other]) {
            (Some(one), Some(other)) => other < one,
            (None, Some(_)) => true,
            _ => false,
        };
        (is_refuted_early || is_refuted_late).then_some(false)
    }
}

/// An interval between two events; an event alone is one whose ends are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Span {
    pub(crate) start: NodeId,
    pub(crate) end: NodeId,
}

/// For each pair of some intervals, whether one's end happens before the other's start in the plan (SPEC 10.4). The start
/// of each must happen before its end, so that the relation is transitive.
#[derive(Clone, Debug)]
pub(crate) struct Precedence {
    words: usize,
    /// Row by row a bit for each interval that comes after.
    after: Vec<u64>,
    /// Row by row a bit for each interval that comes before.
    before: Vec<u64>,
}

impl Precedence {
    /// Windows decide most pairs, and transitivity most of the others: intervals in a row cost one search each. At worst
    /// two rows of distances for each interval, O(n · edges · log nodes) and O(n³ / 64) for the closure.
    pub(crate) fn new(entailment: &Entailment, spans: &[Span]) -> Self {
        let words = spans.len().div_ceil(64);
        let mut made =
            Self { words, after: vec![0; words * spans.len()], before: vec![0; words * spans.len()] };
        let key = |index: &usize| {
            let span = spans[*index];
            let latest = |node: NodeId| entailment.latest[node.index()].unwrap_or(i128::MAX);
            let earliest = |node: NodeId| entailment.earliest[node.index()].unwrap_or(i128::MIN);
            (earliest(span.start), latest(span.start), earliest(span.end), latest(span.end), *index)
        };
        let mut sequence: Vec<usize> = (0..spans.len()).collect();
        sequence.sort_by_key(key);
        for (position, &one) in sequence.iter().enumerate() {
            let mut to_start = Lookup::new(&entailment.distances, spans[one].start, Direction::From);
            let mut to_end = Lookup::new(&entailment.distances, spans[one].end, Direction::To);
            // The nearest first: what precedes it follows.
            for &other in sequence[..position].iter().rev() {
                if !made.is_before(other, one) {
                    let by_windows = entailment.is_before_by_windows(spans[other].end, spans[one].start);
                    if by_windows.unwrap_or_else(|| to_start.is_at_most_zero(spans[other].end)) {
                        made.add(other, one);
                    }
                }
                if !made.is_before(one, other) {
                    let by_windows = entailment.is_before_by_windows(spans[one].end, spans[other].start);
                    if by_windows.unwrap_or_else(|| to_end.is_at_most_zero(spans[other].start)) {
                        made.add(one, other);
                    }
                }
            }
        }
        made
    }

    /// Returns whether the end of `one` happens before the start of `other`. No interval comes before itself.
    pub(crate) fn is_before(&self, one: usize, other: usize) -> bool {
        self.after[one * self.words + other / 64] >> (other % 64) & 1 == 1
    }

    /// Adds a pair and what follows from it.
    fn add(&mut self, one: usize, other: usize) {
        let words = self.words;
        let with_itself = |row: &[u64], index: usize| {
            let mut row = row.to_vec();
            row[index / 64] |= 1 << (index % 64);
            row
        };
        let befores = with_itself(&self.before[one * words..(one + 1) * words], one);
        let afters = with_itself(&self.after[other * words..(other + 1) * words], other);
        for before in indices(&befores) {
            for (word, &more) in self.after[before * words..(before + 1) * words].iter_mut().zip(&afters) {
                *word |= more;
            }
            self.after[before * words + before / 64] &= !(1 << (before % 64));
        }
        for after in indices(&afters) {
            for (word, &more) in self.before[after * words..(after + 1) * words].iter_mut().zip(&befores) {
                *word |= more;
            }
            self.before[after * words + after / 64] &= !(1 << (after % 64));
        }
    }
}

fn indices(row: &[u64]) -> Vec<usize> {
    let mut found = Vec::new();
    for (position, &word) in row.iter().enumerate() {
        let mut left = word;
        while left != 0 {
            found.push(position * 64 + left.trailing_zeros() as usize);
            left &= left - 1;
        }
    }
    found
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Direction {
    From,
    To,
}

/// Distances between one node and others: the first by a search of its own, which is short for neighbors, later ones
/// from a whole row or column.
struct Lookup<'distances> {
    distances: &'distances Distances,
    node: NodeId,
    direction: Direction,
    has_searched: bool,
    all: Option<Vec<Option<i128>>>,
}

impl<'distances> Lookup<'distances> {
    fn new(distances: &'distances Distances, node: NodeId, direction: Direction) -> Self {
        Self { distances, node, direction, has_searched: false, all: None }
    }

    /// Returns whether the distance from the node to `other`, or from `other` to it, is at most zero.
    fn is_at_most_zero(&mut self, other: NodeId) -> bool {
        let distance = if std::mem::replace(&mut self.has_searched, true) {
            let all = self.all.get_or_insert_with(|| match self.direction {
                Direction::From => self.distances.row(self.node.0),
                Direction::To => self.distances.column(self.node.0),
            });
            all[other.index()]
        } else {
            match self.direction {
                Direction::From => self.distances.between(self.node.0, other.0),
                Direction::To => self.distances.between(other.0, self.node.0),
            }
        };
        distance.is_some_and(|distance| distance <= 0)
    }
}
