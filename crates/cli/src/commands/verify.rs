//! `enroute verify`: the independent check of a plan that was written by `enroute plan`, or by anyone.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use mission::{Paths, listing, planning};
use serde_json::{Value, json};
use tpn::plan_json::{PlanError, plan_from_json, selected_activities, stated_activities};
use tpn::{EventEnd, Network};

use crate::deadline::TimeLimit;
use crate::diagnostics::print_problems;
use crate::ground::ground;
use crate::input::read_json;
use crate::load::{Loaded, Target, parse_threat_gap};
use crate::output::{Format, NO, WRONG, YES, document, exit, print_json, print_text};

/// Checks a plan against a mission or a network, from the definitions.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// The plan: an enroute-plan document, of which every plan is checked, or a single plan.
    plan: PathBuf,
    /// The least gap between ordered intervals that the plan was made with; the file's own by default.
    #[arg(long, value_name = "G")]
    threat_gap: Option<String>,
    /// The seed that path planning had.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    time_limit: TimeLimit,
    /// For whom the answer is.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let mut loaded = args.target.load()?;
    if let (Some(text), Some(network)) = (&args.threat_gap, &mut loaded.network) {
        network.threat_gap = parse_threat_gap(text)?;
    }
    let stated: Value = read_json(&args.plan)?;
    let Some(network) = &loaded.network else {
        match args.format {
            Format::Json => print_json(&document("verify", &loaded.problems, json!({ "valid": null })))?,
            Format::Text => print_problems(&loaded.name, &loaded.source, &loaded.problems)?,
        }
        return Ok(exit(WRONG));
    };
    let plans: Vec<&Value> = match stated.get("plans").and_then(Value::as_array) {
        Some(plans) => plans.iter().collect(),
        None => vec![&stated],
    };
    anyhow::ensure!(!plans.is_empty(), "{} has no plan to check", args.plan.display());
    let mut violations = Vec::new();
    for (index, plan) in plans.iter().enumerate() {
        for mut violation in check(args, &loaded, network, plan)? {
            if plans.len() > 1 {
                violation["plan"] = index.into();
            }
            violations.push(violation);
        }
    }
    let is_valid = violations.is_empty();
    match args.format {
        Format::Json => {
            let body = json!({ "valid": is_valid, "violations": violations });
            print_json(&document("verify", &loaded.problems, body))?;
        }
        Format::Text => {
            print_problems(&loaded.name, &loaded.source, &loaded.problems)?;
            let mut text = if is_valid { "valid\n".to_owned() } else { "not valid\n".to_owned() };
            for violation in &violations {
                text.push_str(&format!("  {}\n", violation["message"].as_str().unwrap_or("")));
            }
            print_text(&text)?;
        }
    }
    Ok(exit(if is_valid { YES } else { NO }))
}

/// What is wrong with one plan. What it says of things that the network does not have is wrong with it; a document
/// that is no plan at all is an error of the call.
fn check(args: &Args, loaded: &Loaded, network: &Network, stated: &Value) -> anyhow::Result<Vec<Value>> {
    let extended;
    let network = if names_path_vertices(stated) || orders_ways(stated) || drives(loaded, network, stated) {
        extended = with_paths(args, loaded, network, stated)?;
        &*extended
    } else {
        network
    };
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

/// Whether the plan has windows of path vertices, which are not in the network of the text alone.
fn names_path_vertices(stated: &Value) -> bool {
    let windows = stated.get("windows").and_then(Value::as_object);
    windows.is_some_and(|windows| windows.keys().any(|event| event.contains(".leg")))
}

/// Whether what the plan says of times may follow from paths without vertices: its mission moves vehicles, and without paths
/// it is not valid.
fn drives(loaded: &Loaded, network: &Network, stated: &Value) -> bool {
    let moves = loaded.program.iter().flat_map(|program| &program.primitives).any(|it| it.moves.is_some());
    let is_valid = |plan: tpn::Plan| verify::check_plan(network, &plan).valid;
    moves && !plan_from_json(network, stated).is_ok_and(is_valid)
}

/// Whether the plan has orders of traverses that would meet, which are not in the network of the text alone.
fn orders_ways(stated: &Value) -> bool {
    let resources = stated.get("resources").and_then(Value::as_object);
    resources.is_some_and(|resources| resources.keys().any(|name| name.starts_with("way#")))
}

/// A plan less what it says of paths.
fn without_path_vertices(stated: &Value) -> Value {
    let mut stated = stated.clone();
    if let Some(windows) = stated.get_mut("windows").and_then(Value::as_object_mut) {
        windows.retain(|event, _| !event.contains(".leg"));
    }
    stated
}

/// The network with the paths that planning finds, which the seed determines.
fn with_paths(
    args: &Args,
    loaded: &Loaded,
    network: &Network,
    stated: &Value,
) -> anyhow::Result<Arc<Network>> {
    let network = Arc::new(network.clone());
    let Some(program) = &loaded.program else { return Ok(network) };
    let has_paths = |network: &Network| {
        let mut events = network.nodes.iter().flat_map(|node| &node.events);
        events.any(|event| matches!(event.end, EventEnd::PathVertex { .. }))
    };
    if has_paths(&network) {
        return Ok(network);
    }
    let (mut grounds, ground) = ground(&args.target.file, &program.world)?;
    let problem = planning::Problem {
        ground: ground.as_ref().map(|(key, map)| (key, map)),
        seed: args.seed,
        ..planning::Problem::new(&network, program)
    };
    let mut paths = Paths::default();
    let deadline = args.time_limit.start();
    let mut stop = || deadline.is_over();
    let planned = planning::plan(&problem, &mut grounds, &mut paths, &mut stop);
    deadline.check(&planned.planning.outcome)?;
    // Another plan than the first one has paths of its own.
    let is_own = |plan: tpn::Plan| verify::check_plan(&planned.network, &plan).valid;
    if !plan_from_json(&planned.network, stated).is_ok_and(is_own)
        && let Ok(plan) = plan_from_json(&network, &without_path_vertices(stated))
    {
        let found = listing::network_of(&problem, &plan, &mut grounds, &mut paths);
        return Ok(Arc::new(found.map_err(anyhow::Error::msg)?));
    }
    Ok(planned.network)
}
