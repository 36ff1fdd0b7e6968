//! Coordinates for drawings of plan networks and automata.
//!
//! Drawings are computed, never stored: the same network gives the same drawing everywhere, in time linear in its
//! size. They are display lists without colours; the page paints them and [`svg`] exports them.

pub mod automaton;
pub mod drawing;
pub mod geometry;
pub mod look;
pub mod machine;
pub mod metrics;
pub mod options;
pub mod overlay;
pub mod palette;
pub mod progress;
pub mod svg;
pub mod text;
pub mod threads;

mod across;
mod emit;
mod index;
mod layered;
mod place;
mod recover;
mod size;
mod tree;

pub use automaton::{AutomatonDrawing, AutomatonItem, automaton, automaton_svg};
pub use drawing::{
    ArcShape, BlockForm, BlockShape, Connector, Item, NetworkDrawing, NodeShape, Route, Shape, Slide,
    TextShape,
};
pub use geometry::{Piece, Point, Rect};
pub use look::Parts;
pub use machine::{MachineArc, MachineArcShape, MachineDrawing, machine};
pub use metrics::{TextRole, approximate_text_width};
pub use options::Options;
pub use overlay::{OverlayCurve, OverlayKind};
pub use palette::Palette;
pub use progress::Progress;
pub use svg::{SvgOptions, svg};
pub use tree::block_children;

use smol_str::{SmolStr, format_smolstr};
use tpn::{Network, NodeId, Role};

use crate::text::{ArcTexts, Measure, text_width};

/// Draws a network from left to right, as time flows.
///
/// With blocks it follows the program: sequences on a line, branches below each other, and bounds over what they span,
/// without crossings. Without blocks the same structure is recovered from the graph as far as there is any.
/// `measure` gives the width of a text at [`metrics::TEXT_SIZE`]. Linear in the network, but for the irregular rest of
/// a network without blocks.
pub fn network(network: &Network, options: &Options, measure: Measure<'_>) -> NetworkDrawing {
    if network.nodes.is_empty() {
        return NetworkDrawing::default();
    }
    let tree = tree::tree_from_blocks(network, options).unwrap_or_else(|| recover::tree_from_graph(network));
    let texts = ArcTexts::new(network, options, measure);
    let sizes = size::Sizes::new(network, &tree, &texts, options, measure);
    let mut placer = place::Placer::new(network, &tree, sizes);
    placer.place();
    let (mut drawing, collapsed_ends) = placer.finish();
    across::add_arcs_across(network, &tree, &texts, &collapsed_ends, &mut drawing);
    write_node_names(network, measure, &mut drawing);
    drawing.bounds = place::content_bounds(&drawing);
    drawing.index = index::SpatialIndex::new(&drawing);
    drawing
}

/// What is written inside a node: its number, `D1` for a decision, `s` and `e` for the first and the last event;
/// nothing in the dot of a fork or join.
pub fn node_name(network: &Network, node: NodeId) -> SmolStr {
    let shape = &network.nodes[node.index()];
    match (shape.role, shape.decision) {
        (Role::Structural, _) => SmolStr::default(),
        (Role::Decision, Some(decision)) => Network::decision_name(decision).into(),
        _ if node == network.start => SmolStr::new_static("s"),
        _ if node == network.end => SmolStr::new_static("e"),
        _ => format_smolstr!("{}", node.0),
    }
}

/// Writes the names into the circles, smaller where they are long.
fn write_node_names(network: &Network, measure: Measure<'_>, drawing: &mut NetworkDrawing) {
    let role = TextRole::Node;
    for node in &drawing.nodes {
        let text = node_name(network, node.id);
        if text.is_empty() || node.radius <= metrics::VERTEX_RADIUS {
            continue;
        }
        let natural = text_width(&text, role, measure);
        let inner = node.radius - if node.role == Role::Decision { metrics::DECISION_INSET } else { 0.0 };
        let width = natural.min(2.0 * inner - 3.0);
        let size = role.size() * width / natural;
        let rect = Rect::new(
            node.center.x - width / 2.0,
            node.center.y - size / 2.0,
            node.center.x + width / 2.0,
            node.center.y + size / 2.0,
        );
        drawing.texts.push(TextShape { text, role, size, rect, owner: Item::Node(node.id), slide: None });
    }
}
