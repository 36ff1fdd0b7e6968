//! The bar on top: menus, the mission, the workspaces, and where the plan stands.

use egui::{Align, Button, ComboBox, Frame, Layout, Margin, Panel, RichText, Stroke, Ui};

use crate::command::{COMMANDS, Command, CommandSender, CommandSpec, Group};
use crate::dialog::Dialog;
use crate::mission_file::EXAMPLES;
use crate::panel::{Context, PanelKind};
use crate::state::Status;
use crate::theme::{ThemeChoice, space};
use crate::workspace::Workspace;

/// Shows the bar.
pub fn show(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let frame = Frame::new().fill(tokens.background).inner_margin(Margin::symmetric(10, 0));
    Panel::top("top-bar").exact_size(space::BAR).show_separator_line(false).frame(frame).show(ui, |ui| {
        ui.horizontal_centered(|ui| {
            ui.label(RichText::new("Enroute").strong().size(15.0).color(tokens.text));
            ui.add_space(space::S);
            menus(ui, context, commands);
            ui.add_space(space::S);
            mission_picker(ui, context, commands);
            ui.add_space(space::L);
            workspaces(ui, context, commands);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                tools(ui, context, commands);
                ui.add_space(space::M);
                status(ui, context, commands);
            });
        });
    });
}

fn menus(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    ui.spacing_mut().item_spacing.x = 0.0;
    for group in Group::ALL {
        let title = Button::new(RichText::new(group.title()).color(context.tokens.text_muted))
            .frame_when_inactive(false);
        egui::containers::menu::MenuButton::from_button(title).ui(ui, |ui| {
            ui.set_min_width(220.0);
            for spec in COMMANDS.iter().filter(|spec| spec.group == group && spec.is_plain()) {
                menu_item(ui, context, spec, commands);
            }
            if group == Group::View {
                ui.separator();
                for panel in PanelKind::ALL {
                    if ui.button(panel.title()).clicked() {
                        commands.send(Command::ShowPanel(panel));
                        ui.close();
                    }
                }
            }
        });
    }
    ui.spacing_mut().item_spacing.x = space::M;
}

fn menu_item(ui: &mut Ui, context: &Context<'_>, spec: &CommandSpec, commands: &mut CommandSender) {
    let keys = spec.keys.first().map(|keys| ui.ctx().format_shortcut(keys)).unwrap_or_default();
    let availability = (spec.available)(context.state);
    let button = Button::new(spec.title).shortcut_text(keys);
    let mut response = ui.add_enabled(availability.is_ok(), button);
    if let Err(reason) = availability {
        response = response.on_disabled_hover_text(reason);
    }
    if response.clicked() {
        commands.send(spec.plain(context.state).unwrap_or(Command::CloseDialog));
        ui.close();
    }
}

fn mission_picker(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let open = EXAMPLES.iter().find(|example| context.state.mission == example.name);
    let title = open.map_or(context.state.mission.as_str(), |example| example.title);
    ComboBox::from_id_salt("mission")
        .selected_text(title)
        .width(170.0)
        .show_ui(ui, |ui| {
            for example in EXAMPLES {
                let is_open = context.state.mission == example.name;
                if ui.selectable_label(is_open, example.title).clicked() {
                    commands.send(Command::OpenExample(example.name.into()));
                }
            }
        })
        .response
        .accessible_name("Mission");
}

fn workspaces(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    ui.spacing_mut().item_spacing.x = space::XS;
    for workspace in Workspace::ALL {
        let is_open = context.state.workspace == workspace;
        let color = if is_open { tokens.text } else { tokens.text_muted };
        let fill = if is_open { tokens.pressed } else { tokens.background };
        let button = Button::new(RichText::new(workspace.title()).color(color))
            .fill(fill)
            .stroke(Stroke::NONE)
            .selected(is_open);
        if ui.add(button).clicked() {
            commands.send(Command::ShowWorkspace(workspace));
        }
    }
    ui.spacing_mut().item_spacing.x = space::M;
}

/// Where the plan stands: a sign, a word, and a colour.
fn status(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let [good, warning, error, info] = tokens.soft;
    let (sign, text, color, fill, panel) = match context.state.status() {
        Status::Working => ("…", "Planning".to_owned(), tokens.info, info, PanelKind::Plan),
        Status::Broken => {
            let text = if context.is_stale { "Errors · showing the last good plan" } else { "Errors" };
            ("⚠", text.to_owned(), tokens.error, error, PanelKind::Problems)
        }
        Status::Empty => ("–", "Nothing to plan".to_owned(), tokens.warning, warning, PanelKind::Problems),
        Status::Plan => ("✔", "Plan".to_owned(), tokens.good, good, PanelKind::Plan),
        Status::NoPlan => ("✖", "No plan".to_owned(), tokens.error, error, PanelKind::Plan),
    };
    let text = RichText::new(format!("{sign}  {text}")).color(color);
    let button = Button::new(text).fill(fill).stroke(Stroke::NONE).corner_radius(10.0);
    if ui.add(button).accessible_name(status_name(context)).clicked() {
        commands.send(Command::ShowPanel(panel));
    }
}

fn status_name(context: &Context<'_>) -> &'static str {
    match context.state.status() {
        Status::Working => "Status: planning",
        Status::Broken => "Status: the text has errors",
        Status::Empty => "Status: nothing to plan",
        Status::Plan => "Status: plan found",
        Status::NoPlan => "Status: no plan",
    }
}

fn tools(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let quiet = |text: &'static str| Button::new(text).frame_when_inactive(false);
    if ui.add(quiet("?")).on_hover_text("Keyboard shortcuts").accessible_name("Keyboard shortcuts").clicked()
    {
        commands.send(Command::ShowDialog(Dialog::Keys));
    }
    let (sign, name) = match context.state.settings.theme {
        ThemeChoice::Dark => ("☀", "Light theme"),
        ThemeChoice::Light => ("🌙", "Dark theme"),
    };
    if ui.add(quiet(sign)).on_hover_text(name).accessible_name(name).clicked() {
        commands.send(Command::SetTheme(context.state.settings.theme.toggled()));
    }
    let palette = ui.add(quiet("⌘")).on_hover_text("Command palette (F1)");
    if palette.accessible_name("Command palette").clicked() {
        commands.send(Command::ShowDialog(Dialog::palette()));
    }
}
