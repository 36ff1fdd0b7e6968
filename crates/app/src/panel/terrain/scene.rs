//! What stands and lies on the ground: obstacles, locations, search trees, paths, trails and vehicles.

use glam::{Vec2, Vec3};
use mission::Snapshot;
use rmpl::program::{ObstacleShape, World};

use super::ground::Ground;
use super::shapes::{RoverShape, Shapes, circle_outline};
use crate::state::Selection;

/// The colours of the scene, from the theme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScenePalette {
    /// Obstacles.
    pub obstacle: [f32; 4],
    /// The posts of locations.
    pub location: [f32; 4],
    /// Whatever is selected.
    pub selected: [f32; 4],
    /// Edges of search trees.
    pub tree: [f32; 4],
    /// Paths still to drive.
    pub path: [f32; 4],
    /// Places where vehicles come too near each other.
    pub warning: [f32; 4],
    /// Vehicles, by turns.
    pub vehicles: [[f32; 4]; 6],
}

/// What is shown beside the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneOptions {
    /// The trees that found the paths.
    pub trees: bool,
    /// The paths.
    pub paths: bool,
    /// Declared obstacles.
    pub obstacles: bool,
    /// How many times larger than life vehicles are drawn.
    pub vehicle_scale: f32,
}

/// Builds the scene at `time`, in mission units.
pub fn build(
    snapshot: &Snapshot,
    ground: &Ground,
    time: f64,
    selection: &Selection,
    palette: &ScenePalette,
    options: &SceneOptions,
) -> Shapes {
    let mut shapes = Shapes::default();
    let world = &snapshot.program.world;
    if options.obstacles {
        obstacles(&mut shapes, world, ground, selection, palette);
    }
    locations(&mut shapes, world, ground, selection, palette);
    paths(&mut shapes, snapshot, ground, selection, palette, options);
    encounters(&mut shapes, snapshot, ground, palette);
    vehicles(&mut shapes, snapshot, ground, time, selection, palette, options);
    shapes
}

/// A position of the program in the renderer's precision.
pub fn place([east, north]: [f64; 2]) -> Vec2 {
    Vec2::new(east as f32, north as f32)
}

/// Where a vehicle is and where its nose points at `time`: on its way, or at its start.
pub fn vehicle_pose(snapshot: &Snapshot, vehicle: usize, time: f64) -> Option<(Vec2, f32)> {
    let motion = snapshot.motions.iter().find(|motion| motion.vehicle as usize == vehicle);
    if let Some((position, heading)) = motion.and_then(|motion| motion.at(time)) {
        return Some((place(position), heading as f32));
    }
    let world = &snapshot.program.world;
    let start = &world.vehicles.get(vehicle)?.start.text;
    let location = world.locations.iter().find(|location| location.name.text == *start)?;
    // Vehicles that share a start are drawn beside each other.
    let before = world.vehicles.iter().take(vehicle).filter(|other| other.start.text == *start).count();
    Some((place(location.position_m) + Vec2::new(0.0, -2.0 * before as f32), 0.0))
}

/// The outline of an obstacle in metres.
pub fn outline(shape: &ObstacleShape) -> Vec<Vec2> {
    match shape {
        ObstacleShape::Circle { center_m, radius_m } => circle_outline(place(*center_m), *radius_m as f32),
        ObstacleShape::Polygon { corners_m } => corners_m.iter().map(|&corner| place(corner)).collect(),
    }
}

fn obstacles(
    shapes: &mut Shapes,
    world: &World,
    ground: &Ground,
    selection: &Selection,
    palette: &ScenePalette,
) {
    for obstacle in &world.obstacles {
        let selected = *selection == Selection::Obstacle(obstacle.name.text.clone());
        let color = if selected { palette.selected } else { palette.obstacle };
        let outline = outline(&obstacle.shape);
        shapes.prism(ground, &outline, 2.5, color);
    }
}

