//! Which part of the drawing is seen, and how large.

use display::Point;
use egui::{Pos2, Rect, Vec2, pos2, vec2};

use crate::painter::Placement;

/// A view of the drawing: the point in the middle, and points of the screen per unit of the drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct View {
    center: Point,
    zoom: f64,
    /// Whether the view keeps showing all of the drawing as it changes; ends when the user moves the view.
    is_fitted: bool,
}

/// Between these, whatever is asked for.
const ZOOM_LIMITS: (f64, f64) = (0.002, 6.0);
/// A small drawing is not blown up further than this to fill the panel.
const LARGEST_FIT: f64 = 1.3;
/// Around a drawing that is fitted.
pub(super) const FIT_MARGIN: f32 = 4.0;

impl Default for View {
    fn default() -> Self {
        Self { center: Point::default(), zoom: 1.0, is_fitted: true }
    }
}

impl View {
    /// Points of the screen per unit of the drawing.
    pub(crate) fn zoom(&self) -> f64 {
        self.zoom
    }

    /// Returns whether all of the drawing is to stay in view.
    pub(crate) fn is_fitted(&self) -> bool {
        self.is_fitted
    }

    /// Returns where the drawing lies on the screen.
    pub(crate) fn placement(&self, panel: Rect) -> Placement {
        Placement { point: self.center, at: panel.center(), zoom: self.zoom }
    }

    /// Returns where a point of the drawing is on the screen.
    pub(crate) fn screen_point(&self, panel: Rect, point: Point) -> Pos2 {
        self.placement(panel).screen_point(point)
    }

    /// Returns where a rectangle of the drawing is on the screen.
    pub(crate) fn screen_rect(&self, panel: Rect, rect: display::Rect) -> Rect {
        self.placement(panel).screen_rect(rect)
    }

    /// Returns what point of the drawing is at a place of the screen.
    pub(crate) fn drawing_point(&self, panel: Rect, position: Pos2) -> Point {
        self.placement(panel).drawing_point(position)
    }

    /// The part of the drawing that is seen.
    pub(crate) fn visible(&self, panel: Rect) -> display::Rect {
        self.placement(panel).drawing_rect(panel)
    }

    /// Moves the drawing by a distance on the screen.
    pub(crate) fn pan(&mut self, by: Vec2) {
        if by != Vec2::ZERO {
            self.center = self.center.shifted(-f64::from(by.x) / self.zoom, -f64::from(by.y) / self.zoom);
            self.is_fitted = false;
        }
    }

    /// Makes the drawing larger by `factor`; what is at `fixed` on the screen stays there.
    pub(crate) fn zoom_at(&mut self, panel: Rect, fixed: Pos2, factor: f64) {
        let before = self.drawing_point(panel, fixed);
        self.zoom = (self.zoom * factor).clamp(ZOOM_LIMITS.0, ZOOM_LIMITS.1);
        let after = self.drawing_point(panel, fixed);
        self.center = self.center.shifted(before.x - after.x, before.y - after.y);
        self.is_fitted = false;
    }

    /// Shows the drawing at its designed size, keeping the middle.
    pub(crate) fn reset_zoom(&mut self) {
        self.zoom = 1.0;
        self.is_fitted = false;
    }

    /// Shows all of `bounds`, and keeps doing so until the user moves the view.
    pub(crate) fn fit(&mut self, panel: Rect, bounds: display::Rect) {
        self.show(panel, bounds, LARGEST_FIT);
        self.is_fitted = true;
    }

    /// Leaves free what lies over the upper part of the panel, in points: what fits below it is moved there.
    pub(crate) fn keep_below(&mut self, top: f32) {
        self.center.y -= f64::from(top) / 2.0 / self.zoom;
    }

    /// Shows all of `bounds` where that is no smaller than `least`; otherwise, at that size, what is around `part`, or the
    /// beginning of what of it does not fit. Keeps doing so until the user moves the view.
    pub(crate) fn fit_legibly(
        &mut self,
        panel: Rect,
        bounds: display::Rect,
        part: Option<display::Rect>,
        least: f64,
    ) {
        self.fit(panel, bounds);
        if self.zoom >= least {
            return;
        }
        self.zoom = least;
        let room = panel.shrink(FIT_MARGIN).size();
        let part = part.unwrap_or(bounds);
        let along = |room: f32, (first, last): (f64, f64), (part_first, part_last): (f64, f64)| {
            let half = f64::from(room) / 2.0 / least;
            if last - first <= 2.0 * half {
                return f64::midpoint(first, last);
            }
            let middle = f64::midpoint(part_first, part_last).min(part_first + half);
            middle.clamp(first + half, last - half)
        };
        self.center = Point::new(
            along(room.x, (bounds.min.x, bounds.max.x), (part.min.x, part.max.x)),
            along(room.y, (bounds.min.y, bounds.max.y), (part.min.y, part.max.y)),
        );
    }

