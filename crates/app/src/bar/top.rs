//! The bar on top: menus, the mission, the workspaces, and where the plan is.

use egui::accesskit;
use egui::containers::menu::MenuButton;
use egui::{Align, Button, Frame, Layout, Margin, Panel, RichText, Role, Sense, Stroke, Ui, WidgetInfo};
use panels::Context;
use theme::icon::{self, Icon};
use theme::space;
use theme::structure;
use workbench::Dialog;
use workbench::PanelKind;
use workbench::command::{Command, CommandSender};
use workbench::registry::{CommandSpec, Group, all_commands};
use workbench::state::Status;
use workbench::state::lesson::LessonCommand;
use workbench::state::settings::SettingsCommand;
use workbench::state::settings::ThemeChoice;
use workbench::state::window::WindowCommand;
use workbench::workspace::Workspace;

use crate::bar::badge::{self, Look};
use crate::bar::mission;
use crate::chord;

/// Shows the bar.
pub fn show(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let frame = Frame::new().fill(tokens.background).inner_margin(Margin::symmetric(10, 0));
    Panel::top("top-bar").exact_size(space::BAR).show_separator_line(false).frame(frame).show(ui, |ui| {
        structure::part(ui, accesskit::Role::Banner, "");
        ui.horizontal_centered(|ui| {
            if room(ui) >= ROOM_FOR_NAME {
                structure::heading(ui, RichText::new("Enroute").strong().size(15.0).color(tokens.text), 1);
                ui.add_space(space::S);
            }
            // The menus stand close to each other, as one thing.
            ui.spacing_mut().item_spacing.x = 0.0;
            ui.scope(|ui| menus(ui, context, commands));
            ui.spacing_mut().item_spacing.x = if room(ui) < ROOM_FOR_SPACE { space::XS } else { space::M };
            ui.add_space(space::S);
            // The name has all the room that the frame before left over.
            let spare_id = ui.scope_id().with("spare");
            let (given, spare) = ui.data(|data| data.get_temp::<(f32, f32)>(spare_id)).unwrap_or_default();
            let wanted = mission::width(ui, context);
            let least = if room(ui) < ROOM_FOR_SPACE {
                64.0
            } else if is_narrow(ui) {
                128.0
            } else {
                150.0
            };
            let width = wanted.min(given + spare).max(least);
            mission::show(ui, context, width, commands);
            if room(ui) >= ROOM_FOR_SPACE {
                ui.add_space(space::L);
            }
            workspaces(ui, context, commands);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                tools(ui, context, commands);
                if room(ui) >= ROOM_FOR_SPACE {
                    ui.add_space(space::M);
                }
                status(ui, context, commands);
                let left = (ui.available_width() - STATUS_ROOM).max(0.0);
                if (given, spare) != (width, left) {
                    ui.data_mut(|data| data.insert_temp(spare_id, (width, left)));
                    ui.ctx().request_repaint();
                }
                if (context.state.is_long_at_work() || context.state.is_improving())
                    && icon::button(ui, tokens, Icon::Close, "Stop planning").clicked()
                {
                    commands.send(Command::StopWork);
                }
            });
        });
    });
}

/// A bar narrower than this goes without the name of the program.
const ROOM_FOR_NAME: f32 = 560.0;
/// A bar narrower than this has no space to spare, and the command palette alone of the buttons at its end: the menus have
/// what the others do.
const ROOM_FOR_SPACE: f32 = 640.0;
/// A bar narrower than this has its workspaces in a list: the sign of the plan keeps its words.
const ROOM_FOR_WORKSPACES: f32 = 880.0;
/// Kept free between the workspaces and the sign of the plan, whose words change.
const STATUS_ROOM: f32 = 70.0;
/// A bar narrower than this has its menus in one.
const ROOM_FOR_MENUS: f32 = 1_290.0;

