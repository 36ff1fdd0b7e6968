//! Networks from texts, and plans of them written out by hand. Nothing here plans.

use exact::{Bound, Rational, Time};
use rmpl::program::Change;
use tpn::plan_json::Names;
use tpn::{
    CausalLink, Choice, DecisionId, Extent, LabelId, Levels, Network, NodeId, Ordering, Plan, Quality,
    StateOrder, Supply, Top, UseId, UseOrdering, Window,
};

/// Two activities without length that need each other (case i01 of the suite).
pub const MUTUAL_SUPPORT: &str = "state X : {F, T} = F;
    state Y : {F, T} = F;
    primitive A() [0,0] requires X=T sets Y=T;
    primitive B() [0,0] requires Y=T sets X=T;
    scenario S [0,10] = { A(), B() }";

/// What comes later in a sequence cannot support what comes before it (i03).
pub const LOOK_BEFORE_OPEN: &str = "state DOOR : {OPEN, SHUT} = SHUT;
    primitive Open() [0,0] sets DOOR=OPEN;
    primitive Look() [0,0] requires DOOR=OPEN;
    scenario S [0,10] = { Look(); Open() }";

/// At 10 the store is filled and emptied (i04).
pub const PRODUCED_AS_CONSUMED: &str = "resource Bat 0..10 = 0;
    primitive A() [10,10] produces Bat 5;
    primitive B() [5,5] consumes Bat 5;
    scenario S [0,100] = { { delay [10,10]; B() }, A() }";

/// A sequence that consumes before it produces (i05).
pub const CONSUMED_FIRST: &str = "resource Bat 0..10 = 0;
    primitive P() [0,0] produces Bat 5;
    primitive C() [0,0] consumes Bat 5;
    scenario S [0,100] = { C(); P() }";

/// The network of the first scenario of `text`, which must have no errors.
pub fn network(text: &str) -> Network {
    let parsed = rmpl::parse(text);
    let (network, diagnostics) = tpn::compile(&parsed.program(), &Top::Scenario(None));
    network.unwrap_or_else(|| panic!("{text}\ndoes not compile: {:?} {diagnostics:?}", parsed.diagnostics()))
}

/// What a plan says, by the names of all output.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sketch<'names> {
    /// The alternatives taken, of D1, D2, ….
    pub choices: &'names [(u32, u32)],
    pub links: &'names [(&'names str, &'names str)],
    /// First and then.
    pub order: &'names [(&'names str, &'names str)],
    /// What gives variables that keep their values one, in order.
    pub states: &'names [&'names [&'names str]],
    /// Those of them that planning added.
    pub added: &'names [(&'names str, &'names str)],
}

/// The plan of a sketch: its selection is the closure of its choices, its windows those of its constraints. Where the
/// constraints contradict each other, and without a choice that it needs, it has no windows.
pub fn plan(network: &Network, sketch: Sketch<'_>) -> Plan {
    let mut plan = plan_without_windows(network, sketch);
    plan.windows = windows(network, &plan);
    plan
}

/// The same without its windows, for networks that are too large to work them out here.
pub fn plan_without_windows(network: &Network, sketch: Sketch<'_>) -> Plan {
    let choices: Vec<Choice> = (sketch.choices.iter())
        .map(|&(number, alternative)| Choice { decision: DecisionId(number - 1), alternative })
        .collect();
    let (selected_nodes, selected_arcs) = closure(network, &choices);
    let ordering =
        |&(first, then): &(&str, &str)| Ordering { first: label(network, first), then: label(network, then) };
    Plan {
        choices,
        selected_nodes,
        selected_arcs,
        causal_links: (sketch.links.iter())
            .map(|(ask, tell)| CausalLink { ask: label(network, ask), tell: label(network, tell) })
            .collect(),
        conflict_order: sketch.order.iter().map(ordering).collect(),
        conflict_order_omitted: 0,
        state_order: sketch.states.iter().map(|names| state_order(network, names)).collect(),
        orderings_added: sketch.added.iter().map(ordering).collect(),
        uses_ordered: Vec::new(),
        levels: Vec::new(),
        quality: Quality::default(),
        windows: vec![None; network.nodes.len()],
    }
}

