//! Choices by rewards: which alternative of CHOOSE-REWARD has the best expected sum of rewards (SPEC 8.5).
//!
//! Each state that is believed possible is followed as if the states of the plant were seen from then on, and counts with its
//! probability (QMDP; Littman, Cassandra and Kaelbling 1995). What can be reached from one place of program and plant is
//! remembered, so that later choices of the same program share it. Sums are machine numbers.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use exact::Rational;
use hca::{ChosenBy, Standing, StepObserver, locks};
use plant::simulate::observation_of;
use plant::{
    Belief, ComponentId, EstimateError, FactoredBelief, Formula, Known, Observation, Situation, State,
    Target, observations, targets,
};
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

use super::closed_loop::{ClosedLoop, ProgramExecution, command};
use super::estimator::Estimator;
use super::system::System;

/// A horizon within which program and plant reach more combinations is shortened.
const MAX_COMBINATIONS: usize = 100_000;
/// So is one within which more ways lead from one to the next.
const MAX_WAYS: usize = 1_000_000;
/// Of a belief, so many of the most likely states are followed.
const MAX_STATES: usize = 10_000;
/// Of a state that admits more observations only the one without chance is followed.
const MAX_OBSERVATIONS: usize = 256;
/// Sums that differ by less, in proportion to the larger one, are equal.
const PRECISION: f64 = 1e-9;

/// A choice by rewards that was made.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RewardChoice {
    /// What drawings call it.
    pub label: SmolStr,
    /// Which alternative was chosen, from 0.
    pub alternative: usize,
    /// The expected sum of rewards of each alternative, to six decimals.
    pub expected: Vec<Rational>,
    /// Over how many steps the rewards were summed.
    pub horizon: u32,
    /// Whether the program asks for more steps than could be followed.
    pub is_shortened: bool,
}

impl RewardChoice {
    /// In a sentence: `alternative 2 of choose by reward 3, 5: 2.4, 5 expected within 50 steps`.
    pub fn describe(&self) -> String {
        let expected: Vec<String> = self.expected.iter().map(Rational::to_string).collect();
        let Self { label, horizon, .. } = self;
        let steps = if *horizon == 1 { "step" } else { "steps" };
        let number = self.alternative + 1;
        let mut text = format!(
            "alternative {number} of {label}: {} expected within {horizon} {steps}",
            expected.join(", ")
        );
        if self.is_shortened {
            text.push_str(" (horizon shortened: too many states)");
        }
        text
    }
}

/// Makes the choices of one program.
#[derive(Clone, Debug, Default)]
pub(super) struct Chooser {
    places: Vec<Place>,
    numbers: HashMap<(Standing, State), usize>,
    made: HashMap<(Standing, Vec<Arc<Belief>>), RewardChoice>,
}

/// A program and its plant between two steps, all choices made.
#[derive(Clone, Debug)]
struct Place {
    standing: Standing,
    state: State,
    /// What the locations marked there count.
    reward: f64,
    /// Where the next step leads; `None` if that was not looked at.
    ways: Option<Arc<Vec<Way>>>,
}

/// Where a step leads, with its probability and what completes in it.
#[derive(Clone, Debug)]
struct Way {
    probability: f64,
    earned: f64,
    to: Next,
}

/// What comes after a step.
#[derive(Clone, Debug)]
enum Next {
    /// The number of a place.
    Place(usize),
    /// The run is over.
    End,
    /// A choice by chance.
    Chance(Vec<(f64, Next)>),
    /// A choice by rewards.
    Best(Vec<Next>),
}

/// Sums what completes in a step.
#[derive(Default)]
struct Earned(f64);

impl StepObserver for Earned {
    fn earned(&mut self, reward: Rational) {
        self.0 += reward.to_f64();
    }
}

/// More can happen than is followed.
struct TooMany;

