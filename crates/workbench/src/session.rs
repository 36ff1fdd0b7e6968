//! The workbench at work: the state, the host that it runs on, and what goes to and fro between them.
//!
//! A window around it calls [`Session::begin_frame`], sends commands by [`Session::apply`], shows the state, and ends
//! by [`Session::end_frame`]; without a window, the same calls run the whole app.

use link::{Request, Since, Source};
use serde_json::Value;
use text_editing::{Document, TextCommand};

use crate::command::Command;
use crate::description::State;
use crate::effect::Effect;
use crate::host::{Host, HostEvent, RemoteError};
use crate::host_io::Remote;
use crate::host_io::{self, Autosave};
use crate::library::LibraryCommand;
use crate::mission_file::{self, EXAMPLES};
use crate::registry;
use crate::state::settings::{PlanSettings, Settings};
use crate::state::snapshots::Status;
use crate::state::{AnswerFrame, AppState};

/// The state with its host.
pub struct Session {
    state: AppState,
    host: Box<dyn Host>,
    posted: Option<Posted>,
    stored: Settings,
    autosave: Autosave,
    window_effects: Vec<WindowEffect>,
    last_secs: f64,
    version: u64,
}

/// Something that only the window around a session can do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WindowEffect {
    /// Put text on the clipboard.
    Copy(String),
    /// Paste what is on the clipboard.
    Paste,
    /// The appearance changed.
    Restyle,
}

/// What the planning core was last asked for.
#[derive(Clone, Debug, PartialEq)]
struct Posted {
    revision: u64,
    settings: PlanSettings,
}

/// Longer texts are not copied with each key, in bytes.
const LONGEST_TEXT_AHEAD: usize = 100_000;
/// Longest time that goes by at once, in seconds: a page that was hidden continues where it was.
const LONGEST_STEP_SECS: f64 = 0.25;

impl Session {
    /// A session on a host, drawn by `renderer` (`webgpu`, `webgl2`, …; empty if unknown): with the settings and the
    /// draft that the host keeps, and with what its address names.
    pub fn new(mut host: Box<dyn Host>, renderer: &str) -> Self {
        let mut state = AppState::new();
        if let Some(settings) = host_io::remembered_settings(host.as_ref()) {
            *state.settings = settings;
        }
        renderer.clone_into(&mut state.frame.renderer);
        state.frame.unix_millis = host.unix_millis();
        let mut autosave = Autosave::start(&mut state, host.as_mut());
        autosave.open_first(&mut state, host.as_ref());
        let stored = state.settings.clone();
        Self {
            last_secs: host.monotonic_secs(),
            state,
            host,
            posted: None,
            stored,
            autosave,
            window_effects: Vec::new(),
            version: 1,
        }
    }

    /// The state, to look at.
    pub fn state(&self) -> &AppState {
        &self.state
    }

    /// The state, for what a front end notes of itself: what is on screen and how its frames went.
    pub fn state_mut(&mut self) -> &mut AppState {
        &mut self.state
    }

    /// Returns what runs around the workbench: clock, files, storage and the planning core.
    pub fn host(&self) -> &dyn Host {
        self.host.as_ref()
    }

    /// The same, to be told something.
    pub fn host_mut(&mut self) -> &mut dyn Host {
        self.host.as_mut()
    }

    /// Takes in what happened outside and lets time go by. Returns the seconds after which the next frame is due, if
    /// one is.
    pub fn begin_frame(&mut self) -> Option<f64> {
        let now_secs = self.host.monotonic_secs();
        let elapsed_secs = (now_secs - self.last_secs).clamp(0.0, LONGEST_STEP_SECS);
        self.last_secs = now_secs;
        self.state.frame.now_secs = now_secs;
        self.state.frame.unix_millis = self.host.unix_millis();
        while let Some(event) = self.host.poll() {
            match event {
                HostEvent::FragmentChanged(fragment) => {
                    host_io::open_fragment(&mut self.state, &fragment);
                }
                HostEvent::Shelf(news) => self.autosave.hear(&mut self.state, self.host.as_mut(), news),
                HostEvent::PrivateWindow => self.autosave.note_private(&mut self.state),
                HostEvent::TabSaid(message) => self.autosave.hear_tab(&mut self.state, &message),
                event => self.state.receive(event),
            }
            self.version += 1;
        }
        self.state.judge_by_the_clock();
        let is_waiting = self.state.snapshots.is_waiting();
        if is_waiting {
            self.state.snapshots.lose_patience(now_secs);
            self.state.derive();
        }
        let advanced = self.state.advance(elapsed_secs);
        self.version += u64::from(advanced.is_changed);
        let toast_secs = self.state.window.toasts.advance(now_secs);
        self.do_effects();
        // What stops the work is offered without another reason for a frame.
        let waits = self.state.status() == Status::Working && !self.state.is_long_at_work();
        // How long it has taken is told by the second.
        let counts = self.state.is_long_at_work() || self.state.is_improving();
        let work_secs = [waits.then_some(0.2), counts.then_some(1.0)].into_iter().flatten().next();
        [is_waiting.then_some(0.1), work_secs, advanced.next_secs, toast_secs]
            .into_iter()
            .flatten()
            .reduce(f64::min)
    }

