//! The `enroute` command: reads the call, runs one command, and turns its answer into an exit status.

mod commands;
mod deadline;
mod diagnostics;
mod ground;
mod input;
mod number;
mod opened;
mod output;
mod repeated;
mod save;
mod target;
mod trust;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{ArgMatches, CommandFactory as _, FromArgMatches as _, Parser, Subcommand};

use crate::output::{E_CALL, E_INPUT, E_TIME, Format, LIMIT, WRONG, YES};
use commands::{
    check, compare, contradict, estimate, execute, explain, export, fmt, hca, import, path, plan, prove,
    reconfigure, report, review, robustness, run, schema, simulate, step, stn, tpn, verify,
};

/// Plan, check and explain missions written in RMPL.
#[derive(Parser)]
#[command(name = "enroute", version, arg_required_else_help = true, max_term_width = 80)]
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
    Prove(prove::Args),
    Estimate(estimate::Args),
    Reconfigure(reconfigure::Args),
    #[command(visible_alias = "convert")]
    Import(import::Args),
    Report(report::Args),
    Review(review::Args),
    Export(export::Args),
    Compare(compare::Args),
    Contradict(contradict::Args),
    Schema(schema::Args),
}

fn main() -> ExitCode {
    let arguments: Vec<OsString> = std::env::args_os().collect();
    let matches = Cli::command().try_get_matches_from(&arguments);
    match matches.and_then(|matches| Ok((answer_to(&matches), Cli::from_arg_matches(&matches)?))) {
        Ok(((kind, format), call)) => run(&call, (&kind, format)),
        Err(error) => refuse(&error, &arguments),
    }
}

/// The kind of document and the format that answer a call.
fn answer_to(matches: &ArgMatches) -> (String, Format) {
    let Some((name, mut arguments)) = matches.subcommand() else { return (UNKNOWN.to_owned(), Format::Text) };
    while let Some((_, inner)) = arguments.subcommand() {
        arguments = inner;
    }
    let format = arguments.try_get_one("format").ok().flatten().copied().unwrap_or_default();
    (kind_of(name), format)
}

/// The kind of the documents of a command that does not exist.
const UNKNOWN: &str = "call";

/// The kind of a command's documents.
fn kind_of(command: &str) -> String {
    let kind = match command {
        "review" => "review-check",
        "import" => "tpn",
        _ if Cli::command().find_subcommand(command).is_some() => command,
        _ => UNKNOWN,
    };
    kind.to_owned()
}

/// Answers a call that is wrong, or that asks for help.
fn refuse(error: &clap::Error, arguments: &[OsString]) -> ExitCode {
    let mut words = arguments.iter().map(|word| word.to_string_lossy());
    let is_json = words.any(|word| word == "--format=json")
        || arguments.windows(2).any(|pair| pair[0] == "--format" && pair[1] == "json");
    if !error.use_stderr() || !is_json {
        // Where no one reads any more, there is no one to tell.
        let _ = error.print();
        return output::exit(if error.use_stderr() { WRONG } else { YES });
    }
    let command = arguments.iter().skip(1).find(|word| !word.to_string_lossy().starts_with('-'));
    let kind = kind_of(&command.map(|command| command.to_string_lossy()).unwrap_or_default());
    let message = error.to_string();
    let message = message.trim_start_matches("error: ").trim_end();
    output::print_failure((&kind, Format::Json), E_CALL, message);
    output::exit(WRONG)
}

/// Runs a command; what keeps it from its answer is an answer, too.
fn run(call: &Cli, answer: (&str, Format)) -> ExitCode {
    let result = match &call.command {
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
        Command::Prove(args) => prove::run(args),
        Command::Reconfigure(args) => reconfigure::run(args),
        Command::Import(args) => import::run(args),
        Command::Report(args) => report::run(args),
        Command::Review(args) => review::run(args),
        Command::Export(args) => export::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Contradict(args) => contradict::run(args),
        Command::Schema(args) => schema::run(args),
    };
    result.unwrap_or_else(|error| {
        let is_late = error.is::<deadline::TimeIsUp>();
        let (code, status) = if is_late { (E_TIME, LIMIT) } else { (E_INPUT, WRONG) };
        output::print_failure(answer, code, &format!("{error:#}"));
        output::exit(status)
    })
}
