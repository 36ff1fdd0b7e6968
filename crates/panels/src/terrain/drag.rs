//! Dragging things on the ground: their declarations in the text follow the pointer.

use egui::{PointerButton, Pos2};
use glam::Vec2;
use nalgebra::{Point2, Vector2};
use rmpl::Edit;
use rmpl::program::{ObstacleShape, Program};
use smol_str::SmolStr;
use terrain_view::pick::Scene;
use terrain_view::scene;
use text_editing::{EditKind, TextCommand};
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;
use workbench::state::placing::{VehicleStart, place};
use workbench::state::terrain::TerrainCommand;

use crate::carry::{self, Carried};

/// A drag under way.
#[derive(Clone, Debug, PartialEq)]
pub struct Drag {
    what: Dragged,
    /// Known to the history, so that the whole drag is undone at once.
    number: u64,
    /// The ground under the pointer when it was pressed.
    begun_m: Vec2,
    /// The ground under the pointer in the last frame.
    pub last_m: Vec2,
}

/// What can be dragged, with where it was: steps that were rounded do not add up.
#[derive(Clone, Debug, PartialEq)]
enum Dragged {
    Location(SmolStr, [f64; 2]),
    Obstacle(SmolStr, ObstacleShape),
    /// A vehicle that has not left yet: it starts from where it is dropped.
    Vehicle(SmolStr),
}

impl Dragged {
    fn of(selection: &Selection, scene: &Scene<'_>) -> Option<Self> {
        let world = &scene.snapshot.program.world;
        match selection {
            Selection::Location(name) => {
                let location = world.locations.iter().find(|it| it.name.text == *name)?;
                Some(Self::Location(name.clone(), location.position_m))
            }
            Selection::Obstacle(name) => {
                let obstacle = world.obstacles.iter().find(|it| it.name.text == *name)?;
                Some(Self::Obstacle(name.clone(), obstacle.shape.clone()))
            }
            Selection::Vehicle(name) if is_at_start(scene, name) => Some(Self::Vehicle(name.clone())),
            _ => None,
        }
    }

    fn selection(&self) -> Selection {
        match self {
            Self::Location(name, _) => Selection::Location(name.clone()),
            Self::Obstacle(name, _) => Selection::Obstacle(name.clone()),
            Self::Vehicle(name) => Selection::Vehicle(name.clone()),
        }
    }
}

impl Drag {
    /// Returns whether the place under the pointer is where a vehicle will start.
    pub fn is_start(&self) -> bool {
        matches!(self.what, Dragged::Vehicle(_))
    }
}

/// Returns whether dragging at a point of the window would move something.
pub fn is_draggable(pointer: Pos2, scene: &Scene<'_>) -> bool {
    scene.pick_handle(pointer).and_then(|handle| Dragged::of(&handle, scene)).is_some()
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
        if response.ctx.input(|input| input.modifiers.shift) {
            return None;
        }
        let what = Dragged::of(&scene.pick_handle(begun)?, scene)?;
        *count += 1;
        commands.send(Command::Select(what.selection()));
        let begun_m = scene.ground_at(begun)?;
        return Some(Drag { what, number: *count, begun_m, last_m: begun_m });
    }
    let mut drag = drag?;
    if !response.dragged_by(PointerButton::Primary) {
        if let Dragged::Vehicle(vehicle) = drag.what {
            drop_vehicle(vehicle, pointer, scene, commands);
        }
        return None;
    }
    if let Dragged::Location(name, _) = &drag.what {
        if scene.rect.contains(pointer) {
            carry::put_site_back(&response.ctx);
        } else {
            // Outside, its name is carried, and the location is where it was.
            if drag.last_m != drag.begun_m {
                commands.send(Command::Text(TextCommand::Undo));
                drag.last_m = drag.begun_m;
            }
            carry::take(&response.ctx, Carried::Site(name.clone()));
            return Some(drag);
        }
    }
    let Some(now_m) = scene.ground_at(pointer).filter(|&now_m| now_m.distance(drag.last_m) > 0.05) else {
        return Some(drag);
    };
    // The text may be ahead of the snapshot that is drawn: its own declarations say where the numbers is.
    let parse = scene.state.language.parse()?;
    if let Some(edit) = moved(&drag.what, &parse.program(), now_m - drag.begun_m) {
        commands.send(Command::Edit { edits: vec![edit], kind: EditKind::Drag(drag.number) });
    }
    drag.last_m = now_m;
    Some(drag)
}

