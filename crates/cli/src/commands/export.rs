//! `enroute export`: a plan's schedule in the formats of other tools.

use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context as _;
use clap::ValueEnum;
use mission::review::content_hash;
use report::calendar::Calendar;
use report::export;
use serde_json::json;

use crate::deadline::TimeLimit;
use crate::diagnostics::print_problems;
use crate::load::Target;
use crate::output::{Format, NO, WRONG, YES, document, exit, print_json, print_verbatim};
use crate::worked_out::{WorkedOut, work_out};

/// Writes a plan's schedule for other tools.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// The format.
    #[arg(long = "as", value_enum, value_name = "FORMAT")]
    form: Form,
    /// When the mission starts, as 2004-01-25 or 2004-01-25T05:05:00Z; needed where times are dates.
    #[arg(
        long,
        value_name = "ISO-DATE",
        required_if_eq("form", "icalendar"),
        required_if_eq("form", "open-mct")
    )]
    epoch: Option<String>,
    /// Writes to a file instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Seeds path planning.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    time_limit: TimeLimit,
    /// For whom the answer is where there is no schedule.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// The formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Form {
    /// Comma-separated values with windows and slack.
    Csv,
    /// A plan for Open MCT.
    OpenMct,
    /// A calendar.
    Icalendar,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let worked_out = work_out(&args.target, args.seed, args.time_limit.start())?;
    let WorkedOut { name, snapshot, .. } = &worked_out;
    let is_planned = snapshot.plan().is_some();
    if args.format == Format::Text {
        print_problems(name, &snapshot.source, &snapshot.problems)?;
    }
    if !is_planned {
        match args.format {
            Format::Json => {
                print_json(&document("export", &snapshot.problems, json!({ "status": "no-plan" })))?;
            }
            Format::Text => writeln!(std::io::stderr(), "no plan, so there is no schedule")?,
        }
        return Ok(exit(if snapshot.network.is_some() { NO } else { WRONG }));
    }
    let text = args.text(&worked_out)?;
    match &args.output {
        Some(path) => {
            std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))?;
        }
        None => print_verbatim(&text)?,
    }
    Ok(exit(YES))
}

impl Args {
    fn text(&self, WorkedOut { snapshot, .. }: &WorkedOut) -> anyhow::Result<String> {
        let beyond = "the schedule does not fit into the calendar";
        match self.form {
            Form::Csv => export::csv(snapshot).context("no plan"),
            Form::OpenMct => {
                let plan = export::open_mct(snapshot, &self.calendar(snapshot)?).context(beyond)?;
                Ok(format!("{}\n", serde_json::to_string_pretty(&plan)?))
            }
            Form::Icalendar => {
                let hash =
                    content_hash(&snapshot.source, snapshot.map.as_ref(), &self.target.goal()?, self.seed);
                export::icalendar(snapshot, &self.calendar(snapshot)?, &hash).context(beyond)
            }
        }
    }

    fn calendar(&self, snapshot: &mission::Snapshot) -> anyhow::Result<Calendar> {
        let epoch = self.epoch.as_deref().unwrap_or_default();
        Calendar::new(epoch, snapshot.program.options.time_unit).with_context(|| {
            format!("--epoch wants a date such as 2004-01-25 or 2004-01-25T05:05:00Z, not `{epoch}`")
        })
    }
}
