//! `W-CHOICE`: choice with one alternative.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::parser::replacement;
use crate::span::Span;

pub const CODE: Code = Code("W-CHOICE");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "choice with one alternative",
    meaning:
        "A `choose` with a single alternative offers no choice. A common cause is `;`, which makes a sequence,
instead of `,` between the alternatives.",
    example: "primitive Drive()[20,30];
primitive Wait()[20,30];
scenario Day[0,60] = { choose { Drive(); Wait() } }",
    fix: "Separate alternatives with `,`, or leave out the word `choose`.",
    mended: "primitive Drive()[20,30];
primitive Wait()[20,30];
scenario Day[0,60] = { choose { Drive(), Wait() } }",
};

/// A choice with a single alternative, at its `choose`.
pub(crate) fn one_alternative(choose: Span) -> Diagnostic {
    Diagnostic::warning(CODE, choose, "this `choose` has only one alternative")
        .with_hint("separate alternatives with `,`; `;` makes a sequence")
        .with_fix(replacement("Remove `choose`", choose, ""))
}
