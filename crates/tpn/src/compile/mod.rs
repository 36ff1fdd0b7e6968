//! Compilation of a mission into its temporal plan network (SPEC 3.3): calls expanded, bounds evaluated, rules applied.
//!
//! Language rules that need no expansion (syntax, duplicate names, arities) are the front end's; what depends on
//! arguments and invocations is checked here. Nothing here plans.

mod bounds;
mod build;
mod call;
mod clauses;
mod condition;
mod constants;
mod constraint;
mod exogenous;
mod expand;
mod expander;
mod ground;
mod interchangeable;
mod names;
mod resource;
mod scope;
mod shape;
mod statics;

use std::collections::BTreeSet;

use exact::{Bound, Time};
use rmpl::diagnostics::{kind, recursion};
use rmpl::program::{Program, ScenarioDecl};
use rmpl::{Code, Diagnostic, Severity, Span, listed};
use smol_str::SmolStr;

use crate::network::Network;
pub use exogenous::{Assumption, assumed, assumptions};
pub use ground::{Ground, Level};

use constants::Constants;
use expander::{Declared, Expander};

/// There is no scenario, or none of the name that was asked for.
const E_NOSCENARIO: Code = Code("E-NOSCENARIO");

/// What a network is compiled for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Top {
    /// The scenario of this name, or the first of the file.
    Scenario(Option<SmolStr>),
    /// One invocation of an activity, as `--activity A --bounds L,U` asks for (SPEC 1.4).
    Activity {
        name: SmolStr,
        /// The invocation's least duration.
        lower: Time,
        /// The invocation's greatest duration.
        upper: Bound,
    },
}

impl Top {
    /// The activity of this name, whatever it takes.
    pub fn activity(name: impl Into<SmolStr>) -> Self {
        Self::Activity { name: name.into(), lower: Time::ZERO, upper: Bound::Infinite }
    }
}

/// Compiles `top` of `program`.
///
/// The network is `None` exactly when a diagnostic is an error. Each diagnostic is given once, however often the text
/// that it is about is expanded. Time is linear in the size of the expanded network, and nearly so in the program's.
///
/// ```
/// let parsed = rmpl::parse("scenario Day[0,60] = { Drive()[20,30]; delay; Dig()[5,10] }");
/// let (network, _warnings) = tpn::compile(&parsed.program(), &tpn::Top::Scenario(None));
/// let network = network.expect("nothing in it is an error");
/// let names: Vec<&str> = network.occurrences.iter().map(|it| it.name.as_str()).collect();
/// assert_eq!(names, ["scenario#1", "Drive#1", "delay#1", "Dig#1"]);
/// ```
pub fn compile(program: &Program, top: &Top) -> (Option<Network>, Vec<Diagnostic>) {
    compile_on(program, top, &Level)
}

/// [`compile`] for a mission on `ground`.
pub fn compile_on(program: &Program, top: &Top, ground: &dyn Ground) -> (Option<Network>, Vec<Diagnostic>) {
    let (constants, mut diagnostics) = Constants::new(program);
    let are_constants_sound = diagnostics.is_empty();
    diagnostics.extend(statics::check(program, &constants));
    if !are_constants_sound || diagnostics.iter().any(prevents_expansion) {
        return (None, listed(without_repeats(diagnostics)));
    }
    let (network, found) = expand(program, Declared::new(program, constants, ground), top);
    diagnostics.extend(found);
    let diagnostics = listed(without_repeats(diagnostics));
    let is_sound = diagnostics.iter().all(|found| found.severity != Severity::Error);
    (network.filter(|_| is_sound), diagnostics)
}

