//! The ground, its camera and its tools.

use super::arguments::{number_argument, text_argument};
use super::available::{with_goal_of_flight, with_ground, with_motion, with_paths, with_run, with_vehicles};
use super::spec::{PLAIN, called, keys, plain, when};
use crate::command::Command;
use crate::command::chord::Key;
use crate::panel_effect::ViewAction;
use crate::registry::spec::{CommandSpec, Group, Scope};
use crate::state::growth::{GrowthCommand, Planners};
use crate::state::terrain::{TerrainCommand, Tool};

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    when(
        plain("terrain.fly", "Zoom map to selection", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::View(ViewAction::FitSelection))
        }),
        with_goal_of_flight,
    ),
    when(
        plain("terrain.follow", "Follow vehicle", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::View(ViewAction::Follow))
        }),
        with_vehicles,
    ),
    when(
        plain("terrain.tour", "Tour run", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::View(ViewAction::Tour))
        }),
        with_motion,
    ),
    when(
        plain("terrain.video", "Record or stop video", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::ToggleVideo)
        }),
        with_ground,
    ),
    when(
        plain("terrain.top", "Show top-down view", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::View(ViewAction::TopView))
        }),
        with_ground,
    ),
    when(
        plain("terrain.reset", "Show whole map", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::View(ViewAction::Fit))
        }),
        with_ground,
    ),
    when(
        plain(
            "terrain.clearance",
            "Toggle clearance map",
            Group::Terrain,
            &[keys(PLAIN, Key::C)],
            Scope::NotTyping,
            |_| Command::Terrain(TerrainCommand::ToggleClearance),
        ),
        with_ground,
    ),
    when(
        plain(
            "terrain.growth",
            "Toggle path search tree",
            Group::Terrain,
            &[keys(PLAIN, Key::T)],
            Scope::NotTyping,
            |_| Command::Terrain(TerrainCommand::Growth(GrowthCommand::Toggle)),
        ),
        with_paths,
    ),
    called("terrain.growTo", "Go to sample", Group::Terrain, |_, arguments| {
        let samples = number_argument(arguments, "samples")?.max(0.0) as u32;
        Ok(Command::Terrain(TerrainCommand::Growth(GrowthCommand::GoTo(samples))))
    }),
    called("terrain.growLeg", "Choose leg", Group::Terrain, |_, arguments| {
        let leg = number_argument(arguments, "leg")?.max(0.0) as usize;
        Ok(Command::Terrain(TerrainCommand::Growth(GrowthCommand::ChooseLeg(leg))))
    }),
    called("terrain.growBy", "Choose path planner", Group::Terrain, |_, arguments| {
        let name = text_argument(arguments, "planner")?;
        let planners = Planners::named(name).ok_or_else(|| format!("unknown path planner \"{name}\""))?;
        Ok(Command::Terrain(TerrainCommand::Growth(GrowthCommand::Choose(planners))))
    }),
    when(
        plain(
            "terrain.measure",
            "Measure distance",
            Group::Terrain,
            &[keys(PLAIN, Key::M)],
            Scope::NotTyping,
            |_| Command::Terrain(TerrainCommand::Take(Tool::Measure)),
        ),
        with_ground,
    ),
    when(
        plain("terrain.location", "Place location", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::Take(Tool::Location))
        }),
        with_ground,
    ),
    when(
        plain("terrain.circle", "Place round obstacle", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::Take(Tool::Circle))
        }),
        with_ground,
    ),
    when(
        plain("terrain.appear", "Add obstacle to run", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::Take(Tool::Appear))
        }),
        with_run,
    ),
    when(
        plain("terrain.polygon", "Place polygon obstacle", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::Take(Tool::Polygon))
        }),
        with_ground,
    ),
    when(
        plain("terrain.wall", "Draw wall", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::Take(Tool::Wall))
        }),
        with_ground,
    ),
    when(
        plain("terrain.vehicle", "Place vehicle", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::Take(Tool::Vehicle(motion::VEHICLE_MODELS[0].name.into())))
        }),
        with_ground,
    ),
];
