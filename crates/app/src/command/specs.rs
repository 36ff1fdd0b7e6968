//! The registry: every command with its name, title, menu and keys (DESIGN 1).

use egui::{Key, KeyboardShortcut, Modifiers};
use motion::PlannerKind;
use serde_json::Value;

use crate::command::registry::{Availability, Build, CommandSpec, Group, Scope};
use crate::command::{Command, EditorCommand, PictureFormat, ViewAction};
use crate::dialog::Dialog;
use crate::host::FileKind;
use crate::mission_file;
use crate::panel::PanelKind;
use crate::state::automaton::{AutomatonCommand, Program};
use crate::state::chance::ChanceCommand;
use crate::state::compare::CompareCommand;
use crate::state::documents::ScheduleForm;
use crate::state::execution::ExecutionCommand;
use crate::state::growth::GrowthCommand;
use crate::state::pins::event_by_name;
use crate::state::review::{ReviewCommand, may_sign};
use crate::state::search::{SearchCommand, recorded};
use crate::state::settings::Grouping;
use crate::state::terrain::{TerrainCommand, Tool};
use crate::state::{AppState, PinCommand, Selection, TextCommand};
use crate::theme::ThemeChoice;
use crate::workspace::Workspace;

const fn keys(modifiers: Modifiers, key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(modifiers, key)
}

const PLAIN: Modifiers = Modifiers::NONE;
const CTRL: Modifiers = Modifiers::COMMAND;
const SHIFT: Modifiers = Modifiers::SHIFT;
const ALT: Modifiers = Modifiers::ALT;
const ALT_SHIFT: Modifiers = Modifiers { shift: true, ..Modifiers::ALT };
const CTRL_SHIFT: Modifiers = Modifiers { shift: true, ..Modifiers::COMMAND };

#[expect(clippy::unnecessary_wraps, reason = "it stands beside conditions that can fail")]
fn always(_: &AppState) -> Availability {
    Ok(())
}

fn with_network(state: &AppState) -> Availability {
    let has_network = state.shown().is_some_and(|shown| shown.network.is_some());
    if has_network { Ok(()) } else { Err("there is no network") }
}

fn with_plan(state: &AppState) -> Availability {
    let has_plan = state.shown().is_some_and(|shown| shown.plan().is_some());
    if has_plan { Ok(()) } else { Err("there is no plan") }
}

fn with_program(state: &AppState) -> Availability {
    if state.automaton.moment().is_some() { Ok(()) } else { Err("there is no control program") }
}

/// The component and its mode by name; without a mode, the component is left to behave.
fn injection(state: &AppState, arguments: &Value) -> Result<Command, String> {
    let model = state.automaton.program().and_then(Program::model).ok_or("there is no plant")?;
    let component = text_argument(arguments, "component")?;
    let (id, mode) = if arguments.get("mode").is_none_or(Value::is_null) {
        let id = model.component_named(component);
        (id.ok_or_else(|| format!("the model has no component `{component}`"))?, None)
    } else {
        let (id, mode) = model.component_mode(component, text_argument(arguments, "mode")?)?;
        (id, Some(mode))
    };
    Ok(Command::Automaton(AutomatonCommand::Inject(id, mode)))
}

/// Whether there is something that chance can go wrong with: a plan, or a control program with its plant.
fn with_chance(state: &AppState) -> Availability {
    if matches!(state.automaton.program(), Some(Program::Bound(_))) { Ok(()) } else { with_plan(state) }
}

/// Whether there is something to step through: a plan, a recorded search, or a control program.
fn with_steps(state: &AppState) -> Availability {
    if with_search(state).is_ok() || state.automaton.program().is_some() { Ok(()) } else { with_plan(state) }
}

fn with_search(state: &AppState) -> Availability {
    let is_compared = state.search.recordings(state.shown()).len() > 1;
    let is_recorded = state.shown().is_some_and(|shown| recorded(shown).is_some());
    if is_recorded || is_compared { Ok(()) } else { Err("no search is recorded") }
}

fn with_step(state: &AppState) -> Availability {
    if state.search.step().is_some() { Ok(()) } else { Err("no step of the search is shown") }
}

fn with_comparison(state: &AppState) -> Availability {
    let is_compared = state.search.recordings(state.shown()).len() > 1;
    if is_compared { Ok(()) } else { Err("no searches are compared") }
}

fn search(command: SearchCommand) -> Command {
    Command::Search(command)
}

fn with_run(state: &AppState) -> Availability {
    if state.is_executing() { Ok(()) } else { Err("no mission is executed") }
}

fn with_selection(state: &AppState) -> Availability {
    if state.selection.is_none() { Err("nothing is selected") } else { Ok(()) }
}

fn with_ground(state: &AppState) -> Availability {
    let has_ground = state.shown().is_some_and(|shown| shown.map.is_some());
    if has_ground { Ok(()) } else { Err("the mission has no places") }
}

