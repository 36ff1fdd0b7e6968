//! The open mission on the bar: its name, which can be edited in place, and a menu with the other missions.

use egui::{Button, Key, RichText, TextEdit, Ui};
use panels::Context;
use theme::icon::{self, Icon};
use theme::space;
use workbench::Dialog;
use workbench::command::{Command, CommandSender};
use workbench::library::LibraryCommand;
use workbench::library::TEMPLATES;
use workbench::mission_file::EXAMPLES;
use workbench::state::window::WindowCommand;

/// Missions that the menu lists; the others are in the list of all.
const MAX_LISTED: usize = 8;

/// The width at which the whole name can be read.
pub(super) fn width(ui: &Ui, context: &Context<'_>) -> f32 {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let title = context.state.mission_title().to_owned();
    let galley = ui.painter().layout_no_wrap(title, font, context.tokens.text);
    galley.size().x + space::ROW + 20.0
}

/// Shows the name, `width` points wide in all, and the menu beside it.
pub(super) fn show(ui: &mut Ui, context: &Context<'_>, width: f32, commands: &mut CommandSender) {
    ui.spacing_mut().item_spacing.x = space::XS;
    name(ui, context, width - space::ROW - 4.0, commands);
    menu(ui, context, commands);
    ui.spacing_mut().item_spacing.x = space::M;
}

/// The name, as a field that looks like a label until the pointer or the keyboard is there. What is typed counts when
/// the field is left, and Escape takes it back.
fn name(ui: &mut Ui, context: &Context<'_>, width: f32, commands: &mut CommandSender) {
    let id = ui.scope_id().with("mission-name");
    let title = context.state.mission_title();
    let draft = ui.data(|data| data.get_temp::<String>(id));
    let mut text = draft.clone().unwrap_or_else(|| title.to_owned());
    let color = context.tokens.text;
    let field = TextEdit::singleline(&mut text)
        .id(id)
        .desired_width(width)
        .clip_text(true)
        .text_color(color)
        .align(egui::Align2::LEFT_CENTER)
        .min_size(egui::vec2(0.0, space::ROW))
        .frame(egui::Frame::NONE.inner_margin(egui::Margin::symmetric(4, 2)));
    let field = ui.add(field).accessible_name("Mission name");
    if field.hovered() || field.has_focus() {
        let stroke = if field.has_focus() { context.tokens.accent } else { context.tokens.line_strong };
        let kind = egui::StrokeKind::Outside;
        ui.painter().rect_stroke(field.rect, 4.0, egui::Stroke::new(1.0, stroke), kind);
    }
    let field = field.on_hover_text("Rename this mission");
    if field.changed() {
        ui.data_mut(|data| data.insert_temp(id, text.clone()));
    }
    if field.lost_focus() {
        // Escape has been taken by then: what else leaves a field means it.
        let is_meant = ui.input(|input| {
            let pointer = &input.pointer;
            let is_elsewhere = pointer.any_pressed() || pointer.any_released();
            is_elsewhere || input.key_pressed(Key::Enter) || input.key_pressed(Key::Tab)
        });
        ui.data_mut(|data| data.remove_temp::<String>(id));
        if draft.is_some() && is_meant {
            commands.send(Command::Library(LibraryCommand::Rename { id: None, name: text }));
        }
    }
}

fn menu(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let button = Button::new("").min_size(egui::vec2(space::ROW, space::ROW)).frame_when_inactive(false);
    let (response, _) = egui::containers::menu::MenuButton::from_button(button).ui(ui, |ui| {
        ui.set_min_width(260.0);
        egui::ScrollArea::vertical().max_height(ui.ctx().content_rect().height() - 120.0).show(ui, |ui| {
            entries(ui, context, commands);
        });
    });
    icon::paint(ui.painter(), Icon::ChevronDown, response.rect, 12.0, tokens.text_muted);
    response.on_hover_text("Other missions").accessible_name("Switch mission");
}

fn entries(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let library = &context.state.library;
    if ui.button("Missions…").clicked() {
        commands.send(Command::Window(WindowCommand::ShowDialog(Dialog::missions())));
        ui.close();
    }
    if ui.button("New mission").clicked() {
        commands.send(Command::Library(LibraryCommand::New(&TEMPLATES[0])));
        ui.close();
    }
    let heading = |text: &str| RichText::new(text).small().color(context.tokens.text_muted);
    let missions = library.missions();
    if !missions.is_empty() {
        ui.separator();
        ui.label(heading("Your missions"));
    }
    for mission in missions.iter().take(MAX_LISTED) {
        let is_open = library.open_id() == Some(&mission.id);
        if theme::structure::choice(ui, is_open, mission.name.as_str()).clicked() {
            commands.send(Command::Library(LibraryCommand::Open(mission.id.clone())));
            ui.close();
        }
    }
    ui.separator();
    ui.label(heading("Examples"));
    for example in EXAMPLES {
        let is_open = library.open_id().is_none() && context.state.mission == example.name;
        if theme::structure::choice(ui, is_open, example.title).clicked() {
            commands.send(Command::OpenExample(example.name.into()));
            ui.close();
        }
    }
}
