//! The `enroute` command: reads the call, runs one command, and turns its answer into an exit status.

mod commands;
mod input;
mod load;
mod output;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use commands::{check, explain, path, plan, stn};

/// Plans, checks and explains missions written in RMPL.
#[derive(Parser)]
#[command(name = "enroute", version, about, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Check(check::Args),
    Explain(explain::Args),
    Path(path::Args),
    Plan(plan::Args),
    Stn(stn::Args),
}

fn main() -> ExitCode {
    let result = match &Cli::parse().command {
        Command::Check(args) => check::run(args),
        Command::Explain(args) => explain::run(args),
        Command::Path(args) => path::run(args),
        Command::Plan(args) => plan::run(args),
        Command::Stn(args) => stn::run(args),
    };
    result.unwrap_or_else(|error| {
        eprintln!("error: {error:#}");
        output::exit(output::WRONG)
    })
}
