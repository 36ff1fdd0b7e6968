//! The record of a search: events in order, and the tree that they walk (SPEC 5; issue "Trace").
//!
//! A trace is small: events name ids, and windows and selections are computed again by [`crate::Replay`]. It is bounded:
//! at the limit the recorded search ends, [`Trace::is_truncated`] says so, and the answer is found without a record.
//!
//! A conflict-driven search (SPEC 5.6) has a state for each level of decisions. What follows belongs to the state that it
//! follows in, also after the search has come back there. It may be several searches one after the other, each of which
//! starts with [`Event::Begin`] at the root and knows nothing of those before.

use exact::{Rational, Time};
use serde::{Deserialize, Serialize};
use tpn::{ArcId, CausalLink, Choice, DecisionId, LabelId, Network, NodeId, Ordering, UseId, UseOrdering};

/// A node of the search tree, by position in [`Trace::tree`]. The root is 0.
pub type TreeNodeId = u32;

/// A recorded search.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Trace {
    /// What happened, in order.
    pub events: Vec<Entry>,
    /// The states of the search: one per alternative of each choice point, and the root.
    pub tree: Vec<TreeNode>,
    /// Whether the record was full before the search came to an end.
    pub is_truncated: bool,
}

/// One thing that happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// The state of the search it happened in.
    pub tree_node: TreeNodeId,
    /// What happened.
    pub event: Event,
}

/// What can happen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Event {
    /// A selected node's out-arcs are added next.
    Expand { node: NodeId },
    /// An alternative is taken.
    Decide {
        decision: DecisionId,
        /// The alternative, from 0.
        alternative: u32,
    },
    /// An arc is selected and its bounds constrain the network.
    AddArc { arc: ArcId },
    /// The bounds have been propagated.
    Propagate {
        /// How many events had to move in the schedule that the search maintains.
        moved: u32,
    },
    /// The constraint just added contradicts others.
    Inconsistent {
        /// The contradiction.
        cycle: Vec<CycleMember>,
    },
    /// A requirement with no assertion left to carry it.
    Unclosable {
        /// The requirement.
        ask: LabelId,
    },
    /// An assertion is tried for a requirement.
    TryLink { link: CausalLink },
    /// Two conflicting intervals may overlap.
    Threat { left: LabelId, right: LabelId },
    /// One is put before the other.
    TryOrder { order: Ordering },
    /// Two conflicting intervals can be put in neither order.
    Unresolvable { left: LabelId, right: LabelId },
    /// The choices made contain a conflict learned before.
    Known {
        /// The choices of the conflict, the last one made last; none if there is no solution.
        choices: Vec<TreeChoice>,
    },
    /// Back to the last choice.
    Backtrack {
        /// The state in which it was made.
        to: TreeNodeId,
    },
    /// Back to the last choice that has to do with the failure.
    Backjump {
        /// The state in which it was made.
        to: TreeNodeId,
        /// The states whose choices caused the failure.
        because: Vec<TreeNodeId>,
    },
    Solution {
        /// Its position among the plans.
        plan: u32,
    },
    /// Nothing is left to try.
    Exhausted,
    /// A conflict-driven search starts.
    Begin(SearchRound),
    /// One use of a resource is put before another.
    TryUseOrder { order: UseOrdering },
    /// A use of a resource starts as early as it can; others wait for it.
    TryStart {
        used: UseId,
        /// When it starts, at the latest.
        by: Time,
    },
    /// What follows from choices made before.
    Imply {
        choice: TreeChoice,
        /// Whether it is so; otherwise it is ruled out.
        holds: bool,
        /// The choices that it follows from; none if it is so whatever is chosen.
        because: Vec<TreeChoice>,
    },
    /// No alternative is left of a decision.
    NoAlternative { decision: DecisionId },
    /// Too much of a resource, and none of the uses can wait for another one any more.
    Unsharable { uses: Vec<UseId> },
    /// No plan with these choices is as good as what is looked for.
    NotBetter { choices: Vec<TreeChoice> },
    /// Choices that cannot be made together.
    Clash {
        /// The choices; none if there is a contradiction whatever is chosen.
        choices: Vec<TreeChoice>,
    },
    /// Whatever is done, the environment can choose durations for which these choices leave no times (SPEC 13.1).
    Uncontrollable { choices: Vec<TreeChoice> },
    /// Changes without length that are each before the next one, in a circle (SPEC 10.2).
    Circle {
        /// The orders along the circle.
        orders: Vec<TreeChoice>,
    },
    /// Conflicting intervals touch, and nothing chosen forces them to (SPEC 5.3).
    NoRoomForGap,
    /// From now on the choices are never all made again.
    Learn {
        /// The choices; none if there is no solution.
        choices: Vec<TreeChoice>,
    },
    /// Uses that take more of a reusable resource than it has, if they are at one time: a new choice point.
    Overload {
        /// A minimal set of them.
        uses: Vec<UseId>,
    },
    /// Uses after which the level of a reservoir is out of its range: a new choice point.
    OutOfRange {
        /// The uses that take it there.
        early: Vec<UseId>,
        /// The uses of the other kind, one of which must come first.
        late: Vec<UseId>,
    },
    /// Back to the first state, with all that was learned.
    Restart,
    /// Everything is decided, and the times fit: what a plan keeps of their order, so that all its schedules fit.
    Keep {
        /// Orders of conditions, as in [`tpn::Plan::orderings_added`].
        orders: Vec<Ordering>,
        /// Orders of uses, as in [`tpn::Plan::uses_ordered`].
        uses: Vec<UseOrdering>,
    },
    /// A best-first search opens the state, to continue with it if none is better: what no plan with its choices is
    /// better than, by goal.
    Bound {
        /// The values, in the order of the goals.
        values: Vec<Rational>,
    },
    /// A best-first search continues with the state, for of those that are open none can become better.
    Visit {
        /// What no plan with its choices is better than, in the order of the goals.
        values: Vec<Rational>,
        /// How many other states are open.
        waiting: u32,
    },
    /// A plan that is better than those before, by the value of each goal.
    Improve {
        /// The values, in the order of the goals.
        values: Vec<Rational>,
    },
}