/// A chooser at work, with what it needs to take steps.
struct Work<'chooser> {
    chooser: &'chooser mut Chooser,
    system: &'chooser Arc<System>,
    estimator: &'chooser mut Estimator,
    program: ProgramExecution,
    plant: ClosedLoop,
    /// The components that the program has to do with. What the others do does not matter, so they stay as they are.
    components: BTreeSet<ComponentId>,
}

impl Chooser {
    /// Makes the first open choice of a program, which is one by rewards, under a belief.
    pub(super) fn choose(
        &mut self,
        system: &Arc<System>,
        estimator: &mut Estimator,
        standing: Standing,
        belief: &FactoredBelief,
    ) -> RewardChoice {
        let standing = standing.relative(&system.automaton);
        let groups: Vec<usize> = system.groups_used().into_iter().collect();
        let beliefs = groups.iter().filter_map(|at| belief.beliefs().nth(*at).cloned()).collect();
        let key = (standing, beliefs);
        if let Some(known) = self.made.get(&key) {
            return known.clone();
        }
        if self.places.len() > 2 * MAX_COMBINATIONS {
            *self = Self::default();
        }
        let components = groups.iter().filter_map(|at| system.groups.get(*at));
        let components = components.flat_map(|group| group.components.iter()).copied().collect();
        let (program, plant) = (ProgramExecution::new(system), ClosedLoop::new(system, estimator, None));
        let mut work = Work { chooser: self, system, estimator, program, plant, components };
        let made = work.choose(&key.0, &belief.shares_of(&groups, MAX_STATES));
        self.made.insert(key, made.clone());
        made
    }
}

