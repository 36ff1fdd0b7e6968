//! Impact craters: their shape, and a population of them.
//!
//! Shape after Pike (1977) and Melosh (1989) for simple craters: a bowl about 0.2 diameters deep with a rim 0.04
//! diameters high and a blanket that falls with the cube of the distance; old ones are shallower and have lost rim.

use nalgebra::{Point2, Vector2, distance};

use crate::frame::GridFrame;
use crate::random::Random;

/// A crater to be pressed into a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crater {
    pub(crate) center_m: Point2<f64>,
    pub(crate) diameter_m: f64,
    /// 1 is fresh, 0 has vanished.
    pub(crate) freshness: f64,
}

/// How far from the center a crater changes the ground, in radii.
const REACH_RADII: f64 = 3.0;

impl Crater {
    /// Returns how much higher the ground lies because of the crater, in meters, at a distance from its center.
    pub(crate) fn height_m(&self, distance_m: f64) -> f64 {
        let rim = 0.04 * self.diameter_m * self.freshness;
        let depth = 0.2 * self.diameter_m * self.freshness;
        let radii = distance_m / (0.5 * self.diameter_m);
        if radii < 1.0 {
            rim - depth * (1.0 - radii * radii)
        } else if radii < REACH_RADII {
            // The blanket is cut off at the reach; a linear share takes it to zero there.
            rim / (radii * radii * radii) * (REACH_RADII - radii) / (REACH_RADII - 1.0)
        } else {
            0.0
        }
    }

    /// Adds the crater to heights on a grid.
    pub(crate) fn press(&self, frame: &GridFrame, heights_m: &mut [f32]) {
        let reach = REACH_RADII * 0.5 * self.diameter_m;
        let low = frame.to_cells(self.center_m - Vector2::repeat(reach));
        let high = frame.to_cells(self.center_m + Vector2::repeat(reach));
        let columns = low[0].max(0.0) as u32..(high[0].max(0.0) as u32 + 1).min(frame.width);
        let rows = low[1].max(0.0) as u32..(high[1].max(0.0) as u32 + 1).min(frame.height);
        for row in rows {
            for column in columns.clone() {
                let cell = crate::frame::Cell { column, row };
                let added = self.height_m(distance(&frame.center_m(cell), &self.center_m));
                heights_m[frame.index(cell)] += added as f32;
            }
        }
    }
}

/// Craters whose cumulative number falls with the square of their diameter, largest first so that small ones lie on
/// top, with centers also beyond the border of the grid.
pub(crate) fn crater_population(
    frame: &GridFrame,
    count: u32,
    diameters_m: [f64; 2],
    freshness: [f64; 2],
    random: &mut Random,
) -> Vec<Crater> {
    let [least, greatest] = diameters_m;
    let extent = frame.extent_m();
    let mut craters: Vec<Crater> = (0..count)
        .map(|_| {
            let part = Vector2::new(random.range(-0.1, 1.1), random.range(-0.1, 1.1));
            let center_m = frame.origin_m + part.component_mul(&extent);
            // The inverse of N(≥ D) ∝ D⁻² between the two diameters.
            let rank = random.unit();
            let share = least * least / (greatest * greatest);
            let diameter_m = least / (1.0 - rank * (1.0 - share)).sqrt();
            Crater { center_m, diameter_m, freshness: random.range(freshness[0], freshness[1]) }
        })
        .collect();
    craters.sort_by(|a, b| b.diameter_m.total_cmp(&a.diameter_m));
    craters
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fresh_crater_has_the_depth_and_rim_of_simple_craters() {
        let crater = Crater { center_m: Point2::origin(), diameter_m: 50.0, freshness: 1.0 };
        assert!((crater.height_m(25.0) - 2.0).abs() < 1e-9);
        assert!((crater.height_m(0.0) + 8.0).abs() < 1e-9);
        assert!((crater.height_m(24.999) - crater.height_m(25.001)).abs() < 0.01);
        assert!(crater.height_m(74.999).abs() < 1e-3);
        assert_eq!(crater.height_m(80.0), 0.0);
    }

    #[test]
    fn there_are_four_times_as_many_craters_of_half_the_size() {
        let frame = GridFrame::new(100, 100, 1.0);
        let craters = crater_population(&frame, 20_000, [1.0, 64.0], [0.5, 1.0], &mut Random::from_seed(2));
        let at_least =
            |diameter: f64| craters.iter().filter(|crater| crater.diameter_m >= diameter).count() as f64;
        let ratio = at_least(2.0) / at_least(4.0);
        assert!((ratio - 4.0).abs() < 0.4, "{ratio}");
    }
}
