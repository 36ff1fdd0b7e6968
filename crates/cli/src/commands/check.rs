//! `enroute check`: the diagnostics of mission and program files.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context as _;
use mission::{Manner, Scenarios};
use serde_json::json;
use snapshot::Problem;

use crate::deadline::{Deadline, TimeLimit};
use crate::diagnostics::print_problems;
use crate::opened::Opened;
use crate::output::{Format, WRONG, YES, any_error, document, exit, print_json, print_text};
use crate::target::Target;

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
        let target = Target { file: file.clone(), scenario: None, activity: None, bounds: None };
        let mut mission = target.open()?;
        let problems = check(&mut mission, deadline)?;
        let name = &mission.name;
        wrong |= any_error(&problems);
        match args.format {
            Format::Text => print_problems(name, &mission.source, &problems)?,
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

/// All that the front end, the compilers and planning have to say about a text, in either notation: what the report says.
fn check(mission: &mut Opened, deadline: Deadline) -> anyhow::Result<Vec<Problem>> {
    let Scenarios { program, mut diagnostics, scenarios } = mission.compile_all()?;
    let ground = mission.ground_or_problem(&program.world)?.unwrap_or_else(|problem| {
        diagnostics.push(problem);
        None
    });
    // What planning warns of is about vehicles on the ground.
    for compiled in scenarios.into_iter().filter(|_| ground.is_some()) {
        let evaluated = mission.plan(compiled, ground.clone(), Manner::unexplained(), deadline)?;
        for warning in evaluated.planned.warnings {
            if !diagnostics.contains(&warning) {
                diagnostics.push(warning);
            }
        }
    }
    Ok(Problem::all(&diagnostics, &mission.source))
}
