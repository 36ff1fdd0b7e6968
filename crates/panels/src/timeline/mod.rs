//! The timeline: activities and conditions as bars at the times for which they are scheduled, and time as it plays.
//!
//! Which bars there are and in which rows is prepared once for a plan; what is in view of them is a display list. `handle`
//! drags events inside their windows, `bounds` drags bounds in the text.

mod bar;
mod bounds;
pub(crate) mod controls;
mod handle;
mod link;
mod overview;
mod paint;
mod past;
mod profile;
mod rule;
mod turn;
mod view;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use egui::{
    Color32, CursorIcon, FontId, PointerButton, Rect, Response, ScrollArea, Sense, Ui, UiBuilder, WidgetInfo,
    pos2, vec2,
};
use layout::list::timeline::{LinkCurve, Standing, TimelineState, legend_list, timeline_list};
use layout::timeline::before::Before;
use layout::timeline::{Bar, Chart, RowKind, state, times};
use review::Review;
use smol_str::SmolStr;
use snapshot::Snapshot;
use tpn::{LabelId, Network, Plan};
use workbench::PanelKind;
use workbench::ViewAction;
use workbench::command::{Command, CommandSender};
use workbench::state::settings::TimelineView;
use workbench::state::window::WindowCommand;
use workbench::state::{Selection, Status};
use workbench::time_text;
use workbench::workspace::Workspace;

use self::bounds::BoundDrag;
use self::handle::Pinned;
use self::overview::Silhouette;
use self::paint::{LEGEND_HEIGHT, Painting, ROW_HEIGHT};
use self::view::TimeView;
use crate::carry::{self, Carried};
use crate::{Context, Panel, draw_menu, show_empty};

pub(crate) use self::paint::drawn;

pub struct TimelinePanel {
    view: Option<TimeView>,
    /// Whether the view keeps showing everything; ends when the user moves it.
    is_fitted: bool,
    prepared: Option<Prepared>,
    /// Keys of the rows that are closed.
    closed: BTreeSet<SmolStr>,
    names_width: f32,
    /// The selection that was last brought into view.
    followed_selection: Selection,
    bound_drag: Option<BoundDrag>,
    drags: u64,
    /// Where a range of times that is being selected began.
    range_from: Option<f64>,
}

/// A chart and what it was made of.
struct Prepared {
    snapshot: Arc<Snapshot>,
    /// What the search had selected at the step that was looked at.
    step: Option<Arc<Plan>>,
    view: TimelineView,
    closed: BTreeSet<SmolStr>,
    /// The pinned events that its rows were made for, and those that its bars show.
    pins: [u64; 2],
    /// The review whose rules are drawn.
    review: Option<Arc<Review>>,
    /// The approval whose plan is laid over it.
    approved: Option<String>,
    chart: Chart,
    silhouette: Silhouette,
}

/// The height of the axis.
const AXIS_HEIGHT: f32 = 24.0;
/// The width of the names, at first and at least.
const NAMES_WIDTH: (f32, f32) = (150.0, 60.0);
/// How much more than all that is scheduled the timeline shows at first.
const SHOWN_BEYOND: f64 = 1.08;
/// A bar can be pointed at in at least this width.
const MIN_TARGET: f32 = 6.0;
/// A bar that is narrower than this has handles only while it stands out, or while few bars are in view.
const MIN_HANDLED: f32 = 12.0;
/// With more bars in view than this, they are not few.
const MAX_FEW_BARS: usize = 150;
/// The room of a name in its bar beyond the name itself, and that from the bar to a name beside it.
const NAME_MARGIN: f32 = 8.0;
/// A timeline with less height than this has no legend.
const MIN_HEIGHT: f32 = 150.0;

impl Default for TimelinePanel {
    fn default() -> Self {
        Self {
            view: None,
            is_fitted: true,
            prepared: None,
            closed: BTreeSet::new(),
            names_width: NAMES_WIDTH.0,
            followed_selection: Selection::None,
            bound_drag: None,
            drags: 0,
            range_from: None,
        }
    }
}

