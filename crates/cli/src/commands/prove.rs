//! `enroute prove`: the properties of a control program that hold in every run with its plant, and the flight rules of a
//! mission that hold in every plan.

use exact::counted;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::anyhow;
use executive::model_based::proof::{
    Counterexample, DEFAULTS, Move, Proof, Property, Scope, Verdict, chance_to_end, prove,
};
use executive::model_based::{Options, Run, RunStatus, StepInput, System};
use plant::{Interval, Model};
use review::flight_rule::proof::ALTERNATIVES;
use serde_json::{Map, Value, json};

use crate::commands::prove_rules::{self, Call};
use crate::commands::run::{KnowledgeArg, read_system};
use crate::deadline::TimeLimit;
use crate::number::{number_in, positive_number, seed};
use crate::output::{
    E_LIMIT, Format, LIMIT, NO, WRONG, YES, document, exit, failure, print_json, print_text,
};
use crate::target::Target;

/// Prove properties of a control program in all runs, or rules of a mission in all plans.
#[derive(clap::Args)]
pub struct Args {
    /// Control program, or with --rules a mission; - reads standard input.
    file: PathBuf,
    /// Prove these flight rules of a mission in every plan.
    #[arg(long, value_name = "RULES.json", conflicts_with_all = PROGRAM_OPTIONS)]
    rules: Option<PathBuf>,
    /// Scenario of the mission [default: first in file].
    #[arg(long, requires = "rules")]
    scenario: Option<String>,
    /// Save the first plan that violates a rule.
    #[arg(long, short, value_name = "PLAN.json", requires = "rules")]
    output: Option<PathBuf>,
    /// Stop after N alternatives for each rule (exit status 3).
    #[arg(long, value_name = "N", default_value_t = ALTERNATIVES, requires = "rules", value_parser = number_in(1..=u64::MAX))]
    alternatives: u64,
    /// Seed for path planning in a mission.
    #[arg(long, default_value_t = 0, requires = "rules", value_parser = seed)]
    seed: u64,
    /// Plant model [default: the one that the program file declares].
    #[arg(long, value_name = "M.rmpl")]
    model: Option<PathBuf>,
    /// Property to prove, such as "never A=On AND B=On" (repeatable) [default: five checks].
    #[arg(long, value_name = "PROPERTY")]
    property: Vec<String>,
    /// Let components fail at most N times in a run.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = number_in(0..=u32::MAX))]
    faults: u32,
    /// Information that the program has about its plant.
    #[arg(long, value_enum, default_value_t)]
    knowledge: KnowledgeArg,
    /// Stop after N states (exit status 3).
    #[arg(long, value_name = "N", default_value_t = 200_000, value_parser = positive_number)]
    states: u32,
    /// Explore runs of at most N steps [default: no limit].
    #[arg(long, value_name = "N", value_parser = number_in(0..=u32::MAX))]
    steps: Option<u32>,
    /// Also compute the probability that the program ends within N steps.
    #[arg(long, value_name = "N", value_parser = number_in(0..=u32::MAX))]
    chance: Option<u32>,
    #[command(flatten)]
    time_limit: TimeLimit,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// What is asked of control programs only.
const PROGRAM_OPTIONS: [&str; 7] = ["model", "property", "faults", "knowledge", "states", "steps", "chance"];

/// In each step, this many of the most likely places of a run are followed; the others leave its probability open.
const MAX_PLACES: usize = 20_000;

const ABOUT_MISSIONS: &str =
    "save the program of its `control` block in a file of its own, or prove flight rules with --rules";

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let deadline = args.time_limit.start();
    if let Some(rules) = &args.rules {
        let target =
            Target { file: args.file.clone(), scenario: args.scenario.clone(), activity: None, bounds: None };
        let call = Call {
            target: &target,
            rules,
            output: args.output.as_deref(),
            alternatives: args.alternatives,
            seed: args.seed,
            format: args.format,
        };
        return prove_rules::run(&call, deadline);
    }
    let (system, mut problems) = read_system(&args.file, args.model.as_deref(), args.format, ABOUT_MISSIONS)?;
    let Some(system) = &system else {
        if args.format == Format::Json {
            print_json(&document("prove", &problems, json!({})))?;
        }
        return Ok(exit(WRONG));
    };
    let read = |text: &String| Property::read(text, system).map_err(|error| anyhow!("--property: {error}"));
    let mut properties: Vec<Property> = args.property.iter().map(read).collect::<Result<_, _>>()?;
    if properties.is_empty() {
        properties.extend(DEFAULTS);
    }
    let knowledge = args.knowledge.into();
    let steps = args.steps.unwrap_or(u32::MAX);
    let scope = Scope { faults: args.faults, knowledge, states: args.states as usize, steps };
    let proof = prove(system, &properties, scope, &mut |_| !deadline.is_over())?;
    let chance = match args.chance {
        Some(steps) => Some((steps, chance_to_end(system, knowledge, steps, MAX_PLACES)?)),
        None => None,
    };
    let is = |verdict: fn(&Verdict) -> bool| proof.verdicts.iter().any(|(_, it)| verdict(it));
    let status = if is(|it| matches!(it, Verdict::Broken(_) | Verdict::Never(_))) {
        NO
    } else if is(|it| *it == Verdict::Open) {
        LIMIT
    } else {
        YES
    };
    match args.format {
        Format::Json => {
            if status == LIMIT {
                let why = proof.stopped.as_deref().unwrap_or("a limit was reached");
                problems.push(failure(E_LIMIT, &format!("not all states were explored: {why}")));
            }
            let verdicts = proof
                .verdicts
                .iter()
                .map(|(property, verdict)| verdict_json(property, verdict, &system.model));
            let chance = chance.as_ref().map(|(steps, interval)| {
                let (low, high) = interval.to_f64();
                json!({ "steps": steps, "ends": [low, high] })
            });
            let body = json!({
                "states": proof.states,
                "transitions": proof.transitions,
                "depth": proof.depth,
                "stopped": proof.stopped,
                "properties": verdicts.collect::<Vec<_>>(),
                "chance": chance,
            });
            print_json(&document("prove", &problems, body))?;
        }
        Format::Text => print_text(&text(args, system, &proof, chance.as_ref()))?,
    }
    Ok(exit(status))
}

