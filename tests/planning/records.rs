//! Records of conflict-driven searches on many small random missions: recording changes nothing, what is told is so, and
//! every step can be shown.

use std::collections::BTreeSet;

use acceptance::lasting_missions::{Kind, lasting_mission};
use acceptance::mission::compile;
use exact::{Bound, Time};
use kirk::{
    Departing, Event, Options, Outcome, Replay, ReplayStep, Search, SearchRound, Status, Trace, TreeChoice,
    TreeStatus, Unlimited,
};
use rmpl::program::Change;
use stn::{PointId, Stn};
use tpn::{
    ArcKind, CausalLink, LabelId, Network, NodeId, Ordering, Plan, Precedence, Supply, Top, UseOrdering,
};

/// Missions of each kind.
const MISSIONS: u64 = 400;

/// What a mission has beside its activities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Addition {
    Nothing,
    Objective,
    /// An objective, and a search that continues with the best open state.
    BestFirst,
    /// The environment chooses some durations.
    Nature,
}

#[test]
fn states() {
    check_all(Kind::STATES, Addition::Nothing);
}

#[test]
fn resources() {
    check_all(Kind::RESOURCES, Addition::Nothing);
}

#[test]
fn states_and_resources() {
    check_all(Kind::BOTH, Addition::Nothing);
}

#[test]
fn objectives() {
    check_all(Kind::BOTH, Addition::Objective);
}

#[test]
fn best_first() {
    check_all(Kind::BOTH, Addition::BestFirst);
    check_all(Kind::STATES, Addition::BestFirst);
}

#[test]
fn durations_that_nature_chooses() {
    check_all(Kind::STATES, Addition::Nature);
    check_all(Kind::RESOURCES, Addition::Nature);
}

fn check_all(kind: Kind, addition: Addition) {
    let (mut plans, mut learned, mut failures) = (0, 0, 0);
    for seed in 0..MISSIONS {
        let mut text = lasting_mission(seed, kind);
        if matches!(addition, Addition::Objective | Addition::BestFirst) {
            text = text.replace("scenario S", "objective minimize end;\nscenario S");
        }
        let (Some(mut network), _) = compile(&text, &Top::Scenario(None)) else { continue };
        if addition == Addition::Nature {
            give_to_nature(&mut network, seed);
        }
        let search = addition.search();
        let (outcome, trace) = recorded(&network, search, 100_000);
        check_agreement(&network, search, &outcome, &format!("seed {seed}\n{text}"));
        if trace.events.is_empty() || !trace.is_conflict_driven() {
            continue;
        }
        let told = format!("seed {seed}\n{text}\n{}", kirk::trace_json_lines(&network, &trace));
        check_steps(&network, &trace, &told);
        if let Some(plan) = outcome.plans.first() {
            check_end(&network, &trace, plan, &told);
            plans += 1;
        }
        learned += check_learned(&network, &trace, addition, &told);
        failures += trace.tree.iter().filter(|node| node.status == TreeStatus::Failed).count();
    }
    assert!(plans > MISSIONS / 8, "{plans} plans");
    assert!(learned > 15 && failures > 100, "{learned} learned from {failures} failures");
}

impl Addition {
    const fn search(self) -> Search {
        match self {
            Self::BestFirst => Search::BestFirst,
            Self::Nothing | Self::Objective | Self::Nature => Search::ConflictDirected,
        }
    }
}

/// Lets the environment choose some of the durations that have a range.
fn give_to_nature(network: &mut Network, seed: u64) {
    for (id, arc) in (0_u64..).zip(&mut network.arcs) {
        let is_duration = matches!(arc.kind, ArcKind::Activity | ArcKind::Assertion | ArcKind::Delay);
        let is_drawn = (seed * 31 + id).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 63 == 1;
        if is_duration && is_drawn && arc.upper.finite().is_some_and(|upper| arc.lower < upper) {
            arc.is_contingent = true;
        }
    }
}

fn options(search: Search, trace_events: Option<usize>) -> Options {
    Options { search, trace_events, explain: false, relax: false, ..Options::default() }
}

fn recorded(network: &Network, search: Search, events: usize) -> (Outcome, Trace) {
    let mut outcome = kirk::plan(network, &options(search, Some(events)), &mut Unlimited);
    let trace = outcome.trace.take().expect("it was asked for");
    (outcome, trace)
}

