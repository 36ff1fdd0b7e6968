//! `enroute run`: a control program in a closed loop with a simulated plant.

use exact::counted;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::{anyhow, bail};
use executive::model_based::{
    Knowledge, Options, ProgramTally, Run, RunStatus, StepInput, StepOutcome, StepRecord, System, Trials,
    run_seed, sample,
};
use hca::{Automaton, TraceStep};
use plant::{Interval, State};
use serde_json::{Map, Value, json};
use snapshot::Problem;

use crate::diagnostics::print_problems;
use crate::input::read_control;
use crate::number::{number_in, positive_number, seed};
use crate::output::{
    E_LIMIT, Format, LIMIT, NO, WRONG, YES, document, exit, failure, print_json, print_text,
};

/// So many states before a step may be named as those that states come from.
const MAX_BEFORE: usize = 64;

/// Run a control program in a closed loop with a simulated plant.
#[derive(clap::Args)]
pub struct Args {
    /// Control program; - reads standard input.
    file: PathBuf,
    /// Plant model [default: the one that the program file declares].
    #[arg(long, value_name = "M.rmpl")]
    model: Option<PathBuf>,
    /// Stop after N steps (exit status 3).
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = positive_number)]
    steps: u32,
    /// Put a component into a mode at a step, as in 3:EngineA=Failed. Repeatable.
    #[arg(long, value_name = "STEP:COMPONENT=MODE")]
    inject: Vec<String>,
    /// Observe a value at a step, as in 3:EngineA.thrust=zero. Repeatable.
    #[arg(long, value_name = "STEP:VARIABLE=VALUE")]
    observe: Vec<String>,
    /// Inject random faults, using this seed.
    #[arg(long, alias = "seed", value_name = "SEED", value_parser = seed)]
    fault_seed: Option<u64>,
    /// Track only the K most likely states of each group of components.
    #[arg(long, value_name = "K", value_parser = positive_number)]
    k: Option<u32>,
    /// Information that the program has about its plant.
    #[arg(long, value_enum, default_value_t)]
    knowledge: KnowledgeArg,
    /// Show where states come from, and what observations ruled out.
    #[arg(long)]
    trajectories: bool,
    /// Run N times with random faults and report the success rate.
    #[arg(long, value_name = "N", value_parser = number_in(1..=u64::MAX))]
    monte_carlo: Option<u64>,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// What a program knows of its plant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum KnowledgeArg {
    /// Estimates from commands and observations.
    #[default]
    Estimated,
    /// The true modes of all components.
    Perfect,
}

impl From<KnowledgeArg> for Knowledge {
    fn from(arg: KnowledgeArg) -> Self {
        match arg {
            KnowledgeArg::Estimated => Self::Estimated,
            KnowledgeArg::Perfect => Self::Perfect,
        }
    }
}

/// Compiles a program with its plant, and prints their problems if the output is text. If a file is a mission, the error says
/// so and ends with `about_missions`.
pub(super) fn read_system(
    file: &Path,
    model_file: Option<&Path>,
    format: Format,
    about_missions: &'static str,
) -> anyhow::Result<(Option<Arc<System>>, Vec<Problem>)> {
    let source = read_control(file, about_missions)?;
    let read_model = |path| read_control(path, "--model expects a plant model");
    let model = model_file.map(read_model).transpose()?;
    let compilation = System::compile(&source, model.as_deref());
    let mut problems = Problem::all(&compilation.program_diagnostics, &source);
    let model_problems = Problem::all(&compilation.model_diagnostics, model.as_deref().unwrap_or(""));
    if format == Format::Text {
        print_problems(&file.display().to_string(), &source, &problems)?;
        if let (Some(path), Some(text)) = (model_file, &model) {
            print_problems(&path.display().to_string(), text, &model_problems)?;
        }
    }
    problems.extend(model_problems);
    Ok((compilation.system, problems))
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let (system, mut problems) =
        read_system(&args.file, args.model.as_deref(), args.format, "use `enroute simulate`")?;
    let Some(system) = &system else {
        if args.format == Format::Json {
            print_json(&document("run", &problems, json!({})))?;
        }
        return Ok(exit(WRONG));
    };
    let options = Options {
        most_states: args.k.map(|count| count as usize),
        seed: args.fault_seed,
        knowledge: args.knowledge.into(),
    };
    let inputs = inputs(system, args)?;
    if let Some(runs) = args.monte_carlo {
        let seed = args.fault_seed.unwrap_or(0);
        let trials = Trials { options, seed, most_steps: args.steps, inputs: &inputs };
        return chance(args, system, &trials, runs, &problems);
    }
    let mut run = Run::new(system, options);
    while run.status() == RunStatus::Running && run.records().len() < args.steps as usize {
        let step = run.records().len() as u32 + 1;
        run.step(inputs.get(&step).unwrap_or(&StepInput::default()))?;
    }
    match args.format {
        Format::Json => {
            problems.extend(limit_of(&run).map(|why| failure(E_LIMIT, &why)));
            print_json(&document("run", &problems, run_json(system, &run, args.trajectories)))?;
        }
        Format::Text => print_text(&run_text(system, &run, args.trajectories))?,
    }
    Ok(exit(match run.status() {
        RunStatus::Ended => YES,
        RunStatus::Refuted | RunStatus::Deadlock => NO,
        RunStatus::Running | RunStatus::LimitReached => LIMIT,
    }))
}

