//! What stands and lies on the ground: obstacles, locations, search trees, paths, trails, vehicles, and what a tool has.

use glam::{Vec2, Vec3};
use nalgebra::Point2;
use rmpl::program::{ObstacleShape, VehicleDecl, World};
use snapshot::Snapshot;
use workbench::state::Selection;
use workbench::state::growth::Growth;

use crate::dash::{DASHES, dashed};
use crate::driving;
use crate::ground::Ground;
use crate::shadow;
use crate::shapes::{Shapes, circle_outline};
use crate::sights;
use crate::tree;
use crate::vehicles::{VehicleShape, airship, rover};
use crate::volume::Volume;

/// The colors of the scene. They do not depend on the theme, because the ground does not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScenePalette {
    /// Posts, rims and paths.
    pub light: [f32; 4],
    /// Under light lines, to set them off.
    pub under: [f32; 4],
    /// The fences around obstacles.
    pub fence: [f32; 4],
    /// Obstacles that are volumes.
    pub stone: [f32; 4],
    /// Whatever is selected.
    pub selected: [f32; 4],
    /// Trees that grow from the start and from the goal.
    pub trees: [[f32; 4]; 2],
    /// Places where vehicles come too near each other, and views that are blocked.
    pub warning: [f32; 4],
    /// Vehicles, by turns.
    pub vehicles: [[f32; 4]; 6],
}

/// What is shown beside the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneOptions {
    /// The trees that found the paths.
    pub trees: bool,
    pub paths: bool,
    /// Declared obstacles.
    pub obstacles: bool,
    /// What laser range finders see, in a run.
    pub rays: bool,
    /// What is in sight of what, as far as conditions ask.
    pub sights: bool,
    /// Where shadows come from, if vehicles throw shadows and leave tracks, and obstacles are volumes.
    pub sun: Option<Vec3>,
    /// How many times larger than life vehicles are drawn.
    pub vehicle_scale: f32,
}

/// What the scene is built from.
#[derive(Clone, Copy)]
pub struct SceneInput<'a> {
    pub snapshot: &'a Snapshot,
    pub ground: &'a Ground,
    /// In mission units.
    pub time: f64,
    /// The run that is shown, if one is.
    pub run: Option<&'a snapshot::Execution>,
    /// What is selected in all panels.
    pub selection: &'a Selection,
    /// What the pointer is over in some panel.
    pub hovered: &'a Selection,
    /// A search that is looked at.
    pub growth: &'a Growth,
    pub palette: &'a ScenePalette,
    /// What is shown.
    pub options: &'a SceneOptions,
    /// What a tool in hand has and would do.
    pub sketch: &'a Sketch,
    /// Obstacles that have appeared in the run that is watched, with centers and radii in meters.
    pub appeared: &'a [(Point2<f64>, f64)],
}

/// What a tool has so far, to be drawn on the ground.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sketch {
    /// Lines along the ground.
    pub lines: Vec<[Vec2; 2]>,
    /// Straight lines through the air, and whether nothing is in their way.
    pub sights: Vec<(Vec3, Vec3, bool)>,
    /// Places marked by small rings.
    pub marks: Vec<Vec2>,
    /// A place where the view is blocked.
    pub blocked: Option<Vec3>,
    pub disc: Option<(Vec2, f32)>,
}

/// The height of the posts at locations, in meters.
pub const POST_M: f32 = 7.0;
const FENCE_M: f32 = 2.0;
/// Wheel tracks are drawn up to this scale of vehicles. From farther away, they are too thin to see.
const MAX_TRACK_SCALE: f32 = 2.0;
/// The height of a rover with its mast, in lengths of its body.
const ROVER_HEIGHT: f32 = 0.85;
const TRACK_COLOR: [f32; 4] = [0.16, 0.10, 0.07, 0.55];

