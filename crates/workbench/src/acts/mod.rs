//! What is done: a command goes to the part of the state that owns it, and what takes several parts is done here.
//!
//! `AppState::route` says which command goes where. After it, `derived` computes what depends on what has
//! changed.

mod answers;
mod derived;
mod documents;
mod drawing;
mod lesson;
mod missions;
mod opening;
mod parts;
mod prediction;
mod showing;
mod transport;

use link::Request;
use text_editing::TextCommand;

use crate::command::Command;
use crate::effect::Effect;
use crate::library::MissionKind;
use crate::limits::{MAX_TEXT_BYTES, too_large};
use crate::panel_effect::ViewAction;
use crate::panel_kind::PanelKind;
use crate::state::AppState;
use crate::state::chance::ChanceCommand;
use crate::state::contradict::ContradictCommand;
use crate::state::execution::ExecutionCommand;
use crate::state::pins::PinCommand;
use crate::state::playback;
use crate::state::program_chance::ProgramChanceCommand;
use crate::state::rule_proof::RuleProofCommand;
use crate::state::search::{self, SearchCommand};
use crate::state::selection::Selection;
use crate::state::terrain::{Film, TerrainCommand, Tool};
use crate::workspace::Workspace;

pub use transport::{Advanced, Track};

impl AppState {
    /// Does what a command asks for, and computes what depends on what it changed.
    pub fn apply(&mut self, command: Command) {
        self.route(command);
        self.derive();
    }

    /// Sends a command to the part that owns it.
    fn route(&mut self, command: Command) {
        match command {
            Command::OpenExample(name) => self.open_example(&name),
            Command::OpenSource { name, source } => {
                if !self.refuses_text(source.len()) {
                    self.open_original(name, MissionKind::Shared, &source);
                }
            }
            Command::Library(command) => self.apply_to_library(command),
            Command::Files(command) => self.writing().apply_to_files(command),
            Command::SaveMission => self.save(false),

            Command::SetSource(text) => {
                if !self.refuses_text(text.len()) {
                    self.document.replace_all(&text);
                }
            }
            Command::Text(command) => {
                let pasted = if let TextCommand::Paste(text) = &command { text.len() } else { 0 };
                if pasted == 0 || !self.refuses_text(pasted + self.document.text().len()) {
                    self.writing().type_text(&command);
                }
            }
            Command::Edit { edits, kind } => self.document.edit(&edits, kind, None),
            Command::Draw(command) => self.apply_to_drawing(command),
            Command::Reveal(span) => {
                let mut text = self.writing();
                text.reveal(span);
                text.select_at(span.start);
            }
            Command::Editor(command) => self.writing().apply(command),

            Command::Select(selection) => self.writing().select(selection),
            Command::SelectAndReveal(selection) => self.writing().select_and_reveal(selection),
            Command::Hover(selection) => self.hovered = selection,
            Command::SelectTimes(range) => {
                self.time_range = range.map(|[from, to]| [from.min(to), from.max(to)]);
            }
            Command::ShowReason(index) => self.reason = index,

            Command::Terrain(command) => self.apply_to_terrain(command),
            Command::Seek(time) => self.playback.seek(time),
            Command::SetRate(rate) => self.playback.set_rate(rate),
            Command::Transport(command) => self.apply_to_transport(command),
            Command::Pins(command) => self.apply_to_pins(command),
            Command::Automaton(command) => self.automaton.apply(command),
            Command::Execution(command) => self.apply_to_run(command),
            Command::Chance(ChanceCommand::Start) if self.automaton.is_control() => {
                self.apply_to_program_chance(ProgramChanceCommand::Start);
            }
            Command::Chance(ChanceCommand::Stop) if self.automaton.is_control() => {
                self.apply_to_program_chance(ProgramChanceCommand::Stop);
            }
            Command::Chance(command) => self.apply_to_chance(command),
            Command::Contradict(command) => self.apply_to_contradict(command),
            Command::RuleProof(command) => self.apply_to_rule_proof(command),
            Command::ProgramChance(command) => self.apply_to_program_chance(command),
            Command::ProgramProof(command) => {
                self.automaton.apply_to_proof(command, &self.document);
            }
            Command::Search(command) => self.apply_to_search(command),

            Command::Review(command) => self.reviewing().apply(command),
            Command::Compare(command) => {
                self.window.show(PanelKind::Compare);
                let shown = self.snapshots.shown().map(AsRef::as_ref);
                self.compare.apply(&command, shown, self.review.record(), &mut self.window);
            }
            Command::WriteReport => self.write_report(),
            Command::WriteSchedule { form, epoch } => {
                self.window.dialog = None;
                self.write_schedule(form, &epoch);
            }
            Command::WriteNetwork(form) => self.write_network(form),

            Command::Lesson(command) => self.apply_to_lesson(command),
            Command::Manual(command) => {
                let about_text = self.about_text(&command);
                self.manual.apply(command, about_text, &mut self.window);
            }

            Command::Settings(command) => self.settings.apply(command, &mut self.window),
            Command::StopWork => {
                self.window.ask(Effect::Stop);
                self.give_up(Some(self.document.revision()));
            }
            Command::PlanAgain => self.document.touch(),

            Command::ShowWorkspace(workspace) => self.show_workspace(workspace),
            Command::Window(command) => self.window.apply(command),
            Command::Escape => self.escape(),
        }
    }

