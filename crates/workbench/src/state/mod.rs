//! Everything the app knows, in parts: what commands change and panels read.
//!
//! A part owns its data and changes by its own commands. [`AppState`] puts the parts together and answers what takes
//! several of them to answer; what takes several to do is in `acts`.

pub mod automaton;
pub mod chance;
pub mod compare;
pub mod contradict;
pub mod derived;
pub mod diagnosing;
pub mod documents;
pub mod drawing;
pub(crate) mod editing;
pub mod editor;
pub mod execution;
pub mod files;
pub mod folding;
pub mod growth;
pub(crate) mod imports;
pub mod keys;
pub mod language;
pub mod lesson;
pub mod manual;
pub mod maps;
pub mod networks;
pub mod no_plan;
pub mod part;
pub mod pins;
pub mod placing;
pub mod playback;
pub mod program_chance;
pub mod program_proof;
pub mod review;
pub mod rule_proof;
pub mod search;
pub mod selection;
mod services;
pub mod settings;
pub(crate) mod snapshots;
pub mod terrain;
pub(crate) mod toast;
pub mod window;

use std::sync::Arc;

use link::Update;
use report::calendar::Calendar;
use smol_str::SmolStr;
use snapshot::{Robustness, Snapshot};
use text_editing::Document;

pub use editor::EditorState;
pub use language::Language;
pub use part::Part;
pub use pins::{PinCommand, Pins};
pub use playback::Playback;
pub use selection::Selection;
pub use settings::{PlanSettings, Settings, Views};
pub use snapshots::{Snapshots, Status};
pub use toast::{Toast, ToastKind, Toasts};

use crate::library::{Library, MAIN_TEXT, MissionKind, Open};
use crate::mission_file;
use crate::state::settings::ThemeChoice;
use crate::workspace::{Arrangement, Workspace};

/// The state of the app. Only commands change it ([`AppState::apply`]).
#[derive(Debug)]
pub struct AppState {
    /// The text, its caret and its history.
    pub document: Part<Document>,
    /// What the language knows about the text.
    pub language: Language,
    /// What the editor shows besides the text.
    pub editor: EditorState,
    /// The name of the open mission, without extension.
    pub mission: SmolStr,
    /// How many missions were opened so far: tells the views of one from those of the next.
    pub missions_opened: u64,
    /// The missions that the user has.
    pub library: Library,
    /// The ground of the missions opened so far.
    pub maps: maps::Maps,
    /// What the planning core answered.
    pub snapshots: Part<Snapshots>,
    /// What is selected, in all panels.
    pub selection: Part<Selection>,
    /// What the pointer is over in some panel, for the others to hint at.
    pub hovered: Selection,
    /// The range of times that is selected, in mission units.
    pub time_range: Option<[f64; 2]>,
    /// Which of the reasons why there is no plan is shown on the drawing.
    pub reason: usize,
    /// The step of the search that is looked at.
    pub search: Part<search::SearchState>,
    /// The control program, if the text is one, and its run.
    pub automaton: Part<automaton::AutomatonState>,
    /// The lesson that is open.
    pub lesson: Part<lesson::LessonState>,
    /// The manual as it is looked at.
    pub manual: manual::ManualState,
    /// The review of the mission, with what was said and signed.
    pub review: Part<review::ReviewState>,
    /// The keys of those who sign, and of those whose signatures count.
    pub keys: Part<keys::KeysState>,
    /// What the mission is compared with.
    pub compare: compare::CompareState,
    /// The tool in hand on the terrain, and what it has.
    pub terrain: Part<terrain::TerrainState>,
    /// The mission as it is executed.
    pub execution: Part<execution::ExecutionState>,
    /// Many runs of it with chance.
    pub chance: Part<chance::ChanceState>,
    /// Counterexamples of what its review has passed.
    pub contradict: Part<contradict::ContradictState>,
    /// Which flight rules hold in every plan.
    pub rule_proof: Part<rule_proof::RuleProofState>,
    /// The time shown, and whether it runs.
    pub playback: Part<Playback>,
    /// Events that are pinned to times, to see what that leaves of the plan.
    pub pins: Part<Pins>,
    /// What is remembered between runs.
    pub settings: Part<Settings>,
    /// The window around the mission.
    pub window: window::Window,
    /// How the last frame went.
    pub frame: FrameInfo,
    /// How the user has set up the system.
    pub system: System,
    /// What was computed from what.
    pub derived: derived::Derived,
}

