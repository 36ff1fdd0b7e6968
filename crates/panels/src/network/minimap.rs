//! The overview in the corner: all of the drawing, and the part that is seen.

use display::Point;
use egui::{Color32, Mesh, Pos2, Rect, Shape, Stroke, StrokeKind, pos2, vec2};
use layout::BlockForm;
use theme::Tokens;

use super::data::Drawn;
use super::view::{View, scaled};

/// The largest overview, and its distance from the corner.
const SIZE: egui::Vec2 = vec2(190.0, 120.0);
const MARGIN: f32 = 10.0;

/// Where the overview goes, if the drawing is larger than what is seen.
pub(super) fn place(panel: Rect, view: &View, drawn: &Drawn) -> Option<Rect> {
    let bounds = drawn.drawing.bounds;
    let visible = view.visible(panel);
    let sees_all = visible.contains(bounds.min) && visible.contains(bounds.max);
    if sees_all || panel.width() < 2.0 * SIZE.x || panel.height() < 1.6 * SIZE.y || bounds.width() <= 0.0 {
        return None;
    }
    let height = (f64::from(SIZE.x) * bounds.height() / bounds.width()).clamp(28.0, f64::from(SIZE.y)) as f32;
    let size = vec2(SIZE.x, height);
    Some(Rect::from_min_size(panel.max - size - vec2(MARGIN, MARGIN), size))
}

/// Paints the overview.
pub(super) fn paint(
    painter: &egui::Painter,
    place: Rect,
    panel: Rect,
    view: &View,
    drawn: &Drawn,
    tokens: &Tokens,
) {
    painter.rect(
        place,
        4.0,
        tokens.raised.gamma_multiply(0.96),
        Stroke::new(1.0, tokens.line_strong),
        StrokeKind::Inside,
    );
    let bounds = drawn.drawing.bounds;
    let inner = place.shrink(4.0);
    let painter = painter.with_clip_rect(inner);
    for block in drawn.drawing.blocks.iter().filter(|block| block.depth <= 3) {
        let is_drawn = matches!(block.form, BlockForm::Activity | BlockForm::Collapsed);
        let rect =
            Rect::from_min_max(scaled(bounds, inner, block.rect.min), scaled(bounds, inner, block.rect.max));
        if is_drawn && rect.width() > 3.0 {
            painter.rect_stroke(rect, 1.0, Stroke::new(0.5, tokens.line_strong), StrokeKind::Middle);
        }
    }
    painter.add(Shape::mesh(lines(drawn, bounds, inner, tokens.text_muted)));
    let visible = view.visible(panel);
    let seen = Rect::from_min_max(scaled(bounds, inner, visible.min), scaled(bounds, inner, visible.max));
    let seen = seen.intersect(inner);
    painter.rect(
        seen,
        2.0,
        tokens.accent.gamma_multiply(0.15),
        Stroke::new(1.5, tokens.accent),
        StrokeKind::Inside,
    );
}

/// The point of the drawing that a place of the overview represents.
pub(super) fn point_at(place: Rect, drawn: &Drawn, position: Pos2) -> Point {
    let (bounds, inner) = (drawn.drawing.bounds, place.shrink(4.0));
    let part = (position - inner.min) / inner.size();
    let part = pos2(part.x.clamp(0.0, 1.0), part.y.clamp(0.0, 1.0));
    bounds.min.shifted(f64::from(part.x) * bounds.width(), f64::from(part.y) * bounds.height())
}

/// The activities as one mesh; those that fall onto the same two pixels are drawn once.
fn lines(drawn: &Drawn, bounds: display::Rect, inner: Rect, color: Color32) -> Mesh {
    let mut mesh = Mesh::default();
    let mut last = (i32::MIN, i32::MIN);
    for (from, to) in &drawn.outline {
        let (from, to) = (scaled(bounds, inner, *from), scaled(bounds, inner, *to));
        let cell = ((to.x / 1.5) as i32, (to.y / 1.5) as i32);
        if cell != last {
            let rect = Rect::from_min_max(from, pos2(to.x.max(from.x + 1.0), from.y + 1.0));
            mesh.add_colored_rect(rect, color);
            last = cell;
        }
    }
    mesh
}
