//! `E-NOSCENARIO`: nothing to plan. It is reported by whoever asks for a plan.

use crate::diagnostic::{Code, Severity};
use crate::explanation::Explanation;

pub const CODE: Code = Code("E-NOSCENARIO");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "nothing to plan",
    meaning: "The planner plans a scenario, but the file has none, or none with the requested name. A file with activities
only is valid, but cannot be planned.",
    example: "primitive Drive()[20,30];",
    fix: "Add a scenario, or plan one activity of the file.",
    mended: "primitive Drive()[20,30];
scenario Day[0,60] = { Drive() }",
};
