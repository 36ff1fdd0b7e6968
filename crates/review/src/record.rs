//! What a board adds to a review: an append-only history of who said, acknowledged, approved and took back what, as a
//! document that is kept with the mission (SPEC 16.2).
//!
//! Each entry names the content and the plan that it is about, is sealed over the entries before it, and is signed: one
//! that is altered, missing or put elsewhere is noticed when the document is read, and only what trusted keys have signed
//! counts ([`Record::judge`]). That the last entries are missing shows only in the last digest, which a report prints.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

use data_encoding::HEXLOWER;
use jiff::Timestamp;
use serde_json::{Map, Value, json};

use super::check::{Check, HIDDEN, check, is_after, moment};
pub use super::entry::{Act, Entry, LineKey, Rate, Runs, Said, SeenLine, Subject, Who, seen_lines};
use super::keys::{SecretKey, Trust};
use super::ruling::{Ruling, followers};
use super::sealed::Sealed;
use super::{FlightRules, former_record, strict};

/// The history of one mission's review, with what was approved and the runs that were made.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// The name of the mission whose history this is. Every entry signs it, so it stays when the mission gets another name.
    pub mission: String,
    /// Which history it is: the digest of its first entry, which every other entry signs. Empty in histories of earlier
    /// versions, which have only the name of their mission.
    history: String,
    /// What makes the first entry another one than that of any other history, until there is one.
    nonce: String,
    /// Whether each entry is the first one, or was made after it.
    follows: Vec<bool>,
    /// How many entries follow no other, among those that trusted keys have signed for this mission.
    starts: usize,
    /// Each entry after those that it was made after.
    entries: Vec<Entry>,
    /// What was found of each entry, for `trust` at `now`.
    checks: Vec<Check>,
    /// Which flight rules are in force.
    ruling: Ruling,
    /// Where each set of flight rules was first set, by its digest.
    first_rules: BTreeMap<String, usize>,
    /// Whose signatures count.
    trust: Trust,
    /// Whether the reader has required the rules in force, whatever rules unknown keys have set.
    has_required_rules: bool,
    /// When the entries were checked.
    now: Option<Timestamp>,
    /// Where each entry is, by its digest.
    numbers: BTreeMap<String, usize>,
    /// The digests of the entries that no other was made after.
    heads: BTreeSet<String>,
    /// What approvals are about, by its digest.
    subjects: BTreeMap<String, Kept>,
    /// Texts that are known by their content hashes.
    known_sources: BTreeMap<String, String>,
    /// The results of Monte Carlo runs, the latest content last. Anyone can write any figures into a document, and sign them.
    /// So those of a document count only once they have been repeated.
    pub runs: Vec<Runs>,
}

/// What was approved, with the content hash of its text as far as its map is known.
#[derive(Clone, Debug, PartialEq)]
struct Kept {
    subject: Sealed<Subject>,
    content_hash: String,
}

impl Kept {
    fn new(subject: Sealed<Subject>) -> Self {
        let content_hash = subject.content_hash();
        Self { subject, content_hash }
    }
}

/// Monte Carlo runs of one content, at most.
pub const MAX_RUNS: u64 = 100_000;

/// Contents of which runs are kept.
pub const MAX_RUNS_KEPT: usize = 8;

/// The rules of a mission of which no one has set any.
pub(super) static USUAL_RULES: LazyLock<FlightRules> = LazyLock::new(FlightRules::default);

/// The format of the document.
pub const FORMAT: &str = "enroute-review/3";

/// The format of the version before, whose entries are not signed.
const UNSIGNED_FORMAT: &str = "enroute-review/2";

/// How the formats of all versions begin.
const FORMATS: &str = "enroute-review/";

