//! What a plan assumes: branches of the scenario that are the world's, and leave to the plan when the world acts or what it
//! does (SPEC 13.3).

use exact::Bound;
use rmpl::diagnostics::exogenous::{Choice, alternatives, branch};
use rmpl::program::{Bounds, Condition, Program, ScenarioDecl, Statement, StatementKind};
use rmpl::{Diagnostic, Span};

use super::bounds::{self, Interval};
use super::constants::Constants;
use super::names::Fact;

/// Warnings for each branch of `scenario` that calls nothing: one if it leaves times to the plan, and one if it leaves
/// alternatives.
pub(super) fn check(scenario: &ScenarioDecl, constants: &Constants<'_>) -> Vec<Diagnostic> {
    let warnings = |of| branch(&choices(of, constants)).into_iter().chain(decisions(of));
    branches(scenario).iter().flat_map(warnings).collect()
}

/// The delays and assertions of the world's whose times the plan of a scenario chooses, where they are written.
pub fn assumed(program: &Program) -> Vec<Span> {
    let (constants, _) = Constants::new(program);
    let branches = program.scenarios.iter().flat_map(branches);
    branches.flat_map(|of| choices(of, &constants)).map(|choice| choice.statement).collect()
}

/// The branches of a scenario, one of which may be the world's.
fn branches(scenario: &ScenarioDecl) -> &[Statement] {
    match &scenario.body.kind {
        StatementKind::Parallel(branches) => branches.as_slice(),
        _ => std::slice::from_ref(&scenario.body),
    }
}

/// A warning if `part` calls nothing and leaves alternatives to the plan. Those of `choose` alone: an `if` is decided by its
/// condition, and what is optional is never the world's (SPEC 13.3).
fn decisions(part: &Statement) -> Option<Diagnostic> {
    let mut found: Vec<(usize, Span)> = Vec::new();
    let mut is_of_plan = false;
    part.for_each(&mut |statement| match &statement.kind {
        StatementKind::Call(..) => is_of_plan = true,
        StatementKind::Choose(parts) if parts.len() > 1 => {
            let start = statement.span.start;
            // What stands for a choice has alternatives that begin with the whole statement.
            if parts.iter().all(|alternative| alternative.span.start > start) {
                found.push((parts.len(), Span::new(start, start + "choose".len() as u32)));
            }
        }
        _ => {}
    });
    let (count, word) = *found.first()?;
    (!is_of_plan).then(|| alternatives(count, word, found.len() - 1))
}

/// What `part` leaves to the plan, in textual order; nothing if it calls anything.
fn choices(part: &Statement, constants: &Constants<'_>) -> Vec<Choice> {
    let mut found: Vec<Choice> = Vec::new();
    let mut is_of_plan = false;
    part.for_each(&mut |statement| match &statement.kind {
        StatementKind::Call(..) => is_of_plan = true,
        StatementKind::Delay => {
            let name_end = statement.span.start + "delay".len() as u32;
            let at = statement.bounds.as_ref().map_or(name_end, |bounds| bounds.span.start);
            let is_tight = at == name_end;
            found.extend(choice(statement, "delay".to_owned(), is_tight, Interval::ANY, constants));
        }
        StatementKind::Condition(_, condition) => {
            let name = Fact::written(condition).text().to_string();
            let is_tight = statement.bounds.as_ref().is_some_and(|bounds| needs_blank(condition, bounds));
            found.extend(choice(statement, name, is_tight, Interval::ZERO, constants));
        }
        _ => {}
    });
    if is_of_plan { Vec::new() } else { found }
}

/// What one delay or assertion leaves to the plan, which lasts `unwritten` where it has no bounds.
fn choice(
    statement: &Statement,
    name: String,
    needs_blank: bool,
    unwritten: Interval,
    constants: &Constants<'_>,
) -> Option<Choice> {
    let written = statement.bounds.as_ref();
    // What has no value is an error of its own.
    let interval = written.map_or(Some(unwritten), |written| bounds::interval(written, constants).ok())?;
    let is_natures = written.is_some_and(|written| written.is_contingent);
    let is_open = Bound::Finite(interval.lower) < interval.upper;
    (is_open && !is_natures).then(|| Choice {
        statement: statement.span,
        name,
        bounds: (interval.to_string(), written.map(|written| written.span)),
        is_finite: interval.upper.finite().is_some(),
        needs_blank,
    })
}

/// Whether a word before the bounds would run into what stands before it. Where more than the condition does, as in
/// `a and b[1,2]`, it might.
fn needs_blank(condition: &Condition, bounds: &Bounds) -> bool {
    bounds.span.start.checked_sub(condition.span.end) != Some(1)
}
