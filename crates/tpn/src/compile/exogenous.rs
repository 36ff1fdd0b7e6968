//! What a plan assumes: branches of the scenario that are the world's, and leave to the plan when the world acts or what it
//! does (SPEC 13.3).

use exact::Bound;
use rmpl::diagnostics::exogenous::{Alternatives, Choice, alternatives, branch};
use rmpl::program::{Bounds, Condition, MembersForm, Program, ScenarioDecl, Statement, StatementKind};
use rmpl::{Diagnostic, Span};

use super::bounds::{self, Interval};
use super::constants::Constants;
use super::names::Fact;

/// Warnings for each branch of `scenario` that calls no primitive: one if it leaves times to the plan, and one if it leaves
/// alternatives.
pub(super) fn check(
    program: &Program,
    scenario: &ScenarioDecl,
    constants: &Constants<'_>,
) -> Vec<Diagnostic> {
    let warnings = |of| {
        let statements = of_the_world(program, of)?;
        let times = branch(&choices(&statements, constants));
        let decisions =
            decisions(program, &statements).into_iter().map(|decision| (decision.of, decision.word));
        let alternatives = alternatives(&decisions.collect::<Vec<_>>());
        Some(times.into_iter().chain(alternatives))
    };
    branches(scenario).iter().filter_map(warnings).flatten().collect()
}

/// The delays and assertions of the world's whose times the plan of a scenario chooses, where they are written.
pub fn assumed(program: &Program) -> Vec<Span> {
    let (constants, _) = Constants::new(program);
    let branches = program.scenarios.iter().flat_map(branches);
    let statements = branches.filter_map(|of| of_the_world(program, of));
    statements.flat_map(|of| choices(&of, &constants)).map(|choice| choice.statement).collect()
}

/// What one warning of a branch of the world's is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assumption {
    /// Where the warning is.
    pub warning: Span,
    /// Each statement that leaves something to the plan.
    pub statements: Vec<Span>,
}

/// The warnings about the world's branches of all scenarios, with every statement that they are about. The text of a warning
/// lists only some.
pub fn assumptions(program: &Program) -> Vec<Assumption> {
    let (constants, _) = Constants::new(program);
    let branches = program.scenarios.iter().flat_map(branches);
    let of_branch = |statements: Vec<&Statement>| {
        let times = choices(&statements, &constants);
        let decisions = decisions(program, &statements);
        let times = times.first().map(|first| Assumption {
            warning: first.place(),
            statements: times.iter().map(|choice| choice.statement).collect(),
        });
        let alternatives = decisions.first().map(|first| Assumption {
            warning: first.word,
            statements: decisions.iter().map(|decision| decision.statement).collect(),
        });
        [times, alternatives]
    };
    branches.filter_map(|of| of_the_world(program, of)).flat_map(of_branch).flatten().collect()
}

/// The branches of a scenario, one of which may be the world's.
fn branches(scenario: &ScenarioDecl) -> &[Statement] {
    match &scenario.body.kind {
        StatementKind::Parallel(branches) => branches.as_slice(),
        _ => std::slice::from_ref(&scenario.body),
    }
}

/// All statements of a branch in textual order, with those of the activities that it calls; `None` if it calls anything but
/// activities that only wait and assert.
fn of_the_world<'program>(
    program: &'program Program,
    branch: &'program Statement,
) -> Option<Vec<&'program Statement>> {
    let mut statements = Vec::new();
    let mut called: Vec<&str> = Vec::new();
    let mut open = vec![branch];
    while let Some(part) = open.pop() {
        let mut is_of_plan = false;
        part.for_each(&mut |statement| {
            statements.push(statement);
            let StatementKind::Call(name, _) = &statement.kind else { return };
            match program.activities.iter().find(|activity| activity.name.text == name.text) {
                Some(activity) if !called.contains(&name.text.as_str()) => {
                    called.push(&activity.name.text);
                    open.push(&activity.body);
                }
                Some(_) => {}
                None => is_of_plan = true,
            }
        });
        if is_of_plan {
            return None;
        }
    }
    Some(statements)
}

/// A statement of the world's that leaves to the plan what happens, or in which order.
struct Decision {
    of: Alternatives,
    /// Where its word is.
    word: Span,
    statement: Span,
}

/// The statements of the world's that leave to the plan what happens, or in which order. An `if` is decided by its condition,
/// and what is optional is never the world's (SPEC 13.3).
fn decisions(program: &Program, statements: &[&Statement]) -> Vec<Decision> {
    let found = statements.iter().filter_map(|statement| {
        let start = statement.span.start;
        let of = |of: Alternatives, word: &str| {
            let word = Span::new(start, start + word.len() as u32);
            Some(Decision { of, word, statement: statement.span })
        };
        match &statement.kind {
            // What represents a choice has alternatives that begin with the whole statement.
            StatementKind::Choose(parts)
                if parts.len() > 1 && parts.iter().all(|it| it.span.start > start) =>
            {
                of(Alternatives::Choose(parts.len()), "choose")
            }
            StatementKind::Unordered(parts) if parts.len() > 1 => of(Alternatives::Unordered, "unordered"),
            StatementKind::Members(members) if has_several(program, &members.group.text) => {
                match members.form {
                    MembersForm::Any => of(Alternatives::Any(members.group.text.to_string()), "any"),
                    MembersForm::Unordered => of(Alternatives::Unordered, "each"),
                    MembersForm::Parallel | MembersForm::Sequence => None,
                }
            }
            _ => None,
        }
    });
    found.collect()
}

/// Returns whether a group or a fleet has more than one member.
fn has_several(program: &Program, group: &str) -> bool {
    let is_group = program.groups.iter().any(|it| it.name.text == *group && it.members.len() > 1);
    is_group || program.fleets.iter().any(|it| it.name.text == *group && it.members().count() > 1)
}

/// Returns what statements of the world's leave to the plan.
fn choices(statements: &[&Statement], constants: &Constants<'_>) -> Vec<Choice> {
    let left = |statement: &&Statement| match &statement.kind {
        StatementKind::Delay => {
            let name_end = statement.span.start + "delay".len() as u32;
            let at = statement.bounds.as_ref().map_or(name_end, |bounds| bounds.span.start);
            let is_tight = at == name_end;
            choice(statement, "delay".to_owned(), is_tight, Interval::ANY, constants)
        }
        StatementKind::Condition(_, condition) => {
            let name = Fact::written(condition).text().to_string();
            let is_tight = statement.bounds.as_ref().is_some_and(|bounds| needs_blank(condition, bounds));
            choice(statement, name, is_tight, Interval::ZERO, constants)
        }
        _ => None,
    };
    statements.iter().filter_map(left).collect()
}

/// Returns what one delay or assertion leaves to the plan, which lasts `unwritten` where it has no bounds.
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

/// Returns whether a word before the bounds would run into what is before it. Where more than the condition does, as in
/// `a and b[1,2]`, it might.
fn needs_blank(condition: &Condition, bounds: &Bounds) -> bool {
    bounds.span.start.checked_sub(condition.span.end) != Some(1)
}
