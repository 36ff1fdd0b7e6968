//! Paints what is in view: only that, and only what is large enough to be seen.

use egui::{Align2, Color32, CornerRadius, FontId, Rect, Shape, Stroke, StrokeKind, vec2};
use layout::look::{self, Dash, Ink, Standing};
use layout::metrics::{ARROW_LENGTH, DECISION_INSET};
use layout::progress::elapsed;
use layout::{
    BlockForm, Item, OverlayCurve, OverlayKind, Piece, Point, Progress, Route, TextRole, TextShape,
};
use theme::Tokens;
use tpn::{ArcKind, LabelId, Network, NodeId, Plan, Role};
use workbench::state::search::Focus;
use workbench::state::settings::NetworkView;

use super::data::Drawn;
use super::highlight::Highlight;
use super::level::LevelLines;
use super::view::View;

/// Below this size in points a text is left out, and fades in from there.
const LEAST_TEXT: f64 = 6.0;
/// Shapes smaller than this on the screen are left out.
const LEAST_SHAPE: f64 = 1.5;
/// Below this zoom, activities are named by their outlines instead of their arcs.
const FAR_ZOOM: f64 = 0.42;
/// Below this zoom only activities and structure are drawn: single connections would run together.
const OVERVIEW_ZOOM: f64 = 0.06;
/// With more curves over the drawing than this, they are drawn thin and faint, but for those of the selection.
const MANY_CURVES: usize = 80;
/// Names that would be smaller than this in points keep this size instead, and are cut to the room there is.
const LEGIBLE: f64 = 9.5;
/// Below this zoom, rows lie too close for names between them.
const CROWDED_ZOOM: f64 = 0.28;
/// A name with less room than this on the screen is left out.
const LEAST_NAME: f32 = 30.0;
/// Outlines less high than this on the screen fade.
const FADING_HEIGHT: f32 = 8.0;
/// Outlines fainter than this are left out.
const LEAST_STRENGTH: f32 = 0.04;
/// Events smaller than this on the screen are dots.
const DOT_RADIUS: f32 = 2.0;
/// How far from the corner of its block a title may begin that finds others there, in points.
const FARTHEST_TITLE: f32 = 70.0;
/// From the edge of the panel to a heading that was moved into view.
const HEADING_INSET: f64 = 16.0;

/// Everything that painting needs.
pub(super) struct Scene<'a> {
    /// Paints inside the panel only.
    pub(super) painter: &'a egui::Painter,
    /// The panel.
    pub(super) panel: Rect,
    /// The view.
    pub(super) view: &'a View,
    /// The drawing.
    pub(super) drawn: &'a Drawn,
    /// The network.
    pub(super) network: &'a Network,
    /// The plan, if there is one for this network.
    pub(super) plan: Option<&'a Plan>,
    /// What is shown.
    pub(super) options: &'a NetworkView,
    /// The colours.
    pub(super) tokens: &'a Tokens,
    /// What is selected.
    pub(super) selected: &'a Highlight,
    /// What the pointer is over, here or in another panel.
    pub(super) hovered: &'a Highlight,
    /// What the step of the search that is looked at is about.
    pub(super) focus: Option<&'a Focus>,
    /// What has happened at the time shown, if that is shown.
    pub(super) progress: Option<&'a Progress>,
    /// Where marks lie over the drawing, on the screen.
    pub(super) marks: &'a [Rect],
}

/// The shapes in view, by their places in the drawing.
#[derive(Default)]
struct InView {
    blocks: Vec<u32>,
    connectors: Vec<u32>,
    arcs: Vec<u32>,
    nodes: Vec<u32>,
    texts: Vec<u32>,
}

