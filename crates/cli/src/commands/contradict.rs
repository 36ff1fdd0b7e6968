//! `enroute contradict`: looks for counterexamples of the lines of a mission's review that have passed.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::Context as _;
use exact::Time;
use executive::Script;
use mission::Manner;
use review::contradict::{Counterexample, Effort, Trial, Tried, Verdict};
use review::{FlightRules, Section, review};
use serde_json::{Value, json};
use smol_str::SmolStr;
use tpn::Network;
use tpn::plan_json::plan_from_json;

use crate::commands::report::read_rules;
use crate::commands::verify::without_path_vertices;
use crate::deadline::{Undecided, parse_seconds};
use crate::input::read_json;
use crate::number::{number_in, seed};
use crate::output::{Format, NO, YES, column, document, exit, print_json, print_text};
use crate::target::{PlanOptions, Target};

/// Search for counterexamples of the items that passed in a mission's review.
///
/// The search tries schedules of the plan, undisturbed runs, and other plans. If it contradicts an item, the exit status is 1.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// Review this plan instead of the mission's own; a document of enroute plan.
    #[arg(long, value_name = "PLAN.json")]
    plan: Option<PathBuf>,
    /// Check the plan against these flight rules instead of the default ones.
    #[arg(long, value_name = "RULES.json")]
    rules: Option<PathBuf>,
    /// Stop searching after SECONDS; planning and review come first.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = parse_seconds)]
    budget: f64,
    /// Maximum number of schedules to try: the earliest, the latest, and random ones.
    #[arg(long, value_name = "N", default_value_t = Effort::default().schedules, value_parser = number_in(0..=u64::MAX))]
    schedules: u64,
    /// Maximum number of undisturbed runs to try; vehicles drive in them.
    #[arg(long, value_name = "N", default_value_t = Effort::default().runs, value_parser = number_in(0..=u64::MAX))]
    runs: u64,
    /// Seed for random schedules and runs.
    #[arg(long, default_value_t = 0, value_parser = seed)]
    run_seed: u64,
    #[command(flatten)]
    options: PlanOptions,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let PlanOptions { seed, time_limit, format } = args.options;
    let deadline = time_limit.start();
    let mut mission = args.target.open()?;
    let compiled = mission.compile()?;
    let problems = compiled.problems();
    if compiled.network().is_none() {
        return mission.refuse(&problems, format, ("contradict", json!({ "items": [] })));
    }
    let ground = mission.ground(&compiled)?;
    let mut evaluated = mission.plan(compiled, ground, Manner { seed, ..Manner::default() }, deadline)?;
    if let Some(path) = &args.plan {
        let stated = only_plan(read_json(path)?).with_context(|| format!("cannot use {}", path.display()))?;
        let read = |network: &Network| {
            let whole = plan_from_json(network, &stated);
            let plan = whole.or_else(|_| plan_from_json(network, &without_path_vertices(&stated)));
            plan.map_err(|error| error.to_string())
        };
        let taken = mission.core.take_plan(&mut evaluated, &read);
        taken.map_err(anyhow::Error::msg).with_context(|| format!("cannot use {}", path.display()))?;
    }
    let limit = deadline.enforce(Undecided::Review, ("contradict", format));
    let snapshot = evaluated.snapshot();
    let mut reviewed = review(&snapshot, &args.target.goal()?, seed, &mut || false);
    let rules = match &args.rules {
        Some(path) => read_rules(path)?,
        None => FlightRules::default(),
    };
    reviewed.hold_against(&snapshot, &rules, None, &mut || false);
    limit.answered();
    let effort = Effort { schedules: args.schedules, runs: args.runs, seed: args.run_seed };
    let Some(mut trial) = Trial::new(&snapshot, &reviewed, None, effort) else {
        match format {
            Format::Text => print_text("the mission has no plan, so no item of its review has passed\n")?,
            Format::Json => print_json(&document("contradict", &snapshot.problems, json!({ "items": [] })))?,
        }
        return Ok(exit(NO));
    };
    let begun = Instant::now();
    // A budget that is too long for a duration limits nothing.
    let budget = Duration::try_from_secs_f64(args.budget).unwrap_or(Duration::MAX);
    while begun.elapsed() < budget && mission.core.try_next(&evaluated, &mut trial)? {}
    let tried: Vec<&Tried> = trial.tried().collect();
    let is_contradicted = tried.iter().any(|it| it.verdict() == Verdict::Contradicted);
    match format {
        Format::Text => print_text(&evaluated.planned.network.readable(&table(&tried)))?,
        Format::Json => {
            let body = json!({ "seed": seed, "items": items_json(&tried) });
            print_json(&document("contradict", &snapshot.problems, body))?;
        }
    }
    Ok(exit(if is_contradicted { NO } else { YES }))
}

