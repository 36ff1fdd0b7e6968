//! What the open mission is compared with: a pinned revision, the last approved text, another mission, a saved plan.

use std::sync::Arc;

use link::{Request, Update};
use review::Record;
use review::compare::Side;
use review::keys::Trust;
use review::record::{Subject, is_record};
use serde_json::Value;
use snapshot::{Goal, Snapshot};

use crate::effect::Effect;
use crate::state::window::Window;

/// Something that concerns the comparison.
#[derive(Clone, Debug, PartialEq)]
pub enum CompareCommand {
    /// Keeps the present plan, to compare later ones with.
    Pin,
    /// Compares with the text that was approved last.
    WithApproved,
    /// Lets the user choose a mission, a plan or a review to compare with.
    OpenFile,
    /// Stops comparing.
    Clear,
}

/// What the open mission is compared with.
#[derive(Clone, Debug, Default)]
pub struct CompareState {
    reference: Option<Arc<Side>>,
    /// The text of the plan to compare with; a plan in a file has none.
    text: Option<Arc<str>>,
    /// The name of a text that is being worked out, under its token.
    waiting: Option<(u64, String)>,
    last_token: u64,
}

impl CompareState {
    /// The plan to compare with.
    pub fn reference(&self) -> Option<&Arc<Side>> {
        self.reference.as_ref()
    }

    /// The text of the plan to compare with, if it is known.
    pub fn text(&self) -> Option<&Arc<str>> {
        self.text.as_ref()
    }

    /// The name of the text that is being worked out to compare with.
    pub fn waiting(&self) -> Option<&str> {
        self.waiting.as_ref().map(|(_, name)| name.as_str())
    }

    pub(crate) fn give_up(&mut self) {
        self.waiting = None;
    }
}

impl CompareState {
    /// Does what a command asks for; `shown` is the open mission, `record` what its board said.
    pub(crate) fn apply(
        &mut self,
        command: &CompareCommand,
        shown: Option<&Snapshot>,
        record: &Record,
        window: &mut Window,
    ) {
        match command {
            CompareCommand::Pin => {
                let Some(shown) = shown.filter(|shown| shown.plan().is_some()) else { return };
                let name = format!("baseline (revision {})", shown.revision);
                let (side, text) = (Side::of_snapshot(&name, shown), Arc::clone(&shown.source));
                self.reference = Some(Arc::new(side));
                self.text = Some(text);
                self.waiting = None;
            }
            CompareCommand::WithApproved => match record.last_approval() {
                Some((entry, approved)) => {
                    let name = format!("approved by {} on {}", entry.by, day_of(&entry.time));
                    let Subject { source, goal, seed, .. } = approved.clone();
                    self.evaluate(name, &source, goal, seed, window);
                }
                None => window.info("This mission has no approval yet"),
            },
            CompareCommand::OpenFile => {
                window.ask(Effect::OpenFile(crate::host::FileKind::Comparison));
            }
            CompareCommand::Clear => {
                self.reference = None;
                self.text = None;
                self.waiting = None;
            }
        }
    }

    /// Compares with a file that the user chose.
    ///
    /// What was approved in a review is so by the keys in `trust`, at the time `now`.
    pub(crate) fn open_file(
        &mut self,
        name: &str,
        text: &str,
        seed: u64,
        (trust, now): (&Trust, &str),
        window: &mut Window,
    ) {
        let is_json = name.rsplit_once('.').is_some_and(|(_, ending)| ending.eq_ignore_ascii_case("json"));
        if !is_json {
            self.evaluate(name.to_owned(), text, Goal::Default, seed, window);
            return;
        }
        let failed = |reason: String| format!("Couldn't compare with {name}: {reason}");
        let document: Value = match serde_json::from_str(text) {
            Ok(document) => document,
            Err(reason) => return window.failed(failed(reason.to_string())),
        };
        if is_record(&document) {
            let approved = Record::from_json(text).map(|mut record| {
                record.judge(trust, now);
                record.last_approval().map(|(_, approved)| approved.clone())
            });
            match approved {
                Ok(Some(Subject { source, goal, seed, .. })) => {
                    self.evaluate(name.to_owned(), &source, goal, seed, window);
                }
                Ok(None) => window.failed(failed("no trusted key has approved it".to_owned())),
                Err(reason) => window.failed(failed(reason.to_string())),
            }
            return;
        }
        self.show_plan(name, &document, window);
    }

    /// Compares with a plan, or the first plan of a document.
    pub(crate) fn show_plan(&mut self, name: &str, document: &Value, window: &mut Window) {
        match Side::of_json(name, document) {
            Ok(side) => {
                self.reference = Some(Arc::new(side));
                self.text = None;
                self.waiting = None;
            }
            Err(reason) => window.failed(format!("Couldn't compare with {name}: {reason}")),
        }
    }

    fn evaluate(&mut self, name: String, source: &str, goal: Goal, seed: u64, window: &mut Window) {
        self.last_token += 1;
        let token = self.last_token;
        self.waiting = Some((token, name));
        let update = Update { goal, seed, ..Update::new(0, source) };
        window.post(Request::Evaluate { token, update });
    }

    /// Takes a text that was planned to compare with.
    pub(crate) fn take(&mut self, token: u64, snapshot: &Snapshot) {
        if let Some((_, name)) = self.waiting.take_if(|(waiting, _)| *waiting == token) {
            self.reference = Some(Arc::new(Side::of_snapshot(&name, snapshot)));
            self.text = Some(Arc::clone(&snapshot.source));
        }
    }
}

/// The day of an ISO 8601 time.
fn day_of(time: &str) -> &str {
    time.split('T').next().unwrap_or(time)
}
