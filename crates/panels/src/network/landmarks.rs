//! The activities and decisions in view as widgets: a screen reader lists them, Tab walks them, Enter selects them.

use egui::{Rect, Role, Sense, Ui, WidgetInfo};
use layout::{Item, TextRole};
use tpn::Network;
use workbench::state::Selection;

use super::data::Drawn;
use super::highlight::selection_of;
use super::view::View;

/// With more in view, a list helps nobody.
const MOST: usize = 150;
/// Smaller than this, they cannot be told apart.
const LEAST_HEIGHT: f32 = 5.0;

/// What was done with a landmark.
pub(super) struct Act {
    /// What it stands for.
    pub(super) selection: Selection,
    /// Whether it was double clicked.
    pub(super) is_double: bool,
}

/// Adds the landmarks in view, in the order of time, and answers what was done with one.
pub(super) fn show(
    ui: &Ui,
    panel: Rect,
    view: &View,
    drawn: &Drawn,
    network: &Network,
    chosen: &Selection,
) -> Option<Act> {
    let mut found = in_view(panel, view, drawn, network);
    if found.len() > MOST {
        return None;
    }
    found.sort_by(|left, right| {
        left.0.min.x.total_cmp(&right.0.min.x).then(left.0.min.y.total_cmp(&right.0.min.y))
    });
    let mut act = None;
    for (rect, selection) in found {
        let name = format!("{} in the network", selection.name(Some(network)));
        let response = ui.interact(rect, ui.scope_id().with(("landmark", &name)), Sense::click());
        let is_chosen = selection == *chosen;
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_chosen, &name));
        if response.has_focus() {
            let stroke = egui::Stroke::new(1.5, ui.visuals().selection.stroke.color);
            ui.painter_at(panel).rect_stroke(rect.expand(2.0), 3.0, stroke, egui::StrokeKind::Outside);
        }
        if response.clicked() {
            act = Some(Act { selection, is_double: response.double_clicked() });
        }
    }
    act
}

fn in_view(panel: Rect, view: &View, drawn: &Drawn, network: &Network) -> Vec<(Rect, Selection)> {
    let drawing = &drawn.drawing;
    let area = view.visible(panel);
    let inset = 16.0 / view.zoom();
    let mut found: Vec<(Rect, Selection)> = Vec::new();
    let mut add = |rect: display::Rect, selection: Selection| {
        let rect = view.screen_rect(panel, rect).intersect(panel);
        let is_new = found.last().is_none_or(|(_, last)| *last != selection);
        if rect.height() >= LEAST_HEIGHT && rect.width() > 0.0 && is_new {
            found.push((rect, selection));
        }
    };
    let least = f64::from(LEAST_HEIGHT) / view.zoom();
    let mut arches = Vec::new();
    drawing.visit(area, least, &mut |shape| match shape {
        layout::Shape::Text(at) => {
            let text = &drawing.texts[at as usize];
            let is_name =
                matches!(text.role, TextRole::Name | TextRole::Quiet | TextRole::Tell | TextRole::Title);
            let selection = selection_of(text.owner, network);
            if is_name && text.slide.is_none() && matches!(selection, Selection::Occurrence(_)) {
                add(text.rect, selection);
            }
        }
        layout::Shape::Node(at) => {
            let node = &drawing.nodes[at as usize];
            if let selection @ Selection::Decision(_) = selection_of(Item::Node(node.id), network) {
                add(display::Rect::around(node.center, node.radius), selection);
            }
        }
        layout::Shape::Arc(at) => arches.extend(drawn.sliding.get(&at)),
        _ => {}
    });
    for text in arches.into_iter().flatten().map(|&at| &drawing.texts[at as usize]) {
        let rect = text.rect_in_view(area.min.x + inset, area.max.x - inset);
        if text.role == TextRole::Name && rect.touches(area) {
            add(rect, selection_of(text.owner, network));
        }
    }
    found
}