/// Returns which limit ended a run, in a sentence without an end.
fn limit_of(run: &Run) -> Option<String> {
    match run.status() {
        RunStatus::Ended | RunStatus::Refuted | RunStatus::Deadlock => None,
        RunStatus::Running => {
            Some(format!("the program did not end within {}", counted(run.records().len(), "step")))
        }
        RunStatus::LimitReached => Some("the estimate has more states than its limit".to_owned()),
    }
}

/// The faults and observations of the arguments, by step.
fn inputs(system: &System, args: &Args) -> anyhow::Result<BTreeMap<u32, StepInput>> {
    let model = &system.model;
    let mut inputs: BTreeMap<u32, StepInput> = BTreeMap::new();
    for text in &args.inject {
        let (step, component, mode) = at_step("--inject STEP:COMPONENT=MODE", "3:EngineA=Failed", text)?;
        let (component, mode) = model.component_mode(component, mode).map_err(|error| anyhow!(error))?;
        inputs.entry(step).or_default().injected.insert(component, mode);
    }
    for text in &args.observe {
        let (step, name, value) = at_step("--observe STEP:VARIABLE=VALUE", "3:EngineA.thrust=zero", text)?;
        let observed = model.observation_from_names([(name, value)]).map_err(|error| anyhow!(error))?;
        inputs.entry(step).or_default().observed.extend(observed.0);
    }
    Ok(inputs)
}

/// Reads `STEP:NAME=VALUE`.
fn at_step<'text>(
    usage: &str,
    example: &str,
    text: &'text str,
) -> anyhow::Result<(u32, &'text str, &'text str)> {
    let parts = text.split_once(':').and_then(|(step, rest)| {
        let (name, value) = rest.split_once('=')?;
        Some((step.trim().parse().ok()?, name.trim(), value.trim()))
    });
    let Some((step, name, value)) = parts else {
        bail!("expected {usage}, as in {example}, not `{text}`");
    };
    if step == 0 {
        bail!("steps count from 1, so step 0 in `{text}` does not exist");
    }
    Ok((step, name, value))
}

fn chance(
    args: &Args,
    system: &Arc<System>,
    trials: &Trials<'_>,
    runs: u64,
    problems: &[Problem],
) -> anyhow::Result<ExitCode> {
    let tally = sample(system, trials, 0..runs, &mut || true)?;
    match args.format {
        Format::Json => {
            let (low, high) = tally.interval();
            let faults = tally.faults.iter().map(|(fault, tally)| {
                let members = json!({ "runs": tally.runs, "reached": tally.reached });
                (fault.to_string(), members)
            });
            let body = json!({
                "runs": tally.runs,
                "reached": tally.reached,
                "probability": tally.probability(),
                "interval": [low, high],
                "mean_steps": tally.mean_steps(),
                "ends": tally.ends,
                "faults": faults.collect::<Map<_, _>>(),
                "stuck": tally.stuck,
                "refuted": tally.refuted,
                "stuck_seed": tally.first_stuck.map(|number| run_seed(trials.seed, number)),
            });
            print_json(&document("run", problems, body))?;
        }
        Format::Text => print_text(&tally_text(&tally, trials.seed))?,
    }
    Ok(exit(YES))
}

