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

/// Shows the row. `follow` is the vehicle that the camera follows.
pub fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    snapshot: &Snapshot,
    view: &mut TerrainView,
    follow: &mut Option<usize>,
    commands: &mut CommandSender,
) {
    ui.add_space(space::XS);
    ui.horizontal_wrapped(|ui| {
        ui.add_space(space::S);
        ui.spacing_mut().item_spacing.x = space::S;
        egui::ComboBox::from_id_salt("terrain-coloring")
            .selected_text(coloring_name(view.coloring))
            .width(76.0)
            .show_ui(ui, |ui| {
                for coloring in [Coloring::Natural, Coloring::Height, Coloring::Slope] {
                    ui.selectable_value(&mut view.coloring, coloring, coloring_name(coloring));
                }
            })
            .response
            .accessible_name("Colours of the ground")
            .on_hover_text("What the colours of the ground mean");
        ui.menu_button("Show", |ui| show_menu(ui, view));
        ui.menu_button("Camera", |ui| camera_menu(ui, context, snapshot, follow, commands));
        tools(ui, context, commands);
        let has_paths = !snapshot.traverses.is_empty();
        let is_growing = context.state.terrain.growth.shown().is_some();
        let grow = egui::Button::new("Search tree").selected(is_growing);
        let help = "Grow the search tree that found the path of the selected traverse, sample by sample (T)";
        if ui.add_enabled(has_paths, grow).on_hover_text(help).clicked() {
            commands.send(Command::Terrain(TerrainCommand::Growth(GrowthCommand::Toggle)));
        }
    });
    super::tree::controls(ui, context, commands);
}

fn show_menu(ui: &mut Ui, view: &mut TerrainView) {
    for (value, name, help) in [
        (&mut view.paths, "Paths", "The paths of the plan's traverses"),
        (&mut view.trees, "Search trees", "The trees that found the paths"),
        (&mut view.rays, "Laser rays", "What the laser range finders of vehicles see, in a run"),
        (&mut view.sights, "Lines of sight", "From where vehicles see what the mission asks them to see"),
        (&mut view.names, "Names", "Names of places and vehicles"),
        (&mut view.obstacles, "Obstacles", "Declared obstacles"),
        (&mut view.clearance, "Clearance map", "How much room a vehicle has everywhere (C)"),
        (&mut view.contours, "Contours", "Lines of equal height"),
        (&mut view.grid, "Grid", "A grid in mission coordinates"),
    ] {
        ui.checkbox(value, name).on_hover_text(help);
    }
    ui.separator();
    let (mut scale, [least, most]) = (view.height_scale, HEIGHT_SCALES);
    let slider = egui::Slider::new(&mut scale, least..=most).step_by(0.5).text("heights ×");
    if ui.add(slider).on_hover_text("How much heights are exaggerated; 1 is true to scale").changed() {
        view.height_scale = scale;
    }
}

fn camera_menu(
    ui: &mut Ui,
    context: &Context<'_>,
    snapshot: &Snapshot,
    follow: &mut Option<usize>,
    commands: &mut CommandSender,
) {
    let is_selected = !context.state.selection.is_none();
    let can_fly = is_selected || context.state.terrain.growth.last_sample().is_some();
    let flight = if is_selected || !can_fly { "Fly to the selection" } else { "Fly to the last sample" };
    for (name, action, is_enabled) in [
        ("Whole map", ViewAction::Fit, true),
        ("Straight down", ViewAction::TopView, true),
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
        let mut followed = *follow;
        ui.radio_value(&mut followed, None, "Free camera");
        for (index, vehicle) in vehicles.iter().enumerate() {
            ui.radio_value(&mut followed, Some(index), format!("Follow {}", vehicle.name.text));
        }
        if followed != *follow {
            *follow = followed;
            ui.close();
        }
    }
}

fn tools(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tool = &context.state.terrain.tool;
    let mut take = |tool| commands.send(Command::Terrain(TerrainCommand::Take(tool)));
    let measure = ui.add(egui::Button::new("Measure").selected(*tool == Tool::Measure));
    let help = "Distance, height profile and line of sight between two clicks (M)";
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
        item(ui, "Location".into(), "A click declares a place", Tool::Location);
        item(ui, "Round obstacle".into(), "Drag from the centre outwards, or click", Tool::Circle);
        item(ui, "Wall".into(), "Drag from one end to the other", Tool::Wall);
        if context.state.is_executing() {
            let help = "Drag from the centre outwards, or click: it stands there from the time shown on";
            item(ui, "Obstacle in this run".into(), help, Tool::Appear);
        }
        let help = "Click its corners; double-click or Enter closes it";
        item(ui, "Obstacle with corners".into(), help, Tool::Polygon);
        for model in &motion::VEHICLE_MODELS {
            let help = "A click on a location starts it there; elsewhere it gets a location of its own";
            item(ui, format!("Vehicle {}", model.name), help, Tool::Vehicle(model.name.into()));
        }
    });
}

const fn coloring_name(coloring: Coloring) -> &'static str {
    match coloring {
        Coloring::Natural => "Natural",
        Coloring::Height => "Height",
        Coloring::Slope => "Slope",
    }
}
