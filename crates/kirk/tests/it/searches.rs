//! Both searches on random missions: the same answers, and what must not change them.

use std::collections::BTreeSet;

use crate::support::{NamedPlan, named, network, options, plan};
use kirk::{ExpansionLimit, Options, Search, Status, Unlimited};
use tpn::generate::{Recipe, Tightness, mission};

const TIGHTNESS: [Tightness; 3] = [Tightness::Feasible, Tightness::Boundary, Tightness::Infeasible];

#[test]
fn both_searches_and_the_traced_one_find_the_same_first_plan() {
    for seed in 0..60 {
        for tightness in TIGHTNESS {
            let recipe = Recipe { nodes: 20 + seed as usize, tightness, seed };
            let network = network(&mission(recipe));
            let limit = &mut ExpansionLimit(20_000);
            let chronological = kirk::plan(&network, &options(Search::Chronological, false), limit);
            let directed = plan(&network, Search::ConflictDirected, false);
            if chronological.status != Status::Limit {
                assert_eq!(chronological.status, directed.status, "{recipe:?}");
                assert_eq!(chronological.plans, directed.plans, "{recipe:?}");
            }
            let traced = Options { trace_events: Some(1000), ..options(Search::ConflictDirected, false) };
            let traced = kirk::plan(&network, &traced, &mut Unlimited);
            assert_eq!((traced.status, &traced.plans), (directed.status, &directed.plans), "{recipe:?}");
            let expected = if tightness == Tightness::Infeasible { Status::NoPlan } else { Status::Plan };
            assert_eq!(directed.status, expected, "{recipe:?}");
        }
    }
}

#[test]
fn both_searches_enumerate_the_same_plans() {
    for seed in 0..60 {
        let recipe = Recipe { nodes: 16, tightness: Tightness::Boundary, seed };
        let network = network(&mission(recipe));
        let all = |search| {
            let outcome = plan(&network, search, true);
            let plans: Vec<NamedPlan> = outcome.plans.iter().map(|plan| named(&network, plan)).collect();
            let distinct: BTreeSet<NamedPlan> = plans.iter().cloned().collect();
            assert_eq!(distinct.len(), plans.len(), "{recipe:?}: a plan twice");
            plans
        };
        assert_eq!(all(Search::Chronological), all(Search::ConflictDirected), "{recipe:?}");
    }
}

#[test]
fn a_failure_that_only_gaps_cause_rests_on_every_choice() {
    // Two intervals fit only where the choices force them to touch others. The gaps that they lack otherwise are those
    // of two orders at once, and no bound of the choice that helps is part of that contradiction.
    let text = "var MODE : {A, B, C};
scenario S[0,9] = {
  { delay[0,inf]; MODE=B [0,0]; delay[6,6] },
  { choose { delay[0,inf], delay[7,7] }; MODE=A [1,3] },
  { choose { delay[0,inf], delay[0,0] }; MODE=A [2,2] },
  { delay[3,3]; MODE=A [3,3] }
}";
    let network = network(text);
    let all = |search| plan(&network, search, true).plans;
    let plans = all(Search::Chronological);
    assert!(plans.iter().any(|plan| plan.choices.iter().any(|choice| choice.alternative == 1)), "{plans:#?}");
    assert_eq!(all(Search::ConflictDirected), plans);
}

#[test]
fn pairs_that_touch_are_ordered_in_textual_order() {
    // Both uses of C follow B: the second one, ordered first, would force B to touch the first one, which then needs no
    // gap. In textual order the first one asks for the gap, and there is no plan.
    let text = "var MODE : {A, B, C};
scenario S[0,7] = {
  { choose { delay[4,4], delay[0,4], delay[3,3] }; MODE=C [2,2] },
  { delay[5,5]; MODE=C [2,2] },
  { delay[0,inf]; MODE=B [3,3] }
}";
    let mut network = network(text);
    network.threat_gap = exact::Time::from(2);
    assert_eq!(plan(&network, Search::Chronological, false).status, Status::NoPlan);
    assert_eq!(plan(&network, Search::ConflictDirected, false).status, Status::NoPlan);
}

#[test]
fn networks_without_their_program_are_planned_the_same() {
    for seed in 100..140 {
        for tightness in TIGHTNESS {
            let recipe = Recipe { nodes: 30, tightness, seed };
            let with_blocks = network(&mission(recipe));
            let mut without = with_blocks.clone();
            without.blocks.clear();
            without.root = None;
            let expected = plan(&with_blocks, Search::ConflictDirected, false);
            let found = plan(&without, Search::ConflictDirected, false);
            assert_eq!((found.status, found.plans), (expected.status, expected.plans), "{recipe:?}");
        }
    }
}

#[test]
fn time_scales() {
    for seed in 200..230 {
        let recipe = Recipe { nodes: 40, tightness: Tightness::Boundary, seed };
        let original = network(&mission(recipe));
        let mut scaled = original.clone();
        let longer = |time: exact::Time| {
            time.checked_mul(7).and_then(|time| time.checked_div(3)).expect("a small time")
        };
        for arc in &mut scaled.arcs {
            arc.lower = longer(arc.lower);
            if let exact::Bound::Finite(upper) = &mut arc.upper {
                *upper = longer(*upper);
            }
        }
        scaled.threat_gap = longer(scaled.threat_gap);
        let expected = plan(&original, Search::ConflictDirected, false);
        let found = plan(&scaled, Search::ConflictDirected, false);
        assert_eq!(found.plans.len(), expected.plans.len(), "{recipe:?}");
        for (found, expected) in found.plans.iter().zip(&expected.plans) {
            assert_eq!(found.choices, expected.choices, "{recipe:?}");
            assert_eq!(found.conflict_order, expected.conflict_order, "{recipe:?}");
            for (found, expected) in found.windows.iter().zip(&expected.windows) {
                let (Some(found), Some(expected)) = (found, expected) else {
                    assert_eq!(found.is_some(), expected.is_some(), "{recipe:?}");
                    continue;
                };
                assert_eq!(found.earliest, longer(expected.earliest), "{recipe:?}");
                assert_eq!(found.latest.finite(), expected.latest.finite().map(longer), "{recipe:?}");
            }
        }
    }
}

#[test]
fn times_that_do_not_fit_are_an_error_and_not_a_wrong_answer() {
    let huge = i64::MAX / 2;
    let text = format!("scenario S = {{ delay[{huge},{huge}]; delay[{huge},{huge}]; delay[{huge},{huge}] }}");
    let network = network(&text);
    for search in [Search::ConflictDirected, Search::Chronological] {
        let outcome = plan(&network, search, false);
        assert_eq!((outcome.status, outcome.plans.len()), (Status::Error, 0));
        // Two of the delays fit: only the third one's end is too late.
        let message = outcome.unplannable_message(&network).expect("a time does not fit");
        assert!(message.ends_with("that of delay#3.end"), "{message}");
    }
}

#[test]
fn a_search_stops_when_it_is_told_to() {
    let text = "scenario S[0,100] = { choose { MODE=A [80,80], MODE=B [5,5] }, MODE=B [80,80] }";
    let network = network(text);
    let stopped = kirk::plan(&network, &options(Search::Chronological, false), &mut ExpansionLimit(0));
    assert_eq!((stopped.status, stopped.plans.len()), (Status::Limit, 0));
    let mut asked = 0;
    let mut cancel = |_: &kirk::Stats| {
        asked += 1;
        asked > 1
    };
    let stopped = kirk::plan(&network, &options(Search::Chronological, false), &mut cancel);
    assert_eq!(stopped.status, Status::Limit);
}
