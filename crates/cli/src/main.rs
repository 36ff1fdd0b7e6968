//! The `enroute` command: reads the call, runs one command, and turns its answer into an exit status.

mod commands;
mod input;
mod output;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Plans, checks and explains missions written in RMPL.
#[derive(Parser)]
#[command(name = "enroute", version, about, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {}

fn main() -> ExitCode {
    let result: anyhow::Result<ExitCode> = match Cli::parse().command {};
    result
}