impl Panel for TimelinePanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let (Some(snapshot), Some((network, plan))) = (context.snapshot, context.plan()) else {
            let area = ui.available_rect_before_wrap();
            let text = match context.state.status() {
                Status::Broken | Status::Empty => crate::empty::missing(context, "its timeline appears here"),
                _ => "No plan to show. The Plan panel explains why.".to_owned(),
            };
            show_empty(ui, context, &text);
            carry::over_timeline(ui, context, area, Vec::new, commands);
            return;
        };
        self.prepare(context, snapshot, network, plan);
        let Some(prepared) = self.prepared.take() else { return };
        controls::show(ui, context, network, commands);
        self.show_chart(ui, context, (network, plan), &prepared, commands);
        self.prepared = Some(prepared);
    }
}

impl TimelinePanel {
    /// Makes the chart again where something that it is made of has changed.
    fn prepare(&mut self, context: &Context<'_>, snapshot: &Arc<Snapshot>, network: &Network, plan: &Plan) {
        let state = context.state;
        let (view, step) =
            (&state.settings.views.timeline, context.step().map(|step| Arc::clone(&step.plan)));
        let pins = state.pins.version();
        // What a step of the search shows is not what was reviewed.
        let review = state.review.current().filter(|_| step.is_none()).cloned();
        let is_reviewing = state.window.workspace == Workspace::Review && view.approved;
        let approval = state.review.record().last_approval().filter(|_| is_reviewing);
        let approved = approval.map(|(entry, _)| entry.digest().to_owned());
        let is_current = self.prepared.as_ref().is_some_and(|it| {
            let same_step = match (&it.step, &step) {
                (Some(one), Some(other)) => Arc::ptr_eq(one, other),
                (None, None) => true,
                _ => false,
            };
            let same_review = match (&it.review, &review) {
                (Some(one), Some(other)) => Arc::ptr_eq(one, other),
                (None, None) => true,
                _ => false,
            };
            // While an event is dragged, rows stay as they are.
            let same_rows = state.pins.held().is_some() || it.pins[0] == pins;
            it.snapshot.shows_same(snapshot)
                && same_rows
                && same_step
                && same_review
                && it.approved == approved
                && it.view == *view
                && it.closed == self.closed
        });
        if !is_current {
            let run = state.run_shown().filter(|_| step.is_none());
            let past = run.map(|run| past::of_run(run, state.playback.time)).unwrap_or_default();
            let mut chart = Chart::new(&snapshot.program, (network, plan), &past, view.chart(), &self.closed);
            // Pinned events only narrow windows.
            chart.compare_with_free(if step.is_none() { snapshot.plan().unwrap_or(plan) } else { plan });
            let before =
                review.as_ref().filter(|_| approved.is_some()).and_then(|_| state.review.approved_times());
            let planned = run.filter(|_| view.planned).and_then(|run| run.plans.first());
            let before = before.or_else(|| planned.map(|first| Before::planned(&first.network, &first.plan)));
            if let Some(before) = before {
                chart.compare_with(&before, network, plan);
            }
            if review.is_some() {
                chart.add_rules(state.review.rule_tracks(), &self.closed);
            }
            let silhouette = Silhouette::new(&chart);
            let (snapshot, closed, view) = (Arc::clone(snapshot), self.closed.clone(), view.clone());
            let pins = [pins; 2];
            self.prepared =
                Some(Prepared { snapshot, step, view, closed, pins, review, approved, chart, silhouette });
        } else if let Some(prepared) = self.prepared.as_mut().filter(|it| it.pins[1] != pins) {
            prepared.chart.retime(plan);
            prepared.pins[1] = pins;
        }
    }

