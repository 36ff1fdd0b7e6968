//! `enroute explain`: what a diagnostic code means, with an example and its fix.

use std::process::ExitCode;

use crate::output::{WRONG, YES, exit, print_error, print_text};

/// Explains a diagnostic code such as E-BOUNDS; without one, lists all codes.
#[derive(clap::Args)]
pub struct Args {
    /// The code.
    code: Option<String>,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let Some(code) = &args.code else {
        let mut listing = String::new();
        for explanation in rmpl::diagnostics::EXPLANATIONS {
            listing.push_str(&format!("{:<16} {}\n", explanation.code.0, explanation.title));
        }
        print_text(&listing)?;
        return Ok(exit(YES));
    };
    let code = code.to_uppercase();
    if let Some(explanation) = rmpl::explain(&code) {
        print_text(&explanation.markdown())?;
        return Ok(exit(YES));
    }
    print_error(&format!("there is no diagnostic called {code}; `enroute explain` lists all of them"));
    Ok(exit(WRONG))
}
