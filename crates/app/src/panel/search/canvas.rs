//! The search tree on screen: pan, zoom, click a state to go there, double click to fold what is below it.

use egui::{Align2, FontId, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, pos2, vec2};
use kirk::{TreeNodeId, TreeStatus};

use super::Shown;
use super::tree::TreeDrawing;
use crate::command::ViewAction;
use crate::panel::Context;
use crate::theme::size;

/// Where the tree is scrolled to.
#[derive(Clone, Copy, Debug)]
pub struct View {
    zoom: f32,
    scroll: egui::Vec2,
    fits: bool,
}

impl Default for View {
    fn default() -> Self {
        Self { zoom: 1.0, scroll: egui::Vec2::ZERO, fits: true }
    }
}

/// What was clicked.
pub enum Clicked {
    /// A state: go there.
    State(TreeNodeId),
    /// A state, twice: fold or unfold it.
    Toggle(TreeNodeId),
}

const CELL: egui::Vec2 = vec2(34.0, 52.0);
const RADIUS: f32 = 8.0;

impl View {
    /// Zooms or fits.
    pub fn follow(&mut self, action: ViewAction) {
        match action {
            ViewAction::ZoomIn => self.zoom_by(1.25),
            ViewAction::ZoomOut => self.zoom_by(0.8),
            ViewAction::ZoomReset => (self.zoom, self.fits) = (1.0, false),
            ViewAction::Fit | ViewAction::FitSelection => self.fits = true,
        }
    }

    fn zoom_by(&mut self, factor: f32) {
        self.zoom = (self.zoom * factor).clamp(0.02, 4.0);
        self.fits = false;
    }

    /// Paints the tree and answers what was clicked.
    pub fn show(
        &mut self,
        ui: &mut egui::Ui,
        context: &Context<'_>,
        shown: &Shown<'_>,
        drawing: &TreeDrawing,
    ) -> Option<Clicked> {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let count = shown.trace.tree.len();
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Image, true, format!("Search tree of {count} states"))
        });
        self.navigate(&response, rect, drawing);
        let painter = ui.painter_at(rect);
        let at = |place: [f32; 2]| self.place(rect, place);
        let step = shown.step.map_or(usize::MAX, |step| step.step);
        let current = shown.step.map(|step| step.tree_node);
        let path = path_to(shown, current);
        let visible = rect.expand(CELL.x);
        for (id, place) in drawing.places.iter().enumerate() {
            let Some(from) = place.map(at) else { continue };
            for &child in &drawing.children[id] {
                let Some(to) = drawing.places[child as usize].map(at) else { continue };
                if !visible.intersects(Rect::from_two_pos(from, to)) || !is_discovered(drawing, child, step) {
                    continue;
                }
                let on_path = path.contains(&child);
                let color = if on_path { context.tokens.accent } else { context.tokens.line_strong };
                painter.line_segment([from, to], Stroke::new(if on_path { 2.5 } else { 1.0 }, color));
            }
        }
        let pointer = response.hover_pos();
        let mut hit = None;
        for (id, place) in drawing.places.iter().enumerate() {
            let id = id as TreeNodeId;
            let Some(center) = place.map(at).filter(|center| visible.contains(*center)) else { continue };
            if !is_discovered(drawing, id, step) {
                continue;
            }
            self.state(&painter, context, shown, drawing, id, center, step, current == Some(id));
            if pointer.is_some_and(|pointer| pointer.distance(center) < (RADIUS * self.zoom).max(7.0)) {
                hit = Some(id);
            }
        }
        if let Some(id) = hit {
            let label = shown.trace.label(shown.network, id);
            response.clone().on_hover_text_at_pointer(label);
        }
        if response.double_clicked() {
            hit.map(Clicked::Toggle)
        } else if response.clicked() {
            hit.map(Clicked::State)
        } else {
            None
        }
    }

    fn navigate(&mut self, response: &egui::Response, rect: Rect, drawing: &TreeDrawing) {
        if response.dragged() {
            self.scroll += response.drag_delta();
            self.fits = false;
        }
        if let Some(pointer) = response.hover_pos() {
            let (scroll, pinch) =
                response.ctx.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            let factor = pinch * (scroll * 0.003).exp();
            if factor != 1.0 {
                let before = self.zoom;
                self.zoom_by(factor);
                // What is under the pointer stays there.
                let anchor = pointer - rect.center_top() - self.scroll;
                self.scroll += anchor * (1.0 - self.zoom / before);
            }
        }
        if self.fits {
            let margin = 2.0 * CELL.x;
            let across = (rect.width() - margin) / (drawing.width * CELL.x).max(1.0);
            let down = (rect.height() - 1.6 * CELL.y) / (drawing.depth * CELL.y).max(1.0);
            self.zoom = across.min(down).clamp(0.05, 1.4);
            self.scroll = vec2(-drawing.width * CELL.x * self.zoom / 2.0, CELL.y * 0.6);
        }
    }

    fn place(&self, rect: Rect, [across, down]: [f32; 2]) -> Pos2 {
        rect.center_top() + self.scroll + vec2(across * CELL.x, down * CELL.y) * self.zoom
    }

    #[expect(clippy::too_many_arguments, reason = "a state is drawn from all of them, in one place")]
    fn state(
        &self,
        painter: &egui::Painter,
        context: &Context<'_>,
        shown: &Shown<'_>,
        drawing: &TreeDrawing,
        id: TreeNodeId,
        center: Pos2,
        step: usize,
        is_current: bool,
    ) {
        let tokens = context.tokens;
        let radius = (RADIUS * self.zoom).max(2.5);
        let outline = Stroke::new(1.2, tokens.text_muted);
        match status_at(shown, drawing, id, step) {
            TreeStatus::Unexplored => {
                painter.circle(center, radius * 0.8, tokens.surface, outline);
            }
            TreeStatus::Decision => {
                painter.circle(center, radius, tokens.decision, Stroke::NONE);
            }
            TreeStatus::Failed => {
                let square = Rect::from_center_size(center, vec2(radius, radius) * 1.7);
                painter.rect_filled(square, 1.5, tokens.failure);
            }
            TreeStatus::Solution => {
                let points = [(0.0, -1.35), (1.35, 0.0), (0.0, 1.35), (-1.35, 0.0)];
                let points = points.map(|(x, y)| pos2(center.x + x * radius, center.y + y * radius)).to_vec();
                painter.add(Shape::convex_polygon(points, tokens.solution, Stroke::NONE));
            }
        }
        let is_folded = !drawing.children[id as usize].is_empty()
            && drawing.children[id as usize].iter().all(|&child| drawing.places[child as usize].is_none());
        if is_folded {
            let size = radius * 0.9;
            let below = center + vec2(0.0, radius * 1.9);
            let corners = vec![below - vec2(size, 0.0), below + vec2(size, 0.0), below + vec2(0.0, size)];
            painter.add(Shape::convex_polygon(corners, tokens.failure, Stroke::NONE));
        }
        if is_current {
            let ring = Rect::from_center_size(center, vec2(radius, radius) * 3.2);
            painter.rect_stroke(ring, radius, Stroke::new(2.0, tokens.accent), StrokeKind::Middle);
        }
        if self.zoom > 0.7 {
            let label = shown.trace.label(shown.network, id);
            if label.chars().count() <= 6 {
                let font = FontId::proportional(size::SMALL * self.zoom.min(1.0));
                let beside = center + vec2(radius + 3.0, -radius);
                painter.text(beside, Align2::LEFT_CENTER, label, font, tokens.text_muted);
            }
        }
    }
}

