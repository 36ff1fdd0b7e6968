//! Counting how often the lines of a drawing cross: the same count for every layout.

use std::collections::HashSet;

/// A line as its corners; curves are flattened before.
pub(crate) type Line = Vec<[f64; 2]>;

/// The number of crossings of segments of different lines. Touching, sharing an end and running along each other are
/// no crossings.
pub(crate) fn crossings(lines: &[Line]) -> usize {
    let segments: Vec<(usize, [f64; 2], [f64; 2])> = (lines.iter().enumerate())
        .flat_map(|(line, points)| points.windows(2).map(move |pair| (line, pair[0], pair[1])))
        .collect();
    let cells = Grid::of(&segments);
    let mut found = HashSet::new();
    for members in &cells.members {
        for (at, &one) in members.iter().enumerate() {
            for &other in &members[at + 1..] {
                let (first, second) = (&segments[one as usize], &segments[other as usize]);
                if first.0 != second.0 && cross(first.1, first.2, second.1, second.2) {
                    found.insert((one, other));
                }
            }
        }
    }
    found.len()
}

/// Which segments come through which cell.
struct Grid {
    members: Vec<Vec<u32>>,
}

impl Grid {
    fn of(segments: &[(usize, [f64; 2], [f64; 2])]) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in segments.iter().flat_map(|segment| [segment.1, segment.2]) {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        // About as many cells as segments, in the proportions of the drawing.
        let extent = [(high[0] - low[0]).max(1e-9), (high[1] - low[1]).max(1e-9)];
        let size = (extent[0] * extent[1] / segments.len().max(1) as f64).sqrt().max(1e-9);
        let count =
            [0, 1].map(|axis| ((extent[axis] / size).ceil() as usize).clamp(1, 4 * segments.len().max(1)));
        let mut members = vec![Vec::new(); count[0] * count[1]];
        for (at, segment) in segments.iter().enumerate() {
            let cell = |value: f64, axis: usize| {
                (((value - low[axis]) / extent[axis] * count[axis] as f64) as usize).min(count[axis] - 1)
            };
            let (a, b) = (segment.1, segment.2);
            for row in cell(a[1].min(b[1]), 1)..=cell(a[1].max(b[1]), 1) {
                // Only the columns that the segment passes in this row.
                let bounds = [row, row + 1].map(|edge| low[1] + edge as f64 * extent[1] / count[1] as f64);
                let at_height = |y: f64| a[0] + (b[0] - a[0]) * ((y - a[1]) / (b[1] - a[1])).clamp(0.0, 1.0);
                let ends = if a[1] == b[1] { [a[0], b[0]] } else { bounds.map(at_height) };
                let (left, right) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
                for column in cell(left, 0).saturating_sub(1)..=(cell(right, 0) + 1).min(count[0] - 1) {
                    members[row * count[0] + column].push(at as u32);
                }
            }
        }
        Self { members }
    }
}

/// Returns whether two segments cross, not counting where one ends on the other.
fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2], d: [f64; 2]) -> bool {
    let side = |from: [f64; 2], to: [f64; 2], point: [f64; 2]| {
        let (along, beside) = ([to[0] - from[0], to[1] - from[1]], [point[0] - from[0], point[1] - from[1]]);
        let product = along[0] * beside[1] - along[1] * beside[0];
        let length = along[0].hypot(along[1]);
        if product.abs() <= 0.01 * length { 0.0 } else { product.signum() }
    };
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_counts_what_looking_at_every_pair_counts() {
        let mut rng = tpn::generate::Rng::new(5);
        let mut point = || [rng.between(0, 1000) as f64, rng.between(0, 300) as f64];
        let lines: Vec<Line> = (0..120).map(|_| vec![point(), point(), point()]).collect();
        let mut expected = 0;
        for (at, one) in lines.iter().enumerate() {
            for other in &lines[at + 1..] {
                for first in one.windows(2) {
                    expected +=
                        other.windows(2).filter(|pair| cross(first[0], first[1], pair[0], pair[1])).count();
                }
            }
        }
        assert!(expected > 1000);
        assert_eq!(crossings(&lines), expected);
    }

    #[test]
    fn lines_that_meet_at_an_end_do_not_cross() {
        let lines = vec![
            vec![[0.0, 0.0], [10.0, 10.0]],
            vec![[10.0, 10.0], [20.0, 0.0]],
            vec![[5.0, 5.0], [9.0, 0.0]],
            vec![[0.0, 8.0], [8.0, 0.0]],
        ];
        assert_eq!(crossings(&lines), 1, "only the last crosses the first");
    }
}