/// Why a text is not a record of a review.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RecordError {
    /// It is another kind of document.
    #[error("this is not a review: its format is {found}, not \"{FORMAT}\"")]
    Format {
        /// What it says of itself.
        found: String,
    },
    /// A later version of the program wrote it.
    #[error(
        "a later version of Enroute wrote this review: its format is {found}, but this version reads \"{FORMAT}\""
    )]
    Newer {
        /// What it says of itself.
        found: String,
    },
    #[error("couldn't read this review: {0}")]
    Damaged(String),
    /// Its history has been altered.
    #[error("the history of this review has been altered: {0}")]
    Broken(String),
}

/// Returns whether a document says that it is a review, of whatever version.
pub fn is_record(document: &Value) -> bool {
    document["format"].as_str().is_some_and(|format| format.starts_with(FORMATS))
}

/// Two records are the same if they have the same content, whatever keys are trusted.
impl PartialEq for Record {
    fn eq(&self, other: &Self) -> bool {
        let parts = |it: &Self| (it.mission.clone(), it.history.clone(), it.heads.clone());
        parts(self) == parts(other)
            && self.entries == other.entries
            && self.subjects == other.subjects
            && self.runs == other.runs
    }
}

impl Record {
    /// The record of a mission of which no one has said anything.
    pub fn new(mission: &str) -> Self {
        Self { mission: mission.to_owned(), ..Self::default() }
    }

    /// Prepares a new history: its first entry has this random number in it. Has no effect on a history that has entries.
    pub fn seed(&mut self, random: [u8; 32]) {
        self.nonce = HEXLOWER.encode(&random);
    }

    /// Returns which history it is: the digest of its first entry. Empty in histories of earlier versions.
    pub fn history(&self) -> &str {
        &self.history
    }

    /// Returns whether `other` is the same history, or one of the two is not a history yet. Those of earlier versions
    /// are the same if they have a first entry in common.
    pub fn is_same_history(&self, other: &Self) -> bool {
        let starts = |it: &Self| {
            let starts = it.entries.iter().filter(|entry| match it.history.as_str() {
                "" => entry.former.is_empty(),
                history => entry.digest() == history,
            });
            starts.map(|entry| entry.digest().to_owned()).collect::<BTreeSet<_>>()
        };
        let is_new = self.entries.is_empty() || other.entries.is_empty();
        is_new || (self.history == other.history && !starts(self).is_disjoint(&starts(other)))
    }

    /// Returns whether an entry is the first one, or was made after it.
    pub(super) fn is_after_first(&self, entry: &Entry) -> bool {
        self.numbers.get(entry.digest()).is_some_and(|&index| self.follows.get(index) == Some(&true))
    }

    /// Returns whether trusted people started several histories of this mission, and they are joined here.
    pub(super) fn has_several_starts(&self) -> bool {
        self.starts > 1
    }

