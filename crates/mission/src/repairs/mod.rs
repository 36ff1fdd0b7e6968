//! Changes of the text that give a mission without a plan one: let one activity wait for another, do something first, let a
//! condition last, have more of a resource, but no more than needed. Each has been planned before it is offered.
//!
//! Changes of bounds are the planner's own ([`kirk::Relaxation`]).

mod amounts;
mod candidates;
mod places;

use std::sync::Arc;

use kirk::{Options, Stats, Status};
use rmpl::{Edit, Fix};
use snapshot::Goal;

use amounts::Verdict;
use candidates::Candidate;

use crate::ground::Grounds;
use crate::planning::{self, Planned, Problem};
use crate::reading;
use crate::traverse::Paths;

/// Changes that are tried at most.
const MAX_TRIED: usize = 12;
/// Changes that are offered at most.
const MAX_OFFERED: usize = 6;
/// How often planning one change may ask whether to continue: a few times as often as it took to find out that there is
/// no plan, and so often at least and at most. What takes longer is not offered.
const EFFORTS: (u64, u64) = (2_000, 20_000);
const TIMES_THE_PROOF: u64 = 4;
/// Plannings with different amounts of resources, at most.
const MAX_AMOUNTS_PLANNED: usize = 64;

/// Adds the changes of `source`, whose network `problem` is, to a planning that found no plan.
pub fn add(
    planned: &mut Planned,
    (source, goal): (&str, &Goal),
    problem: &Problem<'_>,
    (grounds, paths): (&mut Grounds, &mut Paths),
    stop: &mut dyn FnMut() -> bool,
) {
    let outcome = &planned.planning.outcome;
    let Some(failure) = &outcome.failure else { return };
    let Stats { nodes, expanded, conflicts, .. } = outcome.stats;
    let proof = nodes.saturating_add(expanded).saturating_add(conflicts);
    let effort = proof.saturating_mul(TIMES_THE_PROOF).clamp(EFFORTS.0, EFFORTS.1);
    let mut verdict = |edits: &[Edit], stop: &mut dyn FnMut() -> bool| {
        verdict((&applied(source, edits), goal), problem, (&mut *grounds, &mut *paths), (effort, stop))
    };
    let mut found: Vec<Fix> = Vec::new();
    let mut amounts = 0;
    for candidate in
        candidates::of(failure, problem.network, problem.program, source).into_iter().take(MAX_TRIED)
    {
        if found.len() == MAX_OFFERED || stop() {
            break;
        }
        let fix = match candidate {
            Candidate::Change(fix) => (verdict(&fix.edits, stop) == Verdict::Plan).then_some(fix),
            Candidate::More(amount) => amount.fix(&mut |edits| {
                amounts += 1;
                if amounts > MAX_AMOUNTS_PLANNED || stop() {
                    return Verdict::Unknown;
                }
                verdict(edits, stop)
            }),
        };
        found.extend(fix);
    }
    if !found.is_empty() {
        Arc::make_mut(&mut planned.planning).repairs = found;
    }
}

/// Returns what planning says of a changed text.
fn verdict(
    (source, goal): (&str, &Goal),
    problem: &Problem<'_>,
    (grounds, paths): (&mut Grounds, &mut Paths),
    (most, stop): (u64, &mut dyn FnMut() -> bool),
) -> Verdict {
    let parse = rmpl::parse(source);
    let program = parse.program();
    let mut diagnostics = parse.diagnostics();
    let Some(network) = reading::compile_on(&program, goal, grounds, &mut diagnostics) else {
        return Verdict::Unknown;
    };
    let network = Arc::new(network);
    let options =
        Options { all: false, best: 1, explain: false, relax: false, trace_events: None, ..problem.options };
    let changed = Problem { network: &network, program: &program, options, programs: None, ..*problem };
    let mut effort = 0;
    let mut enough = || {
        effort += 1;
        effort > most || stop()
    };
    let planned = planning::plan(&changed, grounds, paths, &mut enough);
    let outcome = &planned.planning.outcome;
    let is_valid = planned.planning.verdict.as_ref().is_some_and(|verdict| verdict.valid);
    match outcome.status {
        _ if is_valid && planning::has_plan(outcome) => Verdict::Plan,
        Status::NoPlan => Verdict::NoPlan,
        Status::Plan | Status::Limit | Status::Error => Verdict::Unknown,
    }
}

/// The text with disjoint edits, in textual order.
fn applied(source: &str, edits: &[Edit]) -> String {
    let mut text = source.to_owned();
    for edit in edits.iter().rev() {
        text.replace_range(edit.span.range(), &edit.text);
    }
    text
}
