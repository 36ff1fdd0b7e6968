//! How likely a program is to reach its end when components fail by chance.
//!
//! Run number i of a seed is the same run whoever makes it, and tallies hold only whole numbers: however the runs are
//! shared out, the sum is the same.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

use plant::{EstimateError, Random};
use serde::{Deserialize, Serialize};
use smol_str::{SmolStr, format_smolstr};

use super::estimator::Estimator;
use super::run::{Options, Run, RunStatus, StepInput};
use super::system::System;

/// What many runs have in common.
#[derive(Clone, Copy, Debug)]
pub struct Trials<'inputs> {
    /// How each run is made; its seed is replaced by that of the run.
    pub options: Options,
    pub seed: u64,
    /// A run that has not ended after so many steps has not reached its end.
    pub most_steps: u32,
    /// What comes from outside in every run, by step from 1.
    pub inputs: &'inputs BTreeMap<u32, StepInput>,
}

/// How some runs went. Tallies of different runs add up.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProgramTally {
    /// How many runs there were.
    pub runs: u64,
    /// How many reached the program's end within the steps allowed.
    pub reached: u64,
    /// How many of those took so many steps, by the number of steps.
    pub ends: BTreeMap<u32, u64>,
    /// What failed by chance, in the form `EngineA=Failed`.
    pub faults: BTreeMap<SmolStr, FaultTally>,
    /// What was still marked in the runs that did not end, by the label of the location.
    pub stuck: BTreeMap<SmolStr, u64>,
    /// In how many of the runs that did not end the belief was refuted.
    pub refuted: u64,
    /// The first run that did not end.
    pub first_stuck: Option<u64>,
}

/// The runs in which something failed by chance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultTally {
    /// How many there were.
    pub runs: u64,
    /// How many of those reached the end all the same.
    pub reached: u64,
}

impl ProgramTally {
    /// Adds the runs of another tally.
    pub fn merge(&mut self, other: &Self) {
        self.runs += other.runs;
        self.reached += other.reached;
        for (steps, runs) in &other.ends {
            *self.ends.entry(*steps).or_default() += runs;
        }
        for (fault, tally) in &other.faults {
            let sum = self.faults.entry(fault.clone()).or_default();
            sum.runs += tally.runs;
            sum.reached += tally.reached;
        }
        self.refuted += other.refuted;
        for (label, runs) in &other.stuck {
            *self.stuck.entry(label.clone()).or_default() += runs;
        }
        self.first_stuck = match (self.first_stuck, other.first_stuck) {
            (Some(left), Some(right)) => Some(left.min(right)),
            (left, right) => left.or(right),
        };
    }

    /// The share of the runs that reached the end; 0 without any run.
    pub fn probability(&self) -> f64 {
        if self.runs == 0 { 0.0 } else { self.reached as f64 / self.runs as f64 }
    }

    /// The 95 % confidence interval of the probability.
    pub fn interval(&self) -> (f64, f64) {
        wilson_interval(self.reached, self.runs)
    }

    /// The mean number of steps of the runs that reached the end; 0 if none did.
    pub fn mean_steps(&self) -> f64 {
        let steps: u64 = self.ends.iter().map(|(steps, runs)| u64::from(*steps) * runs).sum();
        if self.reached == 0 { 0.0 } else { steps as f64 / self.reached as f64 }
    }

    fn take(&mut self, system: &System, run: &Run, number: u64) {
        self.runs += 1;
        if run.is_done() {
            self.reached += 1;
            *self.ends.entry(run.records().len() as u32).or_default() += 1;
        } else {
            self.refuted += u64::from(run.status() == RunStatus::Refuted);
            let labels: BTreeSet<SmolStr> = run.upcoming().labels.into_iter().collect();
            for label in labels {
                *self.stuck.entry(label).or_default() += 1;
            }
            self.first_stuck = Some(self.first_stuck.map_or(number, |first| first.min(number)));
        }
        let failed: BTreeSet<_> = run.records().iter().flat_map(|record| &record.failed).collect();
        for &(component, mode) in failed {
            let name = system.model.component(component).map_or("?", |component| component.name.as_str());
            let fault = format_smolstr!("{name}={}", system.model.mode_name(component, mode));
            let tally = self.faults.entry(fault).or_default();
            tally.runs += 1;
            tally.reached += u64::from(run.is_done());
        }
    }
}

/// The seed of one of many runs: with it as [`Options::seed`], that run is made again.
pub const fn run_seed(seed: u64, number: u64) -> u64 {
    Random::skipped(seed, number).next_bits()
}

/// Makes the runs of these numbers, until `go_on` returns `false` after one of them; the tally says how many were made.
pub fn sample(
    system: &Arc<System>,
    trials: &Trials<'_>,
    numbers: Range<u64>,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<ProgramTally, EstimateError> {
    let mut estimator = Estimator::new(system, trials.options.most_states);
    let nothing = StepInput::default();
    let mut tally = ProgramTally::default();
    for number in numbers {
        let options = Options { seed: Some(run_seed(trials.seed, number)), ..trials.options };
        let mut run = Run::with_estimator(system, options, estimator);
        for step in 1..=trials.most_steps {
            if run.status() != RunStatus::Running {
                break;
            }
            run.step(trials.inputs.get(&step).unwrap_or(&nothing))?;
        }
        tally.take(system, &run, number);
        estimator = run.into_estimator();
        if !go_on() {
            break;
        }
    }
    Ok(tally)
}

/// The 95 % confidence interval of a share (Wilson 1927); everything is possible without any run.
pub fn wilson_interval(successes: u64, runs: u64) -> (f64, f64) {
    const NORMAL_QUANTILE: f64 = 1.959_963_984_540_054;
    if runs == 0 {
        return (0.0, 1.0);
    }
    let count = runs as f64;
    let share = successes as f64 / count;
    let square = NORMAL_QUANTILE * NORMAL_QUANTILE;
    let scale = 1.0 + square / count;
    let middle = (share + square / (2.0 * count)) / scale;
    let half =
        NORMAL_QUANTILE * (share * (1.0 - share) / count + square / (4.0 * count * count)).sqrt() / scale;
    ((middle - half).max(0.0), (middle + half).min(1.0))
}
