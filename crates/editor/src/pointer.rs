//! What the pointer does in the text: it places the caret, selects, and opens and closes folds.

use egui::{Response, Ui};
use text_editing::TextCommand;

use crate::geometry::{Geometry, ShownRows};
use crate::{EditorAction, EditorView, LanguageService};

/// A selection that is being drawn with the pointer.
#[derive(Debug, Default)]
pub(crate) struct Drag {
    /// Where it began, in bytes.
    anchor: usize,
}

impl Drag {
    #[expect(clippy::too_many_arguments, reason = "what one frame of the text area holds")]
    pub(crate) fn follow(
        &mut self,
        ui: &Ui,
        view: &EditorView<'_>,
        language: &mut dyn LanguageService,
        geometry: &Geometry<'_>,
        response: &Response,
        shown: &ShownRows,
        actions: &mut Vec<EditorAction>,
    ) {
        let Some(pointer) = response.interact_pointer_pos() else { return };
        let document = view.document;
        let row = geometry.row_at_height(pointer.y).unwrap_or_default().min(geometry.num_rows(document) - 1);
        let (line, nth) = geometry.place_of(row);
        let x = pointer.x - geometry.origin.x;
        let primary_pressed =
            ui.input(|input| input.pointer.primary_pressed()) && crate::is_pressed(response);
        let is_at_folds = x < 0.0 && pointer.x >= geometry.fold_signs(ui.clip_rect()).min;
        if is_at_folds && primary_pressed && language.foldable_lines().binary_search(&line).is_ok() {
            actions.push(EditorAction::ToggleFold(line));
            return;
        }
        let offset = match shown.row(row) {
            Some(shown) => shown.layout.offset_at(view, x),
            None => document.offset_in_row(line, nth, (x / geometry.character_width).max(0.0) as usize),
        };
        let is_pressed =
            |button| ui.input(|input| input.pointer.button_pressed(button)) && crate::is_pressed(response);
        let caret = document.caret();
        let is_selected = (caret.anchor.min(caret.head)..caret.anchor.max(caret.head)).contains(&offset);
        // A menu is about what is under the pointer, and so is what Linux pastes with the middle button.
        let pastes =
            ui.ctx().os() == egui::os::OperatingSystem::Nix && is_pressed(egui::PointerButton::Middle);
        if pastes || is_pressed(egui::PointerButton::Secondary) && !is_selected {
            self.anchor = offset;
            actions.push(EditorAction::Text(TextCommand::Select { anchor: offset, head: offset }));
        }
        let adds = ui.input(|input| input.modifiers.alt);
        if primary_pressed && adds {
            self.anchor = offset;
            actions.push(EditorAction::Text(TextCommand::ToggleCaret(offset)));
        } else if primary_pressed {
            let extends = ui.input(|input| input.modifiers.shift);
            self.anchor = if extends { document.caret().anchor } else { offset };
            actions.push(EditorAction::Text(TextCommand::Select { anchor: self.anchor, head: offset }));
        } else if response.double_clicked() {
            actions.push(EditorAction::Text(TextCommand::SelectWord(offset)));
        } else if response.triple_clicked() {
            actions.push(EditorAction::Text(TextCommand::SelectLine(offset)));
        } else if response.dragged_by(egui::PointerButton::Primary)
            && !adds
            && offset != document.caret().head
        {
            actions.push(EditorAction::Text(TextCommand::Select { anchor: self.anchor, head: offset }));
        }
        if crate::is_pressed(response) {
            actions.push(EditorAction::Press);
        }
    }
}

/// The byte of the text under the pointer, if there is text.
pub(crate) fn offset_under(
    view: &EditorView<'_>,
    geometry: &Geometry<'_>,
    response: &Response,
    shown: &ShownRows,
) -> Option<usize> {
    let pointer = response.hover_pos()?;
    let layout = &shown.row(geometry.row_at_height(pointer.y)?)?.layout;
    let x = pointer.x - geometry.origin.x;
    (x >= layout.left() && x <= layout.right()).then(|| layout.offset_at(view, x))
}