/// With a record, with a short one and without the same is searched in as many steps.
fn check_agreement(network: &Network, search: Search, outcome: &Outcome, told: &str) {
    let unrecorded = kirk::plan(network, &options(search, None), &mut Unlimited);
    assert_eq!(unrecorded.status, outcome.status, "{told}");
    assert_eq!(unrecorded.plans, outcome.plans, "{told}");
    let (cut, trace) = recorded(network, search, 7);
    assert_eq!(cut.plans, outcome.plans, "{told}");
    assert!(trace.events.len() <= 7 && trace.tree.len() <= 7, "{told}");
    if trace.is_conflict_driven() {
        // What is not watched may decide much at once, and then count more decisions.
        assert_eq!(cut.stats, outcome.stats, "{told}");
        assert!(trace.events.iter().all(|entry| (entry.tree_node as usize) < trace.tree.len()), "{told}");
        let replay = Replay::new(network, None, &trace).expect("small numbers");
        assert_eq!(replay.at(&trace, 6).step, trace.events.len() - 1, "{told}");
    }
}

/// What is in force where the search continues fits together; everywhere there is a window for what is selected.
fn check_steps(network: &Network, trace: &Trace, told: &str) {
    let replay = Replay::new(network, None, trace).expect("small numbers");
    for (step, entry) in trace.events.iter().enumerate() {
        let shown = replay.at(trace, step);
        for node in &shown.nodes {
            let window = shown.windows[node.index()].expect("selected events have windows");
            assert!(window.latest >= Bound::Finite(window.earliest), "step {step}, {told}");
        }
        let goes_on = matches!(
            trace.events.get(step + 1).map(|entry| &entry.event),
            Some(
                Event::Decide { .. }
                    | Event::TryLink { .. }
                    | Event::TryOrder { .. }
                    | Event::TryUseOrder { .. }
                    | Event::Keep { .. }
            )
        );
        let goes_on_here = |next: &kirk::Entry| {
            trace.tree[next.tree_node as usize].parent == Some(entry.tree_node)
                || next.tree_node == entry.tree_node
        };
        if goes_on && trace.events.get(step + 1).is_some_and(goes_on_here) {
            assert!(in_force(network, &shown).is_some(), "step {step}, {told}");
        }
        if let Event::Inconsistent { cycle } = &entry.event {
            let total = Time::checked_sum(cycle.iter().map(|member| member.weight)).expect("small numbers");
            assert!(total < Time::ZERO, "step {step}, {told}");
            for (member, next) in cycle.iter().zip(cycle.iter().cycle().skip(1)) {
                assert_eq!(member.to, next.from, "step {step}, {told}");
            }
        }
    }
}

/// The last state is that of the plan.
fn check_end(network: &Network, trace: &Trace, plan: &Plan, told: &str) {
    let last = trace.events.last().expect("there are events");
    assert_eq!(last.event, Event::Solution { plan: 0 }, "{told}");
    let replay = Replay::new(network, None, trace).expect("small numbers");
    let shown = replay.at(trace, trace.events.len());
    assert_eq!(shown.choices, plan.choices, "{told}");
    assert_eq!(shown.links, plan.causal_links, "{told}");
    assert_eq!(shown.orders, plan.orderings_added, "{told}");
    assert_eq!(shown.uses, plan.uses_ordered, "{told}");
    assert_eq!(shown.windows, plan.windows, "{told}");
    let selected: Vec<bool> =
        (0..network.arcs.len()).map(|arc| shown.arcs.iter().any(|it| it.index() == arc)).collect();
    assert_eq!(selected, plan.selected_arcs, "{told}");
}

/// No plan has choices that the search has learned never to make together. Returns how many it has learned.
fn check_learned(network: &Network, trace: &Trace, addition: Addition, told: &str) -> usize {
    let all = Options { all: true, max_plans: 300, ..options(Search::ConflictDirected, None) };
    let all = kirk::plan(network, &all, &mut Unlimited);
    let mut round = &SearchRound::default();
    let mut learned = 0;
    for (step, entry) in trace.events.iter().enumerate() {
        let choices = match &entry.event {
            Event::Begin(begun) => {
                round = begun;
                continue;
            }
            Event::Learn { choices } | Event::Uncontrollable { choices } => choices,
            _ => continue,
        };
        learned += 1;
        for plan in &all.plans {
            let contains = contains(network, plan, choices, round, addition == Addition::Nature);
            assert!(!contains, "step {step}: {plan:#?}\n{told}");
        }
        if choices.is_empty() && round.values.is_empty() && all.status != Status::Limit {
            assert!(all.plans.is_empty(), "step {step}: {told}");
        }
    }
    learned
}

