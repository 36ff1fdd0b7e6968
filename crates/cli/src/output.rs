//! How every command answers: exit status, JSON documents with diagnostics, and text for people (DESIGN 4.2).

use std::borrow::Cow;
use std::io::{IsTerminal as _, Write as _};
use std::process::ExitCode;

use anyhow::Context as _;
use clap::ValueEnum;
use rmpl::{Severity, Span};
use serde_json::{Map, Value, json};
use snapshot::Problem;

/// Done, and the answer is yes.
pub const YES: u8 = 0;
/// Done, and the answer is no: no plan, plan invalid, not consistent.
pub const NO: u8 = 1;
/// The input or the call is wrong.
pub const WRONG: u8 = 2;
/// A limit was reached.
pub const LIMIT: u8 = 3;

/// Output format.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Human-readable text.
    #[default]
    Text,
    /// JSON.
    Json,
}

/// Characters of a word that people are shown: of longer ones, such as names of a thousand letters, the middle is left
/// out.
const MAX_WORD_CHARS: usize = 100;

/// A column of names is no wider than this.
const MAX_COLUMN_CHARS: usize = 60;

/// A JSON document `enroute-<kind>/1` with its diagnostics and the members of `body`, an object. Where there are more
/// diagnostics than are listed, it says how many there are.
pub fn document(kind: &str, problems: &[Problem], body: Value) -> Value {
    let mut members = Map::new();
    members.insert("format".into(), json!(format!("enroute-{kind}/1")));
    members.insert("program".into(), json!(review::PROGRAM));
    members.insert("diagnostics".into(), Value::Array(problems.iter().map(problem_json).collect()));
    let unlisted: u64 = problems.iter().map(|problem| u64::from(problem.more)).sum();
    if unlisted > 0 {
        members.insert("diagnostics_not_listed".into(), json!(unlisted));
    }
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
    print_verbatim(&format!("{}\n", escaped(&serde_json::to_string_pretty(value)?)))
}

/// JSON in which no character commands a terminal: such ones stand in texts only, where JSON has another way to write
/// them.
pub fn escaped(json: &str) -> String {
    use std::fmt::Write as _;
    let mut text = String::with_capacity(json.len());
    for letter in json.chars() {
        if letter != '\n' && commands_terminal(letter) {
            let _ = write!(text, "\\u{:04x}", u32::from(letter));
        } else {
            text.push(letter);
        }
    }
    text
}

/// Returns whether a terminal takes a character for a command or for a change of direction.
pub fn commands_terminal(letter: char) -> bool {
    letter.is_control() || markup::sets_direction(letter)
}

/// Prints text for people on standard output. What comes from files may hold anything: what would command a terminal is
/// shown as a sign, and of words as long as a book the middle is left out.
pub fn print_text(text: &str) -> anyhow::Result<()> {
    print_verbatim(&legible(text))
}

/// Text that can be shown to people.
pub fn legible(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for word in text.split_inclusive([' ', '\n']) {
        shown.push_str(&without_middle(&harmless(word), MAX_WORD_CHARS));
    }
    shown
}

/// Text in which what would command a terminal is a sign.
fn harmless(text: &str) -> String {
    let sign = |letter: char| match letter {
        '\n' | '\t' => letter,
        '\0'..='\u{1f}' => char::from_u32(0x2400 + u32::from(letter)).unwrap_or(letter),
        _ if commands_terminal(letter) => char::REPLACEMENT_CHARACTER,
        _ => letter,
    };
    text.chars().map(sign).collect()
}

/// A text of at most so many characters, without its middle where it has more.
fn without_middle(text: &str, most: usize) -> Cow<'_, str> {
    if text.len() <= most || text.chars().count() <= most {
        return text.into();
    }
    let end = text.char_indices().rev().nth(most / 3 - 1).map_or(0, |(at, _)| at);
    let start: String = text.chars().take(most - most / 3 - 1).collect();
    format!("{start}…{}", &text[end..]).into()
}

/// Names as a column: all of one width, the longest of them cut.
pub fn column<'name>(names: impl Iterator<Item = &'name str>) -> Vec<String> {
    let names: Vec<_> = names.map(|name| without_middle(name, MAX_COLUMN_CHARS)).collect();
    let width = names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
    names.iter().map(|name| format!("{name:<width$}")).collect()
}

/// Prints what a program reads, or a file's own text, on standard output; a reader that has gone away ends the output
/// quietly.
pub fn print_verbatim(text: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    // A file gets every byte; a terminal would do what some of them say.
    let shown =
        if out.is_terminal() { harmless(&text.replace("\r\n", "\n")).into() } else { Cow::Borrowed(text) };
    // What is left in the buffer at the end of the process would be lost without a word.
    match out.write_all(shown.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        result => result.context("cannot write to standard output"),
    }
}

/// Prints a line on standard error; where that is closed, there is no one to tell.
pub fn print_error(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{}", legible(line));
}

/// The code of a call that is wrong.
pub const E_CALL: &str = "E-CALL";
/// The code of an input that cannot be used.
pub const E_INPUT: &str = "E-INPUT";
/// The code of a time limit that was reached.
pub const E_TIME: &str = "E-TIME";
/// The code of another limit that was reached.
pub const E_LIMIT: &str = "E-LIMIT";

/// Answers a call that has no other answer: on standard error, or for programs as the diagnostic of a document of this kind.
pub fn print_failure((kind, format): (&str, Format), code: &str, message: &str) {
    if format == Format::Text {
        return print_error(&format!("error: {message}"));
    }
    if let Err(error) = print_json(&document(kind, &[failure(code, message)], json!({}))) {
        print_error(&format!("error: {message} ({error:#})"));
    }
}

/// Returns a diagnostic about no place in a text.
pub fn failure(code: &str, message: &str) -> Problem {
    Problem {
        code: code.into(),
        severity: Severity::Error,
        message: message.into(),
        span: Span::default(),
        line: 1,
        column: 1,
        file: None,
        file_start: 0,
        hint: None,
        fixes: Vec::new(),
        more: 0,
    }
}

/// Returns whether any of `problems` is an error.
pub fn any_error(problems: &[Problem]) -> bool {
    problems.iter().any(|problem| problem.severity == Severity::Error)
}

/// The process's exit status.
pub fn exit(status: u8) -> ExitCode {
    ExitCode::from(status)
}

/// Leaves out of an object how long things took: its members in milliseconds.
pub fn without_timings(value: &mut Value) {
    if let Value::Object(members) = value {
        members.retain(|name, _| !name.ends_with("millis"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_is_printed_commands_a_terminal() {
        let text = "a\u{1b}[31mb \u{202e}c\u{9b}2J\td\n";
        assert_eq!(legible(text), "a␛[31mb �c�2J\td\n");
        let json = serde_json::to_string(&json!({ "name": text })).expect("it is written");
        let written = escaped(&json);
        assert!(!written.contains(commands_terminal), "{written}");
        let read: Value = serde_json::from_str(&written).expect("it is JSON still");
        assert_eq!(read["name"], text);
    }

    #[test]
    fn a_column_of_names_is_narrow_whatever_they_are() {
        let long = "n".repeat(70_000);
        let column = column(["Drive#1.start", &long, "日本"].into_iter());
        assert!(column.iter().all(|name| name.chars().count() == MAX_COLUMN_CHARS), "{column:?}");
        assert!(legible(&format!("link {long} carries {long}\n")).chars().count() < 250);
    }
}
