//! Causal links and orderings between bars: drawn, and pointed at.

use egui::epaint::CubicBezierShape;
use egui::{Color32, Painter, Pos2, Shape, Stroke, pos2, vec2};
use workbench::state::Selection;

use super::chart::{Link, LinkKind};
use super::paint::{Painting, ROW_HEIGHT};

/// With more links in view than this, they are drawn thin and faint, but for those of the selection.
const MANY: usize = 60;
/// With more than this, only those of the selection are drawn.
const TOO_MANY: usize = 1500;
/// How near the pointer must be.
const REACH: f32 = 5.0;

/// The links in view, as curves.
pub(super) struct Links<'a> {
    curves: Vec<(&'a Link, [Pos2; 4])>,
}

impl<'a> Links<'a> {
    /// The links of a chart that can be seen.
    pub(super) fn in_view(painting: &Painting<'a>) -> Self {
        let first = ((painting.visible.top() - painting.track.top()) / ROW_HEIGHT).floor().max(0.0) as usize;
        let last = ((painting.visible.bottom() - painting.track.top()) / ROW_HEIGHT).ceil().max(0.0) as usize;
        let mut curves = Vec::new();
        for link in &painting.chart.links {
            let (top, bottom) = (link.from.0.min(link.to.0), link.from.0.max(link.to.0));
            if bottom < first || top > last {
                continue;
            }
            let curve = curve_of(painting, link);
            let (left, right) = curve
                .iter()
                .fold((f32::MAX, f32::MIN), |(left, right), point| (left.min(point.x), right.max(point.x)));
            if right >= painting.visible.left() && left <= painting.visible.right() {
                curves.push((link, curve));
            }
        }
        Self { curves }
    }

    /// The link under the pointer.
    pub(super) fn at(&self, pointer: Pos2) -> Option<&'a Link> {
        let nearest = self.curves.iter().map(|(link, curve)| (distance(*curve, pointer), *link));
        nearest.filter(|(distance, _)| *distance <= REACH).min_by(|a, b| a.0.total_cmp(&b.0)).map(|it| it.1)
    }

    /// Draws the links.
    pub(super) fn paint(&self, painting: &Painting<'_>, painter: &Painter) {
        let state = painting.context.state;
        let is_crowded = self.curves.len() > MANY;
        for (link, curve) in &self.curves {
            let selection = link.kind.selection();
            let touches = |chosen: &Selection| {
                let owners = [link.from.1, link.to.1].map(|bar| painting.chart.bars[bar].occurrence);
                *chosen == selection
                    || owners.into_iter().flatten().any(|owner| *chosen == Selection::Occurrence(owner))
            };
            let is_chosen = touches(&state.selection) || touches(&state.hovered);
            if self.curves.len() > TOO_MANY && !is_chosen {
                continue;
            }
            let (color, dash) = match link.kind {
                LinkKind::Causal(_) => (painting.context.tokens.link, [5.0, 3.0]),
                LinkKind::Ordering(_) => (painting.context.tokens.ordering, [2.0, 3.0]),
            };
            if is_crowded && !is_chosen {
                let stroke = Stroke::new(1.0, color.gamma_multiply(0.25));
                let shape = CubicBezierShape::from_points_stroke(*curve, false, Color32::TRANSPARENT, stroke);
                painter.add(Shape::CubicBezier(shape));
            } else {
                dashed(painter, *curve, Stroke::new(if is_chosen { 2.5 } else { 1.4 }, color), dash);
            }
        }
    }
}

/// From the bar that carries or comes first to the other, sideways out and in.
fn curve_of(painting: &Painting<'_>, link: &Link) -> [Pos2; 4] {
    let [from, to] =
        [link.from, link.to].map(|(row, bar)| (painting.row(row).center().y, &painting.chart.bars[bar]));
    let (from, to) = match link.kind {
        LinkKind::Causal(_) => {
            let x = painting.x(to.1.start[0]) + 3.0;
            (pos2(x, from.0), pos2(x, to.0))
        }
        LinkKind::Ordering(_) => {
            (pos2(painting.x(from.1.end[0]), from.0), pos2(painting.x(to.1.start[0]), to.0))
        }
    };
    let bow = vec2(((to.y - from.y).abs() * 0.3).clamp(14.0, 46.0), 0.0);
    let first = if (to.x - from.x).abs() < 40.0 { from - bow } else { from + bow };
    [from, first, to - bow, to]
}

fn at([a, b, c, d]: [Pos2; 4], part: f32) -> Pos2 {
    let rest = 1.0 - part;
    let weights =
        [rest * rest * rest, 3.0 * rest * rest * part, 3.0 * rest * part * part, part * part * part];
    let sum = a.to_vec2() * weights[0]
        + b.to_vec2() * weights[1]
        + c.to_vec2() * weights[2]
        + d.to_vec2() * weights[3];
    sum.to_pos2()
}

fn distance(curve: [Pos2; 4], pointer: Pos2) -> f32 {
    let steps = 16;
    let points = (0..=steps).map(|step| at(curve, step as f32 / steps as f32)).collect::<Vec<_>>();
    let to_segment = |pair: &[Pos2]| {
        let along = pair[1] - pair[0];
        let part = (pointer - pair[0]).dot(along) / along.length_sq().max(1e-6);
        (pair[0] + along * part.clamp(0.0, 1.0)).distance(pointer)
    };
    points.windows(2).map(to_segment).fold(f32::MAX, f32::min)
}

fn dashed(painter: &Painter, curve: [Pos2; 4], stroke: Stroke, [dash, gap]: [f32; 2]) {
    let shape = CubicBezierShape::from_points_stroke(curve, false, Color32::TRANSPARENT, stroke);
    painter.extend(Shape::dashed_line(&shape.flatten(Some(0.3)), stroke, dash, gap));
    let tip = curve[3];
    let head = vec![tip, tip + vec2(-6.0, -3.5), tip + vec2(-6.0, 3.5)];
    painter.add(Shape::convex_polygon(head, stroke.color, Stroke::NONE));
}
