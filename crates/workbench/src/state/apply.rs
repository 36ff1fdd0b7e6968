//! How commands change the state. What only the host can do is left as an [`Effect`].

use std::sync::Arc;

use interchange::is_network_file;
use link::{Request, Response};
use review::Record;
use review::rules::RULES_FORMAT;
use rmpl::Span;
use smol_str::SmolStr;
use snapshot::Snapshot;
use text_editing::TextCommand;

use crate::command::Command;
use crate::host::{FileKind, HostEvent, Save};
use crate::library::{Mission, MissionId, MissionKind};
use crate::limits::{MAX_TEXT_BYTES, too_large};
use crate::mission_file;
use crate::state::chance::ChanceCommand;
use crate::state::program_chance::ProgramChanceCommand;
use crate::state::review::Aside;
use crate::state::search::{self, SearchCommand};
use crate::state::settings::TEXT_SCALES;
use crate::state::terrain::TerrainState;
use crate::state::{AppState, PinCommand, Pins, Selection, ToastKind, playback};
use crate::workspace::Workspace;
use crate::{PanelEffect, PanelKind};

/// Something that the host is to do.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Put text on the clipboard.
    Copy(String),
    /// Let the user choose a file.
    OpenFile(FileKind),
    /// Save the open mission to its file, or these files where the host cannot do that.
    Save(Save, Vec<(String, Vec<u8>)>),
    /// A mission is saved from now on to the file that was opened with this token.
    KeepFile(MissionId, u32),
    /// Let the user save a file.
    SaveFile {
        /// The name to suggest.
        name: String,
        bytes: Vec<u8>,
    },
    /// Let the user save a picture as a PNG.
    SavePicture {
        /// The name to suggest.
        name: String,
        /// The picture as an SVG.
        svg: String,
        /// Width and height in pixels.
        size: [u32; 2],
    },
    /// Put a link to the present view on the clipboard.
    CopyLink,
    /// Send something to the planning core.
    Post(Request),
    /// Take back everything that the planning core was asked.
    Stop,
    /// Keep what reviewers said of the open mission.
    KeepReview {
        /// Whether what is kept already, perhaps by another tab, is joined with it.
        joins: bool,
    },
    /// Find what reviewers said of the open mission.
    RecallReview,
    /// Add to what reviewers said of the open mission.
    JoinReview(Box<Record>),
    /// Keep what came as the review of the open mission and cannot be used.
    SetReviewAside(Aside),
    /// Read a map of a mission from where it is kept.
    ReadMap(MissionId, SmolStr),
    /// Let the address name what is open, so that loading the page again finds it.
    ShowAddress,
    /// The appearance changed.
    Restyle,
}

impl AppState {
    /// Does what a command asks for.
    pub fn apply(&mut self, command: Command) {
        self.do_command(command);
        self.language.follow(&self.document);
        self.editor.folding.follow(&mut self.document, self.language.parse());
        self.automaton.follow(&self.document, self.language.is_control());
        self.follow_lesson();
        self.ask_the_core();
        self.follow_review();
        self.follow_run();
    }

