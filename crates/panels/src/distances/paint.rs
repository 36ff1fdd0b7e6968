//! Paints a distance graph: names in boxes, bounds as curves with their weights, the negative cycle over all.

use display::Point;
use display::text::TEXT_SIZE;
use egui::{Align2, Color32, FontId, Pos2, Rect, Shape, Stroke, StrokeKind, Vec2, vec2};
use exact::Time;
use kirk::Constraint;
use theme::{Tokens, size};
use tpn::Network;
use workbench::state::Selection;
use workbench::state::search::Focus;
use workbench::state::selection::node_name;
use workbench::time_text;

use super::arrange::Arranged;
use super::graph::{DistanceGraph, Edge, Vertex};
use crate::network::view::View;

/// Everything that painting needs.
pub struct Scene<'a> {
    /// Paints inside the panel only.
    pub painter: &'a egui::Painter,
    pub panel: Rect,
    /// Where it is looked at from.
    pub view: &'a View,
    pub graph: &'a DistanceGraph,
    pub arranged: &'a Arranged,
    pub network: &'a Network,
    pub tokens: &'a Tokens,
    /// What is selected.
    pub selection: &'a Selection,
    /// What the step is about.
    pub focus: &'a Focus,
}

/// What the pointer is over, by position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pointed {
    Vertex(usize),
    Edge(usize),
}

/// The height of a box with a name, and how much higher it is with each further one.
const BOX_HEIGHTS: (f64, f64) = (24.0, 16.0);
/// A vertex with so many edges more than the other end of an edge leaves its weight to that end.
const CROWD: usize = 3;
/// The radius of a vertex without a name.
const DOT: f64 = 6.0;
/// Texts that would be smaller than this in points are left out; others keep a size that can be read.
const MIN_TEXT: f32 = 7.5;

/// A size of letters that can be read, in half points so that zooming does not fill the font atlas.
fn legible(font_size: f32) -> f32 {
    ((font_size * 2.0).floor() / 2.0).max(size::SMALL)
}

/// Returns how wide a vertex is drawn.
pub fn width(vertex: &Vertex) -> f64 {
    let widths = vertex.names.iter().map(|name| display::approximate_text_width(name));
    let Some(widest) = widths.reduce(f32::max) else { return 2.0 * DOT };
    // Measured in another size than the one that is drawn; the shape of letters is the same.
    f64::from(widest) * f64::from(size::BODY) / TEXT_SIZE + 18.0
}