fn move_json(by: &Move, model: &Model) -> Value {
    let modes: Map<String, Value> =
        by.named(model).map(|(name, mode)| (name.to_owned(), json!(mode))).collect();
    let observed: Map<String, Value> =
        by.shown(model).map(|(name, value)| (name.to_owned(), json!(value))).collect();
    json!({ "modes": modes, "observed": observed, "choices": by.choices })
}

fn verdict_json(property: &Property, verdict: &Verdict, model: &Model) -> Value {
    let property = property.to_string();
    match verdict {
        Verdict::Holds => json!({ "property": property, "verdict": "holds" }),
        Verdict::Open => json!({ "property": property, "verdict": "open" }),
        Verdict::Never(what) => json!({ "property": property, "verdict": "broken", "never": what }),
        Verdict::Broken(run) => json!({
            "property": property,
            "verdict": "broken",
            "run": {
                "start": move_json(&run.start, model),
                "steps": run.moves.iter().map(|by| move_json(by, model)).collect::<Vec<_>>(),
                "repeats_after": run.repeats_after,
                "goes_on_for": run.goes_on_for,
            },
        }),
    }
}

fn text(args: &Args, system: &Arc<System>, proof: &Proof, chance: Option<&(u32, Interval)>) -> String {
    let faults = match args.faults {
        0 => "no component fails".to_owned(),
        some => format!("at most {}", counted(some as usize, "fault")),
    };
    let mut out = format!(
        "Explored {} and {}, with {faults}.\n",
        counted(proof.states, "state"),
        counted(proof.transitions, "transition")
    );
    if let Some(stopped) = &proof.stopped {
        out.push_str(&format!("Not all states were explored: {stopped}.\n"));
    }
    for (property, verdict) in &proof.verdicts {
        match verdict {
            Verdict::Holds => out.push_str(&format!("holds      {property}\n")),
            Verdict::Open => out.push_str(&format!(
                "open       {property}: no counterexample in the states explored, up to {}\n",
                counted(proof.depth as usize, "step")
            )),
            Verdict::Never(what) => {
                out.push_str(&format!("broken     {property}\n"));
                out.extend(what.iter().map(|what| format!("  never    {what}\n")));
            }
            Verdict::Broken(run) => {
                out.push_str(&format!("broken     {property}\n"));
                out.push_str(&run_text(args, system, run));
            }
        }
    }
    if let Some((steps, interval)) = chance {
        let (low, high) = interval.decimals();
        let value = if low == high { low } else { format!("{low} to {high}") };
        let steps = counted(*steps as usize, "step");
        out.push_str(&format!("chance     the program ends within {steps}: {value}\n"));
    }
    out
}

