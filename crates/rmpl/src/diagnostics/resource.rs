//! `E-RESOURCE`: more is asked of a resource than it can ever give (SPEC 11). Compilation reports it.

use crate::diagnostic::{Code, Severity};
use crate::explanation::Explanation;

pub const CODE: Code = Code("E-RESOURCE");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "resource demand exceeds capacity",
    meaning: "A call uses more of a resource than its capacity, or consumes or produces more than the difference between the
minimum and the maximum level. No plan can contain such a call. Activities *use* a resource with a capacity and free it when
they end. They *consume* and *produce* a resource with levels.",
    example: "resource Power capacity 2;
primitive Drill()[20,30] uses Power 3;
scenario Day[0,60] = { Drill() }",
    fix: "Use less, or raise the capacity.",
    mended: "resource Power capacity 3;
primitive Drill()[20,30] uses Power 3;
scenario Day[0,60] = { Drill() }",
};
