//! `E-KIND`: something of one kind where another kind is needed (SPEC 17). Compilation reports it.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::fleet::GroupKind;
use crate::program::Name;
use crate::span::Span;

pub const CODE: Code = Code("E-KIND");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "wrong kind",
    meaning: "A parameter stands for one kind of thing: a vehicle, a vehicle of one model, a location, a number, a resource,
a condition, or a value of one state. The kind is the written one, as in `r : vehicle`. If none is written, the uses of the
parameter decide. A second use or an argument of another kind is an error, and a note marks the place that decides. The
members of a group must be of one kind, too. Only reservoirs have levels that can be compared.",
    example: "location BASE (0, 0);
location ROCK (9, 9);
vehicle R1 : ATRV at BASE;
primitive Survey(r : vehicle, site : location)[10, 15] requires r.at = site;
scenario Sol[0,60] = { Survey(ROCK, BASE) }",
    fix: "Pass an argument of the kind that the parameter needs, or change the parameter.",
    mended: "location BASE (0, 0);
location ROCK (9, 9);
vehicle R1 : ATRV at BASE;
primitive Survey(r : vehicle, site : location)[10, 15] requires r.at = site;
scenario Sol[0,60] = { Survey(R1, BASE) }",
};

/// Marks the place that decides about a kind.
fn because(span: Span, message: String) -> Diagnostic {
    Diagnostic { severity: Severity::Note, ..Diagnostic::error(CODE, span, message) }
}

/// An argument of another kind than its parameter; `place` is what decides about the parameter.
pub(crate) fn argument(
    (argument, is): (&str, Option<&str>),
    (callee, parameter, kind): (&str, &str, &str),
    span: Span,
    place: Span,
) -> [Diagnostic; 2] {
    let message = match is {
        Some(is) => format!("`{parameter}` of `{callee}` stands for {kind}, but `{argument}` is {is}"),
        None => format!("`{parameter}` of `{callee}` stands for {kind}, which `{argument}` is not"),
    };
    [
        Diagnostic::error(CODE, span, message).with_hint(format!("pass {kind}")),
        because(place, format!("`{parameter}` stands for {kind} because of this")),
    ]
}

/// A second use of a parameter that needs another kind than the first one.
pub(crate) fn two_uses(
    parameter: &str,
    (first, at): (&str, Span),
    (second, span): (&str, Span),
) -> [Diagnostic; 2] {
    let message = format!("`{parameter}` stands for {first}, but this needs {second}");
    [
        Diagnostic::error(CODE, span, message)
            .with_hint("use two parameters, or correct one of the two uses"),
        because(at, format!("`{parameter}` stands for {first} because of this")),
    ]
}

/// A kind that is none.
pub(crate) fn unknown(kind: &Name) -> Diagnostic {
    Diagnostic::error(CODE, kind.span, format!("unknown kind `{}`", kind.text)).with_hint(
        "write `vehicle`, `location`, `number`, `resource`, `condition`, or the name of a model or a state",
    )
}

/// A comparison of what has no level; `is` says what it is.
pub fn no_level(name: &str, is: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("only a reservoir has a level, but `{name}` is {is}"))
        .with_hint("a reservoir is declared with a range: `resource R 0..100 = 50;`")
}

/// Members of one group of different kinds.
pub(crate) fn mixed_group(
    group: &Name,
    (first, is): (&Name, GroupKind),
    (second, differs): (&Name, GroupKind),
) -> [Diagnostic; 2] {
    let message = format!(
        "the members of `{}` must be of one kind, but `{}` is {} and `{}` {}",
        group.text,
        first.text,
        is.one(),
        second.text,
        differs.one()
    );
    [
        Diagnostic::error(CODE, second.span, message).with_hint("declare two groups"),
        because(first.span, format!("`{}` is {}", first.text, is.one())),
    ]
}
