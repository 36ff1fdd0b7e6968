//! How robust the plan is: many runs with chance, made by the core a few at a time.

use std::sync::Arc;

use mission::{Request, Response, Robustness, RobustnessSettings, Tally, Uncertainty};

use super::{AppState, ToastKind};

/// What is left to chance, and the runs made so far.
#[derive(Debug)]
pub struct ChanceState {
    /// What is asked for.
    pub settings: RobustnessSettings,
    /// The revision that is being sampled.
    running: Option<u64>,
    tally: Tally,
    /// What the runs made so far came to, and of which revision.
    robustness: Option<(u64, Arc<Robustness>)>,
}

/// What can be asked about chance.
#[derive(Clone, Debug, PartialEq)]
pub enum ChanceCommand {
    /// Makes the runs, from the first on.
    Start,
    /// Stops making them; what was found is kept.
    Stop,
    /// Changes what is asked for.
    Set(Box<RobustnessSettings>),
}

/// The runs that are made unless the user wants more or fewer.
const USUAL_RUNS: u64 = 1000;
/// More runs than this are for the command line, which shares them out.
pub const MAX_RUNS: u64 = 100_000;

impl Default for ChanceState {
    fn default() -> Self {
        let settings = RobustnessSettings { runs: USUAL_RUNS, seed: 1, uncertainty: Uncertainty::default() };
        Self { settings, running: None, tally: Tally::default(), robustness: None }
    }
}

impl ChanceState {
    /// Whether runs are being made.
    pub const fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// The runs asked for are not made any more; what was found is kept.
    pub(super) const fn give_up(&mut self) {
        self.running = None;
    }

    /// How many runs have been made of those asked for last.
    pub const fn runs_made(&self) -> u64 {
        self.tally.runs
    }
}

impl AppState {
    /// How the plan that is shown fares in many runs with chance, if runs were made of it.
    pub fn robustness(&self) -> Option<&Arc<Robustness>> {
        let (revision, robustness) = self.chance.robustness.as_ref()?;
        self.shown().filter(|shown| shown.revision == *revision).map(|_| robustness)
    }

    pub(super) fn apply_to_chance(&mut self, command: ChanceCommand) {
        match command {
            ChanceCommand::Start => {
                self.chance.tally = Tally::default();
                self.chance.running = self.update_shown().map(|update| update.revision);
                self.sample_on();
            }
            ChanceCommand::Stop => self.chance.running = None,
            ChanceCommand::Set(settings) => {
                self.chance.settings = *settings;
                self.chance.settings.runs = self.chance.settings.runs.clamp(1, MAX_RUNS);
                self.chance.running = None;
            }
        }
    }

    /// Asks for the next runs, unless all are made or the text has changed.
    fn sample_on(&mut self) {
        let wanted = self.chance.running;
        let update = self.update_shown().filter(|update| Some(update.revision) == wanted);
        let from = self.chance.tally.runs;
        match update {
            Some(update) if from < self.chance.settings.runs => {
                let settings = self.chance.settings.clone();
                self.effects.push(super::Effect::Post(Request::Sample { update, settings, from }));
            }
            _ => self.chance.running = None,
        }
    }

    pub(super) fn take_sample(&mut self, answer: Response) {
        let Response::Sampled { revision, settings, from, tally } = answer else { return };
        let is_wanted = self.chance.running == Some(revision)
            && *settings == self.chance.settings
            && from == self.chance.tally.runs;
        if !is_wanted {
            return;
        }
        self.chance.tally.merge(&tally);
        let robustness = Robustness { settings: *settings, tally: self.chance.tally.clone() };
        self.chance.robustness = Some((revision, Arc::new(robustness)));
        self.sample_on();
        if !self.chance.is_running() && self.chance.tally.runs >= self.chance.settings.runs {
            let text = format!("{} runs made", self.chance.tally.runs);
            self.toasts.add(ToastKind::Done, text);
        }
    }
}
