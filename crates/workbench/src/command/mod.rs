//! Commands: everything that can be asked of the app, by menus, keys, the palette, panels or a host page.

pub mod chord;
mod registry;
mod specs;

use kirk::Search as SearchKind;
use rmpl::{Edit, Span};
use smol_str::SmolStr;
use snapshot::Goal;
use text_editing::{EditKind, Find, TextCommand};

use crate::Dialog;
use crate::PanelKind;
use crate::host::FileKind;
use crate::state::automaton::AutomatonCommand;
use crate::state::chance::ChanceCommand;
use crate::state::compare::CompareCommand;
use crate::state::documents::ScheduleForm;
use crate::state::execution::ExecutionCommand;
use crate::state::files::FileCommand;
use crate::state::lesson::LessonCommand;
use crate::state::manual::ManualCommand;
use crate::state::missions::LibraryCommand;
use crate::state::networks::NetworkForm;
use crate::state::program_chance::ProgramChanceCommand;
use crate::state::review::ReviewCommand;
use crate::state::search::SearchCommand;
use crate::state::settings::ThemeChoice;
use crate::state::terrain::TerrainCommand;
use crate::state::{PinCommand, Selection, ToastKind, Views};
use crate::transport::TransportCommand;
use crate::workspace::Workspace;

pub use registry::{Availability, Build, CommandSpec, Group, Scope, by_id, from_json, matching, score};
pub use specs::all_commands;

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
    /// Lets the user choose a file.
    OpenFile(FileKind),
    /// Saves the open mission to its file; where the host knows no such files, lets the user save its texts.
    SaveMission,
    /// Puts a link to the mission on the clipboard.
    CopyLink,

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
    /// Shows one of the reasons why there is no plan on the drawing.
    ShowReason(usize),
    /// Selects a range of times, in mission units.
    SelectTimes(Option<[f64; 2]>),

    /// Something that concerns the step of the search that is looked at.
    Search(SearchCommand),
    /// Something that concerns the run of a control program.
    Automaton(AutomatonCommand),
    /// Something that concerns the run of a mission.
    Execution(ExecutionCommand),
    /// Something that concerns many runs of a mission with chance.
    Chance(ChanceCommand),
    /// Something that concerns many runs of a control program with chance.
    ProgramChance(ProgramChanceCommand),

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

    /// Something that concerns the lessons.
    Lesson(LessonCommand),
    /// Something that concerns the manual.
    Manual(ManualCommand),

    SetGoal(Goal),
    /// How to search.
    SetSearch(SearchKind),
    /// Seeds path planning.
    SetSeed(u64),
    /// Stops whatever the planning core works on.
    StopWork,
    /// Plans the same text once more.
    PlanAgain,
    /// Whether the search is recorded.
    SetTrace(bool),

    ShowWorkspace(Workspace),
    /// Puts the panels of the present workspace back where they were at first.
    ResetWorkspace,
    /// Brings a panel back or to the front.
    ShowPanel(PanelKind),
    /// Closes a panel.
    ClosePanel(PanelKind),
    /// Gives a panel the whole window, the one used last if none is named, or puts all panels back.
    Maximize(Option<PanelKind>),
    /// The user turned to a panel.
    Activate(PanelKind),
    /// Gives the keyboard to the next (`true`) or the previous (`false`) panel on screen.
    TurnPanel(bool),
    /// A view action for the panel used last.
    View(ViewAction),
    ViewOf(PanelKind, ViewAction),
    /// What panels show.
    SetViews(Box<Views>),
    /// Light, dark, or as the system has it.
    SetTheme(ThemeChoice),
    /// How large text is; 1 is the designed size.
    SetTextScale(f32),

    /// Opens a dialog over everything.
    ShowDialog(Dialog),
    CloseDialog,
    /// Leaves what is on top: a dialog, the find bar, the selection.
    Escape,
    /// Says something for a moment.
    Notify(ToastKind, String),
    /// Takes a message away.
    DismissToast(usize),
    /// Puts text on the clipboard.
    Copy(String),
    /// Writes the network for another tool.
    WriteNetwork(NetworkForm),
    /// Saves the drawing of the network.
    SaveNetwork(PictureFormat),
    /// Lets the user save a file.
    SaveFile {
        /// The name to suggest.
        name: String,
        bytes: Vec<u8>,
    },
    /// Lets the user save a picture as a PNG.
    SavePicture {
        /// The name to suggest.
        name: String,
        /// The picture as an SVG.
        svg: String,
        /// Width and height in pixels.
        size: [u32; 2],
    },
}

