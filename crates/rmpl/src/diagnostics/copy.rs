//! `W-COPY`: activities that differ only in a vehicle or a location.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("W-COPY");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Note,
    title: "activities that differ only in a vehicle or a location",
    meaning: "Several activities differ only in name and in one vehicle or location. One activity with a parameter can
replace them. The quick fix merges the activities and changes their calls.",
    example: "location BASE (0, 0);
vehicle R1 : ATRV at BASE;
vehicle R2 : ATRV at BASE;
primitive Rest1()[5,10] requires R1.at=BASE;
primitive Rest2()[5,10] requires R2.at=BASE;
scenario Day[0,60] = { Rest1(), Rest2() }",
    fix: "Write one activity with a parameter.",
    mended: "location BASE (0, 0);
vehicle R1 : ATRV at BASE;
vehicle R2 : ATRV at BASE;
primitive Rest(r)[5,10] requires r.at=BASE;
scenario Day[0,60] = { Rest(R1), Rest(R2) }",
};

/// These activities differ only in these vehicles, or locations.
pub(crate) fn copies(activities: &[&str], subjects: &[&str], span: Span) -> Diagnostic {
    let message = match (activities, subjects) {
        ([first, second], [own, other]) => {
            format!("`{first}` and `{second}` differ only in `{own}` and `{other}`")
        }
        ([first, rest @ ..], [own, ..]) => {
            format!("`{first}` and {} other activities differ only in `{own}`", rest.len())
        }
        _ => String::new(),
    };
    Diagnostic { severity: Severity::Note, ..Diagnostic::warning(CODE, span, message) }
        .with_hint("one activity with a parameter says the same")
}