    pub(super) fn do_command(&mut self, command: Command) {
        match command {
            Command::OpenExample(name) => self.open_example(&name),
            Command::OpenSource { name, source } => {
                if self.refuses_text(source.len()) {
                    return;
                }
                self.open_original(name, MissionKind::Shared, &source);
            }
            Command::Library(command) => self.apply_to_library(command),
            Command::Files(command) => self.apply_to_files(command),
            Command::OpenFile(kind) => self.effects.push(Effect::OpenFile(kind)),
            Command::SaveMission => self.save(false),
            Command::CopyLink => self.effects.push(Effect::CopyLink),

            Command::SetSource(text) => {
                if !self.refuses_text(text.len()) {
                    self.document.replace_all(&text);
                }
            }
            Command::Text(command) => {
                let pasted = if let TextCommand::Paste(text) = &command { text.len() } else { 0 };
                if pasted == 0 || !self.refuses_text(pasted + self.document.text().len()) {
                    self.type_text(&command);
                }
            }
            Command::Edit { edits, kind } => self.document.edit(&edits, kind, None),
            Command::Reveal(span) => {
                self.reveal(span);
                self.select_at(span.start);
            }
            Command::Editor(command) => self.apply_to_editor(command),

            Command::Select(selection) => self.select(selection),
            Command::SelectAndReveal(selection) => {
                let span = self.shown().and_then(|shown| selection.span(shown));
                self.selection = selection;
                if let Some(span) = span.filter(|_| !self.snapshots.is_stale(self.document.revision())) {
                    self.reveal(span);
                }
            }
            Command::Hover(selection) => self.hovered = selection,

            Command::Terrain(command) => self.apply_to_terrain(command),
            Command::Seek(time) => self.playback.seek(time),
            Command::Transport(command) => self.apply_to_transport(command),
            Command::Automaton(command) => self.automaton.apply(command),
            Command::Execution(command) => self.apply_to_run(command),
            Command::Chance(ChanceCommand::Start) if self.automaton.is_control() => {
                self.apply_to_program_chance(ProgramChanceCommand::Start);
            }
            Command::Chance(ChanceCommand::Stop) if self.automaton.is_control() => {
                self.apply_to_program_chance(ProgramChanceCommand::Stop);
            }
            Command::Chance(command) => self.apply_to_chance(command),
            Command::ProgramChance(command) => self.apply_to_program_chance(command),
            Command::Search(command) => self.apply_to_search(command),
            Command::TurnPanel(forwards) => self.turn_panel(forwards),
            Command::SetRate(rate) => self.set_rate(rate),

            Command::Review(command) => self.apply_to_review(command),
            Command::Compare(command) => {
                self.show_panel(PanelKind::Compare);
                self.apply_to_compare(&command);
            }
            Command::WriteReport => self.write_report(),
            Command::WriteSchedule { form, epoch } => {
                self.dialog = None;
                self.write_schedule(form, &epoch);
            }
            Command::Lesson(command) => self.apply_to_lesson(command),
            Command::Manual(command) => self.apply_to_manual(command),
            Command::Pins(command) => self.apply_to_pins(command),
            Command::ShowReason(index) => self.reason = index,
            Command::SelectTimes(range) => {
                self.time_range = range.map(|[from, to]| [from.min(to), from.max(to)]);
            }

            Command::SetGoal(goal) => self.settings.plan.goal = goal,
            Command::SetSearch(search) => self.settings.plan.search = search,
            Command::SetSeed(seed) => self.settings.plan.seed = seed,
            Command::StopWork => {
                self.effects.push(Effect::Stop);
                self.give_up(Some(self.document.revision()));
            }
            Command::PlanAgain => self.document.touch(),
            Command::SetTrace(trace) => self.settings.plan.trace = trace,

            Command::ShowWorkspace(workspace) => {
                self.maximized = None;
                if self.workspace == Workspace::Teach && workspace != Workspace::Teach {
                    // A step of the search is no plan: elsewhere it would be taken for one.
                    self.search.close();
                }
                self.workspace = workspace;
                self.lesson.put_away();
                // A lecturer steps through the search; it must have been recorded.
                self.settings.plan.trace |= workspace == Workspace::Teach;
                match workspace {
                    Workspace::Teach => self.focus_panel(PanelKind::Search),
                    Workspace::Review => self.active_panel = PanelKind::Review,
                    Workspace::Author | Workspace::Execute => {}
                }
                if workspace == Workspace::Execute && !self.language.is_control() {
                    self.show_panel(PanelKind::Execution);
                    self.active_panel = PanelKind::Timeline;
                }
                self.fit_time();
            }
            Command::ResetWorkspace => {
                self.maximized = None;
                self.panel_effects.push(PanelEffect::ResetLayout);
            }
            Command::ShowPanel(panel) => {
                self.maximized = self.maximized.filter(|&maximized| maximized == panel);
                self.show_panel(panel);
                self.active_panel = panel;
            }
            Command::ClosePanel(panel) => {
                self.maximized = self.maximized.filter(|&maximized| maximized != panel);
                self.panel_effects.push(PanelEffect::Close(panel));
            }
            Command::Maximize(panel) => {
                self.maximized = match self.maximized {
                    Some(_) => None,
                    None => Some(panel.unwrap_or(self.active_panel)),
                };
                if let Some(panel) = self.maximized {
                    self.show_panel(panel);
                    self.active_panel = panel;
                }
            }
            Command::Activate(panel) => self.active_panel = panel,
            Command::View(action) => {
                let active = self.active_panel;
                let panel = if active.is_zoomable() { active } else { PanelKind::Network };
                self.request_view(panel, action);
            }
            Command::ViewOf(panel, action) => self.request_view(panel, action),
            Command::SetViews(views) => self.settings.views = *views,
            Command::SetTheme(theme) => {
                self.settings.theme = theme;
                self.effects.push(Effect::Restyle);
            }
            Command::SetTextScale(scale) => {
                let [least, most] = TEXT_SCALES;
                self.settings.text_scale = ((scale * 10.0).round() / 10.0).clamp(least, most);
                self.effects.push(Effect::Restyle);
            }

            Command::ShowDialog(dialog) => self.dialog = Some(dialog),
            Command::CloseDialog => self.dialog = None,
            Command::Escape => self.escape(),
            Command::Notify(kind, text) => self.toasts.add(kind, text),
            Command::DismissToast(index) => self.toasts.dismiss(index),
            Command::Copy(text) => self.effects.push(Effect::Copy(text)),
            Command::WriteNetwork(form) => self.write_network(form),
            Command::SaveNetwork(format) => {
                self.panel_effects.push(PanelEffect::SaveDrawing(format));
                self.show_panel(PanelKind::Network);
            }
            Command::SaveFile { name, bytes } => self.effects.push(Effect::SaveFile { name, bytes }),
            Command::SavePicture { name, svg, size } => {
                self.effects.push(Effect::SavePicture { name, svg, size });
            }
        }
    }