/// Builds the scene.
pub fn build(input: &SceneInput<'_>) -> Shapes {
    let mut shapes = Shapes::default();
    let world = &input.snapshot.program.world;
    if input.options.obstacles {
        obstacles(&mut shapes, world, input);
    }
    for &(center_m, radius_m) in input.appeared {
        let outline = circle_outline(place(center_m), radius_m as f32);
        let rim = (input.palette.warning, 3.0);
        let Some(sun) = input.options.sun else {
            shapes.fence(input.ground, &outline, FENCE_M, faded(input.palette.warning, 0.5), rim);
            continue;
        };
        let volume = Volume::new(outline);
        let mut body = Shapes::default();
        volume.draw(&mut body, input.ground, input.palette.stone);
        shadow::cast(&mut shapes, input.ground, &body, sun);
        shapes.append(body);
        shapes.rim(input.ground, &volume.outline_m, volume.height_m, rim);
    }
    locations(&mut shapes, world, input);
    if input.growth.shown().is_none() {
        paths(&mut shapes, input);
    }
    if input.options.sights {
        sights::draw(&mut shapes, input);
    }
    separation_violations(&mut shapes, input);
    driving::draw(&mut shapes, input);
    vehicles(&mut shapes, input);
    tree::draw(&mut shapes, input);
    sketch(&mut shapes, input);
    shapes
}

/// A position of the program in the renderer's precision.
pub fn place(point_m: impl Into<Point2<f64>>) -> Vec2 {
    let point_m = point_m.into();
    Vec2::new(point_m.x as f32, point_m.y as f32)
}

/// Returns where a vehicle is and where its nose points at `time`: on its way, or at its start.
pub fn vehicle_pose(snapshot: &Snapshot, vehicle: usize, time: f64) -> Option<(Vec2, f32)> {
    let motion = snapshot.motions.iter().find(|motion| motion.vehicle as usize == vehicle);
    if let Some((motion, (position, heading))) = motion.and_then(|motion| Some((motion, motion.at(time)?))) {
        return Some((place(position), smooth_heading(motion, time).unwrap_or(heading as f32)));
    }
    // Vehicles that share a start stand beside each other.
    let occurrences = snapshot.network.as_ref().map_or(&[][..], |network| &network.occurrences);
    let start = snapshot::standing::starts(&snapshot.program, occurrences).get(vehicle).copied().flatten()?;
    Some((place(start.place_m), 0.0))
}

/// The direction in which a moving vehicle turns its nose: it takes corners of its path over a short way, as wheels do.
/// `None` where it stands still.
fn smooth_heading(motion: &snapshot::VehicleMotion, time: f64) -> Option<f32> {
    const HALF_WAY_M: f64 = 0.7;
    let at = |time: f64| motion.at(time).map(|(position, _)| place(position));
    let seconds = |frame: &snapshot::Keyframe| frame.time.to_f64();
    let after = motion.keyframes.partition_point(|frame| seconds(frame) <= time);
    let (before, next) = (motion.keyframes.get(after.checked_sub(1)?)?, motion.keyframes.get(after)?);
    let way_m = place(before.position_m).distance(place(next.position_m));
    let duration = seconds(next) - seconds(before);
    if way_m < 1e-3 || duration <= 0.0 {
        return None;
    }
    let half = HALF_WAY_M * duration / f64::from(way_m);
    let ahead = at(time + half)? - at(time - half)?;
    (ahead.length() > 1e-3).then(|| ahead.to_angle())
}

/// Returns how high over the ground below a vehicle flies at a place; `None` for one that drives.
pub fn flight_height_m(ground: &Ground, world: &World, vehicle: &VehicleDecl, place_m: Vec2) -> Option<f32> {
    let model = snapshot::vehicle::model(world, &vehicle.model.text)?;
    let motion::Drive::Flight { altitude_band_m: [low, high], ground_clearance_m, .. } = model.drive else {
        return None;
    };
    let below_m = ground.height_at(place_m);
    let cruise_m = ground.range_m[0] + f64::midpoint(low, high) as f32;
    Some((cruise_m - below_m).max(ground_clearance_m as f32))
}

/// The outline of an obstacle in meters.
pub fn outline(shape: &ObstacleShape) -> Vec<Vec2> {
    match shape {
        ObstacleShape::Circle { center_m, radius_m } => circle_outline(place(*center_m), *radius_m as f32),
        ObstacleShape::Polygon { corners_m } => corners_m.iter().map(|&corner| place(corner)).collect(),
    }
}

