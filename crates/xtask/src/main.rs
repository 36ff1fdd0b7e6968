//! Builds, serves, tests, benchmarks and packs the page: `cargo xtask --help`.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a command line talks to its user")]

mod bench;
mod documentation;
mod lines;
mod serve;
mod shot;
mod size;
mod test;

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

use anyhow::{Result, ensure};
use clap::{Parser, Subcommand};
use xtask::{
    browser::{Browser, Graphics},
    dist, disturb,
    download::{Download, LIMITS},
    kill::{self, Deaths, Pace, Victim},
    process,
    site::{self, Flavour},
    texts,
};

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
    /// Checks everything: formatting, lints, tests, and the page in headless Chromium.
    Test(test::Options),
    /// Writes the page to `dist/`, for any web server; fails when its download is over the limits.
    Dist,
    /// Prints what the page's download consists of, by file and by crate; fails when it is over the limits.
    Size(size::Options),
    /// Prints the benchmark tables.
    Bench(bench::Options),
    /// Reloads, closes, starves or kills the page while someone types, and counts the key presses that are lost.
    Disturb(Disturbances),
    /// Gives mutated inputs to every reader of other people's data, and prints the results of each reader.
    Fuzz(Fuzzing),
    /// Counts the lines of each crate, without its tests.
    Lines {
        /// Another copy of the repository, to compare with.
        #[arg(long)]
        root: Option<PathBuf>,
    },
    /// Takes a picture of the built page in headless Chromium.
    Shot(shot::Options),
    /// Prints a template for translations: each text of the interface once, with its places, in gettext's format.
    Texts,
}

/// How long each reader is attacked.
#[derive(clap::Args)]
struct Fuzzing {
    /// `--executions N` inputs for each reader, `--reader NAME` for one, `--seed N`, `--input FILE` for one input.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<String>,
}

/// How often the page is disturbed, and with which chance.
#[derive(clap::Args)]
struct Disturbances {
    /// How many disturbances.
    #[arg(long, default_value_t = 100)]
    runs: u32,
    /// Decides what is typed and what happens then.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Takes the page in this folder, such as `dist`, instead of building it.
    #[arg(long)]
    site: Option<PathBuf>,
    /// Kills this browser while someone types, and starts it again, instead of disturbing the page.
    #[arg(long, value_enum)]
    kill: Option<Victim>,
}

fn disturb_page(options: &Disturbances) -> Result<()> {
    let folder = match &options.site {
        Some(folder) => folder.clone(),
        None => site::build(Flavour::Development)?,
    };
    if let Some(victim) = options.kill {
        return kill_browser(victim, &folder, options);
    }
    let browser = Browser::start(Graphics::WebGl2, 1.0)?;
    let losses = disturb::disturb(&browser, &folder, options.runs, options.seed, |made| {
        if made % 100 == 0 {
            eprintln!("{made} of {}", options.runs);
        }
    })?;
    for [found, expected] in &losses.differences {
        eprintln!("expected {expected:?}\nfound    {found:?}");
    }
    print!("{losses}");
    ensure!(losses.lost() == 0, "{} key presses were lost (seed {})", losses.lost(), options.seed);
    Ok(())
}

fn kill_browser(victim: Victim, folder: &Path, options: &Disturbances) -> Result<()> {
    let deaths = kill::kill(victim, folder, options.runs, options.seed, Pace::Random, |so_far| {
        if so_far.kills % 25 == 0 {
            eprintln!("{so_far}");
        }
    })?;
    println!("{}\n{deaths}", Deaths::HEADING);
    let late = deaths.inexcusable();
    ensure!(late == 0, "{late} lost keys were pressed long before the kill (seed {})", options.seed);
    Ok(())
}

/// Builds the page and packs it into the folder `dist`, which it returns.
fn pack_release() -> Result<PathBuf> {
    let dist = process::root().join("dist");
    dist::pack(&site::build(Flavour::Release)?, &dist)?;
    dist::compress(&dist)?;
    Ok(dist)
}

fn write_dist() -> Result<()> {
    let dist = pack_release()?;
    let download = Download::of(&dist)?;
    print!("{download}");
    println!("{}", dist.display());
    download.check(LIMITS)
}

fn main() -> ExitCode {
    if let Some(outcome) = documentation::in_place_of_rustdoc() {
        return outcome;
    }
    let outcome = match Arguments::parse().task {
        Task::Serve(options) => serve::run(&options),
        // The count of what passed and failed is the last line; nothing is to be said after it.
        Task::Test(options) => match test::run_parts(&options) {
            Ok(true) => Ok(()),
            Ok(false) => return ExitCode::FAILURE,
            Err(reason) => Err(reason),
        },
        Task::Dist => write_dist(),
        Task::Size(options) => size::run(&options),
        Task::Bench(options) => bench::run_all(&options),
        Task::Disturb(options) => disturb_page(&options),
        Task::Fuzz(fuzzing) => process::run(
            process::cargo().args(["run", "--quiet", "--package", "fuzz", "--"]).args(fuzzing.arguments),
        ),
        Task::Lines { root } => lines::print(&root.unwrap_or_else(process::root)),
        Task::Shot(options) => shot::run(&options),
        Task::Texts => {
            print!("{}", texts::template());
            Ok(())
        }
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("error: {reason:#}");
            ExitCode::FAILURE
        }
    }
}
