//! `enroute stn`: consistency and windows of a simple temporal network, and, where nature ends some of its durations,
//! whether it is controllable.

mod controllability;

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::anyhow;
use mission::Problem;
use rmpl::{Code, Diagnostic, Span};
use serde_json::{Map, Value, json};
use stn::{Document, Inconsistency, Overflow, ParseError, PointId, Window};

use crate::diagnostics::print_problems;
use crate::input::read_text;
use crate::output::{Format, NO, WRONG, YES, document, exit, print_json, print_text};

/// The file is not a network in the format.
const E_STN: Code = Code("E-STN");

/// Checks an STN file: windows relative to its first time point, or a negative cycle. With contingent links
/// (`.plainStnu`, or `GraphML` of the CSTNU Tool) also whether it is dynamically controllable.
#[derive(clap::Args)]
pub struct Args {
    /// The file; `-` is standard input.
    file: PathBuf,
    /// For whom the answer is.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let source = read_text(&args.file)?;
    if stnu::Document::is_uncertain(&source) {
        return match stnu::Document::parse(&source) {
            Ok(network) => answer_uncertain(args, &network),
            Err(error) => refuse(args, &source, error.line, error.message),
        };
    }
    let network = match stn::parse(&source) {
        Ok(network) => network,
        Err(ParseError { line, message }) => return refuse(args, &source, line, message),
    };
    let (mut stn, consistent) = network.to_stn();
    match consistent {
        Ok(()) => {
            let windows = if network.names.is_empty() {
                Vec::new()
            } else {
                stn.windows(PointId(0)).map_err(|overflow| too_large(&network, overflow))?
            };
            match args.format {
                Format::Text => print_text(&windows_text(&network, &windows))?,
                Format::Json => {
                    let body = json!({ "consistent": true, "windows": windows_json(&network, &windows), "cycle": null });
                    print_json(&document("stn", &[], body))?;
                }
            }
            Ok(exit(YES))
        }
        Err(Inconsistency::NegativeCycle) => {
            match args.format {
                Format::Text => print_text(&cycle_text(&network, &stn))?,
                Format::Json => {
                    let cycle: Vec<Value> =
                        stn.cycle().iter().map(|edge| edge_json(&network, edge)).collect();
                    let body = json!({ "consistent": false, "windows": null, "cycle": cycle });
                    print_json(&document("stn", &[], body))?;
                }
            }
            Ok(exit(NO))
        }
        Err(Inconsistency::Overflow(overflow)) => Err(too_large(&network, overflow)),
    }
}

/// As for plain networks, with contingent links as ordinary bounds, and whether the network is controllable.
fn answer_uncertain(args: &Args, uncertain: &stnu::Document) -> anyhow::Result<ExitCode> {
    let network = controllability::ordinary(uncertain)?;
    let (mut stn, consistent) = network.to_stn();
    match consistent {
        Ok(()) => {}
        Err(Inconsistency::NegativeCycle) => {
            match args.format {
                Format::Text => {
                    print_text(&format!("{}not controllable\n", cycle_text(&network, &stn)))?;
                }
                Format::Json => {
                    let cycle: Vec<Value> =
                        stn.cycle().iter().map(|edge| edge_json(&network, edge)).collect();
                    let body = json!({
                        "consistent": false,
                        "windows": null,
                        "cycle": cycle,
                        "controllable": false,
                        "relaxations": null,
                    });
                    print_json(&document("stn", &[], body))?;
                }
            }
            return Ok(exit(NO));
        }
        Err(Inconsistency::Overflow(overflow)) => return Err(too_large(&network, overflow)),
    }
    let windows = if network.names.is_empty() {
        Vec::new()
    } else {
        stn.windows(PointId(0)).map_err(|overflow| too_large(&network, overflow))?
    };
    let answer = controllability::check(uncertain)?;
    let (is_controllable, cycle, relaxations) = controllability::json(uncertain, &answer);
    match args.format {
        Format::Text => {
            let controllable = controllability::text(uncertain, &answer);
            print_text(&format!("{}{controllable}", windows_text(&network, &windows)))?;
        }
        Format::Json => {
            let body = json!({
                "consistent": true,
                "windows": windows_json(&network, &windows),
                "cycle": cycle,
                "controllable": is_controllable,
                "relaxations": relaxations,
            });
            print_json(&document("stn", &[], body))?;
        }
    }
    Ok(exit(if is_controllable { YES } else { NO }))
}

fn too_large(network: &Document, Overflow { point }: Overflow) -> anyhow::Error {
    anyhow!("a time does not fit into 64 bits: that of {}", network.names[point.index()])
}

/// Says what is wrong with a file.
fn refuse(args: &Args, source: &str, line: usize, message: String) -> anyhow::Result<ExitCode> {
    let problems = Problem::all(&[diagnostic(source, line, message)], source);
    match args.format {
        Format::Text => print_problems(&args.file.display().to_string(), source, &problems)?,
        Format::Json => print_json(&document("stn", &problems, json!({})))?,
    }
    Ok(exit(WRONG))
}

/// The parser's complaint, on the line it is about.
fn diagnostic(source: &str, line: usize, message: String) -> Diagnostic {
    let mut start = 0;
    for line in source.split_inclusive('\n').take(line.saturating_sub(1)) {
        start += line.len();
    }
    let length = source.get(start..).and_then(|rest| rest.lines().next()).map_or(0, str::len);
    Diagnostic::error(E_STN, Span::new(start as u32, (start + length) as u32), message)
}

fn windows_text(network: &Document, windows: &[Window]) -> String {
    let mut text = "consistent\n".to_owned();
    let width = network.names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
    for (name, window) in network.names.iter().zip(windows) {
        let earliest = window.earliest.map_or("-inf".to_owned(), |time| time.to_string());
        let latest = window.latest.map_or("inf".to_owned(), |time| time.to_string());
        text.push_str(&format!("{name:<width$}  [{earliest}, {latest}]\n"));
    }
    text
}

fn cycle_text(network: &Document, stn: &stn::Stn) -> String {
    let total: i128 = stn.cycle().iter().map(|edge| i128::from(edge.weight)).sum();
    let mut text = format!("not consistent: a cycle of weight {total}\n");
    for edge in stn.cycle() {
        let (from, to) = (&network.names[edge.from.index()], &network.names[edge.to.index()]);
        text.push_str(&format!("{from} {} {to}\n", edge.weight));
    }
    text
}

fn windows_json(network: &Document, windows: &[Window]) -> Value {
    let windows = network.names.iter().zip(windows).map(|(name, window)| {
        let earliest = window.earliest.map_or(json!("-inf"), |time| json!(time));
        let latest = window.latest.map_or(json!("inf"), |time| json!(time));
        (name.clone(), json!([earliest, latest]))
    });
    Value::Object(windows.collect::<Map<_, _>>())
}

fn edge_json(network: &Document, edge: &stn::CycleEdge) -> Value {
    json!({
        "from": network.names[edge.from.index()],
        "weight": edge.weight,
        "to": network.names[edge.to.index()],
    })
}