    /// Takes in something that happened outside.
    pub fn receive(&mut self, event: HostEvent) {
        self.take(event);
        self.follow_lesson();
        self.ask_the_core();
    }

    fn take(&mut self, event: HostEvent) {
        match event {
            HostEvent::Answer(Response::Snapshot(snapshot)) => self.take_snapshot(snapshot),
            HostEvent::Answer(Response::Map { key, map }) => {
                self.maps.insert(key, map);
            }
            HostEvent::Answer(Response::Searches(comparison)) => {
                let shown = self.snapshots.shown().cloned();
                self.search.take_comparison(comparison, shown.as_ref(), self.settings.plan.search);
            }
            HostEvent::Answer(Response::MapAccepted { name, cells: [width, height], no_data_cells }) => {
                if self.keep_map(&name) {
                    self.take_map(&name, [width, height], no_data_cells);
                }
                self.document.touch();
            }
            HostEvent::Answer(Response::MapRejected { name, reason }) => {
                self.maps_in_hand.remove(&name);
                self.toasts.add(ToastKind::Failed, format!("The map {name} cannot be used: {reason}"));
            }
            HostEvent::Answer(Response::PlacesRead { name, lines }) => self.take_places(&name, &lines),
            HostEvent::FragmentChanged(_) | HostEvent::Shelf(_) | HostEvent::TabSaid(_) => {}
            HostEvent::Answer(Response::Review { revision, review }) => self.take_review(revision, review),
            HostEvent::Answer(Response::Evaluated { token, snapshot }) => {
                self.take_evaluated(token, &snapshot);
            }
            HostEvent::Answer(answer @ (Response::Execution(_) | Response::NotExecuted { .. })) => {
                self.take_run(answer);
            }
            HostEvent::Answer(Response::ControlRun(standing)) => self.automaton.take(*standing),
            HostEvent::Answer(Response::PathGrowth(standing)) => self.terrain.growth.take(*standing),
            HostEvent::Answer(answer @ Response::Sampled { .. }) => self.take_sample(answer),
            HostEvent::Answer(answer @ Response::ProgramSampled { .. }) => self.take_program_sample(answer),
            HostEvent::CoreFailed { message, revision } => {
                self.give_up(revision);
                self.toasts.add(
                    ToastKind::Failed,
                    format!(
                        "Planning stopped and was started anew. Edit the text, or plan again. ({message})"
                    ),
                );
            }
            HostEvent::CoreRestarted { message } => {
                let words = format!("Planning was interrupted ({message}) and has begun again");
                self.toasts.add(ToastKind::Info, words);
            }
            HostEvent::FileOpened { kind, name, bytes, token } => {
                // What the text imports decides on what a file is for, also where the text came just now.
                self.language.follow(&self.document);
                let open_before = self.library.open_id().cloned();
                self.open_file(kind, &name, bytes);
                // A file that became part of another mission is not that mission's own; nor is that of a network, which
                // other tools have written.
                let token = token.filter(|_| !self.language.is_network());
                let opened = self.library.open_id().filter(|id| open_before.as_ref() != Some(id)).cloned();
                self.effects.extend(opened.zip(token).map(|(id, token)| Effect::KeepFile(id, token)));
            }
            HostEvent::FileSaved { name, revision } => {
                if self.document.revision() == revision {
                    self.document.mark_saved();
                }
                self.toasts.add(ToastKind::Done, format!("Saved to {name}"));
            }
            HostEvent::FileFailed { name, reason } => {
                let place = if name.is_empty() { String::new() } else { format!("{name}: ") };
                self.toasts.add(ToastKind::Failed, format!("{place}{reason}"));
            }
        }
        self.follow_review();
    }