/// Whether a state is known at `step`: it was entered, or it is an untried alternative of a choice that was reached.
fn is_discovered(drawing: &TreeDrawing, id: TreeNodeId, step: usize) -> bool {
    match drawing.first_step[id as usize] {
        Some(first) => first <= step || is_offered(drawing, id, step),
        None => step == usize::MAX || is_offered(drawing, id, step),
    }
}

/// Whether an alternative of the same choice point has been entered.
fn is_offered(drawing: &TreeDrawing, id: TreeNodeId, step: usize) -> bool {
    let siblings = drawing.children.iter().find(|children| children.contains(&id));
    siblings.is_some_and(|siblings| {
        siblings
            .iter()
            .any(|&sibling| drawing.first_step[sibling as usize].is_some_and(|first| first <= step))
    })
}

/// What is known of a state at `step`.
fn status_at(shown: &Shown<'_>, drawing: &TreeDrawing, id: TreeNodeId, step: usize) -> TreeStatus {
    let status = shown.trace.tree[id as usize].status;
    match (drawing.first_step[id as usize], drawing.last_step[id as usize]) {
        (Some(first), _) if first > step => TreeStatus::Unexplored,
        (_, Some(last)) if last > step => TreeStatus::Decision,
        _ => status,
    }
}

/// The states from the root to `node`.
fn path_to(shown: &Shown<'_>, node: Option<TreeNodeId>) -> Vec<TreeNodeId> {
    let mut path = Vec::new();
    let mut at = node;
    while let Some(id) = at {
        path.push(id);
        at = shown.trace.tree.get(id as usize).and_then(|node| node.parent);
    }
    path
}
