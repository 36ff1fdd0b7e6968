//! The lines on screen: laid out, painted, and followed by the pointer.

use std::ops::Range;

use egui::{
    Align2, CursorIcon, FontId, Pos2, Rect, Response, Role, ScrollArea, Sense, Stroke, TextStyle, Ui,
    WidgetInfo,
};
use mission::Problem;
use rmpl::{Severity, Span};
use theme::icon::{self, Icon};
use theme::{Tokens, space};
use workbench::command::{Command, CommandSender, EditorCommand};
use workbench::state::TextCommand;
use workbench::state::document::Document;
use workbench::state::folding::{self, Rows};
use workbench::state::language::SyntaxRole;
use workbench::{PanelEffect, PanelKind};

use crate::Context;
use crate::editor::hover::HoverCache;
use crate::editor::line::LineLayout;
use crate::editor::marks::Shift;
use crate::editor::{brackets, editor_id, keyboard, popup};
use crate::problems::severity_sign;

/// The text with its gutter.
#[derive(Default)]
pub(crate) struct TextArea {
    /// How many times the last press was repeated: 1 drags by character, 2 by word, 3 by line.
    presses: u32,
    /// Where a drag began.
    drag_anchor: Range<usize>,
    /// The width of the widest line, for the revision it was measured at.
    widest: (u64, usize),
    hover: HoverCache,
    /// The lines at which something can be folded, for the revision they were found at.
    foldable: (u64, Vec<usize>),
    /// How far the view is scrolled.
    offset: egui::Vec2,
    /// How the text of the last answer became the present one.
    shift: (u64, u64, Option<Shift>),
}

/// Sizes and places that hold for one frame.
struct Geometry<'a> {
    font: FontId,
    row_height: f32,
    character_width: f32,
    gutter_width: f32,
    /// The top left corner of the first line's text.
    origin: Pos2,
    /// Which line stands in which row.
    rows: &'a Rows,
}

/// The lines on screen, laid out, in order; what is folded is left out.
struct ShownLines {
    lines: Vec<usize>,
    layouts: Vec<LineLayout>,
}

impl ShownLines {
    fn each(&self) -> impl Iterator<Item = (usize, &LineLayout)> {
        self.lines.iter().copied().zip(&self.layouts)
    }

    fn layout_of(&self, line: usize) -> Option<&LineLayout> {
        self.layouts.get(self.lines.binary_search(&line).ok()?)
    }

    /// From the first line to the last, those between that are folded included.
    fn bytes(&self, document: &Document) -> Range<usize> {
        match (self.lines.first(), self.lines.last()) {
            (Some(&first), Some(&last)) => document.line_range(first).start..document.line_range(last).end,
            _ => 0..0,
        }
    }
}

impl Geometry<'_> {
    fn top_of(&self, line: usize) -> f32 {
        self.origin.y + self.rows.row_of(line) as f32 * self.row_height
    }

    /// The line at a height, whether there is text or not.
    fn line_at(&self, y: f32) -> Option<usize> {
        let row = ((y - self.origin.y) / self.row_height).floor();
        (row >= 0.0).then(|| self.rows.line_of(row as usize))
    }

    fn row(&self, line: usize, x: Range<f32>) -> Rect {
        let top = self.top_of(line);
        Rect::from_min_max(Pos2::new(x.start, top), Pos2::new(x.end, top + self.row_height))
    }
}

impl TextArea {
    /// Shows the text in what is left of `ui`.
    pub(crate) fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let document = &context.state.document;
        let font = TextStyle::Monospace.resolve(ui.style());
        let (text_height, character_width) =
            ui.fonts_mut(|fonts| (fonts.row_height(&font), fonts.glyph_width(&font, '0')));
        let row_height = (text_height * 1.18).round();
        let digits = document.line_count().to_string().len().max(3);
        let gutter_width = (digits as f32 + 3.0) * character_width;
        let rows = context.state.editor.folding.rows();
        let num_rows = rows.count(document.line_count());
        let lines_height = num_rows as f32 * row_height;
        let widest = self.widest_line(context) as f32 * character_width;
        let available = ui.available_size();
        let size = egui::vec2(
            (gutter_width + widest + 60.0).max(available.x),
            (lines_height + available.y * 0.5).max(available.y),
        );

