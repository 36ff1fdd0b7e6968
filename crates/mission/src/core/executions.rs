//! The runs of the plan that is kept. A disturbance that is taken back, or an edit that leaves the mission as it is, asks
//! for a run that was made before.

use std::sync::Arc;

use executive::Script;
use rmpl::Shift;
use snapshot::Execution;

/// Runs that are kept: those before are rarely gone back to.
const MAX_RUNS: usize = 8;

/// The runs of a plan, the one asked for last at the end.
#[derive(Default)]
pub(super) struct Executions {
    runs: Vec<Arc<Execution>>,
}

impl Executions {
    /// The run under `script`, as one of the text of `revision`, if it is kept.
    pub(super) fn find(&mut self, script: &Script, revision: u64) -> Option<Arc<Execution>> {
        let at = self.runs.iter().position(|run| run.script == *script)?;
        let mut run = self.runs.remove(at);
        if run.revision != revision {
            Arc::make_mut(&mut run).revision = revision;
        }
        self.runs.push(Arc::clone(&run));
        Some(run)
    }

    /// Keeps a run that was not kept before.
    pub(super) fn keep(&mut self, run: Arc<Execution>) {
        if self.runs.len() == MAX_RUNS {
            self.runs.remove(0);
        }
        self.runs.push(run);
    }

    /// Moves all places through an edit that left the program as it is.
    pub(super) fn follow(&mut self, shift: Shift) {
        for run in &mut self.runs {
            Arc::make_mut(run).follow(shift);
        }
    }
}
