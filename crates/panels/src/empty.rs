//! Says that there is nothing to show, and why.

use egui::{RichText, Ui};

use crate::Context;

/// A quiet sentence in the middle of a panel.
pub fn show_empty(ui: &mut Ui, context: &Context<'_>, text: &str) {
    ui.centered_and_justified(|ui| {
        ui.label(RichText::new(text).color(context.tokens.text_muted));
    });
}