    /// Waits for nothing any more of what the core was asked about `revision` of the text, or about any.
    fn give_up(&mut self, revision: Option<u64>) {
        self.search.give_comparison_up(revision);
        self.give_up_review();
        self.compare.give_up();
        self.automaton.give_up();
        self.chance.give_up();
        self.execution.give_up();
        if let Some(revision) = revision {
            self.snapshots.give_up(revision);
        }
    }

    pub(crate) fn apply_to_search(&mut self, command: SearchCommand) {
        let shown = self.snapshots.shown().cloned();
        self.search.apply(command, shown.as_ref());
        self.reveal_step();
    }

    /// Shows in the editor what a new step is about; the caret stays where it is.
    pub(crate) fn reveal_step(&mut self) {
        if self.snapshots.is_stale(self.document.revision()) {
            return;
        }
        let Some(view) = self.search.shown() else { return };
        let focus = search::Focus::of(view.recording.network(), view.recording.trace(), &view.step);
        if let Some(&span) = focus.spans.first() {
            self.scroll_to(span, true);
        }
    }

    /// Shows a step of the search, counted from 1: at once if it is recorded, otherwise as soon as it is.
    pub fn want_step(&mut self, step: usize) {
        match self.snapshots.shown().cloned() {
            Some(shown)
                if search::recorded(&shown).is_some()
                    && !self.snapshots.is_stale(self.document.revision()) =>
            {
                let target = step.checked_sub(1).map_or(SearchCommand::Close, SearchCommand::GoTo);
                self.search.apply(target, Some(&shown));
            }
            _ => self.search.want_step(step),
        }
    }

