//! The orderings that planning added, as ways from one interval's end to the start of another.
//!
//! A way between rows leaves upright, runs level just above the lower of the two rows, where no texts are, and arrives
//! upright. Ways that would run over each other run side by side, and one that would pass through another event passes
//! beside it.

use std::collections::BTreeMap;

use display::{Piece, Point, Rect};
use tpn::{Network, NodeId, Plan, precedence};

use super::{OverlayCurve, OverlayKind, are_in_one_box, curve, free_curve};
use crate::Shape;
use crate::drawing::NetworkDrawing;
use crate::metrics::EVENT_RADIUS;

/// How far above the line of a row its texts end.
const ABOVE_ROW: f64 = 27.0;
/// Radius of the corners of a way between rows.
const CORNER: f64 = 9.0;
/// How far apart ways run side by side, and how many do.
const TRACKS: (f64, usize) = (6.0, 4);
/// How far beside an event a way passes it.
const BESIDE: f64 = 8.0;

/// The orderings that planning added: from the first interval's end to the other's start. Those of the uses of resources
/// are numbered after those of conditions. What follows from others is left out: of intervals that exclude each other
/// there are as many as pairs, and one after each says the same.
pub fn orderings(drawing: &NetworkDrawing, network: &Network, plan: &Plan) -> Vec<OverlayCurve> {
    let of_labels = plan.orderings_added.iter().map(|ordering| {
        let is_known = [ordering.first, ordering.then].iter().all(|it| it.index() < network.labels.len());
        is_known.then(|| (network.interval(ordering.first).1, network.interval(ordering.then).0))
    });
    let of_uses = plan.uses_ordered.iter().map(|ordering| {
        let is_known = [ordering.first, ordering.then].iter().all(|it| it.index() < network.uses.len());
        let precedence = is_known.then(|| ordering.precedence(network))?;
        Some((precedence.earlier, precedence.later))
    });
    let pairs =
        |orderings: &mut dyn Iterator<Item = [usize; 2]>| precedence::needed(&orderings.collect::<Vec<_>>());
    let labels = &mut plan.orderings_added.iter().map(|it| [it.first.index(), it.then.index()]);
    let uses = &mut plan.uses_ordered.iter().map(|it| [it.first.index(), it.then.index()]);
    let is_needed = [pairs(labels), pairs(uses)].concat();
    let ways = of_labels.chain(of_uses).enumerate().filter_map(|(number, ends)| {
        let (from, to) = ends.filter(|_| is_needed[number])?;
        (!are_in_one_box(drawing, from, to)).then_some((number as u32, [from, to]))
    });
    let ways: Vec<(u32, [NodeId; 2])> = ways.collect();
    let tracks = tracks(drawing, &ways.iter().map(|(_, ends)| *ends).collect::<Vec<_>>());
    let curves = ways.iter().zip(tracks).map(|(&(number, [from, to]), track)| {
        along_track(drawing, OverlayKind::Ordering, number, [from, to], track)
    });
    curves.collect()
}

/// A curve from node to node: between the rows where they are on different ones, below a shared one.
pub(super) fn between_nodes(
    drawing: &NetworkDrawing,
    kind: OverlayKind,
    number: u32,
    from: NodeId,
    to: NodeId,
) -> OverlayCurve {
    along_track(drawing, kind, number, [from, to], 0)
}

/// Returns which of the tracks above its lower row each way takes, so that those that have one in common do not meet as
/// far as there are tracks.
fn tracks(drawing: &NetworkDrawing, ways: &[[NodeId; 2]]) -> Vec<usize> {
    let spans = ways.iter().enumerate().filter_map(|(at, ends)| {
        let [from, to] = ends.map(|node| drawing.anchor(node));
        is_between_rows(from, to).then(|| {
            let row = (from.y.max(to.y) * 4.0).round() as i64;
            (row, from.x.min(to.x), from.x.max(to.x), at)
        })
    });
    let mut spans: Vec<(i64, f64, f64, usize)> = spans.collect();
    spans.sort_by(|one, other| one.0.cmp(&other.0).then(one.1.total_cmp(&other.1)).then(one.3.cmp(&other.3)));
    let mut found = vec![0; ways.len()];
    // Where the last way of each track ends, in the rows.
    let mut ends: BTreeMap<i64, [f64; TRACKS.1]> = BTreeMap::new();
    for (row, left, right, at) in spans {
        let taken = ends.entry(row).or_insert([f64::NEG_INFINITY; TRACKS.1]);
        let free = taken.iter().position(|&end| end + CORNER < left);
        let least = || (0..TRACKS.1).min_by(|&one, &other| taken[one].total_cmp(&taken[other])).unwrap_or(0);
        let track = free.unwrap_or_else(least);
        taken[track] = taken[track].max(right);
        found[at] = track;
    }
    found
}

