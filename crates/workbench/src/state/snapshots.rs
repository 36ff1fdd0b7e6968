//! The answers of the planning core: the latest, and the one to draw.

use std::sync::Arc;

use rmpl::Severity;
use snapshot::Problem;
use snapshot::{Snapshot, Stage};

use crate::state::imports::offer_files;
use crate::state::no_plan;

/// Snapshots as they arrived.
#[derive(Clone, Debug, Default)]
pub struct Snapshots {
    latest: Option<Arc<Snapshot>>,
    shown: Option<Arc<Snapshot>>,
    /// What is wrong with the text of `latest`, that it has no plan included.
    problems: Vec<Problem>,
    /// When `latest` arrived, in seconds on the host's clock.
    latest_secs: f64,
    /// The revision that is not worked out any more, as long as nothing else is.
    given_up: Option<u64>,
}

/// The state of planning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The present text is being worked out.
    Working,
    /// The text has errors; what is drawn belongs to an older text.
    Broken,
    /// There is no network to plan, though nothing is wrong: an empty text, or one that only lacks a scenario.
    Empty,
    /// A control program, which is not planned but run.
    Program,
    Plan,
    /// There is none.
    NoPlan,
    /// Working the present text out was stopped, or the core died over it: nothing is known of its plan.
    Undecided,
}

/// Planning that takes longer than this shows the network without a plan meanwhile.
const PATIENCE_SECS: f64 = 0.25;

impl Snapshots {
    /// Takes an answer; older ones than the latest are dropped.
    pub fn take(&mut self, snapshot: Arc<Snapshot>, now_secs: f64) {
        let is_older = self
            .latest
            .as_ref()
            .is_some_and(|latest| (snapshot.revision, snapshot.stage) < (latest.revision, latest.stage));
        if is_older {
            return;
        }
        let is_drawable = snapshot.network.is_some() && snapshot.stage >= Stage::Improving;
        let is_first = self.shown.is_none() && snapshot.network.is_some();
        if is_drawable || is_first || lacks_a_scenario(&snapshot) {
            self.shown = Some(Arc::clone(&snapshot));
        }
        if self.latest.as_ref().is_none_or(|latest| latest.revision != snapshot.revision) {
            self.latest_secs = now_secs;
        }
        self.problems = snapshot.problems.iter().cloned().chain(no_plan::problems(&snapshot)).collect();
        if lacks_a_scenario(&snapshot) {
            // A mission that is being written has nothing wrong with it.
            let missing = self.problems.iter_mut().filter(|problem| problem.code == NO_SCENARIO);
            missing.for_each(|problem| problem.severity = Severity::Note);
        }
        offer_files(&mut self.problems, &snapshot.source, &snapshot.program.imports);
        self.problems.sort_by_key(|problem| problem.span.start);
        self.latest = Some(snapshot);
    }

    /// Returns what is wrong with the text of the latest answer, that it has no plan included; in textual order.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// Returns whether a compiled network waits for its plan, while an older one is shown.
    pub fn is_waiting(&self) -> bool {
        self.latest.as_ref().zip(self.shown.as_ref()).is_some_and(|(latest, shown)| {
            latest.stage == Stage::Compiled && latest.network.is_some() && shown.revision < latest.revision
        })
    }

    /// Shows a compiled network that waits for its plan, if that takes long.
    pub fn lose_patience(&mut self, now_secs: f64) {
        if self.is_waiting() && now_secs - self.latest_secs > PATIENCE_SECS {
            self.shown.clone_from(&self.latest);
        }
    }

    /// The text of `revision` is not worked out any more.
    pub fn give_up(&mut self, revision: u64) {
        self.given_up = Some(revision);
    }

    /// Returns whether a better plan than the one that is shown is looked for.
    pub fn is_improving(&self, revision: u64) -> bool {
        let latest = self.latest.as_ref().filter(|latest| latest.revision == revision);
        latest.is_some_and(|latest| latest.stage == Stage::Improving) && self.given_up != Some(revision)
    }

    /// Forgets everything: another mission was opened.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// The latest answer, for the editor.
    pub fn latest(&self) -> Option<&Arc<Snapshot>> {
        self.latest.as_ref()
    }

    /// The answer that drawings show: the latest with a network and its plan. A text with errors keeps the last good
    /// one on screen; one that only lacks a scenario is a mission that is being written, and shows its places and
    /// vehicles.
    pub fn shown(&self) -> Option<&Arc<Snapshot>> {
        self.shown.as_ref()
    }

    /// Returns whether what is shown belongs to an older text than `revision`.
    pub fn is_stale(&self, revision: u64) -> bool {
        self.shown.as_ref().is_some_and(|shown| shown.revision != revision)
    }

    /// Returns where the plan represents the text of `revision`.
    pub fn status(&self, revision: u64) -> Status {
        let unfinished = if self.given_up == Some(revision) { Status::Undecided } else { Status::Working };
        let Some(latest) = &self.latest else { return unfinished };
        if latest.revision != revision {
            return unfinished;
        }
        let has_errors = latest.problems.iter().any(|problem| problem.severity == Severity::Error);
        match (&latest.network, &latest.planning) {
            (None, _) if latest.source.trim().is_empty() || lacks_a_scenario(latest) => Status::Empty,
            _ if has_errors => Status::Broken,
            (_, None) if latest.stage == Stage::Compiled => unfinished,
            (None, _) => Status::Empty,
            (Some(_), Some(_)) if latest.plan().is_some() => Status::Plan,
            (Some(_), _) => Status::NoPlan,
        }
    }
}

impl Snapshots {
    /// Returns whether nothing is wrong with the last text that was read but that it says nothing to plan yet.
    pub fn lacks_a_scenario(&self) -> bool {
        self.latest.as_deref().is_some_and(lacks_a_scenario)
    }
}

/// Returns whether nothing is wrong with a text but that it says nothing to plan yet.
fn lacks_a_scenario(snapshot: &Snapshot) -> bool {
    let mut errors =
        snapshot.problems.iter().filter(|problem| problem.severity == Severity::Error).peekable();
    snapshot.network.is_none() && errors.peek().is_some() && errors.all(|it| it.code == NO_SCENARIO)
}

/// The code of that problem.
const NO_SCENARIO: &str = "E-NOSCENARIO";
