//! The activities and decisions in view as widgets: a screen reader lists them, Tab walks them, Enter selects them.

use egui::{Rect, Sense, Ui};
use layout::{BlockForm, Item, TextRole};
use smol_str::SmolStr;
use tpn::{BlockId, Network};
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;

use super::data::Drawn;
use super::highlight::selection_of;
use super::view::View;
use crate::{Context, draw_menu};

/// With more in view, a list helps no one.
const MAX_LANDMARKS: usize = 150;
/// Smaller than this, they cannot be told apart.
const MIN_HEIGHT: f32 = 5.0;

/// What was done with a landmark.
pub(super) struct Act {
    /// What it represents.
    pub(super) selection: Selection,
    /// Whether it was double clicked.
    pub(super) is_double: bool,
    /// The blocks whose box it opens, if a key pressed a box that represents no single activity.
    pub(super) opens: Option<(BlockId, BlockId)>,
}

/// Adds the landmarks in view, in the order of time, and answers what was done with one.
pub(super) fn show(
    ui: &Ui,
    panel: Rect,
    view: &View,
    drawn: &Drawn,
    network: &Network,
    (context, commands): (&Context<'_>, &mut CommandSender),
) -> Option<Act> {
    let chosen = &*context.state.selection;
    let mut found = in_view(panel, view, drawn, network);
    if found.len() > MAX_LANDMARKS {
        return None;
    }
    found.sort_by(|left, right| {
        left.rect.min.x.total_cmp(&right.rect.min.x).then(left.rect.min.y.total_cmp(&right.rect.min.y))
    });
    let mut act = None;
    for Landmark { rect, selection, opens } in found {
        let name = match &opens {
            Some((_, _, title)) => format!("{title}, collapsed, in the network"),
            None => format!("{} in the network", selection.title(Some(network))),
        };
        // Several boxes may have one name.
        let block = opens.as_ref().map(|(first, ..)| first.0);
        let response = ui.interact(rect, ui.scope_id().with(("landmark", &name, block)), Sense::click());
        let is_chosen = selection == *chosen;
        theme::structure::item(&response, is_chosen, &name);
        if response.has_focus() {
            let stroke = egui::Stroke::new(1.5, ui.visuals().selection.stroke.color);
            ui.painter_at(panel).rect_stroke(rect.expand(2.0), 3.0, stroke, egui::StrokeKind::Outside);
        }
        if response.secondary_clicked() {
            commands.send(Command::Select(selection.clone()));
        }
        draw_menu::activities(&response, context, commands);
        if response.clicked() {
            let is_double = response.double_clicked();
            let by_key = !response.clicked_by(egui::PointerButton::Primary) || is_double;
            let opens = opens.filter(|_| by_key).map(|(first, last, _)| (first, last));
            act = Some(Act { selection, is_double, opens });
        }
    }
    act
}

/// Something in view.
struct Landmark {
    rect: Rect,
    selection: Selection,
    /// The blocks and the title of a box that represents no single activity.
    opens: Option<(BlockId, BlockId, SmolStr)>,
}

fn in_view(panel: Rect, view: &View, drawn: &Drawn, network: &Network) -> Vec<Landmark> {
    let drawing = &drawn.drawing;
    let area = view.visible(panel);
    let inset = 16.0 / view.zoom();
    let mut found: Vec<Landmark> = Vec::new();
    let mut add = |rect: display::Rect, selection: Selection| {
        let rect = view.screen_rect(panel, rect).intersect(panel);
        let is_new = found.last().is_none_or(|last| last.selection != selection);
        if rect.height() >= MIN_HEIGHT && rect.width() > 0.0 && is_new {
            found.push(Landmark { rect, selection, opens: None });
        }
    };
    let least = f64::from(MIN_HEIGHT) / view.zoom();
    let mut arches = Vec::new();
    let mut boxes = Vec::new();
    drawing.visit(area, least, &mut |shape| match shape {
        layout::Shape::Text(at) => {
            let text = &drawing.texts[at as usize];
            let is_name =
                matches!(text.role, TextRole::Name | TextRole::Muted | TextRole::Tell | TextRole::Title);
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
        layout::Shape::Block(at) => {
            let shape = &drawing.blocks[at as usize];
            if let (BlockForm::Collapsed, None, Some(first), Some(last)) =
                (shape.form, shape.occurrence, shape.block, shape.last)
            {
                boxes.push((shape.rect, (first, last, shape.title.clone())));
            }
        }
        layout::Shape::Connector(_) => {}
    });
    for text in arches.into_iter().flatten().map(|&at| &drawing.texts[at as usize]) {
        let rect = text.rect_in_view(area.min.x + inset, area.max.x - inset);
        if text.role == TextRole::Name && rect.touches(area) {
            add(rect, selection_of(text.owner, network));
        }
    }
    for (rect, opens) in boxes {
        let rect = view.screen_rect(panel, rect).intersect(panel);
        found.push(Landmark { rect, selection: Selection::None, opens: Some(opens) });
    }
    found
}
