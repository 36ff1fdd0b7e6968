//! The exact Euclidean distance from cell centers to a set of square cells.
//!
//! Felzenszwalb and Huttenlocher (2012), "Distance transforms of sampled functions", adapted so that an occupied cell
//! is its whole square and not its center. Time is linear in the number of cells.

/// Half the diagonal of a cell: no point of a cell is farther from its center.
pub(crate) const HALF_DIAGONAL: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// For each cell, the distance in cells from its center to the nearest occupied square: 0 in occupied cells and
/// infinity when nothing is occupied. `occupied` is row-major and has `width` × `height` entries.
pub fn distance_to_occupied(width: usize, height: usize, occupied: &[bool]) -> Vec<f32> {
    assert_eq!(occupied.len(), width * height, "one entry for each cell");
    // Lengths are counted in half cells, in which cell centers and cell borders are whole numbers.
    let gaps = vertical_gaps(width, height, occupied);
    let mut distances = vec![0.0_f32; width * height];
    let mut envelope = Envelope::with_capacity(width + 1);
    for row in 0..height {
        let gaps = &gaps[row * width..(row + 1) * width];
        let distances = &mut distances[row * width..(row + 1) * width];
        // The border between columns k-1 and k is as near to the occupied cells of both.
        envelope.clear();
        for border in 0..=width {
            let west = if border > 0 { gaps[border - 1] } else { NO_GAP };
            let east = if border < width { gaps[border] } else { NO_GAP };
            let gap = west.min(east);
            if gap != NO_GAP {
                envelope.add(2.0 * border as f64, f64::from(gap) * f64::from(gap));
            }
        }
        let mut piece = 0;
        for (column, (distance, &gap)) in distances.iter_mut().zip(gaps).enumerate() {
            let own = if gap == NO_GAP { f64::INFINITY } else { f64::from(gap) * f64::from(gap) };
            let squared = envelope.value(2.0 * column as f64 + 1.0, &mut piece).min(own);
            *distance = (0.5 * squared.sqrt()) as f32;
        }
    }
    distances
}

/// No occupied cell in the column.
const NO_GAP: u32 = u32::MAX;

/// For each cell, half cells from its center to the nearest occupied square of its own column.
fn vertical_gaps(width: usize, height: usize, occupied: &[bool]) -> Vec<u32> {
    let mut gaps = vec![NO_GAP; width * height];
    let grow = |gap: u32| match gap {
        NO_GAP => NO_GAP,
        0 => 1,
        gap => gap + 2,
    };
    for row in 0..height {
        for column in 0..width {
            let index = row * width + column;
            if occupied[index] {
                gaps[index] = 0;
            } else if row > 0 {
                gaps[index] = grow(gaps[index - width]);
            }
        }
    }
    for row in (0..height.saturating_sub(1)).rev() {
        for column in 0..width {
            let index = row * width + column;
            gaps[index] = gaps[index].min(grow(gaps[index + width]));
        }
    }
    gaps
}

/// The lower envelope of parabolas `(q - apex)² + value`, apexes added in increasing order.
struct Envelope {
    apexes: Vec<f64>,
    values: Vec<f64>,
    /// From where on each parabola is the lowest.
    starts: Vec<f64>,
}

impl Envelope {
    fn with_capacity(count: usize) -> Self {
        Self {
            apexes: Vec::with_capacity(count),
            values: Vec::with_capacity(count),
            starts: Vec::with_capacity(count),
        }
    }

    fn clear(&mut self) {
        self.apexes.clear();
        self.values.clear();
        self.starts.clear();
    }

    fn add(&mut self, apex: f64, value: f64) {
        let mut start = f64::NEG_INFINITY;
        while let (Some(&last_apex), Some(&last_value), Some(&last_start)) =
            (self.apexes.last(), self.values.last(), self.starts.last())
        {
            start =
                ((value + apex * apex) - (last_value + last_apex * last_apex)) / (2.0 * (apex - last_apex));
            if start > last_start {
                break;
            }
            self.apexes.pop();
            self.values.pop();
            self.starts.pop();
            start = f64::NEG_INFINITY;
        }
        self.apexes.push(apex);
        self.values.push(value);
        self.starts.push(start);
    }

    /// The envelope at `place`; `piece` remembers the parabola between calls with increasing places.
    fn value(&self, place: f64, piece: &mut usize) -> f64 {
        if self.apexes.is_empty() {
            return f64::INFINITY;
        }
        while *piece + 1 < self.starts.len() && self.starts[*piece + 1] <= place {
            *piece += 1;
        }
        let offset = place - self.apexes[*piece];
        offset * offset + self.values[*piece]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    fn brute_force(width: usize, height: usize, occupied: &[bool], column: usize, row: usize) -> f64 {
        let gap = |a: usize, b: usize| (a.abs_diff(b) as f64 - 0.5).max(0.0);
        (0..width * height)
            .filter(|&index| occupied[index])
            .map(|index| {
                let (across, along) = (gap(index % width, column), gap(index / width, row));
                (across * across + along * along).sqrt()
            })
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn equals_the_distance_to_every_square_taken_one_by_one() {
        for seed in 0..60 {
            let mut random = Random::from_seed(seed);
            let (width, height) = (1 + random.below(24) as usize, 1 + random.below(24) as usize);
            let density = random.unit() * random.unit();
            let occupied: Vec<bool> = (0..width * height).map(|_| random.unit() < density).collect();
            let distances = distance_to_occupied(width, height, &occupied);
            for row in 0..height {
                for column in 0..width {
                    let expected = brute_force(width, height, &occupied, column, row) as f32;
                    let found = distances[row * width + column];
                    assert!(
                        found == expected || (found - expected).abs() < 1e-5,
                        "seed {seed}, {width} × {height}, ({column}, {row}): {found} instead of {expected}"
                    );
                }
            }
        }
    }
}
