//! The temporal plan network as flat data (SPEC 3.1): nodes, arcs, labels, decisions, occurrences and structure.
//!
//! Ids are indices into the vectors of [`Network`]. A network is built once and then only read; path insertion makes a
//! new one (SPEC 7.3).

use exact::{Bound, Rational, Time};
use rmpl::Span;
use rmpl::program::{Change, Controllability, LabelMode, Measure, Order, component_of_state};
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

use crate::call_names::NamesOnDemand;
use crate::exchange::Exchangeable;
use crate::sight::Sight;

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
    /// A labeled interval: one label of one arc, in textual order of the arcs.
    LabelId;
    /// One occurrence of an activity, assertion, delay, scenario or conditional scope, in textual expansion order.
    OccurrenceId;
    /// A state variable.
    VariableId;
    /// A value, within its variable.
    ValueId;
    /// A block of the program's structure.
    BlockId;
    /// A resource of the network.
    ResourceId;
    /// One use of a resource by one activity or block.
    UseId;
}

/// A temporal plan network. A decision node has only [`ArcKind::Choice`] out-arcs, of which a plan selects exactly one;
/// of any other selected node a plan selects all out-arcs. Bounds between threads ([`ArcKind::Constraint`]) are no
/// node's arcs: a plan selects those of which it selects both events.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Network {
    pub nodes: Vec<Node>,
    /// The constraints, in textual order within each node.
    pub arcs: Vec<Arc>,
    /// The labeled intervals.
    pub labels: Vec<Label>,
    /// The decisions, in textual order.
    pub decisions: Vec<Decision>,
    /// What the program calls, asserts and waits for, in textual expansion order.
    pub occurrences: Vec<Occurrence>,
    /// The state variables that labels speak of.
    pub variables: Vec<Variable>,
    /// What vehicles see of the locations that conditions are about (SPEC 10.5).
    #[serde(default)]
    pub sights: Vec<Sight>,
    /// The resources that are used (SPEC 11).
    pub resources: Vec<Resource>,
    /// Who uses them, in textual order.
    pub uses: Vec<Use>,
    /// What selected arcs cost and are rewarded with (SPEC 12), in textual order.
    pub worths: Vec<Worth>,
    /// How long movements take at least, by where they start, as far as that is known (SPEC 10.3).
    pub departures: Vec<Departure>,
    /// How many meters movements drive at least, by where they start, as far as that is known and counts (SPEC 12).
    #[serde(default)]
    pub distances: Vec<Distance>,
    /// What plans are to be best in, the most important goal first; empty if any plan will do.
    pub objective: Vec<Goal>,
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
    /// What plans have to withstand of durations that the environment chooses.
    #[serde(default)]
    pub controllability: Controllability,
    /// Which vehicles can be exchanged, and what they are exchanged in.
    #[serde(default)]
    pub exchangeable: Exchangeable,
    /// What people read for its calls.
    #[serde(skip)]
    pub names: NamesOnDemand,
}

/// A node: the events that happen at one time, or a point between them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Node {
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
    pub occurrence: OccurrenceId,
    /// Its start, its end, or a point of its path.
    pub end: EventEnd,
}

/// Which event of an occurrence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum EventEnd {
    Start,
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
    /// Whether the environment chooses the duration within its bounds (SPEC 13.1).
    #[serde(default)]
    pub is_contingent: bool,
    /// What it represents.
    pub kind: ArcKind,
    pub labels: Vec<LabelId>,
    /// The occurrence it is the duration of.
    pub occurrence: Option<OccurrenceId>,
    /// For a choice arc: the decision and the alternative, from 0.
    pub choice: Option<(DecisionId, u32)>,
    /// The text it comes from: the bounds where they are written, otherwise the statement.
    pub span: Option<Span>,
}

impl Arc {
    /// An arc of the planner's bounds and no more: it has no text, no labels, and no occurrence, and nobody chooses its duration.
    pub const fn bare(from: NodeId, to: NodeId, (lower, upper): (Time, Bound), kind: ArcKind) -> Self {
        Self {
            from,
            to,
            lower,
            upper,
            is_contingent: false,
            kind,
            labels: Vec::new(),
            occurrence: None,
            choice: None,
            span: None,
        }
    }
}

