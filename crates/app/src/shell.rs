//! The app as a whole: takes events in, applies commands, shows bars, panels and dialogs, and talks to the host.

use std::cell::Cell;

use eframe::egui_wgpu::RenderState;
use egui::{CentralPanel, Frame, Ui};
use egui_tiles::{Behavior, TileId, Tiles, UiResponse};
use mission::{Request, Update};
use panels::{Context, Panels};
use serde_json::Value;
use workbench::PanelKind;
use workbench::command::{self, Command, CommandSender};
use workbench::host::{Host, Remote, RemoteError};
use workbench::mission_file::{self, EXAMPLES};
use workbench::outside;
use workbench::state::{AnswerFrame, AppState, Effect, PlanSettings, Settings, Status, ToastKind};

use crate::bar;
use crate::default_layout::Room;
use crate::dialog;
use crate::layouts::Layouts;
use crate::pressed::take_pressed;
use crate::toasts;

/// The app.
pub struct Enroute {
    state: AppState,
    panels: Panels,
    layouts: Layouts,
    host: Box<dyn Host>,
    read_dropped: ReadDropped,
    egui: egui::Context,
    posted: Option<Posted>,
    stored: Settings,
    drafts: outside::DraftKeeper,
    last_secs: f64,
    version: u64,
}

/// Begins to read a file that was dropped on the app.
type ReadDropped = Box<dyn Fn(egui::DroppedFileHandle)>;

/// What the planning core was last asked for.
#[derive(Clone, Debug, PartialEq)]
struct Posted {
    revision: u64,
    settings: PlanSettings,
}

impl Enroute {
    /// The app on a host, drawn by `renderer` (`webgpu`, `webgl2`, …; empty if unknown).
    pub fn new(egui: &egui::Context, host: Box<dyn Host>, renderer: &str) -> Self {
        let mut state = AppState::new();
        if let Some(settings) = outside::remembered_settings(host.as_ref()) {
            state.settings = settings;
        }
        renderer.clone_into(&mut state.frame.renderer);
        let drafts = outside::DraftKeeper::start(&mut state, host.as_ref());
        outside::open_fragment(&mut state, &host.fragment());
        theme::install_fonts(egui);
        theme::apply(egui, panels::tokens(state.settings.theme), state.settings.text_scale);
        let layouts = Layouts::remembered(host.as_ref());
        let last_secs = host.monotonic_secs();
        let stored = state.settings.clone();
        Self {
            state,
            panels: Panels::new(),
            layouts,
            host,
            read_dropped: Box::new(|_| {}),
            egui: egui.clone(),
            posted: None,
            stored,
            drafts,
            last_secs,
            version: 1,
        }
    }

    /// The same app, whose host reads the files that are dropped on it with `read` and tells of them later, each for
    /// what its name says it is.
    #[must_use]
    pub fn reading_dropped_files(mut self, read: impl Fn(egui::DroppedFileHandle) + 'static) -> Self {
        self.read_dropped = Box::new(read);
        self
    }

    /// The state, to look at.
    pub fn app_state(&self) -> &AppState {
        &self.state
    }

    /// The host.
    pub fn host_mut(&mut self) -> &mut dyn Host {
        self.host.as_mut()
    }

    /// Runs a command as if a panel had sent it.
    pub fn run(&mut self, command: Command) {
        self.apply(vec![command]);
    }

    /// Shows one frame, filling `ui`. `render_state` is for panels that draw with wgpu.
    pub fn show(&mut self, ui: &mut Ui, render_state: Option<&RenderState>) {
        let begun_secs = self.host.monotonic_secs();
        self.begin_frame(begun_secs);
        let pressed = take_pressed(ui.ctx(), &self.state, panels::editor_id());
        self.apply(pressed);
        if self.state.dialog.is_none() {
            let typed = panels::typed_text(ui.ctx(), &self.state);
            self.apply(typed);
        }

        let mut commands = CommandSender::default();
        self.show_everything(ui, render_state, &mut commands);
        self.apply(commands.take());
        self.layouts.follow(&mut self.state);
        if let Some(seconds) = self.drafts.follow(&mut self.state, self.host.as_mut(), begun_secs) {
            self.egui.request_repaint_after_secs(seconds as f32);
        }
        self.remember();
        let done_secs = self.host.monotonic_secs();
        self.state.frame.cpu_millis = (done_secs - begun_secs) * 1000.0;
        self.note_answer(done_secs);
    }

    /// Notes the first frame that shows the answer to the present text.
    fn note_answer(&mut self, done_secs: f64) {
        let revision = self.state.document.revision();
        let is_shown = self.state.shown().is_some_and(|shown| shown.revision == revision);
        let is_noted = self.state.frame.answer.is_some_and(|answer| answer.revision == revision);
        if is_shown && !is_noted && self.state.status() != Status::Working {
            let cpu_millis = self.state.frame.cpu_millis;
            self.state.frame.answer = Some(AnswerFrame { revision, done_secs, cpu_millis });
            self.version += 1;
        }
    }

