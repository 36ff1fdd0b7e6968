//! The automaton on screen: pan, zoom, point at things, press them to select their text.

use egui::{Rect, Role, Sense, Ui, WidgetInfo};
use hca::{Automaton, CompositeKind, LocationId, LocationKind};
use layout::{AutomatonDrawing, AutomatonItem};
use text_editing::TextCommand;
use workbench::PanelKind;
use workbench::ViewAction;
use workbench::command::{Command, CommandSender};
use workbench::state::window::WindowCommand;

use super::{Drawn, Shown, legend, log, marks};
use crate::network::view::View;
use crate::painter::DisplayPainter;
use crate::{Context, counted};

/// Where the drawing is scrolled to.
#[derive(Default)]
pub(super) struct Canvas {
    view: View,
    /// What was pressed last.
    pressed: Option<AutomatonItem>,
}

/// What was pressed, and whether twice.
type Press = (AutomatonItem, bool);

const WHEEL_ZOOM: f64 = 0.0022;
const KEY_ZOOM: f64 = 1.3;
/// At less than this, guards and names of locations are smaller than 11 points: the part that matters is shown then.
const MIN_ZOOM: f64 = 11.0 / 11.5;
/// A small automaton is not blown up further than this where all of it is asked for.
const LARGEST_WHOLE: f64 = 1.3;
/// How far from the pointer something may be to be pointed at, in points.
const REACH: f64 = 6.0;
/// What the legend takes of the height, in drawing units.
const LEGEND_HEIGHT: f64 = 24.0;

impl Canvas {
    /// Shows the drawing in the rest of `ui`.
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        shown: Shown<'_>,
        drawn: &mut Drawn,
        commands: &mut CommandSender,
    ) {
        let (panel, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let name = format!(
            "Automaton. {}. Step {}, active: {}.",
            counted(shown.automaton.locations.len() as u64, "location"),
            shown.moment.upcoming.step,
            log::marked_text(shown.automaton, shown.moment)
        );
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
        self.navigate(&response, panel, &drawn.drawing, shown, context);
        let marked = marks::marked(shown.automaton, context.state.document.caret(), self.pressed);
        let painter = ui.painter_at(panel);
        DisplayPainter::new(&painter, panel, self.view.placement(panel), context.tokens)
            .paint(&[drawn.list(shown.moment, marked)], Vec::new());
        legend::legend(&painter, panel, context.tokens);
        let drawing = &drawn.drawing;
        let on_button = self.buttons(ui, panel, shown, drawing);
        let pointed = response
            .hover_pos()
            .and_then(|at| drawing.pick(self.view.drawing_point(panel, at), REACH / self.view.zoom()));
        let on_drawing = pointed.filter(|_| response.clicked()).map(|item| (item, response.double_clicked()));
        if let Some((item, is_double)) = on_button.or(on_drawing) {
            self.press(shown.automaton, item, is_double, commands);
        }
        if response.clicked() || on_button.is_some() {
            commands.send(Command::Window(WindowCommand::Activate(PanelKind::Automaton)));
        }
        if let Some(text) = pointed.and_then(|item| describe(shown.automaton, item)) {
            response.on_hover_text_at_pointer(text);
        }
    }

    fn navigate(
        &mut self,
        response: &egui::Response,
        panel: Rect,
        drawing: &AutomatonDrawing,
        shown: Shown<'_>,
        context: &Context<'_>,
    ) {
        self.view.pan(response.drag_delta());
        if let Some(pointer) = response.hover_pos() {
            let (scroll, pinch) =
                response.ctx.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            let factor = f64::from(pinch) * (f64::from(scroll) * WHEEL_ZOOM).exp();
            if factor != 1.0 {
                self.view.zoom_at(panel, pointer, factor);
            }
        }
        match context.view_action(PanelKind::Automaton) {
            None | Some(ViewAction::TopView | ViewAction::Follow | ViewAction::Tour) => {}
            Some(ViewAction::ZoomIn) => self.view.zoom_at(panel, panel.center(), KEY_ZOOM),
            Some(ViewAction::ZoomOut) => self.view.zoom_at(panel, panel.center(), 1.0 / KEY_ZOOM),
            Some(ViewAction::ZoomReset) => self.view.reset_zoom(),
            Some(ViewAction::Fit) => self.view.show(panel, with_legend(drawing.bounds), LARGEST_WHOLE),
            Some(ViewAction::FitSelection) => self.view.keep_fitted(),
        }
        if self.view.is_fitted() {
            let part = part_that_matters(shown, drawing, panel.size());
            self.view.fit_legibly(panel, with_legend(drawing.bounds), part, MIN_ZOOM);
        }
    }

    /// Selects the text of something; pressed twice, brings the text to the front.
    fn press(
        &mut self,
        automaton: &Automaton,
        item: AutomatonItem,
        is_double: bool,
        commands: &mut CommandSender,
    ) {
        let Some(span) = marks::span_of(automaton, item) else { return };
        self.pressed = Some(item);
        // From its end to its start, so that the start is scrolled to.
        let range = span.range();
        let select = TextCommand::Select { anchor: range.end, head: range.start };
        commands.send(if is_double { Command::Reveal(span) } else { Command::Text(select) });
    }

    /// Locations, guards and conditions as buttons, for pointers, keys and screen readers; answers which was pressed.
    fn buttons(
        &self,
        ui: &mut Ui,
        panel: Rect,
        shown: Shown<'_>,
        drawing: &AutomatonDrawing,
    ) -> Option<Press> {
        let automaton = shown.automaton;
        let locations = drawing.locations.iter().map(|shape| (AutomatonItem::Location(shape.id), shape.rect));
        let texts = drawing.texts.iter().map(|text| (text.owner, text.rect));
        let texts = texts.filter(|(owner, _)| !matches!(owner, AutomatonItem::Location(_)));
        let mut pressed = None;
        for (at, (item, rect)) in texts.chain(locations).enumerate() {
            let rect = self.view.screen_rect(panel, rect).intersect(panel);
            let Some(text) = describe(automaton, item).filter(|_| rect.is_positive()) else { continue };
            let is_marked = matches!(item, AutomatonItem::Location(id) if shown.moment.marking.contains(id));
            let name = match item {
                AutomatonItem::Location(id) => {
                    let label = automaton.location(id).map_or("", |location| location.label.as_str());
                    let standing = if is_marked { ", active" } else { "" };
                    format!("{}: {label}{standing}", automaton.location_name(id))
                }
                _ => text.clone(),
            };
            let response = ui.interact(rect, ui.scope_id().with(("automaton-item", at)), Sense::click());
            theme::structure::item(&response, is_marked, &name);
            if response.has_focus() {
                let stroke = egui::Stroke::new(1.5, ui.visuals().selection.stroke.color);
                ui.painter_at(panel).rect_stroke(rect.expand(3.0), 5.0, stroke, egui::StrokeKind::Outside);
            }
            if response.clicked() {
                pressed = Some((item, response.double_clicked()));
            }
            response.on_hover_text(text);
        }
        pressed
    }
}

