//! Text that may not have the room of its row.

use std::sync::Arc;

use egui::{Galley, RichText, TextStyle, TextWrapMode, Ui, WidgetText};

/// A text laid out in one line, whatever room there is, to be measured before it is shown.
pub(crate) fn in_one_line(ui: &Ui, text: RichText) -> Arc<Galley> {
    WidgetText::from(text).into_galley(ui, Some(TextWrapMode::Extend), f32::INFINITY, TextStyle::Body)
}

/// A text in one line, cut where its room ends. In a grid a label that may be cut by itself gives way to all others.
pub(crate) fn cut_to(ui: &Ui, text: &str, width: f32) -> Arc<Galley> {
    WidgetText::from(text).into_galley(ui, Some(TextWrapMode::Truncate), width, TextStyle::Body)
}
