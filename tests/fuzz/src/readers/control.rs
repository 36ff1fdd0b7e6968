//! Control programs and models.

use executive::model_based::{Options, Run, StepInput};

use super::{NOTHING, Outcome, Reader, magnitude, nothing, read, refused, text_of};

const WORDS: &[&str] = &[
    "(DEFCLASS ",
    "(DEFINE ",
    "(DEFINSTANCE ",
    "(MODES ",
    "(PARALLEL ",
    "(SEQUENCE ",
    "(WHEN ",
    "(UNLESS ",
    "(DO-WATCHING ",
    "(ALWAYS ",
    "(IF-THENNEXT ",
    "(TRANSITION ",
    "(AND ",
    "(OR ",
    "(NOT ",
    "Failed",
    "*",
    "0.5",
    "INIT",
    "(CHOOSE ",
];

/// Parsed, written in form, compiled, bound.
pub(super) const CONTROL: Reader = Reader {
    name: "control-programs",
    seeds: &["tests/conformance/*.rmpl", "assets/programs/*.rmpl"],
    words: WORDS,
    mend: nothing,
    exercise: control,
    tested: 1200,
};

fn control(input: &[u8]) -> Outcome {
    let text = &*text_of(input);
    let parsed = rmpl::control::parse(text);
    let formatted = rmpl::control::format(text);
    assert_eq!(rmpl::control::format(&formatted), formatted, "formatting twice");
    let (model, _) = plant::compile(&parsed.file);
    if let Some(model) = model {
        let _ = model.state_names(&model.initial_state());
    }
    let (control, found) = mission::read_control(text, None);
    let codes: String = found.iter().map(|found| found.code.to_string()).collect();
    let kind = match control {
        mission::Control::Bound(_) => "bound",
        mission::Control::Unbound(_) => "unbound",
        mission::Control::Plant(_) => "plant",
        mission::Control::Nothing => "nothing",
    };
    if kind == "nothing" {
        return refused(&codes);
    }
    read(&format!("{kind} {codes} {}", magnitude(parsed.file.definitions.len())))
}

/// What is read is run with what its plant does most likely, for a few steps.
pub(super) const RUN: Reader = Reader {
    name: "control-runs",
    seeds: &["assets/programs/*.rmpl"],
    words: WORDS,
    mend: nothing,
    exercise: run,
    tested: 300,
};

fn run(input: &[u8]) -> Outcome {
    let (control, _) = mission::read_control(&text_of(input), None);
    let mission::Control::Bound(system) = control else { return NOTHING };
    let mut run = Run::new(&system, Options { seed: Some(1), ..Options::default() });
    while !run.is_done() && run.records().len() < 6 {
        if let Err(reason) = run.step(&StepInput::default()) {
            return refused(&reason.to_string());
        }
    }
    assert!(Run::replay(&system, Options { seed: Some(1), ..Options::default() }, &run.log()).is_ok());
    read(&String::from(magnitude(run.records().len())))
}
