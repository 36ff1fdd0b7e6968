//! The arguments of commands that host pages give.

use serde_json::Value;

use crate::PanelKind;
use crate::command::Command;
use crate::state::AppState;
use crate::state::automaton::{AutomatonCommand, Program};

/// The component and its mode by name; without a mode, the component is left to behave.
pub(super) fn injection(state: &AppState, arguments: &Value) -> Result<Command, String> {
    let model = state.automaton.program().and_then(Program::model).ok_or("there is no plant")?;
    let component = text_argument(arguments, "component")?;
    let (id, mode) = if arguments.get("mode").is_none_or(Value::is_null) {
        let id = model.component_named(component);
        (id.ok_or_else(|| format!("the model has no component `{component}`"))?, None)
    } else {
        let (id, mode) = model.component_mode(component, text_argument(arguments, "mode")?)?;
        (id, Some(mode))
    };
    Ok(Command::Automaton(AutomatonCommand::Inject(id, mode)))
}

pub(super) fn text_argument<'a>(arguments: &'a Value, name: &str) -> Result<&'a str, String> {
    let value = arguments.get(name).unwrap_or(arguments);
    value.as_str().ok_or_else(|| format!("it takes {{\"{name}\": text}}"))
}

pub(super) fn number_argument(arguments: &Value, name: &str) -> Result<f64, String> {
    let value = arguments.get(name).unwrap_or(arguments);
    value.as_f64().ok_or_else(|| format!("it takes {{\"{name}\": number}}"))
}

pub(super) fn panel_argument(arguments: &Value) -> Result<PanelKind, String> {
    let name = text_argument(arguments, "name")?;
    PanelKind::by_name(name).ok_or_else(|| {
        let known: Vec<&str> = PanelKind::ALL.iter().map(|panel| panel.name()).collect();
        format!("there is no panel \"{name}\"; there are {}", known.join(", "))
    })
}
