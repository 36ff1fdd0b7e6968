//! What this program is.

use egui::{RichText, Ui};
use panels::Context;
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::state::window::WindowCommand;

/// Shows name, version and purpose.
pub(super) fn show(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    ui.set_width(380.0);
    theme::structure::mark_heading(&ui.heading(concat!("Enroute ", env!("CARGO_PKG_VERSION"))), 2);
    ui.label(
        "Mission plans for cooperative vehicles: written in RMPL, planned as temporal plan networks, checked \
              by an independent verifier, and driven over terrain.",
    );
    ui.add_space(space::S);
    ui.label(
        RichText::new("Everything runs in this window; nothing is sent anywhere.")
            .color(context.tokens.text_muted),
    );
    if !context.state.frame.renderer.is_empty() {
        let drawn = format!("Drawn by {}.", context.state.frame.renderer);
        ui.label(RichText::new(drawn).color(context.tokens.text_muted));
    }
    ui.add_space(space::M);
    if ui.button("Close").clicked() {
        commands.send(Command::Window(WindowCommand::CloseDialog));
    }
}