fn locations(
    shapes: &mut Shapes,
    world: &World,
    ground: &Ground,
    selection: &Selection,
    palette: &ScenePalette,
) {
    for location in &world.locations {
        let selected = *selection == Selection::Location(location.name.text.clone());
        let color = if selected { palette.selected } else { palette.location };
        let foot = ground.drape(place(location.position_m), 0.0);
        shapes.line(foot, foot + Vec3::Z * 7.0, if selected { 3.0 } else { 2.0 }, color);
        let ring = circle_outline(place(location.position_m), 2.2);
        for (from, to) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            shapes.draped_line(ground, [*from, *to], 2.0, color);
        }
    }
}

fn paths(
    shapes: &mut Shapes,
    snapshot: &Snapshot,
    ground: &Ground,
    selection: &Selection,
    palette: &ScenePalette,
    options: &SceneOptions,
) {
    for traverse in &snapshot.traverses {
        let selected = snapshot
            .network
            .as_deref()
            .is_some_and(|network| selection.occurrence(network) == Some(traverse.occurrence));
        for leg in &traverse.legs {
            if options.trees {
                for [from, to] in leg.tree_m.iter() {
                    shapes.draped_line(ground, [place(*from), place(*to)], 1.0, palette.tree);
                }
            }
            if options.paths {
                let (color, width) = if selected { (palette.selected, 5.0) } else { (palette.path, 3.0) };
                for pair in leg.points_m.windows(2) {
                    shapes.draped_line(ground, [place(pair[0]), place(pair[1])], width, color);
                }
            }
        }
    }
}

fn encounters(shapes: &mut Shapes, snapshot: &Snapshot, ground: &Ground, palette: &ScenePalette) {
    for encounter in &snapshot.encounters {
        let ring = circle_outline(place(encounter.position_m), 4.0);
        for (from, to) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            shapes.draped_line(ground, [*from, *to], 3.0, palette.warning);
        }
    }
}

fn vehicles(
    shapes: &mut Shapes,
    snapshot: &Snapshot,
    ground: &Ground,
    time: f64,
    selection: &Selection,
    palette: &ScenePalette,
    options: &SceneOptions,
) {
    for (index, vehicle) in snapshot.program.world.vehicles.iter().enumerate() {
        let Some((position, heading_rad)) = vehicle_pose(snapshot, index, time) else { continue };
        let selected = *selection == Selection::Vehicle(vehicle.name.text.clone());
        let own = palette.vehicles[index % palette.vehicles.len()];
        let color = if selected { palette.selected } else { own };
        trail(shapes, snapshot, ground, index, time, own);
        let model = motion::vehicle_model(&vehicle.model.text);
        let (length_m, width_m) =
            model.map_or((1.0, 0.8), |model| (model.length_m as f32, model.width_m as f32));
        let shape = RoverShape {
            place_m: position,
            heading_rad,
            length_m: length_m * options.vehicle_scale,
            width_m: width_m * options.vehicle_scale,
            color,
        };
        match model.map(|model| model.drive) {
            Some(motion::Drive::Flight { altitude_band_m: [low, high], .. }) => {
                shapes.blimp(ground, &shape, f64::midpoint(low, high) as f32);
            }
            _ => shapes.rover(ground, &shape),
        }
    }
}

fn trail(
    shapes: &mut Shapes,
    snapshot: &Snapshot,
    ground: &Ground,
    vehicle: usize,
    time: f64,
    color: [f32; 4],
) {
    let Some(motion) = snapshot.motions.iter().find(|motion| motion.vehicle as usize == vehicle) else {
        return;
    };
    let Some((now, _)) = motion.at(time) else { return };
    let mut before: Option<Vec2> = None;
    for frame in &motion.keyframes {
        let frame_time = *frame.time.numer() as f64 / *frame.time.denom() as f64;
        let (next, done) =
            if frame_time <= time { (place(frame.position_m), false) } else { (place(now), true) };
        if let Some(before) = before.filter(|before| before.distance(next) > 0.01) {
            shapes.draped_line(ground, [before, next], 3.5, color);
        }
        before = Some(next);
        if done {
            break;
        }
    }
}
