//! `enroute import`: a network that another tool wrote, as one of ours.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context as _;
use tpn::interchange::Source;

use crate::input::read_text;
use crate::load::read_source;
use crate::output::{Format, YES, document, exit, print_json, print_text};

/// Reads a network that another tool wrote, and prints it as `enroute tpn` would.
#[derive(clap::Args)]
pub struct Args {
    /// A plan-schema file in JSON or EDN, an enroute-tpn document, or a plan of `PlanDev` (Aerie); `-` is standard input.
    file: PathBuf,
    /// For whom the answer is.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let text = read_text(&args.file)?;
    let source = read_source(&text).with_context(|| format!("cannot read {}", args.file.display()))?;
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