/// What an arc represents (SPEC 3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ArcKind {
    #[serde(rename = "act")]
    Activity,
    /// An assertion, or an explicit ask.
    #[serde(rename = "assert")]
    Assertion,
    Delay,
    /// An instance of a defined activity, start to end.
    #[serde(rename = "comp")]
    Composite,
    /// Bounds or a label on a composite.
    Span,
    /// The guard of an `if`.
    Point,
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
    /// A bound between events of different threads (SPEC 14). It belongs to no node's arcs: it leads nowhere, and is in
    /// force where both its events are selected.
    Constraint,
}

/// A condition asserted or required over an arc.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Label {
    pub arc: ArcId,
    /// Asserted or required.
    pub mode: LabelMode,
    /// Which part of the arc it is about.
    pub extent: Extent,
    /// The condition.
    pub literal: Literal,
    /// The condition as the contracts print it: `PATH1=OK`, `not(PROCEED=OK)`.
    pub text: SmolStr,
    /// The occurrence that the interval's name carries: `Tell(PROCEED=OK)@Tell(PROCEED=OK)#1`.
    pub owner: Option<OccurrenceId>,
    /// Where the condition is written.
    pub span: Option<Span>,
}

/// Which part of its arc a label is about (SPEC 10.2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Extent {
    /// From the arc's start to its end.
    #[default]
    Arc,
    /// The instant of the arc's start.
    Start,
    /// Of an assertion: the variable is changing along the arc, and has the value from its end on.
    Effect,
    /// Of an assertion: the value that a state variable has at the start of everything.
    Initial,
}

/// A state variable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Variable {
    pub name: SmolStr,
    /// The values that are declared or occur.
    pub values: Vec<SmolStr>,
    /// Whether `values` is all of its domain (declared, or a Boolean atom with the values `false` and `true`).
    pub closed: bool,
    /// Whether it keeps a value until something changes it (SPEC 10); otherwise it is known only where it is asserted.
    #[serde(default)]
    pub is_lasting: bool,
}

impl Variable {
    /// The component whose mode it is, if it is read from the plant (SPEC 15).
    pub fn component(&self) -> Option<&str> {
        component_of_state(&self.name).filter(|_| self.is_lasting)
    }
}

/// A resource (SPEC 11).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Resource {
    /// Its name; that of an `unordered` block is `unordered#1`.
    pub name: SmolStr,
    /// How much of it there is.
    pub supply: Supply,
    /// Where it is declared.
    pub span: Option<Span>,
}

/// How much of a resource there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Supply {
    /// What is used is free again afterwards.
    Reusable {
        /// How much may be used at a time.
        capacity: Rational,
    },
    /// What is consumed is gone until something produces it.
    Reservoir {
        /// The level never goes below.
        least: Rational,
        /// The level never goes above.
        greatest: Rational,
        /// The level at the start.
        level: Rational,
    },
}

impl Supply {
    /// The level of a reservoir at the start; of another resource what is in use then, which is nothing.
    pub const fn initial_level(self) -> Rational {
        match self {
            Self::Reusable { .. } => Rational::ZERO,
            Self::Reservoir { level, .. } => level,
        }
    }
}

/// What an activity or a block takes of a resource, or gives to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Use {
    pub resource: ResourceId,
    /// What happens to it.
    pub change: Change,
    /// The maximum amount; not negative.
    pub amount: Rational,
    /// The minimum amount. It is less than `amount` only where meters count, because drives along one path differ in length.
    pub at_least: Rational,
    /// How much more for each meter that is driven.
    pub per_meter: Rational,
    /// It counts where this arc is selected.
    pub arc: ArcId,
    /// When it begins.
    pub start: NodeId,
    pub end: NodeId,
    pub owner: Option<OccurrenceId>,
    /// What the level of a reservoir must be, of a use that changes nothing (SPEC 17): just before `start` if both events are
    /// one, otherwise from then to `end`. What breaks a minimum is what consumes does, so that `change` says which it is.
    #[serde(default)]
    pub level: Option<LevelCondition>,
    /// Where it is written.
    pub span: Option<Span>,
}

