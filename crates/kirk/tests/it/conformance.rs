//! The planning cases of the conformance suite, with both searches.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::support::{NamedPlan, named, network, options, plan};
use kirk::{Options, Search, Status, Unlimited};
use serde_json::Value;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/conformance")
}

fn cases(kind: &str) -> Vec<(String, Value)> {
    let mut cases = Vec::new();
    for entry in std::fs::read_dir(folder()).expect("the suite is there") {
        let path = entry.expect("readable").path();
        if path.extension().is_some_and(|extension| extension == "json") {
            let text = std::fs::read_to_string(&path).expect("readable");
            let case: Value = serde_json::from_str(&text).expect("JSON");
            if case["kind"] == kind {
                cases.push((case["id"].as_str().expect("an id").to_owned(), case));
            }
        }
    }
    cases.sort_by(|left, right| left.0.cmp(&right.0));
    cases
}

fn text(case: &Value) -> String {
    let program = case["program"].as_str().expect("a program");
    std::fs::read_to_string(folder().join(program)).expect("readable")
}

fn time(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

fn expected(plan: &Value) -> NamedPlan {
    let name = |value: &Value| value.as_str().expect("a name").to_owned();
    let array = |value: &Value| value.as_array().expect("an array").clone();
    NamedPlan {
        choices: plan["choices"]
            .as_object()
            .expect("choices")
            .iter()
            .map(|(decision, alternative)| (decision.clone(), alternative.as_u64().expect("a number")))
            .collect(),
        causal_links: array(&plan["causal_links"])
            .iter()
            .map(|link| (name(&link["ask"]), name(&link["tell"])))
            .collect(),
        conflict_order: array(&plan["conflict_order"])
            .iter()
            .map(|pair| (name(&pair[0]), name(&pair[1])))
            .collect(),
        windows: plan["windows"]
            .as_object()
            .expect("windows")
            .iter()
            .map(|(event, window)| (event.clone(), (time(&window[0]), time(&window[1]))))
            .collect::<BTreeMap<_, _>>(),
    }
}

#[test]
fn both_searches_find_the_canonical_plan_and_all_plans_of_every_case() {
    let cases = cases("tpn-plan");
    assert!(cases.len() >= 10, "only {} cases", cases.len());
    for (id, case) in cases {
        let network = network(&text(&case));
        for search in [Search::Chronological, Search::ConflictDirected] {
            let outcome = plan(&network, search, false);
            let expect = &case["expect"];
            if expect["plan_exists"] == false {
                assert_eq!(outcome.status, Status::NoPlan, "{id}, {search:?}");
                continue;
            }
            assert_eq!(outcome.status, Status::Plan, "{id}, {search:?}");
            assert_eq!(
                named(&network, &outcome.plans[0]),
                expected(&expect["canonical"]),
                "{id}, {search:?}"
            );
            let all = plan(&network, search, true);
            let found: Vec<NamedPlan> = all.plans.iter().map(|plan| named(&network, plan)).collect();
            assert_eq!(found.first(), Some(&expected(&expect["canonical"])), "{id}, {search:?}");
            let found: BTreeSet<NamedPlan> = found.into_iter().collect();
            let wanted: BTreeSet<NamedPlan> =
                expect["all_plans"].as_array().expect("plans").iter().map(expected).collect();
            // A case may list the first of its plans only; the count is of all.
            assert!(found.is_superset(&wanted), "{id}, {search:?}");
            assert_eq!(
                Some(all.plans.len() as u64),
                expect["num_distinct_plans"].as_u64(),
                "{id}, {search:?}"
            );
        }
    }
}

#[test]
fn jumping_back_visits_two_leaves_where_chronological_search_visits_seventeen() {
    let case = std::fs::read_to_string(folder().join("b01_backjump_small.rmpl")).expect("readable");
    let network = network(&case);
    assert_eq!(plan(&network, Search::Chronological, false).stats.leaves, 17);
    // The recorded search jumps back as the paper's steps go; the plain one looks ahead as well.
    let recorded = Options { trace_events: Some(10_000), ..options(Search::ConflictDirected, false) };
    assert_eq!(kirk::plan(&network, &recorded, &mut Unlimited).stats.leaves, 2);
    assert!(plan(&network, Search::ConflictDirected, false).stats.leaves <= 2);
}
