//! Control programs and models.

use executive::model_based::{Options, Run, RunStatus, StepInput, StepOutcome};
use plant::{ComponentId, Model, VariableId};

use super::{Outcome, Reader, magnitude, nothing, read, refused, text_of};
use crate::mutation::Random;

const WORDS: &[&str] = &[
    "(DEFCLASS C ()",
    "(DEFINSTANCE I C INIT On)",
    "(DEFOPTION entailment 0.9)",
    "INIT On 0.5 Off 0.5",
    "INIT *",
    "(MODE On true)",
    "(COMMAND cmd {none go})",
    "(VAR v {a b} OBSERVABLE SHOWS a)",
    "(PORT bus Bus)",
    "(PARALLEL ",
    "(SEQUENCE ",
    "(WHEN-DONEXT ",
    "(WHENEVER-DONEXT ",
    "(UNLESS-THENNEXT ",
    "(DO-WATCHING ",
    "(ALWAYS ",
    "(IF-THENNEXT ",
    "(IF-THENNEXT-ELSENEXT ",
    "(TRANSITION On Off (cmd = go))",
    "(FAULT On Off 0.5)",
    " AND ",
    " OR ",
    "(NOT ",
    "~(A = On)",
    "true",
    "false",
    "1/3",
    "INIT",
    "Again ():: ",
];

/// Parsed, written in form, compiled, bound.
pub(super) const CONTROL: Reader = Reader {
    name: "control-programs",
    seeds: &["tests/conformance/*.rmpl", "assets/programs/*.rmpl", "tests/fuzz/corpus/control-runs/*"],
    words: WORDS,
    mend: nothing,
    exercise: control,
    tested: 1200,
    keeps_form: 3,
    cost: 1,
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

/// What is read is run for some steps, each with what its plant does by chance and, as the text decides, with components
/// that break and observations that come otherwise. Each run can be replayed from its log, and taken back.
pub(super) const RUN: Reader = Reader {
    name: "control-runs",
    seeds: &["assets/programs/*.rmpl"],
    words: WORDS,
    mend: nothing,
    exercise: run,
    tested: 300,
    keeps_form: 8,
    cost: 4,
};

/// Steps of a run.
const MAX_STEPS: usize = 12;

/// Returns what comes from outside in a step.
fn outside(random: &mut Random, model: &Model) -> StepInput {
    let mut input = StepInput::default();
    let at = random.below(model.components.len());
    if random.below(4) == 0
        && let Some(component) = model.components.get(at)
        && !component.modes.is_empty()
    {
        input.injected.insert(ComponentId(at as u32), random.below(component.modes.len()) as u8);
    }
    if random.below(4) == 0 {
        let at = random.below(model.variables.len());
        if let Some(variable) = model.variables.get(at).filter(|variable| !variable.values.is_empty()) {
            input.observed.insert(VariableId(at as u32), random.below(variable.values.len()) as u8);
        }
    }
    input
}

fn run(input: &[u8]) -> Outcome {
    let (control, found) = mission::read_control(&text_of(input), None);
    let mission::Control::Bound(system) = control else {
        let codes: String = found.iter().map(|found| found.code.to_string()).collect();
        return refused(&codes);
    };
    let mut random =
        Random::new(input.iter().fold(1, |sum: u64, &byte| sum.wrapping_mul(31) + u64::from(byte)));
    let options = Options { seed: Some(1), ..Options::default() };
    let mut run = Run::new(&system, options);
    let mut led = String::new();
    while run.status() == RunStatus::Running && run.records().len() < MAX_STEPS {
        match run.step(&outside(&mut random, &system.model)) {
            Ok(record) => {
                let marked = magnitude(record.trace.marked.len());
                let commanded = record.commands.0.iter().filter(|&&command| command > 0).count();
                let is_unexplained = record.outcome != StepOutcome::Explained;
                let said = [is_unexplained, !record.failed.is_empty(), !record.unachievable.is_empty()];
                let said: String = said.map(|it| if it { 'y' } else { 'n' }).iter().collect();
                led += &format!("{marked}{}{said} ", magnitude(commanded));
            }
            Err(reason) => return refused(&format!("{led}{reason}")),
        }
    }
    let again = Run::replay(&system, options, &run.log()).expect("a log can be replayed");
    assert_eq!(again.records(), run.records(), "a log replays its run");
    let log = run.log();
    while run.step_back() {}
    for input in &log {
        run.step(input).expect("what was taken back can be stepped again");
    }
    assert_eq!(again.records(), run.records(), "taken back and stepped again");
    read(&led)
}