fn tally_text(tally: &ProgramTally, seed: u64) -> String {
    let (low, high) = tally.interval();
    let mut out = format!(
        "{} of {} runs reached the program's end: {:.4} (95% confidence: {low:.4} to {high:.4}), after {:.1} steps on average\n",
        tally.reached,
        tally.runs,
        tally.probability(),
        tally.mean_steps()
    );
    for (fault, tally) in &tally.faults {
        out.push_str(&format!(
            "  {fault} in {}, {} of which reached the end\n",
            counted(tally.runs, "run"),
            tally.reached
        ));
    }
    for (label, runs) in &tally.stuck {
        out.push_str(&format!("  still active in {}: {label}\n", counted(*runs, "run")));
    }
    if tally.refuted > 0 {
        out.push_str(&format!("  observations refuted the belief in {}\n", counted(tally.refuted, "run")));
    }
    if let Some(number) = tally.first_stuck {
        let seed = run_seed(seed, number);
        out.push_str(&format!("To repeat the first run that did not end, add --fault-seed {seed}.\n"));
    }
    out
}

fn goals_json(goals: &[smol_str::SmolStr]) -> Value {
    let mut members = Map::new();
    for goal in goals {
        let is_equality = !goal.starts_with('(');
        let (name, value) = goal.split_once('=').filter(|_| is_equality).unwrap_or((goal, "true"));
        match members.get_mut(name) {
            // Contradicting goals for one variable are both shown.
            Some(Value::String(known)) => known.push_str(&format!(" and {value}")),
            _ => {
                members.insert(name.to_owned(), json!(value));
            }
        }
    }
    Value::Object(members)
}

fn counts_rewards(automaton: &Automaton) -> bool {
    automaton.locations.iter().any(|location| location.reward.is_some())
        || automaton.choices.iter().any(|choice| choice.rewards().is_some())
}

/// The clocks that run before a step, each with the number of steps after which it is up.
pub(super) fn clocks_json(automaton: &Automaton, trace: &TraceStep) -> Value {
    let clocks = trace
        .clocks
        .iter()
        .filter_map(|&(id, left)| Some(json!({ "clock": automaton.clock(id)?.label, "steps_left": left })));
    clocks.collect()
}

/// The clocks that were up in a step.
pub(super) fn elapsed<'a>(automaton: &'a Automaton, trace: &TraceStep) -> Vec<&'a str> {
    trace.elapsed.iter().filter_map(|&id| Some(automaton.clock(id)?.label.as_str())).collect()
}

/// How the belief after a step came from the one before it, in words.
struct Trajectories {
    /// Each state with its probability and the state that it most likely comes from.
    kept: Vec<(String, Interval, String)>,
    /// Each with its probability before the observation, and what contradicts it.
    ruled_out: Vec<(String, Option<Interval>, String)>,
    dropped: Interval,
}

fn trajectories(system: &System, run: &Run, number: usize) -> Option<Trajectories> {
    let model = &system.model;
    let (record, branches) = (run.records().get(number)?, run.branches(number)?);
    let before: Vec<State> =
        run.belief_before(number)?.states().take(MAX_BEFORE).map(|(state, _)| state).collect();
    let likeliest = before.first()?;
    let named = |state: &State, known: &State| {
        if state == known { "most likely".to_owned() } else { model.differences(known, state) }
    };
    let after = record.belief.most_likely();
    let kept = record.belief.states().zip(&branches.kept).map(|((state, probability), branch)| {
        let from = branch.from.and_then(|from| before.get(from));
        (named(&state, after), probability, from.map_or_else(String::new, |from| named(from, likeliest)))
    });
    let ruled_out = branches.ruled_out.iter().map(|ended| {
        let changes = ended.changes(model, before.get(ended.from).unwrap_or(likeliest));
        (changes, ended.probability.clone(), ended.reasons(model, &record.observation))
    });
    Some(Trajectories {
        kept: kept.collect(),
        ruled_out: ruled_out.collect(),
        dropped: branches.dropped.clone(),
    })
}

impl Trajectories {
    fn text(&self, out: &mut String) {
        for (state, probability, from) in &self.kept {
            out.push_str(&format!("  kept      {state} ({probability}), from {from}\n"));
        }
        for (changes, probability, by) in &self.ruled_out {
            let probability = probability.as_ref().map_or_else(String::new, |it| format!(" ({it})"));
            out.push_str(&format!("  ruled out {changes}{probability} by {by}\n"));
        }
        if self.dropped.exact().is_none() {
            out.push_str(&format!("  dropped   at most {}\n", self.dropped.decimals().1));
        }
    }

    fn json(&self) -> Value {
        let kept = self.kept.iter().map(|(state, probability, from)| {
            json!({ "state": state, "probability": probability_json(probability), "from": from })
        });
        let ruled_out = self.ruled_out.iter().map(|(changes, probability, by)| {
            json!({ "changes": changes, "probability": probability.as_ref().map(probability_json), "by": by })
        });
        json!({
            "kept": kept.collect::<Vec<_>>(),
            "ruled_out": ruled_out.collect::<Vec<_>>(),
            "dropped": self.dropped.decimals().1,
        })
    }
}

