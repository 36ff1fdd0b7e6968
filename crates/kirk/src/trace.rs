//! The record of a search: events in order, and the tree that they walk (SPEC 5; issue "Trace").
//!
//! A trace is small: events name ids, and windows and selections are computed again by [`crate::Replay`]. It is bounded:
//! at the limit the recorded search ends, [`Trace::is_truncated`] says so, and the answer is found without a record.

use exact::Time;
use serde::{Deserialize, Serialize};
use tpn::{ArcId, CausalLink, DecisionId, LabelId, Network, NodeId, Ordering};

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
    Expand {
        /// The node.
        node: NodeId,
    },
    /// An alternative is taken.
    Decide {
        /// The decision.
        decision: DecisionId,
        /// The alternative, from 0.
        alternative: u32,
    },
    /// An arc is selected and its bounds constrain the network.
    AddArc {
        /// The arc.
        arc: ArcId,
    },
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
    TryLink {
        /// The link.
        link: CausalLink,
    },
    /// Two conflicting intervals may overlap.
    Threat {
        /// One of them.
        left: LabelId,
        /// The other.
        right: LabelId,
    },
    /// One is put before the other.
    TryOrder {
        /// The order.
        order: Ordering,
    },
    /// Two conflicting intervals can be put in neither order.
    Unresolvable {
        /// One of them.
        left: LabelId,
        /// The other.
        right: LabelId,
    },
    /// The choices made contain a conflict learned before.
    Known,
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
    /// A plan.
    Solution {
        /// Its position among the plans.
        plan: u32,
    },
    /// Nothing is left to try.
    Exhausted,
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
}

/// One step of a contradiction: `to − from ≤ weight`. The weights of a cycle add up to less than zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CycleMember {
    /// The constraint.
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
    /// What was chosen there; nothing at the root.
    pub choice: Option<TreeChoice>,
    /// What became of it.
    pub status: TreeStatus,
}

/// What distinguishes a state from its parent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TreeChoice {
    /// An alternative of the program.
    Decision {
        /// The decision.
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
}

/// What became of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TreeStatus {
    /// Never entered.
    Unexplored,
    /// Entered, and left for the states below.
    Decision,
    /// A failure.
    Failed,
    /// A plan.
    Solution,
}

impl Trace {
    /// A name for a state, for drawing: `D1=0`, `Ask(…) ← Tell(…)`, `Tell(…) < Tell(…)`, `start`.
    pub fn label(&self, network: &Network, node: TreeNodeId) -> String {
        let Some(node) = self.tree.get(node as usize) else { return String::new() };
        match node.choice {
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
        }
    }

    /// The states that stand for alternatives of the same choice point as `node`, in order, `node` included.
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

    pub(crate) fn set_status(&mut self, node: TreeNodeId, status: TreeStatus) {
        if let Some(node) = self.trace.tree.get_mut(node as usize) {
            node.status = status;
        }
    }
}
