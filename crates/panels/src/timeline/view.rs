//! Where times are on screen: zoom and pan.

use egui::Rect;

/// The room at both ends of a range of times that is shown, in points.
const END_MARGIN: f64 = 14.0;

/// Which part of time is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TimeView {
    /// The time at the left edge, in mission units.
    pub(crate) start: f64,
    /// Points per mission unit.
    pub(crate) scale: f64,
}

impl TimeView {
    /// Shows everything up to `horizon` in `width` points, with a little room at both ends.
    pub(crate) fn fit(horizon: f64, width: f32) -> Self {
        Self::range(0.0, horizon, width)
    }

    /// Shows from `start` to `end` in `width` points, with a little room at both ends, for links that bow out.
    pub(crate) fn range(start: f64, end: f64, width: f32) -> Self {
        let width = f64::from(width.max(1.0));
        let margin = END_MARGIN.min(width / 8.0);
        let scale = (width - 2.0 * margin) / (end - start).max(1e-6);
        Self { start: start - margin / scale, scale }
    }

    /// The time at `x` in `rect`.
    pub(crate) fn time(&self, rect: Rect, x: f32) -> f64 {
        self.start + f64::from(x - rect.left()) / self.scale
    }

    /// Zooms by `factor` and keeps the time at `x` where it is.
    pub(crate) fn zoom(&mut self, rect: Rect, x: f32, factor: f64, horizon: f64) {
        let fixed = self.time(rect, x);
        let least = f64::from(rect.width()) / (horizon * 4.0).max(1e-6);
        self.scale = (self.scale * factor).clamp(least, least * 1e6);
        self.start = fixed - f64::from(x - rect.left()) / self.scale;
    }

    /// Moves by `points` to the right.
    pub(crate) fn pan(&mut self, points: f32) {
        self.start -= f64::from(points) / self.scale;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zooming_keeps_the_time_under_the_pointer() {
        let rect = Rect::from_min_size(egui::pos2(100.0, 0.0), egui::vec2(800.0, 50.0));
        let mut view = TimeView::fit(660.0, rect.width());
        let before = view.time(rect, 400.0);
        view.zoom(rect, 400.0, 3.0, 660.0);
        assert!((view.time(rect, 400.0) - before).abs() < 1e-9);
    }
}
