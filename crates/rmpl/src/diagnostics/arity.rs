//! `E-ARITY`: a call with too many or too few arguments.

use crate::analysis::Call;
use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;

pub const CODE: Code = Code("E-ARITY");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "wrong number of arguments",
    meaning: "A call must pass one argument for each parameter.",
    example: "primitive Drive(from, to)[20,30];
scenario Day[0,60] = { Drive(BASE) }",
    fix: "Add or remove arguments, or change the declaration.",
    mended: "primitive Drive(from, to)[20,30];
scenario Day[0,60] = { Drive(BASE, TAI) }",
};

/// A call whose arguments do not match the declaration.
pub(crate) fn mismatch(name: &str, wanted: u32, call: &Call) -> Diagnostic {
    let count = |number: u32| match number {
        0 => "no arguments".to_owned(),
        1 => "1 argument".to_owned(),
        _ => format!("{number} arguments"),
    };
    let message = format!("`{name}` takes {}, but this call passes {}", count(wanted), count(call.arguments));
    Diagnostic::error(CODE, call.with_arguments, message)
}
