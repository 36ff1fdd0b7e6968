//! Whether faults can leave a program waiting for what never comes, as far as undisturbed runs with them show.
//!
//! A program that ends without faults is run again with one component, and then with two, brought as soon as they can be
//! into modes that no transition leaves. It is only said what a run shows, and only of the smallest sets of faults.

use std::sync::Arc;

use plant::{ComponentId, Model, State};
use rmpl::{Code, Diagnostic, Span};

use super::run::{Options, Run, RunStatus, StepInput};
use super::system::System;

/// A run that has not ended after so many steps is not looked at further.
const MAX_STEPS: u32 = 200;
/// At most this many sets of faults are tried.
const MAX_RUNS: usize = 100;
/// After so many steps in which nothing changes, nothing will.
const STILL_STEPS: u32 = 3;

/// A fault that no transition takes back.
type FinalFault = (ComponentId, u8);

/// Warnings of a program that waits forever with one or two faults, though it ends without any.
pub fn waits_forever(system: &Arc<System>) -> Vec<Diagnostic> {
    if !matches!(outcome(system, &[]), Outcome::Ends) {
        return Vec::new();
    }
    let faults = final_faults(&system.model);
    let pairs = faults.iter().enumerate().flat_map(|(at, first)| {
        faults[at + 1..].iter().filter(|second| second.0 != first.0).map(|second| vec![*first, *second])
    });
    let sets = faults.iter().map(|fault| vec![*fault]).chain(pairs).take(MAX_RUNS);
    let mut found: Vec<Vec<FinalFault>> = Vec::new();
    let mut diagnostics = Vec::new();
    for set in sets {
        if found.iter().any(|known| known.iter().all(|fault| set.contains(fault))) {
            continue;
        }
        if let Outcome::Waits { span, labels } = outcome(system, &set) {
            diagnostics.push(warning(&system.model, &set, span, &labels));
            found.push(set);
        }
    }
    diagnostics
}

fn warning(model: &Model, faults: &[FinalFault], span: Span, labels: &[String]) -> Diagnostic {
    let names: Vec<String> = faults
        .iter()
        .map(|(id, mode)| {
            let name = model.component(*id).map_or("?", |component| component.name.as_str());
            format!("{name}={}", model.mode_name(*id, *mode))
        })
        .collect();
    let message = format!("after {} the program waits forever: {}", names.join(" and "), labels.join(", "));
    Diagnostic::warning(Code("W-LIVENESS"), span, message)
        .with_hint("enclose the part that waits in DO-WATCHING, with a condition that holds after the fault")
}

/// The first fault of each component that leads to a mode which no transition leaves.
fn final_faults(model: &Model) -> Vec<FinalFault> {
    let each = model.component_ids().zip(&model.components);
    each.filter_map(|(id, component)| {
        let targets = component.modes.iter().flat_map(|mode| &mode.faults).map(|fault| fault.to);
        let is_final =
            |to: &u8| component.modes.get(usize::from(*to)).is_some_and(|mode| mode.transitions.is_empty());
        Some((id, targets.into_iter().find(is_final)?))
    })
    .collect()
}

/// How a run with some faults goes.
enum Outcome {
    Ends,
    /// Nothing changes any more. The labels of what is marked, and where the first of it is written.
    Waits {
        span: Span,
        labels: Vec<String>,
    },
    /// It continues, or nothing can be said.
    Open,
}

fn outcome(system: &Arc<System>, faults: &[FinalFault]) -> Outcome {
    let mut run = Run::new(system, Options::default());
    let mut still = 0;
    for _ in 0..MAX_STEPS {
        match run.status() {
            RunStatus::Running => {}
            RunStatus::Ended => return Outcome::Ends,
            RunStatus::Refuted | RunStatus::LimitReached | RunStatus::Deadlock => return Outcome::Open,
        }
        let before = (run.marking().clone(), run.true_state().clone(), run.belief().most_likely().clone());
        let input =
            StepInput { injected: possible(&system.model, &before.1, faults), ..StepInput::default() };
        if run.step(&input).is_err() {
            return Outcome::Open;
        }
        let after = (run.marking().clone(), run.true_state().clone(), run.belief().most_likely().clone());
        let has_failed = faults.iter().all(|(id, mode)| after.1.mode(*id) == *mode);
        let is_still = before == after && has_failed && !run.depends_on_time();
        still = if is_still { still + 1 } else { 0 };
        if still == STILL_STEPS {
            let first = run.marking().iter().next().and_then(|location| system.automaton.location(location));
            let labels = run.upcoming().labels.iter().map(ToString::to_string).collect();
            return Outcome::Waits { span: first.map_or(Span::default(), |location| location.span), labels };
        }
    }
    Outcome::Open
}

/// The faults that can come in the next step.
fn possible(
    model: &Model,
    state: &State,
    faults: &[FinalFault],
) -> std::collections::BTreeMap<ComponentId, u8> {
    let can_come = |(id, to): &&FinalFault| {
        let mode = model.component(*id).and_then(|data| data.modes.get(usize::from(state.mode(*id))));
        mode.is_some_and(|mode| mode.faults.iter().any(|fault| fault.to == *to))
    };
    faults.iter().filter(can_come).copied().collect()
}
