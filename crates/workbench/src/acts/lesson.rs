//! The lesson that is open: it opens missions, sets how they are searched, and does commands by their names.
//!
//! A stop is shown as soon as the core has answered for the text that is there: its step is a step of that search.

use std::sync::Arc;

use kirk::Search as SearchKind;
use markdown::Block;
use smol_str::SmolStr;

use crate::command::Command;
use crate::description::Description;
use crate::effect::Effect;
use crate::lesson::{
    Action, Answer, Expression, Glossary, Lesson, LessonError, LessonMission, LessonSearch, course_lesson,
    filled,
};
use crate::library::MissionKind;
use crate::panel_effect::PanelEffect;
use crate::panel_kind::PanelKind;
use crate::registry::{self, read_lesson};
use crate::state::AppState;
use crate::state::lesson::{Given, LessonCommand, Predictions, learned_key};
use crate::state::search::SearchCommand;
use crate::state::settings::{PlanSettings, Settings};

impl AppState {
    pub(super) fn apply_to_lesson(&mut self, command: LessonCommand) {
        match command {
            LessonCommand::Show => self.show_lesson(),
            LessonCommand::Contents => {
                self.leave_lesson();
                self.show_lesson();
            }
            LessonCommand::Open(name, stop) => self.open_lesson(&name, stop),
            LessonCommand::GoTo(stop) => self.go_to_stop(stop),
            LessonCommand::Turn(forwards) => self.turn_lesson(forwards),
            LessonCommand::ShowAgain => self.arrive_at(self.lesson.stop),
            LessonCommand::Restore => {
                self.restore_text();
                self.lesson.is_due = true;
            }
            LessonCommand::Answer(text) => self.answer(text),
            LessonCommand::Solve => self.solve(),
            LessonCommand::Leave => self.leave_lesson(),
        }
    }

    /// Returns what the stop says, with what is computed filled in and the first occurrence of each term marked.
    pub fn lesson_prose(&self) -> Vec<Block> {
        let Some(stop) = self.lesson.stop() else { return Vec::new() };
        Glossary::get().marked(&filled(&stop.prose, &mut |text| self.lesson_value(text)))
    }

    /// Returns what represents `{{text}}` in prose now.
    pub fn lesson_value(&self, text: &str) -> String {
        let value =
            Expression::read(text).ok().and_then(|expression| expression.value(&Description::of(self)));
        value.map_or_else(|| "…".to_owned(), |value| value.to_string())
    }

    /// A text of one line with what is computed filled in.
    pub fn lesson_line(&self, text: &str) -> String {
        let document = markdown::Document::parse(text);
        let blocks = filled(&document.blocks, &mut |text| self.lesson_value(text));
        blocks.iter().map(Block::plain).collect::<Vec<_>>().join(" ")
    }

    /// Returns whether a stop of the course was answered rightly, in this run or an earlier one.
    pub fn is_learned(&self, lesson: &str, stop: usize) -> bool {
        self.settings.learned.contains(&learned_key(lesson, stop))
    }

    /// Returns what is remembered: how planning and the text are set while no lesson sets them.
    pub(crate) fn settings_to_keep(&self) -> Settings {
        let plan = self.lesson.plan_settings.as_ref().unwrap_or(&self.settings.plan);
        let mut kept = Settings { plan: plan.clone(), ..self.settings.clone() };
        kept.views.editor.wraps = self.lesson.wraps_before.unwrap_or(kept.views.editor.wraps);
        kept
    }

    /// Opens a file as a lesson, whatever is wrong in it: the panel says what that is, by line.
    pub(super) fn open_lesson_file(&mut self, file: &str, bytes: Vec<u8>) {
        let Ok(text) = String::from_utf8(bytes) else {
            self.window.failed(format!("{file} is not a text file"));
            return;
        };
        let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
        // A lesson of the course keeps its name.
        let name: SmolStr =
            if course_lesson(stem).is_some() { format!("{stem} (file)") } else { stem.to_owned() }.into();
        let (lesson, errors) = read_lesson(&name, &text);
        let stop = self.lesson.open.as_ref().filter(|open| open.name == name).map_or(0, |_| self.lesson.stop);
        let errors: Arc<[LessonError]> = errors.into();
        if !errors.is_empty() {
            let count =
                if errors.len() == 1 { "1 error".to_owned() } else { format!("{} errors", errors.len()) };
            self.window.failed(format!("{file} has {count}; see the Lesson panel"));
        }
        self.lesson.own.insert(name.clone(), (Arc::new(lesson), errors));
        self.open_lesson(&name, stop);
    }

