//! The same problems through Enroute and through other programs that solve them, in one run, as Markdown tables.
//!
//! `cargo xtask bench --peers` builds and runs this. What a peer needs is set up below the work folder: a virtual
//! environment, an npm folder, a compiled program. A peer that is not there is a line "not run: why", never a failure.

mod automata;
mod language;
mod layouts;
mod network;
mod paths;
mod planner;
mod stopwatch;
mod table;
mod tools;

use std::path::PathBuf;

use anyhow::Result;
use clap::Parser;

use crate::tools::Tools;

/// What to compare.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
enum Subject {
    /// First plans of random missions: CP-SAT, Z3, aries.
    Planner,
    /// First plans of missions by families: aries.
    Families,
    /// Shortest schedules of activities that share resources, proven: aries, CP-SAT.
    Resources,
    /// Days with more wishes than room, and stops in any order, proven: CP-SAT.
    Objectives,
    /// Simple temporal networks, arc by arc: aries.
    Stn,
    /// Drawings of networks: Graphviz, ELK, dagre, rust-sugiyama.
    Layout,
    /// Paths on maps: OMPL.
    Paths,
    /// Parsing and parsing again: tree-sitter.
    Language,
    /// Steps of an automaton: `XState`.
    Automata,
}

/// The command line.
#[derive(Parser)]
struct Options {
    /// Only this; may be given several times.
    #[arg(long)]
    only: Vec<Subject>,
    /// Where instances go and where the peers are set up.
    #[arg(long, default_value = "target/peers")]
    work: PathBuf,
    /// Fewer and smaller instances, to see that everything runs.
    #[arg(long)]
    quick: bool,
    /// Of the families only those whose names begin like this; may be given several times.
    #[arg(long)]
    family: Vec<String>,
}

fn main() -> Result<()> {
    let options = Options::parse();
    let mut tools = Tools::new(&options.work)?;
    let all = [
        Subject::Planner,
        Subject::Families,
        Subject::Resources,
        Subject::Objectives,
        Subject::Stn,
        Subject::Layout,
        Subject::Paths,
        Subject::Language,
        Subject::Automata,
    ];
    for subject in all {
        if !options.only.is_empty() && !options.only.contains(&subject) {
            continue;
        }
        match subject {
            Subject::Planner => planner::compare(&mut tools, options.quick)?,
            Subject::Families => planner::families::compare(&options.family, options.quick),
            Subject::Resources => planner::resources::compare(&mut tools, options.quick)?,
            Subject::Objectives => planner::objectives::compare(&mut tools, options.quick)?,
            Subject::Stn => network::compare(options.quick),
            Subject::Layout => layouts::compare(&mut tools, options.quick)?,
            Subject::Paths => paths::compare(&mut tools, options.quick)?,
            Subject::Language => language::compare(options.quick)?,
            Subject::Automata => automata::compare(&mut tools, options.quick)?,
        }
    }
    Ok(())
}
