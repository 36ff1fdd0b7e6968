//! The search tree on screen: pan, zoom, click a state to go there, double click to fold what is below it.
//!
//! What is painted is bounded by the room on screen, however large the search: only rows and states in view, and of
//! states that would share a pixel one.

use std::cell::RefCell;
use std::collections::BTreeMap;

use egui::{Align2, Color32, EventFilter, FontId, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, pos2, vec2};
use kirk::{Event, Trace, TreeChoice, TreeNodeId, TreeStatus};
use theme::size;
use tpn::{DecisionId, Network};
use workbench::ViewAction;
use workbench::state::search::focus::concerns;
use workbench::state::search::{Share, wording};

use super::items;
use super::merged::{self, Merged};
use super::tree::{TreeDrawing, TreeIndex};
use crate::{Context, counted};

/// Where the tree is looked at from.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Points per cell, across and down.
    cell: egui::Vec2,
    /// From the middle of the panel's upper edge to the tree's upper left corner.
    scroll: egui::Vec2,
    fits: bool,
    /// What fits must leave states at least this far apart downwards; else the goal is looked at from near.
    min_down: f32,
    /// The state that was last brought into view.
    followed: Option<TreeNodeId>,
    /// Whether the tree itself has the keyboard.
    pub(super) has_focus: bool,
}

impl Default for View {
    fn default() -> Self {
        Self {
            cell: vec2(34.0, 46.0),
            scroll: egui::Vec2::ZERO,
            fits: true,
            min_down: MIN_DOWN,
            followed: None,
            has_focus: false,
        }
    }
}

/// What is drawn of one search.
#[derive(Clone, Copy)]
pub struct Tree<'a> {
    /// The network that was searched.
    pub network: &'a Network,
    /// What was recorded.
    pub trace: &'a Trace,
    /// What is known of its states.
    pub index: &'a TreeIndex,
    /// Where they are.
    pub drawing: &'a TreeDrawing,
    /// The names of alternatives, as far as they were needed.
    pub names: &'a Names,
    /// The step that is looked at, if one is, and its state.
    pub step: Option<(usize, TreeNodeId)>,
    /// The state that the search is for: its plan, or how far it came. The way there is marked while no step is looked
    /// at.
    pub goal: TreeNodeId,
    /// The state that the step jumps back to, if it does.
    pub jump: Option<TreeNodeId>,
    /// The name of the drawing for screen readers.
    pub name: &'a str,
    /// Who entered which state, if these are two searches merged.
    pub merged: Option<Merged<'a>>,
}

/// The names of alternatives. Finding one takes a walk through the network, too much for each frame.
#[derive(Default)]
pub struct Names(RefCell<BTreeMap<(DecisionId, u32), String>>);

impl Tree<'_> {
    /// A name for a state by what was chosen: of a decision, what the alternative does.
    fn label(&self, choice: Option<TreeChoice>) -> String {
        let Some(TreeChoice::Decision { decision, alternative }) = choice else {
            return short_label(self.network, choice);
        };
        let mut names = self.names.0.borrow_mut();
        let name = names.entry((decision, alternative));
        name.or_insert_with(|| self.network.alternative_name(decision, alternative)).clone()
    }

    fn step(&self) -> Option<usize> {
        self.step.map(|(step, _)| step)
    }

    /// The state of the step: that of each search, if two are merged.
    pub(super) fn at_step(&self) -> [Option<TreeNodeId>; 2] {
        match &self.merged {
            Some(merged) => merged.steps.map(|step| step.map(|(_, state)| state)),
            None => [self.step.map(|(_, state)| state), None],
        }
    }

    /// Returns whether a state is known at the step: at that of either search, if two are merged.
    pub(super) fn is_known(&self, id: TreeNodeId) -> bool {
        match &self.merged {
            Some(merged) => merged.is_known(id),
            None => self.index.is_known(id, self.step()),
        }
    }

    /// Returns what has come of a state by the step.
    pub(super) fn status(&self, id: TreeNodeId) -> TreeStatus {
        match &self.merged {
            Some(merged) => merged.status(id),
            None => self.index.status(self.trace, id, self.step()),
        }
    }

    /// The learned conflict that excludes a state by the step: in either search, if two are merged.
    pub(super) fn learned(&self, id: TreeNodeId) -> Option<&[TreeChoice]> {
        match &self.merged {
            Some(merged) => merged.learned(id),
            None => Some(self.index.exclusion(id, self.step())?.conflict(self.trace)),
        }
    }
}