    fn show_chart(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        (network, plan): (&Network, &Plan),
        Prepared { chart, silhouette, .. }: &Prepared,
        commands: &mut CommandSender,
    ) {
        let horizon = chart.horizon.max(context.state.playback.end);
        // What is scheduled fills the width; how late all of it can be is often far beyond.
        let shown_end = (chart.end.max(context.state.playback.end) * SHOWN_BEYOND).min(horizon);
        let all = ui.available_rect_before_wrap();
        let has_legend = all.height() >= MIN_HEIGHT;
        let whole = if has_legend { all.with_max_y(all.bottom() - LEGEND_HEIGHT) } else { all };
        let all_rows = chart.rows.len() as f32 * ROW_HEIGHT + 8.0;
        let column = overview::place(whole, whole.top() + AXIS_HEIGHT, all_rows);
        let rect = column.map_or(whole, |column| whole.with_max_x(column.left() - 4.0));
        let names_width = self.names_width.min(rect.width() * 0.4);
        let axis = Rect::from_min_max(
            pos2(rect.left() + names_width, rect.top()),
            pos2(rect.right() - 8.0, rect.top() + AXIS_HEIGHT),
        );
        let mut view = self.view_for(axis, shown_end);
        self.follow_request(context, (network, plan), axis, (horizon, shown_end), &mut view);
        self.follow_axis(ui, axis, view, (context.state.playback.time, horizon), commands);
        let unit = context.snapshot.map_or("", |it| time_text::unit(it.program.options.time_unit));
        paint::axis(ui, context, axis, &view, (unit, rect.left()));

        let below = Rect::from_min_max(pos2(rect.left(), axis.bottom()), rect.max);
        let mut lower = ui.new_child(UiBuilder::new().max_rect(below));
        let mut scroll = ScrollArea::vertical().auto_shrink(false);
        let seen = below.height() / all_rows;
        if let Some(from) = column.and_then(|column| overview::follow(ui, column, seen)) {
            scroll = scroll.vertical_scroll_offset(from * all_rows);
        }
        let scrolled = scroll.show_viewport(&mut lower, |ui, viewport| {
            let height = all_rows.max(below.height());
            let (area, _) = ui.allocate_exact_size(vec2(below.width(), height), Sense::hover());
            let track = Rect::from_min_max(pos2(axis.left(), area.top()), pos2(axis.right(), area.bottom()));
            let visible = track.intersect(below);
            let place = paint::place(&view, track, visible, area.left());
            let painting = Painting { context, network, chart, view: &view, track, visible, place };
            let mut links = place.links(chart);
            if !context.state.settings.views.timeline.links {
                links.retain(|curve| link::is_chosen(&painting, curve.link));
            }
            let mut moved = view;
            self.navigate(ui, &painting, horizon, &links, &mut moved, commands);
            let first = (viewport.top() / ROW_HEIGHT).floor().max(0.0) as usize;
            let last = ((viewport.bottom() / ROW_HEIGHT).ceil().max(0.0) as usize).min(chart.rows.len());
            self.show_rows(ui, &painting, plan, first..last, &links, commands);
            self.follow_selection(ui, &painting, &mut moved);
            carry::over_timeline(ui, context, below, || lanes(&painting), commands);
            view = moved;
        });
        if let Some(column) = column {
            let part = (scrolled.state.unclamped_offset().y / all_rows, seen);
            overview::paint(ui, context, column, silhouette, part, (&view, axis, chart.horizon));
        }
        turn::show(ui, context, (axis, &view), below.bottom(), commands);
        self.show_divider(ui, rect, axis.left());
        if has_legend {
            let place = Rect::from_min_max(
                pos2(all.left() + 8.0, whole.bottom()),
                pos2(all.right() - 8.0, all.bottom()),
            );
            show_legend(ui, context, chart, place);
        }
        self.view = Some(view);
        ui.advance_cursor_after_rect(all);
    }

