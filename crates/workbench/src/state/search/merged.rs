//! The trees of two searches of one mission as one: a state that both reach by the same choices is there once.

use std::collections::BTreeMap;

use kirk::{Entry, Event, Trace, TreeChoice, TreeNode, TreeNodeId, TreeStatus};

/// Two search trees, merged.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MergedTree {
    /// The states as one tree, parents before their children, with what came of each in whichever search came furthest
    /// there. Its events enter each state once that any search entered, those of the first search first.
    pub trace: Trace,
    /// Each state by its number in either search, if it has it.
    pub own: Vec<[Option<TreeNodeId>; 2]>,
    /// The states of each search by their numbers here.
    pub here: [Vec<TreeNodeId>; 2],
    /// Which searches entered each state.
    entered: Vec<[bool; 2]>,
}

/// Who entered a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Share {
    /// Both searches.
    Both,
    /// One of them alone, 0 or 1.
    Only(usize),
    /// Neither: it was left untried.
    Neither,
}

/// How many states were entered by whom.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShareCounts {
    pub both: usize,
    /// By each alone.
    pub only: [usize; 2],
}

impl MergedTree {
    /// Merges two trees. Takes time in proportion to both, times the logarithm of that.
    pub fn new(traces: [&Trace; 2]) -> Self {
        let mut merged = Self::default();
        let mut known: BTreeMap<(Option<TreeNodeId>, Option<TreeChoice>, u32), TreeNodeId> = BTreeMap::new();
        for (side, trace) in traces.into_iter().enumerate() {
            // A choice that was made again below the same state is another state.
            let mut times: BTreeMap<(Option<TreeNodeId>, Option<TreeChoice>), u32> = BTreeMap::new();
            for (id, node) in trace.tree.iter().enumerate() {
                let parent = node.parent.and_then(|parent| merged.here[side].get(parent as usize).copied());
                let time = times.entry((parent, node.choice)).or_default();
                let here = *known.entry((parent, node.choice, *time)).or_insert_with(|| {
                    let status = TreeStatus::Unexplored;
                    merged.trace.tree.push(TreeNode { parent, choice: node.choice, status });
                    merged.own.push([None, None]);
                    merged.entered.push([false, false]);
                    (merged.trace.tree.len() - 1) as TreeNodeId
                });
                *time += 1;
                merged.own[here as usize][side] = Some(id as TreeNodeId);
                merged.here[side].push(here);
                let status = &mut merged.trace.tree[here as usize].status;
                if progress(node.status) > progress(*status) {
                    *status = node.status;
                }
            }
        }
        for (side, trace) in traces.into_iter().enumerate() {
            for entry in &trace.events {
                let Some(&here) = merged.here[side].get(entry.tree_node as usize) else { continue };
                let entered = &mut merged.entered[here as usize];
                if !entered.contains(&true) {
                    merged.trace.events.push(Entry { tree_node: here, event: Event::Propagate { moved: 0 } });
                }
                entered[side] = true;
            }
            merged.trace.is_truncated |= trace.is_truncated;
        }
        merged
    }

    /// Returns who entered a state.
    pub fn share(&self, id: TreeNodeId) -> Share {
        match self.entered.get(id as usize) {
            Some([true, true]) => Share::Both,
            Some([true, false]) => Share::Only(0),
            Some([false, true]) => Share::Only(1),
            _ => Share::Neither,
        }
    }

    /// Returns how many states were entered by whom.
    pub fn counts(&self) -> ShareCounts {
        let mut counts = ShareCounts::default();
        for id in 0..self.entered.len() {
            match self.share(id as TreeNodeId) {
                Share::Both => counts.both += 1,
                Share::Only(side) => counts.only[side] += 1,
                Share::Neither => {}
            }
        }
        counts
    }
}

/// Returns how much is known by a status.
const fn progress(status: TreeStatus) -> u8 {
    match status {
        TreeStatus::Unexplored => 0,
        TreeStatus::Excluded => 1,
        TreeStatus::Decision => 2,
        TreeStatus::Failed => 3,
        TreeStatus::Solution => 4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::search::Counts;

    fn traced(source: &str, search: kirk::Search) -> Trace {
        let program = rmpl::parse(source).program();
        let network = tpn::compile(&program, &tpn::Top::Scenario(None)).0.expect("it compiles");
        let options = kirk::Options { search, trace_events: Some(100_000), ..kirk::Options::default() };
        kirk::plan(&network, &options, &mut kirk::Unlimited).trace.expect("it was recorded")
    }

    fn both(source: &str) -> [Trace; 2] {
        [kirk::Search::Chronological, kirk::Search::ConflictDirected].map(|search| traced(source, search))
    }

    /// The choices from the root to a state.
    fn way(trace: &Trace, id: TreeNodeId) -> Vec<Option<TreeChoice>> {
        let above = |&id: &TreeNodeId| trace.tree[id as usize].parent;
        std::iter::successors(Some(id), above).map(|id| trace.tree[id as usize].choice).collect()
    }

    #[test]
    fn a_state_of_both_searches_is_there_once_and_each_search_has_all_of_its_states() {
        let traces = both(include_str!("../../../../../assets/missions/backjump.rmpl"));
        let merged = MergedTree::new([&traces[0], &traces[1]]);
        for (side, trace) in traces.iter().enumerate() {
            assert_eq!(merged.here[side].len(), trace.tree.len());
            for id in 0..trace.tree.len() as TreeNodeId {
                let here = merged.here[side][id as usize];
                assert_eq!(merged.own[here as usize][side], Some(id));
                assert_eq!(way(&merged.trace, here), way(trace, id), "it is reached by the same choices");
            }
            let counts = merged.counts();
            assert_eq!(counts.both + counts.only[side], Counts::of(trace).states as usize);
        }
        let shared = merged.own.iter().filter(|own| own.iter().all(Option::is_some)).count();
        assert_eq!(merged.own.len(), traces[0].tree.len() + traces[1].tree.len() - shared);
        for (id, node) in merged.trace.tree.iter().enumerate() {
            assert!(node.parent.is_none_or(|parent| (parent as usize) < id), "parents come first");
        }
    }

    #[test]
    fn learning_saves_states_that_only_the_other_search_enters() {
        let traces = both(include_str!("../../../../../assets/missions/backjump.rmpl"));
        let counts = MergedTree::new([&traces[0], &traces[1]]).counts();
        assert!(counts.both > 0 && counts.only[0] > 0 && counts.only[1] < counts.only[0], "{counts:?}");
    }

    #[test]
    fn a_search_merged_with_itself_is_itself() {
        let [trace, _] = both(include_str!("../../../../../assets/missions/backjump.rmpl"));
        let merged = MergedTree::new([&trace, &trace]);
        assert_eq!(merged.trace.tree, trace.tree);
        assert_eq!(merged.counts().only, [0, 0]);
    }

    #[test]
    fn a_choice_that_is_made_twice_below_one_state_stays_two_states() {
        let node = |parent, status| TreeNode { parent, choice: None, status };
        let tree = vec![
            node(None, TreeStatus::Decision),
            node(Some(0), TreeStatus::Failed),
            node(Some(0), TreeStatus::Solution),
        ];
        let one = Trace { events: Vec::new(), tree: tree[..2].to_vec(), is_truncated: false };
        let other = Trace { events: Vec::new(), tree, is_truncated: false };
        let merged = MergedTree::new([&one, &other]);
        assert_eq!(merged.own, [[Some(0), Some(0)], [Some(1), Some(1)], [None, Some(2)]]);
        assert_eq!(merged.share(2), Share::Neither, "nobody entered it");
    }
}
