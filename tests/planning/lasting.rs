//! State that lasts and resources: the planner against the exhaustive reference on many small random missions, and the
//! reference against known answers and the checker.

use std::collections::BTreeSet;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use acceptance::cases;
use acceptance::distances::{FAR, Scale, of_arcs};
use acceptance::lasting::{Key, Limits, search};
use acceptance::lasting_missions::{Kind, lasting_mission};
use acceptance::mission::{compile, network, try_plans};
use exact::{Bound, Rational};
use kirk::Search;
use rmpl::program::LabelMode;
use tpn::generate::Rng;
use tpn::selection::closure;
use tpn::{
    CausalLink, Choice, DecisionId, Extent, LabelId, Network, NodeId, Plan, Quality, StateOrder, Supply, Top,
    Use, VariableId, Window,
};

/// Missions of each kind that the reference finishes.
const MISSIONS: u64 = 3_000;
/// The reference gives up on missions with more than this, and another one takes their place.
const LIMITS: Limits = Limits { schedules: 20_000, plans: 1_000 };

/// What a comparison went over.
#[derive(Default)]
struct Tally {
    feasible: AtomicU64,
    plans: AtomicU64,
}

impl Tally {
    /// Says how much was compared. The comparison says little unless the missions are mixed.
    #[expect(clippy::print_stdout, reason = "the count is part of the evidence")]
    fn tell(self, kind: Kind) {
        let (feasible, plans) = (self.feasible.into_inner(), self.plans.into_inner());
        println!("{kind:?}: {MISSIONS} missions compared: {feasible} with plans, {plans} plans");
        assert!(
            feasible > MISSIONS / 5 && feasible < MISSIONS * 9 / 10,
            "{feasible} missions of {MISSIONS} have a plan"
        );
    }
}

#[test]
fn states_are_planned_exactly() {
    compare_all(Kind::STATES).tell(Kind::STATES);
}

#[test]
fn resources_are_planned_exactly() {
    compare_all(Kind::RESOURCES).tell(Kind::RESOURCES);
}

#[test]
fn states_and_resources_are_planned_exactly() {
    compare_all(Kind::BOTH).tell(Kind::BOTH);
}

#[test]
fn amounts_between_two_numbers_are_planned_exactly() {
    compare_all_with(Kind::RESOURCES, with_ranges).tell(Kind::RESOURCES);
}

/// Gives some uses of reservoirs a minimum amount below their maximum, as drives have one, whose lengths differ.
fn with_ranges(network: &mut Network, seed: u64) {
    let mut rng = Rng::new(seed ^ 0x7261_6e67);
    let resources = &network.resources;
    let is_range =
        |used: &&mut Use| matches!(resources[used.resource.index()].supply, Supply::Reservoir { .. });
    for used in network.uses.iter_mut().filter(is_range).filter(|used| used.level.is_none()) {
        if rng.chance(60) {
            used.at_least = Rational::from_integer(rng.between(0, used.amount.numerator()));
        }
    }
}

#[test]
fn conditions_on_levels_are_planned_exactly() {
    compare_all(Kind::LEVELS).tell(Kind::LEVELS);
}

#[test]
fn conditions_on_levels_hold_for_all_amounts() {
    compare_all_with(Kind::LEVELS, with_ranges).tell(Kind::LEVELS);
}

/// Compares [`MISSIONS`] missions of a kind; all must agree.
fn compare_all(kind: Kind) -> Tally {
    compare_all_with(kind, |_, _| {})
}

/// Compares missions whose networks are changed first.
fn compare_all_with(kind: Kind, change: fn(&mut Network, u64)) -> Tally {
    let tally = Tally::default();
    let disagreements = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for worker in 0..2_u64 {
            let (tally, disagreements) = (&tally, &disagreements);
            scope.spawn(move || {
                let (mut seed, mut compared) = (worker, 0);
                while compared < MISSIONS / 2 {
                    match compare(&lasting_mission(seed, kind), |network| change(network, seed)) {
                        Ok(Some(plans)) => {
                            tally.feasible.fetch_add(u64::from(plans > 0), Ordering::Relaxed);
                            tally.plans.fetch_add(plans, Ordering::Relaxed);
                            compared += 1;
                        }
                        Ok(None) => {}
                        Err(problem) => {
                            compared += 1;
                            let mut disagreements = disagreements.lock().expect("no thread panics");
                            disagreements.push(format!("seed {seed}, {kind:?}, {problem}"));
                        }
                    }
                    seed += 2;
                }
            });
        }
    });
    let disagreements = disagreements.into_inner().expect("no thread panics");
    let shown = &disagreements[..disagreements.len().min(5)];
    assert!(disagreements.is_empty(), "{} missions differ, such as {shown:#?}", disagreements.len());
    tally
}

