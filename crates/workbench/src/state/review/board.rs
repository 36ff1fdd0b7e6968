//! What people of the board do: comment, acknowledge, resolve, approve and take back. Each is an entry of the history.

use review::board::open_comments;
use review::check::{Objection, objection};
use review::keys::{PublicKey, SecretKey};
use review::names;
use review::record::{Act, Record, Runs, Subject, Who};
use review::{Present, Standing, standing};
use serde_json::Value;
use tpn::plan_json::plan_to_json;

use super::{Person, ReviewState, Reviewing};
use crate::state::settings::PlanSettings;

impl ReviewState {
    /// Returns how the plan stands with its board; `None` before it is known what the plan is about.
    pub fn standing(&self) -> Option<Standing<'_>> {
        let review = self.current().map(AsRef::as_ref);
        let present = Present {
            content_hash: self.hash()?,
            plan_hash: review.map(|review| review.plan_hash.as_str()).or(self.plan_hash()),
            rules: self.record.rules(),
            review,
        };
        Some(standing(&self.record, &present))
    }

    /// Someone with the role that is meant: the only one of the board where none is named.
    pub(crate) fn seated(&self, by: &Person) -> Person {
        let role = match self.record.rules().board.as_slice() {
            [seat] if by.role.trim().is_empty() => seat.role.clone(),
            _ => by.role.trim().to_owned(),
        };
        Person { name: by.name.trim().to_owned(), role }
    }

    /// Whether someone whose key is `key` may do something; `Err` says why not.
    pub fn may_say(&self, key: &PublicKey, act: &Act) -> Result<(), String> {
        let record = &self.record;
        let of = act.of().map(|of| record.entry(of).ok_or_else(|| format!("Unknown entry {of}")));
        let of = of.transpose()?;
        let is_open = |of: &str| {
            let open = open_comments(record);
            open.iter().any(|comment| comment.digest() == of)
        };
        let objection = objection(record, Some(key), act, record.today());
        match act {
            _ if self.hash().is_none() => Err("Wait until planning ends, then try again".to_owned()),
            Act::Comment { .. } if act.text().trim().is_empty() => Err("Comment is empty".to_owned()),
            _ if objection == Some(Objection::NoReason) => Err(match act {
                Act::Resolve { .. } => "Enter how the comment was resolved".to_owned(),
                Act::Waive { .. } => "Enter a reason to waive this item".to_owned(),
                _ => "Enter a reason to acknowledge this item".to_owned(),
            }),
            _ if objection == Some(Objection::NoDate) => {
                Err("Enter the date on which the waiver lapses, such as 2026-01-31".to_owned())
            }
            _ if objection == Some(Objection::NeedsWaiver) => {
                Err("The plan violates a flight rule: waive the item, with a date".to_owned())
            }
            _ if objection == Some(Objection::PastDate) => {
                Err("Enter a date after the day on which you sign (UTC)".to_owned())
            }
            Act::Resolve { of, .. } if !is_open(of) => Err("This comment is already resolved".to_owned()),
            Act::Reopen { of, .. } if is_open(of) => Err("This comment is already open".to_owned()),
            Act::Resolve { .. } | Act::Reopen { .. }
                if !of.is_some_and(|of| matches!(of.act, Act::Comment { .. })) =>
            {
                Err("Only comments can be resolved".to_owned())
            }
            Act::Resolve { of, .. } | Act::Reopen { of, .. } | Act::Withdraw { of, .. }
                if record.withdrawn().contains_key(of.as_str()) =>
            {
                Err("This entry was already withdrawn".to_owned())
            }
            _ if objection == Some(Objection::NotConcerned) => {
                let who = "Only the author of a comment or its addressee";
                Err(format!("{who} can resolve or reopen it"))
            }
            _ if objection == Some(Objection::NotSigner) => {
                Err("Only the person who signed an entry can withdraw it".to_owned())
            }
            _ if objection == Some(Objection::Permanent) => {
                Err("Only comments, acknowledgments, waivers and approvals can be withdrawn".to_owned())
            }
            Act::Approve { .. } | Act::Rules { .. } => Err("This entry can't be withdrawn".to_owned()),
            _ => Ok(()),
        }
    }
}

