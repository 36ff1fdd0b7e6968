//! `enroute compare`: what differs between two plans, by name.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context as _;
use review::Record;
use review::compare::{Change, Comparison, Side, compare};
use review::record::is_record;
use serde_json::{Value, json};
use snapshot::{Goal, Problem};
use tpn::Window;

use crate::diagnostics::print_problems;
use crate::input::{mission_of, read_text};
use crate::opened::Opened;
use crate::output::{Format, NO, WRONG, YES, any_error, document, exit, print_json, print_text};
use crate::target::{PlanOptions, Target};
use crate::trust::Trusted;

/// Compare two plans.
///
/// If the plans differ, the exit status is 1.
#[derive(clap::Args)]
pub struct Args {
    /// Old plan: a mission, a plan in JSON, or an approved review in JSON; - reads standard input.
    before: PathBuf,
    /// New plan, in any of the same forms.
    after: PathBuf,
    /// Scenario to plan, where a mission is given [default: first in file].
    #[arg(long)]
    scenario: Option<String>,
    #[command(flatten)]
    trusted: Trusted,
    #[command(flatten)]
    options: PlanOptions,
}

/// One side, read.
struct Read {
    side: Side,
    source: String,
    problems: Vec<Problem>,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let (before, after) = (args.read(&args.before)?, args.read(&args.after)?);
    let comparison = compare(&before.side, &after.side);
    let is_wrong = any_error(&before.problems) || any_error(&after.problems);
    match args.options.format {
        Format::Json => {
            let problems: Vec<Problem> = before.problems.iter().chain(&after.problems).cloned().collect();
            print_json(&document("compare", &problems, body(&before.side, &after.side, &comparison)))?;
        }
        Format::Text => {
            for read in [&before, &after] {
                // Warnings are about one mission; here only what prevents a plan matters.
                if any_error(&read.problems) {
                    print_problems(&read.side.name, &read.source, &read.problems)?;
                }
            }
            print_text(&text(&before.side, &after.side, &comparison))?;
        }
    }
    Ok(exit(match (is_wrong, comparison.is_same() && before.side.is_planned == after.side.is_planned) {
        (true, _) => WRONG,
        (_, true) => YES,
        (_, false) => NO,
    }))
}

impl Args {
    fn read(&self, path: &Path) -> anyhow::Result<Read> {
        let name = path.display().to_string();
        let text = read_text(path)?;
        let is_json = path.extension().is_some_and(|ending| ending == "json")
            || (name == "-" && text.trim_start().starts_with('{'));
        if !is_json {
            let target = Target {
                file: path.to_owned(),
                scenario: self.scenario.clone(),
                activity: None,
                bounds: None,
            };
            return self.evaluated(path, &mission_of(path, &text)?, target.goal()?, self.options.seed);
        }
        let value: Value = serde_json::from_str(&text).with_context(|| format!("{name}: invalid JSON"))?;
        if is_record(&value) {
            let mut record = Record::from_json(&text).with_context(|| format!("cannot read {name}"))?;
            self.trusted.judge(&mut record)?;
            let approved = record.last_approval();
            let (_, approved) = approved.with_context(|| {
                format!("the review {name} has no approval by a trusted key, so it names no plan")
            })?;
            return self.evaluated(path, &approved.source, approved.goal.clone(), approved.seed);
        }
        let side = Side::of_json(&name, &value).with_context(|| format!("cannot read {name}"))?;
        Ok(Read { side, source: String::new(), problems: Vec::new() })
    }

    fn evaluated(&self, file: &Path, source: &str, goal: Goal, seed: u64) -> anyhow::Result<Read> {
        let name = file.display().to_string();
        let deadline = self.options.time_limit.start();
        let mission = Opened::new(file, source.to_owned(), goal);
        let (snapshot, _) = mission.evaluate(seed, deadline).with_context(|| name.clone())?;
        let side = Side::of_snapshot(&name, &snapshot);
        Ok(Read { side, source: source.to_owned(), problems: snapshot.problems.to_vec() })
    }
}

fn text(before: &Side, after: &Side, comparison: &Comparison) -> String {
    let stands = |side: &Side| if side.is_planned { "" } else { " (no plan)" };
    let mut out = format!(
        "before: {}{}\nafter:  {}{}\n{}\n",
        before.name,
        stands(before),
        after.name,
        stands(after),
        comparison.summary()
    );
    for difference in &comparison.differences {
        out.push_str(&format!("  {}\n", difference.sentence()));
    }
    out
}

fn body(before: &Side, after: &Side, comparison: &Comparison) -> Value {
    let side = |side: &Side| json!({ "name": side.name, "planned": side.is_planned });
    let counts: serde_json::Map<String, Value> = Change::ALL
        .into_iter()
        .zip(comparison.counts())
        .map(|(change, count)| (change.name().to_owned(), count.into()))
        .collect();
    let windows: serde_json::Map<String, Value> = comparison
        .rows
        .iter()
        .map(|row| {
            let windows = |windows: Option<[Window; 2]>| windows.map(|pair| pair.map(window_json));
            (row.name.clone(), json!({ "before": windows(row.before), "after": windows(row.after) }))
        })
        .collect();
    json!({
        "same": comparison.is_same(),
        "before": side(before),
        "after": side(after),
        "counts": counts,
        "differences": comparison.differences,
        "windows": windows,
    })
}

fn window_json(window: Window) -> Value {
    json!([window.earliest, window.latest])
}