impl Scene<'_> {
    /// Paints everything.
    pub(super) fn paint(&self) {
        let shapes = self.in_view();
        self.lanes();
        self.blocks(&shapes.blocks);
        self.highlights();
        self.arcs(&shapes);
        self.elapsed();
        self.overlays();
        self.nodes(&shapes.nodes);
        if self.is_far() {
            let mut taken = self.block_titles(&shapes.blocks);
            if self.view.zoom() >= CROWDED_ZOOM && self.options.parts().shows_text(TextRole::Name) {
                self.names(&shapes.texts, &mut taken);
            }
        } else {
            self.texts(&shapes);
        }
        self.lane_names();
    }

    /// Whether the view is so far out that only structure can be named.
    fn is_far(&self) -> bool {
        self.view.zoom() < FAR_ZOOM
    }

    fn in_view(&self) -> InView {
        let mut shapes = InView::default();
        let area = self.view.visible(self.panel);
        self.drawn.drawing.visit(area, LEAST_SHAPE / self.view.zoom(), &mut |shape| match shape {
            layout::Shape::Block(at) => shapes.blocks.push(at),
            layout::Shape::Connector(at) => shapes.connectors.push(at),
            layout::Shape::Arc(at) => shapes.arcs.push(at),
            layout::Shape::Node(at) => shapes.nodes.push(at),
            layout::Shape::Text(at) => shapes.texts.push(at),
        });
        // The list has parents first, and outer blocks must not cover inner ones.
        shapes.blocks.sort_unstable();
        shapes
    }

    fn color(&self, ink: Ink) -> Color32 {
        ink_color(self.tokens, ink)
    }

    /// How strong lines are: at small zooms they lie so close that full strength would make an area of them.
    fn line_strength(&self) -> f32 {
        (self.view.zoom() / 0.15).clamp(0.35, 1.0) as f32
    }

    /// Whether so little of the drawing can be told apart that only activities and structure are drawn.
    fn is_overview(&self) -> bool {
        self.view.zoom() < OVERVIEW_ZOOM
    }

    /// A line width in points for one in drawing units: never so thin that it vanishes.
    fn width(&self, width: f64) -> f32 {
        (width * self.view.zoom()).clamp(0.35 * width + 0.25, 2.0 * width) as f32
    }

    fn blocks(&self, blocks: &[u32]) {
        let mut outlines = LevelLines::default();
        for &at in blocks {
            let block = &self.drawn.drawing.blocks[at as usize];
            let is_outline = block.form == BlockForm::Activity && self.is_far() || self.is_overview();
            if !(self.options.structure || is_outline || block.form == BlockForm::Collapsed) {
                continue;
            }
            let rect = self.view.screen_rect(self.panel, block.rect);
            let (fill, stroke) = look::block_look(block.form);
            let corner = CornerRadius::same((6.0 * self.view.zoom()).clamp(1.0, 8.0) as u8);
            // Many thin outlines side by side would make an area of their own.
            let strength = (rect.height() / FADING_HEIGHT).clamp(0.0, 1.0);
            let color = self.color(stroke.ink).gamma_multiply(strength);
            let line = Stroke::new(self.width(stroke.width).min(1.0), color);
            // Nested fills of the surface would hide the lanes around them.
            if self.is_overview() {
                if strength > LEAST_STRENGTH {
                    outlines.outline(rect, line);
                }
            } else if fill == Ink::Surface {
                self.painter.rect_stroke(rect, corner, line, StrokeKind::Middle);
            } else {
                self.painter.rect(rect, corner, self.color(fill), line, StrokeKind::Middle);
            }
        }
        outlines.paint(self.painter);
    }

    /// The bands of the parallel branches.
    fn lanes(&self) {
        for lane in self.lanes_in_view() {
            let (fill, stroke) = look::lane_look(lane.number);
            let rect = self.view.screen_rect(self.panel, lane.rect);
            let fill = fill.map_or(self.tokens.surface, |ink| self.color(ink));
            self.painter.rect(rect, 0.0, fill, Stroke::new(1.0, self.color(stroke.ink)), StrokeKind::Middle);
        }
    }

    /// Their names, which stay in view as long as their bands do.
    fn lane_names(&self) {
        let font = FontId::proportional(theme::size::SMALL);
        let color = self.color(Ink::TextMuted);
        let mut taken: Vec<Rect> = Vec::new();
        for lane in self.lanes_in_view() {
            let rect = self.view.screen_rect(self.panel, lane.rect).intersect(self.panel);
            let galley = self.painter.layout_no_wrap(lane.name.to_string(), font.clone(), color);
            let place = Rect::from_min_size(rect.min + vec2(4.0, 1.0), galley.size());
            let has_room =
                rect.expand(1.0).contains_rect(place) && taken.iter().all(|it| !it.intersects(place));
            if has_room {
                self.painter.rect_filled(place.expand2(vec2(3.0, 0.0)), 3.0, self.tokens.surface);
                self.painter.galley(place.min, galley, color);
                taken.push(place);
            }
        }
    }

    fn lanes_in_view(&self) -> impl Iterator<Item = &super::data::Lane> {
        let area = self.view.visible(self.panel);
        let least = 2.0 * LEAST_SHAPE / self.view.zoom();
        let lanes = if self.options.lanes { self.drawn.lanes.as_slice() } else { &[] };
        lanes.iter().filter(move |lane| lane.rect.touches(area) && lane.rect.height() > least)
    }

    /// What time has passed of the arcs that are under way.
    fn elapsed(&self) {
        let area = self.view.visible(self.panel);
        let look = look::elapsed_stroke();
        let stroke = Stroke::new(self.width(look.width).max(2.0), self.color(look.ink));
        let under_way = self.progress.into_iter().flat_map(|progress| &progress.under_way);
        for &(arc, fraction) in under_way {
            let is_seen = self.drawn.drawing.arc(arc).is_some_and(|shape| shape.bounds.touches(area));
            if let Some((start, pieces)) = elapsed(&self.drawn.drawing, arc, fraction).filter(|_| is_seen) {
                self.curve(start, &pieces, stroke, Dash::Solid);
            }
        }
    }

    fn highlights(&self) {
        let drawing = &self.drawn.drawing;
        let step = self.focus.map(|focus| Highlight::of_focus(focus, self.network)).unwrap_or_default();
        let is_failure = self.focus.is_some_and(|focus| focus.is_failure);
        let step_color = if is_failure { self.tokens.failure } else { self.tokens.decision };
        let accent = self.tokens.accent;
        let marks = [(&step, 0.40, step_color), (self.hovered, 0.22, accent), (self.selected, 0.45, accent)];
        for (shapes, strength, hue) in marks {
            let color = hue.gamma_multiply(strength);
            if let Some(occurrence) = shapes.occurrence {
                let outlines = drawing.blocks.iter().filter(|block| block.occurrence == Some(occurrence));
                for block in outlines {
                    let rect = self.view.screen_rect(self.panel, block.rect);
                    self.painter.rect_filled(rect, 6.0, self.tokens.accent.gamma_multiply(strength * 0.25));
                    self.painter.rect_stroke(rect, 6.0, Stroke::new(1.5, color), StrokeKind::Middle);
                }
            }
            for arc in shapes.arcs.iter().filter_map(|&arc| drawing.arc(arc)) {
                let width = (9.0 * self.view.zoom()).clamp(4.0, 12.0) as f32;
                self.curve(arc.start, drawing.pieces(arc), Stroke::new(width, color), Dash::Solid);
            }
            for node in shapes.nodes.iter().filter_map(|&node| drawing.node(node)) {
                let radius = (node.radius + 4.0) * self.view.zoom();
                self.painter.circle_filled(
                    self.view.screen_point(self.panel, node.center),
                    (radius as f32).max(4.0),
                    color,
                );
            }
        }
    }

    fn arcs(&self, shapes: &InView) {
        let drawing = &self.drawn.drawing;
        for &at in &shapes.connectors {
            let connector = &drawing.connectors[at as usize];
            let standing = look::node_standing(self.plan, connector.node);
            if self.is_shown(standing) {
                let look = look::arc_stroke(ArcKind::Glue, Route::Along, standing);
                let stroke = Stroke::new(self.width(look.width), self.color(look.ink));
                self.curve(connector.start, &[connector.piece], stroke, Dash::Solid);
            }
        }
        // What the plan selects lies over what it does not.
        for is_selected in [false, true] {
            let mut level = LevelLines::default();
            for &at in &shapes.arcs {
                let arc = &drawing.arcs[at as usize];
                let standing = look::arc_standing(self.plan, arc.id);
                if (standing == Standing::Selected) != is_selected || !self.is_shown(standing) {
                    continue;
                }
                let look = look::arc_stroke(arc.kind, arc.route, standing);
                let is_connection = matches!(
                    arc.kind,
                    ArcKind::Glue | ArcKind::Fork | ArcKind::Join | ArcKind::Choice | ArcKind::Merge
                );
                if is_connection && self.is_overview() {
                    continue;
                }
                let color = self.color(look.ink).gamma_multiply(self.line_strength());
                let stroke = Stroke::new(self.width(look.width), color);
                let is_level = match (drawing.pieces(arc), look.dash) {
                    ([Piece::Line(end)], Dash::Solid) if self.is_far() => {
                        let at = |point| self.view.screen_point(self.panel, point);
                        level.add(at(arc.start), at(*end), stroke)
                    }
                    _ => false,
                };
                if !is_level {
                    self.curve(arc.start, drawing.pieces(arc), stroke, look.dash);
                }
                if let Some((tip, before)) = drawing.arrow(arc) {
                    self.arrow(tip, before, color);
                }
            }
            level.paint(self.painter);
        }
    }

    fn is_shown(&self, standing: Standing) -> bool {
        self.options.unselected || standing != Standing::Unselected
    }

    fn arrow(&self, tip: Point, before: Point, color: Color32) {
        if ARROW_LENGTH * self.view.zoom() < 2.5 {
            return;
        }
        let corners = look::arrow_head(tip, before).map(|corner| self.view.screen_point(self.panel, corner));
        self.painter.add(Shape::convex_polygon(corners.to_vec(), color, Stroke::NONE));
    }

    fn overlays(&self) {
        let links = self.options.links.then_some(&self.drawn.links);
        let orderings = self.options.orderings.then_some(&self.drawn.orderings);
        let area = self.view.visible(self.panel);
        let all = links.into_iter().chain(orderings).flatten();
        let in_view: Vec<&OverlayCurve> = all.filter(|curve| curve.bounds.touches(area)).collect();
        let is_crowded = in_view.len() > MANY_CURVES;
        for curve in in_view {
            if is_crowded && self.is_overview() && !self.is_chosen(curve) {
                // A cloud of lines says nothing; those of the selection do.
                continue;
            }
            if is_crowded && !self.is_chosen(curve) {
                let color = self.color(look::overlay_stroke(curve.kind).ink).gamma_multiply(0.22);
                self.curve(curve.start, &curve.pieces, Stroke::new(1.0, color), Dash::Solid);
            } else {
                self.overlay(curve);
            }
        }
        self.drawn
            .cycle
            .iter()
            .chain(&self.drawn.threats)
            .filter(|curve| curve.bounds.touches(area))
            .for_each(|curve| self.overlay(curve));
    }

    fn overlay(&self, curve: &OverlayCurve) {
        let look = look::overlay_stroke(curve.kind);
        let color = self.color(look.ink);
        let stroke = Stroke::new(self.width(look.width).max(1.2), color);
        self.curve(curve.start, &curve.pieces, stroke, look.dash);
        if let Some((tip, before)) = end_of(curve) {
            self.arrow(tip, before, color);
        }
    }

    /// Whether a curve belongs to what is selected or pointed at.
    fn is_chosen(&self, curve: &OverlayCurve) -> bool {
        let Some(plan) = self.plan else { return false };
        let number = curve.number as usize;
        let labels = match curve.kind {
            OverlayKind::CausalLink => plan.causal_links.get(number).map(|link| [link.ask, link.tell]),
            OverlayKind::Ordering => plan.orderings_added.get(number).map(|order| [order.first, order.then]),
            OverlayKind::NegativeCycle | OverlayKind::Threat => None,
        };
        let arc = |label: LabelId| self.network.labels.get(label.index()).map(|label| label.arc);
        let mut arcs = labels.into_iter().flatten().filter_map(arc);
        arcs.any(|arc| self.selected.arcs.contains(&arc) || self.hovered.arcs.contains(&arc))
    }

    fn nodes(&self, nodes: &[u32]) {
        for &at in nodes {
            let node = &self.drawn.drawing.nodes[at as usize];
            let standing = look::node_standing(self.plan, node.id);
            if !self.is_shown(standing) {
                continue;
            }
            let stroke = look::node_stroke(node.role, node.radius, standing);
            let center = self.view.screen_point(self.panel, node.center);
            let radius = ((node.radius * self.view.zoom()) as f32).max(1.0);
            let fill = self.color(look::node_fill(node.role, node.radius, standing));
            let line = Stroke::new(self.width(stroke.width), self.color(stroke.ink));
            if radius < DOT_RADIUS {
                self.painter.circle_filled(center, radius, line.color);
            } else {
                self.painter.circle(center, radius, fill, line);
            }
            let is_done = self.progress.is_some_and(|it| it.done.binary_search(&node.id).is_ok());
            // The numbers of events that have happened stand on the mark.
            let dot = ((look::done_radius(node.radius) * self.view.zoom()) as f32).max(0.8 * radius);
            if is_done && dot >= 0.8 {
                self.painter.circle_filled(center, dot, self.color(Ink::Now));
            }
            let inset = (DECISION_INSET * self.view.zoom()) as f32;
            if node.role == Role::Decision && inset >= 1.2 {
                self.painter.circle_stroke(center, radius - inset, Stroke::new(self.width(1.0), line.color));
            }
        }
    }

    fn texts(&self, shapes: &InView) {
        let drawing = &self.drawn.drawing;
        let mut taken = Vec::new();
        for &at in &shapes.texts {
            let text = &drawing.texts[at as usize];
            if text.slide.is_none() {
                self.text(text, text.rect, &mut taken);
            }
        }
        let area = self.view.visible(self.panel);
        let inset = HEADING_INSET / self.view.zoom();
        for at in shapes.arcs.iter().filter(|&&at| drawing.arcs[at as usize].route == Route::Arch) {
            for &at in self.drawn.sliding.get(at).into_iter().flatten() {
                let text = &drawing.texts[at as usize];
                let rect = text.rect_in_view(area.min.x + inset, area.max.x - inset);
                if rect.touches(area) {
                    self.text(text, rect, &mut taken);
                }
            }
        }
        if self.options.windows {
            for text in self.drawn.windows.iter().filter(|text| text.rect.touches(area)) {
                self.text(text, text.rect, &mut taken);
            }
        }
    }

    fn text(&self, text: &TextShape, rect: layout::Rect, taken: &mut Vec<Rect>) {
        let wanted = self.options.parts().shows_text(text.role);
        let arc_of_label = |label: LabelId| self.network.labels[label.index()].arc;
        let standing = look::item_standing(self.plan, text.owner, arc_of_label);
        let size = text.size * self.view.zoom();
        let least = if text.role == TextRole::Node { LEAST_TEXT - 1.0 } else { LEAST_TEXT };
        if !wanted || !self.is_shown(standing) {
            return;
        }
        let place = self.view.screen_rect(self.panel, rect);
        if text.role == TextRole::Name && size < LEGIBLE {
            self.name(text, place, standing, taken);
            return;
        }
        if size < least {
            return;
        }
        let strength = ((size - least) / 1.5).clamp(0.35, 1.0) as f32;
        let is_done = |node: &NodeId| self.progress.is_some_and(|it| it.done.binary_search(node).is_ok());
        let ink = match (&text.owner, text.role) {
            (Item::Node(node), TextRole::Node) if is_done(node) => self.color(Ink::NodeFill),
            _ => self.color(look::text_ink(text.role, standing)),
        };
        let color = ink.gamma_multiply(strength);
        if let Item::Label(label) = text.owner {
            self.mark_label(label, place);
        }
        // Whole and half sizes only, so that zooming does not fill the font atlas.
        let font = |size: f64| FontId::proportional(((size * 2.0).floor() / 2.0) as f32);
        let mut galley = self.painter.layout_no_wrap(text.text.to_string(), font(size), color);
        if galley.size().x > place.width() + 1.0 {
            let ratio = f64::from(place.width() / galley.size().x);
            galley = self.painter.layout_no_wrap(text.text.to_string(), font(size * ratio), color);
        }
        self.painter.galley(place.center() - galley.size() / 2.0, galley, color);
    }

    /// Names of activities where the drawing is small, at a size that can be read.
    fn names(&self, texts: &[u32], taken: &mut Vec<Rect>) {
        for &at in texts {
            let text = &self.drawn.drawing.texts[at as usize];
            let arc_of_label = |label: LabelId| self.network.labels[label.index()].arc;
            let standing = look::item_standing(self.plan, text.owner, arc_of_label);
            if text.role != TextRole::Name || text.slide.is_some() || !self.is_shown(standing) {
                continue;
            }
            let place = self.view.screen_rect(self.panel, text.rect);
            self.name(text, place, standing, taken);
        }
    }

    /// A name at the least legible size over the middle of its place, cut to the length of its arc, if there is room
    /// for it between what is `taken`.
    fn name(&self, text: &TextShape, place: Rect, standing: Standing, taken: &mut Vec<Rect>) {
        let length = match text.owner {
            Item::Arc(arc) => self.drawn.drawing.arc(arc).map(|arc| arc.bounds.width() * self.view.zoom()),
            _ => None,
        };
        let room = length.map_or(place.width(), |length| length as f32 - 6.0);
        if room < LEAST_NAME {
            return;
        }
        let color = self.color(look::text_ink(text.role, standing));
        let font = FontId::proportional(LEGIBLE as f32);
        let mut job = egui::text::LayoutJob::simple_singleline(text.text.to_string(), font, color);
        job.wrap = egui::text::TextWrapping::truncate_at_width(room);
        let galley = self.painter.layout_job(job);
        let rect = Align2::CENTER_BOTTOM.anchor_size(place.center_bottom() + vec2(0.0, 1.0), galley.size());
        if taken.iter().all(|other| !other.intersects(rect)) {
            // What passes behind would make so small a text hard to read.
            self.painter.rect_filled(rect, 2.0, self.tokens.surface.gamma_multiply(0.8));
            self.painter.galley(rect.min, galley, color);
            taken.push(rect);
        }
    }

    fn mark_label(&self, label: LabelId, place: Rect) {
        if self.selected.labels.contains(&label) {
            self.painter.rect_filled(place.expand(2.0), 3.0, self.tokens.selection);
        } else if self.hovered.labels.contains(&label) {
            self.painter.rect_filled(place.expand(2.0), 3.0, self.tokens.hover);
        }
    }

    /// Names of blocks at a fixed size, where they have room, outer before inner. Answers where they are.
    fn block_titles(&self, blocks: &[u32]) -> Vec<Rect> {
        let font = FontId::proportional(theme::size::SMALL);
        let color = self.color(Ink::TextMuted);
        let mut taken: Vec<Rect> = self.marks.to_vec();
        for &at in blocks {
            let block = &self.drawn.drawing.blocks[at as usize];
            let rect = self.view.screen_rect(self.panel, block.rect).intersect(self.panel);
            if block.title.is_empty() || rect.width() < 40.0 || rect.height() < 16.0 {
                continue;
            }
            let galley = self.painter.layout_no_wrap(block.title.to_string(), font.clone(), color);
            let mut place = Rect::from_min_size(rect.min + vec2(5.0, 2.0), galley.size());
            // Beside what is there already, as far as the block goes.
            while let Some(other) = taken.iter().find(|other| other.intersects(place)) {
                place = place.translate(vec2(other.right() + 6.0 - place.left(), 0.0));
            }
            let is_near = place.left() < rect.left() + FARTHEST_TITLE;
            if is_near && rect.contains_rect(place) {
                self.painter.rect_filled(place.expand(1.0), 2.0, self.tokens.surface.gamma_multiply(0.8));
                self.painter.galley(place.min, galley, color);
                taken.push(place);
            }
        }
        taken
    }

    fn curve(&self, start: Point, pieces: &[Piece], stroke: Stroke, dash: Dash) {
        if let ([Piece::Line(end)], Dash::Solid) = (pieces, dash) {
            let ends = [self.view.screen_point(self.panel, start), self.view.screen_point(self.panel, *end)];
            self.painter.line_segment(ends, stroke);
            return;
        }
        let points = self.polyline(start, pieces);
        match dash.lengths() {
            None => {
                self.painter.add(Shape::line(points, stroke));
            }
            Some((mark, gap)) => {
                let scale = self.view.zoom().clamp(0.6, 1.5);
                let (mark, gap) = ((mark * scale) as f32, (gap * scale) as f32);
                self.painter.extend(Shape::dashed_line(&points, stroke, mark, gap));
            }
        }
    }

    /// The curve on the screen, with as many points as its size there needs.
    fn polyline(&self, start: Point, pieces: &[Piece]) -> Vec<egui::Pos2> {
        let mut points = vec![self.view.screen_point(self.panel, start)];
        let mut from = start;
        for &piece in pieces {
            let steps = match piece {
                Piece::Line(_) => 1,
                Piece::Cubic(..) => {
                    ((from.distance(piece.end()) * self.view.zoom() / 6.0) as u32).clamp(3, 24)
                }
            };
            points.extend((1..=steps).map(|step| {
                let at = piece.at(from, f64::from(step) / f64::from(steps));
                self.view.screen_point(self.panel, at)
            }));
            from = piece.end();
        }
        points
    }
}

