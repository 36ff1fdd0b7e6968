//! The review of the open mission: what was computed, what its board has said and approved, and whether that still holds.
//!
//! A review belongs to one text, map, goal and seed, named by their hash. An edit makes it stale; undoing the edit makes
//! it current again, because the hash is the same again.

mod board;

use std::collections::BTreeMap;
use std::sync::Arc;

use kirk::Search as SearchKind;
use layout::timeline::before::Before;
use layout::timeline::rule::RuleTrack;
use link::Request;
use review::keys::KeyRing;
use review::record::Act;
use review::ruling::Proposal;
use review::{FlightRules, Record, Review, content_hash, plan_hash};
use smol_str::SmolStr;
use snapshot::{Robustness, Snapshot, Stage};
use text_editing::Document;

use crate::effect::{Aside, Effect};
use crate::host::FileKind;
use crate::state::AppState;
use crate::state::chance::{ChanceCommand, ChanceState};
use crate::state::documents::ScheduleForm;
use crate::state::keys::{KeyChange, KeysState};
use crate::state::part::Part;
use crate::state::settings::{PlanSettings, Settings};
use crate::state::snapshots::Snapshots;
use crate::state::window::Window;

/// Something that concerns the review of the open mission.
#[derive(Clone, Debug, PartialEq)]
pub enum ReviewCommand {
    /// Reviews the present text.
    Run,
    /// Approves what the review is about.
    Approve {
        by: Person,
        /// What goes with it; empty for an approval without comments.
        text: String,
    },
    /// Does something that needs no approval: comments, resolves, acknowledges, takes back.
    Say { by: Person, act: Act },
    /// Holds the mission against these flight rules from now on.
    SetRules(Box<FlightRules>),
    /// Lets the user save the flight rules as a file.
    SaveRules,
    /// Lets the user save the history as a file.
    SaveRecord,
    /// Lets the user choose such a file; what it has is added.
    OpenRecord,
    /// Lets the user save what was kept and cannot be used.
    SaveAside,
    /// Changes whose signatures count, or who signs here.
    ChangeKeys(KeyChange),
    /// Signs as the owner of another key of one's own from now on.
    SignAs(String),
    /// Lets the user save one's own key, with its secret, as a file.
    SaveOwnKey(String),
    /// Lets the user save the keys that are trusted, without secrets, as a file.
    SaveKeys,
}

/// Someone of the board.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Person {
    pub name: String,
    /// The role; empty for the only one of the board, or for none.
    pub role: String,
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
    /// What the board has said and approved.
    record: Record,
    /// What was found instead of a record, and is left where it is.
    aside: Option<Aside>,
    /// Why `record` is not kept beyond this run, if it could not be.
    unkept: Option<String>,
    /// The key of the mission that `record` is about.
    of: SmolStr,
    /// Records of other missions that could not be kept, by their keys.
    set_aside: BTreeMap<SmolStr, Record>,
    /// What the present content is called.
    current: Option<Current>,
    /// The hash of the plan that is drawn, with the answer that it is of; only while someone has to know it.
    plan: Option<(Arc<Snapshot>, String)>,
    /// The minute since 1970 at which the history was last checked.
    judged_minute: i64,
    /// Random bytes for the first entry of a history that is started here; `None` where the host has no source of such.
    random: Option<[u8; 32]>,
    /// What is to be written as soon as there is a review for it.
    pub(crate) waiting: Option<Waiting>,
}

/// A document whose status needs a review first.
#[derive(Clone, Debug)]
pub(crate) enum Waiting {
    Report,
    /// With the start of the mission.
    Schedule(ScheduleForm, String),
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

const MILLIS_PER_MINUTE: i64 = 60_000;

/// Reviews that are kept, so that undoing finds them again.
const MAX_DONE: usize = 6;

impl ReviewState {
    /// The review to show, and whether it is stale: that of the present content and the plan that is drawn if there is
    /// one, otherwise the latest.
    pub fn shown(&self) -> Option<(&Arc<Review>, bool)> {
        let current = self.done.iter().find(|it| {
            self.current.as_ref().is_some_and(|current| {
                (&it.review.content_hash, it.search) == (&current.hash, current.settings.planner())
            }) && self.plan_hash().is_none_or(|plan_hash| it.review.plan_hash == plan_hash)
        });
        match current {
            Some(done) => Some((&done.review, false)),
            None => self.done.first().map(|done| (&done.review, true)),
        }
    }

