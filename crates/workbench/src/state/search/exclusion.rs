//! States of a search that lead to nothing because of what was learned elsewhere: they contain a learned conflict.

use std::collections::BTreeMap;

use kirk::{Event, Trace, TreeChoice};

/// Why a state was left: a learned conflict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exclusion {
    /// The step that says so, from which on the state is excluded.
    pub step: usize,
    /// The step that taught the conflict, if one alone did.
    pub taught: Option<usize>,
}

impl Exclusion {
    /// The choices that are never made together again, in the search that was recorded as `trace`; none if there is no
    /// solution.
    pub fn conflict<'t>(&self, trace: &'t Trace) -> &'t [TreeChoice] {
        match trace.events.get(self.step).map(|entry| &entry.event) {
            Some(Event::Known { choices }) => choices,
            _ => &[],
        }
    }
}

/// Returns what excludes each state of a search. Takes time in proportion to its steps and states, times the logarithm
/// of what it has learned.
pub fn exclusions(trace: &Trace) -> Vec<Option<Exclusion>> {
    let mut excluded = vec![None; trace.tree.len()];
    let mut taught: BTreeMap<&[TreeChoice], usize> = BTreeMap::new();
    for (step, entry) in trace.events.iter().enumerate() {
        match &entry.event {
            Event::Learn { choices } => {
                taught.insert(choices, step);
            }
            Event::Known { choices } => {
                let taught = taught.get(choices.as_slice()).copied();
                if let Some(excluded) = excluded.get_mut(entry.tree_node as usize) {
                    *excluded = Some(Exclusion { step, taught });
                }
            }
            _ => {}
        }
    }
    excluded
}
