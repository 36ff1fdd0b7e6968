//! One component's state machine: modes coloured by how likely they are, commanded transitions, faults dashed.

use egui::{
    Align2, FontId, Pos2, Rect, Response, Role, Sense, Shape, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2,
};
use layout::geometry::{distance_point_curve, flatten};
use layout::look::arrow_head;
use layout::machine::MODE_HEIGHT;
use layout::{MachineArc, MachineDrawing, Piece, Point};
use num_traits::ToPrimitive as _;
use plant::{Component, ComponentId, Model};
use theme::{Tokens, strong_family};
use workbench::command::{Command, CommandSender};
use workbench::state::automaton::{AutomatonCommand, PlantMoment};

use super::components::percent;
use crate::Context;

/// A component's state machine, laid out.
pub(super) struct Machine {
    arcs: Vec<MachineArc>,
    /// What each arc means, in a sentence.
    texts: Vec<String>,
    drawing: MachineDrawing,
}

/// How things stand with a component.
pub(super) struct Standing {
    id: ComponentId,
    /// By mode, from 0 to 1.
    likelihoods: Vec<f64>,
    estimate: u8,
    truth: u8,
    /// The most likely mode a step before.
    before: Option<u8>,
    /// The mode that it will be brought into.
    pub(super) injected: Option<u8>,
}

const NAME_SIZE: f32 = 12.0;
const PERCENT_SIZE: f32 = 9.5;
/// A mode is at least so wide: it has to hold a percentage.
const LEAST_WIDTH: f32 = 46.0;
const MODE_PADDING: f32 = 9.0;
/// How far from the pointer an arc may be to be pointed at, in points.
const REACH: f64 = 5.0;
/// How much of the accent the most certain mode has in its fill.
const STRONGEST_FILL: f32 = 0.5;

impl Machine {
    /// Lays a component out.
    pub(super) fn new(ui: &Ui, component: &Component) -> Self {
        let widths: Vec<f64> = component.modes.iter().map(|mode| width(ui, &mode.name)).collect();
        let mut arcs = Vec::new();
        let mut texts = Vec::new();
        let name = |mode: u8| component.modes.get(usize::from(mode)).map_or("?", |mode| mode.name.as_str());
        for (from, mode) in component.modes.iter().enumerate() {
            for transition in &mode.transitions {
                arcs.push(MachineArc { from, to: usize::from(transition.to), is_fault: false });
                texts.push(format!("{} → {} when {}", mode.name, name(transition.to), transition.label));
            }
            for fault in &mode.faults {
                arcs.push(MachineArc { from, to: usize::from(fault.to), is_fault: true });
                let to = name(fault.to);
                texts.push(format!("{} → {to} by chance, {} per step", mode.name, fault.label));
            }
        }
        let drawing = layout::machine(&widths, &arcs);
        Self { arcs, texts, drawing }
    }

    /// Its natural width.
    pub(super) fn width(&self) -> f32 {
        self.drawing.bounds.width() as f32
    }

    /// Its natural height.
    pub(super) fn height(&self) -> f32 {
        self.drawing.bounds.height() as f32
    }

    /// Shows it in the middle of the available width, smaller if there is not enough.
    pub(super) fn show(
        &self,
        ui: &mut Ui,
        context: &Context<'_>,
        model: &Model,
        standing: &Standing,
        commands: &mut CommandSender,
    ) {
        let Some(component) = model.component(standing.id) else { return };
        let scale = (ui.available_width() / self.width().max(1.0)).min(1.0);
        let size = vec2(ui.available_width(), self.height() * scale + 2.0);
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        let placed = Placed::new(rect, &self.drawing, scale);
        self.paint_arcs(ui, context.tokens, &placed, standing);
        for (mode, shape) in (0_u8..).zip(&self.drawing.modes) {
            let rect = Rect::from_min_max(placed.screen(shape.min), placed.screen(shape.max));
            paint_mode(ui, context.tokens, rect, component, standing, mode, scale);
            let id = ui.scope_id().with(("mode", standing.id.0, mode));
            let response = ui.interact(rect, id, Sense::click());
            act(ui, context.tokens, &response, component, standing, mode, commands);
        }
        let pointed = response.hover_pos().and_then(|at| self.arc_at(&placed, at));
        if let Some(text) = pointed {
            response.on_hover_text_at_pointer(text);
        }
    }

