//! The run of a control program.

use std::collections::BTreeMap;

use executive::model_based::proof::Verdict;
use executive::model_based::{AskedCondition, RewardChoice, StepOutcome};
use hca::Automaton;
use plant::{Interval, Model};
use serde::Serialize;
#[cfg(test)]
use ts_rs::TS;

use crate::state::automaton::{AutomatonState, PlantMoment, Program};
use crate::state::program_chance::ProgramChanceState;

/// The description has at most this number of states, the most likely ones.
const MAX_BELIEVED: usize = 64;

/// A run of a control program at the current step.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct ProgramRun {
    /// The number of steps before this moment.
    pub step: usize,
    /// The number of all steps of the run.
    pub steps: usize,
    pub locations: usize,
    /// The labels of the marked locations.
    pub marked: Option<Vec<String>>,
    /// The goals that the marked locations assert.
    pub goals: Option<Vec<String>>,
    /// The transitions of the step that led here.
    pub fired: Option<Vec<Fired>>,
    pub can_step: bool,
    pub is_playing: bool,
    pub trouble: Option<String>,
    /// How likely the program is to reach its end; `null` before Monte Carlo runs of the present text.
    pub chance: Option<ProgramChance>,
    /// Which properties hold in all runs; `null` before a proof for the present text.
    pub proof: Option<ProgramProof>,
    pub plant: Option<PlantState>,
}

/// A transition that was taken.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Fired {
    pub from: String,
}

/// How likely a program is to reach its end.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct ProgramChance {
    #[cfg_attr(test, ts(type = "number"))]
    pub runs: u64,
    pub is_running: bool,
    #[cfg_attr(test, ts(type = "number"))]
    pub reached: u64,
    pub probability: f64,
    /// The 95% confidence interval of the probability.
    pub interval: [f64; 2],
    pub mean_steps: f64,
}

/// Which properties hold in all runs of a program, or why Enroute can prove none.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct ProgramProof {
    pub is_running: bool,
    pub states: usize,
    pub trouble: Option<String>,
    /// Why some states were not explored; `null` if all were.
    pub stopped: Option<String>,
    pub verdicts: Vec<ProgramVerdict>,
}

/// Whether a property holds in all runs.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct ProgramVerdict {
    pub property: String,
    /// `holds`, `broken`, or `open` if no examined run breaks it but some runs were not examined.
    pub verdict: String,
    /// In the run that breaks it, the steps in which a component does not behave nominally, such as `3: EngineA=Failed`.
    pub faults: Vec<String>,
}

/// The belief about a plant, and its true state; modes and values by component and variable.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct PlantState {
    /// Most likely first, at most 64 of them.
    pub belief: Vec<Believed>,
    pub true_state: BTreeMap<String, String>,
    pub observations: Option<BTreeMap<String, String>>,
    pub commands: Option<BTreeMap<String, String>>,
    pub next_commands: Option<BTreeMap<String, String>>,
    pub unachievable: Vec<Unachievable>,
    /// The choices by rewards that led into the last step.
    pub chosen: Vec<Chosen>,
    /// The conditions that the program asked for in the last step; empty without the option `entailment`.
    pub asked: Vec<Asked>,
    /// Whether no state explains the observations, so that the run ends here.
    pub is_unexplained: bool,
    /// Whether more states are possible than the estimator keeps, so that probabilities are known less well.
    pub is_uncertain: bool,
    /// Which assumptions the observations contradict.
    pub conflicts: Option<Vec<String>>,
}

/// A state that is believed possible.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Believed {
    pub state: BTreeMap<String, String>,
    pub probability: StateProbability,
}

/// How likely a state is.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(untagged)]
pub enum StateProbability {
    /// An exact fraction.
    Exact(String),
    /// At least and at most so likely, as decimals.
    Between([String; 2]),
}

/// A condition that a program asked for.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct Asked {
    pub condition: String,
    pub probability: StateProbability,
    /// Whether its probability reaches the threshold of the program.
    pub is_known: bool,
}

/// A choice by rewards.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct Chosen {
    pub choice: String,
    /// Which alternative was chosen, from 1.
    pub alternative: usize,
    /// The expected sum of rewards of each alternative, as decimals or fractions.
    pub expected: Vec<String>,
    /// The number of steps that the sum covers.
    pub horizon: u32,
    /// Whether the program asks for more steps than the calculation could cover.
    pub is_shortened: bool,
}

/// A goal that cannot be reached.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Unachievable {
    pub goal: String,
    pub reason: String,
}

