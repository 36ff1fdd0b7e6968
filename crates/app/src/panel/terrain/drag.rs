//! Picking things on the ground, and dragging them: their declarations in the text follow the pointer.

use egui::{PointerButton, Pos2, Rect};
use glam::Vec2;
use mission::Snapshot;
use rmpl::Edit;
use rmpl::program::{ObstacleShape, Program};
use smol_str::SmolStr;

use super::camera::Camera;
use super::ground::Ground;
use super::scene;
use crate::command::{Command, CommandSender};
use crate::panel::Context;
use crate::state::{EditKind, Selection};

/// A drag under way.
#[derive(Clone, Debug, PartialEq)]
pub struct Drag {
    what: Dragged,
    /// Known to the history, so that the whole drag is undone at once.
    number: u64,
    /// The ground under the pointer in the last frame.
    last_m: Vec2,
}

/// What can be dragged.
#[derive(Clone, Debug, PartialEq)]
enum Dragged {
    Location(SmolStr),
    Obstacle(SmolStr),
}

/// What picking looks at.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// The image in the window.
    pub rect: Rect,
    /// The view.
    pub camera: &'a Camera,
    /// The ground.
    pub ground: &'a Ground,
    /// The mission.
    pub snapshot: &'a Snapshot,
    /// The state.
    pub context: &'a Context<'a>,
}

/// Pointers this near to a post, in points, are on it.
const REACH: f32 = 14.0;

impl Scene<'_> {
    /// The ground under a point of the window.
    pub fn ground_at(&self, pointer: Pos2) -> Option<Vec2> {
        let inside = pointer - self.rect.min;
        let size = Vec2::new(self.rect.width(), self.rect.height());
        let (origin, direction) = self.camera.ray(Vec2::new(inside.x, inside.y), size);
        self.ground.hit(origin, direction).map(glam::Vec3::truncate)
    }

    /// What is under a point of the window: a vehicle, a location, an obstacle, a traverse's path, or nothing.
    pub fn pick(&self, pointer: Pos2) -> Selection {
        let size = Vec2::new(self.rect.width(), self.rect.height());
        let inside = Vec2::new(pointer.x - self.rect.min.x, pointer.y - self.rect.min.y);
        let away = |place: Vec2, lift: f32| {
            let point = self.camera.project(self.ground.drape(place, lift), size);
            point.map_or(f32::INFINITY, |point| point.distance(inside))
        };
        let world = &self.snapshot.program.world;
        let time = self.context.state.playback.time;
        for (index, vehicle) in world.vehicles.iter().enumerate() {
            let pose = scene::vehicle_pose(self.snapshot, index, time);
            if pose.is_some_and(|(place, _)| away(place, 1.0) < REACH) {
                return Selection::Vehicle(vehicle.name.text.clone());
            }
        }
        for location in &world.locations {
            let place = scene::place(location.position_m);
            if [0.0, 3.5, 7.0].into_iter().any(|lift| away(place, lift) < REACH) {
                return Selection::Location(location.name.text.clone());
            }
        }
        let Some(hit) = self.ground_at(pointer) else { return Selection::None };
        if let Some(obstacle) = world.obstacles.iter().find(|it| contains(&it.shape, hit)) {
            return Selection::Obstacle(obstacle.name.text.clone());
        }
        let near_m = 10.0 * self.camera.distance_m / size.y.max(1.0);
        let on_path = |points: &[[f64; 2]]| {
            points
                .windows(2)
                .any(|pair| segment_distance(hit, scene::place(pair[0]), scene::place(pair[1])) < near_m)
        };
        let traverse =
            self.snapshot.traverses.iter().find(|it| it.legs.iter().any(|leg| on_path(&leg.points_m)));
        traverse.map_or(Selection::None, |it| Selection::Occurrence(it.occurrence))
    }
}

/// Begins, continues or ends a drag. While it lasts, the dragged thing's numbers in the text follow the pointer.
pub fn update(
    drag: Option<Drag>,
    count: &mut u64,
    response: &egui::Response,
    scene: &Scene<'_>,
    commands: &mut CommandSender,
) -> Option<Drag> {
    let pointer = response.interact_pointer_pos()?;
    if response.drag_started_by(PointerButton::Primary) {
        let begun = response.ctx.input(|input| input.pointer.press_origin()).unwrap_or(pointer);
        let what = match scene.pick(begun) {
            Selection::Location(name) => Dragged::Location(name),
            Selection::Obstacle(name) => Dragged::Obstacle(name),
            _ => return None,
        };
        *count += 1;
        let selection = match &what {
            Dragged::Location(name) => Selection::Location(name.clone()),
            Dragged::Obstacle(name) => Selection::Obstacle(name.clone()),
        };
        commands.send(Command::SelectAndReveal(selection));
        return Some(Drag { what, number: *count, last_m: scene.ground_at(begun)? });
    }
    let mut drag = drag?;
    if !response.dragged_by(PointerButton::Primary) {
        return None;
    }
    let Some(now_m) = scene.ground_at(pointer).filter(|&now_m| now_m.distance(drag.last_m) > 0.05) else {
        return Some(drag);
    };
    // The text may be ahead of the snapshot that is drawn: its own declarations say where the numbers stand.
    let parse = rmpl::parse(scene.context.state.document.text());
    if let Some(edit) = moved(&drag.what, &parse.program(), now_m, now_m - drag.last_m) {
        commands.send(Command::Edit { edits: vec![edit], kind: EditKind::Drag(drag.number) });
        drag.last_m = now_m;
    }
    Some(drag)
}

