//! From a file on the command line to a network: a mission text compiled, or a network written by another tool.

use std::path::PathBuf;
use std::time::Instant;

use anyhow::Context as _;
use mission::{Goal, Problem};
use rmpl::program::Program;
use rmpl::{Bound, Rational};
use tpn::Network;

use crate::input::read_text;

/// What is to be compiled or planned.
#[derive(clap::Args, Debug)]
pub struct Target {
    /// A mission text, or a network in JSON or EDN (`.tpn.json`, `.tpn.edn`); `-` is standard input.
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

/// A file, read.
pub struct Loaded {
    /// Its name, for messages.
    pub name: String,
    /// Its text.
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
        let source = read_text(&self.file)?;
        let begun = Instant::now();
        let name = self.file.display().to_string();
        if is_network(&name, &source) {
            let network = tpn::interchange::Source::read(&source)
                .with_context(|| format!("cannot read {name}"))?
                .into_network();
            let parse_millis = begun.elapsed().as_secs_f64() * 1000.0;
            let problems = Vec::new();
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
                None => (Rational::default(), Bound::Infinite),
            };
            return Ok(Goal::Activity { name: name.into(), lower, upper });
        }
        // Without a choice, a file without scenarios is an error: nothing in it says what to plan.
        Ok(self.scenario.as_ref().map_or(Goal::FirstScenario, |name| Goal::Scenario(name.into())))
    }
}

fn is_network(name: &str, source: &str) -> bool {
    let is_named_so = [".json", ".edn"].iter().any(|ending| name.ends_with(ending));
    is_named_so || (name == "-" && source.trim_start().starts_with('{'))
}

fn parse_bounds(text: &str) -> anyhow::Result<(Rational, Bound)> {
    let explain = || format!("--bounds wants two times such as 450,540 or 0,inf, not `{text}`");
    let (lower, upper) = text.split_once(',').with_context(explain)?;
    let lower = parse_time(lower).with_context(explain)?;
    let upper = match upper.trim() {
        "inf" | "∞" => Bound::Infinite,
        finite => Bound::Finite(parse_time(finite).with_context(explain)?),
    };
    anyhow::ensure!(
        lower >= Rational::default() && Bound::Finite(lower) <= upper,
        "--bounds wants 0 ≤ L ≤ U, not `{text}`"
    );
    Ok((lower, upper))
}

/// A time: a decimal such as 409.5, or a fraction such as 1000/3.
pub fn parse_time(text: &str) -> Option<Rational> {
    let text = text.trim();
    if let Some((numerator, denominator)) = text.split_once('/') {
        let denominator: i64 = denominator.parse().ok().filter(|&denominator| denominator != 0)?;
        return Some(Rational::new(numerator.parse().ok()?, denominator));
    }
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    if !fraction.bytes().all(|byte| byte.is_ascii_digit()) || fraction.len() > 15 {
        return None;
    }
    let scale = 10_i64.pow(fraction.len() as u32);
    let digits: i64 = format!("{whole}{fraction}").parse().ok()?;
    Some(Rational::new(digits, scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_exactly() {
        assert_eq!(parse_time("409.5"), Some(Rational::new(819, 2)));
        assert_eq!(parse_time("1000/3"), Some(Rational::new(1000, 3)));
        assert_eq!(parse_time("-2"), Some(Rational::from(-2)));
        assert_eq!(parse_time("-0.5"), Some(Rational::new(-1, 2)));
        for wrong in ["", "a", "1/0", "1.x", "1e3"] {
            assert_eq!(parse_time(wrong), None, "{wrong}");
        }
    }
}
