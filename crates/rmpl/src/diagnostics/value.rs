//! `E-VALUE`: a value outside what is allowed.

use crate::diagnostic::{Code, Diagnostic, Severity, some_of};
use crate::explanation::Explanation;
use crate::parser::{insertion, replacement};
use crate::program::Name;
use crate::span::Span;

pub const CODE: Code = Code("E-VALUE");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "a value outside what is allowed",
    meaning: "A variable that is declared with a domain has no other values, and a condition on it says which value it means. What is
asserted of a `state` is the one value that it gets. The place of a vehicle is one of the locations. Options, vehicle models and
measures have allowed values as well.",
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
    let diagnostic =
        Diagnostic::error(CODE, span, format!("`{variable}` is a variable: say which value it has"))
            .with_hint(format!("`{variable}` is one of {}", some_of(domain)));
    domain.iter().take(MAX_FIXES).fold(diagnostic, |diagnostic, value| {
        diagnostic.with_fix(insertion(format!("Write `{variable}={value}`"), span.end, format!("={value}")))
    })
}

/// The place of a vehicle that is no location.
pub(crate) fn no_location(name: &str, span: Span, nearest: Option<&str>) -> Diagnostic {
    let diagnostic = Diagnostic::error(CODE, span, format!("no location `{name}` is declared"))
        .with_hint("a vehicle is at one of the locations: `location NAME (east, north);` declares one");
    match nearest {
        Some(nearest) => diagnostic.with_fix(replacement(format!("Change to `{nearest}`"), span, nearest)),
        None => diagnostic,
    }
}

/// An assertion about a state variable that leaves open which value it gets; `values` are the possible ones.
pub(crate) fn no_single_value(variable: &str, values: &[&str], span: Span) -> Diagnostic {
    let message = format!("`{variable}` keeps its value, so an assertion about it says which one it gets");
    let diagnostic = Diagnostic::error(CODE, span, message)
        .with_hint(format!("write `{variable}=…`, or `ask` where the condition is required"));
    values.iter().take(MAX_FIXES).fold(diagnostic, |diagnostic, value| {
        let mended = format!("{variable}={value}");
        diagnostic.with_fix(replacement(format!("Change to `{mended}`"), span, mended))
    })
}

/// Something else than a vehicle's place that is to be where a location is in sight.
pub(crate) fn sight_of_no_place(name: &str, span: Span, is_vehicle: bool) -> Diagnostic {
    let message = format!("`{name}` is not the place of a vehicle, and only a vehicle sees a location");
    let diagnostic = Diagnostic::error(CODE, span, message)
        .with_hint("`V.at in visible(L)` holds while the vehicle V is where it sees the location L");
    if !is_vehicle {
        return diagnostic;
    }
    let mended = format!("{name}.at");
    diagnostic.with_fix(replacement(format!("Change to `{mended}`"), span, mended))
}

/// An assertion that a vehicle sees something, which its movements decide.
pub(crate) fn sight_told(variable: &str, span: Span) -> Diagnostic {
    let message = format!("what is in sight follows from `{variable}`: it can be required, not asserted");
    Diagnostic::error(CODE, span, message).with_fix(insertion("Write `ask`", span.start, "ask "))
}

/// How many values are offered as fixes.
const MAX_FIXES: usize = 5;

pub(crate) fn option(name: &str, wanted: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("the option `{name}` is {wanted}"))
}

pub(crate) fn model(model: &Name, models: &[&str]) -> Diagnostic {
    let diagnostic =
        Diagnostic::error(CODE, model.span, format!("there is no vehicle model `{}`", model.text))
            .with_hint(format!("the models are {}", models.join(", ")));
    models.iter().fold(diagnostic, |diagnostic, known| {
        diagnostic.with_fix(replacement(format!("Change to `{known}`"), model.span, *known))
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
        "the speeds must be the least and the greatest, in this order, not negative and not both zero",
    )
}
