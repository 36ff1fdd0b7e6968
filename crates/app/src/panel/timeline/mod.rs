//! The timeline: activities and conditions as bars with their flexible starts and ends, and time as it plays.

pub(crate) mod bars;
mod controls;
mod paint;
mod view;

use egui::{CursorIcon, PointerButton, Rect, ScrollArea, Sense, Ui, UiBuilder};
use tpn::{Network, Plan};

use crate::command::{Command, CommandSender, ViewAction};
use crate::panel::{Context, Panel, PanelKind, show_empty};
use crate::state::Selection;

use bars::Bar;
use view::TimeView;

/// The timeline.
#[derive(Default)]
pub struct TimelinePanel {
    view: Option<TimeView>,
    /// The horizon that the view was fitted to; a view that the user has not touched follows it.
    fitted: Option<f64>,
    followed: u64,
}

/// The width of the names on the left.
const NAMES_WIDTH: f32 = 190.0;
/// The height of the axis.
const AXIS_HEIGHT: f32 = 24.0;
/// The height of a bar's row.
const ROW_HEIGHT: f32 = 24.0;

impl Panel for TimelinePanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let Some((network, plan)) = context.plan() else {
            show_empty(ui, context, "There is no plan to show over time.");
            return;
        };
        controls::show(ui, context, commands);
        let bars = bars::bars(network, plan, &context.state.settings.views.timeline);
        let horizon = bars::horizon(&bars).max(context.state.playback.end);
        let rect = ui.available_rect_before_wrap();
        let names_width = NAMES_WIDTH.min(rect.width() * 0.4);
        let axis = Rect::from_min_max(
            egui::pos2(rect.left() + names_width, rect.top()),
            egui::pos2(rect.right() - 8.0, rect.top() + AXIS_HEIGHT),
        );
        let mut view = self.view_for(axis, horizon);
        self.follow_request(context, network, plan, axis, horizon, &mut view);
        Self::scrub(ui, axis, view, commands);
        paint::axis(ui, context, axis, &view);

        let below = Rect::from_min_max(egui::pos2(rect.left(), axis.bottom()), rect.max);
        let mut lower = ui.new_child(UiBuilder::new().max_rect(below));
        ScrollArea::vertical().auto_shrink(false).show_viewport(&mut lower, |ui, viewport| {
            let size = egui::vec2(below.width(), (bars.len() as f32 * ROW_HEIGHT + 6.0).max(below.height()));
            let (area, _) = ui.allocate_exact_size(size, Sense::hover());
            let track = Rect::from_min_max(
                egui::pos2(axis.left(), area.top()),
                egui::pos2(axis.right(), area.bottom()),
            );
            self.navigate(ui, track.intersect(below), horizon, &mut view, commands);
            let first = (viewport.top() / ROW_HEIGHT).floor().max(0.0) as usize;
            let last = (viewport.bottom() / ROW_HEIGHT).ceil().max(0.0) as usize;
            let rows = first..last.min(bars.len());
            let painting = paint::Painting { context, network, view: &view, track, names_left: area.left() };
            painting.grid(ui);
            for (index, bar) in bars.iter().enumerate().take(rows.end).skip(rows.start) {
                show_bar(ui, &painting, bar, index, commands);
            }
            if context.state.settings.views.timeline.links {
                painting.links(ui, plan, &bars);
            }
            painting.now(ui);
        });
        self.view = Some(view);
        ui.advance_cursor_after_rect(rect);
    }
}

impl TimelinePanel {
    /// The view as the user left it; before that, everything.
    fn view_for(&mut self, axis: Rect, horizon: f64) -> TimeView {
        let is_untouched = self.fitted.is_some() || self.view.is_none();
        if is_untouched && axis.width() > 1.0 {
            self.fitted = Some(horizon);
            return TimeView::fit(horizon, axis.width());
        }
        self.view.unwrap_or_else(|| TimeView::fit(horizon, axis.width()))
    }