    /// Does what commands ask for, in order.
    pub fn apply(&mut self, commands: Vec<Command>) {
        if commands.is_empty() {
            return;
        }
        for command in commands {
            self.state.apply(command);
        }
        self.version += 1;
        self.do_effects();
    }

    /// Takes what the window is to do.
    pub fn take_window_effects(&mut self) -> Vec<WindowEffect> {
        std::mem::take(&mut self.window_effects)
    }

    /// The state was shown, and laying out a drawing took so long, if one was laid out. Returns the seconds after
    /// which the next frame is due, if one is.
    pub fn end_frame(&mut self, layout_millis: Option<f64>) -> Option<f64> {
        if let Some(millis) = layout_millis {
            self.state.frame.layout_millis = millis;
            self.version += 1;
        }
        let begun_secs = self.state.frame.now_secs;
        let next_secs = self.autosave.follow(&mut self.state, self.host.as_mut(), begun_secs);
        self.do_effects();
        let done_secs = self.host.monotonic_secs();
        self.state.frame.cpu_millis = (done_secs - begun_secs) * 1000.0;
        self.note_answer(done_secs);
        next_secs
    }

    /// Writes down whatever is not written yet: the page is about to close.
    pub fn keep_now(&mut self) {
        self.autosave.keep_now(&mut self.state, self.host.as_mut());
        self.do_effects();
    }

    /// Writes down the text as it will be when these keys are taken in that no frame has drawn yet. Nothing else changes: the
    /// next frame takes the keys in, and writes what it makes of them.
    pub fn keep_ahead(&mut self, keys: &[TextCommand]) {
        let document = &self.state.document;
        if keys.is_empty()
            || document.text().len() > LONGEST_TEXT_AHEAD
            || !document.other_carets().is_empty()
        {
            return;
        }
        let mut ahead = Document::new(document.text());
        ahead.set_caret(document.caret());
        for key in keys {
            key.apply(&mut ahead);
        }
        self.autosave.keep_ahead(&self.state, self.host.as_mut(), ahead.text());
    }

