//! A network as the text of a mission in RMPL that compiles to an equivalent one: the same choices, conditions and
//! bounds between the events, where its structure allows.
//!
//! The arcs have to nest (`series_parallel`); bounds beside them become bounds of blocks, or `constrain` where they
//! cover no whole block. What the notation has no words for, or would read differently, is an [`Obstacle`], never left out.

mod blocks;
mod names;
mod series_parallel;
mod write;

use exact::Bound;

use tpn::network::{ArcId, ArcKind, EventEnd, Extent, Network, NodeId};

/// What keeps a network from being written in RMPL.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Obstacle {
    /// What is in the way: after the names of the nodes and arcs, where there are any.
    pub problem: String,
    /// The events it is about.
    pub nodes: Vec<NodeId>,
    /// The arcs it is about.
    pub arcs: Vec<ArcId>,
}

impl Obstacle {
    fn at_arc(arc: ArcId, problem: &str) -> Self {
        Self { problem: problem.to_owned(), nodes: Vec::new(), arcs: vec![arc] }
    }

    fn of_network(problem: String) -> Self {
        Self { problem, nodes: Vec::new(), arcs: Vec::new() }
    }

    /// A sentence without its full stop. `nodes` and `arcs` are what the network's file calls them, where it has names.
    pub fn told(&self, network: &Network, nodes: &[Option<String>], arcs: &[Option<String>]) -> String {
        let node = |&id: &NodeId| match nodes.get(id.index()) {
            Some(Some(uid)) => format!("the node `{uid}`"),
            _ => event_name(network, id),
        };
        let arc = |&id: &ArcId| match arcs.get(id.index()) {
            Some(Some(uid)) => format!("`{uid}`"),
            _ => arc_name(network, id),
        };
        let arcs = self.arcs.iter().map(arc).collect::<Vec<_>>().join(", ");
        let nodes = self.nodes.iter().map(node).collect::<Vec<_>>().join(", ");
        match (nodes.is_empty(), arcs.is_empty()) {
            (true, true) => self.problem.clone(),
            (true, false) => format!("{arcs} {}", self.problem),
            (false, true) => format!("{nodes} {}", self.problem),
            (false, false) => format!("{nodes} {} ({arcs})", self.problem),
        }
    }
}

fn event_name(network: &Network, id: NodeId) -> String {
    match network.nodes[id.index()].events.first() {
        Some(&event) => format!("the node {} (`{}`)", id.0, network.event_name(event)),
        None => format!("the node {}", id.0),
    }
}

fn arc_name(network: &Network, id: ArcId) -> String {
    let arc = &network.arcs[id.index()];
    match arc.occurrence {
        Some(occurrence) => format!("`{}`", network.occurrences[occurrence.index()].name),
        None => format!("the arc {} from node {} to node {}", id.0, arc.from.0, arc.to.0),
    }
}

/// The text of a mission that means what `network` does, with `remarks` in comments on top.
pub fn write(network: &Network, remarks: &[String]) -> Result<String, Obstacle> {
    refuse_what_has_no_words(network)?;
    let tree = series_parallel::nested(network)?;
    let blocks = blocks::Blocks::new(network, tree)?;
    let text = write::write(network, &blocks, remarks)?;
    Ok(rmpl::format(&text))
}

/// States, resources, worth and paths: a network has them from a mission's text, and that text is what to continue with.
fn refuse_what_has_no_words(network: &Network) -> Result<(), Obstacle> {
    if let Some(state) = network.variables.iter().find(|variable| variable.is_lasting) {
        return Err(Obstacle::of_network(format!(
            "`{}` is a state variable, which keeps its value",
            state.name
        )));
    }
    if let Some(resource) = network.resources.first() {
        return Err(Obstacle::of_network(format!("the network uses the resource `{}`", resource.name)));
    }
    if !network.worths.is_empty() || !network.objective.is_empty() {
        return Err(Obstacle::of_network("the network has costs, rewards or an objective".to_owned()));
    }
    for (index, arc) in network.arcs.iter().enumerate() {
        let id = ArcId::from_index(index);
        let problem = if arc.kind == ArcKind::Path {
            "is a part of a path that was planned"
        } else if arc.kind != ArcKind::Constraint && (arc.lower.is_negative() || arc.upper < Bound::ZERO) {
            "has a negative bound"
        } else {
            continue;
        };
        return Err(Obstacle::at_arc(id, problem));
    }
    let partial = network.labels.iter().find(|label| label.extent != Extent::Arc);
    if let Some(label) = partial {
        return Err(Obstacle::at_arc(
            label.arc,
            &format!("has the condition `{}` at one instant only", label.text),
        ));
    }
    let on_path = |node: &tpn::network::Node| {
        node.events.iter().any(|event| matches!(event.end, EventEnd::PathVertex { .. }))
    };
    match network.nodes.iter().position(on_path) {
        Some(node) => Err(Obstacle {
            problem: "is a point of a path that was planned".to_owned(),
            nodes: vec![NodeId::from_index(node)],
            arcs: Vec::new(),
        }),
        None => Ok(()),
    }
}
