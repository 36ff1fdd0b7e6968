//! Proofs about a control program, continued a little with each request.

use std::sync::Arc;

use executive::model_based::proof::{DEFAULTS, Proof, Property, Proving, Scope};
use link::{ProofAnswer, ProofQuestion};

use crate::control::Control;

/// An unfinished proof, with its question.
pub(crate) struct ProofUnderWay {
    source: Arc<str>,
    question: ProofQuestion,
    proving: Proving,
}

impl ProofUnderWay {
    /// Starts a proof about a text that was read. The error tells why no proof is possible.
    pub(crate) fn new(
        source: &Arc<str>,
        control: &Control,
        question: &ProofQuestion,
    ) -> Result<Self, String> {
        let system = control.system()?;
        let properties = if question.properties.is_empty() {
            DEFAULTS.to_vec()
        } else {
            question.properties.iter().map(|text| Property::read(text, system)).collect::<Result<_, _>>()?
        };
        let scope = Scope {
            faults: question.faults,
            knowledge: question.knowledge,
            states: question.states,
            ..Scope::default()
        };
        let proving = Proving::new(system, properties, scope);
        Ok(Self { source: Arc::clone(source), question: question.clone(), proving })
    }

    /// Returns whether this is the proof that answers `question`, after `from` states.
    pub(crate) fn is_of(&self, source: &Arc<str>, question: &ProofQuestion, from: usize) -> bool {
        self.source == *source && self.question == *question && self.proving.states() == from && from > 0
    }

    /// Explores until `go_on` returns false. Returns how many states have been found, with the answer if the exploration is
    /// over, and the proof to continue otherwise.
    pub(crate) fn lead_on(
        mut self,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<(usize, Result<ProofAnswer, Self>), String> {
        let is_over = self.proving.advance(&mut |_| go_on()).map_err(|error| error.to_string())?;
        let states = self.proving.states();
        if !is_over {
            return Ok((states, Err(self)));
        }
        let Proof { verdicts, states, transitions, depth, stopped } =
            self.proving.judge().map_err(|error| error.to_string())?;
        let verdicts = verdicts.into_iter().map(|(property, verdict)| (property.to_string(), verdict));
        let answer = ProofAnswer { verdicts: verdicts.collect(), states, transitions, depth, stopped };
        Ok((states, Ok(answer)))
    }
}