    fn paint_arcs(&self, ui: &Ui, tokens: &Tokens, placed: &Placed, standing: &Standing) {
        let taken = standing.before.filter(|before| *before != standing.estimate);
        for (arc, shape) in self.arcs.iter().zip(&self.drawing.arcs) {
            let is_taken = taken.is_some_and(|from| {
                (arc.from, arc.to) == (usize::from(from), usize::from(standing.estimate))
            });
            let color = match (is_taken, arc.is_fault) {
                (true, true) => tokens.error,
                (true, false) => tokens.accent,
                (false, true) => tokens.warning,
                (false, false) => tokens.text_muted,
            };
            let stroke = Stroke::new(if is_taken { 2.2 } else { 1.1 }, color);
            let points: Vec<Pos2> =
                flatten(shape.start, &shape.pieces).into_iter().map(|point| placed.screen(point)).collect();
            if arc.is_fault {
                ui.painter().extend(Shape::dashed_line(&points, stroke, 3.0, 2.5));
            } else {
                ui.painter().add(Shape::line(points, stroke));
            }
            if let Some((last, others)) = shape.pieces.split_last() {
                let start = others.last().map_or(shape.start, |piece: &Piece| piece.end());
                let corners = arrow_head(last.end(), last.before_end(start)).map(|at| placed.screen(at));
                ui.painter().add(Shape::convex_polygon(corners.to_vec(), color, Stroke::NONE));
            }
        }
    }

    fn arc_at(&self, placed: &Placed, at: Pos2) -> Option<&str> {
        let at = placed.drawing(at);
        let near = self.drawing.arcs.iter().zip(&self.texts).map(|(shape, text)| {
            (distance_point_curve(at, shape.start, &shape.pieces) * f64::from(placed.scale), text)
        });
        let nearest = near.min_by(|left, right| left.0.total_cmp(&right.0))?;
        (nearest.0 <= REACH).then_some(nearest.1.as_str())
    }
}

impl Standing {
    /// Reads off how things stand with a component at the moment that is looked at.
    pub(super) fn new(context: &Context<'_>, model: &Model, plant: &PlantMoment, id: ComponentId) -> Self {
        let state = &context.state.automaton;
        let before = state.at().checked_sub(1).and_then(|at| state.moments().get(at));
        let likelihoods = plant.belief.marginal(model, id);
        Self {
            id,
            likelihoods: likelihoods.iter().map(|likelihood| likelihood.to_f64().unwrap_or(0.0)).collect(),
            estimate: plant.belief.most_likely().mode(id),
            truth: plant.true_state.mode(id),
            before: before
                .and_then(|moment| moment.plant.as_ref())
                .map(|plant| plant.belief.most_likely().mode(id)),
            injected: state.next_input().plant.injected.get(&id).copied(),
        }
    }

    /// Whether the most likely mode is the true one.
    pub(super) const fn is_right(&self) -> bool {
        self.estimate == self.truth
    }

    fn likelihood(&self, mode: u8) -> f64 {
        self.likelihoods.get(usize::from(mode)).copied().unwrap_or(0.0)
    }

    /// What is to be said of a mode, for those who hear it.
    fn describe(&self, component: &Component, mode: u8) -> String {
        let name = component.modes.get(usize::from(mode)).map_or("?", |mode| mode.name.as_str());
        let mut text = format!("{}: {name}, {}", component.name, percent(self.likelihood(mode)));
        if mode == self.estimate {
            text.push_str(", most likely");
        }
        if mode == self.truth {
            text.push_str(", true");
        }
        if self.injected == Some(mode) {
            text.push_str(", injected in this step");
        }
        text
    }
}

/// Where the drawing lies on the screen.
struct Placed {
    corner: Pos2,
    origin: Point,
    scale: f32,
}

