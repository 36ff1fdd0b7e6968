//! `enroute review`: checks the history of a review, and says how its plan stands with its board.

use std::path::PathBuf;
use std::process::ExitCode;

use review::record::{Entry, RecordError, Runs, short};
use review::{PlanStatus, Present, Record, Standing, review, standing};
use serde_json::{Value, json};

use crate::deadline::Undecided;
use crate::input::read_text;
use crate::output::{Format, NO, YES, document, exit, print_json, print_text};
use crate::target::{PlanOptions, Target};

/// Checks the history of a review, and says how the plan stands with its board.
///
/// The exit status is 0 if the history is as it was written and, where a mission is given, the board has approved that
/// mission; it is 1 if the history has been altered or the mission is not approved.
#[derive(clap::Args)]
pub struct Args {
    /// The history, as the page saves it; `-` is standard input.
    review: PathBuf,
    /// The mission that is to be approved; otherwise what the last entry is about.
    #[arg(long, value_name = "FILE")]
    mission: Option<PathBuf>,
    /// The scenario of the mission; the first one by default.
    #[arg(long, requires = "mission")]
    scenario: Option<String>,
    #[command(flatten)]
    options: PlanOptions,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let text = read_text(&args.review)?;
    let record = match Record::from_json(&text) {
        Ok(record) => record,
        Err(RecordError::Broken(why)) => {
            match args.options.format {
                Format::Json => {
                    print_json(&document("review-check", &[], json!({ "intact": false, "reason": why })))?;
                }
                Format::Text => print_text(&format!("the history has been altered: {why}\n"))?,
            }
            return Ok(exit(NO));
        }
        Err(other) => anyhow::bail!("cannot use {}: {other}", args.review.display()),
    };
    let Some(mission) = &args.mission else {
        let last = record.entries().iter().rev().find(|entry| !entry.content_hash.is_empty());
        let plan_hash = last.map(|entry| entry.plan_hash.as_str()).filter(|hash| !hash.is_empty());
        let content_hash = last.map_or("", |entry| entry.content_hash.as_str());
        let present = Present { content_hash, plan_hash, rules: record.rules(), review: None };
        args.answer(&record, &standing(&record, &present), content_hash)?;
        return Ok(exit(YES));
    };
    let target =
        Target { file: mission.clone(), scenario: args.scenario.clone(), activity: None, bounds: None };
    let deadline = args.options.time_limit.start();
    let (snapshot, _) = target.open()?.evaluate(args.options.seed, deadline)?;
    let limit = deadline.enforce(Undecided::Review);
    let mut review = review(&snapshot, &target.goal()?, args.options.seed, &mut || false);
    let found = record.runs_of(&review.content_hash).map(Runs::robustness);
    review.hold_against(&snapshot, record.rules(), found.as_ref(), &mut || false);
    let standing = standing(&record, &Present::of_review(&review));
    limit.answered();
    args.answer(&record, &standing, &review.content_hash)?;
    Ok(exit(if standing.status.is_approved() { YES } else { NO }))
}

impl Args {
    fn answer(&self, record: &Record, standing: &Standing<'_>, content_hash: &str) -> anyhow::Result<()> {
        let blockers = if self.mission.is_some() { standing.blockers() } else { Vec::new() };
        match self.options.format {
            Format::Json => {
                print_json(&document("review-check", &[], body(record, standing, content_hash, &blockers)))
            }
            Format::Text => print_text(&words(record, standing, content_hash, &blockers)),
        }
    }
}

fn words(record: &Record, standing: &Standing<'_>, content_hash: &str, blockers: &[String]) -> String {
    let count = record.entries().len();
    let entries = if count == 1 { "entry" } else { "entries" };
    let mut out = format!("the history is as it was written: {count} {entries}\n");
    for (index, entry) in record.entries().iter().enumerate() {
        out.push_str(&format!("{:>4}  {}\n", index + 1, told(record, entry)));
    }
    out.push_str(&format!(
        "{}: {}; content {}\n",
        standing.status.name(),
        standing.seats_in_words(),
        short(content_hash)
    ));
    if let (PlanStatus::Lapsed, Some((last, why))) = (standing.status, standing.lapsed) {
        out.push_str(&format!("{} approved {}: {why}\n", last.by, last.time));
    }
    if !standing.open_comments.is_empty() && blockers.is_empty() {
        out.push_str(&format!("open comments: {}\n", standing.open_comments.len()));
    }
    for blocker in blockers {
        out.push_str(&format!("in the way: {blocker}\n"));
    }
    for head in record.heads() {
        out.push_str(&format!("last entry {head}\n"));
    }
    out
}

/// An entry in one line.
fn told(record: &Record, entry: &Entry) -> String {
    let role = if entry.role.is_empty() { String::new() } else { format!(" ({})", entry.role) };
    let number =
        |of: &str| record.entries().iter().position(|it| it.digest() == of).map_or(0, |index| index + 1);
    let of = entry.act.of().map(|of| format!(" entry {}", number(of))).unwrap_or_default();
    let text = match entry.act.text().replace('\n', " ") {
        text if text.is_empty() => text,
        text => format!(": {text}"),
    };
    let taken_back = record.withdrawn().get(entry.digest()).map(|by| format!(" [taken back by {}]", by.by));
    let taken_back = taken_back.unwrap_or_default();
    format!("{}  {}{role} {}{of}{text}{taken_back}", entry.time, entry.by, entry.act.name())
}

fn body(record: &Record, standing: &Standing<'_>, content_hash: &str, blockers: &[String]) -> Value {
    let withdrawn = record.withdrawn();
    let entries = record.entries().iter().map(|entry| {
        json!({
            "digest": entry.digest(),
            "said": entry.raw(),
            "withdrawn_by": withdrawn.get(entry.digest()).map(|by| &by.by),
        })
    });
    let seats = standing.seats.iter().map(|seat| {
        let given: Vec<&str> = seat.given.iter().map(|entry| entry.by.as_str()).collect();
        json!({ "role": seat.role, "wanted": seat.wanted, "given": given })
    });
    json!({
        "intact": true,
        "mission": record.mission,
        "plan_status": standing.status,
        "content_hash": content_hash,
        "board": seats.collect::<Vec<Value>>(),
        "open_comments": standing.open_comments.len(),
        "blockers": blockers,
        "heads": record.heads().collect::<Vec<&str>>(),
        "entries": entries.collect::<Vec<Value>>(),
    })
}