impl Reviewing<'_> {
    /// Someone who does something about the present content, now. The name and the role are remembered.
    pub(super) fn who(&mut self, by: Person) -> Who {
        self.settings.reviewer.clone_from(&by.name);
        self.settings.reviewer_role.clone_from(&by.role);
        let plan_hash = self.review.current().map(|review| review.plan_hash.clone()).unwrap_or_default();
        Who {
            by: names::tidy(&by.name),
            role: by.role,
            time: self.utc_now(),
            content_hash: self.review.hash().unwrap_or_default().to_owned(),
            plan_hash,
        }
    }

    pub(super) fn approve(&mut self, by: &Person, text: &str) {
        let by = self.review.seated(by);
        let key = self.keys.secret(&by.name);
        let refused = match (&key, self.review.standing()) {
            (Err(reason), _) => Some(reason.clone()),
            (Ok((key, _)), Some(standing)) => standing.may_approve(key, &by.role).err(),
            (_, None) => Some("wait until planning ends".to_owned()),
        };
        if let Some(reason) = refused {
            self.window.failed(format!("Not approved: {reason}"));
            return;
        }
        let Some(review) = self.review.current().cloned() else { return };
        let snapshot = self.snapshots.latest();
        let planned = snapshot.and_then(|it| Some((it.network.as_deref()?, it.plan()?)));
        let plan = planned.map_or(Value::Null, |(network, plan)| plan_to_json(network, plan));
        let PlanSettings { goal, seed, .. } = self.settings.plan.clone();
        let found = self.review.hash().and_then(|hash| self.chance.of_content(hash)).cloned();
        let map = snapshot.and_then(|it| it.map.clone());
        let subject = Subject::new(&review, self.document.text(), goal, seed, plan, found.as_deref());
        let subject = Subject { map, ..subject };
        let relied_on = self.review.standing().map(|standing| standing.relied_on).unwrap_or_default();
        let words = format!("Approved by {} ({})", by.name, by.role);
        let approve = |record: &mut Record, who: Who, secret: &SecretKey| {
            record.approve(who, subject, text.to_owned(), relied_on, secret)
        };
        if self.sign_with(by, approve) {
            self.window.done(words);
        }
    }

    pub(super) fn say(&mut self, by: &Person, act: Act) {
        let key = self.keys.secret(&by.name);
        if let Err(reason) = key.and_then(|(key, _)| self.review.may_say(&key, &act)) {
            self.window.failed(reason);
            return;
        }
        let by = self.review.seated(by);
        self.sign(by, act);
    }

    /// Adds an entry, signed. Returns whether it counts; what would not is not added.
    pub(super) fn sign(&mut self, by: Person, act: Act) -> bool {
        self.sign_with(by, |record, who, secret| record.add(who, act, secret))
    }

    fn sign_with(&mut self, by: Person, add: impl FnOnce(&mut Record, Who, &SecretKey) -> String) -> bool {
        let (_, secret) = match self.keys.secret(&by.name) {
            Ok(secret) => secret,
            Err(reason) => {
                self.window.failed(reason);
                return false;
            }
        };
        let who = self.who(by);
        self.name_record();
        self.judge_record();
        let mut record = self.review.record.clone();
        match self.review.random {
            Some(random) => record.seed(random),
            None if record.entries().is_empty() => {
                self.window.failed("Not signed: this browser offers no secret random numbers".to_owned());
                return false;
            }
            None => {}
        }
        let added = add(&mut record, who, &secret);
        if let Some(check) = record.check_of(&added).filter(|check| !check.counts()) {
            let problem = check.problem.as_deref().unwrap_or(check.signature.name());
            self.window.failed(format!("Not signed: {problem}"));
            return false;
        }
        self.review.record = record;
        self.keep();
        true
    }

    /// Keeps what the runs of the present content came to, with the mission.
    pub(crate) fn keep_runs(&mut self, content_hash: &str) {
        let Some(found) = self.chance.of_content(content_hash).filter(|found| found.tally.runs > 0) else {
            return;
        };
        if self.review.hash() == Some(content_hash) {
            self.review.record.keep_runs(Runs::new(content_hash, found));
            self.keep();
        }
    }

    /// Takes the runs that the record has for those that were made here, as far as it has more.
    pub(super) fn learn_runs(&mut self) {
        for runs in &self.review.record.runs {
            self.chance.learn(&runs.content_hash, runs.robustness());
        }
        self.judge();
    }
}
