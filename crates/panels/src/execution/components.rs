//! Faults of the plant's components while an activity runs its control program.

use egui::{ComboBox, DragValue, RichText, Ui};
use executive::Disturbance;
use num_traits::ToPrimitive as _;
use smol_str::SmolStr;
use workbench::command::{Command, CommandSender};
use workbench::state::execution::{ExecutionCommand, Pending};
use workbench::state::playback::number;

use super::{Shown, now};
use crate::Context;
use crate::plan::section;

/// What is to fail, by places in the lists.
#[derive(Default)]
pub(super) struct Components {
    component: usize,
    mode: usize,
    step: u32,
}

/// A component with its modes, those that faults lead to first. Components that can fail come first as well.
struct Choice {
    name: SmolStr,
    modes: Vec<String>,
}

impl Components {
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        shown: Shown<'_>,
        pending: &[&Pending],
        commands: &mut CommandSender,
    ) {
        let Some(snapshot) = context.snapshot else { return };
        let Some(commanded) = &shown.run.commanded else { return };
        let choices = choices(&commanded.plant);
        if choices.is_empty() {
            return;
        }
        let step_units = number(snapshot.program.options.control_step);
        for pending in pending {
            let Some(occurrence) = shown.network.occurrences.get(pending.occurrence.index()) else {
                continue;
            };
            if !commanded.by.contains(&pending.occurrence) {
                continue;
            }
            // Steps that are over cannot go otherwise any more.
            let elapsed = pending.since.map_or(0.0, |since| context.state.playback.time - number(since));
            let next = (elapsed / step_units.max(1e-9)).floor().to_u32().unwrap_or(0) + 1;
            let name = now::name(shown, pending.occurrence);
            section(ui, context, "Components", &format!("of the plant controlled by {name}"));
            self.step = self.step.max(next);
            self.component = self.component.min(choices.len() - 1);
            ui.horizontal_wrapped(|ui| {
                let muted = context.tokens.text_muted;
                let combo = |ui: &mut Ui, label: &str, place: &mut usize, names: &[&str]| {
                    let selected = names.get(*place).copied().unwrap_or_default();
                    let shown = ComboBox::from_id_salt((label, &name)).selected_text(selected).width(84.0);
                    let response = shown.show_ui(ui, |ui| {
                        theme::structure::options(ui, label);
                        for (index, name) in names.iter().enumerate() {
                            theme::structure::option_value(ui, place, index, *name);
                        }
                    });
                    response.response.accessible_name(label);
                };
                let names: Vec<&str> = choices.iter().map(|it| it.name.as_str()).collect();
                combo(ui, "Component", &mut self.component, &names);
                let choice = &choices[self.component.min(choices.len() - 1)];
                self.mode = self.mode.min(choice.modes.len().saturating_sub(1));
                ui.label(RichText::new("enters mode").color(muted));
                let names: Vec<&str> = choice.modes.iter().map(String::as_str).collect();
                combo(ui, "Mode", &mut self.mode, &names);
                let label = ui.label(RichText::new("in step").color(muted)).id;
                ui.add(DragValue::new(&mut self.step).range(next..=1000)).labelled_by(label);
                if ui.button("Inject").clicked()
                    && let Some(mode) = choice.modes.get(self.mode)
                {
                    let fault = Disturbance::Fault {
                        activity: occurrence.name.clone(),
                        step: self.step,
                        component: choice.name.clone(),
                        mode: mode.as_str().into(),
                    };
                    commands.send(Command::Execution(ExecutionCommand::Disturb(fault)));
                }
            });
        }
    }
}

fn choices(model: &plant::Model) -> Vec<Choice> {
    let choice = |id| {
        let component = model.component(id)?;
        let is_fault =
            |mode: u8| component.modes.iter().flat_map(|it| &it.faults).any(|fault| fault.to == mode);
        let mut modes: Vec<(bool, String)> = (0..=u8::MAX)
            .zip(&component.modes)
            .map(|(mode, data)| (!is_fault(mode), data.name.to_string()))
            .collect();
        modes.sort_by_key(|(is_usual, _)| *is_usual);
        Some(Choice {
            name: component.name.clone(),
            modes: modes.into_iter().map(|(_, name)| name).collect(),
        })
    };
    model.component_ids().filter_map(choice).collect()
}