/// Returns whether some schedule of a plan makes these choices, or all of them where the environment has a say.
fn contains(network: &Network, plan: &Plan, choices: &[TreeChoice], round: &SearchRound, all: bool) -> bool {
    let mut stn = Stn::new(network.nodes.len());
    let arcs = network.arcs.iter().zip(&plan.selected_arcs).filter(|(_, is_selected)| **is_selected);
    for (arc, _) in arcs {
        insert(&mut stn, arc.from, arc.to, arc.upper).expect("a plan fits");
        insert_least(&mut stn, arc.from, arc.to, arc.lower).expect("a plan fits");
    }
    for Precedence { earlier, later, least } in plan.precedences(network) {
        insert_least(&mut stn, earlier, later, least).expect("a plan fits");
    }
    if let Some(value) = round.values.last() {
        let best: i64 = value.to_string().parse().expect("whole numbers");
        if stn.insert(PointId(network.start.0), PointId(network.end.0), best - 1, 0).is_err() {
            return false;
        }
    }
    // What is chosen beside what the plan does anyway, which has an order at each time as well.
    let mut before: Vec<(NodeId, NodeId)> = Vec::new();
    let is_made = choices.iter().all(|choice| match choice {
        TreeChoice::Decision { decision, alternative } => {
            plan.choices.iter().any(|it| it.decision == *decision && it.alternative == *alternative)
        }
        TreeChoice::Link(link) => plan.causal_links.contains(link),
        TreeChoice::Order(Ordering { first, then }) => {
            let is_there = |label: LabelId| plan.selected_arcs[network.labels[label.index()].arc.index()];
            let (earlier, later) = (network.interval(*first).1, network.interval(*then).0);
            before.push((earlier, later));
            is_there(*first) && is_there(*then) && keeps(&mut stn, earlier, later, all)
        }
        TreeChoice::UseOrder(order) => {
            let is_there = |used: tpn::UseId| plan.selected_arcs[network.uses[used.index()].arc.index()];
            let Precedence { earlier, later, .. } = order.precedence(network);
            before.push((earlier, later));
            is_there(order.first) && is_there(order.then) && keeps(&mut stn, earlier, later, all)
        }
        TreeChoice::Start { used, by } => {
            let used = &network.uses[used.index()];
            let most = Bound::Finite(*by);
            assert!(!all, "nature chooses nothing where starts are decided");
            plan.selected_arcs[used.arc.index()]
                && insert(&mut stn, network.start, used.start, most).is_some()
        }
        // Which of its pairs are kept apart a plan does not say.
        TreeChoice::NoLink { .. }
        | TreeChoice::Later { .. }
        | TreeChoice::Departure(_)
        | TreeChoice::Apart => false,
    });
    let arcs = network.arcs.iter().zip(&plan.selected_arcs);
    before.extend(arcs.filter(|(_, is_selected)| **is_selected).map(|(arc, _)| (arc.from, arc.to)));
    before.extend(plan.precedences(network).into_iter().map(|it| (it.earlier, it.later)));
    is_made && has_order(stn.schedule(), &before)
}

/// Returns whether what happens at one time has an order.
fn has_order(times: &[i64], before: &[(NodeId, NodeId)]) -> bool {
    let mut left: Vec<(NodeId, NodeId)> = before.to_vec();
    left.retain(|(earlier, later)| earlier != later && times[earlier.index()] == times[later.index()]);
    loop {
        let later: BTreeSet<NodeId> = left.iter().map(|&(_, later)| later).collect();
        let num_left = left.len();
        // What nothing is before comes first.
        left.retain(|(earlier, _)| later.contains(earlier));
        if left.len() == num_left {
            return left.is_empty();
        }
    }
}

/// Returns whether one event is before another in some schedule, which is then kept, or in all.
fn keeps(stn: &mut Stn, earlier: NodeId, later: NodeId, all: bool) -> bool {
    if all {
        return stn.admits(PointId(earlier.0), PointId(later.0), -1, 0).is_err();
    }
    stn.insert(PointId(later.0), PointId(earlier.0), 0, 0).is_ok()
}

fn integer(time: Time) -> i64 {
    time.to_string().parse().expect("the missions have whole times")
}

fn insert(stn: &mut Stn, from: NodeId, to: NodeId, most: Bound) -> Option<()> {
    let Bound::Finite(most) = most else { return Some(()) };
    stn.insert(PointId(from.0), PointId(to.0), integer(most), 0).ok()
}

fn insert_least(stn: &mut Stn, from: NodeId, to: NodeId, least: Time) -> Option<()> {
    stn.insert(PointId(to.0), PointId(from.0), -integer(least), 0).ok()
}

