//! How likely a control program is to reach its end: many runs whose components fail by chance, made by the core.

use std::collections::BTreeMap;
use std::sync::Arc;

use exact::grouped;
use executive::model_based::ProgramTally;
use link::{ProgramChance, Request, Response};
use text_editing::Document;

use super::automaton::{AutomatonState, FaultSeed, Program, ProgramPart};
use super::window::Window;
use crate::mission_file;

/// What is asked for, and the runs made so far.
#[derive(Debug, Default)]
pub struct ProgramChanceState {
    /// What is asked for.
    pub settings: ProgramChanceSettings,
    /// Which runs were asked for last, and of which revision of the text.
    asked: Option<(u64, ProgramChance)>,
    is_running: bool,
    tally: ProgramTally,
    /// Why there are no more runs.
    pub trouble: Option<String>,
}

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProgramChanceSettings {
    /// How many runs.
    pub runs: u64,
    pub seed: u64,
    /// A run that takes more steps has not reached its end.
    pub most_steps: u32,
    /// Whether the faults that were injected by hand happen in every run.
    pub keeps_injected: bool,
}

/// What can be asked about the chances of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgramChanceCommand {
    /// Makes the runs, from the first on.
    Start,
    /// Stops making them; what was found is kept.
    Stop,
    /// Changes what is asked for.
    Set(ProgramChanceSettings),
    /// Shows one of the runs step by step.
    StepThrough(u64),
}

/// More runs than this are for the command line.
pub const MAX_RUNS: u64 = 1_000_000;
/// No run is longer: a program that reaches its end does so in fewer steps.
pub const MAX_STEPS_OF_RUN: u32 = 400;

impl Default for ProgramChanceSettings {
    fn default() -> Self {
        Self { runs: 2000, seed: 1, most_steps: 50, keeps_injected: true }
    }
}

impl ProgramChanceState {
    /// Returns whether runs are being made.
    pub const fn is_running(&self) -> bool {
        self.is_running
    }

    /// Returns how the runs went that were made of a revision of the text; nothing if there were none.
    pub fn tally(&self, revision: u64) -> Option<&ProgramTally> {
        let is_of = self.asked.as_ref().is_some_and(|(asked, _)| *asked == revision);
        (is_of && self.tally.runs > 0).then_some(&self.tally)
    }

    /// Returns which runs were asked for last.
    pub fn asked(&self) -> Option<&ProgramChance> {
        self.asked.as_ref().map(|(_, chance)| chance)
    }

    /// The core was started again: no more answers come.
    pub(crate) const fn give_up(&mut self) {
        self.is_running = false;
    }
}

impl AutomatonState {
    /// Does what a command about the chances of the program asks for.
    pub(crate) fn apply_to_chance(
        &mut self,
        command: ProgramChanceCommand,
        document: &Document,
        window: &mut Window,
    ) {
        match command {
            ProgramChanceCommand::Start => {
                if !matches!(self.program(), Some(Program::Bound { .. })) {
                    return;
                }
                let asked = asked_of(self);
                let chance = &mut self.chance;
                chance.asked = Some((document.revision(), asked));
                chance.tally = ProgramTally::default();
                chance.trouble = None;
                chance.is_running = true;
                self.part = ProgramPart::ManyRuns;
                self.sample_on(document, window);
            }
            ProgramChanceCommand::Stop => self.chance.is_running = false,
            ProgramChanceCommand::Set(mut settings) => {
                settings.runs = settings.runs.clamp(1, MAX_RUNS);
                settings.most_steps = settings.most_steps.clamp(1, MAX_STEPS_OF_RUN);
                self.chance.settings = settings;
            }
            ProgramChanceCommand::StepThrough(number) => {
                let Some((_, chance)) = self.chance.asked.clone() else { return };
                let seed = FaultSeed { seed: chance.seed, run: Some(number) };
                self.show_run(seed, &chance.injected);
            }
        }
    }

    /// Asks for the next runs, unless all are made or the text has changed.
    fn sample_on(&mut self, document: &Document, window: &mut Window) {
        let revision = document.revision();
        let chance = &mut self.chance;
        let from = chance.tally.runs;
        let asked = chance.asked.clone().filter(|(asked, _)| *asked == revision && chance.is_running);
        match asked {
            Some((_, chance)) if from < chance.runs => {
                let source = document.shared_text().into();
                window.post(Request::SampleProgram { revision, source, chance, from });
            }
            _ => chance.is_running = false,
        }
    }

    /// Takes runs that were made.
    pub(crate) fn take_sample(&mut self, answer: Response, document: &Document, window: &mut Window) {
        let Response::ProgramSampled { revision, chance: answered, from, tally } = answer else { return };
        let chance = &mut self.chance;
        let is_wanted = chance.is_running
            && chance.asked.as_ref().is_some_and(|(asked, chance)| *asked == revision && *chance == answered)
            && from == chance.tally.runs;
        if !is_wanted {
            return;
        }
        match tally {
            Ok(tally) => chance.tally.merge(&tally),
            Err(trouble) => {
                chance.trouble = Some(trouble);
                chance.is_running = false;
                return;
            }
        }
        self.sample_on(document, window);
        let chance = &self.chance;
        if !chance.is_running && chance.tally.runs >= answered.runs {
            let text = format!("{} runs completed", grouped(chance.tally.runs));
            window.done(text);
        }
    }
}

fn asked_of(state: &AutomatonState) -> ProgramChance {
    let settings = state.chance.settings;
    ProgramChance {
        plant: Some(Arc::from(mission_file::PLANT)),
        runs: settings.runs,
        seed: settings.seed,
        most_steps: settings.most_steps,
        injected: if settings.keeps_injected { state.injected() } else { BTreeMap::new() },
    }
}
