//! `W-CONTROLLABILITY`: plans that withstand nothing of what nature chooses (SPEC 13.1).

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::parser::replacement;
use crate::span::Span;

pub const CODE: Code = Code("W-CONTROLLABILITY");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "plans choose what nature does",
    meaning: "With `option controllability = none;` the planner reads `contingent` bounds as ordinary ones: it chooses the durations that
nature chooses, and the plan holds only if nature happens to agree. Execution may fail although the plan is valid.",
    example: "option controllability = none;
primitive Drive() contingent [20,40];
scenario Day[0,60] = { Drive() }",
    fix: "Ask for plans that can be executed whatever nature chooses: `dynamic`, as without the option, or `strong`.",
    mended: "option controllability = dynamic;
primitive Drive() contingent [20,40];
scenario Day[0,60] = { Drive() }",
};

/// The option's value at `span` lets plans choose what nature does, and the file has such durations.
pub(crate) fn ignored(span: Span) -> Diagnostic {
    Diagnostic::warning(
        CODE,
        span,
        "plans choose the contingent durations as well, and may fail when nature does not agree",
    )
    .with_hint("`dynamic` asks for plans that can be executed whatever nature chooses")
    .with_fix(replacement("Change to `dynamic`", span, "dynamic"))
}
