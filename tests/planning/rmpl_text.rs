//! Networks written in RMPL mean what they meant: the same plans, with the same windows, or the event at which they do
//! not nest.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use acceptance::mission::{all_plans, network};
use acceptance::random::{crowded_mission, small_mission, timed_mission};
use interchange::Source;
use interchange::plan_schema::{self, Document};
use interchange::rmpl_text;
use kirk::{Search, Status};
use tpn::generate::{Recipe, Tightness, mission};
use tpn::{Network, OccurrenceKind, network_json};

/// The windows of one plan's activities, by event.
type Windows = BTreeMap<String, String>;

/// By plan: the windows of its activities, by their names and the order in which a plan has them.
fn windows(network: &Network) -> BTreeSet<Windows> {
    let outcome = all_plans(network, Search::ConflictDirected);
    assert_ne!(outcome.status, Status::Limit);
    let of_plan = |plan: &tpn::Plan| {
        let activities = network.occurrences.iter().filter(|found| found.kind == OccurrenceKind::Primitive);
        let mut windows = Windows::new();
        for found in activities {
            for (end, node) in [("start", found.start), ("end", found.end)] {
                let is_selected = found.arc.is_some_and(|arc| plan.selected_arcs[arc.index()]);
                if is_selected && let Some(window) = &plan.windows[node.index()] {
                    windows.insert(format!("{}.{end}", found.name), format!("{window:?}"));
                }
            }
        }
        windows
    };
    outcome.plans.iter().map(of_plan).collect()
}

fn written(network: &Network) -> String {
    rmpl_text::write(network, &[]).unwrap_or_else(|obstacle| panic!("{}", obstacle.told(network, &[], &[])))
}

#[test]
fn random_missions_come_back_from_both_formats_with_the_same_plans() {
    let mut with_plan = 0;
    let small = (0..600).map(|seed| (format!("small {seed}"), small_mission(seed)));
    let timed = (0..300).map(|seed| (format!("timed {seed}"), timed_mission(seed)));
    let crowded = (0..100).map(|seed| (format!("crowded {seed}"), crowded_mission(seed)));
    for (name, text) in small.chain(timed).chain(crowded) {
        let one = network(&text);
        let plans = windows(&one);
        let json = network_json::network_to_json(&one);
        let ours = network_json::network_from_json(&json).expect("our own network");
        let again = written(&ours);
        assert_eq!(windows(&network(&again)), plans, "{name}\n{text}\n{again}");
        let theirs = Document::parse(&plan_schema::write(&one).to_string()).expect("plan-schema").network;
        let again = written(&theirs);
        assert_eq!(windows(&network(&again)), plans, "{name}, plan-schema\n{text}\n{again}");
        with_plan += usize::from(!plans.is_empty());
    }
    assert!(with_plan > 300, "only {with_plan} missions have a plan");
}

#[test]
fn larger_missions_come_back_too() {
    for seed in 0..12 {
        let tightness = [Tightness::Feasible, Tightness::Boundary, Tightness::Infeasible][seed as usize % 3];
        let one = network(&mission(Recipe { nodes: 80, tightness, seed }));
        let again = network(&written(&one));
        let first = |network: &Network| {
            let outcome = acceptance::mission::first_plan(network, Search::Chronological);
            outcome.plans.len()
        };
        assert_eq!(first(&again), first(&one), "seed {seed}");
        assert_eq!(again.decisions.len(), one.decisions.len());
    }
}

#[test]
fn bounds_across_blocks_definitions_and_conditions_come_back() {
    let text = "var LIGHT : {ON, OFF, DIM};
        Visit(a)[l,u] = { Drive(a)[1,10]; { Look(a)[2,3], { delay[0,4]; Dig(a) contingent [1,2] } }[0,9] as Work }
        scenario Day[0,60] = {
          { delay[0,inf]; Visit(Rock)[3,20] as One; do Rest()[1,5] maintaining LIGHT in {ON, DIM} as Nap },
          { tell LIGHT=ON [30,50] },
          { do { Wait()[1,2] as Idle; Wait()[2,3] } watching GO_AHEAD; Visit(Hill)[0,30] as Two }
        }
        constrain Idle.end to Nap.start [2,40];
        constrain One.start to Two.start [0,30];";
    let one = network(text);
    let again = written(&one);
    assert!(
        again.contains("Visit()") && again.contains("constrain") && again.contains("contingent"),
        "{again}"
    );
    let plans = windows(&one);
    assert!(!plans.is_empty());
    assert_eq!(windows(&network(&again)), plans, "{again}");
}