/// What the pointer did.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pointed {
    /// The state under the pointer.
    pub hovered: Option<TreeNodeId>,
    /// It was clicked: go there.
    pub clicked: bool,
    /// It was clicked twice: fold or unfold it.
    pub toggled: bool,
    /// Assistive technology goes to it, wherever the pointer is.
    pub chosen: bool,
}

/// The designed size of a cell, and the most and least that one is made.
const CELL: egui::Vec2 = vec2(34.0, 46.0);
const MAX_CELL: egui::Vec2 = vec2(110.0, 58.0);
/// A tree in which states would be nearer to each other downwards is not shown as a whole unless that is asked for.
const MIN_DOWN: f32 = 5.0;
const MIN_CELL: egui::Vec2 = vec2(0.002, 0.002);
const LARGEST_CELL: egui::Vec2 = vec2(260.0, 180.0);
const RADIUS: f32 = 8.0;
/// From the edges of the panel to the tree when all of it is in view.
const MARGIN: egui::Vec2 = vec2(22.0, 18.0);
/// States nearer to each other than this, in points, are drawn as one.
const MIN_GAP: f32 = 2.0;
/// Below this distance states are bars without signs and labels.
const MIN_SIGN: f32 = 7.0;
/// A label with less room than this is left out.
const MIN_LABEL: f32 = 16.0;
/// With less room than this, a label is left out instead of cut.
const MIN_CUT: f32 = 56.0;
/// Between a label and what comes before it.
const LABEL_GAP: f32 = 6.0;

/// Where the label of a state stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Left,
    Right,
}

impl Side {
    /// At the right if it fits there; else where there is more room, left and right of the state.
    fn of(width: f32, [left, right]: [f32; 2]) -> Self {
        if width > right && left > right { Self::Left } else { Self::Right }
    }
}

/// The height in which a tree is drawn as it is meant to be.
pub fn height_of(drawing: &TreeDrawing) -> f32 {
    drawing.depth() * CELL.y + 2.0 * MARGIN.y
}

impl View {
    /// Zooms, shows everything, or what matters at the step.
    pub fn follow(&mut self, action: ViewAction, rect: Rect) {
        match action {
            ViewAction::ZoomIn => self.zoom_at(rect.center(), rect, 1.25),
            ViewAction::ZoomOut => self.zoom_at(rect.center(), rect, 0.8),
            ViewAction::ZoomReset => (self.cell, self.fits, self.followed) = (CELL, false, None),
            ViewAction::Fit => (self.fits, self.min_down) = (true, 0.0),
            // As at first, and from there to the step.
            ViewAction::FitSelection => *self = Self::default(),
            ViewAction::TopView | ViewAction::Follow | ViewAction::Tour => {}
        }
    }

    /// Zooms; what is at `anchor` stays there.
    fn zoom_at(&mut self, anchor: Pos2, rect: Rect, factor: f32) {
        let before = self.cell;
        self.cell = (self.cell * factor).max(MIN_CELL).min(LARGEST_CELL);
        let from_corner = anchor - rect.center_top() - self.scroll;
        self.scroll += from_corner - from_corner * self.cell / before;
        self.fits = false;
    }

