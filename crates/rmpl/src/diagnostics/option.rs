//! `W-OPTION`: unknown option.

use crate::analysis::edit_distance_at_most;
use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::parser::replacement;
use crate::program::Name;
use crate::span::Span;

pub const CODE: Code = Code("W-OPTION");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "unknown option",
    meaning:
        "This option has no effect. The options are `threat_gap`, `strict`, `time_unit`, `control_step` and
`controllability`, and `entailment` and `horizon` in a control program.",
    example: "option threat_gpa = 2;
scenario Day[0,60] = { LIGHT [10,20] }",
    fix: "Correct its name, or remove it.",
    mended: "option threat_gap = 2;
scenario Day[0,60] = { LIGHT [10,20] }",
};

/// An option that nothing reads.
pub(crate) fn unknown(name: &Name) -> Diagnostic {
    let known = ["threat_gap", "strict", "time_unit", "control_step", "controllability"];
    let diagnostic = Diagnostic::warning(CODE, name.span, format!("unknown option `{}`", name.text))
        .with_hint(format!("the options are {}", known.join(", ")));
    let nearest =
        known.iter().filter_map(|known| Some((edit_distance_at_most(&name.text, known, 3)?, known)));
    match nearest.min() {
        Some((_, known)) => {
            diagnostic.with_fix(replacement(format!("Change to `{known}`"), name.span, *known))
        }
        None => diagnostic,
    }
}

/// An option that no control program has; `known` are those that it may have.
pub(crate) fn unknown_of_program(name: &str, span: Span, known: &[&str]) -> Diagnostic {
    let diagnostic = Diagnostic::warning(CODE, span, format!("a control program has no option `{name}`"))
        .with_hint(format!("the options of a control program are {}", known.join(", ")));
    let nearest = known.iter().filter_map(|known| Some((edit_distance_at_most(name, known, 3)?, known)));
    match nearest.min() {
        Some((_, known)) => diagnostic.with_fix(replacement(format!("Change to `{known}`"), span, *known)),
        None => diagnostic,
    }
}
