//! Rocks by the size–frequency distribution of Golombek and Rapp (1997), "Size-frequency distributions of rocks on Mars
//! and Earth analog sites", J. Geophys. Res. 102.

use nalgebra::{Point2, Vector2};
use serde::{Deserialize, Serialize};

use crate::frame::GridFrame;
use crate::random::Random;

/// A rock, taken as the upper half of a ball: half as high as it is wide.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rock {
    /// Meters east and north.
    pub center_m: Point2<f64>,
    /// Meters across.
    pub diameter_m: f64,
}

impl Rock {
    /// The least diameter of a rock that shows on a map of 0.6 m cells.
    pub const MAPPED_DIAMETER_M: f64 = 1.0;

    /// Returns whether the rock is big enough to be on the map; smaller ones are met on the way (SPEC 7.4).
    pub fn is_mapped(&self) -> bool {
        self.diameter_m >= Self::MAPPED_DIAMETER_M
    }
}

/// The fraction of the ground covered by rocks of at least this diameter in meters, when rocks cover `abundance` of it
/// altogether: `k exp(-(1.79 + 0.152 / k) D)`.
pub fn cumulative_rock_area(abundance: f64, diameter_m: f64) -> f64 {
    if abundance <= 0.0 {
        return 0.0;
    }
    abundance * libm::exp(-(1.79 + 0.152 / abundance) * diameter_m)
}

/// Rocks of at least `min_diameter_m`, spread evenly over a grid's extent.
///
/// The number of rocks in a class of diameters is the area that the distribution gives the class over the area of one
/// such rock; a remainder becomes a rock with its probability.
pub fn scatter_rocks(
    frame: &GridFrame,
    abundance: f64,
    min_diameter_m: f64,
    random: &mut Random,
) -> Vec<Rock> {
    const CLASS_WIDTH_M: f64 = 0.05;
    const MAX_DIAMETER_M: f64 = 4.0;
    let extent = frame.extent_m();
    let mut rocks = Vec::new();
    let mut low = min_diameter_m;
    while abundance > 0.0 && low < MAX_DIAMETER_M {
        let high = low + CLASS_WIDTH_M;
        let covered = (cumulative_rock_area(abundance, low) - cumulative_rock_area(abundance, high))
            * extent.x
            * extent.y;
        let middle = 0.5 * (low + high);
        let count = covered / (std::f64::consts::FRAC_PI_4 * middle * middle) + random.unit();
        for _ in 0..count as u32 {
            let part = Vector2::new(random.unit(), random.unit());
            let center_m = frame.origin_m + part.component_mul(&extent);
            rocks.push(Rock { center_m, diameter_m: random.range(low, high) });
        }
        low = high;
    }
    rocks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rocks_cover_what_the_distribution_says() {
        let frame = GridFrame::new(1000, 1000, 0.6);
        for abundance in [0.03, 0.08, 0.16] {
            let rocks = scatter_rocks(&frame, abundance, 0.3, &mut Random::from_seed(3));
            for diameter in [0.3, 0.5, 0.8] {
                let area: f64 = rocks
                    .iter()
                    .filter(|rock| rock.diameter_m >= diameter)
                    .map(|rock| std::f64::consts::FRAC_PI_4 * rock.diameter_m * rock.diameter_m)
                    .sum();
                let found = area / 360_000.0;
                let expected = cumulative_rock_area(abundance, diameter);
                assert!(
                    (found / expected - 1.0).abs() < 0.1,
                    "k {abundance}, D {diameter}: {found} instead of {expected}"
                );
            }
        }
    }

    #[test]
    fn no_rocks_where_none_are_asked_for() {
        let frame = GridFrame::new(100, 100, 1.0);
        assert_eq!(scatter_rocks(&frame, 0.0, 0.3, &mut Random::from_seed(1)), []);
    }
}
