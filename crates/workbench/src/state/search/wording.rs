//! The steps of a search in words.

mod conflict_driven;

use kirk::{Constraint, CycleMember, Event, Trace, TreeChoice, TreeNodeId};
use tpn::Network;

use crate::state::selection::node_name;

use conflict_driven::{decided, gives, named};
pub use conflict_driven::{learned, never};

/// Returns what was chosen in a state, in words.
pub fn choice(network: &Network, choice: Option<TreeChoice>) -> String {
    let words = match choice {
        None => "Initial state".to_owned(),
        Some(TreeChoice::Decision { decision, alternative }) => {
            let name = network.alternative_name(decision, alternative);
            format!("{}: {name}", Network::decision_name(decision))
        }
        Some(TreeChoice::Link(link)) => gives(network, link.ask, Some(link.tell)),
        Some(TreeChoice::Order(order)) => {
            let [first, then] = named(network, [order.first, order.then]);
            format!("{first} before {then}")
        }
        Some(TreeChoice::NoLink { ask }) => gives(network, ask, None),
        Some(
            choice @ (TreeChoice::UseOrder(_)
            | TreeChoice::Start { .. }
            | TreeChoice::Later { .. }
            | TreeChoice::Departure(_)
            | TreeChoice::Apart),
        ) => conflict_driven::fact(network, choice),
    };
    network.readable(&words)
}

/// One event of a search in a sentence.
pub fn event(network: &Network, trace: &Trace, event: &Event) -> String {
    let own = if trace.is_conflict_driven() { None } else { step_by_step(network, trace, event) };
    let words = own.or_else(|| conflict_driven::event(network, trace, event));
    network.readable(&words.unwrap_or_else(|| plain(network, event)))
}

/// Returns what a search that makes one choice after the other says in its own way.
fn step_by_step(network: &Network, trace: &Trace, event: &Event) -> Option<String> {
    match event {
        Event::Backtrack { to } => Some(backtrack(network, trace, *to)),
        Event::Backjump { to, because } => Some(backjump(network, trace, *to, because)),
        Event::TryLink { link } => Some(format!("Try: {}.", gives(network, link.ask, Some(link.tell)))),
        _ => None,
    }
}

/// Returns what both kinds of search say alike.
fn plain(network: &Network, event: &Event) -> String {
    match event {
        Event::Expand { node } => format!("Expand {}: follow all outgoing arcs.", node_name(network, *node)),
        Event::Decide { decision, alternative } => {
            let chosen = TreeChoice::Decision { decision: *decision, alternative: *alternative };
            format!("Decide {}.", choice(network, Some(chosen)))
        }
        Event::AddArc { arc } => {
            let Some(arc) = network.arcs.get(arc.index()) else { return String::new() };
            let (from, to) = (node_name(network, arc.from), node_name(network, arc.to));
            format!("Add {from} → {to} [{}, {}].", arc.lower, arc.upper)
        }
        Event::Propagate { moved: 0 } => "Propagate: no windows change.".to_owned(),
        Event::Propagate { moved: 1 } => "Propagate: the window of 1 event changes.".to_owned(),
        Event::Propagate { moved } => format!("Propagate: the windows of {moved} events change."),
        Event::Inconsistent { cycle } => match kirk::contradiction(network, cycle) {
            Some(contradiction) => format!("Failure: {contradiction}."),
            None => "Failure: the bounds are inconsistent.".to_owned(),
        },
        Event::Solution { .. } => "Plan found.".to_owned(),
        Event::Exhausted => "No alternatives left.".to_owned(),
        _ => String::new(),
    }
}

/// Back to the choice that was made in state `to`, named by one of its alternatives.
fn backtrack(network: &Network, trace: &Trace, to: TreeNodeId) -> String {
    let choice = trace.tree.iter().find(|state| state.parent == Some(to)).and_then(|state| state.choice);
    let choice = choice.map_or_else(|| "the start".to_owned(), |choice| decided(network, choice));
    format!("Backtrack to {choice}.")
}

/// Back over choices that have no part in a failure, to the last one that has.
fn backjump(network: &Network, trace: &Trace, to: TreeNodeId, because: &[TreeNodeId]) -> String {
    let state = |id: TreeNodeId| trace.tree.get(id as usize);
    let named = |id: TreeNodeId| choice(network, state(id).and_then(|state| state.choice));
    let is_last = |id: &TreeNodeId| state(*id).is_some_and(|state| state.parent == Some(to));
    let last = because.iter().copied().find(is_last).or(because.iter().copied().max());
    let Some(last) = last else {
        return "Backjump to the start: the failure depends on no choice.".to_owned();
    };
    let others: Vec<String> = because.iter().filter(|&&id| id != last).map(|&id| named(id)).collect();
    let besides = match others.as_slice() {
        [] => String::new(),
        others => format!(", together with {}", others.join(" and ")),
    };
    format!("Backjump to before {}, the last choice that caused the failure{besides}.", named(last))
}

/// A constraint of a negative cycle, and why it holds.
pub fn cycle_step(network: &Network, member: &CycleMember) -> String {
    let (from, to) = (node_name(network, member.from), node_name(network, member.to));
    let why = match member.constraint {
        Constraint::Lower(_) => "minimum duration",
        Constraint::Upper(_) => "maximum duration",
        Constraint::Link(_) => "causal link",
        Constraint::Order(_) => "ordering",
        Constraint::UseOrder(_) => "resource ordering",
        Constraint::Departure(_) => "travel time from the departure place",
    };
    format!("{from} → {to}: {} ({why})", member.weight)
}
