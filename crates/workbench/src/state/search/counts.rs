//! How much work a recorded search had done after each of its steps, counted as [`kirk::Stats`] counts it.

use kirk::{Event, Trace, TreeNodeId, TreeStatus};

use super::focus::is_failure;

/// Work, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// States entered, the root included: one more than alternatives tried.
    pub states: u32,
    /// Times that bounds were propagated, or choices that followed from others.
    pub propagations: u32,
    /// Times that the search went back to a choice, by a step or by a jump.
    pub backtracks: u32,
    /// Failures met. What is known to fail, what is left out as no better, and a requirement or threat for which each
    /// alternative has failed, are none of their own.
    pub failures: u32,
}

impl Counts {
    /// The work of a whole recording.
    pub fn of(trace: &Trace) -> Self {
        Self::until(trace, trace.events.len())
    }

    /// The work of the first `steps` steps. Linear in them.
    pub fn until(trace: &Trace, steps: usize) -> Self {
        let mut counts = Self::default();
        let mut is_entered = vec![false; trace.tree.len()];
        let mut is_parent = vec![false; trace.tree.len()];
        // A conflict-driven search comes to such a failure by itself, whatever it has tried before.
        if !trace.events.iter().any(|entry| matches!(entry.event, Event::Begin(_))) {
            for parent in trace.tree.iter().filter_map(|node| node.parent) {
                is_parent[parent as usize] = true;
            }
        }
        let is_left_out = |state: TreeNodeId| {
            trace.tree.get(state as usize).is_some_and(|state| state.status == TreeStatus::Excluded)
        };
        for entry in trace.events.iter().take(steps) {
            if let Some(is_entered) = is_entered.get_mut(entry.tree_node as usize)
                && !*is_entered
            {
                *is_entered = true;
                counts.states += 1;
            }
            match &entry.event {
                Event::Propagate { .. } | Event::Imply { .. } => counts.propagations += 1,
                Event::Backtrack { .. } | Event::Backjump { .. } => counts.backtracks += 1,
                Event::Known { .. } => {}
                Event::NotBetter { .. } if is_left_out(entry.tree_node) => {}
                Event::Unclosable { .. } | Event::Unresolvable { .. }
                    if is_parent.get(entry.tree_node as usize) == Some(&true) => {}
                _ => counts.failures += u32::from(is_failure(&entry.event)),
            }
        }
        counts
    }
}
