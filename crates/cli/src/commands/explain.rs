//! `enroute explain`: what a diagnostic code means, with an example and its fix.

use std::process::ExitCode;

use anyhow::Context as _;
use rmpl::diagnostics::EXPLANATIONS;
use serde_json::{Value, json};

use crate::output::{Format, YES, document, exit, print_json, print_text};

/// Explain a diagnostic code such as E-BOUNDS, or list all codes.
#[derive(clap::Args)]
pub struct Args {
    /// Code to explain.
    code: Option<String>,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let Some(code) = &args.code else {
        match args.format {
            Format::Text => {
                let lines = EXPLANATIONS.iter().map(|it| format!("{:<16} {}\n", it.code.0, it.title));
                print_text(&lines.collect::<String>())?;
            }
            Format::Json => {
                let codes: Vec<Value> =
                    EXPLANATIONS.iter().map(|it| json!({ "code": it.code.0, "title": it.title })).collect();
                print_json(&document("explain", &[], json!({ "codes": codes })))?;
            }
        }
        return Ok(exit(YES));
    };
    let code = code.to_uppercase();
    let explanation = rmpl::explain(&code);
    let explanation =
        explanation.with_context(|| format!("unknown code {code}. Run `enroute explain` for a list."))?;
    match args.format {
        Format::Text => print_text(&explanation.markdown())?,
        Format::Json => {
            let body = json!({ "codes": [{
                "code": explanation.code.0,
                "title": explanation.title,
                "markdown": explanation.markdown(),
            }] });
            print_json(&document("explain", &[], body))?;
        }
    }
    Ok(exit(YES))
}