/// What one conflict-driven search of several looks for.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SearchRound {
    /// Whether choices are made in the order of the text; otherwise what has to do with conflicts comes first.
    pub is_in_textual_order: bool,
    /// Whether the state that may lead to the best plan continues, and not what was decided last.
    pub is_best_first: bool,
    /// The values of the first goals in the best plan so far: the last one of these is to be better, the others as good.
    pub values: Vec<Rational>,
    /// What no plan makes better of the last of these, whatever is chosen.
    pub bound: Option<Rational>,
}

/// A movement and what leaves its vehicle where it sets out, with no other movement between (SPEC 10.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Departing {
    /// The movement, by where it leaves the vehicle.
    pub movement: LabelId,
    /// The movement before it, or where the vehicle is at first.
    pub before: LabelId,
}

/// A constraint of the network that planning works on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Constraint {
    /// The least duration of an arc.
    Lower(ArcId),
    /// The greatest duration of an arc.
    Upper(ArcId),
    /// A requirement begins after the assertion that carries it, and ends before it ends.
    Link(CausalLink),
    /// One interval ends before another begins.
    Order(Ordering),
    /// One use of a resource ends before another begins.
    UseOrder(UseOrdering),
    /// A movement takes as long as from where it sets out.
    Departure(Departing),
}

/// One step of a contradiction: `to − from ≤ weight`. The weights of a cycle add up to less than zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CycleMember {
    pub constraint: Constraint,
    /// Where the step starts.
    pub from: NodeId,
    /// Where it ends; the next step starts there.
    pub to: NodeId,
    /// In time units.
    pub weight: Time,
}

/// A state of the search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TreeNode {
    /// The state that it was reached from.
    pub parent: Option<TreeNodeId>,
    /// What was chosen there; nothing at the root, and where a plan needs no choice.
    pub choice: Option<TreeChoice>,
    /// What became of it.
    pub status: TreeStatus,
}

/// What distinguishes a state from its parent, and what choices are called where they are the reason of something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TreeChoice {
    /// An alternative of the program.
    Decision {
        decision: DecisionId,
        /// The alternative, from 0.
        alternative: u32,
    },
    /// An assertion for a requirement.
    Link(CausalLink),
    /// An order of two conflicting intervals.
    Order(Ordering),
    /// A requirement that has no assertion.
    NoLink {
        /// The requirement.
        ask: LabelId,
    },
    /// An order of two uses of a resource.
    UseOrder(UseOrdering),
    /// A latest start of a use of a resource.
    Start {
        used: UseId,
        /// When it starts, at the latest.
        by: Time,
    },
    /// A use of a resource starts later than another state of the same search has it.
    Later {
        used: UseId,
        /// It starts after this.
        than: Time,
    },
    /// Where a movement sets out. This is never chosen; it follows from the order of movements.
    Departure(Departing),
    /// The gap is kept between all conflicting intervals that are put in order (SPEC 5.3): assumed until it is refuted.
    Apart,
}

impl From<Choice> for TreeChoice {
    fn from(Choice { decision, alternative }: Choice) -> Self {
        Self::Decision { decision, alternative }
    }
}

impl TreeChoice {
    /// Returns whether both are alternatives of one choice point.
    pub fn is_alternative_of(self, other: Self) -> bool {
        match (self, other) {
            (Self::Decision { decision, .. }, Self::Decision { decision: other, .. }) => decision == other,
            (Self::Link(link), Self::Link(other)) => link.ask == other.ask,
            (Self::Order(order), Self::Order(other)) => {
                order == other || (order.first, order.then) == (other.then, other.first)
            }
            (Self::UseOrder(order), Self::UseOrder(other)) => {
                order == other || (order.first, order.then) == (other.then, other.first)
            }
            _ => self == other,
        }
    }
}

/// What became of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TreeStatus {
    /// Not entered: the search has not come so far, or found a plan before.
    Unexplored,
    /// Not entered, and never to be: what failed fails with it as well.
    Excluded,
    /// Entered, and left for the states below.
    Decision,
    Failed,
    Solution,
}