/// The current step, what is marked there and, with a plant, what is believed, true, observed and commanded;
/// nothing if the text is not a control program.
pub(super) fn program_run(state: &AutomatonState, revision: u64) -> Option<ProgramRun> {
    let program = state.program()?;
    let moment = state.moment();
    let plant = program.model().zip(moment.and_then(|moment| moment.plant.as_ref()));
    let strings = |names: &[smol_str::SmolStr]| names.iter().map(ToString::to_string).collect();
    Some(ProgramRun {
        step: state.at(),
        steps: state.moments().len().saturating_sub(1),
        locations: program.automaton().map_or(0, |automaton| automaton.locations.len()),
        marked: moment.map(|moment| strings(&moment.upcoming.labels)),
        goals: moment.map(|moment| strings(&moment.upcoming.goals)),
        fired: program.automaton().zip(moment).map(|(automaton, moment)| {
            let taken = moment.taken.iter().flat_map(|taken| &taken.fired);
            taken.filter_map(|&id| fired(automaton, id)).collect()
        }),
        can_step: state.can_step(),
        is_playing: state.is_playing,
        trouble: state.error.clone(),
        chance: chance(&state.chance, revision),
        proof: proof(state, revision),
        plant: plant.map(|(model, moment)| plant_state(model, moment)),
    })
}

fn chance(chance: &ProgramChanceState, revision: u64) -> Option<ProgramChance> {
    let tally = chance.tally(revision)?;
    let (low, high) = tally.interval();
    Some(ProgramChance {
        runs: tally.runs,
        is_running: chance.is_running(),
        reached: tally.reached,
        probability: tally.probability(),
        interval: [low, high],
        mean_steps: tally.mean_steps(),
    })
}

fn proof(state: &AutomatonState, revision: u64) -> Option<ProgramProof> {
    let proof = &state.proof;
    let (is_running, states) = (proof.is_running(), proof.states());
    let empty = ProgramProof { is_running, states, trouble: None, stopped: None, verdicts: Vec::new() };
    match proof.answer(revision) {
        None => is_running.then_some(empty),
        Some((_, Err(trouble))) => Some(ProgramProof { trouble: Some(trouble.clone()), ..empty }),
        Some((_, Ok(answer))) => {
            let model = state.program().and_then(Program::model);
            let verdict = |(property, verdict): &(String, Verdict)| ProgramVerdict {
                property: property.clone(),
                verdict: verdict_name(verdict).to_owned(),
                faults: match verdict {
                    Verdict::Broken(run) => model.map_or_else(Vec::new, |model| run.unusual(model)),
                    _ => Vec::new(),
                },
            };
            let verdicts = answer.verdicts.iter().map(verdict).collect();
            Some(ProgramProof { stopped: answer.stopped.clone(), verdicts, ..empty })
        }
    }
}

const fn verdict_name(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::Holds => "holds",
        Verdict::Broken(_) | Verdict::Never(_) => "broken",
        Verdict::Open => "open",
    }
}

fn fired(automaton: &Automaton, id: hca::TransitionId) -> Option<Fired> {
    let transition = automaton.transitions.get(id.0 as usize)?;
    Some(Fired { from: automaton.location_name(transition.source).clone() })
}

fn state_probability(probability: &Interval) -> StateProbability {
    if probability.exact().is_some() {
        return StateProbability::Exact(probability.to_string());
    }
    let (low, high) = probability.decimals();
    StateProbability::Between([low, high])
}

fn chosen(made: &RewardChoice) -> Chosen {
    Chosen {
        choice: made.label.to_string(),
        alternative: made.alternative + 1,
        expected: made.expected.iter().map(ToString::to_string).collect(),
        horizon: made.horizon,
        is_shortened: made.is_shortened,
    }
}

fn asked(asked: &AskedCondition) -> Asked {
    Asked {
        condition: asked.condition.to_string(),
        probability: state_probability(&asked.probability),
        is_known: asked.is_entailed,
    }
}

fn plant_state(model: &Model, moment: &PlantMoment) -> PlantState {
    let record = moment.record.as_ref();
    PlantState {
        belief: moment
            .belief
            .states()
            .take(MAX_BELIEVED)
            .map(|(state, probability)| Believed {
                state: model.state_names(&state),
                probability: state_probability(&probability),
            })
            .collect(),
        true_state: model.state_names(&moment.true_state),
        observations: record.map(|record| model.observation_names(&record.observation)),
        commands: record.map(|record| model.command_names(&record.commands)),
        next_commands: moment.next_commands.as_ref().map(|commands| model.command_names(commands)),
        unachievable: moment
            .unachievable
            .iter()
            .map(|(goal, reason)| Unachievable { goal: goal.to_string(), reason: reason.clone() })
            .collect(),
        chosen: record.map_or_else(Vec::new, |record| record.chosen.iter().map(chosen).collect()),
        asked: record.map_or_else(Vec::new, |record| record.asked.iter().map(asked).collect()),
        is_unexplained: record.is_some_and(|record| record.outcome != StepOutcome::Explained),
        is_uncertain: record.is_some_and(|record| record.is_uncertain),
        conflicts: record
            .map(|record| record.conflicts.iter().map(|conflict| conflict.describe(model)).collect()),
    }
}
