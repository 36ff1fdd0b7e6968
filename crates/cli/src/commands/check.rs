//! `enroute check`: the diagnostics of mission and program files.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context as _;
use mission::{Goal, Problem};
use serde_json::json;

use crate::diagnostics::print_problems;
use crate::input::read_mission;
use crate::output::{Format, WRONG, YES, any_error, document, exit, print_json, print_text};

/// Reports mistakes in mission and program files.
#[derive(clap::Args)]
pub struct Args {
    /// The files; `-` is standard input.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// For whom the answer is.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let mut wrong = false;
    let mut documents = Vec::new();
    for file in &args.files {
        let source = read_mission(file)?;
        let problems = check(&source);
        wrong |= any_error(&problems);
        let name = file.display().to_string();
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

/// All that the front end and the compiler of networks have to say about a text, in either notation.
fn check(source: &str) -> Vec<Problem> {
    if rmpl::control::is_control_text(source) {
        return Problem::all(&rmpl::control::parse(source).diagnostics, source);
    }
    let parse = rmpl::parse(source);
    let mut diagnostics = parse.diagnostics();
    // Every scenario is compiled, and without one every activity on its own terms is enough to check the default.
    let program = parse.program();
    let goals: Vec<Goal> =
        program.scenarios.iter().map(|scenario| Goal::Scenario(scenario.name.text.clone())).collect();
    let is_library = program.scenarios.is_empty() && program.activities.is_empty();
    let goals = if goals.is_empty() && !is_library { vec![Goal::Default] } else { goals };
    for goal in goals {
        mission::compile(&program, &goal, &mut diagnostics);
    }
    Problem::all(&diagnostics, source)
}
