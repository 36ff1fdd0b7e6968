//! The overview in a corner: all of the drawing, and the part that is seen.

use display::Point;
use egui::{Color32, Mesh, Pos2, Rect, Shape, Stroke, StrokeKind, Vec2, pos2, vec2};
use layout::BlockForm;
use theme::Tokens;

use super::data::Drawn;
use super::view::{View, scaled};

/// The largest overview, and its distance from the corner.
const SIZE: Vec2 = vec2(190.0, 120.0);
const MARGIN: f32 = 10.0;

/// The overview of one panel.
#[derive(Default)]
pub(super) struct Overview {
    /// Whether the pointer drags the part that is seen.
    pub(super) is_dragged: bool,
    corner: usize,
}

/// The corners of a panel, right and lower edges as 1; the first is the usual one.
const CORNERS: [Vec2; 4] = [vec2(1.0, 1.0), vec2(1.0, 0.0), vec2(0.0, 1.0), vec2(0.0, 0.0)];

impl Overview {
    /// Goes to another corner if it covers events or texts where it is, and would cover none there.
    pub(super) fn follow(&mut self, panel: Rect, view: &View, drawn: &Drawn) {
        let covers = |corner: usize| {
            let place = Self { is_dragged: false, corner }.place(panel, view, drawn);
            place.is_some_and(|place| covers_some(view.placement(panel).drawing_rect(place), drawn))
        };
        if covers(self.corner) {
            self.corner = (0..CORNERS.len()).find(|&corner| !covers(corner)).unwrap_or(self.corner);
        }
    }

    /// Returns where it goes, if the drawing is larger than what is seen.
    pub(super) fn place(&self, panel: Rect, view: &View, drawn: &Drawn) -> Option<Rect> {
        let bounds = drawn.drawing.bounds;
        let visible = view.visible(panel);
        let sees_all = visible.contains(bounds.min) && visible.contains(bounds.max);
        if sees_all || panel.width() < 2.0 * SIZE.x || panel.height() < 1.6 * SIZE.y || bounds.width() <= 0.0
        {
            return None;
        }
        let height =
            (f64::from(SIZE.x) * bounds.height() / bounds.width()).clamp(28.0, f64::from(SIZE.y)) as f32;
        let size = vec2(SIZE.x, height);
        let free = panel.shrink(MARGIN).size() - size;
        Some(Rect::from_min_size(panel.min + Vec2::splat(MARGIN) + free * CORNERS[self.corner], size))
    }
}

/// Returns whether there is an event, a box or a text in a part of the drawing.
fn covers_some(area: display::Rect, drawn: &Drawn) -> bool {
    let drawing = &drawn.drawing;
    let mut is_found = false;
    drawing.visit(area, 0.0, &mut |shape| {
        is_found |= match shape {
            layout::Shape::Node(_) | layout::Shape::Text(_) => true,
            layout::Shape::Block(at) => drawing.blocks[at as usize].form == BlockForm::Collapsed,
            layout::Shape::Arc(_) | layout::Shape::Connector(_) => false,
        };
    });
    is_found
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

#[cfg(test)]
mod tests {
    use display::approximate_text_width;

    use super::*;

    const PANEL: Rect = Rect::from_min_max(pos2(0.0, 0.0), pos2(700.0, 400.0));

    fn drawn(text: &str) -> Drawn {
        let (network, _) = tpn::compile(&rmpl::parse(text).program(), &tpn::Top::Scenario(None));
        let network = network.expect("it has no errors");
        let options = layout::Options::default();
        let mut drawn = Drawn::default();
        drawn.drawing = layout::network(&network, &options, &approximate_text_width);
        drawn
    }

    #[test]
    fn the_overview_leaves_free_what_is_seen_if_some_corner_is() {
        let steps = ["A(); A(); A(); A(); A()"; 8].join("; ");
        let branch = format!("{{ {steps} }}");
        let text =
            format!("primitive A()[1,5]; scenario Long = {{ {branch}, {branch}, {branch}, {branch} }}");
        let drawn = drawn(&text);
        let bounds = drawn.drawing.bounds;
        let (mut overview, mut moves, mut places) = (Overview::default(), 0, 0);
        for step in 0..=40 {
            let mut view = View::default();
            let part = f64::from(step) / 40.0;
            view.zoom_at(PANEL, PANEL.center(), 1.2);
            view.look_at(bounds.min.shifted(part * bounds.width(), part * bounds.height()));
            let before = overview.corner;
            overview.follow(PANEL, &view, &drawn);
            moves += usize::from(overview.corner != before);
            let covers = |corner: usize| {
                let place = Overview { is_dragged: false, corner }.place(PANEL, &view, &drawn);
                place.is_some_and(|place| covers_some(view.placement(PANEL).drawing_rect(place), &drawn))
            };
            places += usize::from(!covers(overview.corner));
            assert!(!covers(overview.corner) || (0..4).all(covers), "step {step}");
        }
        assert!(moves > 0 && moves < 12 && places > 20, "{moves} moves, {places} free places");
    }
}
