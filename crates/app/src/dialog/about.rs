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
        "Write missions in RMPL, plan them with temporal plan networks, verify each plan independently, \
         and simulate drives over terrain.",
    );
    ui.add_space(space::S);
    ui.label(
        RichText::new("Enroute runs entirely in this window and sends no data.")
            .color(context.tokens.text_muted),
    );
    if !context.state.frame.renderer.is_empty() {
        let drawn = format!("Renderer: {}", context.state.frame.renderer_name());
        ui.label(RichText::new(drawn).color(context.tokens.text_muted));
    }
    ui.add_space(space::M);
    if ui.button("Close").clicked() {
        commands.send(Command::Window(WindowCommand::CloseDialog));
    }
}
