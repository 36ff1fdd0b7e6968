//! Says that there is nothing to show, and why.

use egui::{RichText, Ui};

use crate::command::CommandSender;
use crate::panel::{Context, Panel, PanelKind};

/// A panel without content.
pub struct PlaceholderPanel {
    kind: PanelKind,
}

impl PlaceholderPanel {
    /// An empty panel of a kind.
    pub fn new(kind: PanelKind) -> Self {
        Self { kind }
    }
}

impl Panel for PlaceholderPanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, _commands: &mut CommandSender) {
        show_empty(ui, context, &format!("{} is not drawn yet.", self.kind.title()));
    }
}

/// A quiet sentence in the middle of a panel.
pub fn show_empty(ui: &mut Ui, context: &Context<'_>, text: &str) {
    ui.centered_and_justified(|ui| {
        ui.label(RichText::new(text).color(context.tokens.text_muted));
    });
}
