//! `E-SYNTAX`: syntax error (SPEC 1.2).

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::parser::{insertion, replacement};
use crate::program::Measure;
use crate::span::Span;

pub const CODE: Code = Code("E-SYNTAX");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "syntax error",
    meaning: "The parser found something it did not expect. The message says what it expected at the marked position.",
    example: "primitive Drive()[20,30];
scenario Day[0,60] = { if LIGHT Drive() }",
    fix: "Add the missing part, or remove the extra one. Separate the statements of a sequence with `;` and parallel
statements with `,`. Write bounds as `[minimum,maximum]`.",
    mended: "primitive Drive()[20,30];
scenario Day[0,60] = { if LIGHT thennext Drive(), LIGHT [60,60] }",
};

/// What stands where something else should.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Found<'t> {
    /// A token with this text.
    Text(&'t str),
    /// Nothing: the text ends.
    End,
}

impl Found<'_> {
    fn describe(self) -> String {
        match self {
            Self::Text(text) => format!("found `{text}`"),
            Self::End => "found the end of the text".to_owned(),
        }
    }
}

fn error(span: Span, message: impl Into<String>) -> Diagnostic {
    Diagnostic::error(CODE, span, message)
}

/// `wanted` should stand at `span`.
pub(crate) fn expected(wanted: &str, found: Found<'_>, span: Span) -> Diagnostic {
    error(span, format!("expected {wanted}, {}", found.describe()))
}

/// `wanted` is missing at `place`, which lies just after `span`.
pub(crate) fn missing(wanted: &str, found: Found<'_>, span: Span, place: u32, text: &str) -> Diagnostic {
    error(span, format!("expected {wanted} after this, {}", found.describe())).with_fix(insertion(
        format!("Insert `{}`", text.trim()),
        place,
        text,
    ))
}

pub(crate) fn too_deep(span: Span) -> Diagnostic {
    error(span, "this is nested too deeply or has too many parts")
        .with_hint("move a part of it into an activity, and call that")
}

pub(crate) fn unmatched_brace(span: Span) -> Diagnostic {
    error(span, "unmatched `}`").with_fix(replacement("Remove `}`", span, ""))
}

pub(crate) fn stray_semicolon(span: Span) -> Diagnostic {
    error(span, "unnecessary `;`").with_fix(replacement("Remove `;`", span, ""))
}

pub(crate) fn empty_statement(span: Span) -> Diagnostic {
    error(span, "expected a statement before this `;`").with_fix(replacement("Remove `;`", span, ""))
}

pub(crate) fn no_declaration(found: Found<'_>, span: Span) -> Diagnostic {
    error(span, format!("expected a declaration, {}", found.describe())).with_hint(
        "declarations are `var`, `state`, `resource`, `const`, `primitive`, `objective`, `option`, `scenario`, `constrain`, \
         `import`, definitions such as `Survey() = { … }`, and `terrain`, `location`, `obstacle` and `vehicle`",
    )
}

pub(crate) fn primitive_with_body(span: Span) -> Diagnostic {
    error(span, "a primitive cannot have a body").with_hint(
        "to define an activity, remove the word `primitive`; otherwise end the declaration with `;`",
    )
}

pub(crate) fn keyword_as_name(word: &str, span: Span) -> Diagnostic {
    error(span, format!("`{word}` is a reserved word")).with_fix(replacement(
        format!("Rename to `{word}_`"),
        span,
        format!("{word}_"),
    ))
}

pub(crate) fn unclosed_brace(opened: Span, place: u32) -> Diagnostic {
    error(opened, "unclosed `{`").with_fix(insertion("Insert `}`", place, " }"))
}

pub(crate) fn unclosed_bracket(opened: Span, place: u32) -> Diagnostic {
    error(opened, "unclosed `[`").with_fix(insertion("Insert `]`", place, "]"))
}

pub(crate) fn empty_choice(span: Span) -> Diagnostic {
    error(span, "a `choose` needs at least one alternative")
}

pub(crate) fn one_bound(span: Span) -> Diagnostic {
    error(span, "the maximum is missing")
        .with_hint("write `[minimum,maximum]`; use `inf` for no maximum")
        .with_fix(insertion("Insert `, inf`", span.start, ", inf"))
}

pub(crate) fn level_as_argument(span: Span) -> Diagnostic {
    error(span, "a condition on a level cannot be an argument")
        .with_hint("pass the resource and the number, and compare them in the activity")
}

