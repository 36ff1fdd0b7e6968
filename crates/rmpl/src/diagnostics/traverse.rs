//! `W-TRAVERSE`: a traverse that goes nowhere (SPEC 1.8).

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("W-TRAVERSE");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "a traverse that goes nowhere",
    meaning: "The primitive is declared with `moves`, but no argument of this call is a declared location. It is planned as an ordinary
activity, and the vehicles stay where they are.",
    example: "location BASE (0, 0);
vehicle Rover : ATRV at BASE;
primitive Drive(to)[20,30] moves Rover;
scenario Day[0,60] = { Drive(SOMEWHERE) }",
    fix: "Hand over a location, or declare the argument as one.",
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
        format!("this traverse goes nowhere: no argument of `{name}` is a location"),
    )
    .with_hint("locations are declared with `location NAME (east, north);`")
}
