//! `enroute robustness`: executes a mission's plan many times with chance, or adds up what several machines found.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr;

use anyhow::{Context as _, bail, ensure};
use mission::Manner;
use serde::{Deserialize, Serialize};
use serde_json::json;
use snapshot::Problem;
use snapshot::robustness::Traverses;
use snapshot::{RobustnessSettings, Tally, Uncertainty};

use crate::deadline::{TimeIsUp, TimeLimit, Undecided};
use crate::diagnostics::print_problems;
use crate::input::{read_json, read_text};
use crate::number::{number_in, seed};
use crate::output::{Format, NO, YES, document, escaped, exit, print_json, print_text, print_verbatim};
use crate::target::Target;

/// Estimate a plan's success rate by Monte Carlo simulation.
///
/// With --shard i/n, only every n-th run is made. Merging the results of all shards with --merge gives exactly the result of one call without --shard.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Option<Target>,
    /// Merge the results in these files (- reads standard input) instead of making runs.
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with = "file")]
    merge: Vec<PathBuf>,
    /// Number of runs, over all shards.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = number_in(1..=u64::MAX))]
    runs: u64,
    /// Seed for runs. Run i is identical in every shard.
    #[arg(long, alias = "seed", value_name = "SEED", default_value_t = 0, value_parser = seed)]
    run_seed: u64,
    /// Seed for path planning.
    #[arg(long, default_value_t = 0, value_parser = seed)]
    path_seed: u64,
    /// Make only the runs of shard i of n, counted from 1.
    #[arg(long, value_name = "i/n", default_value = "1/1")]
    shard: Shard,
    /// Distributions to sample; docs/robustness.md describes the file.
    #[arg(long, value_name = "U.json")]
    uncertainty: Option<PathBuf>,
    /// Simulate each traverse instead of sampling its duration (much slower).
    #[arg(long)]
    drive: bool,
    /// Use worst-case contingent durations.
    #[arg(long)]
    adversary: bool,
    #[command(flatten)]
    time_limit: TimeLimit,
    /// Output format; json is one line.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Which part of the runs is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shard {
    part: u64,
    of: u64,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("\"{text}\" is not a valid shard; expected i/n with 1 ≤ i ≤ n, as in 2/8");
        let (part, of) = text.split_once('/').ok_or_else(wrong)?;
        let (part, of) = (part.parse().map_err(|_| wrong())?, of.parse().map_err(|_| wrong())?);
        if (1..=of).contains(&part) { Ok(Self { part, of }) } else { Err(wrong()) }
    }
}

/// One line of the answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Line {
    format: String,
    /// What was executed: text, plan and seed of its paths.
    mission: String,
    settings: Settings,
    /// The parts of the runs that are in it, as `i/n`.
    shards: Vec<String>,
    is_complete: bool,
    probability: f64,
    /// The 95 % confidence interval.
    interval: [f64; 2],
    tally: Tally,
}

/// [`RobustnessSettings`] as JSON.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Settings {
    runs: u64,
    seed: u64,
    uncertainty: Uncertainty,
}

const FORMAT: &str = "enroute-robustness/1";

impl Line {
    fn new(mission: String, settings: Settings, shards: Vec<String>, tally: Tally) -> Self {
        let (low, high) = tally.interval();
        Self {
            format: FORMAT.to_owned(),
            mission,
            is_complete: tally.runs >= settings.runs,
            settings,
            shards,
            probability: tally.probability(),
            interval: [low, high],
            tally,
        }
    }
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let (line, problems) = if args.merge.is_empty() {
        let target = args.target.as_ref().context("expected a mission file, or --merge with result files")?;
        match sample(args, target)? {
            Ok(sampled) => sampled,
            Err(exit) => return Ok(exit),
        }
    } else {
        (merge(&args.merge)?, Vec::new())
    };
    match args.format {
        Format::Json => {
            let answer = document("robustness", &problems, serde_json::to_value(&line)?);
            print_verbatim(&format!("{}\n", escaped(&serde_json::to_string(&answer)?)))?;
        }
        Format::Text => print_text(&describe(&line))?,
    }
    Ok(exit(YES))
}

type Sampled = (Line, Vec<Problem>);

