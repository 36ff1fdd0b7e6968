//! `enroute schema`: the JSON Schema of the documents that commands print with `--format json`.

use std::process::ExitCode;

use crate::output::{YES, exit, print_verbatim};

/// Tests hold the documents of all commands against it.
const SCHEMA: &str = include_str!("../schema.json");

/// Print the JSON Schema of all documents that commands print as JSON.
#[derive(clap::Args)]
pub struct Args {}

/// Runs the command.
pub fn run(_: &Args) -> anyhow::Result<ExitCode> {
    print_verbatim(SCHEMA)?;
    Ok(exit(YES))
}
