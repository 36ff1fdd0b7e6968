//! The window's content: shows bars, panels and dialogs around the session, and brings keys and commands to it.

use std::cell::{Cell, RefCell};

use eframe::egui_wgpu::RenderState;
use egui::accesskit::Role;
use egui::{CentralPanel, Frame, Ui};
use egui_tiles::{Behavior, TileId, Tiles, UiResponse};
use panels::{Context, Panels};
use serde_json::Value;
use theme::icon::{self, Icon};
use theme::structure;
use workbench::command::{Command, CommandSender};
use workbench::description::State;
use workbench::host::{Host, RemoteError};
use workbench::host_io::Remote;
use workbench::state::manual::ManualCommand;
use workbench::state::window::WindowCommand;
use workbench::state::{AppState, System};
use workbench::{PanelEffect, PanelKind, Session, WindowEffect};

use crate::accessibility::AccessibilityMirror;
use crate::bar;
use crate::default_layout::SizeClass;
use crate::dialog;
use crate::layouts::Layouts;
use crate::pressed::take_pressed;
use crate::toasts;

/// The front end: draws the workbench's state and passes on what the user does.
pub struct Enroute {
    session: Session,
    panels: Panels,
    layouts: Layouts,
    read_dropped: ReadDropped,
    egui: egui::Context,
}

/// How far a line of the wheel scrolls in a page. A notch is six lines in Firefox and 120 pixels in other browsers.
const POINTS_PER_LINE: f32 = 20.0;

/// Begins to read a file that was dropped on the app.
type ReadDropped = Box<dyn Fn(egui::DroppedFileHandle)>;

impl Enroute {
    /// The app on a host, drawn by `renderer` (`webgpu`, `webgl2`, …; empty if unknown).
    pub fn new(egui: &egui::Context, host: Box<dyn Host>, renderer: &str) -> Self {
        let session = Session::new(host, renderer);
        theme::install_fonts(egui);
        let layouts = Layouts::remembered(session.host());
        let app = Self {
            session,
            panels: Panels::new(),
            layouts,
            read_dropped: Box::new(|_| {}),
            egui: egui.clone(),
        };
        app.restyle();
        app
    }

    /// The same app, whose host reads the files that are dropped on it with `read` and tells of them later, each for
    /// what its name says it is.
    #[must_use]
    pub fn reading_dropped_files(mut self, read: impl Fn(egui::DroppedFileHandle) + 'static) -> Self {
        self.read_dropped = Box::new(read);
        self
    }

    /// Continues in another window, drawn by `renderer`. Drawings that panels cached for the previous window are dropped.
    pub fn move_to(&mut self, egui: &egui::Context, renderer: &str) {
        theme::install_fonts(egui);
        self.egui = egui.clone();
        self.panels = Panels::new();
        renderer.clone_into(&mut self.session.state_mut().frame.renderer);
        self.restyle();
    }

    /// The state, to look at.
    pub fn app_state(&self) -> &AppState {
        self.session.state()
    }

    /// Returns what runs around the app: clock, files, storage and the planning core.
    pub fn host_mut(&mut self) -> &mut dyn Host {
        self.session.host_mut()
    }

    /// Runs a command as if a panel had sent it.
    pub fn run(&mut self, command: Command) {
        self.apply(vec![command]);
    }

    /// Writes down whatever is not written yet: the page is about to close.
    pub fn keep_now(&mut self) {
        self.session.keep_now();
    }

    /// Writes down what was typed into the text and no frame has taken in yet.
    pub fn keep_ahead(&mut self, egui: &egui::Context, events: &[egui::Event]) {
        self.session.keep_ahead(&panels::typed_ahead(egui, events));
    }

    /// Shows one frame, filling `ui`. `render_state` is for panels that draw with wgpu.
    pub fn show(&mut self, ui: &mut Ui, render_state: Option<&RenderState>) {
        let mut dropped = self.egui.input(|input| input.raw.dropped_files.clone());
        // What describes an image comes before the image.
        dropped.sort_by_key(|file| !is_description(file.path()));
        for file in dropped {
            (self.read_dropped)(file);
        }
        self.follow_system();
        let next_secs = self.session.begin_frame();
        self.wake_after(next_secs);
        self.follow_effects();
        let pressed = take_pressed(ui.ctx(), self.app_state(), panels::editor_id());
        self.apply(pressed);
        if self.app_state().window.dialog.is_none() {
            let typed = panels::typed_text(ui.ctx(), self.app_state());
            self.apply(typed);
        }

        let mut commands = CommandSender::default();
        let layout_millis = self.show_everything(ui, render_state, &mut commands);
        self.apply(commands.take());
        self.follow_effects();
        let next_secs = self.session.end_frame(layout_millis);
        self.wake_after(next_secs);
        if let Some(mirror) = self.egui.plugin_opt::<AccessibilityMirror>() {
            mirror.lock().announce(&workbench::host_io::announcement(self.app_state()));
        }
        // What is kept is kept when no one is dragging.
        if !self.egui.input(|input| input.pointer.any_down()) {
            self.session.remember();
            self.layouts.remember(self.session.host_mut());
        }
    }

