//! `enroute fmt`: formats mission files in place, or says which ones are not formatted.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context as _;

use crate::input::read_text;
use crate::output::{NO, YES, exit, print_text, print_verbatim};

/// Formats mission files in place; standard input is formatted to standard output.
#[derive(clap::Args)]
pub struct Args {
    /// The files; `-` is standard input.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Changes nothing, and exits with 1 if a file is not formatted.
    #[arg(long)]
    check: bool,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let mut unformatted = false;
    for file in &args.files {
        let source = read_text(file)?;
        let formatted = format(&source);
        if args.check {
            if formatted != source {
                unformatted = true;
                print_text(&format!("{} is not formatted\n", file.display()))?;
            }
        } else if file == Path::new("-") {
            print_verbatim(&formatted)?;
        } else if formatted != source {
            std::fs::write(file, formatted).with_context(|| format!("cannot write {}", file.display()))?;
        }
    }
    Ok(exit(if unformatted { NO } else { YES }))
}

/// The text, formatted in its own notation.
fn format(source: &str) -> String {
    if rmpl::control::is_control_text(source) { rmpl::control::format(source) } else { rmpl::format(source) }
}
