//! Lines: straight and curved, dashed, with arrow heads, and closed.

use display::list::{ARROW_LENGTH, tip};
use display::{Dash, Item, PathEnd, Piece, Point, arrow_head};
use egui::{Color32, Pos2, Shape, Stroke};

use super::level::LevelLines;
use super::{DisplayPainter, Lines, SMALL_ZOOM, polygon};

/// Arrow heads shorter than this are left out, in points.
const MIN_HEAD: f64 = 2.5;
/// A curve has a point for so many points of its length on the screen, at least and at most so many.
const CURVE_STEPS: (f64, u32, u32) = (6.0, 3, 24);
/// Dashes are smaller and larger with the drawing, between these.
const DASH_SCALE: (f64, f64) = (0.6, 1.5);

impl DisplayPainter<'_> {
    pub(super) fn path(
        &self,
        (start, pieces): (Point, &[Piece]),
        end: PathEnd,
        item: &Item,
        lines: Lines,
        level: &mut LevelLines,
    ) {
        let fill = item.fill.map(|fill| self.color(fill.color()));
        let dash = item.stroke.map_or(Dash::Solid, |stroke| stroke.dash);
        let stroke = item.stroke.map(|stroke| self.stroke(stroke, lines));
        if end == PathEnd::Closed {
            self.polygon(self.polyline(start, pieces), fill, stroke, dash);
            return;
        }
        let Some(stroke) = stroke else { return };
        let dash = if lines.is_crowded { Dash::Solid } else { dash };
        match (pieces, dash) {
            ([Piece::Line(end)], Dash::Solid) => {
                let ends = [start, *end].map(|point| self.placement.screen_point(point));
                let is_level = self.placement.zoom < SMALL_ZOOM && level.add(ends[0], ends[1], stroke);
                if !is_level {
                    self.painter.line_segment(ends, stroke);
                }
            }
            _ => self.line(self.polyline(start, pieces), stroke, dash),
        }
        let has_head = end == PathEnd::Head && !lines.is_crowded;
        if has_head
            && ARROW_LENGTH * self.placement.zoom >= MIN_HEAD
            && let Some((tip, before)) = tip(start, pieces)
        {
            let corners = arrow_head(tip, before).map(|corner| self.placement.screen_point(corner));
            self.painter.add(Shape::convex_polygon(corners.to_vec(), stroke.color, Stroke::NONE));
        }
    }

    /// Lines from point to point of the screen.
    pub(super) fn line(&self, points: Vec<Pos2>, stroke: Stroke, dash: Dash) {
        match dash.lengths() {
            None => {
                self.painter.add(Shape::line(points, stroke));
            }
            Some((mark, gap)) => {
                let scale = self.placement.zoom.clamp(DASH_SCALE.0, DASH_SCALE.1);
                let (mark, gap) = ((mark * scale) as f32, (gap * scale) as f32);
                self.painter.extend(Shape::dashed_line(&points, stroke, mark, gap));
            }
        }
    }

    fn polygon(&self, mut corners: Vec<Pos2>, fill: Option<Color32>, stroke: Option<Stroke>, dash: Dash) {
        if let Some(fill) = fill {
            self.painter.add(polygon::filled(&corners, fill));
        }
        let Some(stroke) = stroke else { return };
        if dash == Dash::Solid {
            self.painter.add(Shape::closed_line(corners, stroke));
        } else {
            corners.extend(corners.first().copied());
            self.line(corners, stroke, dash);
        }
    }

    /// The curve on the screen, with as many points as its size there needs.
    fn polyline(&self, start: Point, pieces: &[Piece]) -> Vec<Pos2> {
        let mut points = Vec::with_capacity(pieces.len() + 1);
        points.push(self.placement.screen_point(start));
        let mut from = start;
        for &piece in pieces {
            let steps = match piece {
                Piece::Line(_) => 1,
                Piece::Cubic(..) => {
                    let (step, fewest, most) = CURVE_STEPS;
                    ((from.distance(piece.end()) * self.placement.zoom / step) as u32).clamp(fewest, most)
                }
            };
            points.extend(
                (1..=steps).map(|step| {
                    self.placement.screen_point(piece.at(from, f64::from(step) / f64::from(steps)))
                }),
            );
            from = piece.end();
        }
        points
    }
}
