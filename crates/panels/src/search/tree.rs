//! Coordinates for the search tree: the root on top, children in the order of their alternatives, subtrees as close
//! together as they fit, after Reingold and Tilford (1981). Distances are in cells; linear in the size of the search.

use kirk::{Event, Trace, TreeNodeId, TreeStatus};
use workbench::state::search::focus::is_failure;
use workbench::state::search::{Exclusion, exclusions};

/// The tree as it is drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreeDrawing {
    /// Where each state stands: across, from the leftmost, and down; `None` for those inside a folded one.
    pub places: Vec<Option<[f32; 2]>>,
    /// The states that are drawn, by their row and from left to right.
    pub rows: Vec<Vec<TreeNodeId>>,
    /// Cells from the leftmost to the rightmost state.
    pub width: f32,
}

/// What is known of the states of a search besides where they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreeIndex {
    /// The children of state `n` are `children[child_start[n]..child_start[n + 1]]`, in order.
    child_start: Vec<u32>,
    children: Vec<TreeNodeId>,
    /// The first step in which each state is entered.
    pub first_step: Vec<Option<usize>>,
    /// The last step in it or below it.
    pub last_step: Vec<Option<usize>>,
    /// The first step in which each state fails.
    failure_step: Vec<Option<usize>>,
    /// The steps in which a best-first search opens each state or continues with it.
    pub bounded: Vec<Vec<u32>>,
    /// The step from which on each state is known: when it or another alternative of its choice point is entered.
    known_from: Vec<usize>,
    /// How many states are below each.
    pub below: Vec<u32>,
    /// How many failures are in or below each.
    pub failures: Vec<u32>,
    /// Whether there is a plan in or below each state.
    pub has_solution: Vec<bool>,
    /// What excludes each state that contains a learned conflict.
    excluded: Vec<Option<Exclusion>>,
    /// The states in the order in which they were entered.
    pub entered: Vec<TreeNodeId>,
    /// The state that the search is for: its last plan, or where it was when it ended without one.
    pub goal: TreeNodeId,
}

impl TreeIndex {
    /// Goes through `trace` once.
    pub fn new(trace: &Trace) -> Self {
        let count = trace.tree.len();
        let mut index = Self {
            child_start: vec![0; count + 1],
            first_step: vec![None; count],
            last_step: vec![None; count],
            failure_step: vec![None; count],
            bounded: vec![Vec::new(); count],
            known_from: vec![usize::MAX; count],
            below: vec![0; count],
            failures: vec![0; count],
            excluded: exclusions(trace),
            has_solution: trace.tree.iter().map(|node| node.status == TreeStatus::Solution).collect(),
            ..Self::default()
        };
        for (step, entry) in trace.events.iter().enumerate() {
            let id = entry.tree_node as usize;
            if id < count {
                if index.first_step[id].is_none() {
                    index.first_step[id] = Some(step);
                    index.entered.push(entry.tree_node);
                }
                index.last_step[id] = Some(step);
                if index.failure_step[id].is_none() && is_failure(&entry.event) {
                    index.failure_step[id] = Some(step);
                }
                if matches!(entry.event, Event::Bound { .. } | Event::Visit { .. }) {
                    index.bounded[id].push(step as u32);
                }
            }
        }
        index.find_children(trace);
        // Parents come before their children, so one pass from the end sees children first.
        for (id, node) in trace.tree.iter().enumerate().rev() {
            // A state that failed because all below it failed is not a failure of its own.
            if index.failures[id] == 0 && node.status == TreeStatus::Failed {
                index.failures[id] = 1;
            }
            let Some(parent) = node.parent.map(|parent| parent as usize).filter(|&parent| parent < id) else {
                continue;
            };
            index.has_solution[parent] |= index.has_solution[id];
            index.below[parent] += 1 + index.below[id];
            index.failures[parent] += index.failures[id];
            index.last_step[parent] = index.last_step[parent].max(index.last_step[id]);
        }
        index.find_known(trace);
        index.find_goal();
        index
    }

    fn find_children(&mut self, trace: &Trace) {
        let count = trace.tree.len();
        let parent_of = |id: usize| {
            let parent = trace.tree.get(id)?.parent? as usize;
            (parent < count).then_some(parent)
        };
        for parent in (0..count).filter_map(parent_of) {
            self.child_start[parent + 1] += 1;
        }
        for id in 0..count {
            self.child_start[id + 1] += self.child_start[id];
        }
        let mut next = self.child_start.clone();
        self.children = vec![0; next.last().map_or(0, |&count| count as usize)];
        for id in 0..count {
            if let Some(parent) = parent_of(id) {
                self.children[next[parent] as usize] = id as TreeNodeId;
                next[parent] += 1;
            }
        }
    }