    fn show_rows(
        &mut self,
        ui: &Ui,
        painting: &Painting<'_>,
        plan: &Plan,
        rows: std::ops::Range<usize>,
        links: &[LinkCurve<'_>],
        commands: &mut CommandSender,
    ) {
        let state = painting.context.state;
        let pinned: Pinned = state.pins.all().into_iter().collect();
        let (mut of_rows, mut of_bars) = (Vec::new(), BTreeMap::new());
        let mut handles = Vec::new();
        let mut chosen = None;
        for index in rows.clone() {
            let shown = &painting.chart.rows[index];
            let bars = shown.bars.clone().map(|at| (at, &painting.chart.bars[at]));
            let is_row_selected = shown.kind == RowKind::Single
                && bars.clone().any(|(_, bar)| is_chosen(bar, &state.selection, painting.network));
            if let RowKind::Rule(rule) = shown.kind {
                rule::show(ui, painting, index, rule);
            }
            if let RowKind::Profile(part) = shown.kind {
                profile::show(ui, painting, index, part);
            }
            let is_row_hovered = self.show_row(ui, painting, plan, index, is_row_selected, commands);
            of_rows.push(Standing { is_selected: is_row_selected, is_hovered: is_row_hovered });
            let mut painted_to = f32::MIN;
            for (at, bar) in bars {
                let place = painting.bar_rect(bar, index);
                // Bars that fall onto the same point of the screen are drawn once.
                let is_seen = place.intersects(painting.visible.expand2(vec2(4.0, 40.0)));
                let is_merged =
                    !bar.kind.is_of_state() && place.width() < 1.0 && place.right() < painted_to + 1.0;
                if !is_seen || is_merged {
                    continue;
                }
                painted_to = painted_to.max(place.right());
                let is_selected = is_chosen(bar, &state.selection, painting.network);
                let is_single = shown.kind == RowKind::Single && !shown.is_closed;
                let is_hovered = if is_single {
                    is_row_hovered
                } else {
                    show_bar(ui, painting, plan, (index, at), is_selected, commands)
                };
                of_bars.insert(at, Standing { is_selected, is_hovered });
                // What a variable keeps begins and ends with the activities that change it, which have bars of their own.
                if bar.kind.is_of_state() || bar.kind.is_past() {
                    continue;
                }
                let is_prominent = is_selected || is_hovered;
                let is_pinned = bar.events.iter().any(|event| pinned.contains_key(event));
                let is_wide = is_single || place.width() >= MIN_HANDLED;
                handles.push((index, bar, is_prominent, is_prominent || is_pinned || is_wide));
                if is_selected && chosen.is_none() {
                    chosen = Some((index, bar));
                }
            }
        }
        let links: Vec<_> =
            links.iter().map(|curve| (*curve, link::is_chosen(painting, curve.link))).collect();
        let first = rows.start;
        let shown = TimelineState {
            now: Some(state.playback.time),
            is_executing: state.is_executing(),
            range: state.time_range,
            row: &|index| of_rows.get(index - first).copied().unwrap_or_default(),
            bar: &|at| of_bars.get(&at).copied().unwrap_or_default(),
            links: &links,
            note: None,
        };
        let list =
            timeline_list(painting.chart, (painting.network, plan), &painting.place, rows.clone(), &shown);
        paint::show(ui, painting.context, &list);
        rows.for_each(|index| painting.sign(ui, index));
        // Handles come last, so that they are over the bars that they belong to.
        let are_few = handles.len() <= MAX_FEW_BARS;
        for (index, bar, is_prominent, _) in handles.into_iter().filter(|it| are_few || it.3) {
            handle::show(ui, painting, &pinned, (index, bar), is_prominent, commands);
        }
        match chosen {
            Some(chosen) => {
                bounds::show(ui, painting, chosen, &mut self.bound_drag, &mut self.drags, commands);
                show_connector(ui, painting, chosen);
            }
            None => self.bound_drag = None,
        }
        handle::show_held(ui, painting, &pinned);
    }

    /// A row as something to click; opens and closes it where it has others below. Returns whether it is pointed at.
    fn show_row(
        &mut self,
        ui: &Ui,
        painting: &Painting<'_>,
        plan: &Plan,
        index: usize,
        is_selected: bool,
        commands: &mut CommandSender,
    ) -> bool {
        let shown = &painting.chart.rows[index];
        let row = painting.row(index);
        let bar = painting.chart.bars.get(shown.bars.clone()).and_then(<[Bar]>::first);
        let mut is_hovered = false;
        if let (RowKind::Single, Some(bar)) = (shown.kind, bar) {
            let id = ui.scope_id().with(("row", index));
            let response = ui.interact(row, id, sense(is_selected));
            is_hovered = respond(ui, &response, painting, plan, (index, bar), is_selected, commands);
        }
        let Some(key) = &shown.key else { return is_hovered };
        let area = match shown.kind {
            RowKind::Single => painting.sign_rect(index),
            _ => Rect::from_min_max(row.min, pos2(painting.track.left(), row.bottom())),
        };
        let response = ui.interact(area, ui.scope_id().with(("open", key)), Sense::click());
        response.widget_info(|| {
            let act = if shown.is_closed { "Expand" } else { "Collapse" };
            WidgetInfo::labeled(egui::Role::Button, true, format!("{act} {} on the timeline", shown.name))
        });
        if response.clicked() && !self.closed.remove(key) {
            self.closed.insert(key.clone());
        }
        is_hovered || response.hovered()
    }

    /// The view as the user left it; before that, all that is scheduled.
    fn view_for(&mut self, axis: Rect, shown_end: f64) -> TimeView {
        match self.view {
            Some(view) if !self.is_fitted => view,
            _ => TimeView::fit(shown_end, axis.width()),
        }
    }

    fn follow_request(
        &mut self,
        context: &Context<'_>,
        (network, plan): (&Network, &Plan),
        axis: Rect,
        (horizon, shown_end): (f64, f64),
        view: &mut TimeView,
    ) {
        let Some(action) = context.view_action(PanelKind::Timeline) else { return };
        self.is_fitted = false;
        match action {
            ViewAction::ZoomIn => view.zoom(axis, axis.center().x, 1.4, horizon),
            ViewAction::ZoomOut => view.zoom(axis, axis.center().x, 1.0 / 1.4, horizon),
            ViewAction::TopView | ViewAction::Follow | ViewAction::Tour => {}
            ViewAction::ZoomReset | ViewAction::Fit => {
                self.is_fitted = true;
                *view = TimeView::fit(shown_end, axis.width());
            }
            ViewAction::FitSelection => {
                let selected = context.state.selection.occurrence(network);
                let occurrence = selected.and_then(|id| network.occurrences.get(id.index()));
                let times = occurrence.and_then(|it| times(plan, [it.start, it.end]));
                let range = times.map(|[start, end]| [start[0], end[1].min(horizon)]);
                if let Some([from, to]) = context.state.time_range.or(range) {
                    *view = TimeView::range(from, to, axis.width());
                }
            }
        }
    }

    /// Dragging along the axis moves the time; with Shift it selects a range.
    fn follow_axis(
        &mut self,
        ui: &Ui,
        axis: Rect,
        view: TimeView,
        (time, horizon): (f64, f64),
        commands: &mut CommandSender,
    ) {
        let response = ui.interact(axis, ui.scope_id().with("axis"), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Slider, true, "Time axis"));
        ui.ctx().accesskit_node_builder(response.id, |node| {
            node.set_numeric_value(time);
            node.set_min_numeric_value(0.0);
            node.set_max_numeric_value(horizon);
        });
        if !self.select_range(ui, &response, axis, view, commands)
            && let Some(pointer) = response.interact_pointer_pos()
            && crate::is_pressed(&response)
        {
            commands.send(Command::Seek(view.time(axis, pointer.x)));
        }
        response.on_hover_cursor(CursorIcon::ResizeHorizontal);
    }

