//! `E-FORM`: unknown construct in a control program (SPEC 2.1). The prefix notation reports it.

use crate::diagnostic::{Code, Severity};
use crate::explanation::Explanation;

pub const CODE: Code = Code("E-FORM");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "unknown construct in a control program",
    meaning: "In a control program or a plant model, the first word in parentheses must be a construct, such as `SEQUENCE`,
`PARALLEL`, `WHEN-DONEXT` or `DEFCLASS`, or the name of a definition in the file. This word is neither.",
    example: "(PARALEL (EngineA = Standby) (Camera = Off))",
    fix: "Correct the word, or add a definition with this name.",
    mended: "(PARALLEL (EngineA = Standby) (Camera = Off))",
};