/// A light line along the ground, set off by a dark one under it.
pub fn cased_line(
    shapes: &mut Shapes,
    ground: &Ground,
    ends_m: [Vec2; 2],
    width_px: f32,
    color: [f32; 4],
    under: [f32; 4],
) {
    cased_lines(shapes, ground, &[ends_m], width_px, color, under);
}

/// Lines on the ground with a casing, all of the casing below: beside a short line it would cover the next one.
pub fn cased_lines(
    shapes: &mut Shapes,
    ground: &Ground,
    lines_m: &[[Vec2; 2]],
    width_px: f32,
    color: [f32; 4],
    under: [f32; 4],
) {
    for &ends_m in lines_m {
        shapes.draped_line(ground, ends_m, width_px + 2.6, under);
    }
    for &ends_m in lines_m {
        shapes.draped_line(ground, ends_m, width_px, color);
    }
}

fn ring(
    shapes: &mut Shapes,
    input: &SceneInput<'_>,
    center_m: Vec2,
    radius_m: f32,
    color: [f32; 4],
    width: f32,
) {
    let corners = circle_outline(center_m, radius_m);
    let sides = || corners.iter().zip(corners.iter().cycle().skip(1)).map(|(&from, &to)| [from, to]);
    for side in sides() {
        shapes.draped_line(input.ground, side, width + 2.0, input.palette.under);
    }
    for side in sides() {
        shapes.draped_line(input.ground, side, width, color);
    }
}

fn obstacles(shapes: &mut Shapes, world: &World, input: &SceneInput<'_>) {
    let palette = input.palette;
    for obstacle in &world.obstacles {
        let own = Selection::Obstacle(obstacle.name.text.clone());
        let rim = match (*input.selection == own, *input.hovered == own) {
            (true, _) => (palette.selected, 3.0),
            (_, true) => (palette.light, 2.5),
            _ => (faded(palette.light, 0.75), 1.4),
        };
        let outline = outline(&obstacle.shape);
        if obstacle.is_solid() {
            match input.options.sun {
                // The volume itself is on the graphics card.
                Some(_) => {
                    let volume = Volume::new(outline);
                    shapes.rim(input.ground, &volume.outline_m, volume.height_m, rim);
                }
                None => shapes.fence(input.ground, &outline, FENCE_M, palette.fence, rim),
            }
            continue;
        }
        // Nothing stands there: the rim lies on the ground, in dashes.
        let closed: Vec<Vec2> = outline.iter().chain(outline.first()).copied().collect();
        for dash in dashed(&closed, DASHES[1], input.options.vehicle_scale) {
            shapes.draped_line(input.ground, dash, rim.1 + 2.0, palette.under);
            shapes.draped_line(input.ground, dash, rim.1, rim.0);
        }
    }
}

fn locations(shapes: &mut Shapes, world: &World, input: &SceneInput<'_>) {
    let palette = input.palette;
    for location in &world.locations {
        let own = Selection::Location(location.name.text.clone());
        let (color, width) = match (*input.selection == own, *input.hovered == own) {
            (true, _) => (palette.selected, 3.0),
            (_, true) => (palette.light, 2.6),
            _ => (palette.light, 1.8),
        };
        let foot = input.ground.drape(place(location.position_m), 0.0);
        let top = foot + Vec3::Z * POST_M;
        shapes.line(foot, top, width + 2.0, palette.under);
        shapes.line(foot, top, width, color);
        ring(shapes, input, place(location.position_m), 2.2, color, width);
    }
}

