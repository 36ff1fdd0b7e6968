//! What a plan, or its failure, adds to a drawing: curves between places on it, and texts under its nodes.

mod ordering;

use display::geometry::curve_bounds;
use display::{Measure, Piece, Point, Rect};
use serde::{Deserialize, Serialize};
use tpn::{ArcId, LabelId, Network, NodeId, Plan, Role};

use self::ordering::between_nodes;
pub use self::ordering::orderings;

use crate::drawing::{Item, NetworkDrawing, TextShape};
use crate::joints::Joints;
use crate::metrics::{TextRole, VERTEX_RADIUS};
use crate::text::{bounds_label, text_width};

/// A curve over the drawing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OverlayCurve {
    /// What it shows.
    pub kind: OverlayKind,
    /// Which one of its kind: the position in the plan's list, or the step of the cycle.
    pub number: u32,
    /// Where the curve begins.
    pub start: Point,
    pub pieces: Vec<Piece>,
    /// The curve lies inside.
    pub bounds: Rect,
}

/// What an [`OverlayCurve`] shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum OverlayKind {
    /// From the assertion that carries a requirement to that requirement.
    CausalLink,
    /// From the end of one interval to the start of the other that planning put after it.
    Ordering,
    /// A step of a negative cycle, from its event to the next.
    NegativeCycle,
    /// Between two conditions that contradict each other and cannot be kept apart.
    Threat,
}

/// What is taller than this, in drawing units, is a box and not a line of text.
const TALLEST_TEXT: f64 = 20.0;
/// Boxes that are so far apart are joined by a way between them.
const BOX_GAP: f64 = 4.0;

/// How far a curve between two places on one line hangs below it.
const SAG: (f64, f64) = (34.0, 150.0);

/// The causal links of a plan, but for those within a box that hides both ends.
pub fn causal_links(drawing: &NetworkDrawing, network: &Network, plan: &Plan) -> Vec<OverlayCurve> {
    let places = label_places(drawing, network);
    let curve = |(number, link): (usize, &tpn::CausalLink)| {
        let (from, to) = (places.get(link.tell.index())?, places.get(link.ask.index())?);
        let node = |label: LabelId| network.arcs[network.labels[label.index()].arc.index()].from;
        if from == to && are_in_one_box(drawing, node(link.tell), node(link.ask)) {
            return None;
        }
        Some(between_labels(number as u32, *from, *to))
    };
    plan.causal_links.iter().enumerate().filter_map(curve).collect()
}

/// Pairs of conditions that contradict each other and cannot be kept apart.
pub fn threats(drawing: &NetworkDrawing, network: &Network, pairs: &[[LabelId; 2]]) -> Vec<OverlayCurve> {
    let places = label_places(drawing, network);
    let curve = |(number, [one, other]): (usize, &[LabelId; 2])| {
        let (from, to) = (places.get(one.index())?, places.get(other.index())?);
        let curve = between_labels(number as u32, *from, *to);
        Some(OverlayCurve { kind: OverlayKind::Threat, ..curve })
    };
    pairs.iter().enumerate().filter_map(curve).collect()
}

/// A negative cycle, given as the events it passes; the last is followed by the first. A step along an arc, in either
/// direction, follows the arc's own curve.
pub fn negative_cycle(drawing: &NetworkDrawing, network: &Network, events: &[NodeId]) -> Vec<OverlayCurve> {
    let next = events.iter().cycle().skip(1);
    let steps: Vec<(&NodeId, &NodeId)> = events.iter().zip(next).filter(|(from, to)| from != to).collect();
    let arcs = steps
        .iter()
        .flat_map(|&(&from, &to)| [arc_between(network, from, to), arc_between(network, to, from)]);
    let joints = Joints::new(drawing, network, arcs.flatten());
    let step = |(number, &(&from, &to)): (usize, &(&NodeId, &NodeId))| {
        along_arc(drawing, network, &joints, number as u32, [from, to])
            .unwrap_or_else(|| between_nodes(drawing, OverlayKind::NegativeCycle, number as u32, from, to))
    };
    steps.iter().enumerate().map(step).collect()
}

/// The window of every visible event and decision, below it.
pub fn windows(
    drawing: &NetworkDrawing,
    plan: &Plan,
    window_width: f64,
    measure: &dyn Measure,
) -> Vec<TextShape> {
    let role = TextRole::Window;
    let text = |node: &crate::drawing::NodeShape| {
        let window = plan.windows.get(node.id.index()).copied().flatten()?;
        let text = bounds_label(window.earliest, window.latest);
        let natural = text_width(&text, role, measure);
        let width = if window_width > 0.0 { natural.min(window_width) } else { natural };
        let top = node.center.y + node.radius + 2.0;
        let left = node.center.x - width / 2.0;
        Some(TextShape {
            text,
            role,
            size: role.size() * width / natural,
            rect: Rect::new(left, top, left + width, top + role.line_height()),
            owner: Item::Node(node.id),
            slide: None,
        })
    };
    drawing
        .nodes
        .iter()
        .filter(|node| node.role != Role::Structural && node.radius > VERTEX_RADIUS)
        .filter_map(text)
        .collect()
}

