//! The check of a plan (SPEC 5.5): its selection, its constraints, its links, its orders and its windows.

use std::collections::{BTreeMap, BTreeSet};

use exact::{Bound, Time};
use num_integer::Integer as _;
use rmpl::program::LabelMode;
use tpn::{ArcId, CausalLink, LabelId, Network, NodeId, Ordering, Plan, Window};

use crate::distance::{Distances, Edge};
use crate::labels::{self, interval};
use crate::selection;
use crate::{Rule, Verdict, Violation, node_name};

/// Checks `plan` against `network` from the definitions.
///
/// Time is about O((edges + conflicts) · log nodes) after the consistency check, with one row of distances for each
/// conflicting interval that neither the windows nor an added constraint already order.
///
/// ```
/// let parsed = rmpl::parse("scenario Day[0,60] = { Drive()[20,30] }");
/// let (network, _warnings) = tpn::compile(&parsed.program(), &tpn::Top::Scenario(None));
/// let network = network.expect("nothing in it is an error");
/// let stated = |latest: u32| {
///     serde_json::json!({
///         "choices": {}, "activities": ["Drive#1"],
///         "causal_links": [], "conflict_order": [], "orderings_added": [],
///         "windows": { "Drive#1.start": [0, 0], "Drive#1.end": [20, latest] },
///     })
/// };
/// let plan = tpn::plan_json::plan_from_json(&network, &stated(30))?;
/// assert!(verify::check_plan(&network, &plan).valid);
/// let plan = tpn::plan_json::plan_from_json(&network, &stated(31))?;
/// assert_eq!(verify::check_plan(&network, &plan).violations[0].rule, verify::Rule::Window);
/// # Ok::<(), tpn::plan_json::PlanError>(())
/// ```
pub fn check_plan(network: &Network, plan: &Plan) -> Verdict {
    if let Err(verdict) = selection::check_form(network, plan) {
        return verdict;
    }
    let mut violations = Vec::new();
    selection::check_selection(network, plan, &mut violations);
    check_links(network, plan, &mut violations);
    if !violations.is_empty() {
        return Verdict::new(violations);
    }
    let Some(constraints) = Constraints::new(network, plan) else {
        let message = "the bounds are too large, or their denominators too different, to be checked exactly";
        return Verdict::new(vec![Violation::new(Rule::Form, message)]);
    };
    match Distances::new(network.nodes.len(), constraints.edges.clone()) {
        Err(cycle) => violations.push(constraints.describe_cycle(network, &cycle)),
        Ok(distances) => {
            let checker = Checker::new(network, plan, &constraints, distances);
            checker.check_containment(&mut violations);
            checker.check_conflicts(&mut violations);
            checker.check_windows(&mut violations);
        }
    }
    Verdict::new(violations)
}

/// Every selected Ask has exactly one link, to a selected Tell that supports it.
fn check_links(network: &Network, plan: &Plan, violations: &mut Vec<Violation>) {
    let mut linked: BTreeMap<LabelId, u32> = BTreeMap::new();
    for link in &plan.causal_links {
        let (ask, tell) = (&network.labels[link.ask.index()], &network.labels[link.tell.index()]);
        let names = vec![network.label_name(link.ask), network.label_name(link.tell)];
        *linked.entry(link.ask).or_default() += 1;
        let wrong = if ask.mode != LabelMode::Ask || tell.mode != LabelMode::Tell {
            Some("a causal link leads from an assertion to a requirement")
        } else if !labels::is_selected(network, plan, link.ask)
            || !labels::is_selected(network, plan, link.tell)
        {
            Some("a causal link joins intervals that are not selected")
        } else if !tell.literal.supports(&ask.literal) {
            Some("the assertion does not make the requirement hold")
        } else {
            None
        };
        if let Some(wrong) = wrong {
            let message = format!("{wrong}: {} and {}", names[1], names[0]);
            violations.push(Violation::new(Rule::Support, message).with_intervals(names));
        }
    }
    for label in labels::selected(network, plan) {
        if network.labels[label.index()].mode != LabelMode::Ask {
            continue;
        }
        let name = network.label_name(label);
        let message = match linked.get(&label) {
            None => format!("nothing is linked to {name}"),
            Some(1) => continue,
            Some(count) => format!("{name} has {count} causal links"),
        };
        violations.push(Violation::new(Rule::Support, message).with_intervals(vec![name]));
    }
}

/// What put an edge into the distance graph.
#[derive(Clone, Copy)]
enum Reason {
    Arc(ArcId),
    Link(CausalLink),
    Order(Ordering),
}

