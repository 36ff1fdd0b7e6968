//! How much work a recorded search had done after each of its steps.

use kirk::{Event, Trace};

use super::focus::is_failure;

/// Work, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// States entered, the root included.
    pub states: u32,
    /// Times that bounds were propagated, or choices that followed from others.
    pub propagations: u32,
    /// Times that the search went back, by a step, by a jump or to the start.
    pub backtracks: u32,
    /// Failures met.
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
        for entry in trace.events.iter().take(steps) {
            if let Some(is_entered) = is_entered.get_mut(entry.tree_node as usize)
                && !*is_entered
            {
                *is_entered = true;
                counts.states += 1;
            }
            match entry.event {
                Event::Propagate { .. } | Event::Imply { .. } => counts.propagations += 1,
                Event::Backtrack { .. } | Event::Backjump { .. } | Event::Restart => counts.backtracks += 1,
                _ => counts.failures += u32::from(is_failure(&entry.event)),
            }
        }
        counts
    }
}