fn paths(shapes: &mut Shapes, input: &SceneInput<'_>) {
    let palette = input.palette;
    let network = input.snapshot.network.as_deref();
    let is_of = |selection: &Selection, occurrence| {
        network.is_some_and(|network| selection.occurrence(network) == Some(occurrence))
    };
    for traverse in &*input.snapshot.traverses {
        let (color, width) = match () {
            () if is_of(input.selection, traverse.occurrence) => (palette.selected, 4.0),
            () if is_of(input.hovered, traverse.occurrence) => (palette.light, 4.0),
            () => (palette.light, 2.6),
        };
        for leg in &traverse.legs {
            if input.options.trees {
                for [from, to] in leg.tree_m.iter() {
                    let color = faded(palette.light, 0.4);
                    shapes.draped_line(input.ground, [place(*from), place(*to)], 1.0, color);
                }
            }
            if input.options.paths {
                for pair in leg.points_m.windows(2) {
                    let ends = [place(pair[0]), place(pair[1])];
                    cased_line(shapes, input.ground, ends, width, color, palette.under);
                }
            }
        }
    }
}

fn separation_violations(shapes: &mut Shapes, input: &SceneInput<'_>) {
    for violation in &*input.snapshot.separation_violations {
        ring(shapes, input, place(violation.position_m), 4.0, input.palette.warning, 3.0);
    }
}

fn vehicles(shapes: &mut Shapes, input: &SceneInput<'_>) {
    let SceneInput { snapshot, ground, time, palette, options, .. } = *input;
    for (index, vehicle) in snapshot.program.world.vehicles.iter().enumerate() {
        let Some((position, heading_rad)) = vehicle_pose(snapshot, index, time) else { continue };
        let selected = *input.selection == Selection::Vehicle(vehicle.name.text.clone());
        let color = palette.vehicles[index % palette.vehicles.len()];
        let model = snapshot::vehicle::model(&snapshot.program.world, &vehicle.model.text);
        let (length_m, width_m) =
            model.map_or((1.0, 0.8), |model| (model.length_m as f32, model.width_m as f32));
        // Airships are large enough to be seen as they are.
        let height_m = flight_height_m(ground, &snapshot.program.world, vehicle, position);
        let has_tracks =
            options.sun.is_some() && height_m.is_none() && options.vehicle_scale <= MAX_TRACK_SCALE;
        let driven_m = trail(
            shapes,
            input,
            index,
            (color, has_tracks.then_some(width_m * options.vehicle_scale * 0.84)),
        );
        let scale = if height_m.is_some() { options.vehicle_scale.sqrt() } else { options.vehicle_scale };
        let shape = VehicleShape {
            place_m: position,
            heading_rad,
            length_m: length_m * scale,
            width_m: width_m * scale,
            color,
            driven_lengths: driven_m / (length_m * scale),
        };
        let around = if selected { palette.selected } else { color };
        ring(shapes, input, position, shape.length_m * 0.85, around, if selected { 3.0 } else { 1.6 });
        let mut body = Shapes::default();
        match height_m {
            Some(height_m) => {
                let foot = ground.drape(position, 0.0);
                shapes.air_line(foot, foot + Vec3::Z * height_m, 1.2, faded(palette.light, 0.5));
                airship(&mut body, &shape, foot.z + height_m);
            }
            None => rover(&mut body, ground, &shape),
        }
        if let Some(sun) = options.sun {
            shadow::cast(shapes, ground, &body, sun);
        }
        shapes.append(body);
    }
}

/// Draws the path of a vehicle so far, and its wheel tracks if a gauge is given; returns how long it is, in meters.
fn trail(
    shapes: &mut Shapes,
    input: &SceneInput<'_>,
    vehicle: usize,
    (color, gauge_m): ([f32; 4], Option<f32>),
) -> f32 {
    let motion = input.snapshot.motions.iter().find(|motion| motion.vehicle as usize == vehicle);
    let Some((motion, (now, _))) = motion.and_then(|motion| Some((motion, motion.at(input.time)?))) else {
        return 0.0;
    };
    let mut driven_m = 0.0;
    let mut before: Option<Vec2> = None;
    for frame in &motion.keyframes {
        let frame_time = frame.time.to_f64();
        let is_done = frame_time > input.time;
        let next = place(if is_done { now } else { frame.position_m });
        if let Some(before) = before.filter(|before| before.distance(next) > 0.01) {
            if let Some(gauge_m) = gauge_m {
                let aside = (next - before).normalize_or_zero().perp() * (gauge_m / 2.0);
                for side in [aside, -aside] {
                    shapes.draped_line(input.ground, [before + side, next + side], 3.0, TRACK_COLOR);
                }
            }
            // The leader's trail is wider, so that those that follow in its track are seen on it.
            let width = if vehicle == 0 { 6.0 } else { 3.0 };
            shapes.draped_line(input.ground, [before, next], width, color);
            driven_m += before.distance(next);
        }
        before = Some(next);
        if is_done {
            break;
        }
    }
    driven_m
}

