//! `enroute check`: the diagnostics of mission and program files.

use std::path::PathBuf;
use std::process::ExitCode;

use mission::{Manner, Scenarios};
use serde_json::{Value, json};
use snapshot::Problem;

use crate::deadline::{Deadline, TimeLimit, Undecided};
use crate::diagnostics::{path_of_file, print_problems};
use crate::opened::Opened;
use crate::output::{Format, WRONG, YES, any_error, document, exit, print_json, print_text};
use crate::target::Target;

/// Check mission and program files for errors.
#[derive(clap::Args)]
pub struct Args {
    /// Files to check; - reads standard input.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    time_limit: TimeLimit,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let mut wrong = false;
    let deadline = args.time_limit.start();
    let mut checked = Vec::new();
    for file in &args.files {
        let target = Target { file: file.clone(), scenario: None, activity: None, bounds: None };
        let mut mission = target.open()?;
        let limit = deadline.enforce(Undecided::Plan, ("check", args.format));
        let problems = check(&mut mission, deadline)?;
        limit.answered();
        let name = &mission.name;
        wrong |= any_error(&problems);
        match args.format {
            Format::Text => print_problems(name, &mission.source, &problems)?,
            Format::Json => checked.push((name.clone(), problems)),
        }
    }
    match args.format {
        Format::Text if !wrong => print_text("no errors\n")?,
        Format::Text => {}
        Format::Json => print_json(&answer(checked))?,
    }
    Ok(exit(if wrong { WRONG } else { YES }))
}

/// The document: of several files, each with its own diagnostics, and all diagnostics with the names of their files.
fn answer(checked: Vec<(String, Vec<Problem>)>) -> Value {
    if let [(name, problems)] = &*checked {
        return document("check", problems, json!({ "file": name }));
    }
    let files: Vec<Value> = checked
        .iter()
        .map(|(name, problems)| {
            let mut file = document("check", problems, json!({ "file": name }));
            if let Some(members) = file.as_object_mut() {
                members.remove("format");
            }
            file
        })
        .collect();
    let of_file = |(name, problems): (String, Vec<Problem>)| {
        problems.into_iter().map(move |problem| {
            let file = problem.file.as_ref().map_or_else(|| name.clone(), |file| path_of_file(&name, file));
            Problem { span: problem.span_in_file(), file: Some(file.into()), file_start: 0, ..problem }
        })
    };
    let problems: Vec<Problem> = checked.into_iter().flat_map(of_file).collect();
    document("check", &problems, json!({ "files": files }))
}

/// All that the front end, the compilers and planning have to say about a text, in either notation: what the report says.
fn check(mission: &mut Opened, deadline: Deadline) -> anyhow::Result<Vec<Problem>> {
    let Scenarios { program, mut diagnostics, scenarios } = mission.compile_all()?;
    if rmpl::control::is_control_text(&mission.source) {
        diagnostics.extend(mission.core.idle_parts(&mission.source, &mut || !deadline.is_over()));
        diagnostics.sort_by_key(|diagnostic| (diagnostic.span, diagnostic.code));
    }
    let ground = mission.ground_or_problem(&program)?.unwrap_or_else(|problem| {
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
