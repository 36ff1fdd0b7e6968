//! `W-TRAVERSE`: traverse without a destination (SPEC 1.8).

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("W-TRAVERSE");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "traverse without a destination",
    meaning: "The primitive is declared with `moves`, but no argument of this call is a declared location. The planner
treats it as an ordinary activity, and the vehicles do not move.",
    example: "location BASE (0, 0);
vehicle Rover : ATRV at BASE;
primitive Drive(to)[20,30] moves Rover;
scenario Day[0,60] = { Drive(SOMEWHERE) }",
    fix: "Pass a declared location.",
    mended: "location BASE (0, 0);
location SITE (80, 60);
vehicle Rover : ATRV at BASE;
primitive Drive(to)[20,30] moves Rover;
scenario Day[0,60] = { Drive(SITE) }",
};

/// A call of a traverse without a location.
pub(crate) fn no_location(name: &str, span: Span) -> Diagnostic {
    Diagnostic::warning(
        CODE,
        span,
        format!("this traverse has no destination: no argument of `{name}` is a location"),
    )
    .with_hint("declare a location with `location NAME (east, north);`")
}