fn drop_vehicle(vehicle: SmolStr, pointer: Pos2, scene: &Scene<'_>, commands: &mut CommandSender) {
    if let Some(start) = start_at(pointer, scene) {
        commands.send(Command::Terrain(TerrainCommand::MoveStart { vehicle, start }));
    }
}

/// Returns where a vehicle that is put down at a point of the window starts: at the location there, or on the ground.
pub fn start_at(pointer: Pos2, scene: &Scene<'_>) -> Option<VehicleStart> {
    if let Some(location) = scene.pick_location(pointer) {
        return Some(VehicleStart::Location(location));
    }
    let at = scene.ground_at(pointer)?;
    Some(VehicleStart::Ground(Point2::new(f64::from(at.x), f64::from(at.y))))
}

/// Returns whether a vehicle has not left its start at the time shown.
fn is_at_start(scene: &Scene<'_>, name: &str) -> bool {
    let world = &scene.snapshot.program.world;
    let Some(index) = world.vehicles.iter().position(|it| it.name.text == name) else { return false };
    let pose = |time| scene::vehicle_pose(scene.snapshot, index, time).map(|(place, _)| place);
    pose(scene.state.playback.time) == pose(0.0)
}

/// The edit that moves a thing `by_m` from where it was.
fn moved(what: &Dragged, program: &Program, by_m: Vec2) -> Option<Edit> {
    let by_m = Vector2::new(by_m.x, by_m.y).cast::<f64>();
    let shifted = |point_m: [f64; 2]| place(Point2::from(point_m) + by_m);
    match what {
        Dragged::Location(name, position_m) => {
            let location = program.world.locations.iter().find(|it| it.name.text == *name)?;
            Some(Edit { span: location.numbers_span, text: shifted(*position_m) })
        }
        Dragged::Obstacle(name, shape) => {
            let obstacle = program.world.obstacles.iter().find(|it| it.name.text == *name)?;
            let text = match shape {
                ObstacleShape::Circle { center_m, radius_m } => format!("{}, {radius_m}", shifted(*center_m)),
                ObstacleShape::Polygon { corners_m } => {
                    corners_m.iter().map(|&corner| shifted(corner)).collect::<Vec<_>>().join(", ")
                }
            };
            Some(Edit { span: obstacle.numbers_span, text })
        }
        Dragged::Vehicle(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "location A (1, 2);\nobstacle O circle (10, 10, 3);\nobstacle P polygon (0, 0, 4, 0, 4, 4);\n";

    fn after(what: &Dragged, steps_m: &[Vec2]) -> String {
        let mut text = TEXT.to_owned();
        for &by_m in steps_m {
            let edit = moved(what, &rmpl::parse(&text).program(), by_m).expect("it is declared");
            text.replace_range(edit.span.range(), &edit.text);
        }
        text
    }

    #[test]
    fn dragging_rewrites_only_the_numbers_of_the_declaration() {
        let text = after(&Dragged::Location("A".into(), [1.0, 2.0]), &[Vec2::new(4.04, -2.01)]);
        assert_eq!(text, TEXT.replace("(1, 2)", "(5, 0)"));
        let circle = ObstacleShape::Circle { center_m: [10.0, 10.0], radius_m: 3.0 };
        let text = after(&Dragged::Obstacle("O".into(), circle), &[Vec2::new(1.5, -2.0)]);
        assert_eq!(text, TEXT.replace("(10, 10, 3)", "(11.5, 8, 3)"));
        let polygon = ObstacleShape::Polygon { corners_m: vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]] };
        let text = after(&Dragged::Obstacle("P".into(), polygon), &[Vec2::new(1.0, 1.0)]);
        assert_eq!(text, TEXT.replace("(0, 0, 4, 0, 4, 4)", "(1, 1, 5, 1, 5, 5)"));
    }

    #[test]
    fn many_small_steps_lead_as_far_as_one_large_one() {
        let circle = ObstacleShape::Circle { center_m: [10.0, 10.0], radius_m: 3.0 };
        let steps: Vec<Vec2> = (1..=100).map(|step| Vec2::new(step as f32 * 0.04, 0.0)).collect();
        let text = after(&Dragged::Obstacle("O".into(), circle), &steps);
        assert_eq!(text, TEXT.replace("(10, 10, 3)", "(14, 10, 3)"));
    }
}