impl Work<'_> {
    fn choose(&mut self, standing: &Standing, states: &[(State, f64)]) -> RewardChoice {
        self.program.stepper.return_to(standing);
        let choice = self.program.stepper.open_choice().cloned();
        let label = choice.as_ref().and_then(|choice| self.system.automaton.title(choice.composite));
        let alternatives = choice.as_ref().and_then(|choice| choice.rewards()).map_or(0, <[_]>::len);
        let mut starts: Vec<Vec<(f64, Next)>> = Vec::with_capacity(alternatives);
        for alternative in 0..alternatives {
            let start = states.iter().map(|(state, share)| {
                self.program.stepper.return_to(standing);
                self.program.stepper.choose(alternative);
                (*share, self.open(state))
            });
            starts.push(start.collect());
        }
        let reached = self.reach(starts.iter().flatten().map(|(_, next)| next), self.system.horizon);
        let values = self.values(&reached);
        let expected: Vec<f64> = starts
            .iter()
            .map(|start| start.iter().map(|(share, next)| share * value(next, &values)).sum())
            .collect();
        let mut best = 0;
        for (at, value) in expected.iter().enumerate() {
            let known = expected[best];
            if *value > known + PRECISION * value.abs().max(known.abs()) {
                best = at;
            }
        }
        RewardChoice {
            label: label.unwrap_or_default(),
            alternative: best,
            expected: expected.into_iter().map(rounded).collect(),
            horizon: reached.horizon,
            is_shortened: reached.horizon < self.system.horizon,
        }
    }

    /// Returns what comes next where the program is, with the plant in a state: its open choices are followed in their
    /// order.
    fn open(&mut self, state: &State) -> Next {
        if let Some(choice) = self.program.stepper.open_choice().cloned() {
            let standing = self.program.stepper.standing();
            let each = |work: &mut Self, alternative: usize| {
                work.program.stepper.return_to(&standing);
                work.program.stepper.choose(alternative);
                work.open(state)
            };
            return match &choice.by {
                ChosenBy::Chance(weights) => {
                    let total = weights.iter().sum::<u64>() as f64;
                    let weights = weights.iter().enumerate();
                    Next::Chance(weights.map(|(at, it)| (*it as f64 / total, each(self, at))).collect())
                }
                ChosenBy::Reward(rewards) => {
                    Next::Best((0..rewards.len()).map(|at| each(self, at)).collect())
                }
            };
        }
        let programs = &mut [&mut self.program];
        ClosedLoop::set_aside(programs);
        if programs[0].stepper.is_done() || locks::deadlock(&[&mut programs[0].stepper]).is_some() {
            return Next::End;
        }
        let standing = self.program.stepper.standing().relative(&self.system.automaton);
        let Chooser { places, numbers, .. } = &mut *self.chooser;
        let number = *numbers.entry((standing, state.clone())).or_insert_with_key(|(standing, state)| {
            let reward = self.system.automaton.reward(standing.marking()).to_f64();
            places.push(Place { standing: standing.clone(), state: state.clone(), reward, ways: None });
            places.len() - 1
        });
        Next::Place(number)
    }

    /// The places that are reached in so many steps, or in as many as can be followed.
    fn reach<'starts>(&mut self, starts: impl Iterator<Item = &'starts Next>, horizon: u32) -> Reached {
        let mut reached = Reached { order: Vec::new(), ends: Vec::new(), positions: HashMap::new(), horizon };
        starts.for_each(|next| reached.add(next));
        let mut ways = 0;
        for step in 0..horizon {
            let first = reached.ends.last().copied().unwrap_or(0);
            reached.ends.push(reached.order.len());
            for position in first..reached.order.len() {
                let followed = self.follow(reached.order[position]);
                if let Ok(followed) = &followed {
                    ways += followed.len();
                    followed.iter().for_each(|way| reached.add(&way.to));
                }
                if followed.is_err() || ways > MAX_WAYS || reached.order.len() > MAX_COMBINATIONS {
                    reached.horizon = step;
                    return reached;
                }
            }
        }
        reached
    }

    /// Returns where the next step from a place leads.
    fn follow(&mut self, number: usize) -> Result<Arc<Vec<Way>>, TooMany> {
        let place = &self.chooser.places[number];
        if let Some(ways) = &place.ways {
            return Ok(Arc::clone(ways));
        }
        let (standing, state) = (place.standing.clone(), place.state.clone());
        // A step that fails ends the run.
        let ways = Arc::new(self.ways(&standing, &state).unwrap_or_else(|_| Ok(Vec::new()))?);
        self.chooser.places[number].ways = Some(Arc::clone(&ways));
        Ok(ways)
    }

    fn ways(
        &mut self,
        standing: &Standing,
        state: &State,
    ) -> Result<Result<Vec<Way>, TooMany>, EstimateError> {
        self.program.stepper.return_to(standing);
        let (next, _) = command(&[&mut self.program], self.estimator, state);
        let mut each: Vec<(ComponentId, Vec<Target>)> = Vec::with_capacity(self.components.len());
        for id in &self.components {
            each.push((*id, targets(&self.system.model, *id, state, &next.commands)?));
        }
        let all = each.iter().map(|(_, targets)| targets.len()).fold(1, usize::saturating_mul);
        if all > MAX_COMBINATIONS {
            return Ok(Err(TooMany));
        }
        let mut ways = Vec::new();
        let mut total = 0.0;
        for number in 0..all {
            let (mut rest, mut probability, mut after) = (number, 1.0, state.clone());
            for (id, targets) in &each {
                let target = targets[rest % targets.len()];
                rest /= targets.len();
                let sum = targets.iter().map(|target| target.weight).sum::<u64>();
                probability *= target.weight as f64 / sum as f64;
                after.set_mode(*id, target.mode);
            }
            // Modes that contradict each other do not occur together.
            if self.plant.enter(after.clone()).is_ok() {
                total += probability;
                self.learn(standing, &after, probability, &mut ways);
            }
        }
        for way in &mut ways {
            way.probability /= total;
        }
        Ok(Ok(ways))
    }

    /// Adds the ways through a step whose plant comes to a state with this probability.
    fn learn(&mut self, standing: &Standing, state: &State, probability: f64, into: &mut Vec<Way>) {
        self.program.stepper.return_to(standing);
        let asked = self.program.asked();
        for (observation, share) in self.observed(state, asked.iter().map(|(_, condition)| condition)) {
            self.program.stepper.return_to(standing);
            let belief = FactoredBelief::certain(&self.system.groups, state);
            let known = Known { groups: &self.system.groups, belief: &belief, observation: &observation };
            let mut earned = Earned::default();
            self.program.step(&asked, known, &mut earned);
            locks::grant(&mut [&mut self.program.stepper]);
            let to = self.open(state);
            into.push(Way { probability: probability * share, earned: earned.0, to });
        }
    }

    /// Returns what may be observed in a state, with probabilities, if some conditions depend on it.
    fn observed<'asked>(
        &self,
        state: &State,
        mut asked: impl Iterator<Item = &'asked Formula>,
    ) -> Vec<(Observation, f64)> {
        let model = &self.system.model;
        let mut situation = Situation::new(model, state, &Observation::default());
        let is_decided = asked.all(|condition| {
            situation.entails(condition) || situation.entails(&model.opposite(condition.clone()))
        });
        if is_decided {
            return vec![(Observation::default(), 1.0)];
        }
        let all = observations(model, state, &self.components, MAX_OBSERVATIONS);
        let all = all.unwrap_or_else(|| vec![observation_of(model, state)]);
        let share = 1.0 / all.len() as f64;
        all.into_iter().map(|observation| (observation, share)).collect()
    }

    /// The best expected sums of rewards from the places that were reached at first, over all steps of the horizon.
    fn values(&self, reached: &Reached) -> Values {
        let positions = reached.positions.clone();
        let mut values = Values { sums: vec![0.0; reached.order.len()], positions };
        for steps in 1..=reached.horizon {
            // So many steps are left in the places that were reached before the others.
            let last = (reached.horizon - steps) as usize;
            let count = reached.ends.get(last).copied().unwrap_or(reached.order.len());
            let sums = reached.order[..count].iter().map(|number| {
                let place = &self.chooser.places[*number];
                let ways = place.ways.iter().flat_map(|ways| ways.iter());
                let later: f64 =
                    ways.map(|way| way.probability * (way.earned + value(&way.to, &values))).sum();
                place.reward + later
            });
            let sums: Vec<f64> = sums.collect();
            values.sums[..count].copy_from_slice(&sums);
        }
        values
    }
}