/// One line per running clock.
pub(super) fn clocks_text(automaton: &Automaton, trace: &TraceStep, out: &mut String) {
    for &(id, left) in &trace.clocks {
        let Some(clock) = automaton.clock(id) else { continue };
        let steps = if left == 1 { "step" } else { "steps" };
        out.push_str(&format!("  clock     {}: {left} {steps} left\n", clock.label));
    }
}

fn failed_text(system: &System, id: plant::ComponentId, mode: u8) -> String {
    let name = system.model.component(id).map_or("?", |component| component.name.as_str());
    format!("{name}={}", system.model.mode_name(id, mode))
}

fn step_json(system: &System, record: &StepRecord) -> Value {
    let model = &system.model;
    let mut step = json!({
        "step": record.trace.step,
        "marked": record.trace.labels,
        "goals": goals_json(&record.trace.goals),
        "commands": model.command_names(&record.commands),
        "unachievable": record.unachievable.iter().map(|(goal, _)| goal).collect::<Vec<_>>(),
        "reasons": record.unachievable.iter().map(|(goal, reason)| json!({ "goal": goal, "reason": reason })).collect::<Vec<_>>(),
        "observations": model.observation_names(&record.observation),
        "failed": record.failed.iter().map(|&(id, mode)| failed_text(system, id, mode)).collect::<Vec<_>>(),
        "true_state": model.state_names(&record.true_state),
        "uncertain": record.is_uncertain,
        "conflicts": record.conflicts.iter().map(|conflict| conflict.describe(model)).collect::<Vec<_>>(),
    });
    let members = match &record.outcome {
        StepOutcome::Explained => [
            ("estimate", json!(model.state_names(record.belief.most_likely()))),
            ("probability", probability_json(&record.belief.highest_probability())),
        ],
        StepOutcome::Refuted { conflict } => {
            [("refuted", json!(true)), ("unexplained", json!(model.observation_names(conflict)))]
        }
        // Whether it is refuted is not known.
        StepOutcome::LimitReached => {
            [("refuted", Value::Null), ("unexplained", json!(model.observation_names(&record.observation)))]
        }
    };
    if let Value::Object(step) = &mut step {
        step.extend(members.map(|(name, value)| (name.to_owned(), value)));
        if let Some(state) = &record.planned_from {
            step.insert("planned_from".to_owned(), json!(model.state_names(state)));
        }
        if !system.automaton.clocks.is_empty() {
            step.insert("clocks".to_owned(), clocks_json(&system.automaton, &record.trace));
            step.insert("elapsed".to_owned(), json!(elapsed(&system.automaton, &record.trace)));
        }
        if !system.automaton.locks.is_empty() {
            step.insert("locks".to_owned(), json!(record.trace.locks));
        }
        if !record.chosen.is_empty() {
            let chosen = record.chosen.iter().map(|made| {
                json!({
                    "choice": made.label,
                    "alternative": made.alternative + 1,
                    "expected": made.expected,
                    "horizon": made.horizon,
                    "shortened": made.is_shortened,
                })
            });
            step.insert("chosen".to_owned(), chosen.collect());
        }
        if system.entailment.is_some() {
            let asked = record.asked.iter().map(|asked| {
                json!({
                    "condition": asked.condition,
                    "probability": probability_json(&asked.probability),
                    "entailed": asked.is_entailed,
                })
            });
            step.insert("asked".to_owned(), asked.collect());
        }
    }
    step
}

/// An exact fraction, or the limits between which the probability is known to be.
pub(super) fn probability_json(probability: &Interval) -> Value {
    if probability.exact().is_some() {
        return json!(probability.to_string());
    }
    let (low, high) = probability.decimals();
    json!([low, high])
}

const fn status_name(status: RunStatus) -> &'static str {
    match status {
        RunStatus::Running => "running",
        RunStatus::Ended => "ended",
        RunStatus::Refuted => "refuted",
        RunStatus::LimitReached => "limit",
        RunStatus::Deadlock => "deadlock",
    }
}