    fn apply_to_terrain(&mut self, command: TerrainCommand) {
        match (&command, self.terrain.film) {
            (TerrainCommand::ToggleVideo, Some(_)) => return self.end_film(),
            (TerrainCommand::ToggleVideo, None) if self.playback.end <= 0.0 => {
                return self.window.failed("Plan the mission first, then record a video");
            }
            // The video begins with the run.
            (TerrainCommand::FilmArea(_), Some(Film::Wanted)) => {
                self.playback.seek(0.0);
                self.playback.play();
            }
            (TerrainCommand::View(ViewAction::Tour), _) => self.playback.play(),
            _ => {}
        }
        let (terrain, settings, mut text) = self.on_terrain();
        terrain.apply(command, settings, &mut text);
    }

    fn apply_to_pins(&mut self, command: PinCommand) {
        let Some(shown) = self.snapshots.shown().cloned() else { return };
        if let Err(reason) = self.pins.apply(command, &shown) {
            self.window.failed(reason);
            return;
        }
        if matches!(command, PinCommand::GoOn | PinCommand::TakeBack | PinCommand::Pin(..))
            && let Some(course) = self.pins.course(&shown)
        {
            self.playback.time = playback::number(course.now);
        }
    }

    fn apply_to_run(&mut self, command: ExecutionCommand) {
        if let ExecutionCommand::Appear { again, .. } = command {
            if !again {
                self.terrain.tool = Tool::Look;
            }
            if !self.is_executing() {
                self.window.failed("Run the mission first, then add an obstacle");
                return;
            }
        }
        let mission = (self.mission.as_str(), self.settings.plan.seed);
        self.execution.apply(command, mission, &mut self.playback, &mut self.window);
    }

    fn apply_to_chance(&mut self, command: ChanceCommand) {
        let planned = self.update_with_plan().zip(self.shown()).map(|(update, shown)| {
            let map = shown.map.as_ref();
            let content = review::content_hash(&update.source, map, &update.goal, update.seed);
            (update, content)
        });
        let ended = self.chance.apply(command, planned, &mut self.window);
        self.keep_ended_runs(ended);
    }

    fn apply_to_contradict(&mut self, command: ContradictCommand) {
        let review = self.review.current().cloned();
        match command {
            ContradictCommand::Stop => self.contradict.give_up(),
            ContradictCommand::Start(only) => match self.update_with_plan().zip(review) {
                Some((update, review)) => {
                    let now_secs = self.frame.now_secs;
                    self.contradict.start(update, review, only, now_secs, &mut self.window);
                }
                None => self.window.failed("Review the current text first"),
            },
            ContradictCommand::Replay(line) => {
                let script = review.and_then(|review| self.contradict.script(&review, &line));
                if let Some(script) = script {
                    self.show_workspace(Workspace::Execute);
                    self.apply_to_run(ExecutionCommand::Replay(Box::new(script)));
                }
            }
        }
    }

    fn apply_to_rule_proof(&mut self, command: RuleProofCommand) {
        let hash = self.review.current().map(|review| review.content_hash.clone());
        match command {
            RuleProofCommand::Stop => {
                self.window.ask(Effect::Stop);
                self.rule_proof.give_up();
            }
            RuleProofCommand::Start(only) => match self.update_with_plan().zip(hash) {
                Some((update, hash)) => {
                    let rules = self.review.record().rules().rules.iter();
                    let rules = rules.filter(|rule| only.as_ref().is_none_or(|only| *only == rule.rule));
                    let rules = rules.cloned().collect();
                    self.rule_proof.start(update, hash, rules, &mut self.window);
                }
                None => self.window.failed("Review the current text first"),
            },
            RuleProofCommand::Open(rule) => {
                let found = hash.and_then(|hash| self.rule_proof.counterexample(&hash, &rule).cloned());
                let Some(found) = found else { return };
                if found.is_own {
                    self.show_workspace(Workspace::Execute);
                    self.apply_to_run(ExecutionCommand::Replay(Box::new(found.script)));
                } else {
                    self.window.show(PanelKind::Compare);
                    let name = format!("plan that can violate “{rule}”");
                    self.compare.show_plan(&name, &found.plan, &mut self.window);
                }
            }
        }
    }