fn menus(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let color = context.tokens.text_muted;
    let button = |title: &str| Button::new(RichText::new(title).color(color)).frame_when_inactive(false);
    if is_narrow(ui) {
        let (opener, _) = MenuButton::from_button(button("Menu")).ui(ui, |ui| {
            structure::part(ui, accesskit::Role::Menu, "Menu");
            for group in Group::ALL {
                let opener = ui.menu_button(group.title(), |ui| menu(ui, context, group, commands)).response;
                structure::role(&opener, accesskit::Role::MenuItem);
            }
        });
        structure::role(&opener, accesskit::Role::MenuItem);
    } else {
        for group in Group::ALL {
            let (opener, _) = MenuButton::from_button(button(group.title()))
                .ui(ui, |ui| menu(ui, context, group, commands));
            structure::role(&opener, accesskit::Role::MenuItem);
        }
    }
    structure::part_in(ui, ui.min_rect(), accesskit::Role::MenuBar, "Menus");
}

fn room(ui: &Ui) -> f32 {
    ui.ctx().content_rect().width()
}

fn is_narrow(ui: &Ui) -> bool {
    room(ui) < ROOM_FOR_MENUS
}

fn menu(ui: &mut Ui, context: &Context<'_>, group: Group, commands: &mut CommandSender) {
    ui.set_min_width(220.0);
    structure::part(ui, accesskit::Role::Menu, group.title());
    if group == Group::View {
        let opener = ui.menu_button("Panels", |ui| panel_items(ui, context, commands)).response;
        structure::role(&opener, accesskit::Role::MenuItem);
        ui.separator();
    }
    // Entries that do not fit into the window scroll.
    let height = ui.ctx().content_rect().height() - 2.0 * space::BAR;
    egui::ScrollArea::vertical().max_height(height).show(ui, |ui| {
        for spec in all_commands().filter(|spec| spec.group == group && spec.is_plain()) {
            menu_item(ui, context, spec, commands);
        }
    });
}

/// All panels, each to be shown.
fn panel_items(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    structure::part(ui, accesskit::Role::Menu, "Panels");
    for panel in PanelKind::ALL {
        let is_on_screen = context.state.window.panels_on_screen.contains(&panel);
        let item = ui.selectable_label(is_on_screen, panel.title());
        structure::role(&item, accesskit::Role::MenuItemCheckBox);
        if item.clicked() {
            commands.send(Command::Window(WindowCommand::ShowPanel(panel)));
            ui.close();
        }
    }
}

fn menu_item(ui: &mut Ui, context: &Context<'_>, spec: &CommandSpec, commands: &mut CommandSender) {
    let keys = chord::texts(ui.ctx(), spec, context.state).into_iter().next().unwrap_or_default();
    let availability = (spec.available)(context.state);
    let button = Button::new(spec.title).shortcut_text(keys);
    let mut response = ui.add_enabled(availability.is_ok(), button);
    structure::role(&response, accesskit::Role::MenuItem);
    if let Err(reason) = availability {
        response = response.on_disabled_hover_text(reason);
    }
    if response.clicked() {
        commands.send(spec.plain(context.state).unwrap_or(Command::Window(WindowCommand::CloseDialog)));
        ui.close();
    }
}

fn workspaces(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    if room(ui) < ROOM_FOR_WORKSPACES {
        return workspace_list(ui, context, commands);
    }
    ui.spacing_mut().item_spacing.x = space::XS;
    for workspace in Workspace::ALL {
        let is_open = context.state.window.workspace == workspace && !context.state.lesson.is_beside();
        let color = if is_open { tokens.text } else { tokens.text_muted };
        let fill = if is_open { tokens.pressed } else { tokens.background };
        let button = Button::new(RichText::new(workspace.title()).color(color))
            .fill(fill)
            .stroke(Stroke::NONE)
            .selected(is_open);
        let button = ui.add(button);
        structure::mark_current(&button, is_open);
        if button.clicked() {
            commands.send(Command::ShowWorkspace(workspace));
        }
    }
    let is_open = context.state.lesson.is_beside();
    let color = if is_open { tokens.text } else { tokens.text_muted };
    let fill = if is_open { tokens.pressed } else { tokens.background };
    let lessons =
        Button::new(RichText::new("Lessons").color(color)).fill(fill).stroke(Stroke::NONE).selected(is_open);
    let lessons = ui.add(lessons).on_hover_text("Open the guided course (L)");
    structure::mark_current(&lessons, is_open);
    if lessons.clicked() {
        commands.send(Command::Lesson(LessonCommand::Show));
    }
    ui.spacing_mut().item_spacing.x = space::M;
}

