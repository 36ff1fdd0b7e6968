//! The row above the image: what is shown, where the camera is, and the tools.

use egui::Ui;
use snapshot::Snapshot;
use theme::space;
use workbench::PanelKind;
use workbench::ViewAction;
use workbench::command::{Command, CommandSender};
use workbench::state::growth::GrowthCommand;
use workbench::state::settings::{Coloring, HEIGHT_SCALES, TerrainView};
use workbench::state::terrain::{TerrainCommand, Tool};
use workbench::state::window::WindowCommand;

use crate::Context;

/// Shows the row. `mounts` are the vehicle that the camera follows, and the one that it is mounted on.
pub fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    snapshot: &Snapshot,
    view: &mut TerrainView,
    mounts: [&mut Option<usize>; 2],
    commands: &mut CommandSender,
) {
    ui.add_space(space::XS);
    ui.horizontal_wrapped(|ui| {
        ui.add_space(space::S);
        ui.spacing_mut().item_spacing.x = space::S;
        ui.menu_button("Show", |ui| show_menu(ui, view));
        ui.menu_button("Camera", |ui| camera_menu(ui, context, snapshot, mounts, commands));
        tools(ui, context, commands);
        let has_paths = !snapshot.traverses.is_empty();
        let is_growing = context.state.terrain.growth.shown().is_some();
        let grow = egui::Button::new("Search tree").selected(is_growing);
        let help = "Grow the path's search tree sample by sample (T)";
        if ui.add_enabled(has_paths, grow).on_hover_text(help).clicked() {
            commands.send(Command::Terrain(TerrainCommand::Growth(GrowthCommand::Toggle)));
        }
    });
    super::tree::controls(ui, context, commands);
}

fn show_menu(ui: &mut Ui, view: &mut TerrainView) {
    for coloring in [Coloring::Natural, Coloring::Height, Coloring::Slope] {
        let choice = ui.radio_value(&mut view.coloring, coloring, coloring_name(coloring));
        choice.on_hover_text("Color the terrain naturally, by height or by slope");
    }
    ui.separator();
    for (value, name, help) in [
        (&mut view.paths, "Paths", "Paths of the plan's traverses"),
        (&mut view.trees, "Search trees", "Search trees of the paths"),
        (&mut view.rays, "Laser rays", "Range sensor readings during a run"),
        (&mut view.sights, "Lines of sight", "Positions with the required line of sight"),
        (&mut view.names, "Names", "Names of places and vehicles"),
        (&mut view.obstacles, "Obstacles", "Declared obstacles"),
        (&mut view.clearance, "Clearance map", "Distance to the nearest obstacle (C)"),
        (&mut view.contours, "Contours", "Contour lines"),
        (&mut view.grid, "Grid", "A grid in mission coordinates"),
        (&mut view.data_only, "Data only", "No ground detail, shadows, wheel tracks and sky"),
    ] {
        ui.checkbox(value, name).on_hover_text(help);
    }
    ui.separator();
    let (mut scale, [least, most]) = (view.height_scale, HEIGHT_SCALES);
    let slider = egui::Slider::new(&mut scale, least..=most).step_by(0.5).text("Vertical exaggeration");
    if ui.add(slider).on_hover_text("Scale of heights (1 is true to scale)").changed() {
        view.height_scale = scale;
    }
}

fn camera_menu(
    ui: &mut Ui,
    context: &Context<'_>,
    snapshot: &Snapshot,
    [follow, onboard]: [&mut Option<usize>; 2],
    commands: &mut CommandSender,
) {
    let is_selected = !context.state.selection.is_none();
    let can_fly = is_selected || context.state.terrain.growth.last_sample().is_some();
    let flight = if is_selected || !can_fly { "Zoom to selection" } else { "Zoom to last sample" };
    for (name, action, is_enabled) in [
        ("Whole map", ViewAction::Fit, true),
        ("Top-down view", ViewAction::TopView, true),
        (flight, ViewAction::FitSelection, can_fly),
    ] {
        if ui.add_enabled(is_enabled, egui::Button::new(name)).clicked() {
            commands.send(Command::Window(WindowCommand::ViewOf(PanelKind::Terrain, action)));
            ui.close();
        }
    }
    let vehicles = &snapshot.program.world.vehicles;
    if !vehicles.is_empty() {
        ui.separator();
        let before = (*follow, *onboard);
        let mut mounted = before;
        ui.radio_value(&mut mounted, (None, None), "Free camera");
        for (index, vehicle) in vehicles.iter().enumerate() {
            let name = &vehicle.name.text;
            ui.radio_value(&mut mounted, (Some(index), None), format!("Follow {name}"));
            ui.radio_value(&mut mounted, (None, Some(index)), format!("On board {name}"));
        }
        if mounted != before {
            (*follow, *onboard) = mounted;
            ui.close();
        }
    }
}

fn tools(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tool = &context.state.terrain.tool;
    let mut take = |tool| commands.send(Command::Terrain(TerrainCommand::Take(tool)));
    let measure = ui.add(egui::Button::new("Measure").selected(*tool == Tool::Measure));
    let help = "Measure distance, height profile and line of sight (M)";
    if measure.on_hover_text(help).clicked() {
        take(Tool::Measure);
    }
    let is_placing = !matches!(tool, Tool::Look | Tool::Measure);
    let title = egui::Button::new("Place").selected(is_placing);
    egui::containers::menu::MenuButton::from_button(title).ui(ui, |ui| {
        let mut item = |ui: &mut Ui, name: String, help: &str, wanted: Tool| {
            if ui.button(name).on_hover_text(help).clicked() {
                take(wanted);
                ui.close();
            }
        };
        item(ui, "Location".into(), "Click to declare a location", Tool::Location);
        item(ui, "Round obstacle".into(), "Drag from the center outwards, or click", Tool::Circle);
        item(ui, "Wall".into(), "Drag from one end to the other", Tool::Wall);
        if context.state.is_executing() {
            let help = "Drag from the center outwards; it appears at the current time";
            item(ui, "Obstacle in this run".into(), help, Tool::Appear);
        }
        let help = "Click each corner; double-click or press Enter to finish";
        item(ui, "Polygon obstacle".into(), help, Tool::Polygon);
        for model in &motion::VEHICLE_MODELS {
            let help = "Click a location, or anywhere to declare a new one";
            item(ui, format!("Vehicle {}", model.name), help, Tool::Vehicle(model.name.into()));
        }
    });
}

const fn coloring_name(coloring: Coloring) -> &'static str {
    match coloring {
        Coloring::Natural => "Natural colors",
        Coloring::Height => "Colors by height",
        Coloring::Slope => "Colors by slope",
    }
}
