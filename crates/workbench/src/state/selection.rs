//! What is selected, shared by every panel, and how it maps to the source text and back.
//!
//! A selection holds ids of one network. When a new network arrives, [`Selection::carried`] finds the same thing in it
//! by name.

use rmpl::Span;
use rmpl::program::World;
use serde_json::{Value, json};
use smol_str::SmolStr;
use snapshot::Snapshot;
use tpn::{ArcId, CausalLink, DecisionId, LabelId, Network, NodeId, OccurrenceId, Ordering};

/// The one thing that is selected in all panels.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Selection {
    #[default]
    None,
    /// An activity, assertion, delay or scenario as it occurs in the expanded program.
    Occurrence(OccurrenceId),
    /// An event of the network.
    Node(NodeId),
    /// A temporal constraint.
    Arc(ArcId),
    Decision(DecisionId),
    /// One alternative of a decision, from 0.
    Alternative(DecisionId, u32),
    /// A labeled interval.
    Label(LabelId),
    /// An assertion that carries a requirement.
    Link(CausalLink),
    /// Two conflicting intervals in their order.
    Ordering(Ordering),
    /// A named place.
    Location(SmolStr),
    Obstacle(SmolStr),
    Vehicle(SmolStr),
    /// A step of the recorded search, from 0.
    SearchStep(u32),
}

impl Selection {
    /// Returns whether nothing is selected.
    pub fn is_none(&self) -> bool {
        *self == Self::None
    }

    /// The occurrence that is selected or that what is selected belongs to.
    pub fn occurrence(&self, network: &Network) -> Option<OccurrenceId> {
        match self {
            Self::Occurrence(occurrence) => Some(*occurrence),
            Self::Node(node) => Some(network.nodes.get(node.index())?.events.first()?.occurrence),
            Self::Arc(arc) => network.arcs.get(arc.index())?.occurrence,
            Self::Label(label) => network.labels.get(label.index())?.owner,
            _ => None,
        }
    }

    /// The selected traverse, if it has a path.
    pub fn occurrence_of_path(&self, snapshot: &Snapshot) -> Option<OccurrenceId> {
        let occurrence = self.occurrence(snapshot.network.as_deref()?)?;
        snapshot.traverses.iter().any(|it| it.occurrence == occurrence).then_some(occurrence)
    }

    /// Returns whether `occurrence` is to be drawn as selected: it is selected itself, or is an end of the selected
    /// link or ordering.
    pub fn involves(&self, network: &Network, occurrence: OccurrenceId) -> bool {
        let owns = |label: LabelId| {
            network.labels.get(label.index()).and_then(|label| label.owner) == Some(occurrence)
        };
        match self {
            Self::Link(link) => owns(link.ask) || owns(link.tell),
            Self::Ordering(ordering) => owns(ordering.first) || owns(ordering.then),
            Self::Location(name) | Self::Vehicle(name) => {
                let occurrence = network.occurrences.get(occurrence.index());
                occurrence.is_some_and(|occurrence| occurrence.arguments.contains(name))
            }
            Self::Decision(_) | Self::Alternative(..) => self.is_around(network, occurrence),
            _ => self.occurrence(network) == Some(occurrence),
        }
    }

    /// Returns whether an activity is written inside the selected decision or alternative.
    fn is_around(&self, network: &Network, occurrence: OccurrenceId) -> bool {
        let outer = match self {
            Self::Decision(id) => network.decisions.get(id.index()).and_then(|decision| decision.span),
            Self::Alternative(id, alternative) => network
                .decisions
                .get(id.index())
                .and_then(|decision| decision.alternative_spans.get(*alternative as usize).copied()),
            _ => None,
        };
        let inner = network.occurrences.get(occurrence.index()).and_then(|occurrence| occurrence.span);
        outer.zip(inner).is_some_and(|(outer, inner)| outer.contains(inner))
    }

    /// Returns where the selection is written, for the editor to show.
    pub fn span(&self, snapshot: &Snapshot) -> Option<Span> {
        let world = &snapshot.program.world;
        let network = snapshot.network.as_deref();
        match self {
            Self::None | Self::SearchStep(_) => None,
            Self::Occurrence(id) => network?.occurrences.get(id.index())?.span,
            Self::Node(id) => {
                let node = network?.nodes.get(id.index())?;
                if let Some(decision) = node.decision {
                    return network?.decisions.get(decision.index())?.span;
                }
                let event = node.events.first()?;
                network?.occurrences.get(event.occurrence.index())?.span
            }
            Self::Arc(id) => network?.arcs.get(id.index())?.span,
            Self::Decision(id) => network?.decisions.get(id.index())?.span,
            Self::Alternative(id, alternative) => {
                network?.decisions.get(id.index())?.alternative_spans.get(*alternative as usize).copied()
            }
            Self::Label(id) => network?.labels.get(id.index())?.span,
            Self::Link(link) => network?.labels.get(link.ask.index())?.span,
            Self::Ordering(ordering) => network?.labels.get(ordering.first.index())?.span,
            Self::Location(name) => world.locations.iter().find(|it| it.name.text == *name).map(|it| it.span),
            Self::Obstacle(name) => world.obstacles.iter().find(|it| it.name.text == *name).map(|it| it.span),
            Self::Vehicle(name) => world.vehicles.iter().find(|it| it.name.text == *name).map(|it| it.span),
        }
    }

