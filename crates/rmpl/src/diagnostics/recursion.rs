//! `E-RECURSION`: activities that call themselves, and constants and files that depend on themselves.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("E-RECURSION");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "what depends on itself",
    meaning: "Every call is expanded into the network, and a plan is a finite network: an activity cannot call itself, directly or
through others. Nor can a constant depend on itself: `const A = B; const B = A + 1;` gives neither a value. Files
may not import each other in a circle either.",
    example: "primitive Drive()[20,30];
Patrol() = { Drive(); Patrol() }
scenario Day[0,60] = { Patrol() }",
    fix: "Say how often: `repeat 2 { Drive() }`, or write the repetitions out.",
    mended: "primitive Drive()[20,30];
Patrol() = { Drive(); Drive() }
scenario Day[0,60] = { Patrol() }",
};

/// A cycle of calls: the activities of the cycle, and the call that closes it.
pub fn cycle(way: &[&str], call: Span) -> Diagnostic {
    let first = way.first().copied().unwrap_or_default();
    let steps: Vec<String> = way.iter().chain([&first]).map(|name| format!("`{name}`")).collect();
    let message =
        format!("activities may not call themselves, and `{first}` does: {}", steps.join(" calls "));
    Diagnostic::error(CODE, call, message)
        .with_hint("a network is finite: write repetitions out, one after the other")
}

/// A cycle of imports: the files of the cycle, and where it closes.
pub(crate) fn imports(way: &[&str], place: Span) -> Diagnostic {
    let first = way.first().copied().unwrap_or_default();
    let steps: Vec<String> = way.iter().chain([&first]).map(|name| format!("`{name}`")).collect();
    let message = format!("files may not import each other in a circle: {}", steps.join(" imports "));
    Diagnostic::error(CODE, place, message)
        .with_hint("put what both need into a file of its own, which both import")
}

/// A cycle of constants: each names the next one in its value, and `place` is where the last names the first.
pub fn constants(way: &[&str], place: Span) -> Diagnostic {
    let first = way.first().copied().unwrap_or_default();
    let steps: Vec<String> = way.iter().chain([&first]).map(|name| format!("`{name}`")).collect();
    let message =
        format!("a constant may not depend on itself, and `{first}` does: {}", steps.join(" names "));
    Diagnostic::error(CODE, place, message).with_hint("give one of them a number")
}
