//! From goals to commands: one command set per step, and the reason where a goal cannot be reached (SPEC 9.2).

use std::collections::{BTreeMap, BTreeSet};

use smol_str::SmolStr;

use crate::belief::State;
use crate::consistency::Assumed;
use crate::diagnosis::shrink;
use crate::domains::Domains;
use crate::model::{Commands, ComponentId, Model, Observation};
use crate::policy::Planner;
use crate::successor::nominal;
use crate::value_set::ValueSet;

/// A search over whole states gives up after this many of them.
const MAX_STATES: usize = 20_000;

/// A component to be brought into one of some modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Goal {
    pub component: ComponentId,
    /// The modes that will do.
    pub modes: ValueSet,
}

impl Goal {
    /// The goal of one mode.
    pub const fn mode(component: ComponentId, mode: u8) -> Self {
        Self { component, modes: ValueSet::one(mode) }
    }

    /// The goal in the form `EngineA=Standby`.
    pub fn describe(&self, model: &Model) -> String {
        let name = model.component(self.component).map_or("?", |data| data.name.as_str());
        let modes: Vec<&str> =
            self.modes.values().map(|mode| model.mode_name(self.component, mode)).collect();
        format!("{name}={}", modes.join(" or "))
    }
}

/// A goal that is not pursued, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unreachable {
    pub goal: Goal,
    /// Why, in words.
    pub reason: String,
    /// Whether this is only because the search was cut off.
    pub limit_reached: bool,
    /// Whether it is because no state satisfies it together with other goals.
    pub is_contradiction: bool,
}

/// What to command now.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NextCommands {
    /// One command per independent group of goals.
    pub commands: Commands,
    /// The goals that are not pursued.
    pub unreachable: Vec<Unreachable>,
}

/// One command of a plan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Command {
    /// The component commanded, or the command variable where it has several.
    pub component: SmolStr,
    pub command: SmolStr,
}

/// A command sequence from a state to goals: the commands of each step, and the state at its end.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Plan {
    /// The commands of each step; all idle where the plant moves by itself.
    pub steps: Vec<Commands>,
}

impl Plan {
    /// The commands one by one.
    pub fn commands(&self, model: &Model) -> Vec<Command> {
        let names = self.steps.iter().flat_map(|commands| model.command_names(commands));
        names
            .map(|(component, command)| Command { component: component.into(), command: command.into() })
            .collect()
    }
}

enum Failure {
    Impossible,
    Limit,
}

impl Planner {
    /// The first command set toward `goals` from `state`: goals with nothing in common upstream are pursued at once.
    pub fn next_commands(&self, state: &State, goals: &[Goal]) -> NextCommands {
        let (goals, mut unreachable) = self.consistent(goals);
        let mut commands = self.model.idle();
        for group in self.groups(&goals) {
            let (plan, failed) = self.pursue(state, &group);
            unreachable.extend(failed);
            if let Some(first) = plan.steps.first() {
                for (slot, value) in commands.0.iter_mut().zip(&first.0).filter(|(_, value)| **value != 0) {
                    *slot = *value;
                }
            }
        }
        unreachable.sort_by_key(|unreachable| unreachable.goal);
        NextCommands { commands, unreachable }
    }

    /// A whole command sequence to `goals`, one command at a time; the error gives the goals that cannot be reached.
    pub fn reconfigure(&self, state: &State, goals: &[Goal]) -> Result<Plan, Vec<Unreachable>> {
        let (goals, unreachable) = self.consistent(goals);
        let (plan, failed) = self.pursue(state, &goals);
        let unreachable: Vec<Unreachable> = unreachable.into_iter().chain(failed).collect();
        if unreachable.is_empty() { Ok(plan) } else { Err(unreachable) }
    }

    /// Joins goals of the same component; contradicting ones are given back as unreachable.
    fn consistent(&self, goals: &[Goal]) -> (Vec<Goal>, Vec<Unreachable>) {
        let mut joined: BTreeMap<ComponentId, (ValueSet, Vec<Goal>)> = BTreeMap::new();
        for goal in goals {
            let entry = joined.entry(goal.component).or_insert((ValueSet::FULL, Vec::new()));
            entry.0 &= goal.modes;
            entry.1.push(*goal);
        }
        let mut unreachable = Vec::new();
        let mut kept = Vec::new();
        for (component, (modes, given)) in joined {
            if modes.is_empty() {
                let all: Vec<String> = given.iter().map(|goal| goal.describe(&self.model)).collect();
                let reason = format!("{} are inconsistent", all.join(" and "));
                let failed = given.iter().map(|goal| Unreachable {
                    goal: *goal,
                    reason: reason.clone(),
                    limit_reached: false,
                    is_contradiction: true,
                });
                unreachable.extend(failed);
            } else {
                kept.push(Goal { component, modes });
            }
        }
        self.drop_incompatible(&mut kept, &mut unreachable);
        kept.sort_by_key(|goal| self.order.number(goal.component));
        (kept, unreachable)
    }

