//! `E-RECURSION`: activities that call themselves, and constants and files that depend on themselves.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("E-RECURSION");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "recursive definition",
    meaning: "The planner expands every call into a finite network, so an activity cannot call itself, directly or through
others. A constant cannot depend on itself: `const A = B; const B = A + 1;` gives neither a value. Files cannot import each
other in a cycle, a model cannot extend itself, and a group cannot hold itself.",
    example: "primitive Drive()[20,30];
Patrol() = { Drive(); Patrol() }
scenario Day[0,60] = { Patrol() }",
    fix: "Give the number of repetitions, as in `repeat 2 { Drive() }`, or write them one after the other.",
    mended: "primitive Drive()[20,30];
Patrol() = { Drive(); Drive() }
scenario Day[0,60] = { Patrol() }",
};

/// A cycle of calls: the activities of the cycle, and the call that closes it.
pub fn cycle(way: &[&str], call: Span) -> Diagnostic {
    let first = way.first().copied().unwrap_or_default();
    let steps: Vec<String> = way.iter().chain([&first]).map(|name| format!("`{name}`")).collect();
    let message = format!("an activity cannot call itself, but `{first}` does: {}", steps.join(" calls "));
    Diagnostic::error(CODE, call, message).with_hint("give the number of repetitions, as in `repeat 2 { … }`")
}

/// A cycle of models: each extends the next one.
pub(crate) fn models(way: &[&str], place: Span) -> Diagnostic {
    let message = format!("a model cannot extend itself, but {}", circle(way, " extends "));
    Diagnostic::error(CODE, place, message).with_hint("remove one `extends`")
}

/// A cycle of groups: each holds the next one.
pub(crate) fn groups(way: &[&str], place: Span) -> Diagnostic {
    let message = format!("a group cannot hold itself, but {}", circle(way, " holds "));
    Diagnostic::error(CODE, place, message).with_hint("remove one of the members")
}

fn circle(way: &[&str], verb: &str) -> String {
    let first = way.first().copied().unwrap_or_default();
    let steps: Vec<String> = way.iter().chain([&first]).map(|name| format!("`{name}`")).collect();
    steps.join(verb)
}

/// A cycle of imports: the files of the cycle, and where it closes.
pub(crate) fn imports(way: &[&str], place: Span) -> Diagnostic {
    let first = way.first().copied().unwrap_or_default();
    let steps: Vec<String> = way.iter().chain([&first]).map(|name| format!("`{name}`")).collect();
    let message = format!("files cannot import each other in a cycle: {}", steps.join(" imports "));
    Diagnostic::error(CODE, place, message)
        .with_hint("move what both need into a third file, and import it in both")
}

/// A cycle of constants: each names the next one in its value, and `place` is where the last names the first.
pub fn constants(way: &[&str], place: Span) -> Diagnostic {
    let first = way.first().copied().unwrap_or_default();
    let steps: Vec<String> = way.iter().chain([&first]).map(|name| format!("`{name}`")).collect();
    let message =
        format!("a constant cannot depend on itself, but `{first}` does: {}", steps.join(" names "));
    Diagnostic::error(CODE, place, message).with_hint("give one of them a numeric value")
}
