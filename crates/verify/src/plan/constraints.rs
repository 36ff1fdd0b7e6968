//! The temporal constraints of a plan: its selected arcs, its links and all its orderings.

use exact::{Bound, Time};
use num_integer::Integer as _;
use tpn::{ArcId, CausalLink, LabelId, Network, NodeId, Ordering, Plan, UseOrdering};

use crate::departure::{self, Movement};
use crate::distance::Edge;
use crate::instant::Step;
use crate::labels::{self, interval};
use crate::uncertainty::natures_events;
use crate::{Rule, Violation, amounts, node_name};

/// What put an edge into the distance graph.
#[derive(Clone, Copy)]
enum Reason {
    Arc(ArcId),
    Link(CausalLink),
    Order(Ordering),
    Uses(UseOrdering),
    Departure(Movement),
}

/// The plan's temporal constraints as edges over integers: times multiplied by the common denominator.
pub(super) struct Constraints {
    pub(super) edges: Vec<Edge>,
    /// What puts one event before another where both happen at one time (SPEC 10.4).
    pub(super) steps: Vec<Step>,
    /// What each constraint is, by the edges' `reason`.
    reasons: Vec<Reason>,
    pub(super) scale: i128,
    pub(super) gap: i128,
    /// By arc: its bounds, the lower one raised to what a movement takes from where it starts.
    bounds: Vec<(i128, Option<i128>)>,
}

impl Constraints {
    /// `None` if the exact numbers do not fit.
    pub(super) fn new(network: &Network, plan: &Plan) -> Option<Self> {
        let bounds = network.arcs.iter().flat_map(|arc| [Some(arc.lower), arc.upper.finite()]);
        let departures = network.departures.iter().map(|departure| departure.least);
        let mut scale: i128 = 1;
        for time in bounds.chain(departures).flatten().chain([network.threat_gap]) {
            scale = scale.lcm(&i128::from(time.denominator()));
            // Bounds have 63 bits and sums have as many terms as there are nodes; this leaves room for both.
            if scale > 1 << 40 {
                return None;
            }
        }
        let mut made = Self {
            edges: Vec::new(),
            steps: Vec::new(),
            reasons: Vec::new(),
            scale,
            gap: 0,
            bounds: Vec::new(),
        };
        made.gap = made.scaled(network.threat_gap);
        for (index, arc) in network.arcs.iter().enumerate() {
            let (lower, upper) = (made.scaled(arc.lower), arc.upper.finite().map(|upper| made.scaled(upper)));
            made.bounds.push((lower, upper));
            if plan.selected_arcs[index] {
                let reason = Reason::Arc(ArcId::from_index(index));
                made.add(arc.from, arc.to, lower, upper, reason);
                // Nothing is before the start.
                if lower >= 0 && arc.to != network.start {
                    made.put_before(arc.from, arc.to);
                }
            }
        }
        let natures = natures_events(network, &plan.selected_arcs);
        for &link in &plan.causal_links {
            let (ask, tell) = (interval(network, link.ask), interval(network, link.tell));
            made.add(ready(network, link.tell), ask.start, 0, None, Reason::Link(link));
            // What lasts need not be asserted any longer.
            if labels::is_lasting(network, link.ask) {
                made.put_before(ready(network, link.tell), ask.start);
            } else {
                made.add(ask.end, tell.end, 0, None, Reason::Link(link));
            }
        }
        for &ordering in &plan.orderings_added {
            let (earlier, later, gap) = ordered_events(network, plan, ordering);
            // Before what begins at the environment's event there is no gap (SPEC 13.1).
            let gap = if gap && !natures[later.index()] { made.gap } else { 0 };
            made.add(earlier, later, gap, None, Reason::Order(ordering));
            if labels::is_lasting(network, ordering.first) {
                made.put_before(earlier, later);
            }
        }
        for &ordering in &plan.uses_ordered {
            let (earlier, later) = ordered_moments(network, ordering);
            made.add(earlier, later, 0, None, Reason::Uses(ordering));
            made.put_before(earlier, later);
        }
        for movement in departure::of_plan(network, plan) {
            if let Some(least) = movement.least {
                let moving = interval(network, movement.arrival);
                let least = made.scaled(least);
                let arc = network.labels[movement.arrival.index()].arc;
                let lower = &mut made.bounds[arc.index()].0;
                *lower = least.max(*lower);
                made.add(moving.start, moving.end, least, None, Reason::Departure(movement));
            }
        }
        Some(made)
    }

    fn scaled(&self, time: Time) -> i128 {
        i128::from(time.numerator()) * (self.scale / i128::from(time.denominator()))
    }

    fn add(&mut self, from: NodeId, to: NodeId, lower: i128, upper: Option<i128>, reason: Reason) {
        let index = self.reasons.len() as u32;
        self.reasons.push(reason);
        self.edges.push(Edge { from: to.0, to: from.0, weight: -lower, reason: index });
        if let Some(upper) = upper {
            self.edges.push(Edge { from: from.0, to: to.0, weight: upper, reason: index });
        }
    }

    /// The constraint that was added last also says which event is first at one instant. An event is before itself anyway.
    fn put_before(&mut self, from: NodeId, to: NodeId) {
        if from != to {
            self.steps.push(Step { from, to, reason: self.reasons.len() as u32 - 1 });
        }
    }

    /// Returns what an arc takes at least, from where a movement starts.
    pub(super) fn least(&self, arc: ArcId) -> i128 {
        self.bounds[arc.index()].0
    }