        let mut area = ScrollArea::both().id_salt("mission text").auto_shrink(false);
        let geometry_of = |origin: Pos2| Geometry {
            font: font.clone(),
            row_height,
            character_width,
            gutter_width,
            origin: origin + egui::vec2(gutter_width, 0.0),
            rows,
        };
        let reveal = context.take_last(|effect| match effect {
            PanelEffect::Reveal(reveal) => Some(reveal),
            _ => None,
        });
        if let Some(reveal) = reveal {
            area = self.scroll_to(context, area, reveal, &geometry_of(Pos2::ZERO), available);
        }
        let shown = area.show_viewport(ui, |ui, viewport| {
            let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
            let geometry = geometry_of(rect.min);
            let first = (viewport.top() / row_height).floor().max(0.0) as usize;
            let last = ((viewport.bottom() / row_height).ceil().max(0.0) as usize).min(num_rows);
            let lines = (first.min(last)..last).map(|row| rows.line_of(row)).collect();
            let response = ui.interact(ui.clip_rect().intersect(rect), editor_id(), Sense::click_and_drag());
            Self::follow_focus(ui, context, &response);
            let shown = lay_out(ui, context, &geometry, lines);
            self.follow_pointer(ui, context, &geometry, &response, &shown, commands);
            self.paint(ui, context, &geometry, &response, &shown);
            describe(ui, context, &response);
            let offset = Self::offset_under_pointer(context, &geometry, &response, &shown);
            let problems = shifted_problems(context, self.shift(context));
            self.hover.show(context, &response, offset, &problems);
            if let Some(caret) = caret_rect(context, &geometry, &shown).filter(|_| response.has_focus()) {
                let to_global = ui.ctx().layer_transform_to_global(ui.layer_id()).unwrap_or_default();
                popup::show(ui, context, to_global * caret, commands);
                popup::show_signature(ui, context, to_global * caret);
            }
        });
        self.offset = shown.state.clamped_offset();
    }

    /// Moves the view so that a place can be seen, once.
    fn scroll_to(
        &self,
        context: &Context<'_>,
        area: ScrollArea,
        reveal: workbench::state::editor::Reveal,
        geometry: &Geometry<'_>,
        available: egui::Vec2,
    ) -> ScrollArea {
        let document = &context.state.document;
        let head = document.boundary_before(reveal.span.start as usize);
        let top = geometry.top_of(document.line_at(head));
        let margin = geometry.row_height * 2.0;
        let offset = self.offset;
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
        let left = document.column_at(head) as f32 * geometry.character_width;
        let room = available.x - geometry.gutter_width - 4.0 * geometry.character_width;
        let x = if left < offset.x {
            (left - 8.0 * geometry.character_width).max(0.0)
        } else if left > offset.x + room {
            left - room
        } else {
            offset.x
        };
        area.scroll_offset(egui::vec2(x, y))
    }

    /// The characters of the longest line.
    fn widest_line(&mut self, context: &Context<'_>) -> usize {
        let document = &context.state.document;
        if self.widest.0 != document.revision() {
            let widths = (0..document.line_count()).map(|line| document.line_range(line).len());
            self.widest = (document.revision(), widths.max().unwrap_or_default());
        }
        self.widest.1
    }

    fn follow_focus(ui: &Ui, context: &Context<'_>, response: &Response) {
        let is_given = context.take_last(|effect| {
            (effect == PanelEffect::FocusEditor && context.state.dialog.is_none()).then_some(())
        });
        if is_given.is_some() || crate::is_pressed(response) {
            response.request_focus();
        }
        if response.has_focus() {
            ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, keyboard::EVENT_FILTER));
        }
        if response.hovered() {
            ui.set_cursor_icon(CursorIcon::Text);
        }
    }

    fn offset_under_pointer(
        context: &Context<'_>,
        geometry: &Geometry<'_>,
        response: &Response,
        shown: &ShownLines,
    ) -> Option<usize> {
        let pointer = response.hover_pos()?;
        let layout = shown.layout_of(geometry.line_at(pointer.y)?)?;
        let x = pointer.x - geometry.origin.x;
        (x >= 0.0 && x <= layout.galley().size().x).then(|| layout.offset_at(context, x))
    }

    fn follow_pointer(
        &mut self,
        ui: &Ui,
        context: &Context<'_>,
        geometry: &Geometry<'_>,
        response: &Response,
        shown: &ShownLines,
        commands: &mut CommandSender,
    ) {
        let Some(pointer) = response.interact_pointer_pos() else { return };
        let document = &context.state.document;
        let line = geometry.line_at(pointer.y).unwrap_or_default().min(document.line_count() - 1);
        let x = pointer.x - geometry.origin.x;
        let primary_pressed =
            ui.input(|input| input.pointer.primary_pressed()) && crate::is_pressed(response);
        if x < 0.0 && primary_pressed && pointer.x >= fold_signs(geometry, ui.clip_rect()).min {
            let is_foldable = context.state.language.parse().is_some_and(|parse| {
                folding::regions(document, parse).iter().any(|region| region.first_line == line)
            });
            if is_foldable {
                commands.send(Command::Editor(EditorCommand::ToggleFold(line)));
                return;
            }
        }
        let offset = match shown.layout_of(line) {
            Some(layout) => layout.offset_at(context, x),
            None => document.offset_at(line, (x / geometry.character_width).max(0.0) as usize),
        };
        if primary_pressed {
            self.presses = ui.input(|input| {
                if input.pointer.button_triple_clicked(egui::PointerButton::Primary) {
                    3
                } else if input.pointer.button_double_clicked(egui::PointerButton::Primary) {
                    2
                } else {
                    1
                }
            });
            let extends = ui.input(|input| input.modifiers.shift);
            let anchor = if extends { document.caret().anchor } else { offset };
            self.drag_anchor = anchor..anchor;
            commands.send(Command::Text(TextCommand::Select { anchor, head: offset }));
        } else if response.double_clicked() {
            commands.send(Command::Text(TextCommand::SelectWord(offset)));
        } else if response.triple_clicked() {
            commands.send(Command::Text(TextCommand::SelectLine(offset)));
        } else if response.dragged_by(egui::PointerButton::Primary) && offset != document.caret().head {
            let anchor = self.drag_anchor.start;
            commands.send(Command::Text(TextCommand::Select { anchor, head: offset }));
        }
        if crate::is_pressed(response) {
            commands.send(Command::Activate(PanelKind::Editor));
        }
    }

    fn paint(
        &mut self,
        ui: &Ui,
        context: &Context<'_>,
        geometry: &Geometry<'_>,
        response: &Response,
        shown: &ShownLines,
    ) {
        let clip = ui.clip_rect();
        let text_left = clip.left() + geometry.gutter_width;
        let text_clip = Rect::from_min_max(Pos2::new(text_left - 1.0, clip.top()), clip.max);
        let painter = ui.painter().with_clip_rect(text_clip);
        let marks = Painting { context, geometry, shown, painter: &painter, right: clip.right() };
        marks.current_line(clip.left());
        marks.step(self.shift(context));
        marks.selected_thing(self.shift(context));
        marks.matches_of_find();
        marks.selected_text(response.has_focus());
        marks.brackets();
        for (line, layout) in shown.each() {
            let text_top = geometry.top_of(line) + (geometry.row_height - layout.galley().size().y) / 2.0;
            let at = Pos2::new(geometry.origin.x, text_top);
            painter.galley(at, layout.galley().clone(), context.tokens.text);
            if geometry.rows.is_folded_at(line) {
                marks.folded(line, layout);
            }
        }
        marks.problems(self.shift(context));
        marks.caret(ui, response);
        let foldable = self.foldable_lines(ui, context, geometry);
        paint_gutter(ui, context, geometry, shown, self.shift(context), &foldable);
    }

    /// The lines at which something can be folded; looked for only while the pointer is in the gutter.
    fn foldable_lines(&mut self, ui: &Ui, context: &Context<'_>, geometry: &Geometry<'_>) -> Vec<usize> {
        let clip = ui.clip_rect();
        let gutter =
            Rect::from_min_max(clip.min, Pos2::new(clip.left() + geometry.gutter_width, clip.bottom()));
        let pointer = ui.input(|input| input.pointer.hover_pos());
        let Some(parse) =
            context.state.language.parse().filter(|_| pointer.is_some_and(|it| gutter.contains(it)))
        else {
            return Vec::new();
        };
        let revision = context.state.document.revision();
        if self.foldable.0 != revision {
            let regions = folding::regions(&context.state.document, parse);
            self.foldable = (revision, regions.iter().map(|region| region.first_line).collect());
        }
        self.foldable.1.clone()
    }

    /// How the text of the last answer became the present one.
    fn shift(&mut self, context: &Context<'_>) -> Shift {
        let Some(latest) = context.state.snapshots.latest() else { return Shift::NONE };
        let revisions = (latest.revision, context.state.document.revision());
        if (self.shift.0, self.shift.1) != revisions || self.shift.2.is_none() {
            let shift = if revisions.0 == revisions.1 {
                Shift::NONE
            } else {
                Shift::between(&latest.source, context.state.document.text())
            };
            self.shift = (revisions.0, revisions.1, Some(shift));
        }
        self.shift.2.unwrap_or(Shift::NONE)
    }
}

