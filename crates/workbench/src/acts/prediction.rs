//! Predictions: what comes next in the search or in a run, asked for before the panels show it.
//!
//! The answer makes the panels show the next step. What is right is read from what they then show.

use kirk::{Event, TreeChoice};
use tpn::DecisionId;

use crate::lesson::{Answer, Forecast, StepKind, course_lesson};
use crate::state::AppState;
use crate::state::automaton::AutomatonCommand;
use crate::state::lesson::{Prediction, Predictions, learned_key};
use crate::state::search::wording::choice;
use crate::state::search::{Recording, SearchCommand};

impl AppState {
    /// Returns what the stop has the student predict.
    pub fn forecast(&self) -> Option<&Forecast> {
        match &self.lesson.stop()?.ask.as_ref()?.answer {
            Answer::Prediction(forecast) => Some(forecast),
            _ => None,
        }
    }

    /// Returns what can be predicted now; empty if nothing can.
    pub fn forecasts(&self) -> Vec<String> {
        let Some(forecast) = self.forecast().filter(|_| self.can_predict()) else { return Vec::new() };
        match forecast {
            Forecast::Decision | Forecast::Failure => {
                let Some(recording) = self.searched() else { return Vec::new() };
                let mut all = choices_of(&recording, *forecast == Forecast::Failure);
                all.extend(forecast.nothing().map(str::to_owned));
                all
            }
            Forecast::Estimate(name) => {
                let model = self.automaton.program().and_then(|program| program.model());
                let component = model.and_then(|model| model.component(model.component_named(name)?));
                component
                    .map(|it| it.modes.iter().map(|mode| mode.name.to_string()).collect())
                    .unwrap_or_default()
            }
        }
    }

    fn can_predict(&self) -> bool {
        let predictions = &self.lesson.predictions;
        let is_open = !self.lesson.is_due && !predictions.is_over && predictions.pending.is_none();
        let is_computed = !self.automaton.is_control() || self.automaton.progress().is_none();
        is_open
            && is_computed
            && predictions.revision == self.document.revision()
            && predictions.seen != usize::MAX
    }

    /// The search that the panels show.
    fn searched(&self) -> Option<Recording> {
        self.search.recordings(self.shown()).into_iter().nth(self.search.side())
    }

    /// Takes a prediction, and lets the panels show what it is about.
    pub(super) fn predict(&mut self, given: String) {
        let Some(forecast) = self.forecast().cloned() else { return };
        if !self.forecasts().contains(&given) {
            self.window.info("Choose one of the listed predictions, or click Reset view to start again");
            return;
        }
        let seen = self.lesson.predictions.seen;
        match forecast {
            Forecast::Decision => self.predict_step(given, StepKind::Decision),
            Forecast::Failure => self.predict_step(given, StepKind::Failure),
            Forecast::Estimate(_) => {
                self.lesson.predictions.pending = Some(given);
                self.automaton.apply(AutomatonCommand::GoTo(seen + 1));
            }
        }
    }

    fn predict_step(&mut self, given: String, kind: StepKind) {
        let Some(recording) = self.searched() else { return };
        let events = &recording.trace().events;
        let unseen = events.iter().enumerate().skip(self.lesson.predictions.seen);
        let next = unseen.into_iter().find(|(_, entry)| kind.is(&entry.event)).map(|(step, _)| step);
        self.apply_to_search(SearchCommand::GoTo(next.unwrap_or(recording.steps().saturating_sub(1))));
        let nothing = self.forecast().and_then(Forecast::nothing).unwrap_or_default();
        let shown = match next {
            Some(_) => self.choice_shown().unwrap_or_default(),
            None => nothing.to_owned(),
        };
        self.lesson.predictions.is_over = next.is_none();
        self.note_prediction(given, shown);
    }

    /// The choice of the step that the panels show: the alternative that it takes, or that of the state that fails.
    fn choice_shown(&self) -> Option<String> {
        let view = self.search.shown()?;
        let trace = view.recording.trace();
        let entry = trace.events.get(view.step.step)?;
        let made = match entry.event {
            Event::Decide { decision, alternative } => Some(TreeChoice::Decision { decision, alternative }),
            _ => trace.tree.get(entry.tree_node as usize)?.choice,
        };
        Some(choice(view.recording.network(), made))
    }

    fn note_prediction(&mut self, given: String, shown: String) {
        let prediction = Prediction { given, shown };
        let counts = self.settings.predictions;
        self.settings.predictions = [counts[0] + 1, counts[1] + u32::from(prediction.is_right())];
        self.lesson.predictions.made.push(prediction);
        let Some(lesson) = self.lesson.open.as_ref().filter(|_| self.lesson.predictions.is_over) else {
            return;
        };
        if course_lesson(&lesson.name).is_some() {
            self.settings.learned.insert(learned_key(&lesson.name, self.lesson.stop));
        }
    }

    /// Notes how much the panels have shown, and judges a prediction whose step has come.
    pub(super) fn follow_predictions(&mut self) {
        let Some(forecast) = self.forecast().cloned() else { return };
        let revision = self.document.revision();
        if self.lesson.predictions.revision != revision {
            self.lesson.predictions = Predictions { revision, ..Predictions::default() };
        }
        let shown = match &forecast {
            // Without a step, panels show what came of the whole search.
            Forecast::Decision | Forecast::Failure => {
                self.search.step().map_or(usize::MAX, |step| step.step + 1)
            }
            Forecast::Estimate(_) => self.automaton.at(),
        };
        let before = self.lesson.predictions.seen;
        if shown > before {
            self.lesson.predictions.seen = shown;
        }
        let Forecast::Estimate(name) = forecast else { return };
        let is_stuck = self.automaton.progress().is_none() && !self.automaton.can_step();
        if self.lesson.predictions.pending.is_some()
            && shown > before
            && let Some(mode) = self.estimated_mode(&name)
            && let Some(given) = self.lesson.predictions.pending.take()
        {
            self.lesson.predictions.is_over = is_stuck;
            self.note_prediction(given, mode);
        } else if is_stuck && !self.lesson.predictions.is_over {
            (self.lesson.predictions.is_over, self.lesson.predictions.pending) = (true, None);
        }
    }

    /// The mode of a component in the most likely state, as the panels show it.
    fn estimated_mode(&self, name: &str) -> Option<String> {
        let model = self.automaton.program()?.model()?;
        let component = model.component_named(name)?;
        let belief = &self.automaton.moment()?.plant.as_ref()?.belief;
        Some(model.mode_name(component, belief.most_likely().mode(component)).to_owned())
    }
}

/// The alternatives of all decisions, by name, and if wanted all other choices of the search.
fn choices_of(recording: &Recording, with_others: bool) -> Vec<String> {
    let network = recording.network();
    let mut all = Vec::new();
    for (index, decision) in network.decisions.iter().enumerate() {
        let decision_id = DecisionId::from_index(index);
        let alternatives = (0..decision.alternatives.len() as u32)
            .map(|alternative| TreeChoice::Decision { decision: decision_id, alternative });
        all.extend(alternatives.map(|it| choice(network, Some(it))));
    }
    if with_others {
        for state in &recording.trace().tree {
            let name = choice(network, state.choice);
            if !all.contains(&name) {
                all.push(name);
            }
        }
    }
    all
}
