//! The text with its gutter: scrolled, laid out, painted, and followed by the pointer.

use egui::{CursorIcon, Pos2, Rect, Response, Role, ScrollArea, Sense, TextStyle, Ui, WidgetInfo};

use text_editing::{MIN_WRAP_COLUMNS, Rows, WrappedRows};

use crate::geometry::{Geometry, LONGEST_ROW_BYTES, ShownRows};
use crate::painting::Painting;
use crate::pointer::Drag;
use crate::{
    EditorAction, EditorView, LanguageService, Reveal, caret, gutter, hover, keyboard, menu, pointer, popup,
};

/// The text with its gutter.
#[derive(Debug, Default)]
pub(crate) struct TextArea {
    drag: Drag,
    /// The width of the widest line, for the revision it was measured at.
    widest: (u64, usize),
    /// Which row stands where, if lines are broken into rows.
    wrapped: Option<Wrapped>,
    /// How far the view is scrolled.
    offset: egui::Vec2,
    /// Where the list at the caret was on screen in the last frame, if it was open.
    popup: Option<Rect>,
    /// The place under the pointer that something is known of, as its owner was told.
    hovered: Option<usize>,
}

/// The rows that lines are broken into, and what they were worked out for.
#[derive(Debug)]
struct Wrapped {
    revision: u64,
    columns: usize,
    folded: Rows,
    rows: WrappedRows,
}

/// Columns that stay free at the right of rows that lines are broken into: for a blank that hangs over, and the caret.
const FREE_COLUMNS: f32 = 2.0;

/// Columns that can be seen behind a place to which the view was scrolled sideways.
const MARGIN_COLUMNS: f32 = 4.0;

impl TextArea {
    /// Shows the text in what is left of `ui`.
    pub(crate) fn show(
        &mut self,
        ui: &mut Ui,
        view: &EditorView<'_>,
        language: &mut dyn LanguageService,
        actions: &mut Vec<EditorAction>,
    ) {
        let font = TextStyle::Monospace.resolve(ui.style());
        let (text_height, character_width) =
            ui.fonts_mut(|fonts| (fonts.row_height(&font), fonts.glyph_width(&font, '0')));
        let row_height = (text_height * 1.18).round();
        let num_lines = view.document.line_count();
        let digits = num_lines.to_string().len().max(3);
        let gutter_width = (digits as f32 + 3.0) * character_width;
        let available = ui.available_size();
        let columns = ((available.x - gutter_width - ui.spacing().scroll.allocated_width()) / character_width
            - FREE_COLUMNS)
            .max(MIN_WRAP_COLUMNS as f32) as usize;
        let widest_line = self.widest_line(view);
        let wanted = (view.wraps || widest_line > LONGEST_ROW_BYTES).then_some(columns);
        if view.document.wrap_columns() != wanted {
            actions.push(EditorAction::WrapAt(wanted));
        }
        self.wrap(view);
        let is_wrapped = self.wrapped.is_some();
        let widest = if is_wrapped { 0.0 } else { widest_line as f32 * character_width + 60.0 };
        let wrapped = self.wrapped.as_ref().map(|wrapped| &wrapped.rows);
        let geometry_of = |origin: Pos2| Geometry {
            font: font.clone(),
            row_height,
            character_width,
            gutter_width,
            origin: origin + egui::vec2(gutter_width, 0.0),
            folded: view.rows,
            wrapped,
        };
        let num_rows = geometry_of(Pos2::ZERO).num_rows(view.document);
        let size = egui::vec2(
            (gutter_width + widest).max(available.x),
            (num_rows as f32 * row_height + available.y * 0.5).max(available.y),
        );

        let mut area = ScrollArea::both().id_salt("text").auto_shrink(false);
        if let Some(reveal) = view.reveal {
            let offset = scrolled_to(view, self.offset, reveal, &geometry_of(Pos2::ZERO), available);
            area = area.scroll_offset(offset);
        }
        let shown = area.show_viewport(ui, |ui, viewport| {
            let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
            let geometry = geometry_of(rect.min);
            let first = (viewport.top() / row_height).floor().max(0.0) as usize;
            let last = ((viewport.bottom() / row_height).ceil().max(0.0) as usize).min(num_rows);
            let response = ui.interact(ui.clip_rect().intersect(rect), view.id, Sense::click_and_drag());
            follow_focus(ui, view, &response, self.popup.take());
            let shown = ShownRows::new(ui, view, language, &geometry, first.min(last)..last);
            self.drag.follow(ui, view, language, &geometry, &response, &shown, actions);
            menu::show(view, &response, actions);
            paint(ui, view, language, &geometry, &response, &shown);
            describe(ui, view, &response);
            let offset = pointer::offset_under(view, &geometry, &response, &shown);
            let hovered = hover::show(view, language, &response, offset);
            if self.hovered != hovered {
                self.hovered = hovered;
                actions.push(EditorAction::Hover(hovered));
            }
            if let Some(caret) = caret::rect(view, &geometry, &shown).filter(|_| response.has_focus()) {
                let to_global = ui.ctx().layer_transform_to_global(ui.layer_id()).unwrap_or_default();
                self.popup = popup::show(ui, view, to_global * caret, actions);
                popup::show_signature(ui, view, language, to_global * caret);
            }
        });
        self.offset = shown.state.clamped_offset();
    }

