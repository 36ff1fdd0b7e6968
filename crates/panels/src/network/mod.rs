//! The temporal plan network: drawn from the mission's structure, with what the plan or its failure adds.
//!
//! `data` holds what is drawn, `view` where it is seen from, `paint` puts it on the screen. Coordinates come from the
//! `layout` crate and are computed again when the network changes.

mod data;
mod describe;
mod detail;
mod export;
mod highlight;
mod landmarks;
mod marks;
mod minimap;
mod paint;
mod search;
mod toolbar;
pub(crate) mod view;

use std::sync::Arc;

use display::Point;
use egui::{CursorIcon, InputState, Key, PointerButton, Rect, Response, Role, Sense, Ui, WidgetInfo, vec2};
use layout::{BlockForm, Item, NetworkDrawing, OverlayCurve, OverlayKind, Progress};
use snapshot::Snapshot;
use tpn::{BlockId, Network, NodeId, Plan};
use workbench::ViewAction;
use workbench::command::{Command, CommandSender};
use workbench::state::search::Focus;
use workbench::state::settings::NetworkView;
use workbench::state::settings::SettingsCommand;
use workbench::state::window::WindowCommand;
use workbench::state::{Selection, Status, Views};
use workbench::workspace::Workspace;
use workbench::{PanelEffect, PanelKind};

use self::data::{Drawn, block_key, fits, is_collapsible};
use self::detail::Detail;
use self::highlight::{Highlight, selection_of};
use self::landmarks::Act;
use self::minimap::Overview;
use self::paint::{Scene, badge};
use self::search::Search;
use self::toolbar::Asked;
use self::view::View;
use super::{Context, Panel, draw_menu};
use crate::carry::{self, Carried};
use crate::painter::DisplayPainter;

/// The network panel.
#[derive(Default)]
pub struct NetworkPanel {
    drawn: Drawn,
    view: View,
    detail: Detail,
    search: Search,
    /// The selection that was last brought into view.
    followed_selection: Selection,
    /// The step of the search that was last brought into view.
    followed_step: Option<usize>,
    /// What this panel last said the pointer is over.
    told_hover: Selection,
    overview: Overview,
}

/// How far from the pointer something may be to be pointed at, in points.
const REACH: f64 = 6.0;
/// From the upper edge of the panel to its badges, and how high those of one and of two lines are with the room below.
const BADGES_TOP: f32 = 8.0;
/// See [`BADGES_TOP`].
const BADGE_HEIGHTS: [f32; 2] = [30.0, 44.0];
const WHEEL_ZOOM: f64 = 0.0022;
const KEY_ZOOM: f64 = 1.3;
/// Where something was opened, the whole is shown with it down to this zoom.
const MIN_OPENED: f64 = 0.62;
/// A selection elsewhere is shown no larger than this.
const SELECTION_ZOOM: f64 = 1.4;

impl Panel for NetworkPanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let Some((snapshot, network)) = context.snapshot.and_then(|it| Some((it, it.network.as_ref()?)))
        else {
            crate::empty::show_missing(ui, context, "its network appears here", commands);
            return;
        };
        let views = &context.state.settings.views;
        let mut options = views.network.clone();
        let boxes = self.boxes();
        let asked = toolbar::show(ui, context, &mut options, &mut self.search, boxes, commands);
        if options != views.network {
            commands.send(Command::Settings(SettingsCommand::SetViews(Box::new(Views {
                network: options.clone(),
                ..views.clone()
            }))));
        }
        let room = ui.available_size() - vec2(0.0, badges_height(context, snapshot));
        self.detail.follow(room, self.view.is_fitted(), options.windows);
        self.draw(context, snapshot, network);
        self.answer(asked, network, commands);
        self.show_drawing(ui, context, snapshot, network, &options, commands);
    }
}

impl NetworkPanel {
    /// Returns whether something is behind a box, and whether that is not as it would be by itself.
    fn boxes(&self) -> (bool, bool) {
        let mut blocks = self.drawn.drawing.blocks.iter();
        (blocks.any(|block| block.form == BlockForm::Collapsed), self.detail.is_changed())
    }

