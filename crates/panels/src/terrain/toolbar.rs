//! The row above the image: what is shown, where the camera is, and the tools.

use egui::{RichText, Slider, TextEdit, Ui};
use snapshot::Snapshot;
use terrain_view::pace::Savings;
use theme::space;
use workbench::PanelKind;
use workbench::ViewAction;
use workbench::command::{Command, CommandSender};
use workbench::state::growth::GrowthCommand;
use workbench::state::settings::{
    Coloring, Effects, HEIGHT_SCALES, SUN_AZIMUTHS_DEG, SUN_HEIGHTS_DEG, SettingsCommand, SunView,
    TerrainView,
};
use workbench::state::terrain::{TerrainCommand, Tool};
use workbench::state::window::WindowCommand;

use super::Mount;
use crate::Context;

/// Shows the row. `savings` are what is left out by itself.
pub fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    snapshot: &Snapshot,
    view: &mut TerrainView,
    (mount, savings): (&mut Mount, Savings),
    commands: &mut CommandSender,
) {
    ui.add_space(space::XS);
    ui.horizontal_wrapped(|ui| {
        ui.add_space(space::S);
        ui.spacing_mut().item_spacing.x = space::S;
        ui.menu_button("Show", |ui| show_menu(ui, context, view, savings, commands));
        ui.menu_button("Camera", |ui| camera_menu(ui, context, snapshot, mount, commands));
        tools(ui, context, commands);
        if context.state.terrain.film.is_some() {
            let stop = egui::Button::new(RichText::new("Stop recording").color(context.tokens.error));
            if ui.add(stop).on_hover_text("End the video and save it").clicked() {
                commands.send(Command::Terrain(TerrainCommand::ToggleVideo));
            }
        }
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

fn show_menu(
    ui: &mut Ui,
    context: &Context<'_>,
    view: &mut TerrainView,
    savings: Savings,
    commands: &mut CommandSender,
) {
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
        (
            &mut view.data_only,
            "Data only",
            "Hide ground detail, shadows, wheel tracks, sky and obstacle heights",
        ),
    ] {
        ui.checkbox(value, name).on_hover_text(help);
    }
    ui.separator();
    let (mut scale, [least, most]) = (view.height_scale, HEIGHT_SCALES);
    let slider = Slider::new(&mut scale, least..=most).step_by(0.5).text("Vertical exaggeration");
    if ui.add(slider).on_hover_text("Scale of heights (1 is true to scale)").changed() {
        view.height_scale = scale;
    }
    ui.menu_button("Sun", |ui| sun_menu(ui, context, &mut view.sun, commands));
    ui.menu_button("Visual effects", |ui| effects_menu(ui, &mut view.effects, savings));
}

/// Where the light comes from.
fn sun_menu(ui: &mut Ui, context: &Context<'_>, sun: &mut SunView, commands: &mut CommandSender) {
    ui.set_max_width(250.0);
    let goes_by_clock = sun.follows_clock && context.state.time_of_day_secs().is_some();
    ui.checkbox(&mut sun.follows_clock, "Follow mission clock")
        .on_hover_text("Take the time of day from the start date");
    let mut epoch = context.state.settings.epoch.clone();
    ui.horizontal(|ui| {
        let label = ui.label("Start date");
        let field = TextEdit::singleline(&mut epoch).hint_text("2004-01-25T05:05:00Z").desired_width(150.0);
        if ui.add(field).labelled_by(label.id).changed() {
            commands.send(Command::Settings(SettingsCommand::SetEpoch(epoch)));
        }
    });
    if sun.follows_clock && !goes_by_clock {
        let is_empty = context.state.settings.epoch.is_empty();
        let note =
            if is_empty { "Without a start date, the sun stays:" } else { "Invalid date. The sun stays:" };
        ui.label(RichText::new(note).small().color(context.tokens.text_muted));
    }
    ui.add_enabled_ui(!goes_by_clock, |ui| {
        let [least, most] = SUN_AZIMUTHS_DEG;
        let azimuth =
            Slider::new(&mut sun.azimuth_deg, least..=most).step_by(5.0).suffix("°").text("Direction");
        ui.add(azimuth).on_hover_text("Clockwise from north");
        let [least, most] = SUN_HEIGHTS_DEG;
        let height = Slider::new(&mut sun.height_deg, least..=most).step_by(1.0).suffix("°").text("Height");
        ui.add(height).on_hover_text("Above the horizon");
    });
}

/// How much is drawn that costs time.
fn effects_menu(ui: &mut Ui, effects: &mut Effects, savings: Savings) {
    let automatic = if *effects == Effects::Automatic && savings > Savings::None {
        "Automatic (reduced now)"
    } else {
        "Automatic"
    };
    for (choice, name, help) in [
        (Effects::Automatic, automatic, "Full, and reduced while frames are slow"),
        (Effects::Full, "Full", "Ground detail and shadows in full resolution"),
        (Effects::Reduced, "Reduced", "Half resolution, no ground detail"),
    ] {
        ui.radio_value(effects, choice, name).on_hover_text(help);
    }
}

fn camera_menu(
    ui: &mut Ui,
    context: &Context<'_>,
    snapshot: &Snapshot,
    mount: &mut Mount,
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
        let before = *mount;
        ui.radio_value(mount, Mount::Free, "Free camera");
        for (index, vehicle) in vehicles.iter().enumerate() {
            let name = &vehicle.name.text;
            ui.radio_value(mount, Mount::Follow(index), format!("Follow {name}"));
            ui.radio_value(mount, Mount::OnBoard(index), format!("On board {name}"));
        }
        if *mount != before {
            ui.close();
        }
        ui.separator();
        let has_motion = !snapshot.motions.is_empty();
        let tour = egui::Button::new("Tour run").selected(matches!(mount, Mount::Tour(_)));
        let help = "Play, and follow each vehicle as it departs";
        if ui.add_enabled(has_motion, tour).on_hover_text(help).clicked() {
            commands.send(Command::Terrain(TerrainCommand::View(ViewAction::Tour)));
            ui.close();
        }
    }
    let has_film = context.state.terrain.film.is_some();
    let name = if has_film { "Stop recording" } else { "Record video" };
    let can_record = has_film || context.state.playback.end > 0.0;
    let help = "Play from the start, and save what the terrain shows as a video";
    if ui.add_enabled(can_record, egui::Button::new(name)).on_hover_text(help).clicked() {
        commands.send(Command::Terrain(TerrainCommand::ToggleVideo));
        ui.close();
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