impl Placed {
    fn new(rect: Rect, drawing: &MachineDrawing, scale: f32) -> Self {
        let left = (rect.width() - drawing.bounds.width() as f32 * scale) / 2.0;
        let corner = pos2((rect.left() + left).round() + 0.5, rect.top() + 0.5);
        Self { corner, origin: drawing.bounds.min, scale }
    }

    fn screen(&self, point: Point) -> Pos2 {
        let (x, y) = (point.x - self.origin.x, point.y - self.origin.y);
        self.corner + vec2(x as f32, y as f32) * self.scale
    }

    fn drawing(&self, at: Pos2) -> Point {
        let moved = (at - self.corner) / self.scale;
        self.origin.shifted(f64::from(moved.x), f64::from(moved.y))
    }
}

fn width(ui: &Ui, name: &str) -> f64 {
    let font = FontId::new(NAME_SIZE, strong_family());
    let text = ui.painter().layout_no_wrap(name.to_owned(), font, ui.visuals().text_color());
    f64::from((text.size().x + 2.0 * MODE_PADDING).max(LEAST_WIDTH).ceil())
}

fn paint_mode(
    ui: &Ui,
    tokens: &Tokens,
    rect: Rect,
    component: &Component,
    standing: &Standing,
    mode: u8,
    scale: f32,
) {
    let Some(data) = component.modes.get(usize::from(mode)) else { return };
    let likelihood = standing.likelihood(mode);
    let is_estimate = standing.estimate == mode;
    let painter = ui.painter();
    let corner = MODE_HEIGHT as f32 * scale / 2.0;
    let fill = tokens.surface.lerp_to_gamma(tokens.accent, STRONGEST_FILL * likelihood as f32);
    let stroke = match (standing.injected == Some(mode), is_estimate) {
        (true, _) => Stroke::new(2.0, tokens.error),
        (false, true) => Stroke::new(2.0, tokens.accent),
        (false, false) => Stroke::new(1.0, tokens.line_strong),
    };
    painter.rect(rect, corner, fill, stroke, StrokeKind::Inside);
    let color = if likelihood > 0.0 { tokens.text } else { tokens.text_muted };
    let family = if is_estimate { strong_family() } else { egui::FontFamily::Proportional };
    let font = FontId::new(NAME_SIZE * scale, family);
    let is_open = likelihood > 0.0 && likelihood < 1.0;
    let lift = if is_open { 5.0 * scale } else { 0.0 };
    painter.text(rect.center() - vec2(0.0, lift), Align2::CENTER_CENTER, &data.name, font, color);
    if is_open {
        let font = FontId::proportional(PERCENT_SIZE * scale);
        let at = rect.center() + vec2(0.0, 6.5 * scale);
        painter.text(at, Align2::CENTER_CENTER, percent(likelihood), font, color);
    }
    if standing.truth == mode {
        let color = if is_estimate { tokens.text } else { tokens.warning };
        let at = rect.right_top() + vec2(-5.0, 4.0) * scale;
        painter.circle(at, 4.0 * scale, color, Stroke::new(1.5, tokens.raised));
    }
}

/// Lets a mode be pointed at, pressed, and heard.
fn act(
    ui: &Ui,
    tokens: &Tokens,
    response: &Response,
    component: &Component,
    standing: &Standing,
    mode: u8,
    commands: &mut CommandSender,
) {
    let text = standing.describe(component, mode);
    let is_injected = standing.injected == Some(mode);
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_injected, &text));
    if response.hovered() || response.has_focus() {
        let rect = response.rect.expand(2.0);
        let stroke = Stroke::new(1.5, tokens.accent);
        ui.painter().rect_stroke(rect, rect.height() / 2.0, stroke, StrokeKind::Outside);
    }
    if response.clicked() {
        let wanted = (!is_injected).then_some(mode);
        commands.send(Command::Automaton(AutomatonCommand::Inject(standing.id, wanted)));
    }
    let hint = if is_injected { "Press to let it behave" } else { "Press to bring it here in this step" };
    response.clone().on_hover_text(format!("{text}\n{hint}"));
}