fn run_text(args: &Args, system: &Arc<System>, run: &Counterexample) -> String {
    let model = &system.model;
    let mut out = String::new();
    let shown = |by: &Move| -> String {
        let modes = by.named(model).map(|(name, mode)| format!("{name}={mode}"));
        let choices = by.choices.iter().map(|choice| format!("alternative {}", choice + 1));
        let seen = by.shown(model).map(|(name, value)| format!("{name}={value} observed"));
        modes.chain(seen).chain(choices).collect::<Vec<_>>().join(", ")
    };
    let start = shown(&run.start);
    if !start.is_empty() {
        out.push_str(&format!("  start    {start}\n"));
    }
    let mut flags = String::new();
    for (number, by) in (1..).zip(&run.moves) {
        if *by != Move::default() {
            out.push_str(&format!("  step {number:<3} {}\n", shown(by)));
        }
        for (name, mode) in by.named(model) {
            flags.push_str(&format!(" --inject {number}:{name}={mode}"));
        }
        for (name, value) in by.shown(model) {
            flags.push_str(&format!(" --observe {number}:{name}={value}"));
        }
    }
    out.push_str(&format!("  end      {}\n", run.ending()));
    let is_repeatable = run.start == Move::default() && run.moves.iter().all(|by| by.choices.is_empty());
    if is_repeatable && let Some(active) = active_at_end(args, system, run) {
        out.push_str(&active);
        let file = in_shell(&args.file);
        let model =
            args.model.as_ref().map_or_else(String::new, |path| format!(" --model {}", in_shell(path)));
        let knowledge = if args.knowledge == KnowledgeArg::Perfect { " --knowledge perfect" } else { "" };
        out.push_str(&format!(
            "  repeat   enroute run {file}{model}{knowledge}{flags} --steps {}\n",
            run.moves.len().max(1)
        ));
    }
    out
}

/// A path as a shell takes it.
fn in_shell(path: &Path) -> String {
    let path = path.display().to_string();
    shlex::try_quote(&path).map_or_else(|_| path.clone(), Into::into)
}

/// The locations that are still active at the end of the run, which is repeated for it.
fn active_at_end(args: &Args, system: &Arc<System>, counterexample: &Counterexample) -> Option<String> {
    let options = Options { knowledge: args.knowledge.into(), ..Options::default() };
    let mut run = Run::new(system, options);
    for by in &counterexample.moves {
        if run.status() != RunStatus::Running {
            break;
        }
        let (injected, observed) =
            (by.modes.iter().copied().collect(), by.observed.iter().copied().collect());
        let input = StepInput { injected, observed };
        run.step(&input).ok()?;
    }
    Some(run.upcoming().labels.iter().map(|label| format!("  active   {label}\n")).collect())
}