    /// Goals whose modes' constraints cannot hold together.
    fn drop_incompatible(&self, goals: &mut Vec<Goal>, unreachable: &mut Vec<Unreachable>) {
        let mut free = Domains::observed(&self.model, &Observation::default());
        for island in &self.model.islands {
            let wanted = |component: &ComponentId| {
                let goal = goals.iter().find(|goal| goal.component == *component)?;
                goal.modes.only()
            };
            let mut assumed =
                Assumed { model: &self.model, island, modes: island.components.iter().map(wanted).collect() };
            let Err(places) = assumed.check(&mut free) else { continue };
            shrink(&mut assumed, &mut free, places, |_| true);
            let culprits: Vec<ComponentId> = island
                .components
                .iter()
                .zip(&assumed.modes)
                .filter(|(_, mode)| mode.is_some())
                .map(|(id, _)| *id)
                .collect();
            let all: Vec<Goal> =
                goals.iter().filter(|goal| culprits.contains(&goal.component)).copied().collect();
            let names: Vec<String> = all.iter().map(|goal| goal.describe(&self.model)).collect();
            let reason = format!("{} are inconsistent", names.join(" and "));
            unreachable.extend(all.iter().map(|goal| Unreachable {
                goal: *goal,
                reason: reason.clone(),
                limit_reached: false,
                is_contradiction: true,
            }));
            goals.retain(|goal| !culprits.contains(&goal.component));
        }
    }

    /// Goals that share a component upstream belong together.
    fn groups(&self, goals: &[Goal]) -> Vec<Vec<Goal>> {
        let mut groups: Vec<(Vec<ComponentId>, Vec<Goal>)> = Vec::new();
        for goal in goals {
            let mut upstream = self.upstream(goal.component);
            let (touching, apart): (Vec<_>, Vec<_>) = groups
                .into_iter()
                .partition(|(known, _)| known.iter().any(|component| upstream.contains(component)));
            groups = apart;
            let mut members = vec![*goal];
            for (known, goals) in touching {
                upstream.extend(known);
                members.extend(goals);
            }
            members.sort_by_key(|goal| self.order.number(goal.component));
            groups.push((upstream, members));
        }
        groups.into_iter().map(|(_, goals)| goals).collect()
    }

    /// A plan for as many goals as possible, downstream first, and the others.
    fn pursue(&self, state: &State, goals: &[Goal]) -> (Plan, Vec<Unreachable>) {
        if let Ok(plan) = self.plan(state, goals) {
            return (plan, Vec::new());
        }
        let mut accepted: Vec<Goal> = Vec::new();
        let mut best = Plan::default();
        let mut failed = Vec::new();
        for goal in goals {
            accepted.push(*goal);
            match self.plan(state, &accepted) {
                Ok(plan) => best = plan,
                Err(failure) => {
                    accepted.pop();
                    let limit_reached = matches!(failure, Failure::Limit);
                    failed.push(Unreachable {
                        goal: *goal,
                        reason: self.reason(state, *goal, &accepted, limit_reached),
                        limit_reached,
                        is_contradiction: false,
                    });
                }
            }
        }
        (best, failed)
    }

    /// The policies' plan if it gets there, otherwise one found by search.
    fn plan(&self, state: &State, goals: &[Goal]) -> Result<Plan, Failure> {
        let reach = self.reach(state);
        let out_of_reach = |goal: &Goal| {
            reach.get(goal.component.0 as usize).is_none_or(|reach| (*reach & goal.modes).is_empty())
        };
        if self.is_complete && goals.iter().any(out_of_reach) {
            return Err(Failure::Impossible);
        }
        match self.plan_by_policy(state, goals) {
            Some(plan) => Ok(plan),
            None => self.plan_by_search(state, goals),
        }
    }

    fn plan_by_policy(&self, state: &State, goals: &[Goal]) -> Option<Plan> {
        if self.order.is_cyclic {
            return None;
        }
        let mut plan = Plan::default();
        let mut state = state.clone();
        let mut seen = BTreeSet::new();
        while !is_met(&state, goals) {
            if !seen.insert(state.clone()) {
                return None;
            }
            let reach = self.reach(&state);
            let commands = self.next(&state, goals, &reach)?;
            state = nominal(&self.model, &state, &commands).ok()?;
            plan.steps.push(commands);
        }
        Some(plan)
    }

