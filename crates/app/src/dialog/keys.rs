//! The list of keys, made from the command registry and from what the editor does by itself.

use egui::{Grid, RichText, ScrollArea, TextEdit, Ui};
use panels::Context;
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::registry::{Group, all_commands};
use workbench::state::window::WindowCommand;

use crate::chord;

/// What the editor does with keys that are not commands.
const EDITOR_KEYS: [(&str, &str); 12] = [
    ("Arrows, Home, End, Page Up, Page Down", "Move the cursor (with Shift: select)"),
    ("Ctrl+Left, Ctrl+Right", "Move by word"),
    ("Ctrl+Home, Ctrl+End", "Go to the start or end of the text"),
    ("Ctrl+A", "Select all"),
    ("Ctrl+X, Ctrl+C, Ctrl+V", "Cut, copy, paste (the whole line without a selection)"),
    ("Tab, Shift+Tab", "Next placeholder, or indent / outdent"),
    ("Ctrl+Backspace, Ctrl+Delete", "Delete a word"),
    ("Alt+click", "Add or remove a cursor"),
    ("Double-click, triple-click", "Select a word or a line"),
    ("Up, Down, Enter, Tab", "Choose and accept a suggestion"),
    ("Esc", "Close suggestions, collapse to one cursor, leave snippet"),
    ("Double-click a tab", "Maximize or restore panel"),
];

/// Shows the list.
pub(super) fn show(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let room = ui.ctx().content_rect().size();
    ui.set_width((room.x - 80.0).min(720.0));
    let id = ui.scope_id().with("keys-query");
    let mut query = ui.data(|data| data.get_temp::<String>(id)).unwrap_or_default();
    ui.horizontal(|ui| {
        theme::structure::mark_heading(&ui.heading("Keyboard shortcuts"), 2);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if ui.button("Close").clicked() {
                commands.send(Command::Window(WindowCommand::CloseDialog));
            }
            let field = TextEdit::singleline(&mut query).hint_text("Search shortcuts");
            let field = ui.add(field.desired_width(240.0)).accessible_name("Search shortcuts");
            if ui.memory(|memory| memory.focused().is_none()) {
                field.request_focus();
            }
        });
    });
    ui.data_mut(|data| data.insert_temp(id, query.clone()));
    ui.add_space(space::S);
    let wanted = query.trim().to_lowercase();
    let fits = |keys: &str, title: &str| {
        wanted.is_empty() || keys.to_lowercase().contains(&wanted) || title.to_lowercase().contains(&wanted)
    };
    let of_commands = Group::ALL.into_iter().map(|group| {
        let rows = all_commands()
            .filter(|spec| spec.group == group && !spec.keys.is_empty())
            .map(|spec| (chord::texts(ui.ctx(), spec, context.state).join("  or  "), spec.title));
        (group.title(), rows.collect::<Vec<_>>())
    });
    let of_editor = EDITOR_KEYS.map(|(keys, title)| (keys.to_owned(), title)).to_vec();
    let sections: Vec<_> = of_commands.chain([("Text and panels", of_editor)]).collect();
    ScrollArea::vertical().max_height(room.y - 200.0).auto_shrink([false, true]).show(ui, |ui| {
        let mut is_empty = true;
        for (title, rows) in sections {
            let rows: Vec<_> = rows.into_iter().filter(|(keys, title)| fits(keys, title)).collect();
            if rows.is_empty() {
                continue;
            }
            is_empty = false;
            theme::structure::heading(ui, RichText::new(title).strong().color(context.tokens.accent), 3);
            Grid::new(title).num_columns(2).min_col_width(260.0).spacing([space::L, space::S]).show(
                ui,
                |ui| {
                    theme::structure::part(ui, egui::accesskit::Role::Table, title);
                    for (keys, title) in rows {
                        ui.label(RichText::new(keys).strong());
                        ui.label(title);
                        ui.end_row();
                    }
                },
            );
            ui.add_space(space::M);
        }
        if is_empty {
            ui.label(RichText::new("No matching shortcuts").color(context.tokens.text_muted));
        }
    });
}
