//! `enroute stn`: consistency and windows of a simple temporal network, and, where the environment ends some of its
//! durations, whether it is controllable.

mod controllability;

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::anyhow;
use rmpl::{Code, Diagnostic, Span};
use serde_json::{Map, Value, json};
use snapshot::Problem;
use stn::{Inconsistency, Overflow, PointId, Stn, Window};
use stnu::{Document, ParseError};

use self::controllability::Controllability;
use crate::diagnostics::print_problems;
use crate::input::read_text;
use crate::output::{Format, NO, WRONG, YES, column, document, exit, print_json, print_text};

/// The file's times were rounded.
const W_ROUNDED: Code = Code("W-ROUNDED");
/// The file is not a network in the format.
const E_STN: Code = Code("E-STN");

/// Check a simple temporal network (STN): windows, or a negative cycle.
///
/// Windows are relative to the first time point. A file with contingent links (.plainStnu, or GraphML of the CSTNU Tool) is also checked for dynamic controllability.
#[derive(clap::Args)]
pub struct Args {
    /// STN or STNU file; - reads standard input.
    file: PathBuf,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let source = read_text(&args.file)?;
    let network = match Document::parse(&source) {
        Ok(network) => network,
        Err(ParseError { line, message }) => return refuse(args, &source, line, message),
    };
    let has_nature = Document::is_uncertain(&source);
    let problems = rounding(&network, &source);
    if args.format == Format::Text {
        print_problems(&args.file.display().to_string(), &source, &problems)?;
    }
    let (mut stn, consistent) = controllability::ordinary(&network)?;
    let windows = match consistent {
        Ok(()) if network.names.is_empty() => Vec::new(),
        Ok(()) => stn.windows(PointId(0)).map_err(|overflow| too_large(&network, overflow))?,
        Err(Inconsistency::NegativeCycle) => {
            return inconsistent(args, &network, &stn, has_nature, &problems);
        }
        Err(Inconsistency::Overflow(overflow)) => return Err(too_large(&network, overflow)),
    };
    let answer = if has_nature { Some(controllability::check(&network)?) } else { None };
    match args.format {
        Format::Text => {
            let controllable = answer.as_ref().map(|answer| controllability::text(&network, answer));
            print_text(&format!("{}{}", windows_text(&network, &windows), controllable.unwrap_or_default()))?;
        }
        Format::Json => {
            let mut body =
                json!({ "consistent": true, "windows": windows_json(&network, &windows), "cycle": null });
            if let Some(answer) = &answer {
                let (is_controllable, cycle, relaxations) = controllability::json(&network, answer);
                body["controllable"] = json!(is_controllable);
                body["cycle"] = cycle;
                body["relaxations"] = relaxations;
            }
            print_json(&document("stn", &problems, body))?;
        }
    }
    let is_kept = answer.is_none_or(|answer| matches!(answer, Controllability::Controllable));
    Ok(exit(if is_kept { YES } else { NO }))
}

/// The answer where the environment's help is not enough.
fn inconsistent(
    args: &Args,
    network: &Document,
    stn: &Stn,
    has_nature: bool,
    problems: &[Problem],
) -> anyhow::Result<ExitCode> {
    match args.format {
        Format::Text => {
            let controllable = if has_nature { "not controllable\n" } else { "" };
            print_text(&format!("{}{controllable}", cycle_text(network, stn)))?;
        }
        Format::Json => {
            let cycle: Vec<Value> = stn.cycle().iter().map(|edge| edge_json(network, edge)).collect();
            let mut body = json!({ "consistent": false, "windows": null, "cycle": cycle });
            if has_nature {
                body["controllable"] = json!(false);
                body["relaxations"] = Value::Null;
            }
            print_json(&document("stn", problems, body))?;
        }
    }
    Ok(exit(NO))
}

/// Says so where the file's times were rounded.
fn rounding(network: &Document, source: &str) -> Vec<Problem> {
    if !network.is_rounded {
        return Vec::new();
    }
    let message = "the times have no common part within 64 bits, and were rounded to billionths: constraints to the \
                   tighter side, contingent links to the wider one";
    Problem::all(&[Diagnostic::warning(W_ROUNDED, Span::new(0, 0), message)], source)
}

fn too_large(network: &Document, Overflow { point }: Overflow) -> anyhow::Error {
    anyhow!("the time of {} does not fit into 64 bits", network.names[point.index()])
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
    let names = column(network.names.iter().map(String::as_str));
    for (name, window) in names.iter().zip(windows) {
        let earliest = window.earliest.map_or("-inf".to_owned(), |tick| network.time(tick).to_string());
        let latest = window.latest.map_or("inf".to_owned(), |tick| network.time(tick).to_string());
        text.push_str(&format!("{name}  [{earliest}, {latest}]\n"));
    }
    text
}

fn cycle_text(network: &Document, stn: &Stn) -> String {
    let total: i128 = stn.cycle().iter().map(|edge| i128::from(edge.weight)).sum();
    // A sum over a whole cycle may leave 64 bits; then it is told in ticks.
    let total = i64::try_from(total).map_or(total.to_string(), |total| network.time(total).to_string());
    let mut text = format!("inconsistent: negative cycle of weight {total}\n");
    for edge in stn.cycle() {
        let (from, to) = (&network.names[edge.from.index()], &network.names[edge.to.index()]);
        text.push_str(&format!("{from} {} {to}\n", network.time(edge.weight)));
    }
    text
}

fn windows_json(network: &Document, windows: &[Window]) -> Value {
    let windows = network.names.iter().zip(windows).map(|(name, window)| {
        let earliest = window.earliest.map_or(json!("-inf"), |tick| json!(network.time(tick)));
        let latest = window.latest.map_or(json!("inf"), |tick| json!(network.time(tick)));
        (name.clone(), json!([earliest, latest]))
    });
    Value::Object(windows.collect::<Map<_, _>>())
}

fn edge_json(network: &Document, edge: &stn::CycleEdge) -> Value {
    json!({
        "from": network.names[edge.from.index()],
        "weight": network.time(edge.weight),
        "to": network.names[edge.to.index()],
    })
}
