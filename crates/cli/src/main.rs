//! The `enroute` command: reads the call, runs one command, and turns its answer into an exit status.

mod commands;
mod deadline;
mod diagnostics;
mod ground;
mod input;
mod opened;
mod output;
mod target;
mod trust;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use commands::{
    check, compare, contradict, estimate, execute, explain, export, fmt, hca, import, path, plan,
    reconfigure, report, review, robustness, run, simulate, step, stn, tpn, verify,
};

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
    Fmt(fmt::Args),
    Explain(explain::Args),
    Tpn(tpn::Args),
    Plan(plan::Args),
    Verify(verify::Args),
    Execute(execute::Args),
    Simulate(simulate::Args),
    Robustness(robustness::Args),
    Path(path::Args),
    Stn(stn::Args),
    Hca(hca::Args),
    Step(step::Args),
    Run(run::Args),
    Estimate(estimate::Args),
    Reconfigure(reconfigure::Args),
    Import(import::Args),
    Report(report::Args),
    Review(review::Args),
    Export(export::Args),
    Compare(compare::Args),
    Contradict(contradict::Args),
}

fn main() -> ExitCode {
    let result = match &Cli::parse().command {
        Command::Check(args) => check::run(args),
        Command::Fmt(args) => fmt::run(args),
        Command::Explain(args) => explain::run(args),
        Command::Tpn(args) => tpn::run(args),
        Command::Plan(args) => plan::run(args),
        Command::Verify(args) => verify::run(args),
        Command::Execute(args) => execute::run(args),
        Command::Simulate(args) => simulate::run(args),
        Command::Robustness(args) => robustness::run(args),
        Command::Path(args) => path::run(args),
        Command::Stn(args) => stn::run(args),
        Command::Hca(args) => hca::run(args),
        Command::Step(args) => step::run(args),
        Command::Run(args) => run::run(args),
        Command::Estimate(args) => estimate::run(args),
        Command::Reconfigure(args) => reconfigure::run(args),
        Command::Import(args) => import::run(args),
        Command::Report(args) => report::run(args),
        Command::Review(args) => review::run(args),
        Command::Export(args) => export::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Contradict(args) => contradict::run(args),
    };
    result.unwrap_or_else(|error| {
        output::print_error(&format!("error: {error:#}"));
        let is_late = error.is::<deadline::TimeIsUp>();
        output::exit(if is_late { output::LIMIT } else { output::WRONG })
    })
}
