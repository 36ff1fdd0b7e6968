//! The dispatchable form of a plan, and what partial execution leaves of it, as the suite says.

use std::path::Path;

use exact::{Bound, Time};
use executive::{Observations, PlanNetwork, Progress, progress};
use kirk::{Options, Unlimited};
use serde_json::Value;
use tpn::compile::{Top, compile};
use tpn::{Network, NodeId, Plan};

fn suite(file: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/conformance");
    std::fs::read_to_string(folder.join(file)).expect("the suite is there")
}

fn planned(source: &str) -> (Network, Plan) {
    let network = compile(&rmpl::parse(source).program(), &Top::Scenario(None)).0.expect("it compiles");
    let plan = kirk::plan(&network, &Options::default(), &mut Unlimited).plans.remove(0);
    (network, plan)
}

fn node(network: &Network, name: &str) -> NodeId {
    let named = |node: &tpn::Node| node.events.iter().any(|&event| network.event_name(event) == name);
    NodeId::from_index(network.nodes.iter().position(named).unwrap_or_else(|| panic!("no event {name}")))
}

#[test]
fn the_papers_scenario_has_eight_components_and_nineteen_of_fifty_six_edges() {
    let case: Value = serde_json::from_str(&suite("x01_execution_windows.json")).expect("JSON");
    let (network, plan) = planned(&suite("t01_enroute_scenario.rmpl"));
    let mut made = PlanNetwork::new(&network, &plan).expect("a plan");
    let points: Vec<stn::PointId> = made.all_points().collect();
    let form = stn::dispatchable(&made.stn.all_pairs().expect("small numbers"), &points);
    let expected = &case["dispatch"];
    assert_eq!(Some(form.components.len() as u64), expected["rigid_components"].as_u64());
    assert_eq!(Some(form.num_edges_before_pruning as u64), expected["apsp_edges"].as_u64());
    assert_eq!(Some(form.edges.len() as u64), expected["minimal_dispatchable_edges"].as_u64());
}

#[test]
fn windows_after_partial_execution_are_those_of_the_suite() {
    let case: Value = serde_json::from_str(&suite("x01_execution_windows.json")).expect("JSON");
    for update in case["expect"]["updates"].as_array().expect("updates") {
        let (network, plan) = planned(&suite(update["program"].as_str().expect("a program")));
        let time = |value: &Value| Time::from(value.as_i64().expect("a whole number"));
        let executed = update["executed"].as_object().expect("times").iter();
        let executed = executed.map(|(event, value)| (node(&network, event), time(value))).collect();
        let observed = Observations { executed, now: time(&update["now"]) };
        let title = &update["title"];
        match progress(&network, &plan, &observed).expect("small numbers") {
            Progress::Violated(reasons) => {
                assert_eq!(update["consistent"], false, "{title}");
                assert!(!reasons.is_empty(), "{title}");
            }
            Progress::Consistent(windows, _) => {
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
    let (network, plan) = planned("primitive A()[1,3]; primitive B()[2,5]; scenario S[4,6] = { A(); B() }");
    let half = Time::new(5, 2).expect("a fraction");
    let observed = Observations { executed: vec![(node(&network, "A#1.end"), half)], now: half };
    let Ok(Progress::Consistent(windows, _)) = progress(&network, &plan, &observed) else {
        panic!("consistent")
    };
    let end = windows[node(&network, "B#1.end").index()].expect("selected");
    assert_eq!((end.earliest, end.latest), (Time::new(9, 2).expect("a fraction"), Bound::Finite(6.into())));
}
