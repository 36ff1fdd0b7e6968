//! Models of Livingstone and Pamela: what is written of them can be read.

use interchange::jmpl::{self, SourceFile};
use interchange::pamela;
use rmpl::Diagnostic;

use super::{Outcome, Reader, magnitude, nothing, read, refused, text_of};

/// JMPL as a plant model.
pub(super) const JMPL: Reader = Reader {
    name: "jmpl",
    seeds: &[],
    words: &[
        "class ",
        "enum ",
        " extends ",
        "relation ",
        "failure (*, ",
        "transition (",
        "switch (",
        "case ",
        "stateVector [",
        "iff (",
        "if (",
        " else ",
        "this",
        " != ",
        " | ",
        "noCommand",
        "*/",
        "<mplInit><assign eq='a.b=c'/></mplInit>",
    ],
    mend: nothing,
    exercise: jmpl,
    tested: 1500,
    keeps_form: 5,
    cost: 1,
};

/// Pamela as a mission.
pub(super) const PAMELA: Reader = Reader {
    name: "pamela",
    seeds: &[],
    words: &[
        "(defpclass ",
        "(defpmethod ",
        ":bounds [",
        ":infinity",
        ":inherit [",
        ":initial ",
        "(mode-of ",
        "(lvar \"x\")",
        "(sequence ",
        "(parallel ",
        "(choose (choice ",
        "(whenever ",
        "(soft-parallel ",
        "(between :a :b ",
        "(not ",
        "(= ",
        "-1",
        "delay",
    ],
    mend: nothing,
    exercise: pamela,
    tested: 1500,
    keeps_form: 5,
    cost: 1,
};

fn jmpl(input: &[u8]) -> Outcome {
    let file = SourceFile { name: "a.jmpl".to_owned(), text: text_of(input).into_owned() };
    match jmpl::translate(&[file], &[]) {
        Ok(model) => {
            assert_is_well_formed(&rmpl::control::parse(&model.text).diagnostics, &model.text);
            read(&format!("{} {}", magnitude(model.text.len()), model.left_out.join(" ")))
        }
        Err(reason) => refused(&reason.to_string()),
    }
}

fn pamela(input: &[u8]) -> Outcome {
    match pamela::translate("a.pamela", &text_of(input)) {
        Ok(translated) => {
            let text = &translated.text;
            let diagnostics = if rmpl::control::is_control_text(text) {
                rmpl::control::parse(text).diagnostics
            } else {
                rmpl::parse(text).diagnostics()
            };
            assert_is_well_formed(&diagnostics, text);
            read(&format!("{} {}", magnitude(text.len()), translated.left_out.join(" ")))
        }
        Err(reason) => refused(&reason.to_string()),
    }
}

/// A text may have errors that its source has, such as a name that is declared twice, but none of syntax.
fn assert_is_well_formed(diagnostics: &[Diagnostic], text: &str) {
    let broken = diagnostics.iter().find(|found| matches!(found.code.0, "E-SYNTAX" | "E-LEX"));
    assert!(broken.is_none(), "{broken:?}\n{text}");
}