fn is_between_rows(from: Point, to: Point) -> bool {
    (to.y - from.y).abs() >= ABOVE_ROW + EVENT_RADIUS
}

fn along_track(
    drawing: &NetworkDrawing,
    kind: OverlayKind,
    number: u32,
    [from, to]: [NodeId; 2],
    track: usize,
) -> OverlayCurve {
    let radius = |node: NodeId| {
        let of_box = || drawing.box_of(node).map(|hiding| hiding.rect.height() / 2.0);
        drawing.node(node).map(|shape| shape.radius).or_else(of_box).unwrap_or_default()
    };
    let (source, target) = (drawing.anchor(from), drawing.anchor(to));
    if !is_between_rows(source, target) {
        let (start, piece) = free_curve(source, radius(from), target, radius(to));
        return curve(kind, number, start, vec![piece]);
    }
    let run = source.y.max(target.y) - ABOVE_ROW - TRACKS.0 * track as f64;
    // Drawn from above to below, and turned round where it goes the other way.
    let is_downwards = target.y > source.y;
    let [above, below] = if is_downwards { [from, to] } else { [to, from] };
    let upper = drawing.anchor(above);
    let is_blocked = drawing.node(above).is_some() && passes_event(drawing, upper, run, [above, below]);
    // What leaves passes others at their right, what arrives at their left.
    let side = if is_downwards { 1.0 } else { -1.0 };
    let aside = if is_blocked { side * (radius(above) + BESIDE) } else { 0.0 };
    let (start, pieces) = downwards(upper, radius(above), aside, run, drawing.anchor(below), radius(below));
    let (start, pieces) = if is_downwards { (start, pieces) } else { super::reversed(start, &pieces) };
    curve(kind, number, start, pieces)
}

/// Returns whether a line down from an event passes through others.
fn passes_event(drawing: &NetworkDrawing, from: Point, down_to: f64, but: [NodeId; 2]) -> bool {
    let line = Rect { min: from, max: Point::new(from.x, down_to) };
    let mut is_found = false;
    drawing.visit(line, 0.0, &mut |shape| {
        if let Shape::Node(at) = shape {
            is_found |= !but.contains(&drawing.nodes[at as usize].id);
        }
    });
    is_found
}

/// A way from a place in an upper row, `aside` of it where something is below it, to one in a lower row.
fn downwards(
    from: Point,
    from_radius: f64,
    aside: f64,
    run: f64,
    to: Point,
    to_radius: f64,
) -> (Point, Vec<Piece>) {
    let leg = from.x + aside;
    let across = if to.x > leg { 1.0 } else { -1.0 };
    let corner = ((to.x - leg).abs() / 2.0).min(CORNER);
    let mut pieces = Vec::with_capacity(6);
    let start = if aside == 0.0 {
        from.shifted(0.0, from_radius)
    } else {
        // From the rim, halfway to its bottom.
        let reach = from_radius * std::f64::consts::FRAC_1_SQRT_2;
        let start = from.shifted(reach * aside.signum(), reach);
        let turn = Point::new(leg, start.y + (leg - start.x).abs());
        pieces.push(Piece::Cubic(start.lerp(turn, 0.5), Point::new(leg, start.y), turn));
        start
    };
    pieces.extend([
        Piece::Line(Point::new(leg, run - corner)),
        Piece::Cubic(Point::new(leg, run), Point::new(leg, run), Point::new(leg + corner * across, run)),
        Piece::Line(Point::new(to.x - corner * across, run)),
        Piece::Cubic(Point::new(to.x, run), Point::new(to.x, run), Point::new(to.x, run + corner)),
        Piece::Line(to.shifted(0.0, -to_radius)),
    ]);
    (start, pieces)
}
