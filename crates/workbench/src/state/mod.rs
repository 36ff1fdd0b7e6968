//! Everything the app knows: the one thing that commands change and panels read.

mod announcement;
mod apply;
pub mod automaton;
pub mod chance;
pub mod compare;
pub mod documents;
mod editing;
pub mod editor;
pub mod execution;
pub mod files;
pub mod folding;
pub mod growth;
pub mod language;
pub mod lesson;
pub mod manual;
pub mod missions;
pub mod networks;
pub mod no_plan;
pub mod pins;
pub mod placing;
pub mod playback;
pub mod program_chance;
pub mod review;
pub mod search;
pub mod selection;
mod services;
pub mod settings;
mod snapshots;
pub mod terrain;
pub mod toast;

use std::collections::BTreeMap;
use std::sync::Arc;

use rmpl::Span;
use smol_str::SmolStr;
use snapshot::{MapKey, Snapshot};
use text_editing::Document;

use crate::library::{Library, MissionId, MissionKind};
use crate::mission_file;
use crate::state::editor::Reveal;
use crate::state::settings::ThemeChoice;
use crate::workspace::{Arrangement, Workspace};
use crate::{Dialog, PanelEffect, PanelEffects, PanelKind};

pub use apply::Effect;
pub use editor::EditorState;
pub use language::Language;
pub use pins::{PinCommand, Pins};
pub use playback::Playback;
pub use selection::Selection;
pub use settings::{PlanSettings, Settings, Views};
pub use snapshots::{Snapshots, Status};
pub use toast::{Toast, ToastKind, Toasts};

/// The state of the app. Only commands change it ([`AppState::apply`]).
#[derive(Debug)]
pub struct AppState {
    /// The text, its caret and its history.
    pub document: Document,
    /// What the language knows about the text.
    pub language: Language,
    /// The name of the open mission, without extension.
    pub mission: SmolStr,
    /// The missions that the user has.
    pub library: Library,
    /// The texts of other missions that were open in this run, with their histories.
    set_aside: BTreeMap<MissionId, Document>,
    /// Maps that the user chose and that the core has not read yet.
    maps_in_hand: BTreeMap<SmolStr, Arc<[u8]>>,
    /// A label that came without its image.
    waiting_label: Option<missions::WaitingLabel>,
    /// The map that was opened last, whose label may come after it.
    last_map: Option<(String, Vec<u8>)>,
    /// What the planning core answered.
    pub snapshots: Snapshots,
    /// The ground of the missions opened so far.
    pub maps: BTreeMap<MapKey, Arc<::terrain::Terrain>>,
    /// What is selected, in all panels.
    pub selection: Selection,
    /// What the pointer is over in some panel, for the others to hint at.
    pub hovered: Selection,
    /// The step of the search that is looked at.
    pub search: search::SearchState,
    /// The control program, if the text is one, and its run.
    pub automaton: automaton::AutomatonState,
    /// The lesson that is open.
    pub lesson: lesson::LessonState,
    /// The manual as it is looked at.
    pub manual: manual::ManualState,
    /// The review of the mission, with what was said and signed.
    pub review: review::ReviewState,
    /// What the mission is compared with.
    pub compare: compare::CompareState,
    /// The tool in hand on the terrain, and what it has.
    pub terrain: terrain::TerrainState,
    /// The mission as it is executed.
    pub execution: execution::ExecutionState,
    /// Many runs of it with chance.
    pub chance: chance::ChanceState,
    /// The time shown, and whether it runs.
    pub playback: Playback,
    /// Events that are pinned to times, to see what that leaves of the plan.
    pub pins: Pins,
    /// Which of the reasons why there is no plan is shown on the drawing.
    pub reason: usize,
    /// The range of times that is selected, in mission units.
    pub time_range: Option<[f64; 2]>,
    /// Which workspace is shown.
    pub workspace: Workspace,
    /// What is remembered between runs.
    pub settings: Settings,
    /// What the editor shows besides the text.
    pub editor: EditorState,
    /// Short messages.
    pub toasts: Toasts,
    /// The dialog on top, if any.
    pub dialog: Option<Dialog>,
    /// The panel that was used last; view actions go to it.
    pub active_panel: PanelKind,
    /// The panel that has the window to itself, if one has.
    pub maximized: Option<PanelKind>,
    /// The panels that were on screen in the last frame, in the order of the layout.
    pub panels_on_screen: Vec<PanelKind>,
    /// What panels and their layout are to do.
    pub panel_effects: PanelEffects,
    /// How the last frame went.
    pub frame: FrameInfo,
    /// How the user has set up the system.
    pub system: System,
    /// What the host is to do.
    pub(crate) effects: Vec<Effect>,
}

