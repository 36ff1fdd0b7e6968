//! Says what happens at the step that is looked at.

use kirk::Event;
use workbench::state::search::Recording;
use workbench::state::search::focus::is_failure;
use workbench::state::search::wording::{cycle_step, event};

use crate::{Context, counted};

/// Says what happens at the step that is looked at.
pub fn show(ui: &mut egui::Ui, context: &Context<'_>, recording: &Recording) {
    let tokens = context.tokens;
    let trace = recording.trace();
    let Some(view) = context.state.search.shown() else {
        let more = match (trace.is_truncated, trace.is_conflict_driven()) {
            (false, _) => "",
            (true, false) => "; the search that found the plan was not recorded",
            (true, true) => "; later steps were not recorded",
        };
        let text = format!(
            "{} recorded{more}. Press the period key (.) to step, or click a state in the tree.",
            counted(recording.steps() as u64, "step")
        );
        ui.label(egui::RichText::new(text).color(tokens.text_muted));
        return;
    };
    let step = view.step.step;
    let Some(entry) = trace.events.get(step) else { return };
    let color = match entry.event {
        Event::Solution { .. } => tokens.solution,
        _ if is_failure(&entry.event) => tokens.failure,
        _ => tokens.text,
    };
    let position = format!("{} / {}", step + 1, trace.events.len());
    ui.horizontal_wrapped(|ui| {
        ui.label(egui::RichText::new(position).color(tokens.text_muted).monospace());
        ui.label(egui::RichText::new(event(recording.network(), trace, &entry.event)).color(color));
    });
    if let Event::Inconsistent { cycle } = &entry.event {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 18.0;
            for member in cycle {
                let text = egui::RichText::new(cycle_step(recording.network(), member));
                ui.add(egui::Label::new(text.color(tokens.text_muted).small()).extend());
            }
        });
    }
}
