//! Networks across file formats: our own JSON, and plan-schema as other tools write it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use acceptance::mission::{all_plans, first_plan, key, network};
use acceptance::random::small_mission;
use interchange::plan_schema::{self, Document, PlanSchemaError};
use kirk::Search;
use serde_json::{Value, json};
use tpn::{ArcKind, network_json};

/// The files that other tools wrote; `None`, said aloud, where this machine does not have them.
#[expect(clippy::print_stdout, reason = "a test that does not run says so")]
fn shared(name: &str) -> Option<String> {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/tpn").join(name);
    let text = std::fs::read_to_string(&path).ok();
    if text.is_none() {
        println!("not run, data absent: {}", path.display());
    }
    text
}

#[test]
fn the_seattle_network_is_the_same_in_json_and_edn_and_has_a_plan() {
    let (Some(json), Some(edn)) = (shared("seattle-v1.tpn.json"), shared("seattle-v1.tpn.edn")) else {
        return;
    };
    let (from_json, from_edn) = (Document::parse(&json).expect("JSON"), Document::parse(&edn).expect("EDN"));
    for document in [&from_json, &from_edn] {
        let network = &document.network;
        // 50 nodes and 60 arcs of the file; its constraints are durations of activities.
        assert_eq!(network.decisions.len(), 4);
        let count = |kind: ArcKind| network.arcs.iter().filter(|arc| arc.kind == kind).count();
        assert_eq!(count(ArcKind::Activity), 24);
        assert_eq!(document.node_uids.iter().flatten().count(), 36 + 4 + 4 + 3 + 3);
        assert_eq!(first_plan(network, Search::Chronological).plans.len(), 1);
        assert_eq!(first_plan(network, Search::ConflictDirected).plans.len(), 1);
    }
    // Sets have no order, so only what does not depend on one is compared.
    let durations = |document: &Document| {
        let arcs = document.network.arcs.iter().filter(|arc| arc.kind == ArcKind::Activity);
        let mut all: Vec<String> = arcs
            .map(|arc| {
                let name =
                    &document.network.occurrences[arc.occurrence.expect("an activity").index()].activity;
                format!("{name} {:?} {:?}", arc.lower, arc.upper)
            })
            .collect();
        all.sort();
        all
    };
    assert_eq!(durations(&from_json), durations(&from_edn));
    assert_eq!(from_json.objects.len(), from_edn.objects.len());
}

#[test]
fn a_constraint_between_two_branches_holds() {
    let Some(text) = shared("first2.tpn.json") else { return };
    let document = Document::parse(&text).expect("JSON");
    // From the end of the choice at least 1 to the middle of the other branch, which is over at 4 at the latest:
    // only the alternative with do-f [1,3] and do-g [2,5] is fast enough, and its end is at 3 exactly.
    let outcome = all_plans(&document.network, Search::Chronological);
    assert_eq!(outcome.plans.len(), 1);
    let plan = tpn::plan_json::plan_to_json(&document.network, &outcome.plans[0]);
    assert_eq!(plan["choices"], json!({"D1": 1}));
    assert_eq!(plan["windows"]["do-g#1.end"], json!([3, 3]));
    assert_eq!(plan["windows"]["do-a#1.end"], json!([4, 4]));
    assert_eq!(plan["windows"]["do-c#1.end"], json!([88, 93]));
    // Costs and rewards are carried along, and said to be of no consequence.
    let not_planned: BTreeSet<&str> = document.not_planned.iter().map(String::as_str).collect();
    assert_eq!(not_planned, ["costle-2013", "costle-2082", "rewardge-2014", "rewardge-2083"].into());
    assert_eq!(document.to_json(), serde_json::from_str::<Value>(&text).expect("JSON"));
}

#[test]
fn a_choice_between_delays_has_one_plan_for_each() {
    let Some(text) = shared("choose-time.example.tpn.edn") else { return };
    let document = Document::parse(&text).expect("EDN");
    let outcome = all_plans(&document.network, Search::Chronological);
    let mut ends: Vec<String> = (outcome.plans.iter())
        .map(|plan| format!("{:?}", plan.windows[document.network.end.index()].expect("selected").earliest))
        .collect();
    ends.sort();
    let mut expected: Vec<String> =
        [1, 101, 201].iter().map(|&time| format!("{:?}", exact::Time::from(time))).collect();
    expected.sort();
    assert_eq!(ends, expected);
    assert_eq!(document.to_json()["node-13"]["htn-node"], json!("hem-14"));
}

#[test]
fn broken_interchange_files_are_refused_with_the_object_at_fault() {
    let refuse = |text: &str| Document::parse(text).expect_err(text);
    assert!(matches!(refuse("scenario S = {}"), PlanSchemaError::Notation { .. }));
    assert!(matches!(refuse("[]"), PlanSchemaError::Shape(_)));
    assert!(matches!(refuse("{}"), PlanSchemaError::Shape(_)));
    let dangling = r#"{"network-id": "n", "n": {"tpn-type": "network", "begin-node": "a"}}"#;
    assert_eq!(refuse(dangling), PlanSchemaError::Dangling { from: "n".into(), to: "a".into() });
    let bounds = r#"{"network-id": "n", "n": {"tpn-type": "network", "begin-node": "a"},
        "a": {"tpn-type": "state", "activities": ["x"]}, "b": {"tpn-type": "state", "activities": []},
        "x": {"tpn-type": "activity", "name": "X", "end-node": "b", "constraints": ["c"]},
        "c": {"tpn-type": "temporal-constraint", "value": [5, 3], "end-node": "b"}}"#;
    assert!(matches!(refuse(bounds), PlanSchemaError::Bounds { uid, .. } if uid == "c"));
}

