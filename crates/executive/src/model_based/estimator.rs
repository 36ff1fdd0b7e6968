//! The estimator: belief updates and the commands that follow, remembered so that many runs share them.
//!
//! Each group of components has a belief of its own (SPEC3 17.2). If no state that was kept explains an observation, the
//! history is expanded again from the last step at which nothing had been dropped (17.3; Kurien and Nayak 2000). Where a
//! program names a probability from which on conditions are entailed, more states are kept until that is decided.

use std::collections::BTreeMap;
use std::sync::Arc;

use hca::Standing;
use plant::bounded::MAX_STATES;
use plant::{
    Belief, BoundedUpdate, Commands, Conflict, Effort, EstimateError, FactoredBelief, Formula, Goal, Group,
    Known, NextCommands, Observation, Planner, Probability, State, conflicts, update_bounded,
};
use serde::{Deserialize, Serialize};

use super::reward_choice::{Chooser, RewardChoice};
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
    pub(super) fn certain(system: &System, state: &State) -> Self {
        Self::initial(FactoredBelief::certain(&system.groups, state))
    }

    /// Certainty of another state.
    fn certain_of(&self, system: &System, state: &State) -> Self {
        Self::initial(self.belief.certain_of(&system.groups, state))
    }

    /// Returns what is believed before the first step.
    fn initial(belief: FactoredBelief) -> Self {
        let histories = belief.beliefs().map(|belief| History { complete: Arc::clone(belief), since: None });
        Self { histories: histories.collect(), belief }
    }
}

/// A condition of which a belief has to decide whether it is at least as probable as a program demands.
pub(super) struct Threshold<'asked> {
    pub(super) condition: &'asked Formula,
    pub(super) entailed_from: &'asked Probability,
}

impl Threshold<'_> {
    /// Returns whether what was dropped leaves open on which side of the threshold the condition is.
    fn is_open(&self, known: Known<'_>) -> bool {
        let probability = known.probability(self.condition);
        probability.low < *self.entailed_from && *self.entailed_from <= probability.high
    }
}

/// A belief after a step, and what it took.
#[derive(Clone, Debug)]
pub(super) struct BeliefUpdate {
    /// `None` if it is not known to be explained.
    pub(super) believed: Option<Believed>,
    pub(super) outcome: StepOutcome,
    /// Whether limits kept the dropped measure from becoming small, or a threshold from being decided.
    pub(super) is_uncertain: bool,
    pub(super) conflicts: Vec<Conflict>,
}

impl BeliefUpdate {
    /// The update of programs that know the state.
    pub(super) fn certain(system: &System, before: &Believed, state: &State) -> Self {
        let believed = Some(before.certain_of(system, state));
        Self { believed, outcome: StepOutcome::Explained, is_uncertain: false, conflicts: Vec::new() }
    }
}

/// What was asked of a group: its number, what is believed of it, what was commanded and observed.
type GroupQuestion = (usize, Arc<Belief>, Commands, Observation);

