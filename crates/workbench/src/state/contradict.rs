//! Counterexamples of the lines of a review that have passed: schedules and runs that the core tries, a few at a time.

use std::sync::Arc;

use executive::Script;
use link::{Request, Response, Update};
use review::Review;
use review::contradict::{Effort, Tried, Verdict};
use review::record::LineKey;

use crate::state::window::Window;

/// What was tried so far.
#[derive(Debug, Default)]
pub struct ContradictState {
    running: Option<Running>,
    /// What was found of each reviewed plan, the latest first: an edit and its undo find it again.
    found: Vec<(Reviewed, Vec<Tried>)>,
}

/// What can be asked.
#[derive(Clone, Debug, PartialEq)]
pub enum ContradictCommand {
    /// Looks for counterexamples of one line that has passed, or of all.
    Start(Option<LineKey>),
    /// Stops looking; what was found is kept.
    Stop,
    /// Executes the counterexample of a line.
    Replay(LineKey),
}

/// The content and the plan of a review, by their hashes.
type Reviewed = (String, String);

#[derive(Debug)]
struct Running {
    revision: u64,
    review: Arc<Review>,
    only: Option<LineKey>,
    progress: [u64; 2],
    since_secs: f64,
}

/// Seconds after which no more is tried.
const BUDGET_SECS: f64 = 60.0;
/// Reviews of which results are kept.
const MAX_REVIEWS: usize = 6;

fn reviewed(review: &Review) -> Reviewed {
    (review.content_hash.clone(), review.plan_hash.clone())
}

impl ContradictState {
    /// Returns how many schedules and runs have been tried, and how many are to be; `None` while nothing is tried.
    pub fn progress(&self) -> Option<[u64; 2]> {
        self.running.as_ref().map(|running| running.progress)
    }

    /// The one line that is being tried, if it is one.
    pub fn only(&self) -> Option<&LineKey> {
        self.running.as_ref()?.only.as_ref()
    }

    /// Returns how a line of a review was tried.
    pub fn of_line(&self, review: &Review, line: &LineKey) -> Option<&Tried> {
        self.of_review(review).find(|tried| tried.line == *line)
    }

    /// All lines of a review that were tried.
    pub fn of_review(&self, review: &Review) -> impl Iterator<Item = &Tried> {
        let known = self.found.iter().find(|(of, _)| {
            (of.0.as_str(), of.1.as_str()) == (review.content_hash.as_str(), review.plan_hash.as_str())
        });
        known.into_iter().flat_map(|(_, tried)| tried)
    }

    /// The run that shows the counterexample of a line.
    pub(crate) fn script(&self, review: &Review, line: &LineKey) -> Option<Script> {
        Some(self.of_line(review, line)?.counterexample.as_ref()?.script.clone())
    }

    /// What was asked for does not come.
    pub(crate) fn give_up(&mut self) {
        self.running = None;
    }

    /// Begins to try the lines of a review.
    pub(crate) fn start(
        &mut self,
        update: Update,
        review: Arc<Review>,
        only: Option<LineKey>,
        now_secs: f64,
        window: &mut Window,
    ) {
        let Effort { schedules, runs, .. } = Effort::default();
        let progress = [0, schedules + runs];
        let revision = update.revision;
        self.running = Some(Running { revision, review, only, progress, since_secs: now_secs });
        self.try_on(Some(update), window);
    }

    /// Asks for the next schedules and runs, unless the mission has changed.
    fn try_on(&mut self, update: Option<Update>, window: &mut Window) {
        let Some(running) = &self.running else { return };
        let Some(update) = update.filter(|update| update.revision == running.revision) else {
            self.running = None;
            return;
        };
        window.post(Request::Contradict {
            update,
            review: Arc::clone(&running.review),
            only: running.only.clone(),
            effort: Effort::default(),
            from: running.progress[0],
        });
    }

    /// Takes what was tried, and asks for more.
    pub(crate) fn take(
        &mut self,
        answer: Response,
        update: Option<Update>,
        now_secs: f64,
        window: &mut Window,
    ) {
        let Response::Contradicted { revision, only, progress, tried } = answer else { return };
        let is_wanted = |running: &&mut Running| running.revision == revision && running.only == only;
        let Some(running) = self.running.as_mut().filter(is_wanted) else { return };
        running.progress = progress;
        let is_late = now_secs - running.since_secs > BUDGET_SECS;
        let review = Arc::clone(&running.review);
        match tried {
            Ok(tried) => self.keep(reviewed(&review), tried),
            Err(reason) => {
                self.running = None;
                window.failed(format!("Couldn\u{2019}t look for counterexamples: {reason}"));
                return;
            }
        }
        if progress[0] < progress[1] && !is_late {
            self.try_on(update, window);
            return;
        }
        self.running = None;
        window.done(self.summary(&review));
    }

