//! A simulated planar laser range finder in a world that is finer than the map (SPEC 7.4).

use serde::{Deserialize, Serialize};
use terrain::{Obstacle, Random, Terrain};

use crate::geometry::{distance, squared_distance};

/// The things that a laser meets: discs and straight faces, in metres.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FineWorld {
    discs: Vec<Disc>,
    faces: Vec<[[f64; 2]; 2]>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Disc {
    center_m: [f64; 2],
    radius_m: f64,
}

/// What a range finder can do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LaserModel {
    /// The angle that it sweeps, centred ahead, in radians.
    pub field_of_view_rad: f64,
    /// The angle between two rays in radians.
    pub resolution_rad: f64,
    /// How far it sees in metres.
    pub range_m: f64,
    /// Standard deviation of a measured range in metres.
    pub noise_m: f64,
}

impl LaserModel {
    /// Like the SICK units that such robots carried: 180° in steps of 1°, 8 m, 1.5 cm.
    pub const SICK: Self = Self {
        field_of_view_rad: std::f64::consts::PI,
        resolution_rad: std::f64::consts::PI / 180.0,
        range_m: 8.0,
        noise_m: 0.015,
    };
}

/// One sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LaserScan {
    /// Where it was taken, in metres.
    pub origin_m: [f64; 2],
    /// The direction of the first ray, the rightmost, in radians.
    pub first_ray_rad: f64,
    /// The angle between two rays in radians.
    pub resolution_rad: f64,
    /// The measured range of each ray in metres; `None` when it met nothing.
    pub ranges_m: Vec<Option<f64>>,
}

impl LaserScan {
    /// The measured points in metres.
    pub fn points_m(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.ranges_m.iter().enumerate().filter_map(|(ray, range)| {
            let range = (*range)?;
            let angle = self.first_ray_rad + self.resolution_rad * ray as f64;
            Some([self.origin_m[0] + range * libm::cos(angle), self.origin_m[1] + range * libm::sin(angle)])
        })
    }
}

impl FineWorld {
    /// The rocks of a map from a diameter in metres on, also those too small for the map, and declared obstacles.
    pub fn new(terrain: &Terrain, obstacles: &[Obstacle], least_rock_m: f64) -> Self {
        let mut world = Self::default();
        for rock in terrain.rocks().iter().filter(|rock| rock.diameter_m >= least_rock_m) {
            world.add(&Obstacle::Circle { center_m: rock.center_m, radius_m: 0.5 * rock.diameter_m });
        }
        for obstacle in obstacles {
            world.add(obstacle);
        }
        world
    }

    /// Puts a thing into the world.
    pub fn add(&mut self, obstacle: &Obstacle) {
        match obstacle {
            Obstacle::Circle { center_m, radius_m } => {
                self.discs.push(Disc { center_m: *center_m, radius_m: *radius_m });
            }
            Obstacle::Polygon { corners_m } => {
                let next = corners_m.iter().cycle().skip(1);
                self.faces.extend(corners_m.iter().zip(next).map(|(&a, &b)| [a, b]));
            }
        }
    }

    /// Metres from a point to the nearest surface, 0 inside a disc; infinite in an empty world.
    pub fn distance_m(&self, point_m: [f64; 2]) -> f64 {
        let discs = self.discs.iter().map(|disc| (distance(disc.center_m, point_m) - disc.radius_m).max(0.0));
        let faces = self.faces.iter().map(|&[a, b]| distance_to_segment(point_m, a, b));
        discs.chain(faces).fold(f64::INFINITY, f64::min)
    }

    /// Sweeps the laser of a vehicle at a place and heading.
    pub fn scan(
        &self,
        origin_m: [f64; 2],
        heading_rad: f64,
        model: &LaserModel,
        random: &mut Random,
    ) -> LaserScan {
        let near = self.around(origin_m, model.range_m);
        let rays = (model.field_of_view_rad / model.resolution_rad).round().clamp(0.0, 1e5) as u32;
        let first_ray_rad = heading_rad - 0.5 * model.field_of_view_rad;
        let ranges_m = (0..=rays)
            .map(|ray| {
                let angle = first_ray_rad + model.resolution_rad * f64::from(ray);
                let direction = [libm::cos(angle), libm::sin(angle)];
                let range = near.cast(origin_m, direction);
                (range <= model.range_m).then(|| (range + model.noise_m * random.gaussian()).max(0.0))
            })
            .collect();
        LaserScan { origin_m, first_ray_rad, resolution_rad: model.resolution_rad, ranges_m }
    }

