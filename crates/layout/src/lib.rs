//! Drawings of plan networks, automata, timelines and maps: where everything is, and the display list of it.
//!
//! Drawings are computed, never stored: the same network gives the same drawing everywhere, in time linear in its
//! size. Each is built once, by a function of [`list`], into a display list; the screen, files and reports are made from
//! that.

pub mod automaton;
pub mod drawing;
pub mod list;
pub mod machine;
pub mod metrics;
pub mod options;
pub mod overlay;
pub mod progress;
pub mod style;
pub mod text;
pub mod threads;
pub mod timeline;

mod across;
mod caption;
mod contents;
mod emit;
mod fit;
mod folding;
mod joints;
mod layered;
mod place;
mod recover;
mod rows;
mod size;
mod tree;

pub use automaton::{AutomatonDrawing, AutomatonItem, automaton};
pub use drawing::{
    ArcShape, BlockForm, BlockShape, Connector, Item, NetworkDrawing, NodeShape, Route, Shape, Slide,
    TextShape,
};
pub use fit::{MIN_TEXT, Range, Room, fitted, openings};
pub use list::automaton::{AutomatonState, automaton_list};
pub use list::network::{NetworkState, network_list};
pub use machine::{MachineArc, MachineArcShape, MachineDrawing, machine};
pub use metrics::TextRole;
pub use options::{Detail, Finer, Options, Written};
pub use overlay::{OverlayCurve, OverlayKind};
pub use progress::Progress;
pub use style::Parts;
pub use tree::block_children;

use display::{Measure, Rect};
use smol_str::{SmolStr, format_smolstr};
use tpn::{Network, NodeId, Role};

use crate::contents::Contents;
use crate::folding::Folding;
use crate::text::{ArcTexts, text_width};
use crate::tree::Tree;

/// Draws a network from left to right, as time flows.
///
/// With blocks it follows the program: sequences on a line, branches below each other, and bounds over what they span,
/// without crossings. Without blocks the same structure is recovered from the graph as far as there is any.
/// `measure` gives the width of a text at [`display::text::TEXT_SIZE`]. Linear in the network, but for the irregular rest of
/// a network without blocks.
pub fn network(network: &Network, options: &Options, measure: &dyn Measure) -> NetworkDrawing {
    if network.nodes.is_empty() {
        return NetworkDrawing::default();
    }
    let contents = Contents::new(network);
    let tree = tree_of(network, &contents, options);
    let texts = ArcTexts::new(network, options, measure);
    finish(network, &contents, &tree, &texts, options)
}

/// The structure of a network, folded as the options say.
fn tree_of(network: &Network, contents: &Contents, options: &Options) -> Tree {
    let root = network.root.filter(|root| root.index() < network.blocks.len());
    let folded = root.and_then(|root| {
        tree::tree_from_blocks(network, root, Folding::new(network, contents, options, root))
    });
    folded.unwrap_or_else(|| recover::tree_from_graph(network))
}

/// Draws a network whose structure and texts are known.
fn finish(
    network: &Network,
    contents: &Contents,
    tree: &Tree,
    texts: &ArcTexts<'_>,
    options: &Options,
) -> NetworkDrawing {
    let sizes = size::Sizes::new(network, contents, tree, texts, options);
    let hidden_nodes = tree.folding.hidden_nodes(network, contents);
    let mut placer = place::Placer::new(network, tree, sizes, &hidden_nodes);
    placer.place();
    let (mut drawing, collapsed_ends) = placer.finish();
    across::add_arcs_across(network, tree, texts, &hidden_nodes, &collapsed_ends, &mut drawing);
    write_node_names(network, texts.measure, &mut drawing);
    drawing.bounds = place::content_bounds(&drawing);
    drawing.index = drawing.indexed();
    drawing
}

/// Returns what is written inside a node: its number, `D1` for a decision, `s` and `e` for the first and the last
/// event; nothing in the dot of a fork or join.
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
fn write_node_names(network: &Network, measure: &dyn Measure, drawing: &mut NetworkDrawing) {
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
