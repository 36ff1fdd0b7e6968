//! `enroute execute`: the windows that remain of a plan after some of its events have happened.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context as _;
use exact::Time;
use executive::{Observations, Progress, Waiting};
use mission::Manner;
use serde::Deserialize as _;
use serde_json::{Map, Value, json};
use tpn::{Network, Plan, Window};

use crate::deadline::TimeLimit;
use crate::input::read_json;
use crate::output::{Format, NO, YES, column, document, exit, print_json, print_text};
use crate::target::Target;

/// Show the remaining windows of a plan after some events have happened.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// Execute this plan instead of the mission's own; a document of enroute plan.
    #[arg(long, value_name = "PLAN.json")]
    plan: Option<PathBuf>,
    /// Events so far: {"executed": {event: time…}, "now": t}.
    #[arg(long, value_name = "OBS.json")]
    observe: PathBuf,
    #[command(flatten)]
    time_limit: TimeLimit,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let mut mission = args.target.open()?;
    let compiled = mission.compile()?;
    let problems = compiled.problems();
    let Some(network) = compiled.network().cloned() else {
        let body = json!({ "consistent": false, "windows": {}, "violations": [] });
        return mission.refuse(&problems, args.format, ("execute", body));
    };
    let network = &*network;
    let plan = if let Some(file) = &args.plan {
        let document: Value = read_json(file)?;
        let plans = tpn::plan_json::plans_from_json(network, &document)?;
        plans
            .into_iter()
            .next()
            .with_context(|| format!("{} lists no plan; it needs at least one", file.display()))?
    } else {
        let manner = Manner { without_paths: true, ..Manner::unexplained() };
        let planned = mission.plan(compiled, None, manner, args.time_limit.start())?.planned;
        planned.planning.outcome.plans.first().cloned().context("the mission has no plan to execute")?
    };
    let observed = observations(network, &read_json(&args.observe)?)?;
    let progress = executive::progress(network, &plan, &observed)?;
    let is_consistent = matches!(progress, Progress::Consistent(..));
    match args.format {
        Format::Json => {
            print_json(&document("execute", &problems, progress_json(network, &progress)))?;
        }
        Format::Text => {
            let text = progress_text(network, &plan, &progress);
            print_text(&network.readable(&text))?;
        }
    }
    Ok(exit(if is_consistent { YES } else { NO }))
}

fn observations(network: &Network, document: &Value) -> anyhow::Result<Observations> {
    let times = tpn::plan_json::times_from_json(network, document.get("executed").unwrap_or(&json!({})))?;
    let executed: Vec<(tpn::NodeId, Time)> = times
        .iter()
        .enumerate()
        .filter_map(|(index, time)| Some((tpn::NodeId::from_index(index), (*time)?)))
        .collect();
    let latest = executed.iter().map(|&(_, time)| time).max().unwrap_or_default();
    let now = match document.get("now") {
        Some(now) => Time::deserialize(now).context("`now` is not a time")?,
        None => latest,
    };
    Ok(Observations { executed, now })
}

fn named_windows(network: &Network, windows: &[Option<Window>]) -> BTreeMap<String, Window> {
    let mut named = BTreeMap::new();
    for (node, window) in network.nodes.iter().zip(windows) {
        let Some(window) = window else { continue };
        for &event in &node.events {
            named.insert(network.event_name(event), *window);
        }
    }
    named
}

/// The event that waits, and the event of the environment's that it waits for.
fn names(network: &Network, wait: &Waiting) -> (String, String) {
    let natures = network.arcs[wait.natures.index()].to;
    let name = |node| tpn::plan_json::node_name(network, node);
    (name(wait.event), name(natures))
}

fn wait_json(network: &Network, wait: &Waiting) -> Value {
    let (event, natures) = names(network, wait);
    json!({ "event": event, "for": natures, "until": wait.until })
}

fn progress_json(network: &Network, progress: &Progress) -> Value {
    match progress {
        Progress::Consistent(windows, waits) => {
            let windows: Map<String, Value> = named_windows(network, windows)
                .into_iter()
                .map(|(name, window)| (name, json!([window.earliest, window.latest])))
                .collect();
            let mut body = json!({ "consistent": true, "windows": windows, "violations": [] });
            if !waits.is_empty() {
                body["waits"] = waits.iter().map(|wait| wait_json(network, wait)).collect();
            }
            body
        }
        Progress::Violated(reasons) => json!({ "consistent": false, "windows": {}, "violations": reasons }),
    }
}

fn progress_text(network: &Network, plan: &Plan, progress: &Progress) -> String {
    match progress {
        Progress::Consistent(windows, waits) => {
            let named = named_windows(network, windows);
            let before = named_windows(network, &plan.windows);
            let read: Vec<String> = named.keys().map(|name| network.readable(name)).collect();
            let shown = column(read.iter().map(String::as_str));
            let lines = named.iter().zip(&shown).map(|((name, window), shown)| {
                let changed = if before.get(name) == Some(window) { "" } else { "  changed" };
                format!("{shown}  [{}, {}]{changed}\n", window.earliest, window.latest)
            });
            let waits = waits.iter().map(|wait| {
                let (event, natures) = names(network, wait);
                format!("{event} waits for {natures}, or for {}\n", wait.until)
            });
            lines.chain(waits).collect()
        }
        Progress::Violated(reasons) => {
            let mut text = "the plan can no longer be kept\n".to_owned();
            for reason in reasons {
                text.push_str(&format!("  {reason}\n"));
            }
            text
        }
    }
}