    /// The alternatives of one choice point stand side by side in the trace.
    fn find_known(&mut self, trace: &Trace) {
        let mut from = 0;
        while from < trace.tree.len() {
            let is_next = |until: &usize| trace.are_alternatives(from as TreeNodeId, *until as TreeNodeId);
            let until =
                (from + 1..trace.tree.len()).take_while(is_next).last().map_or(from + 1, |last| last + 1);
            let first = self.first_step[from..until].iter().copied().flatten().min();
            self.known_from[from..until].fill(first.unwrap_or(usize::MAX));
            from = until;
        }
    }

    /// The states below one, in order.
    pub fn children(&self, id: TreeNodeId) -> &[TreeNodeId] {
        let id = id as usize;
        let bounds = self.child_start.get(id).zip(self.child_start.get(id + 1));
        bounds.and_then(|(&from, &to)| self.children.get(from as usize..to as usize)).unwrap_or_default()
    }

    fn find_goal(&mut self) {
        let entered = || self.entered.iter().rev().copied();
        let is_plan = |id: &TreeNodeId| self.children(*id).is_empty() && self.has_solution[*id as usize];
        self.goal = entered().find(is_plan).or_else(|| entered().next()).unwrap_or(0);
    }

    /// Returns how a state failed, if it did.
    pub fn failure<'t>(&self, trace: &'t Trace, id: TreeNodeId) -> Option<&'t Event> {
        let step = self.failure_step.get(id as usize).copied().flatten()?;
        trace.events.get(step).map(|entry| &entry.event)
    }

    /// Returns whether a state is known at `step`: it was entered, or it is an alternative of a choice that was
    /// reached. Without a step all are.
    pub fn is_known(&self, id: TreeNodeId, step: Option<usize>) -> bool {
        step.is_none_or(|step| self.known_from.get(id as usize).is_some_and(|&from| from <= step))
    }

    /// Returns what is known of a state at `step`.
    pub fn status(&self, trace: &Trace, id: TreeNodeId, step: Option<usize>) -> TreeStatus {
        if self.exclusion(id, step).is_some() {
            return TreeStatus::Excluded;
        }
        let at = id as usize;
        let status = trace.tree.get(at).map_or(TreeStatus::Unexplored, |node| node.status);
        if status == TreeStatus::Excluded && step.is_some() && self.excluded_by(trace, id) > step {
            return TreeStatus::Unexplored;
        }
        let (Some(step), Some(Some(first)), Some(Some(last))) =
            (step, self.first_step.get(at), self.last_step.get(at))
        else {
            return status;
        };
        let is_open = || {
            let bounded = self.bounded(trace, id, Some(step));
            bounded.is_some_and(|event| matches!(event, Event::Bound { .. }))
        };
        if *first > step || (*last > step && is_open()) {
            TreeStatus::Unexplored
        } else if *last > step {
            TreeStatus::Decision
        } else {
            status
        }
    }

    /// Returns what a best-first search has last said of a state by `step`, or at all: what it may lead to.
    pub fn bounded<'t>(&self, trace: &'t Trace, id: TreeNodeId, step: Option<usize>) -> Option<&'t Event> {
        let steps = self.bounded.get(id as usize)?;
        let count = step.map_or(steps.len(), |step| steps.partition_point(|&at| at as usize <= step));
        let last = *steps.get(count.checked_sub(1)?)?;
        trace.events.get(last as usize).map(|entry| &entry.event)
    }

    /// The step in which it became known that an excluded state leads to nothing, too: its own last one, or of one that was
    /// never entered the last one in the alternatives beside it.
    pub fn excluded_by(&self, trace: &Trace, id: TreeNodeId) -> Option<usize> {
        if let Some(own) = self.last_step.get(id as usize).copied().flatten() {
            return Some(own);
        }
        let parent = trace.tree.get(id as usize)?.parent?;
        let beside = self.children(parent).iter().filter(|&&other| trace.are_alternatives(other, id));
        beside.filter_map(|&other| self.last_step.get(other as usize).copied().flatten()).max()
    }

    /// The learned conflict that excludes a state by `step`, or at all.
    pub fn exclusion(&self, id: TreeNodeId, step: Option<usize>) -> Option<Exclusion> {
        let exclusion = self.excluded.get(id as usize).copied().flatten()?;
        step.is_none_or(|step| exclusion.step <= step).then_some(exclusion)
    }

    /// Returns whether the search went elsewhere from a state without a plan, and without having tried all that is
    /// below it.
    pub fn is_left(&self, id: TreeNodeId, step: Option<usize>) -> bool {
        let at = id as usize;
        let last = self.last_step.get(at).copied().flatten();
        self.has_solution.get(at) == Some(&false)
            && step.is_none_or(|step| last.is_some_and(|last| last < step))
    }

    /// Returns whether all that was tried below a state failed, so that it can be folded.
    pub fn is_failed_subtree(&self, id: TreeNodeId) -> bool {
        let at = id as usize;
        !self.children(id).is_empty()
            && self.has_solution.get(at) == Some(&false)
            && self.first_step.get(at).is_some_and(Option::is_some)
    }
}

