//! How robust the plan is: many runs with chance, made by the core a few at a time.

use std::sync::Arc;

use link::{Request, Response};
use review::content_hash;
use snapshot::{Robustness, RobustnessSettings, Tally, Uncertainty};

use super::{AppState, ToastKind};

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
/// More runs than this are for the command line, which shares them out.
pub const MAX_RUNS: u64 = 100_000;

impl Default for ChanceState {
    fn default() -> Self {
        let settings = RobustnessSettings { runs: USUAL_RUNS, seed: 1, uncertainty: Uncertainty::default() };
        Self { settings, running: None, tally: Tally::default(), of_content: Vec::new() }
    }
}

impl ChanceState {
    /// Whether runs are being made.
    pub const fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// The runs asked for are not made any more; what was found is kept.
    pub(super) fn give_up(&mut self) {
        self.running = None;
    }

    /// What the runs of this content came to: see [`review::content_hash`].
    pub fn of_content(&self, content_hash: &str) -> Option<Arc<Robustness>> {
        self.of_content.iter().find(|(of, _)| of == content_hash).map(|(_, found)| Arc::clone(found))
    }

    /// Takes what is known from elsewhere, unless more runs were made here.
    pub(super) fn learn(&mut self, content_hash: &str, found: Robustness) {
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

    /// How many runs have been made of those asked for last.
    pub const fn runs_made(&self) -> u64 {
        self.tally.runs
    }
}

impl AppState {
    /// How the present mission fares in many runs with chance, if runs were made of it.
    pub fn robustness(&self) -> Option<&Arc<Robustness>> {
        let content = self.review.hash()?;
        self.chance.of_content.iter().find(|(of, _)| of == content).map(|(_, found)| found)
    }

    pub(super) fn apply_to_chance(&mut self, command: ChanceCommand) {
        match command {
            ChanceCommand::Start => {
                self.chance.tally = Tally::default();
                self.chance.running = self.update_shown().zip(self.shown()).map(|(update, shown)| {
                    let map = shown.map.as_ref();
                    let content = content_hash(&update.source, map, &update.goal, update.seed);
                    (update.revision, content)
                });
                self.sample_on();
            }
            ChanceCommand::Stop => {
                let stopped = self.chance.running.take();
                self.judge_reviews();
                if let Some((_, content)) = stopped {
                    self.keep_runs(&content);
                }
            }
            ChanceCommand::Set(settings) => {
                self.chance.settings = *settings;
                self.chance.settings.runs = self.chance.settings.runs.clamp(1, MAX_RUNS);
                self.chance.running = None;
            }
        }
    }

    /// Asks for the next runs, unless all are made or the text has changed.
    fn sample_on(&mut self) {
        let wanted = self.chance.running.as_ref().map(|running| running.0);
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
        let Some((running, content)) = self.chance.running.clone() else { return };
        let is_wanted =
            running == revision && *settings == self.chance.settings && from == self.chance.tally.runs;
        if !is_wanted {
            return;
        }
        self.chance.tally.merge(&tally);
        let robustness = Robustness { settings: *settings, tally: self.chance.tally.clone() };
        self.chance.keep(content.clone(), robustness);
        self.sample_on();
        if !self.chance.is_running() {
            self.judge_reviews();
            self.keep_runs(&content);
        }
        if !self.chance.is_running() && self.chance.tally.runs >= self.chance.settings.runs {
            let text = format!("{} runs made", self.chance.tally.runs);
            self.toasts.add(ToastKind::Done, text);
        }
    }
}
