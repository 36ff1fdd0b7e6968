//! Best-first search: of all states that are open the one continues whose goals may still become best (A*: Hart, Nilsson
//! and Raphael 1968), so that the first solution is one that no other is better than. Conflicts are learned, and
//! exclude states before they are visited (conflict-directed A*: Williams and Ragno 2007).
//!
//! It shows how bounds lead a search, and keeps every open state; better and better plans, each found by a search that
//! goes as deep as it can, need neither the memory nor the way from state to state.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use typed_index_collections::TiVec;

use super::Solver;
use super::encode::Problem;
use super::literal::Literal;
use super::resources::Sharing;
use super::trail::Cause;
use crate::ids::{ChoicePointId, StateId};
use crate::options::Stats;
use crate::trace::{Event, TreeNodeId};

/// What no solution below a state is better than: the least value of each goal's sum.
pub(crate) type MinSums = Vec<i64>;

/// More states are not kept.
const MAX_STATES: usize = 200_000;

/// A state: what was decided last, and after what.
#[derive(Clone, Debug)]
struct State {
    parent: Option<StateId>,
    /// Nothing at the root.
    decided: Option<Literal>,
    /// Where it is in the record.
    tree_node: Option<TreeNodeId>,
}

/// A state that may lead to solutions. Of equally good ones the deepest continues, and of these the first.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Open {
    least: Reverse<MinSums>,
    depth: u32,
    state: Reverse<StateId>,
}

/// The states of a best-first search.
#[derive(Clone, Debug)]
pub(crate) struct Frontier {
    states: TiVec<StateId, State>,
    open: BinaryHeap<Open>,
    /// What the last solution was not to be better than.
    pub(crate) visited: MinSums,
}

/// What came of going on with the best open states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Visit {
    /// Everything is decided, and the least values of all times fit. No open state is better than [`Frontier::visited`].
    Solution,
    /// What is open is no better than what was asked for.
    NothingBetter,
    Stopped,
    TooManyStates,
}

impl Frontier {
    pub(crate) fn new(num_goals: usize) -> Self {
        let root = State { parent: None, decided: None, tree_node: Some(0) };
        let open =
            Open { least: Reverse(vec![i64::MIN; num_goals]), depth: 0, state: Reverse(StateId::from(0)) };
        Self { states: vec![root].into(), open: BinaryHeap::from([open]), visited: Vec::new() }
    }

    /// Returns what nothing that is open is better than, if anything is.
    pub(crate) fn least(&self) -> Option<&MinSums> {
        self.open.peek().map(|open| &open.least.0)
    }

    /// The states from below the root to `state`.
    fn way_to(&self, state: StateId) -> Vec<StateId> {
        let mut way = Vec::new();
        let mut at = state;
        while let Some(parent) = self.states[at].parent {
            way.push(at);
            at = parent;
        }
        way.reverse();
        way
    }

    fn push(&mut self, state: State, least: MinSums, depth: u32) {
        let state = self.states.push_and_get_key(state);
        self.open.push(Open { least: Reverse(least), depth, state: Reverse(state) });
    }
}

impl Solver {
    /// Continues with the best open states until one of them is a solution that is better than `than`, if that is given.
    /// `stop` is asked once a state.
    pub(crate) fn visit_best(
        &mut self,
        problem: &mut Problem<'_>,
        frontier: &mut Frontier,
        stop: &mut dyn FnMut(&Stats) -> bool,
    ) -> Visit {
        while let Some(mut open) = frontier.open.pop() {
            if stop(&self.stats) || frontier.states.len() > MAX_STATES {
                let is_stopped = frontier.states.len() <= MAX_STATES;
                frontier.open.push(open);
                self.retract(0);
                return if is_stopped { Visit::Stopped } else { Visit::TooManyStates };
            }
            if !self.go_to(problem, frontier, open.state.0) {
                continue;
            }
            // What has been learned since it was opened may tell more.
            let known = self.min_sums(problem, &open.least.0);
            if known > open.least.0 && open.depth > 0 {
                self.record_bound(problem, &known);
                open.least.0 = known;
                frontier.open.push(open);
                continue;
            }
            open.least.0 = known;
            self.record_visit(problem, &open.least.0, frontier.open.len());
            if let Some(choice_point) = self.next_choice_point() {
                self.branch(problem, frontier, &open, choice_point);
                continue;
            }
            match self.look_at_leaf(problem, stop) {
                Leaf::Solution => {
                    frontier.visited = open.least.0;
                    return Visit::Solution;
                }
                Leaf::Changed => frontier.open.push(open),
                Leaf::Start(start) => self.branch_on_start(problem, frontier, &open, start),
                Leaf::Stopped => {
                    frontier.open.push(open);
                    self.retract(0);
                    return Visit::Stopped;
                }
            }
        }
        self.retract(0);
        Visit::NothingBetter
    }

    /// Tells of all states that are open still that they are no better than the plan that was found.
    pub(crate) fn close(&mut self, frontier: &Frontier) {
        // One that is open again goes by the states below it.
        let parents: BTreeSet<StateId> = frontier.states.iter().filter_map(|state| state.parent).collect();
        for open in frontier.open.clone().into_sorted_vec().into_iter().rev() {
            let state = open.state.0;
            match frontier.states[state].tree_node {
                Some(tree_node) if parents.contains(&state) => self.record_tried(tree_node),
                Some(tree_node) => {
                    self.record_refused(tree_node, Event::NotBetter { choices: Vec::new() });
                }
                None => {}
            }
        }
    }

