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
mod names;
mod resource;
mod scope;
mod shape;
mod statics;

use std::collections::BTreeSet;

use exact::{Bound, Time};
use rmpl::diagnostics::recursion;
use rmpl::program::{Program, ScenarioDecl};
use rmpl::{Code, Diagnostic, Severity, Span};
use smol_str::SmolStr;

use crate::network::Network;
pub use exogenous::assumed;

use constants::Constants;
use expand::Expander;

/// There is no scenario, or none of the name that was asked for.
const E_NOSCENARIO: Code = Code("E-NOSCENARIO");
/// There is no activity of the name that was asked for.
const E_UNDEF: Code = Code("E-UNDEF");

/// What a network is compiled for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Top {
    /// The scenario of this name, or the first of the file.
    Scenario(Option<SmolStr>),
    /// One invocation of an activity, as `--activity A --bounds L,U` asks for (SPEC 1.4).
    Activity {
        /// Its name.
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
    let (constants, mut diagnostics) = Constants::new(program);
    let are_constants_sound = diagnostics.is_empty();
    diagnostics.extend(statics::check(program, &constants));
    if !are_constants_sound || diagnostics.iter().any(|found| found.code == recursion::CODE) {
        return (None, without_repeats(diagnostics));
    }
    let mut expander = Expander::new(program, constants);
    let root = match top {
        Top::Scenario(name) => find_scenario(program, name.as_ref())
            .map(|scenario| {
                diagnostics.extend(exogenous::check(scenario, &expander.constants));
                expander.scenario(scenario)
            })
            .map_err(|error| diagnostics.push(error)),
        Top::Activity { name, lower, upper } => {
            expander.top_activity(name, *lower, *upper).map_err(|error| diagnostics.push(error))
        }
    };
    if root.is_ok() {
        expander.constrain();
    }
    let (network, found) = expander.finish(root.ok());
    diagnostics.extend(found);
    let diagnostics = without_repeats(diagnostics);
    let is_sound = diagnostics.iter().all(|found| found.severity != Severity::Error);
    (network.filter(|_| is_sound), diagnostics)
}

/// Adds to `front_end`, the diagnostics of reading a text, those of compiling it that say something new: a mistake
/// that both stages see is told once.
pub fn merge_diagnostics(front_end: &mut Vec<Diagnostic>, compiled: Vec<Diagnostic>) {
    let overlap = |one: Span, other: Span| one.start <= other.end && other.start <= one.end;
    let known = front_end.len();
    for found in compiled {
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
            Some(name) => format!("there is no scenario `{name}`"),
            None => "the file has no scenario, so there is nothing to plan".to_owned(),
        };
        Diagnostic::error(E_NOSCENARIO, Span::default(), message)
            .with_hint("write `scenario Name[0,100] = { … }`, or plan one activity by itself")
    })
}

fn without_repeats(diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mut seen = BTreeSet::new();
    diagnostics.into_iter().filter(|found| seen.insert((found.code, found.span))).collect()
}