#[test]
fn infinity_is_read_in_every_spelling() {
    for upper in ["\"Infinity\"", "\"infinity\"", "\"inf\""] {
        let text = format!(
            r#"{{"network-id": "n", "n": {{"tpn-type": "network", "begin-node": "a"}},
            "a": {{"tpn-type": "state", "activities": ["x"]}}, "b": {{"tpn-type": "state"}},
            "x": {{"tpn-type": "activity", "name": "X", "end-node": "b", "constraints": ["c"]}},
            "c": {{"tpn-type": "temporal-constraint", "value": [2.5, {upper}], "end-node": "b"}}}}"#
        );
        let network = Document::parse(&text).expect("a network").network;
        assert_eq!(Some(network.arcs[0].lower), exact::Time::new(5, 2));
        assert_eq!(network.arcs[0].upper, exact::Bound::Infinite);
    }
    let edn = "{:network-id :n :n {:tpn-type :network :begin-node :a} :a {:tpn-type :state :activities #{:x}}
        :b {:tpn-type :state} :x {:tpn-type :activity :command \"X\" :end-node :b :constraints #{:c}}
        :c {:tpn-type :temporal-constraint :value [0 :infinity] :end-node :b}}";
    assert_eq!(Document::parse(edn).expect("EDN").network.arcs[0].upper, exact::Bound::Infinite);
}

/// Seeds of missions to send through a format.
const SEEDS: std::ops::Range<u64> = 0..400;

#[test]
fn a_network_in_our_json_is_planned_as_before() {
    let mut with_plan = 0;
    for seed in SEEDS {
        let network = network(&small_mission(seed));
        let written = network_json::network_to_json(&network);
        let read =
            network_json::network_from_json(&written).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        assert_eq!(network_json::network_to_json(&read), written, "seed {seed}");
        let plans = |network: &tpn::Network| -> Vec<_> {
            let outcome = all_plans(network, Search::ConflictDirected);
            outcome.plans.iter().map(|plan| tpn::plan_json::plan_to_json(network, plan)).collect()
        };
        let before = plans(&network);
        assert_eq!(plans(&read), before, "seed {seed}");
        with_plan += usize::from(!before.is_empty());
    }
    assert!(with_plan > 50, "only {with_plan} missions have plans");
}

#[test]
fn a_network_without_our_extra_members_is_read_by_its_events_alone() {
    let network = network(
        "scenario S[0,9] = { { delay[0,4]; A()[1,2] }, c [5,5], { delay[1,1]; do B()[2,3] maintaining c } }",
    );
    let mut written = network_json::network_to_json(&network);
    let members = written.as_object_mut().expect("an object");
    members.remove("occurrences");
    members.remove("variables");
    members.remove("threat_gap");
    let read = network_json::network_from_json(&written).expect("a network");
    let plans = |network: &tpn::Network| {
        let outcome = first_plan(network, Search::Chronological);
        tpn::plan_json::plan_to_json(network, &outcome.plans[0])
    };
    assert_eq!(plans(&read), plans(&network));
}

#[test]
fn a_network_in_plan_schema_has_as_many_plans_as_before() {
    let mut with_plan = 0;
    for seed in SEEDS {
        let text = small_mission(seed);
        let before = network(&text);
        let written = plan_schema::write(&before);
        let document =
            Document::parse(&written.to_string()).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        let found = |network: &tpn::Network| all_plans(network, Search::ConflictDirected).plans.len();
        assert_eq!(found(&document.network), found(&before), "seed {seed}\n{text}");
        with_plan += usize::from(found(&before) > 0);
    }
    assert!(with_plan > 50, "only {with_plan} missions have plans");
}

#[test]
fn plan_schema_nodes_and_arcs_refer_to_each_other_both_ways() {
    for seed in SEEDS {
        let written = plan_schema::write(&network(&small_mission(seed)));
        let objects = written.as_object().expect("a map");
        let mut arcs_seen = 0;
        for (uid, object) in objects.iter().filter(|(_, object)| object.is_object()) {
            assert_eq!(object["uid"], json!(uid));
            for arc in object["activities"].as_array().into_iter().flatten() {
                let end = objects[arc.as_str().expect("a uid")]["end-node"].as_str().expect("an end");
                let entering = objects[end]["incidence-set"].as_array().expect("a list");
                assert!(entering.contains(arc), "seed {seed}: {arc} does not enter {end}");
                arcs_seen += 1;
            }
            for constraint in object["constraints"].as_array().into_iter().flatten() {
                assert_eq!(
                    objects[constraint.as_str().expect("a uid")]["tpn-type"],
                    json!("temporal-constraint")
                );
            }
        }
        assert!(arcs_seen > 0);
    }
}

#[test]
fn our_own_plan_survives_a_round_trip_by_names() {
    for seed in SEEDS {
        let network = network(&small_mission(seed));
        for plan in all_plans(&network, Search::Chronological).plans {
            let written = tpn::plan_json::plan_to_json(&network, &plan);
            let read = tpn::plan_json::plan_from_json(&network, &written).expect("our own plan");
            let same = |name: String| name;
            assert_eq!(key(&network, &read, &same), key(&network, &plan, &same), "seed {seed}");
            let verdict = verify::check_plan(&network, &read);
            assert!(verdict.valid, "seed {seed}: {:#?}", verdict.violations);
        }
    }
}
