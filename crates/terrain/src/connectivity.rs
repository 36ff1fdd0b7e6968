//! Proofs that a place can't be reached: the pieces into which an outer bound of the free places falls.

use nalgebra::Point2;

use crate::configuration::ConfigurationSpace;
use crate::distance::HALF_DIAGONAL;
use crate::frame::Cell;

/// The connected pieces of a set of cells; cells that share a side are connected.
///
/// That is enough for a proof: where a free path passes a corner, the corner is a free point of all four cells around
/// it, and a vehicle of radius 0 can't pass a corner beside an occupied cell.
#[derive(Clone, Debug)]
pub(crate) struct Regions {
    /// The piece of each cell; `NONE` outside the set.
    labels: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl Regions {
    /// Labels the cells for which `belongs` holds, in one pass over rows with union–find and one to settle.
    pub(crate) fn label(width: usize, height: usize, belongs: impl Fn(usize) -> bool) -> Self {
        let mut labels = vec![NONE; width * height];
        let mut parents: Vec<u32> = Vec::new();
        for row in 0..height {
            for column in 0..width {
                let index = row * width + column;
                if !belongs(index) {
                    continue;
                }
                let mut label = NONE;
                let mut join = |neighbor: u32| {
                    if neighbor != NONE {
                        label = if label == NONE { neighbor } else { unite(&mut parents, label, neighbor) };
                    }
                };
                if column > 0 {
                    join(labels[index - 1]);
                }
                if row > 0 {
                    join(labels[index - width]);
                }
                if label == NONE {
                    label = parents.len() as u32;
                    parents.push(label);
                }
                labels[index] = label;
            }
        }
        for label in labels.iter_mut().filter(|label| **label != NONE) {
            *label = root(&mut parents, *label);
        }
        Self { labels }
    }

    /// Returns whether both cells are in the set and in one piece.
    pub(crate) fn joined(&self, a: usize, b: usize) -> bool {
        self.labels[a] != NONE && self.labels[a] == self.labels[b]
    }
}

fn root(parents: &mut [u32], mut label: u32) -> u32 {
    while parents[label as usize] != label {
        parents[label as usize] = parents[parents[label as usize] as usize];
        label = parents[label as usize];
    }
    label
}

fn unite(parents: &mut [u32], a: u32, b: u32) -> u32 {
    let (a, b) = (root(parents, a), root(parents, b));
    let (low, high) = (a.min(b), a.max(b));
    parents[high as usize] = low;
    low
}

/// Each cell is cut into this many pieces along each side.
const PIECES: u32 = 4;

/// Maps with more cells are not cut: it would take gigabytes.
const MAX_CELLS_CUT: usize = 1 << 22;

/// Returns whether two points are in different pieces of an outer bound of the free places, made of cells cut in
/// sixteen. `false` on a map of more than four million cells.
pub(crate) fn are_separated_finely(space: &ConfigurationSpace, a_m: Point2<f64>, b_m: Point2<f64>) -> bool {
    let frame = *space.frame();
    if frame.cell_count() > MAX_CELLS_CUT {
        return false;
    }
    let (width, height) = ((frame.width * PIECES) as usize, (frame.height * PIECES) as usize);
    let size = 1.0 / f64::from(PIECES);
    let regions = Regions::label(width, height, |index| {
        let (column, row) = ((index % width) as u32, (index / width) as u32);
        let cell = Cell { column: column / PIECES, row: row / PIECES };
        if space.is_occupied(cell) {
            return false;
        }
        let clearance = space.center_clearance(cell);
        // Well inside or well outside, the cell's center decides for all its pieces.
        if (clearance - space.radius).abs() > HALF_DIAGONAL + 0.01 {
            return clearance > space.radius;
        }
        let center = Point2::new((f64::from(column) + 0.5) * size, (f64::from(row) + 0.5) * size);
        space
            .nearest_occupied(center, cell)
            .is_none_or(|(distance, _)| distance + HALF_DIAGONAL * size + 1e-6 >= space.radius)
    });
    let index = |point_m: Point2<f64>| {
        let point = frame.to_cells(point_m);
        let piece = |value: f64, size: usize| ((value * f64::from(PIECES)) as usize).min(size - 1);
        piece(point.y, height) * width + piece(point.x, width)
    };
    !frame.contains(a_m) || !frame.contains(b_m) || !regions.joined(index(a_m), index(b_m))
}
