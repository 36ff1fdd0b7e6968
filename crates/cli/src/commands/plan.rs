//! `enroute plan`: plans a mission or a network, and says why where there is no plan.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Context as _;
use clap::ValueEnum;
use exact::{Bound, Time};
use kirk::{Failure, Options, Outcome, Search, Status};
use mission::planning::Planned;
use mission::{Compiled, Evaluated, Manner, SavedState};
use rmpl::LineIndex;
use rmpl::files::Files;
use serde_json::{Value, json};
use snapshot::paths_json::{separation_violations_json, traverses_json};
use snapshot::{Planning, Problem};
use tpn::{Levels, Network, Supply};

use crate::commands::held_rules::HeldRules;
use crate::commands::report::read_rules;
use crate::deadline::TimeLimit;
use crate::diagnostics::{path_of_file, print_problems};
use crate::input::read_json;
use crate::number::{positive_number, seed};
use crate::opened::Opened;
use crate::output::{
    E_INPUT, E_LIMIT, E_TIME, Format, LIMIT, NO, WRONG, YES, any_error, column, document, exit, failure,
    print_json, print_text, without_timings,
};
use crate::save::{refuse_input, save};
use crate::target::{Target, parse_threat_gap};

/// Plan a mission: choices, causal links, orderings and event windows.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// Search method.
    #[arg(long, value_enum, default_value_t)]
    search: SearchName,
    /// List every distinct plan.
    #[arg(long)]
    all: bool,
    /// List the K best plans.
    #[arg(long, value_name = "K", conflicts_with = "all", value_parser = positive_number)]
    best: Option<u32>,
    /// Stop after N plans (with --all).
    #[arg(long, value_name = "N", value_parser = positive_number)]
    limit: Option<u32>,
    #[command(flatten)]
    time_limit: TimeLimit,
    /// Minimum gap between ordered intervals [default: the mission's].
    #[arg(long, value_name = "G")]
    threat_gap: Option<String>,
    /// Write the search to FILE as JSON lines.
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
    /// Seed for path planning.
    #[arg(long, default_value_t = 0, value_parser = seed)]
    seed: u64,
    /// Don't plan paths for traverses.
    #[arg(long)]
    no_paths: bool,
    /// Check every plan against these flight rules.
    #[arg(long, value_name = "RULES.json")]
    rules: Option<PathBuf>,
    /// Start from the values, levels and places that simulate --state wrote.
    #[arg(long, value_name = "STATE.json")]
    state: Option<PathBuf>,
    /// Omit timings, for reproducible output.
    #[arg(long)]
    no_timings: bool,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// The searches by name.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum SearchName {
    /// After a failure, undoes the last choice.
    Chronological,
    /// Learns from each failure and jumps back. Finds a valid plan, not always the first in textual order.
    #[default]
    ConflictDirected,
    /// Best-first (A*): the first plan found is optimal. Uses more memory.
    BestFirst,
}

