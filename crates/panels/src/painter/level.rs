//! Lines along the axes as one mesh: where thousands of them are in view, shapes of their own with soft edges would take
//! longer to be cut into triangles than the frame may take.

use egui::{Color32, Mesh, Painter, Pos2, Rect, Shape, Stroke, pos2, vec2};

/// Lines that are painted together.
#[derive(Default)]
pub(super) struct LevelLines(Mesh);

impl LevelLines {
    /// Adds a line if it is level or upright; returns whether it is.
    pub(super) fn add(&mut self, from: Pos2, to: Pos2, stroke: Stroke) -> bool {
        /// Less than this is not a slope that can be seen, in points.
        const LEVEL: f32 = 0.5;
        let is_level = (from.y - to.y).abs() < LEVEL;
        if !is_level && (from.x - to.x).abs() >= LEVEL {
            return false;
        }
        let (width, color) = visible(stroke);
        let (low, high) = (from.min(to), from.max(to));
        // On whole points, so that lines without soft edges are all equally strong.
        let rect = if is_level {
            let top = (low.y - width / 2.0).round();
            Rect::from_min_max(pos2(low.x, top), pos2(high.x.max(low.x + 1.0), top + width))
        } else {
            let left = (low.x - width / 2.0).round();
            Rect::from_min_max(pos2(left, low.y), pos2(left + width, high.y))
        };
        self.0.add_colored_rect(rect, color);
        true
    }

    /// Adds the outline of a rectangle.
    pub(super) fn outline(&mut self, rect: Rect, stroke: Stroke) {
        let (width, color) = visible(stroke);
        let rect = Rect::from_min_max(rect.min.round(), rect.max.round());
        let across = vec2(rect.width() + width, width);
        let down = vec2(width, (rect.height() - width).max(0.0));
        let below = vec2(0.0, width);
        for (corner, size) in [
            (rect.min, across),
            (rect.left_bottom(), across),
            (rect.min + below, down),
            (rect.right_top() + below, down),
        ] {
            self.0.add_colored_rect(Rect::from_min_size(corner, size), color);
        }
    }

    pub(super) fn paint(self, painter: &Painter) {
        if self.0.is_empty() {
            return;
        }
        painter.add(Shape::mesh(self.0));
    }
}

/// Lines thinner than a point are a point wide and as much fainter.
fn visible(stroke: Stroke) -> (f32, Color32) {
    (stroke.width.round().max(1.0), stroke.color.gamma_multiply(stroke.width.min(1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_lines_along_the_axes_are_taken() {
        let mut lines = LevelLines::default();
        let stroke = Stroke::new(1.0, Color32::WHITE);
        assert!(lines.add(pos2(0.0, 5.2), pos2(30.0, 5.4), stroke));
        assert!(lines.add(pos2(4.0, 5.0), pos2(4.0, 90.0), stroke));
        assert!(!lines.add(pos2(0.0, 0.0), pos2(30.0, 30.0), stroke));
        assert_eq!(lines.0.vertices.len(), 8);
    }

    #[test]
    fn an_outline_lies_around_its_rectangle_without_covering_it() {
        let mut lines = LevelLines::default();
        let rect = Rect::from_min_max(pos2(10.0, 10.0), pos2(50.0, 30.0));
        lines.outline(rect, Stroke::new(1.0, Color32::WHITE));
        assert_eq!(lines.0.calc_bounds(), rect.with_max_x(51.0).with_max_y(31.0));
        assert_eq!(lines.0.vertices.len(), 16);
    }
}