    /// Selects a range of times by a drag with Shift. Returns whether that is going on.
    fn select_range(
        &mut self,
        ui: &Ui,
        response: &Response,
        area: Rect,
        view: TimeView,
        commands: &mut CommandSender,
    ) -> bool {
        let Some(pointer) = response.interact_pointer_pos() else { return false };
        let (has_shift, origin) = ui.input(|input| (input.modifiers.shift, input.pointer.press_origin()));
        if response.drag_started_by(PointerButton::Primary) {
            let begun = origin.unwrap_or(pointer);
            self.range_from = has_shift.then(|| view.time(area, begun.x));
        }
        let Some(from) = self.range_from.filter(|_| response.dragged() || response.drag_stopped()) else {
            return has_shift;
        };
        let round = |time: f64| workbench::state::playback::number(handle::round_time(&view, time)).max(0.0);
        let range = [round(from), round(view.time(area, pointer.x))];
        commands.send(Command::SelectTimes((range[0] != range[1]).then_some(range)));
        if response.drag_stopped() {
            self.range_from = None;
        }
        true
    }

    /// Wheel and drags on the empty track move and scale time.
    fn navigate(
        &mut self,
        ui: &Ui,
        painting: &Painting<'_>,
        horizon: f64,
        links: &[LinkCurve<'_>],
        view: &mut TimeView,
        commands: &mut CommandSender,
    ) {
        let track = painting.visible;
        let response = ui.interact(track, ui.scope_id().with("track"), Sense::click_and_drag());
        let is_selecting = self.select_range(ui, &response, painting.track, *view, commands);
        let is_dragged =
            response.dragged_by(PointerButton::Primary) || response.dragged_by(PointerButton::Middle);
        if is_dragged && !is_selecting {
            self.is_fitted &= response.drag_delta().x == 0.0;
            view.pan(response.drag_delta().x);
            ui.scroll_with_delta(vec2(0.0, response.drag_delta().y));
        }
        let pointed = response.hover_pos().and_then(|at| link::at(links, at));
        if response.clicked() {
            let selection =
                pointed.map_or(Selection::None, |link| link::selection(link.kind, painting.network));
            commands.send(Command::Select(selection));
        }
        if response.secondary_clicked() {
            commands.send(Command::Select(Selection::None));
        }
        draw_menu::activities(&response, painting.context, commands);
        if response.double_clicked() {
            commands.send(Command::Window(WindowCommand::ViewOf(PanelKind::Timeline, ViewAction::Fit)));
        }
        if let Some(pointed) = pointed {
            let name = link::name(pointed.kind, painting.network);
            response.on_hover_cursor(CursorIcon::PointingHand).on_hover_text_at_pointer(name);
        }
        let pointer =
            ui.ctx().pointer_hover_pos().filter(|&at| track.contains(at) && ui.rect_contains_pointer(track));
        let Some(pointer) = pointer else { return };
        let (zoom, scroll, shift) =
            ui.input(|input| (input.zoom_delta(), input.smooth_scroll_delta(), input.modifiers.shift));
        if (zoom - 1.0).abs() > f32::EPSILON {
            self.is_fitted = false;
            view.zoom(painting.track, pointer.x, f64::from(zoom), horizon);
        }
        let sideways = if shift && scroll.x == 0.0 { scroll.y } else { scroll.x };
        if sideways != 0.0 {
            self.is_fitted = false;
            view.pan(sideways);
        }
    }

    /// Scrolls to the bar of a new selection, and to its time where not everything is shown.
    fn follow_selection(&mut self, ui: &Ui, painting: &Painting<'_>, view: &mut TimeView) {
        let selection = &*painting.context.state.selection;
        if *selection == self.followed_selection {
            return;
        }
        self.followed_selection = selection.clone();
        let rows = painting.chart.rows.iter().enumerate();
        let of_row = rows.flat_map(|(row, shown)| shown.bars.clone().map(move |at| (row, at)));
        let chosen: Vec<Rect> = of_row
            .map(|(row, at)| (row, &painting.chart.bars[at]))
            .filter(|(_, bar)| is_chosen(bar, selection, painting.network))
            .map(|(row, bar)| painting.bar_rect(bar, row))
            .collect();
        let is_seen = |bar: &Rect| painting.visible.expand(1.0).intersects(*bar);
        let Some(first) = chosen.first().filter(|_| !chosen.iter().any(is_seen)) else { return };
        if !painting.visible.y_range().intersects(first.y_range()) {
            ui.scroll_to_rect(*first, Some(egui::Align::Center));
        }
        if !self.is_fitted && !painting.visible.x_range().intersects(first.x_range()) {
            view.pan(painting.visible.center().x - first.left());
        }
    }

    /// The line between names and bars, which can be dragged.
    fn show_divider(&mut self, ui: &Ui, rect: Rect, x: f32) {
        let area = Rect::from_center_size(pos2(x, rect.center().y), vec2(6.0, rect.height()));
        let response = ui.interact(area, ui.scope_id().with("divider"), Sense::drag());
        if response.dragged()
            && let Some(pointer) = response.interact_pointer_pos()
        {
            self.names_width = (pointer.x - rect.left()).clamp(NAMES_WIDTH.1, rect.width() * 0.4);
        }
        if response.hovered() || response.dragged() {
            let stroke = egui::Stroke::new(2.0, ui.visuals().selection.stroke.color);
            ui.painter().vline(x, rect.y_range(), stroke);
        }
        response.on_hover_cursor(CursorIcon::ResizeColumn);
    }
}

/// The rows of each lane that is named after a vehicle, with the vehicle's name.
fn lanes(painting: &Painting<'_>) -> Vec<(SmolStr, Rect)> {
    let vehicles = painting.context.snapshot.map_or(&[][..], |it| &it.program.world.vehicles);
    let rows = &painting.chart.rows;
    let mut found = Vec::new();
    for head in rows.iter().filter(|row| row.key.is_some()) {
        let Some(vehicle) = vehicles.iter().find(|it| it.name.text == head.name) else { continue };
        let own = rows.iter().enumerate().filter(|(_, row)| row.lane == head.lane);
        found.extend(own.map(|(index, _)| (vehicle.name.text.clone(), painting.row(index))));
    }
    found
}

/// What colors and lines mean, in one line.
fn show_legend(ui: &Ui, context: &Context<'_>, chart: &Chart, place: Rect) {
    paint::show(ui, context, &legend_list(chart, paint::drawn(place)));
    if chart.legend.is_empty() {
        return;
    }
    let words = |is_site: bool| {
        let names = chart.legend.iter().filter(|it| it.is_site == is_site).map(|it| it.name.as_str());
        names.collect::<Vec<_>>().join(", ")
    };
    let lines: Vec<String> = [("Sites", words(true)), ("Values", words(false))]
        .into_iter()
        .filter(|(_, names)| !names.is_empty())
        .map(|(kind, names)| format!("{kind}: {names}"))
        .collect();
    let response = ui.interact(place, ui.scope_id().with("legend"), Sense::hover());
    response.widget_info(|| {
        WidgetInfo::labeled(egui::Role::Label, true, format!("Colors. {}", lines.join(". ")))
    });
    response.on_hover_ui_at_pointer(|ui| {
        for line in &lines {
            ui.label(line);
        }
    });
}

/// A bar that shares its row with others, as something to click. Returns whether it is pointed at.
fn show_bar(
    ui: &Ui,
    painting: &Painting<'_>,
    plan: &Plan,
    (row, at): (usize, usize),
    is_selected: bool,
    commands: &mut CommandSender,
) -> bool {
    let bar = &painting.chart.bars[at];
    let place = painting.bar_rect(bar, row);
    let wider = (MIN_TARGET - place.width()).max(0.0) / 2.0;
    let area = place.expand2(vec2(wider, 2.0)).intersect(painting.visible);
    if !area.is_positive() {
        return false;
    }
    let response = ui.interact(area, ui.scope_id().with(("bar", at)), sense(is_selected));
    respond(ui, &response, painting, plan, (row, bar), is_selected, commands)
}

/// The connector after the selected bar.
fn show_connector(ui: &Ui, painting: &Painting<'_>, (row, bar): (usize, &Bar)) {
    let occurrence = bar.occurrence.and_then(|id| painting.network.occurrences.get(id.index()));
    let Some(occurrence) = occurrence.filter(|_| bar.label.is_none()) else { return };
    let Some(span) = occurrence.span else { return };
    let place = painting.bar_rect(bar, row);
    // A name that has no room in its bar is beside it.
    let font = FontId::proportional(theme::size::SMALL);
    let name = ui.painter().layout_no_wrap(bar.name.to_string(), font, Color32::PLACEHOLDER).size().x;
    let beside = if name + NAME_MARGIN > place.width() { name + NAME_MARGIN } else { 0.0 };
    let end = place.right_center() + vec2(beside, 0.0);
    let name = painting.network.readable(&occurrence.name);
    carry::connector(ui, painting.context, end, painting.visible, (span, &name));
}

/// Returns what is selected can be carried to another activity; a drag of anything else moves the view.
fn sense(is_selected: bool) -> Sense {
    if is_selected { Sense::click_and_drag() } else { Sense::click() }
}

/// Carries the bar, or what is carried over it.
fn carry(
    ui: &Ui,
    response: &Response,
    painting: &Painting<'_>,
    place: Rect,
    bar: &Bar,
    commands: &mut CommandSender,
) {
    let occurrence = bar.occurrence.and_then(|id| painting.network.occurrences.get(id.index()));
    let Some(span) = occurrence.and_then(|it| it.span).filter(|_| bar.label.is_none()) else { return };
    if response.drag_started_by(PointerButton::Primary)
        && painting.context.state.drawn_statement() == Some(span)
    {
        carry::take(ui.ctx(), Carried::Activity(span));
    }
    let pointer = ui.input(|input| input.pointer.interact_pos());
    if let Some(at) = pointer.filter(|_| response.contains_pointer()) {
        carry::over_activity(ui, painting.context, span, at.x < place.center().x, commands);
    }
}

/// What pointing at a bar and clicking it does. Returns whether it is pointed at, here or in another panel.
fn respond(
    ui: &Ui,
    response: &Response,
    painting: &Painting<'_>,
    plan: &Plan,
    (row, bar): (usize, &Bar),
    is_selected: bool,
    commands: &mut CommandSender,
) -> bool {
    let context = painting.context;
    carry(ui, response, painting, painting.bar_rect(bar, row), bar, commands);
    let selection = bar::selection(bar, painting.network);
    let owner = bar.occurrence.and_then(|it| painting.network.occurrences.get(it.index()));
    let name = match (bar.label, owner) {
        _ if bar.kind.is_of_state() => state::words(painting.network, plan, bar).join(", "),
        (Some(_), Some(owner)) if owner.name != bar.name => format!("{} of {}", bar.name, owner.name),
        (None, Some(owner)) => owner.name.to_string(),
        _ => bar.name.to_string(),
    };
    let name = painting.network.readable(&name);
    theme::structure::item(response, is_selected, &format!("{name}: {}", bar::words(bar, plan)));
    if response.hovered() && context.state.hovered != selection {
        commands.send(Command::Hover(selection.clone()));
    }
    if response.double_clicked() {
        commands.send(Command::SelectAndReveal(selection.clone()));
    } else if response.clicked() || response.secondary_clicked() {
        commands.send(Command::Select(selection.clone()));
    }
    draw_menu::activities(response, context, commands);
    let is_hovered = response.hovered() || is_chosen(bar, &context.state.hovered, painting.network);
    response.clone().on_hover_ui_at_pointer(|ui| {
        if bar.label.is_none() {
            ui.label(theme::strong(bar.name.as_str()));
        }
        let name = selection.title(Some(painting.network));
        if bar.label.is_some() {
            ui.label(theme::strong(name));
        } else if name != bar.name {
            ui.label(egui::RichText::new(name).small().color(context.tokens.text_muted));
        }
        if bar.kind.is_of_state() {
            for line in state::words(painting.network, plan, bar) {
                ui.label(line);
            }
        }
        ui.label(bar::words(bar, plan));
        for &label in &bar.labels {
            if let Some(label) = painting.network.labels.get(label.index()) {
                ui.label(layout::text::label_words(label));
            }
        }
    });
    is_hovered
}

/// Returns whether a selection is about a bar: its occurrence, its condition, or a link or an ordering that ends at it.
fn is_chosen(bar: &Bar, selection: &Selection, network: &Network) -> bool {
    let is_of = |label: LabelId| {
        if let Some(own) = bar.label {
            return own == label;
        }
        let owner = network.labels.get(label.index()).and_then(|label| label.owner);
        owner.is_some() && owner == bar.occurrence
    };
    match selection {
        Selection::None => false,
        Selection::Label(label) => is_of(*label),
        Selection::Link(link) => is_of(link.ask) || is_of(link.tell),
        Selection::Ordering(ordering) => is_of(ordering.first) || is_of(ordering.then),
        _ => selection.occurrence(network).is_some_and(|chosen| bar.occurrence == Some(chosen)),
    }
}