/// The edit that moves a thing: a location to `now_m`, an obstacle by `step_m`.
fn moved(what: &Dragged, program: &Program, now_m: Vec2, step_m: Vec2) -> Option<Edit> {
    match what {
        Dragged::Location(name) => {
            let location = program.world.locations.iter().find(|it| it.name.text == *name)?;
            let text = format!("{}, {}", decimetres(now_m.x), decimetres(now_m.y));
            Some(Edit { span: location.numbers_span, text })
        }
        Dragged::Obstacle(name) => {
            let obstacle = program.world.obstacles.iter().find(|it| it.name.text == *name)?;
            let shifted = |[east, north]: [f64; 2]| {
                let (east, north) = (east as f32 + step_m.x, north as f32 + step_m.y);
                format!("{}, {}", decimetres(east), decimetres(north))
            };
            let text = match &obstacle.shape {
                ObstacleShape::Circle { center_m, radius_m } => format!("{}, {radius_m}", shifted(*center_m)),
                ObstacleShape::Polygon { corners_m } => {
                    corners_m.iter().map(|&corner| shifted(corner)).collect::<Vec<_>>().join(", ")
                }
            };
            Some(Edit { span: obstacle.numbers_span, text })
        }
    }
}

/// Metres to a tenth, as an author would write them.
fn decimetres(metres: f32) -> String {
    let tenths = (f64::from(metres) * 10.0).round() / 10.0;
    format!("{}", if tenths == 0.0 { 0.0 } else { tenths })
}

/// Where a selected thing is.
pub fn place_of(snapshot: &Snapshot, selection: &Selection) -> Option<Vec2> {
    let world = &snapshot.program.world;
    match selection {
        Selection::Location(name) => {
            world.locations.iter().find(|it| it.name.text == *name).map(|it| scene::place(it.position_m))
        }
        Selection::Obstacle(name) => {
            let obstacle = world.obstacles.iter().find(|it| it.name.text == *name)?;
            let outline = scene::outline(&obstacle.shape);
            Some(outline.iter().copied().sum::<Vec2>() / outline.len().max(1) as f32)
        }
        Selection::Vehicle(name) => {
            let index = world.vehicles.iter().position(|it| it.name.text == *name)?;
            scene::vehicle_pose(snapshot, index, 0.0).map(|(place, _)| place)
        }
        _ => {
            let occurrence = selection.occurrence(snapshot.network.as_deref()?)?;
            let traverse = snapshot.traverses.iter().find(|it| it.occurrence == occurrence)?;
            let points = &traverse.legs.first()?.points_m;
            points.get(points.len() / 2).map(|&point| scene::place(point))
        }
    }
}

fn contains(shape: &ObstacleShape, point: Vec2) -> bool {
    match shape {
        ObstacleShape::Circle { center_m, radius_m } => {
            scene::place(*center_m).distance(point) <= *radius_m as f32
        }
        ObstacleShape::Polygon { corners_m } => {
            let corners: Vec<Vec2> = corners_m.iter().map(|&corner| scene::place(corner)).collect();
            let sides = corners.iter().zip(corners.iter().cycle().skip(1));
            let crossings = sides.filter(|(a, b)| {
                (a.y > point.y) != (b.y > point.y)
                    && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)
            });
            crossings.count() % 2 == 1
        }
    }
}

fn segment_distance(point: Vec2, from: Vec2, to: Vec2) -> f32 {
    let along = to - from;
    let part = if along.length_squared() > 0.0 {
        ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0)
    } else {
        0.0
    };
    point.distance(from + along * part)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "location A (1, 2);\nobstacle O circle (10, 10, 3);\nobstacle P polygon (0, 0, 4, 0, 4, 4);\n";

    fn after(what: &Dragged, now_m: Vec2, step_m: Vec2) -> String {
        let parse = rmpl::parse(TEXT);
        let edit = moved(what, &parse.program(), now_m, step_m).expect("it is declared");
        let mut text = TEXT.to_owned();
        text.replace_range(edit.span.range(), &edit.text);
        text
    }

    #[test]
    fn dragging_rewrites_only_the_numbers_of_the_declaration() {
        let text = after(&Dragged::Location("A".into()), Vec2::new(5.04, -0.01), Vec2::ZERO);
        assert_eq!(text, TEXT.replace("(1, 2)", "(5, 0)"));
        let text = after(&Dragged::Obstacle("O".into()), Vec2::ZERO, Vec2::new(1.5, -2.0));
        assert_eq!(text, TEXT.replace("(10, 10, 3)", "(11.5, 8, 3)"));
        let text = after(&Dragged::Obstacle("P".into()), Vec2::ZERO, Vec2::new(1.0, 1.0));
        assert_eq!(text, TEXT.replace("(0, 0, 4, 0, 4, 4)", "(1, 1, 5, 1, 5, 5)"));
    }

    #[test]
    fn a_point_is_inside_a_polygon_or_not() {
        let shape = ObstacleShape::Polygon { corners_m: vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]] };
        assert!(contains(&shape, Vec2::new(3.0, 1.0)));
        assert!(!contains(&shape, Vec2::new(1.0, 3.0)));
    }
}
