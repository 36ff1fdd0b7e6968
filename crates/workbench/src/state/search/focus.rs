//! What a step of the search is about: the events, constraints, conditions and places of the text that panels mark
//! while the step is looked at.

use kirk::{Constraint, Departing, Event, Member, Reason, ReplayStep, Trace, TreeChoice};
use rmpl::Span;
use tpn::{ArcId, DecisionId, LabelId, Network, NodeId, UseId, UseOrdering};

use crate::state::selection::Selection;

/// What a step is about.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Focus {
    /// Whether the search has just met a failure.
    pub is_failure: bool,
    pub nodes: Vec<NodeId>,
    pub arcs: Vec<ArcId>,
    pub labels: Vec<LabelId>,
    /// Where these are written.
    pub spans: Vec<Span>,
}

/// Returns whether a step tells what the search does: a choice, a failure, what follows from it. The others only
/// prepare it.
pub fn is_key(event: &Event) -> bool {
    !matches!(event, Event::Expand { .. } | Event::AddArc { .. } | Event::Propagate { .. })
}

impl Focus {
    /// Returns what a reason why there is no plan is about.
    pub fn of_reason(network: &Network, reason: &Reason) -> Self {
        let mut focus = Self { is_failure: true, ..Self::default() };
        for member in &reason.conflict {
            match *member {
                Member::Bound(constraint) => focus.add_constraint(network, constraint),
                Member::Condition(label) => focus.add_label(network, label),
                Member::Use(used) => focus.add_uses(network, &[used]),
            }
        }
        focus.add_choices(
            network,
            reason.choices.iter().map(|choice| TreeChoice::Decision {
                decision: choice.decision,
                alternative: choice.alternative,
            }),
        );
        focus
    }

    /// Returns what the step of `trace` that was replayed as `step` is about.
    pub fn of(network: &Network, trace: &Trace, step: &ReplayStep) -> Self {
        let mut focus = Self::default();
        let Some(entry) = trace.events.get(step.step) else { return focus };
        focus.is_failure = is_failure(&entry.event);
        // That bounds were propagated is about the constraint that was just added.
        let before = step.step.checked_sub(1).and_then(|before| trace.events.get(before));
        let event = match (&entry.event, before) {
            (Event::Propagate { .. }, Some(before)) => &before.event,
            (event, _) => event,
        };
        match event {
            Event::Expand { node } => focus.add_node(network, *node),
            Event::Decide { decision, alternative } => {
                focus.add_alternative(network, *decision, *alternative);
            }
            Event::AddArc { arc } => focus.add_arc(network, *arc),
            Event::Inconsistent { cycle } => {
                for member in cycle {
                    focus.add_constraint(network, member.constraint);
                }
            }
            Event::Unclosable { ask } => focus.add_label(network, *ask),
            Event::TryLink { link } => focus.add_labels(network, [link.tell, link.ask]),
            Event::Threat { left, right } | Event::Unresolvable { left, right } => {
                focus.add_labels(network, [*left, *right]);
            }
            Event::TryOrder { order } => focus.add_labels(network, [order.first, order.then]),
            Event::Backtrack { to } | Event::Backjump { to, .. } => {
                let choice = trace.tree.get(*to as usize).and_then(|state| state.choice);
                focus.add_choices(network, choice);
            }
            Event::TryUseOrder { order } => focus.add_uses(network, &[order.first, order.then]),
            Event::TryStart { used, .. } => focus.add_uses(network, &[*used]),
            Event::Imply { choice, .. } => focus.add_choices(network, [*choice]),
            Event::NoAlternative { decision } => {
                let node = network.decisions.get(decision.index()).map(|decision| decision.node);
                if let Some(node) = node {
                    focus.add_node(network, node);
                }
            }
            Event::Unsharable { uses } | Event::Overload { uses } => focus.add_uses(network, uses),
            Event::OutOfRange { early, .. } => focus.add_uses(network, early),
            Event::NotBetter { choices }
            | Event::Clash { choices }
            | Event::Uncontrollable { choices }
            | Event::Circle { orders: choices }
            | Event::Known { choices }
            | Event::Learn { choices } => focus.add_choices(network, choices.iter().copied()),
            Event::Keep { orders, uses } => {
                focus.add_choices(network, orders.iter().map(|&order| TreeChoice::Order(order)));
                focus.add_choices(network, uses.iter().map(|&order| TreeChoice::UseOrder(order)));
            }
            Event::Propagate { .. }
            | Event::Solution { .. }
            | Event::Exhausted
            | Event::Begin(_)
            | Event::NoRoomForGap
            | Event::Restart
            | Event::Bound { .. }
            | Event::Visit { .. }
            | Event::Improve { .. } => {}
        }
        focus.spans.sort_unstable();
        focus.spans.dedup();
        focus
    }

