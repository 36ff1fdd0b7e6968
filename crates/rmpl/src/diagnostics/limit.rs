//! `E-LIMIT`: a mission that expands to more than can be planned. Compilation reports it.

use crate::diagnostic::{Code, Severity};
use crate::explanation::Explanation;

/// The code.
pub const CODE: Code = Code("E-LIMIT");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "a mission that expands to too much",
    meaning: "Every call is written out in full. Activities that each call another one twice double the network with every level: thirty
levels are a thousand million copies. The mission is refused before it fills the memory.",
    example: "primitive Step()[1,2];
Twice() = { Step(); Step() }
Four() = { Twice(); Twice() }
scenario Day[0,60] = { Four() }",
    fix: "Call the activities of the lowest levels fewer times, or plan one activity at a time.",
    mended: "primitive Step()[1,2];
Twice() = { Step(); Step() }
scenario Day[0,60] = { Twice() }",
};
