//! `E-VALUE`: invalid value.

use crate::diagnostic::{Code, Diagnostic, Severity, some_of};
use crate::explanation::Explanation;
use crate::parser::{insertion, replacement};
use crate::span::Span;

pub const CODE: Code = Code("E-VALUE");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "invalid value",
    meaning: "A variable has only the values of its domain, and a condition on it must name one of them. An assertion about
a `state` must name the one value that it sets. A vehicle can only be at a declared location. Options, vehicle models and
sizes also have a range of allowed values.",
    example: "var PATH : {OPEN, SHUT};
scenario Day[0,60] = { PATH=OPNE [10,20] }",
    fix: "Correct the value, or add it to the domain.",
    mended: "var PATH : {OPEN, SHUT};
scenario Day[0,60] = { PATH=OPEN [10,20] }",
};

/// A value that the domain does not have.
pub(crate) fn outside_domain(
    variable: &str,
    value: &str,
    span: Span,
    domain: &[&str],
    nearest: Option<&str>,
) -> Diagnostic {
    let diagnostic = Diagnostic::error(CODE, span, format!("`{value}` is not a value of `{variable}`"))
        .with_hint(format!("`{variable}` is one of {}", some_of(domain)));
    match nearest {
        Some(nearest) => diagnostic.with_fix(replacement(format!("Change to `{nearest}`"), span, nearest)),
        None => diagnostic,
    }
}

/// A variable with a domain that stands without a value.
pub(crate) fn no_value(variable: &str, span: Span, domain: &[&str]) -> Diagnostic {
    let diagnostic = Diagnostic::error(CODE, span, format!("expected a value for the variable `{variable}`"))
        .with_hint(format!("`{variable}` is one of {}", some_of(domain)));
    domain.iter().take(MAX_FIXES).fold(diagnostic, |diagnostic, value| {
        diagnostic.with_fix(insertion(format!("Write `{variable}={value}`"), span.end, format!("={value}")))
    })
}

/// Two variables of a control program or plant model that a constraint compares.
pub fn different_domains(left: &str, right: &str, right_span: Span) -> Diagnostic {
    let message = format!("`{left}` and `{right}` have different domains");
    Diagnostic::error(CODE, right_span, message)
        .with_hint("two variables can be equal if they have the same values")
}

/// The place of a vehicle that is not a location.
pub(crate) fn no_location(name: &str, span: Span, nearest: Option<&str>) -> Diagnostic {
    let diagnostic = Diagnostic::error(CODE, span, format!("unknown location `{name}`"))
        .with_hint("declare it with `location NAME (east, north);`");
    match nearest {
        Some(nearest) => diagnostic.with_fix(replacement(format!("Change to `{nearest}`"), span, nearest)),
        None => diagnostic,
    }
}

/// An assertion about a state variable that leaves open which value it gets; `values` are the possible ones.
pub(crate) fn no_single_value(variable: &str, values: &[&str], span: Span) -> Diagnostic {
    let message = format!("an assertion must set exactly one value of the state `{variable}`");
    let diagnostic = Diagnostic::error(CODE, span, message)
        .with_hint(format!("write `{variable}=…`, or use `ask` to require the condition"));
    values.iter().take(MAX_FIXES).fold(diagnostic, |diagnostic, value| {
        let mended = format!("{variable}={value}");
        diagnostic.with_fix(replacement(format!("Change to `{mended}`"), span, mended))
    })
}

/// Something else than a vehicle's place that is to be where a location is in sight.
pub(crate) fn sight_of_no_place(name: &str, span: Span, is_vehicle: bool) -> Diagnostic {
    let message =
        format!("`{name}` cannot be in `visible(…)`: only the place of a vehicle can, as in `V.at`");
    let diagnostic = Diagnostic::error(CODE, span, message)
        .with_hint("`V.at in visible(L)` is true while the vehicle V is at a location from which it sees L");
    if !is_vehicle {
        return diagnostic;
    }
    let mended = format!("{name}.at");
    diagnostic.with_fix(replacement(format!("Change to `{mended}`"), span, mended))
}

/// An assertion that a vehicle sees something, which its movements decide.
pub(crate) fn sight_told(variable: &str, span: Span) -> Diagnostic {
    let message = format!("visibility follows from `{variable}`: it can be required, but not asserted");
    Diagnostic::error(CODE, span, message).with_fix(insertion("Write `ask`", span.start, "ask "))
}

/// An assertion about a level, which activities decide.
pub(crate) fn level_told(resource: &str, span: Span) -> Diagnostic {
    let message =
        format!("the level of `{resource}` follows from activities: it can be required, but not asserted");
    Diagnostic::error(CODE, span, message).with_fix(insertion("Write `ask`", span.start, "ask "))
}

/// A level after `watching`, which asserts that something does not hold.
pub(crate) fn level_watched(resource: &str, span: Span) -> Diagnostic {
    let message = format!("the level of `{resource}` follows from activities, so `watching` cannot use it");
    Diagnostic::error(CODE, span, message)
        .with_hint("write `maintaining` and the opposite comparison to require it")
}

/// How many values are offered as fixes.
const MAX_FIXES: usize = 5;

pub(crate) fn option(name: &str, wanted: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("the option `{name}` must be {wanted}"))
}

pub(crate) fn model(name: &str, span: Span, nearest: Option<&str>, built_in: &[&str]) -> Diagnostic {
    let diagnostic = Diagnostic::error(CODE, span, format!("unknown vehicle model `{name}`")).with_hint(
        format!("declare it with `model {name} {{ … }}`; the built-in models are {}", built_in.join(", ")),
    );
    nearest.into_iter().chain(built_in.iter().copied()).fold(diagnostic, |diagnostic, known| {
        diagnostic.with_fix(replacement(format!("Change to `{known}`"), span, known))
    })
}

pub(crate) fn closed_to(name: &str, span: Span, is_activity: bool, nearest: Option<&str>) -> Diagnostic {
    let message = if is_activity {
        format!("`{name}` moves no vehicle, so no area can be closed to it")
    } else {
        format!("no vehicle, vehicle model, or activity is called `{name}`")
    };
    let diagnostic = Diagnostic::error(CODE, span, message).with_hint(
        "name vehicles, vehicle models, or activities with `moves`; without `for` the area is closed to all",
    );
    match nearest {
        Some(nearest) => diagnostic.with_fix(replacement(format!("Change to `{nearest}`"), span, nearest)),
        None => diagnostic,
    }
}

pub(crate) fn not_positive(what: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("{what} must be greater than 0"))
}

pub(crate) fn speeds(span: Span) -> Diagnostic {
    Diagnostic::error(
        CODE,
        span,
        "expected (minimum, maximum) speed, with 0 ≤ minimum ≤ maximum and maximum > 0",
    )
}
