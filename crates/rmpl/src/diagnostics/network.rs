//! `W-NETWORK`: what the file of a network says and planning does not honour. Only reading such a file can find it.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("W-NETWORK");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "something in a network's file that planning does not honour",
    meaning: "Files of other tools say more than planning a network takes into account: what activities cost and earn, limits on
that, durations that are not the executive's to choose, guards and probabilities. The plan and every verdict about it hold for the
network without them.",
    example: "// In a file of another tool: {\"act-1\": {\"tpn-type\": \"activity\", \"cost\": 5, \"controllable\": false, …}, …}",
    fix: "Write the mission in RMPL, where activities have `costs`, `rewards` and `contingent` durations.",
    mended: "primitive Act()contingent [2,5] costs 5;
scenario Day[0,60] = { Act() }",
};

/// `what` the file of a network says in vain.
pub fn not_honoured(what: &[String]) -> Diagnostic {
    let message = format!("planning does not honour what this file says: {}", what.join(", "));
    Diagnostic::warning(CODE, Span::default(), message)
}
