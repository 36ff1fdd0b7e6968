//! Tests of the checker, which everything else trusts: hand-written plans, each changed in one thing that must be
//! refused by the right rule with the right names, and every verdict on tiny networks against brute force.

mod brute_force;
mod chance;
mod controllability;
mod game;
mod lasting_brute_force;
mod lasting_oracle;
mod lasting_schedules;
mod missions;
mod oracle;
mod plan_rules;
mod resource_rules;
mod schedule_rules;
mod state_rules;
