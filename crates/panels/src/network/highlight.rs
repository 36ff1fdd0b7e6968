//! Which shapes show a selection, and what a place of the drawing selects.

use display::Rect;
use layout::{Item, NetworkDrawing};
use tpn::{ArcId, LabelId, Network, NodeId, OccurrenceId, OccurrenceKind};
use workbench::state::Selection;
use workbench::state::search::Focus;

/// The shapes of one selection.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Highlight {
    /// Rings around these.
    pub(super) nodes: Vec<NodeId>,
    /// A glow behind these.
    pub(super) arcs: Vec<ArcId>,
    /// A mark behind these texts.
    pub(super) labels: Vec<LabelId>,
    /// The outline of this activity.
    pub(super) occurrence: Option<OccurrenceId>,
}

impl Highlight {
    /// The shapes of `selection`; ids that the network does not have are left out.
    pub(super) fn of(selection: &Selection, network: &Network) -> Self {
        let mut shapes = Self::default();
        match selection {
            Selection::Occurrence(id) => shapes.add_occurrence(network, *id),
            Selection::Node(id) => shapes.nodes.extend(network.nodes.get(id.index()).map(|_| *id)),
            Selection::Arc(id) => shapes.add_arc(network, *id),
            Selection::Decision(id) => {
                shapes.nodes.extend(network.decisions.get(id.index()).map(|decision| decision.node));
            }
            Selection::Alternative(id, alternative) => {
                let decision = network.decisions.get(id.index());
                let arc = decision.and_then(|it| it.alternatives.get(*alternative as usize));
                if let Some(&arc) = arc {
                    shapes.add_arc(network, arc);
                }
            }
            Selection::Label(id) => shapes.add_label(network, *id),
            Selection::Link(link) => shapes.add_labels(network, [link.tell, link.ask]),
            Selection::Ordering(ordering) => shapes.add_labels(network, [ordering.first, ordering.then]),
            Selection::Location(_) | Selection::Vehicle(_) => {
                for (index, occurrence) in network.occurrences.iter().enumerate() {
                    if selection.involves(network, OccurrenceId::from_index(index)) {
                        shapes.nodes.extend([occurrence.start, occurrence.end]);
                        shapes.arcs.extend(occurrence.arc);
                    }
                }
            }
            Selection::None | Selection::Obstacle(_) | Selection::SearchStep(_) => {}
        }
        shapes
    }

    /// The shapes that a step of the search is about.
    pub(super) fn of_focus(focus: &Focus, network: &Network) -> Self {
        let mut shapes = Self::default();
        shapes.nodes.extend(focus.nodes.iter().filter(|node| node.index() < network.nodes.len()));
        for &arc in &focus.arcs {
            shapes.add_arc(network, arc);
        }
        for &label in &focus.labels {
            shapes.add_label(network, label);
        }
        shapes
    }

    /// These shapes but for the events and arcs of others.
    pub(super) fn without(&self, other: &Self) -> Self {
        let mut rest = self.clone();
        rest.nodes.retain(|node| !other.nodes.contains(node));
        rest.arcs.retain(|arc| !other.arcs.contains(arc));
        rest
    }

    /// The area that the shapes cover on a drawing; `None` if there are none.
    pub(super) fn bounds(&self, drawing: &NetworkDrawing) -> Option<Rect> {
        let nodes = self.nodes.iter().map(|&node| {
            let at = drawing.anchor(node);
            drawing.node(node).map_or(Rect { min: at, max: at }, |shape| Rect::around(at, shape.radius))
        });
        let arcs = self.arcs.iter().filter_map(|&arc| drawing.arc(arc)).map(|arc| arc.bounds);
        nodes.chain(arcs).reduce(Rect::union)
    }

    fn add_occurrence(&mut self, network: &Network, id: OccurrenceId) {
        let Some(occurrence) = network.occurrences.get(id.index()) else { return };
        self.occurrence = Some(id);
        self.nodes.extend([occurrence.start, occurrence.end]);
        self.arcs.extend(occurrence.arc);
    }

    fn add_arc(&mut self, network: &Network, id: ArcId) {
        let Some(arc) = network.arcs.get(id.index()) else { return };
        self.arcs.push(id);
        self.nodes.extend([arc.from, arc.to]);
    }

    fn add_labels(&mut self, network: &Network, ids: [LabelId; 2]) {
        for id in ids {
            self.add_label(network, id);
        }
    }

    fn add_label(&mut self, network: &Network, id: LabelId) {
        let Some(label) = network.labels.get(id.index()) else { return };
        self.labels.push(id);
        self.add_arc(network, label.arc);
    }
}

/// The events that a selection is about where `drawing` hides all that it marks. That of a decision is also about where
/// its ways begin.
pub(super) fn wanted(selection: &Selection, network: &Network, drawing: &NetworkDrawing) -> Vec<NodeId> {
    if let Selection::Decision(id) = selection {
        let decision = network.decisions.get(id.index());
        let arcs = decision.iter().flat_map(|decision| &decision.alternatives);
        let ends = arcs.filter_map(|arc| network.arcs.get(arc.index())).map(|arc| arc.to);
        return ends.collect();
    }
    let nodes = Highlight::of(selection, network).nodes;
    if nodes.iter().any(|&node| drawing.node(node).is_some()) { Vec::new() } else { nodes }
}

/// Returns what an item of the drawing represents.
pub(super) fn selection_of(item: Item, network: &Network) -> Selection {
    match item {
        Item::Node(node) => match network.nodes.get(node.index()).and_then(|it| it.decision) {
            Some(decision) => Selection::Decision(decision),
            None => Selection::Node(node),
        },
        Item::Arc(id) => {
            let Some(arc) = network.arcs.get(id.index()) else { return Selection::None };
            match (arc.occurrence, arc.choice) {
                (Some(occurrence), _) => Selection::Occurrence(occurrence),
                (None, Some((decision, alternative))) => Selection::Alternative(decision, alternative),
                (None, None) => Selection::Arc(id),
            }
        }
        Item::Label(id) => {
            let owner = network.labels.get(id.index()).and_then(|label| label.owner);
            let is_assertion = |owner: &OccurrenceId| {
                network.occurrences.get(owner.index()).is_some_and(|it| it.kind == OccurrenceKind::Assertion)
            };
            owner.filter(is_assertion).map_or(Selection::Label(id), Selection::Occurrence)
        }
        Item::Block(id) => match network.blocks.get(id.index()).map(|block| &block.kind) {
            Some(tpn::BlockKind::Scope { occurrence: Some(occurrence), .. }) => {
                Selection::Occurrence(*occurrence)
            }
            Some(tpn::BlockKind::Choose { decision, .. }) => Selection::Decision(*decision),
            _ => Selection::None,
        },
    }
}