    /// Keeps the settings if they have changed.
    pub fn remember(&mut self) {
        let settings = self.state.settings_to_keep();
        if self.stored != settings {
            self.stored = settings;
            host_io::remember_settings(self.host.as_mut(), &self.stored);
        }
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

    /// Runs a command of a host page and saves the result at once: the browser may leave the page before the next frame.
    fn do_at_once(&mut self, command: Command) {
        self.apply(vec![command]);
        let now_secs = self.state.frame.now_secs;
        self.autosave.follow(&mut self.state, self.host.as_mut(), now_secs);
        self.do_effects();
    }

    fn do_effects(&mut self) {
        // A text ends what was asked of the one before; what is asked of this one comes after it.
        self.post_text();
        for effect in self.state.window.take_effects() {
            match effect {
                Effect::Copy(text) => self.window_effects.push(WindowEffect::Copy(text)),
                Effect::Paste => {
                    if !self.host.read_clipboard() {
                        self.window_effects.push(WindowEffect::Paste);
                    }
                }
                Effect::OpenFile(kind) => self.host.open_file(kind),
                Effect::Save(save, _) if self.host.saves_in_place() => self.host.save_in_place(save),
                Effect::Save(_, downloads) => {
                    let names: Vec<String> = downloads.iter().map(|(name, _)| name.clone()).collect();
                    for (name, bytes) in downloads {
                        self.host.save_file(&name, bytes);
                    }
                    self.state.document.mark_saved();
                    self.state.window.done(format!("Saved {}", names.join(", ")));
                }
                Effect::KeepFile(id, token) => self.host.keep_file(&id.0, token),
                Effect::SaveFile { name, bytes } => self.host.save_file(&name, bytes),
                Effect::SavePicture { name, svg, size } => self.host.save_picture(&name, svg, size),
                Effect::Film(area) => {
                    if let Err(reason) = self.host.film(area) {
                        self.state.terrain.film = None;
                        self.state.window.failed(reason);
                    }
                }
                Effect::SaveFilm { name } => self.host.save_film(&name),
                Effect::CopyLink => self.copy_link(),
                Effect::Post(request) => self.host.post(request),
                Effect::Stop => self.host.stop(),
                Effect::KeepReview { joins } => {
                    host_io::keep_review(self.host.as_mut(), &mut self.state, joins);
                }
                Effect::JoinReview(record) => {
                    self.state.reviewing().join(*record);
                }
                Effect::SetReviewAside(aside) => {
                    host_io::set_review_aside(self.host.as_mut(), &mut self.state, aside);
                }
                Effect::ReadMap(id, name) => Autosave::read_map(self.host.as_mut(), &id, &name),
                // An address that is still to be opened stays.
                Effect::ShowAddress if self.autosave.wants_another() => {}
                Effect::ShowAddress => host_io::show_address(&self.state, self.host.as_mut()),
                Effect::HearReview => host_io::hear_review(self.host.as_ref(), &mut self.state),
                Effect::ChangeKeys(change) => {
                    host_io::change_keys(self.host.as_mut(), &mut self.state, change);
                }
                Effect::RecallKeys => host_io::recall_keys(self.host.as_ref(), &mut self.state),
                Effect::RecallReview => host_io::recall_review(self.host.as_mut(), &mut self.state),
                Effect::Restyle => self.window_effects.push(WindowEffect::Restyle),
            }
        }
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
        let document = &self.state.document;
        let since = self.posted.as_ref().and_then(|posted| {
            let edits = document.edits_since(posted.revision)?.cloned().collect();
            Some(Since { revision: posted.revision, edits })
        });
        let source = Source::edited(document.shared_text(), since);
        self.host.post(Request::Update(wanted.settings.update(revision, source)));
        self.posted = Some(Posted { revision, ..wanted });
        self.state.frame.asked_secs = self.state.frame.now_secs;
    }

    /// Asks for the run that is watched to be worked out, unless that was asked for already.
    fn post_run(&mut self) {
        if let Some(request) = self.state.run_to_ask_for() {
            self.host.post(request);
        }
    }

    fn copy_link(&mut self) {
        let fragment = host_io::fragment(&self.state);
        match self.host.link(&fragment) {
            Some(link) if !host_io::is_link_short(&link) => {
                let words = "This mission is too long for a link. Saving it to a file instead.";
                self.state.window.info(words);
                self.state.apply(Command::Library(LibraryCommand::SaveMissionFile));
                self.do_effects();
            }
            Some(link) => {
                self.window_effects.push(WindowEffect::Copy(link));
                self.state.window.done("Link copied");
            }
            None => self.state.window.failed("Links are available in the browser version only"),
        }
    }
}

impl Remote for Session {
    fn open(&mut self, name: &str) -> Result<(), RemoteError> {
        if mission_file::example(name).is_none() {
            return Err(RemoteError::UnknownMission {
                name: name.to_owned(),
                known: EXAMPLES.iter().map(|example| example.name.to_owned()).collect(),
            });
        }
        self.do_at_once(Command::OpenExample(name.into()));
        Ok(())
    }

    fn set_source(&mut self, text: &str) {
        self.do_at_once(Command::SetSource(text.to_owned()));
    }

    fn source(&self) -> String {
        self.state.document.text().to_owned()
    }

    fn dispatch(&mut self, command: &str, arguments: &Value) -> Result<(), RemoteError> {
        let command = registry::from_json(&self.state, command, arguments)?;
        self.do_at_once(command);
        Ok(())
    }

    fn state(&self) -> State {
        State::of(&self.state)
    }

    fn state_version(&self) -> u64 {
        self.version
    }
}