    /// Returns what is at a byte offset of the text: the thing with the smallest span around it.
    ///
    /// Among equals, `current` stays selected if it is one of them: the text of a definition represents all of its
    /// expansions.
    pub fn at_offset(snapshot: &Snapshot, offset: u32, current: &Self) -> Self {
        let mut best: Option<(u32, Self)> = None;
        let mut offer = |span: Option<Span>, candidate: Self| {
            let Some(span) = span.filter(|span| span.touches(offset)) else { return };
            let length = span.end.saturating_sub(span.start);
            let better = best
                .as_ref()
                .is_none_or(|(least, _)| length < *least || (length == *least && candidate == *current));
            if better {
                best = Some((length, candidate));
            }
        };
        offer_world(&snapshot.program.world, &mut offer);
        if let Some(network) = snapshot.network.as_deref() {
            offer_network(network, &mut offer);
        }
        best.map_or(Self::None, |(_, selection)| selection)
    }

    /// Its name as the contracts print it; empty for nothing.
    pub fn name(&self, network: Option<&Network>) -> String {
        let label = |network: &Network, id: LabelId| {
            network.labels.get(id.index()).map(|_| network.label_name(id)).unwrap_or_default()
        };
        match (self, network) {
            (Self::Location(name) | Self::Obstacle(name) | Self::Vehicle(name), _) => name.to_string(),
            (Self::SearchStep(step), _) => format!("step {step}"),
            (Self::Decision(id), _) => Network::decision_name(*id),
            (Self::Alternative(id, alternative), _) => {
                format!("{}={alternative}", Network::decision_name(*id))
            }
            (Self::None, _) | (_, None) => String::new(),
            (Self::Occurrence(id), Some(network)) => {
                network.occurrences.get(id.index()).map(|it| it.name.to_string()).unwrap_or_default()
            }
            (Self::Node(id), Some(network)) => node_name(network, *id),
            (Self::Arc(id), Some(network)) => arc_name(network, *id),
            (Self::Label(id), Some(network)) => label(network, *id),
            (Self::Link(link), Some(network)) => {
                format!("{} ← {}", label(network, link.ask), label(network, link.tell))
            }
            (Self::Ordering(ordering), Some(network)) => {
                format!("{} ≺ {}", label(network, ordering.first), label(network, ordering.then))
            }
        }
    }

    /// Its name for people: calls with their arguments.
    pub fn title(&self, network: Option<&Network>) -> String {
        let name = self.name(network);
        if let Some(network) = network { network.readable(&name) } else { name }
    }

