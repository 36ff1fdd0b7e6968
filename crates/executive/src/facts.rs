//! A network with what has happened so far, for planning again (SPEC 6.2): executed events keep their times, all
//! others come later, and the world's news replace what the program said.

use exact::{Bound, Rational, Time};
use rmpl::program::{Change, LabelMode};
use smol_str::format_smolstr;
use tpn::{
    Arc, ArcId, ArcKind, Choice, DecisionId, EventRef, Extent, Label, LabelId, Literal, Network, Node,
    NodeId, Occurrence, OccurrenceId, OccurrenceKind, Plan, ResourceId, Role, Use, UseId, ValueId, ValueSet,
    VariableId,
};

/// What has happened and what is known at a moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facts {
    pub now: Time,
    /// Nodes of the program's network that have happened.
    pub happened: Vec<(NodeId, Time)>,
    /// Path vertices that were passed; they are appended to the network, so they are known by their event.
    pub passed: Vec<(EventRef, Time)>,
    /// Occurrences that take this long.
    pub durations: Vec<(OccurrenceId, Time)>,
    /// Conditions that begin at this time.
    pub begins: Vec<(OccurrenceId, Time)>,
    /// Values that the world gave to variables that last, and when.
    pub states: Vec<(VariableId, ValueId, Time)>,
    /// By how much levels changed that no one planned to change, and when.
    pub levels: Vec<(ResourceId, Rational, Time)>,
    /// Traverses whose driven distance is known: `levels` has how much less than the maximum they take, or how much more.
    pub driven: Vec<OccurrenceId>,
    /// What activities that said to set something have brought about instead.
    pub outcomes: Vec<(LabelId, ValueId)>,
    /// The alternatives that were given up while they ran.
    pub taken_back: Vec<TakenBack>,
    /// Where vehicles stand that no activity of a plan has brought there.
    pub places: Vec<StandingPlace>,
}

/// An alternative that was given up while it ran (SPEC 15).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TakenBack {
    /// The alternative.
    pub choice: Choice,
    /// When all of it is over: the others begin no earlier.
    pub since: Time,
}

/// Where a vehicle stands that stopped on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandingPlace {
    /// Index into the program's world.
    pub vehicle: u32,
    /// Meters east and north.
    pub place_m: [f64; 2],
    pub since: Time,
}

/// A lower bound that binds nothing: no mission is longer. Not more than that, for times are counted in ticks as fine as all
/// that is known of a run, and have to fit into 64 bits.
const LONG: i64 = 1 << 30;

impl Facts {
    /// `network` with these facts. `num_program_nodes` is how many nodes the program's own network has.
    ///
    /// Facts are arcs from each node back to the start: only those of selected nodes count, so alternatives that are
    /// not taken stay open. A decision that was taken is settled by its alternative: the others would begin too late.
    pub fn apply(&self, network: &Network, num_program_nodes: usize) -> Network {
        let mut changed = network.clone();
        for &(occurrence, duration) in &self.durations {
            set_duration(&mut changed, occurrence, duration);
        }
        for &(label, value) in &self.outcomes {
            set_outcome(&mut changed, label, value);
        }
        let mut times = vec![None; network.nodes.len()];
        for &(node, time) in &self.happened {
            if let Some(slot) = times.get_mut(node.index()) {
                *slot = Some(time);
            }
        }
        for (index, node) in network.nodes.iter().enumerate() {
            for &(event, time) in &self.passed {
                if node.events.contains(&event) {
                    times[index] = Some(time);
                }
            }
        }
        for used in &mut changed.uses {
            let is_over = times.get(used.end.index()).is_some_and(Option::is_some);
            let is_driven = used.owner.is_some_and(|owner| self.driven.contains(&owner));
            if is_over || (is_driven && used.change == Change::Consumes) {
                used.amount = used.counted();
                used.at_least = used.amount;
            }
        }
        for &(occurrence, _) in &self.begins {
            free_start(&mut changed, occurrence, &times);
        }
        free_paths(&mut changed, &times);
        for (index, (time, described)) in times.iter().zip(&network.nodes).enumerate() {
            let node = NodeId::from_index(index);
            let is_vertex = index >= num_program_nodes;
            if node == network.start || described.role == Role::Decision {
                continue;
            }
            match *time {
                Some(time) => add_back_arc(&mut changed, node, time, time),
                // A vertex that was not reported lies between others that are held.
                None if is_vertex => {}
                None => add_back_arc(&mut changed, node, self.now, Time::from(LONG)),
            }
        }
        self.hold_natures(&mut changed, &times);
        for taken_back in &self.taken_back {
            take_back(&mut changed, *taken_back);
        }
        for &(occurrence, time) in &self.begins {
            let start = changed.occurrences[occurrence.index()].start;
            if times[start.index()].is_none() {
                add_back_arc(&mut changed, start, time.max(self.now), time.max(self.now));
            }
        }
        for &(variable, value, at) in &self.states {
            add_state(&mut changed, variable, value, at);
        }
        for &(resource, by, at) in &self.levels {
            add_level(&mut changed, resource, by, at);
        }
        changed
    }

