//! The steps of a search in words.

mod conflict_driven;

use kirk::{Constraint, CycleMember, Event, Trace, TreeChoice, TreeNodeId};
use tpn::Network;

use crate::state::selection::{alternative_text, node_name};

use conflict_driven::{gives, named};
pub use conflict_driven::{learned, never};

/// What was chosen in a state, in words.
pub fn choice(network: &Network, choice: Option<TreeChoice>) -> String {
    match choice {
        None => "Before any choice".to_owned(),
        Some(TreeChoice::Decision { decision, alternative }) => {
            let text = alternative_text(network, decision, alternative);
            format!("{} = {text}", Network::decision_name(decision))
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
    }
}

/// One event of a search in a sentence.
pub fn event(network: &Network, trace: &Trace, event: &Event) -> String {
    let own = if trace.is_conflict_driven() { None } else { step_by_step(network, trace, event) };
    own.or_else(|| conflict_driven::event(network, trace, event)).unwrap_or_else(|| plain(network, event))
}

/// What a search that makes one choice after the other says in its own way.
fn step_by_step(network: &Network, trace: &Trace, event: &Event) -> Option<String> {
    match event {
        Event::Backjump { to, because } => Some(backjump(network, trace, *to, because)),
        Event::TryLink { link } => Some(format!("Try: {}.", gives(network, link.ask, Some(link.tell)))),
        _ => None,
    }
}

/// What both kinds of search say alike.
fn plain(network: &Network, event: &Event) -> String {
    match event {
        Event::Expand { node } => format!("Follow all arcs out of {}.", node_name(network, *node)),
        Event::Decide { decision, alternative } => {
            let chosen = TreeChoice::Decision { decision: *decision, alternative: *alternative };
            format!("Decide {}.", choice(network, Some(chosen)))
        }
        Event::AddArc { arc } => {
            let Some(arc) = network.arcs.get(arc.index()) else { return String::new() };
            let (from, to) = (node_name(network, arc.from), node_name(network, arc.to));
            format!("Add {from} → {to} [{}, {}].", arc.lower, arc.upper)
        }
        Event::Propagate { moved: 0 } => "Propagate: nothing has to move.".to_owned(),
        Event::Propagate { moved: 1 } => "Propagate: one event moves.".to_owned(),
        Event::Propagate { moved } => format!("Propagate: {moved} events move."),
        Event::Inconsistent { cycle } => match kirk::contradiction(network, cycle) {
            Some(contradiction) => format!("Failure: {contradiction}."),
            None => "Failure: the bounds contradict each other.".to_owned(),
        },
        Event::Backtrack { .. } => "Back to the last choice.".to_owned(),
        Event::Solution { .. } => "This is a plan.".to_owned(),
        Event::Exhausted => "Nothing is left to try.".to_owned(),
        _ => String::new(),
    }
}

/// Back over choices that have no part in a failure, to the last one that has.
fn backjump(network: &Network, trace: &Trace, to: TreeNodeId, because: &[TreeNodeId]) -> String {
    let state = |id: TreeNodeId| trace.tree.get(id as usize);
    let named = |id: TreeNodeId| choice(network, state(id).and_then(|state| state.choice));
    let is_last = |id: &TreeNodeId| state(*id).is_some_and(|state| state.parent == Some(to));
    let last = because.iter().copied().find(is_last).or(because.iter().copied().max());
    let Some(last) = last else {
        return "Jump back to the start: the failure rests on no choice.".to_owned();
    };
    let others: Vec<String> = because.iter().filter(|&&id| id != last).map(|&id| named(id)).collect();
    let besides = match others.as_slice() {
        [] => String::new(),
        others => format!(", besides {}", others.join(" and ")),
    };
    format!("Jump back to before {}, the last choice that the failure rests on{besides}.", named(last))
}

/// A constraint of a negative cycle, and why it holds.
pub fn cycle_step(network: &Network, member: &CycleMember) -> String {
    let (from, to) = (node_name(network, member.from), node_name(network, member.to));
    let why = match member.constraint {
        Constraint::Lower(_) => "least duration",
        Constraint::Upper(_) => "greatest duration",
        Constraint::Link(_) => "causal link",
        Constraint::Order(_) => "ordering",
        Constraint::UseOrder(_) => "order of uses",
        Constraint::Departure(_) => "the way from where it sets out",
    };
    format!("{from} → {to}: {} ({why})", member.weight)
}
