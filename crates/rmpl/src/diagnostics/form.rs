//! `E-FORM`: an unknown construct of a control program (SPEC 2.1). The prefix notation reports it.

use crate::diagnostic::{Code, Severity};
use crate::explanation::Explanation;

pub const CODE: Code = Code("E-FORM");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "an unknown construct of a control program",
    meaning: "The first word in the parentheses of a control program or a plant model says what they are: `SEQUENCE`, `PARALLEL`,
`WHEN-DONEXT`, `DEFCLASS` and so on, or the name of a definition of the file. This word is none of them.",
    example: "(PARALEL (EngineA = Standby) (Camera = Off))",
    fix: "Correct the word, or define what it names.",
    mended: "(PARALLEL (EngineA = Standby) (Camera = Off))",
};
