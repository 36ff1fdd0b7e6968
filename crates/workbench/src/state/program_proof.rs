//! What holds in all runs of a control program: what is asked, and what the core has found.

use std::sync::Arc;

use executive::model_based::proof::{Counterexample, Move, Verdict};
use executive::model_based::{Knowledge, StepInput};
use link::{ProofAnswer, ProofQuestion, Request, Response};
use text_editing::Document;

use super::automaton::{AutomatonState, Program, ProgramPart};
use super::window::Window;
use crate::mission_file;

/// What is asked for, and what was found.
#[derive(Debug, Default)]
pub struct ProgramProofState {
    /// What is asked for.
    pub settings: ProofSettings,
    /// What was asked last, of which revision of the text.
    asked: Option<(u64, ProofQuestion)>,
    is_running: bool,
    /// Whether the core is to be asked once it has the text.
    is_wanted: bool,
    states: usize,
    answer: Option<Result<ProofAnswer, String>>,
}

/// What is asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProofSettings {
    /// Properties, with semicolons between them; if empty, the checks that every program should pass.
    pub properties: String,
    /// How often components fail at most in a run.
    pub faults: u32,
    pub knowledge: Knowledge,
}

/// What can be asked about proofs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ProgramProofCommand {
    /// Begins a proof of what is asked for.
    Start,
    /// Ends it before all is explored; nothing is known then.
    Stop,
    /// Changes what is asked for.
    Set(ProofSettings),
    /// Shows the run that breaks the property with this number.
    StepThrough(usize),
}

/// The page allows at most this many faults; the command line allows more.
pub const MAX_FAULTS: u32 = 5;
/// The page explores at most this many states.
const MAX_STATES: usize = 100_000;

impl Default for ProofSettings {
    fn default() -> Self {
        Self { properties: String::new(), faults: 1, knowledge: Knowledge::Estimated }
    }
}

impl ProgramProofState {
    /// Returns whether a proof is under way.
    pub const fn is_running(&self) -> bool {
        self.is_running
    }

    /// Returns how many states have been found.
    pub const fn states(&self) -> usize {
        self.states
    }

    /// Returns what was asked of a revision of the text, and what was found; nothing if nothing was.
    pub fn answer(&self, revision: u64) -> Option<(&ProofQuestion, &Result<ProofAnswer, String>)> {
        let (_, question) = self.asked.as_ref().filter(|(asked, _)| *asked == revision)?;
        Some((question, self.answer.as_ref()?))
    }

    /// The core was started again: no more answers come.
    pub(crate) const fn give_up(&mut self) {
        self.is_running = false;
        self.is_wanted = false;
    }

    /// The text has this revision now: a question about another revision is dropped.
    pub(super) fn follow(&mut self, revision: u64) {
        if self.asked.as_ref().is_some_and(|(asked, _)| *asked != revision) {
            self.give_up();
        }
    }

    /// Returns whether the core is to be asked.
    pub(crate) const fn is_wanted(&self) -> bool {
        self.is_wanted
    }
}

impl AutomatonState {
    /// Does what a command about proofs asks for.
    pub(crate) fn apply_to_proof(&mut self, command: ProgramProofCommand, document: &Document) {
        match command {
            ProgramProofCommand::Start => {
                if !matches!(self.program(), Some(Program::Bound { .. })) {
                    return;
                }
                let settings = &self.proof.settings;
                let properties = settings.properties.split(';').map(str::trim);
                let question = ProofQuestion {
                    plant: Some(Arc::from(mission_file::PLANT)),
                    properties: properties.filter(|text| !text.is_empty()).map(str::to_owned).collect(),
                    faults: settings.faults,
                    knowledge: settings.knowledge,
                    states: MAX_STATES,
                };
                self.proof.asked = Some((document.revision(), question));
                self.proof.is_running = true;
                self.proof.is_wanted = true;
                self.proof.states = 0;
                self.proof.answer = None;
                self.part = ProgramPart::Proof;
            }
            ProgramProofCommand::Stop => self.proof.give_up(),
            ProgramProofCommand::Set(mut settings) => {
                settings.faults = settings.faults.min(MAX_FAULTS);
                self.proof.settings = settings;
            }
            ProgramProofCommand::StepThrough(number) => {
                let answer = self.proof.answer.as_ref().and_then(|answer| answer.as_ref().ok());
                let verdict = answer.and_then(|answer| answer.verdicts.get(number));
                if let Some((_, Verdict::Broken(run))) = verdict {
                    let input = |by: &Move| StepInput {
                        injected: by.modes.iter().copied().collect(),
                        observed: by.observed.iter().copied().collect(),
                    };
                    let inputs = run.moves.iter().map(input).collect();
                    self.show_steps(inputs);
                }
            }
        }
    }

    /// Asks to explore further, unless the text has changed.
    pub(crate) fn prove_on(&mut self, document: &Document, window: &mut Window) {
        let revision = document.revision();
        let proof = &mut self.proof;
        proof.is_wanted = false;
        let asked = proof.asked.clone().filter(|(asked, _)| *asked == revision && proof.is_running);
        match asked {
            Some((_, question)) => {
                let source = document.shared_text().into();
                let from = proof.states;
                window.post(Request::ProveProgram { revision, source, question, from });
            }
            None => proof.is_running = false,
        }
    }

    /// Takes what was found.
    pub(crate) fn take_proof(&mut self, answer: Response, document: &Document, window: &mut Window) {
        let Response::ProgramProven { revision, question, states, answer } = answer else { return };
        let proof = &mut self.proof;
        let is_asked = proof.asked.as_ref().is_some_and(|(asked, it)| *asked == revision && *it == question);
        if !proof.is_running || !is_asked {
            return;
        }
        proof.states = states;
        if answer.is_some() {
            proof.answer = answer;
            proof.is_running = false;
        } else {
            self.prove_on(document, window);
        }
    }
}

/// Returns whether the page can step through a run: its programs estimate, and make their likeliest choices from the
/// likeliest start.
pub fn can_step_through(question: &ProofQuestion, run: &Counterexample) -> bool {
    question.knowledge == Knowledge::Estimated
        && run.start == Move::default()
        && run.moves.iter().all(|by| by.choices.is_empty())
}