/// Events of a search that `--trace` writes at most.
const TRACE_EVENTS: usize = 1_000_000;

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let options = args.options()?;
    let mut mission = args.target.open()?;
    if let Some(file) = &args.state {
        let start: SavedState = read_json(file)?;
        mission.start_from(start).with_context(|| format!("cannot use {}", file.display()))?;
    }
    let mut compiled = mission.compile()?;
    if let Some(gap) = options.threat_gap {
        // The checker asks for the same gap.
        mission.core.set_threat_gap(&mut compiled, gap);
    }
    let mut problems = compiled.problems();
    if compiled.network().is_none() {
        debug_assert!(any_error(&problems), "a file without a network has an error");
        let body = json!({ "status": "error", "plans": [], "failure": null, "stats": {} });
        return mission.refuse(&problems, args.format, ("plan", body));
    }
    let rules = args.rules.as_deref().map(read_rules).transpose()?;
    args.trace.as_deref().map_or(Ok(()), refuse_input)?;
    let begun = Instant::now();
    let deadline = args.time_limit.start();
    let without_paths = args.no_paths || compiled.is_network;
    let ground = if without_paths { None } else { mission.ground(&compiled)? };
    let most_millis = deadline.remaining_millis();
    let manner = Manner { options, seed: args.seed, without_paths, with_repairs: true, most_millis };
    let Evaluated { compiled, planned, .. } = mission.plan(compiled, ground, manner, deadline)?;
    let plan_millis = millis_since(begun);
    if let Some(file) = &args.trace {
        let trace = planned.planning.outcome.trace.as_ref();
        let trace = trace
            .context("the search has no trace, because the times of the mission are too large to plan")?;
        save(file, &kirk::trace_json_lines(&planned.network, trace))?;
    }
    let outcome = &planned.planning.outcome;
    let rules = match &rules {
        Some(rules) => HeldRules::new(rules, &compiled.program, &planned),
        None => HeldRules::default(),
    };
    match args.format {
        Format::Json => {
            let mut body = outcome_json(&planned, &compiled, plan_millis);
            if args.no_timings {
                without_timings(&mut body["stats"]);
            }
            if args.rules.is_some() {
                body["rules"] = rules.worst_json();
                body["rules_by_plan"] = rules.by_plan_json();
            }
            problems.extend(Problem::all(&planned.warnings, &mission.source));
            problems.extend(unanswered(&planned));
            print_json(&document("plan", &problems, body))?;
        }
        Format::Text => {
            let warnings = Problem::all(&planned.warnings, &mission.source);
            print_problems(&mission.name, &mission.source, &problems)?;
            print_problems(&mission.name, &mission.source, &warnings)?;
            print_text(&outcome_text(&planned, &mission))?;
            print_text(&rules.text())?;
        }
    }
    let is_refused = planned.planning.verdict.as_ref().is_some_and(|verdict| !verdict.valid);
    Ok(exit(match outcome.status {
        // What the independent checker does not accept is not a plan to rely on.
        Status::Plan if is_refused || !rules.are_kept() => NO,
        Status::Plan => YES,
        Status::NoPlan => NO,
        Status::Limit => LIMIT,
        Status::Error => WRONG,
    }))
}

impl Args {
    fn options(&self) -> anyhow::Result<Options> {
        let threat_gap = self.threat_gap.as_deref().map(parse_threat_gap).transpose()?;
        Ok(Options {
            search: match self.search {
                SearchName::Chronological => Search::Chronological,
                SearchName::ConflictDirected => Search::ConflictDirected,
                SearchName::BestFirst => Search::BestFirst,
            },
            threat_gap,
            all: self.all,
            max_plans: self.limit.map_or(Options::default().max_plans, |count| count as usize),
            best: self.best.map_or(1, |count| count as usize),
            trace_events: self.trace.is_some().then_some(TRACE_EVENTS),
            ..Options::default()
        })
    }
}

fn millis_since(begun: Instant) -> f64 {
    begun.elapsed().as_secs_f64() * 1000.0
}

fn status_name(status: Status) -> &'static str {
    match status {
        Status::Plan => "plan",
        Status::NoPlan => "no-plan",
        Status::Limit => "limit",
        Status::Error => "error",
    }
}