fn run_json(system: &System, run: &Run, has_trajectories: bool) -> Value {
    let mut steps: Vec<Value> = run.records().iter().map(|record| step_json(system, record)).collect();
    if has_trajectories {
        for (number, step) in steps.iter_mut().enumerate() {
            if let (Value::Object(step), Some(trajectories)) = (step, trajectories(system, run, number)) {
                step.insert("trajectories".to_owned(), trajectories.json());
            }
        }
    }
    let last = run.upcoming();
    steps.push(json!({ "step": last.step, "marked": last.labels }));
    let mut body =
        json!({ "steps": steps, "terminated": run.is_done(), "status": status_name(run.status()) });
    if let Value::Object(body) = &mut body {
        if run.status() == RunStatus::Deadlock {
            body.insert("deadlock".to_owned(), json!(run.deadlock()));
        }
        if counts_rewards(&system.automaton) {
            body.insert("reward".to_owned(), json!(run.reward()));
        }
    }
    body
}

fn run_text(system: &System, run: &Run, has_trajectories: bool) -> String {
    let model = &system.model;
    let listed = |names: BTreeMap<String, String>, joint: &str| {
        let names: Vec<String> =
            names.into_iter().map(|(name, value)| format!("{name}{joint}{value}")).collect();
        if names.is_empty() { "–".to_owned() } else { names.join(", ") }
    };
    let mut out = String::new();
    for (number, record) in run.records().iter().enumerate() {
        out.push_str(&format!("step {}\n", record.trace.step));
        record.trace.labels.iter().for_each(|label| out.push_str(&format!("  active    {label}\n")));
        for made in &record.chosen {
            out.push_str(&format!("  chose     {}\n", made.describe()));
        }
        clocks_text(&system.automaton, &record.trace, &mut out);
        record.trace.locks.iter().for_each(|lock| out.push_str(&format!("  locked    {lock}\n")));
        out.push_str(&format!("  commands  {}\n", listed(model.command_names(&record.commands), ".")));
        if let Some(state) = &record.planned_from {
            out.push_str(&format!("  planned   from {}\n", listed(model.state_names(state), "=")));
        }
        for &(id, mode) in &record.failed {
            out.push_str(&format!("  fault     {}\n", failed_text(system, id, mode)));
        }
        for (goal, reason) in &record.unachievable {
            out.push_str(&format!("  unmet     {goal}: {reason}\n"));
        }
        out.push_str(&format!("  observed  {}\n", listed(model.observation_names(&record.observation), "=")));
        match &record.outcome {
            StepOutcome::Explained => out.push_str(&format!(
                "  estimate  {} ({})\n",
                listed(model.state_names(record.belief.most_likely()), "="),
                record.belief.highest_probability()
            )),
            StepOutcome::Refuted { conflict } => {
                let conflict = listed(model.observation_names(conflict), "=");
                out.push_str(&format!("  refuted   no state of the plant explains {conflict}\n"));
            }
            StepOutcome::LimitReached => {
                out.push_str("  limit     no state that the estimator kept explains the observations\n");
            }
        }
        let shown = has_trajectories.then(|| trajectories(system, run, number)).flatten();
        if let Some(trajectories) = shown {
            trajectories.text(&mut out);
        }
        for asked in &record.asked {
            let word = if asked.is_entailed { "known    " } else { "not known" };
            out.push_str(&format!("  {word} {} ({})\n", asked.condition, asked.probability));
        }
        if record.is_uncertain {
            out.push_str("  uncertain more states are possible than the estimator keeps\n");
        }
        for label in elapsed(&system.automaton, &record.trace) {
            out.push_str(&format!("  elapsed   {label}\n"));
        }
        record
            .conflicts
            .iter()
            .for_each(|conflict| out.push_str(&format!("  conflict  {}\n", conflict.describe(model))));
    }
    if counts_rewards(&system.automaton) {
        out.push_str(&format!("Rewards: {}.\n", run.reward()));
    }
    if run.status() == RunStatus::Deadlock {
        out.push_str(&format!("Deadlock: {}.\n", run.deadlock().join(", ")));
    }
    if run.is_done() {
        out.push_str(&format!("The program ended after {}.\n", counted(run.records().len(), "step")));
    } else {
        out.push_str(match run.status() {
            RunStatus::Refuted => "The belief is refuted, so the run ends. Still active:\n",
            RunStatus::LimitReached => "State limit reached. Still active:\n",
            RunStatus::Deadlock => "Locks wait for each other, so the run ends. Still active:\n",
            RunStatus::Running | RunStatus::Ended => "Step limit reached. Still active:\n",
        });
        run.upcoming().labels.iter().for_each(|label| out.push_str(&format!("  {label}\n")));
    }
    out
}
