//! The review of the open mission: what was computed, what reviewers said and signed, and whether it still holds.
//!
//! A review belongs to one text, map, goal and seed, named by their hash. An edit makes it stale; undoing the edit makes
//! it current again, because the hash is the same again.

use std::collections::BTreeMap;
use std::sync::Arc;

use mission::review::record::{Comment, Ruled, SignOff};
use mission::review::{FlightRules, Record, Review, Status, content_hash};
use mission::{Request, Robustness, SearchKind, Stage, Update};
use smol_str::SmolStr;

use crate::state::{AppState, Effect, PlanSettings, ToastKind};

/// Something that concerns the review of the open mission.
#[derive(Clone, Debug, PartialEq)]
pub enum ReviewCommand {
    /// Reviews the present text.
    Run,
    /// Signs what the review is about.
    Sign {
        /// Who signs.
        name: String,
    },
    /// Takes the latest sign-off of the present content back.
    Withdraw,
    /// Adds a comment.
    Comment {
        /// Who writes.
        author: String,
        /// What it is about, by name; the whole mission if nothing is named.
        about: Option<String>,
        /// The words.
        text: String,
    },
    /// Takes a comment away.
    RemoveComment(usize),
    /// Holds the mission against these flight rules from now on.
    SetRules(Box<FlightRules>),
    /// Lets the user save the flight rules as a file.
    SaveRules,
    /// Lets the user save comments and sign-offs as a file.
    SaveRecord,
    /// Lets the user choose such a file; what it has is added.
    OpenRecord,
}

/// What is known of the review.
#[derive(Clone, Debug, Default)]
pub struct ReviewState {
    /// The latest reviews, the newest first.
    done: Vec<Done>,
    /// The revision that is being reviewed, and the search that plans it.
    running: Option<(u64, SearchKind)>,
    /// The content that was last asked to be reviewed, so that nothing is asked twice of its own accord.
    asked: Option<String>,
    /// What reviewers said and signed.
    record: Record,
    /// Why `record` is not kept beyond this run, if it could not be.
    unkept: Option<String>,
    /// The key of the mission that `record` is about.
    of: SmolStr,
    /// Records of other missions that could not be kept, by their keys.
    set_aside: BTreeMap<SmolStr, Record>,
    /// What the present content is called.
    current: Option<Current>,
    /// Whether the report is to be written as soon as there is a review for it.
    pub(super) wants_report: bool,
}

/// A review with how it came about.
#[derive(Clone, Debug)]
struct Done {
    search: SearchKind,
    review: Arc<Review>,
    /// The runs with chance that `review` was held against.
    robustness: Option<Arc<Robustness>>,
}

/// The hash of the present content, and what it was computed from.
#[derive(Clone, Debug, PartialEq)]
struct Current {
    revision: u64,
    answered: Option<(u64, Stage)>,
    settings: PlanSettings,
    hash: String,
}

/// Reviews that are kept, so that undoing finds them again.
const MAX_DONE: usize = 6;

/// How the sign-off of a mission stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Signed<'a> {
    /// Nobody has signed.
    Never,
    /// Signed as it is now.
    Current(&'a SignOff),
    /// Signed as it was before.
    Stale(&'a SignOff),
}

impl ReviewState {
    /// The review to show, and whether it is stale: that of the present content if there is one, otherwise the latest.
    pub fn shown(&self, search: SearchKind) -> Option<(&Arc<Review>, bool)> {
        let hash = self.hash();
        let current =
            self.done.iter().find(|it| Some(it.review.content_hash.as_str()) == hash && it.search == search);
        match current {
            Some(done) => Some((&done.review, false)),
            None => self.done.first().map(|done| (&done.review, true)),
        }
    }

    /// The hash of the present content, once it is known.
    pub fn hash(&self) -> Option<&str> {
        self.current.as_ref().map(|current| current.hash.as_str())
    }

    /// Whether a review is being made.
    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Whether the present content has never been asked to be reviewed.
    pub fn is_unasked(&self) -> bool {
        self.hash().is_some() && self.asked.is_none()
    }

    /// What reviewers said and signed.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Why it is not kept beyond this run, if it could not be.
    pub fn unkept(&self) -> Option<&str> {
        self.unkept.as_deref()
    }

    /// How the sign-off stands.
    pub fn signed(&self) -> Signed<'_> {
        let rules = self.record.rules();
        let current = self.hash().and_then(|hash| self.record.sign_off_of(hash, &rules));
        match (current, self.record.sign_offs.last()) {
            (Some(sign_off), _) => Signed::Current(sign_off),
            (None, Some(last)) => Signed::Stale(last),
            (None, None) => Signed::Never,
        }
    }

    /// Under which key the record of a mission is kept.
    pub(crate) fn key(mission: &str) -> String {
        format!("enroute/review-1/{mission}")
    }

    /// The host has kept the record, or says why not.
    pub(crate) fn kept(&mut self, outcome: Result<(), String>) {
        self.unkept = outcome.err();
    }

    /// Adds what is kept of the record elsewhere, such as in another tab.
    pub(crate) fn join(&mut self, kept: Record) {
        self.record.merge(kept);
    }

    /// Another mission is open now: forgets the reviews, and sets aside what could not be kept.
    fn leave(&mut self) {
        let record = std::mem::take(&mut self.record);
        let mut set_aside = std::mem::take(&mut self.set_aside);
        if self.unkept.is_some() {
            set_aside.insert(self.of.clone(), record);
        }
        *self = Self { set_aside, ..Self::default() };
    }
}