    /// Draws what the snapshot holds, as far as that has changed, with detail where the selection is.
    fn draw(&mut self, context: &Context<'_>, snapshot: &Snapshot, network: &Arc<Network>) {
        let begun_secs = (context.clock)();
        let latest = context.state.snapshots.latest().map(std::convert::AsRef::as_ref);
        let pins = (context.state.pins.version(), context.state.pins.plan(snapshot));
        let pins = context.state.settings.views.network.windows.then_some(pins);
        let mut is_new = self.drawn.follow(snapshot, network, context.step(), &self.detail, latest, pins);
        let is_selected_anew = context.state.selection != self.followed_selection;
        let is_next_step = Self::step_of(context) != self.followed_step;
        let of_selection = (is_new || is_selected_anew)
            .then(|| highlight::wanted(&context.state.selection, network, &self.drawn.drawing));
        let of_step = (is_new || is_next_step).then(|| Self::wanted_at_step(context, network));
        for nodes in [of_selection.unwrap_or_default(), of_step.unwrap_or_default()] {
            self.detail.reveal(network, &self.drawn.drawing, &nodes);
            is_new |= self.drawn.follow(snapshot, network, context.step(), &self.detail, latest, pins);
        }
        if is_new {
            context.layout_millis.set(Some(((context.clock)() - begun_secs) * 1000.0));
        }
        self.search.follow(network, self.drawn.version);
    }

    /// The step of the search that is looked at.
    fn step_of(context: &Context<'_>) -> Option<usize> {
        context.state.search.step().map(|step| step.step)
    }

    /// The events that the step of the search that is looked at is about, if it is one of those that tell something.
    fn wanted_at_step(context: &Context<'_>, network: &Network) -> Vec<NodeId> {
        let is_key = |view: &workbench::state::search::View| {
            let entry = view.recording.trace().events.get(view.step.step);
            entry.is_some_and(|entry| workbench::state::search::focus::is_key(&entry.event))
        };
        let focus = context.step().filter(|view| is_key(view)).and_then(|_| context.focus());
        focus.map(|focus| Highlight::of_focus(&focus, network).nodes).unwrap_or_default()
    }

    /// Returns what tells which approved plan is laid over the present one: in a review, unless that is switched off or
    /// a step of the search is looked at.
    fn approved_key(context: &Context<'_>) -> Option<String> {
        let state = context.state;
        let is_wanted = state.window.workspace == Workspace::Review
            && state.settings.views.timeline.approved
            && context.step().is_none();
        let (entry, _) = state.review.record().last_approval().filter(|_| is_wanted)?;
        let review = state.review.current()?;
        Some(format!("{} {} {}", entry.digest(), review.content_hash, review.plan_hash))
    }

    fn answer(&mut self, asked: Asked, network: &Network, commands: &mut CommandSender) {
        let found = match asked {
            Asked::Nothing => return,
            Asked::OpenAll => {
                self.detail.reset();
                self.detail.is_expanded = true;
                return;
            }
            Asked::FitAll => {
                self.detail.reset();
                commands.send(Command::Window(WindowCommand::ViewOf(PanelKind::Network, ViewAction::Fit)));
                return;
            }
            Asked::CloseAll => {
                self.detail.reset();
                self.detail.collapsed = data::outermost_activities(network);
                return;
            }
            Asked::NextMatch => self.search.step(true),
            Asked::PreviousMatch => self.search.step(false),
        };
        if let Some(selection) = found {
            commands.send(Command::SelectAndReveal(selection));
        }
    }

