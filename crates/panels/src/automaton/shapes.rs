//! Paints an automaton: nested composites, locations with their marking, transitions with their guards.
//!
//! What is marked has a dot and a heavier border besides its colour. Non-entailment is a bar over what is not entailed.

use egui::{Align2, Color32, FontId, Pos2, Rect, Shape, Stroke, StrokeKind, pos2, vec2};
use hca::{CompositeKind, LocationKind};
use layout::look::arrow_head;
use layout::{AutomatonDrawing, AutomatonItem, Piece, Point, TextRole};
use theme::{Tokens, size};

use super::Shown;
use crate::network::view::View;

/// Below this size in points a text is left out.
const LEAST_TEXT: f64 = 5.0;

/// Everything that painting needs.
pub(super) struct Scene<'a> {
    /// Paints inside the panel only.
    pub(super) painter: &'a egui::Painter,
    /// The panel.
    pub(super) panel: Rect,
    /// The view.
    pub(super) view: &'a View,
    /// The colours.
    pub(super) tokens: &'a Tokens,
    /// What is shown.
    pub(super) shown: Shown<'a>,
    /// What the text stands for that is selected, or that the caret is in.
    pub(super) marked: &'a [AutomatonItem],
}

impl Scene<'_> {
    /// Paints everything.
    pub(super) fn paint(&self, drawing: &AutomatonDrawing) {
        self.composites(drawing);
        self.successions(drawing);
        self.transitions(drawing);
        self.locations(drawing);
        self.texts(drawing);
        self.legend();
    }

    fn point(&self, point: Point) -> Pos2 {
        self.view.screen_point(self.panel, point)
    }

    fn composites(&self, drawing: &AutomatonDrawing) {
        let tokens = self.tokens;
        let preempted = self.shown.moment.taken.as_ref().map_or(&[][..], |taken| taken.preempted.as_slice());
        for shape in &drawing.composites {
            let rect = self.view.screen_rect(self.panel, shape.rect);
            let is_active = self.shown.automaton.is_active(shape.id, &self.shown.moment.marking);
            let fill = if shape.is_watching { tokens.raised } else { Color32::TRANSPARENT };
            self.painter.rect_filled(rect, 7.0, fill);
            if self.marked.contains(&AutomatonItem::Composite(shape.id)) {
                // Faint, so that what is written inside stays legible.
                self.painter.rect_filled(rect, 7.0, self.tokens.selection.gamma_multiply(0.5));
            }
            let color = match (shape.is_watching, is_active) {
                (true, true) => tokens.decision,
                (false, true) => tokens.text_muted,
                (_, false) => tokens.line_strong,
            };
            let stroke = Stroke::new(if is_active { 1.8 } else { 1.0 }, color);
            if shape.is_watching || shape.kind == CompositeKind::Program {
                self.painter.rect_stroke(rect, 7.0, stroke, StrokeKind::Middle);
            } else {
                let corners = [rect.left_top(), rect.right_top(), rect.right_bottom(), rect.left_bottom()];
                let around = [corners[0], corners[1], corners[2], corners[3], corners[0]];
                self.painter.extend(Shape::dashed_line(&around, stroke, 5.0, 4.0));
            }
            if preempted.contains(&shape.id) {
                self.painter.rect_stroke(
                    rect.expand(2.0),
                    8.0,
                    Stroke::new(1.5, tokens.threat),
                    StrokeKind::Outside,
                );
                let font = FontId::proportional(size::SMALL);
                let corner = rect.right_top() + vec2(-6.0, 3.0);
                self.painter.text(
                    corner,
                    Align2::RIGHT_TOP,
                    "✗ preempted in the last step",
                    font,
                    tokens.threat,
                );
            }
        }
    }

    fn successions(&self, drawing: &AutomatonDrawing) {
        let color = self.tokens.text_muted;
        for &(from, to) in &drawing.successions {
            let ends = [self.point(from), self.point(to)];
            self.painter.extend(Shape::dashed_line(&ends, Stroke::new(1.3, color), 4.0, 3.0));
            self.arrow(to, from, color);
        }
    }

    fn transitions(&self, drawing: &AutomatonDrawing) {
        let fired = self.shown.moment.taken.as_ref().map_or(&[][..], |taken| taken.fired.as_slice());
        for shape in &drawing.transitions {
            let has_fired = fired.contains(&shape.id);
            let color = if has_fired { self.tokens.accent } else { self.tokens.path_unselected };
            let width = if has_fired { 2.6 } else { 1.3 };
            let points = layout::geometry::flatten(shape.start, &shape.pieces);
            let points: Vec<Pos2> = points.into_iter().map(|point| self.point(point)).collect();
            if self.marked.contains(&AutomatonItem::Transition(shape.id)) {
                self.painter.add(Shape::line(points.clone(), Stroke::new(9.0, self.tokens.selection)));
            }
            self.painter.add(Shape::line(points, Stroke::new(width, color)));
            if let Some((last, before)) = shape.pieces.split_last() {
                let start = before.last().map_or(shape.start, |piece: &Piece| piece.end());
                self.arrow(last.end(), last.before_end(start), color);
            }
        }
    }

    fn arrow(&self, tip: Point, before: Point, color: Color32) {
        let corners = arrow_head(tip, before).map(|corner| self.point(corner));
        self.painter.add(Shape::convex_polygon(corners.to_vec(), color, Stroke::NONE));
    }

    fn locations(&self, drawing: &AutomatonDrawing) {
        let tokens = self.tokens;
        for shape in &drawing.locations {
            let rect = self.view.screen_rect(self.panel, shape.rect);
            let is_marked = self.shown.moment.marking.contains(shape.id);
            let corner = if shape.kind == LocationKind::Assert { 5.0 } else { rect.height() / 2.0 };
            let color = if is_marked { tokens.tell } else { tokens.path_unselected };
            let stroke = Stroke::new(if is_marked { 2.6 } else { 1.3 }, color);
            let fill = if is_marked { tokens.soft[0] } else { tokens.node_fill };
            if self.marked.contains(&AutomatonItem::Location(shape.id)) {
                self.painter.rect_filled(rect.expand(4.0), corner + 4.0, tokens.selection);
            }
            self.painter.rect(rect, corner, fill, stroke, StrokeKind::Middle);
            let inset = (3.0 * self.view.zoom()) as f32;
            if shape.is_start && inset > 1.0 {
                let inner = rect.shrink(inset);
                self.painter.rect_stroke(
                    inner,
                    (corner - inset).max(1.0),
                    Stroke::new(0.8, color),
                    StrokeKind::Middle,
                );
            }
            let font = FontId::proportional((9.5 * self.view.zoom()).clamp(6.0, 12.0) as f32);
            let name = self.shown.automaton.location_name(shape.id);
            // A tag on the border, so that it cannot be taken for the name of what lies below.
            let galley = self.painter.layout_no_wrap(name, font, tokens.text_muted);
            let half = galley.size() / 2.0;
            let center = rect.right_bottom() - vec2(half.x + 8.0, 0.0);
            let tag = Rect::from_center_size(center, galley.size() + vec2(6.0, -1.0));
            self.painter.rect_filled(tag, 3.0, tokens.surface);
            self.painter.galley(center - half, galley, tokens.text_muted);
            if is_marked {
                let radius = (5.0 * self.view.zoom()).clamp(3.0, 8.0) as f32;
                let outline = Stroke::new(1.5, tokens.surface);
                self.painter.circle(rect.left_top() + vec2(radius, 0.0), radius, tokens.tell, outline);
            }
        }
    }

    fn texts(&self, drawing: &AutomatonDrawing) {
        let fired = self.shown.moment.taken.as_ref().map_or(&[][..], |taken| taken.fired.as_slice());
        for text in &drawing.texts {
            let size = text.role.size() * self.view.zoom();
            if size < LEAST_TEXT {
                continue;
            }
            let place = self.view.screen_rect(self.panel, text.rect);
            if matches!(text.owner, AutomatonItem::Transition(_)) && self.marked.contains(&text.owner) {
                self.painter.rect_filled(place.expand(2.0), 3.0, self.tokens.selection);
            }
            let color = match (text.role, text.owner) {
                (TextRole::Name, _) => self.tokens.text,
                (_, AutomatonItem::Composite(_)) => self.tokens.decision,
                (_, AutomatonItem::Transition(id)) if fired.contains(&id) => self.tokens.accent,
                _ => self.tokens.text_muted,
            };
            self.text(&text.text, size, place, color);
        }
    }

    /// Writes a text into its place; what stands behind `~` gets a bar over it instead.
    fn text(&self, text: &str, size: f64, place: Rect, color: Color32) {
        let (before, barred) =
            text.split_once('~').map_or((text, None), |(before, after)| (before, Some(after)));
        let whole = format!("{before}{}", barred.unwrap_or_default());
        let font = FontId::proportional(((size * 2.0).floor() / 2.0) as f32);
        let mut galley = self.painter.layout_no_wrap(whole.clone(), font.clone(), color);
        let mut used = font;
        if galley.size().x > place.width() + 1.0 {
            used = FontId::proportional(used.size * place.width() / galley.size().x);
            galley = self.painter.layout_no_wrap(whole, used.clone(), color);
        }
        let corner = place.center() - galley.size() / 2.0;
        if barred.is_some() {
            let lead = self.painter.layout_no_wrap(before.to_owned(), used, color).size().x;
            let top = corner.y + 0.5;
            let ends = [pos2(corner.x + lead, top), pos2(corner.x + galley.size().x, top)];
            self.painter.line_segment(ends, Stroke::new(1.2, color));
        }
        self.painter.galley(corner, galley, color);
    }

    /// What the signs mean, as much of it as there is room for.
    fn legend(&self) {
        let parts = [
            "● marked",
            "double border: marked at the start",
            "overbar: not known to hold",
            "dashed arrow: then",
        ];
        let font = FontId::proportional(size::SMALL);
        let color = self.tokens.text_faint;
        let mut at = self.panel.left_bottom() + vec2(8.0, -6.0);
        for part in parts {
            let galley = self.painter.layout_no_wrap(part.to_owned(), font.clone(), color);
            let size = galley.size();
            if at.x + size.x > self.panel.right() {
                break;
            }
            self.painter.galley(at - vec2(0.0, size.y), galley, color);
            at.x += size.x + 14.0;
        }
    }
}
