//! A host of the planning core for tests: its clock stands still, it interrupts nothing, and it keeps all answers.

use std::sync::Arc;

use link::{Request, Response, Update};
use mission::{Core, CoreHost};
use snapshot::Snapshot;

/// All answers, in order.
#[derive(Default)]
pub struct Answers(pub Vec<Response>);

impl CoreHost for Answers {
    fn now_millis(&self) -> f64 {
        0.0
    }

    fn is_superseded(&mut self) -> bool {
        false
    }

    fn answer(&mut self, response: Response) {
        self.0.push(response);
    }
}

impl Answers {
    /// The last answer of a kind.
    ///
    /// # Panics
    ///
    /// If there is none.
    pub fn last<'a, T>(&'a self, kind: impl Fn(&'a Response) -> Option<T>) -> T {
        self.0.iter().rev().find_map(kind).expect("it is answered")
    }

    /// The last snapshot.
    ///
    /// # Panics
    ///
    /// If there is none.
    pub fn snapshot(&self) -> Arc<Snapshot> {
        self.last(|answer| match answer {
            Response::Snapshot(snapshot) => Some(Arc::clone(snapshot)),
            _ => None,
        })
    }
}

/// Returns what a core that starts from nothing answers about a text.
pub fn answers(source: &str) -> Answers {
    let mut answers = Answers::default();
    Core::default().handle(Request::Update(Update::new(1, source)), &mut answers);
    answers
}

/// A text, planned.
pub fn snapshot(source: &str) -> Arc<Snapshot> {
    answers(source).snapshot()
}