impl TreeDrawing {
    /// Lays a search out; `is_folded` says which states are drawn without what is below them.
    pub fn new(index: &TreeIndex, is_folded: &dyn Fn(TreeNodeId) -> bool) -> Self {
        let count = index.below.len();
        let mut drawing = Self { places: vec![None; count], ..Self::default() };
        if count == 0 {
            return drawing;
        }
        let is_shown = shown(index, is_folded);
        let offsets = offsets(index, &is_shown);
        drawing.places[0] = Some([0.0, 0.0]);
        for id in 0..count {
            let Some([across, down]) = drawing.places[id] else { continue };
            for &child in index.children(id as TreeNodeId) {
                if is_shown[child as usize] {
                    drawing.places[child as usize] = Some([across + offsets[child as usize], down + 1.0]);
                }
            }
        }
        let across =
            |drawing: &Self| drawing.places.iter().flatten().map(|place| place[0]).collect::<Vec<_>>();
        let all = across(&drawing);
        let left = all.iter().copied().fold(f32::INFINITY, f32::min);
        drawing.width = all.iter().copied().fold(f32::NEG_INFINITY, f32::max) - left;
        for place in drawing.places.iter_mut().flatten() {
            place[0] -= left;
        }
        drawing.find_rows(index);
        drawing
    }

    /// Cells from the root to the lowest state.
    pub fn depth(&self) -> f32 {
        self.rows.len().saturating_sub(1) as f32
    }

    fn find_rows(&mut self, index: &TreeIndex) {
        let mut row = vec![0];
        while !row.is_empty() {
            let is_placed = |child: &&TreeNodeId| self.places[**child as usize].is_some();
            let next = row.iter().flat_map(|&id| index.children(id)).filter(is_placed).copied().collect();
            self.rows.push(row);
            row = next;
        }
    }

    /// The state itself, or the folded one that it is inside of.
    pub fn stand_in(&self, trace: &Trace, id: TreeNodeId) -> TreeNodeId {
        let mut at = id;
        while self.places.get(at as usize).copied().flatten().is_none() {
            match trace.tree.get(at as usize).and_then(|node| node.parent) {
                Some(parent) => at = parent,
                None => break,
            }
        }
        at
    }

    /// The states of a row between two places across, with one more on either side.
    pub fn between(&self, row: usize, left: f32, right: f32) -> &[TreeNodeId] {
        let Some(row) = self.rows.get(row) else { return &[] };
        let across = |id: TreeNodeId| self.places[id as usize].map_or(0.0, |place| place[0]);
        let from = row.partition_point(|&id| across(id) < left).saturating_sub(1);
        let to = (row.partition_point(|&id| across(id) <= right) + 1).min(row.len());
        row.get(from..to).unwrap_or_default()
    }

    /// The state nearest to a place, if it is within `reach` cells across and down.
    pub fn nearest(&self, at: [f32; 2], reach: [f32; 2]) -> Option<TreeNodeId> {
        let row = at[1].round();
        if row < 0.0 || (row - at[1]).abs() > reach[1] {
            return None;
        }
        let distance =
            |id: TreeNodeId| self.places[id as usize].map_or(f32::INFINITY, |place| (place[0] - at[0]).abs());
        let near = self.between(row as usize, at[0], at[0]).iter().copied();
        let nearest = near.min_by(|&one, &other| distance(one).total_cmp(&distance(other)))?;
        (distance(nearest) <= reach[0]).then_some(nearest)
    }
}

