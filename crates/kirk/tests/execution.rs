//! Plans as networks to execute, and planning again after changes.

mod support;

use std::path::Path;

use kirk::{ExpansionLimit, PlanNetwork, Planner, Remaining, Search, Status, Unlimited};
use rmpl::{Bound, Rational};
use serde_json::Value;
use support::{network, options, plan};
use tpn::generate::{Recipe, Rng, Tightness, mission};
use tpn::{ArcId, Network, NodeId};

fn suite(file: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/conformance");
    std::fs::read_to_string(folder.join(file)).expect("the suite is there")
}

fn node(network: &Network, name: &str) -> NodeId {
    let named = |node: &tpn::Node| node.events.iter().any(|&event| network.event_name(event) == name);
    NodeId::from_index(network.nodes.iter().position(named).unwrap_or_else(|| panic!("no event {name}")))
}

#[test]
fn the_papers_scenario_has_eight_components_and_nineteen_of_fifty_six_edges() {
    let case: Value = serde_json::from_str(&suite("x01_execution_windows.json")).expect("JSON");
    let network = network(&suite("t01_enroute_scenario.rmpl"));
    let outcome = plan(&network, Search::ConflictDirected, false);
    let form = PlanNetwork::new(&network, &outcome.plans[0], None).and_then(|mut plan| plan.dispatchable());
    let form = form.expect("small numbers");
    let expected = &case["dispatch"];
    assert_eq!(Some(form.components.len() as u64), expected["rigid_components"].as_u64());
    assert_eq!(Some(form.num_edges_before_pruning as u64), expected["apsp_edges"].as_u64());
    assert_eq!(Some(form.edges.len() as u64), expected["minimal_dispatchable_edges"].as_u64());
}

#[test]
fn windows_after_partial_execution_are_those_of_the_suite() {
    let case: Value = serde_json::from_str(&suite("x01_execution_windows.json")).expect("JSON");
    for update in case["expect"]["updates"].as_array().expect("updates") {
        let network = network(&suite(update["program"].as_str().expect("a program")));
        let outcome = plan(&network, Search::ConflictDirected, false);
        let mut plan = PlanNetwork::new(&network, &outcome.plans[0], None).expect("small numbers");
        let time = |value: &Value| Rational::from_integer(value.as_i64().expect("a whole number"));
        let executed: Vec<(NodeId, Rational)> = update["executed"]
            .as_object()
            .expect("times")
            .iter()
            .map(|(event, value)| (node(&network, event), time(value)))
            .collect();
        let pending: Vec<NodeId> = update["not_yet_executed"]
            .as_array()
            .expect("events")
            .iter()
            .map(|event| node(&network, event.as_str().expect("a name")))
            .collect();
        let remaining = plan.after(&executed, &pending, time(&update["now"])).expect("small numbers");
        let title = &update["title"];
        match remaining {
            Remaining::Violated(constraints) => {
                assert_eq!(update["consistent"], false, "{title}");
                assert!(!constraints.is_empty(), "{title}");
            }
            Remaining::Windows(windows) => {
                assert_eq!(update["consistent"], true, "{title}");
                for (event, expected) in update["windows"].as_object().expect("windows") {
                    let window = windows[node(&network, event).index()].expect("selected");
                    assert_eq!(window.earliest, time(&expected[0]), "{title}: {event}");
                    assert_eq!(window.latest, Bound::Finite(time(&expected[1])), "{title}: {event}");
                }
            }
        }
    }
}

#[test]
fn observations_between_the_units_of_the_mission_are_exact() {
    let network = network("primitive A()[1,3]; primitive B()[2,5]; scenario S[4,6] = { A(); B() }");
    let outcome = plan(&network, Search::ConflictDirected, false);
    let mut plan = PlanNetwork::new(&network, &outcome.plans[0], None).expect("small numbers");
    let half = Rational::new(5, 2);
    let Ok(Remaining::Windows(windows)) = plan.after(&[(node(&network, "A#1.end"), half)], &[], half) else {
        panic!("consistent")
    };
    let end = windows[node(&network, "B#1.end").index()].expect("selected");
    assert_eq!((end.earliest, end.latest), (Rational::new(9, 2), Bound::Finite(6.into())));
}

#[test]
fn planning_again_gives_the_plan_of_a_search_from_scratch_whatever_was_asked_before() {
    for seed in 0..40 {
        for tightness in [Tightness::Feasible, Tightness::Boundary] {
            let network = support::network(&mission(Recipe { nodes: 80, tightness, seed }));
            for search in [Search::Chronological, Search::ConflictDirected] {
                let mut planner = Planner::new(network.clone(), None);
                let mut random = Rng::new(seed);
                for step in 0..30 {
                    let arc = ArcId::from_index(random.below(network.arcs.len() as u64) as usize);
                    let bounds = &network.arcs[arc.index()];
                    let Some(upper) = bounds.upper.finite().filter(|_| bounds.kind == tpn::ArcKind::Activity)
                    else {
                        continue;
                    };
                    let more = Rational::from_integer(random.between(-2, 2));
                    planner.set_bounds(arc, bounds.lower, Bound::Finite((upper + more).max(bounds.lower)));
                    let options = support::options(search, false);
                    let fresh = kirk::plan(planner.network(), &options, &mut ExpansionLimit(2_000));
                    let again = planner.plan(&options, &mut ExpansionLimit(2_000));
                    if fresh.status != Status::Limit {
                        let (fresh, again) = ((fresh.status, fresh.plans), (again.status, again.plans));
                        assert_eq!(again, fresh, "{tightness:?} {seed} {search:?} {step}");
                    }
                }
            }
        }
    }
}

#[test]
fn planning_again_after_a_change_answers_as_planning_anew() {
    for seed in 0..12 {
        let recipe = Recipe { nodes: 60, tightness: Tightness::Boundary, seed };
        let original = network(&mission(recipe));
        let mut planner = Planner::new(original.clone(), None);
        let mut random = Rng::new(seed);
        for change in 0..12 {
            let arc = ArcId::from_index(random.below(original.arcs.len() as u64) as usize);
            let lower = Rational::new(random.between(0, 12), random.between(1, 2));
            let upper = Bound::Finite(lower + Rational::from_integer(random.between(0, 30)));
            planner.set_bounds(arc, lower, upper);
            let anew = plan(planner.network(), Search::ConflictDirected, false);
            let again = planner.plan(&options(Search::ConflictDirected, false), &mut Unlimited);
            assert_eq!((again.status, again.plans), (anew.status, anew.plans), "{recipe:?}, change {change}");
            if change % 3 == 2 {
                let old = &original.arcs[arc.index()];
                planner.set_bounds(arc, old.lower, old.upper);
            }
        }
    }
}
