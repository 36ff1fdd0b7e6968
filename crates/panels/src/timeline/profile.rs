//! What pointing at the profile of a resource tells: its level then, and who takes of it.

use egui::{Rect, Sense, Ui};
use layout::timeline::ProfilePart;

use super::paint::Painting;
use crate::painter::Placement;

/// Shows the row of a profile, of which the plot is drawn elsewhere, as something to point at.
pub(super) fn show(ui: &Ui, painting: &Painting<'_>, index: usize, part: ProfilePart) {
    let Some(profile) = painting.chart.profiles.get(part.profile) else { return };
    let row = painting.row(index);
    let plot = Placement::SCREEN.screen_rect(painting.place.plot(index, part, profile.num_rows()));
    let area = Rect::from_x_y_ranges(plot.x_range(), row.y_range()).intersect(painting.visible);
    if !area.is_positive() {
        return;
    }
    let response = ui.interact(area, ui.scope_id().with(("profile", index)), Sense::hover());
    let Some(pointer) = response.hover_pos() else { return };
    let time = painting.view.time(painting.track, pointer.x);
    response.on_hover_ui_at_pointer(|ui| {
        ui.label(theme::strong(format!("{} at {time:.1}", profile.name)));
        for line in profile.words(time.max(0.0)) {
            ui.label(line);
        }
        let [first, second] = profile.summary();
        ui.label(format!("in all schedules {first}, {second}"));
    });
}