    /// Makes the decisions of a state again. `false` if they cannot all be made.
    fn go_to(&mut self, problem: &Problem<'_>, frontier: &Frontier, state: StateId) -> bool {
        self.retract(0);
        if !self.settle(problem) {
            return false;
        }
        for ancestor in frontier.way_to(state) {
            let State { decided, tree_node, .. } = frontier.states[ancestor];
            let Some(literal) = decided else { continue };
            let refused = frontier.states[state].tree_node;
            if self.trail.fails(literal) {
                self.record_known(refused, Some(literal));
                return false;
            }
            self.trail.open_level();
            // An open Boolean can be either.
            let _ = self.trail.set(literal, Cause::Decision);
            self.record_again(tree_node);
            if !self.settle(problem) {
                // A failure of its own has been told.
                self.record_known(refused.filter(|_| ancestor != state), None);
                return false;
            }
        }
        true
    }

    /// Propagates, and learns from the conflict where there is one.
    fn settle(&mut self, problem: &Problem<'_>) -> bool {
        let conflict = match self.propagate(&mut |_| false) {
            Ok(_) if !self.is_contradictory => {
                self.record_implied();
                return true;
            }
            Ok(_) => return false,
            Err(conflict) => conflict,
        };
        self.record_failure(problem, &conflict);
        self.stats.conflicts += 1;
        let Stats { backtracks, jumped_over, .. } = self.stats;
        if !self.learn(&conflict) {
            self.is_contradictory = true;
        }
        // It continues in the best state, wherever that is: none is returned to.
        self.stats = Stats { backtracks, jumped_over, ..self.stats };
        false
    }

    /// The first choice point that counts and is not decided.
    fn next_choice_point(&mut self) -> Option<ChoicePointId> {
        while let Some(id) = self.activity.pop() {
            let choice_point = &self.choice_points[id];
            let counts = choice_point.when.iter().all(|&when| self.trail.holds(when));
            if counts && !choice_point.options.iter().any(|&option| self.trail.holds(option)) {
                self.activity.insert(id);
                return Some(id);
            }
        }
        None
    }

    /// Opens a state for each option that is left.
    fn branch(&mut self, problem: &Problem<'_>, frontier: &mut Frontier, from: &Open, id: ChoicePointId) {
        let level = self.trail.level();
        for option in self.choice_points[id].options.clone() {
            if self.trail.fails(option) {
                continue;
            }
            self.trail.open_level();
            let _ = self.trail.set(option, Cause::Decision);
            self.record_decision(option);
            let is_left = self.open(problem, frontier, from, option, level);
            if is_left {
                continue;
            }
            // What it has taught changes what is left for its siblings, and may leave one alone.
            if !self.go_to(problem, frontier, from.state.0) {
                return;
            }
            if self.choice_points[id].options.iter().any(|&option| self.trail.holds(option)) {
                frontier.open.push(from.clone());
                return;
            }
        }
    }

    /// Opens a state in which a use starts as early as it can, and one in which it does not.
    fn branch_on_start(
        &mut self,
        problem: &Problem<'_>,
        frontier: &mut Frontier,
        from: &Open,
        start: Literal,
    ) {
        let level = self.trail.level() - 1;
        let tree_node = self.record_later(start);
        let later = State { parent: Some(from.state.0), decided: Some(!start), tree_node };
        self.open(problem, frontier, from, start, level);
        frontier.push(later, from.least.0.clone(), from.depth);
    }

    /// Opens a state that has been decided, and leaves it. If its times do not fit nothing is opened, and what has been
    /// learned is kept: `false`.
    fn open(
        &mut self,
        problem: &Problem<'_>,
        frontier: &mut Frontier,
        from: &Open,
        decided: Literal,
        level: u32,
    ) -> bool {
        self.stats.expanded += 1;
        let tree_node = self.recorded_state();
        if !self.settle(problem) {
            return false;
        }
        let least = self.min_sums(problem, &from.least.0);
        self.record_bound(problem, &least);
        frontier.push(
            State { parent: Some(from.state.0), decided: Some(decided), tree_node },
            least,
            from.depth + 1,
        );
        self.retract(level);
        true
    }

    /// Returns what no solution below the present state is better than, where nothing above it is better than `before`.
    fn min_sums(&self, problem: &Problem<'_>, before: &[i64]) -> MinSums {
        problem.goal_bounds(self).into_iter().zip(before).map(|(own, &before)| own.max(before)).collect()
    }

    /// Looks at a state in which everything that counts is decided.
    fn look_at_leaf(&mut self, problem: &mut Problem<'_>, stop: &mut dyn FnMut(&Stats) -> bool) -> Leaf {
        self.stats.leaves += 1;
        let is_broken = self.is_broken(problem);
        let sharing = if is_broken { Sharing::Restarted } else { problem.share(self) };
        let is_changed = match sharing {
            Sharing::Restarted => true,
            Sharing::Decided => {
                let start = self.trail.last_decision();
                return start.map_or(Leaf::Changed, Leaf::Start);
            }
            Sharing::Fits => {
                debug_assert!(self.is_solution(problem), "the least times fit");
                let stats = self.stats;
                match problem.withstand(self, &mut || stop(&stats)) {
                    Some(is_changed) => is_changed,
                    None => return Leaf::Stopped,
                }
            }
        };
        if is_changed {
            self.record_choice_points(problem);
            Leaf::Changed
        } else {
            Leaf::Solution
        }
    }
}

/// What a state without open choice points is.
enum Leaf {
    Solution,
    /// There are new choice points, or it is excluded.
    Changed,
    /// It has been decided when a use starts.
    Start(Literal),
    Stopped,
}
