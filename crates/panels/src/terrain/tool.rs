//! What clicks and keys do while a tool other than looking is in hand, and what it shows while it waits for them.

use egui::{Key, PointerButton, Pos2, Response};
use glam::Vec2;
use nalgebra::Point2;
use terrain_view::pick::Scene;
use terrain_view::scene::{Sketch, place};
use workbench::command::{Command, CommandSender};
use workbench::state::execution::ExecutionCommand;
use workbench::state::placing::{NewThing, VehicleStart, wall};
use workbench::state::terrain::{TerrainCommand, Tool};

use super::drag::start_at;
use super::measure::Measurement;

/// The radius that a click alone gives a round obstacle, in meters.
const CLICKED_RADIUS_M: f64 = 5.0;
/// A wall is as thick as this, in meters, or as so many cells if those are more.
const WALL_M: f64 = 3.0;
const WALL_CELLS: f64 = 2.0;
/// Corners nearer to the last one than this many points are not meant.
const SAME_CORNER: f32 = 8.0;

/// Does what clicks and keys ask of the tool in hand. `pressed_m` keeps where a drag began.
pub fn update(
    response: &Response,
    scene: &Scene<'_>,
    pressed_m: &mut Option<Vec2>,
    commands: &mut CommandSender,
) {
    if response.drag_started_by(PointerButton::Primary) {
        let pressed = response.ctx.input(|input| input.pointer.press_origin());
        *pressed_m = pressed.and_then(|pressed| scene.ground_at(pressed));
    }
    let state = &scene.state.terrain;
    let again = response.ctx.input(|input| input.modifiers.shift);
    let mut send = |command| commands.send(Command::Terrain(command));
    let pointer = response.interact_pointer_pos();
    let clicked = pointer.filter(|_| response.clicked());
    let at = |pointer: Pos2| scene.ground_at(pointer).map(meters);
    match &state.tool {
        Tool::Look => {}
        Tool::Measure => {
            if let Some(point) = clicked.and_then(at) {
                send(TerrainCommand::Point(point));
            }
        }
        Tool::Location => {
            if let Some(point) = clicked.and_then(at) {
                send(TerrainCommand::Place { thing: NewThing::Location(point), again });
            }
        }
        Tool::Vehicle(model) => {
            if let Some(start) = clicked.and_then(|pointer| start_at(pointer, scene)) {
                let thing = NewThing::Vehicle { model: model.clone(), start };
                send(TerrainCommand::Place { thing, again });
            }
        }
        Tool::Circle | Tool::Appear => {
            let is_drawn = response.drag_stopped_by(PointerButton::Primary);
            let drawn = drawn_disc(response, scene, *pressed_m).filter(|_| is_drawn);
            let drawn = drawn.map(|(center, radius_m)| (meters(center), f64::from(radius_m)));
            let disc = drawn.or_else(|| Some((clicked.and_then(at)?, CLICKED_RADIUS_M)));
            if let Some((center_m, radius_m)) = disc {
                commands.send(if state.tool == Tool::Appear {
                    Command::Execution(ExecutionCommand::Appear { center_m, radius_m, again })
                } else {
                    let thing = NewThing::Circle { center_m, radius_m };
                    Command::Terrain(TerrainCommand::Place { thing, again })
                });
            }
        }
        Tool::Wall => {
            let is_drawn = response.drag_stopped_by(PointerButton::Primary);
            let ends_m = drawn_wall(response, scene, *pressed_m).filter(|_| is_drawn);
            if let Some(ends_m) = ends_m {
                send(TerrainCommand::Place {
                    thing: NewThing::Wall { ends_m, thickness_m: thickness_m(scene) },
                    again,
                });
            }
        }
        Tool::Polygon => {
            let is_close = |point: Point2<f64>| {
                let projected = scene.camera.project(scene.ground.drape(place(point), 0.0), scene.size());
                let inside = clicked.map(|at| at - scene.rect.min);
                projected
                    .zip(inside)
                    .is_some_and(|(shown, at)| shown.distance(Vec2::new(at.x, at.y)) < SAME_CORNER)
            };
            let points = &state.points_m;
            let closes = points.len() >= 3
                && (points.first().copied().is_some_and(is_close)
                    || points.last().copied().is_some_and(is_close));
            if closes {
                send(TerrainCommand::Finish);
            } else if let Some(point) =
                clicked.and_then(at).filter(|_| !points.last().copied().is_some_and(is_close))
            {
                send(TerrainCommand::Point(point));
            }
            let pressed = |key| response.ctx.input(|input| input.key_pressed(key));
            if pressed(Key::Enter) {
                send(TerrainCommand::Finish);
            }
            if pressed(Key::Backspace) && response.has_focus() {
                send(TerrainCommand::TakeBack);
            }
        }
    }
}

