//! One of two searches in figures: how much work it had done at its step, and in all.

use egui::{RichText, Ui};
use kirk::Status;
use workbench::PanelKind;
use workbench::command::{Command, CommandSender};
use workbench::state::search::{Counts, Recording, SearchCommand};
use workbench::state::window::WindowCommand;

use super::kind_name;
use crate::Context;

/// Shows the heading and the figures of a search.
pub fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    recording: &Recording,
    side: usize,
    commands: &mut CommandSender,
) {
    let tokens = context.tokens;
    let Some(searched) = recording.searched() else { return };
    let step = context.state.search.view(side).map(|view| view.step.step + 1);
    let all = Counts::of(recording.trace());
    let now = step.map_or(all, |step| Counts::until(recording.trace(), step));
    let is_active = context.state.search.side() == side;
    egui::Frame::new().inner_margin(egui::Margin { left: 10, right: 8, top: 4, bottom: 2 }).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.spacing_mut().item_spacing.y = 1.0;
        ui.horizontal(|ui| {
            let name = kind_name(searched.search);
            let color = if is_active { tokens.text } else { tokens.text_muted };
            let text = theme::strong(name).color(color);
            let button = ui.add(egui::Button::selectable(is_active, text));
            if button.on_hover_text("Show this search in the other panels").clicked() {
                commands.send(Command::Window(WindowCommand::Activate(PanelKind::Search)));
                commands.send(Command::Search(SearchCommand::Turn(side)));
            }
            let (text, color) = match searched.status {
                Status::Plan => ("plan found", tokens.solution),
                Status::NoPlan => ("no plan", tokens.failure),
                Status::Limit => ("undecided", tokens.warning),
                Status::Error => ("times too large", tokens.error),
            };
            ui.label(RichText::new(text).small().color(color));
        });
        let more = if recording.trace().is_truncated { "+" } else { "" };
        let learned = |steps: usize| recording.trace().learned(steps.saturating_sub(1)).count() as u64;
        let figures = [
            ("steps", step.unwrap_or(recording.steps()) as u64, recording.steps() as u64),
            ("states", now.states.into(), all.states.into()),
            ("propagations", now.propagations.into(), all.propagations.into()),
            ("backtracks", now.backtracks.into(), all.backtracks.into()),
            ("failures", now.failures.into(), all.failures.into()),
            ("learned", learned(step.unwrap_or(usize::MAX)), learned(usize::MAX)),
        ];
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 10.0;
            for (name, now, all) in figures.into_iter().filter(|&(name, _, all)| name != "learned" || all > 0)
            {
                let text = if now == all {
                    format!("{name} {all}{more}")
                } else {
                    format!("{name} {now} / {all}{more}")
                };
                ui.label(RichText::new(text).small().color(tokens.text_muted));
            }
            let millis = searched.millis;
            let time = if millis >= 100.0 { format!("{millis:.0} ms") } else { format!("{millis:.1} ms") };
            ui.label(RichText::new(format!("time {time}")).small().color(tokens.text_muted))
                .on_hover_text("Run time in this window, including recording");
        });
    });
}
