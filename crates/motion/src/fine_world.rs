//! What stands on the ground, finer than the map shows it: shapes, how near they are, and where rays meet them (SPEC 7.4).

use nalgebra::Point2;
use parry2d_f64::bounding_volume::{BoundingSphere, BoundingVolume as _};
use parry2d_f64::query::details::ray_toi_with_ball;
use parry2d_f64::query::{PointQuery as _, Ray, RayCast as _};
use parry2d_f64::shape::{Ball, Segment};
use terrain::{Obstacle, Terrain};

/// The things that vehicles can touch and range sensors see: discs and straight faces, in meters.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FineWorld {
    discs: Vec<Disc>,
    faces: Vec<Segment>,
    /// What lies below the plane of range finders: vehicles touch it, and sonars hear it.
    low: Vec<Disc>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Disc {
    center_m: Point2<f64>,
    shape: Ball,
    is_rock: bool,
}

impl FineWorld {
    /// The rocks of a map from a diameter in meters on, also those too small for the map, and declared obstacles.
    pub fn new(terrain: &Terrain, obstacles: &[Obstacle], min_rock_m: f64) -> Self {
        let mut world = Self::default();
        for rock in terrain.rocks().iter().filter(|rock| rock.diameter_m >= min_rock_m) {
            let shape = Ball::new(0.5 * rock.diameter_m);
            world.discs.push(Disc { center_m: rock.center_m, shape, is_rock: true });
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
                self.discs.push(Disc { center_m: *center_m, shape: Ball::new(*radius_m), is_rock: false });
            }
            Obstacle::Polygon { corners_m } => {
                let next = corners_m.iter().cycle().skip(1);
                self.faces.extend(corners_m.iter().zip(next).map(|(&a, &b)| Segment::new(a, b)));
            }
        }
    }

    /// Takes away the rocks that come within a range of a point, because a vehicle stands there.
    pub fn clear_rocks(&mut self, point_m: Point2<f64>, range_m: f64) {
        self.discs.retain(|disc| !disc.is_rock || disc.distance_m(point_m) >= range_m);
    }

    /// Puts a round thing into the world that lies below the plane of range finders; a polygon stands as high as any.
    pub fn add_low(&mut self, obstacle: &Obstacle) {
        match obstacle {
            Obstacle::Circle { center_m, radius_m } => {
                self.low.push(Disc { center_m: *center_m, shape: Ball::new(*radius_m), is_rock: false });
            }
            Obstacle::Polygon { .. } => self.add(obstacle),
        }
    }

    /// Returns whether something lies below the plane of range finders.
    pub(crate) const fn has_low(&self) -> bool {
        !self.low.is_empty()
    }

    /// Meters from a point to the nearest surface, 0 inside a disc; infinite in an empty world.
    pub fn distance_m(&self, point_m: Point2<f64>) -> f64 {
        let discs = self.discs.iter().chain(&self.low).map(|disc| disc.distance_m(point_m));
        let faces = self.faces.iter().map(|face| face.distance_to_local_point(&point_m, true));
        discs.chain(faces).fold(f64::INFINITY, f64::min)
    }

    /// Returns what of it comes within a range of a point.
    pub fn around(&self, point_m: Point2<f64>, range_m: f64) -> Self {
        let reach = BoundingSphere::new(point_m, range_m);
        let is_near = |disc: &&Disc| reach.intersects(&BoundingSphere::new(disc.center_m, disc.shape.radius));
        let is_in_reach = |face: &&Segment| face.distance_to_local_point(&point_m, true) <= range_m;
        Self {
            discs: self.discs.iter().filter(is_near).copied().collect(),
            faces: self.faces.iter().filter(is_in_reach).copied().collect(),
            low: self.low.iter().filter(is_near).copied().collect(),
        }
    }

    /// The distance along a ray with a unit direction to the first thing it meets within a range.
    pub(crate) fn cast(&self, ray: &Ray, range_m: f64) -> Option<f64> {
        let discs = self.discs.iter().filter_map(|disc| disc.cast(ray));
        let faces = self.faces.iter().filter_map(|face| face.cast_local_ray(ray, range_m, true));
        discs.chain(faces).filter(|&range| range <= range_m).min_by(f64::total_cmp)
    }

    /// The same of a ray along the ground, which meets what is low as well.
    pub(crate) fn cast_low(&self, ray: &Ray, range_m: f64) -> Option<f64> {
        let low = self.low.iter().filter_map(|disc| disc.cast(ray)).filter(|&range| range <= range_m);
        low.chain(self.cast(ray, range_m)).min_by(f64::total_cmp)
    }
}

impl Disc {
    fn distance_m(&self, point_m: Point2<f64>) -> f64 {
        let offset = Point2::from(point_m - self.center_m);
        self.shape.distance_to_local_point(&offset, true)
    }

    /// Returns where a ray meets it; 0 for a ray that begins inside.
    fn cast(&self, ray: &Ray) -> Option<f64> {
        ray_toi_with_ball(&self.center_m, self.shape.radius, ray, true).1
    }
}
