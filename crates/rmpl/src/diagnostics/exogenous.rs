//! `W-EXOGENOUS`: a branch of the world's whose times the plan would choose (SPEC 13.3). Compilation reports it.

use crate::diagnostic::{Code, Diagnostic, Edit, Fix, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("W-EXOGENOUS");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "the plan chooses when the world acts",
    meaning: "A branch of the scenario that calls nothing, and only waits and asserts, is what the world does. Where it leaves a choice,
as `delay[5,20]` does, the planner takes the time that suits the plan: it moves the storm past the survey. Behind `contingent`
the choice is nature's, and the plan has to withstand every one. A `delay` without bounds may take any time, and leaves a choice
as well.",
    example: "var GO : {OK, NO};
primitive Dig()[4,4];
scenario Day[0,60] = { { delay; do { Dig() } maintaining GO=OK }, { delay[5,20]; GO=OK [10,10] } }",
    fix: "Write `contingent` before the bounds that nature chooses from, which are finite. Where it is known when the world acts, give
both bounds the same time.",
    mended: "var GO : {OK, NO};
primitive Dig()[4,4];
scenario Day[0,60] = { { delay; do { Dig() } maintaining GO=OK }, { delay contingent [5,20]; GO=OK [10,10] } }",
};

/// What a branch of the world's leaves to the plan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    /// The delay or the assertion.
    pub statement: Span,
    /// How it reads: `delay` or its condition.
    pub name: String,
    /// The bounds as they are evaluated, `[5,20]`, and where they stand, if they are written.
    pub bounds: (String, Option<Span>),
    /// Whether the upper one is finite, so that nature can choose.
    pub is_finite: bool,
    /// Whether the word needs a blank before it where the bounds stand.
    pub needs_blank: bool,
}

/// A branch of the world's that leaves `choices` to the plan; none if it leaves none.
pub fn branch(choices: &[Choice]) -> Option<Diagnostic> {
    let first = choices.first()?;
    let span = first.bounds.1.unwrap_or(first.statement);
    let more = match choices.len() - 1 {
        0 => String::new(),
        1 => ", and 1 more".to_owned(),
        more => format!(", and {more} more"),
    };
    let message = format!(
        "this branch calls nothing, so it is what the world does, and the plan would choose when: from {} of `{}`{more}",
        first.bounds.0, first.name
    );
    let hint = match choices.iter().find(|choice| !choice.is_finite) {
        Some(endless) => format!(
            "say how long it takes at most: nature chooses from finite bounds, as in `{} contingent [0,30]`",
            endless.name
        ),
        None => "behind `contingent` nature chooses; bounds that are equal leave no choice".to_owned(),
    };
    let edits: Vec<Edit> = (choices.iter().filter(|choice| choice.is_finite))
        .filter_map(|choice| {
            let at = choice.bounds.1?.start;
            let text = if choice.needs_blank { " contingent " } else { "contingent " };
            Some(Edit { span: Span::new(at, at), text: text.to_owned() })
        })
        .collect();
    let diagnostic = Diagnostic::warning(CODE, span, message).with_hint(hint);
    if edits.is_empty() {
        return Some(diagnostic);
    }
    let fix = Fix { label: "Let nature choose: insert `contingent`".to_owned(), edits };
    Some(diagnostic.with_fix(fix))
}
