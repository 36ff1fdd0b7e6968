//! Doing what a stop shows: panels, workspace, step, selection, camera, time.

use crate::lesson::{Expectation, LessonSearch, Show, StepTarget, Which};
use crate::panel_effect::ViewAction;
use crate::panel_kind::PanelKind;
use crate::state::AppState;
use crate::state::automaton::{AutomatonCommand, ProgramPart};
use crate::state::growth::{GrowthCommand, Planners};
use crate::state::pins::Pins;
use crate::state::search::wording::event;
use crate::state::search::{Recording, SearchCommand};
use crate::state::selection::Selection;
use crate::state::snapshots::Status;
use crate::state::terrain::TerrainCommand;
use crate::state::toast::ToastKind;
use crate::workspace::Workspace;

/// The panels whose view begins again at each stop.
const VIEWS: [PanelKind; 4] =
    [PanelKind::Network, PanelKind::Timeline, PanelKind::Terrain, PanelKind::Distances];

impl AppState {
    /// Shows what the stop shows, as soon as the core has answered, and judges its task.
    pub(crate) fn follow_lesson(&mut self) {
        if self.lesson.open.is_none() {
            return;
        }
        if self.lesson.is_due {
            if !self.is_ready_for_stop() {
                return;
            }
            self.lesson.is_due = false;
            let show = self.lesson.stop().map(|stop| stop.show.clone()).unwrap_or_default();
            self.show(&show);
            self.check_expectation();
            self.follow_predictions();
            return;
        }
        self.draw_samples();
        if self.lesson.is_solution_due {
            self.solve();
        }
        self.judge_task();
        self.follow_predictions();
    }

    /// Draws the samples that the stop shows, once the core has found them.
    fn draw_samples(&mut self) {
        let Some(samples) = self.lesson.samples_due else { return };
        let is_found =
            self.terrain.growth.shown().is_some_and(|shown| shown.total() >= samples || shown.is_complete());
        if is_found {
            self.lesson.samples_due = None;
            self.apply_to_terrain(TerrainCommand::Growth(GrowthCommand::GoTo(samples)));
            // From near, the last sample is what is to be seen.
            if self.lesson.stop().is_some_and(|stop| stop.show.near.contains(&PanelKind::Terrain)) {
                self.window.view(PanelKind::Terrain, ViewAction::FitSelection);
            }
        }
    }

    /// Returns whether everything that a stop can show has been worked out.
    fn is_ready_for_stop(&self) -> bool {
        let Some(latest) = self.snapshots.latest() else { return false };
        if latest.revision != self.document.revision() || latest.stage != snapshot::Stage::Complete {
            return false;
        }
        if self.automaton.is_control() {
            return self.automaton.program().is_some() && self.automaton.progress().is_none();
        }
        let compares = self.lesson.open.as_ref().is_some_and(|lesson| lesson.search == LessonSearch::Both);
        let awaits_both = compares && latest.planning.is_some();
        !awaits_both || self.search.recordings(self.shown()).len() == 2
    }

    fn show(&mut self, show: &Show) {
        self.begin_stop(show);
        self.apply_to_search(SearchCommand::Turn(show.side));
        if let Some((line, target)) = &show.step {
            match self.step_of(target) {
                Some(step) => self.apply_to_search(SearchCommand::GoTo(step)),
                None => self.tell_lecturer(*line, "the search doesn't have this step"),
            }
        }
        if let Some(moments) = show.moments {
            self.automaton.apply(AutomatonCommand::GoTo(moments));
        }
        if let Some((line, name)) = &show.select {
            let found = self.shown().and_then(|shown| Selection::by_name(shown, name));
            match found {
                Some(selection) => self.writing().select(selection),
                None => self.tell_lecturer(*line, &format!("nothing in the mission is named “{name}”")),
            }
        }
        if show.samples.is_some() || show.planner.is_some() {
            self.apply_to_terrain(TerrainCommand::Growth(GrowthCommand::Toggle));
            self.apply_to_terrain(TerrainCommand::Growth(GrowthCommand::Choose(
                show.planner.unwrap_or_default(),
            )));
            self.lesson.samples_due = show.samples;
            self.draw_samples();
        }
        if let Some(time) = show.time {
            self.playback.seek(time);
        }
        for (line, id, arguments) in &show.commands {
            match crate::registry::command_of_lesson(self, id, arguments) {
                Ok(command) => self.do_lesson_command(command),
                Err(error) => self.tell_lecturer(*line, &format!("{id}: {error}")),
            }
        }
        for panel in VIEWS {
            let is_near = show.near.contains(&panel);
            self.window.view(panel, if is_near { ViewAction::FitSelection } else { ViewAction::Fit });
        }
        // The whole of a large tree or automaton cannot be read: it is shown around the step.
        for panel in [PanelKind::Search, PanelKind::Automaton] {
            self.window.view(panel, ViewAction::FitSelection);
        }
        self.window.active_panel = PanelKind::Lesson;
    }

