//! `enroute report`: reviews a mission, and writes the review as one HTML file.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context as _;
use mission::review::{Line, Record, Review, Section, Status, TimeRange, review};
use serde_json::{Value, json};

use crate::deadline::TimeLimit;
use crate::diagnostics::print_problems;
use crate::input::read_text;
use crate::load::Target;
use crate::output::{Format, NO, WRONG, YES, document, exit, print_json, print_text};
use crate::worked_out::{WorkedOut, work_out};

/// Reviews a mission: a checklist of its plan, and a report that prints and needs no network.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// Writes the report as one HTML file.
    #[arg(short, long, value_name = "OUT.html", required_if_eq("format", "text"))]
    output: Option<PathBuf>,
    /// Comments and sign-offs, as the page saves them, to stand in the report.
    #[arg(long, value_name = "REVIEW.json")]
    record: Option<PathBuf>,
    /// Seeds path planning.
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
    let worked_out = work_out(&args.target, args.seed, args.time_limit.start())?;
    let WorkedOut { name, snapshot, ground } = &worked_out;
    let review = review(snapshot, &args.target.goal()?, args.seed, &mut || false);
    let record = match &args.record {
        Some(path) => {
            let text = read_text(path)?;
            Some(Record::from_json(&text).with_context(|| format!("cannot read {}", path.display()))?)
        }
        None => None,
    };
    if let Some(path) = &args.output {
        let page = report::html(&report::Document {
            name,
            snapshot,
            review: &review,
            record: record.as_ref(),
            robustness: None,
            seed: args.seed,
            ground: ground.as_deref(),
        });
        std::fs::write(path, page).with_context(|| format!("cannot write {}", path.display()))?;
    }
    match args.format {
        Format::Json => print_json(&document("report", &snapshot.problems, review_json(&review)))?,
        Format::Text => {
            print_problems(name, &snapshot.source, &snapshot.problems)?;
            print_text(&summary(&review))?;
        }
    }
    let status = match (&snapshot.network, review.status) {
        (None, _) => WRONG,
        (_, Status::Failed) => NO,
        _ => YES,
    };
    Ok(exit(status))
}

fn summary(review: &Review) -> String {
    let [passed, attention, failed] = review.counts();
    let mut text = format!("{passed} passed, {attention} for attention, {failed} failed\n");
    for section in Section::ALL {
        let lines = review.lines(section).into_iter().filter(|line| line.status != Status::Passed);
        for line in lines {
            text.push_str(&format!("{}: {}\n", line.status.name(), line.text));
        }
    }
    text.push_str(&format!("content {}\n", review.content_hash));
    text
}

fn line_json(line: &Line, more: Value) -> Value {
    let mut value = json!({
        "status": line.status,
        "text": line.text,
        "span": line.span.map(|span| json!({ "start": span.start, "end": span.end, "line": line.line_number })),
        "names": line.names,
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
        "status": review.status,
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
        }))).collect::<Vec<_>>(),
        "encounters": plain(&review.separation_violations),
        "warnings": plain(&review.warnings),
    })
}
