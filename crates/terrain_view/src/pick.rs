//! What is under the pointer: a name, a vehicle, a location, an obstacle, a path, or the bare ground.

use egui::{Pos2, Rect};
use glam::{Vec2, Vec3};
use rmpl::program::ObstacleShape;
use snapshot::Snapshot;
use workbench::state::{AppState, Selection};

use crate::camera::Camera;
use crate::ground::Ground;
use crate::outline::is_inside;
use crate::scene;

/// What picking looks at.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// The image in the window.
    pub rect: Rect,
    pub camera: &'a Camera,
    pub ground: &'a Ground,
    pub snapshot: &'a Snapshot,
    pub state: &'a AppState,
    /// The plates with names, as they were painted last.
    pub plates: &'a [(Rect, Selection)],
}

/// A place on a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnPath {
    /// The traverse, as an index into the snapshot's.
    pub traverse: usize,
    /// Its leg, from 0.
    pub leg: usize,
    pub place_m: Vec2,
}

/// Pointers this near to a post or a vehicle, in points, are on it.
const REACH: f32 = 14.0;
/// Pointers this near to one, in points, can take hold of it.
const HANDLE_REACH: f32 = 9.0;
/// Pointers this near to a path, in points, are on it.
const PATH_REACH: f32 = 8.0;
/// Meters between the points of a path that are looked at.
const PATH_STEP_M: f32 = 4.0;

impl Scene<'_> {
    /// The size of the image in points.
    pub fn size(&self) -> Vec2 {
        Vec2::new(self.rect.width(), self.rect.height())
    }

    /// A point of the window in the image.
    fn inside(&self, pointer: Pos2) -> Vec2 {
        Vec2::new(pointer.x - self.rect.min.x, pointer.y - self.rect.min.y)
    }

    /// The ground under a point of the window, in space.
    pub fn hit(&self, pointer: Pos2) -> Option<Vec3> {
        let (origin, direction) = self.camera.ray(self.inside(pointer), self.size());
        self.ground.hit(origin, direction)
    }

    /// The place under a point of the window.
    pub fn ground_at(&self, pointer: Pos2) -> Option<Vec2> {
        self.hit(pointer).map(Vec3::truncate)
    }

    /// Returns what is under a point of the window.
    pub fn pick(&self, pointer: Pos2) -> Selection {
        if let Some((_, named)) = self.plates.iter().find(|(plate, _)| plate.contains(pointer)) {
            return named.clone();
        }
        if let Some(standing) = self.pick_standing(pointer, REACH) {
            return standing;
        }
        if let Some(on_path) = self.pick_path(pointer) {
            return Selection::Occurrence(self.snapshot.traverses[on_path.traverse].occurrence);
        }
        let Some(hit) = self.ground_at(pointer) else { return Selection::None };
        let world = &self.snapshot.program.world;
        let obstacle = world.obstacles.iter().find(|it| contains(&it.shape, hit));
        obstacle.map_or(Selection::None, |it| Selection::Obstacle(it.name.text.clone()))
    }

    /// Returns what a drag from a point of the window takes hold of: the vehicle or the post that is there, or anything
    /// that is selected. A name, or a whole obstacle, is no handle: turning the view must not move what it happens to
    /// begin on.
    pub fn pick_handle(&self, pointer: Pos2) -> Option<Selection> {
        let picked = self.pick(pointer);
        if !picked.is_none() && picked == *self.state.selection {
            return Some(picked);
        }
        let is_on_plate = self.plates.iter().any(|(plate, _)| plate.contains(pointer));
        if is_on_plate { None } else { self.pick_standing(pointer, HANDLE_REACH) }
    }

    /// The nearest vehicle or post of a location, at most `reach` points away.
    fn pick_standing(&self, pointer: Pos2, reach: f32) -> Option<Selection> {
        let (inside, projector) = (self.inside(pointer), self.camera.projector(self.size()));
        let away = |place: Vec2, lift_m: f32| {
            let point = projector.project(self.ground.drape(place, lift_m));
            point.map_or(f32::INFINITY, |point| point.distance(inside))
        };
        let world = &self.snapshot.program.world;
        let time = self.state.playback.time;
        let vehicles = world.vehicles.iter().enumerate().filter_map(|(index, vehicle)| {
            let (place, _) = scene::vehicle_pose(self.snapshot, index, time)?;
            let lift_m = scene::flight_height_m(self.ground, world, vehicle, place).unwrap_or(1.0);
            Some((away(place, lift_m), Selection::Vehicle(vehicle.name.text.clone())))
        });
        let locations = world.locations.iter().map(|location| {
            let place = scene::place(location.position_m);
            let lifts = [0.0, 0.5, 1.0].into_iter().map(|part| away(place, part * scene::POST_M));
            (lifts.fold(f32::INFINITY, f32::min), Selection::Location(location.name.text.clone()))
        });
        let found = vehicles.chain(locations).filter(|(away, _)| *away < reach);
        found.min_by(|(left, _), (right, _)| left.total_cmp(right)).map(|(_, selection)| selection)
    }

    /// The location whose post is under a point of the window.
    pub fn pick_location(&self, pointer: Pos2) -> Option<smol_str::SmolStr> {
        let (inside, projector) = (self.inside(pointer), self.camera.projector(self.size()));
        let locations = self.snapshot.program.world.locations.iter();
        let near = locations.filter_map(|location| {
            let foot = self.ground.drape(scene::place(location.position_m), 0.0);
            let away = projector.project(foot)?.distance(inside);
            (away < REACH * 1.4).then_some((away, location.name.text.clone()))
        });
        near.min_by(|(left, _), (right, _)| left.total_cmp(right)).map(|(_, name)| name)
    }

    /// The place of a path that is nearest to a point of the window, if it is near enough.
    pub fn pick_path(&self, pointer: Pos2) -> Option<OnPath> {
        let (inside, projector) = (self.inside(pointer), self.camera.projector(self.size()));
        let mut best: Option<(f32, OnPath)> = None;
        for (traverse, driven) in self.snapshot.traverses.iter().enumerate() {
            for (leg, way) in driven.legs.iter().enumerate() {
                for pair in way.points_m.windows(2) {
                    let (from, to) = (scene::place(pair[0]), scene::place(pair[1]));
                    let pieces = (from.distance(to) / PATH_STEP_M).ceil().clamp(1.0, 200.0) as u32;
                    let at = |piece: u32| from.lerp(to, piece as f32 / pieces as f32);
                    for piece in 0..pieces {
                        let ends = [at(piece), at(piece + 1)];
                        let shown = ends.map(|end| projector.project(self.ground.drape(end, 0.2)));
                        let [Some(a), Some(b)] = shown else { continue };
                        let part = nearest_part(inside, a, b);
                        let away = inside.distance(a.lerp(b, part));
                        if away < PATH_REACH && best.is_none_or(|(least, _)| away < least) {
                            let place_m = ends[0].lerp(ends[1], part);
                            best = Some((away, OnPath { traverse, leg, place_m }));
                        }
                    }
                }
            }
        }
        best.map(|(_, on_path)| on_path)
    }
}