    /// Returns what was found of a review, in one sentence.
    fn summary(&self, review: &Review) -> String {
        let count = |wanted: Verdict| self.of_review(review).filter(|it| it.verdict() == wanted).count();
        let [survived, contradicted] = [Verdict::Survived, Verdict::Contradicted].map(count);
        let lines = |count: usize| if count == 1 { "1 item".to_owned() } else { format!("{count} items") };
        format!("{} contradicted, {} survived", lines(contradicted), lines(survived))
    }

    /// Lines that were tried again replace what was found of them before.
    fn keep(&mut self, of: Reviewed, tried: Vec<Tried>) {
        let known = self.found.iter().position(|(known, _)| *known == of);
        let mut all = known.map(|at| self.found.remove(at).1).unwrap_or_default();
        all.retain(|known| tried.iter().all(|it| it.line != known.line));
        all.extend(tried);
        self.found.insert(0, (of, all));
        self.found.truncate(MAX_REVIEWS);
    }
}

#[cfg(test)]
mod tests {
    use review::contradict::Counterexample;
    use review::{Section, Status};
    use snapshot::Goal;

    use super::*;

    const MISSION: &str = "primitive Walk()[5,9]; scenario S[0,30] = { Walk(); delay }";

    /// A state that tries all lines of a mission; its review, and a line that has passed.
    fn started(only: bool) -> (ContradictState, Arc<Review>, LineKey, Window) {
        let snapshot = test_core::snapshot(MISSION);
        let review = Arc::new(review::review(&snapshot, &Goal::Default, 0, &mut || false));
        let line = review.plan.iter().find(|line| line.status == Status::Passed).expect("there is a plan");
        let line = LineKey::new(Section::Plan, line);
        let (mut state, mut window) = (ContradictState::default(), Window::default());
        let update = Update::new(1, MISSION);
        state.start(update, Arc::clone(&review), only.then(|| line.clone()), 0.0, &mut window);
        (state, review, line, window)
    }

    fn answer(only: Option<&LineKey>, done: u64, tried: Vec<Tried>) -> Response {
        Response::Contradicted { revision: 1, only: only.cloned(), progress: [done, 220], tried: Ok(tried) }
    }

    #[test]
    fn more_is_asked_for_until_all_is_tried_or_the_time_is_up() {
        let (mut state, review, line, mut window) = started(false);
        assert_eq!(state.progress(), Some([0, 220]));
        let tried = Tried { line: line.clone(), schedules: 9, runs: 0, plans: 0, counterexample: None };
        let update = || Some(Update::new(1, MISSION));
        state.take(answer(None, 9, vec![tried.clone()]), update(), 1.0, &mut window);
        assert_eq!(state.progress(), Some([9, 220]));
        assert_eq!(
            state.of_line(&review, &line).map(Tried::sentence).as_deref(),
            Some("survived 9 schedules")
        );
        state.take(answer(None, 20, vec![tried]), update(), BUDGET_SECS + 1.0, &mut window);
        assert_eq!(state.progress(), None, "the budget is spent");
        // An answer to something else changes nothing.
        state.take(answer(Some(&line), 30, Vec::new()), update(), 2.0, &mut window);
        assert!(state.of_line(&review, &line).is_some());
    }

    #[test]
    fn a_line_that_is_tried_alone_replaces_what_was_found_of_it() {
        let (mut state, review, line, mut window) = started(true);
        let script = Script { run_seed: Some(3), ..Script::default() };
        let counterexample = Some(Counterexample { text: "it is late".to_owned(), script: script.clone() });
        let tried = Tried { line: line.clone(), schedules: 1, runs: 1, plans: 0, counterexample };
        state.take(answer(Some(&line), 220, vec![tried]), None, 1.0, &mut window);
        assert_eq!(state.progress(), None);
        assert_eq!(state.script(&review, &line), Some(script));
        let told = state.of_line(&review, &line).map(Tried::sentence);
        assert_eq!(told.as_deref(), Some("contradicted by a run: it is late"));
        // Another text has a review of its own.
        let other = Review { content_hash: "other".to_owned(), ..Review::clone(&review) };
        assert_eq!(state.of_line(&other, &line), None);
    }
}