    /// Asks the core for what the state now wants to know.
    pub fn ask_the_core(&mut self) {
        let shown = self.snapshots.shown().cloned();
        let wanted = self.search.ask_for_comparison(shown.as_ref(), self.document.revision());
        if wanted.is_some()
            && let Some(update) = self.update_planned()
        {
            self.effects.push(Effect::Post(Request::CompareSearches(update)));
        }
        if let Some(wanted) = self.automaton.take_request(&self.document) {
            self.effects.push(Effect::Post(Request::RunControl(wanted)));
        }
        let mut growth = std::mem::take(&mut self.terrain.growth);
        if let Some(wanted) = growth.take_request(|| self.update_shown()) {
            self.effects.push(Effect::Post(Request::GrowPath(wanted)));
        }
        self.terrain.growth = growth;
    }

    /// Turns to the next or the previous panel on screen, and gives it the keyboard.
    fn turn_panel(&mut self, forwards: bool) {
        let panels = &self.panels_on_screen;
        let at = panels.iter().position(|&panel| panel == self.active_panel);
        let next = match (at, forwards) {
            (None, _) => 0,
            (Some(at), true) => (at + 1) % panels.len(),
            (Some(at), false) => (at + panels.len() - 1) % panels.len(),
        };
        if let Some(&panel) = panels.get(next) {
            self.focus_panel(panel);
        }
    }

    /// Gives a panel the keyboard.
    fn focus_panel(&mut self, panel: PanelKind) {
        self.active_panel = panel;
        if panel == PanelKind::Editor {
            self.focus_editor();
        } else {
            self.panel_effects.push(PanelEffect::FocusPanel(panel));
        }
    }

    /// Takes a new snapshot and carries selection and time over to it.
    fn take_snapshot(&mut self, snapshot: Arc<Snapshot>) {
        let before = self.snapshots.shown().cloned();
        self.snapshots.take(snapshot, self.frame.now_secs);
        self.follow_shown(before.as_ref());
    }

    /// Adapts selection and time if another snapshot than `before` is shown now.
    pub(crate) fn follow_shown(&mut self, before: Option<&Arc<Snapshot>>) {
        let Some(after) = self.snapshots.shown().cloned() else { return };
        if before.is_some_and(|before| Arc::ptr_eq(before, &after)) {
            return;
        }
        self.search.follow(before, &after);
        let same_plan = |before: &Arc<Snapshot>| match (&before.planning, &after.planning) {
            (Some(before), Some(after)) => Arc::ptr_eq(before, after),
            _ => false,
        };
        if !before.is_some_and(same_plan) {
            self.pins.follow(before.map(Arc::as_ref), &after);
            self.reason = 0;
        }
        if let Some(before) = before {
            self.selection = self.selection.carried(before, &after);
            self.hovered = Selection::None;
        }
        self.fit_time();
        self.follow_with_terrain();
        self.take_picture(&after);
    }

    fn apply_to_pins(&mut self, command: PinCommand) {
        let Some(shown) = self.snapshots.shown().cloned() else { return };
        if let Err(reason) = self.pins.apply(command, &shown) {
            self.toasts.add(ToastKind::Failed, reason);
            return;
        }
        if matches!(command, PinCommand::GoOn | PinCommand::TakeBack | PinCommand::Pin(..))
            && let Some(course) = self.pins.course(&shown)
        {
            self.playback.time = playback::number(course.now);
        }
    }

    fn step_pins_back(&mut self) -> bool {
        let shown = self.snapshots.shown().cloned();
        self.pins.step_back(shown.as_ref())
    }

    pub(super) fn open_example(&mut self, name: &str) {
        if let Some(example) = mission_file::example(name) {
            self.open_original(example.name.into(), MissionKind::Example, example.source);
        }
    }

    pub(super) fn open(&mut self, name: SmolStr, source: &str) {
        self.document.open(source);
        self.editor.popup = None;
        self.editor.folding.unfold_all();
        self.mission = name;
        self.leave_lesson_behind();
        self.leave_review();
        self.snapshots.clear();
        self.automaton.forget();
        self.search.forget();
        self.execution.forget();
        self.turn_to_notation(source);
        self.language.follow(&self.document);
        self.selection = Selection::None;
        self.hovered = Selection::None;
        self.terrain = TerrainState::default();
        self.pins = Pins::default();
        self.time_range = None;
        self.playback = playback::Playback { rate: self.playback.rate, ..Default::default() };
        self.settings.plan.goal = snapshot::Goal::Default;
        self.scroll_to(Span::new(0, 0), false);
        self.dialog = None;
    }