    /// Paints the tree and answers what the pointer did.
    pub fn show(&mut self, ui: &mut egui::Ui, context: &Context<'_>, tree: &Tree<'_>) -> Pointed {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let count = tree.trace.tree.len();
        response.widget_info(|| {
            let name = format!("{}: search tree of {}", tree.name, counted(count as u64, "state"));
            egui::WidgetInfo::labeled(egui::Role::Tree, true, name)
        });
        self.has_focus = response.has_focus();
        if self.has_focus {
            // Arrow keys walk the tree (`keys`) instead of going to the next widget.
            let filter = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
            ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        }
        self.navigate(&response, rect, tree);
        self.follow_step(rect, tree);
        let painter = ui.painter_at(rect);
        let path = path_to(tree);
        let scene = Scene { painter: &painter, rect, view: *self, context, tree, path: &path };
        scene.paint();
        let hovered = response.hover_pos().and_then(|pointer| self.state_at(rect, pointer, tree));
        let place =
            |id: TreeNodeId| Some(self.place(rect, tree.drawing.places.get(id as usize).copied().flatten()?));
        let chosen = items::show(ui, &response, tree, &path, place);
        Pointed {
            hovered: chosen.or(hovered),
            chosen: chosen.is_some(),
            clicked: response.clicked() && hovered.is_some(),
            toggled: response.double_clicked() && hovered.is_some(),
        }
    }

    fn state_at(&self, rect: Rect, pointer: Pos2, tree: &Tree<'_>) -> Option<TreeNodeId> {
        let at = self.cells(rect, pointer);
        let reach = vec2(radius(self.cell).max(7.0), radius(self.cell).max(7.0)) / self.cell;
        let found = tree.drawing.nearest(at, [reach.x, reach.y.min(0.5)])?;
        tree.is_known(found).then_some(found)
    }

    fn navigate(&mut self, response: &egui::Response, rect: Rect, tree: &Tree<'_>) {
        if response.dragged() {
            self.scroll += response.drag_delta();
            self.fits = false;
        }
        if let Some(pointer) = response.hover_pos() {
            let (scroll, pinch) =
                response.ctx.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            let factor = pinch * (scroll * 0.003).exp();
            if factor != 1.0 {
                self.zoom_at(pointer, rect, factor);
            }
        }
        if self.fits {
            let room = rect.size() - 2.0 * MARGIN;
            let across = room.x / (tree.drawing.width + 0.6).max(1.0);
            let down = room.y / tree.drawing.depth().max(1.0);
            if down < self.min_down {
                self.look_at_goal(rect, tree);
                return;
            }
            self.cell = vec2(across, down).min(MAX_CELL).max(MIN_CELL);
            // A tree of one row stands near the top.
            self.scroll = vec2(-(tree.drawing.width + 0.4) * self.cell.x / 2.0, MARGIN.y);
        }
    }

    /// At the designed size, with the goal where much of the way there is in view.
    fn look_at_goal(&mut self, rect: Rect, tree: &Tree<'_>) {
        let goal = tree.drawing.stand_in(tree.trace, tree.goal);
        let Some([across, down]) = tree.drawing.places.get(goal as usize).copied().flatten() else { return };
        self.cell = CELL;
        self.scroll = vec2(0.0, rect.height() * 0.8) - vec2(across, down) * self.cell;
    }

    /// Brings the state of a new step into view if it is not.
    fn follow_step(&mut self, rect: Rect, tree: &Tree<'_>) {
        let current = tree.step.map(|(_, state)| tree.drawing.stand_in(tree.trace, state));
        if current == self.followed {
            return;
        }
        self.followed = current;
        let place = current.and_then(|id| tree.drawing.places.get(id as usize).copied().flatten());
        if let Some(place) = place {
            let at = self.place(rect, place);
            if !rect.shrink2(MARGIN.min(rect.size() / 4.0)).contains(at) {
                self.scroll += rect.center() - at;
                self.fits = false;
            }
        }
    }

    fn place(&self, rect: Rect, [across, down]: [f32; 2]) -> Pos2 {
        rect.center_top() + self.scroll + vec2(across, down) * self.cell
    }

    fn cells(&self, rect: Rect, at: Pos2) -> [f32; 2] {
        let from_corner = (at - rect.center_top() - self.scroll) / self.cell;
        [from_corner.x, from_corner.y]
    }
}

/// The state that a step of `trace` jumps back to, past choices that have no part in the failure.
pub fn jump(trace: &Trace, step: usize) -> Option<TreeNodeId> {
    match trace.events.get(step)?.event {
        Event::Backjump { to, .. } => Some(to),
        _ => None,
    }
}