fn outcome_json(planned: &Planned, compiled: &Compiled, plan_millis: f64) -> Value {
    let outcome = &planned.planning.outcome;
    let stats = &outcome.stats;
    let world = (!compiled.is_network).then_some(&compiled.program.world);
    let plan_json = |(network, plan): (&Network, &tpn::Plan)| tpn::plan_json::plan_to_json(network, plan);
    let plans: Vec<Value> = all_plans(planned).map(plan_json).collect();
    let mut body = json!({
        "status": status_name(outcome.status),
        "plans": plans,
        "verdict": planned.planning.verdict,
        "failure": outcome.failure.as_ref().map(|failure| failure_json(failure, &planned.planning, &compiled.source, &planned.network)),
        "undrivable": planned.planning.undrivable.iter().map(|undrivable| json!({
            "activity": planned.network.occurrences[undrivable.occurrence.index()].name,
            "leg": undrivable.leg,
            "reason": undrivable.reason,
        })).collect::<Vec<_>>(),
        "left_out": planned.planning.left_out.iter().map(|left_out| json!({
            "choices": choices_json(&left_out.choices),
            "reason": left_out.reason,
        })).collect::<Vec<_>>(),
        "traverses": world.map(|world| traverses_json(&planned.traverses, &planned.network, world)),
        "encounters": world.map(|world| separation_violations_json(&planned.separation_violations, world)),
        "stats": {
            "parse_millis": compiled.timings.parse_millis,
            "compile_millis": compiled.timings.compile_millis,
            "plan_millis": plan_millis,
            "nodes": stats.nodes,
            "arcs": stats.arcs,
            "decisions": stats.decisions,
            "expanded": stats.expanded,
            "backtracks": stats.backtracks,
            "conflicts": stats.conflicts,
            "leaves": stats.leaves,
            "nogoods": stats.nogoods,
        },
    });
    if let Some(bound) = outcome.bound {
        body["bound"] = json!(bound);
    }
    body
}

/// All plans that were asked for, each with its network.
pub fn all_plans(planned: &Planned) -> impl Iterator<Item = (&Network, &tpn::Plan)> {
    let own = planned.planning.outcome.plans.iter().map(|plan| (planned.network.as_ref(), plan));
    own.chain(planned.others.iter().map(|listed| (listed.network.as_ref(), &listed.plan)))
}

fn failure_json(failure: &Failure, planning: &Planning, source: &str, network: &Network) -> Value {
    let (lines, files) = (LineIndex::new(source), Files::of(source));
    let span_json = |span: &rmpl::Span| {
        let place = files.line_column(source, &lines, span.start);
        let file = files.at(span.start);
        let (start, end) = (span.start.saturating_sub(file.start), span.end.saturating_sub(file.start));
        let mut told = json!({ "start": start, "end": end, "line": place.line, "column": place.column });
        if file.start > 0 {
            told["file"] = json!(file.name);
        }
        told
    };
    let repairs: Vec<Value> = planning
        .repairs
        .iter()
        .map(|repair| {
            let edit = |edit: &rmpl::Edit| json!({ "span": span_json(&edit.span), "text": edit.text });
            json!({ "label": repair.label, "edits": repair.edits.iter().map(edit).collect::<Vec<_>>() })
        })
        .collect();
    let kinds: Vec<&str> = failure.kinds().iter().map(|kind| kind.name()).collect();
    let reasons: Vec<Value> = failure
        .reasons
        .iter()
        .map(|reason| {
            json!({
                "choices": choices_json(&reason.choices),
                "kind": reason.kind.name(),
                "message": reason.message,
                "spans": reason.spans.iter().map(span_json).collect::<Vec<_>>(),
                "minimal": reason.is_minimal,
                "run": reason.failing_run_in_words(network),
            })
        })
        .collect();
    let relaxations: Vec<Value> = failure
        .relaxations
        .iter()
        .map(|relaxation| {
            json!({
                "label": relaxation.label,
                "bounds": relaxation.bounds_text,
                "span": relaxation.span.as_ref().map(span_json),
            })
        })
        .collect();
    json!({
        "kinds": kinds,
        "reasons": reasons,
        "complete": failure.is_complete,
        "relaxations": relaxations,
        "repairs": repairs,
        "gap": failure.is_of_gap,
    })
}