impl Scene<'_> {
    /// Paints everything.
    pub fn paint(&self, pointed: Option<Pointed>) {
        let has_cycle = self.graph.edges.iter().any(|edge| edge.is_in_cycle);
        let mut edges: Vec<usize> = (0..self.graph.edges.len()).collect();
        edges.sort_by_key(|&edge| (self.graph.edges[edge].is_in_cycle, self.is_new(&self.graph.edges[edge])));
        for &edge in &edges {
            self.edge(edge, has_cycle, pointed == Some(Pointed::Edge(edge)));
        }
        for vertex in 0..self.graph.vertices.len() {
            self.vertex(vertex, pointed == Some(Pointed::Vertex(vertex)));
        }
        // Weights lie over the boxes' edges, never under them.
        let mut taken: Vec<Rect> = (0..self.graph.vertices.len()).map(|vertex| self.frame(vertex)).collect();
        let mut degrees = vec![0; self.graph.vertices.len()];
        for edge in &self.graph.edges {
            degrees[edge.from] += 1;
            degrees[edge.to] += 1;
        }
        for &edge in edges.iter().rev() {
            self.weight(edge, has_cycle, &degrees, &mut taken);
        }
    }

    /// Returns what is at a place of the screen.
    pub fn pointed(&self, pointer: Pos2) -> Option<Pointed> {
        if let Some(vertex) =
            (0..self.graph.vertices.len()).find(|&vertex| self.frame(vertex).contains(pointer))
        {
            return Some(Pointed::Vertex(vertex));
        }
        let distance = |edge: usize| {
            let points = self.curve(edge);
            let segments = points.windows(2).map(|pair| distance_to_segment(pointer, pair[0], pair[1]));
            segments.fold(f32::INFINITY, f32::min)
        };
        let all = (0..self.graph.edges.len()).map(|edge| (distance(edge), edge));
        let nearest = all.min_by(|one, other| one.0.total_cmp(&other.0));
        nearest.filter(|(distance, _)| *distance < 5.0).map(|(_, edge)| Pointed::Edge(edge))
    }

    /// Returns what is said about it.
    pub fn describe(&self, pointed: Pointed) -> Vec<String> {
        match pointed {
            Pointed::Vertex(vertex) => {
                let nodes = &self.graph.vertices[vertex].nodes;
                nodes.iter().map(|&node| node_name(self.network, node)).collect()
            }
            Pointed::Edge(edge) => {
                let edge = &self.graph.edges[edge];
                let name = |vertex: usize| {
                    let vertex = &self.graph.vertices[vertex];
                    vertex.nodes.first().map(|&node| node_name(self.network, node)).unwrap_or_default()
                };
                let (from, to) = (name(edge.from), name(edge.to));
                let weight = time_text::time(edge.weight);
                let why = match edge.constraint {
                    Constraint::Lower(_) => "minimum duration",
                    Constraint::Upper(_) => "maximum duration",
                    Constraint::Link(_) => "causal link",
                    Constraint::Order(_) => "ordering",
                    Constraint::UseOrder(_) => "resource ordering",
                    Constraint::Departure(_) => "travel time from the departure place",
                };
                vec![format!("{to} is at most {weight} after {from}"), why.to_owned()]
            }
        }
    }

    /// Returns what it selects.
    pub fn selection_of(&self, pointed: Pointed) -> Selection {
        match pointed {
            Pointed::Vertex(vertex) => {
                let nodes = &self.graph.vertices[vertex].nodes;
                nodes.first().map_or(Selection::None, |&node| Selection::Node(node))
            }
            Pointed::Edge(edge) => match self.graph.edges[edge].constraint {
                Constraint::Lower(arc) | Constraint::Upper(arc) => Selection::Arc(arc),
                Constraint::Link(link) => Selection::Link(link),
                Constraint::Order(order) => Selection::Ordering(order),
                Constraint::UseOrder(_) => Selection::None,
                Constraint::Departure(departing) => Selection::Label(departing.movement),
            },
        }
    }

    fn frame(&self, vertex: usize) -> Rect {
        let zoom = self.view.zoom() as f32;
        let center = self.view.screen_point(self.panel, self.arranged.places[vertex]);
        let vertex = &self.graph.vertices[vertex];
        let height = match vertex.names.len() {
            0 => 2.0 * DOT,
            lines => BOX_HEIGHTS.0 + (lines - 1) as f64 * BOX_HEIGHTS.1,
        };
        Rect::from_center_size(center, vec2(width(vertex) as f32, height as f32) * zoom)
    }

    /// Returns whether the step that is looked at is about a bound.
    fn is_new(&self, edge: &Edge) -> bool {
        match edge.constraint {
            Constraint::Lower(arc) | Constraint::Upper(arc) => self.focus.arcs.contains(&arc),
            Constraint::Link(link) => self.focus.labels.contains(&link.ask),
            Constraint::Order(order) => self.focus.labels.contains(&order.first),
            Constraint::UseOrder(_) => false,
            Constraint::Departure(departing) => self.focus.labels.contains(&departing.movement),
        }
    }

    fn is_selected(&self, edge: &Edge) -> bool {
        match (edge.constraint, self.selection) {
            (Constraint::Lower(arc) | Constraint::Upper(arc), Selection::Arc(selected)) => arc == *selected,
            (Constraint::Lower(arc) | Constraint::Upper(arc), Selection::Occurrence(selected)) => {
                self.network.arcs.get(arc.index()).is_some_and(|arc| arc.occurrence == Some(*selected))
            }
            (Constraint::Link(link), Selection::Link(selected)) => link == *selected,
            (Constraint::Order(order), Selection::Ordering(selected)) => order == *selected,
            _ => false,
        }
    }

    fn color(&self, edge: &Edge, has_cycle: bool) -> Color32 {
        let tokens = self.tokens;
        if edge.is_in_cycle {
            return tokens.threat;
        }
        let color = match edge.constraint {
            _ if self.is_selected(edge) || self.is_new(edge) => tokens.accent,
            Constraint::Link(_) => tokens.link,
            Constraint::Order(_) | Constraint::UseOrder(_) => tokens.ordering,
            Constraint::Upper(_) => tokens.path,
            Constraint::Lower(_) | Constraint::Departure(_) => tokens.text_muted,
        };
        if has_cycle { color.gamma_multiply(0.4) } else { color }
    }

    fn edge(&self, edge: usize, has_cycle: bool, is_pointed: bool) {
        let points = self.curve(edge);
        let edge = &self.graph.edges[edge];
        let color = self.color(edge, has_cycle);
        let strong = edge.is_in_cycle || self.is_new(edge) || self.is_selected(edge) || is_pointed;
        let stroke = Stroke::new(if strong { 2.4 } else { 1.1 }, color);
        let dashed = matches!(edge.constraint, Constraint::Lower(_)) && !edge.is_in_cycle;
        if dashed {
            self.painter.extend(Shape::dashed_line(&points, stroke, 5.0, 3.0));
        } else {
            self.painter.add(Shape::line(points.clone(), stroke));
        }
        self.arrow(edge.to, &points, color);
    }

    /// The arrow's head, where the curve meets the box that it leads to, or ends beside it.
    fn arrow(&self, to: usize, points: &[Pos2], color: Color32) {
        let Some((tip, along)) = tip(self.frame(to).expand(1.0), points) else { return };
        let length = (7.0 * self.view.zoom() as f32).clamp(4.0, 9.0);
        let back = tip - along * length;
        let side = along.rot90() * length * 0.42;
        self.painter.add(Shape::convex_polygon(vec![tip, back + side, back - side], color, Stroke::NONE));
    }

    fn vertex(&self, vertex: usize, is_pointed: bool) {
        let tokens = self.tokens;
        let frame = self.frame(vertex);
        let it = &self.graph.vertices[vertex];
        let owner = |node: tpn::NodeId| {
            let events =
                self.network.nodes.get(node.index()).map(|node| node.events.as_slice()).unwrap_or_default();
            matches!(self.selection, Selection::Occurrence(selected) if events.iter().any(|it| it.occurrence == *selected))
        };
        let is_selected =
            it.nodes.iter().any(|&node| *self.selection == Selection::Node(node) || owner(node));
        let is_in_cycle = self
            .graph
            .edges
            .iter()
            .any(|edge| edge.is_in_cycle && (edge.from == vertex || edge.to == vertex));
        let is_new = it.nodes.iter().any(|node| self.focus.nodes.contains(node));
        let (line, width) = match (is_in_cycle, is_selected || is_pointed || is_new) {
            (true, _) => (tokens.threat, 2.0),
            (_, true) => (tokens.accent, 2.0),
            _ => (tokens.line_strong, 1.0),
        };
        let fill = if is_selected { tokens.accent_soft } else { tokens.raised };
        let round = if it.names.is_empty() { frame.height() / 2.0 } else { 6.0 };
        self.painter.rect(frame, round, fill, Stroke::new(width, line), StrokeKind::Middle);
        let font_size = size::BODY * self.view.zoom() as f32;
        if font_size < MIN_TEXT {
            return;
        }
        let lines = it.names.len() as f32;
        let pitch = (BOX_HEIGHTS.1 * self.view.zoom()) as f32;
        for (line, name) in it.names.iter().enumerate() {
            let font = FontId::proportional(legible(font_size));
            let mut job = egui::text::LayoutJob::simple_singleline(name.clone(), font, tokens.text);
            job.wrap = egui::text::TextWrapping::truncate_at_width(frame.width() - 4.0);
            let galley = self.painter.layout_job(job);
            let middle = frame.center() + vec2(0.0, (line as f32 - (lines - 1.0) / 2.0) * pitch);
            self.painter.galley(middle - galley.size() / 2.0, galley, tokens.text);
        }
    }

    /// The weight of an edge on its curve, where it covers nothing else; `degrees` says of how many edges each vertex is an
    /// where they end.
    fn weight(&self, edge: usize, has_cycle: bool, degrees: &[usize], taken: &mut Vec<Rect>) {
        let font_size = ((size::SMALL + 1.0) * self.view.zoom() as f32).min(14.0);
        if font_size < MIN_TEXT {
            return;
        }
        let points = self.curve(edge);
        let edge = &self.graph.edges[edge];
        let color = self.color(edge, has_cycle);
        let text = time_text::time(edge.weight);
        let font = FontId::proportional(legible(font_size));
        let galley = self.painter.layout_no_wrap(text, font, color);
        // Forward and backward edges lie side by side: their weights stand at different places along them.
        let first = if edge.weight > Time::ZERO { 0.42 } else { 0.58 };
        let (from, to) = (degrees[edge.from], degrees[edge.to]);
        let places = if from >= to + CROWD {
            [0.72, 0.62, 0.82, 0.5, 0.42, 0.34, 0.26, 0.18]
        } else if to >= from + CROWD {
            [0.28, 0.38, 0.18, 0.5, 0.58, 0.66, 0.74, 0.82]
        } else {
            [first, 0.5, 0.34, 0.66, 0.26, 0.74, 0.18, 0.82]
        };
        for along in places {
            let place = Align2::CENTER_CENTER.anchor_size(at_fraction(&points, along), galley.size());
            let fits = taken.iter().all(|other| !other.intersects(place));
            if fits {
                self.painter.rect_filled(place.expand2(vec2(3.0, 0.0)), 3.0, self.tokens.surface);
                self.painter.galley(place.min, galley, color);
                taken.push(place.expand2(vec2(3.0, 0.0)));
                return;
            }
        }
    }

    /// An edge on the screen, as a line of many points.
    fn curve(&self, edge: usize) -> Vec<Pos2> {
        let way: Vec<Point> = self.arranged.ways.get(edge).cloned().unwrap_or_default();
        let mut points = Vec::new();
        for (index, pair) in way.windows(2).enumerate() {
            let (from, to) = (pair[0], pair[1]);
            // Level at the places it passes, so that a long edge is one smooth curve.
            let bend = (to.x - from.x) * 0.5;
            for step in usize::from(index > 0)..=12 {
                let along = step as f64 / 12.0;
                let keep = 1.0 - along;
                let x = from.x * keep.powi(3)
                    + 3.0 * (from.x + bend) * keep * keep * along
                    + 3.0 * (to.x - bend) * keep * along * along
                    + to.x * along.powi(3);
                let y = from.y * keep.powi(3)
                    + 3.0 * from.y * keep * keep * along
                    + 3.0 * to.y * keep * along * along
                    + to.y * along.powi(3);
                points.push(self.view.screen_point(self.panel, Point::new(x, y)));
            }
        }
        points
    }
}

