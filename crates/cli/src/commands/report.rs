//! `enroute report`: reviews a mission, and writes the review as one HTML file.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context as _;
use review::{FlightRules, Line, Present, Review, Section, Status, TimeRange, review, standing};
use serde_json::{Value, json};
use snapshot::{Robustness, RobustnessSettings};

use crate::deadline::Undecided;
use crate::diagnostics::print_problems;
use crate::input::read_text;
use crate::output::{Format, NO, WRONG, YES, document, exit, print_json, print_text};
use crate::repeated::repeat;
use crate::save::{refuse_input, save};
use crate::target::{PlanOptions, Target};
use crate::trust::Trusted;

/// Review a mission: print a checklist and write a self-contained HTML report.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// HTML file to write; optional with --format json.
    #[arg(short, long, value_name = "OUT.html", required_if_eq("format", "text"))]
    output: Option<PathBuf>,
    /// Review history to include in the report.
    #[arg(long, alias = "record", value_name = "REVIEW.json")]
    review: Option<PathBuf>,
    #[command(flatten)]
    trusted: Trusted,
    /// Check the plan against these flight rules [default: those of the review, otherwise the default ones].
    #[arg(long, value_name = "RULES.json")]
    rules: Option<PathBuf>,
    /// Monte Carlo result to include; a document of enroute robustness.
    #[arg(long, value_name = "ROBUSTNESS.json")]
    robustness: Option<PathBuf>,
    #[command(flatten)]
    options: PlanOptions,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let deadline = args.options.time_limit.start();
    let mission = args.target.open()?;
    args.output.as_deref().map_or(Ok(()), refuse_input)?;
    let name = &mission.short_name();
    let (snapshot, ground) = &mission.evaluate(args.options.seed, deadline)?;
    let limit = deadline.enforce(Undecided::Review, ("report", args.options.format));
    let mut review = review(snapshot, &args.target.goal()?, args.options.seed, &mut || false);
    let record = args.review.as_deref().map(|path| args.trusted.read(path)).transpose()?.unwrap_or_default();
    let rules = match &args.rules {
        Some(path) => read_rules(path)?,
        None => record.rules().clone(),
    };
    let robustness = if let Some(path) = &args.robustness {
        Some(read_robustness(path, &review.content_hash)?)
    } else {
        let content =
            (args.target.file.as_path(), &**snapshot, &args.target.goal()?, review.content_hash.as_str());
        let repeated = repeat(&record, content, args.options.seed, deadline)?;
        repeated.map(|repeated| repeated.robustness)
    };
    review.hold_against(snapshot, &rules, robustness.as_ref(), &mut || false);
    let page = args.output.as_deref().map(|path| {
        let page = report::html(&report::Document {
            name,
            snapshot,
            review: &review,
            record: Some(&record),
            robustness: robustness.as_ref(),
            seed: args.options.seed,
            ground: ground.as_deref(),
        });
        (path, page)
    });
    limit.answered();
    if let Some((path, page)) = page {
        save(path, &page)?;
    }
    match args.options.format {
        Format::Json => {
            let mut body = review_json(&review);
            body["plan_status"] = json!(standing(&record, &Present::of_review(&review)).status);
            print_json(&document("report", &snapshot.problems, body))?;
        }
        Format::Text => {
            print_problems(name, &snapshot.source, &snapshot.problems)?;
            print_text(&summary(&review))?;
            let standing = standing(&record, &Present::of_review(&review));
            print_text(&format!("{}; approvals: {}\n", standing.status.name(), standing.seats_in_words()))?;
        }
    }
    let status = match (&snapshot.network, review.status) {
        (None, _) => WRONG,
        (_, Status::Failed) => NO,
        _ => YES,
    };
    Ok(exit(status))
}

/// Reads flight rules.
pub fn read_rules(path: &Path) -> anyhow::Result<FlightRules> {
    let rules = FlightRules::from_json(&read_text(path)?);
    rules.map_err(|reason| anyhow::anyhow!("cannot read {}: {reason}", path.display()))
}