    /// The command for the unmet goal furthest downstream, or for what it needs first.
    fn next(&self, state: &State, goals: &[Goal], reach: &[ValueSet]) -> Option<Commands> {
        let goal = goals.iter().find(|goal| !goal.modes.contains(state.mode(goal.component)))?;
        let step = self.toward(goal.component, state.mode(goal.component), goal.modes, reach)?;
        let mut needed: Vec<Goal> =
            step.conditions.iter().map(|&(component, modes)| Goal { component, modes }).collect();
        needed.sort_by_key(|goal| self.order.number(goal.component));
        if is_met(state, &needed) {
            return self.commands_for(goal.component, step, state);
        }
        self.next(state, &needed, reach)
    }

    /// Breadth first over whole states with one command at a time; exact, for small groups.
    fn plan_by_search(&self, state: &State, goals: &[Goal]) -> Result<Plan, Failure> {
        let mut choices = vec![self.model.idle()];
        let involved: BTreeSet<ComponentId> =
            goals.iter().flat_map(|goal| self.upstream(goal.component)).collect();
        for (at, variable) in self.model.command_variables.iter().enumerate() {
            if involved.contains(&variable.component) {
                for (value, _) in (0..=u8::MAX).zip(&variable.values).skip(1) {
                    let mut commands = self.model.idle();
                    commands.0[at] = value;
                    choices.push(commands);
                }
            }
        }
        let mut seen: BTreeSet<State> = BTreeSet::from([state.clone()]);
        let mut nodes: Vec<(State, Option<(usize, usize)>)> = vec![(state.clone(), None)];
        let mut at = 0;
        while at < nodes.len() {
            if is_met(&nodes[at].0, goals) {
                return Ok(path(&nodes, at, &choices));
            }
            if nodes.len() > MAX_STATES {
                return Err(Failure::Limit);
            }
            for (choice, commands) in choices.iter().enumerate() {
                let Ok(next) = nominal(&self.model, &nodes[at].0, commands) else { continue };
                if seen.insert(next.clone()) {
                    nodes.push((next, Some((at, choice))));
                }
            }
            at += 1;
        }
        Err(Failure::Impossible)
    }

    fn reason(&self, state: &State, goal: Goal, accepted: &[Goal], limit_reached: bool) -> String {
        if limit_reached {
            return format!(
                "no commands that reach {} were found within {MAX_STATES} states",
                goal.describe(&self.model)
            );
        }
        let reach = self.reach(state);
        if reach.get(goal.component.0 as usize).is_some_and(|reach| !(*reach & goal.modes).is_empty()) {
            let others: Vec<String> = accepted.iter().map(|goal| goal.describe(&self.model)).collect();
            let what = goal.describe(&self.model);
            return if others.is_empty() {
                format!("no commands reach {what}: its first step makes a later step impossible")
            } else {
                format!("no commands reach {what} together with {}", others.join(" and "))
            };
        }
        self.why(state, goal, &reach)
    }

    /// Returns why no mode of a goal is in reach: no transition leads there, or one needs what is out of reach itself.
    fn why(&self, state: &State, goal: Goal, reach: &[ValueSet]) -> String {
        let name = self.model.component(goal.component).map_or("?", |data| data.name.as_str());
        let mode = |mode: u8| self.model.mode_name(goal.component, mode);
        let from = state.mode(goal.component);
        let target = goal.modes.values().find(|&to| self.policy(goal.component, from, to).is_some());
        let Some(target) = target else {
            let wanted: Vec<&str> = goal.modes.values().map(mode).collect();
            return format!(
                "no commanded transition of `{name}` leads from {} to {}",
                mode(from),
                wanted.join(" or ")
            );
        };
        let mut at = from;
        for _ in 0..ValueSet::MOST {
            let Some(step) = self.policy(goal.component, at, target) else { break };
            let out = |(cause, modes): &&(ComponentId, ValueSet)| {
                reach.get(cause.0 as usize).is_none_or(|reach| (*reach & *modes).is_empty())
            };
            if let Some(&(component, modes)) = step.conditions.iter().find(out) {
                let needed = Goal { component, modes };
                let because = if self.order.is_cyclic {
                    String::new()
                } else {
                    format!(": {}", self.why(state, needed, reach))
                };
                return format!(
                    "`{name}` goes from {} to {} only with {}, which cannot be reached{because}",
                    mode(at),
                    mode(step.to),
                    needed.describe(&self.model)
                );
            }
            at = step.to;
        }
        format!("no transitions lead `{name}` from {} to {}", mode(from), mode(target))
    }
}

fn is_met(state: &State, goals: &[Goal]) -> bool {
    goals.iter().all(|goal| goal.modes.contains(state.mode(goal.component)))
}

fn path(nodes: &[(State, Option<(usize, usize)>)], mut at: usize, choices: &[Commands]) -> Plan {
    let mut steps = Vec::new();
    while let Some((_, Some((before, choice)))) = nodes.get(at) {
        steps.push(choices[*choice].clone());
        at = *before;
    }
    steps.reverse();
    Plan { steps }
}
