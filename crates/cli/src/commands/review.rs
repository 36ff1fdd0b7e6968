//! `enroute review verify`: checks the history of a review, and says whether the board approved a content.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Subcommand;
use review::names::one_line;
use review::record::{Entry, RecordError, short};
use review::rules::RequiredRules;
use review::{Check, PlanStatus, Present, Record, Review, Standing, Waiver, WaiverState, review, standing};
use serde_json::{Value, json};
use snapshot::Goal;

use crate::deadline::Undecided;
use crate::input::read_text;
use crate::opened::Opened;
use crate::output::{Format, NO, YES, document, exit, print_json, print_text};
use crate::repeated::{Repeated, repeat};
use crate::target::{PlanOptions, Target};
use crate::trust::Trusted;

/// Verify the history of a review.
#[derive(clap::Args)]
#[command(disable_help_subcommand = true)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Verify(Box<Verify>),
}

/// Verify signatures and dates, and whether the board approved the content.
///
/// If the history was altered, or trusted keys have not approved the content, the exit status is 1.
#[derive(clap::Args)]
struct Verify {
    /// Review history, as the page saves it; - reads standard input.
    file: PathBuf,
    /// Mission to look for in the history [default: text of the last approval].
    #[arg(long, value_name = "FILE")]
    mission: Option<PathBuf>,
    /// Scenario of the mission [default: first in file].
    #[arg(long, requires = "mission")]
    scenario: Option<String>,
    #[command(flatten)]
    trusted: Trusted,
    /// Flight rules and board that must be in force, as far as this file gives them.
    #[arg(long, value_name = "RULES.json")]
    rules: Option<PathBuf>,
    /// Digest of an entry that the history must contain; may be repeated.
    #[arg(long, value_name = "DIGEST")]
    has: Vec<String>,
    #[command(flatten)]
    options: PlanOptions,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let Command::Verify(args) = &args.command;
    args.run()
}

/// A content, reviewed.
struct Reviewed {
    review: Review,
    source: String,
    /// Its Monte Carlo runs, if the history has some.
    repeated: Option<Repeated>,
}

/// What was found of a history.
struct Found<'a> {
    repeated: Option<Repeated>,
    record: &'a Record,
    standing: Standing<'a>,
    content_hash: &'a str,
    blockers: Vec<String>,
}

impl Found<'_> {
    fn is_approved(&self) -> bool {
        self.standing.status.is_approved() && self.blockers.is_empty()
    }
}

impl Verify {
    fn run(&self) -> anyhow::Result<ExitCode> {
        let mut record = match Record::from_json(&read_text(&self.file)?) {
            Ok(record) => record,
            Err(RecordError::Broken(why)) => return self.refuse(&why),
            Err(other) => anyhow::bail!("cannot use {}: {other}", self.file.display()),
        };
        self.trusted.judge(&mut record)?;
        let required = self.required_rules()?;
        if required.as_ref().is_some_and(|it| it.names_board() && it.differences(record.rules()).is_empty()) {
            record.confirm_rules();
        }
        if let Some(missing) = self.has.iter().find(|digest| record.entry(digest).is_none()) {
            return self.refuse(&format!("the entry {missing} is missing"));
        }
        let found = self.review(&record)?;
        let (review, repeated) = match found {
            Some(Reviewed { review, source, repeated }) => {
                record.learn_source(&review.content_hash, &source);
                (Some(review), repeated)
            }
            None => (None, None),
        };
        let (present, content_hash) = if let Some(review) = &review {
            (Present::of_review(review), review.content_hash.as_str())
        } else {
            let last = record.entries().iter().rev().find(|entry| !entry.content_hash.is_empty());
            let content_hash = last.map_or("", |entry| entry.content_hash.as_str());
            let rules = record.rules();
            (Present { content_hash, plan_hash: None, rules, review: None }, content_hash)
        };
        let standing = standing(&record, &present);
        let mut blockers = standing.blockers();
        if record.last_approval().is_none() {
            let none = if self.trusted.is_empty() {
                "no keys are trusted; name them with --trust"
            } else {
                "no trusted key has approved the content"
            };
            blockers.push(none.to_owned());
        }
        let differences = required.iter().flat_map(|required| required.differences(record.rules()));
        let differences: Vec<&str> = differences.collect();
        if !differences.is_empty() {
            blockers.push(format!("not the required flight rules: {}", differences.join(", ")));
        }
        let found = Found { repeated, record: &record, standing, content_hash, blockers };
        match self.options.format {
            Format::Json => print_json(&document("review-check", &[], body(&found)))?,
            Format::Text => print_text(&words(&found))?,
        }
        Ok(exit(if found.is_approved() { YES } else { NO }))
    }

