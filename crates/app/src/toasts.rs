//! Shows the short messages in the corner.

use egui::{Align2, Area, Frame, Id, Order, Stroke};
use panels::Context;
use theme::icon::{self, Icon};
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::state::ToastKind;
use workbench::state::window::WindowCommand;

/// Shows all messages, newest at the bottom.
pub fn show(egui: &egui::Context, context: &Context<'_>, commands: &mut CommandSender) {
    let toasts = context.state.window.toasts.shown();
    if toasts.is_empty() {
        return;
    }
    let tokens = context.tokens;
    Area::new(Id::unique("toasts"))
        .order(Order::Foreground)
        .anchor(Align2::RIGHT_BOTTOM, [-space::L, -34.0])
        .show(egui, |ui| {
            for (index, toast) in toasts.iter().enumerate() {
                let (sign, color) = match toast.kind {
                    ToastKind::Done => (Icon::Check, tokens.good),
                    ToastKind::Info => (Icon::Info, tokens.info),
                    ToastKind::Failed => (Icon::Warning, tokens.error),
                };
                Frame::popup(ui.style()).stroke(Stroke::new(1.0, color)).show(ui, |ui| {
                    ui.set_max_width(360.0);
                    ui.horizontal(|ui| {
                        icon::label(ui, sign, color);
                        ui.add(egui::Label::new(panels::without_backticks(&toast.text)).wrap());
                        if icon::button(ui, tokens, Icon::Close, "Dismiss message").clicked() {
                            commands.send(Command::Window(WindowCommand::DismissToast(index)));
                        }
                    });
                });
                ui.add_space(space::S);
            }
        });
}