/// Returns how many plans the mission has, if the reference finishes and both searches agree with it.
fn compare(text: &str, change: impl Fn(&mut Network)) -> Result<Option<u64>, String> {
    let (network, diagnostics) = compile(text, &Top::Scenario(None));
    let mut network = network.ok_or_else(|| format!("does not compile: {diagnostics:?}\n{text}"))?;
    change(&mut network);
    let Some(answer) = search(&network, LIMITS) else { return Ok(None) };
    for search in [Search::Chronological, Search::ConflictDirected] {
        let plans = |all| {
            try_plans(&network, search, all).map_err(|problem| format!("{search:?}: {problem}\n{text}"))
        };
        let outcome = plans(true)?;
        let found: BTreeSet<Key> = outcome.plans.iter().map(|plan| key(&network, plan)).collect();
        let (missing, wrong) =
            (answer.plans.difference(&found).count(), found.difference(&answer.plans).count());
        // Plans that differ only in the orderings of resources are one plan.
        if missing > 0 || wrong > 0 {
            return Err(format!("{search:?}: {missing} plans are missing, {wrong} are wrong\n{text}"));
        }
        if outcome.plans.len() != found.len() {
            return Err(format!("{search:?}: a plan is listed twice\n{text}"));
        }
        let first = plans(false)?;
        let is_right = match first.plans.first() {
            Some(plan) => answer.plans.contains(&key(&network, plan)),
            None => answer.plans.is_empty(),
        };
        if !is_right {
            return Err(format!("{search:?}: the first plan is not one of all\n{text}"));
        }
    }
    Ok(Some(answer.plans.len() as u64))
}

/// Returns what makes a plan distinct.
fn key(network: &Network, plan: &Plan) -> Key {
    let mut key = Key {
        choices: plan.choices.iter().map(|it| (it.decision.0, it.alternative)).collect(),
        links: plan.causal_links.iter().map(|it| (it.ask.0, it.tell.0)).collect(),
        sides: sides(network, plan),
    };
    key.choices.sort_unstable();
    key.links.sort_unstable();
    key.sides.sort_unstable();
    key
}

/// The pairs of producers that exclude each other, as the plan orders them.
pub(crate) fn sides(network: &Network, plan: &Plan) -> Vec<(u32, u32)> {
    let mut sides = Vec::new();
    for StateOrder { producers, .. } in &plan.state_order {
        for (position, &first) in producers.iter().enumerate() {
            let later = producers[position + 1..].iter().filter(|&&then| network.conflict(first, then));
            sides.extend(later.map(|then| (first.0, then.0)));
        }
    }
    sides
}

/// Returns how many plans a text has.
fn count(text: &str) -> usize {
    search(&network(text), Limits { schedules: 1_000_000, ..LIMITS }).expect("it is small").plans.len()
}

#[test]
fn the_reference_knows_the_conformance_cases() {
    let text = |name: &str| cases::read(&cases::folder().join(format!("{name}.rmpl")));
    for (name, plans) in [
        ("s01_persistence", 1),
        ("s02_effect_while_changing", 1),
        ("s03_requires_and_sets", 1),
        ("s04_threat_both_ways", 2),
    ] {
        assert_eq!(count(&text(name)), plans, "{name}");
    }
    // The case's earliest end is the shortest horizon with a plan.
    for (name, horizon, end) in [
        ("r01_unary_order", 20, 20),
        ("r03_three_users", 40, 20),
        ("r05_reservoir_low", 40, 13),
        ("r07_per_minute", 40, 7),
        ("s02_effect_while_changing", 30, 8),
        ("s03_requires_and_sets", 30, 10),
        ("s04_threat_both_ways", 40, 20),
    ] {
        let text = text(name);
        let within = |horizon_now: i64| {
            let from = format!("scenario S [0,{horizon}]");
            assert!(text.contains(&from), "{text}");
            count(&text.replace(&from, &format!("scenario S [0,{horizon_now}]")))
        };
        assert!(within(end) > 0, "{name} within {end}");
        assert_eq!(within(end - 1), 0, "{name} within {}", end - 1);
    }
}

/// Every plan that the reference finds makes a plan that the checker accepts.
#[test]
fn the_checker_accepts_what_the_reference_finds() {
    let mut accepted = 0;
    for seed in 0..1_000 {
        let text = lasting_mission(seed, Kind::STATES);
        let network = network(&text);
        let Some(answer) = search(&network, LIMITS) else { continue };
        for key in answer.plans.iter().take(50) {
            let plan = plan_of(&network, key);
            let verdict = verify::check_plan(&network, &plan);
            assert!(verdict.valid, "seed {seed}: {:#?}\n{key:?}\n{text}", verdict.violations);
            let schedule = verify::earliest_schedule(&plan);
            let verdict = verify::check_schedule(&network, &plan, &schedule);
            assert!(verdict.valid, "seed {seed}: {:#?}\n{key:?}\n{text}", verdict.violations);
            accepted += 1;
        }
    }
    assert!(accepted > 500, "{accepted} plans");
}

