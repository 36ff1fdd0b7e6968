//! `W-CONTROLLABILITY`: plans that withstand nothing of what the environment chooses (SPEC 13.1).

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::parser::replacement;
use crate::span::Span;

pub const CODE: Code = Code("W-CONTROLLABILITY");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "`contingent` is ignored",
    meaning: "With `option controllability = none;`, the planner treats `contingent` bounds as ordinary bounds and chooses
these durations itself. The environment may choose other durations, so execution may fail although the plan is valid.",
    example: "option controllability = none;
primitive Drive() contingent [20,40];
scenario Day[0,60] = { Drive() }",
    fix: "Use `dynamic` (the default) or `strong` to get plans that work for every duration in the range.",
    mended: "option controllability = dynamic;
primitive Drive() contingent [20,40];
scenario Day[0,60] = { Drive() }",
};

/// The option's value at `span` lets the planner ignore `contingent`, and the file has such durations.
pub(crate) fn ignored(span: Span) -> Diagnostic {
    Diagnostic::warning(
        CODE,
        span,
        "`contingent` is ignored: a plan may fail if the environment chooses other durations",
    )
    .with_hint("with `dynamic`, plans work for every duration in the range")
    .with_fix(replacement("Change to `dynamic`", span, "dynamic"))
}