    /// Returns the milliseconds that laying out a drawing took, if one was laid out.
    fn show_everything(
        &mut self,
        ui: &mut Ui,
        render_state: Option<&RenderState>,
        commands: &mut CommandSender,
    ) -> Option<f64> {
        let layout_millis = Cell::new(None);
        let effects = RefCell::new(std::mem::take(&mut self.session.state_mut().window.panel_effects));
        let state = self.session.state();
        let clock = || self.session.host().monotonic_secs();
        let context = Context {
            state,
            snapshot: state.looked_at(),
            is_stale: state.snapshots.is_stale(state.document.revision()),
            tokens: panels::tokens(state),
            render_state,
            now_secs: state.frame.now_secs,
            clock: &clock,
            effects: &effects,
            layout_millis: &layout_millis,
        };
        bar::top::show(ui, &context, commands);
        bar::bottom::show(ui, &context, commands);
        self.layouts.fit(SizeClass::of(ui.ctx().content_rect().size()));
        let tree = self.layouts.tree_mut(state.arrangement());
        let mut shown = Vec::new();
        CentralPanel::default().frame(Frame::new().fill(context.tokens.background)).show(ui, |ui| {
            structure::part(ui, Role::Main, "Panels");
            let mut tiles =
                PanelTiles { panels: &mut self.panels, context: &context, commands, shown: Vec::new() };
            match state.window.maximized {
                Some(panel) => tiles.show_alone(ui, panel),
                None => tree.ui(&mut tiles, ui),
            }
            panels::keyboard_navigation::follow(ui, tiles.context, tiles.commands);
            shown = tiles.shown;
        });
        dialog::show(ui.ctx(), &context, commands);
        toasts::show(ui.ctx(), &context, commands);
        let state = self.session.state_mut();
        state.window.panels_on_screen = shown;
        // What no panel has taken waits for its panel.
        state.window.panel_effects = effects.into_inner();
        layout_millis.get()
    }

    fn apply(&mut self, commands: Vec<Command>) {
        if !commands.is_empty() {
            self.session.apply(commands);
            self.follow_effects();
            self.egui.request_repaint();
        }
    }

    /// Does what commands have left for the window and for the layout of its panels.
    fn follow_effects(&mut self) {
        self.layouts.follow(self.session.state_mut());
        let focused = |effect: PanelEffect| match effect {
            PanelEffect::FocusPanel(panel) => Some(panel),
            _ => None,
        };
        if let Some(panel) = self.session.state_mut().window.panel_effects.take(focused).pop() {
            let id = panels::region_id(panel);
            self.egui.memory_mut(|memory| memory.request_focus(id));
            self.egui.data_mut(|data| data.insert_temp(id, Ring(false)));
        }
        for effect in self.session.take_window_effects() {
            match effect {
                WindowEffect::Copy(text) => self.egui.copy_text(text),
                WindowEffect::Paste => self.egui.send_viewport_cmd(egui::ViewportCommand::RequestPaste),
                WindowEffect::Restyle => self.restyle(),
            }
        }
    }

    /// Looks at what the user has asked of all programs; it may change while the app runs.
    fn follow_system(&mut self) {
        let system = System {
            is_light: self.egui.system_theme() == Some(egui::Theme::Light),
            reduces_motion: self.session.host().reduces_motion(),
            is_firefox: self.session.host().is_firefox(),
        };
        if self.app_state().system != system {
            self.session.state_mut().system = system;
            self.restyle();
            self.egui.request_repaint();
        }
    }

    fn restyle(&self) {
        let state = self.app_state();
        let motion = state.system.reduces_motion;
        theme::apply(&self.egui, panels::tokens(state), state.settings.text_scale, motion);
        if cfg!(target_arch = "wasm32") {
            self.egui.options_mut(|options| options.input_options.line_scroll_speed = POINTS_PER_LINE);
        }
    }

    fn wake_after(&self, seconds: Option<f64>) {
        if let Some(seconds) = seconds {
            self.egui.request_repaint_after_secs(seconds as f32);
        }
    }
}

impl eframe::App for Enroute {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let render_state = frame.wgpu_render_state().cloned();
        self.session.state_mut().frame.total_millis =
            frame.info().cpu_usage.map(|seconds| f64::from(seconds) * 1000.0);
        self.show(ui, render_state.as_ref());
    }

    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        panels::tokens(self.app_state()).background.to_normalized_gamma_f32()
    }

    #[cfg(target_arch = "wasm32")]
    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(self)
    }
}