/// Returns which states are drawn.
fn shown(index: &TreeIndex, is_folded: &dyn Fn(TreeNodeId) -> bool) -> Vec<bool> {
    let mut is_shown = vec![false; index.below.len()];
    let mut pending = vec![0];
    while let Some(id) = pending.pop() {
        is_shown[id as usize] = true;
        if !is_folded(id) {
            pending.extend(index.children(id));
        }
    }
    is_shown
}

/// The outline of a subtree: the leftmost and rightmost place of each of its rows, the lowest row first, all to be
/// moved by `shift`. The root is at 0 when moved.
struct Outline {
    rows: Vec<[f32; 2]>,
    shift: f32,
}

/// Returns how far each state stands to the right of its parent.
fn offsets(index: &TreeIndex, is_shown: &[bool]) -> Vec<f32> {
    let count = is_shown.len();
    let mut offsets = vec![0.0_f32; count];
    let mut outlines: Vec<Option<Outline>> = (0..count).map(|_| None).collect();
    // Parents come before their children, so one pass from the end finds the outlines of children ready.
    for id in (0..count).rev().filter(|&id| is_shown[id]) {
        let mut all: Option<Outline> = None;
        let children = || index.children(id as TreeNodeId).iter().map(|&child| child as usize);
        let (mut first, mut last) = (None, 0.0);
        for child in children().filter(|&child| is_shown[child]) {
            let Some(mut outline) = outlines[child].take() else { continue };
            let at = match &all {
                None => 0.0,
                Some(left) => gap(left, &outline),
            };
            outline.shift += at;
            offsets[child] = at;
            first = first.or(Some(at));
            last = at;
            all = Some(match all {
                None => outline,
                Some(left) => joined(left, outline),
            });
        }
        let mut outline = all.unwrap_or(Outline { rows: Vec::new(), shift: 0.0 });
        if let Some(first) = first {
            let middle = f32::midpoint(first, last);
            outline.shift -= middle;
            for child in children().filter(|&child| is_shown[child]) {
                offsets[child] -= middle;
            }
        }
        outline.rows.push([-outline.shift, -outline.shift]);
        outlines[id] = Some(outline);
    }
    offsets
}

/// Returns how far `right` has to be moved so that it stands one cell beside `left` in every row that both have.
fn gap(left: &Outline, right: &Outline) -> f32 {
    let pairs = left.rows.iter().rev().zip(right.rows.iter().rev());
    let needed =
        pairs.map(|(left_row, right_row)| left_row[1] + left.shift + 1.0 - right_row[0] - right.shift);
    needed.fold(f32::NEG_INFINITY, f32::max)
}

