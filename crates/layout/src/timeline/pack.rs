//! Which row each bar of a lane is in, so that none lies over another.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The row of each span `[start, end)`: by ascending starts, the first row that is free then. That takes as many rows
/// as spans lie over one point of time, which is the minimum. An instant takes its point of time for itself. `O(n log n)`.
pub(super) fn first_fit(spans: &[[f64; 2]]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..spans.len()).collect();
    // Of those that start together, the longest comes first: what has others inside lies above them.
    let key = |at: usize| (spans[at][0], spans[at][1]);
    order.sort_by(|&left, &right| {
        let (left, right) = (key(left), key(right));
        left.0.total_cmp(&right.0).then(right.1.total_cmp(&left.1))
    });
    let mut rows = vec![0; spans.len()];
    let mut busy: BinaryHeap<Reverse<(Instant, usize)>> = BinaryHeap::new();
    let mut free: BinaryHeap<Reverse<usize>> = BinaryHeap::new();
    for at in order {
        let [start, end] = spans[at];
        while let Some(&Reverse((_, row))) = busy.peek().filter(|it| it.0.0.0 <= start) {
            busy.pop();
            free.push(Reverse(row));
        }
        // All rows are busy or free.
        let row = free.pop().map_or(busy.len(), |Reverse(row)| row);
        rows[at] = row;
        busy.push(Reverse((Instant(end.max(start.next_up())), row)));
    }
    rows
}

/// A time with a total order.
#[derive(Clone, Copy, Debug)]
struct Instant(f64);

impl Ord for Instant {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl PartialOrd for Instant {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Instant {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Instant {}

#[cfg(test)]
mod tests {
    use super::*;

    /// Spans that are the same in each run, with many that touch and some instants.
    fn spans(count: u64) -> Vec<[f64; 2]> {
        let mut state = 7_u64;
        let mut next = |limit: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % limit
        };
        let span = |start: u64, length: u64| [start as f64, (start + length) as f64];
        (0..count).map(|_| span(next(count), next(12))).collect()
    }

    #[test]
    fn no_two_spans_of_a_row_overlap_and_there_are_as_few_rows_as_can_be() {
        for count in [1, 10, 40, 300, 1_000] {
            let spans = spans(count);
            let rows = first_fit(&spans);
            assert_eq!(rows.len(), spans.len());
            let lasts = |[start, end]: [f64; 2]| [start, end.max(start.next_up())];
            let at_once = |time: f64| {
                let is_there = |span: &&[f64; 2]| lasts(**span)[0] <= time && time < lasts(**span)[1];
                spans.iter().filter(is_there).count()
            };
            let fewest = spans.iter().map(|span| at_once(span[0])).max().expect("some");
            assert_eq!(rows.iter().max().map(|row| row + 1), Some(fewest), "{count} spans");
            for row in 0..fewest {
                let mut own: Vec<_> =
                    spans.iter().zip(&rows).filter(|it| *it.1 == row).map(|it| lasts(*it.0)).collect();
                own.sort_by(|left, right| left[0].total_cmp(&right[0]));
                assert!(own.windows(2).all(|pair| pair[0][1] <= pair[1][0]), "row {row} of {count} spans");
            }
        }
    }

    #[test]
    fn the_first_free_row_is_taken_in_the_order_of_starts() {
        assert_eq!(first_fit(&[[0.0, 4.0], [4.0, 6.0], [1.0, 3.0], [3.0, 9.0]]), [0, 0, 1, 1]);
        assert_eq!(first_fit(&[[0.0, 2.0], [0.0, 9.0]]), [1, 0], "what lasts longer is above");
        assert_eq!(
            first_fit(&[[5.0, 5.0], [5.0, 5.0], [0.0, 5.0]]),
            [0, 1, 0],
            "instants do not cover another"
        );
        assert_eq!(first_fit(&[[0.0, f64::INFINITY], [3.0, 4.0]]), [0, 1]);
        assert!(first_fit(&[]).is_empty());
    }
}