    /// Shows the lessons' panels.
    fn show_lesson(&mut self) {
        if self.lesson.panels.is_empty() {
            self.lesson.panels =
                vec![vec![vec![PanelKind::Network]], vec![vec![PanelKind::Editor, PanelKind::Timeline]]];
        }
        if !self.lesson.is_beside {
            self.lesson.is_beside = true;
            self.window.panel_effects.push(PanelEffect::Arrange);
        }
        self.window.turn_to(PanelKind::Lesson);
    }

    fn open_lesson(&mut self, name: &str, stop: usize) {
        let (lesson, errors) = match (self.lesson.own.get(name), course_lesson(name)) {
            (Some((lesson, errors)), _) => (Arc::clone(lesson), Arc::clone(errors)),
            (None, Some(found)) => {
                let (lesson, errors) = read_lesson(found.name, found.text);
                (Arc::new(lesson), errors.into())
            }
            (None, None) => {
                self.window.failed(format!("Unknown lesson “{name}”"));
                return;
            }
        };
        self.enter(lesson, errors, stop);
    }

    /// Opens the mission of a stop and goes there.
    fn enter(&mut self, lesson: Arc<Lesson>, errors: Arc<[LessonError]>, stop: usize) {
        let kept = self.lesson.plan_settings.take().unwrap_or_else(|| self.settings.plan.clone());
        let mission = lesson.mission_at(stop).clone();
        match &mission {
            LessonMission::Example(name) => self.open_example(name),
            LessonMission::Text(text) => {
                self.open_original(lesson.title.as_str().into(), MissionKind::Lesson, text);
            }
        }
        self.attach_lesson(lesson, errors, kept);
        self.lesson.opened = Some(mission);
        self.arrive_at(stop);
    }

    /// The lesson is about the mission that is open, as it stands.
    fn attach_lesson(&mut self, lesson: Arc<Lesson>, errors: Arc<[LessonError]>, kept: PlanSettings) {
        self.lesson.plan_settings = Some(kept);
        // Beside prose there is less room for the text.
        let wraps = &mut self.settings.views.editor.wraps;
        self.lesson.wraps_before.get_or_insert(*wraps);
        *wraps = true;
        self.set_lesson_search(lesson.search);
        (self.lesson.open, self.lesson.errors) = (Some(lesson), errors);
        self.lesson.stop = 0;
    }

    /// Lets planning search as a lesson wants it, and record that.
    fn set_lesson_search(&mut self, search: LessonSearch) {
        self.settings.plan.trace = true;
        self.settings.plan.search = Some(match search {
            LessonSearch::One(kind) => kind,
            LessonSearch::Both => SearchKind::Chronological,
        });
        let shown = self.shown().cloned();
        self.search.apply(SearchCommand::Compare(search == LessonSearch::Both), shown.as_ref());
    }

    /// Continues with a lesson of the course whose mission was edited, and is open.
    pub(crate) fn resume_lesson(&mut self, name: &str, stop: usize) {
        let Some(found) = course_lesson(name) else { return };
        let (lesson, errors) = read_lesson(found.name, found.text);
        let kept = self.lesson.plan_settings.take().unwrap_or_else(|| self.settings.plan.clone());
        self.lesson.opened = Some(lesson.mission_at(stop).clone());
        self.attach_lesson(Arc::new(lesson), errors.into(), kept);
        self.arrive_at(stop);
    }

    /// Goes to a stop; it begins with the lesson's text.
    fn go_to_stop(&mut self, stop: usize) {
        let Some(lesson) = self.lesson.open.clone() else { return };
        let stop = stop.min(lesson.stops.len().saturating_sub(1));
        if self.lesson.opened.as_ref() != Some(lesson.mission_at(stop)) {
            let errors = Arc::clone(&self.lesson.errors);
            self.enter(lesson, errors, stop);
            return;
        }
        self.restore_text();
        self.arrive_at(stop);
    }

    /// Gives the mission the text that the lesson opened it with, as an edit that can be undone.
    fn restore_text(&mut self) {
        let Some(mission) = &self.lesson.opened else { return };
        let text = text_editing::Document::new(mission.source());
        if text.text() != self.document.text() {
            self.document.replace_all(text.text());
        }
    }

