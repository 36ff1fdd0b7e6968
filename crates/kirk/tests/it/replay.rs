//! Recorded searches, replayed.

use crate::support::network;
use kirk::{Event, Options, Replay, Search, Status, Trace, TreeStatus, Unlimited, trace_json_lines};
use tpn::Network;
use tpn::generate::{Recipe, Tightness, mission};

fn traced(network: &Network, search: Search, events: usize) -> (kirk::Outcome, Trace) {
    let options = Options { search, trace_events: Some(events), ..Options::default() };
    let mut outcome = kirk::plan(network, &options, &mut Unlimited);
    let trace = outcome.trace.take().expect("recorded");
    (outcome, trace)
}

#[test]
fn the_last_step_has_the_plan_with_its_links_orders_and_windows() {
    for seed in 0..20 {
        for search in [Search::Chronological, Search::ConflictDirected] {
            let network = network(&mission(Recipe { nodes: 30, tightness: Tightness::Boundary, seed }));
            let (outcome, trace) = traced(&network, search, 100_000);
            assert_eq!(outcome.status, Status::Plan, "seed {seed}");
            assert!(!trace.is_truncated);
            let plan = &outcome.plans[0];
            let replay = Replay::new(&network, None, &trace).expect("small numbers");
            let last = replay.at(&trace, trace.events.len());
            assert_eq!(last.windows, plan.windows, "seed {seed}, {search:?}");
            assert_eq!(last.choices, plan.choices, "seed {seed}, {search:?}");
            assert_eq!(last.links, plan.causal_links, "seed {seed}, {search:?}");
            assert_eq!(last.orders, plan.orderings_added, "seed {seed}, {search:?}");
            assert_eq!(
                last.arcs.len(),
                plan.selected_arcs.iter().filter(|&&is_selected| is_selected).count()
            );
            let statuses = trace.tree.iter().filter(|node| node.status == TreeStatus::Solution).count();
            assert_eq!(statuses, 1, "seed {seed}, {search:?}");
        }
    }
}

#[test]
fn steps_can_be_visited_in_any_order() {
    let network = network(&mission(Recipe { nodes: 24, tightness: Tightness::Infeasible, seed: 3 }));
    let (_, trace) = traced(&network, Search::Chronological, 2_000);
    let replay = Replay::new(&network, None, &trace).expect("small numbers");
    let forwards: Vec<_> = (0..trace.events.len()).step_by(7).map(|step| replay.at(&trace, step)).collect();
    for expected in forwards.iter().rev() {
        assert_eq!(replay.at(&trace, expected.step), *expected);
    }
}

/// The arcs, choices, links and orders in force after every step, kept as a stack while going through the events.
#[test]
fn a_step_has_what_the_states_that_lead_to_it_have_added() {
    for seed in [11, 12] {
        let network = network(&mission(Recipe { nodes: 40, tightness: Tightness::Infeasible, seed }));
        let (_, trace) = traced(&network, Search::Chronological, 3_000);
        let replay = Replay::new(&network, None, &trace).expect("small numbers");
        let mut stack: Vec<(u32, usize, usize)> = vec![(0, 0, 0)];
        for (step, entry) in trace.events.iter().enumerate() {
            let ancestors: Vec<u32> = std::iter::successors(Some(entry.tree_node), |&node| {
                trace.tree.get(node as usize).and_then(|node| node.parent)
            })
            .collect();
            stack.retain(|(node, ..)| ancestors.contains(node));
            if !stack.iter().any(|(node, ..)| *node == entry.tree_node) {
                stack.push((entry.tree_node, 0, 0));
            }
            let (_, arcs, choices) = stack.last_mut().expect("the present state");
            match entry.event {
                Event::AddArc { .. } => *arcs += 1,
                Event::Decide { .. } | Event::TryLink { .. } | Event::TryOrder { .. } => *choices = 1,
                _ => {}
            }
            if step % 5 == 0 {
                let replayed = replay.at(&trace, step);
                assert_eq!(replayed.arcs.len(), stack.iter().map(|(_, arcs, _)| arcs).sum::<usize>());
                let added = replayed.choices.len() + replayed.links.len() + replayed.orders.len();
                assert_eq!(added, stack.iter().map(|(.., choices)| choices).sum::<usize>(), "{seed} {step}");
            }
        }
    }
}

#[test]
fn a_failed_step_shows_its_contradiction_and_the_state_before_it() {
    let text =
        "primitive Long()[30,40]; primitive Short()[5,10]; scenario S[0,20] = { choose { Long(), Short() } }";
    let network = network(text);
    let (_, trace) = traced(&network, Search::Chronological, 1_000);
    let failed = trace.events.iter().position(|entry| matches!(entry.event, Event::Inconsistent { .. }));
    let failed = failed.expect("the first alternative is too long");
    let step = Replay::new(&network, None, &trace).expect("small numbers").at(&trace, failed);
    assert_eq!(step.choices.len(), 1);
    let total = exact::Time::checked_sum(step.cycle.iter().map(|member| member.weight));
    assert_eq!(total, Some((-10).into()), "30 does not fit into 20");
    assert!(step.windows[network.start.index()].is_some());
    let because = trace.events.iter().any(|entry| matches!(entry.event, Event::Backtrack { .. }));
    assert!(!because, "the next alternative of the same choice needs no backtracking");
}

#[test]
fn a_trace_is_bounded() {
    let network = network(&mission(Recipe { nodes: 60, tightness: Tightness::Boundary, seed: 5 }));
    let (whole, _) = traced(&network, Search::Chronological, 1_000_000);
    let (outcome, trace) = traced(&network, Search::Chronological, 50);
    assert!(trace.is_truncated);
    assert_eq!(trace.events.len(), 50);
    assert_eq!(outcome.plans, whole.plans, "recording less does not change the plan");
    assert_eq!(Replay::new(&network, None, &trace).expect("small numbers").at(&trace, 49).step, 49);
}

#[test]
fn a_trace_is_written_as_one_json_object_per_line() {
    let text = "scenario S[0,100] = { choose { MODE=A [80,80], MODE=B [5,5] }, MODE=B [80,80] }";
    let network = network(text);
    let (_, trace) = traced(&network, Search::Chronological, 1_000);
    let lines: Vec<serde_json::Value> = trace_json_lines(&network, &trace)
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect();
    assert_eq!(lines.len(), 1 + trace.events.len() + trace.tree.len());
    assert_eq!(lines[0]["format"], "enroute-trace/1");
    let states = &lines[1 + trace.events.len()..];
    let solved = states.iter().find(|state| state["status"] == "solution").expect("a plan");
    assert_eq!((solved["label"].as_str(), solved["alternative"].as_u64()), (Some("D1=1"), Some(1)));
    let orders = states.iter().filter(|state| !state["conflict"].is_null()).count();
    assert_eq!(orders, 2, "neither order of the two modes fits");
    let text = serde_json::to_string(&trace).expect("serializable");
    assert_eq!(serde_json::from_str::<Trace>(&text).expect("deserializable"), trace);
}
