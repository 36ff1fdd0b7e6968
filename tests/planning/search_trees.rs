//! The tree of a finished search leaves nothing open: what has no plan has failed everywhere or is said to be excluded,
//! and beside a plan only those alternatives are unexplored that would have come after it.

use std::collections::BTreeSet;

use acceptance::mission::compile;
use acceptance::missions::missions;
use kirk::{
    Event, ExpansionLimit, Options, Search, Status, Trace, TreeChoice, TreeNodeId, TreeStatus, Unlimited,
};
use tpn::{Network, Plan, Top};
use workbench::state::search::exclusions;

/// Random missions of each kind.
const MISSIONS: u64 = 150;

/// What is cheap takes long, and there is too little time for that everywhere: the search for the best plan opens states from
/// which it need not continue.
const BARGAINS: &str = "objective minimize cost;
    primitive Fast()[1,1] costs 7; primitive Steady()[3,3] costs 4; primitive Slow()[5,5] costs 2;
    scenario S[0,19] = {
        choose { Fast(), Steady(), Slow() }; choose { Fast(), Steady(), Slow() };
        choose { Fast(), Steady(), Slow() }; choose { Fast(), Steady(), Slow() };
        choose { Fast(), Steady(), Slow() }; choose { Fast(), Steady(), Slow() }
    }";

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

/// Returns what of the tree of a finished search is open still.
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
    for (name, text) in missions(MISSIONS).into_iter().chain([("bargains".to_owned(), BARGAINS.to_owned())]) {
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

/// The choices from the root to a state.
fn way(trace: &Trace, id: TreeNodeId) -> Vec<TreeChoice> {
    let above = |&id: &TreeNodeId| trace.tree[id as usize].parent;
    std::iter::successors(Some(id), above).filter_map(|id| trace.tree[id as usize].choice).collect()
}

/// Returns whether a plan makes all of these choices, which are alternatives of decisions.
fn makes(plan: &Plan, choices: &[TreeChoice]) -> bool {
    choices.iter().all(|choice| match *choice {
        TreeChoice::Decision { decision, alternative } => {
            plan.choices.iter().any(|it| it.decision == decision && it.alternative == alternative)
        }
        _ => false,
    })
}

/// Returns what is wrong with the learned conflicts that are said to exclude states.
fn false_exclusions(network: &Network, trace: &Trace) -> Vec<String> {
    let excluded = exclusions(trace);
    let ways = ways_to_plans(trace);
    let mut wrong = Vec::new();
    for (id, node) in (0..).zip(&trace.tree) {
        let way = way(trace, id);
        let contains = |choices: &[TreeChoice]| choices.iter().all(|choice| way.contains(choice));
        let own: Vec<&Event> =
            trace.events.iter().filter(|it| it.tree_node == id).map(|it| &it.event).collect();
        let Some(exclusion) = excluded[id as usize] else {
            if own.iter().any(|event| matches!(event, Event::Known { .. })) {
                wrong.push(format!("state {id} contains a learned conflict, and nothing says so"));
            }
            continue;
        };
        let conflict = exclusion.conflict(trace);
        let is_told = exclusion.taught.is_none_or(|step| {
            let taught = &trace.events[step].event;
            step < exclusion.step && matches!(taught, Event::Learn { choices } if choices == conflict)
        });
        let is_left = matches!(node.status, TreeStatus::Failed | TreeStatus::Excluded)
            && !ways.contains(&id)
            && matches!(
                own.last(),
                None | Some(Event::Known { .. } | Event::Backtrack { .. } | Event::Backjump { .. })
            );
        // A search that goes by conflicts rests on what follows from its choices as well.
        let is_contained = trace.is_conflict_driven() || (!conflict.is_empty() && contains(conflict));
        if !is_told || !is_left || !is_contained {
            let label = trace.label(network, id);
            wrong.push(format!("state {id}, {label}: {exclusion:?}, {conflict:?}, {is_told} {is_left} {is_contained}, {own:?}"));
        }
    }
    wrong
}

#[test]
fn a_state_is_excluded_by_a_learned_conflict_that_it_contains_and_that_no_plan_does() {
    let mut wrong = Vec::new();
    let (mut entered, mut learned) = (0, 0);
    for (name, text) in missions(MISSIONS) {
        let (Some(network), _) = compile(&text, &Top::Scenario(None)) else { continue };
        for search in [Search::ConflictDirected, Search::BestFirst] {
            let options = Options {
                search,
                trace_events: Some(20_000),
                explain: false,
                relax: false,
                ..Options::default()
            };
            let outcome = kirk::plan(&network, &options, &mut ExpansionLimit(2_000));
            let Some(trace) = outcome.trace else { continue };
            wrong.extend(false_exclusions(&network, &trace).into_iter().map(|it| format!("{name}: {it}")));
            entered += exclusions(&trace).into_iter().flatten().count();
            // With an objective, it learns which choices are no better.
            if !network.objective.is_empty() || trace.learned(usize::MAX).next().is_none() {
                continue;
            }
            let all = Options { all: true, max_plans: 200, ..Options::default() };
            let plans = kirk::plan(&network, &all, &mut Unlimited).plans;
            for (step, choices) in trace.learned(usize::MAX) {
                learned += 1;
                if plans.iter().any(|plan| makes(plan, choices)) {
                    wrong.push(format!("{name}, step {step}: a plan makes {choices:?}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}: {}", wrong.len(), wrong.join("\n"));
    assert!(entered > 20 && learned > 200, "{entered} entered, {learned} learned");
}