    /// The review of the present content, if it has been made.
    pub fn current(&self) -> Option<&Arc<Review>> {
        self.shown().filter(|(_, is_stale)| !is_stale).map(|(it, _)| it)
    }

    /// The rules of the mission over time, as far as the present content has been held against them.
    pub fn rule_tracks(&self) -> Vec<RuleTrack> {
        self.current().map(|review| report::rule_tracks(review)).unwrap_or_default()
    }

    /// When things could be in the plan that was last approved, if the present content is another.
    pub fn approved_times(&self) -> Option<Before> {
        let (entry, approved) = self.record.last_approval()?;
        let review = self.current()?;
        let is_other = entry.content_hash != review.content_hash || entry.plan_hash != review.plan_hash;
        if is_other { report::windows_before(approved) } else { None }
    }

    /// The hash of the present content, once it is known.
    pub fn hash(&self) -> Option<&str> {
        self.current.as_ref().map(|current| current.hash.as_str())
    }

    /// The hash of the plan that is drawn, where the present content has been reviewed or approved.
    fn plan_hash(&self) -> Option<&str> {
        self.plan.as_ref().map(|(_, hash)| hash.as_str())
    }

    /// Returns whether it matters which plan the present content has.
    fn asks_for_plan(&self) -> bool {
        let Some(hash) = self.hash() else { return false };
        let mut entries = self.record.entries().iter();
        self.done.iter().any(|done| done.review.content_hash == hash)
            || entries.any(|entry| matches!(entry.act, Act::Approve { .. }) && entry.content_hash == hash)
    }

    /// Returns whether a review is being made.
    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Returns whether the present content has never been asked to be reviewed.
    pub fn is_unasked(&self) -> bool {
        self.hash().is_some() && self.asked.is_none()
    }

    /// Returns what the board has said and approved.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Returns what was found instead of a record, and is left where it is.
    pub fn aside(&self) -> Option<&Aside> {
        self.aside.as_ref()
    }

    /// Returns why it is not kept beyond this run, if it could not be.
    pub fn unkept(&self) -> Option<&str> {
        self.unkept.as_deref()
    }

    /// Under which key the record of a mission is kept.
    pub(crate) fn key(mission: &str) -> String {
        format!("enroute/review-1/{mission}")
    }

    /// Under which key a record is kept that cannot be used.
    pub(crate) fn aside_key(mission: &str, number: usize) -> String {
        let key = Self::key(mission);
        if number == 0 { format!("{key}/aside") } else { format!("{key}/aside-{number}") }
    }

    /// Something was found that cannot be used; it is kept.
    pub(crate) fn set_aside(&mut self, aside: Aside) {
        self.aside = Some(aside);
    }

    /// The host has kept the record, or says why not.
    pub(crate) fn kept(&mut self, outcome: Result<(), String>) {
        self.unkept = outcome.err();
    }

    /// Adds what is kept of the record elsewhere, such as in another tab.
    pub(crate) fn join(&mut self, kept: Record) {
        if self.record.entries().is_empty() {
            self.record.mission.clone_from(&kept.mission);
        }
        // Where two tabs start a history at the same time, that of the first one stays.
        self.record.follow_history_of(&kept);
        self.record.merge(kept);
    }

    /// The core stopped: what was asked of it does not come.
    pub(crate) fn give_up(&mut self) {
        self.running = None;
        self.waiting = None;
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

/// The review with what it is about: what its commands read and change of other parts.
pub(crate) struct Reviewing<'a> {
    pub(crate) review: &'a mut Part<ReviewState>,
    pub(crate) keys: &'a KeysState,
    pub(crate) chance: &'a mut Part<ChanceState>,
    pub(crate) settings: &'a mut Part<Settings>,
    pub(crate) window: &'a mut Window,
    pub(crate) document: &'a mut Part<Document>,
    pub(crate) snapshots: &'a Snapshots,
    pub(crate) mission: &'a str,
    /// What the record is kept under.
    pub(crate) mission_key: SmolStr,
    pub(crate) unix_millis: i64,
}

impl Reviewing<'_> {
    /// Does what a command asks for.
    pub(crate) fn apply(&mut self, command: ReviewCommand) {
        match command {
            ReviewCommand::Run => self.run(),
            ReviewCommand::Approve { by, text } => self.approve(&by, text.trim()),
            ReviewCommand::Say { by, act } => self.say(&by, act),
            ReviewCommand::SetRules(rules) => self.set_rules(&rules),
            ReviewCommand::SaveRules => self.save_as("rules", self.review.record.rules().to_json()),
            ReviewCommand::SaveRecord => self.save_as("review", self.review.record.to_json()),
            ReviewCommand::ChangeKeys(change) => self.window.ask(Effect::ChangeKeys(change)),
            ReviewCommand::SignAs(name) => self.settings.reviewer = name,
            ReviewCommand::SaveOwnKey(name) => match self.keys.ring().own_to_json(&name) {
                Some(text) => self.window.save_file(format!("{name}.key.json"), text.into_bytes()),
                None => self.window.failed(format!("Unknown key “{name}”")),
            },
            ReviewCommand::SaveKeys => {
                let text = self.keys.ring().to_json(false);
                self.window.save_file("board.keys.json".to_owned(), text.into_bytes());
            }
            ReviewCommand::OpenRecord => self.window.ask(Effect::OpenFile(FileKind::Json)),
            ReviewCommand::SaveAside => {
                if let Some(aside) = &self.review.aside {
                    self.save_as("aside.review", aside.text.clone());
                }
            }
        }
    }