fn sample(args: &Args, target: &Target) -> anyhow::Result<Result<Sampled, ExitCode>> {
    let mut mission = target.open()?;
    let compiled = mission.compile()?;
    let problems = compiled.problems();
    let Some(network) = compiled.network() else {
        return Ok(Err(mission.refuse(&problems, args.format, ("robustness", json!({})))?));
    };
    let mut uncertainty = match &args.uncertainty {
        Some(file) => read_json::<Uncertainty>(file)?,
        None => Uncertainty::default(),
    };
    if args.drive {
        uncertainty.traverses = Traverses::Driven;
    }
    uncertainty.adversary |= args.adversary;
    if let Some(problem) = uncertainty.problem(network) {
        bail!(problem);
    }
    let ground = mission.ground(&compiled)?;
    let deadline = args.time_limit.start();
    let manner = Manner { seed: args.path_seed, ..Manner::default() };
    let evaluated = mission.plan(compiled, ground, manner, deadline)?;
    if args.format == Format::Text {
        print_problems(&mission.name, &mission.source, &problems)?;
    }
    let Some(sampler) = evaluated.sampler(&uncertainty) else {
        match args.format {
            Format::Text => {
                print_text("the mission has no plan to execute; run `enroute plan` for the reason\n")?;
            }
            Format::Json => print_json(&document("robustness", &problems, json!({ "status": "no-plan" })))?,
        }
        return Ok(Err(exit(NO)));
    };
    let sampler = sampler?;
    let limit = deadline.enforce(Undecided::Robustness, ("robustness", args.format));
    let settings =
        RobustnessSettings { runs: args.runs, seed: args.run_seed, uncertainty: uncertainty.clone() };
    let mut tally = Tally::default();
    let mut number = args.shard.part - 1;
    while number < args.runs {
        ensure!(!deadline.is_over(), TimeIsUp(Undecided::Robustness));
        mission.core.sample_run((&evaluated, &sampler), &settings, number, &mut tally)?;
        number += args.shard.of;
    }
    limit.answered();
    let map = evaluated.ground.as_ref().map(|(key, _)| key);
    let mission = review::content_hash(&mission.source, map, &target.goal()?, args.path_seed);
    let shards = vec![format!("{}/{}", args.shard.part, args.shard.of)];
    let settings = Settings { runs: args.runs, seed: args.run_seed, uncertainty };
    Ok(Ok((Line::new(mission, settings, shards, tally), problems)))
}

/// Adds up lines that belong together.
fn merge(files: &[PathBuf]) -> anyhow::Result<Line> {
    let mut sum: Option<Line> = None;
    for file in files {
        let text = read_text(file)?;
        for (index, text) in text.lines().enumerate().filter(|(_, text)| !text.trim().is_empty()) {
            let line: Line = serde_json::from_str(text)
                .with_context(|| format!("{}, line {}", file.display(), index + 1))?;
            sum = Some(match sum {
                None => line,
                Some(sum) => added(sum, &line, file)?,
            });
        }
    }
    sum.context("the files contain no results to merge")
}

fn added(sum: Line, line: &Line, file: &Path) -> anyhow::Result<Line> {
    let file = file.display();
    ensure!(line.format == FORMAT, "{file}: expected results in the format {FORMAT}");
    ensure!(line.mission == sum.mission, "{file}: the results belong to another mission");
    ensure!(line.settings == sum.settings, "{file}: the results were made with other settings");
    if let Some(shard) = line.shards.iter().find(|shard| sum.shards.contains(shard)) {
        bail!("{file}: shard {shard} appears twice");
    }
    let same_cut = |shard: &String| shard.split_once('/').map(|(_, of)| of.to_owned());
    ensure!(
        line.shards.first().and_then(same_cut) == sum.shards.first().and_then(same_cut),
        "{file}: the number of shards differs from that of the other files"
    );
    let mut tally = sum.tally;
    tally.merge(&line.tally);
    let mut shards: Vec<String> = sum.shards.into_iter().chain(line.shards.iter().cloned()).collect();
    shards.sort_by_key(|shard| shard.split_once('/').and_then(|(part, _)| part.parse::<u64>().ok()));
    Ok(Line::new(sum.mission, sum.settings, shards, tally))
}

fn describe(line: &Line) -> String {
    use std::fmt::Write as _;
    let tally = &line.tally;
    let percent = |share: f64| format!("{:.2}%", share * 100.0);
    let mut text = format!(
        "{} of {} runs reach the end: {} (95% confidence: {} to {})\n",
        tally.succeeded,
        tally.runs,
        percent(line.probability),
        percent(line.interval[0]),
        percent(line.interval[1])
    );
    if tally.succeeded_by_replanning > 0 {
        let _ = writeln!(text, "{} of them only by replanning", tally.succeeded_by_replanning);
    }
    if !line.is_complete {
        let _ = writeln!(text, "only shards {}", line.shards.join(", "));
    }
    if !tally.breaks.is_empty() {
        text.push_str("\ncause                          broken  stopped  example\n");
        for (name, breaks) in tally.worst_events() {
            let _ = writeln!(
                text,
                "{name:30} {:>6}  {:>7}  run {}: {}",
                breaks.violations, breaks.stops, breaks.example_run, breaks.example
            );
        }
    }
    text.push_str("\nslack used                       mean  maximum\n");
    for (name, mean, most) in tally.tightest_events() {
        let _ = writeln!(text, "{name:30} {:>6.1}%  {:>6.1}%", mean * 100.0, most * 100.0);
    }
    text
}
