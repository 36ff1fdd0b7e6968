//! Text that may not have the room of its row.

use std::sync::Arc;

use egui::{Galley, RichText, TextStyle, TextWrapMode, Ui, WidgetText};

/// A text laid out in one line, whatever room there is, to be measured before it is shown.
pub(crate) fn in_one_line(ui: &Ui, text: RichText) -> Arc<Galley> {
    WidgetText::from(text).into_galley(ui, Some(TextWrapMode::Extend), f32::INFINITY, TextStyle::Body)
}
