//! `enroute export`: a plan's schedule in the formats of other tools.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context as _;
use clap::ValueEnum;
use interchange::geojson::{EARTH_RADIUS_M, Projection};
use report::calendar::Calendar;
use report::export;
use review::{PlanStatus, Present, content_hash, review, standing};
use serde_json::{Value, json};
use snapshot::Snapshot;

use crate::commands::import::{parse_degrees, parse_radius};
use crate::deadline::Deadline;
use crate::diagnostics::print_problems;
use crate::output::{Format, NO, WRONG, YES, document, exit, print_error, print_json, print_verbatim};
use crate::repeated::repeat;
use crate::save::{refuse_input, save};
use crate::target::{PlanOptions, Target};
use crate::trust::Trusted;

/// Export a schedule (CSV, JSON, Open MCT, iCalendar, PlanDev, GeoJSON, PDDL).
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// File format.
    #[arg(long = "as", value_enum, value_name = "FORMAT")]
    form: Form,
    /// Start of the mission, as in 2004-01-25 or 2004-01-25T05:05:00Z; adds dates. Open MCT, iCalendar and
    /// PlanDev need it.
    #[arg(
        long,
        value_name = "ISO-DATE",
        required_if_eq("form", "icalendar"),
        required_if_eq("form", "open-mct"),
        required_if_eq("form", "plandev")
    )]
    epoch: Option<String>,
    /// Longitude and latitude of the mission origin in degrees (GeoJSON).
    #[arg(
        long,
        value_name = "LON,LAT",
        value_parser = parse_degrees,
        allow_hyphen_values = true,
        required_if_eq("form", "geojson")
    )]
    origin: Option<[f64; 2]>,
    /// Radius of the body in meters (GeoJSON) [default: 6371008.8, Earth].
    #[arg(long, value_name = "METERS", value_parser = parse_radius)]
    radius: Option<f64>,
    /// Review history; adds the approval status to the export.
    #[arg(long, value_name = "REVIEW.json")]
    review: Option<PathBuf>,
    #[command(flatten)]
    trusted: Trusted,
    /// Write to FILE instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    options: PlanOptions,
}

/// The formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Form {
    /// Comma-separated values with windows and slack.
    Csv,
    /// JSON with everything that is known of the schedule.
    Json,
    /// Plan for Open MCT.
    OpenMct,
    /// iCalendar file.
    Icalendar,
    /// Plan for PlanDev (Aerie).
    #[value(name = "plandev")]
    PlanDev,
    /// Places, obstacles and paths in GeoJSON.
    #[value(name = "geojson")]
    GeoJson,
    /// PDDL plan.
    #[value(name = "pddl")]
    Pddl,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let mission = args.target.open()?;
    args.output.as_deref().map_or(Ok(()), refuse_input)?;
    let name = mission.short_name();
    let deadline = args.options.time_limit.start();
    let (snapshot, _) = mission.evaluate(args.options.seed, deadline)?;
    let is_planned = snapshot.plan().is_some();
    if args.options.format == Format::Text {
        print_problems(&name, &snapshot.source, &snapshot.problems)?;
    }
    if !is_planned {
        match args.options.format {
            Format::Json => {
                print_json(&document("export", &snapshot.problems, json!({ "status": "no-plan" })))?;
            }
            Format::Text => print_error("the mission has no plan, so there is no schedule to export"),
        }
        return Ok(exit(if snapshot.network.is_some() { NO } else { WRONG }));
    }
    let text = args.text(&snapshot, deadline)?;
    match &args.output {
        Some(path) => {
            save(path, &text)?;
            if args.options.format == Format::Json {
                let body = json!({ "status": "written", "file": path.display().to_string() });
                print_json(&document("export", &snapshot.problems, body))?;
            }
        }
        None => print_verbatim(&text)?,
    }
    Ok(exit(YES))
}

impl Args {
    fn text(&self, snapshot: &Snapshot, deadline: Deadline) -> anyhow::Result<String> {
        let goal = self.target.goal()?;
        let record = self.review.as_deref().map(|path| self.trusted.read(path)).transpose()?;
        let hash = content_hash(&snapshot.source, snapshot.map.as_ref(), &goal, self.options.seed);
        let status = match record {
            None => PlanStatus::Draft,
            Some(record) => {
                let content = (self.target.file.as_path(), snapshot, &goal, hash.as_str());
                let repeated = repeat(&record, content, self.options.seed, deadline)?;
                let mut review = review(snapshot, &goal, self.options.seed, &mut || false);
                let found = repeated.map(|repeated| repeated.robustness);
                review.hold_against(snapshot, record.rules(), found.as_ref(), &mut || false);
                standing(&record, &Present::of_review(&review)).status
            }
        };
        let calendar = self.epoch.as_deref().map(|epoch| calendar(epoch, snapshot)).transpose()?;
        let calendar = calendar.as_ref();
        let about = export::About { content_hash: &hash, status, calendar, pins: &[], plan: None };
        let beyond = "the schedule does not fit into the calendar of years 1 to 9999";
        let written = |document: Value| Ok(format!("{}\n", serde_json::to_string_pretty(&document)?));
        match self.form {
            Form::Csv => export::csv(snapshot, &about).context(beyond),
            Form::Json => written(export::json(snapshot, &about).context(beyond)?),
            Form::OpenMct => written(export::open_mct(snapshot, &about).context(beyond)?),
            Form::PlanDev => written(report::plandev::plandev(snapshot, &about).context(beyond)?),
            Form::GeoJson => {
                let origin_deg = self.origin.unwrap_or_default();
                let radius_m = self.radius.unwrap_or(EARTH_RADIUS_M);
                written(report::geojson::geojson(snapshot, &Projection::Degrees { origin_deg, radius_m }))
            }
            Form::Pddl => report::pddl::pddl(snapshot, &about).context(beyond),
            Form::Icalendar => export::icalendar(snapshot, &about).context(beyond),
        }
    }
}

fn calendar(epoch: &str, snapshot: &Snapshot) -> anyhow::Result<Calendar> {
    Calendar::new(epoch, snapshot.program.options.time_unit).with_context(|| {
        format!("--epoch expects a date, as in 2004-01-25 or 2004-01-25T05:05:00Z, not `{epoch}`")
    })
}
