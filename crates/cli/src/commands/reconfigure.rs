//! `enroute reconfigure`: the commands that bring a plant from a state to a goal.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::anyhow;
use plant::{Goal, Model, Planner, Unreachable};
use serde_json::{Value, json};

use super::estimate::load_model;
use crate::input::read_json;
use crate::output::{self, E_LIMIT, Format, LIMIT, NO, WRONG, YES, document, exit, print_json, print_text};

/// Find commands that take a plant from a state to a goal.
#[derive(clap::Args)]
pub struct Args {
    /// Plant model; - reads standard input.
    model: PathBuf,
    /// State: {component:mode}; an absent component is in its initial mode.
    #[arg(long, value_name = "S.json")]
    state: PathBuf,
    /// Goal: {component:mode}.
    #[arg(long, value_name = "G.json")]
    goal: PathBuf,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let Some((model, mut problems)) = load_model(&args.model, args.format, "reconfigure")? else {
        return Ok(exit(WRONG));
    };
    let state: BTreeMap<String, String> = read_json(&args.state)?;
    let state = state.iter().map(|(name, mode)| (name.as_str(), mode.as_str()));
    let state = model.state_from_names(state).map_err(|error| anyhow!(error))?;
    let goal: BTreeMap<String, String> = read_json(&args.goal)?;
    let mut goals = Vec::new();
    for (name, mode) in &goal {
        let (component, mode) = model.component_mode(name, mode).map_err(|error| anyhow!(error))?;
        goals.push(Goal::mode(component, mode));
    }
    let (body, text, status) = match Planner::new(&Arc::new(model.clone())).reconfigure(&state, &goals) {
        Ok(plan) => {
            let commands = plan.commands(&model);
            let listed: Vec<Value> = commands
                .iter()
                .map(|command| json!({ "component": command.component, "command": command.command }))
                .collect();
            let lines = commands.iter().map(|command| format!("{} {}\n", command.component, command.command));
            let text = if commands.is_empty() {
                "Already in the goal state; no commands needed.\n".into()
            } else {
                lines.collect()
            };
            (json!({ "status": "done", "commands": listed }), text, YES)
        }
        Err(unreachable) => failure(&model, &unreachable),
    };
    match args.format {
        Format::Json => {
            if status == LIMIT {
                problems.push(output::failure(E_LIMIT, text.trim_end()));
            }
            print_json(&document("reconfigure", &problems, body))?;
        }
        Format::Text => print_text(&text)?,
    }
    Ok(exit(status))
}

fn failure(model: &Model, unreachable: &[Unreachable]) -> (Value, String, u8) {
    let reasons: Vec<&str> = unreachable.iter().map(|failed| failed.reason.as_str()).collect();
    let goals: Vec<Value> = unreachable
        .iter()
        .map(|failed| json!({ "goal": failed.goal.describe(model), "reason": failed.reason }))
        .collect();
    let text = unreachable
        .iter()
        .map(|failed| format!("{}: {}\n", failed.goal.describe(model), failed.reason))
        .collect();
    let status = if unreachable.iter().any(|failed| failed.limit_reached) { LIMIT } else { NO };
    let reason = reasons.join("; ");
    (json!({ "status": "unreachable", "commands": [], "reason": reason, "unreachable": goals }), text, status)
}