fn lay_out(ui: &Ui, context: &Context<'_>, geometry: &Geometry<'_>, lines: Vec<usize>) -> ShownLines {
    let document = &context.state.document;
    let mut shown = ShownLines { lines, layouts: Vec::new() };
    let Range { start, end } = shown.bytes(document);
    let roles = context.state.language.roles(Span::new(start as u32, end as u32));
    let colors: Vec<_> =
        roles.into_iter().map(|(span, role)| (span, syntax_color(role, context.tokens))).collect();
    let layouts = shown
        .lines
        .iter()
        .map(|&line| LineLayout::new(ui, context, &geometry.font, document.line_range(line), &colors));
    shown.layouts = layouts.collect();
    shown
}

const fn syntax_color(role: SyntaxRole, tokens: &Tokens) -> egui::Color32 {
    let syntax = &tokens.syntax;
    match role {
        SyntaxRole::Keyword => syntax.keyword,
        SyntaxRole::Activity => syntax.activity,
        SyntaxRole::Variable => syntax.variable,
        SyntaxRole::Value => syntax.value,
        SyntaxRole::Parameter => syntax.parameter,
        SyntaxRole::Place => syntax.place,
        SyntaxRole::Number => syntax.number,
        SyntaxRole::String => syntax.string,
        SyntaxRole::Comment => syntax.comment,
        SyntaxRole::Punctuation => syntax.punctuation,
        SyntaxRole::Unknown => tokens.error,
    }
}

