//! Commands: everything that can be asked of the app, by menus, keys, the palette, panels or a host page.

pub mod chord;

use rmpl::{Edit, Span};
use smol_str::SmolStr;
use text_editing::{EditKind, TextCommand};

use crate::library::LibraryCommand;
use crate::state::automaton::AutomatonCommand;
use crate::state::chance::ChanceCommand;
use crate::state::compare::CompareCommand;
use crate::state::contradict::ContradictCommand;
use crate::state::documents::ScheduleForm;
use crate::state::drawing::DrawCommand;
use crate::state::editor::EditorCommand;
use crate::state::execution::ExecutionCommand;
use crate::state::files::FileCommand;
use crate::state::lesson::LessonCommand;
use crate::state::manual::ManualCommand;
use crate::state::networks::NetworkForm;
use crate::state::pins::PinCommand;
use crate::state::playback::TransportCommand;
use crate::state::program_chance::ProgramChanceCommand;
use crate::state::program_proof::ProgramProofCommand;
use crate::state::review::ReviewCommand;
use crate::state::rule_proof::RuleProofCommand;
use crate::state::search::SearchCommand;
use crate::state::selection::Selection;
use crate::state::settings::SettingsCommand;
use crate::state::terrain::TerrainCommand;
use crate::state::window::WindowCommand;
use crate::workspace::Workspace;

/// Something the app is asked to do.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Opens the example mission of this name.
    OpenExample(SmolStr),
    /// Opens a mission text that is not an example.
    OpenSource {
        /// Its name, without extension.
        name: SmolStr,
        source: String,
    },
    /// Something that concerns the missions of the library.
    Library(LibraryCommand),
    /// Something that concerns the files of the open mission.
    Files(FileCommand),
    /// Saves the open mission to its file; where the host knows no such files, lets the user save its texts.
    SaveMission,

    /// Replaces the whole text, as one undoable edit.
    SetSource(String),
    /// An editing key.
    Text(TextCommand),
    /// Edits of the text made elsewhere: on the map, by a quick fix.
    Edit {
        /// Disjoint edits in textual order.
        edits: Vec<Edit>,
        /// How they join the history.
        kind: EditKind,
    },
    /// Something that is drawn of the mission's activities.
    Draw(DrawCommand),
    /// Puts the caret at a place of the text and shows the editor there.
    Reveal(Span),
    /// Something that concerns only the editor.
    Editor(EditorCommand),

    /// Selects something in all panels.
    Select(Selection),
    /// Selects something in all panels and shows its text.
    SelectAndReveal(Selection),
    /// The pointer is over something.
    Hover(Selection),
    /// Selects a range of times, in mission units.
    SelectTimes(Option<[f64; 2]>),
    /// Shows one of the reasons why there is no plan on the drawing.
    ShowReason(usize),

    /// Something that concerns the terrain.
    Terrain(TerrainCommand),

    /// Plays, stops, steps: drives whatever the keys drive now.
    Transport(TransportCommand),
    /// Goes to a time, in mission units from the start.
    Seek(f64),
    /// Sets how fast time runs; 1 is normal.
    SetRate(f64),
    /// Something that concerns events pinned to times.
    Pins(PinCommand),

    /// Something that concerns the step of the search that is looked at.
    Search(SearchCommand),
    /// Something that concerns the run of a control program.
    Automaton(AutomatonCommand),
    /// Something that concerns the run of a mission.
    Execution(ExecutionCommand),
    /// Something that concerns many runs of a mission with chance.
    Chance(ChanceCommand),
    /// Something that concerns counterexamples of what the review has passed.
    Contradict(ContradictCommand),
    /// Something about proofs of flight rules over every plan.
    RuleProof(RuleProofCommand),
    /// Something that concerns many runs of a control program with chance.
    ProgramChance(ProgramChanceCommand),
    /// Something that concerns what holds in all runs of a control program.
    ProgramProof(ProgramProofCommand),

    /// Something that concerns the review.
    Review(ReviewCommand),
    /// Something that concerns what the mission is compared with.
    Compare(CompareCommand),
    /// Writes the review as a report.
    WriteReport,
    /// Writes the plan's schedule for another tool.
    WriteSchedule {
        form: ScheduleForm,
        /// When the mission starts, where the format needs it.
        epoch: String,
    },
    /// Writes the network for another tool.
    WriteNetwork(NetworkForm),

    /// Something that concerns the lessons.
    Lesson(LessonCommand),
    /// Something that concerns the manual.
    Manual(ManualCommand),

    /// Something that is remembered between runs: how to plan, what panels show, how everything looks.
    Settings(SettingsCommand),
    /// Stops whatever the planning core works on.
    StopWork,
    /// Plans the same text again.
    PlanAgain,

    ShowWorkspace(Workspace),
    /// Something that concerns the window: panels, dialogs, messages, and files to choose or save.
    Window(WindowCommand),
    /// Leaves what is on top: a dialog, the find bar, the selection.
    Escape,
}

/// Collects commands while a frame is shown.
#[derive(Debug, Default)]
pub struct CommandSender {
    commands: Vec<Command>,
}

impl CommandSender {
    /// Asks for something; it is done before the next frame is shown.
    pub fn send(&mut self, command: Command) {
        self.commands.push(command);
    }

    /// Returns what was asked for, in order.
    pub fn take(&mut self) -> Vec<Command> {
        std::mem::take(&mut self.commands)
    }

    /// Returns whether nothing was asked for.
    pub fn is_empty(&self) -> bool {
        self.commands.is_empty()
    }
}
