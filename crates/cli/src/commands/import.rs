//! `enroute import`: a network that another tool wrote, as one of ours; places and obstacles as lines of a mission.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context as _;
use interchange::Source;
use interchange::geojson::{self, Frame};
use serde_json::{Value, json};

use crate::input::read_text;
use crate::output::{Format, YES, document, exit, print_json, print_text, print_verbatim};

/// Reads a network that another tool wrote, and prints it as `enroute tpn` would; or places and obstacles in `GeoJSON`, and
/// prints their declarations, for a file that a mission imports.
#[derive(clap::Args)]
pub struct Args {
    /// A plan-schema file in JSON or EDN, an enroute-tpn document, a pTPN, a plan of `PlanDev` (Aerie), or `GeoJSON`; `-` is standard
    /// input.
    file: PathBuf,
    /// The longitude and latitude in degrees that are at (0, 0) of the mission; of `GeoJSON`, whose south-west corner it is
    /// otherwise.
    #[arg(long, value_name = "LON,LAT", value_parser = parse_degrees, allow_hyphen_values = true)]
    origin: Option<[f64; 2]>,
    /// The radius of the body in metres on which `GeoJSON` has its degrees; otherwise the Earth's, 6371008.8.
    #[arg(long, value_name = "METRES", value_parser = parse_radius)]
    radius: Option<f64>,
    /// The coordinates of `GeoJSON` are metres already.
    #[arg(long, conflicts_with_all = ["origin", "radius"])]
    metres: bool,
    /// For whom the answer is.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let text = read_text(&args.file)?;
    let name = args.file.display().to_string();
    if is_places(&name, &text) {
        let frame = Frame { is_metres: args.metres, origin_deg: args.origin, radius_m: args.radius };
        let lines =
            geojson::declarations(&name, &text, &frame).with_context(|| format!("cannot read {name}"))?;
        match args.format {
            Format::Json => print_json(&document("places", &[], json!({ "rmpl": lines })))?,
            Format::Text => print_verbatim(&lines)?,
        }
        return Ok(exit(YES));
    }
    anyhow::ensure!(
        !args.metres && args.origin.is_none() && args.radius.is_none(),
        "{name} is no GeoJSON, which --origin, --radius and --metres are for"
    );
    let source = Source::read(&text).with_context(|| format!("cannot read {}", args.file.display()))?;
    let not_planned = match &source {
        Source::Enroute(_) => Vec::new(),
        Source::PlanSchema(document) => document.not_planned.clone(),
    };
    let network = source.into_network();
    match args.format {
        Format::Json => {
            let mut body = tpn::network_json::network_to_json(&network);
            body["not_planned"] = not_planned.into();
            print_json(&document("tpn", &[], body))?;
        }
        Format::Text => {
            print_text(&tpn::text::to_text(&network))?;
            if !not_planned.is_empty() {
                print_text(&format!("without meaning for planning: {}\n", not_planned.join(", ")))?;
            }
        }
    }
    Ok(exit(YES))
}

fn is_places(name: &str, text: &str) -> bool {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    name.to_ascii_lowercase().ends_with(".geojson")
        || serde_json::from_str::<Value>(text).is_ok_and(|document| geojson::is_geojson(&document))
}

pub fn parse_degrees(text: &str) -> Result<[f64; 2], String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[lon, lat]) if lon.abs() <= 360.0 && lat.abs() <= 90.0 => Ok([lon, lat]),
        _ => Err("a longitude and a latitude in degrees, such as 77.45,18.44".to_owned()),
    }
}

pub fn parse_radius(text: &str) -> Result<f64, String> {
    let radius: Option<f64> = text.parse().ok();
    radius
        .filter(|it| geojson::BODY_RADII_M.contains(it))
        .ok_or_else(|| "a number of metres, from 1 to 1,000,000,000".to_owned())
}
