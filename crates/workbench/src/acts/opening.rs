//! Opening another text: every part of the state begins again.

use rmpl::Span;
use smol_str::SmolStr;

use crate::library::MissionKind;
use crate::manual;
use crate::mission_file;
use crate::panel_kind::PanelKind;
use crate::state::AppState;
use crate::state::manual::ManualCommand;
use crate::state::pins::Pins;
use crate::state::playback::Playback;
use crate::state::selection::Selection;
use crate::state::terrain::TerrainState;
use crate::workspace::Workspace;

impl AppState {
    pub(super) fn open_example(&mut self, name: &str) {
        if let Some(example) = mission_file::example(name) {
            self.open_original(example.name.into(), MissionKind::Example, example.source);
        }
    }

    /// Opens a text under a name: what belongs to the one before goes.
    pub(super) fn open(&mut self, name: SmolStr, source: &str) {
        self.end_film();
        self.document.open(source);
        self.missions_opened += 1;
        self.editor.popup = None;
        self.editor.folding.unfold_all();
        self.mission = name;
        self.leave_lesson_behind();
        self.reviewing().leave();
        self.snapshots.clear();
        self.automaton.forget();
        self.search.forget();
        self.execution.forget();
        self.turn_to_notation(source);
        self.language.follow(&self.document);
        *self.selection = Selection::None;
        self.derived.lost_selection = None;
        self.hovered = Selection::None;
        *self.terrain = TerrainState::default();
        *self.pins = Pins::default();
        self.time_range = None;
        *self.playback = Playback { rate: self.playback.rate, ..Playback::default() };
        self.settings.plan.goal = snapshot::Goal::Default;
        self.window.scroll_to(Span::new(0, 0), false);
        self.window.dialog = None;
    }

    /// Control programs and missions are looked at in different workspaces.
    fn turn_to_notation(&mut self, source: &str) {
        let is_control = rmpl::control::is_control_text(source);
        if is_control {
            self.window.workspace = Workspace::Execute;
            self.window.show(PanelKind::Editor);
            self.window.turn_to(PanelKind::Automaton);
        } else if self.window.workspace == Workspace::Execute && !self.language.is_control() {
            self.window.show(PanelKind::Execution);
        } else if self.window.workspace == Workspace::Execute {
            self.window.workspace = Workspace::Author;
            self.window.active_panel = PanelKind::Editor;
        }
    }

    /// The page and the section of the manual about what the pointer is over in the text, or else about what the caret is
    /// at while the text is the panel asked about: a problem there, or the part of the language.
    pub(super) fn about_text(&self, command: &ManualCommand) -> Option<(&'static str, String)> {
        let ManualCommand::About(panel) = command else { return None };
        let caret = || (*panel == PanelKind::Editor).then(|| self.document.caret().head);
        let place = self.editor.hovered.or_else(caret)? as u32;
        let is_there = |span: Span| span.start <= place && place <= span.end;
        let problem = self.snapshots.problems().iter().find(|problem| is_there(problem.span));
        problem.and_then(|problem| manual::about_code(&problem.code)).or_else(|| {
            let hover =
                rmpl::editor::hover(self.language.parse()?, place, &rmpl::editor::Evaluation::default())?;
            let (page, section) = manual::about_topic(hover.topic);
            Some((page, section.to_owned()))
        })
    }
}
