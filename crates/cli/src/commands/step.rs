//! `enroute step`: runs an automaton on given estimates.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::process::ExitCode;

use hca::{Automaton, Estimate, Trace, Vocabulary};
use serde::Deserialize;
use serde_json::{Value, json};
use smol_str::SmolStr;
use snapshot::Problem;

use super::run::{clocks_json, clocks_text, elapsed};
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
        Format::Json => print_json(&document("step", &problems, trace_json(automaton, &trace)))?,
        Format::Text => print_text(&trace_text(automaton, &trace))?,
    }
    Ok(exit(YES))
}

fn trace_json(automaton: &Automaton, trace: &Trace) -> Value {
    let each = trace.steps.iter().map(|step| {
        let mut members = json!({
            "step": step.step, "num_marked": step.marked.len(), "goals": step.goals, "labels": step.labels,
        });
        if let (Value::Object(members), false) = (&mut members, automaton.clocks.is_empty()) {
            members.insert("clocks".to_owned(), clocks_json(automaton, step));
            members.insert("elapsed".to_owned(), json!(elapsed(automaton, step)));
        }
        members
    });
    let steps: Vec<Value> = each.collect();
    json!({ "steps": steps, "terminated": trace.terminated })
}

fn trace_text(automaton: &Automaton, trace: &Trace) -> String {
    let mut out = String::new();
    for step in &trace.steps {
        out.push_str(&format!("step {}: {} marked\n", step.step, step.marked.len()));
        step.labels.iter().for_each(|label| out.push_str(&format!("  {label}\n")));
        clocks_text(automaton, step, &mut out);
        for label in elapsed(automaton, step) {
            out.push_str(&format!("  elapsed   {label}\n"));
        }
    }
    out.push_str(if trace.terminated { "The program has ended.\n" } else { "The program has not ended.\n" });
    out
}