fn state_order(network: &Network, names: &[&str]) -> StateOrder {
    let producers: Vec<LabelId> = names.iter().map(|name| label(network, name)).collect();
    StateOrder { variable: network.labels[producers[0].index()].literal.variable, producers }
}

/// The labeled interval of a name.
pub fn label(network: &Network, name: &str) -> LabelId {
    Names::new(network).label(name).unwrap_or_else(|problem| panic!("{problem}"))
}

/// The event of a name.
pub fn event(network: &Network, name: &str) -> NodeId {
    Names::new(network).event(name).unwrap_or_else(|problem| panic!("{problem}"))
}

/// Returns what the choices select (SPEC 3.1), node by node from the start.
pub fn closure(network: &Network, choices: &[Choice]) -> (Vec<bool>, Vec<bool>) {
    let mut nodes = vec![false; network.nodes.len()];
    let mut arcs = vec![false; network.arcs.len()];
    nodes[network.start.index()] = true;
    // As often as there are nodes is enough for any path.
    for _ in 0..network.nodes.len() {
        for (index, arc) in network.arcs.iter().enumerate() {
            let is_taken = match arc.choice {
                None => true,
                Some((decision, alternative)) => choices.contains(&Choice { decision, alternative }),
            };
            if nodes[arc.from.index()] && is_taken {
                arcs[index] = true;
                nodes[arc.to.index()] = true;
            }
        }
    }
    (nodes, arcs)
}

/// A constraint `lower ≤ to − from ≤ upper`.
#[derive(Clone, Copy, Debug)]
pub struct Constraint {
    pub from: NodeId,
    pub to: NodeId,
    pub lower: Time,
    pub upper: Bound,
}

/// The selected arcs, the links and the added orderings of a plan (SPEC 5.2, 5.3).
pub fn constraints(network: &Network, plan: &Plan) -> Vec<Constraint> {
    let mut found = Vec::new();
    for (arc, _) in network.arcs.iter().zip(&plan.selected_arcs).filter(|(_, selected)| **selected) {
        found.push(Constraint { from: arc.from, to: arc.to, lower: arc.lower, upper: arc.upper });
    }
    let mut at_least = |from: NodeId, to: NodeId, lower: Time| {
        found.push(Constraint { from, to, lower, upper: Bound::Infinite });
    };
    for link in &plan.causal_links {
        at_least(ready(network, link.tell), occupied(network, link.ask).0, time(0));
        if !is_lasting(network, link.ask) {
            at_least(occupied(network, link.ask).1, occupied(network, link.tell).1, time(0));
        }
    }
    for ordering in &plan.orderings_added {
        let (end, start) = (occupied(network, ordering.first).1, occupied(network, ordering.then).0);
        if !is_lasting(network, ordering.first) {
            at_least(end, start, network.threat_gap);
            continue;
        }
        // What is put before a requirement is over when the requirement's own producer is ready (SPEC 10.2).
        let own = plan.causal_links.iter().find(|link| link.ask == ordering.then);
        at_least(end, own.map_or(start, |link| ready(network, link.tell)), time(0));
    }
    for ordering in &plan.uses_ordered {
        let (from, to) = match network.resources[network.uses[ordering.first.index()].resource.index()].supply
        {
            Supply::Reusable { .. } => {
                (network.uses[ordering.first.index()].end, network.uses[ordering.then.index()].start)
            }
            Supply::Reservoir { .. } => (moment(network, ordering.first), moment(network, ordering.then)),
        };
        at_least(from, to, time(0));
    }
    found
}