    fn save_as(&mut self, what: &str, text: String) {
        self.window.save_file(format!("{}.{what}.json", self.mission), text.into_bytes());
    }

    /// Asks the core for a review of the present text.
    pub(crate) fn run(&mut self) {
        let revision = self.document.revision();
        self.review.running = Some((revision, self.settings.plan.planner()));
        self.review.asked = self.review.hash().map(str::to_owned);
        let update = self.settings.plan.update(revision, self.document.shared_text());
        let rules = self.review.record.rules().rules.clone();
        self.window.post(Request::Review { update, rules });
    }

    /// Takes a review that was asked for. Returns what was waiting for it.
    pub(crate) fn take(&mut self, revision: u64, review: Arc<Review>) -> Option<Waiting> {
        // What no one waits for any more may be of another mission.
        let (_, search) = self.review.running.take_if(|running| running.0 == revision)?;
        self.review.done.retain(|it| it.review.content_hash != review.content_hash || it.search != search);
        self.review.done.insert(0, Done { search, review, robustness: None });
        self.review.done.truncate(MAX_DONE);
        self.judge();
        self.review.waiting.take()
    }

    /// Holds every review against the present rules, and against the runs that were made of its content.
    pub(crate) fn judge(&mut self) {
        let rules = self.review.record.rules().clone();
        for done in &mut self.review.done {
            let robustness = self.chance.of_content(&done.review.content_hash).cloned();
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

    fn set_rules(&mut self, rules: &FlightRules) {
        if let Some(problem) = rules.problem() {
            self.window.failed(format!("Invalid flight rules: {problem}"));
            return;
        }
        if self.review.record.rules() == rules && self.review.record.has_settled_rules() {
            return;
        }
        let unknown = rules
            .board
            .iter()
            .flat_map(|seat| &seat.people)
            .find(|key| self.keys.ring().trust().name_of(key).is_none());
        if let Some(unknown) = unknown {
            let words = format!("Trust the key {} first: the board names it", unknown.fingerprint());
            self.window.failed(words);
            return;
        }
        let by = Person { name: self.settings.reviewer.clone(), role: self.settings.reviewer_role.clone() };
        let proposals = self.review.record.proposals().into_iter();
        let mut proposals = proposals.filter(|proposal| proposal.rules == rules);
        let key = self.keys.secret(&by.name).map(|(key, _)| key).ok();
        let has_signed = |proposal: Proposal<'_>| proposal.by.iter().any(|entry| entry.key == key);
        if key.is_some() && proposals.any(has_signed) {
            self.window.failed("You have already agreed to these flight rules".to_owned());
            return;
        }
        if !self.sign(by, Act::Rules { rules: rules.clone() }) {
            return;
        }
        self.judge();
        let mut proposals = self.review.record.proposals().into_iter();
        if let Some(proposal) = proposals.find(|proposal| proposal.rules == rules) {
            let words = format!("Proposed, not in force yet: {}", proposal.consent());
            self.window.info(&words);
        }
    }

    /// Takes flight rules from a file.
    pub(crate) fn import_rules(&mut self, name: &str, text: &str) {
        match FlightRules::from_json(text) {
            Ok(rules) => {
                self.set_rules(&rules);
                let record = &self.review.record;
                if *record.rules() != rules || !record.conflicting_rules().is_empty() {
                    return;
                }
                self.window.done(format!("Applied the flight rules of {name}"));
            }
            Err(reason) => self.window.failed(format!("{name}: {reason}")),
        }
    }

    /// Adds what a file has.
    pub(crate) fn import_record(&mut self, name: &str, text: &str) {
        match Record::from_json(text) {
            Ok(record) if !self.is_of_open_mission(&record) => {
                // What is added to a history stays in it for good.
                let words = format!(
                    "{name} is a review of “{}”, not of the open mission. No entries added.",
                    record.mission
                );
                self.window.failed(words);
            }
            Ok(record) if !self.can_join(&record) => {
                self.window.failed(format!("{name} is another history of this mission. No entries added."));
            }
            Ok(record) => {
                let (count, left_out) = self.merge_foreign(record);
                let entries = if count == 1 { "entry" } else { "entries" };
                let mut parts = vec![format!("Added {count} new {entries} from {name}")];
                let doubtful = self.review.record.checked().filter(|(_, check)| !check.counts()).count();
                if doubtful > 0 {
                    parts.push(format!("Entries that don't count: {doubtful} (see History)"));
                }
                if left_out > 0 {
                    parts.push("Monte Carlo results are not taken from a file: run them again".to_owned());
                }
                match parts.as_slice() {
                    [added] => self.window.done(added.clone()),
                    parts => self.window.failed(format!("{}.", parts.join(". "))),
                }
            }
            Err(reason) => {
                self.window.failed(format!("Couldn't add {name}: {reason}. No entries added."));
            }
        }
    }

    /// Returns whether a record from elsewhere is the history that is here, or can take its place.
    fn can_join(&self, record: &Record) -> bool {
        let mut record = record.clone();
        record.judge(&self.keys.ring().trust(), &self.utc_now());
        self.review.record.can_join(&record)
    }

    /// Adds a record from elsewhere. Returns how many entries are new, and for how many contents runs were left out.
    fn merge_foreign(&mut self, mut record: Record) -> (usize, usize) {
        self.name_record();
        record.judge(&self.keys.ring().trust(), &self.utc_now());
        // If the history here is empty, it continues one of the same content under another mission name.
        let is_present = |content: &str| self.review.hash() == Some(content);
        if self.review.record.entries().is_empty()
            && record.counted().any(|entry| is_present(&entry.content_hash))
        {
            self.review.record.mission.clone_from(&record.mission);
        }
        let mut runs = std::mem::take(&mut record.runs);
        runs.retain(|runs| self.review.record.runs_of(&runs.content_hash).is_none_or(|known| known != runs));
        let left_out = runs.len();
        let of_present = runs.into_iter().find(|runs| self.review.hash() == Some(&runs.content_hash));
        if let Some(runs) = of_present {
            // They can be made again as they were made.
            let settings = Box::new(runs.robustness().settings);
            self.chance.apply(ChanceCommand::Set(settings), None, self.window);
        }
        let count = self.review.record.merge(record);
        self.judge_record();
        self.learn_runs();
        self.keep();
        (count, left_out)
    }

    /// Gives an empty history the name of the open mission, which may have been renamed.
    pub(super) fn name_record(&mut self) {
        if self.review.record.entries().is_empty() && self.review.record.mission != self.mission {
            self.review.record.mission = self.mission.to_string();
        }
    }

    /// Returns whether a record is about the open mission: by its name, or, where that was changed, by the present
    /// content or by what both histories have.
    fn is_of_open_mission(&self, record: &Record) -> bool {
        let hash = self.review.hash();
        let is_present = |content: &str| hash.is_some_and(|hash| hash == content);
        record.mission.is_empty()
            || record.mission == self.mission
            || record.mission == self.review.record.mission
            || record.entries().iter().any(|entry| {
                is_present(&entry.content_hash) || self.review.record.entry(entry.digest()).is_some()
            })
            || record.runs.iter().any(|runs| is_present(&runs.content_hash))
    }

    fn keep(&mut self) {
        self.name_record();
        self.window.ask(Effect::KeepReview { joins: true });
    }

    /// The host found this kept under the open mission's name, and this that could not be used before.
    /// `random` is for a new history.
    pub(crate) fn recall(&mut self, kept: Option<&str>, aside: Option<String>, random: Option<[u8; 32]>) {
        self.review.random = random;
        self.review.of = self.mission_key.clone();
        let set_aside = self.review.set_aside.remove(&self.mission_key);
        let reason = "an earlier copy was unreadable".to_owned();
        self.review.aside = aside.map(|text| Aside { reason, text });
        let record = match kept.map(|text| (text, Record::from_json(text))) {
            Some((_, Ok(record))) => record,
            Some((text, Err(reason))) => {
                // It stays where it is; what is kept from here on goes beside it.
                let words = format!("Couldn't read the saved review: {reason}. A copy was set aside.");
                self.window.failed(words);
                self.review.aside = Some(Aside { reason: reason.to_string(), text: text.to_owned() });
                Record::default()
            }
            None => Record::default(),
        };
        self.review.record = record;
        self.name_record();
        self.judge_record();
        if let Some(set_aside) = set_aside {
            self.review.record.merge(set_aside);
            self.window.ask(Effect::KeepReview { joins: true });
        }
        self.learn_runs();
    }

    /// The open original has become a mission of its own: what was said of it is said of the mission too.
    pub(crate) fn go_along(&mut self) {
        self.review.of = self.mission_key.clone();
        if !self.review.record.is_empty() {
            self.keep();
        }
    }

    /// Adds what came with a mission.
    pub(crate) fn join(&mut self, record: Record) {
        if self.can_join(&record) {
            self.merge_foreign(record);
        } else {
            self.window
                .failed("The mission file has a different review history. No entries added.".to_owned());
        }
    }

    /// Another mission is open now.
    pub(crate) fn leave(&mut self) {
        self.review.leave();
        self.window.ask(Effect::RecallReview);
    }

    /// Follows what the present content is. Nothing is hashed twice.
    pub(crate) fn follow(&mut self) {
        let revision = self.document.revision();
        if self.review.running.is_some_and(|running| running.0 != revision) {
            // A newer text ends the review of the older one. What waits for the older one gets that of the newer text.
            self.review.give_up();
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
            self.follow_plan();
            self.evaluate_rules();
            return;
        }
        let settings = self.settings.plan.clone();
        let hash = content_hash(self.document.text(), latest.map.as_ref(), &settings.goal, settings.seed);
        // An approval of this content may have signed another text, in a history of an earlier version.
        if self.review.record.contradicts(&hash, self.document.text()) {
            self.review.record.learn_source(&hash, self.document.text());
        }
        self.review.current = Some(Current { revision, answered, settings, hash });
        self.follow_plan();
    }

    /// Follows which plan is drawn: one content has another plan by another search, or where planning was stopped.
    fn follow_plan(&mut self) {
        let revision = self.document.revision();
        let drawn = self.snapshots.latest().filter(|it| it.revision == revision && it.plan().is_some());
        let Some(drawn) = drawn.filter(|_| self.review.asks_for_plan()) else {
            self.review.plan = None;
            return;
        };
        if self.review.plan.as_ref().is_none_or(|(known, _)| !Arc::ptr_eq(known, drawn)) {
            self.review.plan = Some((Arc::clone(drawn), plan_hash(drawn)));
        }
    }

    /// Asks for the rules of the mission that the present review has not been held against.
    fn evaluate_rules(&mut self) {
        let rules = self.review.record.rules();
        if !self.review.is_running()
            && self.review.current().is_some_and(|review| !review.is_evaluated(rules))
        {
            self.run();
        }
    }

    /// Checks the history by the keys that are trusted, as of now.
    pub(crate) fn judge_record(&mut self) {
        let (trust, now) = (self.keys.ring().trust(), self.utc_now());
        self.review.judged_minute = self.unix_millis / MILLIS_PER_MINUTE;
        self.review.record.judge(&trust, &now);
    }

    /// Now, as an ISO 8601 time in UTC.
    fn utc_now(&self) -> String {
        report::calendar::utc_text(self.unix_millis)
    }
}

impl AppState {
    /// Takes the keys that are kept now: other signatures may count.
    pub(crate) fn take_keys(&mut self, ring: KeyRing, unkept: Option<String>) {
        *self.keys = KeysState { ring, unkept };
        let mut reviewing = self.reviewing();
        reviewing.judge_record();
        reviewing.judge();
        self.derive();
    }

    /// Checks the history again every minute: waivers lapse.
    pub(crate) fn judge_by_the_clock(&mut self) {
        let minute = self.frame.unix_millis / MILLIS_PER_MINUTE;
        if self.review.record.is_empty() || self.review.judged_minute == minute {
            return;
        }
        self.reviewing().judge_record();
        self.derive();
    }
}