/// What the user has asked of all programs, and which one this runs in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct System {
    /// Dark on light.
    pub is_light: bool,
    /// Nothing moves by itself.
    pub reduces_motion: bool,
    /// The page is in Firefox, which keeps some keys for itself.
    pub is_firefox: bool,
}

/// How the last frame went.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameInfo {
    /// What draws: `webgpu`, `webgl2`, `vulkan`, …; empty if unknown.
    pub renderer: String,
    /// Milliseconds that the app took for its last frame, without the time to draw it.
    pub cpu_millis: f64,
    /// Milliseconds of the processor that the frame before took in all: the app, egui's shapes and triangles, and
    /// handing them to the graphics; `None` if unknown.
    pub total_millis: Option<f64>,
    /// The first frame with the last answer.
    pub answer: Option<AnswerFrame>,
    /// Milliseconds that laying out the drawings took, when it last had to be done.
    pub layout_millis: f64,
    /// Seconds on the host's clock at the start of this frame.
    pub now_secs: f64,
    /// The same when the present text was handed to the planning core.
    pub asked_secs: f64,
    /// The date and time at the start of this frame, in milliseconds since 1970, in UTC.
    pub unix_millis: i64,
}

impl FrameInfo {
    /// Returns what draws, as people call it; empty if unknown.
    pub fn renderer_name(&self) -> &str {
        match self.renderer.as_str() {
            "webgpu" => "WebGPU",
            "webgl2" => "WebGL2",
            "vulkan" => "Vulkan",
            "metal" => "Metal",
            "gl" => "OpenGL",
            other => other,
        }
    }
}

/// The first frame that showed an answer of the planning core.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnswerFrame {
    /// The revision of the text that was answered.
    pub revision: u64,
    /// When the frame was done, in seconds on the host's clock.
    pub done_secs: f64,
    /// Milliseconds that the app took for it, laying out included.
    pub cpu_millis: f64,
}

/// Work that takes longer than this can be stopped on screen.
const LONG_SECS: f64 = 0.5;

impl AppState {
    /// The state with which the app starts: the first example, before anything was answered.
    pub fn new() -> Self {
        let example = mission_file::EXAMPLES[0];
        let document = Document::new(example.source);
        Self {
            language: Language::new(&document),
            document: Part::new(document),
            editor: EditorState::default(),
            mission: example.name.into(),
            missions_opened: 0,
            library: Library::new(MissionKind::Example, example.source),
            maps: maps::Maps::default(),
            snapshots: Part::default(),
            selection: Part::default(),
            hovered: Selection::None,
            time_range: None,
            reason: 0,
            search: Part::default(),
            automaton: Part::default(),
            lesson: Part::default(),
            manual: manual::ManualState::default(),
            review: Part::default(),
            keys: Part::default(),
            compare: compare::CompareState::default(),
            terrain: Part::default(),
            execution: Part::default(),
            chance: Part::default(),
            contradict: Part::default(),
            rule_proof: Part::default(),
            playback: Part::default(),
            pins: Part::default(),
            settings: Part::default(),
            window: window::Window::default(),
            frame: FrameInfo::default(),
            system: System::default(),
            derived: derived::Derived::default(),
        }
    }

    /// Returns which layout the panels have.
    pub fn arrangement(&self) -> Arrangement {
        if self.lesson.is_beside() {
            return Arrangement::Lesson;
        }
        Arrangement::new(self.window.workspace, self.language.is_control())
    }

    /// Returns what the panels show: see [`Snapshots::shown`].
    pub fn shown(&self) -> Option<&Arc<Snapshot>> {
        self.snapshots.shown()
    }

    /// Returns where the plan is, for the status display.
    pub fn status(&self) -> Status {
        match self.snapshots.status(self.document.revision()) {
            Status::Empty if self.automaton.is_control() => Status::Program,
            status => status,
        }
    }

    /// Returns whether the theme that is shown is light on dark.
    pub fn is_dark(&self) -> bool {
        match self.settings.theme {
            ThemeChoice::System => !self.system.is_light,
            ThemeChoice::Dark => true,
            ThemeChoice::Light => false,
        }
    }