    /// The rules that have to be in force.
    fn required_rules(&self) -> anyhow::Result<Option<RequiredRules>> {
        let Some(path) = &self.rules else { return Ok(None) };
        let rules = RequiredRules::from_json(&read_text(path)?);
        let cannot = |reason: String| anyhow::anyhow!("cannot use {}: {reason}", path.display());
        rules.map(Some).map_err(cannot)
    }

    /// The history is not whole.
    fn refuse(&self, why: &str) -> anyhow::Result<ExitCode> {
        match self.options.format {
            Format::Json => {
                let body = json!({ "intact": false, "approved": false, "reason": why });
                print_json(&document("review-check", &[], body))?;
            }
            Format::Text => print_text(&format!("the history was altered: {why}\n"))?,
        }
        Ok(exit(NO))
    }

    /// The review of the mission, or of the text that was approved last; nothing if there is neither.
    fn review(&self, record: &Record) -> anyhow::Result<Option<Reviewed>> {
        let (file, mission, goal, seed) = match (&self.mission, record.last_approval()) {
            (Some(file), _) => {
                let (path, scenario) = (file.clone(), self.scenario.clone());
                let target = Target { file: path, scenario, activity: None, bounds: None };
                (file, target.open()?, target.goal()?, self.options.seed)
            }
            (None, Some((_, approved))) => {
                let goal: Goal = approved.goal.clone();
                let mission = Opened::new(&self.file, approved.source.clone(), goal.clone());
                (&self.file, mission, goal, approved.seed)
            }
            (None, None) => return Ok(None),
        };
        let deadline = self.options.time_limit.start();
        let (snapshot, _) = mission.evaluate(seed, deadline)?;
        let limit = deadline.enforce(Undecided::Review, ("review-check", self.options.format));
        let mut review = review(&snapshot, &goal, seed, &mut || false);
        let content = (file.as_path(), &*snapshot, &goal, review.content_hash.as_str());
        let repeated = repeat(record, content, seed, deadline)?;
        let found = repeated.as_ref().map(|repeated| &repeated.robustness);
        review.hold_against(&snapshot, record.rules(), found, &mut || false);
        limit.answered();
        Ok(Some(Reviewed { review, source: snapshot.source.to_string(), repeated }))
    }
}

fn words(found: &Found<'_>) -> String {
    let Found { repeated, record, standing, content_hash, blockers } = found;
    let count = record.entries().len();
    let entries = if count == 1 { "entry" } else { "entries" };
    let mut out = format!("history intact: {count} {entries}\n");
    out.push_str(&match record.history() {
        "" => "history id: none\n".to_owned(),
        history => format!("history id: {history}\n"),
    });
    for (index, (entry, check)) in record.checked().enumerate() {
        out.push_str(&format!("{:>4}  {}\n", index + 1, told(record, entry, check)));
    }
    out.push_str(&format!(
        "{}; approvals: {}; content {}\n",
        standing.status.name(),
        standing.seats_in_words(),
        short(content_hash)
    ));
    out.push_str(&format!("board: {}; {}\n", record.rules().board_in_words(), set_by(&record.board_by())));
    out.push_str(&format!(
        "flight rules: {}; {}\n",
        short(&record.rules().digest()),
        set_by(&record.rules_by())
    ));
    if let Some(repeated) = repeated {
        out.push_str(&format!("Monte Carlo: {}\n", repeated.sentence()));
    }
    for proposal in record.proposals() {
        out.push_str(&format!(
            "proposed board: {}; {}; {}\n",
            proposal.rules.board_in_words(),
            set_by(&proposal.by),
            proposal.consent()
        ));
    }
    if let (PlanStatus::Lapsed, Some((last, why))) = (standing.status, standing.lapsed) {
        out.push_str(&format!("{} approved {}: {why}\n", last.by, last.time));
    }
    for Waiver { entry, line, until, state } in &standing.waivers {
        let lapses = if *state == WaiverState::Lapsed { "lapsed" } else { "lapses" };
        let text = one_line(&line.text);
        out.push_str(&format!("waiver {}, {lapses} {until}, by {}: {text}\n", state.name(), entry.by));
    }
    for blocker in blockers {
        out.push_str(&format!("blocked: {blocker}\n"));
    }
    for head in record.heads() {
        out.push_str(&format!("last entry {head}\n"));
    }
    out
}