/// The disc from the place where the button went down to the pointer.
fn drawn_disc(response: &Response, scene: &Scene<'_>, center: Option<Vec2>) -> Option<(Vec2, f32)> {
    let rim = scene.ground_at(response.interact_pointer_pos()?)?;
    Some((center?, center?.distance(rim).max(0.5)))
}

/// The line from the place where the button went down to the pointer, if that is far enough for a wall.
fn drawn_wall(response: &Response, scene: &Scene<'_>, from: Option<Vec2>) -> Option<[Point2<f64>; 2]> {
    let to = scene.ground_at(response.interact_pointer_pos()?)?;
    let from = from.filter(|from| from.distance(to) >= 1.0)?;
    Some([meters(from), meters(to)])
}

/// Returns how thick a wall is that is drawn, in meters: it must not slip between the cells of the map.
fn thickness_m(scene: &Scene<'_>) -> f64 {
    WALL_M.max(WALL_CELLS * f64::from(scene.ground.cell_m))
}

/// What the tool has, and what a click at the pointer would add.
pub fn sketch(
    response: &Response,
    scene: &Scene<'_>,
    pressed_m: Option<Vec2>,
    measured: Option<&Measurement>,
) -> Sketch {
    let state = &scene.state.terrain;
    let pointer = response.hover_pos();
    let hit = pointer.and_then(|pointer| scene.ground_at(pointer));
    let points: Vec<Vec2> = state.points_m.iter().map(|&point| place(point)).collect();
    match &state.tool {
        Tool::Look => Sketch::default(),
        Tool::Measure => match measured {
            Some(measured) => measured.sketch(scene.ground, scene.state.settings.views.terrain.height_scale),
            None => Sketch { marks: points.into_iter().chain(hit).collect(), ..Sketch::default() },
        },
        Tool::Location => Sketch { marks: hit.into_iter().collect(), ..Sketch::default() },
        Tool::Vehicle(_) => {
            let start = pointer.and_then(|pointer| start_at(pointer, scene));
            let at = start.and_then(|start| match start {
                VehicleStart::Ground(at) => Some(place(at)),
                VehicleStart::Location(name) => {
                    let locations = &scene.snapshot.program.world.locations;
                    let location = locations.iter().find(|it| it.name.text == name)?;
                    Some(place(location.position_m))
                }
            });
            Sketch { marks: at.into_iter().collect(), ..Sketch::default() }
        }
        Tool::Circle | Tool::Appear => {
            let is_drawing = response.dragged_by(PointerButton::Primary);
            let drawn = drawn_disc(response, scene, pressed_m).filter(|_| is_drawing);
            let hovering = hit.map(|center| (center, CLICKED_RADIUS_M as f32));
            Sketch { disc: drawn.or(hovering), ..Sketch::default() }
        }
        Tool::Wall => {
            let is_drawing = response.dragged_by(PointerButton::Primary);
            let drawn = drawn_wall(response, scene, pressed_m).filter(|_| is_drawing);
            match drawn.map(|ends_m| wall(ends_m, thickness_m(scene)).map(place)) {
                Some(corners) => {
                    let sides = [0, 1, 2, 3].map(|side| [corners[side], corners[(side + 1) % 4]]);
                    Sketch { lines: sides.to_vec(), ..Sketch::default() }
                }
                None => Sketch { marks: hit.into_iter().collect(), ..Sketch::default() },
            }
        }
        Tool::Polygon => {
            let corners: Vec<Vec2> = points.iter().copied().chain(hit).collect();
            let closing = (corners.len() >= 3).then(|| [corners[corners.len() - 1], corners[0]]);
            let sides = corners.windows(2).map(|pair| [pair[0], pair[1]]).chain(closing);
            Sketch { lines: sides.collect(), marks: points, ..Sketch::default() }
        }
    }
}

/// Returns what the tool waits for, in words.
pub fn hint(tool: &Tool, points: usize) -> Option<String> {
    Some(match tool {
        Tool::Look => return None,
        Tool::Measure => match points {
            0 => "Click the start point".to_owned(),
            1 => "Click the end point".to_owned(),
            _ => "Click to measure again · Esc to stop".to_owned(),
        },
        Tool::Location => "Click to place a location · Shift for several".to_owned(),
        Tool::Circle => "Drag from the center outwards · Shift for several".to_owned(),
        Tool::Appear => "Drag from the center of the new obstacle · Shift for several".to_owned(),
        Tool::Wall => "Drag from one end of the wall to the other · Shift for several".to_owned(),
        Tool::Polygon => match points {
            0 => "Click the first corner".to_owned(),
            1 | 2 => "Click the next corner".to_owned(),
            _ => "Click the next corner · Enter to finish".to_owned(),
        },
        Tool::Vehicle(model) => format!("Click the start position of the {model}"),
    })
}

/// A place on the ground, east and north.
pub(super) fn meters(place: Vec2) -> Point2<f64> {
    Point2::new(f64::from(place.x), f64::from(place.y))
}