    /// Returns whether no one has said anything yet, and no runs are kept.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty() && self.runs.is_empty()
    }

    /// The history, each entry after those that it was made after.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The entries, each with what was found of it.
    pub fn checked(&self) -> impl DoubleEndedIterator<Item = (&Entry, &Check)> {
        self.entries.iter().zip(&self.checks)
    }

    /// The entries that count: those that trusted keys have signed, and whose signers may do what they did.
    pub fn counted(&self) -> impl DoubleEndedIterator<Item = &Entry> {
        self.checked().filter(|(_, check)| check.counts()).map(|(entry, _)| entry)
    }

    /// The entries that count and have not been taken back.
    pub fn standing_entries(&self) -> impl DoubleEndedIterator<Item = &Entry> {
        let withdrawn = self.withdrawn();
        self.counted().filter(move |entry| !withdrawn.contains_key(entry.digest()))
    }

    /// Checks the entries again: for whom some keys are trusted, and at which time (ISO 8601, in UTC). Until then nothing
    /// counts.
    pub fn judge(&mut self, trust: &Trust, now: &str) {
        self.now = moment(now);
        self.trust = trust.clone();
        self.check_again();
    }

    fn check_again(&mut self) {
        let is_start = |entry: &&Entry| {
            let is_trusted = entry.key.as_ref().is_some_and(|key| self.trust.name_of(key).is_some());
            entry.former.is_empty() && entry.is_signed() && is_trusted && entry.mission == self.mission
        };
        self.starts = self.entries.iter().filter(is_start).count();
        let of = |entry| check(self, entry, &self.trust, self.now);
        self.checks = self.entries.iter().map(of).collect();
        self.ruling = Ruling::new(&self.entries, &self.checks);
    }

    /// Returns which entries set the flight rules.
    pub(super) fn ruling(&self) -> &Ruling {
        &self.ruling
    }

    /// Returns whether an entry was made after the last change of the flight rules. Rules that were replaced and set
    /// again are no longer those that an earlier approval is of.
    pub fn is_under_rules(&self, entry: &Entry) -> bool {
        self.numbers.get(entry.digest()).is_some_and(|&index| self.ruling.is_under(index))
    }

    /// Returns whether the flight rules that an entry names were in force when it was made, and its signer knew them.
    pub(super) fn was_under_rules(&self, entry: &Entry) -> bool {
        self.numbers.get(entry.digest()).is_some_and(|&index| self.ruling.was_under_own(index))
    }

    /// Notes that the reader requires the rules in force: then rules that unknown keys have set block nothing.
    pub const fn confirm_rules(&mut self) {
        self.has_required_rules = true;
    }

    /// Returns whether the reader requires the rules in force.
    pub(super) const fn has_required_rules(&self) -> bool {
        self.has_required_rules
    }

    /// Returns whose signatures count.
    pub(super) const fn trust(&self) -> &Trust {
        &self.trust
    }

    /// Returns whether an entry comes before the flight rules that it names, wherever they are set.
    pub(super) fn precedes_its_rules(&self, entry: &Entry) -> bool {
        let first = self.first_rules.get(&entry.rules);
        let index = self.numbers.get(entry.digest()).copied().unwrap_or(self.checks.len());
        first.is_some_and(|&first| first > index) && entry.rules != USUAL_RULES.digest()
    }

    /// When the entries were checked.
    pub(super) fn now(&self) -> Option<Timestamp> {
        self.now
    }

    /// The entry of this digest.
    pub fn entry(&self, digest: &str) -> Option<&Entry> {
        self.entries.get(*self.numbers.get(digest)?)
    }

    /// Returns what was found of the entry of this digest.
    pub fn check_of(&self, digest: &str) -> Option<&Check> {
        self.checks.get(*self.numbers.get(digest)?)
    }

    /// The number of an entry, from 1; 0 if there is none.
    pub fn number(&self, digest: &str) -> usize {
        self.numbers.get(digest).map_or(0, |index| index + 1)
    }

    /// Returns what an approval is about.
    pub fn subject(&self, entry: &Said) -> Option<&Subject> {
        match &entry.act {
            Act::Approve { subject, .. } => self.subjects.get(subject).map(|kept| &*kept.subject),
            _ => None,
        }
    }

    /// Returns whether an approval has signed a text, map, goal or seed of another content than it names. In histories
    /// of earlier versions the map is not known: then only a text counts as another one whose content is known here.
    pub(super) fn has_other_content(&self, entry: &Entry) -> bool {
        let Act::Approve { subject, .. } = &entry.act else { return false };
        let Some(Kept { subject, content_hash }) = self.subjects.get(subject) else { return false };
        let has_map = !entry.history.is_empty() || !entry.nonce.is_empty() || subject.map.is_some();
        let is_other = has_map && *content_hash != entry.content_hash;
        is_other || self.known_sources.get(&entry.content_hash).is_some_and(|known| *known != subject.source)
    }

    /// Returns whether an approval of this content has signed another text.
    pub fn contradicts(&self, content_hash: &str, source: &str) -> bool {
        let is_known = self.known_sources.get(content_hash).is_some_and(|known| known == source);
        let mut entries = self.entries.iter().filter(|entry| entry.content_hash == content_hash);
        !is_known && entries.any(|entry| self.subject(entry).is_some_and(|subject| subject.source != source))
    }

    /// Notes the text of a content, and checks the entries again by it.
    pub fn learn_source(&mut self, content_hash: &str, source: &str) {
        if self.contradicts(content_hash, source) {
            self.known_sources.insert(content_hash.to_owned(), source.to_owned());
            self.check_again();
        }
    }

    /// The digests of the last entries: those that no other was made after, usually one. Who knows them knows the history.
    pub fn heads(&self) -> impl Iterator<Item = &str> {
        self.heads.iter().map(String::as_str)
    }

    fn push(&mut self, entry: Entry) {
        for former in &entry.former {
            self.heads.remove(former);
        }
        self.heads.insert(entry.digest().to_owned());
        self.checks.push(check(self, &entry, &self.trust, self.now));
        self.numbers.insert(entry.digest().to_owned(), self.entries.len());
        self.entries.push(entry);
    }

    /// The entries that have been taken back, by whom.
    pub fn withdrawn(&self) -> BTreeMap<&str, &Entry> {
        let withdrawals = self.counted().filter_map(|entry| match &entry.act {
            Act::Withdraw { of, .. } => Some((of.as_str(), entry)),
            _ => None,
        });
        withdrawals.collect()
    }

    /// The flight rules in force, otherwise the usual ones: see [`Record::ruled`].
    pub fn rules(&self) -> &FlightRules {
        self.ruled().map_or(&USUAL_RULES, |(_, rules)| rules)
    }

    /// Adds an entry after all others that are not dated later, signed. Returns its digest.
    pub fn add(&mut self, who: Who, act: Act, secret: &SecretKey) -> String {
        let said = Said { rules: self.ruling.digests(), ..self.said(who, act) };
        self.insert(Entry::signed(said, secret))
    }

    fn insert(&mut self, entry: Entry) -> String {
        let digest = entry.digest().to_owned();
        if self.entries.is_empty() && !entry.nonce.is_empty() {
            self.history.clone_from(&digest);
        }
        self.entries.push(entry);
        self.put_in_order();
        digest
    }

    /// Adds an entry as earlier versions wrote it: without a signature, so that it does not count.
    pub(super) fn add_unsigned(&mut self, who: Who, act: Act) {
        self.push(Entry::new(Sealed::new(self.said(who, act)), String::new()));
    }

    pub(super) fn said(&self, who: Who, act: Act) -> Said {
        let Who { by, role, time, content_hash, plan_hash } = who;
        let former = self.last_before(&time);
        let (mission, key, rules, acknowledged) = (self.mission.clone(), None, String::new(), Vec::new());
        let (history, nonce) = if self.entries.is_empty() {
            (String::new(), self.nonce.clone())
        } else {
            (self.history.clone(), String::new())
        };
        Said {
            by,
            mission,
            history,
            nonce,
            key,
            role,
            time,
            content_hash,
            plan_hash,
            rules,
            acknowledged,
            former,
            act,
        }
    }

    /// The last entries that an entry of this `time` can follow. Entries with a later date are passed over: an entry that
    /// follows one of them would not count, so one false date would keep everybody from withdrawing an approval.
    fn last_before(&self, time: &str) -> Vec<String> {
        let mut last = BTreeSet::new();
        let mut open: Vec<&str> = self.heads.iter().map(String::as_str).collect();
        let mut seen = BTreeSet::new();
        while let Some(digest) = open.pop() {
            let Some(entry) = self.entry(digest).filter(|_| seen.insert(digest)) else { continue };
            if is_after(&entry.time, time) {
                open.extend(entry.former.iter().map(String::as_str));
            } else {
                last.insert(digest.to_owned());
            }
        }
        // A second entry that follows no other would not count.
        let first = self.entries.first().filter(|_| last.is_empty()).map(|entry| entry.digest().to_owned());
        let first = first.map(|first| if self.history.is_empty() { first } else { self.history.clone() });
        last.into_iter().chain(first).collect()
    }

    /// Adds an approval of `subject`, signed, and returns its digest; `acknowledged` are the digests of what it relies on: see
    /// [`Standing::relied_on`](super::Standing::relied_on).
    pub fn approve(
        &mut self,
        who: Who,
        subject: Subject,
        text: String,
        acknowledged: Vec<String>,
        secret: &SecretKey,
    ) -> String {
        let rules = subject.rules.digest();
        let subject = self.keep_subject(subject);
        let said = Said { rules, acknowledged, ..self.said(who, Act::Approve { subject, text }) };
        self.insert(Entry::signed(said, secret))
    }

    /// Keeps what is approved. Returns its digest.
    pub(super) fn keep_subject(&mut self, subject: Subject) -> String {
        let subject = Sealed::new(subject);
        let digest = subject.digest().to_owned();
        self.subjects.insert(digest.clone(), Kept::new(subject));
        digest
    }

    /// Keeps what runs of a content came to, instead of what runs of the same content came to before.
    pub fn keep_runs(&mut self, runs: Runs) {
        self.runs.retain(|known| known.content_hash != runs.content_hash);
        self.runs.push(runs);
        let more = self.runs.len().saturating_sub(MAX_RUNS_KEPT);
        self.runs.drain(..more);
    }

    /// Returns what runs of this content came to.
    pub fn runs_of(&self, content_hash: &str) -> Option<&Runs> {
        self.runs.iter().find(|runs| runs.content_hash == content_hash)
    }

    /// The document, on several lines.
    pub fn to_json(&self) -> String {
        let entry = |entry: &Entry| json!({ "digest": entry.digest(), "said": entry.raw(), "signature": entry.signature() });
        let entries = self.entries.iter().map(entry);
        let subjects: Map<String, Value> =
            self.subjects.iter().map(|(digest, kept)| (digest.clone(), kept.subject.raw().clone())).collect();
        let document = json!({
            "format": FORMAT,
            "program": crate::PROGRAM,
            "diagnostics": [],
            "mission": self.mission,
            "history": self.history,
            "entries": entries.collect::<Vec<Value>>(),
            "heads": self.heads,
            "subjects": subjects,
            "runs": self.runs.iter().map(sealed_runs).collect::<Vec<Value>>(),
        });
        let mut text = serde_json::to_string_pretty(&document).unwrap_or_default();
        text.push('\n');
        text
    }

    /// Takes over which history another record is, where this one has none of its own that counts.
    fn take_history_of(&mut self, other: &Self) {
        if self.entries.is_empty() || (self.counted().next().is_none() && other.counted().next().is_some()) {
            self.history.clone_from(&other.history);
        }
    }

    /// Returns whether the entries of `other` can be added without mixing two histories: they are the same, or nothing
    /// counts here.
    pub fn can_join(&self, other: &Self) -> bool {
        self.is_same_history(other) || (self.counted().next().is_none() && other.counted().next().is_some())
    }

    /// Agrees with another copy of the history that was kept first, where two tabs started one at the same time.
    pub fn follow_history_of(&mut self, kept: &Self) {
        if !kept.entries.is_empty() && self.history != kept.history {
            self.history.clone_from(&kept.history);
            self.put_in_order();
        }
    }

    /// Reads the document, and checks that its history is whole. Whose signatures count is a matter of [`Record::judge`].
    /// Documents of the first version have no history: what was said and approved becomes one, in order of time.
    pub fn from_json(text: &str) -> Result<Self, RecordError> {
        let damaged = |error: serde_json::Error| RecordError::Damaged(error.to_string());
        let mut value = strict::from_str(text).map_err(damaged)?;
        match value["format"].as_str() {
            Some(FORMAT | UNSIGNED_FORMAT) => {}
            Some(former_record::FORMAT) => {
                let record = former_record::read(value).map_err(damaged)?;
                let hidden = record.entries.iter().position(|entry| !entry.is_visible());
                return hidden.map_or(Ok(record), |index| Err(has_hidden(index)));
            }
            Some(newer) if newer.starts_with(FORMATS) => {
                return Err(RecordError::Newer { found: newer.to_owned() });
            }
            _ => return Err(RecordError::Format { found: value["format"].to_string() }),
        }
        let mut record =
            Self { mission: value["mission"].as_str().unwrap_or_default().to_owned(), ..Self::default() };
        value["history"].as_str().unwrap_or_default().clone_into(&mut record.history);
        let Value::Array(runs) = value["runs"].take() else { return Err(lacks("runs")) };
        for mut runs in runs {
            // Those that a version without digests kept cannot be told from others, and are made again.
            let Some(digest) = runs.as_object_mut().and_then(|members| members.remove("digest")) else {
                continue;
            };
            let runs = Sealed::<Runs>::read(runs).map_err(damaged)?;
            if digest != runs.digest() {
                let what = format!(
                    "the Monte Carlo runs of content {} have been changed",
                    short(&runs.content_hash)
                );
                return Err(RecordError::Broken(what));
            }
            record.runs.push((*runs).clone());
        }
        if record.runs.iter().any(|runs| runs.tally.succeeded > runs.tally.runs) {
            return Err(RecordError::Damaged("more runs reached the end than were made".to_owned()));
        }
        if record.runs.iter().any(|runs| runs.tally.runs > MAX_RUNS) {
            return Err(RecordError::Damaged(format!("it has more than {MAX_RUNS} Monte Carlo runs")));
        }
        let Value::Object(subjects) = value["subjects"].take() else { return Err(lacks("subjects")) };
        for (digest, subject) in subjects {
            let subject = Sealed::<Subject>::read(subject).map_err(damaged)?;
            if subject.digest() != digest {
                let what = format!("the approved subject {} has been changed", short(&digest));
                return Err(RecordError::Broken(what));
            }
            record.subjects.insert(digest, Kept::new(subject));
        }
        let Value::Array(entries) = value["entries"].take() else { return Err(lacks("entries")) };
        let mut known = BTreeSet::new();
        for (index, mut entry) in entries.into_iter().enumerate() {
            // An index would make a member of what is not an object, or panic.
            let said = entry.get_mut("said").map(Value::take).unwrap_or_default();
            let said = Sealed::<Said>::read(said).map_err(damaged)?;
            if !said.is_visible() {
                return Err(has_hidden(index));
            }
            record.is_next(&said, entry["digest"].as_str().unwrap_or_default(), &known).map_err(|why| {
                RecordError::Broken(format!("entry {} ({}, {}) {why}", index + 1, said.by, said.time))
            })?;
            known.insert(said.digest().to_owned());
            let signature = entry["signature"].as_str().unwrap_or_default().to_owned();
            record.entries.push(Entry::new(said, signature));
        }
        if record.entries.is_empty() {
            record.history.clear();
        }
        record.put_in_order();
        let has_first = record.history.is_empty() || record.entry(&record.history).is_some();
        if !has_first {
            return Err(RecordError::Broken("the first entry is missing".to_owned()));
        }
        let heads: BTreeSet<String> = serde_json::from_value(value["heads"].take()).map_err(damaged)?;
        if heads != record.heads {
            return Err(RecordError::Broken("an entry at the end is missing".to_owned()));
        }
        Ok(record)
    }

    /// What is wrong with an entry that comes after the `known` ones.
    fn is_next(
        &self,
        entry: &Sealed<Said>,
        digest: &str,
        known: &BTreeSet<String>,
    ) -> Result<(), &'static str> {
        match &entry.act {
            _ if entry.digest() != digest => Err("has been changed"),
            _ if known.contains(digest) => Err("occurs twice"),
            _ if !entry.former.iter().all(|former| known.contains(former)) => Err("follows a missing entry"),
            Act::Approve { subject, .. } if !self.subjects.contains_key(subject) => {
                Err("approves content that is missing")
            }
            act if act.of().is_some_and(|of| !known.contains(of)) => Err("is about a missing entry"),
            _ => Ok(()),
        }
    }

    /// Adds what another record has and this one has not. Returns how many entries are new. Each entry stays after those
    /// that it was made after; otherwise they are in order of time.
    pub fn merge(&mut self, other: Self) -> usize {
        let before = self.entries.len();
        self.take_history_of(&other);
        self.subjects.extend(other.subjects);
        let mut new = Vec::new();
        for entry in other.entries {
            match self.numbers.get(entry.digest()) {
                None => new.push(entry),
                // The same words with a signature that is one.
                Some(&known) if entry.is_signed() => self.entries[known] = entry,
                Some(_) => {}
            }
        }
        self.entries.extend(new);
        self.put_in_order();
        for runs in other.runs {
            if self.runs_of(&runs.content_hash).is_none_or(|known| known.tally.runs < runs.tally.runs) {
                self.keep_runs(runs);
            }
        }
        self.entries.len() - before
    }

    /// Puts the entries in the one order that they have, whatever order a document has them in: which flight rules were set
    /// last must not depend on that.
    fn put_in_order(&mut self) {
        self.entries = in_order(std::mem::take(&mut self.entries));
        self.heads.clear();
        self.numbers.clear();
        self.first_rules.clear();
        for (index, entry) in self.entries.iter().enumerate() {
            for former in &entry.former {
                self.heads.remove(former);
            }
            self.heads.insert(entry.digest().to_owned());
            self.numbers.insert(entry.digest().to_owned(), index);
            if let Act::Rules { rules } = &entry.act {
                self.first_rules.entry(rules.digest()).or_insert(index);
            }
        }
        let first = self.numbers.get(&self.history);
        self.follows = first.map_or_else(Vec::new, |&first| followers(&self.entries, first));
        self.check_again();
    }
}