/// The formats that drawings are saved in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// Lines and texts, sharp at any size.
    Svg,
    /// Pixels.
    Png,
}

impl PictureFormat {
    /// What files of this format end in.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
        }
    }
}

/// What only the editor does.
#[derive(Clone, Debug, PartialEq)]
pub enum EditorCommand {
    /// Gives the editor the keyboard.
    Focus,
    /// The pointer is over a place of the text that something is known of, or over none any more.
    Hover(Option<usize>),
    /// Text that an input method is composing.
    Compose(String),
    /// Opens the find bar, with the replacement row or without.
    Find {
        /// Whether the replacement row is open.
        replacing: bool,
    },
    /// Changes what is looked for.
    SetFind(Find),
    /// Closes the find bar.
    CloseFind,
    /// Selects the next match.
    FindNext,
    /// Selects the match before.
    FindPrevious,
    /// Replaces the selected match and selects the next.
    ReplaceOne,
    /// Replaces all matches.
    ReplaceAll,
    /// Goes to a line, from 1.
    GoToLine(usize),
    /// Goes to the next or the previous problem.
    GoToProblem {
        /// Whether to go forwards.
        forwards: bool,
    },
    /// Lists what can be written at the caret.
    Complete,
    /// Lists what mends the problem at the caret.
    QuickFix,
    /// Lists where the name at the caret stands.
    FindReferences,
    /// Goes to where the name at the caret is declared.
    GoToDefinition,
    /// Goes to the bracket that belongs to the one at the caret.
    GoToBracket,
    /// Goes where the caret was before, or forward again.
    GoToPlace {
        /// Whether to go forward.
        forwards: bool,
    },
    /// Moves in the list at the caret.
    MoveInPopup(isize),
    /// Takes an entry of the list at the caret, the chosen one if none is given.
    TakeFromPopup(Option<usize>),
    /// Closes the list at the caret.
    ClosePopup,
    /// Asks for a new name of the name at the caret.
    Rename,
    /// Gives the name at the caret a new name.
    RenameTo(String),
    /// Gives the text its canonical layout.
    Format,
    /// Selects the next larger piece of structure.
    ExpandSelection,
    /// Folds away or shows the piece of text that begins in this line, from 0.
    ToggleFold(usize),
    /// Folds the innermost open piece of text around the caret, or shows it again.
    FoldAtCaret(bool),
    /// Folds every outermost piece, or shows everything.
    FoldAll(bool),
    /// The view breaks lines into rows of so many columns, or breaks none.
    WrapAt(Option<usize>),
    /// Cuts or copies the selection, or the line of the caret.
    CopySelection {
        /// Whether it is taken away.
        cut: bool,
    },
}

/// What can be done with a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewAction {
    ZoomIn,
    ZoomOut,
    /// Designed size.
    ZoomReset,
    /// Everything at once.
    Fit,
    /// What is selected.
    FitSelection,
    /// Straight down, north up; for the terrain.
    TopView,
    /// Keeps the selected vehicle in the middle, or the first one; lets it go if one is kept. For the terrain.
    Follow,
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

    /// What was asked for, in order.
    pub fn take(&mut self) -> Vec<Command> {
        std::mem::take(&mut self.commands)
    }

    /// Whether nothing was asked for.
    pub fn is_empty(&self) -> bool {
        self.commands.is_empty()
    }
}