/// What a level is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LevelCondition {
    pub order: Order,
    pub bound: Rational,
}

impl LevelCondition {
    /// The kind of change that can break it.
    pub const fn change(self) -> Change {
        if self.order.is_minimum() { Change::Consumes } else { Change::Produces }
    }
}

/// What an activity costs and is rewarded with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Worth {
    /// It counts where this arc is selected.
    pub arc: ArcId,
    /// Its cost, however far it drives.
    pub cost: Rational,
    /// Its cost for each meter of the planned path.
    pub cost_per_meter: Rational,
    pub reward: Rational,
}

/// How long a movement takes at least if it starts at one place: before its path is known by the straight line at the
/// greatest speed, and by its path afterwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Departure {
    /// Where the movement leaves its first vehicle: its label on `V.at`.
    pub arrival: LabelId,
    /// Where that vehicle is before.
    pub from: ValueId,
    /// The least duration; `None` if it cannot be driven from there.
    pub least: Option<Time>,
}

/// How many meters a movement drives at least if it starts at one place: before its path is known along the straight
/// line, and along its path afterwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Distance {
    /// Where the movement leaves its first vehicle: its label on `V.at`.
    pub arrival: LabelId,
    /// Where that vehicle is before.
    pub from: ValueId,
    /// The meters.
    pub meters: Rational,
}

/// One goal of an objective (SPEC 12).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Goal {
    /// Whether more is better.
    pub is_maximized: bool,
    /// What is added up: each measure with its factor.
    pub terms: Vec<(Rational, Measure)>,
    /// Where it is written.
    pub span: Option<Span>,
}

/// A variable restricted to a set of values.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Literal {
    pub variable: VariableId,
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
    /// Returns whether no value is in both.
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

    /// Returns whether a value is one of these.
    pub fn contains(&self, value: ValueId) -> bool {
        match self {
            Self::In(values) => values.binary_search(&value).is_ok(),
            Self::NotIn(values) => values.binary_search(&value).is_err(),
        }
    }

    /// Returns whether every value of `self` is in `other`.
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
    /// Returns whether the two cannot hold together (SPEC 3.1).
    pub fn conflicts(&self, other: &Self) -> bool {
        self.variable == other.variable && self.values.is_disjoint(&other.values)
    }

    /// Returns whether asserting `self` makes `required` hold.
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
    /// From how long to how long it takes to end it early, if that can be done (SPEC 15).
    #[serde(default)]
    pub aborts: Option<[Time; 2]>,
    /// Where the call, assertion or delay is written.
    pub span: Option<Span>,
}

/// What an occurrence is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OccurrenceKind {
    /// A primitive activity.
    Primitive,
    /// A defined activity.
    Activity,
    /// An assertion or an explicit ask.
    Assertion,
    Delay,
    /// The scenario itself, or the activity planned for.
    Scenario,
    /// A `do` or an `if` whose condition is not an activity's own: `do#1`, `if#1`. It names the labeled interval and has
    /// no events of its own, so it appears in no windows.
    Scope,
}

/// A piece of the program's structure, between its first and its last event.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Block {
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
    Leaf { arc: ArcId },
    /// One after the other; the glue between neighbors is the arc from one's end to the next one's start, if they
    /// are different nodes.
    Sequence { children: Vec<BlockId> },
    /// All, between a fork and a join.
    Parallel {
        /// The branches, in textual order.
        branches: Vec<BlockId>,
    },
    /// One of several, between a decision and a merge.
    Choose {
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
        child: BlockId,
    },
}

impl Use {
    /// When a reservoir is consumed from, or produced into, or a condition on its level begins to hold.
    pub fn moment(&self) -> NodeId {
        if self.change == Change::Produces && self.level.is_none() { self.end } else { self.start }
    }

