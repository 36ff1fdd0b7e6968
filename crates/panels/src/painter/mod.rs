//! Draws display lists on the screen: what is in view, and as much detail as can be seen at its zoom.
//!
//! This is the only place that turns them into egui's shapes. What a drawing shows is decided where its list is built.

mod curve;
mod hatch;
mod level;
mod polygon;
#[cfg(test)]
mod tests;
mod text;

use display::{Color, DisplayList, Fill, Ground, Group, Item, Point, Shape, Stroke};
use egui::{Color32, CornerRadius, Mesh, Pos2, Rect, StrokeKind, vec2};
use theme::Tokens;

use self::level::LevelLines;

/// Where a drawing lies on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// A point of the drawing.
    pub point: Point,
    /// Where that is on the screen.
    pub at: Pos2,
    /// Points of the screen per unit of the drawing.
    pub zoom: f64,
}

/// Draws display lists inside an area of the screen.
pub struct DisplayPainter<'a> {
    painter: egui::Painter,
    area: Rect,
    placement: Placement,
    tokens: &'a Tokens,
    /// What is seen of the drawing.
    visible: display::Rect,
}

/// Shapes smaller than this on the screen are left out, in points.
const MIN_SHAPE: f64 = 1.5;
/// Below this zoom, lines along the axes have no soft edges: there are too many.
const SMALL_ZOOM: f64 = 0.42;
/// Below this zoom, single lines of a crowd are left out, and outlines have no soft edges.
const OVERVIEW_ZOOM: f64 = 0.06;
/// Below this zoom dense lines begin to fade, and how far they do.
const DENSE: (f64, f64) = (0.15, 0.35);
/// How strong and how broad the lines of a crowd are.
const CROWD: (f32, f32) = (0.22, 1.0);
/// Outlines less high than this on the screen fade, in points.
const FADING_HEIGHT: f32 = 8.0;
/// Outlines fainter than this are left out.
const MIN_STRENGTH: f32 = 0.04;
/// Circles smaller than this on the screen are dots.
const DOT_RADIUS: f32 = 2.0;

impl Placement {
    /// That of a drawing whose frame is the screen.
    pub const SCREEN: Self = Self { point: Point::new(0.0, 0.0), at: Pos2::ZERO, zoom: 1.0 };

    /// Returns where a point of the drawing is on the screen.
    pub fn screen_point(&self, point: Point) -> Pos2 {
        let offset = ((point.x - self.point.x) * self.zoom, (point.y - self.point.y) * self.zoom);
        self.at + vec2(offset.0 as f32, offset.1 as f32)
    }

    /// Returns where a rectangle of the drawing is on the screen.
    pub fn screen_rect(&self, rect: display::Rect) -> Rect {
        Rect::from_min_max(self.screen_point(rect.min), self.screen_point(rect.max))
    }

    /// Returns what point of the drawing is at a place of the screen.
    pub fn drawing_point(&self, position: Pos2) -> Point {
        let offset = position - self.at;
        self.point.shifted(f64::from(offset.x) / self.zoom, f64::from(offset.y) / self.zoom)
    }

    /// Returns what part of the drawing is in a part of the screen.
    pub fn drawing_rect(&self, area: Rect) -> display::Rect {
        display::Rect { min: self.drawing_point(area.min), max: self.drawing_point(area.max) }
    }
}

/// Which items of a list are in view, a bit for each.
struct InView(Vec<u64>);

impl InView {
    fn of(list: &DisplayList, visible: display::Rect, min_size: f64) -> Self {
        let mut words = vec![0_u64; list.items().len().div_ceil(64)];
        list.visit(visible, min_size, &mut |at| words[at as usize / 64] |= 1 << (at % 64));
        Self(words)
    }

    /// Those among `range`, in order.
    fn among(&self, range: std::ops::Range<usize>) -> impl Iterator<Item = usize> {
        let words = range.start / 64..range.end.div_ceil(64);
        let all = words.flat_map(|word| {
            let mut left = self.0[word];
            std::iter::from_fn(move || {
                let bit = left.trailing_zeros() as usize;
                let found = (left != 0).then_some(word * 64 + bit);
                left &= left.wrapping_sub(1);
                found
            })
        });
        all.filter(move |at| range.contains(at))
    }
}

