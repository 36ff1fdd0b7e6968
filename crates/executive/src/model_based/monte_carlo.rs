//! How likely a program is to reach its end when components fail by chance.

use plant::{EstimateError, Random};

use super::mind::{Estimation, Mind};
use super::run::{Options, Run, StepInput};
use super::system::System;

/// The result of many runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MonteCarlo {
    /// How many runs there were.
    pub runs: u32,
    /// How many reached the program's end within the steps allowed.
    pub reached: u32,
    /// The share of those.
    pub probability: f64,
    /// The 95 % confidence interval of the probability.
    pub interval: (f64, f64),
    /// The mean number of steps of the runs that reached the end; 0 if none did.
    pub mean_steps: f64,
}

/// Makes `runs` runs of at most `most_steps` steps each, with random numbers from `seed`.
pub fn monte_carlo(
    system: &System,
    options: Options,
    runs: u32,
    most_steps: u32,
    seed: u64,
) -> Result<MonteCarlo, EstimateError> {
    let estimation = options.estimation.unwrap_or_else(|| Estimation::for_model(&system.model));
    let mut mind = Mind::new(&system.model, estimation);
    let mut seeds = Random::new(seed);
    let mut reached = 0;
    let mut steps = 0_u64;
    for _ in 0..runs {
        let options = Options { seed: Some(seeds.next_bits()), ..options };
        let mut run = Run::with_mind(system, options, mind);
        for _ in 0..most_steps {
            if run.is_done() {
                break;
            }
            run.step(&StepInput::default())?;
        }
        if run.is_done() {
            reached += 1;
            steps += run.records().len() as u64;
        }
        mind = run.into_mind();
    }
    let mean_steps = if reached == 0 { 0.0 } else { steps as f64 / f64::from(reached) };
    let probability = if runs == 0 { 0.0 } else { f64::from(reached) / f64::from(runs) };
    Ok(MonteCarlo {
        runs,
        reached,
        probability,
        interval: wilson_interval(reached.into(), runs.into()),
        mean_steps,
    })
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