/// The workspaces as a list that opens.
fn workspace_list(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let is_lesson = context.state.lesson.is_beside();
    let title = if is_lesson { "Lessons" } else { context.state.window.workspace.title() };
    let list = egui::ComboBox::from_id_salt("workspace").selected_text(title).width(0.0);
    let shown = list.show_ui(ui, |ui| {
        structure::options(ui, "Workspace");
        for workspace in Workspace::ALL {
            let is_open = context.state.window.workspace == workspace && !is_lesson;
            if structure::option(ui, is_open, workspace.title()).clicked() {
                commands.send(Command::ShowWorkspace(workspace));
            }
        }
        if structure::option(ui, is_lesson, "Lessons").clicked() {
            commands.send(Command::Lesson(LessonCommand::Show));
        }
    });
    shown.response.accessible_name("Workspace");
}

/// Where the plan is: a sign, a word, and a color.
fn status(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let latest = context.state.snapshots.latest();
    let verdict = latest.and_then(|latest| latest.planning.as_ref()?.verdict.as_ref());
    let Look { sign, text, color, fill, panel } =
        badge::look(tokens, context.state.status(), context.is_stale, verdict.map(|it| it.valid));
    let font = egui::TextStyle::Body.resolve(ui.style());
    let galley = ui.painter().layout_no_wrap(text.to_owned(), font, color);
    let width = galley.size().x + 40.0;
    // The sign alone says enough where the words would cover the workspaces.
    let has_room = width <= ui.available_width();
    let size = egui::vec2(if has_room { width } else { 32.0 }, space::ROW);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let name = status_name(context);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    ui.painter().rect_filled(rect, rect.height() / 2.0, fill);
    if response.hovered() || response.has_focus() {
        let stroke = Stroke::new(1.0, color);
        ui.painter().rect_stroke(rect, rect.height() / 2.0, stroke, egui::StrokeKind::Inside);
    }
    let sign_rect =
        egui::Rect::from_min_size(rect.min + egui::vec2(8.0, 0.0), egui::vec2(16.0, rect.height()));
    icon::paint(ui.painter(), sign, sign_rect, 13.0, color);
    let at = egui::pos2(rect.left() + 28.0, rect.center().y - galley.size().y / 2.0);
    if has_room {
        ui.painter().galley(at, galley, color);
    }
    if response.on_hover_text("Show details").clicked() {
        commands.send(Command::Window(WindowCommand::ShowPanel(panel)));
    }
}

fn status_name(context: &Context<'_>) -> &'static str {
    match context.state.status() {
        Status::Working => "Status: planning",
        Status::Broken => "Status: errors",
        Status::Empty => "Status: nothing to plan",
        Status::Program => "Status: control program",
        Status::Plan => "Status: plan found",
        Status::NoPlan => "Status: no plan",
        Status::Undecided => "Status: undecided, planning was stopped",
    }
}

fn tools(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    ui.spacing_mut().item_spacing.x = space::XS;
    let palette = |ui: &mut Ui, commands: &mut CommandSender| {
        if icon::button(ui, tokens, Icon::Palette, "Command palette").clicked() {
            commands.send(Command::Window(WindowCommand::ShowDialog(Dialog::palette())));
        }
    };
    if room(ui) < ROOM_FOR_SPACE {
        return palette(ui, commands);
    }
    if icon::button(ui, tokens, Icon::Help, "Keyboard shortcuts").clicked() {
        commands.send(Command::Window(WindowCommand::ShowDialog(Dialog::Keys)));
    }
    let (sign, name, other) = if context.state.is_dark() {
        (Icon::Sun, "Light theme", ThemeChoice::Light)
    } else {
        (Icon::Moon, "Dark theme", ThemeChoice::Dark)
    };
    if icon::button(ui, tokens, sign, name).clicked() {
        commands.send(Command::Settings(SettingsCommand::SetTheme(other)));
    }
    palette(ui, commands);
    ui.spacing_mut().item_spacing.x = space::M;
}