/// The size of a state's sign.
fn radius(cell: egui::Vec2) -> f32 {
    (cell.x * 0.3).min(cell.y * 0.21).clamp(1.0, RADIUS)
}

/// The states from the root to that of the step, or without a step to the goal, in this order; ascending, since parents come before their children.
fn path_to(tree: &Tree<'_>) -> Vec<TreeNodeId> {
    let above = |&id: &TreeNodeId| tree.trace.tree.get(id as usize).and_then(|node| node.parent);
    let mut path: Vec<_> =
        std::iter::successors(Some(tree.step.map_or(tree.goal, |(_, state)| state)), above).collect();
    path.reverse();
    path
}

/// Everything that painting needs.
struct Scene<'a> {
    painter: &'a egui::Painter,
    rect: Rect,
    view: View,
    context: &'a Context<'a>,
    tree: &'a Tree<'a>,
    path: &'a [TreeNodeId],
}

impl Scene<'_> {
    fn paint(&self) {
        let [left, top] = self.view.cells(self.rect, self.rect.min);
        let [right, bottom] = self.view.cells(self.rect, self.rect.max);
        let last = self.tree.drawing.rows.len().saturating_sub(1);
        let first_row = (top.floor() - 1.0).max(0.0) as usize;
        let last_row = ((bottom.ceil() + 1.0).max(0.0) as usize).min(last);
        let stride = (MIN_GAP / self.view.cell.y).ceil().max(1.0) as usize;
        let rows: Vec<(usize, Vec<TreeNodeId>)> = (first_row..=last_row)
            .step_by(stride)
            .map(|row| (row, self.seen(row, left - 1.0, right + 1.0)))
            .collect();
        for (row, states) in rows.iter().filter(|(row, _)| *row > 0) {
            self.edges(*row, states);
        }
        self.path_edges(first_row, last_row);
        for (_, states) in &rows {
            self.states(states);
        }
        // What matters is seen even where only one of many states is drawn.
        for &id in self.path {
            self.sign_of(id);
        }
        self.jump();
        for state in self.tree.at_step().into_iter().flatten() {
            self.current(self.tree.drawing.stand_in(self.tree.trace, state));
        }
    }

    /// The states of a row that are drawn: those in view, and of those that would share a place one.
    fn seen(&self, row: usize, left: f32, right: f32) -> Vec<TreeNodeId> {
        let states = self.tree.drawing.between(row, left, right);
        let least = MIN_GAP / self.view.cell.x;
        let across = |id: TreeNodeId| self.tree.drawing.places[id as usize].map_or(0.0, |place| place[0]);
        let mut seen = Vec::new();
        let mut at = 0;
        while let Some(&id) = states.get(at) {
            let next = if least > 1.0 {
                at + 1 + states[at + 1..].partition_point(|&other| across(other) < across(id) + least)
            } else {
                at + 1
            };
            // A solution stands out of those that share its place; what is not known yet gives way.
            let group = states[at..next].iter().take(64).copied();
            let known = group.filter(|&id| self.tree.is_known(id));
            seen.extend(known.max_by_key(|&id| {
                (self.tree.index.has_solution[id as usize], self.tree.index.first_step[id as usize].is_some())
            }));
            at = next;
        }
        seen
    }

    fn at(&self, id: TreeNodeId) -> Option<Pos2> {
        let place = self.tree.drawing.places.get(id as usize).copied().flatten()?;
        Some(self.view.place(self.rect, place))
    }

    /// From each state of a row up to the level of its choice point and over to it.
    fn edges(&self, row: usize, states: &[TreeNodeId]) {
        let color = self.context.tokens.text_faint;
        let strength = (self.view.cell.x / 6.0).clamp(0.35, 1.0);
        let stroke =
            Stroke::new(if self.view.cell.x < 4.0 { 0.6 } else { 1.0 }, color.gamma_multiply(strength));
        if self.view.cell.y < MIN_GAP && row > 1 {
            return;
        }
        for &id in states {
            self.edge(id, stroke);
        }
    }

    fn edge(&self, id: TreeNodeId, stroke: Stroke) {
        let parent = self.tree.trace.tree.get(id as usize).and_then(|node| node.parent);
        let (Some(to), Some(from)) = (self.at(id), parent.and_then(|parent| self.at(parent))) else { return };
        let middle = f32::midpoint(from.y, to.y);
        if let Some(merged) = self.tree.merged {
            return self.merged_edge(
                merged.tree.share(id),
                [from, pos2(from.x, middle), pos2(to.x, middle), to],
                stroke,
            );
        }
        // Clipped here: a long tree has lines that are too long to be painted exactly.
        let clip = |x: f32| x.clamp(self.rect.left() - 4.0, self.rect.right() + 4.0);
        self.painter.line_segment([pos2(to.x, to.y), pos2(to.x, middle)], stroke);
        if (from.x - to.x).abs() > 0.1 {
            self.painter.line_segment([pos2(clip(to.x), middle), pos2(clip(from.x), middle)], stroke);
        }
        self.painter.line_segment([pos2(from.x, middle), from], stroke);
    }

    /// An edge of merged trees, in the color and the dashes of the search that alone entered its state.
    fn merged_edge(&self, share: Share, corners: [Pos2; 4], stroke: Stroke) {
        let is_path = stroke.color == self.context.tokens.accent;
        let color = if is_path { stroke.color } else { merged::color(self.context, share) };
        let clip = self.rect.expand(4.0);
        let corners = corners.map(|corner| pos2(corner.x.clamp(clip.left(), clip.right()), corner.y));
        let stroke = Stroke::new(stroke.width.max(1.4), color);
        // What is smaller than its dashes is told by its color alone.
        let share = if self.view.cell.x < 8.0 { Share::Both } else { share };
        self.painter.extend(merged::lines(&corners, stroke, share));
    }

    /// The arrow of a jump, from the state of the step around all that it passes over to where it leads.
    fn jump(&self) {
        let ends = self.tree.step.map(|(_, state)| state).zip(self.tree.jump);
        let stand_in = |id| self.at(self.tree.drawing.stand_in(self.tree.trace, id));
        let Some((from, to)) = ends.and_then(|(from, to)| Some((stand_in(from)?, stand_in(to)?))) else {
            return;
        };
        let stroke = Stroke::new(2.0, self.context.tokens.failure);
        let radius = radius(self.view.cell).max(3.0);
        // To the left of what it passes over, as far as there is room.
        let aside = (0.35 * (from.y - to.y).abs()).clamp(24.0, 120.0);
        let left = (from.x.min(to.x) - aside).max(self.rect.left() + 6.0);
        let [start, end] = [from - vec2(radius * 1.6, 0.0), to - vec2(radius * 1.6, 0.0)];
        let control = [pos2(left, start.y), pos2(left, end.y)];
        let curve = egui::epaint::CubicBezierShape::from_points_stroke(
            [start, control[0], control[1], end],
            false,
            Color32::TRANSPARENT,
            stroke,
        );
        let points = curve.flatten(Some(0.5));
        self.painter.extend(Shape::dashed_line(&points, stroke, 6.0, 3.0));
        let along = (end
            - points.iter().rev().find(|it| it.distance(end) > 6.0).copied().unwrap_or(control[1]))
        .normalized();
        let across = along.rot90() * 4.5;
        let back = end - along * 9.0;
        let head = vec![end, back + across, back - across];
        self.painter.add(Shape::convex_polygon(head, stroke.color, Stroke::NONE));
    }

    fn path_edges(&self, first_row: usize, last_row: usize) {
        let stroke = Stroke::new(if self.view.cell.x < 6.0 { 1.5 } else { 2.5 }, self.context.tokens.accent);
        let rows = first_row.saturating_sub(1)..(last_row + 2).min(self.path.len());
        for &id in self.path.get(rows).unwrap_or_default() {
            self.edge(id, stroke);
        }
    }

    fn states(&self, states: &[TreeNodeId]) {
        let radius = radius(self.view.cell);
        // How far a label may reach to the left: past no sign and no label before it.
        let mut free = self.rect.left() + 4.0;
        for (place, &id) in states.iter().enumerate() {
            let Some(center) = self.at(id).filter(|at| self.rect.expand(RADIUS * 2.0).contains(*at)) else {
                continue;
            };
            let choice = self.tree.trace.tree[id as usize].choice;
            if concerns(choice, &self.context.state.selection, self.tree.network) {
                self.painter.circle_filled(center, radius + 5.0, self.context.tokens.selection);
            } else if concerns(choice, &self.context.state.hovered, self.tree.network) {
                self.painter.circle_filled(center, radius + 4.0, self.context.tokens.hover);
            }
            self.sign(id, center, radius);
            let mut end = center.x + radius;
            if self.view.cell.x >= MIN_SIGN && self.view.cell.y >= 16.0 {
                let next = states.get(place + 1).and_then(|&next| self.at(next));
                let right = next.map_or(self.rect.right() - 4.0, |next| next.x - radius - 3.0);
                end = self.label(id, center, radius, [free, right]).unwrap_or(end).max(end);
            }
            free = end + LABEL_GAP;
        }
    }

    fn sign_of(&self, id: TreeNodeId) {
        if let Some(center) = self.at(id).filter(|at| self.rect.contains(*at)) {
            self.sign(id, center, radius(self.view.cell).max(2.0));
        }
    }

    fn sign(&self, id: TreeNodeId, center: Pos2, radius: f32) {
        let tokens = self.context.tokens;
        match self.tree.status(id) {
            TreeStatus::Unexplored => {
                let outline = Stroke::new((radius / 6.0).clamp(0.5, 1.2), tokens.text_muted);
                self.painter.circle(center, radius * 0.8, tokens.surface, outline);
            }
            // A failure that was not searched.
            TreeStatus::Excluded => {
                let square = Rect::from_center_size(center, vec2(radius, radius) * 1.5);
                let outline = Stroke::new((radius / 5.0).clamp(0.6, 1.5), tokens.failure);
                self.painter.rect(square, 1.5, tokens.surface, outline, StrokeKind::Middle);
            }
            TreeStatus::Decision => {
                self.painter.circle_filled(center, radius, tokens.decision);
            }
            TreeStatus::Failed => {
                let square = Rect::from_center_size(center, vec2(radius, radius) * 1.7);
                self.painter.rect_filled(square, 1.5, tokens.failure);
            }
            TreeStatus::Solution => {
                // Seen from afar as well.
                let radius = radius.max(3.0);
                let points = [(0.0, -1.35), (1.35, 0.0), (0.0, 1.35), (-1.35, 0.0)];
                let points = points.map(|(x, y)| pos2(center.x + x * radius, center.y + y * radius)).to_vec();
                self.painter.add(Shape::convex_polygon(points, tokens.solution, Stroke::NONE));
            }
        }
        if radius >= 2.0 && self.tree.learned(id).is_some() {
            // The bar of a road that is closed; where the other search did go in, within its failure.
            let is_closed = self.tree.status(id) == TreeStatus::Excluded;
            let color = if is_closed { tokens.failure } else { tokens.surface };
            let bar = Rect::from_center_size(center, vec2(radius * 1.1, (radius * 0.4).max(1.0)));
            self.painter.rect_filled(bar, 0.0, color);
        }
        if radius >= 4.0 && self.is_folded(id) {
            let (top, half) = (center.y + radius * 1.25, radius * 0.8);
            let corners = vec![
                pos2(center.x - half, top),
                pos2(center.x + half, top),
                pos2(center.x, top + radius * 0.75),
            ];
            self.painter.add(Shape::convex_polygon(corners, tokens.failure, Stroke::NONE));
        }
    }

    /// Returns whether a state is drawn without what is below it.
    fn is_folded(&self, id: TreeNodeId) -> bool {
        let children = self.tree.index.children(id);
        !children.is_empty()
            && children.iter().all(|&child| self.tree.drawing.places[child as usize].is_none())
    }

    fn current(&self, id: TreeNodeId) {
        let Some(center) = self.at(id) else { return };
        let radius = radius(self.view.cell).max(3.0);
        self.sign(id, center, radius);
        let ring = Rect::from_center_size(center, egui::Vec2::splat((radius * 3.0).max(12.0)));
        let stroke = Stroke::new(2.0, self.context.tokens.accent);
        self.painter.rect_stroke(ring, radius, stroke, StrokeKind::Middle);
    }

    /// A label beside a state, cut to the room there: at its right up to `limits[1]`, or at its left down to `limits[0]`
    /// where it is cut less. Answers how far it reaches to the right, or nothing where there is no room.
    fn label(&self, id: TreeNodeId, center: Pos2, radius: f32, limits: [f32; 2]) -> Option<f32> {
        let tokens = self.context.tokens;
        let is_ringed = self.tree.at_step().contains(&Some(id));
        let aside = if is_ringed {
            radius * 1.5 + 5.0
        } else if self.tree.status(id) == TreeStatus::Solution {
            // Beside the corner of its sign.
            radius * 1.35 + 4.0
        } else {
            radius + 3.0
        };
        let is_on_path = self.path.binary_search(&id).is_ok();
        let color = if is_on_path { tokens.text } else { tokens.text_muted };
        let rooms = [center.x - aside - limits[0], limits[1] - center.x - aside];
        // The arrow of a jump leaves at the left.
        let jumps = self.tree.jump.is_some() && is_ringed;
        let side_of = |width: f32| if jumps { Side::Right } else { Side::of(width, rooms) };
        if rooms[side_of(f32::INFINITY) as usize] < MIN_LABEL {
            return None;
        }
        // What says less in whole words comes before what is cut; where the step is or leads from, even that.
        let forms = self.label_forms(id);
        let whole = forms.iter().find_map(|text| {
            let galley = self.one_line(text, color, f32::INFINITY);
            let side = side_of(galley.size().x);
            (galley.size().x <= rooms[side as usize]).then_some((galley, side))
        });
        let (galley, side) = whole.or_else(|| {
            let side = side_of(f32::INFINITY);
            let room = rooms[side as usize];
            ((is_ringed || is_on_path) && room >= MIN_CUT)
                .then(|| (self.one_line(&forms[0], color, room), side))
        })?;
        let (align, x) = match side {
            Side::Left => (Align2::RIGHT_CENTER, center.x - aside),
            Side::Right => (Align2::LEFT_CENTER, center.x + aside),
        };
        let at = align.anchor_size(pos2(x, center.y), galley.size());
        self.painter.galley(at.min, galley, color);
        Some(at.right())
    }

    /// Returns what the label of a state says where there is room for all, and what it says with less room.
    fn label_forms(&self, id: TreeNodeId) -> Vec<String> {
        let choice = self.tree.trace.tree[id as usize].choice;
        let (name, short) = (self.tree.label(choice), short_label(self.tree.network, choice));
        let bound = self.bound(id).map(|bound| format!(" · {bound}")).unwrap_or_default();
        let learned = self.tree.learned(id);
        let learned = learned.map(|it| format!(" · {}", wording::never(self.tree.network, it)));
        let folded = self.is_folded(id).then(|| format!("+{}", self.tree.index.below[id as usize]));
        let below = folded.as_ref().map(|folded| format!(" {folded}")).unwrap_or_default();
        let mut forms = vec![
            format!("{name}{bound}{}{below}", learned.unwrap_or_default()),
            format!("{name}{bound}{below}"),
            format!("{short}{bound}{below}"),
            format!("{name}{below}"),
            format!("{short}{below}"),
        ];
        // How many are folded says more than which alternative it is.
        forms.extend(folded.or_else(|| shortest_label(choice)));
        forms.dedup();
        forms
    }

    /// Returns what the goals may become in a state, where the search goes by that.
    fn bound(&self, id: TreeNodeId) -> Option<String> {
        let bounded = self.tree.index.bounded(self.tree.trace, id, self.tree.step())?;
        let (Event::Bound { values } | Event::Visit { values, .. }) = bounded else { return None };
        let values: Vec<String> = values.iter().map(ToString::to_string).collect();
        Some(values.join(", "))
    }

    fn one_line(&self, text: &str, color: Color32, room: f32) -> std::sync::Arc<egui::Galley> {
        let mut job = egui::text::LayoutJob::simple_singleline(
            text.to_owned(),
            FontId::proportional(size::SMALL),
            color,
        );
        job.wrap = egui::text::TextWrapping::truncate_at_width(room);
        self.painter.layout_job(job)
    }
}