    /// Returns what an arc takes at most, if anything.
    pub(super) fn greatest(&self, arc: ArcId) -> Option<i128> {
        self.bounds[arc.index()].1
    }

    /// A time as it was before scaling, if it fits.
    pub(super) fn unscaled(&self, scaled: i128) -> Option<Time> {
        Time::from_wide(scaled, self.scale)
    }

    /// Returns whether an edge is a bound of one of some arcs, which are sorted: its own, or what a movement takes at
    /// least.
    pub(super) fn is_range(&self, network: &Network, edge: &Edge, arcs: &[ArcId]) -> bool {
        let arc = match self.reasons[edge.reason as usize] {
            Reason::Arc(arc) => arc,
            Reason::Departure(movement) => network.labels[movement.arrival.index()].arc,
            Reason::Link(_) | Reason::Order(_) | Reason::Uses(_) => return false,
        };
        arcs.binary_search(&arc).is_ok()
    }

    /// Returns what put an edge there, in the author's terms; `None` for `[0,0]` between events, which only joins the
    /// program's parts.
    pub(super) fn tell(&self, network: &Network, reason: u32) -> Option<String> {
        let reason = self.reasons[reason as usize];
        if let Reason::Arc(arc) = reason {
            let arc = &network.arcs[arc.index()];
            if arc.lower.is_zero() && arc.upper == Bound::ZERO {
                return None;
            }
        }
        Some(describe(network, reason))
    }

    /// A negative cycle, in the author's terms.
    pub(super) fn describe_cycle(&self, network: &Network, cycle: &[Edge]) -> Violation {
        let reasons: Vec<String> =
            cycle.iter().map(|edge| describe(network, self.reasons[edge.reason as usize])).collect();
        let events = cycle.iter().map(|edge| node_name(network, NodeId(edge.from))).collect();
        let message = format!("these constraints are inconsistent: {}", reasons.join("; "));
        Violation::new(Rule::Temporal, message).with_events(events)
    }

    /// A cycle of events at one instant, in the author's terms.
    pub(super) fn describe_circle(&self, network: &Network, circle: &[Step]) -> Violation {
        let reasons: Vec<String> =
            circle.iter().map(|step| describe(network, self.reasons[step.reason as usize])).collect();
        let events: Vec<String> = circle.iter().map(|step| node_name(network, step.from)).collect();
        let message = format!(
            "each of {} would have to happen before the next, and the last before the first: {}",
            events.join(", "),
            reasons.join("; ")
        );
        Violation::new(Rule::Temporal, message).with_events(events)
    }
}

/// The event from which on what a label asserts holds: the end of an effect, otherwise the start.
fn ready(network: &Network, label: LabelId) -> NodeId {
    let interval = interval(network, label);
    let is_effect = network.labels[label.index()].extent == tpn::Extent::Effect;
    if is_effect { interval.end } else { interval.start }
}

/// The events that an added ordering keeps apart, and whether by the threat gap: that is for variables that do not last
/// (SPEC 5.3). A producer that is put before a requirement ends no later than the requirement's own producer is ready
/// (SPEC 10.2).
fn ordered_events(network: &Network, plan: &Plan, ordering: Ordering) -> (NodeId, NodeId, bool) {
    let earlier = interval(network, ordering.first).end;
    let later = interval(network, ordering.then).start;
    if !labels::is_lasting(network, ordering.first) {
        return (earlier, later, true);
    }
    let own = plan.causal_links.iter().find(|link| link.ask == ordering.then);
    (earlier, own.map_or(later, |link| ready(network, link.tell)), false)
}

/// The events that two ordered uses keep in order: the end and the start of uses of a reusable resource, the moments at
/// which the level of a reservoir changes (SPEC 11).
pub(super) fn ordered_moments(network: &Network, ordering: UseOrdering) -> (NodeId, NodeId) {
    let [first, then] = [ordering.first, ordering.then].map(|used| {
        // Which level is asked for says nothing of when.
        let level = network.uses[used.index()].level.map(|_| 0);
        amounts::taken(network, used, [0, 0], level)
    });
    match network.resources[network.uses[first.used.index()].resource.index()].supply {
        tpn::Supply::Reusable { .. } => (first.end, then.start),
        tpn::Supply::Reservoir { .. } => (first.last_moment(), then.moment()),
    }
}

fn describe(network: &Network, reason: Reason) -> String {
    match reason {
        Reason::Arc(arc) => {
            let arc = &network.arcs[arc.index()];
            let (from, to) = (node_name(network, arc.from), node_name(network, arc.to));
            format!("{from} to {to} takes [{},{}]", arc.lower.readable(), arc.upper.readable())
        }
        Reason::Link(link) if labels::is_lasting(network, link.ask) => {
            let (ask, tell) = (network.label_name(link.ask), network.label_name(link.tell));
            format!("{ask} must start when {tell} is ready")
        }
        Reason::Link(link) => {
            format!("{} must be inside {}", network.label_name(link.ask), network.label_name(link.tell))
        }
        Reason::Order(order) => {
            format!("{} must come before {}", network.label_name(order.first), network.label_name(order.then))
        }
        Reason::Uses(order) => {
            format!("{} must come before {}", network.use_name(order.first), network.use_name(order.then))
        }
        Reason::Departure(movement) => {
            let (arrival, before) =
                (network.label_name(movement.arrival), network.label_name(movement.before));
            let least = Bound::Finite(movement.least.unwrap_or_default());
            format!("{arrival} takes at least {least} after {before}")
        }
    }
}
