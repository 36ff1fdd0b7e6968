//! The lines that join an arc to its events where these stand in other rows.

use std::collections::{BTreeMap, BTreeSet};

use display::{Piece, Point};
use tpn::{ArcId, Network, NodeId};

use crate::drawing::{ArcShape, Connector, NetworkDrawing};

/// Places that are no further apart are one.
const NEAR: f64 = 0.5;

/// The connectors of the events of some arcs.
pub(crate) struct Joints<'a> {
    drawing: &'a NetworkDrawing,
    network: &'a Network,
    of: BTreeMap<NodeId, Vec<&'a Connector>>,
}

impl<'a> Joints<'a> {
    /// One pass over the connectors of the drawing.
    pub(crate) fn new(
        drawing: &'a NetworkDrawing,
        network: &'a Network,
        arcs: impl IntoIterator<Item = ArcId>,
    ) -> Self {
        let arcs = arcs.into_iter().filter_map(|arc| network.arcs.get(arc.index()));
        let ends: BTreeSet<NodeId> = arcs.flat_map(|arc| [arc.from, arc.to]).collect();
        let mut of: BTreeMap<NodeId, Vec<&Connector>> = BTreeMap::new();
        if !ends.is_empty() {
            for connector in drawing.connectors.iter().filter(|it| ends.contains(&it.node)) {
                of.entry(connector.node).or_default().push(connector);
            }
        }
        Self { drawing, network, of }
    }

    /// The curve of an arc with the lines before and behind it that represent its events.
    pub(crate) fn way(&self, shape: &ArcShape) -> (Point, Vec<Piece>) {
        let mut start = shape.start;
        let mut pieces = self.drawing.pieces(shape).to_vec();
        let Some(arc) = self.network.arcs.get(shape.id.index()) else { return (start, pieces) };
        let joints = |node: NodeId| self.of.get(&node).map(Vec::as_slice).unwrap_or_default();
        let before = joints(arc.from);
        let mut lead = Vec::new();
        while lead.len() < before.len()
            && let Some(joint) = before.iter().find(|it| it.piece.end().distance(start) <= NEAR)
        {
            start = joint.start;
            lead.push(joint.piece);
        }
        pieces.splice(0..0, lead.into_iter().rev());
        let behind = joints(arc.to);
        for _ in behind {
            let end = pieces.last().map_or(start, |piece| piece.end());
            let Some(joint) = behind.iter().find(|it| it.start.distance(end) <= NEAR) else { break };
            pieces.push(joint.piece);
        }
        (start, pieces)
    }
}
