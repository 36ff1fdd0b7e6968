//! Builds, serves, tests, benchmarks and packs the page: `cargo xtask --help`.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a command line talks to its user")]

mod serve;
mod shot;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Builds, serves, tests, benchmarks and packs the page.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Builds the page and serves it on a loopback address; rebuilds and reloads it when a source changes.
    Serve(serve::Options),
    /// Takes a picture of the built page in headless Chromium.
    Shot(shot::Options),
}

fn main() -> ExitCode {
    let outcome = match Arguments::parse().task {
        Task::Serve(options) => serve::run(&options),
        Task::Shot(options) => shot::run(&options),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("error: {reason:#}");
            ExitCode::FAILURE
        }
    }
}
