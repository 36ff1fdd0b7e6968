//! `enroute contradict`: looks for counterexamples of the lines of a mission's review that have passed.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;

use executive::Script;
use mission::Manner;
use mission::execution::Ran;
use review::contradict::{Counterexample, Trial, Tried};
use review::{FlightRules, Section, review};
use serde_json::{Value, json};

use crate::commands::report::read_rules;
use crate::deadline::{TimeLimit, Undecided};
use crate::output::{Format, NO, YES, column, document, exit, print_json, print_text};
use crate::target::Target;

/// Looks for counterexamples of what has passed in a mission's review: in schedules of its plan, and in runs.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// Flight rules to hold the plan against; otherwise the usual ones.
    #[arg(long, value_name = "RULES.json")]
    rules: Option<PathBuf>,
    /// How many schedules to try: the earliest, the latest, and others by chance.
    #[arg(long, value_name = "N", default_value_t = 200)]
    schedules: usize,
    /// How many undisturbed runs to try; vehicles drive in them.
    #[arg(long, value_name = "N", default_value_t = 10)]
    runs: u64,
    /// Seeds schedules and runs; paths are those of seed 0.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    time_limit: TimeLimit,
    /// For whom the answer is.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// The paths of the plan are those of this seed.
const PATH_SEED: u64 = 0;

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let deadline = args.time_limit.start();
    let (snapshot, _) = args.target.open()?.evaluate(PATH_SEED, deadline)?;
    let limit = deadline.enforce(Undecided::Review);
    let mut reviewed = review(&snapshot, &args.target.goal()?, PATH_SEED, &mut || false);
    let rules = match &args.rules {
        Some(path) => read_rules(path)?,
        None => FlightRules::default(),
    };
    reviewed.hold_against(&snapshot, &rules, None, &mut || false);
    limit.answered();
    let Some(mut trial) = Trial::new(&snapshot, &reviewed) else {
        match args.format {
            Format::Text => print_text("the mission has no plan, so nothing of it has passed\n")?,
            Format::Json => print_json(&document("contradict", &snapshot.problems, json!({ "items": [] })))?,
        }
        return Ok(exit(NO));
    };
    trial.try_schedules(args.schedules, args.seed, &mut || deadline.is_over());
    let mut mission = args.target.open()?;
    let compiled = mission.compile()?;
    let ground = mission.ground(&compiled)?;
    let manner = Manner { seed: PATH_SEED, ..Manner::default() };
    let mut evaluated = mission.plan(compiled, ground, manner, deadline)?;
    for number in 0..args.runs {
        if deadline.is_over() {
            break;
        }
        let seed = args.seed.wrapping_add(number);
        evaluated.reseed(seed);
        // Nature ends its durations anywhere in every other run, and at ends of their ranges in the others.
        let script = Script { adversary: number % 2 == 1, ..Script::default() };
        let Some(ran) = mission.core.run(&evaluated, &script) else { break };
        let Ran { outcome, .. } = ran?;
        trial.try_run(&outcome.log, outcome.ending, seed);
    }
    let tried = trial.into_tried();
    let is_contradicted = tried.iter().any(|it| it.counterexample.is_some());
    match args.format {
        Format::Text => print_text(&table(&tried))?,
        Format::Json => {
            let body = json!({ "items": items_json(&tried) });
            print_json(&document("contradict", &snapshot.problems, body))?;
        }
    }
    Ok(exit(if is_contradicted { NO } else { YES }))
}

/// What was done to a line.
fn how(tried: &Tried) -> String {
    let counted = |count: usize, one: &str, several: &str| match count {
        0 => None,
        1 => Some(format!("1 {one}")),
        count => Some(format!("{count} {several}")),
    };
    let parts = [counted(tried.schedules, "schedule", "schedules"), counted(tried.runs, "run", "runs")];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    if parts.is_empty() { "not tried".to_owned() } else { parts.join(", ") }
}

const fn outcome(tried: &Tried) -> &'static str {
    match (&tried.counterexample, tried.schedules, tried.runs) {
        (Some(_), ..) => "contradicted",
        (None, 0, 0) => "not-tried",
        (None, ..) => "survived",
    }
}

fn table(tried: &[Tried]) -> String {
    let mut text = String::new();
    let whats: Vec<String> = tried.iter().map(how).collect();
    for (tried, what) in tried.iter().zip(column(whats.iter().map(String::as_str))) {
        text.push_str(&format!(
            "{:<12}  {what}  {}: {}\n",
            outcome(tried),
            tried.section.title(),
            tried.text
        ));
        if let Some(Counterexample { text: found, schedule, seed }) = &tried.counterexample {
            let by = match seed {
                Some(seed) => format!("run of seed {seed}"),
                None => "schedule".to_owned(),
            };
            text.push_str(&format!("    {by}: {found}\n"));
            for (event, time) in schedule {
                text.push_str(&format!("      {:>9}  {event}\n", time.readable()));
            }
        }
    }
    let count = |wanted: &str| tried.iter().filter(|it| outcome(it) == wanted).count();
    text.push_str(&format!(
        "{} of {} lines survived, {} contradicted, {} not tried\n",
        count("survived"),
        tried.len(),
        count("contradicted"),
        count("not-tried")
    ));
    text
}

/// The lines for other programs. An `id` is the section of the review with the number of the line among those of it that have
/// passed, from 1.
fn items_json(tried: &[Tried]) -> Value {
    let mut numbers: BTreeMap<Section, usize> = BTreeMap::new();
    let item = |tried: &Tried| {
        let number = numbers.entry(tried.section).or_default();
        *number += 1;
        let mut item = json!({
            "id": format!("{}/{number}", json!(tried.section).as_str().unwrap_or_default()),
            "text": tried.text,
            "status": outcome(tried),
            "tried": { "schedules": tried.schedules, "runs": tried.runs },
        });
        if let Some(Counterexample { text, schedule, seed }) = &tried.counterexample {
            item["counterexample"] = json!({ "text": text, "seed": seed, "schedule": schedule });
        }
        item
    };
    tried.iter().map(item).collect()
}