impl Remote for Enroute {
    fn open(&mut self, name: &str) -> Result<(), RemoteError> {
        self.session.open(name)?;
        self.follow_effects();
        self.egui.request_repaint();
        Ok(())
    }

    fn set_source(&mut self, text: &str) {
        self.session.set_source(text);
        self.follow_effects();
        self.egui.request_repaint();
    }

    fn source(&self) -> String {
        self.session.source()
    }

    fn dispatch(&mut self, command: &str, arguments: &Value) -> Result<(), RemoteError> {
        self.session.dispatch(command, arguments)?;
        self.follow_effects();
        self.egui.request_repaint();
        Ok(())
    }

    fn state(&self) -> State {
        Remote::state(&self.session)
    }

    fn state_version(&self) -> u64 {
        self.session.state_version()
    }
}

/// Whether a panel that has the keyboard as a whole says so by a ring.
#[derive(Clone, Copy)]
struct Ring(bool);

/// Shows panels in the tiles of the layout.
struct PanelTiles<'a> {
    panels: &'a mut Panels,
    context: &'a Context<'a>,
    commands: &'a mut CommandSender,
    /// The panels that were shown in this frame.
    shown: Vec<PanelKind>,
}

/// Height of the bar with the tabs.
const TAB_BAR: f32 = 28.0;

impl PanelTiles<'_> {
    /// Shows a panel under its tab and nothing else.
    fn show_alone(&mut self, ui: &mut Ui, panel: PanelKind) {
        let tokens = self.context.tokens;
        let (bar, _) =
            ui.allocate_exact_size(egui::vec2(ui.available_width(), TAB_BAR), egui::Sense::hover());
        let mut bar_ui = ui.new_child(
            egui::UiBuilder::new().max_rect(bar).layout(egui::Layout::left_to_right(egui::Align::Center)),
        );
        let state = egui_tiles::TabState { active: true, is_being_dragged: false, closable: true };
        let id = ui.scope_id().with(("maximized", panel.name()));
        let tab = bar::tab::show(&mut bar_ui, self.context, Some(panel), id, &state);
        self.follow_tab(&tab, panel);
        bar_ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if icon::button(ui, tokens, Icon::Restore, "Restore panels").clicked() {
                self.commands.send(Command::Window(WindowCommand::Maximize(None)));
            }
            panels::show_stale(ui, self.context, panel);
        });
        let place = egui::UiBuilder::new().max_rect(ui.available_rect_before_wrap());
        let mut pane = ui.new_child(place);
        self.show_panel(&mut pane, panel);
    }

    fn follow_tab(&mut self, tab: &bar::tab::Tab, panel: PanelKind) {
        if tab.is_closed {
            self.commands.send(Command::Window(WindowCommand::ClosePanel(panel)));
        } else if tab.response.double_clicked() {
            self.commands.send(Command::Window(WindowCommand::Maximize(Some(panel))));
        }
    }

    fn show_panel(&mut self, ui: &mut Ui, kind: PanelKind) {
        self.shown.push(kind);
        let rect = ui.max_rect();
        ui.painter().rect_filled(rect, 0.0, self.context.tokens.surface);
        let pressed = ui.input(|input| {
            input.pointer.any_pressed() && input.pointer.interact_pos().is_some_and(|at| rect.contains(at))
        });
        if pressed
            && self.context.state.window.active_panel != kind
            && self.context.state.window.dialog.is_none()
        {
            self.commands.send(Command::Window(WindowCommand::Activate(kind)));
        }
        structure::part(ui, Role::Region, &format!("{} panel", kind.title()));
        self.region(ui, kind);
        let place = egui::UiBuilder::new().max_rect(ui.available_rect_before_wrap());
        // A panel starts with a fresh view for each mission. Lessons and the manual outlast missions.
        let mission = if matches!(kind, PanelKind::Lesson | PanelKind::Manual) {
            0
        } else {
            self.context.state.missions_opened
        };
        let mut inside = ui.new_child(place.id_salt((kind.name(), mission)));
        self.panels.show(kind, &mut inside, self.context, self.commands);
    }

    /// The panel as something that can have the keyboard: Tab goes from it to what it holds.
    fn region(&self, ui: &Ui, kind: PanelKind) {
        let id = panels::region_id(kind);
        let rect = ui.max_rect();
        let has_focus = ui.memory(|memory| memory.has_focus(id));
        // It is in the order of Tab only while it has the keyboard: to the others it would be a stop without use.
        if !has_focus {
            return;
        }
        let region = ui.interact(rect, id, egui::Sense::focusable_noninteractive());
        region.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Group, true, kind.title()));
        let filter =
            egui::EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
        // The pointer's user knows where they are; the ring is for those who go by keys.
        let uses_keys = ui.input(|input| {
            input.raw.events.iter().any(|event| matches!(event, egui::Event::Key { pressed: true, .. }))
        });
        let Ring(is_shown) = ui.data(|data| data.get_temp(id)).unwrap_or(Ring(true));
        if uses_keys && !is_shown {
            ui.data_mut(|data| data.insert_temp(id, Ring(true)));
        }
        if !is_shown && !uses_keys {
            return;
        }
        let stroke = egui::Stroke::new(1.5, self.context.tokens.accent);
        let painter = ui.ctx().layer_painter(egui::LayerId::new(egui::Order::Middle, id.with("ring")));
        painter.rect_stroke(rect.shrink(1.0), 2.0, stroke, egui::StrokeKind::Inside);
    }
}