impl AppState {
    pub(super) fn apply_to_review(&mut self, command: ReviewCommand) {
        match command {
            ReviewCommand::Run => self.run_review(),
            ReviewCommand::Sign { name } => self.sign(name.trim()),
            ReviewCommand::Withdraw => {
                if let Signed::Current(sign_off) = self.review.signed() {
                    let taken_back = sign_off.clone();
                    self.review.record.sign_offs.retain(|it| *it != taken_back);
                    self.effects.push(Effect::KeepReview { joins: false });
                }
            }
            ReviewCommand::Comment { author, about, text } => self.comment(author.trim(), about, text.trim()),
            ReviewCommand::RemoveComment(index) => {
                if index < self.review.record.comments.len() {
                    self.review.record.comments.remove(index);
                    self.effects.push(Effect::KeepReview { joins: false });
                }
            }
            ReviewCommand::SetRules(rules) => self.set_rules(*rules),
            ReviewCommand::SaveRules => self.effects.push(Effect::SaveFile {
                name: format!("{}.rules.json", self.mission),
                bytes: self.review.record.rules().to_json().into_bytes(),
            }),
            ReviewCommand::SaveRecord => self.effects.push(Effect::SaveFile {
                name: format!("{}.review.json", self.mission),
                bytes: self.review.record.to_json().into_bytes(),
            }),
            ReviewCommand::OpenRecord => self.effects.push(Effect::OpenFile(crate::host::FileKind::Json)),
        }
    }

    /// Asks the core for a review of the present text.
    pub(super) fn run_review(&mut self) {
        let revision = self.document.revision();
        let PlanSettings { goal, search, seed, trace } = self.settings.plan.clone();
        self.review.running = Some((revision, search));
        self.review.asked = self.review.hash().map(str::to_owned);
        let source = self.document.shared_text();
        let update = Update { revision, source, goal, search, seed, trace };
        self.effects.push(Effect::Post(Request::Review(update)));
    }

    /// Takes a review that was asked for.
    pub(super) fn take_review(&mut self, revision: u64, review: Arc<Review>) {
        // What nobody waits for any more may be of another mission.
        let Some((_, search)) = self.review.running.take_if(|running| running.0 == revision) else { return };
        self.review.done.retain(|it| it.review.content_hash != review.content_hash || it.search != search);
        self.review.done.insert(0, Done { search, review, robustness: None });
        self.review.done.truncate(MAX_DONE);
        self.judge_reviews();
        if std::mem::take(&mut self.review.wants_report) && self.current_review().is_some() {
            self.write_report();
        }
    }

    /// Holds every review against the present rules, and against the runs that were made of its content.
    pub(crate) fn judge_reviews(&mut self) {
        let rules = self.review.record.rules();
        for done in &mut self.review.done {
            let robustness = self.chance.of_content(&done.review.content_hash);
            let is_same = match (&robustness, &done.robustness) {
                (Some(new), Some(old)) => Arc::ptr_eq(new, old),
                (None, None) => true,
                _ => false,
            };
            if !is_same || done.review.rules != rules {
                Arc::make_mut(&mut done.review).judge(&rules, robustness.as_deref());
                done.robustness = robustness;
            }
        }
    }

    fn set_rules(&mut self, rules: FlightRules) {
        if let Some(problem) = rules.problem() {
            self.toasts.add(ToastKind::Failed, format!("These flight rules cannot be used: {problem}"));
            return;
        }
        let (by, time) = (self.settings.reviewer.clone(), self.utc_now());
        self.review.record.ruled = Some(Ruled { by, time, rules });
        self.keep_review();
        self.judge_reviews();
    }

    /// Takes flight rules from a file.
    pub(super) fn import_rules(&mut self, name: &str, text: &str) {
        match FlightRules::from_json(text) {
            Ok(rules) => {
                self.set_rules(rules);
                self.toasts.add(ToastKind::Done, format!("{name}: these are the flight rules now"));
            }
            Err(reason) => self.toasts.add(ToastKind::Failed, format!("{name}: {reason}")),
        }
    }

    /// The core stopped: what was asked of it does not come.
    pub(super) fn give_up_review(&mut self) {
        self.review.running = None;
        self.review.wants_report = false;
    }

    /// The review of the present content, if it has been made.
    pub fn current_review(&self) -> Option<&Arc<Review>> {
        self.review.shown(self.settings.plan.search).filter(|(_, is_stale)| !is_stale).map(|(it, _)| it)
    }

