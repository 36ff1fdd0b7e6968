//! What a kind of problem means, with an example and its fix: the language's manual page.

use egui::{Frame, Margin, RichText, ScrollArea, Ui};
use panels::Context;
use theme::show_markdown;
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::manual;
use workbench::state::manual::ManualCommand;
use workbench::state::window::WindowCommand;

/// Shows the manual page of `code`.
pub(super) fn show(ui: &mut Ui, context: &Context<'_>, code: &str, commands: &mut CommandSender) {
    let tokens = context.tokens;
    ui.set_width(560.0);
    let Some(page) = rmpl::explain(code) else {
        ui.label(format!("No help available for {code}."));
        close(ui, commands);
        return;
    };
    ui.horizontal(|ui| {
        theme::structure::mark_heading(&ui.heading(page.title), 2);
        ui.label(RichText::new(code).monospace().color(tokens.text_muted));
    });
    ui.add_space(space::S);
    ScrollArea::vertical().max_height(420.0).auto_shrink([false, true]).show(ui, |ui| {
        show_markdown(ui, tokens, page.meaning);
        for (title, text) in [("Example", page.example), ("Fixed", page.mended)] {
            ui.add_space(space::S);
            ui.label(theme::strong(title));
            Frame::new().fill(tokens.sunken).corner_radius(4.0).inner_margin(Margin::same(8)).show(
                ui,
                |ui| {
                    ui.set_width(ui.available_width());
                    ui.label(RichText::new(text.trim()).monospace());
                },
            );
            if title == "Example" {
                ui.add_space(space::S);
                show_markdown(ui, tokens, page.fix);
            }
        }
    });
    ui.add_space(space::M);
    ui.horizontal(|ui| {
        close(ui, commands);
        if ui.button("Open in manual").clicked()
            && let Some(section) = manual::section_of_code(code)
        {
            commands.send(Command::Window(WindowCommand::CloseDialog));
            commands.send(Command::Manual(ManualCommand::Open("diagnostics", section)));
        }
    });
}

fn close(ui: &mut Ui, commands: &mut CommandSender) {
    if ui.button("Close").clicked() {
        commands.send(Command::Window(WindowCommand::CloseDialog));
    }
}