    fn follow_request(
        &mut self,
        context: &Context<'_>,
        network: &Network,
        plan: &Plan,
        axis: Rect,
        horizon: f64,
        view: &mut TimeView,
    ) {
        let Some(action) = context.view_action(PanelKind::Timeline, &mut self.followed) else { return };
        self.fitted = None;
        match action {
            ViewAction::ZoomIn => view.zoom(axis, axis.center().x, 1.4, horizon),
            ViewAction::ZoomOut => view.zoom(axis, axis.center().x, 1.0 / 1.4, horizon),
            ViewAction::TopView | ViewAction::Follow => {}
            ViewAction::ZoomReset | ViewAction::Fit => {
                self.fitted = Some(horizon);
                *view = TimeView::fit(horizon, axis.width());
            }
            ViewAction::FitSelection => {
                let selected = context.state.selection.occurrence(network);
                let occurrence = selected.and_then(|id| network.occurrences.get(id.index()));
                let window = |node: tpn::NodeId| plan.windows.get(node.index()).copied().flatten();
                if let Some((start, end)) = occurrence.and_then(|it| window(it.start).zip(window(it.end))) {
                    let from = crate::state::playback::number(start.earliest);
                    let to = crate::state::playback::bound(end.latest).min(horizon);
                    *view = TimeView::range(from, to, axis.width());
                }
            }
        }
    }

    /// Dragging along the axis moves the time.
    fn scrub(ui: &Ui, axis: Rect, view: TimeView, commands: &mut CommandSender) {
        let response = ui.interact(axis, ui.scope_id().with("axis"), Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, "Time axis"));
        if let Some(pointer) = response.interact_pointer_pos()
            && response.is_pointer_button_down_on()
        {
            commands.send(Command::Seek(view.time(axis, pointer.x)));
        }
        response.on_hover_cursor(CursorIcon::ResizeHorizontal);
    }

    /// Wheel and drags on the empty track move and scale time.
    fn navigate(
        &mut self,
        ui: &Ui,
        track: Rect,
        horizon: f64,
        view: &mut TimeView,
        commands: &mut CommandSender,
    ) {
        let response = ui.interact(track, ui.scope_id().with("track"), Sense::click_and_drag());
        if response.dragged_by(PointerButton::Primary) || response.dragged_by(PointerButton::Middle) {
            self.fitted = None;
            view.pan(response.drag_delta().x);
        }
        if response.clicked() {
            commands.send(Command::Select(Selection::None));
        }
        if response.double_clicked() {
            commands.send(Command::ViewOf(PanelKind::Timeline, ViewAction::Fit));
        }
        let Some(pointer) = ui.ctx().pointer_hover_pos().filter(|&at| track.contains(at)) else { return };
        if !response.contains_pointer() && !ui.rect_contains_pointer(track) {
            return;
        }
        let (zoom, scroll, shift) =
            ui.input(|input| (input.zoom_delta(), input.smooth_scroll_delta(), input.modifiers.shift));
        if (zoom - 1.0).abs() > f32::EPSILON {
            self.fitted = None;
            view.zoom(track, pointer.x, f64::from(zoom), horizon);
        }
        let sideways = if shift && scroll.x == 0.0 { scroll.y } else { scroll.x };
        if sideways != 0.0 {
            self.fitted = None;
            view.pan(sideways);
        }
    }
}

fn show_bar(ui: &Ui, painting: &paint::Painting<'_>, bar: &Bar, index: usize, commands: &mut CommandSender) {
    let context = painting.context;
    let row = painting.row(index);
    let selection = Selection::Occurrence(bar.occurrence);
    let is_selected = context.state.selection.involves(painting.network, bar.occurrence);
    let response = ui.interact(row, ui.scope_id().with(("bar", bar.occurrence.0)), Sense::click());
    response.widget_info(|| {
        let name = format!("{}: {}", bar.name, bar.words);
        egui::WidgetInfo::selected(egui::Role::Button, true, is_selected, name)
    });
    let is_hovered = response.hovered() || context.state.hovered == selection;
    painting.bar(ui, bar, row, is_selected, is_hovered);
    if response.hovered() && context.state.hovered != selection {
        commands.send(Command::Hover(selection.clone()));
    }
    if response.clicked() {
        commands.send(Command::Select(selection.clone()));
    }
    if response.double_clicked() {
        commands.send(Command::SelectAndReveal(selection));
    }
    response.on_hover_ui_at_pointer(|ui| {
        ui.label(crate::theme::strong(&bar.name));
        ui.label(&bar.words);
        for &label in bar.asks.iter().chain(&bar.tells) {
            if let Some(label) = painting.network.labels.get(label.index()) {
                let verb = if label.mode == rmpl::program::LabelMode::Ask { "requires" } else { "asserts" };
                ui.label(format!("{verb} {}", label.text));
            }
        }
    });
}