/// Returns why the search gave no answer, or not all of it, as a diagnostic.
fn unanswered(planned: &Planned) -> Option<Problem> {
    let planning = &planned.planning;
    match planning.outcome.status {
        Status::Plan | Status::NoPlan => None,
        Status::Limit => {
            let code = if planning.undrivable.is_empty() { E_TIME } else { E_LIMIT };
            Some(match planning.undecided() {
                Some(why) => failure(code, &format!("undecided: {why}")),
                None => failure(E_LIMIT, "limit reached: there may be more plans"),
            })
        }
        Status::Error => {
            planning.outcome.unplannable_message(&planned.network).map(|why| failure(E_INPUT, &why))
        }
    }
}

fn choices_json(choices: &[tpn::Choice]) -> Value {
    choices
        .iter()
        .map(|choice| (Network::decision_name(choice.decision), json!(choice.alternative)))
        .collect::<serde_json::Map<String, Value>>()
        .into()
}

fn outcome_text(planned: &Planned, mission: &Opened) -> String {
    let outcome = &planned.planning.outcome;
    let mut text = match outcome.status {
        Status::Plan => String::new(),
        Status::NoPlan => "no plan\n".to_owned(),
        Status::Limit => match planned.planning.undecided() {
            None => "limit reached: there may be more plans\n".to_owned(),
            Some(_) if planned.planning.undrivable.is_empty() => "time limit reached: undecided\n".to_owned(),
            Some(why) => format!("undecided: {why}\n"),
        },
        Status::Error => {
            let message = outcome.unplannable_message(&planned.network);
            message.map(|message| format!("{message}\n")).unwrap_or_default()
        }
    };
    let readable = |text: &str| planned.network.readable(text);
    let count = all_plans(planned).count();
    for ((network, plan), number) in all_plans(planned).zip(1..) {
        if count > 1 {
            text.push_str(&format!("plan {number} of {count}\n"));
        }
        text.push_str(&readable(&plan_text(network, plan)));
    }
    if let Some(verdict) = &planned.planning.verdict {
        if verdict.valid {
            text.push_str("verified by the independent checker\n");
        }
        for violation in &verdict.violations {
            text.push_str(&format!("NOT VALID: {}\n", readable(&violation.message)));
        }
    }
    if let Some(failure) = &outcome.failure {
        text.push_str(&failure_text(failure, mission, &planned.network));
        for label in planned.planning.ways_out() {
            text.push_str(&readable(&format!("fix: {label}\n")));
        }
    }
    for undrivable in &planned.planning.undrivable {
        let name = &planned.network.occurrences[undrivable.occurrence.index()].name;
        text.push_str(&readable(&format!("{name} can't be driven {}\n", undrivable.reason)));
    }
    for left_out in &planned.planning.left_out {
        let taken = |choice: &tpn::Choice| {
            format!("{} = {}", Network::decision_name(choice.decision), choice.alternative)
        };
        let choices: Vec<String> = left_out.choices.iter().map(taken).collect();
        let reason = readable(&left_out.reason);
        text.push_str(&format!("left out  {}: {reason}\n", choices.join(", ")));
    }
    text.push_str(&stats_text(outcome));
    text
}

/// The text tells so many orders of conditions; what excludes each other may be ordered in a square of ways.
const MAX_ORDERS_TOLD: usize = 200;