/// The tip of a curve and the point it comes from.
fn end_of(curve: &OverlayCurve) -> Option<(Point, Point)> {
    let (last, before) = curve.pieces.split_last()?;
    let start = before.last().map_or(curve.start, |piece| piece.end());
    Some((last.end(), last.before_end(start)))
}

/// The colour of an ink in the app's theme.
pub(super) fn ink_color(tokens: &Tokens, ink: Ink) -> Color32 {
    match ink {
        Ink::Surface => tokens.surface,
        Ink::Sunken => tokens.sunken,
        Ink::Raised => tokens.raised,
        Ink::Line => tokens.line,
        Ink::LineStrong => tokens.line_strong,
        Ink::Text => tokens.text,
        Ink::TextMuted => tokens.text_muted,
        Ink::TextFaint => tokens.text_faint,
        Ink::Path => tokens.path,
        Ink::PathUnselected => tokens.path_unselected,
        Ink::NodeFill => tokens.node_fill,
        Ink::Decision => tokens.decision,
        Ink::Tell => tokens.tell,
        Ink::Ask => tokens.ask,
        Ink::Link => tokens.link,
        Ink::Ordering => tokens.ordering,
        Ink::Threat => tokens.threat,
        Ink::Slack => tokens.accent,
        Ink::Now => tokens.now,
        Ink::Lane => tokens.hover,
    }
}

/// A short message in a corner of the panel, with a sign that does not depend on colour.
pub(super) fn badge(
    painter: &egui::Painter,
    corner: egui::Pos2,
    text: &str,
    color: Color32,
    tokens: &Tokens,
    width: f32,
) {
    let font = FontId::proportional(theme::size::SMALL);
    let mut job = egui::text::LayoutJob::simple(text.to_owned(), font, color, width);
    job.wrap.max_rows = 2;
    let galley = painter.layout_job(job);
    let rect = Align2::LEFT_TOP.anchor_size(corner, galley.size() + vec2(16.0, 8.0));
    painter.rect(rect, 5.0, tokens.raised, Stroke::new(1.0, color.gamma_multiply(0.6)), StrokeKind::Inside);
    painter.galley(rect.min + vec2(8.0, 4.0), galley, color);
}