    fn begin_frame(&mut self, now_secs: f64) {
        let elapsed_secs = (now_secs - self.last_secs).clamp(0.0, 0.25);
        self.last_secs = now_secs;
        self.state.frame.now_secs = now_secs;
        self.state.frame.unix_millis = self.host.unix_millis();
        while let Some(event) = self.host.poll() {
            if let workbench::host::HostEvent::FragmentChanged(fragment) = &event {
                outside::open_fragment(&mut self.state, fragment);
            }
            self.state.receive(event);
            self.version += 1;
        }
        for file in self.egui.input(|input| input.raw.dropped_files.clone()) {
            (self.read_dropped)(file);
        }
        let shown = self.state.shown().cloned();
        if self.state.snapshots.lose_patience(now_secs) {
            self.egui.request_repaint_after_secs(0.1);
            self.state.follow_shown(shown.as_ref());
        }
        if self.state.search.is_playing {
            let shown = self.state.shown().cloned();
            if self.state.search.advance(elapsed_secs, shown.as_ref()) {
                self.state.reveal_step();
                self.version += 1;
            }
            self.egui.request_repaint_after_secs(if self.state.search.steps_per_sec > 20.0 {
                0.0
            } else {
                0.05
            });
        }
        if self.state.terrain.growth.is_playing {
            let rate = self.state.playback.rate;
            self.version += u64::from(self.state.terrain.growth.advance(elapsed_secs, rate));
            self.egui.request_repaint_after_secs(0.02);
        }
        if self.state.automaton.is_playing {
            let rate = self.state.playback.rate;
            self.version += u64::from(self.state.automaton.advance(elapsed_secs, rate));
            self.egui.request_repaint_after_secs(0.05);
        }
        if self.state.playback.is_playing {
            self.state.playback.advance(elapsed_secs);
            self.state.follow_run();
            self.version += 1;
            self.egui.request_repaint();
        }
        if let Some(seconds) = self.state.toasts.advance(now_secs) {
            self.egui.request_repaint_after_secs(seconds as f32);
        }
        self.do_effects();
    }

    fn show_everything(
        &mut self,
        ui: &mut Ui,
        render_state: Option<&RenderState>,
        commands: &mut CommandSender,
    ) {
        let layout_millis = Cell::new(None);
        let host = self.host.as_ref();
        let clock = || host.monotonic_secs();
        let context = Context {
            state: &self.state,
            snapshot: self.state.looked_at(),
            is_stale: self.state.snapshots.is_stale(self.state.document.revision()),
            tokens: panels::tokens(self.state.settings.theme),
            render_state,
            now_secs: self.state.frame.now_secs,
            clock: &clock,
            layout_millis: &layout_millis,
        };
        bar::top::show(ui, &context, commands);
        bar::bottom::show(ui, &context, commands);
        self.layouts.fit(Room::of(ui.ctx().content_rect().size()));
        let tree = self.layouts.tree_mut(self.state.arrangement());
        let mut shown = Vec::new();
        CentralPanel::default().frame(Frame::new().fill(context.tokens.background)).show(ui, |ui| {
            let mut tiles =
                PanelTiles { panels: &mut self.panels, context: &context, commands, shown: Vec::new() };
            tree.ui(&mut tiles, ui);
            panels::walk::follow(ui, tiles.context, tiles.commands);
            shown = tiles.shown;
        });
        dialog::show(ui.ctx(), &context, commands);
        toasts::show(ui.ctx(), &context, commands);
        if let Some(millis) = layout_millis.get() {
            self.state.frame.layout_millis = millis;
            self.version += 1;
        }
        let is_editor_shown = shown.contains(&PanelKind::Editor);
        self.state.panels_on_screen = shown;
        if is_editor_shown {
            // The editor has scrolled and taken the focus as it was asked to.
            self.state.editor.reveal = None;
            self.state.editor.wants_focus &= self.state.dialog.is_some();
        }
    }

    fn apply(&mut self, commands: Vec<Command>) {
        if commands.is_empty() {
            return;
        }
        for command in commands {
            self.state.apply(command);
        }
        self.layouts.follow(&mut self.state);
        self.version += 1;
        self.do_effects();
        self.egui.request_repaint();
    }

    fn do_effects(&mut self) {
        for effect in self.state.take_effects() {
            match effect {
                Effect::Copy(text) => self.egui.copy_text(text),
                Effect::OpenFile(kind) => self.host.open_file(kind),
                Effect::SaveFile { name, bytes } => self.host.save_file(&name, bytes),
                Effect::SavePicture { name, svg, size } => self.host.save_picture(&name, svg, size),
                Effect::CopyLink => self.copy_link(),
                Effect::Post(request) => self.host.post(request),
                Effect::DropFocus => self.egui.memory_mut(|memory| {
                    if let Some(focused) = memory.focused() {
                        memory.surrender_focus(focused);
                    }
                }),
                Effect::KeepReview { joins } => {
                    outside::keep_review(self.host.as_mut(), &mut self.state, joins);
                }
                Effect::RecallReview => outside::recall_review(self.host.as_ref(), &mut self.state),
                Effect::Restyle => {
                    let Settings { theme, text_scale, .. } = self.state.settings;
                    theme::apply(&self.egui, panels::tokens(theme), text_scale);
                }
            }
        }
        self.post_text();
        self.post_run();
    }