/// The volumes of the obstacles that something stands at, in their order.
pub fn volumes(world: &World) -> Vec<Volume> {
    let solid = world.obstacles.iter().filter(|it| it.is_solid());
    solid.map(|it| Volume::new(outline(&it.shape))).collect()
}

/// The corners in space of the box around a vehicle as it is drawn.
pub fn vehicle_box_m(input: &VehicleBox<'_>) -> Option<[Vec3; 8]> {
    let VehicleBox { snapshot, ground, vehicle: index, time, vehicle_scale } = *input;
    let vehicle = snapshot.program.world.vehicles.get(index)?;
    let (place_m, heading_rad) = vehicle_pose(snapshot, index, time)?;
    let model = snapshot::vehicle::model(&snapshot.program.world, &vehicle.model.text);
    let (length_m, width_m) = model.map_or((1.0, 0.8), |it| (it.length_m as f32, it.width_m as f32));
    let flight_m = flight_height_m(ground, &snapshot.program.world, vehicle, place_m);
    let scale = if flight_m.is_some() { vehicle_scale.sqrt() } else { vehicle_scale };
    let (half, aside) = (length_m * scale / 2.0, width_m * scale / 2.0);
    let [low, high] = match flight_m {
        Some(height_m) => [height_m - aside * 1.3, height_m + aside],
        None => [0.0, length_m * scale * ROVER_HEIGHT],
    };
    let foot = ground.drape(place_m, 0.0);
    let (ahead, left) = (Vec2::from_angle(heading_rad) * half, Vec2::from_angle(heading_rad).perp() * aside);
    Some(std::array::from_fn(|corner| {
        let sign = |bit: usize| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
        foot + (ahead * sign(0) + left * sign(1)).extend(if corner >> 2 & 1 == 1 { high } else { low })
    }))
}

/// Which vehicle, and when.
#[derive(Clone, Copy, Debug)]
pub struct VehicleBox<'a> {
    pub snapshot: &'a Snapshot,
    pub ground: &'a Ground,
    /// As an index into the program's world.
    pub vehicle: usize,
    /// In mission units.
    pub time: f64,
    /// How many times larger than life vehicles are drawn.
    pub vehicle_scale: f32,
}

fn sketch(shapes: &mut Shapes, input: &SceneInput<'_>) {
    let (palette, sketch) = (input.palette, input.sketch);
    for &ends in &sketch.lines {
        cased_line(shapes, input.ground, ends, 2.4, palette.selected, palette.under);
    }
    for &(from, to, is_clear) in &sketch.sights {
        let color = if is_clear { palette.light } else { palette.warning };
        shapes.line(from, to, 1.6, faded(color, 0.9));
        for end in [from, to] {
            let foot = input.ground.drape(end.truncate(), 0.0);
            shapes.line(foot, end, 2.0, palette.light);
        }
    }
    if let Some((center, radius_m)) = sketch.disc {
        ring(shapes, input, center, radius_m, palette.selected, 2.4);
    }
    // Marks are as large on the screen as vehicles are.
    let radius_m = 0.5 * input.options.vehicle_scale;
    for &mark in &sketch.marks {
        ring(shapes, input, mark, radius_m, palette.selected, 2.4);
    }
    if let Some(blocked) = sketch.blocked {
        let up = Vec3::Z * radius_m * 3.0;
        shapes.line(blocked, blocked + up, 3.0, palette.warning);
        ring(shapes, input, blocked.truncate(), radius_m * 1.4, palette.warning, 3.0);
    }
}

/// A color with less opacity.
pub fn faded([red, green, blue, opacity]: [f32; 4], part: f32) -> [f32; 4] {
    [red, green, blue, opacity * part]
}
