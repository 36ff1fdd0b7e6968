//! `enroute robustness`: executes a mission's plan many times with chance, or adds up what several machines found.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr;

use anyhow::{Context as _, bail, ensure};
use mission::Manner;
use serde::{Deserialize, Serialize};
use snapshot::robustness::Traverses;
use snapshot::{RobustnessSettings, Tally, Uncertainty};

use crate::deadline::{TimeIsUp, TimeLimit, Undecided};
use crate::diagnostics::print_problems;
use crate::input::{read_json, read_text};
use crate::output::{Format, NO, WRONG, YES, escaped, exit, print_text, print_verbatim};
use crate::target::Target;

/// Executes a mission's plan many times with chance: how often it reaches its end, and what breaks it.
///
/// With --shard i/n it makes only every n-th run; the lines of all shards, given to --merge, add up to exactly what one
/// call without --shard gives.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Option<Target>,
    /// Adds up the JSON lines in these files (`-` is standard input) instead of making runs.
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with = "file")]
    merge: Vec<PathBuf>,
    /// How many runs, over all shards.
    #[arg(long, default_value_t = 1000)]
    runs: u64,
    /// Seeds chance; run number i of a seed is the same run in every shard.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Seeds path planning.
    #[arg(long, default_value_t = 0)]
    path_seed: u64,
    /// Makes only the runs of part i of n, from 1.
    #[arg(long, value_name = "i/n", default_value = "1/1")]
    shard: Shard,
    /// What is left to chance; docs/robustness.md describes it.
    #[arg(long, value_name = "U.json")]
    uncertainty: Option<PathBuf>,
    /// Lets vehicles drive their traverses in simulation instead of drawing how long they take: far slower.
    #[arg(long)]
    drive: bool,
    /// Lets nature choose its durations so as to break the plan: ends of ranges, where nothing breaks it.
    #[arg(long)]
    adversary: bool,
    #[command(flatten)]
    time_limit: TimeLimit,
    /// For whom the answer is; json is one line.
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
        let wrong = || format!("\"{text}\" is no part such as 2/8");
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
    let line = if args.merge.is_empty() {
        let target =
            args.target.as_ref().context("it takes a mission, or --merge and the files to add up")?;
        match sample(args, target)? {
            Ok(line) => line,
            Err(exit) => return Ok(exit),
        }
    } else {
        merge(&args.merge)?
    };
    match args.format {
        Format::Json => print_verbatim(&format!("{}\n", escaped(&serde_json::to_string(&line)?)))?,
        Format::Text => print_text(&describe(&line))?,
    }
    Ok(exit(YES))
}

fn sample(args: &Args, target: &Target) -> anyhow::Result<Result<Line, ExitCode>> {
    let mut mission = target.open()?;
    let compiled = mission.compile()?;
    let problems = compiled.problems();
    let Some(network) = compiled.network() else {
        print_problems(&mission.name, &mission.source, &problems)?;
        return Ok(Err(exit(WRONG)));
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
        print_text("the mission has no plan to execute; `enroute plan` says why\n")?;
        return Ok(Err(exit(NO)));
    };
    let sampler = sampler?;
    let limit = deadline.enforce(Undecided::Robustness);
    let settings = RobustnessSettings { runs: args.runs, seed: args.seed, uncertainty: uncertainty.clone() };
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
    let settings = Settings { runs: args.runs, seed: args.seed, uncertainty };
    Ok(Ok(Line::new(mission, settings, shards, tally)))
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
    sum.context("the files hold no lines to add up")
}

fn added(sum: Line, line: &Line, file: &Path) -> anyhow::Result<Line> {
    let file = file.display();
    ensure!(line.format == FORMAT, "{file}: this is no {FORMAT}");
    ensure!(line.mission == sum.mission, "{file}: these runs are of another mission");
    ensure!(line.settings == sum.settings, "{file}: these runs were made with other settings");
    if let Some(shard) = line.shards.iter().find(|shard| sum.shards.contains(shard)) {
        bail!("{file}: part {shard} is there twice");
    }
    let same_cut = |shard: &String| shard.split_once('/').map(|(_, of)| of.to_owned());
    ensure!(
        line.shards.first().and_then(same_cut) == sum.shards.first().and_then(same_cut),
        "{file}: the runs were cut into another number of parts"
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
    let percent = |share: f64| format!("{:.2} %", share * 100.0);
    let mut text = format!(
        "{} of {} runs reach the end: {} (95 % confidence: {} to {})\n",
        tally.succeeded,
        tally.runs,
        percent(line.probability),
        percent(line.interval[0]),
        percent(line.interval[1])
    );
    if tally.succeeded_by_replanning > 0 {
        let _ = writeln!(text, "{} of them only by planning again", tally.succeeded_by_replanning);
    }
    if !line.is_complete {
        let _ = writeln!(text, "parts {} only", line.shards.join(", "));
    }
    if !tally.breaks.is_empty() {
        text.push_str("\nwhat breaks the plan           broken  stopped  example\n");
        for (name, breaks) in tally.worst_events() {
            let _ = writeln!(
                text,
                "{name:30} {:>6}  {:>7}  run {}: {}",
                breaks.violations, breaks.stops, breaks.example_run, breaks.example
            );
        }
    }
    text.push_str("\nslack used                       mean     most\n");
    for (name, mean, most) in tally.tightest_events() {
        let _ = writeln!(text, "{name:30} {:>6.1} % {:>6.1} %", mean * 100.0, most * 100.0);
    }
    text
}
