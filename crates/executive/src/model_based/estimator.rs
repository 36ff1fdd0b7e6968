//! The estimator: belief updates and the commands that follow, remembered so that many runs share them.
//!
//! Each group of components has a belief of its own (SPEC3 17.2). If no state that was kept explains an observation, the
//! history is expanded again from the last step at which nothing had been dropped (17.3; Kurien and Nayak 2000).

use std::collections::BTreeMap;
use std::sync::Arc;

use plant::bounded::MAX_STATES;
use plant::{
    Belief, BoundedUpdate, Commands, Conflict, Effort, EstimateError, FactoredBelief, Goal, Group,
    NextCommands, Observation, Planner, State, conflicts, update_bounded,
};
use serde::{Deserialize, Serialize};

use super::system::System;

/// Remembered answers are thrown away when there are more than this many.
const MAX_REMEMBERED: usize = 20_000;
/// Beliefs with more states than this are not remembered.
const MAX_REMEMBERED_STATES: usize = 2000;
/// A diagnosis names at most this many conflicts.
const MAX_CONFLICTS: usize = 8;

/// Whether what was observed in a step can be explained.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum StepOutcome {
    /// Some states explain it.
    #[default]
    Explained,
    /// No trajectory at all explains it: the belief is refuted.
    Refuted {
        /// What is left of the observations when they are left out one after the other as long as the rest stays
        /// unexplained.
        conflict: Observation,
    },
    /// No state that was kept explains it, and the limit of states leaves open whether another one does.
    LimitReached,
}

/// What is believed of a plant, and how that came about.
#[derive(Clone, Debug)]
pub(super) struct Believed {
    pub(super) belief: FactoredBelief,
    /// For each group of components, in the order of the groups.
    histories: Vec<History>,
}

/// The steps of a group since the last one at which nothing had been dropped of its belief.
#[derive(Clone, Debug)]
struct History {
    complete: Arc<Belief>,
    since: Option<Arc<TakenStep>>,
}

/// What was done and observed in a step, with the steps before it.
#[derive(Debug)]
struct TakenStep {
    commands: Commands,
    observation: Observation,
    before: Option<Arc<TakenStep>>,
}

impl Drop for TakenStep {
    /// Step by step: a long history would be too deep for the stack.
    fn drop(&mut self) {
        let mut next = self.before.take();
        while let Some(mut step) = next.and_then(Arc::into_inner) {
            next = step.before.take();
        }
    }
}

impl Believed {
    /// Certainty of one state.
    pub(super) fn certain(groups: &[Group], state: &State) -> Self {
        let belief = FactoredBelief::certain(groups, state);
        let histories = belief.beliefs().map(|belief| History { complete: Arc::clone(belief), since: None });
        Self { histories: histories.collect(), belief }
    }
}

/// A belief after a step, and what it took.
#[derive(Clone, Debug)]
pub(super) struct BeliefUpdate {
    /// `None` if it is not known to be explained.
    pub(super) believed: Option<Believed>,
    pub(super) outcome: StepOutcome,
    /// Whether the limit of states kept the dropped measure from becoming small.
    pub(super) is_uncertain: bool,
    pub(super) conflicts: Vec<Conflict>,
}

/// What was asked of a group: its number, what is believed of it, what was commanded and observed.
type GroupQuestion = (usize, Arc<Belief>, Commands, Observation);

/// Estimates and plans for one model.
#[derive(Clone, Debug)]
pub struct Estimator {
    planner: Arc<Planner>,
    groups: Arc<Vec<Group>>,
    most_states: usize,
    updates: BTreeMap<GroupQuestion, BoundedUpdate>,
    diagnoses: BTreeMap<(State, Commands, Observation), Vec<Conflict>>,
    plans: BTreeMap<(State, Vec<Goal>), NextCommands>,
}

/// What becomes of a group in a step.
enum GroupUpdate {
    Explained {
        belief: Arc<Belief>,
        is_uncertain: bool,
    },
    /// Also from this belief, for which the history was expanded again.
    Refuted(Arc<Belief>),
    LimitReached,
}

impl Estimator {
    /// Remembers nothing yet. Each group of components has a belief of at most `most_states` states.
    pub fn new(system: &System, most_states: Option<usize>) -> Self {
        Self {
            planner: Arc::clone(&system.planner),
            groups: Arc::clone(&system.groups),
            most_states: most_states.unwrap_or(MAX_STATES).clamp(1, MAX_STATES),
            updates: BTreeMap::new(),
            diagnoses: BTreeMap::new(),
            plans: BTreeMap::new(),
        }
    }

    /// The reactive planner.
    pub const fn planner(&self) -> &Arc<Planner> {
        &self.planner
    }