/// The plan's temporal constraints as edges over integers: times multiplied by the common denominator.
struct Constraints {
    edges: Vec<Edge>,
    /// What each constraint is, by the edges' `reason`.
    reasons: Vec<Reason>,
    scale: i128,
    gap: i128,
}

impl Constraints {
    /// `None` if the exact numbers do not fit.
    fn new(network: &Network, plan: &Plan) -> Option<Self> {
        let bounds = network.arcs.iter().flat_map(|arc| [Some(arc.lower), arc.upper.finite()]);
        let mut scale: i128 = 1;
        for time in bounds.flatten().chain([network.threat_gap]) {
            scale = scale.lcm(&i128::from(time.denominator()));
            // Bounds have 63 bits and sums have as many terms as there are nodes; this leaves room for both.
            if scale > 1 << 40 {
                return None;
            }
        }
        let mut made = Self { edges: Vec::new(), reasons: Vec::new(), scale, gap: 0 };
        made.gap = made.scaled(network.threat_gap);
        for (index, arc) in network.arcs.iter().enumerate() {
            if plan.selected_arcs[index] {
                let upper = arc.upper.finite().map(|upper| made.scaled(upper));
                made.add(
                    arc.from,
                    arc.to,
                    made.scaled(arc.lower),
                    upper,
                    Reason::Arc(ArcId::from_index(index)),
                );
            }
        }
        for &link in &plan.causal_links {
            let (ask, tell) = (interval(network, link.ask), interval(network, link.tell));
            made.add(tell.start, ask.start, 0, None, Reason::Link(link));
            made.add(ask.end, tell.end, 0, None, Reason::Link(link));
        }
        for &ordering in &plan.orderings_added {
            let (first, then) = (interval(network, ordering.first), interval(network, ordering.then));
            made.add(first.end, then.start, made.gap, None, Reason::Order(ordering));
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

    fn describe_cycle(&self, network: &Network, cycle: &[Edge]) -> Violation {
        let reasons: Vec<String> =
            cycle.iter().map(|edge| describe(network, self.reasons[edge.reason as usize])).collect();
        let events = cycle.iter().map(|edge| node_name(network, NodeId(edge.from))).collect();
        let message = format!("these constraints contradict each other: {}", reasons.join("; "));
        Violation::new(Rule::Temporal, message).with_events(events)
    }
}

fn describe(network: &Network, reason: Reason) -> String {
    match reason {
        Reason::Arc(arc) => {
            let arc = &network.arcs[arc.index()];
            let (from, to) = (node_name(network, arc.from), node_name(network, arc.to));
            format!("{from} to {to} takes [{},{}]", Bound::Finite(arc.lower), arc.upper)
        }
        Reason::Link(link) => {
            format!("{} lies inside {}", network.label_name(link.ask), network.label_name(link.tell))
        }
        Reason::Order(order) => {
            format!("{} comes before {}", network.label_name(order.first), network.label_name(order.then))
        }
    }
}

struct Checker<'plan> {
    network: &'plan Network,
    plan: &'plan Plan,
    scale: i128,
    gap: i128,
    distances: Distances,
    /// Per node: the latest time after the start, if bounded.
    latest: Vec<Option<i128>>,
    /// Per node: minus the earliest time after the start, if bounded.
    earliest: Vec<Option<i128>>,
}

impl<'plan> Checker<'plan> {
    fn new(
        network: &'plan Network,
        plan: &'plan Plan,
        constraints: &Constraints,
        distances: Distances,
    ) -> Self {
        let latest = distances.row(network.start.0);
        let earliest =
            distances.column(network.start.0).into_iter().map(|distance| distance.map(|to| -to)).collect();
        Self { network, plan, scale: constraints.scale, gap: constraints.gap, distances, latest, earliest }
    }

    /// Whether `later − earlier ≥ least` in every schedule.
    fn is_entailed(&self, earlier: NodeId, later: NodeId, least: i128) -> bool {
        if let (Some(at_least), Some(at_most)) = (self.earliest[later.index()], self.latest[earlier.index()])
            && at_least - at_most >= least
        {
            return true;
        }
        self.distances.between(later.0, earlier.0).is_some_and(|distance| distance <= -least)
    }

    fn check_containment(&self, violations: &mut Vec<Violation>) {
        for link in &self.plan.causal_links {
            let (ask, tell) = (interval(self.network, link.ask), interval(self.network, link.tell));
            if !self.is_entailed(tell.start, ask.start, 0) || !self.is_entailed(ask.end, tell.end, 0) {
                let names = vec![self.network.label_name(link.ask), self.network.label_name(link.tell)];
                let message = format!("{} is not always inside {}", names[0], names[1]);
                violations.push(Violation::new(Rule::Support, message).with_intervals(names));
            }
        }
    }

