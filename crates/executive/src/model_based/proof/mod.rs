//! Proof by exhaustion: what holds in every run of a program with its plant, whatever the environment does (SPEC 9.4).
//!
//! Components fail up to so many times, in any step in which they can. What is decided by chance, a choice or one of several
//! outcomes, may fall in any way; where it falls again and again, each outcome comes at some time. A property that a run
//! breaks is answered by such a run.

mod chance;
mod idle_parts;
mod paths;
mod product;
mod property;

use std::sync::Arc;

use plant::EstimateError;
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

use super::closed_loop::Knowledge;
use super::system::System;
use paths::Found;
use product::{Exploration, Explorer, Judged, Limits, NodeId, Product};

pub use chance::chance_to_end;
pub use idle_parts::{idle_parts, idle_parts_alone};
pub use paths::Counterexample;
pub use product::{End, Move};
pub use property::{Condition, DEFAULTS, Property};

/// How far to explore.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scope {
    /// How often components fail at most in a run.
    pub faults: u32,
    pub knowledge: Knowledge,
    /// How many states are kept at most, of program, plant and belief together.
    pub states: usize,
    /// How many steps the runs take at most that are looked at.
    pub steps: u32,
}

impl Default for Scope {
    fn default() -> Self {
        Self { faults: 1, knowledge: Knowledge::Estimated, states: 200_000, steps: u32::MAX }
    }
}

/// Whether a property holds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Verdict {
    /// It is true in all runs.
    Holds,
    /// Not in this run.
    Broken(Box<Counterexample>),
    /// These never become active, or never become true.
    Never(Vec<SmolStr>),
    /// No run was found that breaks it, but not all were looked at.
    Open,
}

/// What was found out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Proof {
    /// The properties in the order in which they were given.
    pub verdicts: Vec<(Property, Verdict)>,
    /// How many states there are, of program, plant and belief together.
    pub states: usize,
    /// How many steps lead from one to another.
    pub transitions: usize,
    /// The most steps that the shortest run to a state takes.
    pub depth: u32,
    /// Why not all states were looked at, if that is so.
    pub stopped: Option<String>,
}

/// Finds out which properties hold in all runs of a program, until `go_on` returns false; it gets the number of states found.
pub fn prove(
    system: &Arc<System>,
    properties: &[Property],
    scope: Scope,
    go_on: &mut dyn FnMut(usize) -> bool,
) -> Result<Proof, EstimateError> {
    let mut proving = Proving::new(system, properties.to_vec(), scope);
    proving.advance(go_on)?;
    proving.judge()
}

/// A proof under way, to be led on a little at a time.
pub struct Proving {
    system: Arc<System>,
    properties: Vec<Property>,
    conditions: Vec<Condition>,
    exploration: Exploration,
    is_over: bool,
}

impl Proving {
    /// Begins a proof.
    pub fn new(system: &Arc<System>, properties: Vec<Property>, scope: Scope) -> Self {
        let conditions: Vec<Condition> = properties.iter().flat_map(Property::conditions).cloned().collect();
        let limits = Limits { faults: scope.faults, nodes: scope.states.max(1), depth: scope.steps };
        let explorer = Explorer::new(system, conditions.clone());
        let exploration = Exploration::new(explorer, scope.knowledge, limits);
        Self { system: Arc::clone(system), properties, conditions, exploration, is_over: false }
    }

    /// Returns how many states have been found.
    pub fn states(&self) -> usize {
        self.exploration.product.nodes.len()
    }

    /// Explores until `go_on` returns false; it gets the number of states found. Returns whether everything in the scope is
    /// explored.
    pub fn advance(&mut self, go_on: &mut dyn FnMut(usize) -> bool) -> Result<bool, EstimateError> {
        self.is_over = self.exploration.advance(go_on)?;
        Ok(self.is_over)
    }

    /// Returns what the states that were explored say.
    pub fn judge(mut self) -> Result<Proof, EstimateError> {
        if !self.is_over {
            self.exploration.end_early("the proof was stopped".to_owned());
        }
        let Exploration { explorer, product, .. } = &mut self.exploration;
        let judge = Judge { system: &self.system, product, conditions: &self.conditions };
        let mut verdicts = Vec::with_capacity(self.properties.len());
        for property in self.properties {
            let mut verdict = judge.verdict(&property);
            if verdict == Verdict::Open
                && let Some(run) = judge.long_run(&property, explorer)?
            {
                verdict = Verdict::Broken(Box::new(run));
            }
            verdicts.push((property, verdict));
        }
        let explored = product.nodes.iter().filter(|node| node.end.is_none());
        Ok(Proof {
            verdicts,
            states: product.nodes.len(),
            transitions: explored.filter_map(|node| node.edges.as_ref()).map(Vec::len).sum(),
            depth: product.nodes.iter().map(|node| node.depth).max().unwrap_or(0),
            stopped: product.stopped.clone(),
        })
    }
}

/// A run that has not come to what is to come after so many more steps is taken for one that never does.
const LONG_RUN: u32 = 2000;