/// Returns where the marks of a step are; where those have no room together, what is asserted there.
fn part_that_matters(
    shown: Shown<'_>,
    drawing: &AutomatonDrawing,
    room: egui::Vec2,
) -> Option<display::Rect> {
    let around = |is_such: &dyn Fn(LocationId) -> bool| {
        let shapes = drawing.locations.iter().filter(|shape| is_such(shape.id));
        shapes.map(|shape| shape.rect).reduce(display::Rect::union)
    };
    let is_marked = |id: LocationId| shown.moment.marking.contains(id);
    let asserts = |id: LocationId| {
        shown.automaton.location(id).is_some_and(|location| location.kind == LocationKind::Assert)
    };
    let marks = around(&is_marked)?;
    let fits =
        marks.width() * MIN_ZOOM <= f64::from(room.x) && marks.height() * MIN_ZOOM <= f64::from(room.y);
    if fits { Some(marks) } else { around(&|id| is_marked(id) && asserts(id)).or(Some(marks)) }
}

/// The legend is below the drawing.
fn with_legend(mut bounds: display::Rect) -> display::Rect {
    bounds.max.y += LEGEND_HEIGHT;
    bounds
}

/// Returns what something on the drawing means, in a sentence.
fn describe(automaton: &Automaton, item: AutomatonItem) -> Option<String> {
    match item {
        AutomatonItem::Location(id) => {
            let location = automaton.location(id)?;
            let meaning = match location.kind {
                LocationKind::Assert => "Active until its goal is achieved",
                LocationKind::Always => "Starts its body at every step",
                LocationKind::If => "Branches once",
                LocationKind::Unless => "Starts its body once, unless the condition is known to hold",
                LocationKind::When => "Waits for the condition, then starts its body once",
                LocationKind::Whenever => "Starts its body whenever the condition is known to hold",
                LocationKind::Wait => "Active until the time is up",
                LocationKind::At => "Starts its body at this time of the program",
                LocationKind::Lock => "Active until the lock is granted",
                LocationKind::Reward => "Counts a reward",
                LocationKind::Every => "Starts its body again and again",
            };
            Some(format!("{}: {}\n{meaning}", automaton.location_name(id), location.label))
        }
        AutomatonItem::Transition(id) => {
            let transition = automaton.transitions.get(id.0 as usize)?;
            let Some(guard) = transition.guard.and_then(|guard| automaton.guard(guard)) else {
                let is_timed = automaton.location(transition.source).is_some_and(|it| it.clock.is_some());
                let leaves = transition.target != hca::Element::Location(transition.source);
                let when =
                    if is_timed && leaves { "Fires when the time is up" } else { "Fires at every step" };
                return Some(when.to_owned());
            };
            let verb = if guard.non_entailed { "is not known to hold" } else { "is known to hold" };
            Some(format!("Fires when {} {verb}", guard.constraint))
        }
        AutomatonItem::Composite(id) => {
            let composite = automaton.composite(id)?;
            let Some(guard) = composite.maintenance.and_then(|test| automaton.guard(test)) else {
                return match composite.kind {
                    CompositeKind::Parallel => Some("These branches run in parallel".to_owned()),
                    CompositeKind::Sequence => Some("These parts run in sequence".to_owned()),
                    CompositeKind::Lock => {
                        Some("Locked while no other lock contradicts the constraint".to_owned())
                    }
                    CompositeKind::Choice => Some("Starts one of these at random".to_owned()),
                    CompositeKind::Timeout => Some("Ends its first part when the time is up".to_owned()),
                    _ => None,
                };
            };
            let verb = if guard.non_entailed { "is known to hold" } else { "is no longer known to hold" };
            Some(format!("Ends as soon as {} {verb}", guard.constraint))
        }
    }
}
