//! The arguments of commands that host pages give.

use hca::VariableId;
use plant::hitting_sets::HittingMove;
use serde_json::Value;

use crate::command::Command;
use crate::panel_kind::PanelKind;
use crate::state::AppState;
use crate::state::automaton::{AutomatonCommand, Program, ProgramPart};
use crate::state::program_proof::ProgramProofCommand;

/// The component and its mode by name; without a mode, the component is left to behave.
pub(super) fn injection(state: &AppState, arguments: &Value) -> Result<Command, String> {
    let model = state.automaton.program().and_then(Program::model).ok_or("no plant model")?;
    let component = text_argument(arguments, "component")?;
    let (id, mode) = if arguments.get("mode").is_none_or(Value::is_null) {
        let id = model.component_named(component);
        (id.ok_or_else(|| format!("unknown component {component}"))?, None)
    } else {
        let (id, mode) = model.component_mode(component, text_argument(arguments, "mode")?)?;
        (id, Some(mode))
    };
    Ok(Command::Automaton(AutomatonCommand::Inject(id, mode)))
}

/// A step of the hitting-set tree: without arguments it starts again, with `next` it does the next step or `"all"`.
pub(super) fn hitting(_: &AppState, arguments: &Value) -> Result<Command, String> {
    let command = if let Some(next) = arguments.get("next") {
        AutomatonCommand::DiagnoseNext(next == "all")
    } else if arguments.get("node").is_some() {
        let node = number_argument(arguments, "node")?.max(0.0) as usize;
        let step = match arguments.get("as").and_then(Value::as_str) {
            Some("diagnosis") => HittingMove::Diagnose,
            Some("closed") => HittingMove::Close,
            Some("conflict") => {
                let conflict = number_argument(arguments, "conflict")?.max(1.0) as usize;
                HittingMove::Expand(conflict - 1)
            }
            _ => {
                return Err(
                    "The argument \"as\" must be \"conflict\", \"diagnosis\" or \"closed\"".to_owned()
                );
            }
        };
        AutomatonCommand::Diagnose(node, step)
    } else {
        AutomatonCommand::StartDiagnosis
    };
    Ok(Command::Automaton(command))
}

/// Returns what is known of a variable of a program without a plant; without a value, nothing is.
pub(super) fn knowledge(state: &AppState, arguments: &Value) -> Result<Command, String> {
    let automaton = state.automaton.program().and_then(Program::automaton).ok_or("no control program")?;
    let name = text_argument(arguments, "variable")?;
    let found = automaton.variables.iter().position(|it| it.name == name);
    let at = found.ok_or_else(|| format!("unknown variable {name}"))?;
    let value = match arguments.get("value").and_then(Value::as_str) {
        None => None,
        Some(value) => {
            let found = automaton.variables[at].values.iter().position(|it| it == value);
            Some(found.ok_or_else(|| format!("{name} has no value {value}"))? as u32)
        }
    };
    Ok(Command::Automaton(AutomatonCommand::Know(VariableId(at as u32), value)))
}

/// Returns what is to be proven: `properties`, `faults` and `knowledge`; what is not given stays.
pub(super) fn proof(state: &AppState, arguments: &Value) -> Result<Command, String> {
    let mut settings = state.automaton.proof.settings.clone();
    if let Some(properties) = arguments.get("properties") {
        properties.as_str().ok_or("\"properties\" must be a text")?.clone_into(&mut settings.properties);
    }
    if arguments.get("faults").is_some() {
        settings.faults = number_argument(arguments, "faults")?.max(0.0) as u32;
    }
    if let Some(knowledge) = arguments.get("knowledge") {
        settings.knowledge = serde_json::from_value(knowledge.clone())
            .map_err(|_| "\"knowledge\" must be \"estimated\" or \"perfect\"")?;
    }
    Ok(Command::ProgramProof(ProgramProofCommand::Set(settings)))
}

/// A part of what is shown of a program, by name.
pub(super) fn part(_: &AppState, arguments: &Value) -> Result<Command, String> {
    let name = text_argument(arguments, "part")?;
    let found = ProgramPart::ALL.into_iter().find(|part| part.name() == name);
    let part = found.ok_or_else(|| {
        format!(
            "unknown part \"{name}\"; known parts: {}",
            ProgramPart::ALL.map(ProgramPart::name).join(", ")
        )
    })?;
    Ok(Command::Automaton(AutomatonCommand::Show(part)))
}

pub(super) fn text_argument<'a>(arguments: &'a Value, name: &str) -> Result<&'a str, String> {
    let value = arguments.get(name).unwrap_or(arguments);
    value.as_str().ok_or_else(|| format!("expected {{\"{name}\": text}}"))
}

pub(super) fn number_argument(arguments: &Value, name: &str) -> Result<f64, String> {
    let value = arguments.get(name).unwrap_or(arguments);
    value.as_f64().ok_or_else(|| format!("expected {{\"{name}\": number}}"))
}

pub(super) fn panel_argument(arguments: &Value) -> Result<PanelKind, String> {
    let name = text_argument(arguments, "name")?;
    PanelKind::by_name(name).ok_or_else(|| {
        let known: Vec<&str> = PanelKind::ALL.iter().map(|panel| panel.name()).collect();
        format!("unknown panel \"{name}\"; known panels: {}", known.join(", "))
    })
}