/// How the lines of a group are drawn.
#[derive(Clone, Copy)]
struct Lines {
    min_width: f32,
    strength: f32,
    is_crowded: bool,
}

impl<'a> DisplayPainter<'a> {
    /// Draws inside `area` only.
    pub fn new(painter: &egui::Painter, area: Rect, placement: Placement, tokens: &'a Tokens) -> Self {
        let visible = placement.drawing_rect(area.intersect(painter.clip_rect()));
        Self {
            painter: painter.with_clip_rect(area.intersect(painter.clip_rect())),
            area,
            placement,
            tokens,
            visible,
        }
    }

    /// The part of the drawing that is seen.
    pub fn visible(&self) -> display::Rect {
        self.visible
    }

    /// Returns what is too small to be drawn, in drawing units.
    pub fn min_size(&self) -> f64 {
        MIN_SHAPE / self.placement.zoom
    }

    /// Draws lists over each other, by their layers. Names that look for room of their own leave `taken` free.
    pub fn paint(&self, lists: &[&DisplayList], taken: Vec<Rect>) {
        let in_view: Vec<InView> =
            lists.iter().map(|list| InView::of(list, self.visible, self.min_size())).collect();
        let all = lists.iter().zip(&in_view);
        let mut groups: Vec<_> = all
            .flat_map(|(list, in_view)| {
                list.groups().map(move |(group, range)| (*list, in_view, group, range))
            })
            .collect();
        groups.sort_by_key(|(_, _, group, _)| group.layer);
        let mut taken = taken;
        for (list, in_view, group, range) in groups {
            self.group(list, group, in_view.among(range), &mut taken);
        }
    }

    fn group(
        &self,
        list: &DisplayList,
        group: &Group,
        in_view: impl Iterator<Item = usize>,
        taken: &mut Vec<Rect>,
    ) {
        let clip = group.clip.map(|clip| self.placement.screen_rect(clip));
        let clipped = clip.map(|clip| self.clipped(clip));
        let painter = clipped.as_ref().unwrap_or(self);
        let zoom = self.placement.zoom;
        let items: Vec<&Item> =
            in_view.map(|at| &list.items()[at]).filter(|item| item.detail.holds(zoom)).collect();
        let is_crowded = group.crowd.is_some_and(|most| items.len() > most as usize);
        if is_crowded && zoom < OVERVIEW_ZOOM {
            return;
        }
        let strength = if group.is_dense { (zoom / DENSE.0).clamp(DENSE.1, 1.0) as f32 } else { 1.0 };
        let lines = Lines { min_width: group.min_size, strength, is_crowded };
        let mut level = LevelLines::default();
        let mut hatching = Mesh::default();
        for item in items {
            // A hatching lies under what is drawn after it.
            if !hatching.is_empty() && !matches!(item.fill, Some(Fill::Hatched(_))) {
                painter.painter.add(egui::Shape::mesh(std::mem::take(&mut hatching)));
            }
            match item.shape {
                Shape::Path { start, pieces, end } => {
                    painter.path((start, list.pieces(pieces)), end, item, lines, &mut level);
                }
                Shape::Rectangle { rect, corner } => {
                    painter.rectangle(rect, corner, item, lines, (&mut level, &mut hatching));
                }
                Shape::Circle { center, radius } => painter.circle(center, radius, item, lines),
                Shape::Text(place) => painter.text(list.text(place), taken),
            }
        }
        if !hatching.is_empty() {
            painter.painter.add(egui::Shape::mesh(hatching));
        }
        level.paint(&painter.painter);
    }

    fn clipped(&self, clip: Rect) -> Self {
        let area = self.area.intersect(clip);
        Self {
            painter: self.painter.with_clip_rect(area.intersect(self.painter.clip_rect())),
            area,
            visible: self.placement.drawing_rect(area),
            ..*self
        }
    }