/// Compiles every scenario of `program` on `ground`, and hands each network to `take` unless an error prevents it. What is wrong with
/// any of them comes back. What the scenarios share is read once, so that time is linear in the program and its networks.
pub fn compile_scenarios(
    program: &Program,
    ground: &dyn Ground,
    mut take: impl FnMut(Option<Network>),
) -> Vec<Diagnostic> {
    let (constants, mut diagnostics) = Constants::new(program);
    let are_constants_sound = diagnostics.is_empty();
    diagnostics.extend(statics::check(program, &constants));
    if !are_constants_sound || diagnostics.iter().any(prevents_expansion) {
        return listed(without_repeats(diagnostics));
    }
    let declared = Declared::new(program, constants, ground);
    let mut names = BTreeSet::new();
    for scenario in program.scenarios.iter().filter(|scenario| names.insert(&scenario.name.text)) {
        let (network, found) = expand_scenario(program, Expander::new(declared.clone()), scenario);
        let is_sound = found.iter().all(|found| found.severity != Severity::Error);
        diagnostics.extend(found);
        take(network.filter(|_| is_sound));
    }
    listed(without_repeats(diagnostics))
}

/// Returns whether a mistake would only bring others with it, or no end.
fn prevents_expansion(found: &Diagnostic) -> bool {
    found.code == recursion::CODE || found.code == kind::CODE
}

fn expand<'program>(
    program: &'program Program,
    declared: Declared<'program>,
    top: &Top,
) -> (Option<Network>, Vec<Diagnostic>) {
    let mut expander = Expander::new(declared);
    match top {
        Top::Scenario(name) => match find_scenario(program, name.as_ref()) {
            Ok(scenario) => expand_scenario(program, expander, scenario),
            Err(error) => with_first(error, expander.finish(None)),
        },
        Top::Activity { name, lower, upper } => match expander.top_activity(name, *lower, *upper) {
            Ok(root) => {
                expander.constrain();
                expander.finish(Some(root))
            }
            Err(error) => with_first(error, expander.finish(None)),
        },
    }
}

fn expand_scenario<'program>(
    program: &'program Program,
    mut expander: Expander<'program>,
    scenario: &'program ScenarioDecl,
) -> (Option<Network>, Vec<Diagnostic>) {
    let mut diagnostics = exogenous::check(program, scenario, &expander.constants);
    let root = expander.scenario(scenario);
    expander.constrain();
    let (network, found) = expander.finish(Some(root));
    diagnostics.extend(found);
    (network, diagnostics)
}

fn with_first(
    error: Diagnostic,
    (network, found): (Option<Network>, Vec<Diagnostic>),
) -> (Option<Network>, Vec<Diagnostic>) {
    (network, std::iter::once(error).chain(found).collect())
}

/// Adds to `front_end`, the diagnostics of reading a text, those of compiling it that say something new: a mistake
/// that both stages see is told once.
pub fn merge_diagnostics(front_end: &mut Vec<Diagnostic>, compiled: Vec<Diagnostic>) {
    let overlap = |one: Span, other: Span| one.start <= other.end && other.start <= one.end;
    let known = front_end.len();
    // What is after the end of a list that was cut has been counted.
    let cut = front_end.iter().find(|told| told.more > 0 && told.severity == Severity::Error);
    let end = cut.map_or(u32::MAX, |told| told.span.start);
    let is_counted = |found: &Diagnostic| found.severity == Severity::Error && found.span.start > end;
    for found in compiled.into_iter().filter(|found| !is_counted(found)) {
        let told = |earlier: &Diagnostic| earlier.code == found.code && overlap(earlier.span, found.span);
        if !front_end[..known].iter().any(told) {
            front_end.push(found);
        }
    }
}

fn find_scenario<'program>(
    program: &'program Program,
    name: Option<&SmolStr>,
) -> Result<&'program ScenarioDecl, Diagnostic> {
    let found = match name {
        Some(name) => program.scenarios.iter().find(|scenario| scenario.name.text == *name),
        None => program.scenarios.first(),
    };
    found.ok_or_else(|| {
        let message = match name {
            Some(name) => format!("unknown scenario `{name}`"),
            None => "the file needs a scenario to plan".to_owned(),
        };
        Diagnostic::error(E_NOSCENARIO, Span::default(), message)
            .with_hint("add `scenario Name[0,100] = { … }`, or plan one activity")
    })
}

fn without_repeats(diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mut seen = BTreeSet::new();
    diagnostics.into_iter().filter(|found| seen.insert((found.code, found.span))).collect()
}
