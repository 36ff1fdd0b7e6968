//! `W-NETWORK`: what the file of a network says and planning does not honor. Only reading such a file can find it.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("W-NETWORK");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "part of a network file is ignored when planning",
    meaning: "Files of other tools contain information that planning ignores: costs and rewards of activities, limits on
them, uncontrolled durations, guards and probabilities. The plan and its verification are valid for the network without this
information.",
    example: "// In a file of another tool: {\"act-1\": {\"tpn-type\": \"activity\", \"cost\": 5, \"controllable\": false, …}, …}",
    fix: "Write the mission in RMPL, which has `costs`, `rewards` and `contingent` durations.",
    mended: "primitive Act()contingent [2,5] costs 5;
scenario Day[0,60] = { Act() }",
};

/// `what` the file of a network says in vain.
pub fn not_honored(what: &[String]) -> Diagnostic {
    let message = format!("ignored when planning: {}", what.join(", "));
    Diagnostic::warning(CODE, Span::default(), message)
}