/// The column of the gutter in which folds are opened and closed.
fn fold_signs(geometry: &Geometry<'_>, clip: Rect) -> egui::Rangef {
    let right = clip.left() + geometry.gutter_width;
    egui::Rangef::new(right - 1.5 * geometry.character_width, right)
}

/// What is painted onto the lines of one frame.
struct Painting<'a> {
    context: &'a Context<'a>,
    geometry: &'a Geometry<'a>,
    shown: &'a ShownLines,
    painter: &'a egui::Painter,
    right: f32,
}

impl Painting<'_> {
    /// The rectangles that a span covers on screen, one per line; a line break counts as one character.
    fn rects(&self, span: Range<usize>) -> Vec<Rect> {
        let document = &self.context.state.document;
        let mut rects = Vec::new();
        for (line, layout) in self.shown.each() {
            let bytes = document.line_range(line);
            if span.end < bytes.start || span.start > bytes.end {
                continue;
            }
            let left = layout.x_of(self.context, span.start.max(bytes.start));
            let mut right = layout.x_of(self.context, span.end.min(bytes.end));
            if span.end > bytes.end {
                right += self.geometry.character_width;
            }
            if right > left {
                let x = self.geometry.origin.x;
                rects.push(self.geometry.row(line, x + left..x + right));
            }
        }
        rects
    }

    fn current_line(&self, left: f32) {
        let document = &self.context.state.document;
        if document.caret().is_empty() {
            let line = document.line_at(document.caret().head);
            let row = self.geometry.row(line, left..self.right);
            self.painter.rect_filled(row, 0.0, self.context.tokens.raised);
        }
    }

    /// A sign behind a line whose rest is folded away.
    fn folded(&self, line: usize, layout: &LineLayout) {
        let left = self.geometry.origin.x + layout.galley().size().x + self.geometry.character_width * 0.6;
        let width = self.geometry.character_width * 2.6;
        let plate = self.geometry.row(line, left..left + width).shrink2(egui::vec2(0.0, 3.0));
        self.painter.rect_filled(plate, 3.0, self.context.tokens.pressed);
        let color = self.context.tokens.text_faint;
        self.painter.text(plate.center(), Align2::CENTER_CENTER, "…", self.geometry.font.clone(), color);
    }

    /// A quiet bar behind what is selected in the other panels.
    fn selected_thing(&self, shift: Shift) {
        let Some(snapshot) = self.context.snapshot.filter(|_| !self.context.is_stale) else { return };
        let span = self.context.state.selection.span(snapshot).and_then(|span| shift.span(span));
        for rect in span.map(|span| self.rects(span.range())).unwrap_or_default() {
            self.painter.rect_filled(rect, 3.0, self.context.tokens.accent_soft);
        }
    }

    /// A frame around what the step of the search that is looked at is about.
    fn step(&self, shift: Shift) {
        let Some(focus) = self.context.focus().filter(|_| !self.context.is_stale) else { return };
        let tokens = self.context.tokens;
        let color = if focus.is_failure { tokens.failure } else { tokens.decision };
        for span in focus.spans.iter().filter_map(|&span| shift.span(span)) {
            for rect in self.rects(span.range()) {
                self.painter.rect_filled(rect, 3.0, color.gamma_multiply(0.16));
                let line = rect.bottom() - 1.0;
                self.painter.hline(rect.x_range(), line, Stroke::new(2.0, color.gamma_multiply(0.8)));
            }
        }
    }

    fn matches_of_find(&self) {
        let Some(find) = &self.context.state.editor.find else { return };
        let Ok(pattern) = find.pattern() else { return };
        let document = &self.context.state.document;
        let Range { start, end } = self.shown.bytes(document);
        let visible = document.text().get(start..end).unwrap_or_default();
        let stroke = Stroke::new(1.0, self.context.tokens.warning);
        for found in pattern.matches(visible) {
            for rect in self.rects(start + found.start..start + found.end) {
                self.painter.rect_filled(rect, 2.0, self.context.tokens.soft[1]);
                self.painter.rect_stroke(rect, 2.0, stroke, egui::StrokeKind::Inside);
            }
        }
    }

    fn selected_text(&self, has_focus: bool) {
        let range = self.context.state.document.caret().range();
        let tokens = self.context.tokens;
        let color = if has_focus { tokens.selection } else { tokens.pressed };
        if !range.is_empty() {
            for rect in self.rects(range) {
                self.painter.rect_filled(rect, 2.0, color);
            }
        }
    }

    fn brackets(&self) {
        let document = &self.context.state.document;
        let Some((one, other)) = brackets::matching(document.text(), document.caret().head) else { return };
        let stroke = Stroke::new(1.0, self.context.tokens.line_strong);
        for at in [one, other] {
            for rect in self.rects(at..at + 1) {
                self.painter.rect(rect, 2.0, self.context.tokens.pressed, stroke, egui::StrokeKind::Inside);
            }
        }
    }

    /// Wavy lines under what is wrong.
    fn problems(&self, shift: Shift) {
        for (problem, span) in shifted_problems(self.context, shift) {
            let (_, color) = severity_sign(self.context.tokens, problem.severity);
            let mut range = span.range();
            // A problem at a single point still needs something to see.
            range.end = range.end.max(range.start + 1);
            let range = range.start..range.end.min(self.context.state.document.text().len().max(range.start));
            let mut rects = self.rects(range);
            if rects.is_empty() {
                rects.extend(self.rects(span.range().start.saturating_sub(1)..span.range().start));
            }
            for rect in rects {
                self.wave(rect, color);
            }
        }
    }

    fn wave(&self, rect: Rect, color: egui::Color32) {
        let (step, height) = (2.5, 1.6);
        let middle = rect.bottom() - 2.5;
        let count = ((rect.width() / step).ceil() as usize).clamp(2, 400);
        let points = (0..=count).map(|index| {
            let up = if index % 2 == 0 { -height } else { height };
            Pos2::new((rect.left() + index as f32 * step).min(rect.right()), middle + up / 2.0)
        });
        self.painter.line(points.collect(), Stroke::new(1.2, color));
    }

    fn caret(&self, ui: &Ui, response: &Response) {
        let Some(row) = caret_rect(self.context, self.geometry, self.shown) else { return };
        let row = row.shrink2(egui::vec2(0.0, 1.5));
        if !response.has_focus() {
            return;
        }
        let since = self.context.now_secs - self.context.state.editor.active_secs;
        let is_window_focused = ui.input(|input| input.focused);
        let is_on = !is_window_focused || since.rem_euclid(1.1) < 0.65 || since > 30.0;
        if is_on {
            self.painter.vline(row.left(), row.y_range(), Stroke::new(1.5, self.context.tokens.accent));
        }
        if is_window_focused && since <= 30.0 {
            let phase = since.rem_euclid(1.1);
            let next = if phase < 0.65 { 0.65 - phase } else { 1.1 - phase };
            ui.ctx().request_repaint_after_secs(next as f32 + 0.01);
        }
        let to_global = ui.ctx().layer_transform_to_global(ui.layer_id()).unwrap_or_default();
        ui.output_mut(|output| {
            output.mutable_text_under_cursor |= response.hovered();
            output.ime = Some(egui::output::IMEOutput {
                purpose: egui::IMEPurpose::Normal,
                rect: to_global * response.rect,
                cursor_rect: to_global * row,
                should_interrupt_composition: false,
            });
        });
    }
}