/// A name for a state that is short enough to stand beside it.
pub fn short_label(network: &Network, choice: Option<TreeChoice>) -> String {
    let condition =
        |id: tpn::LabelId| network.labels.get(id.index()).map(|it| it.text.clone()).unwrap_or_default();
    let owner = |id: tpn::LabelId| {
        let label = network.labels.get(id.index());
        let owner = label.and_then(|label| network.occurrences.get(label.owner?.index()));
        network.readable(&owner.map_or_else(|| network.label_name(id), |owner| owner.name.to_string()))
    };
    // A statement that is nothing but a condition is called by that, if that tells the two apart.
    let stated = |id: tpn::LabelId| {
        let label = network.labels.get(id.index())?;
        let owner = network.occurrences.get(label.owner?.index())?;
        (owner.kind == tpn::OccurrenceKind::Assertion).then(|| label.text.to_string())
    };
    let ordered = |order: tpn::Ordering| {
        let labels = [order.first, order.then];
        let short = labels.map(|id| stated(id).unwrap_or_else(|| owner(id)));
        if short[0] == short[1] { labels.map(owner) } else { short }
    };
    let user = |id: tpn::UseId| {
        let used = network.uses.get(id.index());
        let owner = used.and_then(|used| network.occurrences.get(used.owner?.index()));
        network.readable(&owner.map_or_else(|| network.use_name(id), |owner| owner.name.to_string()))
    };
    match choice {
        None => "start".to_owned(),
        Some(TreeChoice::Decision { decision, alternative }) => {
            format!("{}={alternative}", Network::decision_name(decision))
        }
        Some(TreeChoice::Link(link)) => format!("← {}", owner(link.tell)),
        Some(TreeChoice::Order(order)) => ordered(order).join(" ≺ "),
        Some(TreeChoice::NoLink { ask }) => format!("{} ← no support", condition(ask)),
        Some(TreeChoice::UseOrder(order)) => format!("{} ≺ {}", user(order.first), user(order.then)),
        Some(TreeChoice::Start { used, by }) => format!("{} by {by}", user(used)),
        Some(TreeChoice::Later { used, than }) => format!("{} after {than}", user(used)),
        Some(TreeChoice::Apart) => "all gaps kept".to_owned(),
        Some(TreeChoice::Departure(it)) => format!("{} → {}", owner(it.before), owner(it.movement)),
    }
}

