//! The settings on one page: how everything looks, how missions are planned, and what the terrain shows.

use egui::{Button, RichText, ScrollArea, Slider, TextEdit, Ui};
use panels::Context;
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::library::LibraryCommand;
use workbench::state::Views;
use workbench::state::settings::{Effects, HEIGHT_SCALES, SettingsCommand, TEXT_SCALES, ThemeChoice};
use workbench::state::window::WindowCommand;

const WIDTH: f32 = 460.0;

/// Shows the page. What is changed takes effect at once.
pub(super) fn show(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let screen = ui.ctx().content_rect().size();
    ui.set_width(WIDTH.min(screen.x - 64.0));
    theme::structure::mark_heading(&ui.heading("Settings"), 2);
    ScrollArea::vertical().max_height((screen.y - 180.0).max(160.0)).show(ui, |ui| {
        let mut send = |command| commands.send(Command::Settings(command));
        appearance(ui, context, &mut send);
        planning(ui, context, &mut send);
        let views = &context.state.settings.views;
        let mut changed = views.clone();
        text_and_terrain(ui, context, &mut changed);
        if changed != *views {
            send(SettingsCommand::SetViews(Box::new(changed)));
        }
        layouts(ui, context, commands);
    });
    ui.add_space(space::M);
    ui.horizontal(|ui| {
        if ui.button("Reset layout").on_hover_text("Restore the default panels of this workspace").clicked() {
            commands.send(Command::Window(WindowCommand::ResetWorkspace));
        }
        if ui.button("Close").clicked() {
            commands.send(Command::Window(WindowCommand::CloseDialog));
        }
    });
}

fn section(ui: &mut Ui, context: &Context<'_>, title: &str) {
    ui.add_space(space::M);
    ui.label(theme::strong(title).color(context.tokens.text_muted));
}

fn appearance(ui: &mut Ui, context: &Context<'_>, send: &mut dyn FnMut(SettingsCommand)) {
    section(ui, context, "Appearance");
    let settings = &context.state.settings;
    ui.horizontal(|ui| {
        ui.label("Theme");
        let choices =
            [(ThemeChoice::System, "System"), (ThemeChoice::Light, "Light"), (ThemeChoice::Dark, "Dark")];
        for (choice, name) in choices {
            if ui.radio(settings.theme == choice, name).clicked() {
                send(SettingsCommand::SetTheme(choice));
            }
        }
    });
    let mut scale = settings.text_scale;
    let slider = Slider::new(&mut scale, TEXT_SCALES[0]..=TEXT_SCALES[1]).step_by(0.1).text("Text size");
    // A slider whose page changes its size cannot be dragged, so the size changes when the button is released.
    let slider = ui.add(slider);
    let dragged = slider.id.with("dragged");
    if slider.dragged() {
        ui.data_mut(|data| data.insert_temp(dragged, scale));
    } else if slider.drag_stopped() {
        let scale = ui.data_mut(|data| data.remove_temp(dragged)).unwrap_or(scale);
        send(SettingsCommand::SetTextScale(scale));
    } else if slider.changed() {
        send(SettingsCommand::SetTextScale(scale));
    }
}

fn planning(ui: &mut Ui, context: &Context<'_>, send: &mut dyn FnMut(SettingsCommand)) {
    section(ui, context, "Planning");
    let plan = &context.state.settings.plan;
    let mut trace = plan.trace;
    if ui
        .checkbox(&mut trace, "Record the search")
        .on_hover_text("Step through it in the Search panel")
        .changed()
    {
        send(SettingsCommand::SetTrace(trace));
    }
    let mut seed = plan.seed;
    ui.horizontal(|ui| {
        let label = ui.label("Path planning seed");
        if ui.add(egui::DragValue::new(&mut seed)).labelled_by(label.id).changed() {
            send(SettingsCommand::SetSeed(seed));
        }
    });
}

/// The layouts that are saved with the mission, and a button that saves the current one.
fn layouts(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    section(ui, context, "Layouts of this mission");
    let mut send = |command| commands.send(Command::Library(command));
    let saved = context.state.library.open_mission().map_or(&[][..], |mission| &mission.layouts);
    for (number, layout) in saved.iter().enumerate() {
        ui.horizontal(|ui| {
            let name = &layout.name;
            if ui.button("Show").accessible_name(format!("Show layout {name}")).clicked() {
                send(LibraryCommand::ShowLayout(number));
            }
            if ui.button("Delete").accessible_name(format!("Delete layout {name}")).clicked() {
                send(LibraryCommand::DeleteLayout(number));
            }
            ui.label(name);
            ui.label(RichText::new(&layout.workspace).small().color(context.tokens.text_muted));
        });
    }
    let id = ui.scope_id().with("layout name");
    let mut name = ui.data(|data| data.get_temp::<String>(id)).unwrap_or_default();
    ui.horizontal(|ui| {
        let field = TextEdit::singleline(&mut name).hint_text("Name").desired_width(160.0);
        ui.add(field).accessible_name("Layout name");
        let is_lesson = context.state.lesson.is_beside();
        let button = ui.add_enabled(!name.trim().is_empty() && !is_lesson, Button::new("Save layout"));
        let missing = if is_lesson { "Close the lesson to save a layout" } else { "Enter a name" };
        let button = button.on_disabled_hover_text(missing);
        if button.on_hover_text("Save the panels of this workspace with the mission").clicked() {
            send(LibraryCommand::SaveLayout(std::mem::take(&mut name)));
        }
    });
    ui.data_mut(|data| data.insert_temp(id, name));
}

fn text_and_terrain(ui: &mut Ui, context: &Context<'_>, views: &mut Views) {
    section(ui, context, "Mission text");
    ui.checkbox(&mut views.editor.wraps, "Word wrap");
    section(ui, context, "Terrain");
    let [least, most] = HEIGHT_SCALES;
    let scale = &mut views.terrain.height_scale;
    ui.add(Slider::new(scale, least..=most).step_by(0.5).text("Vertical exaggeration"));
    ui.checkbox(&mut views.terrain.names, "Place and vehicle names");
    ui.checkbox(&mut views.terrain.grid, "Grid in mission coordinates");
    ui.horizontal(|ui| {
        ui.label("Visual effects");
        for (choice, name, help) in [
            (Effects::Automatic, "Automatic", "Full, and reduced while frames are slow"),
            (Effects::Full, "Full", "Ground detail and shadows in full resolution"),
            (Effects::Reduced, "Reduced", "Half resolution, no ground detail"),
        ] {
            ui.radio_value(&mut views.terrain.effects, choice, name).on_hover_text(help);
        }
    });
    ui.add_space(space::S);
    let note = "Each panel's Show menu has more options.";
    ui.label(RichText::new(note).small().color(context.tokens.text_muted));
}
