//! The checker against brute force: random plans and random schedules of tiny missions, most of them nearly right.

use tpn::generate::Rng;
use tpn::{CausalLink, Choice, DecisionId, LabelId, Network, Ordering, Plan, Quality};
use verify::{check_plan, check_schedule};

use crate::brute_force::{accepts_plan, accepts_schedule, conflicting, schedules, windows};
use crate::chance::{pick, thread, times};
use crate::missions::{closure, network, time, units};

const HORIZON: i64 = 7;
/// Missions with more schedules are left out: there are enough others.
const MANY: usize = 4_000;

/// The text of tiny mission number `seed`.
fn tiny_mission(seed: u64) -> String {
    let mut rng = Rng::new(seed);
    let gap = rng.below(2);
    let threads: Vec<String> = (0..rng.between(2, 3)).map(|_| thread(&mut rng, interval, 15)).collect();
    let lower = rng.below(3);
    format!("option threat_gap = {gap};\nscenario S[{lower},{HORIZON}] = {{ {} }}\n", threads.join(", "))
}

fn interval(rng: &mut Rng) -> String {
    let conditions = ["c", "not c", "V=X", "V=Y", "not(V=X)", "not(V=Y)"];
    let condition = conditions[rng.below(conditions.len() as u64) as usize];
    let lower = rng.below(4);
    let bounds = match rng.below(3) {
        0 => String::new(),
        1 => format!(" [{lower},{lower}]"),
        _ => format!(" [{lower},{}]", lower + rng.below(3)),
    };
    match rng.below(6) {
        0 => format!("do A(){} maintaining {condition}", if bounds.is_empty() { "[1,2]" } else { &bounds }),
        1 => format!("ask {condition}{bounds}"),
        2 => format!("do {{ B()[0,1]; A()[1,1] }} watching {condition}"),
        _ => format!("{condition}{bounds}"),
    }
}

/// A plan that is right as far as chance likes.
fn random_plan(network: &Network, rng: &mut Rng) -> Plan {
    let mut choices = Vec::new();
    for (index, decision) in network.decisions.iter().enumerate() {
        if closure(network, &choices).0[decision.node.index()] || rng.chance(2) {
            let alternative = rng.below(decision.alternatives.len() as u64) as u32;
            choices.push(Choice { decision: DecisionId::from_index(index), alternative });
        }
    }
    if rng.chance(3) {
        choices.pop();
    }
    let (mut selected_nodes, mut selected_arcs) = closure(network, &choices);
    if rng.chance(3) {
        let arc = rng.below(selected_arcs.len() as u64) as usize;
        selected_arcs[arc] = !selected_arcs[arc];
    }
    if rng.chance(3) {
        let node = rng.below(selected_nodes.len() as u64) as usize;
        selected_nodes[node] = !selected_nodes[node];
    }
    let mut plan = Plan {
        choices,
        selected_nodes,
        selected_arcs,
        causal_links: Vec::new(),
        conflict_order: Vec::new(),
        conflict_order_omitted: 0,
        state_order: Vec::new(),
        orderings_added: Vec::new(),
        uses_ordered: Vec::new(),
        levels: Vec::new(),
        quality: Quality::default(),
        windows: vec![None; network.nodes.len()],
    };
    let labels: Vec<LabelId> = (0..network.labels.len()).map(LabelId::from_index).collect();
    for &ask in &labels {
        let label = &network.labels[ask.index()];
        let is_ask = label.mode == rmpl::program::LabelMode::Ask && plan.selected_arcs[label.arc.index()];
        let fitting: Vec<LabelId> = (labels.iter().copied())
            .filter(|tell| {
                let tell = &network.labels[tell.index()];
                tell.mode == rmpl::program::LabelMode::Tell && tell.literal.supports(&label.literal)
            })
            .collect();
        let tell = if rng.chance(90) { pick(rng, &fitting) } else { pick(rng, &labels) };
        if let Some(&tell) = tell.filter(|_| if is_ask { rng.chance(97) } else { rng.chance(1) }) {
            plan.causal_links.push(CausalLink { ask, tell });
        }
    }
    for (one, other) in conflicting(network, &plan) {
        let (first, then) = if rng.chance(50) { (one, other) } else { (other, one) };
        let ordering = Ordering { first, then };
        if rng.chance(97) {
            plan.conflict_order.push(ordering);
        }
        if rng.chance(70) {
            plan.orderings_added.push(ordering);
        }
        if rng.chance(3) {
            plan.conflict_order.push(Ordering { first: then, then: first });
        }
        if rng.chance(3) {
            plan.orderings_added.push(Ordering { first: then, then: first });
        }
    }
    if rng.chance(3)
        && let (Some(&first), Some(&then)) = (pick(rng, &labels), pick(rng, &labels))
    {
        plan.conflict_order.push(Ordering { first, then });
    }
    plan
}

