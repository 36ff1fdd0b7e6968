//! `E-RESOURCE`: more is asked of a resource than it can ever give (SPEC 11). Compilation reports it.

use crate::diagnostic::{Code, Severity};
use crate::explanation::Explanation;

pub const CODE: Code = Code("E-RESOURCE");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "more than a resource can ever give",
    meaning: "A call uses more of a resource than its capacity, or consumes or produces more than lies between the least and the greatest
level. No plan has such a call. What is used is free again afterwards, and what is consumed is gone: a resource with a capacity is
used, and one with levels is consumed and produced.",
    example: "resource Power capacity 2;
primitive Drill()[20,30] uses Power 3;
scenario Day[0,60] = { Drill() }",
    fix: "Use less, or raise the capacity.",
    mended: "resource Power capacity 3;
primitive Drill()[20,30] uses Power 3;
scenario Day[0,60] = { Drill() }",
};