/// The windows of the selected nodes by Floyd and Warshall's algorithm; none where the constraints contradict.
pub fn windows(network: &Network, plan: &Plan) -> Vec<Option<Window>> {
    let count = network.nodes.len();
    let mut distance: Vec<Vec<Option<Time>>> = vec![vec![None; count]; count];
    let shorten = |entry: &mut Option<Time>, through: Time| {
        *entry = Some(entry.map_or(through, |known| known.min(through)));
    };
    for (node, row) in distance.iter_mut().enumerate() {
        row[node] = Some(time(0));
    }
    for constraint in constraints(network, plan) {
        let (from, to) = (constraint.from.index(), constraint.to.index());
        shorten(&mut distance[to][from], constraint.lower.checked_neg().expect("a small time"));
        if let Bound::Finite(upper) = constraint.upper {
            shorten(&mut distance[from][to], upper);
        }
    }
    for middle in 0..count {
        for from in 0..count {
            for to in 0..count {
                if let (Some(there), Some(on)) = (distance[from][middle], distance[middle][to]) {
                    let through = there.checked_add(on).expect("a small time");
                    shorten(&mut distance[from][to], through);
                }
            }
        }
    }
    let is_consistent = (0..count).all(|node| distance[node][node] == Some(time(0)));
    let start = network.start.index();
    let window = |node: usize| {
        let earliest = distance[node][start]?.checked_neg()?;
        let latest = distance[start][node].map_or(Bound::Infinite, Bound::Finite);
        (is_consistent && plan.selected_nodes[node]).then_some(Window { earliest, latest })
    };
    (0..count).map(window).collect()
}

/// A whole number of time units.
pub fn time(units: i64) -> Time {
    Time::from(units)
}

/// A time that must be a whole number of units.
pub fn units(time: Time) -> i64 {
    assert!(time.is_integer(), "{time} is not whole");
    time.numerator()
}

/// Returns whether a label is of a state variable.
pub fn is_lasting(network: &Network, label: LabelId) -> bool {
    network.variables[network.labels[label.index()].literal.variable.index()].is_lasting
}

/// The first and the last event of what a label occupies (SPEC 10.2).
pub fn occupied(network: &Network, label: LabelId) -> (NodeId, NodeId) {
    let arc = &network.arcs[network.labels[label.index()].arc.index()];
    match network.labels[label.index()].extent {
        Extent::Arc | Extent::Effect => (arc.from, arc.to),
        Extent::Start => (arc.from, arc.from),
        Extent::Initial => (network.start, network.start),
    }
}

/// The event from which on a producer's value holds.
pub fn ready(network: &Network, label: LabelId) -> NodeId {
    let (start, end) = occupied(network, label);
    if network.labels[label.index()].extent == Extent::Effect { end } else { start }
}

/// When a use changes the level of a reservoir (SPEC 11).
pub fn moment(network: &Network, used: UseId) -> NodeId {
    let used = &network.uses[used.index()];
    if used.change == Change::Produces { used.end } else { used.start }
}

/// The use of a name.
pub fn used(network: &Network, name: &str) -> UseId {
    Names::new(network).used(name).unwrap_or_else(|problem| panic!("{problem}"))
}

/// The plan of a sketch with orderings of uses, and with what it says of resources.
pub fn plan_of_resources(
    network: &Network,
    sketch: Sketch<'_>,
    ordered: &[(&str, &str)],
    levels: &[Levels],
) -> Plan {
    let mut plan = plan(network, sketch);
    let ordering = |&(first, then): &(&str, &str)| UseOrdering {
        first: used(network, first),
        then: used(network, then),
    };
    plan.uses_ordered = ordered.iter().map(ordering).collect();
    plan.levels = levels.to_vec();
    plan.windows = windows(network, &plan);
    plan
}

/// At most this much is used at a time.
pub fn peak(amount: i64) -> Levels {
    Levels::Peak(Rational::from_integer(amount))
}

/// The level stays between these.
pub fn range(low: i64, high: i64) -> Levels {
    Levels::Range { low: Rational::from_integer(low), high: Rational::from_integer(high) }
}