/// The first plan of a document.
fn only_plan(mut stated: Value) -> anyhow::Result<Value> {
    match stated.get_mut("plans").map(Value::take) {
        Some(Value::Array(plans)) => {
            plans.into_iter().next().context("the document lists no plan; it needs at least one")
        }
        Some(_) => anyhow::bail!("`plans` must be a list"),
        None => Ok(stated),
    }
}

const fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Survived => "survived",
        Verdict::Contradicted => "contradicted",
        Verdict::NotTried => "not tried",
    }
}

fn table(tried: &[&Tried]) -> String {
    let mut text = String::new();
    let hows: Vec<String> = tried.iter().map(|it| it.how()).collect();
    for (tried, how) in tried.iter().zip(column(hows.iter().map(String::as_str))) {
        let (verdict, title) = (word(tried.verdict()), tried.line.section.title());
        text.push_str(&format!("{verdict:<12}  {how}  {title}: {}\n", tried.line.text));
        let Some(Counterexample { text: found, script }) = &tried.counterexample else { continue };
        if *script == Script::default() {
            text.push_str(&format!("    {found}\n"));
        } else if script.schedule.is_empty() {
            text.push_str(&format!("    run: {found}\n"));
            let as_drawn = script.nature.is_empty();
            let how = match (script.run_seed, script.adversary, as_drawn) {
                (_, true, _) => "worst-case contingent durations".to_owned(),
                (Some(seed), false, true) => format!("seed {seed}"),
                _ => "contingent durations:".to_owned(),
            };
            text.push_str(&format!("      {how}\n"));
            text.push_str(&times(&script.nature));
        } else {
            text.push_str(&format!("    schedule: {found}\n"));
            text.push_str(&times(&script.schedule));
        }
    }
    let count = |wanted: Verdict| tried.iter().filter(|it| it.verdict() == wanted).count();
    text.push_str(&format!(
        "{} of {} items survived, {} contradicted, {} not tried\n",
        count(Verdict::Survived),
        tried.len(),
        count(Verdict::Contradicted),
        count(Verdict::NotTried)
    ));
    text
}

/// Times by name, the earliest first.
fn times(of: &BTreeMap<SmolStr, Time>) -> String {
    let mut sorted: Vec<(&SmolStr, &Time)> = of.iter().collect();
    sorted.sort_by_key(|&(name, time)| (time, name));
    sorted.iter().map(|(name, time)| format!("      {:>9}  {name}\n", time.readable())).collect()
}

/// The lines for other programs. An `id` is the section of the review with the number of the line among those of it that have
/// passed, from 1.
fn items_json(tried: &[&Tried]) -> Value {
    let mut numbers: BTreeMap<Section, usize> = BTreeMap::new();
    let item = |tried: &&Tried| {
        let section = tried.line.section;
        let number = numbers.entry(section).or_default();
        *number += 1;
        let mut item = json!({
            "id": format!("{}/{number}", json!(section).as_str().unwrap_or_default()),
            "text": tried.line.text,
            "status": tried.verdict(),
            "tried": { "schedules": tried.schedules, "runs": tried.runs, "plans": tried.plans },
        });
        if let Some(Counterexample { text, script }) = &tried.counterexample {
            item["counterexample"] = json!({ "text": text, "script": script });
        }
        item
    };
    tried.iter().map(item).collect()
}
