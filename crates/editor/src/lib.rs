//! A code editor as a widget: it lays out only the lines on screen, and knows nothing of what the text means.
//!
//! It is told everything for one frame as an [`EditorView`], asks a [`LanguageService`] about the part of the text that
//! is on screen or under the pointer, and returns what its user wants as [`EditorAction`]s. It changes nothing itself: the
//! text, its caret and its history are a [`Document`](text_editing::Document), which its owner changes.

mod action;
mod brackets;
mod caret;
mod find_bar;
mod geometry;
mod gutter;
mod hover;
mod keyboard;
mod line;
mod menu;
mod painting;
mod pointer;
mod popup;
mod text_area;
mod view;

use egui::Ui;

pub use action::EditorAction;
pub use keyboard::{Keyboard, typed, typed_ahead};
pub use view::{
    Diagnostic, EditorView, Highlight, LanguageService, Mark, MenuEntry, Popup, PopupItem, Reveal, Severity,
    Signature,
};

/// The widget: it keeps only what concerns no one else, such as where the text is scrolled to.
#[derive(Debug, Default)]
pub struct Editor {
    text_area: text_area::TextArea,
}

impl Editor {
    /// Shows the editor in what is left of `ui`. Returns what its user wants, in order.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        view: &EditorView<'_>,
        language: &mut dyn LanguageService,
    ) -> Vec<EditorAction> {
        let mut actions = Vec::new();
        if let Some(find) = view.find {
            find_bar::show(ui, view, find, &mut actions);
        }
        self.text_area.show(ui, view, language, &mut actions);
        actions
    }
}

/// Returns whether the pointer went down here, though it may be up again: where frames are slow, one frame sees both.
fn is_pressed(response: &egui::Response) -> bool {
    response.is_pointer_button_down_on() || response.clicked()
}
