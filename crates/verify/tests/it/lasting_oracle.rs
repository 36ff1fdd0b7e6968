//! State and resources against brute force: random plans and random schedules of tiny missions, most of them nearly right.

use crate::brute_force::Schedule;
use std::collections::BTreeMap;

use tpn::generate::Rng;
use tpn::{
    CausalLink, Choice, DecisionId, LabelId, Network, Ordering, Plan, StateOrder, UseId, UseOrdering,
    VariableId,
};
use verify::{check_plan, check_schedule};

use crate::brute_force::{schedules, windows};
use crate::chance::{pick, thread, times};
use crate::lasting_brute_force::{
    Before, accepts_resources_at, accepts_states, accepts_states_at, excluding, levels, producers,
    requirements, some_order_keeps, supporters, threats,
};
use crate::missions::{Sketch, closure, network, plan_without_windows};

const HORIZON: i64 = 6;
/// Missions with more schedules are left out: there are enough others.
const MANY: usize = 3_000;
/// Schedules with more orders of their events are left out.
const MANY_ORDERS: usize = 20_000;

/// The text of tiny mission number `seed`.
fn tiny_mission(seed: u64) -> String {
    let mut rng = Rng::new(seed);
    let declared = "state X : {A, B, C} = A; resource R capacity 3; resource T 0..4 = 2;
        primitive ToA() sets X=A; primitive Keep() requires X=A sets X=A; primitive ToB() requires X=A sets X=B; primitive ToC() sets X=C uses R 1;
        primitive InA() requires X=A uses R 2; primitive FromB() requires at start X=B; primitive NotB() requires not X=B;
        primitive Drink() consumes T 2; primitive Pour() produces T 1 uses R 1; primitive Mix() produces T 2 consumes T 1;
        primitive Hold() uses R 2;";
    let threads: Vec<String> = (0..rng.between(2, 3)).map(|_| thread(&mut rng, activity, 12)).collect();
    format!("{declared}\nscenario S[0,{HORIZON}] = {{ {} }}\n", threads.join(", "))
}

fn activity(rng: &mut Rng) -> String {
    let lower = rng.below(3);
    let bounds = match rng.below(4) {
        0 => "[0,0]".to_owned(),
        1 => format!("[{lower},{lower}]"),
        _ => format!("[{lower},{}]", lower + rng.below(3)),
    };
    let names = ["ToA", "Keep", "ToB", "ToC", "InA", "FromB", "NotB", "Drink", "Pour", "Mix", "Hold"];
    let name = names[rng.below(names.len() as u64) as usize];
    let value = ["A", "B", "C"][rng.below(3) as usize];
    match rng.below(12) {
        0 | 1 => format!("X={value} {bounds}"),
        2 => format!("ask X={value} {bounds}"),
        3 => format!("do Hold(){bounds} watching X={value}"),
        4 => "do { Wait()[1,1]; Wait()[0,1] } using R 2".to_owned(),
        _ => format!("{name}(){bounds}"),
    }
}

/// A plan that is right as far as chance likes; without windows and levels.
fn random_plan(network: &Network, rng: &mut Rng) -> Plan {
    let mut choices = Vec::new();
    for (index, decision) in network.decisions.iter().enumerate() {
        if closure(network, &choices).0[decision.node.index()] {
            let alternative = rng.below(decision.alternatives.len() as u64) as u32;
            choices.push(Choice { decision: DecisionId::from_index(index), alternative });
        }
    }
    let mut plan = plan_without_windows(network, Sketch::default());
    (plan.selected_nodes, plan.selected_arcs) = closure(network, &choices);
    plan.choices = choices;
    // Some order of all, in which the first values are mostly first.
    let mut places: BTreeMap<LabelId, u64> = BTreeMap::new();
    for label in (0..network.labels.len()).map(LabelId::from_index) {
        let is_initial = network.labels[label.index()].extent == tpn::Extent::Initial && rng.chance(97);
        places.insert(label, if is_initial { 0 } else { 1 + rng.below(1000) });
    }
    let is_before = |one: LabelId, other: LabelId| (places[&one], one) < (places[&other], other);
    let say = |plan: &mut Plan, rng: &mut Rng, first: LabelId, then: LabelId| {
        let (first, then) = if rng.chance(1) { (then, first) } else { (first, then) };
        if rng.chance(60) {
            plan.orderings_added.push(Ordering { first, then });
        }
    };
    let mut lists: BTreeMap<VariableId, Vec<LabelId>> = BTreeMap::new();
    for producer in producers(network, &plan) {
        lists.entry(network.labels[producer.index()].literal.variable).or_default().push(producer);
    }
    for (variable, mut producers) in lists {
        producers.sort_by_key(|&producer| (places[&producer], producer));
        if rng.chance(1) {
            producers.pop();
        }
        if rng.chance(1) && !producers.is_empty() {
            producers.push(producers[0]);
        }
        if rng.chance(98) {
            plan.state_order.push(StateOrder { variable, producers });
        }
    }
    for (one, other) in excluding(network, &plan) {
        let (first, then) = if is_before(one, other) { (one, other) } else { (other, one) };
        say(&mut plan, rng, first, then);
    }
    for ask in requirements(network, &plan) {
        let mut fitting = supporters(network, &plan, ask);
        if rng.chance(4) {
            fitting = (0..network.labels.len()).map(LabelId::from_index).collect();
        }
        let Some(&own) = pick(rng, &fitting).filter(|_| rng.chance(99)) else { continue };
        plan.causal_links.push(CausalLink { ask, tell: own });
        for threat in threats(network, &plan, ask, own) {
            let (first, then) = if is_before(threat, own) { (threat, ask) } else { (ask, threat) };
            say(&mut plan, rng, first, then);
        }
    }
    let uses: Vec<UseId> = (0..network.uses.len()).map(UseId::from_index).collect();
    for _ in 0..rng.below(4) {
        let (Some(&first), Some(&then)) = (pick(rng, &uses), pick(rng, &uses)) else { continue };
        let is_selected = |used: UseId| plan.selected_arcs[network.uses[used.index()].arc.index()];
        let is_fitting = network.uses[first.index()].resource == network.uses[then.index()].resource
            && first != then
            && is_selected(first)
            && is_selected(then);
        if is_fitting || rng.chance(2) {
            plan.uses_ordered.push(UseOrdering { first, then });
        }
    }
    plan
}