/// The places that are reached from some starts, in the order of the steps that it takes.
struct Reached {
    order: Vec<usize>,
    /// How many are reached in no step, in at most one, and so on.
    ends: Vec<usize>,
    positions: HashMap<usize, usize>,
    horizon: u32,
}

impl Reached {
    fn add(&mut self, next: &Next) {
        match next {
            Next::Place(number) => {
                self.positions.entry(*number).or_insert_with(|| {
                    self.order.push(*number);
                    self.order.len() - 1
                });
            }
            Next::End => {}
            Next::Chance(parts) => parts.iter().for_each(|(_, part)| self.add(part)),
            Next::Best(parts) => parts.iter().for_each(|part| self.add(part)),
        }
    }
}

/// Sums of rewards by place.
struct Values {
    sums: Vec<f64>,
    positions: HashMap<usize, usize>,
}

fn value(next: &Next, values: &Values) -> f64 {
    match next {
        Next::Place(number) => {
            values.positions.get(number).and_then(|at| values.sums.get(*at)).copied().unwrap_or(0.0)
        }
        Next::End => 0.0,
        Next::Chance(parts) => parts.iter().map(|(share, part)| share * value(part, values)).sum(),
        Next::Best(parts) => parts.iter().map(|part| value(part, values)).fold(f64::NEG_INFINITY, f64::max),
    }
}

/// A sum to six decimals; zero if it is too large to be told.
fn rounded(value: f64) -> Rational {
    const MILLIONTHS: f64 = 1e6;
    Rational::from_wide((value * MILLIONTHS).round() as i128, MILLIONTHS as i128).unwrap_or(Rational::ZERO)
}