    /// Returns how many events of the world's own a network with these facts ends with.
    pub fn num_world_events(&self) -> usize {
        self.states.len() + self.levels.len()
    }

    /// The world's own events in a network with these facts, and when they happened.
    pub fn world_nodes(&self, network: &Network) -> impl Iterator<Item = (Time, NodeId)> + '_ {
        let first = network.nodes.len() - self.num_world_events();
        let times = self.states.iter().map(|&(.., at)| at).chain(self.levels.iter().map(|&(.., at)| at));
        times.enumerate().map(move |(index, at)| (at, NodeId::from_index(first + index)))
    }

    /// A network and its plan without what these facts have added to it; what they say of durations stays.
    pub fn remove(&self, network: &mut Network, plan: &mut Plan) {
        let num_nodes = network.nodes.len() - self.num_world_events();
        let is_own =
            |arc: &Arc| arc.to != network.start && arc.from.index() < num_nodes && arc.to.index() < num_nodes;
        let num_arcs = network.arcs.iter().rposition(is_own).map_or(0, |last| last + 1);
        let num_labels = network.labels.len() - self.states.len();
        let num_uses = network.uses.len() - self.levels.len();
        network.nodes.truncate(num_nodes);
        network.arcs.truncate(num_arcs);
        network.labels.truncate(num_labels);
        network.uses.truncate(num_uses);
        network.occurrences.truncate(network.occurrences.len() - self.num_world_events());
        for node in &mut network.nodes {
            node.out_arcs.retain(|arc| arc.index() < num_arcs);
            node.in_arcs.retain(|arc| arc.index() < num_arcs);
        }
        let is_label = |label: LabelId| label.index() < num_labels;
        let is_use = |used: UseId| used.index() < num_uses;
        plan.selected_nodes.truncate(num_nodes);
        plan.windows.truncate(num_nodes);
        plan.selected_arcs.truncate(num_arcs);
        plan.causal_links.retain(|link| is_label(link.ask) && is_label(link.tell));
        for orders in [&mut plan.conflict_order, &mut plan.orderings_added] {
            orders.retain(|order| is_label(order.first) && is_label(order.then));
        }
        for order in &mut plan.state_order {
            order.producers.retain(|&label| is_label(label));
        }
        plan.uses_ordered.retain(|order| is_use(order.first) && is_use(order.then));
    }
}

impl Facts {
    /// Of a duration that the environment chooses what is over is known, and of one under way how long it takes at least.
    fn hold_natures(&self, network: &mut Network, times: &[Option<Time>]) {
        for arc in network.arcs.iter_mut().filter(|arc| arc.is_contingent) {
            let Some(began) = times[arc.from.index()] else { continue };
            let ended = times[arc.to.index()];
            let Some(lasted) = ended.unwrap_or(self.now).checked_sub(began) else { continue };
            if ended.is_some() {
                (arc.lower, arc.upper) = (lasted, Bound::Finite(lasted));
            } else if Bound::Finite(lasted) <= arc.upper {
                arc.lower = arc.lower.max(lasted);
            }
        }
    }
}

/// A label gives another value than the text says.
fn set_outcome(network: &mut Network, label: LabelId, value: ValueId) {
    let Some(label) = network.labels.get_mut(label.index()) else { return };
    let variable = &network.variables[label.literal.variable.index()];
    let Some(name) = variable.values.get(value.index()) else { return };
    label.text = format_smolstr!("{}={name}", variable.name);
    label.literal.values = ValueSet::In(vec![value]);
}

/// Holds `node` to come between `earliest` and `latest` after the start.
fn add_back_arc(network: &mut Network, node: NodeId, earliest: Time, latest: Time) {
    // Nothing comes before the start, and what is not negative has an opposite that fits.
    let back = |time: Time| time.max(Time::ZERO).checked_neg().unwrap_or_default();
    let (lower, upper) = (back(latest), back(earliest));
    let start = network.start;
    add_arc(network, [node, start], lower, upper);
}

/// Holds the second of two nodes to come between `lower` and `upper` after the first.
fn add_arc(network: &mut Network, [from, to]: [NodeId; 2], lower: Time, upper: Time) {
    network.connect(Arc::bare(from, to, (lower, Bound::Finite(upper)), ArcKind::Span));
}

/// An event of the world at a time that has come, with an arc that begins at it. Planning takes it as one more event that
/// keeps its time; nothing else is tied to it.
fn add_world_event(network: &mut Network, at: Time) -> (NodeId, ArcId, OccurrenceId) {
    let node = NodeId::from_index(network.nodes.len());
    network.nodes.push(Node { role: Role::Event, ..Node::default() });
    let start = network.start;
    add_arc(network, [start, node], at, at);
    let back = ArcId::from_index(network.arcs.len());
    add_back_arc(network, node, at, at);
    let owner = OccurrenceId::from_index(network.occurrences.len());
    let count = network.occurrences.iter().filter(|it| it.activity == WORLD).count() + 1;
    network.occurrences.push(Occurrence {
        name: format_smolstr!("{WORLD}#{count}"),
        activity: WORLD.into(),
        kind: OccurrenceKind::Scope,
        start: node,
        end: node,
        arc: None,
        arguments: Vec::new(),
        parent: None,
        aborts: None,
        span: None,
    });
    (node, back, owner)
}

