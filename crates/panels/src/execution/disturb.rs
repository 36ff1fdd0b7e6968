//! Disturbances by hand: what can still go otherwise than planned, and what was made to.

use egui::{Align, DragValue, Layout, RichText, Ui};
use exact::Time;
use executive::Disturbance;
use theme::icon::{self, Icon};
use tpn::{OccurrenceId, OccurrenceKind};
use workbench::command::{Command, CommandSender};
use workbench::state::execution::{ExecutionCommand, Pending, disturbance_text, exact_time};
use workbench::time_text;

use super::components::Components;
use super::vehicles::Vehicles;
use super::{Shown, now};
use crate::Context;
use crate::plan::section;

/// The size of a button: large enough to be hit while the run plays.
pub(super) const BUTTON: egui::Vec2 = egui::vec2(84.0, 28.0);
/// At first, the list has at most this many activities and conditions: the next ones.
const FIRST_LISTED: usize = 4;

/// A name that leaves room for two buttons after it, cut if it is too long.
pub(super) fn name_cell(ui: &mut Ui, name: &str) {
    let width = (ui.available_width() - 2.0 * BUTTON.x - 16.0).max(60.0);
    ui.allocate_ui_with_layout(egui::vec2(width, BUTTON.y), Layout::left_to_right(Align::Center), |ui| {
        ui.set_min_width(width);
        ui.add(egui::Label::new(name).truncate());
    });
}

/// How much longer or later, in mission units, and what is meant to happen to vehicles and components.
pub(super) struct Disturb {
    amount: f64,
    vehicles: Vehicles,
    components: Components,
    /// Whether all activities and conditions are listed.
    lists_all: bool,
}

impl Default for Disturb {
    fn default() -> Self {
        let (vehicles, components) = (Vehicles::default(), Components::default());
        Self { amount: 30.0, vehicles, components, lists_all: false }
    }
}

impl Disturb {
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        shown: Shown<'_>,
        commands: &mut CommandSender,
    ) {
        let moment = shown.moment;
        let all: Vec<&Pending> =
            moment.under_way.iter().chain(&moment.holding).chain(&moment.to_come).collect();
        let unit = context.snapshot.map(|snapshot| time_text::unit(snapshot.program.options.time_unit));
        if !all.is_empty() {
            section(ui, context, "Disturbances", "apply from the current time");
            ui.horizontal(|ui| {
                let name = ui.label(RichText::new("Delay by").color(context.tokens.text_muted)).id;
                let field = DragValue::new(&mut self.amount).range(0.0..=1e6).speed(0.5).max_decimals(1);
                ui.add(field.suffix(suffix(unit))).labelled_by(name);
            });
            natures(ui, context, shown, commands);
            let listed = if self.lists_all { all.len() } else { FIRST_LISTED.min(all.len()) };
            for &pending in &all[..listed] {
                ui.horizontal(|ui| self.row(ui, shown, pending, commands));
            }
            if all.len() > FIRST_LISTED {
                let rest = all.len() - FIRST_LISTED;
                let more = if self.lists_all { "Show fewer".to_owned() } else { format!("Show {rest} more") };
                if ui.link(more).clicked() {
                    self.lists_all = !self.lists_all;
                }
            }
            self.vehicles.show(ui, context, commands);
            self.components.show(ui, context, shown, &all, commands);
        }
        made(ui, context, commands);
    }

    fn row(&self, ui: &mut Ui, shown: Shown<'_>, pending: &Pending, commands: &mut CommandSender) {
        let id = pending.occurrence;
        let name = now::name(shown, id);
        let Some(occurrence) = shown.network.occurrences.get(id.index()) else { return };
        name_cell(ui, &now::words(shown, id));
        ui.horizontal(|ui| {
            let mut button = |ui: &mut Ui, text: &str, make: &dyn Fn() -> ExecutionCommand| {
                let response = ui.add(egui::Button::new(text).min_size(BUTTON));
                response.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::Button, true, format!("{text} {name}"))
                });
                if response.clicked() {
                    commands.send(Command::Execution(make()));
                }
            };
            let amount = exact_time(self.amount.max(0.0));
            if occurrence.kind == OccurrenceKind::Assertion {
                button(ui, "Withdraw", &|| ExecutionCommand::Withdraw(occurrence.name.clone()));
                if pending.since.is_none() {
                    button(ui, "Delay", &|| {
                        let at = pending.window.earliest;
                        let at = at.checked_add(amount).unwrap_or(at);
                        let condition = occurrence.name.clone();
                        ExecutionCommand::Disturb(Disturbance::Late { condition, at })
                    });
                }
            } else {
                button(ui, "Extend", &|| {
                    let usual = usual_duration(shown, id);
                    let duration = usual.checked_add(amount).unwrap_or(usual);
                    let activity = occurrence.name.clone();
                    ExecutionCommand::Disturb(Disturbance::Duration { activity, duration })
                });
            }
        });
    }
}

/// Whether the environment chooses its durations against the plan, where it chooses some.
fn natures(ui: &mut Ui, context: &Context<'_>, shown: Shown<'_>, commands: &mut CommandSender) {
    if shown.network.arcs.iter().all(|arc| !arc.is_contingent) {
        return;
    }
    let mut is_opposed = context.state.execution.is_opposed();
    let hint = "Choose contingent durations that break the plan, if any can. Restarts the run.";
    if ui.checkbox(&mut is_opposed, "Worst-case durations").on_hover_text(hint).changed() {
        commands.send(Command::Execution(ExecutionCommand::Oppose(is_opposed)));
    }
}

/// Returns how long an activity takes as things stand: in this run if it comes to its end, otherwise at least.
fn usual_duration(shown: Shown<'_>, id: OccurrenceId) -> Time {
    let Some(occurrence) = shown.network.occurrences.get(id.index()) else { return Time::ZERO };
    let took = shown.run.plans.last().and_then(|last| {
        let at = |node: tpn::NodeId| last.times.get(node.index()).copied().flatten();
        at(occurrence.end)?.checked_sub(at(occurrence.start)?)
    });
    took.or_else(|| Some(shown.network.arcs.get(occurrence.arc?.index())?.lower)).unwrap_or_default()
}

/// What was made to go wrong so far.
fn made(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let disturbances = context.state.execution.disturbances();
    if disturbances.is_empty() {
        return;
    }
    section(ui, context, "Active disturbances", "");
    for (index, disturbance) in disturbances.iter().enumerate() {
        ui.horizontal(|ui| {
            let text = disturbance_text(disturbance);
            if icon::button(ui, context.tokens, Icon::Close, &format!("Remove: {text}")).clicked() {
                commands.send(Command::Execution(ExecutionCommand::TakeBack(index)));
            }
            ui.add(egui::Label::new(&text).truncate()).on_hover_text(&text);
        });
    }
}

/// Returns what follows a number in a unit.
pub(super) fn suffix(unit: Option<&str>) -> String {
    unit.map_or_else(String::new, |unit| format!(" {unit}"))
}
