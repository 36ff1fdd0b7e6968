//! How every command answers: exit status, JSON documents with diagnostics, and text for people (DESIGN 4.2).

use std::io::Write as _;
use std::process::ExitCode;

use clap::ValueEnum;
use mission::Problem;
use rmpl::Severity;
use serde_json::{Map, Value, json};

/// Done, and the answer is yes.
pub const YES: u8 = 0;
/// Done, and the answer is no: no plan, plan invalid, not consistent.
pub const NO: u8 = 1;
/// The input or the call is wrong.
pub const WRONG: u8 = 2;
/// A limit was reached.
pub const LIMIT: u8 = 3;

/// For whom the answer is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For people.
    #[default]
    Text,
    /// For programs.
    Json,
}

/// A JSON document `enroute-<kind>/1` with its diagnostics and the members of `body`, an object.
pub fn document(kind: &str, problems: &[Problem], body: Value) -> Value {
    let mut members = Map::new();
    members.insert("format".into(), json!(format!("enroute-{kind}/1")));
    members.insert("diagnostics".into(), Value::Array(problems.iter().map(problem_json).collect()));
    if let Value::Object(body) = body {
        members.extend(body);
    }
    Value::Object(members)
}

fn problem_json(problem: &Problem) -> Value {
    let span = problem.span_in_file();
    let mut told = json!({
        "code": problem.code,
        "severity": problem.severity,
        "message": problem.message,
        "span": {
            "start": span.start,
            "end": span.end,
            "line": problem.line,
            "column": problem.column,
        },
        "hint": problem.hint,
    });
    if let Some(file) = &problem.file {
        told["file"] = json!(file);
    }
    told
}

/// Prints a JSON document on standard output.
pub fn print_json(value: &Value) -> anyhow::Result<()> {
    print_text(&format!("{}\n", serde_json::to_string_pretty(value)?))
}

/// Prints text on standard output; a reader that has gone away ends the output quietly.
pub fn print_text(text: &str) -> anyhow::Result<()> {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        result => Ok(result?),
    }
}

/// Prints a line on standard error; where that is closed, there is nobody to tell.
pub fn print_error(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Whether any of `problems` is an error.
pub fn any_error(problems: &[Problem]) -> bool {
    problems.iter().any(|problem| problem.severity == Severity::Error)
}

/// The process's exit status.
pub fn exit(status: u8) -> ExitCode {
    ExitCode::from(status)
}