    fn show_drawing(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        snapshot: &Snapshot,
        network: &Arc<Network>,
        options: &NetworkView,
        commands: &mut CommandSender,
    ) {
        let plan = context.plan().map(|(_, plan)| plan).filter(|plan| fits(plan, network));
        let times = || context.state.review.approved_times();
        let approved = Self::approved_key(context).map(|key| data::Approved { key, times: &times });
        self.drawn.list(network, plan, options, approved.as_ref());
        let now = context.state.playback.time;
        let is_timed = options.now && now > 0.0 && context.step().is_none();
        let progress = plan.filter(|_| is_timed).map(|plan| Progress::at(network, plan, now));
        self.save_picture(context, (snapshot, network), plan, progress.as_ref(), options, commands);
        let (panel, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        crate::note_drawing(&response);
        let summary = describe::summary(network, plan);
        response
            .widget_info(|| WidgetInfo::labeled(Role::Image, true, format!("{}. {summary}", title(context))));
        self.carry(ui, context, panel, &response, (network, plan), commands);
        self.move_view(ui, context, panel, &response, (snapshot, network));

        self.show_connector(ui, context, panel, network);
        let act = landmarks::show(ui, panel, &self.view, &self.drawn, network, (context, commands));
        // It does not jump about while the drawing moves.
        let is_moved =
            |input: &InputState| input.pointer.any_down() || input.smooth_scroll_delta() != vec2(0.0, 0.0);
        if options.minimap && !ui.input(is_moved) {
            self.overview.follow(panel, &self.view, &self.drawn);
        }
        let overview = self.overview.place(panel, &self.view, &self.drawn).filter(|_| options.minimap);
        let pointer =
            pointer_over(ui, &response).filter(|at| overview.is_none_or(|overview| !overview.contains(*at)));
        let pointed = pointer.and_then(|at| self.pointed(panel, at, network, plan, options));
        self.tell_hover(context, pointed.as_ref(), commands);
        match act {
            Some(act) if act.is_double => self.toggle_block_under(pointer, panel, network),
            Some(Act { opens: Some((first, last)), .. }) => self.open(network, first, last),
            Some(act) => {
                self.followed_selection = act.selection.clone();
                commands.send(Command::SelectAndReveal(act.selection));
            }
            None => self.click(&response, pointed.as_ref(), panel, network, commands),
        }

        if response.secondary_clicked() {
            let selection = pointed.as_ref().map(|pointed| pointed.selection().clone()).unwrap_or_default();
            self.followed_selection = selection.clone();
            commands.send(Command::Select(selection));
        }
        draw_menu::activities(&response, context, commands);

        let painter = ui.painter_at(panel);
        let selected = Highlight::of(&context.state.selection, network);
        let hovered = Highlight::of(&context.state.hovered, network);
        let contradiction = || context.reason().map(|reason| Focus::of_reason(network, reason));
        let focus = context.focus().or_else(contradiction);
        let marks = options.problems.then(|| marks::Groups::new(panel, &self.view, &self.drawn.marks));
        let marked: Vec<Rect> = marks.iter().flat_map(marks::Groups::rects).collect();
        let scene = Scene {
            drawn: &self.drawn,
            network,
            plan,
            options,
            selected: &selected,
            hovered: &hovered,
            focus: focus.as_ref(),
            progress: progress.as_ref(),
        };
        scene
            .paint(&DisplayPainter::new(&painter, panel, self.view.placement(panel), context.tokens), marked);
        if let Some(groups) = &marks {
            marks::show(ui, panel, groups, &self.drawn.marks, context.tokens, commands);
        }
        if let Some(place) = overview {
            minimap::paint(&painter, place, panel, &self.view, &self.drawn, context.tokens);
        }
        show_badges(&painter, panel, context, snapshot);
        if response.has_focus() {
            let stroke = egui::Stroke::new(1.0, context.tokens.accent);
            painter.rect_stroke(panel.shrink(1.0), 2.0, stroke, egui::StrokeKind::Inside);
        }
        if let Some(pointed) = pointed.filter(|_| !response.dragged()) {
            show_tooltip(&response, context, &pointed, &self.drawn.drawing, network, plan);
        }
    }

    /// Saves the drawing once for every time that was asked for: with all its detail, since a file has any room.
    fn save_picture(
        &self,
        context: &Context<'_>,
        (snapshot, network): (&Snapshot, &Arc<Network>),
        plan: Option<&Plan>,
        progress: Option<&Progress>,
        options: &NetworkView,
        commands: &mut CommandSender,
    ) {
        let formats = context.effects.borrow_mut().take(|effect| match effect {
            PanelEffect::SaveDrawing(format) => Some(format),
            _ => None,
        });
        if formats.is_empty() {
            return;
        }
        let detail = self.detail.expanded();
        let windows_of = options.windows.then(|| {
            let pins = &context.state.pins;
            (pins.version(), pins.plan(snapshot))
        });
        let mut drawn = Drawn::default();
        drawn.follow(snapshot, network, context.step(), &detail, None, windows_of);
        let times = || context.state.review.approved_times();
        let approved = Self::approved_key(context).map(|key| data::Approved { key, times: &times });
        drawn.list(network, plan, options, approved.as_ref());
        for format in formats {
            commands.send(export::save(format, context, &drawn, network, plan, progress, options));
        }
    }

    /// Follows the mouse, the keys, and what was asked of the view.
    fn move_view(
        &mut self,
        ui: &Ui,
        context: &Context<'_>,
        panel: Rect,
        response: &Response,
        (snapshot, network): (&Snapshot, &Network),
    ) {
        let overview = self
            .overview
            .place(panel, &self.view, &self.drawn)
            .filter(|_| context.state.settings.views.network.minimap);
        let pointer = response.interact_pointer_pos();
        // Two fingers move and zoom; one of them alone would drag as well.
        let touch = ui.input(InputState::multi_touch).filter(|touch| panel.contains(touch.start_pos));
        if let Some(touch) = touch {
            self.overview.is_dragged = false;
            self.view.pan(touch.translation_delta);
            self.view.zoom_at(panel, touch.center_pos, f64::from(touch.zoom_delta));
            return;
        }
        if response.drag_started() || response.clicked() {
            let is_over = |place: &Rect| pointer.is_some_and(|at| place.contains(at));
            self.overview.is_dragged = overview.as_ref().is_some_and(is_over);
        }
        if let (true, Some(place), Some(at)) = (self.overview.is_dragged, overview, pointer) {
            self.view.look_at(minimap::point_at(place, &self.drawn, at));
        } else if carry::carried(ui.ctx()).is_some() {
            ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
        } else if response.dragged_by(PointerButton::Primary) || response.dragged_by(PointerButton::Middle) {
            self.view.pan(response.drag_delta());
            ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
        }
        if response.drag_stopped() {
            self.overview.is_dragged = false;
        }
        if let Some(at) = pointer_over(ui, response) {
            let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta(), input.zoom_delta()));
            let factor =
                if pinch == 1.0 { (f64::from(scroll.y) * WHEEL_ZOOM).exp() } else { f64::from(pinch) };
            if factor != 1.0 {
                self.view.zoom_at(panel, at, factor);
            }
            self.view.pan(vec2(scroll.x, 0.0));
        }
        // With something selected, arrows go from it to its neighbors.
        if response.has_focus() && context.state.selection.is_none() {
            self.view.pan(arrow_keys(ui) * 48.0);
        }
        let action = context.view_action(PanelKind::Network);
        self.follow_action(action, panel, context, network);
        self.follow_selection(panel, context, network);
        self.follow_step(panel, context, network);
        if self.view.is_fitted() {
            self.fit(panel, context, snapshot, network);
        }
    }

    /// Shows all of the drawing below the badges; where something was opened and all would be too small to read, what is
    /// around that.
    fn fit(&mut self, panel: Rect, context: &Context<'_>, snapshot: &Snapshot, network: &Network) {
        let top = badges_height(context, snapshot);
        let area = panel.with_min_y(panel.top() + top);
        if self.detail.has_focus() {
            let of_step = context.focus().map(|focus| Highlight::of_focus(&focus, network));
            let shapes = of_step.unwrap_or_else(|| Highlight::of(&context.state.selection, network));
            let part = shapes.bounds(&self.drawn.drawing);
            self.view.fit_legibly(area, self.drawn.frame(), part, MIN_OPENED);
        } else {
            self.view.fit(area, self.drawn.frame());
        }
        self.view.keep_below(top);
    }

    fn follow_action(
        &mut self,
        action: Option<ViewAction>,
        panel: Rect,
        context: &Context<'_>,
        network: &Network,
    ) {
        match action {
            None | Some(ViewAction::TopView | ViewAction::Follow | ViewAction::Tour) => {}
            Some(ViewAction::ZoomIn) => self.view.zoom_at(panel, panel.center(), KEY_ZOOM),
            Some(ViewAction::ZoomOut) => self.view.zoom_at(panel, panel.center(), 1.0 / KEY_ZOOM),
            Some(ViewAction::ZoomReset) => self.view.reset_zoom(),
            Some(ViewAction::Fit) => {
                // Asked for twice, it shows the whole again, not what was opened.
                if self.view.is_fitted() {
                    self.detail.reset();
                }
                self.view.fit(panel, self.drawn.frame());
            }
            Some(ViewAction::FitSelection) => {
                let shapes = Highlight::of(&context.state.selection, network);
                match shapes.bounds(&self.drawn.drawing) {
                    Some(area) => self.view.show(panel, area.expanded(60.0), SELECTION_ZOOM),
                    None => self.view.fit(panel, self.drawn.frame()),
                }
            }
        }
    }

    /// Brings a new selection into view if none of it is.
    fn follow_selection(&mut self, panel: Rect, context: &Context<'_>, network: &Network) {
        let selection = &*context.state.selection;
        if *selection == self.followed_selection {
            return;
        }
        self.followed_selection = selection.clone();
        let Some(area) = Highlight::of(selection, network).bounds(&self.drawn.drawing) else { return };
        if !self.view.visible(panel).overlaps(area.expanded(1.0)) {
            self.view.look_at(area.center());
        }
    }

    /// Brings what a new step is about into view if none of it is.
    fn follow_step(&mut self, panel: Rect, context: &Context<'_>, network: &Network) {
        let step = Self::step_of(context);
        if step == self.followed_step {
            return;
        }
        self.followed_step = step;
        // All of a fitted drawing is in view.
        if self.view.is_fitted() {
            return;
        }
        let Some(focus) = context.focus() else { return };
        let area = Highlight::of_focus(&focus, network).bounds(&self.drawn.drawing);
        if let Some(area) = area.filter(|area| !self.view.visible(panel).overlaps(area.expanded(1.0))) {
            self.view.look_at(area.center());
        }
    }

    /// Carries the selected activity to another one.
    fn carry(
        &self,
        ui: &Ui,
        context: &Context<'_>,
        panel: Rect,
        response: &Response,
        (network, plan): (&Network, Option<&Plan>),
        commands: &mut CommandSender,
    ) {
        let options = &context.state.settings.views.network;
        let over = |at| {
            let pointed = self.pointed(panel, at, network, plan, options)?;
            let selection = pointed.selection().clone();
            let span = network.occurrences.get(selection.occurrence(network)?.index())?.span?;
            Some((selection, span))
        };
        if response.drag_started_by(PointerButton::Primary) {
            let begun = ui.input(|input| input.pointer.press_origin());
            let pressed = begun.and_then(over).map(|(_, span)| span);
            if let Some(span) = pressed.filter(|span| context.state.drawn_statement() == Some(*span)) {
                carry::take(ui.ctx(), Carried::Activity(span));
            }
        }
        if carry::carried(ui.ctx()).is_none() {
            return;
        }
        if let Some(at) = pointer_over(ui, response)
            && let Some((selection, span)) = over(at)
            && let Some(bounds) = Highlight::of(&selection, network).bounds(&self.drawn.drawing)
        {
            let is_left = self.view.drawing_point(panel, at).x < bounds.center().x;
            carry::over_activity(ui, context, span, is_left, commands);
        }
    }

    /// The connector after the selected activity.
    fn show_connector(&self, ui: &Ui, context: &Context<'_>, panel: Rect, network: &Network) {
        let selection = &*context.state.selection;
        let selected = selection.occurrence(network).and_then(|id| network.occurrences.get(id.index()));
        let Some((occurrence, span)) = selected.and_then(|it| Some((it, it.span?))) else { return };
        let Some(bounds) = Highlight::of(selection, network).bounds(&self.drawn.drawing) else { return };
        let end = self.view.screen_rect(panel, bounds).right_center();
        carry::connector(ui, context, end, panel, (span, &network.readable(&occurrence.name)));
    }

    /// Returns what is under the pointer: a shape, or a curve over the shapes.
    fn pointed(
        &self,
        panel: Rect,
        at: egui::Pos2,
        network: &Network,
        plan: Option<&Plan>,
        options: &NetworkView,
    ) -> Option<Pointed> {
        let point = self.view.drawing_point(panel, at);
        let reach = REACH / self.view.zoom();
        let item = self.drawn.drawing.pick(point, reach);
        let is_small = matches!(item, Some(Item::Node(_) | Item::Label(_)));
        if !is_small && let Some(plan) = plan {
            let links = options.links.then_some(&self.drawn.links);
            let orderings = options.orderings.then_some(&self.drawn.orderings);
            let curves = links.into_iter().chain(orderings).flatten();
            let nearest = curves
                .map(|curve| (distance(curve, point, reach), curve))
                .filter(|(distance, _)| *distance <= reach * 0.7)
                .min_by(|left, right| left.0.total_cmp(&right.0));
            if let Some((_, curve)) = nearest {
                return overlay_selection(curve, network, plan).map(Pointed::Curve);
            }
        }
        let item = item?;
        (!matches!(item, Item::Block(_)) || options.structure || is_box(&self.drawn, item))
            .then(|| Pointed::Item(item, selection_of(item, network)))
    }

    fn tell_hover(&mut self, context: &Context<'_>, pointed: Option<&Pointed>, commands: &mut CommandSender) {
        let hover = pointed.map(|pointed| pointed.selection().clone()).unwrap_or_default();
        if hover != self.told_hover {
            // Another panel's hint is not taken away when the pointer merely is not here.
            if !hover.is_none() || context.state.hovered == self.told_hover {
                commands.send(Command::Hover(hover.clone()));
            }
            self.told_hover = hover;
        }
    }

    fn click(
        &mut self,
        response: &Response,
        pointed: Option<&Pointed>,
        panel: Rect,
        network: &Network,
        commands: &mut CommandSender,
    ) {
        if response.double_clicked() && !self.overview.is_dragged {
            self.toggle_block_under(response.interact_pointer_pos(), panel, network);
        } else if response.clicked() && !self.overview.is_dragged {
            response.request_focus();
            let selection = pointed.map(|pointed| pointed.selection().clone()).unwrap_or_default();
            self.followed_selection = selection.clone();
            commands.send(Command::SelectAndReveal(selection));
        }
    }

    /// Opens the box at a place, or collapses the innermost block there.
    fn toggle_block_under(&mut self, pointer: Option<egui::Pos2>, panel: Rect, network: &Network) {
        let Some(point) = pointer.map(|at| self.view.drawing_point(panel, at)) else { return };
        let blocks = self.drawn.drawing.blocks.iter().filter(|block| block.rect.contains(point));
        let found = blocks.rev().find_map(|block| {
            let id: BlockId = block.block?;
            let is_box = block.form == BlockForm::Collapsed;
            (is_box || is_collapsible(network, id)).then_some((is_box, id, block.last.unwrap_or(id)))
        });
        match found {
            Some((true, first, last)) => self.open(network, first, last),
            Some((false, block, _)) => self.detail.collapsed.extend(block_key(network, block)),
            None => {}
        }
    }

    /// Opens a box, and shows everything with it.
    fn open(&mut self, network: &Network, first: BlockId, last: BlockId) {
        self.detail.open(network, first, last);
        self.view.keep_fitted();
    }
}

