//! How robust the plan is: many runs with chance, made by the core a few at a time.

pub use review::record::MAX_RUNS;
use std::sync::Arc;

use exact::grouped;
use link::{Request, Response, Update};
use snapshot::{Robustness, RobustnessSettings, Tally, Uncertainty};

use crate::state::window::Window;

/// What is left to chance, and the runs made so far.
#[derive(Debug)]
pub struct ChanceState {
    /// What is asked for.
    pub settings: RobustnessSettings,
    /// The revision that is being sampled, and its content.
    running: Option<(u64, String)>,
    tally: Tally,
    /// What the runs of each content came to, those that were made last first: an edit and its undo find them again.
    of_content: Vec<(String, Arc<Robustness>)>,
}

/// Contents of which runs are kept.
const MAX_CONTENTS: usize = 8;

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

impl Default for ChanceState {
    fn default() -> Self {
        let settings = RobustnessSettings { runs: USUAL_RUNS, seed: 1, uncertainty: Uncertainty::default() };
        Self { settings, running: None, tally: Tally::default(), of_content: Vec::new() }
    }
}

impl ChanceState {
    /// Returns whether runs are being made.
    pub const fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// The runs asked for are not made any more; what was found is kept.
    pub(crate) fn give_up(&mut self) {
        self.running = None;
    }

    /// Returns what the runs of this content came to: see [`review::content_hash`].
    pub fn of_content(&self, content_hash: &str) -> Option<&Arc<Robustness>> {
        self.of_content.iter().find(|(of, _)| of == content_hash).map(|(_, found)| found)
    }

    /// Takes what is known from elsewhere, unless more runs were made here.
    pub(crate) fn learn(&mut self, content_hash: &str, found: Robustness) {
        let known = self.of_content(content_hash).map_or(0, |known| known.tally.runs);
        if found.tally.runs > known {
            self.keep(content_hash.to_owned(), found);
        }
    }

    fn keep(&mut self, content: String, robustness: Robustness) {
        self.of_content.retain(|(of, _)| *of != content);
        self.of_content.insert(0, (content, Arc::new(robustness)));
        self.of_content.truncate(MAX_CONTENTS);
    }

    /// Returns how many runs have been made of those asked for last.
    pub const fn runs_made(&self) -> u64 {
        self.tally.runs
    }
}

impl ChanceState {
    /// Does what a command asks for; `planned` is the mission as it is planned, with its content hash. Returns the
    /// content whose runs have ended, if some have.
    pub(crate) fn apply(
        &mut self,
        command: ChanceCommand,
        planned: Option<(Update, String)>,
        window: &mut Window,
    ) -> Option<String> {
        match command {
            ChanceCommand::Start => {
                self.tally = Tally::default();
                let (update, content) = planned.unzip();
                self.running = update.as_ref().map(|update| update.revision).zip(content);
                self.sample_on(update, window);
                None
            }
            ChanceCommand::Stop => self.running.take().map(|(_, content)| content),
            ChanceCommand::Set(settings) => {
                self.settings = *settings;
                self.settings.runs = self.settings.runs.clamp(1, MAX_RUNS);
                self.running = None;
                None
            }
        }
    }

    /// Asks for the next runs of what is planned, unless all are made or the mission has changed.
    fn sample_on(&mut self, update: Option<Update>, window: &mut Window) {
        let wanted = self.running.as_ref().map(|running| running.0);
        let from = self.tally.runs;
        match update.filter(|update| Some(update.revision) == wanted) {
            Some(update) if from < self.settings.runs => {
                let settings = self.settings.clone();
                window.post(Request::Sample { update, settings, from });
            }
            _ => self.running = None,
        }
    }

    /// Takes runs that were made. Returns the content whose runs have ended, if they have.
    pub(crate) fn take(
        &mut self,
        answer: Response,
        update: Option<Update>,
        window: &mut Window,
    ) -> Option<String> {
        let Response::Sampled { revision, settings, from, tally } = answer else { return None };
        let (running, content) = self.running.clone()?;
        let is_wanted = running == revision && *settings == self.settings && from == self.tally.runs;
        if !is_wanted {
            return None;
        }
        self.tally.merge(&tally);
        let robustness = Robustness { settings: *settings, tally: self.tally.clone() };
        self.keep(content.clone(), robustness);
        self.sample_on(update, window);
        if self.is_running() {
            return None;
        }
        if self.tally.runs >= self.settings.runs {
            window.done(format!("{} runs completed", grouped(self.tally.runs)));
        }
        Some(content)
    }
}