fn plan_text(network: &Network, plan: &tpn::Plan) -> String {
    let mut text = String::new();
    if !plan.choices.is_empty() {
        let choices: Vec<String> = plan
            .choices
            .iter()
            .map(|choice| format!("{} = {}", Network::decision_name(choice.decision), choice.alternative))
            .collect();
        text.push_str(&format!("choices   {}\n", choices.join(", ")));
    }
    for link in &plan.causal_links {
        text.push_str(&format!(
            "link      {} supports {}\n",
            network.label_name(link.tell),
            network.label_name(link.ask)
        ));
    }
    let added: BTreeSet<&tpn::Ordering> = plan.orderings_added.iter().collect();
    let orders = plan.telling_order(network);
    for order in orders.iter().take(MAX_ORDERS_TOLD) {
        let added = if added.contains(order) { " (added)" } else { "" };
        let (first, then) = (network.label_name(order.first), network.label_name(order.then));
        text.push_str(&format!("order     {first} before {then}{added}\n"));
    }
    let more = orders.len().saturating_sub(MAX_ORDERS_TOLD);
    if more > 0 {
        text.push_str(&format!("order     and {more} more; `--format json` lists all\n"));
    }
    for order in &plan.uses_ordered {
        let (first, then) = (network.use_name(order.first), network.use_name(order.then));
        text.push_str(&format!("order     {first} before {then} (added)\n"));
    }
    for (resource, levels) in network.resources.iter().zip(&plan.levels) {
        let name = &resource.name;
        text.push_str(&match (resource.supply, *levels) {
            (Supply::Reservoir { least, greatest, .. }, Levels::Range { low, high }) => {
                format!("resource  {name}: {low}–{high} (allowed {least}–{greatest})\n")
            }
            (Supply::Reusable { capacity }, Levels::Peak(peak)) => {
                format!("resource  {name}: peak {peak} of {capacity}\n")
            }
            _ => String::new(),
        });
    }
    let quality = &plan.quality;
    if !network.worths.is_empty() || quality.is_optimal.is_some() {
        let optimal = match quality.is_optimal {
            Some(true) => ", optimal",
            Some(false) => ", the best found",
            None => "",
        };
        let meters =
            if quality.length_m == 0.0 { String::new() } else { format!(", {:.1} m", quality.length_m) };
        text.push_str(&format!(
            "objective cost {}, reward {}, end {}{meters}{optimal}\n",
            quality.cost,
            quality.reward,
            quality.end.readable()
        ));
    }
    let mut rows: Vec<(Time, Bound, String)> = Vec::new();
    for (node, window) in network.nodes.iter().zip(&plan.windows) {
        let Some(window) = window else { continue };
        for &event in node.events.iter().filter(|&&event| plan.has_event(network, event)) {
            rows.push((window.earliest, window.latest, network.readable(&network.event_name(event))));
        }
    }
    rows.sort();
    let shown = column(rows.iter().map(|(_, _, name)| name.as_str()));
    for ((earliest, latest, _), name) in rows.iter().zip(shown) {
        text.push_str(&format!("  {name}  [{}, {}]\n", earliest.readable(), latest.readable()));
    }
    text
}

fn failure_text(failure: &Failure, mission: &Opened, network: &Network) -> String {
    let source = &*mission.source;
    let (lines, files) = (LineIndex::new(source), Files::of(source));
    let mut text = String::new();
    for reason in &failure.reasons {
        text.push_str(&format!("{} ({})\n", network.readable(&reason.message), reason.kind.name()));
        for line in reason.failing_run_in_words(network) {
            text.push_str(&format!("  {}\n", network.readable(&line)));
        }
        for span in &reason.spans {
            let place = files.line_column(source, &lines, span.start);
            let file = files.at(span.start);
            let is_first = file.start == 0;
            let name = if is_first { mission.name.clone() } else { path_of_file(&mission.name, &file.name) };
            let snippet = source.get(span.range()).unwrap_or("").lines().next().unwrap_or("");
            text.push_str(&format!("  {name}:{}:{}: {snippet}\n", place.line, place.column));
        }
    }
    if !failure.is_complete {
        text.push_str("more reasons exist than are listed\n");
    }
    text
}

fn stats_text(outcome: &Outcome) -> String {
    let stats = &outcome.stats;
    let counted = |count: u64, one: &str| format!("{count} {one}{}", if count == 1 { "" } else { "s" });
    format!(
        "{}, {}, {}; {} expanded, {}, {}\n",
        counted(stats.nodes, "node"),
        counted(stats.arcs, "arc"),
        counted(stats.decisions, "decision"),
        stats.expanded,
        counted(stats.backtracks, "backtrack"),
        counted(stats.conflicts, "failure")
    )
}
