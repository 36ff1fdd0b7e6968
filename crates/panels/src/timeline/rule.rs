//! What pointing at the track of a flight rule tells: how the plan stands to it.

use egui::{Sense, Ui};

use super::paint::Painting;

/// Shows the row of a rule, which is drawn elsewhere, as something to point at.
pub(super) fn show(ui: &Ui, painting: &Painting<'_>, index: usize, rule: usize) {
    let Some(rule) = painting.chart.rules.get(rule) else { return };
    let response = ui.interact(painting.row(index), ui.scope_id().with(("rule", index)), Sense::hover());
    response.on_hover_ui_at_pointer(|ui| {
        ui.label(theme::strong(rule.name.as_str()));
        ui.label(&rule.words);
    });
}
