//! `enroute check`: the diagnostics of mission and program files.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::Context as _;
use mission::{Paths, planning};
use rmpl::program::World;
use serde_json::json;
use snapshot::{Goal, Problem};

use crate::deadline::{Deadline, TimeLimit};
use crate::diagnostics::print_problems;
use crate::ground::ground_or_problem;
use crate::input::{read_mission, read_text};
use crate::load::{is_network, read_network};
use crate::output::{Format, WRONG, YES, any_error, document, exit, print_json, print_text};

/// Reports mistakes in mission and program files.
#[derive(clap::Args)]
pub struct Args {
    /// The files; `-` is standard input.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    time_limit: TimeLimit,
    /// For whom the answer is.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let mut wrong = false;
    let deadline = args.time_limit.start();
    let mut documents = Vec::new();
    for file in &args.files {
        let name = file.display().to_string();
        let source = if is_network(&name, "") { read_text(file)? } else { read_mission(file)? };
        let problems = if is_network(&name, &source) {
            read_network(&name, &source)?.1
        } else {
            check(file, &source, deadline)?
        };
        wrong |= any_error(&problems);
        match args.format {
            Format::Text => print_problems(&name, &source, &problems)?,
            Format::Json => documents.push(document("check", &problems, json!({ "file": name }))),
        }
    }
    match args.format {
        Format::Text if !wrong => print_text("no errors\n")?,
        Format::Text => {}
        // One file gives one document, as every other command does; several give a list of them.
        Format::Json if documents.len() == 1 => print_json(&documents.pop().context("one document")?)?,
        Format::Json => print_json(&json!(documents))?,
    }
    Ok(exit(if wrong { WRONG } else { YES }))
}

/// All that the front end, the compiler of networks and planning have to say about a text, in either notation: what the report
/// says.
fn check(file: &Path, source: &str, deadline: Deadline) -> anyhow::Result<Vec<Problem>> {
    if rmpl::control::is_control_text(source) {
        return Ok(Problem::all(&rmpl::control::parse(source).diagnostics, source));
    }
    let parse = rmpl::parse(source);
    let mut diagnostics = parse.diagnostics();
    // Every scenario is compiled, and without one every activity on its own terms is enough to check the default.
    let program = parse.program();
    let has_ground = program.world != World::default();
    let networks = match (program.scenarios.is_empty(), program.activities.is_empty()) {
        (false, _) => mission::compile_scenarios(&program, &mut diagnostics, has_ground),
        (true, false) => {
            mission::compile(&program, &Goal::Default, &mut diagnostics).map(|network| vec![network])
        }
        (true, true) => Some(Vec::new()),
    };
    let (mut grounds, ground) = ground_or_problem(file, &program.world)?;
    let ground = ground.unwrap_or_else(|problem| {
        diagnostics.push(problem);
        None
    });
    // What planning warns of is about vehicles on the ground.
    if let Some((key, map)) = ground {
        let mut paths = Paths::default();
        for network in networks.into_iter().flatten().map(Arc::new) {
            let problem = planning::Problem {
                ground: Some((&key, &map)),
                options: kirk::Options { explain: false, relax: false, ..kirk::Options::default() },
                ..planning::Problem::new(&network, &program)
            };
            let planned = planning::plan(&problem, &mut grounds, &mut paths, &mut || deadline.is_over());
            deadline.check(&planned.planning.outcome)?;
            for warning in planned.warnings {
                if !diagnostics.contains(&warning) {
                    diagnostics.push(warning);
                }
            }
        }
    }
    Ok(Problem::all(&diagnostics, source))
}