/// Entries in order of time, each after those that it was made after and the one that it is about: one order, whatever
/// order they come in.
pub(super) fn in_order(entries: Vec<Entry>) -> Vec<Entry> {
    let all: BTreeSet<&str> = entries.iter().map(Entry::digest).collect();
    let mut waits_for: Vec<usize> = Vec::with_capacity(entries.len());
    let mut after: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    let mut ready = BTreeSet::new();
    // Times in UTC and of one shape are in order when their texts are.
    let key = |index: usize| (entries[index].time.as_str(), entries[index].digest(), index);
    for (index, entry) in entries.iter().enumerate() {
        let former = entry.former.iter().map(String::as_str).chain(entry.act.of());
        let former: BTreeSet<&str> = former.filter(|former| all.contains(former)).collect();
        waits_for.push(former.len());
        if former.is_empty() {
            ready.insert(key(index));
        }
        for former in former {
            after.entry(former).or_default().push(index);
        }
    }
    let mut order = Vec::with_capacity(entries.len());
    while let Some((_, digest, index)) = ready.pop_first() {
        order.push(index);
        for &next in after.get(digest).into_iter().flatten() {
            waits_for[next] -= 1;
            if waits_for[next] == 0 {
                ready.insert(key(next));
            }
        }
    }
    let mut entries: Vec<Option<Entry>> = entries.into_iter().map(Some).collect();
    order.into_iter().filter_map(|index| entries[index].take()).collect()
}

/// Runs as they are written, with their digest.
fn sealed_runs(runs: &Runs) -> Value {
    let sealed = Sealed::new(runs.clone());
    let mut raw = sealed.raw().clone();
    raw["digest"] = sealed.digest().into();
    raw
}

fn has_hidden(index: usize) -> RecordError {
    RecordError::Damaged(format!("of entry {}, {HIDDEN}", index + 1))
}

fn lacks(member: &str) -> RecordError {
    RecordError::Damaged(format!("it has no `{member}`"))
}

/// As much of a digest as people compare.
pub fn short(digest: &str) -> &str {
    digest.get(..12).unwrap_or(digest)
}
