//! `E-SYNTAX`: text that does not follow the grammar (SPEC 1.2).

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
    title: "text that does not follow the grammar",
    meaning: "Something is missing, or stands where it cannot. The message names what was expected at the marked place. Reading goes
on behind it, so that one slip of the pen is reported once.",
    example: "primitive Drive()[20,30];
scenario Day[0,60] = { if LIGHT Drive() }",
    fix: "Add what is missing or remove what is too much. A sequence separates its statements with `;`, a parallel with `,`, and
bounds have two sides.",
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
            Self::End => "the text ends here".to_owned(),
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

/// `wanted` is missing at `place`, which lies just behind `span`.
pub(crate) fn missing(wanted: &str, found: Found<'_>, span: Span, place: u32, text: &str) -> Diagnostic {
    error(span, format!("expected {wanted} behind this, {}", found.describe())).with_fix(insertion(
        format!("Insert `{}`", text.trim()),
        place,
        text,
    ))
}

pub(crate) fn too_deep(span: Span) -> Diagnostic {
    error(span, "this nests too deeply or joins too many parts")
        .with_hint("give a part of it a name: define an activity and call it")
}

pub(crate) fn unmatched_brace(span: Span) -> Diagnostic {
    error(span, "this `}` closes nothing").with_fix(replacement("Remove `}`", span, ""))
}

pub(crate) fn stray_semicolon(span: Span) -> Diagnostic {
    error(span, "this `;` ends nothing").with_fix(replacement("Remove `;`", span, ""))
}

pub(crate) fn empty_statement(span: Span) -> Diagnostic {
    error(span, "there is no statement before this `;`").with_fix(replacement("Remove `;`", span, ""))
}

pub(crate) fn no_declaration(found: Found<'_>, span: Span) -> Diagnostic {
    error(span, format!("expected a declaration, {}", found.describe())).with_hint(
        "a file holds `var`, `state`, `resource`, `const`, `primitive`, `objective`, `option`, `scenario`, `constrain`, `import`, \
         definitions such as `Survey() = { … }`, and the world's `terrain`, `location`, `obstacle` and `vehicle`",
    )
}

pub(crate) fn primitive_with_body(span: Span) -> Diagnostic {
    error(span, "a primitive has no body")
        .with_hint("leave out the word `primitive` to define an activity, or end the declaration with `;`")
}

pub(crate) fn keyword_as_name(word: &str, span: Span) -> Diagnostic {
    error(span, format!("`{word}` is a word of the language and cannot be a name")).with_fix(replacement(
        format!("Rename to `{word}_`"),
        span,
        format!("{word}_"),
    ))
}

pub(crate) fn unclosed_brace(opened: Span, place: u32) -> Diagnostic {
    error(opened, "this `{` is never closed").with_fix(insertion("Insert `}`", place, " }"))
}

pub(crate) fn unclosed_bracket(opened: Span, place: u32) -> Diagnostic {
    error(opened, "this `[` is never closed").with_fix(insertion("Insert `]`", place, "]"))
}

pub(crate) fn empty_choice(span: Span) -> Diagnostic {
    error(span, "a `choose` needs at least one alternative")
}

pub(crate) fn one_bound(span: Span) -> Diagnostic {
    error(span, "bounds have two sides, and the upper one is missing")
        .with_hint("write `[lower, upper]`; `inf` leaves the upper side open")
        .with_fix(insertion("Insert `, inf`", span.start, ", inf"))
}

pub(crate) fn negative_bound(span: Span) -> Diagnostic {
    error(span, "a bound cannot be negative").with_fix(replacement("Remove `-`", span, ""))
}

pub(crate) fn double_equals(span: Span) -> Diagnostic {
    error(span, "a value is compared with a single `=`").with_fix(replacement("Remove `=`", span, ""))
}

pub(crate) fn wrong_count(wanted: &str, count: usize, span: Span) -> Diagnostic {
    error(span, format!("expected {wanted}; here are {count}"))
}

