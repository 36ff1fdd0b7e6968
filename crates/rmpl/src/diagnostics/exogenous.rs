//! `W-EXOGENOUS`: a branch of the world's whose times or alternatives the plan would choose (SPEC 13.3). Compilation reports
//! it.

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
as well. So does `choose`: the planner takes the alternative that suits the plan, such as clear weather.",
    example: "var GO : {OK, NO};
primitive Dig()[4,4];
scenario Day[0,60] = { { delay; do { Dig() } maintaining GO=OK }, { delay[5,20]; GO=OK [10,10] } }",
    fix: "Write `contingent` before the bounds that nature chooses from, which are finite. Where it is known when the world acts, give
both bounds the same time. Of the alternatives of `choose`, keep the one that the plan is made for, and plan for each other one
apart.",
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

/// How every message begins; what the plan would choose follows: `when: …` or `what: …`.
pub const BEGINNING: &str =
    "this branch calls nothing, so it is what the world does, and the plan would choose ";

/// A branch of the world's that leaves alternatives to the plan: how many the first `choose` has and where that word
/// stands, and how many more such statements there are.
pub fn alternatives(count: usize, word: Span, more: usize) -> Diagnostic {
    let more = match more {
        0 => String::new(),
        1 => ", and of 1 more choice".to_owned(),
        more => format!(", and of {more} more choices"),
    };
    let message = format!("{BEGINNING}what: one of the {count} alternatives of `choose`{more}");
    Diagnostic::warning(CODE, word, message)
        .with_hint("keep the alternative that the plan is made for, and plan for each other one apart")
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
    let message = format!("{BEGINNING}when: from {} of `{}`{more}", first.bounds.0, first.name);
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