    /// Control programs and missions are looked at in different workspaces.
    fn turn_to_notation(&mut self, source: &str) {
        let is_control = rmpl::control::is_control_text(source);
        if is_control {
            self.workspace = Workspace::Execute;
            self.show_panel(PanelKind::Editor);
            self.show_panel(PanelKind::Automaton);
            self.active_panel = PanelKind::Automaton;
        } else if self.workspace == Workspace::Execute && !self.language.is_control() {
            self.show_panel(PanelKind::Execution);
        } else if self.workspace == Workspace::Execute {
            self.workspace = Workspace::Author;
            self.active_panel = PanelKind::Editor;
        }
    }

    /// Says so if a text of so many bytes is too long for a mission.
    pub(super) fn refuses_text(&mut self, bytes: usize) -> bool {
        let reason = too_large(bytes, MAX_TEXT_BYTES);
        if let Some(reason) = &reason {
            let words = format!("The text is too long for a mission: {reason}. What is open stays as it is");
            self.toasts.add(ToastKind::Failed, words);
        }
        reason.is_some()
    }

    fn open_file(&mut self, kind: FileKind, name: &str, bytes: Vec<u8>) {
        if let Some(reason) = too_large(bytes.len(), kind.max_bytes(name)) {
            let words = format!("{name} is not opened: {reason}. What is open stays as it is");
            self.toasts.add(ToastKind::Failed, words);
            return;
        }
        match kind {
            FileKind::Mission => self.open_mission_file(name, bytes),
            FileKind::Map => self.open_map_file(name, bytes),
            FileKind::Lesson => self.open_lesson_file(name, bytes),
            FileKind::Json => match String::from_utf8(bytes) {
                Ok(text) => {
                    let document: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
                    if let Ok(mission) = Mission::from_json(&text) {
                        self.open_whole(mission);
                    } else if is_network_file(&text) {
                        self.open_mission_file(name, text.into_bytes());
                    } else if document["format"] == RULES_FORMAT {
                        self.import_rules(name, &text);
                    } else if document["type"] == "FeatureCollection" {
                        self.open_map_file(name, text.into_bytes());
                    } else if !self.open_run(&document) {
                        self.import_record(name, &text);
                    }
                }
                Err(_) => self.toasts.add(ToastKind::Failed, format!("{name} is not a text file")),
            },
            FileKind::Comparison => match String::from_utf8(bytes) {
                Ok(text) => self.compare_with_file(name, &text),
                Err(_) => self.toasts.add(ToastKind::Failed, format!("{name} is not a text file")),
            },
        }
    }

    pub(super) fn request_view(&mut self, panel: PanelKind, action: crate::command::ViewAction) {
        self.panel_effects.push(PanelEffect::View(panel, action));
    }

    fn escape(&mut self) {
        if self.dialog.take().is_some() {
            return;
        }
        if self.editor.popup.take().is_some() {
            return;
        }
        if !self.document.other_carets().is_empty() {
            text_editing::TextCommand::OneCaret.apply(&mut self.document);
            return;
        }
        if self.document.has_stops() {
            self.document.leave_template();
            return;
        }
        if self.editor.find.take().is_some() {
            self.focus_editor();
        } else if self.escape_from_terrain() {
            // The tool was put away, or what it had.
        } else if self.search.step().is_some() {
            self.search.close();
        } else if self.pins.held().is_some() {
            self.step_pins_back();
        } else if self.time_range.take().is_none() && !self.step_pins_back() {
            self.selection = Selection::None;
        }
    }
}