impl Trace {
    /// A name for a state, for drawing: `D1=0`, `Ask(…) ← Tell(…)`, `Tell(…) < Tell(…)`, `start`.
    pub fn label(&self, network: &Network, node: TreeNodeId) -> String {
        let Some(node) = self.tree.get(node as usize) else { return String::new() };
        match node.choice {
            None if node.parent.is_some() => "plan".to_owned(),
            None => "start".to_owned(),
            Some(TreeChoice::Decision { decision, alternative }) => {
                format!("{}={alternative}", Network::decision_name(decision))
            }
            Some(TreeChoice::Link(link)) => {
                format!("{} ← {}", network.label_name(link.ask), network.label_name(link.tell))
            }
            Some(TreeChoice::Order(order)) => {
                format!("{} < {}", network.label_name(order.first), network.label_name(order.then))
            }
            Some(TreeChoice::NoLink { ask }) => format!("{} ← nothing", network.label_name(ask)),
            Some(TreeChoice::UseOrder(order)) => {
                format!("{} < {}", network.use_name(order.first), network.use_name(order.then))
            }
            Some(TreeChoice::Start { used, by }) => format!("{} by {by}", network.use_name(used)),
            Some(TreeChoice::Later { used, than }) => {
                format!("{} after {than}", network.use_name(used))
            }
            Some(TreeChoice::Apart) => "keeping all gaps".to_owned(),
            Some(TreeChoice::Departure(Departing { movement, before })) => {
                format!("{} from {}", network.label_name(movement), network.label_name(before))
            }
        }
    }

    /// Returns whether this is the record of a conflict-driven search.
    pub fn is_conflict_driven(&self) -> bool {
        matches!(self.events.first(), Some(Entry { event: Event::Begin(_), .. }))
    }

    /// Returns whether two states are alternatives of one choice point. Those of one choice point stand side by side.
    pub fn are_alternatives(&self, one: TreeNodeId, other: TreeNodeId) -> bool {
        let node = |id: TreeNodeId| self.tree.get(id as usize);
        let (Some(one), Some(other)) = (node(one), node(other)) else { return false };
        let is_one_point = match (one.choice, other.choice) {
            (Some(one), Some(other)) => one.is_alternative_of(other),
            _ => false,
        };
        one.parent == other.parent && is_one_point
    }

    /// Returns what a search has learned by a step, each with the step in which it did.
    pub fn learned(&self, step: usize) -> impl Iterator<Item = (usize, &[TreeChoice])> {
        self.events.iter().take(step.saturating_add(1)).enumerate().filter_map(|(step, entry)| {
            match &entry.event {
                Event::Learn { choices } | Event::Uncontrollable { choices } => {
                    Some((step, choices.as_slice()))
                }
                _ => None,
            }
        })
    }

    /// The states that represent alternatives of the same choice point as `node`, in order, `node` included.
    pub fn children(&self, node: TreeNodeId) -> impl Iterator<Item = TreeNodeId> + '_ {
        (0..).zip(&self.tree).filter(move |(_, child)| child.parent == Some(node)).map(|(id, _)| id)
    }
}

/// Records a search up to a limit.
#[derive(Clone, Debug)]
pub(crate) struct Recorder {
    pub(crate) trace: Trace,
    limit: usize,
}

impl Recorder {
    pub(crate) fn new(limit: usize) -> Self {
        let root = TreeNode { parent: None, choice: None, status: TreeStatus::Decision };
        Self { trace: Trace { tree: vec![root], ..Trace::default() }, limit }
    }

    pub(crate) fn record(&mut self, tree_node: TreeNodeId, event: Event) {
        if self.trace.events.len() < self.limit {
            self.trace.events.push(Entry { tree_node, event });
        } else {
            self.trace.is_truncated = true;
        }
    }

    /// Adds the states of a choice point's alternatives; returns the first one's id.
    pub(crate) fn branch(
        &mut self,
        parent: TreeNodeId,
        choices: impl Iterator<Item = TreeChoice>,
    ) -> TreeNodeId {
        let first = self.trace.tree.len() as TreeNodeId;
        if self.trace.tree.len() < self.limit {
            let node = |choice| TreeNode {
                parent: Some(parent),
                choice: Some(choice),
                status: TreeStatus::Unexplored,
            };
            self.trace.tree.extend(choices.map(node));
        } else {
            self.trace.is_truncated = true;
        }
        first
    }

    /// Adds a state that is entered at once.
    pub(crate) fn enter(&mut self, parent: TreeNodeId, choice: Option<TreeChoice>) -> Option<TreeNodeId> {
        if self.trace.tree.len() >= self.limit {
            self.trace.is_truncated = true;
            return None;
        }
        self.trace.tree.push(TreeNode { parent: Some(parent), choice, status: TreeStatus::Decision });
        Some(self.trace.tree.len() as TreeNodeId - 1)
    }

    pub(crate) fn set_status(&mut self, node: TreeNodeId, status: TreeStatus) {
        if let Some(node) = self.trace.tree.get_mut(node as usize) {
            node.status = status;
        }
    }
}