/// The plan of a key, with all that it says about order as added orderings.
fn plan_of(network: &Network, key: &Key) -> Plan {
    let choices: Vec<Choice> = (key.choices.iter())
        .map(|&(decision, alternative)| Choice { decision: DecisionId(decision), alternative })
        .collect();
    let (selected_nodes, selected_arcs) = closure(network, &choices);
    let ordering = |first: u32, then: u32| tpn::Ordering { first: LabelId(first), then: LabelId(then) };
    let mut orderings_added: Vec<tpn::Ordering> =
        key.sides.iter().map(|&(first, then)| ordering(first, then)).collect();
    // A requirement is on the side of its producer.
    for &(ask, own) in &key.links {
        for &(first, then) in &key.sides {
            let other = if first == own { then } else { first };
            if (first != own && then != own) || !threatens(network, other, ask) {
                continue;
            }
            orderings_added.push(if first == own { ordering(ask, other) } else { ordering(other, ask) });
        }
    }
    let state_order = state_order(network, &selected_arcs, &key.sides);
    let mut plan = Plan {
        choices,
        selected_nodes,
        selected_arcs,
        causal_links: (key.links.iter())
            .map(|&(ask, tell)| CausalLink { ask: LabelId(ask), tell: LabelId(tell) })
            .collect(),
        orderings_added,
        conflict_order: Vec::new(),
        conflict_order_omitted: 0,
        state_order,
        uses_ordered: Vec::new(),
        levels: Vec::new(),
        quality: Quality::default(),
        windows: vec![None; network.nodes.len()],
    };
    plan.windows = windows(network, &plan);
    plan
}

/// The selected producers of each variable in an order that agrees with the sides.
fn state_order(network: &Network, selected_arcs: &[bool], sides: &[(u32, u32)]) -> Vec<StateOrder> {
    let mut found = Vec::new();
    for variable in (0..network.variables.len()).map(VariableId::from_index) {
        let labels = (0..network.labels.len()).map(LabelId::from_index);
        let mut left: Vec<LabelId> = labels
            .filter(|&id| {
                let label = &network.labels[id.index()];
                label.mode == LabelMode::Tell
                    && label.literal.variable == variable
                    && network.is_lasting(id)
                    && selected_arcs[label.arc.index()]
            })
            .collect();
        let mut producers = Vec::new();
        let waits =
            |then: LabelId, left: &[LabelId]| left.iter().any(|first| sides.contains(&(first.0, then.0)));
        while let Some(next) = left.iter().position(|&it| !waits(it, &left)) {
            producers.push(left.remove(next));
        }
        assert!(left.is_empty(), "the sides have a circle");
        if !producers.is_empty() {
            found.push(StateOrder { variable, producers });
        }
    }
    found
}

fn threatens(network: &Network, producer: u32, ask: u32) -> bool {
    let (producer, ask) = (&network.labels[producer as usize], &network.labels[ask as usize]);
    producer.extent == Extent::Effect || !producer.literal.supports(&ask.literal)
}

/// The exact windows of a plan whose constraints are whole.
fn windows(network: &Network, plan: &Plan) -> Vec<Option<Window>> {
    let mut matrix =
        of_arcs(network, Scale(1), |arc| plan.selected_arcs[arc.index()]).expect("it has schedules");
    let ready = |label: LabelId| {
        let is_effect = network.labels[label.index()].extent == Extent::Effect;
        if is_effect { network.interval(label).1 } else { network.interval(label).0 }
    };
    let mut put = |from: NodeId, to: NodeId| {
        assert!(matrix.constrain(from.index(), to.index(), 0, None), "the plan has a schedule");
    };
    for link in &plan.causal_links {
        put(ready(link.tell), network.interval(link.ask).0);
    }
    for order in &plan.orderings_added {
        let own = plan.causal_links.iter().find(|link| link.ask == order.then);
        let then = own.map_or(network.interval(order.then).0, |link| ready(link.tell));
        put(network.interval(order.first).1, then);
    }
    let start = network.start.index();
    let window = |(node, &is_selected): (usize, &bool)| {
        let latest = match matrix.get(start, node) {
            FAR.. => Bound::Infinite,
            latest => Bound::Finite(Scale(1).unscaled(latest)),
        };
        is_selected.then(|| Window { earliest: Scale(1).unscaled(-matrix.get(node, start)), latest })
    };
    plan.selected_nodes.iter().enumerate().map(window).collect()
}
