//! What a command is about: a mission text, or a network written by another tool, and what of it is planned.

use std::path::PathBuf;

use anyhow::Context as _;
use exact::{Bound, Time};
use snapshot::Goal;

use crate::deadline::TimeLimit;
use crate::number::seed;
use crate::output::Format;

/// How commands plan and answer that need a plan with its paths.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct PlanOptions {
    /// Seed for path planning.
    #[arg(long, default_value_t = 0, value_parser = seed)]
    pub seed: u64,
    #[command(flatten)]
    pub time_limit: TimeLimit,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// What is to be compiled or planned.
#[derive(clap::Args, Debug)]
pub struct Target {
    /// Mission (.rmpl), network (.tpn.json, .tpn.edn, .tpn, .ptpn, .xml), or
    /// PlanDev plan (.json); - reads standard input.
    pub file: PathBuf,
    /// Scenario to plan [default: first in file].
    #[arg(long, conflicts_with = "activity")]
    pub scenario: Option<String>,
    /// Plan this activity instead of a scenario.
    #[arg(long)]
    pub activity: Option<String>,
    /// Minimum and maximum duration of the activity, as in 450,540 or 0,inf.
    #[arg(long, requires = "activity", value_name = "L,U")]
    pub bounds: Option<String>,
}

impl Target {
    /// Returns what the call asks to be planned.
    pub fn goal(&self) -> anyhow::Result<Goal> {
        if let Some(name) = &self.activity {
            let (lower, upper) = match &self.bounds {
                Some(bounds) => parse_bounds(bounds)?,
                None => (Time::ZERO, Bound::Infinite),
            };
            return Ok(Goal::Activity { name: name.into(), lower, upper });
        }
        // Without a choice, a file without scenarios is an error: nothing in it says what to plan.
        Ok(self.scenario.as_ref().map_or(Goal::FirstScenario, |name| Goal::Scenario(name.into())))
    }
}

/// Returns whether a file holds a network rather than a mission text.
pub fn is_network(name: &str, source: &str) -> bool {
    let is_named_so = [".json", ".edn", ".tpn", ".ptpn", ".xml"].iter().any(|ending| name.ends_with(ending));
    is_named_so || (name == "-" && interchange::is_network_text(source))
}

fn parse_bounds(text: &str) -> anyhow::Result<(Time, Bound)> {
    let explain = || format!("--bounds expects two times, as in 450,540 or 0,inf, not `{text}`");
    let (lower, upper) = text.split_once(',').with_context(explain)?;
    let lower: Time = lower.parse().with_context(explain)?;
    let upper: Bound = upper.parse().with_context(explain)?;
    anyhow::ensure!(
        !lower.is_negative() && Bound::Finite(lower) <= upper,
        "--bounds expects 0 ≤ L ≤ U, not `{text}`"
    );
    Ok((lower, upper))
}

/// The value of `--threat-gap`.
pub fn parse_threat_gap(text: &str) -> anyhow::Result<Time> {
    let gap: Time = text.parse().with_context(|| format!("--threat-gap expects a time, not `{text}`"))?;
    anyhow::ensure!(!gap.is_negative(), "--threat-gap must not be negative");
    Ok(gap)
}