/// What the user has asked of all programs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct System {
    /// Dark on light.
    pub is_light: bool,
    /// Nothing moves by itself.
    pub reduces_motion: bool,
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
    pub whole_millis: Option<f64>,
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
            document,
            mission: example.name.into(),
            library: Library::new(MissionKind::Example, example.source),
            set_aside: BTreeMap::new(),
            maps_in_hand: BTreeMap::new(),
            waiting_label: None,
            last_map: None,
            snapshots: Snapshots::default(),
            maps: BTreeMap::new(),
            selection: Selection::None,
            hovered: Selection::None,
            search: search::SearchState::default(),
            automaton: automaton::AutomatonState::default(),
            lesson: lesson::LessonState::default(),
            manual: manual::ManualState::default(),
            review: review::ReviewState::default(),
            compare: compare::CompareState::default(),
            terrain: terrain::TerrainState::default(),
            execution: execution::ExecutionState::default(),
            chance: chance::ChanceState::default(),
            playback: Playback::default(),
            pins: Pins::default(),
            reason: 0,
            time_range: None,
            workspace: Workspace::default(),
            settings: Settings::default(),
            editor: EditorState::default(),
            toasts: Toasts::default(),
            dialog: None,
            active_panel: PanelKind::Editor,
            maximized: None,
            panels_on_screen: Vec::new(),
            system: System::default(),
            panel_effects: PanelEffects::default(),
            frame: FrameInfo::default(),
            effects: vec![Effect::RecallReview],
        }
    }

    /// Which layout the panels have.
    pub const fn arrangement(&self) -> Arrangement {
        if self.lesson.is_beside() {
            return Arrangement::Lesson;
        }
        Arrangement::new(self.workspace, self.language.is_control())
    }

    /// What the panels show: see [`Snapshots::shown`].
    pub fn shown(&self) -> Option<&Arc<Snapshot>> {
        self.snapshots.shown()
    }

    /// Where the plan stands, for the status display.
    pub fn status(&self) -> Status {
        match self.snapshots.status(self.document.revision()) {
            Status::Empty if self.automaton.is_control() => Status::Program,
            status => status,
        }
    }

    /// Whether the theme that is shown is light on dark.
    pub const fn is_dark(&self) -> bool {
        match self.settings.theme {
            ThemeChoice::System => !self.system.is_light,
            ThemeChoice::Dark => true,
            ThemeChoice::Light => false,
        }
    }

    /// Whether the present text has been worked out for so long that somebody may want to stop it.
    pub fn is_long_at_work(&self) -> bool {
        self.status() == Status::Working && self.frame.now_secs - self.frame.asked_secs > LONG_SECS
    }

    /// For how many whole seconds the present text has been worked out, while it is.
    pub fn secs_at_work(&self) -> u64 {
        let is_at_work = self.status() == Status::Working || self.is_improving();
        let secs = if is_at_work { self.frame.now_secs - self.frame.asked_secs } else { 0.0 };
        secs.max(0.0) as u64
    }

    /// Whether the present text has a plan, and a better one is looked for.
    pub fn is_improving(&self) -> bool {
        self.snapshots.is_improving(self.document.revision())
    }

    /// Asks the layout to bring a panel back, or to the front of its tabs.
    pub(crate) fn show_panel(&mut self, panel: PanelKind) {
        self.panel_effects.push(PanelEffect::Show(panel));
    }

    /// Asks the editor to scroll to a place; with `center` to the middle, even when the place can be seen.
    pub(crate) fn scroll_to(&mut self, span: Span, center: bool) {
        self.panel_effects.push(PanelEffect::Reveal(Reveal { span, center }));
    }

    /// Gives the editor the keyboard.
    pub(crate) fn focus_editor(&mut self) {
        self.panel_effects.push(PanelEffect::FocusEditor);
    }

    /// Takes what the host is to do.
    pub(crate) fn take_effects(&mut self) -> Vec<Effect> {
        std::mem::take(&mut self.effects)
    }
}

impl Default for AppState {
    fn default() -> Self {
        Self::new()
    }
}