    /// Nothing of the stop before is left: no step, no selection, no pins, no trees, no steps of a program.
    fn begin_stop(&mut self, show: &Show) {
        let usual = if self.automaton.is_control() { Workspace::Execute } else { Workspace::Teach };
        self.window.workspace = show.workspace.unwrap_or(usual);
        self.search.close();
        *self.selection = Selection::None;
        *self.pins = Pins::default();
        self.lesson.samples_due = None;
        self.lesson.is_solution_due = false;
        self.reason = 0;
        self.time_range = None;
        self.playback.is_playing = false;
        self.playback.seek(0.0);
        self.apply_to_terrain(TerrainCommand::Growth(GrowthCommand::Choose(Planners::AsPlanned)));
        self.apply_to_terrain(TerrainCommand::Growth(GrowthCommand::Close));
        if self.automaton.is_control() {
            self.automaton.apply(AutomatonCommand::Reset);
            self.automaton.part = ProgramPart::default();
        }
    }

    /// A step by what happens in it, from 0.
    pub(crate) fn step_of(&self, target: &StepTarget) -> Option<usize> {
        let recordings = self.search.recordings(self.shown());
        let recording: &Recording = recordings.get(self.search.side())?;
        let trace = recording.trace();
        match target {
            StepTarget::Number(number) => number.checked_sub(1).filter(|step| *step < recording.steps()),
            StepTarget::End => recording.steps().checked_sub(1),
            StepTarget::Kind { which, kind, with } => {
                let mut steps = trace.events.iter().enumerate().filter(|(_, entry)| {
                    kind.is(&entry.event)
                        && event(recording.network(), trace, &entry.event).contains(with.as_str())
                });
                let found = match which {
                    Which::Nth(nth) => steps.nth(nth.checked_sub(1)?),
                    Which::Last => steps.next_back(),
                };
                found.map(|(step, _)| step)
            }
        }
    }

    /// Tells the lecturer if the lesson's mission, as it is, does not come to what the lesson says of it.
    fn check_expectation(&mut self) {
        let Some(lesson) = &self.lesson.open else { return };
        let is_its_mission = self.lesson.opened.as_ref() == Some(&lesson.mission);
        let (status, words) = match lesson.expects {
            Expectation::Plan => (Status::Plan, "has a plan"),
            Expectation::NoPlan => (Status::NoPlan, "has no plan"),
            Expectation::Errors => (Status::Broken, "has errors"),
            Expectation::Program => (Status::Program, "is a control program"),
        };
        if is_its_mission && self.lesson.text() == Some(self.document.text()) && self.status() != status {
            let text = format!(
                "The lesson header (expects) states that its mission {words}, but the planner \
                         found otherwise"
            );
            self.window.failed(text);
        }
    }

    /// Says what a stop wants and the mission does not have. After an edit of the text that is no one's mistake.
    fn tell_lecturer(&mut self, line: u32, message: &str) {
        let is_own_text = self.lesson.text() == Some(self.document.text());
        let kind = if is_own_text { ToastKind::Failed } else { ToastKind::Info };
        let whose = if is_own_text { "Line" } else { "You edited the text. Line" };
        self.window.toasts.add(kind, format!("{whose} {line} of the lesson: {message}"));
    }
}
