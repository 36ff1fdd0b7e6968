//! The temporal plan network as flat data (SPEC 3.1): nodes, arcs, labels, decisions, occurrences and structure.
//!
//! Ids are indices into the vectors of [`Network`]. A network is built once and then only read; path insertion makes a
//! new one (SPEC 7.3).

use exact::{Bound, Time};
use rmpl::Span;
use rmpl::program::LabelMode;
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

macro_rules! id {
    ($($(#[$doc:meta])* $name:ident;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
        pub struct $name(pub u32);

        impl $name {
            /// The position in the vector that the id indexes.
            pub const fn index(self) -> usize {
                self.0 as usize
            }

            /// The id of the element at `index`.
            pub const fn from_index(index: usize) -> Self {
                Self(index as u32)
            }
        }

        impl From<usize> for $name {
            fn from(index: usize) -> Self {
                Self::from_index(index)
            }
        }

        impl From<$name> for usize {
            fn from(id: $name) -> Self {
                id.index()
            }
        }
    )*};
}

id! {
    /// An event of the network.
    NodeId;
    /// A temporal constraint between two events.
    ArcId;
    /// A decision, in textual order: `DecisionId(0)` is `D1`.
    DecisionId;
    /// A labelled interval: one label of one arc, in textual order of the arcs.
    LabelId;
    /// One occurrence of an activity, assertion, delay, scenario or conditional scope, in textual expansion order.
    OccurrenceId;
    /// A state variable.
    VariableId;
    /// A value, within its variable.
    ValueId;
    /// A block of the program's structure.
    BlockId;
}

/// A temporal plan network. A decision node has only [`ArcKind::Choice`] out-arcs, of which a plan selects exactly one;
/// of any other selected node a plan selects all out-arcs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Network {
    /// The events.
    pub nodes: Vec<Node>,
    /// The constraints, in textual order within each node.
    pub arcs: Vec<Arc>,
    /// The labelled intervals.
    pub labels: Vec<Label>,
    /// The decisions, in textual order.
    pub decisions: Vec<Decision>,
    /// What the program calls, asserts and waits for, in textual expansion order.
    pub occurrences: Vec<Occurrence>,
    /// The state variables that labels speak of.
    pub variables: Vec<Variable>,
    /// The program's structure, parents after children; drawings and explanations read it.
    /// Empty for a network that came without a program.
    pub blocks: Vec<Block>,
    /// The outermost block, if there is structure.
    pub root: Option<BlockId>,
    /// The event all windows are relative to.
    pub start: NodeId,
    /// The last event.
    pub end: NodeId,
    /// The least gap between conflicting intervals that planning orders (SPEC 5.3).
    pub threat_gap: Time,
}

/// An event.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Node {
    /// What it is for.
    pub role: Role,
    /// The named events that it is, in textual order; a node may carry several names or none.
    pub events: Vec<EventRef>,
    /// The decision, if it is one.
    pub decision: Option<DecisionId>,
    /// Arcs that leave it, in textual order.
    pub out_arcs: Vec<ArcId>,
    /// Arcs that enter it.
    pub in_arcs: Vec<ArcId>,
}

/// What a node is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// The start or end of an occurrence.
    Event,
    /// A fork, join or merge of the program's structure.
    #[default]
    Structural,
    /// A choice between its out-arcs.
    Decision,
}

/// One of the names of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct EventRef {
    /// Whose event.
    pub occurrence: OccurrenceId,
    /// Its start, its end, or a point of its path.
    pub end: EventEnd,
}

/// Which event of an occurrence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum EventEnd {
    /// It begins.
    Start,
    /// It is over.
    End,
    /// A traverse passes a vertex of its path (SPEC 7.3): `leg` from 1, `vertex` from 1 within the leg.
    /// The vertex that ends a leg is its waypoint.
    PathVertex {
        /// The leg between two waypoints, from 1.
        leg: u32,
        /// The vertex within the leg, from 1.
        vertex: u32,
    },
}