/// The network of a step, if all that is in force fits together.
fn in_force(network: &Network, step: &ReplayStep) -> Option<Stn> {
    let mut stn = Stn::new(network.nodes.len());
    for arc in &step.arcs {
        let arc = &network.arcs[arc.index()];
        insert(&mut stn, arc.from, arc.to, arc.upper)?;
        insert_least(&mut stn, arc.from, arc.to, arc.lower)?;
    }
    let links = step.links.iter().flat_map(|link: &CausalLink| link.precedences(network));
    let uses = step.uses.iter().map(|order: &UseOrdering| order.precedence(network));
    for Precedence { earlier, later, least } in links.chain(uses) {
        insert_least(&mut stn, earlier, later, least)?;
    }
    for &(used, by) in &step.starts {
        insert(&mut stn, network.start, network.uses[used.index()].start, Bound::Finite(by))?;
    }
    for order in &step.orders {
        let (earlier, later) = (network.interval(order.first).1, network.interval(order.then).0);
        insert_least(&mut stn, earlier, later, Time::ZERO)?;
    }
    Some(stn)
}

#[test]
fn what_is_told_of_resources_is_what_the_mission_says() {
    for seed in 0..MISSIONS {
        let text = lasting_mission(seed, Kind::RESOURCES);
        let (Some(network), _) = compile(&text, &Top::Scenario(None)) else { continue };
        let (_, trace) = recorded(&network, Search::ConflictDirected, 100_000);
        for entry in &trace.events {
            match &entry.event {
                Event::Overload { uses } => {
                    let resource = &network.resources[network.uses[uses[0].index()].resource.index()];
                    let Supply::Reusable { capacity } = resource.supply else { panic!("{text}") };
                    let sum = |without: Option<usize>| {
                        let counted = uses.iter().enumerate().filter(|(at, _)| Some(*at) != without);
                        let amounts = counted.map(|(_, used)| network.uses[used.index()].amount);
                        amounts.fold(exact::Rational::default(), |sum, amount| {
                            sum.checked_add(amount).expect("small numbers")
                        })
                    };
                    assert!(sum(None) > capacity, "too much together: {text}");
                    assert!((0..uses.len()).all(|at| sum(Some(at)) <= capacity), "a minimal set: {text}");
                }
                Event::OutOfRange { early, late } => {
                    let change = |used: &tpn::UseId| network.uses[used.index()].change;
                    assert!(early.iter().all(|used| change(used) == change(&early[0])), "{text}");
                    assert!(late.iter().all(|used| change(used) != change(&early[0])), "{text}");
                    assert!(early.iter().all(|used| change(used) != Change::Uses), "{text}");
                }
                _ => {}
            }
        }
    }
}

#[test]
fn departures_follow_the_movements() {
    let text = "location A (0, 0); location B (30, 0); location C (60, 0);
vehicle R1 : ATRV-Jr at A;
primitive Drive(to)[1,90] moves R1 speed (0.02, 0.5);
scenario S[0,500] = { free { delay; Drive(B) }, free { delay; Drive(C) } }";
    let (network, diagnostics) = compile(text, &Top::Scenario(None));
    let mut network = network.unwrap_or_else(|| panic!("{diagnostics:?}"));
    let values = |id: usize| match &network.labels[id].literal.values {
        tpn::ValueSet::In(values) => values[0],
        tpn::ValueSet::NotIn(_) => panic!("a place"),
    };
    let arrivals: Vec<LabelId> = (0..network.labels.len())
        .map(LabelId::from_index)
        .filter(|&label| network.labels[label.index()].is_changing())
        .collect();
    let places: Vec<tpn::ValueId> = (0..network.labels.len()).map(values).collect();
    let departures = arrivals.iter().flat_map(|&arrival| {
        let all = places.iter().enumerate();
        all.map(move |(far, &from)| tpn::Departure {
            arrival,
            from,
            least: Some(Time::from(20 + far as i64)),
        })
    });
    network.departures = departures.collect();
    let (outcome, trace) = recorded(&network, Search::ConflictDirected, 1_000);
    let replay = Replay::new(&network, None, &trace).expect("small numbers");
    let last = replay.at(&trace, trace.events.len());
    assert_eq!(last.windows, outcome.plans[0].windows);
    let of = |Departing { movement, before }: &Departing| {
        (network.label_name(*before), network.label_name(*movement))
    };
    let departures: Vec<(String, String)> = last.departures.iter().map(of).collect();
    assert_eq!(departures.len(), 2, "{departures:?}");
    assert_eq!(departures.iter().filter(|(before, _)| before.starts_with("Init")).count(), 1);
}
