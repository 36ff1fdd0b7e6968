//! What of a plan has happened at a moment of its earliest schedule, for drawings that show the present.

use display::geometry::{Piece, Point, first_part};
use exact::{Bound, Time};
use tpn::{ArcId, Network, NodeId, Plan};

use crate::drawing::NetworkDrawing;

/// What has happened, and what is under way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Progress {
    /// Events that have happened, in the order of their ids.
    pub done: Vec<NodeId>,
    /// Constraints between an event that has happened and one that has not, with the part of the time between the two
    /// that has gone by.
    pub under_way: Vec<(ArcId, f64)>,
}

impl Progress {
    /// The progress of a plan at `now`, in mission units, when everything happens as early as it can. Linear in the
    /// network.
    pub fn at(network: &Network, plan: &Plan, now: f64) -> Self {
        let time =
            |node: NodeId| plan.windows.get(node.index()).copied().flatten().map(|it| it.earliest.to_f64());
        let nodes = (0..network.nodes.len()).map(NodeId::from_index);
        let done = nodes.filter(|&node| time(node).is_some_and(|time| time <= now)).collect();
        let part = |(index, arc): (usize, &tpn::Arc)| {
            let is_selected = plan.selected_arcs.get(index) == Some(&true);
            // Connections without a duration of their own are never under way.
            let lasts = arc.upper != Bound::Finite(Time::ZERO);
            let (from, to) = time(arc.from).zip(time(arc.to)).filter(|_| is_selected && lasts)?;
            (from <= now && now < to).then(|| (ArcId::from_index(index), (now - from) / (to - from)))
        };
        Self { done, under_way: network.arcs.iter().enumerate().filter_map(part).collect() }
    }
}

/// The part of an arc's curve that time has passed, `fraction` of it; `None` for an arc that is not drawn.
pub fn elapsed(drawing: &NetworkDrawing, arc: ArcId, fraction: f64) -> Option<(Point, Vec<Piece>)> {
    let shape = drawing.arc(arc)?;
    Some((shape.start, first_part(shape.start, drawing.pieces(shape), fraction)))
}