    /// The kind of thing, as a word for programs.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Occurrence(_) => "occurrence",
            Self::Node(_) => "node",
            Self::Arc(_) => "arc",
            Self::Decision(_) => "decision",
            Self::Alternative(..) => "alternative",
            Self::Label(_) => "label",
            Self::Link(_) => "link",
            Self::Ordering(_) => "ordering",
            Self::Location(_) => "location",
            Self::Obstacle(_) => "obstacle",
            Self::Vehicle(_) => "vehicle",
            Self::SearchStep(_) => "search-step",
        }
    }

    /// The selection as plain JSON for a host page: `null`, or its kind, name and id.
    pub fn to_json(&self, network: Option<&Network>) -> Value {
        let id = match self {
            Self::None => return Value::Null,
            Self::Occurrence(id) => json!(id.0),
            Self::Node(id) => json!(id.0),
            Self::Arc(id) => json!(id.0),
            Self::Decision(id) => json!(id.0),
            Self::Alternative(id, alternative) => json!([id.0, alternative]),
            Self::Label(id) => json!(id.0),
            Self::Link(link) => json!([link.ask.0, link.tell.0]),
            Self::Ordering(ordering) => json!([ordering.first.0, ordering.then.0]),
            Self::SearchStep(step) => json!(step),
            Self::Location(_) | Self::Obstacle(_) | Self::Vehicle(_) => Value::Null,
        };
        json!({ "kind": self.kind(), "name": self.name(network), "id": id })
    }

    /// The thing of this name: an occurrence (`Group-Wait#1`), an event (`Group-Wait#1.start`), a decision (`D1`), a
    /// labeled interval, a location, an obstacle or a vehicle.
    pub fn by_name(snapshot: &Snapshot, name: &str) -> Option<Self> {
        if let Some(network) = snapshot.network.as_deref() {
            if let Some(found) = network.occurrences.iter().position(|it| it.name == name) {
                return Some(Self::Occurrence(OccurrenceId::from_index(found)));
            }
            let decisions = (0..network.decisions.len()).map(DecisionId::from_index);
            if let Some(found) = decisions.into_iter().find(|&id| Network::decision_name(id) == name) {
                return Some(Self::Decision(found));
            }
            if let Some(found) = network
                .nodes
                .iter()
                .position(|node| node.events.iter().any(|&event| network.event_name(event) == name))
            {
                return Some(Self::Node(NodeId::from_index(found)));
            }
            let labels = (0..network.labels.len()).map(LabelId::from_index);
            if let Some(found) = labels.into_iter().find(|&id| network.label_name(id) == name) {
                return Some(Self::Label(found));
            }
        }
        let World { locations, obstacles, vehicles, .. } = &snapshot.program.world;
        if locations.iter().any(|it| it.name.text == name) {
            return Some(Self::Location(name.into()));
        }
        if obstacles.iter().any(|it| it.name.text == name) {
            return Some(Self::Obstacle(name.into()));
        }
        vehicles.iter().any(|it| it.name.text == name).then(|| Self::Vehicle(name.into()))
    }

    /// The same thing in a newer snapshot, found by its name; nothing if it is gone.
    pub fn carried(&self, old: &Snapshot, new: &Snapshot) -> Self {
        let old_network = old.network.as_deref();
        let new_network = new.network.as_deref();
        let label = |id: LabelId| {
            let name = old_network.filter(|it| id.index() < it.labels.len())?.label_name(id);
            let network = new_network?;
            (0..network.labels.len()).map(LabelId::from_index).find(|&it| network.label_name(it) == name)
        };
        let carried = match self {
            Self::None => None,
            Self::SearchStep(step) => Some(Self::SearchStep(*step)),
            Self::Arc(id) => {
                let name = old_network.map(|network| arc_name(network, *id));
                new_network.and_then(|network| {
                    (0..network.arcs.len())
                        .map(ArcId::from_index)
                        .find(|&it| Some(arc_name(network, it)) == name)
                        .map(Self::Arc)
                })
            }
            Self::Alternative(id, alternative) => new_network
                .and_then(|network| network.decisions.get(id.index()))
                .filter(|decision| (*alternative as usize) < decision.alternatives.len())
                .map(|_| Self::Alternative(*id, *alternative)),
            Self::Label(id) => label(*id).map(Self::Label),
            Self::Link(link) => {
                label(link.ask).zip(label(link.tell)).map(|(ask, tell)| Self::Link(CausalLink { ask, tell }))
            }
            Self::Ordering(ordering) => label(ordering.first)
                .zip(label(ordering.then))
                .map(|(first, then)| Self::Ordering(Ordering { first, then })),
            _ => Self::by_name(new, &self.name(old_network)),
        };
        carried.unwrap_or_default()
    }
}

/// The name of a node: its first event, its decision, or its number.
pub fn node_name(network: &Network, id: NodeId) -> String {
    let Some(node) = network.nodes.get(id.index()) else { return String::new() };
    match (node.decision, node.events.first()) {
        (Some(decision), _) => Network::decision_name(decision),
        (None, Some(&event)) => network.event_name(event),
        (None, None) => format!("node {}", id.0),
    }
}

/// The name of a duration: of the activity, condition or delay that lasts it, or of its ends.
pub fn duration_name(network: &Network, id: ArcId) -> String {
    let occurrence = network.arcs.get(id.index()).and_then(|arc| arc.occurrence);
    match occurrence.and_then(|occurrence| network.occurrences.get(occurrence.index())) {
        Some(occurrence) => occurrence.name.to_string(),
        None => arc_name(network, id),
    }
}

/// The name of an arc: from its first event to its second.
pub fn arc_name(network: &Network, id: ArcId) -> String {
    network
        .arcs
        .get(id.index())
        .map(|arc| format!("{} → {}", node_name(network, arc.from), node_name(network, arc.to)))
        .unwrap_or_default()
}

fn offer_world(world: &World, offer: &mut impl FnMut(Option<Span>, Selection)) {
    for it in &world.locations {
        offer(Some(it.span), Selection::Location(it.name.text.clone()));
    }
    for it in &world.obstacles {
        offer(Some(it.span), Selection::Obstacle(it.name.text.clone()));
    }
    for it in &world.vehicles {
        offer(Some(it.span), Selection::Vehicle(it.name.text.clone()));
    }
}

fn offer_network(network: &Network, offer: &mut impl FnMut(Option<Span>, Selection)) {
    for (index, it) in network.occurrences.iter().enumerate() {
        offer(it.span, Selection::Occurrence(OccurrenceId::from_index(index)));
    }
    for (index, it) in network.decisions.iter().enumerate() {
        let id = DecisionId::from_index(index);
        offer(it.span, Selection::Decision(id));
    }
    for (index, it) in network.labels.iter().enumerate() {
        // An assertion's own text represents the assertion, which is an occurrence and was offered already.
        let is_assertion = it
            .owner
            .and_then(|owner| network.occurrences.get(owner.index()))
            .is_some_and(|owner| owner.arc == Some(it.arc) && owner.span.is_some() && owner.span == it.span);
        if !is_assertion {
            offer(it.span, Selection::Label(LabelId::from_index(index)));
        }
    }
}