fn with_paths(state: &AppState) -> Availability {
    let has_paths = state.shown().is_some_and(|shown| !shown.traverses.is_empty());
    if has_paths { Ok(()) } else { Err("the plan has no traverse with a path") }
}

fn with_vehicles(state: &AppState) -> Availability {
    let has_vehicles = state.shown().is_some_and(|shown| !shown.program.world.vehicles.is_empty());
    if has_vehicles { Ok(()) } else { Err("the mission has no vehicles") }
}

fn with_pins(state: &AppState) -> Availability {
    if state.pins.is_empty() { Err("no event is pinned") } else { Ok(()) }
}

fn with_undo(state: &AppState) -> Availability {
    if state.document.can_undo() { Ok(()) } else { Err("nothing has been edited") }
}

fn with_redo(state: &AppState) -> Availability {
    if state.document.can_redo() { Ok(()) } else { Err("nothing has been undone") }
}

fn with_earlier_draft(state: &AppState) -> Availability {
    if state.earlier_draft.is_some() { Ok(()) } else { Err("no draft of an earlier visit is kept") }
}

fn with_problems(state: &AppState) -> Availability {
    let has_problems = state.snapshots.latest().is_some_and(|latest| !latest.problems.is_empty());
    if has_problems { Ok(()) } else { Err("there are no problems") }
}

/// Whether a mission is open that can be reviewed, planned or not.
fn with_mission(state: &AppState) -> Availability {
    let is_reviewed = state.automaton.program().is_none() && state.snapshots.latest().is_some();
    if is_reviewed { Ok(()) } else { Err("there is no mission to review") }
}

fn with_sign_off(state: &AppState) -> Availability {
    let is_signed = !state.review.record().sign_offs.is_empty();
    if is_signed { Ok(()) } else { Err("nobody has signed this mission off yet") }
}

fn with_record(state: &AppState) -> Availability {
    if state.review.record().is_empty() { Err("there are no comments and no sign-offs") } else { Ok(()) }
}

/// Asks when the mission starts, beginning with what was said last.
fn ask_epoch(state: &AppState, form: ScheduleForm) -> Command {
    Command::ShowDialog(Dialog::Epoch { form, epoch: state.settings.epoch.clone() })
}

/// A command that stands in menus and in the palette.
const fn plain(
    id: &'static str,
    title: &'static str,
    group: Group,
    shortcuts: &'static [KeyboardShortcut],
    scope: Scope,
    make: fn(&AppState) -> Command,
) -> CommandSpec {
    CommandSpec { id, title, group, keys: shortcuts, scope, available: always, build: Build::Plain(make) }
}

/// A command for host pages that needs arguments.
const fn called(
    id: &'static str,
    title: &'static str,
    group: Group,
    make: fn(&AppState, &Value) -> Result<Command, String>,
) -> CommandSpec {
    CommandSpec {
        id,
        title,
        group,
        keys: &[],
        scope: Scope::Everywhere,
        available: always,
        build: Build::FromJson(make),
    }
}

const fn when(mut spec: CommandSpec, available: fn(&AppState) -> Availability) -> CommandSpec {
    spec.available = available;
    spec
}