    /// Asks for the present text to be worked out, unless that was asked for already.
    fn post_text(&mut self) {
        let wanted =
            Posted { revision: self.state.document.revision(), settings: self.state.settings.plan.clone() };
        if self.posted.as_ref() == Some(&wanted) {
            return;
        }
        // The same text planned in another way is a new revision: answers must be told apart.
        if self.posted.as_ref().is_some_and(|posted| posted.revision == wanted.revision) {
            self.state.document.touch();
        }
        let revision = self.state.document.revision();
        let PlanSettings { goal, search, seed, trace } = wanted.settings.clone();
        let source = self.state.document.shared_text();
        self.host.post(Request::Update(Update { revision, source, goal, search, seed, trace }));
        self.posted = Some(Posted { revision, ..wanted });
    }

    /// Asks for the run that is watched to be worked out, unless that was asked for already.
    fn post_run(&mut self) {
        if let Some(request) = self.state.run_to_ask_for() {
            self.host.post(request);
        }
    }

    fn copy_link(&mut self) {
        let fragment = outside::fragment(&self.state);
        match self.host.link(&fragment) {
            Some(link) => {
                self.egui.copy_text(link);
                self.state.toasts.add(ToastKind::Done, "The link is on the clipboard");
            }
            None => self.state.toasts.add(ToastKind::Failed, "Links work in the web page only"),
        }
    }

    /// Keeps settings and layouts when they have changed and nobody is dragging.
    fn remember(&mut self) {
        if self.egui.input(|input| input.pointer.any_down()) {
            return;
        }
        if self.stored != self.state.settings {
            self.stored = self.state.settings.clone();
            outside::remember_settings(self.host.as_mut(), &self.stored);
        }
        self.layouts.remember(self.host.as_mut());
    }
}

impl eframe::App for Enroute {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let render_state = frame.wgpu_render_state().cloned();
        self.state.frame.whole_millis = frame.info().cpu_usage.map(|seconds| f64::from(seconds) * 1000.0);
        self.show(ui, render_state.as_ref());
    }

    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        panels::tokens(self.state.settings.theme).background.to_normalized_gamma_f32()
    }

    #[cfg(target_arch = "wasm32")]
    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(self)
    }
}

impl Remote for Enroute {
    fn open(&mut self, name: &str) -> Result<(), RemoteError> {
        if mission_file::example(name).is_none() {
            return Err(RemoteError::UnknownMission {
                name: name.to_owned(),
                known: EXAMPLES.iter().map(|example| example.name.to_owned()).collect(),
            });
        }
        self.run(Command::OpenExample(name.into()));
        Ok(())
    }

    fn set_source(&mut self, text: &str) {
        self.run(Command::SetSource(text.to_owned()));
    }

    fn source(&self) -> String {
        self.state.document.text().to_owned()
    }

    fn dispatch(&mut self, command: &str, arguments: &Value) -> Result<(), RemoteError> {
        let command = command::from_json(&self.state, command, arguments)?;
        self.run(command);
        Ok(())
    }

    fn state(&self) -> Value {
        outside::state_json(&self.state)
    }

    fn state_version(&self) -> u64 {
        self.version
    }
}

/// Shows panels in the tiles of the layout.
struct PanelTiles<'a> {
    panels: &'a mut Panels,
    context: &'a Context<'a>,
    commands: &'a mut CommandSender,
    /// The panels that were shown in this frame.
    shown: Vec<PanelKind>,
}

impl Behavior<PanelKind> for PanelTiles<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, kind: &mut PanelKind) -> UiResponse {
        self.shown.push(*kind);
        let rect = ui.max_rect();
        ui.painter().rect_filled(rect, 0.0, self.context.tokens.surface);
        let pressed = ui.input(|input| {
            input.pointer.any_pressed() && input.pointer.interact_pos().is_some_and(|at| rect.contains(at))
        });
        if pressed && self.context.state.active_panel != *kind && self.context.state.dialog.is_none() {
            self.commands.send(Command::Activate(*kind));
        }
        ui.push_id(kind.name(), |ui| self.panels.show(*kind, ui, self.context, self.commands));
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
        if tab.is_closed
            && let Some(kind) = kind
        {
            self.commands.send(Command::ClosePanel(kind));
        }
        tab.response
    }

    fn is_tab_closable(&self, _tiles: &Tiles<PanelKind>, _tile: TileId) -> bool {
        true
    }

    fn tab_bar_height(&self, _style: &egui::Style) -> f32 {
        28.0
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
