//! Temporal plan networks: the data model, compilation from RMPL, and plans as data.
//!
//! Nothing here decides what a plan is; planning is `kirk`, checking is `verify`.

mod alternative;
pub mod call_names;
mod calls;
pub mod compile;
pub mod exchange;
pub mod families;
pub mod generate;
pub mod network;
pub mod network_json;
pub mod path;
pub mod plan;
pub mod plan_json;
pub mod precedence;
pub mod selection;
pub mod sight;
mod spans;
pub mod text;
pub mod vocabulary;
pub mod worth;

pub use alternative::other_choice;
pub use compile::{
    Assumption, Ground, Level, Top, assumed, assumptions, compile, compile_on, compile_scenarios,
    merge_diagnostics,
};
pub use network::{
    Arc, ArcId, ArcKind, Block, BlockId, BlockKind, Decision, DecisionId, Departure, Distance, EventEnd,
    EventRef, Extent, Goal, Label, LabelId, LevelCondition, Literal, Network, Node, NodeId, Occurrence,
    OccurrenceId, OccurrenceKind, Resource, ResourceId, Role, Supply, Use, UseId, ValueId, ValueSet,
    Variable, VariableId, Worth,
};
pub use plan::{
    CausalLink, Choice, DistinctPlans, Levels, Ordering, Plan, PlanOrder, Precedence, Quality, StateOrder,
    UseOrdering, Window,
};
pub use sight::{Hidden, Sight};