/// A condition that is asserted leaves open which of several holds.
pub(crate) fn choice_asserted(span: Span) -> Diagnostic {
    error(span, "an assertion says what holds, and this leaves open which of several does").with_hint(
        "write `choose { a, b }` where planning is to choose; `do … watching a and b` asserts that one of them is false",
    )
}

/// What an activity requires leaves open which of several it is.
pub(crate) fn choice_required(span: Span) -> Diagnostic {
    error(span, "what a primitive requires leaves no choice, and this is one of several conditions").with_hint(
        "write `X in {V, W}` for several values of one variable, or declare a primitive for each condition and \
         `choose` between them; `do … maintaining a or b` requires one of two conditions at a call",
    )
}

pub(crate) fn no_single_effect(span: Span) -> Diagnostic {
    error(span, "an effect says which one value the variable gets").with_hint("write `sets X=V`")
}

pub(crate) fn comma_before_clause(span: Span) -> Diagnostic {
    error(span, "a comma goes on with the clause before it, and here another one begins")
        .with_fix(replacement("Remove `,`", span, ""))
}

pub(crate) fn start_in_list(span: Span) -> Diagnostic {
    error(span, "what is required at the start has a clause of its own").with_fix(replacement(
        "Begin a clause with `requires`",
        span,
        " requires",
    ))
}

/// `word` is `uses` or `costs`.
pub(crate) fn per_time(word: &str, span: Span) -> Diagnostic {
    let hint = match word {
        "uses" => {
            "what is used is free again at the activity's end; `consumes` and `produces` count per unit of time"
        }
        _ => "write what the whole activity costs, or what it costs `per metre`",
    };
    error(span, format!("`{word}` does not count per unit of time")).with_hint(hint)
}

pub(crate) fn using_per(span: Span) -> Diagnostic {
    error(span, "`using` takes the same amount throughout").with_fix(replacement("Remove the unit", span, ""))
}

/// A measure that an objective does not know.
pub(crate) fn unknown_measure(written: &str, span: Span) -> Diagnostic {
    let diagnostic = error(span, format!("expected `cost`, `reward`, `end` or `length`, found `{written}`"));
    let mut parts = written.split('-');
    if written.contains('-') && parts.all(|part| Measure::by_name(part).is_some()) {
        return diagnostic
            .with_hint("a hyphen between letters belongs to a name: put blanks around a minus")
            .with_fix(replacement("Put blanks around `-`", span, written.replace('-', " - ")));
    }
    diagnostic
}

/// A goal that is better the later the scenario ends.
pub(crate) fn end_maximized(span: Span) -> Diagnostic {
    error(
        span,
        "`end` may only be minimised: a plan says when it can end at the earliest, and any plan may end later",
    )
}

/// The name of an occurrence that does not say which of its events is meant.
pub(crate) fn which_event(span: Span) -> Diagnostic {
    error(span, "an occurrence has two events: say which, `.start` or `.end`")
        .with_fix(insertion("Insert `.start`", span.end, ".start"))
        .with_fix(insertion("Insert `.end`", span.end, ".end"))
}

/// A bound between two events among statements.
pub(crate) fn constrain_in_block(span: Span) -> Diagnostic {
    error(span, "`constrain` is a declaration, and stands outside of all blocks")
        .with_hint("it relates events wherever they are: name their occurrences with `as`, and write it behind the block")
}

/// What is to be in sight is itself somewhere else at every time.
pub(crate) fn sight_of_vehicle(span: Span) -> Diagnostic {
    error(span, "`visible(…)` names a location, and a vehicle is at several").with_hint(
        "require each vehicle to see a location, or write one condition for each location: \
         `do … maintaining R2.at=HILL and R1.at in visible(HILL)`",
    )
}

/// An argument of several conditions.
pub(crate) fn joined_argument(span: Span) -> Diagnostic {
    error(span, "an argument is one condition, and this joins another one").with_hint(
        "give the activity a parameter for each, and join them where it uses them: `A(a, b) = { ask a and b }`",
    )
}
