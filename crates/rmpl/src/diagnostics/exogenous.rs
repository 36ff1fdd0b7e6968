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
    title: "planner controls an external event",
    meaning: "A branch of the scenario that calls no activity, and only waits and asserts, describes external events. If its
times are flexible, as in `delay[5,20]`, the planner picks the time that suits the plan, for example a storm after the
survey. A `delay` without bounds is flexible too. After `contingent`, the environment chooses the time, and the plan must
work for every choice. With `choose` or `any`, the planner picks the alternative that suits the plan, such as clear weather; with
`unordered`, it picks the order.",
    example: "var GO : {OK, NO};
primitive Dig()[4,4];
scenario Day[0,60] = { { delay; do { Dig() } maintaining GO=OK }, { delay[5,20]; GO=OK [10,10] } }",
    fix: "If the environment decides, write `contingent` before finite bounds. If the time is known, make both bounds equal.
If the branch has alternatives, keep one, and plan for each of the others in a separate scenario.",
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
    /// The bounds as they are evaluated, `[5,20]`, and where they are, if they are written.
    pub bounds: (String, Option<Span>),
    /// Whether the upper one is finite, so that the environment can choose.
    pub is_finite: bool,
    /// Whether the word needs a blank before it where the bounds is.
    pub needs_blank: bool,
}

impl Choice {
    /// Returns where it is told: at its bounds, if they are written.
    pub fn place(&self) -> Span {
        self.bounds.1.unwrap_or(self.statement)
    }
}

/// How the messages begin whose branch leaves times to the plan; the statements and their bounds follow.
pub const WHEN: &str = "the planner chooses when this external event happens: ";

/// How the messages begin whose branch leaves alternatives to the plan; their number follows.
pub const WHAT: &str = "the planner chooses which external event happens: ";

/// What a statement of the world's leaves to the plan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Alternatives {
    /// One of so many parts of a `choose`.
    Choose(usize),
    /// One member of this group.
    Any(String),
    /// The order of the parts.
    Unordered,
}

/// So many of the statements of a branch are listed.
const MAX_LISTED: usize = 4;

/// Returns what the statements of a branch leave to the plan, one after the other.
fn list(parts: &[String]) -> String {
    match parts {
        [shown @ .., last] if !shown.is_empty() && parts.len() <= MAX_LISTED => {
            format!("{}, and {last}", shown.join(", "))
        }
        all if all.len() > MAX_LISTED => {
            format!("{}, and {} more", all[..MAX_LISTED].join(", "), all.len() - MAX_LISTED)
        }
        all => all.concat(),
    }
}

/// A branch of the world's that leaves alternatives to the plan, by each such statement and where its word is; none if it leaves
/// none.
pub fn alternatives(found: &[(Alternatives, Span)]) -> Option<Diagnostic> {
    let (first, word) = found.first()?;
    let what = |(of, _): &(Alternatives, Span)| match of {
        Alternatives::Choose(count) => format!("one of the {count} alternatives of `choose`"),
        Alternatives::Any(group) => format!("one for a member of `{group}`"),
        Alternatives::Unordered => "the first one of `unordered`".to_owned(),
    };
    let hint = match first {
        Alternatives::Unordered => "write the events in the order in which they happen",
        Alternatives::Choose(_) | Alternatives::Any(_) => {
            "keep one alternative, and plan for each of the others in a separate scenario"
        }
    };
    let what = list(&found.iter().map(what).collect::<Vec<_>>());
    Some(Diagnostic::warning(CODE, *word, format!("{WHAT}{what}")).with_hint(hint))
}

/// A branch of the world's that leaves `choices` to the plan; none if it leaves none.
pub fn branch(choices: &[Choice]) -> Option<Diagnostic> {
    let span = choices.first()?.place();
    let left = choices.iter().map(|it| format!("`{}` allows {}", it.name, it.bounds.0));
    let message = format!("{WHEN}{}", list(&left.collect::<Vec<_>>()));
    let hint = match choices.iter().find(|choice| !choice.is_finite) {
        Some(endless) => format!(
            "give it a finite maximum, as in `{} contingent [0,30]`, so that the plan must work for every time in the range",
            endless.name
        ),
        None => {
            "add `contingent` if the environment decides, or use equal bounds if the time is known".to_owned()
        }
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
    let fix = Fix { label: "Insert `contingent`".to_owned(), edits };
    Some(diagnostic.with_fix(fix))
}
