//! Checks of modes and arcs: modes that no values allow or nothing reaches, transitions that conflict, and faults that sum to
//! more than 1 (SPEC 9.1).

use std::collections::BTreeMap;

use rmpl::diagnostics::{ambiguous, constraint, probability, unreachable};
use rmpl::{Diagnostic, Span};

use crate::assignment::{Found, describe, satisfying};
use crate::formula::Formula;
use crate::model::{Component, ComponentId, Mode, Model};
use crate::value_set::ValueSet;

/// Adds what is wrong with the modes and arcs of a component.
pub(crate) fn check_arcs(model: &Model, id: ComponentId, diagnostics: &mut Vec<Diagnostic>) {
    let Some(component) = model.component(id) else { return };
    let mut sets = model.full.clone();
    for (number, mode) in (0..=u8::MAX).zip(&component.modes) {
        sets[Model::mode_symbol(id) as usize] = ValueSet::one(number);
        let impossible = satisfying(&[&mode.constraint], &mut sets) == Found::Nothing;
        let impossible = impossible.then(|| constraint::impossible_mode(&mode.name, mode.span));
        let found = impossible.into_iter().chain(choices(model, component, mode, &mut sets));
        for diagnostic in found.chain(faults(model, component, mode, &mut sets)) {
            // Components of one class have the same errors.
            diagnostic.add_once_to(diagnostics);
        }
    }
}

/// Adds a warning for each mode that no component starts in, and no transition or fault leads to.
pub(crate) fn check_reach(model: &Model, diagnostics: &mut Vec<Diagnostic>) {
    // A mode of a class is reachable if one of its components reaches it.
    let mut reached: BTreeMap<Span, (&str, &str, bool)> = BTreeMap::new();
    for component in &model.components {
        let modes = reach(component);
        for (number, mode) in (0..=u8::MAX).zip(&component.modes) {
            let entry = reached.entry(mode.span).or_insert((&component.class, &mode.name, false));
            entry.2 |= modes.contains(number);
        }
    }
    for (span, (class, mode, _)) in reached.into_iter().filter(|(_, (.., is_reached))| !is_reached) {
        diagnostics.push(unreachable::mode(class, mode, span));
    }
}

/// The modes that a component can reach.
fn reach(component: &Component) -> ValueSet {
    let mut reached = component.prior.iter().map(|(mode, _)| *mode).collect::<ValueSet>();
    loop {
        let before = reached;
        for mode in before.values().filter_map(|mode| component.modes.get(usize::from(mode))) {
            let outcomes = mode.choices.iter().flat_map(|choice| choice.outcomes.iter().map(|(to, _)| *to));
            reached = outcomes
                .chain(mode.faults.iter().map(|fault| fault.to))
                .fold(reached, |all, to| all | ValueSet::one(to));
        }
        if reached == before {
            return reached;
        }
    }
}

/// Pairs of guards that can hold together and lead to different modes.
fn choices(model: &Model, component: &Component, mode: &Mode, sets: &mut [ValueSet]) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for (at, second) in mode.choices.iter().enumerate() {
        for first in mode.choices.iter().take(at).filter(|first| first.differs(second)) {
            let together = satisfying(&[&first.guard, &second.guard, &mode.constraint], sets);
            if let Found::Assignment(assignment) = together {
                let name =
                    |to: u8| component.modes.get(usize::from(to)).map_or("?", |mode| mode.name.as_str());
                let place = describe(model, &assignment);
                let (one, other) = (name(first.nominal), name(second.nominal));
                found.push(ambiguous::guards(&mode.name, one, other, &place, second.span));
                break;
            }
        }
    }
    found
}

/// Faults that are possible together and sum to more than 1.
fn faults(model: &Model, component: &Component, mode: &Mode, sets: &mut [ValueSet]) -> Option<Diagnostic> {
    let sum = mode.faults.iter().map(|fault| u128::from(fault.numerator)).sum::<u128>();
    if sum <= u128::from(mode.denominator) {
        return None;
    }
    let assignment = too_probable(mode, sets, &mut Vec::new(), 0, 0)?;
    let span = mode.faults.last().map_or(component.span, |fault| fault.span);
    Some(probability::faults(&mode.name, &describe(model, &assignment), span))
}

/// Values with which faults from a place on, beside those whose guards are held already, sum to more than 1.
fn too_probable<'mode>(
    mode: &'mode Mode,
    sets: &mut [ValueSet],
    held: &mut Vec<&'mode Formula>,
    at: usize,
    sum: u128,
) -> Option<Vec<(u32, u8)>> {
    let all: Vec<&Formula> = held.iter().copied().chain([&mode.constraint]).collect();
    let Found::Assignment(assignment) = satisfying(&all, sets) else { return None };
    if sum > u128::from(mode.denominator) {
        return Some(assignment);
    }
    let fault = mode.faults.get(at)?;
    held.push(&fault.guard);
    let with = too_probable(mode, sets, held, at + 1, sum + u128::from(fault.numerator));
    held.pop();
    with.or_else(|| {
        let rest = mode.faults.iter().skip(at + 1).map(|fault| u128::from(fault.numerator)).sum::<u128>();
        let is_possible = sum + rest > u128::from(mode.denominator);
        is_possible.then(|| too_probable(mode, sets, held, at + 1, sum)).flatten()
    })
}