    /// Returns whether the present text has been worked out for so long that someone may want to stop it.
    pub fn is_long_at_work(&self) -> bool {
        self.status() == Status::Working && self.frame.now_secs - self.frame.asked_secs > LONG_SECS
    }

    /// For how many whole seconds the present text has been worked out, while it is.
    pub fn secs_at_work(&self) -> u64 {
        let is_at_work = self.status() == Status::Working || self.is_improving();
        let secs = if is_at_work { self.frame.now_secs - self.frame.asked_secs } else { 0.0 };
        secs.max(0.0) as u64
    }

    /// Returns whether the present text has a plan, and a better one is looked for.
    pub fn is_improving(&self) -> bool {
        self.snapshots.is_improving(self.document.revision())
    }

    /// Returns what panels draw: while a mission is executed, the plan followed at the time shown with what has
    /// happened; otherwise [`AppState::shown`].
    pub fn looked_at(&self) -> Option<&Arc<Snapshot>> {
        self.execution.snapshot().filter(|_| self.is_executing()).or_else(|| self.shown())
    }

    /// Returns whether a run of the mission is shown.
    pub fn is_executing(&self) -> bool {
        self.window.workspace == Workspace::Execute
            && self
                .execution
                .run()
                .zip(self.shown())
                .is_some_and(|(run, shown)| shown.revision == run.revision && shown.plan().is_some())
    }

    /// Returns whether a run of the mission will be shown as soon as it is there.
    pub(crate) fn is_awaiting_run(&self) -> bool {
        self.window.workspace == Workspace::Execute
            && self.status() == Status::Plan
            && self.execution.trouble().is_none()
            && !self.is_executing()
    }

    /// Seconds after midnight at the time shown, by the start date that was given; `None` if there is no such date.
    pub fn time_of_day_secs(&self) -> Option<f64> {
        const DAY_SECS: f64 = 86_400.0;
        let unit = self.shown()?.program.options.time_unit;
        let start_secs = Calendar::new(self.settings.epoch.trim(), unit)?.epoch().as_second() as f64;
        Some((start_secs + self.playback.time * unit.seconds() as f64).rem_euclid(DAY_SECS))
    }

    /// The run of the mission, while it is shown.
    pub fn run_shown(&self) -> Option<&snapshot::Execution> {
        self.execution.run().map(AsRef::as_ref).filter(|_| self.is_executing())
    }

    /// Returns how robust the plan is, once runs were made of the present content.
    pub fn robustness(&self) -> Option<&Arc<Robustness>> {
        self.chance.of_content(self.review.hash()?)
    }

    /// The present text as it was planned, whether or not there is a plan; nothing while that is not shown.
    pub(crate) fn update_planned(&self) -> Option<Update> {
        let revision = self.document.revision();
        let shown = self.shown().filter(|shown| shown.revision == revision)?;
        Some(self.settings.plan.update(revision, Arc::clone(&shown.source)))
    }

    /// The present text as it was planned, once it has a plan.
    pub(crate) fn update_with_plan(&self) -> Option<Update> {
        self.update_planned().filter(|_| self.shown().is_some_and(|shown| shown.plan().is_some()))
    }

    /// Returns what the open mission is known by: its id in the library, or the name of an original.
    pub fn mission_key(&self) -> SmolStr {
        self.library.open_id().map_or_else(|| self.mission.clone(), |id| id.0.clone())
    }

    /// Returns what the open mission is called on screen: examples have a title.
    pub fn mission_title(&self) -> &str {
        match self.library.open() {
            Open::Original { kind: MissionKind::Example, .. } => {
                mission_file::example(&self.mission).map_or(self.mission.as_str(), |example| example.title)
            }
            _ => &self.mission,
        }
    }

    /// The name of the main text of the open mission, as a file.
    pub(crate) fn main_text(&self) -> SmolStr {
        let main = self.library.open_mission().and_then(|mission| mission.texts.first());
        main.map_or_else(|| MAIN_TEXT.into(), |main| main.name.clone())
    }

    /// The names of the mission's files, the main text first.
    pub fn file_names(&self) -> Vec<SmolStr> {
        files::names(&self.document, self.main_text())
    }

    /// Returns which of them the caret is in.
    pub fn file_at_caret(&self) -> usize {
        files::at_caret(&self.document)
    }
}

impl Default for AppState {
    fn default() -> Self {
        Self::new()
    }
}