    fn add_node(&mut self, network: &Network, id: NodeId) {
        let Some(node) = network.nodes.get(id.index()) else { return };
        self.nodes.push(id);
        let decision = node.decision.and_then(|decision| network.decisions.get(decision.index()));
        let occurrence = node.events.first().and_then(|it| network.occurrences.get(it.occurrence.index()));
        match (decision, occurrence) {
            (Some(decision), _) => self.spans.extend(decision.span),
            (None, Some(occurrence)) => self.spans.extend(occurrence.span),
            (None, None) => {}
        }
    }

    fn add_alternative(&mut self, network: &Network, id: DecisionId, alternative: u32) {
        let Some(decision) = network.decisions.get(id.index()) else { return };
        self.nodes.push(decision.node);
        self.arcs.extend(decision.alternatives.get(alternative as usize));
        self.spans.extend(decision.alternative_spans.get(alternative as usize));
    }

    fn add_arc(&mut self, network: &Network, id: ArcId) {
        let Some(arc) = network.arcs.get(id.index()) else { return };
        self.arcs.push(id);
        let occurrence = arc.occurrence.and_then(|it| network.occurrences.get(it.index()));
        self.spans.extend(arc.span.or_else(|| occurrence?.span));
    }

    fn add_labels(&mut self, network: &Network, ids: [LabelId; 2]) {
        for id in ids {
            self.add_label(network, id);
        }
    }

    fn add_choices(&mut self, network: &Network, choices: impl IntoIterator<Item = TreeChoice>) {
        for choice in choices {
            match choice {
                TreeChoice::Decision { decision, alternative } => {
                    self.add_alternative(network, decision, alternative);
                }
                TreeChoice::Link(link) => self.add_labels(network, [link.tell, link.ask]),
                TreeChoice::Order(order) => self.add_labels(network, [order.first, order.then]),
                TreeChoice::NoLink { ask } => self.add_label(network, ask),
                TreeChoice::UseOrder(order) => self.add_uses(network, &[order.first, order.then]),
                TreeChoice::Start { used, .. } | TreeChoice::Later { used, .. } => {
                    self.add_uses(network, &[used]);
                }
                TreeChoice::Apart => {}
                TreeChoice::Departure(Departing { movement, before }) => {
                    self.add_labels(network, [before, movement]);
                }
            }
        }
    }

    fn add_uses(&mut self, network: &Network, uses: &[UseId]) {
        for used in uses.iter().filter_map(|used| network.uses.get(used.index())) {
            self.arcs.push(used.arc);
            let owner = used.owner.and_then(|owner| network.occurrences.get(owner.index()));
            self.spans.extend(owner.and_then(|owner| owner.span).or(used.span));
        }
    }

    fn add_label(&mut self, network: &Network, id: LabelId) {
        let Some(label) = network.labels.get(id.index()) else { return };
        self.labels.push(id);
        self.arcs.push(label.arc);
        self.spans.extend(label.span);
    }

