//! `enroute tpn`: the temporal plan network of a mission, in one of several notations.

use std::process::ExitCode;

use anyhow::Context as _;
use clap::ValueEnum;
use interchange::Source;
use interchange::plan_schema::Document;
use mission::Compiled;
use serde_json::json;
use snapshot::Problem;
use tpn::Network;

use crate::diagnostics::print_problems;
use crate::output::{Format, NO, YES, document, exit, print_error, print_json, print_text, print_verbatim};
use crate::target::Target;

/// Compile a mission to its temporal plan network (TPN).
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// Notation [default: text, or json with --format json].
    #[arg(long = "as", value_enum, value_name = "NOTATION")]
    notation: Option<Notation>,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// What a network can be written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Notation {
    /// Document enroute-tpn/1.
    Json,
    /// Human-readable listing.
    Text,
    /// Graphviz.
    Dot,
    /// SVG drawing, as in the page.
    Svg,
    /// Interchange format plan-schema of other planners.
    PlanSchema,
    /// XML of MIT's MERS group, as RMPyL writes it.
    #[value(name = "ptpn")]
    Ptpn,
    /// RMPL mission, if the network's structure allows one.
    Rmpl,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let notation = args.notation.unwrap_or(match args.format {
        Format::Text => Notation::Text,
        Format::Json => Notation::Json,
    });
    let mut mission = args.target.open()?;
    let compiled = mission.compile()?;
    let problems = compiled.problems();
    let Some(network) = compiled.network() else {
        let format = if notation == Notation::Json { Format::Json } else { args.format };
        return mission.refuse(&problems, format, ("tpn", json!({ "nodes": [], "arcs": [] })));
    };
    if notation != Notation::Json {
        print_problems(&mission.name, &mission.source, &problems)?;
    }
    match notation {
        Notation::Json => {
            print_json(&document("tpn", &problems, tpn::network_json::network_to_json(network)))?;
        }
        Notation::Text => print_text(&tpn::text::to_text(network))?,
        Notation::Dot => print_verbatim(&tpn::text::to_dot(network))?,
        Notation::Svg => print_verbatim(&drawing(network))?,
        Notation::Ptpn => {
            print_verbatim(
                &interchange::ptpn::write(network).context("the network cannot be written as a pTPN")?,
            )?;
        }
        Notation::Rmpl => return print_rmpl(&compiled, network, &problems, args.format),
        // A file that was plan-schema is written as it was read, with what is not understood; anything else is translated.
        Notation::PlanSchema => print_json(&match as_read(&compiled) {
            Some(read) => read.to_json(),
            None => interchange::plan_schema::write(network),
        })?,
    }
    Ok(exit(YES))
}

/// The file of another tool.
fn as_read(compiled: &Compiled) -> Option<Box<Document>> {
    match Source::read(&compiled.source) {
        Ok(Source::PlanSchema(read)) if compiled.is_network => Some(read),
        _ => None,
    }
}

/// The network as a mission's text, or what keeps it from being one.
fn print_rmpl(
    compiled: &Compiled,
    network: &Network,
    problems: &[Problem],
    format: Format,
) -> anyhow::Result<ExitCode> {
    let (mut nodes, mut arcs, mut remarks) = (Vec::new(), Vec::new(), Vec::new());
    if let Some(read) = as_read(compiled) {
        remarks.extend(read.not_honored().iter().map(|said| format!("Not honored: {said}.")));
        (nodes, arcs) = (read.node_uids, read.arc_uids);
    }
    match (interchange::rmpl_text::write(network, &remarks), format) {
        (Ok(text), Format::Text) => print_verbatim(&text)?,
        (Ok(text), Format::Json) => print_json(&document("rmpl", problems, json!({ "rmpl": text })))?,
        (Err(obstacle), format) => {
            let told = obstacle.told(network, &nodes, &arcs);
            match format {
                Format::Text => print_error(&format!("the network cannot be written in RMPL: {told}")),
                Format::Json => {
                    print_json(&document("rmpl", problems, json!({ "rmpl": null, "obstacle": told })))?;
                }
            }
            return Ok(exit(NO));
        }
    }
    Ok(exit(YES))
}

fn drawing(network: &Network) -> String {
    let drawing = layout::network(network, &layout::Options::default(), &display::approximate_text_width);
    let list = layout::network_list(&drawing, network, &layout::NetworkState::default());
    display::svg(&[&list], display::Theme::Light, "Temporal plan network")
}
