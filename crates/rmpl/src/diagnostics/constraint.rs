//! `E-CONSTRAINT`: malformed constraint of a control program (SPEC 2.1). The prefix notation reports it.

use crate::diagnostic::{Code, Severity};
use crate::explanation::Explanation;

pub const CODE: Code = Code("E-CONSTRAINT");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "malformed constraint",
    meaning: "A constraint compares a variable with a value, as in `(EngineA = Firing)`, negates one with `NOT`, or joins several with
`AND` or `OR`. It needs both sides of the `=`.",
    example: "(WHEN-DONEXT (EngineA =) (Camera = Off))",
    fix: "Write the missing part, or put parentheses around each comparison.",
    mended: "(WHEN-DONEXT (EngineA = Standby) (Camera = Off))",
};