/// Where the caret is on screen, if its line is visible.
fn caret_rect(context: &Context<'_>, geometry: &Geometry<'_>, shown: &ShownLines) -> Option<Rect> {
    let head = context.state.document.caret().head;
    let line = context.state.document.line_at(head);
    let layout = shown.layout_of(line)?;
    let x = geometry.origin.x + layout.x_of(context, head);
    Some(geometry.row(line, x..x + 1.0))
}

/// The problems of the last answer, at their places in the present text.
fn shifted_problems<'a>(context: &Context<'a>, shift: Shift) -> Vec<(&'a Problem, Span)> {
    let latest = context.state.snapshots.latest();
    let problems = latest.map(|latest| &*latest.problems).unwrap_or_default();
    problems.iter().filter_map(|problem| Some((problem, shift.span(problem.span)?))).collect()
}

fn paint_gutter(
    ui: &Ui,
    context: &Context<'_>,
    geometry: &Geometry<'_>,
    shown: &ShownLines,
    shift: Shift,
    foldable: &[usize],
) {
    let tokens = context.tokens;
    let document = &context.state.document;
    let clip = ui.clip_rect();
    let left = clip.left();
    let gutter = Rect::from_min_max(clip.min, Pos2::new(left + geometry.gutter_width - 1.0, clip.bottom()));
    let painter = ui.painter().with_clip_rect(gutter);
    painter.rect_filled(gutter, 0.0, tokens.surface);
    let current = document.line_at(document.caret().head);
    let mut worst = std::collections::BTreeMap::<usize, Severity>::new();
    for (problem, span) in shifted_problems(context, shift) {
        let line = document.line_at(span.start as usize);
        let entry = worst.entry(line).or_insert(problem.severity);
        *entry = (*entry).min(problem.severity);
    }
    let signs = fold_signs(geometry, clip);
    for &line in &shown.lines {
        let row = geometry.row(line, left..signs.min);
        let color = if line == current { tokens.text } else { tokens.text_faint };
        let number = (line + 1).to_string();
        painter.text(row.right_center(), Align2::RIGHT_CENTER, number, geometry.font.clone(), color);
        let is_folded = geometry.rows.is_folded_at(line);
        if is_folded || foldable.binary_search(&line).is_ok() {
            let sign = if is_folded { Icon::ChevronRight } else { Icon::ChevronDown };
            let at = Pos2::new(signs.center(), row.center().y);
            icon::paint(
                &painter,
                sign,
                Rect::from_center_size(at, egui::Vec2::ZERO),
                10.0,
                tokens.text_faint,
            );
        }
        if let Some(&severity) = worst.get(&line) {
            let (sign, color) = severity_sign(tokens, severity);
            let at = Pos2::new(left + space::M + 2.0, row.center().y);
            icon::paint(&painter, sign, Rect::from_center_size(at, egui::Vec2::ZERO), 12.0, color);
        }
    }
}

/// Tells assistive technologies what the widget is and what it holds.
fn describe(ui: &Ui, context: &Context<'_>, response: &Response) {
    let document = &context.state.document;
    response.widget_info(|| {
        let text = document.text();
        let mut info = WidgetInfo::text_edit(ui.is_enabled(), text, text, "");
        info.role = Role::MultilineTextInput;
        info.label = Some("Mission text".to_owned());
        info
    });
    ui.ctx().accesskit_node_builder(response.id, |builder| {
        builder.set_role(egui::accesskit::Role::MultilineTextInput);
        builder.set_label("Mission text");
        builder.add_action(egui::accesskit::Action::SetValue);
        builder.add_action(egui::accesskit::Action::ReplaceSelectedText);
    });
}