    /// From the next frame on shows all of the drawing.
    pub(crate) fn keep_fitted(&mut self) {
        self.is_fitted = true;
    }

    /// Shows `area` as large as it goes, up to `largest`.
    pub(crate) fn show(&mut self, panel: Rect, area: display::Rect, largest: f64) {
        let room = panel.shrink(FIT_MARGIN).size().max(vec2(1.0, 1.0));
        let across = f64::from(room.x) / area.width().max(1.0);
        let down = f64::from(room.y) / area.height().max(1.0);
        self.zoom = across.min(down).min(largest).clamp(ZOOM_LIMITS.0, ZOOM_LIMITS.1);
        self.center = area.center();
        self.is_fitted = false;
    }

    /// Puts a point into the middle.
    pub(crate) fn look_at(&mut self, point: Point) {
        self.center = point;
        self.is_fitted = false;
    }
}

/// The place of the screen with these coordinates inside `outer`, for a point of `bounds`; used by the overview.
pub(crate) fn scaled(bounds: display::Rect, outer: Rect, point: Point) -> Pos2 {
    let across = ((point.x - bounds.min.x) / bounds.width().max(1.0)) as f32;
    let down = ((point.y - bounds.min.y) / bounds.height().max(1.0)) as f32;
    pos2(outer.left() + across * outer.width(), outer.top() + down * outer.height())
}

#[cfg(test)]
mod tests {
    use super::*;

    const PANEL: Rect = Rect::from_min_max(pos2(100.0, 50.0), pos2(900.0, 450.0));

    #[test]
    fn what_would_be_too_small_to_read_is_shown_around_its_part() {
        let mut view = View::default();
        let bounds = display::Rect::new(0.0, 0.0, 4000.0, 200.0);
        view.fit_legibly(PANEL, bounds, None, 0.5);
        assert!(view.is_fitted() && (view.zoom() - 0.5).abs() < 1e-9);
        // From the beginning on, the whole height in the middle.
        assert!((view.placement(PANEL).point.x - 792.0).abs() < 1e-6, "{:?}", view.placement(PANEL));
        assert!((view.placement(PANEL).point.y - 100.0).abs() < 1e-6);
        let part = display::Rect::new(3900.0, 0.0, 3950.0, 40.0);
        view.fit_legibly(PANEL, bounds, Some(part), 0.5);
        assert!((view.placement(PANEL).point.x - (4000.0 - 792.0)).abs() < 1e-6, "to the end and no further");
        view.fit_legibly(PANEL, bounds, Some(part), 0.1);
        assert!(view.zoom() < 0.5, "what can be read is shown whole");
    }

    #[test]
    fn what_is_under_the_pointer_stays_there_while_zooming() {
        let mut view = View::default();
        let pointer = pos2(333.0, 77.0);
        let before = view.drawing_point(PANEL, pointer);
        view.zoom_at(PANEL, pointer, 1.7);
        assert!(view.drawing_point(PANEL, pointer).distance(before) < 1e-9);
        assert!(!view.is_fitted());
    }

    #[test]
    fn a_fitted_drawing_lies_inside_the_panel_with_its_middle_in_the_middle() {
        let mut view = View::default();
        let bounds = display::Rect::new(-30.0, -500.0, 4000.0, 700.0);
        view.fit(PANEL, bounds);
        let shown = view.screen_rect(PANEL, bounds);
        assert!(PANEL.contains_rect(shown) && (shown.center() - PANEL.center()).length() < 0.01);
        assert!(view.is_fitted());
    }

    #[test]
    fn panning_moves_the_drawing_with_the_pointer() {
        let mut view = View::default();
        let point = Point::new(10.0, 20.0);
        let before = view.screen_point(PANEL, point);
        view.pan(vec2(31.0, -7.0));
        assert!((view.screen_point(PANEL, point) - before - vec2(31.0, -7.0)).length() < 1e-3);
    }
}
