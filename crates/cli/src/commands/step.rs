//! `enroute step`: runs an automaton on given estimates.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::process::ExitCode;

use hca::{Estimate, Trace, Vocabulary};
use serde::Deserialize;
use serde_json::{Value, json};
use smol_str::SmolStr;
use snapshot::Problem;

use crate::diagnostics::print_problems;
use crate::input::{read_control, read_json};
use crate::output::{Format, WRONG, YES, document, exit, print_json, print_text};

/// Run a control program on given state estimates, step by step.
#[derive(clap::Args)]
pub struct Args {
    /// Control program; - reads standard input.
    file: PathBuf,
    /// Estimates: {"estimates":[{var:value}…], …}; docs/contracts.md lists all members.
    #[arg(long, value_name = "E.json")]
    estimates: PathBuf,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// What the file of estimates holds. The initial estimate informs the reader; no step depends on it.
#[derive(Deserialize)]
struct Estimates {
    #[serde(default)]
    domains: BTreeMap<SmolStr, Vec<SmolStr>>,
    #[serde(default)]
    program_vars: BTreeSet<SmolStr>,
    #[serde(default, rename = "estimates")]
    each_step: Vec<BTreeMap<String, String>>,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let source = read_control(&args.file, "use `enroute simulate`")?;
    let given: Estimates = read_json(&args.estimates)?;
    let vocabulary = Vocabulary { domains: given.domains, program_variables: given.program_vars };
    let compilation = hca::compile_text(&source, &vocabulary);
    let problems = Problem::all(&compilation.diagnostics, &source);
    if args.format == Format::Text {
        print_problems(&args.file.display().to_string(), &source, &problems)?;
    }
    let Some(automaton) = &compilation.automaton else {
        if args.format == Format::Json {
            print_json(&document("step", &problems, json!({})))?;
        }
        return Ok(exit(WRONG));
    };
    let estimates: Vec<Estimate> = given
        .each_step
        .iter()
        .map(|known| automaton.estimate(known.iter().map(|(name, value)| (name.as_str(), value.as_str()))))
        .collect();
    let trace = hca::trace(automaton, &estimates);
    match args.format {
        Format::Json => print_json(&document("step", &problems, trace_json(&trace)))?,
        Format::Text => print_text(&trace_text(&trace))?,
    }
    Ok(exit(YES))
}

fn trace_json(trace: &Trace) -> Value {
    let steps: Vec<Value> = trace
        .steps
        .iter()
        .map(|step| {
            json!({ "step": step.step, "num_marked": step.marked.len(), "goals": step.goals, "labels": step.labels })
        })
        .collect();
    json!({ "steps": steps, "terminated": trace.terminated })
}

fn trace_text(trace: &Trace) -> String {
    let mut out = String::new();
    for step in &trace.steps {
        out.push_str(&format!("step {}: {} marked\n", step.step, step.marked.len()));
        step.labels.iter().for_each(|label| out.push_str(&format!("  {label}\n")));
    }
    out.push_str(if trace.terminated { "The program has ended.\n" } else { "The program has not ended.\n" });
    out
}