/// The point of a line that is so far along it.
fn at_fraction(points: &[Pos2], fraction: f32) -> Pos2 {
    let length: f32 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    let mut rest = length * fraction;
    for pair in points.windows(2) {
        let part = pair[0].distance(pair[1]);
        if rest <= part && part > 0.0 {
            return pair[0] + (pair[1] - pair[0]) * (rest / part);
        }
        rest -= part;
    }
    points.last().copied().unwrap_or(Pos2::ZERO)
}

fn distance_to_segment(point: Pos2, from: Pos2, to: Pos2) -> f32 {
    let along = to - from;
    let length = along.length_sq();
    let at = if length > 0.0 { ((point - from).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
    point.distance(from + along * at)
}

/// Returns where a curve ends that leads to a box, and its direction there: where it enters the box, or its last point
/// if it stops short of it. Nothing of a curve without length.
fn tip(frame: Rect, points: &[Pos2]) -> Option<(Pos2, Vec2)> {
    let enters = points.windows(2).find(|pair| !frame.contains(pair[0]) && frame.contains(pair[1]));
    let Some(enters) = enters else {
        let last = points.windows(2).rfind(|pair| pair[0] != pair[1])?;
        return Some((last[1], (last[1] - last[0]).normalized()));
    };
    // The point on the frame, by halving.
    let (mut outside, mut inside) = (enters[0], enters[1]);
    for _ in 0..8 {
        let middle = outside + (inside - outside) / 2.0;
        if frame.contains(middle) { inside = middle } else { outside = middle }
    }
    Some((outside, (enters[1] - enters[0]).normalized()))
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn every_curve_has_its_arrow_also_where_it_stops_short_of_the_box() {
        let frame = Rect::from_min_max(pos2(10.0, 0.0), pos2(20.0, 10.0));
        let (tip_in, along) = tip(frame, &[pos2(0.0, 5.0), pos2(15.0, 5.0)]).expect("it enters");
        assert!((tip_in.x - 10.0).abs() < 0.1 && along == vec2(1.0, 0.0));
        let short = [pos2(0.0, 5.0), pos2(8.0, 5.0), pos2(8.0, 5.0)];
        assert_eq!(tip(frame, &short), Some((pos2(8.0, 5.0), vec2(1.0, 0.0))));
        assert_eq!(tip(frame, &[pos2(3.0, 3.0), pos2(3.0, 3.0)]), None);
    }
}
