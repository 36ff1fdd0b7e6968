//! What a plan assumes: branches of the scenario that are the world's, and leave to the plan when the world acts (SPEC
//! 13.3).

use exact::Bound;
use rmpl::diagnostics::exogenous::{Choice, branch};
use rmpl::program::{Bounds, Condition, Program, ScenarioDecl, Statement, StatementKind};
use rmpl::{Diagnostic, Span};

use super::bounds::{self, Interval};
use super::constants::Constants;
use super::names::Fact;

/// A warning for each branch of `scenario` that calls nothing and leaves a choice.
pub(super) fn check(scenario: &ScenarioDecl, constants: &Constants<'_>) -> Vec<Diagnostic> {
    branches(scenario).iter().filter_map(|of| branch(&choices(of, constants))).collect()
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