/// The start and the only piece of a curve between two circles. On one line it hangs below, where the arches are not.
pub(crate) fn free_curve(from: Point, from_radius: f64, to: Point, to_radius: f64) -> (Point, Piece) {
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    let (first, second) = if dy.abs() < SAG.0 {
        let sag = (dx.abs() * 0.2).clamp(SAG.0, SAG.1);
        let reach = (dx * 0.15).clamp(-SAG.1, SAG.1);
        (from.shifted(reach, sag), to.shifted(-reach, sag))
    } else {
        let reach = (dx.abs() * 0.4).clamp(SAG.0, SAG.1);
        (from.shifted(reach, dy * 0.3), to.shifted(-reach, -dy * 0.3))
    };
    let rim = |center: Point, toward: Point, radius: f64| {
        let direction = center.direction_to(toward);
        center.shifted(direction.x * radius, direction.y * radius)
    };
    (rim(from, first, from_radius), Piece::Cubic(first, second, rim(to, second, to_radius)))
}

/// Returns whether one box hides both.
fn are_in_one_box(drawing: &NetworkDrawing, one: NodeId, other: NodeId) -> bool {
    let rect = |node| drawing.box_of(node).map(|hiding| hiding.rect);
    rect(one).is_some() && rect(one) == rect(other)
}

/// Returns where each label is written, or the box that hides it.
fn label_places(drawing: &NetworkDrawing, network: &Network) -> Vec<Rect> {
    let hidden = |label: &tpn::Label| {
        let from = network.arcs[label.arc.index()].from;
        let anchor = drawing.anchor(from);
        // What leads to a box ends at its edge: its words stay free.
        drawing.box_of(from).map_or(Rect { min: anchor, max: anchor }, |hiding| hiding.rect)
    };
    let mut places: Vec<Rect> = network.labels.iter().map(hidden).collect();
    for text in &drawing.texts {
        if let Item::Label(LabelId(label)) = text.owner
            && let Some(place) = places.get_mut(label as usize)
        {
            *place = text.rect;
        }
    }
    places
}

fn between_labels(number: u32, from: Rect, to: Rect) -> OverlayCurve {
    let (source, target) = (from.center(), to.center());
    let dy = target.y - source.y;
    let gap = dy.abs() - f64::midpoint(from.height(), to.height());
    // Between texts there is little to see of a short way; below a box a longer one would lead through it.
    let is_box = from.height().max(to.height()) > TALLEST_TEXT;
    let (start, end, first, second) = if gap < if is_box { BOX_GAP } else { SAG.0 } {
        let (start, end) = (Point::new(source.x, from.max.y), Point::new(target.x, to.max.y));
        let sag = ((target.x - source.x).abs() * 0.2).clamp(SAG.0, SAG.1);
        (start, end, start.shifted(0.0, sag), end.shifted(0.0, sag))
    } else {
        let side = |rect: Rect, downwards: bool| if downwards { rect.max.y } else { rect.min.y };
        let start = Point::new(source.x, side(from, dy > 0.0));
        let end = Point::new(target.x, side(to, dy < 0.0));
        let middle = (end.y - start.y) / 2.0;
        (start, end, start.shifted(0.0, middle), end.shifted(0.0, -middle))
    };
    curve(OverlayKind::CausalLink, number, start, vec![Piece::Cubic(first, second, end)])
}

fn arc_between(network: &Network, from: NodeId, to: NodeId) -> Option<ArcId> {
    let outgoing = &network.nodes.get(from.index())?.out_arcs;
    outgoing.iter().copied().find(|arc| network.arcs[arc.index()].to == to)
}

/// The whole way of the arc from one event to another, in either direction.
fn along_arc(
    drawing: &NetworkDrawing,
    network: &Network,
    joints: &Joints<'_>,
    number: u32,
    [from, to]: [NodeId; 2],
) -> Option<OverlayCurve> {
    let way = |from, to| {
        let shape = arc_between(network, from, to).and_then(|arc| drawing.arc(arc))?;
        Some(joints.way(shape))
    };
    let back = || way(to, from).map(|(start, pieces)| reversed(start, &pieces));
    let (start, pieces) = way(from, to).or_else(back)?;
    Some(curve(OverlayKind::NegativeCycle, number, start, pieces))
}

/// The same curve the other way.
pub(crate) fn reversed(start: Point, pieces: &[Piece]) -> (Point, Vec<Piece>) {
    let mut ends: Vec<Point> = vec![start];
    ends.extend(pieces.iter().map(|piece| piece.end()));
    let back = pieces.iter().zip(&ends).rev().map(|(piece, &from)| match *piece {
        Piece::Line(_) => Piece::Line(from),
        Piece::Cubic(first, second, _) => Piece::Cubic(second, first, from),
    });
    (ends.last().copied().unwrap_or(start), back.collect())
}

fn curve(kind: OverlayKind, number: u32, start: Point, pieces: Vec<Piece>) -> OverlayCurve {
    OverlayCurve { kind, number, start, bounds: curve_bounds(start, &pieces), pieces }
}
