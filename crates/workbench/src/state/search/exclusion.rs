//! States of a search that lead to nothing because of what was learned elsewhere: they contain a learned conflict.

use std::collections::BTreeMap;

use kirk::{Event, Trace, TreeChoice, TreeNodeId, TreeStatus};

/// Why a state was left, or never entered: a learned conflict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exclusion {
    /// The step from which on the state is excluded.
    pub step: usize,
    /// The step that taught the conflict, if one alone did.
    pub taught: Option<usize>,
    /// The step whose event names the conflict.
    named: usize,
}

impl Exclusion {
    /// The choices that are never made together again, in the search that was recorded as `trace`; none if there is no
    /// solution.
    pub fn conflict<'t>(&self, trace: &'t Trace) -> &'t [TreeChoice] {
        match trace.events.get(self.named).map(|entry| &entry.event) {
            Some(Event::Known { choices } | Event::Learn { choices }) => choices,
            _ => &[],
        }
    }
}

/// What excludes each state of a search. Takes time in proportion to its steps and states, times the logarithm of what it
/// has learned.
pub fn exclusions(trace: &Trace) -> Vec<Option<Exclusion>> {
    let mut excluded = vec![None; trace.tree.len()];
    let mut taught: BTreeMap<&[TreeChoice], usize> = BTreeMap::new();
    for (step, entry) in trace.events.iter().enumerate() {
        match &entry.event {
            Event::Learn { choices } => {
                taught.insert(choices, step);
                if let Some(Event::Backjump { to, .. }) = trace.events.get(step + 1).map(|next| &next.event) {
                    let exclusion = Exclusion { step: step + 1, taught: Some(step), named: step };
                    pass(trace, entry.tree_node, *to, exclusion, &mut excluded);
                }
            }
            Event::Known { choices } => {
                let taught = taught.get(choices.as_slice()).copied();
                if let Some(excluded) = excluded.get_mut(entry.tree_node as usize) {
                    *excluded = Some(Exclusion { step, taught, named: step });
                }
            }
            _ => {}
        }
    }
    excluded
}

/// A jump leaves untried what stands beside the states that it passes.
fn pass(
    trace: &Trace,
    from: TreeNodeId,
    to: TreeNodeId,
    exclusion: Exclusion,
    excluded: &mut [Option<Exclusion>],
) {
    let above = |&id: &TreeNodeId| trace.tree.get(id as usize).and_then(|node| node.parent);
    for passed in std::iter::successors(Some(from), above).take_while(|&id| id > to) {
        let beside = (passed + 1..).take_while(|&other| trace.are_alternatives(passed, other));
        for id in beside.map(|id| id as usize) {
            if trace.tree[id].status == TreeStatus::Excluded {
                excluded[id] = Some(exclusion);
            }
        }
    }
}
