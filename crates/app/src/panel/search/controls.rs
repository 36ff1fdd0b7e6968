//! The row of controls above the search tree: stepping, playing, breakpoints, and which search runs.

use mission::SearchKind;

use super::Shown;
use crate::command::{Command, CommandSender};
use crate::panel::Context;
use crate::state::search::SearchCommand;

/// Shows the controls.
pub fn show(
    ui: &mut egui::Ui,
    context: &Context<'_>,
    shown: &Shown<'_>,
    hides_failed: &mut bool,
    shows_matrix: &mut bool,
    commands: &mut CommandSender,
) {
    let search = &context.state.search;
    let last = shown.trace.events.len() - 1;
    ui.horizontal_wrapped(|ui| {
        let mut button = |ui: &mut egui::Ui, text: &str, help: &str, command: SearchCommand| {
            if ui.button(text).on_hover_text(help).clicked() {
                commands.send(Command::Search(command));
            }
        };
        button(ui, "Start", "To the first step (R)", SearchCommand::GoTo(0));
        button(ui, "◀", "One step back (,)", SearchCommand::Step(-1));
        let play = if search.is_playing { "Stop" } else { "Play" };
        button(ui, play, "Lets steps go by themselves (Space)", SearchCommand::TogglePlaying);
        button(ui, "▶", "One step forward (.)", SearchCommand::Step(1));
        button(ui, "Run", "To the next breakpoint, or to the end", SearchCommand::Run(true));
        if shown.step.is_some() {
            button(
                ui,
                "Show the plan",
                "Leaves the search and shows the plan again (Esc)",
                SearchCommand::Close,
            );
        }
        let mut step = shown.step.map_or(last, |step| step.step);
        let slider = egui::Slider::new(&mut step, 0..=last).text("step");
        if ui.add(slider).changed() {
            commands.send(Command::Search(SearchCommand::GoTo(step)));
        }
    });
    ui.horizontal_wrapped(|ui| {
        let mut kind = context.state.settings.plan.search;
        let name = |kind| match kind {
            SearchKind::Chronological => "Chronological search",
            SearchKind::ConflictDirected => "Conflict-directed search",
        };
        egui::ComboBox::from_id_salt("search-kind").selected_text(name(kind)).show_ui(ui, |ui| {
            for choice in [SearchKind::Chronological, SearchKind::ConflictDirected] {
                ui.selectable_value(&mut kind, choice, name(choice));
            }
        });
        if kind != context.state.settings.plan.search {
            commands.send(Command::SetSearch(kind));
        }
        ui.label(egui::RichText::new("Stop at").color(context.tokens.text_muted));
        let mut breakpoints = search.breakpoints;
        for (value, name, help) in [
            (&mut breakpoints.decision, "decisions", "Run and Play stop where an alternative is taken"),
            (&mut breakpoints.failure, "failures", "Run and Play stop at dead ends"),
            (&mut breakpoints.threat, "threats", "Run and Play stop where conflicting intervals may overlap"),
            (&mut breakpoints.solution, "plans", "Run and Play stop at plans"),
        ] {
            ui.toggle_value(value, name).on_hover_text(help);
        }
        if breakpoints != search.breakpoints {
            commands.send(Command::Search(SearchCommand::SetBreakpoints(breakpoints)));
        }
        ui.toggle_value(hides_failed, "Fold failures")
            .on_hover_text("Hides what is below states in which all fails");
        ui.toggle_value(shows_matrix, "Distances")
            .on_hover_text("The distance matrix of the events selected so far");
    });
}
