//! `E-LEX`: characters that no token is made of.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::parser::replacement;
use crate::span::Span;
use crate::syntax::{LexProblem, LexProblemKind, is_dash};

pub const CODE: Code = Code("E-LEX");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "unrecognized character",
    meaning: "Enroute cannot read a character, a comment, a string or a number. A name contains the letters A to Z, digits,
`_`, and single hyphens between them. Text copied from a word processor or a paper often contains other dashes and quotes.",
    example: "primitive Group-Wait()[0,54];
scenario Day[0,60] = { Group–Wait() }",
    fix: "Type the plain character. If Enroute knows the plain form, a quick fix inserts it.",
    mended: "primitive Group-Wait()[0,54];
scenario Day[0,60] = { Group-Wait() }",
};

/// Returns what the lexer could not read, in the author's terms. `text` is the text that the problem's offsets count
/// in.
pub(crate) fn diagnostic(problem: LexProblem, text: &str) -> Diagnostic {
    let span = Span::new(problem.start, problem.end);
    let written = text.get(span.range()).unwrap_or("");
    match problem.kind {
        LexProblemKind::Unknown => unknown(span, written),
        LexProblemKind::ForeignName => foreign_name(span, written),
        LexProblemKind::UnclosedComment => {
            Diagnostic::error(CODE, span, "unterminated comment").with_hint("add `*/` to close it")
        }
        LexProblemKind::UnclosedString => Diagnostic::error(CODE, span, "unterminated string")
            .with_fix(crate::parser::insertion("Insert `\"`", span.end, "\"")),
        LexProblemKind::UnclosedControl => {
            Diagnostic::error(CODE, span, "unterminated control block").with_hint("add `}` to close it")
        }
        LexProblemKind::HugeNumber => {
            Diagnostic::error(CODE, span, "this number has too many digits to represent exactly")
                .with_hint("use at most 14 digits")
        }
    }
}

fn unknown(span: Span, written: &str) -> Diagnostic {
    let shown: String = written.chars().take(12).flat_map(char::escape_debug).collect();
    let plural = if written.chars().count() > 1 { "these characters are" } else { "this character is" };
    let mut diagnostic = Diagnostic::error(CODE, span, format!("{plural} not valid here: `{shown}`"));
    if let Some(plain) = plain_form(written) {
        diagnostic = diagnostic.with_fix(replacement(format!("Replace with `{plain}`"), span, plain));
    }
    diagnostic.with_fix(replacement("Remove", span, ""))
}

fn foreign_name(span: Span, written: &str) -> Diagnostic {
    let plain: String = written.chars().map(|letter| if is_dash(letter) { '-' } else { letter }).collect();
    let diagnostic = Diagnostic::error(
        CODE,
        span,
        format!("the name `{written}` contains characters that are not allowed in names"),
    )
    .with_hint("use the letters A to Z, digits, `_`, and single hyphens between them");
    if plain.is_ascii() {
        return diagnostic.with_fix(replacement(format!("Replace with `{plain}`"), span, plain));
    }
    diagnostic
}

/// The character that word processors and papers print otherwise.
fn plain_form(written: &str) -> Option<&'static str> {
    Some(match written {
        "“" | "”" | "„" => "\"",
        "–" | "−" | "—" | "‐" => "-",
        "≠" => "!=",
        "≤" => "<=",
        "≥" => ">=",
        "×" | "·" => "*",
        "÷" => "/",
        "¬" => "not ",
        "，" => ",",
        "；" => ";",
        _ => return None,
    })
}
