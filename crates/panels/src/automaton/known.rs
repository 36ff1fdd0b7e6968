//! What is known of the variables of a program without a plant: chosen by hand before each step.

use egui::{ComboBox, Grid, RichText, Ui};
use hca::{Automaton, VariableId};
use workbench::command::{Command, CommandSender};
use workbench::state::automaton::AutomatonCommand;

use super::title;
use crate::Context;

/// Shows one choice per variable.
pub(super) fn show(ui: &mut Ui, context: &Context<'_>, automaton: &Automaton, commands: &mut CommandSender) {
    title(ui, context, "Observations in this step", "");
    let note = RichText::new("No plant model: enter them by hand.").small();
    ui.label(note.color(context.tokens.text_muted));
    let input = context.state.automaton.next_input();
    Grid::new("automaton-known").num_columns(2).show(ui, |ui| {
        for (variable, id) in automaton.variables.iter().zip(0..) {
            ui.label(RichText::new(variable.name.as_str()).color(context.tokens.text));
            let now = input.known.get(&id).copied();
            let text = |value: Option<u32>| match value {
                None => "unknown",
                Some(value) => {
                    variable.values.get(value as usize).map_or("another value", |name| name.as_str())
                }
            };
            let combo = ComboBox::from_id_salt(("known", id)).selected_text(text(now)).show_ui(ui, |ui| {
                theme::structure::options(ui, "Known value");
                for value in std::iter::once(None).chain((0..variable.value_count()).map(Some)) {
                    if theme::structure::option(ui, now == value, text(value)).clicked() {
                        commands.send(Command::Automaton(AutomatonCommand::Know(VariableId(id), value)));
                    }
                }
            });
            combo.response.accessible_name(format!("Known value of {}", variable.name));
            ui.end_row();
        }
    });
}
