//! All steps in a table: what was marked, wanted, commanded, observed and found.

use egui::{Grid, RichText, ScrollArea, Ui};
use executive::model_based::StepOutcome;
use hca::Automaton;
use plant::{Commands, Model};
use workbench::command::{Command, CommandSender};
use workbench::state::automaton::{AutomatonCommand, Moment};

use super::Shown;
use crate::Context;

/// What each column tells, and whether there is nothing to tell without a plant.
const COLUMNS: [(&str, bool); 5] =
    [("Active", false), ("Goals", false), ("Commands", true), ("Result", false), ("Observed", true)];

/// Widths in points: of the column of step numbers, and the least that any other has.
const STEP_WIDTH: f32 = 48.0;
const MIN_CELL: f32 = 84.0;

/// Shows the table; `in_view` is the step that was scrolled to last.
pub(super) fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    shown: Shown<'_>,
    in_view: &mut usize,
    commands: &mut CommandSender,
) {
    let tokens = context.tokens;
    let state = &context.state.automaton;
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        let has_plant = shown.moment.plant.is_some();
        let is_told = |(_, needs_plant): (&str, bool)| has_plant || !needs_plant;
        // Cells break their lines rather than leave the panel, while there is room for a few words in each.
        let columns = if has_plant { COLUMNS.len() } else { COLUMNS.len() - 2 };
        let room = (ui.available_width() - STEP_WIDTH) / columns as f32 - ui.spacing().item_spacing.x;
        Grid::new("automaton-steps").striped(true).max_col_width(room.max(MIN_CELL)).show(ui, |ui| {
            theme::structure::part(ui, egui::accesskit::Role::Table, "Steps");
            let headings = COLUMNS.into_iter().filter(|column| is_told(*column)).map(|(heading, _)| heading);
            for heading in std::iter::once("Step").chain(headings) {
                ui.label(RichText::new(heading).small().color(tokens.text_muted));
            }
            ui.end_row();
            for (at, moment) in state.moments().iter().enumerate() {
                let is_shown = at == state.at();
                let number = if moment.marking.is_empty() { "end".to_owned() } else { (at + 1).to_string() };
                let label = theme::structure::choice(ui, is_shown, number).on_hover_text("Show this step");
                if is_shown && *in_view != at {
                    *in_view = at;
                    label.scroll_to_me(None);
                }
                if label.clicked() {
                    commands.send(Command::Automaton(AutomatonCommand::GoTo(at)));
                }
                let color = if is_shown { tokens.text } else { tokens.text_muted };
                let cells = cells(shown, moment, state.moments().get(at + 1).map(AsRef::as_ref));
                for (cell, _) in cells.into_iter().zip(COLUMNS).filter(|(_, column)| is_told(*column)) {
                    ui.label(RichText::new(cell).small().color(color));
                }
                ui.end_row();
            }
        });
    });
}

fn cells(shown: Shown<'_>, moment: &Moment, next: Option<&Moment>) -> [String; 5] {
    let mut marked = marked_text(shown.automaton, moment);
    for &(id, left) in &moment.upcoming.clocks {
        let Some(clock) = shown.automaton.clock(id) else { continue };
        let steps = if left == 1 { "step" } else { "steps" };
        marked.push_str(&format!("\n{}: {left} {steps} left", clock.label));
    }
    let goals = moment.upcoming.goals.join(", ");
    let plant = moment.plant.as_ref().zip(shown.program.model());
    let commands = plant.and_then(|(plant, model)| Some(commands_text(model, plant.next_commands.as_ref()?)));
    let after = next.and_then(|next| next.plant.as_ref()?.record.as_ref()).zip(shown.program.model());
    let observed = after.map(|(record, model)| {
        let names = model.observation_names(&record.observation);
        names.iter().map(|(name, value)| format!("{name}={value}")).collect::<Vec<_>>().join(", ")
    });
    [marked, goals, commands.unwrap_or_default(), outcome(shown, next), observed.unwrap_or_default()]
}

/// Returns what was injected, found and preempted in a step, and which times were up.
fn outcome(shown: Shown<'_>, next: Option<&Moment>) -> String {
    let Some(next) = next else { return String::new() };
    let mut parts = Vec::new();
    let record = next.plant.as_ref().and_then(|plant| plant.record.as_ref());
    if let Some((record, model)) = record.zip(shown.program.model()) {
        for (&component, &mode) in &record.input.injected {
            let name = model.component(component).map_or("?", |component| component.name.as_str());
            parts.push(format!("injected: {name}={}", model.mode_name(component, mode)));
        }
        for &(component, mode) in &record.failed {
            let name = model.component(component).map_or("?", |component| component.name.as_str());
            parts.push(format!("random fault: {name}={}", model.mode_name(component, mode)));
        }
        match record.outcome {
            StepOutcome::Explained => {}
            StepOutcome::Refuted { .. } => {
                parts.push("no state explains the observation".to_owned());
            }
            StepOutcome::LimitReached => parts.push("no tracked state explains the observation".to_owned()),
        }
        parts.extend(record.conflicts.iter().map(|conflict| conflict.describe(model)));
    }
    let preempted = next.taken.as_ref().map_or(0, |taken| taken.preempted.len());
    if preempted > 0 {
        parts.push("preempted".to_owned());
    }
    for &id in next.taken.iter().flat_map(|taken| &taken.elapsed) {
        let Some(clock) = shown.automaton.clock(id) else { continue };
        parts.push(format!("time is up: {}", clock.label));
    }
    parts.join("; ")
}

/// The names of the marked locations.
pub(super) fn marked_text(automaton: &Automaton, moment: &Moment) -> String {
    let names: Vec<String> =
        moment.marking.iter().map(|location| automaton.location_name(location)).collect();
    names.join(" ")
}

/// Commands as `EngineA.standby`, without the idle ones.
pub(super) fn commands_text(model: &Model, commands: &Commands) -> String {
    let names = model.command_names(commands);
    let texts: Vec<String> = names.iter().map(|(name, value)| format!("{name}.{value}")).collect();
    if texts.is_empty() { "none".to_owned() } else { texts.join(", ") }
}