/// The alternative alone, for states beside others of the same choice; none where it has no number.
fn shortest_label(choice: Option<TreeChoice>) -> Option<String> {
    match choice {
        Some(TreeChoice::Decision { alternative, .. }) => Some(format!("={alternative}")),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_stands_at_the_left_where_it_would_be_cut_at_the_right() {
        assert_eq!(Side::of(60.0, [200.0, 60.0]), Side::Right, "it fits");
        assert_eq!(Side::of(61.0, [200.0, 60.0]), Side::Left, "it is cut beside its sibling");
        assert_eq!(Side::of(61.0, [40.0, 60.0]), Side::Right, "less room at the left");
    }

    #[test]
    fn a_stop_of_a_lesson_takes_back_how_the_tree_was_zoomed_and_moved() {
        let room = Rect::from_min_size(Pos2::ZERO, vec2(400.0, 300.0));
        let first = View::default();
        let mut view = first;
        view.followed = Some(3);
        for _ in 0..4 {
            view.follow(ViewAction::ZoomIn, room);
        }
        view.scroll += vec2(50.0, -700.0);
        assert!(view.cell.x > 2.0 * first.cell.x && !view.fits);
        view.follow(ViewAction::FitSelection, room);
        assert_eq!((view.cell, view.scroll, view.fits), (first.cell, first.scroll, true));
        assert_eq!(view.followed, None, "the step is brought into view anew");
    }
}
