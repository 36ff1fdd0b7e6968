//! Networks of other tools, which do not say how they are nested.

use crate::support::{network, options};
use exact::{Bound, Time};
use interchange::Source;
use kirk::{Search, Status, Unlimited, Unplannable};
use tpn::generate::{Recipe, Tightness, mission};
use tpn::{Choice, DecisionId, Network, Window};

/// The network as another tool would give it.
fn without_blocks(mut network: Network) -> Network {
    network.root = None;
    network.blocks.clear();
    network
}

#[test]
fn where_choices_end_is_found_in_a_network_without_blocks() {
    let mut plans = 0;
    for seed in 0..40 {
        for tightness in [Tightness::Feasible, Tightness::Boundary, Tightness::Infeasible] {
            // What is worth most is only planned where choices are known to nest.
            let text = format!("objective minimize end; {}", mission(Recipe { nodes: 18, tightness, seed }));
            let nested = network(&text);
            let options = options(Search::ConflictDirected, false);
            let expected = kirk::plan(&nested, &options, &mut Unlimited);
            let found = kirk::plan(&without_blocks(nested.clone()), &options, &mut Unlimited);
            assert_eq!(found.status, expected.status, "{text}");
            for (found, expected) in found.plans.iter().zip(&expected.plans) {
                plans += 1;
                let verdict = verify::check_plan(&nested, found);
                assert!(verdict.violations.is_empty(), "{verdict:?}\n{text}");
                let end = |plan: &tpn::Plan| plan.windows[nested.end.index()].map(|window| window.earliest);
                assert_eq!(end(found), end(expected), "{text}");
            }
        }
    }
    assert!(plans > 60, "{plans} plans");
}

/// Two activities between open delays, in a quarter of an hour; the second begins five minutes after the first.
fn threads(first: &str) -> String {
    format!(
        r#"{{ "net": {{ "tpn-type": "network", "begin-node": "b", "end-node": "e" }},
        "b": {{ "tpn-type": "p-begin", "end-node": "e", "constraints": ["whole"], "activities": ["wait1", "wait2"] }},
        "e": {{ "tpn-type": "p-end" }},
        "whole": {{ "tpn-type": "temporal-constraint", "end-node": "e", "value": [0, 15] }},
        "wait1": {{ "tpn-type": "delay-activity", "end-node": "s1" }},
        {first},
        "rest1": {{ "tpn-type": "delay-activity", "end-node": "e" }},
        "wait2": {{ "tpn-type": "delay-activity", "end-node": "s2" }},
        "s2": {{ "tpn-type": "state", "activities": ["second"] }},
        "second": {{ "tpn-type": "activity", "name": "second", "end-node": "e2" }},
        "e2": {{ "tpn-type": "state", "activities": ["rest2"] }},
        "rest2": {{ "tpn-type": "delay-activity", "end-node": "e" }},
        "apart": {{ "tpn-type": "temporal-constraint", "end-node": "s2", "value": [5, 5], "between-threads": true }} }}"#
    )
}

fn read(text: &str) -> Network {
    Source::read(text).expect("is a network").into_network()
}

/// A choice after the first delay whose second alternative continues at `second`.
fn choice(second: &str) -> String {
    threads(&format!(
        r#""s1": {{ "tpn-type": "c-begin", "end-node": "e1", "constraints": ["apart"], "activities": ["one", "other"] }},
        "one": {{ "tpn-type": "activity", "name": "one", "end-node": "e1" }},
        "other": {{ "tpn-type": "activity", "name": "other", "end-node": "{second}" }},
        "e1": {{ "tpn-type": "c-end", "activities": ["rest1"] }}"#
    ))
}

#[test]
fn constraints_between_threads_are_planned_beside_open_delays_and_choices() {
    let plain = threads(
        r#""s1": { "tpn-type": "state", "activities": ["first"], "constraints": ["apart"] },
        "first": { "tpn-type": "activity", "name": "first", "end-node": "e1" },
        "e1": { "tpn-type": "state", "activities": ["rest1"] }"#,
    );
    for text in [plain, choice("e1")] {
        let network = read(&text);
        let outcome = kirk::plan(&network, &options(Search::ConflictDirected, false), &mut Unlimited);
        assert_eq!(outcome.status, Status::Plan, "{:?}", outcome.unplannable);
        let constraint = network.constraints().next().expect("there is one between threads");
        let arc = &network.arcs[constraint.index()];
        let window = |earliest: i64, latest: i64| {
            Some(Window { earliest: Time::from(earliest), latest: Bound::Finite(Time::from(latest)) })
        };
        let windows = &outcome.plans[0].windows;
        assert_eq!((windows[arc.from.index()], windows[arc.to.index()]), (window(0, 10), window(5, 15)));
    }
}

#[test]
fn choices_that_do_not_nest_are_refused_for_what_they_are() {
    // The second alternative continues where the other thread waits.
    let network = read(&choice("s2"));
    let outcome = kirk::plan(&network, &options(Search::ConflictDirected, false), &mut Unlimited);
    assert_eq!((outcome.status, outcome.unplannable), (Status::Error, Some(Unplannable::Entangled)));
    let message = outcome.unplannable_message(&network).expect("there is one");
    assert!(message.contains("not nested"), "{message}");
}

#[test]
fn plans_that_are_not_wanted_are_left_out_where_choices_do_not_nest() {
    let network = read(&choice("s2").replace(r#", "constraints": ["apart"]"#, ""));
    let mut excluded: Vec<Vec<Choice>> = Vec::new();
    for alternative in 0..2 {
        let options = options(Search::ConflictDirected, false);
        let outcome = kirk::plan_except(&network, &options, &excluded, &mut Unlimited);
        let plan =
            outcome.plans.first().unwrap_or_else(|| panic!("{:?}", outcome.unplannable_message(&network)));
        assert_eq!(plan.choices, [Choice { decision: DecisionId(0), alternative }]);
        excluded.push(plan.choices.clone());
    }
    let none =
        kirk::plan_except(&network, &options(Search::ConflictDirected, false), &excluded, &mut Unlimited);
    assert_eq!((none.status, none.plans.len()), (Status::NoPlan, 0));
}
