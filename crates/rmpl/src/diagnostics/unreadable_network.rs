//! `E-NETWORK`: a text that begins as the file of a network and cannot be read as one. Only reading such a file can find it.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("E-NETWORK");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "unreadable network file",
    meaning: "A text that starts with `{` is read as a network: plan-schema in JSON or EDN, or the JSON that `enroute tpn
--format json` writes. This file is neither. It may have a syntax error, a reference to a missing object, or a bound that is
not an exact time.",
    example: "{\"network-id\": \"net\", \"net\": {\"tpn-type\": \"network\", \"begin-node\": \"a\"}}",
    fix: "Fix the file at the position shown, or export it again. An RMPL mission starts with a declaration.",
    mended: "scenario Day[0,60] = { Work()[1,2] }",
};

/// The text cannot be read for this `reason`.
pub fn unreadable(reason: &str) -> Diagnostic {
    Diagnostic::error(CODE, Span::default(), format!("cannot read this network: {reason}"))
}