    /// When it is over with a reservoir: a condition on its level at its end, all else the moment it happens.
    pub fn last_moment(&self) -> NodeId {
        if self.level.is_some() { self.end } else { self.moment() }
    }

    /// Returns whether it requires a level from one event to another, and not only before one.
    pub fn is_lasting(&self) -> bool {
        self.level.is_some() && self.start != self.end
    }

    /// A condition on a level as people read it: `R1.battery >= 30`.
    pub fn level_text(&self, resources: &[Resource]) -> Option<String> {
        let LevelCondition { order, bound } = self.level?;
        Some(format!("{} {} {}", resources[self.resource.index()].name, order.symbol(), bound.readable()))
    }

    /// The minimum and maximum change of a reservoir's level.
    pub fn level_changes(&self) -> [Rational; 2] {
        let less = |amount: Rational| amount.checked_neg().unwrap_or_default();
        match self.change {
            Change::Uses => [Rational::ZERO; 2],
            Change::Consumes => [less(self.amount), less(self.at_least)],
            Change::Produces => [self.at_least, self.amount],
        }
    }

    /// The amount that counts until the driven distance is known: the maximum that it takes, or the minimum that it gives.
    pub fn counted(&self) -> Rational {
        if self.change == Change::Produces { self.at_least } else { self.amount }
    }

    /// The amount for people: `4`, `28.5 to 40`.
    pub fn readable_amount(&self) -> String {
        let amount = self.amount.readable();
        if self.at_least == self.amount {
            amount
        } else {
            format!("{} to {amount}", self.at_least.readable())
        }
    }
}

impl Arc {
    /// Returns whether it keeps its events at one instant, so that what is nature's at one is nature's at the other
    /// (SPEC 13.1).
    pub fn is_tie(&self) -> bool {
        self.lower.is_zero() && self.upper == Bound::ZERO && !self.is_contingent
    }
}

impl Label {
    /// Returns what it does, as its name says: `Ask`, `Tell`, `Set` or `Init`.
    pub const fn verb(&self) -> &'static str {
        match (self.mode, self.extent) {
            (LabelMode::Ask, _) => "Ask",
            (LabelMode::Tell, Extent::Effect) => "Set",
            (LabelMode::Tell, Extent::Initial) => "Init",
            (LabelMode::Tell, Extent::Arc | Extent::Start) => "Tell",
        }
    }

    /// Returns whether a variable that keeps its value has none while this continues.
    pub fn is_changing(&self) -> bool {
        self.extent == Extent::Effect
    }
}

impl Network {
    /// Adds an arc between two events that are in the network.
    pub fn connect(&mut self, arc: Arc) -> ArcId {
        let id = ArcId::from_index(self.arcs.len());
        self.nodes[arc.from.index()].out_arcs.push(id);
        self.nodes[arc.to.index()].in_arcs.push(id);
        self.arcs.push(arc);
        id
    }

    /// The network with these choices: the arcs to other alternatives would have to take at least one unit and at most none.
    #[must_use]
    pub fn with_choices(&self, choices: impl IntoIterator<Item = crate::Choice>) -> Self {
        let mut network = self.clone();
        for choice in choices {
            let alternatives = &self.decisions[choice.decision.index()].alternatives;
            for (_, arc) in (0..).zip(alternatives).filter(|&(number, _)| number != choice.alternative) {
                network.arcs[arc.index()].lower = Time::ONE;
                network.arcs[arc.index()].upper = Bound::ZERO;
            }
        }
        network
    }