/// Returns whether orderings of uses join different selected uses of one resource.
fn has_fitting_uses(network: &Network, plan: &Plan) -> bool {
    plan.uses_ordered.iter().all(|it| {
        let (first, then) = (&network.uses[it.first.index()], &network.uses[it.then.index()]);
        it.first != it.then
            && first.resource == then.resource
            && [first, then].iter().all(|used| plan.selected_arcs[used.arc.index()])
    })
}

#[test]
fn verdicts_on_plans_with_state_and_resources_are_those_of_brute_force() {
    let (mut accepted, mut refused, mut refused_for_resources) = (0, 0, 0);
    for seed in 0..1000 {
        let network = network(&tiny_mission(seed));
        let mut rng = Rng::new(seed ^ 0x51A7E);
        for _ in 0..8 {
            let mut plan = random_plan(&network, &mut rng);
            let Some(all) = schedules(&network, &plan, HORIZON, MANY) else { continue };
            plan.windows = windows(&plan, &all);
            let before = Before::new(&network, &plan, &all);
            let (is_within, levels) = levels(&network, &plan, &before);
            plan.levels = levels;
            let mut tells_levels = true;
            if rng.chance(4) {
                let more = exact::Rational::ONE;
                match &mut plan.levels[rng.below(2) as usize] {
                    tpn::Levels::Peak(peak) => *peak = peak.checked_add(more).expect("a small amount"),
                    tpn::Levels::Range { low, .. } => *low = low.checked_sub(more).expect("a small amount"),
                }
                tells_levels = false;
            }
            let is_right = !all.is_empty()
                && has_fitting_uses(&network, &plan)
                && !before.has_circle()
                && accepts_states(&network, &plan, &before)
                && tells_levels;
            let verdict = check_plan(&network, &plan);
            let expected = is_right && is_within;
            assert_eq!(verdict.valid, expected, "mission {seed}: {plan:?}\n{:#?}", verdict.violations);
            accepted += usize::from(expected);
            refused += usize::from(!is_right);
            refused_for_resources += usize::from(is_right && !is_within);
            if !expected {
                continue;
            }
            // Every schedule of a plan that is accepted keeps every rule.
            for _ in 0..5 {
                let Some(schedule) = pick(&mut rng, &all) else { break };
                let verdict = check_schedule(&network, &plan, &times(&plan, schedule));
                assert!(verdict.valid, "mission {seed}: {schedule:?} {:#?}", verdict.violations);
            }
        }
    }
    assert!(
        accepted > 500 && refused > 500 && refused_for_resources > 100,
        "{accepted} plans were accepted, {refused} refused, {refused_for_resources} for their resources"
    );
}

#[test]
fn verdicts_on_schedules_with_state_and_resources_are_those_of_brute_force() {
    let (mut accepted, mut refused) = (0, 0);
    for seed in 0..1500 {
        let network = network(&tiny_mission(seed));
        let mut rng = Rng::new(seed ^ 0xD1CE);
        let mut plan = random_plan(&network, &mut rng);
        plan.causal_links.clear();
        plan.state_order.clear();
        plan.orderings_added.clear();
        plan.uses_ordered.clear();
        let Some(all) = schedules(&network, &plan, HORIZON, 40 * MANY) else { continue };
        for _ in 0..10 {
            let Some(schedule) = pick(&mut rng, &all) else { break };
            let keeps = |places: &Schedule| {
                accepts_states_at(&network, &plan, places) && accepts_resources_at(&network, &plan, places)
            };
            let Some(expected) = some_order_keeps(&network, &plan, schedule, MANY_ORDERS, keeps) else {
                continue;
            };
            let verdict = check_schedule(&network, &plan, &times(&plan, schedule));
            assert_eq!(verdict.valid, expected, "mission {seed}: {schedule:?} {:#?}", verdict.violations);
            if expected {
                accepted += 1;
            } else {
                refused += 1;
            }
        }
    }
    assert!(accepted > 500 && refused > 500, "{accepted} schedules were accepted and {refused} refused");
}