/// What the pointer is over.
enum Pointed {
    Item(Item, Selection),
    Curve(Selection),
}

impl Pointed {
    fn selection(&self) -> &Selection {
        match self {
            Self::Item(_, selection) | Self::Curve(selection) => selection,
        }
    }
}

fn is_box(drawn: &Drawn, item: Item) -> bool {
    let Item::Block(id) = item else { return false };
    let mut boxes = drawn.drawing.blocks.iter().filter(|block| block.form == BlockForm::Collapsed);
    boxes.any(|block| block.block == Some(id))
}

fn distance(curve: &OverlayCurve, point: Point, reach: f64) -> f64 {
    if !curve.bounds.expanded(reach).contains(point) {
        return f64::INFINITY;
    }
    display::geometry::distance_point_curve(point, curve.start, &curve.pieces)
}

fn overlay_selection(curve: &OverlayCurve, network: &Network, plan: &Plan) -> Option<Selection> {
    let number = curve.number as usize;
    match curve.kind {
        OverlayKind::CausalLink => plan.causal_links.get(number).map(|&link| Selection::Link(link)),
        OverlayKind::Ordering => {
            if let Some(&ordering) = plan.orderings_added.get(number) {
                return Some(Selection::Ordering(ordering));
            }
            // Those of the uses of resources follow; each represents the one that has to wait.
            let ordering = plan.uses_ordered.get(number - plan.orderings_added.len())?;
            network.uses.get(ordering.then.index())?.owner.map(Selection::Occurrence)
        }
        OverlayKind::NegativeCycle | OverlayKind::Threat => None,
    }
}

