//! `W-MIXED`: `,` and `;` in the same braces (SPEC 1.3).

use crate::diagnostic::{Code, Diagnostic, Edit, Fix, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("W-MIXED");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "`,` and `;` in the same braces",
    meaning: "`,` binds tighter than `;`: in `{ A(), B(); C() }` the activities A and B run in parallel, and C follows both. A
reader may expect something else.",
    example: "primitive A()[1,2];
primitive B()[1,2];
primitive C()[1,2];
scenario Day[0,9] = { A(), B(); C() }",
    fix: "Put braces around the parallel part.",
    mended: "primitive A()[1,2];
primitive B()[1,2];
primitive C()[1,2];
scenario Day[0,9] = { { A(), B() }; C() }",
};

/// `comma` is the first `,` of a block that also has `;`; `parallels` are the parts that `,` makes.
pub(crate) fn mixed(comma: Span, parallels: &[Span]) -> Diagnostic {
    let edits = parallels.iter().flat_map(|span| {
        [
            Edit { span: Span::new(span.start, span.start), text: "{ ".to_owned() },
            Edit { span: Span::new(span.end, span.end), text: " }".to_owned() },
        ]
    });
    let fix = Fix { label: "Put braces around the parallel part".to_owned(), edits: edits.collect() };
    Diagnostic::warning(CODE, comma, "`,` and `;` in the same braces: `,` binds tighter")
        .with_hint(
            "parts joined by `,` run in parallel; the part after `;` starts when all of them have ended",
        )
        .with_fix(fix)
}