pub(crate) fn negative_bound(span: Span) -> Diagnostic {
    error(span, "a bound cannot be negative").with_fix(replacement("Remove `-`", span, ""))
}

pub(crate) fn double_equals(span: Span) -> Diagnostic {
    error(span, "use a single `=` to compare a value").with_fix(replacement("Remove `=`", span, ""))
}

pub(crate) fn wrong_count(wanted: &str, count: usize, span: Span) -> Diagnostic {
    error(span, format!("expected {wanted}, found {count}"))
}

/// A condition that is asserted leaves open which of several holds.
pub(crate) fn choice_asserted(span: Span) -> Diagnostic {
    error(span, "an assertion must be one condition, but this one allows several").with_hint(
        "to let the planner choose, write `choose { a, b }`; `do … watching a and b` asserts that one of them is false",
    )
}

/// Returns what an activity requires leaves open which of several it is.
pub(crate) fn choice_required(span: Span) -> Diagnostic {
    error(span, "a primitive must require one condition, but this one allows several").with_hint(
        "for several values of one variable, write `X in {V, W}`; otherwise declare one primitive for each condition and \
         `choose` between them, or write `do … maintaining a or b` at the call",
    )
}

pub(crate) fn no_single_effect(span: Span) -> Diagnostic {
    error(span, "an effect must set exactly one value").with_hint("write `sets X=V`")
}

pub(crate) fn comma_before_clause(span: Span) -> Diagnostic {
    error(span, "unnecessary comma: a new clause starts here").with_fix(replacement("Remove `,`", span, ""))
}

pub(crate) fn start_in_list(span: Span) -> Diagnostic {
    error(span, "`requires at start` needs its own clause").with_fix(replacement(
        "Start a clause with `requires`",
        span,
        " requires",
    ))
}

/// `word` is `uses` or `costs`.
pub(crate) fn per_time(word: &str, span: Span) -> Diagnostic {
    let hint = match word {
        "uses" => {
            "`uses` cannot count per unit of time, because the activity frees the resource when it ends; use `consumes` or `produces`"
        }
        _ => "write the total cost of the activity, or its cost `per metre`",
    };
    error(span, format!("`{word}` cannot count per unit of time")).with_hint(hint)
}

pub(crate) fn using_per(span: Span) -> Diagnostic {
    error(span, "the amount of `using` is constant and has no unit").with_fix(replacement(
        "Remove the unit",
        span,
        "",
    ))
}

/// A measure that an objective does not know.
pub(crate) fn unknown_measure(written: &str, span: Span) -> Diagnostic {
    let diagnostic = error(span, format!("expected `cost`, `reward`, `end` or `length`, found `{written}`"));
    let mut parts = written.split('-');
    if written.contains('-') && parts.all(|part| Measure::by_name(part).is_some()) {
        return diagnostic.with_hint("`a-b` is a name; write `a - b` to subtract").with_fix(replacement(
            "Put spaces around `-`",
            span,
            written.replace('-', " - "),
        ));
    }
    diagnostic
}

/// A goal that is better the later the scenario ends.
pub(crate) fn end_maximized(span: Span) -> Diagnostic {
    error(span, "`end` can only be minimized, because it is the earliest end of the plan")
}

/// The name of an occurrence that does not say which of its events is meant.
pub(crate) fn which_event(span: Span) -> Diagnostic {
    error(span, "expected `.start` or `.end` after the name of an occurrence")
        .with_fix(insertion("Insert `.start`", span.end, ".start"))
        .with_fix(insertion("Insert `.end`", span.end, ".end"))
}

/// A bound between two events among statements.
pub(crate) fn constrain_in_block(span: Span) -> Diagnostic {
    error(span, "`constrain` is a declaration and must be outside all blocks")
        .with_hint("name the occurrences with `as`, and move `constrain` after the block")
}

/// Returns what is to be in sight is itself somewhere else at every time.
pub(crate) fn sight_of_vehicle(span: Span) -> Diagnostic {
    error(span, "`visible(…)` needs a location, but a vehicle is at different ones over time").with_hint(
        "require each vehicle to see a location, or write one condition for each location: \
         `do … maintaining R2.at=HILL and R1.at in visible(HILL)`",
    )
}

/// An argument of several conditions.
pub(crate) fn joined_argument(span: Span) -> Diagnostic {
    error(span, "an argument must be a single condition").with_hint(
        "give the activity one parameter for each condition, and join them in its body: `A(a, b) = { ask a and b }`",
    )
}