/// Returns who set rules, and when.
fn set_by(entries: &[&Entry]) -> String {
    if entries.is_empty() {
        return "default, no one has set any".to_owned();
    }
    let by = entries.iter().map(|entry| format!("{} {}", entry.by, entry.time));
    format!("set by {}", by.collect::<Vec<_>>().join(", "))
}

/// An entry in one line.
fn told(record: &Record, entry: &Entry, check: &Check) -> String {
    let role = if entry.role.is_empty() { String::new() } else { format!(" ({})", entry.role) };
    let of = entry.act.of().map(|of| format!(" entry {}", record.number(of))).unwrap_or_default();
    let text = match one_line(entry.act.text()) {
        text if text.is_empty() => text,
        text => format!(": {text}"),
    };
    let taken_back = record.withdrawn().get(entry.digest()).map(|by| format!(" [withdrawn by {}]", by.by));
    let taken_back = taken_back.unwrap_or_default();
    let check = record.words_of(entry, check);
    format!("{}  {}{role} {}{of}{text}{taken_back} [{check}]", entry.time, entry.by, entry.act.name())
}

fn body(found: &Found<'_>) -> Value {
    let Found { repeated, record, standing, content_hash, blockers } = found;
    let withdrawn = record.withdrawn();
    let entries = record.checked().map(|(entry, check)| {
        json!({
            "digest": entry.digest(),
            "said": entry.raw(),
            "signature": check.signature,
            "problem": check.problem,
            "counts": check.counts(),
            "without_effect": record.without_effect(entry),
            "withdrawn_by": withdrawn.get(entry.digest()).map(|by| &by.by),
        })
    });
    let seats = standing.seats.iter().map(|seat| {
        let given: Vec<&str> = seat.given.iter().map(|entry| entry.by.as_str()).collect();
        json!({ "role": seat.role, "wanted": seat.wanted, "given": given })
    });
    let waivers = standing.waivers.iter().map(|waiver| {
        json!({
            "item": waiver.line,
            "reason": waiver.entry.act.text(),
            "by": waiver.entry.by,
            "until": waiver.until,
            "state": waiver.state,
        })
    });
    let by = |entries: &[&Entry]| {
        let by = |entry: &&Entry| json!({ "by": entry.by, "role": entry.role, "key": entry.key, "time": entry.time, "entry": entry.digest() });
        entries.iter().map(by).collect::<Vec<Value>>()
    };
    let proposals = record.proposals().into_iter().map(|proposal| {
        json!({
            "rules": proposal.rules,
            "by": by(&proposal.by),
            "agreed": proposal.agreed,
            "wanted": proposal.wanted,
        })
    });
    let rules = json!({
        "in_force": record.rules(),
        "digest": record.rules().digest(),
        "by": by(&record.rules_by()),
        "board_by": by(&record.board_by()),
        "proposed": proposals.collect::<Vec<Value>>(),
    });
    json!({
        "intact": true,
        "approved": found.is_approved(),
        "mission": record.mission,
        "history": record.history(),
        "plan_status": standing.status,
        "content_hash": content_hash,
        "board": seats.collect::<Vec<Value>>(),
        "rules": rules,
        "robustness": repeated.as_ref().map(Repeated::json),
        "open_comments": standing.open_comments.len(),
        "blockers": blockers,
        "waivers": waivers.collect::<Vec<Value>>(),
        "heads": record.heads().collect::<Vec<&str>>(),
        "entries": entries.collect::<Vec<Value>>(),
    })
}
