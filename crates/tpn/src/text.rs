//! Networks for people and for drawing tools: a text dump and Graphviz DOT.

use std::fmt::Write as _;

use exact::Bound;
use markup::graphviz_string;

use crate::network::{Arc, ArcId, ArcKind, Network, NodeId, Role};

/// One line for each node with the arcs that leave it below.
pub fn to_text(network: &Network) -> String {
    let mut text = format!(
        "{} nodes, {} arcs, {} decisions; start {}, end {}\n",
        network.nodes.len(),
        network.arcs.len(),
        network.decisions.len(),
        network.start.0,
        network.end.0
    );
    for (index, node) in network.nodes.iter().enumerate() {
        let role = match (node.role, node.decision) {
            (_, Some(decision)) => Network::decision_name(decision),
            (Role::Event, None) => "event".to_owned(),
            (Role::Structural | Role::Decision, None) => "structure".to_owned(),
        };
        let events: Vec<String> = node.events.iter().map(|&event| network.event_name(event)).collect();
        let _ = writeln!(text, "{index:>5} {role:<10} {}", events.join(" = "));
        for &arc in &node.out_arcs {
            let _ =
                writeln!(text, "        -> {:<5} {}", network.arcs[arc.index()].to.0, arc_text(network, arc));
        }
    }
    for constraint in network.constraints() {
        let arc = &network.arcs[constraint.index()];
        let _ = writeln!(text, "{:>5} -> {:<5} {}", arc.from.0, arc.to.0, arc_text(network, constraint));
    }
    text
}

/// Returns what is on an arc: its bounds, its labels and its activity.
fn arc_text(network: &Network, id: ArcId) -> String {
    let arc = &network.arcs[id.index()];
    let mut text = format!("{} {}", bounds_text(arc), kind_name(arc.kind));
    if let Some((decision, alternative)) = arc.choice {
        let _ = write!(text, " {} = {alternative}", Network::decision_name(decision));
    }
    if let Some(occurrence) = arc.occurrence {
        let _ = write!(text, " {}", network.occurrences[occurrence.index()].name);
    }
    for label in labels(network, arc) {
        let _ = write!(text, " {label}");
    }
    text
}

/// A drawing for Graphviz: decisions with a double outline, spans dashed.
pub fn to_dot(network: &Network) -> String {
    let mut text =
        "digraph tpn {\n  rankdir=LR;\n  node [shape=circle, fontsize=10];\n  edge [fontsize=9];\n"
            .to_owned();
    for (index, node) in network.nodes.iter().enumerate() {
        let shape = if node.role == Role::Decision { "doublecircle" } else { "circle" };
        let events: Vec<String> = node.events.iter().map(|&event| network.event_name(event)).collect();
        let tooltip = graphviz_string(&events.join(" = "));
        let name = node_title(network, NodeId::from_index(index));
        let _ = writeln!(
            text,
            "  n{index} [shape={shape}, label={}, tooltip={tooltip}];",
            graphviz_string(&name)
        );
    }
    for arc in &network.arcs {
        let mut label = bounds_text(arc);
        for condition in labels(network, arc) {
            let _ = write!(label, "\n{condition}");
        }
        if let Some(occurrence) = arc.occurrence {
            let _ = write!(label, "\n{}", network.occurrences[occurrence.index()].name);
        }
        let style = if matches!(arc.kind, ArcKind::Composite | ArcKind::Span | ArcKind::Constraint) {
            ", style=dashed"
        } else {
            ""
        };
        let _ =
            writeln!(text, "  n{} -> n{} [label={}{style}];", arc.from.0, arc.to.0, graphviz_string(&label));
    }
    text.push_str("}\n");
    text
}

fn node_title(network: &Network, node: NodeId) -> String {
    if node == network.start {
        "start".to_owned()
    } else if node == network.end {
        "end".to_owned()
    } else {
        match network.nodes[node.index()].decision {
            Some(decision) => Network::decision_name(decision),
            None => node.0.to_string(),
        }
    }
}

fn labels(network: &Network, arc: &Arc) -> Vec<String> {
    let one = |label: &crate::LabelId| {
        let label = &network.labels[label.index()];
        format!("{}({})", label.verb(), label.text)
    };
    arc.labels.iter().map(one).collect()
}

/// The bounds of an arc, and that the environment chooses within them.
fn bounds_text(arc: &Arc) -> String {
    let word = if arc.is_contingent { " contingent" } else { "" };
    format!("[{},{}]{word}", Bound::Finite(arc.lower), arc.upper)
}

/// The kind as the contracts write it.
pub fn kind_name(kind: ArcKind) -> &'static str {
    match kind {
        ArcKind::Activity => "act",
        ArcKind::Assertion => "assert",
        ArcKind::Delay => "delay",
        ArcKind::Composite => "comp",
        ArcKind::Span => "span",
        ArcKind::Point => "point",
        ArcKind::Glue => "glue",
        ArcKind::Fork => "fork",
        ArcKind::Join => "join",
        ArcKind::Choice => "choice",
        ArcKind::Merge => "merge",
        ArcKind::Path => "path",
        ArcKind::Constraint => "constraint",
    }
}