/// Every command, in the order of the menus.
pub static COMMANDS: &[CommandSpec] = &[
    // Missions and files.
    plain("file.open", "Open a mission…", Group::File, &[keys(CTRL, Key::O)], Scope::Everywhere, |_| {
        Command::OpenFile(FileKind::Mission)
    }),
    when(
        plain("file.openDraft", "Bring back the last draft", Group::File, &[], Scope::Everywhere, |_| {
            Command::OpenEarlierDraft
        }),
        with_earlier_draft,
    ),
    plain("file.save", "Save the mission", Group::File, &[keys(CTRL, Key::S)], Scope::Everywhere, |_| {
        Command::SaveMission
    }),
    plain("file.importMap", "Import a map…", Group::File, &[], Scope::Everywhere, |_| {
        Command::OpenFile(FileKind::Map)
    }),
    plain("file.share", "Copy a link to this mission", Group::File, &[], Scope::Everywhere, |_| {
        Command::CopyLink
    }),
    when(
        plain("file.networkSvg", "Save the network as SVG…", Group::File, &[], Scope::Everywhere, |_| {
            Command::SaveNetwork(PictureFormat::Svg)
        }),
        with_network,
    ),
    when(
        plain("file.networkPng", "Save the network as PNG…", Group::File, &[], Scope::Everywhere, |_| {
            Command::SaveNetwork(PictureFormat::Png)
        }),
        with_network,
    ),
    called("file.example", "Open an example", Group::File, |_, arguments| {
        let name = text_argument(arguments, "name")?;
        mission_file::example(name)
            .map(|example| Command::OpenExample(example.name.into()))
            .ok_or_else(|| format!("there is no example \"{name}\""))
    }),
    // The text.
    when(
        plain("edit.undo", "Undo", Group::Edit, &[keys(CTRL, Key::Z)], Scope::Editor, |_| {
            Command::Text(TextCommand::Undo)
        }),
        with_undo,
    ),
    when(
        plain(
            "edit.redo",
            "Redo",
            Group::Edit,
            &[keys(CTRL_SHIFT, Key::Z), keys(CTRL, Key::Y)],
            Scope::Editor,
            |_| Command::Text(TextCommand::Redo),
        ),
        with_redo,
    ),
    plain("edit.find", "Find…", Group::Edit, &[keys(CTRL, Key::F)], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::Find { replacing: false })
    }),
    plain("edit.replace", "Replace…", Group::Edit, &[keys(CTRL, Key::H)], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::Find { replacing: true })
    }),
    plain(
        "edit.toggleComment",
        "Toggle comment",
        Group::Edit,
        &[keys(CTRL, Key::Slash)],
        Scope::Editor,
        |_| Command::Text(TextCommand::ToggleComment),
    ),
    plain(
        "edit.duplicate",
        "Duplicate lines",
        Group::Edit,
        &[keys(CTRL_SHIFT, Key::D)],
        Scope::Typing,
        |_| Command::Text(TextCommand::DuplicateLines),
    ),
    plain(
        "edit.deleteLines",
        "Delete lines",
        Group::Edit,
        &[keys(CTRL_SHIFT, Key::K)],
        Scope::Typing,
        |_| Command::Text(TextCommand::DeleteLines),
    ),
    plain("edit.moveUp", "Move lines up", Group::Edit, &[keys(ALT, Key::ArrowUp)], Scope::Typing, |_| {
        Command::Text(TextCommand::MoveLinesUp)
    }),
    plain(
        "edit.moveDown",
        "Move lines down",
        Group::Edit,
        &[keys(ALT, Key::ArrowDown)],
        Scope::Typing,
        |_| Command::Text(TextCommand::MoveLinesDown),
    ),
    plain("edit.complete", "Complete", Group::Edit, &[keys(CTRL, Key::Space)], Scope::Typing, |_| {
        Command::Editor(EditorCommand::Complete)
    }),
    plain(
        "edit.quickFix",
        "Quick fix…",
        Group::Edit,
        &[keys(CTRL, Key::Period)],
        Scope::Everywhere,
        |_| Command::Editor(EditorCommand::QuickFix),
    ),
    plain("edit.rename", "Rename…", Group::Edit, &[keys(PLAIN, Key::F2)], Scope::Editor, |_| {
        Command::Editor(EditorCommand::Rename)
    }),
    plain(
        "edit.format",
        "Format the text",
        Group::Edit,
        &[keys(ALT_SHIFT, Key::F)],
        Scope::Everywhere,
        |_| Command::Editor(EditorCommand::Format),
    ),
    plain(
        "edit.expandSelection",
        "Select more",
        Group::Edit,
        &[keys(ALT_SHIFT, Key::ArrowRight)],
        Scope::Typing,
        |_| Command::Editor(EditorCommand::ExpandSelection),
    ),
    plain("edit.fold", "Fold", Group::Edit, &[keys(CTRL_SHIFT, Key::OpenBracket)], Scope::Typing, |_| {
        Command::Editor(EditorCommand::FoldAtCaret(true))
    }),
    plain(
        "edit.unfold",
        "Unfold",
        Group::Edit,
        &[keys(CTRL_SHIFT, Key::CloseBracket)],
        Scope::Typing,
        |_| Command::Editor(EditorCommand::FoldAtCaret(false)),
    ),
    plain("edit.foldAll", "Fold everything", Group::Edit, &[], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::FoldAll(true))
    }),
    plain("edit.unfoldAll", "Unfold everything", Group::Edit, &[], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::FoldAll(false))
    }),
    called("edit.setSource", "Replace the text", Group::Edit, |_, arguments| {
        text_argument(arguments, "text").map(|text| Command::SetSource(text.to_owned()))
    }),
    called("edit.insert", "Type text at the caret", Group::Edit, |_, arguments| {
        let text = text_argument(arguments, "text")?;
        Ok(Command::Text(TextCommand::Insert(text.to_owned())))
    }),
    called("edit.select", "Select text", Group::Edit, |state, arguments| {
        let anchor = number_argument(arguments, "start")?;
        let head = number_argument(arguments, "end").unwrap_or(anchor);
        let offset = |value: f64| state.document.boundary_before(value.max(0.0) as usize);
        Ok(Command::Text(TextCommand::Select { anchor: offset(anchor), head: offset(head) }))
    }),
    // Going to places.
    plain(
        "go.palette",
        "Command palette",
        Group::Go,
        &[keys(CTRL_SHIFT, Key::P), keys(PLAIN, Key::F1)],
        Scope::Everywhere,
        |_| Command::ShowDialog(Dialog::palette()),
    ),
    plain("go.line", "Go to line…", Group::Go, &[keys(CTRL, Key::G)], Scope::Everywhere, |_| {
        Command::ShowDialog(Dialog::go_to_line())
    }),
    plain("go.definition", "Definition", Group::Go, &[keys(PLAIN, Key::F12)], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::GoToDefinition)
    }),
    plain("go.references", "References", Group::Go, &[keys(SHIFT, Key::F12)], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::FindReferences)
    }),
    when(
        plain(
            "go.nextProblem",
            "Next problem",
            Group::Go,
            &[keys(PLAIN, Key::F8)],
            Scope::Everywhere,
            |_| Command::Editor(EditorCommand::GoToProblem { forwards: true }),
        ),
        with_problems,
    ),
    when(
        plain(
            "go.previousProblem",
            "Previous problem",
            Group::Go,
            &[keys(SHIFT, Key::F8)],
            Scope::Everywhere,
            |_| Command::Editor(EditorCommand::GoToProblem { forwards: false }),
        ),
        with_problems,
    ),
    plain("go.findNext", "Next match", Group::Go, &[keys(PLAIN, Key::F3)], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::FindNext)
    }),
    plain("go.findPrevious", "Previous match", Group::Go, &[keys(SHIFT, Key::F3)], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::FindPrevious)
    }),
    when(
        plain("go.selectionText", "Text of the selection", Group::Go, &[], Scope::Everywhere, |state| {
            Command::SelectAndReveal(state.selection.clone())
        }),
        with_selection,
    ),
    plain("go.editor", "Mission text", Group::Go, &[keys(CTRL, Key::Num0)], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::Focus)
    }),
    plain("go.leave", "Leave", Group::Go, &[keys(PLAIN, Key::Escape)], Scope::Everywhere, |_| {
        Command::Escape
    }),
    called("edit.renameTo", "Rename the name at the caret", Group::Edit, |_, arguments| {
        let name = text_argument(arguments, "name")?;
        Ok(Command::Editor(EditorCommand::RenameTo(name.to_owned())))
    }),
    called("go.select", "Select by name", Group::Go, |state, arguments| {
        let name = text_argument(arguments, "name")?;
        if name.is_empty() {
            return Ok(Command::Select(Selection::None));
        }
        let snapshot = state.shown().ok_or("nothing has been worked out yet")?;
        Selection::by_name(snapshot, name)
            .map(Command::Select)
            .ok_or_else(|| format!("the mission has nothing named \"{name}\""))
    }),
    // Panels, zoom, appearance.
    plain(
        "view.author",
        "Author workspace",
        Group::View,
        &[keys(CTRL, Key::Num1)],
        Scope::Everywhere,
        |_| Command::ShowWorkspace(Workspace::Author),
    ),
    plain("view.teach", "Teach workspace", Group::View, &[keys(CTRL, Key::Num2)], Scope::Everywhere, |_| {
        Command::ShowWorkspace(Workspace::Teach)
    }),
    plain(
        "view.review",
        "Review workspace",
        Group::View,
        &[keys(CTRL, Key::Num3)],
        Scope::Everywhere,
        |_| Command::ShowWorkspace(Workspace::Review),
    ),
    plain(
        "view.execute",
        "Execute workspace",
        Group::View,
        &[keys(CTRL, Key::Num4)],
        Scope::Everywhere,
        |_| Command::ShowWorkspace(Workspace::Execute),
    ),
    plain("view.resetWorkspace", "Reset the panels", Group::View, &[], Scope::Everywhere, |_| {
        Command::ResetWorkspace
    }),
    plain(
        "view.zoomIn",
        "Zoom in",
        Group::View,
        &[keys(PLAIN, Key::Equals), keys(PLAIN, Key::Plus)],
        Scope::NotTyping,
        |_| Command::View(ViewAction::ZoomIn),
    ),
    plain("view.zoomOut", "Zoom out", Group::View, &[keys(PLAIN, Key::Minus)], Scope::NotTyping, |_| {
        Command::View(ViewAction::ZoomOut)
    }),
    plain(
        "view.zoomReset",
        "Reset the zoom",
        Group::View,
        &[keys(PLAIN, Key::Num0)],
        Scope::NotTyping,
        |_| Command::View(ViewAction::ZoomReset),
    ),
    plain("view.fit", "Fit everything", Group::View, &[keys(PLAIN, Key::F)], Scope::NotTyping, |_| {
        Command::View(ViewAction::Fit)
    }),
    when(
        plain(
            "view.fitSelection",
            "Fit the selection",
            Group::View,
            &[keys(SHIFT, Key::F)],
            Scope::NotTyping,
            |_| Command::View(ViewAction::FitSelection),
        ),
        with_selection,
    ),
    plain("view.theme", "Light or dark", Group::View, &[], Scope::Everywhere, |state| {
        Command::SetTheme(state.settings.theme.toggled())
    }),
    plain(
        "view.textLarger",
        "Larger text",
        Group::View,
        &[keys(CTRL, Key::Equals), keys(CTRL, Key::Plus)],
        Scope::Everywhere,
        |state| Command::SetTextScale(state.settings.text_scale + 0.1),
    ),
    plain(
        "view.textSmaller",
        "Smaller text",
        Group::View,
        &[keys(CTRL, Key::Minus)],
        Scope::Everywhere,
        |state| Command::SetTextScale(state.settings.text_scale - 0.1),
    ),
    plain("view.textReset", "Normal text size", Group::View, &[], Scope::Everywhere, |_| {
        Command::SetTextScale(1.0)
    }),
    plain("view.nextPanel", "Next panel", Group::View, &[keys(PLAIN, Key::F6)], Scope::Everywhere, |_| {
        Command::TurnPanel(true)
    }),
    plain(
        "view.previousPanel",
        "Previous panel",
        Group::View,
        &[keys(SHIFT, Key::F6)],
        Scope::Everywhere,
        |_| Command::TurnPanel(false),
    ),
    called("view.panel", "Show a panel", Group::View, |_, arguments| {
        panel_argument(arguments).map(Command::ShowPanel)
    }),
    called("view.closePanel", "Close a panel", Group::View, |_, arguments| {
        panel_argument(arguments).map(Command::ClosePanel)
    }),
    called("view.grouping", "Choose the grouping of the timeline", Group::View, |state, arguments| {
        let name = text_argument(arguments, "name")?;
        let grouping = Grouping::ALL.into_iter().find(|grouping| grouping.name() == name);
        let mut views = state.settings.views.clone();
        views.timeline.grouping = grouping.ok_or("\"name\" is \"structure\", \"thread\" or \"vehicle\"")?;
        Ok(Command::SetViews(Box::new(views)))
    }),
    called("view.selectTimes", "Select a range of times", Group::View, |_, arguments| {
        let number = |name: &str| arguments.get(name).and_then(Value::as_f64);
        Ok(Command::SelectTimes(number("from").zip(number("to")).map(|(from, to)| [from, to])))
    }),
    called("view.setTheme", "Choose the theme", Group::View, |_, arguments| {
        match text_argument(arguments, "theme")? {
            "dark" => Ok(Command::SetTheme(ThemeChoice::Dark)),
            "light" => Ok(Command::SetTheme(ThemeChoice::Light)),
            other => Err(format!("\"theme\" is \"dark\" or \"light\", not \"{other}\"")),
        }
    }),
    called("view.workspace", "Show a workspace", Group::View, |_, arguments| {
        let name = text_argument(arguments, "name")?;
        Workspace::by_name(name)
            .map(Command::ShowWorkspace)
            .ok_or_else(|| format!("there is no workspace \"{name}\""))
    }),
    // The ground.
    when(
        plain("terrain.fly", "Fly to the selection", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::View(ViewAction::FitSelection))
        }),
        with_selection,
    ),
    when(
        plain("terrain.follow", "Follow the vehicle", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::View(ViewAction::Follow))
        }),
        with_vehicles,
    ),
    when(
        plain("terrain.top", "Look straight down", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::View(ViewAction::TopView))
        }),
        with_ground,
    ),
    when(
        plain("terrain.reset", "Show the whole map", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::View(ViewAction::Fit))
        }),
        with_ground,
    ),
    when(
        plain(
            "terrain.clearance",
            "Clearance map",
            Group::Terrain,
            &[keys(PLAIN, Key::C)],
            Scope::NotTyping,
            |_| Command::Terrain(TerrainCommand::ToggleClearance),
        ),
        with_ground,
    ),
    when(
        plain(
            "terrain.growth",
            "Search tree of a path",
            Group::Terrain,
            &[keys(PLAIN, Key::T)],
            Scope::NotTyping,
            |_| Command::Terrain(TerrainCommand::Growth(GrowthCommand::Toggle)),
        ),
        with_paths,
    ),
    called("terrain.growTo", "Draw so many samples", Group::Terrain, |_, arguments| {
        let samples = number_argument(arguments, "samples")?.max(0.0) as u32;
        Ok(Command::Terrain(TerrainCommand::Growth(GrowthCommand::GoTo(samples))))
    }),
    called("terrain.growLeg", "Choose the leg of the search tree", Group::Terrain, |_, arguments| {
        let leg = number_argument(arguments, "leg")?.max(0.0) as usize;
        Ok(Command::Terrain(TerrainCommand::Growth(GrowthCommand::ChooseLeg(leg))))
    }),
    called("terrain.growBy", "Choose the path planner", Group::Terrain, |_, arguments| {
        let planner = match text_argument(arguments, "planner")? {
            "as-planned" => None,
            "rrt" => Some(PlannerKind::Rrt),
            "rrt-connect" => Some(PlannerKind::RrtConnect),
            "rrt-star" => Some(PlannerKind::RrtStar),
            "kinodynamic" => Some(PlannerKind::Kinodynamic),
            other => return Err(format!("there is no path planner \"{other}\"")),
        };
        Ok(Command::Terrain(TerrainCommand::Growth(GrowthCommand::ChoosePlanner(planner))))
    }),
    when(
        plain("terrain.measure", "Measure", Group::Terrain, &[keys(PLAIN, Key::M)], Scope::NotTyping, |_| {
            Command::Terrain(TerrainCommand::Take(Tool::Measure))
        }),
        with_ground,
    ),
    when(
        plain("terrain.location", "Place a location", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::Take(Tool::Location))
        }),
        with_ground,
    ),
    when(
        plain("terrain.circle", "Place a round obstacle", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::Take(Tool::Circle))
        }),
        with_ground,
    ),
    when(
        plain(
            "terrain.appear",
            "Let an obstacle appear in the run",
            Group::Terrain,
            &[],
            Scope::Everywhere,
            |_| Command::Terrain(TerrainCommand::Take(Tool::Appear)),
        ),
        with_run,
    ),
    when(
        plain(
            "terrain.polygon",
            "Place an obstacle with corners",
            Group::Terrain,
            &[],
            Scope::Everywhere,
            |_| Command::Terrain(TerrainCommand::Take(Tool::Polygon)),
        ),
        with_ground,
    ),
    when(
        plain("terrain.vehicle", "Place a vehicle", Group::Terrain, &[], Scope::Everywhere, |_| {
            Command::Terrain(TerrainCommand::Take(Tool::Vehicle(motion::VEHICLE_MODELS[0].name.into())))
        }),
        with_ground,
    ),
    // Planning.
    plain("plan.chronological", "Search chronologically", Group::Plan, &[], Scope::Everywhere, |_| {
        Command::SetSearch(mission::SearchKind::Chronological)
    }),
    plain(
        "plan.conflictDirected",
        "Search directed by conflicts",
        Group::Plan,
        &[],
        Scope::Everywhere,
        |_| Command::SetSearch(mission::SearchKind::ConflictDirected),
    ),
    plain("plan.compare", "Compare both searches", Group::Plan, &[], Scope::Everywhere, |state| {
        Command::Search(SearchCommand::Compare(!state.search.compares()))
    }),
    plain("plan.otherPaths", "Plan other paths", Group::Plan, &[], Scope::Everywhere, |state| {
        Command::SetSeed(state.settings.plan.seed + 1)
    }),
    called("plan.seed", "Choose the seed of path planning", Group::Plan, |_, arguments| {
        number_argument(arguments, "seed").map(|seed| Command::SetSeed(seed.max(0.0) as u64))
    }),
    called("plan.scenario", "Choose what to plan", Group::Plan, |_, arguments| {
        let name = text_argument(arguments, "name")?;
        Ok(Command::SetGoal(mission::Goal::Scenario(name.into())))
    }),
    // Judging and comparing.
    when(
        plain("review.run", "Review this plan", Group::Review, &[], Scope::Everywhere, |_| {
            Command::Review(ReviewCommand::Run)
        }),
        with_mission,
    ),
    when(
        plain("file.report", "Write the report", Group::Review, &[], Scope::Everywhere, |_| {
            Command::WriteReport
        }),
        with_mission,
    ),
    when(
        plain("export.csv", "Export the schedule as CSV", Group::Review, &[], Scope::Everywhere, |_| {
            Command::WriteSchedule { form: ScheduleForm::Csv, epoch: String::new() }
        }),
        with_plan,
    ),
    when(
        plain("export.openMct", "Export to Open MCT…", Group::Review, &[], Scope::Everywhere, |state| {
            ask_epoch(state, ScheduleForm::OpenMct)
        }),
        with_plan,
    ),
    when(
        plain("export.icalendar", "Export to a calendar…", Group::Review, &[], Scope::Everywhere, |state| {
            ask_epoch(state, ScheduleForm::Icalendar)
        }),
        with_plan,
    ),
    when(
        plain("compare.pin", "Compare from now on", Group::Review, &[], Scope::Everywhere, |_| {
            Command::Compare(CompareCommand::Pin)
        }),
        with_plan,
    ),
    when(
        plain(
            "compare.signedOff",
            "Compare with the last sign-off",
            Group::Review,
            &[],
            Scope::Everywhere,
            |_| Command::Compare(CompareCommand::WithSignedOff),
        ),
        with_sign_off,
    ),
    plain("compare.file", "Compare with a file…", Group::Review, &[], Scope::Everywhere, |_| {
        Command::Compare(CompareCommand::OpenFile)
    }),
    when(
        plain("review.save", "Save comments and sign-offs", Group::Review, &[], Scope::Everywhere, |_| {
            Command::Review(ReviewCommand::SaveRecord)
        }),
        with_record,
    ),
    plain("review.open", "Add comments and sign-offs…", Group::Review, &[], Scope::Everywhere, |_| {
        Command::Review(ReviewCommand::OpenRecord)
    }),
    called("review.sign", "Sign off", Group::Review, |state, arguments| {
        let name = text_argument(arguments, "name")?;
        match state.current_review().map(|review| may_sign(review)) {
            Some(Ok(())) => Ok(Command::Review(ReviewCommand::Sign { name: name.to_owned() })),
            Some(Err(reason)) => Err(reason.to_owned()),
            None => Err("the present text has not been reviewed".to_owned()),
        }
    }),
    called("review.comment", "Comment", Group::Review, |_, arguments| {
        Ok(Command::Review(ReviewCommand::Comment {
            author: text_argument(arguments, "author")?.to_owned(),
            about: arguments.get("about").and_then(Value::as_str).map(str::to_owned),
            text: text_argument(arguments, "text")?.to_owned(),
        }))
    }),
    called("export.schedule", "Export the schedule", Group::Review, |_, arguments| {
        let name = text_argument(arguments, "as")?;
        let form = ScheduleForm::by_name(name)
            .ok_or_else(|| "\"as\" is \"csv\", \"open-mct\" or \"icalendar\"".to_owned())?;
        let epoch = arguments.get("epoch").and_then(Value::as_str).unwrap_or_default().to_owned();
        Ok(Command::WriteSchedule { form, epoch })
    }),
    when(
        plain("plan.release", "Release pinned events", Group::Plan, &[], Scope::Everywhere, |_| {
            Command::Pins(PinCommand::ReleaseAll)
        }),
        with_pins,
    ),
    when(
        called("plan.pin", "Pin an event to a time", Group::Plan, |state, arguments| {
            let name = arguments.get("event").and_then(Value::as_str);
            let time = arguments.get("time").and_then(Value::as_f64);
            let (Some(name), Some(time)) = (name, time.filter(|time| time.abs() < 1e12)) else {
                return Err("it takes {\"event\": text, \"time\": number}".to_owned());
            };
            let network = state.shown().and_then(|shown| shown.network.as_deref());
            let node = network.and_then(|network| event_by_name(network, name));
            let node = node.ok_or_else(|| format!("there is no event \"{name}\""))?;
            // Pins are resolved to a tenth of a unit at least; thousandths are finer than any drag.
            let time = rmpl::Rational::new((time * 1000.0).round() as i64, 1000);
            Ok(Command::Pins(PinCommand::Pin(node, time)))
        }),
        with_plan,
    ),
    // Time.
    when(
        plain(
            "play.toggle",
            "Play or pause",
            Group::Play,
            &[keys(PLAIN, Key::Space)],
            Scope::NotTyping,
            |_| Command::TogglePlaying,
        ),
        with_steps,
    ),
    when(
        plain(
            "play.forward",
            "Next event",
            Group::Play,
            &[keys(PLAIN, Key::Period)],
            Scope::NotTyping,
            |_| Command::StepTime(true),
        ),
        with_steps,
    ),
    when(
        plain(
            "play.back",
            "Previous event",
            Group::Play,
            &[keys(PLAIN, Key::Comma)],
            Scope::NotTyping,
            |_| Command::StepTime(false),
        ),
        with_steps,
    ),
    when(
        plain(
            "play.start",
            "To the start",
            Group::Play,
            &[keys(PLAIN, Key::Home)],
            Scope::NotTyping,
            |state| {
                if state.steps_search() { search(SearchCommand::GoTo(0)) } else { Command::Seek(0.0) }
            },
        ),
        with_steps,
    ),
    when(
        plain("play.end", "To the end", Group::Play, &[keys(PLAIN, Key::End)], Scope::NotTyping, |state| {
            if state.steps_search() {
                search(SearchCommand::GoTo(usize::MAX))
            } else {
                Command::Seek(state.playback.end)
            }
        }),
        with_steps,
    ),
    plain("play.faster", "Faster", Group::Play, &[], Scope::Everywhere, |state| {
        if state.steps_search() {
            search(SearchCommand::SetSpeed(state.search.steps_per_sec * 2.0))
        } else {
            Command::SetRate(state.playback.rate * 2.0)
        }
    }),
    plain("play.slower", "Slower", Group::Play, &[], Scope::Everywhere, |state| {
        if state.steps_search() {
            search(SearchCommand::SetSpeed(state.search.steps_per_sec / 2.0))
        } else {
            Command::SetRate(state.playback.rate / 2.0)
        }
    }),
    // The recorded search.
    when(
        plain(
            "search.run",
            "Run to the next breakpoint",
            Group::Play,
            &[keys(PLAIN, Key::CloseBracket)],
            Scope::NotTyping,
            |_| search(SearchCommand::Run(true)),
        ),
        with_search,
    ),
    when(
        plain(
            "search.runBack",
            "Run back to the breakpoint before",
            Group::Play,
            &[keys(PLAIN, Key::OpenBracket)],
            Scope::NotTyping,
            |_| search(SearchCommand::Run(false)),
        ),
        with_search,
    ),
    when(
        plain("search.close", "Show the plan again", Group::Play, &[], Scope::Everywhere, |_| {
            search(SearchCommand::Close)
        }),
        with_step,
    ),
    when(
        plain("search.turn", "Turn to the other search", Group::Play, &[], Scope::Everywhere, |state| {
            search(SearchCommand::Turn(1 - state.search.side().min(1)))
        }),
        with_comparison,
    ),
    when(
        plain("search.link", "Step both searches together", Group::Play, &[], Scope::Everywhere, |state| {
            search(SearchCommand::Link(!state.search.is_linked()))
        }),
        with_comparison,
    ),
    when(
        called("search.goTo", "Go to a step of the search", Group::Play, |_, arguments| {
            let step = number_argument(arguments, "step")?;
            if step < 1.0 {
                return Ok(search(SearchCommand::Close));
            }
            Ok(search(SearchCommand::GoTo(step as usize - 1)))
        }),
        with_search,
    ),
    when(
        called("search.goToState", "Go to a state of the search", Group::Play, |_, arguments| {
            let state = number_argument(arguments, "state")?;
            Ok(search(SearchCommand::GoToNode(state.max(0.0) as u32)))
        }),
        with_search,
    ),
    called("search.breakpoints", "Choose where the search stops", Group::Play, |state, arguments| {
        let mut chosen = state.search.breakpoints;
        for (name, value) in [
            ("decision", &mut chosen.decision),
            ("failure", &mut chosen.failure),
            ("threat", &mut chosen.threat),
            ("solution", &mut chosen.solution),
        ] {
            match arguments.get(name) {
                None => {}
                Some(Value::Bool(stops)) => *value = *stops,
                Some(_) => return Err(format!("\"{name}\" is true or false")),
            }
        }
        Ok(search(SearchCommand::SetBreakpoints(chosen)))
    }),
    called("search.speed", "Choose how many steps go by in a second", Group::Play, |_, arguments| {
        number_argument(arguments, "steps").map(|speed| search(SearchCommand::SetSpeed(speed)))
    }),
    called("play.seek", "Go to a time", Group::Play, |_, arguments| {
        number_argument(arguments, "time").map(Command::Seek)
    }),
    // The run of a mission.
    when(
        plain("execute.reset", "Start the run over", Group::Play, &[], Scope::Everywhere, |_| {
            Command::Execution(ExecutionCommand::Reset)
        }),
        with_run,
    ),
    when(
        plain("execute.save", "Save the run…", Group::Play, &[], Scope::Everywhere, |_| {
            Command::Execution(ExecutionCommand::Save)
        }),
        with_run,
    ),
    plain("execute.replay", "Replay a run…", Group::Play, &[], Scope::Everywhere, |_| {
        Command::Execution(ExecutionCommand::Open)
    }),
    when(
        called("execute.withdraw", "Withdraw a condition now", Group::Play, |_, arguments| {
            let condition = text_argument(arguments, "condition")?;
            Ok(Command::Execution(ExecutionCommand::Withdraw(condition.into())))
        }),
        with_run,
    ),
    when(
        called("execute.disturb", "Disturb the run", Group::Play, |_, arguments| {
            let disturbance = serde_json::from_value(arguments.clone()).map_err(|error| error.to_string())?;
            Ok(Command::Execution(ExecutionCommand::Disturb(disturbance)))
        }),
        with_run,
    ),
    when(
        called("program.inject", "Bring a component into a mode in this step", Group::Play, injection),
        with_program,
    ),
    when(
        plain("program.reset", "Start the program anew", Group::Play, &[], Scope::Everywhere, |_| {
            Command::Automaton(AutomatonCommand::Reset)
        }),
        with_program,
    ),
    when(
        plain("execute.sample", "Run many times with chance", Group::Play, &[], Scope::Everywhere, |_| {
            Command::Chance(ChanceCommand::Start)
        }),
        with_chance,
    ),
    plain("execute.stopSampling", "Stop the runs with chance", Group::Play, &[], Scope::Everywhere, |_| {
        Command::Chance(ChanceCommand::Stop)
    }),
    // Help.
    plain(
        "help.keys",
        "Keyboard shortcuts",
        Group::Help,
        &[keys(PLAIN, Key::Questionmark)],
        Scope::NotTyping,
        |_| Command::ShowDialog(Dialog::Keys),
    ),
    plain("help.about", "About Enroute", Group::Help, &[], Scope::Everywhere, |_| {
        Command::ShowDialog(Dialog::About)
    }),
];

fn text_argument<'a>(arguments: &'a Value, name: &str) -> Result<&'a str, String> {
    let value = arguments.get(name).unwrap_or(arguments);
    value.as_str().ok_or_else(|| format!("it takes {{\"{name}\": text}}"))
}

fn number_argument(arguments: &Value, name: &str) -> Result<f64, String> {
    let value = arguments.get(name).unwrap_or(arguments);
    value.as_f64().ok_or_else(|| format!("it takes {{\"{name}\": number}}"))
}

fn panel_argument(arguments: &Value) -> Result<PanelKind, String> {
    let name = text_argument(arguments, "name")?;
    PanelKind::by_name(name).ok_or_else(|| {
        let known: Vec<&str> = PanelKind::ALL.iter().map(|panel| panel.name()).collect();
        format!("there is no panel \"{name}\"; there are {}", known.join(", "))
    })
}