/// Returns where a selected thing is at `time`.
pub fn place_of(snapshot: &Snapshot, selection: &Selection, time: f64) -> Option<Vec2> {
    let world = &snapshot.program.world;
    match selection {
        Selection::Location(name) => {
            world.locations.iter().find(|it| it.name.text == *name).map(|it| scene::place(it.position_m))
        }
        Selection::Obstacle(name) => {
            let obstacle = world.obstacles.iter().find(|it| it.name.text == *name)?;
            Some(middle(&scene::outline(&obstacle.shape)))
        }
        Selection::Vehicle(name) => {
            let index = world.vehicles.iter().position(|it| it.name.text == *name)?;
            scene::vehicle_pose(snapshot, index, time).map(|(place, _)| place)
        }
        _ => {
            let occurrence = selection.occurrence(snapshot.network.as_deref()?)?;
            let traverse = snapshot.traverses.iter().find(|it| it.occurrence == occurrence)?;
            let points: Vec<Vec2> = traverse
                .legs
                .iter()
                .flat_map(|leg| &leg.points_m)
                .map(|&point| scene::place(point))
                .collect();
            (!points.is_empty()).then(|| middle(&points))
        }
    }
}

/// Returns how much ground a selected thing takes up, in meters.
pub fn extent_of(snapshot: &Snapshot, selection: &Selection) -> f32 {
    let points: Vec<Vec2> = if let Selection::Obstacle(name) = selection {
        let obstacles = &snapshot.program.world.obstacles;
        let found = obstacles.iter().find(|it| it.name.text == *name);
        found.map(|it| scene::outline(&it.shape)).unwrap_or_default()
    } else {
        let network = snapshot.network.as_deref();
        let occurrence = network.and_then(|network| selection.occurrence(network));
        let traverses = snapshot.traverses.iter().filter(|it| Some(it.occurrence) == occurrence);
        let legs = traverses.flat_map(|it| &it.legs);
        legs.flat_map(|leg| &leg.points_m).map(|&point| scene::place(point)).collect()
    };
    let low = points.iter().copied().reduce(Vec2::min).unwrap_or_default();
    let high = points.iter().copied().reduce(Vec2::max).unwrap_or_default();
    (high - low).max_element()
}

fn middle(points: &[Vec2]) -> Vec2 {
    points.iter().copied().sum::<Vec2>() / points.len().max(1) as f32
}

/// Returns whether a place is inside an obstacle.
pub fn contains(shape: &ObstacleShape, point: Vec2) -> bool {
    match shape {
        ObstacleShape::Circle { center_m, radius_m } => {
            scene::place(*center_m).distance(point) <= *radius_m as f32
        }
        ObstacleShape::Polygon { corners_m } => {
            let corners: Vec<Vec2> = corners_m.iter().map(|&corner| scene::place(corner)).collect();
            is_inside(&corners, point)
        }
    }
}

/// Returns which part of the way from `from` to `to` is nearest to `point`, from 0 to 1.
pub fn nearest_part(point: Vec2, from: Vec2, to: Vec2) -> f32 {
    let along = to - from;
    if along.length_squared() > 0.0 {
        ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_inside_a_polygon_or_not() {
        let shape = ObstacleShape::Polygon { corners_m: vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]] };
        assert!(contains(&shape, Vec2::new(3.0, 1.0)));
        assert!(!contains(&shape, Vec2::new(1.0, 3.0)));
    }

    #[test]
    fn the_nearest_part_of_a_way_is_between_its_ends() {
        let (from, to) = (Vec2::ZERO, Vec2::new(10.0, 0.0));
        assert!((nearest_part(Vec2::new(4.0, 7.0), from, to) - 0.4).abs() < 1e-6);
        assert!(nearest_part(Vec2::new(-4.0, 7.0), from, to) == 0.0);
        assert!(nearest_part(Vec2::new(40.0, 7.0), from, to) == 1.0);
    }
}