    fn add_constraint(&mut self, network: &Network, constraint: Constraint) {
        match constraint {
            Constraint::Lower(arc) | Constraint::Upper(arc) => self.add_arc(network, arc),
            Constraint::Link(link) => self.add_labels(network, [link.tell, link.ask]),
            Constraint::Order(order) => self.add_labels(network, [order.first, order.then]),
            Constraint::UseOrder(order) => self.add_uses(network, &[order.first, order.then]),
            Constraint::Departure(departing) => {
                self.add_choices(network, [TreeChoice::Departure(departing)]);
            }
        }
    }
}

/// Returns whether an event is a failure.
pub fn is_failure(event: &Event) -> bool {
    matches!(
        event,
        Event::Inconsistent { .. }
            | Event::Unclosable { .. }
            | Event::Unresolvable { .. }
            | Event::Known { .. }
            | Event::NoAlternative { .. }
            | Event::Unsharable { .. }
            | Event::NotBetter { .. }
            | Event::Clash { .. }
            | Event::Uncontrollable { .. }
            | Event::Circle { .. }
            | Event::NoRoomForGap
    )
}

/// Returns what the other panels select when a state of the search is clicked: what was chosen there.
pub fn selection_of(network: &Network, choice: Option<TreeChoice>) -> Selection {
    match choice {
        None | Some(TreeChoice::Apart) => Selection::None,
        Some(TreeChoice::Decision { decision, alternative }) => Selection::Alternative(decision, alternative),
        Some(TreeChoice::Link(link)) => Selection::Link(link),
        Some(TreeChoice::Order(order)) => Selection::Ordering(order),
        Some(TreeChoice::NoLink { ask }) => Selection::Label(ask),
        Some(
            TreeChoice::UseOrder(UseOrdering { then: used, .. })
            | TreeChoice::Start { used, .. }
            | TreeChoice::Later { used, .. },
        ) => {
            let owner = network.uses.get(used.index()).and_then(|used| used.owner);
            owner.map_or(Selection::None, Selection::Occurrence)
        }
        Some(TreeChoice::Departure(departing)) => Selection::Label(departing.movement),
    }
}

/// Returns whether a state of the search is about what is selected: the choice itself, its decision, or a condition
/// that the choice links or orders.
pub fn concerns(choice: Option<TreeChoice>, selection: &Selection, network: &Network) -> bool {
    let Some(choice) = choice else { return false };
    let owns = |label: LabelId| match selection {
        Selection::Label(selected) => *selected == label,
        Selection::Occurrence(selected) => {
            network.labels.get(label.index()).is_some_and(|label| label.owner == Some(*selected))
        }
        Selection::Arc(arc) => network.labels.get(label.index()).is_some_and(|label| label.arc == *arc),
        _ => false,
    };
    match (choice, selection) {
        (_, Selection::None) => false,
        (TreeChoice::Decision { decision, .. }, Selection::Decision(selected)) => decision == *selected,
        (TreeChoice::Decision { decision, .. }, Selection::Node(node)) => {
            network.decisions.get(decision.index()).is_some_and(|decision| decision.node == *node)
        }
        (TreeChoice::Decision { decision, alternative }, Selection::Occurrence(selected)) => {
            let decision = network.decisions.get(decision.index());
            let alternative = decision.and_then(|it| it.alternative_spans.get(alternative as usize));
            let occurrence = network.occurrences.get(selected.index()).and_then(|it| it.span);
            alternative.zip(occurrence).is_some_and(|(outer, inner)| outer.contains(inner))
        }
        (TreeChoice::Link(link), _) if owns(link.ask) || owns(link.tell) => true,
        (TreeChoice::Order(order), _) if owns(order.first) || owns(order.then) => true,
        (TreeChoice::NoLink { ask }, _) if owns(ask) => true,
        (TreeChoice::UseOrder(order), Selection::Occurrence(selected)) => {
            let is_theirs =
                |used: &UseId| network.uses.get(used.index()).is_some_and(|it| it.owner == Some(*selected));
            [order.first, order.then].iter().any(is_theirs)
        }
        _ => selection_of(network, Some(choice)) == *selection,
    }
}
