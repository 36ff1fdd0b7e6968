//! The mission text: a code editor that lays out only the lines on screen.
//!
//! The text itself and what keys do to it are in [`workbench::state`]; here it is shown, and the pointer is followed.

mod brackets;
mod find_bar;
mod hover;
mod keyboard;
mod line;
mod marks;
mod popup;
mod text_area;

use egui::Ui;
use workbench::command::CommandSender;

use crate::{Context, Panel};

pub use hover::show_markdown;
pub use keyboard::{editor_id, typed_text};

/// The editor.
#[derive(Default)]
pub struct EditorPanel {
    text_area: text_area::TextArea,
}

impl Panel for EditorPanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        if let Some(find) = &context.state.editor.find {
            find_bar::show(ui, context, find, commands);
        }
        self.text_area.show(ui, context, commands);
    }
}
