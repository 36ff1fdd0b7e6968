//! `enroute import`: a network that another tool wrote, as one of ours; places and obstacles as lines of a mission; a problem
//! in PDDL as a mission; a model that is a program elsewhere as one of ours.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context as _;
use interchange::Source;
use interchange::geojson::{self, Frame};
use interchange::jmpl;
use interchange::pamela;
use interchange::pddl;
use serde_json::{Value, json};
use snapshot::Problem;

use super::import_models::{import_jmpl, import_pamela};
use crate::input::read_text;
use crate::number::number_in;
use crate::output::{Format, YES, document, exit, print_error, print_json, print_text, print_verbatim};

/// Convert a file of another tool.
///
/// A network is printed as enroute tpn prints it. Places, obstacles, vehicles and groups in GeoJSON or CSV are printed as declarations, for a file that a mission imports. A PDDL domain and a problem of it are printed as a mission. A model of Livingstone (JMPL) is printed as a plant model, and a file of Pamela as a mission or a plant model; what these cannot express is listed on standard error.
#[derive(clap::Args)]
pub struct Args {
    /// plan-schema (JSON or EDN), enroute-tpn document, pTPN, PlanDev (Aerie) plan, GeoJSON, CSV of places, PDDL domain, JMPL, or Pamela; - reads standard input.
    file: PathBuf,
    /// Problem of the PDDL domain; more files of a JMPL model (.jmpl, .hrn, .ini), or folders of them.
    more: Vec<PathBuf>,
    /// How often each action may happen (PDDL) [default: 1].
    #[arg(long, value_name = "N", value_parser = number_in(1..=pddl::MAX_TIMES))]
    times: Option<u32>,
    /// Leave out the metric: any plan counts, which is found sooner (PDDL).
    #[arg(long)]
    any_plan: bool,
    /// Longitude and latitude of the mission origin in degrees (GeoJSON) [default: south-west corner].
    #[arg(long, value_name = "LON,LAT", value_parser = parse_degrees, allow_hyphen_values = true)]
    origin: Option<[f64; 2]>,
    /// Radius of the body in meters (GeoJSON) [default: 6371008.8, Earth].
    #[arg(long, value_name = "METERS", value_parser = parse_radius)]
    radius: Option<f64>,
    /// Read the coordinates as meters (GeoJSON).
    #[arg(long = "meters", alias = "metres", conflicts_with_all = ["origin", "radius"])]
    meters: bool,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let text = read_text(&args.file)?;
    let name = args.file.display().to_string();
    let has_frame = args.meters || args.origin.is_some() || args.radius.is_some();
    let is_pddl = pddl::is_pddl(&text);
    anyhow::ensure!(
        !has_frame || (!is_pddl && is_places(&name, &text)),
        "{name} is not GeoJSON or CSV; remove --origin, --radius and --meters, which only these need"
    );
    if is_pddl {
        return import_pddl(args, (&name, &text));
    }
    anyhow::ensure!(
        args.times.is_none() && !args.any_plan,
        "{name} is not a PDDL domain; remove --times and --any-plan, which only PDDL needs"
    );
    if jmpl::is_jmpl(&name) {
        return import_jmpl(&args.file, text, &args.more, args.format);
    }
    anyhow::ensure!(args.more.is_empty(), "{name} is neither a PDDL domain nor JMPL; give one file only");
    if pamela::is_pamela(&name) {
        return import_pamela(&args.file, &text, args.format);
    }
    if is_places(&name, &text) {
        let frame = Frame { is_meters: args.meters, origin_deg: args.origin, radius_m: args.radius };
        let lines =
            geojson::declarations(&name, &text, &frame).with_context(|| format!("cannot read {name}"))?;
        match args.format {
            Format::Json => print_json(&document("places", &[], json!({ "rmpl": lines })))?,
            Format::Text => print_verbatim(&lines)?,
        }
        return Ok(exit(YES));
    }
    if !interchange::is_network_text(&text) {
        let is_control = rmpl::control::is_control_text(&text);
        anyhow::ensure!(!is_control, "{name} is a control program; use `enroute run`");
        anyhow::ensure!(
            !is_mission(&args.file, &text),
            "{name} is a mission; use `enroute plan` or `enroute tpn`"
        );
    }
    let source = Source::read(&text).with_context(|| format!("cannot read {}", args.file.display()))?;
    let not_planned = match &source {
        Source::Enroute(_) => Vec::new(),
        Source::PlanSchema(document) => document.not_planned.clone(),
    };
    let not_honored = source.not_honored();
    let told = (!not_honored.is_empty()).then(|| rmpl::diagnostics::network::not_honored(&not_honored));
    let network = source.into_network();
    match args.format {
        Format::Json => {
            let mut body = tpn::network_json::network_to_json(&network);
            body["not_planned"] = not_planned.into();
            print_json(&document("tpn", &Problem::all(told.as_slice(), ""), body))?;
        }
        Format::Text => {
            print_text(&tpn::text::to_text(&network))?;
            if !not_planned.is_empty() {
                print_text(&format!("ignored (no effect on planning): {}\n", not_planned.join(", ")))?;
            }
            if let Some(told) = told {
                print_error(&format!("warning: {}", told.message));
            }
        }
    }
    Ok(exit(YES))
}

/// Prints a problem in PDDL as a mission. Prints what the mission leaves out or changes on standard error.
fn import_pddl(args: &Args, domain: (&str, &str)) -> anyhow::Result<ExitCode> {
    let [path] = &*args.more else {
        anyhow::bail!(
            "{} is PDDL; give the domain and the problem, as in enroute import DOMAIN PROBLEM",
            domain.0
        )
    };
    let problem = (path.display().to_string(), read_text(path)?);
    let settings = pddl::Settings { times: args.times.unwrap_or(1), has_metric: !args.any_plan };
    let read = pddl::translate(domain, (&problem.0, &problem.1), settings);
    let read = read.context("cannot read the problem as a mission")?;
    match args.format {
        Format::Json => {
            let body = json!({ "rmpl": read.mission, "remarks": read.remarks });
            print_json(&document("rmpl", &[], body))?;
        }
        Format::Text => {
            print_verbatim(&read.mission)?;
            read.remarks.iter().for_each(|remark| print_error(&format!("note: {remark}")));
        }
    }
    Ok(exit(YES))
}

/// Returns whether a text that is not a network is a mission: by the name of its file, or because it declares what to
/// do.
fn is_mission(file: &Path, text: &str) -> bool {
    let program = rmpl::parse(text).program();
    let is_named_so = file.extension().is_some_and(|extension| extension == "rmpl");
    is_named_so || !(program.scenarios.is_empty() && program.activities.is_empty())
}

fn is_places(name: &str, text: &str) -> bool {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    name.to_ascii_lowercase().ends_with(".geojson")
        || geojson::is_table(name)
        || serde_json::from_str::<Value>(text).is_ok_and(|document| geojson::is_geojson(&document))
}

pub fn parse_degrees(text: &str) -> Result<[f64; 2], String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[lon, lat]) if lon.abs() <= 360.0 && lat.abs() <= 90.0 => Ok([lon, lat]),
        _ => Err("expected a longitude and a latitude in degrees, as in 77.45,18.44".to_owned()),
    }
}

pub fn parse_radius(text: &str) -> Result<f64, String> {
    let radius: Option<f64> = text.parse().ok();
    radius
        .filter(|it| geojson::BODY_RADII_M.contains(it))
        .ok_or_else(|| "expected a number of meters from 1 to 1,000,000,000".to_owned())
}