#[test]
fn networks_of_other_tools_are_written_or_say_what_is_in_the_way() {
    for name in
        ["choose-time.example.tpn.edn", "seattle-v1.tpn.json", "seattle-v1.tpn.edn", "first2.tpn.json"]
    {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/tpn").join(name);
        let Ok(text) = std::fs::read_to_string(&path) else { continue };
        let one = Source::read(&text).expect("a network").into_network();
        let again = written(&one);
        let back = network(&again);
        assert_eq!(back.decisions.len(), one.decisions.len(), "{name}\n{again}");
        let ends = |network: &Network| -> BTreeSet<String> {
            let outcome = all_plans(network, Search::ConflictDirected);
            let end =
                |plan: &tpn::Plan| plan.windows[network.end.index()].map(|window| format!("{window:?}"));
            outcome.plans.iter().filter_map(end).collect()
        };
        assert_eq!(ends(&back), ends(&one), "{name}\n{again}");
    }
}

#[test]
fn what_does_not_nest_is_named() {
    // N: b continues to both ends of what a and c part into.
    let arcs = [("ac", "a", "c"), ("ad", "a", "d"), ("bd", "b", "d")];
    let mut file = serde_json::json!({
        "network-id": "net", "net": { "tpn-type": "network", "begin-node": "s", "end-node": "e" },
        "s": { "tpn-type": "p-begin", "activities": ["sa", "sb"], "constraints": [] },
        "e": { "tpn-type": "p-end", "activities": [], "constraints": [] },
    });
    for (name, outs) in [("a", vec!["ac", "ad"]), ("b", vec!["bd"]), ("c", vec!["ce"]), ("d", vec!["de"])] {
        file[name] = serde_json::json!({ "tpn-type": "state", "activities": outs, "constraints": [] });
    }
    for (name, _, to) in
        arcs.into_iter().chain([("sa", "s", "a"), ("sb", "s", "b"), ("ce", "c", "e"), ("de", "d", "e")])
    {
        file[name] =
            serde_json::json!({ "tpn-type": "activity", "name": name, "end-node": to, "constraints": [] });
    }
    let read = Document::parse(&file.to_string()).expect("a network");
    let obstacle = rmpl_text::write(&read.network, &[]).expect_err("it does not nest");
    let told = obstacle.told(&read.network, &read.node_uids, &read.arc_uids);
    assert_eq!(told, "the node `d` joins arcs that did not branch at a single event (`ad`, `bd`)");
}

#[test]
fn what_the_notation_cannot_say_back_is_refused_by_name() {
    for (text, told) in [
        (
            "state ARM : {IN, OUT} = IN; scenario S = { ARM=OUT [1,2] }",
            "`ARM` is a state variable, which keeps its value",
        ),
        (
            "resource Power; primitive A()[1,2] uses Power; scenario S = { A() }",
            "the network uses the resource `Power`",
        ),
        (
            "primitive A()[1,2] costs 3; objective minimize cost; scenario S = { A() }",
            "the network has costs, rewards or an objective",
        ),
    ] {
        let network = network(text);
        let obstacle = rmpl_text::write(&network, &[]).expect_err(text);
        assert_eq!(obstacle.told(&network, &[], &[]), told);
    }
}

#[test]
fn names_of_other_tools_become_names_and_are_told() {
    let text = r#"{"network-id": "n", "n": {"tpn-type": "network", "begin-node": "a", "end-node": "c"},
        "a": {"tpn-type": "state", "activities": ["x"]}, "b": {"tpn-type": "state", "activities": ["y"]},
        "c": {"tpn-type": "state", "activities": []},
        "x": {"tpn-type": "activity", "name": "drive to\n1", "args": ["the rock", 2, "choose"], "end-node": "b"},
        "y": {"tpn-type": "activity", "name": "drive.to_1", "end-node": "c"}}"#;
    let network = Document::parse(text).expect("a network").network;
    let text = written(&network);
    let again = acceptance::mission::network(&text);
    let names: Vec<&str> = again.occurrences.iter().map(|found| found.activity.as_str()).collect();
    assert_eq!(names, ["scenario", "drive_to_1", "drive_to_1-2"], "{text}");
    assert!(text.contains("// drive_to_1 is “drive to 1” in the network."), "{text}");
    assert!(text.contains("drive_to_1(the_rock, 2, choose_)"), "{text}");
}