    /// Works out which row stands where, if lines are broken into rows.
    fn wrap(&mut self, view: &EditorView<'_>) {
        let Some(columns) = view.document.wrap_columns() else {
            self.wrapped = None;
            return;
        };
        let revision = view.document.revision();
        let is_known = self.wrapped.as_ref().is_some_and(|known| {
            known.revision == revision && known.columns == columns && known.folded == *view.rows
        });
        if !is_known {
            let rows = WrappedRows::new(view.document, view.rows);
            self.wrapped = Some(Wrapped { revision, columns, folded: view.rows.clone(), rows });
        }
    }

    /// The bytes of the longest line, which are at least its characters.
    fn widest_line(&mut self, view: &EditorView<'_>) -> usize {
        let document = view.document;
        if self.widest.0 != document.revision() {
            let widths = (0..document.line_count()).map(|line| document.line_range(line).len());
            self.widest = (document.revision(), widths.max().unwrap_or_default());
        }
        self.widest.1
    }
}

/// Returns how far the view is scrolled when a place is to be seen, once, and it was scrolled by `offset` before.
fn scrolled_to(
    view: &EditorView<'_>,
    offset: egui::Vec2,
    reveal: Reveal,
    geometry: &Geometry<'_>,
    available: egui::Vec2,
) -> egui::Vec2 {
    let document = view.document;
    let head = document.boundary_before(reveal.offset);
    let top = geometry.top_of(geometry.row_at(document, head));
    let margin = geometry.row_height * 2.0;
    let is_visible =
        top >= offset.y + margin.min(top) && top + geometry.row_height + margin <= offset.y + available.y;
    let y = if is_visible {
        offset.y
    } else if reveal.center {
        (top - available.y * 0.4).max(0.0)
    } else if top < offset.y + margin {
        (top - margin).max(0.0)
    } else {
        top + geometry.row_height + margin - available.y
    };
    let column = |offset: usize| document.column_at(offset) as f32 * geometry.character_width;
    let left = column(head);
    let room = available.x - geometry.gutter_width - geometry.character_width;
    let line_fits = column(document.line_range(document.line_at(head)).end) <= room;
    // A view that was scrolled sideways goes all the way back as soon as nothing of the line is hidden then.
    let x = if geometry.wrapped.is_some() || line_fits || left < offset.x && left <= room {
        0.0
    } else if left < offset.x {
        left - room / 2.0
    } else if left > offset.x + room {
        left - room + MARGIN_COLUMNS * geometry.character_width
    } else {
        offset.x
    };
    egui::vec2(x, y)
}

/// The text has the focus while it is pressed, and keeps it while the list at its caret, `popup`, is.
fn follow_focus(ui: &Ui, view: &EditorView<'_>, response: &Response, popup: Option<Rect>) {
    let presses_popup = ui.input(|input| {
        let is_press = input.pointer.any_pressed() || input.pointer.any_released();
        let at = input.pointer.interact_pos().filter(|_| is_press);
        at.is_some_and(|at| popup.is_some_and(|popup| popup.contains(at)))
    });
    if view.takes_focus || presses_popup || crate::is_pressed(response) {
        response.request_focus();
    }
    if response.has_focus() {
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, keyboard::EVENT_FILTER));
    }
    if response.hovered() {
        ui.set_cursor_icon(CursorIcon::Text);
    }
}

fn paint(
    ui: &Ui,
    view: &EditorView<'_>,
    language: &mut dyn LanguageService,
    geometry: &Geometry<'_>,
    response: &Response,
    shown: &ShownRows,
) {
    let clip = ui.clip_rect();
    let text_left = clip.left() + geometry.gutter_width;
    let text_clip = Rect::from_min_max(Pos2::new(text_left - 1.0, clip.top()), clip.max);
    let painter = ui.painter().with_clip_rect(text_clip);
    let painting = Painting { view, geometry, shown, painter: &painter, right: clip.right() };
    painting.current_line(clip.left());
    painting.headings();
    painting.marks();
    painting.matches_of_find();
    painting.selected_text(response.has_focus());
    painting.brackets();
    for row in shown.each() {
        let layout = &row.layout;
        let text_top = geometry.top_of(row.row) + (geometry.row_height - layout.galley().size().y) / 2.0;
        let at = Pos2::new(geometry.origin.x + layout.left(), text_top);
        painter.galley(at, layout.galley().clone(), view.tokens.text);
        if layout.is_last() && geometry.folded.is_folded_at(row.line) {
            painting.folded(row);
        }
    }
    painting.diagnostics();
    caret::paint(ui, view, geometry, shown, &painter, response);
    gutter::paint(ui, view, language, geometry, shown);
}

/// Tells assistive technologies what the widget is and what it holds.
fn describe(ui: &Ui, view: &EditorView<'_>, response: &Response) {
    response.widget_info(|| {
        let text = view.document.text();
        let mut info = WidgetInfo::text_edit(ui.is_enabled(), text, text, "");
        info.role = Role::MultilineTextInput;
        info.label = Some(view.name.to_owned());
        info
    });
    ui.ctx().accesskit_node_builder(response.id, |builder| {
        builder.set_role(egui::accesskit::Role::MultilineTextInput);
        builder.set_label(view.name);
        builder.add_action(egui::accesskit::Action::SetValue);
        builder.add_action(egui::accesskit::Action::ReplaceSelectedText);
    });
}