    /// Holds the reviews against runs that have ended, and keeps these with the mission.
    fn keep_ended_runs(&mut self, content: Option<String>) {
        if let Some(content) = content {
            let mut reviewing = self.reviewing();
            reviewing.judge();
            reviewing.keep_runs(&content);
        }
    }

    fn apply_to_program_chance(&mut self, command: ProgramChanceCommand) {
        self.automaton.apply_to_chance(command, &self.document, &mut self.window);
    }

    fn apply_to_search(&mut self, command: SearchCommand) {
        let shown = self.snapshots.shown().cloned();
        self.search.apply(command, shown.as_ref());
        self.reveal_step();
    }

    /// Shows in the editor what a new step is about; the caret stays where it is.
    fn reveal_step(&mut self) {
        if self.snapshots.is_stale(self.document.revision()) {
            return;
        }
        let Some(view) = self.search.shown() else { return };
        let focus = search::Focus::of(view.recording.network(), view.recording.trace(), &view.step);
        if let Some(&span) = focus.spans.first() {
            self.window.scroll_to(span, true);
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

    fn show_workspace(&mut self, workspace: Workspace) {
        self.window.maximized = None;
        if self.window.workspace == Workspace::Teach && workspace != Workspace::Teach {
            // A step of the search is not a plan: elsewhere it would be taken for one.
            self.search.close();
        }
        self.window.workspace = workspace;
        self.lesson.put_away();
        // A lecturer steps through the search; it must have been recorded.
        self.settings.plan.trace |= workspace == Workspace::Teach;
        match workspace {
            Workspace::Teach => self.window.focus_panel(PanelKind::Search),
            Workspace::Review => self.window.active_panel = PanelKind::Review,
            Workspace::Execute if !self.language.is_control() => {
                self.window.show(PanelKind::Execution);
                self.window.active_panel = PanelKind::Timeline;
            }
            Workspace::Author | Workspace::Execute => {}
        }
    }

    /// Waits for nothing any more of what the core was asked about `revision` of the text, or about any.
    fn give_up(&mut self, revision: Option<u64>) {
        self.search.give_comparison_up(revision);
        self.review.give_up();
        self.compare.give_up();
        self.automaton.give_up();
        self.chance.give_up();
        self.contradict.give_up();
        self.rule_proof.give_up();
        self.execution.give_up();
        if let Some(revision) = revision {
            self.snapshots.give_up(revision);
        }
    }

    /// Returns what the planning core is to execute, if it was not asked already.
    pub(crate) fn run_to_ask_for(&mut self) -> Option<Request> {
        let update = self.update_with_plan().filter(|_| self.window.workspace == Workspace::Execute)?;
        if self.execution.is_asked(&update) { None } else { Some(self.execution.request(update)) }
    }

    /// Says so if a text of so many bytes is too long for a mission.
    fn refuses_text(&mut self, bytes: usize) -> bool {
        let reason = too_large(bytes, MAX_TEXT_BYTES);
        if let Some(reason) = &reason {
            let words = format!("Text too long: {reason}. Your current mission is unchanged.");
            self.window.failed(words);
        }
        reason.is_some()
    }

    /// Leaves what is on top, one thing at a time.
    fn escape(&mut self) {
        if self.window.dialog.take().is_some() || self.editor.popup.take().is_some() {
            return;
        }
        if !self.document.other_carets().is_empty() {
            TextCommand::OneCaret.apply(&mut self.document);
            return;
        }
        if self.document.has_stops() {
            self.document.leave_template();
            return;
        }
        if self.editor.find.take().is_some() {
            self.window.focus_editor();
        } else if self.terrain.escape() {
            // The tool was put away, or what it had.
        } else if self.search.step().is_some() {
            self.search.close();
        } else if self.pins.held().is_some() {
            self.step_pins_back();
        } else if self.time_range.take().is_none() && !self.step_pins_back() {
            *self.selection = Selection::None;
        }
    }

    fn step_pins_back(&mut self) -> bool {
        let shown = self.snapshots.shown().cloned();
        self.pins.step_back(shown.as_ref())
    }
}
