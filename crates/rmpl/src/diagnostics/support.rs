//! `W-SUPPORT`: an Ask that no Tell of the file can support.

use crate::analysis::{Literal, Names};
use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;

pub const CODE: Code = Code("W-SUPPORT");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "unsupported condition",
    meaning: "`do … maintaining c`, `if c thennext …` and `ask c` need an assertion of `c` that contains them, but the file
has none. No plan can contain this part; if it is an alternative of a choice, the planner never selects it. For a `state`,
an activity must set the value, unless it is the initial one.",
    example: "primitive Drive()[20,30];
scenario Day[0,60] = { do { Drive() } maintaining LIGHT }",
    fix: "Assert the condition in a parallel branch, with the duration for which it holds, or correct its name.",
    mended: "primitive Drive()[20,30];
scenario Day[0,60] = { { delay; do { Drive() } maintaining LIGHT }, LIGHT [40,40] }",
};

/// An Ask that no Tell of the file can support.
pub(crate) fn never(literal: &Literal, name: &str, is_state: bool, names: &Names) -> Diagnostic {
    let mut condition = match literal.values.as_slice() {
        [] => name.to_owned(),
        [(value, _)] => format!("{name}={}", names.text(*value)),
        values => {
            let values: Vec<&str> = values.iter().map(|(value, _)| names.text(*value).as_str()).collect();
            format!("{name} in {{{}}}", values.join(", "))
        }
    };
    if literal.negated {
        condition = format!("not({condition})");
    }
    let diagnostic = Diagnostic::warning(
        CODE,
        literal.span,
        format!("nothing asserts `{condition}`, so this part can never be in a plan"),
    );
    if is_state {
        return diagnostic.with_hint("it is not the initial value, and no activity sets it");
    }
    diagnostic.with_hint(format!("assert it in a parallel branch, as in `{{ delay; {condition} [10,20] }}`"))
}