    /// For each event the first of those at one instant with it, if the ends of each of `ties` are.
    pub fn instants<'network>(&self, ties: impl Iterator<Item = &'network Arc>) -> Vec<NodeId> {
        fn find(first: &mut [usize], mut index: usize) -> usize {
            while first[index] != index {
                first[index] = first[first[index]];
                index = first[index];
            }
            index
        }
        let mut first: Vec<usize> = (0..self.nodes.len()).collect();
        for tie in ties {
            let (one, other) = (find(&mut first, tie.from.index()), find(&mut first, tie.to.index()));
            first[one.max(other)] = one.min(other);
        }
        (0..first.len()).map(|index| NodeId::from_index(find(&mut first, index))).collect()
    }

    /// The first and the last event of what a label occupies.
    pub fn interval(&self, label: LabelId) -> (NodeId, NodeId) {
        let label = &self.labels[label.index()];
        let arc = &self.arcs[label.arc.index()];
        match label.extent {
            Extent::Arc | Extent::Effect => (arc.from, arc.to),
            Extent::Start | Extent::Initial => (arc.from, arc.from),
        }
    }

    /// The event from which on what a label asserts holds (SPEC 10.2).
    pub fn ready(&self, label: LabelId) -> NodeId {
        let (start, end) = self.interval(label);
        if self.labels[label.index()].is_changing() { end } else { start }
    }

    /// Returns whether a label is about a variable that keeps its value (SPEC 10).
    pub fn is_lasting(&self, label: LabelId) -> bool {
        self.variables[self.labels[label.index()].literal.variable.index()].is_lasting
    }

    /// Returns whether two labels may not overlap: of a variable that keeps its value, changes exclude each other and
    /// what requires another value (SPEC 10.2); of others, conditions that cannot hold together (SPEC 3.1).
    pub fn conflict(&self, one: LabelId, other: LabelId) -> bool {
        let is_lasting = self.is_lasting(one);
        let (left, right) = (&self.labels[one.index()], &self.labels[other.index()]);
        if !is_lasting || left.literal.variable != right.literal.variable {
            return left.literal.conflicts(&right.literal);
        }
        match (left.mode, right.mode) {
            (LabelMode::Ask, LabelMode::Ask) => false,
            (LabelMode::Tell, LabelMode::Tell) => {
                left.is_changing() || right.is_changing() || left.literal != right.literal
            }
            (LabelMode::Ask, LabelMode::Tell) => {
                right.is_changing() || !right.literal.supports(&left.literal)
            }
            (LabelMode::Tell, LabelMode::Ask) => left.is_changing() || !left.literal.supports(&right.literal),
        }
    }

    /// The bounds between events of different threads.
    pub fn constraints(&self) -> impl Iterator<Item = ArcId> + '_ {
        let arcs = self.arcs.iter().enumerate();
        arcs.filter(|(_, arc)| arc.kind == ArcKind::Constraint).map(|(id, _)| ArcId::from_index(id))
    }

    /// Returns whether the environment chooses a duration, and the mission does not say to plan as if it did not (SPEC
    /// 13.1).
    pub fn is_uncertain(&self, arc: ArcId) -> bool {
        self.controllability != Controllability::None && self.arcs[arc.index()].is_contingent
    }

    /// Returns which events the environment executes where these arcs are selected: the ends of durations that it
    /// chooses, and what is tied to them by `[0,0]` (SPEC 13.1). Indexed by node; empty if there are none.
    pub fn natures_events(&self, selected_arcs: &[bool]) -> Vec<bool> {
        let is_selected = |arc: ArcId| selected_arcs.get(arc.index()).copied().unwrap_or(false);
        let mut open: Vec<NodeId> = (0..self.arcs.len())
            .map(ArcId::from_index)
            .filter(|&arc| self.is_uncertain(arc) && is_selected(arc))
            .map(|arc| self.arcs[arc.index()].to)
            .collect();
        if open.is_empty() {
            return Vec::new();
        }
        let mut natures = vec![false; self.nodes.len()];
        let between_threads: Vec<ArcId> = self.constraints().collect();
        while let Some(node) = open.pop() {
            if std::mem::replace(&mut natures[node.index()], true) {
                continue;
            }
            let beyond = |arc: &&ArcId| {
                let arc = &self.arcs[arc.index()];
                arc.from == node || arc.to == node
            };
            let own = &self.nodes[node.index()];
            let arcs = own.in_arcs.iter().chain(&own.out_arcs);
            for &id in arcs.chain(between_threads.iter().filter(beyond)) {
                let arc = &self.arcs[id.index()];
                if arc.is_tie() && is_selected(id) {
                    open.extend([arc.from, arc.to]);
                }
            }
        }
        natures
    }

    /// Returns whether the objective counts meters: driven ones, or the cost of each.
    pub fn counts_meters(&self) -> bool {
        let has_cost = self.worths.iter().any(|worth| !worth.cost_per_meter.is_zero());
        let counted = |measure: Measure| match measure {
            Measure::Length => true,
            Measure::Cost => has_cost,
            Measure::Reward | Measure::End => false,
        };
        self.objective.iter().flat_map(|goal| &goal.terms).any(|&(_, measure)| counted(measure))
    }

    /// The name of a use: `Uses(Power)@Radio#1`. Of several by one owner the second is `Uses(Power)#2@Radio#1`.
    pub fn use_name(&self, used: UseId) -> String {
        let of = &self.uses[used.index()];
        let verb = match of.change {
            _ if of.level.is_some() => "Requires",
            Change::Uses => "Uses",
            Change::Consumes => "Consumes",
            Change::Produces => "Produces",
        };
        let resource = &self.resources[of.resource.index()].name;
        let is_alike = |other: &&Use| {
            (other.resource, other.owner) == (of.resource, of.owner)
                && other.level.is_some() == of.level.is_some()
                && (of.level.is_some() || other.change == of.change)
                && (of.owner.is_some() || other.arc == of.arc)
        };
        let count = ordinal(self.uses[..used.index()].iter().filter(is_alike).count());
        match of.owner {
            Some(owner) => format!("{verb}({resource}){count}@{}", self.occurrences[owner.index()].name),
            None => format!("{verb}({resource}){count}@arc{}", of.arc.0),
        }
    }

    /// The name of one event of an occurrence: `Group-Wait#1.start`, `Group-Traverse-Path#1.leg2.vertex3`.
    pub fn event_name(&self, event: EventRef) -> String {
        let name = &self.occurrences[event.occurrence.index()].name;
        match event.end {
            EventEnd::Start => format!("{name}.start"),
            EventEnd::End => format!("{name}.end"),
            EventEnd::PathVertex { leg, vertex } => format!("{name}.leg{leg}.vertex{vertex}"),
        }
    }

    /// The name of a labeled interval: `Ask(PATH1=OK)@Group-Traverse-Path#1`, `Set(ARM=OUT)@Deploy#1`, `Init(ARM=IN)`. Of
    /// several by one owner the second is `Ask(ARM=OUT)#2@Dig#1`.
    pub fn label_name(&self, label: LabelId) -> String {
        let of = &self.labels[label.index()];
        let mode = of.verb();
        let count = ordinal(self.earlier_namesakes(label));
        match of.owner {
            _ if of.extent == Extent::Initial => format!("{mode}({}){count}", of.text),
            Some(owner) => format!("{mode}({}){count}@{}", of.text, self.occurrences[owner.index()].name),
            None => format!("{mode}({}){count}@arc{}", of.text, of.arc.0),
        }
    }

    /// Returns how many labels before this one have its owner, what it does, and its condition. They begin at one
    /// event: arcs of one owner do.
    fn earlier_namesakes(&self, label: LabelId) -> usize {
        let of = &self.labels[label.index()];
        let from = self.arcs[of.arc.index()].from;
        let arcs = self.nodes[from.index()].out_arcs.iter();
        let labels = arcs.flat_map(|arc| &self.arcs[arc.index()].labels);
        let is_alike = |other: &Label| {
            (other.owner, other.verb(), &other.text) == (of.owner, of.verb(), &of.text)
                && (of.owner.is_some() || other.arc == of.arc)
        };
        labels.filter(|&&other| other < label && is_alike(&self.labels[other.index()])).count()
    }

    /// The printed name of a decision: `D1`.
    pub fn decision_name(decision: DecisionId) -> String {
        format!("D{}", decision.0 + 1)
    }
}

/// `#2` for what one other of the same name comes before; nothing for the first.
fn ordinal(earlier: usize) -> String {
    if earlier == 0 { String::new() } else { format!("#{}", earlier + 1) }
}