/// Who does what disturbances do, in explanations.
const WORLD: &str = "the-world";

/// A variable that lasts has a value from a time on.
fn add_state(network: &mut Network, variable: VariableId, value: ValueId, at: Time) {
    let (_, arc, owner) = add_world_event(network, at);
    let of = &network.variables[variable.index()];
    let text = format_smolstr!("{}={}", of.name, of.values[value.index()]);
    let id = LabelId::from_index(network.labels.len());
    network.labels.push(Label {
        arc,
        mode: LabelMode::Tell,
        extent: Extent::Start,
        literal: Literal { variable, values: ValueSet::In(vec![value]) },
        text,
        owner: Some(owner),
        span: None,
    });
    network.arcs[arc.index()].labels.push(id);
}

/// A level changes by so much.
fn add_level(network: &mut Network, resource: ResourceId, by: Rational, at: Time) {
    let (node, arc, owner) = add_world_event(network, at);
    let change = if by.is_negative() { Change::Consumes } else { Change::Produces };
    let amount = if by.is_negative() { by.checked_neg().unwrap_or_default() } else { by };
    network.uses.push(Use {
        resource,
        change,
        amount,
        at_least: amount,
        per_meter: Rational::ZERO,
        arc,
        start: node,
        end: node,
        owner: Some(owner),
        level: None,
        span: None,
    });
}

fn set_duration(network: &mut Network, occurrence: OccurrenceId, duration: Time) {
    if let Some(arc) = network.occurrences[occurrence.index()].arc {
        let arc = &mut network.arcs[arc.index()];
        (arc.lower, arc.upper) = (duration, Bound::Finite(duration));
    }
    // How it divides among the segments of a path is not known.
    for arc in network.arcs.iter_mut().filter(|arc| arc.kind == ArcKind::Path) {
        if arc.occurrence == Some(occurrence) {
            (arc.lower, arc.upper) = (Time::ZERO, Bound::Infinite);
        }
    }
}

/// Vertices of a path guide a vehicle: of a traverse under way what was passed is known, and the rest has no deadlines.
fn free_paths(network: &mut Network, times: &[Option<Time>]) {
    for arc in network.arcs.iter_mut().filter(|arc| arc.kind == ArcKind::Path) {
        let Some(began) = times[arc.from.index()] else { continue };
        arc.upper = Bound::Infinite;
        if let Some(took) = times[arc.to.index()].and_then(|ended| ended.checked_sub(began)) {
            arc.lower = arc.lower.min(took);
        }
    }
}

/// An alternative is excluded, and the others of its decision may begin later than the decision.
fn take_back(network: &mut Network, TakenBack { choice, since }: TakenBack) {
    let Some(decision) = network.decisions.get(choice.decision.index()) else { return };
    for (alternative, arc) in (0..).zip(decision.alternatives.clone()) {
        let is_given_up = alternative == choice.alternative;
        let arc = &mut network.arcs[arc.index()];
        // All events are held to come long before that.
        let lower = if is_given_up { Time::from(2 * LONG) } else { Time::ZERO };
        (arc.lower, arc.upper) = (lower, Bound::Infinite);
        let to = arc.to;
        if !is_given_up {
            add_back_arc(network, to, since, Time::from(LONG));
        }
    }
}

/// Lets a condition of the world begin as late as it does: what ties it to what comes before it in its branch, up to the
/// delay, the fork or the decision there, lasts as long as it takes. What is not tied to it waits for nothing.
fn free_start(network: &mut Network, occurrence: OccurrenceId, times: &[Option<Time>]) {
    let mut pending = vec![network.occurrences[occurrence.index()].start];
    while let Some(node) = pending.pop() {
        for id in network.nodes[node.index()].in_arcs.clone() {
            let Arc { from, kind, choice, .. } = network.arcs[id.index()];
            let is_freed = match kind {
                ArcKind::Delay | ArcKind::Glue | ArcKind::Fork => true,
                ArcKind::Choice => choice.is_some_and(|choice| !is_decided_otherwise(network, choice, times)),
                _ => false,
            };
            if is_freed {
                let arc = &mut network.arcs[id.index()];
                (arc.lower, arc.upper) = (Time::ZERO, Bound::Infinite);
            }
            if kind == ArcKind::Glue {
                pending.push(from);
            }
        }
    }
}

/// Returns whether another alternative of a decision has started: only what begins with its decision is still excluded
/// then.
fn is_decided_otherwise(
    network: &Network,
    (decision, alternative): (DecisionId, u32),
    times: &[Option<Time>],
) -> bool {
    let num_alternatives = network.decisions[decision.index()].alternatives.len() as u32;
    let mut others = (0..num_alternatives).filter(|&other| other != alternative);
    others.any(|other| {
        let own = network.own_nodes(decision, other);
        own.iter().zip(times).any(|(is_own, time)| *is_own && time.is_some())
    })
}
