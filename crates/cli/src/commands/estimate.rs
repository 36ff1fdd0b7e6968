//! `enroute estimate`: one belief update.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context as _, anyhow};
use plant::bounded::MAX_STATES;
use plant::{Belief, EstimateError, Model, State, conflicts, update_best, update_exact};
use serde::Deserialize;
use serde_json::{Value, json};
use snapshot::Problem;

use super::run::probability_json;
use crate::diagnostics::print_problems;
use crate::input::{read_control, read_json};
use crate::number::positive_number;
use crate::output::{
    E_LIMIT, Format, LIMIT, NO, WRONG, YES, document, exit, failure, print_json, print_text,
};

/// The search for likely states gives up after this many nodes.
const MAX_NODES: u32 = 1_000_000;

/// Update the belief about a plant after commands and observations.
#[derive(clap::Args)]
#[command(override_usage = "\
enroute estimate [OPTIONS] --commands <C.json> --observations <O.json>\n                        <MODEL>")]
pub struct Args {
    /// Plant model; - reads standard input.
    model: PathBuf,
    /// Belief before: [{"state":{component:mode…}, "probability":"p/q"}…] [default: INIT of the model].
    #[arg(long, value_name = "P.json")]
    prior: Option<PathBuf>,
    /// Commands: {component:command}; an absent component gets its idle command.
    #[arg(long, value_name = "C.json")]
    commands: PathBuf,
    /// Observations: {"EngineA.thrust":"full"}.
    #[arg(long, value_name = "O.json")]
    observations: PathBuf,
    /// Find only the K most likely states [default: all].
    #[arg(long, value_name = "K", value_parser = positive_number)]
    k: Option<u32>,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

#[derive(Deserialize)]
struct Believed {
    state: BTreeMap<String, String>,
    probability: Value,
}

/// The names of a JSON object of strings; `null` represents nothing.
fn names(given: &BTreeMap<String, Option<String>>) -> impl Iterator<Item = (&str, &str)> {
    given.iter().filter_map(|(name, value)| Some((name.as_str(), value.as_deref()?)))
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let Some((model, mut problems)) = load_model(&args.model, args.format, "estimate")? else {
        return Ok(exit(WRONG));
    };
    let prior = match &args.prior {
        Some(path) => prior(&model, &read_json::<Vec<Believed>>(path)?)
            .with_context(|| format!("{} is not a belief about this plant", path.display()))?,
        None => Belief::initial(&model, MAX_STATES).filter(Belief::is_exact).with_context(|| {
            format!("the plant may start in more than {MAX_STATES} states: name the likely ones with --prior")
        })?,
    };
    let given: BTreeMap<String, Option<String>> = read_json(&args.commands)?;
    let commands = model.commands_from_names(names(&given)).map_err(|error| anyhow!(error))?;
    let given: BTreeMap<String, Option<String>> = read_json(&args.observations)?;
    let observation = model.observation_from_names(names(&given)).map_err(|error| anyhow!(error))?;
    let result = match args.k {
        None => update_exact(&model, &prior, &commands, &observation).map(|belief| (belief, false)),
        Some(most) => update_best(&model, &prior, &commands, &observation, most as usize, MAX_NODES)
            .map(|(belief, statistics)| (belief, statistics.limit_reached)),
    };
    let (posterior, limit_reached) = match result {
        Ok((belief, limit_reached)) => (Some(belief), limit_reached),
        Err(EstimateError::Unexplained) => (None, false),
        Err(error @ EstimateError::TooMany(_)) => {
            return Err(anyhow!(error).context("to find only the 100 most likely states, add --k 100"));
        }
        Err(error) => return Err(error.into()),
    };
    let why = conflicts(&model, prior.most_likely(), &commands, &observation, 8)?;
    let why: Vec<String> = why.iter().map(|conflict| conflict.describe(&model)).collect();
    match args.format {
        Format::Json => {
            let body = json!({
                "posterior": posterior.as_ref().map_or_else(|| json!([]), |belief| belief_json(&model, belief)),
                "conflicts": why,
            });
            if limit_reached {
                problems.push(failure(E_LIMIT, "the search for likely states stopped at its limit"));
            }
            print_json(&document("estimate", &problems, body))?;
        }
        Format::Text => print_text(&belief_text(&model, posterior.as_ref(), &why))?,
    }
    Ok(exit(match posterior {
        None => NO,
        Some(_) if limit_reached => LIMIT,
        Some(_) => YES,
    }))
}

/// The model of a file; `None` after having reported what is wrong with it.
pub fn load_model(
    path: &std::path::Path,
    format: Format,
    kind: &str,
) -> anyhow::Result<Option<(Model, Vec<Problem>)>> {
    let source = read_control(path, "this command expects a plant model")?;
    let parsed = rmpl::control::parse(&source);
    let (model, found) = if parsed.has_errors() { (None, Vec::new()) } else { plant::compile(&parsed.file) };
    let mut diagnostics = parsed.diagnostics;
    diagnostics.extend(found);
    if model.is_none() && diagnostics.is_empty() {
        diagnostics.push(
            rmpl::Diagnostic::error(
                rmpl::Code("E-UNDEF"),
                rmpl::Span::default(),
                "the model declares no component",
            )
            .with_hint("declare components by DEFCLASS and DEFINSTANCE"),
        );
    }
    let problems = Problem::all(&diagnostics, &source);
    if format == Format::Text {
        print_problems(&path.display().to_string(), &source, &problems)?;
    } else if model.is_none() {
        print_json(&document(kind, &problems, json!({})))?;
    }
    Ok(model.map(|model| (model, problems)))
}

fn prior(model: &Model, given: &[Believed]) -> anyhow::Result<Belief> {
    let mut states: Vec<(State, plant::Probability)> = Vec::new();
    for believed in given {
        let modes = believed.state.iter().map(|(name, mode)| (name.as_str(), mode.as_str()));
        let state = model.state_from_names(modes).map_err(|error| anyhow!(error))?;
        let text = match &believed.probability {
            Value::String(text) => text.clone(),
            other => other.to_string(),
        };
        let probability = plant::probability::parse_exact(&text).ok_or_else(|| {
            anyhow!("`{text}` is not a probability; write a decimal or a fraction, as in \"396/397\"")
        })?;
        states.push((state, probability));
    }
    Belief::from_probabilities(states)
        .context("every state has probability 0; at least one needs a probability above 0")
}

fn belief_json(model: &Model, belief: &Belief) -> Value {
    let states = belief.states();
    states
        .map(|(state, probability)| json!({ "state": model.state_names(state), "probability": probability_json(&probability) }))
        .collect()
}

fn belief_text(model: &Model, belief: Option<&Belief>, why: &[String]) -> String {
    let mut out = String::new();
    match belief {
        None => out.push_str("No state of the prior belief explains the observations.\n"),
        Some(belief) => {
            for (state, probability) in belief.states() {
                out.push_str(&format!("{probability}  {}\n", model.describe(state)));
            }
        }
    }
    for conflict in why {
        out.push_str(&format!("because {conflict}\n"));
    }
    out
}