/// The name of the drawing for screen readers.
fn title(context: &Context<'_>) -> &'static str {
    if context.is_stale && context.state.status() == Status::Broken {
        "Network of the last valid version"
    } else {
        "Network"
    }
}

/// Where the pointer is, if it is over the drawing or one of its landmarks.
fn pointer_over(ui: &Ui, response: &Response) -> Option<egui::Pos2> {
    if response.contains_pointer() { ui.input(|input| input.pointer.hover_pos()) } else { None }
}

/// How the arrow keys move the drawing.
fn arrow_keys(ui: &Ui) -> egui::Vec2 {
    ui.input(|input| {
        let pressed = |key| f32::from(u8::from(input.key_pressed(key)));
        vec2(
            pressed(Key::ArrowLeft) - pressed(Key::ArrowRight),
            pressed(Key::ArrowUp) - pressed(Key::ArrowDown),
        )
    })
}

/// Returns what a badge says of an older text that the drawing is of.
fn stale_text(context: &Context<'_>) -> Option<&'static str> {
    match context.state.status() {
        _ if !context.is_stale => None,
        Status::Broken => Some("⚠ The text has errors: showing the last valid network"),
        Status::Empty => Some("⚠ Nothing to plan: showing the previous network"),
        Status::Undecided => Some("⚠ Out of date: network of a previous version"),
        _ => None,
    }
}

/// The first reason why there is no plan.
fn first_reason(snapshot: &Snapshot) -> Option<&kirk::Reason> {
    snapshot.planning.as_ref()?.outcome.failure.as_ref()?.reasons.first()
}

/// The height of the panel's upper part that badges may cover: of a step, as of a reason, that of two lines, so that the
/// drawing keeps its place from step to step.
fn badges_height(context: &Context<'_>, snapshot: &Snapshot) -> f32 {
    let stale = if stale_text(context).is_some() { BADGE_HEIGHTS[0] } else { 0.0 };
    let is_told = context.step().is_some() || first_reason(snapshot).is_some();
    let told = if is_told { BADGE_HEIGHTS[1] } else { 0.0 };
    if stale + told > 0.0 { BADGES_TOP + stale + told } else { 0.0 }
}

/// Says when the drawing is that of an older text, and why there is no plan.
fn show_badges(painter: &egui::Painter, panel: Rect, context: &Context<'_>, snapshot: &Snapshot) {
    let tokens = context.tokens;
    let width = (panel.width() - 60.0).clamp(80.0, 520.0);
    let mut corner = panel.left_top() + vec2(10.0, BADGES_TOP);
    if let Some(text) = stale_text(context) {
        badge(painter, corner, text, tokens.warning, tokens, width);
        corner.y += BADGE_HEIGHTS[0];
    }
    if let Some(view) = context.step() {
        let trace = view.recording.trace();
        let (step, steps) = (view.step.step, trace.events.len());
        let Some(entry) = trace.events.get(step) else { return };
        let text = workbench::state::search::wording::event(view.recording.network(), trace, &entry.event);
        let is_failure = workbench::state::search::focus::is_failure(&entry.event);
        let color = if is_failure { tokens.failure } else { tokens.accent };
        badge(painter, corner, &format!("Step {} / {steps}: {text}", step + 1), color, tokens, width);
        return;
    }
    if let Some(reason) = first_reason(snapshot) {
        badge(painter, corner, &format!("✗ No plan: {}", reason.message), tokens.error, tokens, width);
    }
}

fn show_tooltip(
    response: &Response,
    context: &Context<'_>,
    pointed: &Pointed,
    drawing: &NetworkDrawing,
    network: &Network,
    plan: Option<&Plan>,
) {
    let box_at = |item: &Item| match item {
        Item::Block(id) => {
            let mut blocks = drawing.blocks.iter().filter(|shape| shape.form == BlockForm::Collapsed);
            blocks.find(|shape| shape.block == Some(*id)).map(|shape| (shape.title.clone(), *id))
        }
        _ => None,
    };
    let (heading, lines) = match pointed {
        Pointed::Item(item, _) if let Some((title, id)) = box_at(item) => {
            describe::describe_box(&title, id, network, drawing)
        }
        Pointed::Item(item, _) => match describe::describe(*item, network, plan) {
            Some(described) => described,
            None => return,
        },
        Pointed::Curve(selection) => {
            let what = match selection {
                Selection::Link(_) => "causal link: the assertion supports the requirement",
                _ => "ordering: the first ends before the second starts",
            };
            (selection.title(Some(network)), vec![what.to_owned()])
        }
    };
    response.clone().on_hover_ui_at_pointer(|ui| {
        ui.set_max_width(420.0);
        ui.label(egui::RichText::new(heading).strong().color(context.tokens.text));
        for line in lines {
            ui.label(egui::RichText::new(line).color(context.tokens.text_muted));
        }
    });
}