#[test]
fn verdicts_on_plans_are_those_of_brute_force() {
    let (mut accepted, mut refused) = (0, 0);
    for seed in 0..400 {
        let network = network(&tiny_mission(seed));
        let mut rng = Rng::new(seed ^ 0x51ED);
        for _ in 0..12 {
            let mut plan = random_plan(&network, &mut rng);
            let Some(all) = schedules(&network, &plan, HORIZON, MANY) else { continue };
            plan.windows = windows(&plan, &all);
            if rng.chance(10)
                && let Some(window) = plan.windows[rng.below(network.nodes.len() as u64) as usize].as_mut()
            {
                let moved = window.earliest.checked_add(time(rng.between(-1, 1)));
                window.earliest = moved.expect("a small time");
            }
            let expected = accepts_plan(&network, &plan, &all);
            let verdict = check_plan(&network, &plan);
            assert_eq!(verdict.valid, expected, "mission {seed}: {plan:?}\n{:?}", verdict.violations);
            if expected {
                accepted += 1;
            } else {
                refused += 1;
            }
        }
    }
    assert!(accepted > 500 && refused > 500, "{accepted} plans were accepted and {refused} refused");
}

#[test]
fn every_schedule_inside_a_valid_plan_passes_and_none_outside_a_bound() {
    let (mut inside, mut outside) = (0, 0);
    for seed in 0..400 {
        let network = network(&tiny_mission(seed));
        let mut rng = Rng::new(seed ^ 0xACE5);
        for _ in 0..12 {
            let mut plan = random_plan(&network, &mut rng);
            let Some(all) = schedules(&network, &plan, HORIZON, MANY) else { continue };
            plan.windows = windows(&plan, &all);
            if !accepts_plan(&network, &plan, &all) {
                continue;
            }
            for _ in 0..5 {
                let Some(schedule) = pick(&mut rng, &all) else { continue };
                let verdict = check_schedule(&network, &plan, &times(&plan, schedule));
                assert!(verdict.valid, "mission {seed}: {schedule:?} {:?}", verdict.violations);
                inside += 1;
                // One event is moved past a bound of an arc.
                let selected: Vec<&tpn::Arc> = (network.arcs.iter().zip(&plan.selected_arcs))
                    .filter_map(|(arc, is_selected)| is_selected.then_some(arc))
                    .collect();
                let Some(arc) = pick(&mut rng, &selected) else { continue };
                let mut moved = schedule.clone();
                let from = moved[arc.from.index()];
                moved[arc.to.index()] = match arc.upper {
                    exact::Bound::Finite(upper) if rng.chance(50) => from + units(upper) + 1,
                    _ => from + units(arc.lower) - 1,
                };
                let verdict = check_schedule(&network, &plan, &times(&plan, &moved));
                assert!(!verdict.valid, "mission {seed}: {moved:?}");
                outside += 1;
            }
        }
    }
    assert!(inside > 500 && outside > 500, "{inside} schedules inside, {outside} outside");
}

#[test]
fn verdicts_on_schedules_are_those_of_brute_force() {
    let (mut accepted, mut refused) = (0, 0);
    for seed in 0..600 {
        let network = network(&tiny_mission(seed));
        let mut rng = Rng::new(seed ^ 0xBEE);
        // Without links and orderings: schedules of all that the choices select.
        let mut plan = random_plan(&network, &mut rng);
        plan.causal_links.clear();
        plan.conflict_order.clear();
        plan.orderings_added.clear();
        let (nodes, arcs) = closure(&network, &plan.choices);
        let is_decided = (network.nodes.iter().zip(&nodes))
            .filter(|(_, is_selected)| **is_selected)
            .filter_map(|(node, _)| node.decision)
            .all(|decision| plan.choices.iter().filter(|choice| choice.decision == decision).count() == 1);
        if !is_decided
            || plan.choices.iter().any(|it| !nodes[network.decisions[it.decision.index()].node.index()])
        {
            continue;
        }
        (plan.selected_nodes, plan.selected_arcs) = (nodes, arcs);
        let Some(all) = schedules(&network, &plan, HORIZON, 40 * MANY) else { continue };
        for _ in 0..20 {
            let Some(schedule) = pick(&mut rng, &all) else { break };
            let mut schedule = schedule.clone();
            if rng.chance(15) {
                let node = rng.below(schedule.len() as u64) as usize;
                schedule[node] += rng.between(-1, 1);
            }
            let expected = accepts_schedule(&network, &plan, &schedule);
            let verdict = check_schedule(&network, &plan, &times(&plan, &schedule));
            assert_eq!(verdict.valid, expected, "mission {seed}: {schedule:?} {:?}", verdict.violations);
            if expected {
                accepted += 1;
            } else {
                refused += 1;
            }
        }
    }
    assert!(accepted > 500 && refused > 500, "{accepted} schedules were accepted and {refused} refused");
}