    /// The color as it is on the screen.
    fn color(&self, color: Color) -> Color32 {
        let full = self.tokens.role(color.role);
        match color.ground {
            _ if color.strength >= 1.0 => full,
            Ground::Below => full.gamma_multiply(color.strength),
            Ground::Surface => self.tokens.mixed(full, color.strength),
        }
    }

    /// A line on the screen: never so thin that it vanishes.
    fn stroke(&self, stroke: Stroke, lines: Lines) -> egui::Stroke {
        let color = self.color(stroke.color);
        if lines.is_crowded {
            return egui::Stroke::new(CROWD.1, color.gamma_multiply(CROWD.0));
        }
        let width = stroke.width;
        let seen = (width * self.placement.zoom).clamp(0.35 * width + 0.25, 2.0 * width) as f32;
        let color = if lines.strength < 1.0 { color.gamma_multiply(lines.strength) } else { color };
        egui::Stroke::new(seen.max(lines.min_width), color)
    }

    fn rectangle(
        &self,
        rect: display::Rect,
        corner: f64,
        item: &Item,
        lines: Lines,
        (level, hatching): (&mut LevelLines, &mut Mesh),
    ) {
        let zoom = self.placement.zoom;
        let rect = self.placement.screen_rect(rect);
        let fill = match item.fill {
            Some(Fill::Hatched(color)) => {
                let seen = self.area.intersect(self.painter.clip_rect());
                hatch::add(hatching, rect, seen, self.color(color));
                None
            }
            Some(Fill::Solid(color)) => Some(self.color(color)),
            None => None,
        };
        let mut line = item.stroke.map_or(egui::Stroke::NONE, |stroke| self.stroke(stroke, lines));
        if zoom < SMALL_ZOOM {
            // Many thin outlines side by side would make an area of their own.
            let strength = (rect.height() / FADING_HEIGHT).clamp(0.0, 1.0);
            line = egui::Stroke::new(line.width.min(1.0), line.color.gamma_multiply(strength));
            if zoom < OVERVIEW_ZOOM && fill.is_none() {
                if strength > MIN_STRENGTH {
                    level.outline(rect, line);
                }
                return;
            }
        }
        let corner = if corner == 0.0 { 0.0 } else { (corner * zoom).clamp(1.0, corner.max(8.0)) };
        let corner = CornerRadius::same(corner.round().min(255.0) as u8);
        match (fill, item.stroke.map(|stroke| stroke.dash.lengths().is_some())) {
            (Some(fill), None) => {
                self.painter.rect_filled(rect, corner, fill);
            }
            (None, None) => {}
            (fill, Some(true)) if zoom >= SMALL_ZOOM => {
                self.painter.rect_filled(rect, corner, fill.unwrap_or_default());
                let corners = [rect.left_top(), rect.right_top(), rect.right_bottom(), rect.left_bottom()];
                let around = [corners[0], corners[1], corners[2], corners[3], corners[0]];
                self.line(around.to_vec(), line, item.stroke.map_or(display::Dash::Solid, |it| it.dash));
            }
            (fill, _) => {
                self.painter.rect(rect, corner, fill.unwrap_or_default(), line, StrokeKind::Middle);
            }
        }
    }

    fn circle(&self, center: Point, radius: f64, item: &Item, lines: Lines) {
        let center = self.placement.screen_point(center);
        let radius = ((radius * self.placement.zoom) as f32).max(lines.min_width.max(1.0));
        let fill = item.fill.map(|fill| self.color(fill.color()));
        let line = item.stroke.map(|stroke| self.stroke(stroke, lines));
        match (fill, line) {
            (_, Some(line)) if radius < DOT_RADIUS => {
                self.painter.circle_filled(center, radius, line.color);
            }
            (Some(fill), None) => {
                self.painter.circle_filled(center, radius, fill);
            }
            (fill, line) => {
                let line = line.unwrap_or(egui::Stroke::NONE);
                self.painter.circle(center, radius, fill.unwrap_or_default(), line);
            }
        }
    }
}
