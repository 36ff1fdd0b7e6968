//! Changes of the text that give a mission without a plan one: let one activity wait for another, do something first, let a
//! condition last, have more of a resource. Each has been planned before it is offered.
//!
//! Changes of bounds are the planner's own ([`kirk::Relaxation`]).

mod candidates;
mod places;

use std::sync::Arc;

use kirk::Options;
use rmpl::{Edit, Fix};
use snapshot::Goal;

use crate::ground::Grounds;
use crate::planning::{self, Planned, Problem};
use crate::reading;
use crate::traverse::Paths;

/// Changes that are planned at most; each takes a planning.
const MAX_TRIED: usize = 12;
/// Changes that are offered at most.
const MAX_OFFERED: usize = 6;
/// How often planning one change may ask whether to go on: what takes longer is not offered.
const MAX_EFFORT: u32 = 20_000;

/// Adds the changes of `source`, whose network `problem` is, to a planning that found no plan.
pub fn add(
    planned: &mut Planned,
    (source, goal): (&str, &Goal),
    problem: &Problem<'_>,
    (grounds, paths): (&mut Grounds, &mut Paths),
    stop: &mut dyn FnMut() -> bool,
) {
    let Some(failure) = &planned.planning.outcome.failure else { return };
    let mut found: Vec<Fix> = Vec::new();
    for fix in candidates::of(failure, problem.network, problem.program, source).into_iter().take(MAX_TRIED) {
        if found.len() == MAX_OFFERED || stop() {
            break;
        }
        if gives_a_plan(&applied(source, &fix.edits), goal, problem, (&mut *grounds, &mut *paths), stop) {
            found.push(fix);
        }
    }
    if !found.is_empty() {
        Arc::make_mut(&mut planned.planning).repairs = found;
    }
}

fn gives_a_plan(
    source: &str,
    goal: &Goal,
    problem: &Problem<'_>,
    (grounds, paths): (&mut Grounds, &mut Paths),
    stop: &mut dyn FnMut() -> bool,
) -> bool {
    let parse = rmpl::parse(source);
    let program = parse.program();
    let mut diagnostics = parse.diagnostics();
    let Some(network) = reading::compile_on(&program, goal, grounds, &mut diagnostics) else { return false };
    let network = Arc::new(network);
    let options =
        Options { all: false, best: 1, explain: false, relax: false, trace_events: None, ..problem.options };
    let changed = Problem { network: &network, program: &program, options, programs: None, ..*problem };
    let mut effort = 0;
    let mut enough = || {
        effort += 1;
        effort > MAX_EFFORT || stop()
    };
    let planned = planning::plan(&changed, grounds, paths, &mut enough);
    let is_valid = planned.planning.verdict.as_ref().is_some_and(|verdict| verdict.valid);
    is_valid && planning::has_plan(&planned.planning.outcome)
}

/// The text with disjoint edits, in textual order.
fn applied(source: &str, edits: &[Edit]) -> String {
    let mut text = source.to_owned();
    for edit in edits.iter().rev() {
        text.replace_range(edit.span.range(), &edit.text);
    }
    text
}
