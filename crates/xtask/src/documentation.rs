//! Documentation that is checked with the libraries that the tests were built with.
//!
//! `cargo doc` reads metadata that only `cargo check` writes, for all dependencies. For examples in documentation cargo calls
//! rustdoc with the libraries that tests use instead. This program stands in for rustdoc there, and has it read the
//! documentation of the same crate first.

use std::{
    env,
    ffi::{OsStr, OsString},
    process::{Command, ExitCode},
};

use anyhow::{Context as _, Result};
use xtask::process::target_dir;

/// Names rustdoc to this program when cargo runs it in rustdoc's place.
const RUSTDOC: &str = "XTASK_RUSTDOC";

/// Options of rustdoc that are only for examples; each is followed by a value.
const OF_EXAMPLES: [&str; 2] = ["--test-run-directory", "--test-args"];

/// Has cargo run this program in place of rustdoc, which refuses documentation with warnings.
pub(crate) fn by_us(command: &mut Command) -> Result<&mut Command> {
    let rustdoc = env::var_os("RUSTDOC").unwrap_or_else(|| "rustdoc".into());
    let this = env::current_exe().context("this program does not know where it is")?;
    // The build of the tests may have replaced this program. Linux then appends a word to its path; the new program is at that path.
    let this = this.to_string_lossy().trim_end_matches(" (deleted)").to_owned();
    Ok(command.env(RUSTDOC, rustdoc).env("RUSTDOC", this).env("RUSTDOCFLAGS", "-D warnings"))
}

/// Does rustdoc's work, if this program was run in its place.
pub(crate) fn in_place_of_rustdoc() -> Option<ExitCode> {
    let rustdoc = env::var_os(RUSTDOC)?;
    let arguments: Vec<OsString> = env::args_os().skip(1).collect();
    let succeeds = |arguments: &[OsString]| {
        Command::new(&rustdoc).args(arguments).status().is_ok_and(|status| status.success())
    };
    let is_documented = without_examples(&arguments).is_none_or(|mut documenting| {
        documenting.extend(["--out-dir".into(), target_dir().join("doc").into()]);
        succeeds(&documenting)
    });
    let succeeded = succeeds(&arguments) && is_documented;
    Some(if succeeded { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Arguments that have rustdoc read the documentation whose examples these arguments run, if they do.
fn without_examples(arguments: &[OsString]) -> Option<Vec<OsString>> {
    let is = |argument: &OsString, name: &str| argument == OsStr::new(name);
    arguments.iter().any(|argument| is(argument, "--test")).then(|| {
        let mut kept = Vec::new();
        let mut rest = arguments.iter();
        while let Some(argument) = rest.next() {
            if OF_EXAMPLES.iter().any(|name| is(argument, name)) {
                rest.next();
            } else if !is(argument, "--test") && !is(argument, "--nocapture") {
                kept.push(argument.clone());
            }
        }
        kept
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_only_for_examples_is_left_out() {
        let arguments = |words: &str| words.split(' ').map(OsString::from).collect::<Vec<_>>();
        let asked = arguments("--edition=2024 --test src/lib.rs --test-run-directory here --extern a=b");
        assert_eq!(without_examples(&asked), Some(arguments("--edition=2024 src/lib.rs --extern a=b")));
        assert_eq!(without_examples(&arguments("-vV")), None);
    }
}