    pub(super) fn estimate(
        &mut self,
        believed: &Believed,
        commands: &Commands,
        observation: &Observation,
    ) -> Result<BeliefUpdate, EstimateError> {
        let conflicts = self.diagnose(believed.belief.most_likely(), commands, observation)?;
        let groups = Arc::clone(&self.groups);
        let mut is_uncertain = false;
        let mut is_limited = false;
        let mut beliefs = Vec::with_capacity(groups.len());
        let mut histories = Vec::with_capacity(groups.len());
        let mut refuted: BTreeMap<usize, Arc<Belief>> = BTreeMap::new();
        let each = believed.belief.beliefs().zip(&believed.histories).zip(groups.iter()).enumerate();
        for (at, ((belief, history), group)) in each {
            let (commands, observation) = (group.commands(commands), group.observation(observation));
            match self.update_group(at, belief, history, &commands, &observation)? {
                GroupUpdate::Explained { belief, is_uncertain: one } => {
                    is_uncertain |= one;
                    let since = (!belief.is_exact()).then(|| {
                        Arc::new(TakenStep { commands, observation, before: history.since.clone() })
                    });
                    let complete = if since.is_some() { &history.complete } else { &belief };
                    histories.push(History { complete: Arc::clone(complete), since });
                    beliefs.push(belief);
                }
                GroupUpdate::Refuted(prior) => {
                    refuted.insert(at, prior);
                }
                GroupUpdate::LimitReached => is_limited = true,
            }
        }
        if !refuted.is_empty() {
            let conflict = self.unexplained(refuted, commands, observation)?;
            let outcome = StepOutcome::Refuted { conflict };
            return Ok(BeliefUpdate { believed: None, outcome, is_uncertain, conflicts });
        }
        if is_limited {
            let outcome = StepOutcome::LimitReached;
            return Ok(BeliefUpdate { believed: None, outcome, is_uncertain: true, conflicts });
        }
        let believed = Some(Believed { belief: FactoredBelief::new(&groups, beliefs), histories });
        Ok(BeliefUpdate { believed, outcome: StepOutcome::Explained, is_uncertain, conflicts })
    }

    fn update_group(
        &mut self,
        at: usize,
        belief: &Arc<Belief>,
        history: &History,
        commands: &Commands,
        observation: &Observation,
    ) -> Result<GroupUpdate, EstimateError> {
        let update = self.update(at, belief, commands, observation, Effort::AsNeeded)?;
        if let Some(belief) = update.belief {
            return Ok(GroupUpdate::Explained {
                belief: Arc::new(belief),
                is_uncertain: update.is_uncertain,
            });
        }
        if !update.is_open {
            return Ok(GroupUpdate::Refuted(Arc::clone(belief)));
        }
        let mut steps = Vec::new();
        let mut next = history.since.as_ref();
        while let Some(step) = next {
            steps.push(step);
            next = step.before.as_ref();
        }
        let mut prior = Arc::clone(&history.complete);
        for step in steps.into_iter().rev() {
            let update = self.update(at, &prior, &step.commands, &step.observation, Effort::Most)?;
            match update.belief {
                Some(belief) => prior = Arc::new(belief),
                // It was explained before with fewer states.
                None => return Ok(GroupUpdate::LimitReached),
            }
        }
        let update = self.update(at, &prior, commands, observation, Effort::Most)?;
        Ok(match update.belief {
            Some(belief) => {
                GroupUpdate::Explained { is_uncertain: update.is_uncertain, belief: Arc::new(belief) }
            }
            None if update.is_open => GroupUpdate::LimitReached,
            None => GroupUpdate::Refuted(prior),
        })
    }

    /// What is left of the observations when they are left out in the order of the text, as long as one of the groups that
    /// are `refuted`, from the beliefs given, stays so.
    fn unexplained(
        &mut self,
        mut refuted: BTreeMap<usize, Arc<Belief>>,
        commands: &Commands,
        observation: &Observation,
    ) -> Result<Observation, EstimateError> {
        let groups = Arc::clone(&self.groups);
        let mut group_of = BTreeMap::new();
        for (at, group) in groups.iter().enumerate() {
            group_of.extend(group.variables.iter().map(|variable| (*variable, at)));
        }
        let mut rest = observation.clone();
        for variable in observation.0.keys() {
            let Some(&at) = group_of.get(variable) else { continue };
            let mut fewer = rest.clone();
            fewer.0.remove(variable);
            if let Some(prior) = refuted.get(&at) {
                let (commands, part) = (groups[at].commands(commands), groups[at].observation(&fewer));
                let update = self.update(at, prior, &commands, &part, Effort::Most)?;
                if update.belief.is_some() || update.is_open {
                    if refuted.len() == 1 {
                        continue;
                    }
                    refuted.remove(&at);
                }
            }
            rest = fewer;
        }
        Ok(rest)
    }

    fn update(
        &mut self,
        at: usize,
        belief: &Arc<Belief>,
        commands: &Commands,
        observation: &Observation,
        effort: Effort,
    ) -> Result<BoundedUpdate, EstimateError> {
        let key = (at, Arc::clone(belief), commands.clone(), observation.clone());
        if effort == Effort::AsNeeded
            && let Some(known) = self.updates.get(&key)
        {
            return Ok(known.clone());
        }
        let model = &self.groups[at].model;
        let update = update_bounded(model, belief, commands, observation, self.most_states, effort)?;
        let states = belief.len() + update.belief.as_ref().map_or(0, Belief::len);
        if effort == Effort::AsNeeded && states <= MAX_REMEMBERED_STATES {
            if self.updates.len() >= MAX_REMEMBERED {
                self.updates.clear();
            }
            self.updates.insert(key, update.clone());
        }
        Ok(update)
    }

    fn diagnose(
        &mut self,
        state: &State,
        commands: &Commands,
        observation: &Observation,
    ) -> Result<Vec<Conflict>, EstimateError> {
        let key = (state.clone(), commands.clone(), observation.clone());
        if let Some(known) = self.diagnoses.get(&key) {
            return Ok(known.clone());
        }
        let found = conflicts(self.planner.model(), state, commands, observation, MAX_CONFLICTS)?;
        if self.diagnoses.len() >= MAX_REMEMBERED {
            self.diagnoses.clear();
        }
        self.diagnoses.insert(key, found.clone());
        Ok(found)
    }

    pub(super) fn plan(&mut self, state: &State, goals: &[Goal]) -> NextCommands {
        let key = (state.clone(), goals.to_vec());
        if let Some(known) = self.plans.get(&key) {
            return known.clone();
        }
        let next = self.planner.next_commands(state, goals);
        if self.plans.len() >= MAX_REMEMBERED {
            self.plans.clear();
        }
        self.plans.insert(key, next.clone());
        next
    }
}
