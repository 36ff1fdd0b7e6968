//! All-pairs distances over exact integers, the textbook way: the yardstick of the tests.

use exact::{Bound, Time};
use tpn::{ArcId, Network};

/// The distance where there is no path.
pub const FAR: i64 = i64::MAX / 4;

/// A distance matrix closed under the triangle inequality.
#[derive(Clone, Debug)]
pub struct Matrix {
    size: usize,
    cells: Vec<i64>,
}

impl Matrix {
    /// No constraints between `size` points.
    pub fn new(size: usize) -> Self {
        let mut cells = vec![FAR; size * size];
        for point in 0..size {
            cells[point * size + point] = 0;
        }
        Self { size, cells }
    }

    /// The greatest value of `to − from`.
    pub fn get(&self, from: usize, to: usize) -> i64 {
        self.cells[from * self.size + to]
    }

    /// Adds `to − from ≤ weight` and closes again, O(n²); false if that is inconsistent.
    #[must_use]
    pub fn add(&mut self, from: usize, to: usize, weight: i64) -> bool {
        if weight >= self.get(from, to) {
            return true;
        }
        let back = self.get(to, from);
        if back < FAR && weight + back < 0 {
            return false;
        }
        for before in 0..self.size {
            let to_from = self.get(before, from);
            if to_from >= FAR {
                continue;
            }
            for after in 0..self.size {
                let from_to = self.get(to, after);
                if from_to < FAR {
                    let through = to_from + weight + from_to;
                    let cell = &mut self.cells[before * self.size + after];
                    *cell = (*cell).min(through);
                }
            }
        }
        true
    }

    /// Adds `lower ≤ to − from ≤ upper`.
    #[must_use]
    pub fn constrain(&mut self, from: usize, to: usize, lower: i64, upper: Option<i64>) -> bool {
        self.add(to, from, -lower) && upper.is_none_or(|upper| self.add(from, to, upper))
    }
}

/// Times as integers: multiplied by a common denominator.
#[derive(Clone, Copy, Debug)]
pub struct Scale(pub i64);

impl Scale {
    /// The least scale that makes every bound and the gap whole.
    pub fn of(network: &Network) -> Self {
        let times = network.arcs.iter().flat_map(|arc| [Some(arc.lower), arc.upper.finite()]);
        let mut scale = 1;
        for time in times.flatten().chain([network.threat_gap]) {
            let denominator = time.denominator();
            let mut multiple = scale;
            while multiple % denominator != 0 {
                multiple += scale;
            }
            scale = multiple;
        }
        Self(scale)
    }

    /// A time, scaled.
    pub fn time(self, time: Time) -> i64 {
        time.numerator() * (self.0 / time.denominator())
    }

    /// A bound, scaled.
    pub fn bound(self, bound: Bound) -> Option<i64> {
        bound.finite().map(|time| self.time(time))
    }

    /// Back to a time.
    pub fn unscaled(self, scaled: i64) -> Time {
        Time::new(scaled, self.0).expect("the scale is positive")
    }
}

/// The distances of the selected arcs alone; `None` if they are inconsistent.
pub fn of_arcs(network: &Network, scale: Scale, is_selected: impl Fn(ArcId) -> bool) -> Option<Matrix> {
    let mut matrix = Matrix::new(network.nodes.len());
    for (index, arc) in network.arcs.iter().enumerate() {
        if is_selected(ArcId::from_index(index)) {
            let (lower, upper) = (scale.time(arc.lower), scale.bound(arc.upper));
            if !matrix.constrain(arc.from.index(), arc.to.index(), lower, upper) {
                return None;
            }
        }
    }
    Some(matrix)
}
