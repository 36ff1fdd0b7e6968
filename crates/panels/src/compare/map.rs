//! The paths of both plans from above: the first dashed, the second solid.

use display::{ColorRole, Dash, Stroke};
use egui::{Role, Sense, StrokeKind, Ui, WidgetInfo};
use layout::list::map::{MapFrame, MapPath, extent_m, map_list};
use review::compare::{Comparison, Way};
use theme::space;

use crate::Context;
use crate::painter::{DisplayPainter, Placement};
use crate::timeline::drawn;

/// The drawing is at most this wide and high.
const MAX_SIZE: [f32; 2] = [560.0, 320.0];
/// Around what is shown.
const MARGIN: f64 = 8.0;

/// Shows the paths.
pub(super) fn show(ui: &mut Ui, context: &Context<'_>, comparison: &Comparison) {
    let Some(snapshot) = context.snapshot else { return };
    let world = &snapshot.program.world;
    let ways = comparison.paths.iter().flat_map(|pair| pair.before.iter().chain(&pair.after));
    let points_m = ways.flat_map(|way| way.points_m.iter().copied());
    let Some([low_m, high_m]) = extent_m(world, points_m) else { return };
    ui.add_space(space::S);
    let width = ui.available_width().min(MAX_SIZE[0]);
    let size_m = high_m - low_m;
    let high_per_wide = size_m.y / size_m.x.max(1.0);
    let height = (width * high_per_wide as f32).clamp(120.0, MAX_SIZE[1]);
    let (rect, response) = ui.allocate_exact_size(egui::vec2(width, height), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, context.readable(&words(comparison))));
    if !ui.is_rect_visible(rect) {
        return;
    }
    let paths: Vec<MapPath<'_>> = comparison
        .paths
        .iter()
        .flat_map(|pair| {
            let before = Stroke::solid(ColorRole::TextMuted, 2.0).dashed(Dash::Dashed);
            let after = Stroke::solid(ColorRole::Slack, 2.0);
            [(&pair.before, before), (&pair.after, after)].into_iter().filter_map(|(way, stroke)| {
                let points_m = way.as_ref()?.points_m.clone();
                Some(MapPath { name: &pair.name, points_m, stroke })
            })
        })
        .collect();
    let list = map_list(world, &paths, &MapFrame::new(low_m, high_m, drawn(rect), MARGIN), None);
    DisplayPainter::new(ui.painter(), rect, Placement::SCREEN, context.tokens).paint(&[&list], Vec::new());
    let outline = egui::Stroke::new(1.0, context.tokens.line);
    ui.painter().rect_stroke(rect, 4.0, outline, StrokeKind::Inside);
    let note = "Dashed: before. Solid: after. North is up.";
    ui.label(egui::RichText::new(note).small().color(context.tokens.text_muted));
}

fn words(comparison: &Comparison) -> String {
    let lengths: Vec<String> = comparison
        .paths
        .iter()
        .map(|pair| {
            let length = |way: &Option<Way>| {
                way.as_ref().map_or_else(|| "none".to_owned(), |way| format!("{:.1} m", way.length_m))
            };
            format!("{}: before {}, after {}", pair.name, length(&pair.before), length(&pair.after))
        })
        .collect();
    format!("Map with the paths of both plans. {}", lengths.join(". "))
}