/// Reads what `enroute robustness` printed of this very mission.
fn read_robustness(path: &Path, content_hash: &str) -> anyhow::Result<Robustness> {
    let document: Value =
        serde_json::from_str(&read_text(path)?).with_context(|| format!("cannot read {}", path.display()))?;
    anyhow::ensure!(
        document["mission"] == content_hash,
        "{} belongs to another mission, map, goal or path seed; run enroute robustness again",
        path.display()
    );
    let read = || -> Option<Robustness> {
        let settings = &document["settings"];
        let settings = RobustnessSettings {
            runs: settings["runs"].as_u64()?,
            seed: settings["seed"].as_u64()?,
            uncertainty: serde_json::from_value(settings["uncertainty"].clone()).ok()?,
        };
        Some(Robustness { settings, tally: serde_json::from_value(document["tally"].clone()).ok()? })
    };
    read()
        .with_context(|| format!("cannot read {}: expected a document of enroute robustness", path.display()))
}

fn summary(review: &Review) -> String {
    let [passed, attention, failed] = review.counts();
    let information = review.count(Status::Information);
    let need = if attention == 1 { "needs" } else { "need" };
    let mut text = format!(
        "{passed} passed, {attention} {need} attention, {failed} failed; {information} informational\n"
    );
    for section in Section::ALL {
        let lines = review.lines(section).into_iter().filter(|line| line.status > Status::Passed);
        for line in lines {
            let criterion = line.criterion.as_ref().map(|it| format!(" [{it}]")).unwrap_or_default();
            text.push_str(&format!("{}: {}{criterion}\n", line.status.name(), line.text));
        }
    }
    text.push_str(&format!("content {}\n", review.content_hash));
    text
}

fn line_json(line: &Line, more: Value) -> Value {
    let mut value = json!({
        "status": line.status,
        "text": line.text,
        "criterion": line.criterion,
        "span": line.span.map(|span| json!({ "start": span.start, "end": span.end, "line": line.line_number })),
        "names": line.names,
        "place": line.place,
    });
    if let (Value::Object(members), Value::Object(more)) = (&mut value, more) {
        members.extend(more);
    }
    value
}

fn range_json(range: TimeRange) -> Value {
    json!([range.least, range.greatest])
}

fn review_json(review: &Review) -> Value {
    let plain = |lines: &[Line]| lines.iter().map(|line| line_json(line, json!({}))).collect::<Vec<_>>();
    json!({
        "content_hash": review.content_hash,
        "plan_hash": review.plan_hash,
        "status": review.status,
        "rules": review.rules,
        "plan": plain(&review.plan),
        "choices": review.choices.iter().map(|it| line_json(&it.line, json!({
            "decision": it.name,
            "alternatives": it.alternatives.iter().map(|alternative| json!({
                "number": alternative.number,
                "text": alternative.text,
                "fate": alternative.fate.sentence(),
            })).collect::<Vec<_>>(),
        }))).collect::<Vec<_>>(),
        "causal_links": review.causal_links.iter().map(|it| line_json(&it.line, json!({
            "ask": it.ask,
            "tell": it.tell,
            "lead": range_json(it.lead),
            "margin": range_json(it.margin),
        }))).collect::<Vec<_>>(),
        "conflicts": review.conflicts.iter().map(|it| line_json(&it.line, json!({
            "first": it.first,
            "then": it.then,
            "gap": range_json(it.gap),
            "added": it.is_added,
        }))).collect::<Vec<_>>(),
        "states": plain(&review.states),
        "resources": review.resources.iter().map(|it| line_json(&it.line, json!({
            "resource": it.name,
            "spare": it.spare,
            "room": it.room,
        }))).collect::<Vec<_>>(),
        "mission_rules": plain(&review.mission_rules),
        "overlaps": plain(&review.overlaps),
        "durations": plain(&review.durations),
        "robustness": review.robustness.as_ref().map(|line| line_json(line, json!({}))),
        "events": review.events.iter().map(|it| line_json(&it.line, json!({
            "event": it.name,
            "window": [it.window.earliest, it.window.latest],
            "slack": it.slack,
        }))).collect::<Vec<_>>(),
        "traverses": review.traverses.iter().map(|it| line_json(&it.line, json!({
            "activity": it.name,
            "vehicles": it.vehicles,
            "places": it.places,
            "length_m": it.length_m,
            "duration": range_json(it.duration),
            "clearance_m": it.clearance_m,
            "slope_max_rad": it.slope_max_rad,
            "slope_limit_rad": it.slope_limit_rad,
        }))).collect::<Vec<_>>(),
        "encounters": plain(&review.separation_violations),
        "warnings": plain(&review.warnings),
    })
}