    /// `before` of SPEC 5.3.
    fn is_before(&self, first: LabelId, then: LabelId, added: &BTreeSet<(LabelId, LabelId)>) -> bool {
        if added.contains(&(first, then)) {
            return true;
        }
        let (first, then) = (interval(self.network, first), interval(self.network, then));
        let least = if first.is_instant { self.gap } else { 0 };
        self.is_entailed(first.end, then.start, least)
    }

    fn check_conflicts(&self, violations: &mut Vec<Violation>) {
        let network = self.network;
        let selected = labels::selected(network, self.plan);
        let added: BTreeSet<(LabelId, LabelId)> =
            self.plan.orderings_added.iter().map(|ordering| (ordering.first, ordering.then)).collect();
        let said: BTreeSet<(LabelId, LabelId)> =
            self.plan.conflict_order.iter().map(|ordering| (ordering.first, ordering.then)).collect();
        let mut stated = said.clone();
        let mut complain = |message: String, (one, other): (LabelId, LabelId)| {
            let names = vec![network.label_name(one), network.label_name(other)];
            violations.push(Violation::new(Rule::Conflict, message).with_intervals(names));
        };
        for (one, other) in labels::conflicting_pairs(network, &selected) {
            let (one_name, other_name) = (network.label_name(one), network.label_name(other));
            let directions = (stated.remove(&(one, other)), stated.remove(&(other, one)));
            if network.labels[one.index()].arc == network.labels[other.index()].arc {
                complain(format!("{one_name} and {other_name} are on the same arc"), (one, other));
                continue;
            }
            let (first, then) = match directions {
                (true, false) => (one, other),
                (false, true) => (other, one),
                (true, true) => {
                    complain(format!("{one_name} and {other_name} are ordered both ways"), (one, other));
                    continue;
                }
                (false, false) => {
                    complain(
                        format!("the plan does not say which of {one_name} and {other_name} is first"),
                        (one, other),
                    );
                    continue;
                }
            };
            if !self.is_before(first, then, &added) {
                let (first_name, then_name) = (network.label_name(first), network.label_name(then));
                complain(
                    format!("{first_name} may overlap {then_name}, which it is said to precede"),
                    (first, then),
                );
            }
        }
        for (first, then) in stated {
            let (first_name, then_name) = (network.label_name(first), network.label_name(then));
            complain(
                format!("{first_name} and {then_name} are ordered, but do not conflict or are not selected"),
                (first, then),
            );
        }
        for ordering in &self.plan.orderings_added {
            // Intervals of no length at one instant are each before the other: then the stated order, which has been
            // looked at above, may be the other one.
            let is_said = said.contains(&(ordering.first, ordering.then))
                || said.contains(&(ordering.then, ordering.first));
            if !is_said {
                let (first, then) = (network.label_name(ordering.first), network.label_name(ordering.then));
                complain(
                    format!("{first} was put before {then}, which the order of conflicts does not say"),
                    (ordering.first, ordering.then),
                );
            }
        }
    }

    fn check_windows(&self, violations: &mut Vec<Violation>) {
        for (index, window) in self.plan.windows.iter().enumerate() {
            let node = NodeId::from_index(index);
            let expected = if self.plan.selected_nodes[index] { self.window(index) } else { None };
            // Plans that are read back have windows only where events have names.
            let is_unreported = window.is_none() && self.network.nodes[index].events.is_empty();
            if *window == expected || is_unreported {
                continue;
            }
            let name = node_name(self.network, node);
            let message = format!("the window of {name} is {}, not {}", show(expected), show(*window));
            violations.push(Violation::new(Rule::Window, message).with_events(vec![name]));
        }
    }

    /// The exact window of a node; `None` if nothing bounds it from below or the numbers do not fit.
    fn window(&self, index: usize) -> Option<Window> {
        let time = |scaled: i128| Time::from_wide(scaled, self.scale);
        let earliest = time(self.earliest[index]?)?;
        let latest = match self.latest[index] {
            Some(latest) => Bound::Finite(time(latest)?),
            None => Bound::Infinite,
        };
        Some(Window { earliest, latest })
    }
}

fn show(window: Option<Window>) -> String {
    match window {
        Some(window) => format!("[{},{}]", Bound::Finite(window.earliest), window.latest),
        None => "absent".to_owned(),
    }
}