    fn arrive_at(&mut self, stop: usize) {
        let Some(lesson) = &self.lesson.open else { return };
        self.lesson.stop = stop.min(lesson.stops.len().saturating_sub(1));
        self.lesson.is_due = true;
        self.lesson.predictions =
            Predictions { revision: self.document.revision(), ..Predictions::default() };
        let wanted = self.lesson.stop().map(|stop| stop.show.panels.clone()).unwrap_or_default();
        if !wanted.is_empty() && wanted != self.lesson.panels {
            self.lesson.panels = wanted;
            self.window.panel_effects.push(PanelEffect::Arrange);
        }
        self.show_lesson();
        self.window.ask(Effect::ShowAddress);
    }

    fn turn_lesson(&mut self, forwards: bool) {
        let Some(lesson) = &self.lesson.open else { return };
        let (at, stops) = (self.lesson.stop, lesson.stops.len());
        match (forwards, self.lesson.neighbor(forwards)) {
            (true, _) if at + 1 < stops => self.go_to_stop(at + 1),
            (false, _) if at > 0 => self.go_to_stop(at - 1),
            (true, Some(next)) => self.open_lesson(next, 0),
            (false, Some(before)) => self.open_lesson(before, usize::MAX),
            (_, None) => {}
        }
    }

    /// Another mission is opened: the lesson is not about it, and planning is set as it was before.
    pub(super) fn leave_lesson_behind(&mut self) {
        self.lesson.leave_mission();
        if let Some(kept) = self.lesson.plan_settings.take() {
            self.settings.plan = PlanSettings { goal: self.settings.plan.goal.clone(), ..kept };
        }
        if let Some(wraps) = self.lesson.wraps_before.take() {
            self.settings.views.editor.wraps = wraps;
        }
    }

    fn leave_lesson(&mut self) {
        self.leave_lesson_behind();
        self.search.apply(SearchCommand::Compare(false), None);
        self.window.ask(Effect::ShowAddress);
    }

    fn answer(&mut self, text: String) {
        let Some(ask) = self.lesson.stop().and_then(|stop| stop.ask.as_ref()) else { return };
        match ask.answer {
            Answer::Task(_) => return,
            Answer::Prediction(_) => return self.predict(text),
            Answer::Choice(_) | Answer::Number(..) | Answer::Word(_) => {}
        }
        let Some(is_right) = ask.answer.is_right(&text, &Description::of(self)) else {
            self.window.info("Wait until planning ends, then check your answer");
            return;
        };
        self.note_answer(Given { text, is_right });
    }

    fn note_answer(&mut self, given: Given) {
        let Some(lesson) = &self.lesson.open else { return };
        if given.is_right && course_lesson(&lesson.name).is_some() {
            self.settings.learned.insert(learned_key(&lesson.name, self.lesson.stop));
        }
        let stop = (lesson.name.clone(), self.lesson.stop);
        self.lesson.answers.insert(stop, given);
    }

    /// Judges the task of the stop, once what it shows is shown.
    pub(super) fn judge_task(&mut self) {
        let Some(ask) = self.lesson.stop().and_then(|stop| stop.ask.as_ref()) else { return };
        let is_done = self.lesson.given().is_some_and(|given| given.is_right);
        if let Answer::Task(condition) = &ask.answer
            && !is_done
            && condition.holds(&Description::of(self)) == Some(true)
        {
            self.note_answer(Given { text: String::new(), is_right: true });
        }
    }

    /// Does what the task asks for, once the mission's run is there if one is on its way.
    pub(super) fn solve(&mut self) {
        self.lesson.is_solution_due = self.is_awaiting_run();
        if self.lesson.is_solution_due {
            return;
        }
        let Some(ask) = self.lesson.stop().and_then(|stop| stop.ask.as_ref()) else { return };
        for action in ask.solution.clone() {
            match action {
                Action::Replace(before, after) => {
                    let text = self.document.text();
                    if text.contains(&before) {
                        let text = text.replacen(&before, &after, 1);
                        self.document.replace_all(&text);
                    } else {
                        let text = format!(
                            "Couldn't find “{before}” in the text. Choose Reset text, then try again."
                        );
                        self.window.info(text);
                    }
                }
                Action::Command(_, id, arguments) => self.do_named(&id, &arguments),
            }
        }
    }

    /// Runs a command by its name.
    fn do_named(&mut self, id: &str, arguments: &serde_json::Value) {
        match registry::command_of_lesson(self, id, arguments) {
            Ok(command) => self.do_lesson_command(command),
            Err(error) => self.window.failed(format!("{id}: {error}")),
        }
    }

    pub(super) fn do_lesson_command(&mut self, command: Command) {
        let is_beside = self.lesson.is_beside;
        self.route(command);
        self.lesson.is_beside = is_beside;
    }
}
