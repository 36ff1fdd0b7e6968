//! `enroute verify`: the independent check of a plan that was written by `enroute plan`, or by anyone.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use mission::{Compiled, Manner};
use serde_json::{Value, json};
use tpn::plan_json::{PlanError, plan_from_json, selected_activities, stated_activities};
use tpn::{EventEnd, Network};

use crate::diagnostics::print_problems;
use crate::input::read_json;
use crate::opened::Opened;
use crate::output::{Format, NO, YES, document, exit, print_json, print_text};
use crate::target::{PlanOptions, Target, parse_threat_gap};

/// Verify a plan independently of the planner.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// Plan: a document of enroute plan, with every plan in it, or a single plan.
    plan: PathBuf,
    /// Minimum gap between ordered intervals [default: the mission's].
    #[arg(long, value_name = "G")]
    threat_gap: Option<String>,
    #[command(flatten)]
    options: PlanOptions,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let mut mission = args.target.open()?;
    let mut compiled = mission.compile()?;
    if let (Some(text), Some(_)) = (&args.threat_gap, compiled.network()) {
        mission.core.set_threat_gap(&mut compiled, parse_threat_gap(text)?);
    }
    let stated: Value = read_json(&args.plan)?;
    let problems = compiled.problems();
    let Some(network) = compiled.network() else {
        return mission.refuse(&problems, args.options.format, ("verify", json!({ "valid": null })));
    };
    let plans: Vec<&Value> = match stated.get("plans").and_then(Value::as_array) {
        Some(plans) => plans.iter().collect(),
        None => vec![&stated],
    };
    let mut violations = Vec::new();
    for (index, plan) in plans.iter().enumerate() {
        for mut violation in check(args, &mut mission, (&compiled, network), plan)? {
            if plans.len() > 1 {
                violation["plan"] = index.into();
            }
            violations.push(violation);
        }
    }
    let is_valid = violations.is_empty();
    match args.options.format {
        Format::Json => {
            let body = json!({ "valid": is_valid, "plans": plans.len(), "violations": violations });
            print_json(&document("verify", &problems, body))?;
        }
        Format::Text => {
            print_problems(&mission.name, &mission.source, &problems)?;
            let mut text = match (is_valid, plans.is_empty()) {
                (true, true) => {
                    "valid: the document lists no plan, so there is nothing to check\n".to_owned()
                }
                (true, false) => "valid\n".to_owned(),
                (false, _) => "not valid\n".to_owned(),
            };
            for violation in &violations {
                text.push_str(&format!("  {}\n", violation["message"].as_str().unwrap_or("")));
            }
            print_text(&network.readable(&text))?;
        }
    }
    Ok(exit(if is_valid { YES } else { NO }))
}

/// Returns what is wrong with one plan. What it says of things that the network does not have is wrong with it; a
/// document that is not a plan at all is an error of the call.
fn check(
    args: &Args,
    mission: &mut Opened,
    (compiled, network): (&Compiled, &Arc<Network>),
    stated: &Value,
) -> anyhow::Result<Vec<Value>> {
    let moves = names_path_vertices(stated) || orders_ways(stated) || drives(compiled, network, stated);
    let with_paths =
        if moves { with_paths(args, mission, (compiled, network), stated)? } else { Arc::clone(network) };
    let network = &*with_paths;
    let plan = match plan_from_json(network, stated) {
        Ok(plan) => plan,
        Err(error @ PlanError::Unknown { .. }) => {
            return Ok(vec![
                json!({ "rule": "form", "message": error.to_string(), "events": [], "intervals": [] }),
            ]);
        }
        Err(error) => return Err(error.into()),
    };
    let verdict = verify::check_plan(network, &plan);
    let mut violations: Vec<Value> = Vec::new();
    for violation in &verdict.violations {
        violations.push(serde_json::to_value(violation)?);
    }
    if let Some(activities) = stated_activities(stated) {
        let selected = selected_activities(network, &plan);
        if activities != selected {
            let message =
                format!("the plan lists the activities {activities:?}, but its choices select {selected:?}");
            violations
                .push(json!({ "rule": "selection", "message": message, "events": [], "intervals": [] }));
        }
    }
    Ok(violations)
}

/// Returns whether the plan has windows of path vertices, which are not in the network of the text alone.
fn names_path_vertices(stated: &Value) -> bool {
    let windows = stated.get("windows").and_then(Value::as_object);
    windows.is_some_and(|windows| windows.keys().any(|event| event.contains(".leg")))
}

/// Returns whether what the plan says of times may follow from paths without vertices: its mission moves vehicles, and
/// without paths it is not valid.
fn drives(compiled: &Compiled, network: &Network, stated: &Value) -> bool {
    let moves = compiled.program.primitives.iter().any(|it| it.moves.is_some());
    let is_valid = |plan: tpn::Plan| verify::check_plan(network, &plan).valid;
    moves && !plan_from_json(network, stated).is_ok_and(is_valid)
}

/// Returns whether the plan has orders of traverses that would meet, which are not in the network of the text alone.
fn orders_ways(stated: &Value) -> bool {
    let resources = stated.get("resources").and_then(Value::as_object);
    resources.is_some_and(|resources| resources.keys().any(|name| name.starts_with("way#")))
}

/// A plan less what it says of paths.
pub(super) fn without_path_vertices(stated: &Value) -> Value {
    let mut stated = stated.clone();
    if let Some(windows) = stated.get_mut("windows").and_then(Value::as_object_mut) {
        windows.retain(|event, _| !event.contains(".leg"));
    }
    stated
}

/// The network with the paths that planning finds, which the seed determines.
fn with_paths(
    args: &Args,
    mission: &mut Opened,
    (compiled, network): (&Compiled, &Arc<Network>),
    stated: &Value,
) -> anyhow::Result<Arc<Network>> {
    let mut events = network.nodes.iter().flat_map(|node| &node.events);
    if compiled.is_network || events.any(|event| matches!(event.end, EventEnd::PathVertex { .. })) {
        return Ok(Arc::clone(network));
    }
    let ground = mission.ground(compiled)?;
    let manner = Manner { seed: args.options.seed, ..Manner::default() };
    let evaluated = mission.plan(compiled.clone(), ground, manner, args.options.time_limit.start())?;
    // Another plan than the first one has paths of its own.
    let own = &evaluated.planned.network;
    let is_own = |plan: tpn::Plan| verify::check_plan(own, &plan).valid;
    if !plan_from_json(own, stated).is_ok_and(is_own)
        && let Ok(plan) = plan_from_json(network, &without_path_vertices(stated))
    {
        return Ok(Arc::new(mission.core.network_of(&evaluated, &plan).map_err(anyhow::Error::msg)?));
    }
    Ok(Arc::clone(own))
}
