//! `E-NETWORK`: a text that begins as the file of a network and cannot be read as one. Only reading such a file can find it.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("E-NETWORK");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "the file of a network cannot be read",
    meaning: "A text that begins with a map of JSON or EDN is the file of a network: plan-schema as other tools write it, or the
JSON that `enroute tpn --format json` writes. It is neither: the notation is broken, an object refers to one that is not there,
or a bound is no exact time.",
    example: "{\"network-id\": \"net\", \"net\": {\"tpn-type\": \"network\", \"begin-node\": \"a\"}}",
    fix: "Mend the file where the message says, or export it again. A mission in RMPL begins with a declaration.",
    mended: "scenario Day[0,60] = { Work()[1,2] }",
};

/// The text cannot be read for this `reason`.
pub fn unreadable(reason: &str) -> Diagnostic {
    Diagnostic::error(CODE, Span::default(), format!("this network cannot be read: {reason}"))
}
