//! The lines of a review under trial: one more schedule of the plan, or one more run of it.

use executive::PlanError;
use review::contradict::{Effort, Trial};
use review::record::LineKey;

use crate::core::Core;
use crate::evaluated::Evaluated;

/// A trial, and what it belongs to: the revision of the text, the one line that is tried, and how much is tried.
pub(crate) struct Trying {
    pub(crate) of: (u64, Option<LineKey>, Effort),
    pub(crate) trial: Trial,
}

impl Core {
    /// Holds one more schedule or run of the plan against the lines that stand; returns whether there was one to try.
    pub fn try_next(&mut self, evaluated: &Evaluated, trial: &mut Trial) -> Result<bool, PlanError> {
        if trial.try_schedule() {
            return Ok(true);
        }
        let Some(script) = trial.next_run() else { return Ok(false) };
        let Some(ran) = self.run(evaluated, &script) else { return Ok(false) };
        let outcome = ran?.outcome;
        trial.try_run(&script, &outcome.log, outcome.ending);
        Ok(true)
    }
}