/// A temporal constraint `lower ≤ to − from ≤ upper`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Arc {
    /// The earlier event.
    pub from: NodeId,
    /// The later event.
    pub to: NodeId,
    /// Least duration; finite and not negative for arcs of a program.
    pub lower: Time,
    /// Greatest duration.
    pub upper: Bound,
    /// What it stands for.
    pub kind: ArcKind,
    /// Its labels.
    pub labels: Vec<LabelId>,
    /// The occurrence it is the duration of.
    pub occurrence: Option<OccurrenceId>,
    /// For a choice arc: the decision and the alternative, from 0.
    pub choice: Option<(DecisionId, u32)>,
    /// The text it comes from: the bounds where they are written, otherwise the statement.
    pub span: Option<Span>,
}

/// What an arc stands for (SPEC 3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ArcKind {
    /// A primitive.
    #[serde(rename = "act")]
    Activity,
    /// An assertion, or an explicit ask.
    #[serde(rename = "assert")]
    Assertion,
    /// A delay.
    Delay,
    /// An instance of a defined activity, start to end.
    #[serde(rename = "comp")]
    Composite,
    /// Bounds or a label on a composite.
    Span,
    /// The guard of an `if`.
    Point,
    /// Sequence.
    Glue,
    /// From a fork to a branch.
    Fork,
    /// From a branch to its join.
    Join,
    /// From a decision to an alternative.
    Choice,
    /// From an alternative to its merge.
    Merge,
    /// A piece of a traverse's path (SPEC 7.3).
    Path,
}

/// A condition asserted or required over an arc.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Label {
    /// The arc.
    pub arc: ArcId,
    /// Asserted or required.
    pub mode: LabelMode,
    /// The condition.
    pub literal: Literal,
    /// The condition as the contracts print it: `PATH1=OK`, `not(PROCEED=OK)`.
    pub text: SmolStr,
    /// The occurrence that the interval's name carries: `Tell(PROCEED=OK)@Tell(PROCEED=OK)#1`.
    pub owner: Option<OccurrenceId>,
    /// Where the condition is written.
    pub span: Option<Span>,
}

/// A state variable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Variable {
    /// Its name.
    pub name: SmolStr,
    /// The values that are declared or occur.
    pub values: Vec<SmolStr>,
    /// Whether `values` is all of its domain (declared, or a Boolean atom with the values `false` and `true`).
    pub closed: bool,
}

/// A variable restricted to a set of values.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Literal {
    /// The variable.
    pub variable: VariableId,
    /// The values.
    pub values: ValueSet,
}

/// A set of values of one variable, sorted and without repeats. Of a closed domain always [`ValueSet::In`].
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum ValueSet {
    /// Exactly these.
    In(Vec<ValueId>),
    /// All but these.
    NotIn(Vec<ValueId>),
}

impl ValueSet {
    /// Whether no value is in both.
    pub fn is_disjoint(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::In(left), Self::In(right)) => left.iter().all(|value| right.binary_search(value).is_err()),
            (Self::In(inside), Self::NotIn(outside)) | (Self::NotIn(outside), Self::In(inside)) => {
                inside.iter().all(|value| outside.binary_search(value).is_ok())
            }
            // Open domains always hold a value that neither names.
            (Self::NotIn(_), Self::NotIn(_)) => false,
        }
    }

    /// Whether every value of `self` is in `other`.
    pub fn is_subset(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::In(left), Self::In(right)) => left.iter().all(|value| right.binary_search(value).is_ok()),
            (Self::In(inside), Self::NotIn(outside)) => {
                inside.iter().all(|value| outside.binary_search(value).is_err())
            }
            (Self::NotIn(_), Self::In(_)) => false,
            (Self::NotIn(left), Self::NotIn(right)) => {
                right.iter().all(|value| left.binary_search(value).is_ok())
            }
        }
    }
}

impl Literal {
    /// Whether the two cannot hold together (SPEC 3.1).
    pub fn conflicts(&self, other: &Self) -> bool {
        self.variable == other.variable && self.values.is_disjoint(&other.values)
    }

    /// Whether asserting `self` makes `required` hold.
    pub fn supports(&self, required: &Self) -> bool {
        self.variable == required.variable && self.values.is_subset(&required.values)
    }
}

/// A choice of the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Decision {
    /// The decision node.
    pub node: NodeId,
    /// The choice arcs, one per alternative.
    pub alternatives: Vec<ArcId>,
    /// Where each alternative is written; parallel to `alternatives`, empty without a program.
    pub alternative_spans: Vec<Span>,
    /// The `choose`.
    pub span: Option<Span>,
}

