//! What is known about the text under the pointer: what is wrong there, and what its language says.

use egui::{Response, RichText, Ui};
use theme::icon;
use theme::show_markdown;

use crate::{Diagnostic, EditorView, LanguageService};

/// Shows what is known at `offset` beside the pointer, unless a list is open at the caret. Returns the place that something
/// is known of.
pub(crate) fn show(
    view: &EditorView<'_>,
    language: &mut dyn LanguageService,
    response: &Response,
    offset: Option<usize>,
) -> Option<usize> {
    let offset = offset.filter(|_| view.popup.is_none())?;
    let touching: Vec<&Diagnostic<'_>> =
        view.diagnostics.iter().filter(|it| it.bytes.start <= offset && offset <= it.bytes.end).collect();
    let markdown = language.hover(offset);
    if touching.is_empty() && markdown.is_none() {
        return None;
    }
    response.clone().on_hover_ui_at_pointer(|ui| {
        ui.set_max_width(460.0);
        for diagnostic in &touching {
            show_diagnostic(ui, view, diagnostic);
        }
        if let Some(markdown) = &markdown {
            if !touching.is_empty() {
                ui.separator();
            }
            show_markdown(ui, view.tokens, markdown);
        }
        if let Some(keys) = view.manual_keys {
            let text = format!("{keys}: open manual");
            ui.label(RichText::new(text).small().color(view.tokens.text_muted));
        }
    });
    Some(offset)
}

fn show_diagnostic(ui: &mut Ui, view: &EditorView<'_>, diagnostic: &Diagnostic<'_>) {
    let tokens = view.tokens;
    let (sign, color) = diagnostic.severity.sign(tokens);
    ui.horizontal_top(|ui| {
        icon::label(ui, sign, color);
        ui.vertical(|ui| {
            show_markdown(ui, tokens, diagnostic.message);
            if let Some(hint) = diagnostic.hint {
                show_markdown(ui, tokens, hint);
            }
            let fix = diagnostic.fix_keys.map(|keys| format!("   {keys} to fix")).unwrap_or_default();
            let below = format!("{}{fix}", diagnostic.code);
            ui.label(RichText::new(below).small().color(tokens.text_muted));
        });
    });
}
