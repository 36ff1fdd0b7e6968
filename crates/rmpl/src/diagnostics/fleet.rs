//! How mistakes in fleets and groups are worded: they are kinds of `E-BOUNDS` and `E-UNDEF` (SPEC 17).

use super::{bounds, undefined};
use crate::diagnostic::Diagnostic;
use crate::parser::replacement;
use crate::program::{FleetDecl, MAX_FLEET, Name};
use crate::span::Span;

/// A fleet whose last number is before its first.
pub(crate) fn reversed_range(fleet: &FleetDecl) -> Diagnostic {
    let (first, last) = (fleet.first, fleet.last);
    let message = format!("a fleet needs at least one vehicle, but {first}..{last} holds no number");
    let mended = format!("[{last}..{first}]");
    Diagnostic::error(bounds::CODE, fleet.range_span, message)
        .with_hint("write the smaller number first")
        .with_fix(replacement(format!("Change to `{mended}`"), fleet.range_span, mended))
}

/// A fleet of more vehicles than any mission has.
pub(crate) fn long_range(fleet: &FleetDecl) -> Diagnostic {
    let message = format!("a fleet may have at most {MAX_FLEET} vehicles");
    Diagnostic::error(bounds::CODE, fleet.range_span, message).with_hint("shorten the range")
}

/// A member of a group that is nothing.
pub(crate) fn unknown_member(name: &Name) -> Diagnostic {
    let message = format!("unknown member `{}`", name.text);
    Diagnostic::error(undefined::CODE, name.span, message)
        .with_hint("a group holds vehicles, fleets, locations, values of variables, or groups")
}

/// A group that `any` or `each` ranges over, and that is not declared.
pub fn unknown_group(name: &str, span: Span, nearest: Option<&str>) -> Diagnostic {
    let diagnostic = Diagnostic::error(undefined::CODE, span, format!("unknown group `{name}`"))
        .with_hint(format!("declare it: `group {name} = R1, R2;`, or name a fleet"));
    match nearest {
        Some(nearest) => diagnostic.with_fix(replacement(format!("Change to `{nearest}`"), span, nearest)),
        None => diagnostic,
    }
}

/// Equipment of a vehicle that its model does not have. `model` is that model.
pub fn unknown_equipment(owner: &str, part: &str, model: &str, what: &str, span: Span) -> Diagnostic {
    let message = format!("`{owner}` has no {what} `{part}`");
    Diagnostic::error(undefined::CODE, span, message).with_hint(format!(
        "declare the {what} in `model {model} {{ … }}`, or in a model that extends `{model}`"
    ))
}
