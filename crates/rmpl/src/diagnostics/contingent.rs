//! `E-CONTINGENT`: nature is to choose how long something composite takes (SPEC 13.1).

use crate::diagnostic::{Code, Diagnostic, Fix, Severity};
use crate::explanation::Explanation;
use crate::parser::{CONTINGENT, replacement};
use crate::span::Span;

pub const CODE: Code = Code("E-CONTINGENT");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "nature cannot choose how long something composite takes",
    meaning: "Of one activity, one assertion or one delay, nature may choose how long it takes: `contingent [20,40]`. How long a block, a
choice, a `do`, an `if`, a defined activity or the scenario takes follows from what happens in it. Bounds around it
without the word are requirements on that.",
    example: "primitive Drive()[10,30];
primitive Dig()[5,5];
scenario Day[0,60] = { { Drive(); Dig() } contingent [15,35] }",
    fix: "Write the word at the activity that nature decides about, and leave it out here.",
    mended: "primitive Drive() contingent [10,30];
primitive Dig()[5,5];
scenario Day[0,60] = { { Drive(); Dig() } [15,35] }",
};

/// Contingent bounds at `span` of `what`, which is composite. `word` is their word with the blanks behind it, `moved` a
/// change that puts them where nature can choose.
pub(crate) fn composite(what: &str, word: Span, span: Span, moved: Option<Fix>) -> Diagnostic {
    let message = format!(
        "nature chooses how long an activity, an assertion or a delay takes, not how long {what} does"
    );
    let diagnostic = Diagnostic::error(CODE, span, message).with_hint(
        "write `contingent` at the part that nature decides about; bounds without the word are required of the whole",
    );
    let diagnostic = match moved {
        Some(moved) => diagnostic.with_fix(moved),
        None => diagnostic,
    };
    diagnostic.with_fix(replacement("Leave out `contingent`", word, ""))
}

/// Contingent bounds at `span` of a call of the defined activity `name`.
pub fn activity(name: &str, span: Span) -> Diagnostic {
    let word = Span::new(span.start, (span.start + CONTINGENT.len() as u32).min(span.end));
    composite(&format!("the activity `{name}`"), word, span, None)
}