struct Judge<'proof> {
    system: &'proof System,
    product: &'proof Product,
    conditions: &'proof [Condition],
}

impl Judge<'_> {
    fn verdict(&self, property: &Property) -> Verdict {
        let product = self.product;
        let node = |id: NodeId| &product.nodes[id as usize];
        let ended = |id: NodeId| node(id).end == Some(End::Ended);
        let found = match property {
            Property::Always(condition) => product.run_to(|id| !self.holds(id, condition)),
            Property::Never(condition) => product.run_to(|id| self.may_hold(id, condition)),
            Property::Eventually { condition, within: None } => {
                product.run_without(None, |id| self.holds(id, condition))
            }
            Property::Eventually { condition, within: Some(steps) } => {
                product.run_too_long(None, |id| self.holds(id, condition), *steps)
            }
            Property::Ends { within: None } => product.run_without(None, ended),
            Property::Ends { within: Some(steps) } => product.run_too_long(None, ended, *steps),
            Property::LeadsTo { from, to, within } => {
                let starts = |id: NodeId| self.may_hold(id, from);
                let is_goal = |id: NodeId| self.holds(id, to);
                match within {
                    None => product.run_without(Some(&starts), is_goal),
                    Some(steps) => product.run_too_long(Some(&starts), is_goal, *steps),
                }
            }
            Property::GoalsAgree => product.run_to(|id| node(id).contradiction.is_some()),
            Property::NoDeadlock => product.run_to(|id| node(id).end == Some(End::Deadlock)),
            Property::AllReached => return self.all(self.unreached()),
            Property::AllGuardsHold => return self.all(self.unheard()),
        };
        match found {
            Found::Run(run) => Verdict::Broken(run),
            Found::Nothing => Verdict::Holds,
            Found::Open => Verdict::Open,
        }
    }

    /// Returns where not all was explored: a run that does not come to its goal for very many steps.
    fn long_run(
        &self,
        property: &Property,
        explorer: &mut Explorer,
    ) -> Result<Option<Counterexample>, EstimateError> {
        let (from, to) = match property {
            Property::Ends { within: None } => (None, None),
            Property::Eventually { condition, within: None } => (None, Some(condition)),
            Property::LeadsTo { from, to, within: None } => (Some(from), Some(to)),
            _ => return Ok(None),
        };
        let is_goal = |judged: &[Judged], end: Option<End>| match to {
            Some(condition) => self.judged(judged, condition) == Judged::True,
            None => end == Some(End::Ended),
        };
        let node = |id: NodeId| &self.product.nodes[id as usize];
        let is_goal_node = |id: NodeId| is_goal(&node(id).judged, node(id).end);
        let starts = |id: NodeId| from.is_some_and(|from| self.may_hold(id, from));
        let from: Option<&dyn Fn(NodeId) -> bool> = if from.is_some() { Some(&starts) } else { None };
        let Some((mut run, last)) = self.product.run_to_the_unexplored(from, is_goal_node) else {
            return Ok(None);
        };
        let steps = explorer.nominal_steps(node(last), &is_goal, LONG_RUN)?;
        run.goes_on_for = Some(steps);
        Ok((steps == LONG_RUN).then_some(run))
    }

    fn holds(&self, id: NodeId, condition: &Condition) -> bool {
        self.judged(&self.product.nodes[id as usize].judged, condition) == Judged::True
    }

    fn may_hold(&self, id: NodeId, condition: &Condition) -> bool {
        self.judged(&self.product.nodes[id as usize].judged, condition) != Judged::False
    }

    fn judged(&self, judged: &[Judged], condition: &Condition) -> Judged {
        let place = self.conditions.iter().position(|known| known == condition);
        place.and_then(|place| judged.get(place)).copied().unwrap_or(Judged::Undecided)
    }

    fn all(&self, never: Vec<SmolStr>) -> Verdict {
        match (never.is_empty(), &self.product.stopped) {
            (true, _) => Verdict::Holds,
            (false, None) => Verdict::Never(never),
            (false, Some(_)) => Verdict::Open,
        }
    }

    /// The locations that are active in no run.
    fn unreached(&self) -> Vec<SmolStr> {
        let ids = (0..self.system.automaton.locations.len()).map(|at| hca::LocationId(at as u32));
        let unreached = ids.filter(|id| !self.product.reached.contains(id));
        unreached.filter_map(|id| Some(self.system.automaton.location(id)?.label.clone())).collect()
    }

    /// Returns what is waited for in some run, and true in none.
    fn unheard(&self) -> Vec<SmolStr> {
        let automaton = &self.system.automaton;
        let ids = (0..automaton.transitions.len()).map(|at| hca::TransitionId(at as u32));
        let transitions = ids.zip(&automaton.transitions).filter(|(id, transition)| {
            let waits = automaton.location(transition.source).is_some_and(|location| {
                matches!(location.kind, hca::LocationKind::When | hca::LocationKind::Whenever)
            });
            waits && self.product.reached.contains(&transition.source) && !self.product.fired.contains(id)
        });
        transitions.map(|(_, transition)| automaton.condition_text(transition).into()).collect()
    }
}