    fn sign(&mut self, name: &str) {
        let Some(review) = self.current_review().filter(|review| may_sign(review).is_ok()) else { return };
        if name.is_empty() {
            self.toasts.add(ToastKind::Failed, "A sign-off needs a name");
            return;
        }
        let sign_off = SignOff {
            name: name.to_owned(),
            time: self.utc_now(),
            content_hash: review.content_hash.clone(),
            counts: review.counts(),
            source: self.document.text().to_owned(),
            goal: self.settings.plan.goal.clone(),
            seed: self.settings.plan.seed,
            rules: review.rules.clone(),
        };
        name.clone_into(&mut self.settings.reviewer);
        self.toasts.add(ToastKind::Done, format!("Signed off by {name}"));
        self.review.record.sign_offs.push(sign_off);
        self.keep_review();
    }

    fn comment(&mut self, author: &str, about: Option<String>, text: &str) {
        if text.is_empty() {
            return;
        }
        if author.is_empty() {
            self.toasts.add(ToastKind::Failed, "A comment needs the name of its author");
            return;
        }
        let comment = Comment {
            author: author.to_owned(),
            time: self.utc_now(),
            about,
            text: text.to_owned(),
            content_hash: self.review.hash().unwrap_or_default().to_owned(),
        };
        author.clone_into(&mut self.settings.reviewer);
        self.review.record.comments.push(comment);
        self.keep_review();
    }

    /// Adds what a file has.
    pub(super) fn import_record(&mut self, name: &str, text: &str) {
        match Record::from_json(text) {
            Ok(record) => {
                let count = self.review.record.merge(record);
                self.judge_reviews();
                let entries = if count == 1 { "entry" } else { "entries" };
                self.toasts.add(ToastKind::Done, format!("{name}: {count} new {entries}"));
                self.keep_review();
            }
            Err(reason) => self.toasts.add(ToastKind::Failed, format!("{name}: {reason}")),
        }
    }

    fn keep_review(&mut self) {
        self.review.record.mission = self.mission.to_string();
        self.effects.push(Effect::KeepReview { joins: true });
    }

    /// The host found this kept under the open mission's name.
    pub(crate) fn recall_review(&mut self, kept: Option<&str>) {
        self.review.of = self.mission_key();
        let set_aside = self.review.set_aside.remove(&self.review.of);
        let kept = kept.map(Record::from_json);
        if let Some(Err(reason)) = &kept {
            // It stays where it is until something new is kept.
            self.toasts.add(ToastKind::Failed, format!("The kept review cannot be read: {reason}"));
        }
        let mut record = kept.and_then(Result::ok).unwrap_or_default();
        record.mission = self.mission.to_string();
        if let Some(set_aside) = set_aside {
            record.merge(set_aside);
            self.effects.push(Effect::KeepReview { joins: true });
        }
        self.review.record = record;
        self.judge_reviews();
    }

    /// The open original has become a mission of its own: what was said of it is said of the mission too.
    pub(super) fn review_goes_along(&mut self) {
        self.review.of = self.mission_key();
        if !self.review.record.is_empty() {
            self.keep_review();
        }
    }

    /// Adds what came with a mission.
    pub(crate) fn join_review(&mut self, record: Record) {
        self.review.record.merge(record);
        self.judge_reviews();
        self.keep_review();
    }

    /// Another mission is open now.
    pub(super) fn leave_review(&mut self) {
        self.review.leave();
        self.effects.push(Effect::RecallReview);
    }

    /// Follows what the present content is. Nothing is hashed twice.
    pub(super) fn follow_review(&mut self) {
        let revision = self.document.revision();
        if self.review.running.is_some_and(|running| running.0 != revision) {
            // A newer text ends the review of the older one. Whoever waits for the first one gets that of the new text.
            self.give_up_review();
            if self.review.done.is_empty() {
                self.review.asked = None;
            }
        }
        let Some(latest) = self.snapshots.latest() else {
            self.review.current = None;
            return;
        };
        let answered = Some((latest.revision, latest.stage));
        let is_known = self.review.current.as_ref().is_some_and(|it| {
            (it.revision, it.answered) == (revision, answered) && it.settings == self.settings.plan
        });
        if is_known {
            return;
        }
        let settings = self.settings.plan.clone();
        let hash = content_hash(self.document.text(), latest.map.as_ref(), &settings.goal, settings.seed);
        self.review.current = Some(Current { revision, answered, settings, hash });
    }

    /// Now, as an ISO 8601 time in UTC.
    fn utc_now(&self) -> String {
        report::calendar::utc_text(self.frame.unix_millis)
    }
}

/// Whether a review can be signed; `Err` says why not.
pub fn may_sign(review: &Review) -> Result<(), &'static str> {
    match review.status {
        _ if !review.is_planned() => Err("there is no plan to sign"),
        Status::Failed => Err("lines of the review have failed"),
        Status::Information | Status::Passed | Status::Attention => Ok(()),
    }
}
