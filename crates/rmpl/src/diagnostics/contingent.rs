//! `E-CONTINGENT`: the environment is to choose how long something composite takes (SPEC 13.1).

use crate::diagnostic::{Code, Diagnostic, Fix, Severity};
use crate::explanation::Explanation;
use crate::parser::{CONTINGENT, replacement};
use crate::span::Span;

pub const CODE: Code = Code("E-CONTINGENT");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "`contingent` on a composite",
    meaning: "Only a primitive activity, an assertion or a delay can be `contingent`, as in `contingent [20,40]`: the
environment chooses its duration. The duration of a block, a choice, a `do`, an `if`, a defined activity or the scenario
follows from its parts. To limit that duration, write bounds without the word.",
    example: "primitive Drive()[10,30];
primitive Dig()[5,5];
scenario Day[0,60] = { { Drive(); Dig() } contingent [15,35] }",
    fix: "Move `contingent` to the activity whose duration is uncontrolled, and remove it here.",
    mended: "primitive Drive() contingent [10,30];
primitive Dig()[5,5];
scenario Day[0,60] = { { Drive(); Dig() } [15,35] }",
};

/// Contingent bounds at `span` of `what`, which is composite. `word` is their word with the blanks after it, `moved` a
/// change that puts them where the environment can choose.
pub(crate) fn composite(what: &str, word: Span, span: Span, moved: Option<Fix>) -> Diagnostic {
    let message = format!("only an activity, an assertion or a delay can be contingent, not {what}");
    let diagnostic = Diagnostic::error(CODE, span, message).with_hint(
        "move `contingent` to the part whose duration is uncontrolled; without the word, these bounds limit the total duration",
    );
    let diagnostic = match moved {
        Some(moved) => diagnostic.with_fix(moved),
        None => diagnostic,
    };
    diagnostic.with_fix(replacement("Remove `contingent`", word, ""))
}

/// Contingent bounds at `span` of a call of the defined activity `name`.
pub fn activity(name: &str, span: Span) -> Diagnostic {
    let word = Span::new(span.start, (span.start + CONTINGENT.len() as u32).min(span.end));
    composite(&format!("the activity `{name}`"), word, span, None)
}
