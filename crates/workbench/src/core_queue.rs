//! What waits for the planning core, wherever it runs: one request at a time, the newest text first to matter.
//!
//! Used by every [`Host`](crate::host::Host). It starts nothing itself; the host sends what [`CoreQueue::next`] gives
//! and tells how it went.

use std::collections::VecDeque;

use mission::Request;

/// Requests that wait, the one under way, and what a core that is started anew has to be told again.
#[derive(Debug, Default)]
pub struct CoreQueue {
    waiting: VecDeque<Request>,
    under_way: Option<Request>,
    /// Imported maps that the running core knows.
    imported: Vec<Request>,
}

impl CoreQueue {
    /// Adds a request. A text that was not yet sent gives way to a newer one, a map to a newer one of its name.
    pub fn post(&mut self, request: Request) {
        self.waiting.retain(|earlier| !replaces(&request, earlier));
        self.waiting.push_back(request);
    }

    /// The request to send now, if the core is free; it counts as under way from here on.
    pub fn start_next(&mut self) -> Option<&Request> {
        if self.under_way.is_some() {
            return None;
        }
        self.under_way = self.waiting.pop_front();
        self.under_way.as_ref()
    }

    /// The core has answered the request under way in full.
    pub fn finished(&mut self) {
        if let Some(request @ Request::ImportMap { .. }) = self.under_way.take() {
            self.imported.retain(|earlier| !replaces(&request, earlier));
            self.imported.push(request);
        }
    }

    /// Whether the core works on a text that a newer one waits to replace.
    pub fn is_superseded(&self) -> bool {
        self.under_way
            .as_ref()
            .is_some_and(|request| self.waiting.iter().any(|newer| replaces(newer, request)))
    }

    /// Whether the core has been given something that it has not answered in full.
    pub fn is_busy(&self) -> bool {
        self.under_way.is_some()
    }

    /// The core was started anew and knows nothing: what it knew will be sent again first. The request that was under
    /// way is given up and returned.
    pub fn restarted(&mut self) -> Option<Request> {
        let given_up = self.under_way.take();
        for known in self.imported.drain(..).rev() {
            if !self.waiting.iter().any(|newer| replaces(newer, &known)) {
                self.waiting.push_front(known);
            }
        }
        given_up
    }
}

/// The revision of the text that a request is about.
pub fn revision(request: &Request) -> Option<u64> {
    match request {
        Request::Update(update)
        | Request::Review(update)
        | Request::Execute { update, .. }
        | Request::Sample { update, .. } => Some(update.revision),
        Request::CompareSearches { revision } | Request::SampleProgram { revision, .. } => Some(*revision),
        Request::ImportMap { .. } | Request::WorkOut { .. } => None,
    }
}

/// Whether answering `newer` makes answering `earlier` pointless.
fn replaces(newer: &Request, earlier: &Request) -> bool {
    match (newer, earlier) {
        // A newer text ends what was asked of the older one; a text to compare with stands for itself.
        (
            Request::Update(_),
            Request::Update(_)
            | Request::Review(_)
            | Request::Execute { .. }
            | Request::Sample { .. }
            | Request::SampleProgram { .. }
            | Request::CompareSearches { .. },
        )
        | (Request::CompareSearches { .. }, Request::CompareSearches { .. })
        | (Request::Review(_), Request::Review(_))
        | (Request::WorkOut { .. }, Request::WorkOut { .. })
        | (Request::Execute { .. }, Request::Execute { .. })
        | (Request::Sample { .. }, Request::Sample { .. })
        | (Request::SampleProgram { .. }, Request::SampleProgram { .. }) => true,
        (Request::ImportMap { name: newer, .. }, Request::ImportMap { name: earlier, .. }) => {
            newer == earlier
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use mission::{Goal, SearchKind, Update};

    use super::*;

    fn update(revision: u64) -> Request {
        Request::Update(Update {
            revision,
            source: "".into(),
            goal: Goal::default(),
            search: SearchKind::default(),
            seed: 0,
            trace: false,
        })
    }

    fn map(name: &str, bytes: &[u8]) -> Request {
        Request::ImportMap { name: name.into(), bytes: bytes.to_vec() }
    }

    #[test]
    fn only_the_newest_text_is_sent() {
        let mut queue = CoreQueue::default();
        for revision in 1..=3 {
            queue.post(update(revision));
        }
        assert_eq!(queue.start_next(), Some(&update(3)));
        queue.finished();
        assert_eq!(queue.start_next(), None);
    }

    #[test]
    fn a_comparison_gives_way_to_a_newer_text_and_waits_for_an_earlier_one() {
        let mut queue = CoreQueue::default();
        queue.post(update(1));
        queue.post(Request::CompareSearches { revision: 1 });
        assert_eq!(queue.start_next(), Some(&update(1)));
        assert!(!queue.is_superseded());
        queue.finished();
        assert_eq!(queue.start_next(), Some(&Request::CompareSearches { revision: 1 }));
        queue.post(update(2));
        assert!(queue.is_superseded());
    }

    #[test]
    fn one_request_is_under_way_at_a_time_and_knows_when_it_is_superseded() {
        let mut queue = CoreQueue::default();
        queue.post(update(1));
        assert!(queue.start_next().is_some());
        assert!(!queue.is_superseded());
        queue.post(update(2));
        assert!(queue.is_superseded());
        assert_eq!(queue.start_next(), None);
        queue.finished();
        assert_eq!(queue.start_next(), Some(&update(2)));
        assert!(!queue.is_superseded());
    }

    #[test]
    fn a_map_is_sent_before_the_text_that_was_posted_after_it() {
        let mut queue = CoreQueue::default();
        queue.post(update(1));
        queue.post(map("m", b"1"));
        queue.post(update(2));
        assert_eq!(queue.start_next(), Some(&map("m", b"1")));
        queue.finished();
        assert_eq!(queue.start_next(), Some(&update(2)));
    }

    #[test]
    fn a_newer_text_ends_a_review_but_not_the_other_way_round() {
        let review = |revision| match update(revision) {
            Request::Update(update) => Request::Review(update),
            other => other,
        };
        let mut queue = CoreQueue::default();
        queue.post(update(1));
        queue.post(review(1));
        assert_eq!(queue.start_next(), Some(&update(1)));
        assert!(!queue.is_superseded());
        queue.finished();
        assert_eq!(queue.start_next(), Some(&review(1)));
        queue.post(update(2));
        assert!(queue.is_superseded());
    }

    #[test]
    fn a_restarted_core_is_told_its_maps_again_but_not_what_stopped_it() {
        let mut queue = CoreQueue::default();
        queue.post(map("a", b"1"));
        assert!(queue.start_next().is_some());
        queue.finished();
        queue.post(map("b", b"2"));
        assert!(queue.start_next().is_some());
        queue.finished();
        queue.post(update(7));
        assert!(queue.start_next().is_some());
        queue.post(map("a", b"3"));
        assert_eq!(queue.restarted(), Some(update(7)));
        assert_eq!(queue.start_next(), Some(&map("b", b"2")));
        queue.finished();
        assert_eq!(queue.start_next(), Some(&map("a", b"3")));
        queue.finished();
        assert_eq!(queue.start_next(), None);
    }
}
