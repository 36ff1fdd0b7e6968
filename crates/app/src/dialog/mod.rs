//! Dialogs over the panels: missions, the command palette, the key list, going to a line, explanations.

mod about;
mod epoch;
mod explain;
mod go_to_line;
mod keys;
mod missions;
mod name;
mod palette;
mod rename;
mod settings;
mod trust;

use egui::{Align2, Area, Frame, Id, Order};
use panels::Context;
use theme::space;
use theme::structure;
use workbench::Dialog;
use workbench::command::{Command, CommandSender};
use workbench::state::window::WindowCommand;

/// Shows the open dialog, if there is one.
pub fn show(egui: &egui::Context, context: &Context<'_>, commands: &mut CommandSender) {
    let Some(dialog) = &context.state.window.dialog else { return };
    let is_list = matches!(
        dialog,
        Dialog::Palette { .. }
            | Dialog::GoToLine { .. }
            | Dialog::Rename { .. }
            | Dialog::MissionName { .. }
            | Dialog::VersionName { .. }
            | Dialog::FileName { .. }
    );
    let anchor = if is_list { Align2::CENTER_TOP } else { Align2::CENTER_CENTER };
    let offset = if is_list { egui::vec2(0.0, 72.0) } else { egui::Vec2::ZERO };
    // Each dialog has a size of its own, and keeps it.
    let id = Id::unique("dialog").with(dialog.name());
    let area = Area::new(id).order(Order::Foreground).anchor(anchor, offset).constrain(true);
    let modal = egui::Modal::new(id)
        .area(area)
        .backdrop_color(context.tokens.shadow)
        .frame(Frame::window(&egui.style_of(egui.theme())).inner_margin(space::L));
    let answer = modal.show(egui, |ui| {
        show_content(ui, context, dialog, commands);
        structure::part_in(ui, ui.min_rect(), egui::accesskit::Role::Dialog, dialog.title());
    });
    if answer.should_close() {
        commands.send(Command::Window(WindowCommand::CloseDialog));
    }
}

fn show_content(ui: &mut egui::Ui, context: &Context<'_>, dialog: &Dialog, commands: &mut CommandSender) {
    match dialog {
        Dialog::Palette { query, chosen } => palette::show(ui, context, query, *chosen, commands),
        Dialog::GoToLine { line } => go_to_line::show(ui, context, line, commands),
        Dialog::Rename { old, name } => rename::show(ui, context, old, name, commands),
        Dialog::Epoch { form, epoch } => epoch::show(ui, context, *form, epoch, commands),
        Dialog::Explain(code) => explain::show(ui, context, code, commands),
        Dialog::Missions { query, renaming } => missions::show(ui, context, query, renaming, commands),
        Dialog::MissionName { name } => name::show(ui, name::Named::Mission, name, commands),
        Dialog::VersionName { name } => name::show(ui, name::Named::Version, name, commands),
        Dialog::FileName { name, renames } => {
            let named = if *renames { name::Named::File } else { name::Named::NewFile };
            name::show(ui, named, name, commands);
        }
        Dialog::TrustKeys { file, people } => trust::show(ui, context, file, people, commands),
        Dialog::Settings => settings::show(ui, context, commands),
        Dialog::Keys => keys::show(ui, context, commands),
        Dialog::About => about::show(ui, context, commands),
    }
}

/// Selects all of a text field of so many characters that has not had the keyboard yet, so that typing replaces it.
fn select_all_at_first(ui: &egui::Ui, field: &egui::Response, characters: usize) {
    if field.has_focus() || field.lost_focus() {
        return;
    }
    let mut state = egui::TextEdit::load_state(ui.ctx(), field.id).unwrap_or_default();
    let all = egui::text::CCursorRange::two(
        egui::text::CCursor::default(),
        egui::text::CCursor::new(egui::text::CharIndex::from(characters)),
    );
    state.cursor.set_char_range(Some(all));
    state.store(ui.ctx(), field.id);
}