/// Estimates and plans for one model.
#[derive(Clone, Debug)]
pub struct Estimator {
    planner: Arc<Planner>,
    groups: Arc<Vec<Group>>,
    most_states: usize,
    initial: Option<FactoredBelief>,
    updates: BTreeMap<GroupQuestion, BoundedUpdate>,
    diagnoses: BTreeMap<(State, Commands, Observation), Vec<Conflict>>,
    plans: BTreeMap<(State, Vec<Goal>), NextCommands>,
    /// By program, what its choices by rewards were made with.
    choosers: Vec<(Arc<System>, Chooser)>,
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
            initial: None,
            updates: BTreeMap::new(),
            diagnoses: BTreeMap::new(),
            plans: BTreeMap::new(),
            choosers: Vec::new(),
        }
    }

    /// The reactive planner.
    pub const fn planner(&self) -> &Arc<Planner> {
        &self.planner
    }

    /// Returns what is believed before the first step.
    pub(super) fn initial(&mut self) -> Believed {
        let belief =
            self.initial.get_or_insert_with(|| FactoredBelief::initial(&self.groups, self.most_states));
        Believed::initial(belief.clone())
    }

    pub(super) fn estimate(
        &mut self,
        believed: &Believed,
        commands: &Commands,
        observation: &Observation,
        asked: &[Threshold<'_>],
    ) -> Result<BeliefUpdate, EstimateError> {
        let conflicts = self.diagnose(believed.belief.most_likely(), commands, observation)?;
        let groups = Arc::clone(&self.groups);
        let mut is_uncertain = false;
        let mut is_limited = false;
        let mut beliefs = Vec::with_capacity(groups.len());
        let mut refuted: BTreeMap<usize, Arc<Belief>> = BTreeMap::new();
        let each = believed.belief.beliefs().zip(&believed.histories).zip(groups.iter()).enumerate();
        for (at, ((belief, history), group)) in each {
            let (commands, observation) = (group.commands(commands), group.observation(observation));
            match self.update_group(at, belief, history, &commands, &observation)? {
                GroupUpdate::Explained { belief, is_uncertain: one } => {
                    is_uncertain |= one;
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
        let mut belief = FactoredBelief::new(&groups, beliefs);
        is_uncertain |= self.decide(&believed.belief, &mut belief, commands, observation, asked)?;
        let histories = belief.beliefs().zip(&believed.histories).zip(groups.iter());
        let histories = histories.map(|((belief, history), group)| {
            if belief.is_exact() {
                return History { complete: Arc::clone(belief), since: None };
            }
            let (commands, observation) = (group.commands(commands), group.observation(observation));
            let taken = TakenStep { commands, observation, before: history.since.clone() };
            History { complete: Arc::clone(&history.complete), since: Some(Arc::new(taken)) }
        });
        let histories = histories.collect();
        let believed = Some(Believed { belief, histories });
        Ok(BeliefUpdate { believed, outcome: StepOutcome::Explained, is_uncertain, conflicts })
    }

    /// Keeps more states of the groups that thresholds depend on, as long as these are open; returns whether one stays so.
    fn decide(
        &self,
        before: &FactoredBelief,
        belief: &mut FactoredBelief,
        commands: &Commands,
        observation: &Observation,
        asked: &[Threshold<'_>],
    ) -> Result<bool, EstimateError> {
        let groups = &*self.groups;
        let is_open =
            |belief: &FactoredBelief, one: &Threshold<'_>| one.is_open(Known { groups, belief, observation });
        let mut open: Vec<&Threshold<'_>> = asked.iter().filter(|one| is_open(belief, one)).collect();
        for (at, (group, prior)) in groups.iter().zip(before.beliefs()).enumerate() {
            let known = Known { groups, belief, observation };
            let has_dropped = belief.beliefs().nth(at).is_some_and(|belief| !belief.is_exact());
            let depends = |one: &&&Threshold<'_>| known.groups_of(one.condition).contains(&at);
            let depending: Vec<&Threshold<'_>> = open.iter().filter(depends).copied().collect();
            if !has_dropped || depending.is_empty() {
                continue;
            }
            let decides = |candidate: &Belief| {
                let with = belief.with(groups, at, Arc::new(candidate.clone()));
                depending.iter().all(|one| !is_open(&with, one))
            };
            let (commands, seen) = (group.commands(commands), group.observation(observation));
            let most = self.most_states;
            let update =
                update_bounded(&group.model, prior, &commands, &seen, most, Effort::AsNeeded, &decides)?;
            if let Some(found) = update.belief {
                *belief = belief.with(groups, at, Arc::new(found));
                open.retain(|one| is_open(belief, one));
            }
        }
        Ok(!open.is_empty())
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

    /// Returns what is left of the observations when they are left out in the order of the text, as long as one of the
    /// groups that are `refuted`, from the beliefs given, stays so.
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
        let most = self.most_states;
        let update = update_bounded(model, belief, commands, observation, most, effort, &|_| true)?;
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

    /// Makes the first open choice of a program, which is one by rewards.
    pub(super) fn choose(
        &mut self,
        system: &Arc<System>,
        standing: Standing,
        belief: &FactoredBelief,
    ) -> RewardChoice {
        let known = self.choosers.iter().position(|(known, _)| Arc::ptr_eq(known, system));
        let (_, mut chooser) = known
            .map_or_else(|| (Arc::clone(system), Chooser::default()), |at| self.choosers.swap_remove(at));
        let made = chooser.choose(system, self, standing, belief);
        self.choosers.push((Arc::clone(system), chooser));
        made
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
