//! From a file on the command line to a network: a mission text compiled, or a network written by another tool.

use std::path::PathBuf;
use std::time::Instant;

use anyhow::Context as _;
use exact::{Bound, Time};
use interchange::Source;
use rmpl::diagnostics::network;
use rmpl::program::Program;
use snapshot::{Goal, Problem};
use tpn::Network;

use crate::input::{read_mission, read_text};

/// What is to be compiled or planned.
#[derive(clap::Args, Debug)]
pub struct Target {
    /// A mission text, or a network in JSON or EDN (`.tpn.json`, `.tpn.edn`), a pTPN (`.tpn`, `.ptpn`, `.xml`), or a plan of `PlanDev` (`.json`); `-` is standard input.
    pub file: PathBuf,
    /// The scenario; the first of the file by default.
    #[arg(long, conflicts_with = "activity")]
    pub scenario: Option<String>,
    /// An activity instead of a scenario.
    #[arg(long)]
    pub activity: Option<String>,
    /// The bounds of the activity's invocation, such as 450,540 or 0,inf.
    #[arg(long, requires = "activity", value_name = "L,U")]
    pub bounds: Option<String>,
}

/// A mission's files as they were read.
pub struct Loaded {
    /// Its name, for messages.
    pub name: String,
    pub source: String,
    /// What is wrong with it.
    pub problems: Vec<Problem>,
    /// The mission, if it is a mission text.
    pub program: Option<Program>,
    /// Milliseconds that reading took, without compiling.
    pub parse_millis: f64,
    /// The network, unless an error prevents it.
    pub network: Option<Network>,
}

impl Target {
    /// Reads the file and compiles it. Fails when it cannot be read, or is a network that is not well formed.
    pub fn load(&self) -> anyhow::Result<Loaded> {
        let name = self.file.display().to_string();
        let is_standard_input = name == "-";
        let source = if is_standard_input || is_network(&name, "") {
            read_text(&self.file)?
        } else {
            read_mission(&self.file)?
        };
        let begun = Instant::now();
        if is_network(&name, &source) {
            let (network, problems) = read_network(&name, &source)?;
            let parse_millis = begun.elapsed().as_secs_f64() * 1000.0;
            return Ok(Loaded {
                name,
                source,
                problems,
                program: None,
                parse_millis,
                network: Some(network),
            });
        }
        let parse = rmpl::parse(&source);
        let parse_millis = begun.elapsed().as_secs_f64() * 1000.0;
        let (program, mut diagnostics) = (parse.program(), parse.diagnostics());
        let network = mission::compile(&program, &self.goal()?, &mut diagnostics);
        let problems = Problem::all(&diagnostics, &source);
        let program = Some(program);
        Ok(Loaded { name, source, problems, program, parse_millis, network })
    }

    /// What the call asks to be planned.
    pub fn goal(&self) -> anyhow::Result<Goal> {
        if let Some(name) = &self.activity {
            let (lower, upper) = match &self.bounds {
                Some(bounds) => parse_bounds(bounds)?,
                None => (Time::ZERO, Bound::Infinite),
            };
            return Ok(Goal::Activity { name: name.into(), lower, upper });
        }
        // Without a choice, a file without scenarios is an error: nothing in it says what to plan.
        Ok(self.scenario.as_ref().map_or(Goal::FirstScenario, |name| Goal::Scenario(name.into())))
    }
}

/// The network that a file holds, and what is to be said of the file.
pub fn read_network(name: &str, source: &str) -> anyhow::Result<(Network, Vec<Problem>)> {
    let read = Source::read(source).with_context(|| format!("cannot read {name}"))?;
    let not_honoured = read.not_honoured();
    let told = (!not_honoured.is_empty()).then(|| network::not_honoured(&not_honoured));
    let problems = Problem::all(told.as_slice(), source);
    Ok((read.into_network(), problems))
}

/// Whether a file holds a network rather than a mission text.
pub fn is_network(name: &str, source: &str) -> bool {
    let is_named_so = [".json", ".edn", ".tpn", ".ptpn", ".xml"].iter().any(|ending| name.ends_with(ending));
    is_named_so || (name == "-" && interchange::is_network_text(source))
}

fn parse_bounds(text: &str) -> anyhow::Result<(Time, Bound)> {
    let explain = || format!("--bounds wants two times such as 450,540 or 0,inf, not `{text}`");
    let (lower, upper) = text.split_once(',').with_context(explain)?;
    let lower: Time = lower.parse().with_context(explain)?;
    let upper: Bound = upper.parse().with_context(explain)?;
    anyhow::ensure!(
        !lower.is_negative() && Bound::Finite(lower) <= upper,
        "--bounds wants 0 ≤ L ≤ U, not `{text}`"
    );
    Ok((lower, upper))
}

/// The value of `--threat-gap`.
pub fn parse_threat_gap(text: &str) -> anyhow::Result<Time> {
    let gap: Time = text.parse().with_context(|| format!("--threat-gap wants a time, not `{text}`"))?;
    anyhow::ensure!(!gap.is_negative(), "--threat-gap must not be negative");
    Ok(gap)
}
