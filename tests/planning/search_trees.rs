//! The tree of a finished search leaves nothing open: what has no plan has failed everywhere or is said to be excluded,
//! and beside a plan only those alternatives are unexplored that would have come after it.

use std::collections::BTreeSet;

use acceptance::mission::compile;
use acceptance::missions::missions;
use kirk::{Event, ExpansionLimit, Options, Search, Status, Trace, TreeNodeId, TreeStatus};
use tpn::Top;

/// Random missions of each kind.
const MISSIONS: u64 = 150;

/// The states on the way to a plan, the plan's own included.
fn ways_to_plans(trace: &Trace) -> BTreeSet<TreeNodeId> {
    let mut ways = BTreeSet::new();
    for (id, node) in trace.tree.iter().enumerate().filter(|(_, node)| node.status == TreeStatus::Solution) {
        ways.insert(id as TreeNodeId);
        let mut above = node.parent;
        while let Some(parent) = above.filter(|&parent| ways.insert(parent)) {
            above = trace.tree[parent as usize].parent;
        }
    }
    ways
}

fn is_best_first(trace: &Trace) -> bool {
    matches!(trace.events.first().map(|it| &it.event), Some(Event::Begin(round)) if round.is_best_first)
}

/// What of the tree of a finished search is open still.
fn open_states(trace: &Trace) -> Vec<String> {
    let ways = ways_to_plans(trace);
    let entered: BTreeSet<TreeNodeId> = trace.events.iter().map(|entry| entry.tree_node).collect();
    let mut open = Vec::new();
    for (id, node) in (0..).zip(&trace.tree) {
        let is_after_plan = (0..id).rev().take_while(|&other| trace.are_alternatives(other, id));
        let is_right = match node.status {
            TreeStatus::Unexplored if is_best_first(trace) => false,
            TreeStatus::Unexplored => is_after_plan.into_iter().any(|other| ways.contains(&other)),
            // Opened, and closed once nothing below can be better.
            TreeStatus::Excluded if is_best_first(trace) => !ways.contains(&id),
            TreeStatus::Excluded => {
                !entered.contains(&id) && node.parent.is_some_and(|parent| !ways.contains(&parent))
            }
            // A conflict-driven search jumps out of states before all below them is tried, and leaves them.
            TreeStatus::Decision => ways.contains(&id) || trace.is_conflict_driven(),
            TreeStatus::Failed => !ways.contains(&id),
            TreeStatus::Solution => true,
        };
        if !is_right {
            open.push(format!("state {id} is {:?}", node.status));
        }
    }
    open
}

#[test]
fn a_finished_search_leaves_no_state_open() {
    let mut wrong = Vec::new();
    let (mut finished, mut excluded, mut jumps) = (0, 0, 0);
    for (name, text) in missions(MISSIONS) {
        let (Some(network), _) = compile(&text, &Top::Scenario(None)) else { continue };
        for search in Search::ALL {
            let options = Options {
                search,
                trace_events: Some(20_000),
                explain: false,
                relax: false,
                ..Options::default()
            };
            let outcome = kirk::plan(&network, &options, &mut ExpansionLimit(2_000));
            let Some(trace) = outcome.trace.filter(|trace| !trace.is_truncated) else { continue };
            if !matches!(outcome.status, Status::Plan | Status::NoPlan) {
                continue;
            }
            finished += 1;
            excluded += trace.tree.iter().filter(|node| node.status == TreeStatus::Excluded).count();
            jumps += trace.events.iter().filter(|it| matches!(it.event, Event::Backjump { .. })).count();
            let open = open_states(&trace);
            if !open.is_empty() {
                wrong.push(format!("{name}, {search:?}, {:?}: {}", outcome.status, open.join(", ")));
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {finished}: {}", wrong.len(), wrong.join("\n"));
    assert!(
        finished > 1_500 && jumps > 100 && excluded > 50,
        "{finished} searches, {jumps} jumps, {excluded} excluded"
    );
}