impl Behavior<PanelKind> for PanelTiles<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, kind: &mut PanelKind) -> UiResponse {
        self.show_panel(ui, *kind);
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, kind: &PanelKind) -> egui::WidgetText {
        bar::tab_title(self.context, *kind).into()
    }

    fn tab_ui(
        &mut self,
        tiles: &mut Tiles<PanelKind>,
        ui: &mut Ui,
        id: egui::Id,
        tile: TileId,
        state: &egui_tiles::TabState,
    ) -> egui::Response {
        let kind = tiles.get_pane(&tile).copied();
        let tab = bar::tab::show(ui, self.context, kind, id, state);
        if let Some(kind) = kind {
            self.follow_tab(&tab, kind);
        }
        tab.response
    }

    fn top_bar_right_ui(
        &mut self,
        tiles: &Tiles<PanelKind>,
        ui: &mut Ui,
        _tile: TileId,
        tabs: &egui_tiles::Tabs,
        _scroll_offset: &mut f32,
    ) {
        let panel = tabs.active.and_then(|tile| tiles.get_pane(&tile)).copied();
        let Some(panel) = panel else { return };
        let name = format!("Maximize {}", panel.title());
        if icon::button(ui, self.context.tokens, Icon::Maximize, &name).clicked() {
            self.commands.send(Command::Window(WindowCommand::Maximize(Some(panel))));
        }
        let name = format!("Help: {}", panel.title());
        if panel != PanelKind::Manual && icon::button(ui, self.context.tokens, Icon::Help, &name).clicked() {
            self.commands.send(Command::Manual(ManualCommand::About(panel)));
        }
        panels::show_stale(ui, self.context, panel);
    }

    fn is_tab_closable(&self, _tiles: &Tiles<PanelKind>, _tile: TileId) -> bool {
        true
    }

    fn tab_bar_height(&self, _style: &egui::Style) -> f32 {
        TAB_BAR
    }

    fn tab_bar_color(&self, _visuals: &egui::Visuals) -> egui::Color32 {
        self.context.tokens.background
    }

    fn tab_title_spacing(&self, _visuals: &egui::Visuals) -> f32 {
        10.0
    }

    fn tab_outline_stroke(
        &self,
        _visuals: &egui::Visuals,
        _tiles: &Tiles<PanelKind>,
        _tile: TileId,
        _state: &egui_tiles::TabState,
    ) -> egui::Stroke {
        egui::Stroke::NONE
    }

    fn tab_bar_hline_stroke(&self, _visuals: &egui::Visuals) -> egui::Stroke {
        egui::Stroke::new(1.0, self.context.tokens.line)
    }

    fn tab_text_color(
        &self,
        _visuals: &egui::Visuals,
        _tiles: &Tiles<PanelKind>,
        _tile: TileId,
        state: &egui_tiles::TabState,
    ) -> egui::Color32 {
        if state.active { self.context.tokens.text } else { self.context.tokens.text_muted }
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        6.0
    }

    fn resize_stroke(&self, _style: &egui::Style, state: egui_tiles::ResizeState) -> egui::Stroke {
        let tokens = self.context.tokens;
        match state {
            egui_tiles::ResizeState::Idle => egui::Stroke::NONE,
            egui_tiles::ResizeState::Hovering => egui::Stroke::new(2.0, tokens.line_strong),
            egui_tiles::ResizeState::Dragging => egui::Stroke::new(2.0, tokens.accent),
        }
    }

    fn simplification_options(&self) -> egui_tiles::SimplificationOptions {
        egui_tiles::SimplificationOptions { all_panes_must_have_tabs: true, ..Default::default() }
    }

    fn min_size(&self) -> f32 {
        80.0
    }
}

/// Returns whether a file is of a kind that describes an image in a file of its own.
fn is_description(path: &std::path::Path) -> bool {
    path.extension()
        .is_some_and(|it| ["lbl", "yaml", "yml"].iter().any(|known| it.eq_ignore_ascii_case(known)))
}
