//! Where a core runs: its clock, whether it should continue, and where its answers go.

use std::sync::Arc;

use link::Response;
use snapshot::Snapshot;

/// What the core needs from where it runs.
pub trait CoreHost {
    /// Milliseconds since an arbitrary moment.
    fn now_millis(&self) -> f64;

    /// Returns whether the request under way should be given up, because a newer one has come.
    fn is_superseded(&mut self) -> bool;

    /// Takes an answer.
    fn answer(&mut self, response: Response);

    /// Returns whether plans are wanted before the best one is known.
    fn wants_first_plans(&self) -> bool {
        true
    }
}

/// Answers with a compiled network once its plan takes long: to send it twice would hold up the plan.
pub(crate) struct Unhurried<'a> {
    pub(crate) host: &'a mut dyn CoreHost,
    pub(crate) waiting: Option<Arc<Snapshot>>,
    pub(crate) due_millis: f64,
}

impl CoreHost for Unhurried<'_> {
    fn now_millis(&self) -> f64 {
        self.host.now_millis()
    }

    fn is_superseded(&mut self) -> bool {
        let is_due = self.host.now_millis() >= self.due_millis;
        if is_due && let Some(snapshot) = self.waiting.take() {
            self.answer(Response::Snapshot(snapshot));
        }
        self.host.is_superseded()
    }

    fn wants_first_plans(&self) -> bool {
        self.host.wants_first_plans()
    }

    fn answer(&mut self, response: Response) {
        self.waiting = None;
        self.host.answer(response);
    }
}

/// Keeps the last snapshot instead of answering with it.
pub(crate) struct LastSnapshot<'a> {
    pub(crate) host: &'a mut dyn CoreHost,
    pub(crate) passes_maps: bool,
    pub(crate) last: Option<Arc<Snapshot>>,
}

impl CoreHost for LastSnapshot<'_> {
    fn now_millis(&self) -> f64 {
        self.host.now_millis()
    }

    fn is_superseded(&mut self) -> bool {
        self.host.is_superseded()
    }

    fn wants_first_plans(&self) -> bool {
        false
    }

    fn answer(&mut self, response: Response) {
        match response {
            Response::Snapshot(snapshot) => self.last = Some(snapshot),
            Response::Map { .. } if !self.passes_maps => {}
            other => self.host.answer(other),
        }
    }
}
