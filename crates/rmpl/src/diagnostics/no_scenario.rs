//! `E-NOSCENARIO`: nothing to plan. It is reported by whoever asks for a plan.

use crate::diagnostic::{Code, Severity};
use crate::explanation::Explanation;

pub const CODE: Code = Code("E-NOSCENARIO");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "nothing to plan",
    meaning: "A plan is made for a scenario, and the file has none, or none of the name that was asked for. A file of activities alone
is fine until a plan is wanted.",
    example: "primitive Drive()[20,30];",
    fix: "Write a scenario, or plan one activity of the file by itself.",
    mended: "primitive Drive()[20,30];
scenario Day[0,60] = { Drive() }",
};