    /// What of it comes within a range of a point.
    pub fn around(&self, point_m: [f64; 2], range_m: f64) -> Self {
        let near = |disc: &&Disc| {
            let reach = range_m + disc.radius_m;
            squared_distance(disc.center_m, point_m) <= reach * reach
        };
        Self {
            discs: self.discs.iter().filter(near).copied().collect(),
            faces: self
                .faces
                .iter()
                .filter(|[a, b]| distance_to_segment(point_m, *a, *b) <= range_m)
                .copied()
                .collect(),
        }
    }

    /// The distance along a ray to the first thing it meets; infinite when there is none.
    fn cast(&self, origin: [f64; 2], direction: [f64; 2]) -> f64 {
        let discs = self.discs.iter().map(|disc| cast_at_disc(origin, direction, disc));
        let faces = self.faces.iter().map(|&[a, b]| cast_at_face(origin, direction, a, b));
        discs.chain(faces).fold(f64::INFINITY, f64::min)
    }
}

fn cast_at_disc(origin: [f64; 2], direction: [f64; 2], disc: &Disc) -> f64 {
    let offset = [disc.center_m[0] - origin[0], disc.center_m[1] - origin[1]];
    let along = offset[0] * direction[0] + offset[1] * direction[1];
    let across = offset[0] * direction[1] - offset[1] * direction[0];
    let half_chord = disc.radius_m * disc.radius_m - across * across;
    if half_chord < 0.0 || along + half_chord.sqrt() < 0.0 {
        return f64::INFINITY;
    }
    (along - half_chord.sqrt()).max(0.0)
}

fn cast_at_face(origin: [f64; 2], direction: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let side = [b[0] - a[0], b[1] - a[1]];
    let offset = [a[0] - origin[0], a[1] - origin[1]];
    let turn = direction[0] * side[1] - direction[1] * side[0];
    if turn == 0.0 {
        return f64::INFINITY;
    }
    let range = (offset[0] * side[1] - offset[1] * side[0]) / turn;
    let share = (offset[0] * direction[1] - offset[1] * direction[0]) / turn;
    if range >= 0.0 && (0.0..=1.0).contains(&share) { range } else { f64::INFINITY }
}

fn distance_to_segment(point: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let side = [b[0] - a[0], b[1] - a[1]];
    let squared = side[0] * side[0] + side[1] * side[1];
    let share = if squared > 0.0 {
        (((point[0] - a[0]) * side[0] + (point[1] - a[1]) * side[1]) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    distance(point, [a[0] + side[0] * share, a[1] + side[1] * share])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn world() -> FineWorld {
        let mut world = FineWorld::default();
        world.add(&Obstacle::Circle { center_m: [5.0, 0.0], radius_m: 1.0 });
        world.add(&Obstacle::Polygon { corners_m: vec![[-2.0, 3.0], [2.0, 3.0], [2.0, 4.0], [-2.0, 4.0]] });
        world
    }

    #[test]
    fn rays_end_at_the_nearest_surface() {
        let exact = LaserModel { noise_m: 0.0, ..LaserModel::SICK };
        let scan = world().scan([0.0, 0.0], FRAC_PI_2, &exact, &mut Random::from_seed(1));
        assert_eq!(scan.ranges_m.len(), 181);
        // The rightmost ray looks east at the disc, the middle one north at the wall, the leftmost west at nothing.
        assert!((scan.ranges_m[0].unwrap() - 4.0).abs() < 1e-9);
        assert!((scan.ranges_m[90].unwrap() - 3.0).abs() < 1e-9);
        assert_eq!(scan.ranges_m[180], None);
        for point in scan.points_m() {
            assert!(world().distance_m(point) < 1e-9, "{point:?} is on no surface");
        }
    }

    #[test]
    fn noise_has_its_standard_deviation_and_its_seed() {
        let look =
            |seed| world().scan([0.0, 0.0], FRAC_PI_2, &LaserModel::SICK, &mut Random::from_seed(seed));
        assert_eq!(look(4), look(4));
        assert_ne!(look(4), look(5));
        let errors: Vec<f64> = (0..2000).map(|seed| look(seed).ranges_m[90].unwrap() - 3.0).collect();
        let deviation = (errors.iter().map(|error| error * error).sum::<f64>() / 2000.0).sqrt();
        assert!((deviation - 0.015).abs() < 0.001, "{deviation}");
    }

    #[test]
    fn nothing_is_seen_beyond_the_range() {
        let short = LaserModel { range_m: 2.5, ..LaserModel::SICK };
        for heading in [0.0, FRAC_PI_2, PI] {
            let scan = world().scan([0.0, 0.0], heading, &short, &mut Random::from_seed(1));
            assert!(scan.ranges_m.iter().all(Option::is_none));
        }
    }
}
