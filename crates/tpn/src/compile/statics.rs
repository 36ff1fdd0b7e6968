//! Checks that need no expansion but decide whether one is possible: recursion, and bounds without names.

use std::collections::BTreeMap;

use rmpl::call_cycles::call_cycles;
use rmpl::diagnostics::recursion as wording;
use rmpl::fleet;
use rmpl::program::{ActivityDecl, Bounds, HeaderBound, HeaderBounds, Program, StatementKind};
use rmpl::{Diagnostic, Span};

use super::bounds;
use super::constants::Constants;

/// Everything that is wrong whatever is compiled.
pub(super) fn check(program: &Program, constants: &Constants<'_>) -> Vec<Diagnostic> {
    let mut found = recursion(program);
    found.extend(fleet::check(program));
    let mut check_bounds = |written: &Bounds| {
        if bounds::is_constant(written)
            && let Err(error) = bounds::interval(written, constants)
        {
            found.push(error);
        }
    };
    for primitive in &program.primitives {
        primitive.bounds.iter().for_each(&mut check_bounds);
    }
    for activity in &program.activities {
        if let HeaderBounds::Sides {
            lower: HeaderBound::Limit(lower),
            upper: HeaderBound::Limit(upper),
            span,
        } = &activity.bounds
        {
            check_bounds(&Bounds {
                lower: lower.clone(),
                upper: upper.clone(),
                is_contingent: false,
                span: *span,
            });
        }
        activity.body.for_each(&mut |statement| {
            statement.bounds.iter().for_each(&mut check_bounds);
        });
    }
    for scenario in &program.scenarios {
        scenario.bounds.iter().for_each(&mut check_bounds);
        scenario.body.for_each(&mut |statement| {
            statement.bounds.iter().for_each(&mut check_bounds);
        });
    }
    for constraint in &program.constraints {
        if bounds::is_constant(&constraint.bounds)
            && let Err(error) = bounds::interval_between_events(&constraint.bounds, constants)
        {
            found.push(error);
        }
    }
    found
}

/// One diagnostic for each cycle of calls; cycles that share an activity are one mistake.
fn recursion(program: &Program) -> Vec<Diagnostic> {
    let mut by_name: BTreeMap<&str, usize> = BTreeMap::new();
    for (index, activity) in program.activities.iter().enumerate() {
        by_name.entry(activity.name.text.as_str()).or_insert(index);
    }
    let calls: Vec<Vec<(usize, Span)>> =
        program.activities.iter().map(|activity| calls_of(activity, &by_name)).collect();
    let described = call_cycles(&calls).into_iter().map(|cycle| {
        let name = |&member: &usize| program.activities[member].name.text.as_str();
        wording::cycle(&cycle.members.iter().map(name).collect::<Vec<_>>(), cycle.closing_call)
    });
    described.collect()
}

fn calls_of(activity: &ActivityDecl, by_name: &BTreeMap<&str, usize>) -> Vec<(usize, Span)> {
    let mut calls = Vec::new();
    activity.body.for_each(&mut |statement| {
        if let StatementKind::Call(name, _) = &statement.kind
            && let Some(&callee) = by_name.get(name.text.as_str())
            && activity.formals.iter().all(|formal| formal.text != name.text)
        {
            calls.push((callee, name.span));
        }
    });
    calls
}
