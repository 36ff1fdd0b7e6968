//! The list of keys, made from the command registry.

use egui::{Grid, RichText, ScrollArea, Ui};
use panels::Context;
use theme::space;
use workbench::command::{Command, CommandSender, Group, all_commands};

use crate::chord;

/// Shows the list.
pub(super) fn show(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    ui.set_width(620.0);
    ui.horizontal(|ui| {
        ui.heading("Keyboard shortcuts");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if ui.button("Close").clicked() {
                commands.send(Command::CloseDialog);
            }
        });
    });
    ui.add_space(space::S);
    ScrollArea::vertical().max_height(460.0).auto_shrink([false, true]).show(ui, |ui| {
        ui.columns(2, |columns| {
            for (index, group) in Group::ALL.into_iter().enumerate() {
                let ui = &mut columns[index % 2];
                let with_keys: Vec<_> =
                    all_commands().filter(|spec| spec.group == group && !spec.keys.is_empty()).collect();
                if with_keys.is_empty() {
                    continue;
                }
                ui.label(RichText::new(group.title()).strong().color(tokens.accent));
                Grid::new(group.title()).num_columns(2).spacing([space::L, space::XS]).show(ui, |ui| {
                    for spec in with_keys {
                        let keys: Vec<String> =
                            spec.keys.iter().map(|&keys| chord::text(ui.ctx(), keys)).collect();
                        ui.label(RichText::new(keys.join("  ")).monospace().color(tokens.text_muted));
                        ui.label(spec.title);
                        ui.end_row();
                    }
                });
                ui.add_space(space::M);
            }
        });
    });
}
