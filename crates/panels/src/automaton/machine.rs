//! One component's state machine: modes colored by how likely they are, commanded transitions, faults dashed.

use display::DisplayList;
use display::geometry::distance_point_curve;
use egui::{FontId, Pos2, Rect, Response, Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2};
use layout::list::machine::{ModeState, NAME_SIZE, machine_list};
use layout::{MachineArc, MachineDrawing};
use plant::{Component, ComponentId, Interval, Model};
use theme::{Tokens, strong_family};
use workbench::command::{Command, CommandSender};
use workbench::state::automaton::{AutomatonCommand, PlantMoment};

use super::components::percent_between;
use crate::Context;
use crate::painter::{DisplayPainter, Placement};

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
    /// For each mode, in the order of declaration.
    likelihoods: Vec<Interval>,
    estimate: u8,
    truth: u8,
    /// The most likely mode a step before.
    before: Option<u8>,
    /// The mode that it will be brought into.
    pub(super) injected: Option<u8>,
}

/// A mode is at least so wide: it has to hold a percentage.
const MIN_WIDTH: f32 = 46.0;
const MODE_PADDING: f32 = 9.0;
/// How far from the pointer an arc may be to be pointed at, in points.
const REACH: f64 = 5.0;

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
                let probability = transition.probability.as_ref();
                let probability =
                    probability.map_or_else(String::new, |given| format!(", probability {given}"));
                texts.push(format!(
                    "{} → {} when {}{probability}",
                    mode.name,
                    name(transition.to),
                    transition.label
                ));
            }
            for fault in &mode.faults {
                arcs.push(MachineArc { from, to: usize::from(fault.to), is_fault: true });
                let to = name(fault.to);
                let condition = fault.condition.as_ref();
                let condition = condition.map_or_else(String::new, |guard| format!(" when {guard}"));
                texts
                    .push(format!("{} → {to}: random fault, {} per step{condition}", mode.name, fault.label));
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
        let placed = placement(rect, &self.drawing, scale);
        DisplayPainter::new(ui.painter(), ui.clip_rect(), placed, context.tokens)
            .paint(&[&self.list(component, standing)], Vec::new());
        for (mode, shape) in (0..=u8::MAX).zip(&self.drawing.modes) {
            let rect = placed.screen_rect(*shape);
            let id = ui.scope_id().with(("mode", standing.id.0, mode));
            let response = ui.interact(rect, id, Sense::click());
            act(ui, context.tokens, &response, component, standing, mode, commands);
        }
        let pointed = response.hover_pos().and_then(|at| self.arc_at(&placed, at));
        if let Some(text) = pointed {
            response.on_hover_text_at_pointer(text);
        }
    }

    /// The display list of the machine as things stand.
    fn list(&self, component: &Component, standing: &Standing) -> DisplayList {
        let modes: Vec<ModeState> = (0..=u8::MAX)
            .zip(&component.modes)
            .map(|(mode, data)| ModeState {
                name: data.name.as_str().into(),
                likelihood: standing.likelihood(mode),
                percent: standing.percent(mode, 0).into(),
                is_estimate: standing.estimate == mode,
                is_true: standing.truth == mode,
                is_injected: standing.injected == Some(mode),
            })
            .collect();
        let taken = standing.before.filter(|before| *before != standing.estimate);
        let taken = taken.map(|from| (usize::from(from), usize::from(standing.estimate)));
        machine_list(&self.drawing, &self.arcs, &modes, taken)
    }

    fn arc_at(&self, placed: &Placement, at: Pos2) -> Option<&str> {
        let at = placed.drawing_point(at);
        let near =
            self.drawing.arcs.iter().zip(&self.texts).map(|(shape, text)| {
                (distance_point_curve(at, shape.start, &shape.pieces) * placed.zoom, text)
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
        Self {
            id,
            likelihoods: plant.belief.marginal(model, id),
            estimate: plant.belief.most_likely().mode(id),
            truth: plant.true_state.mode(id),
            before: before
                .and_then(|moment| moment.plant.as_ref())
                .map(|plant| plant.belief.most_likely().mode(id)),
            injected: state.next_input().plant.injected.get(&id).copied(),
        }
    }

    /// Returns whether the most likely mode is the true one.
    pub(super) const fn is_right(&self) -> bool {
        self.estimate == self.truth
    }

    /// The least that a mode's probability is.
    fn likelihood(&self, mode: u8) -> f64 {
        self.likelihoods.get(usize::from(mode)).map_or(0.0, |likelihood| likelihood.to_f64().0)
    }

    fn percent(&self, mode: u8, most_decimals: u32) -> String {
        let likelihood = self.likelihoods.get(usize::from(mode));
        likelihood.map_or_else(String::new, |likelihood| percent_between(likelihood, most_decimals))
    }

    /// Returns what is to be said of a mode, for those who hear it.
    fn describe(&self, component: &Component, mode: u8) -> String {
        let name = component.modes.get(usize::from(mode)).map_or("?", |mode| mode.name.as_str());
        let mut text = format!("{}: {name}, {}", component.name, self.percent(mode, 2));
        if mode == self.estimate {
            text.push_str(", most likely");
        }
        if mode == self.truth {
            text.push_str(", true mode");
        }
        if self.injected == Some(mode) {
            text.push_str(", injected in this step");
        }
        text
    }
}

/// Returns where the drawing lies in `rect`: in its middle.
fn placement(rect: Rect, drawing: &MachineDrawing, scale: f32) -> Placement {
    let left = (rect.width() - drawing.bounds.width() as f32 * scale) / 2.0;
    let at = pos2((rect.left() + left).round() + 0.5, rect.top() + 0.5);
    Placement { point: drawing.bounds.min, at, zoom: f64::from(scale) }
}

fn width(ui: &Ui, name: &str) -> f64 {
    let font = FontId::new(NAME_SIZE as f32, strong_family());
    let text = ui.painter().layout_no_wrap(name.to_owned(), font, ui.visuals().text_color());
    f64::from((text.size().x + 2.0 * MODE_PADDING).max(MIN_WIDTH).ceil())
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
    let hint = if is_injected { "Click to clear the fault" } else { "Click to force this mode in this step" };
    response.clone().on_hover_text(format!("{text}\n{hint}"));
}
