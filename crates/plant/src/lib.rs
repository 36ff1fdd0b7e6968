//! Component models, belief update and reactive planning (SPEC 2.2 and 9).
//!
//! A [`Model`] is data that never changes. What is believed of the plant, and what is commanded, is computed from it
//! by functions; the loop that joins them with a control program is another crate's business.

mod arc_check;
mod assignment;
mod behavior;
pub mod belief;
pub mod best_first;
pub mod bounded;
mod branches;
mod check;
pub mod compile;
pub mod consistency;
pub mod diagnosis;
mod domains;
pub mod exact;
pub mod factored;
pub mod formula;
pub mod group;
mod guard_check;
pub mod hitting_sets;
pub mod interval;
mod island;
mod island_core;
pub mod knowledge;
pub mod likelihood;
mod merged;
pub mod model;
mod normalization;
pub mod observe;
mod odds;
pub mod order;
pub mod policy;
mod possible;
mod prepared;
mod prior;
pub mod probability;
pub mod reconfigure;
pub mod simulate;
mod spans;
pub mod successor;
mod table;
pub mod value_set;

pub use belief::{Belief, State};
pub use best_first::{SearchStatistics, update_best};
pub use bounded::{BoundedUpdate, Effort, update_bounded};
pub use branches::{KeptBranch, RuledOut, StepBranches, step_branches};
pub use compile::compile;
pub use diagnosis::{Conflict, conflict_without, conflicts};
pub use exact::update_exact;
pub use factored::FactoredBelief;
pub use formula::Formula;
pub use group::{Group, groups};
pub use interval::Interval;
pub use knowledge::{Known, Situation};
pub use model::{
    Choice, CommandVariable, CommandVariableId, Commands, Component, ComponentId, Fault, Mode, Model,
    Observation, PlantVariable, Transition, VariableId,
};
pub use order::CausalOrder;
pub use policy::Planner;
pub use possible::{Target, observations, targets};
pub use prior::draw_initial;
pub use probability::Probability;
pub use reconfigure::{Command, Goal, NextCommands, Plan, Unreachable};
pub use simulate::{Random, SimulatedPlant};
pub use successor::{EstimateError, intended, successor};
pub use value_set::ValueSet;
