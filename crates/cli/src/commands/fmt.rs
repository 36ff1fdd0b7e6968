//! `enroute fmt`: formats mission files in place, or names those that are not formatted.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::json;

use crate::input::read_text;
use crate::output::{Format, NO, YES, document, exit, print_json, print_text, print_verbatim};
use crate::save::replace;

/// Format mission files in place.
///
/// Standard input (-) is formatted to standard output.
#[derive(clap::Args)]
pub struct Args {
    /// Files to format; - reads standard input.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Change nothing; if a file is not formatted, exit with status 1.
    #[arg(long)]
    check: bool,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let mut unformatted = false;
    let mut files = Vec::new();
    for file in &args.files {
        let source = read_text(file)?;
        let formatted = format(&source);
        let is_formatted = formatted == source;
        let mut answer = json!({ "file": file.display().to_string(), "formatted": is_formatted });
        if args.check {
            unformatted |= !is_formatted;
            if !is_formatted && args.format == Format::Text {
                print_text(&format!("{} is not formatted\n", file.display()))?;
            }
        } else if file == Path::new("-") {
            match args.format {
                Format::Text => print_verbatim(&formatted)?,
                Format::Json => answer["text"] = json!(formatted),
            }
        } else if !is_formatted {
            replace(file, &formatted)?;
        }
        files.push(answer);
    }
    if args.format == Format::Json {
        print_json(&document("fmt", &[], json!({ "files": files })))?;
    }
    Ok(exit(if unformatted { NO } else { YES }))
}

/// The text, formatted in its own notation.
fn format(source: &str) -> String {
    if rmpl::control::is_control_text(source) { rmpl::control::format(source) } else { rmpl::format(source) }
}