/// The outline of both together. Costs as much as the lower of them has rows.
fn joined(left: Outline, right: Outline) -> Outline {
    let common = left.rows.len().min(right.rows.len());
    let (left_from, right_from) = (left.rows.len() - common, right.rows.len() - common);
    if left.rows.len() >= right.rows.len() {
        let mut all = left;
        for (row, other) in all.rows[left_from..].iter_mut().zip(&right.rows[right_from..]) {
            row[1] = other[1] + right.shift - all.shift;
        }
        all
    } else {
        let mut all = right;
        for (row, other) in all.rows[right_from..].iter_mut().zip(&left.rows[left_from..]) {
            row[0] = other[0] + left.shift - all.shift;
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use kirk::{Search, TreeNode, Unlimited};

    use super::*;

    fn traced(source: &str) -> Trace {
        let program = rmpl::parse(source).program();
        let network = tpn::compile(&program, &tpn::Top::Scenario(None)).0.expect("it compiles");
        let options = kirk::Options {
            search: Search::Chronological,
            trace_events: Some(10_000),
            ..kirk::Options::default()
        };
        kirk::plan(&network, &options, &mut Unlimited).trace.expect("it was recorded")
    }

    fn backjump() -> Trace {
        traced(include_str!("../../../../assets/missions/backjump.rmpl"))
    }

    /// A tree with these parents, all of it failed.
    fn failed(parents: &[u32]) -> Trace {
        let node = |parent| TreeNode { parent, choice: None, status: TreeStatus::Failed };
        let tree =
            std::iter::once(node(None)).chain(parents.iter().map(|&parent| node(Some(parent)))).collect();
        Trace { events: Vec::new(), tree, is_truncated: false }
    }

    fn check_places(trace: &Trace, drawing: &TreeDrawing) {
        for row in &drawing.rows {
            for pair in row.windows(2) {
                let [left, right] =
                    [pair[0], pair[1]].map(|id| drawing.places[id as usize].expect("it is drawn"));
                assert!(right[0] - left[0] > 0.99, "{} and {} cover each other", pair[0], pair[1]);
            }
        }
        for (id, node) in trace.tree.iter().enumerate() {
            let (Some(parent), Some([_, down])) = (node.parent, drawing.places[id]) else { continue };
            assert_eq!(drawing.places[parent as usize].map(|place| place[1] + 1.0), Some(down));
        }
        let drawn: usize = drawing.rows.iter().map(Vec::len).sum();
        assert_eq!(drawn, drawing.places.iter().flatten().count());
    }

    #[test]
    fn no_two_states_share_a_place_and_parents_stand_above_their_children() {
        let trace = backjump();
        let drawing = TreeDrawing::new(&TreeIndex::new(&trace), &|_| false);
        check_places(&trace, &drawing);
        assert!(drawing.places.iter().all(Option::is_some));
    }

    #[test]
    fn trees_of_any_shape_are_laid_out_without_overlap() {
        let mut seed = 7_u64;
        for _ in 0..50 {
            let parents: Vec<u32> = (0..200_u32)
                .map(|id| {
                    seed =
                        seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    let back = (seed >> 33) as u32 % 12;
                    id.saturating_sub(back)
                })
                .collect();
            let trace = failed(&parents);
            check_places(&trace, &TreeDrawing::new(&TreeIndex::new(&trace), &|_| false));
        }
    }

    #[test]
    fn a_long_chain_of_choices_stays_narrow() {
        // Each state has one alternative that was not tried, as in a search that never goes back.
        let parents: Vec<u32> = (0..20_000_u32).map(|id| id / 2 * 2).collect();
        let trace = failed(&parents);
        let drawing = TreeDrawing::new(&TreeIndex::new(&trace), &|_| false);
        assert!(drawing.width <= drawing.depth() / 2.0 + 1.0, "{}", drawing.width);
        check_places(&trace, &drawing);
    }

    #[test]
    fn folding_failed_subtrees_leaves_the_solution_in_sight() {
        let trace = backjump();
        let index = TreeIndex::new(&trace);
        let whole = TreeDrawing::new(&index, &|_| false);
        let drawing = TreeDrawing::new(&index, &|id| index.is_failed_subtree(id));
        assert!(drawing.width < whole.width);
        let solution = trace.tree.iter().position(|node| node.status == TreeStatus::Solution);
        assert!(solution.is_some_and(|id| drawing.places[id].is_some()));
        let hidden = drawing.places.iter().position(Option::is_none).expect("something is folded");
        let stand_in = drawing.stand_in(&trace, hidden as TreeNodeId);
        assert!(index.is_failed_subtree(stand_in) && drawing.places[stand_in as usize].is_some());
    }

    #[test]
    fn the_tree_grows_with_the_steps() {
        let trace = backjump();
        let index = TreeIndex::new(&trace);
        let known = |step| {
            (0..trace.tree.len() as TreeNodeId)
                .filter(|&id| index.is_known(id, Some(step)))
                .collect::<BTreeSet<_>>()
        };
        let mut before = BTreeSet::new();
        for step in 0..trace.events.len() {
            let now = known(step);
            assert!(now.is_superset(&before));
            assert!(now.contains(&trace.events[step].tree_node));
            before = now;
        }
    }

    #[test]
    fn failures_below_a_state_are_counted_once() {
        // The root with two branches: one with two failures, one that is a failure itself.
        let index = TreeIndex::new(&failed(&[0, 0, 1, 1]));
        assert_eq!(index.failures, vec![3, 2, 1, 1, 1]);
        assert_eq!(index.below, vec![4, 2, 0, 0, 0]);
    }

    #[test]
    fn the_nearest_state_is_found_by_its_place() {
        let trace = backjump();
        let drawing = TreeDrawing::new(&TreeIndex::new(&trace), &|_| false);
        for (id, place) in drawing.places.iter().enumerate() {
            let [across, down] = place.expect("nothing is folded");
            assert_eq!(drawing.nearest([across + 0.2, down - 0.1], [0.4, 0.4]), Some(id as TreeNodeId));
        }
        assert_eq!(drawing.nearest([drawing.width + 3.0, 1.0], [0.4, 0.4]), None);
    }
}