/// One activity, assertion, delay or scenario, as it occurs in the expanded program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Occurrence {
    /// Its name in all output: `Group-Wait#1`, `Tell(PROCEED=OK)#1`, `delay#2`, `scenario#1`.
    pub name: SmolStr,
    /// Its activity, without the count: `Group-Wait`.
    pub activity: SmolStr,
    /// What it is.
    pub kind: OccurrenceKind,
    /// Its first event.
    pub start: NodeId,
    /// Its last event.
    pub end: NodeId,
    /// The arc of its duration, if it has one.
    pub arc: Option<ArcId>,
    /// The arguments of the call after substitution, as text.
    pub arguments: Vec<SmolStr>,
    /// The activity or scenario instance it occurs in.
    pub parent: Option<OccurrenceId>,
    /// Where the call, assertion or delay is written.
    pub span: Option<Span>,
}

/// What occurs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OccurrenceKind {
    /// A primitive activity.
    Primitive,
    /// A defined activity.
    Activity,
    /// An assertion or an explicit ask.
    Assertion,
    /// A delay.
    Delay,
    /// The scenario itself, or the activity planned for.
    Scenario,
    /// A `do` or an `if` whose condition is no activity's own: `do#1`, `if#1`. It names the labelled interval and has
    /// no events of its own, so it appears in no windows.
    Scope,
}

/// A piece of the program's structure, between its first and its last event.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Block {
    /// What it is.
    pub kind: BlockKind,
    /// Its first event.
    pub start: NodeId,
    /// Its last event.
    pub end: NodeId,
    /// Where it is written.
    pub span: Option<Span>,
}

/// The kinds of block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum BlockKind {
    /// One arc: a primitive, an assertion, a delay, or nothing (an empty block's glue).
    Leaf {
        /// The arc.
        arc: ArcId,
    },
    /// One after the other; the glue between neighbours is the arc from one's end to the next one's start, if they
    /// are different nodes.
    Sequence {
        /// In order.
        children: Vec<BlockId>,
    },
    /// All, between a fork and a join.
    Parallel {
        /// The branches, in textual order.
        branches: Vec<BlockId>,
    },
    /// One of several, between a decision and a merge.
    Choose {
        /// The decision.
        decision: DecisionId,
        /// The alternatives, in textual order.
        alternatives: Vec<BlockId>,
    },
    /// Bounds, a label or an activity instance around a child: `arc` spans from the block's start to its end,
    /// above the child.
    Scope {
        /// What is inside; its start and end may be the block's own.
        child: BlockId,
        /// The spanning arcs (composite, span), outermost first.
        arcs: Vec<ArcId>,
        /// The activity instance or scenario, if it is one.
        occurrence: Option<OccurrenceId>,
    },
    /// `if`: a guard arc, then a child.
    Guard {
        /// The point arc that asks.
        arc: ArcId,
        /// What follows.
        child: BlockId,
    },
}

impl Network {
    /// The name of one event of an occurrence: `Group-Wait#1.start`, `Group-Traverse-Path#1.leg2.vertex3`.
    pub fn event_name(&self, event: EventRef) -> String {
        let name = &self.occurrences[event.occurrence.index()].name;
        match event.end {
            EventEnd::Start => format!("{name}.start"),
            EventEnd::End => format!("{name}.end"),
            EventEnd::PathVertex { leg, vertex } => format!("{name}.leg{leg}.vertex{vertex}"),
        }
    }

    /// The name of a labelled interval: `Ask(PATH1=OK)@Group-Traverse-Path#1`.
    pub fn label_name(&self, label: LabelId) -> String {
        let label = &self.labels[label.index()];
        let mode = match label.mode {
            LabelMode::Ask => "Ask",
            LabelMode::Tell => "Tell",
        };
        match label.owner {
            Some(owner) => format!("{mode}({})@{}", label.text, self.occurrences[owner.index()].name),
            None => format!("{mode}({})@arc{}", label.text, label.arc.0),
        }
    }

    /// The printed name of a decision: `D1`.
    pub fn decision_name(decision: DecisionId) -> String {
        format!("D{}", decision.0 + 1)
    }
}
