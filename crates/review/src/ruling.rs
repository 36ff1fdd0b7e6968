//! Which flight rules are in force, since which entry, and who has agreed to them (SPEC 16.2).
//!
//! Every trusted person sets flight rules. Rules that weaken the board take effect once people who could complete the
//! board in force have signed the same rules: otherwise one person could set a board that this person alone completes.
//! If two people set rules without knowing of each other, the stricter board is in force; if neither is stricter, nothing is
//! approved in this history any more.

use std::collections::BTreeSet;

use super::FlightRules;
use super::check::{Check, Signature};
use super::keys::PublicKey;
use super::record::{Act, Entry, Record};
use super::seat;

/// Which entries set the flight rules in force, by their indices.
#[derive(Clone, Debug, Default)]
pub(super) struct Ruling {
    /// Those that set the rules in force: the last one put them into force. Empty while no one has set any.
    set_by: Vec<usize>,
    /// Those that set the board in force, and perhaps other flight rules with it.
    board_by: Vec<usize>,
    /// The first two entries that set rules without knowing of each other, where neither board is at least as strict as the
    /// other. No later entry ends that: an entry that comes before others, by its date, could undo what they agreed to.
    conflicting: Vec<usize>,
    /// Which entries follow the last change of the rules; `None` if they have never changed.
    under: Option<Vec<bool>>,
    /// Changes that the board in force has not agreed to, each with the entries that ask for it.
    proposed: Vec<Vec<usize>>,
    /// Entries that set rules to which the board did not agree.
    without_effect: BTreeSet<usize>,
    /// The digests of rules that are in force, or have been.
    ever_in_force: BTreeSet<String>,
}

/// Rules in force.
struct InForce<'a> {
    rules: &'a FlightRules,
    digest: String,
    set_by: Vec<usize>,
    board_by: Vec<usize>,
    /// The digests of entries that follow the last change to these rules, and of that one; `None` of the usual rules,
    /// which everyone knows.
    followers: Option<BTreeSet<&'a str>>,
}

impl InForce<'_> {
    /// Returns whether the signer of an entry knew these rules.
    fn is_known_to(&self, entry: &Entry) -> bool {
        let follows = |followers: &BTreeSet<&str>| {
            followers.contains(entry.digest())
                || entry.former.iter().any(|former| followers.contains(former.as_str()))
        };
        self.followers.as_ref().is_none_or(follows)
    }
}

/// What an entry that sets rules does to rules in force.
enum Effect {
    /// It replaces them.
    Replaces,
    /// It replaces them if their board agrees.
    Weakens,
    /// Its signer did not know them, and neither board is at least as strict as the other.
    Conflicts,
    /// Its signer did not know them, and they are stricter.
    Nothing,
}

fn effect(entry: &Entry, rules: &FlightRules, before: &InForce<'_>) -> Effect {
    let weakens = seat::weakens(&before.rules.board, &rules.board);
    match (weakens, before.is_known_to(entry)) {
        (false, _) => Effect::Replaces,
        (true, true) => Effect::Weakens,
        (true, false) if seat::weakens(&rules.board, &before.rules.board) => Effect::Conflicts,
        (true, false) => Effect::Nothing,
    }
}

impl Ruling {
    /// Of entries in order, with what was found of each. Everyone chooses the dates of their entries, and what these
    /// follow, so the order decides nothing between entries that do not follow each other: only the stricter board has effect.
    pub(super) fn new(entries: &[Entry], checks: &[Check]) -> Self {
        let usual = FlightRules::default();
        let mut ruling = Self::default();
        let mut in_force = InForce {
            rules: &usual,
            digest: usual.digest(),
            set_by: Vec::new(),
            board_by: Vec::new(),
            followers: None,
        };
        for (index, (entry, check)) in entries.iter().zip(checks).enumerate() {
            if in_force.is_known_to(entry)
                && let Some(followers) = &mut in_force.followers
            {
                followers.insert(entry.digest());
            }
            let Act::Rules { rules } = &entry.act else { continue };
            if check.counts() {
                ruling.add(entries, (index, rules), &mut in_force);
            }
        }
        if in_force.followers.is_some() {
            ruling.under = Some(entries.iter().map(|entry| in_force.is_known_to(entry)).collect());
        } else {
            // Otherwise, anyone could approve by the usual rules what the board has not seen.
            ruling.ever_in_force.insert(in_force.digest);
        }
        (ruling.set_by, ruling.board_by) = (in_force.set_by, in_force.board_by);
        ruling
    }

    /// Takes in an entry that sets rules, after all before it.
    fn add<'a>(
        &mut self,
        entries: &'a [Entry],
        (index, rules): (usize, &'a FlightRules),
        in_force: &mut InForce<'a>,
    ) {
        let entry = &entries[index];
        if in_force.rules == rules {
            // No change: approvals before it are of the same rules.
            if in_force.set_by.is_empty() {
                (in_force.set_by, in_force.board_by) = (vec![index], vec![index]);
            }
            return;
        }
        let mut signed = vec![index];
        match effect(entry, rules, in_force) {
            Effect::Replaces => {}
            Effect::Nothing => {
                self.without_effect.insert(index);
                return;
            }
            Effect::Conflicts => {
                self.without_effect.insert(index);
                if self.conflicting.is_empty() {
                    self.conflicting = in_force.set_by.last().copied().into_iter().chain([index]).collect();
                }
                return;
            }
            Effect::Weakens => {
                // Who agreed to leave other rules than these did not agree to leave these.
                if !in_force.set_by.is_empty() && entry.rules != in_force.digest {
                    self.without_effect.insert(index);
                    return;
                }
                let same = |indices: &Vec<usize>| rules_of(entries, indices) == Some(rules);
                if let Some(known) = self.proposed.iter().position(same) {
                    signed = self.proposed.remove(known);
                    signed.push(index);
                }
                let board = &in_force.rules.board;
                if seat::filled(board, &keys_of(entries, &signed)) < seat::wanted(board) {
                    self.without_effect.insert(index);
                    self.proposed.push(signed);
                    return;
                }
            }
        }
        self.without_effect.retain(|index| !signed.contains(index));
        let keeps_board = in_force.rules.board == rules.board && !in_force.board_by.is_empty();
        let board_by = if keeps_board { in_force.board_by.clone() } else { signed.clone() };
        let (digest, followers) = (rules.digest(), Some(BTreeSet::from([entry.digest()])));
        self.ever_in_force.insert(digest.clone());
        *in_force = InForce { rules, digest, set_by: signed, board_by, followers };
        self.proposed.clear();
    }

    /// Returns whether rules with this digest are in force, or have been.
    pub(super) fn was_in_force(&self, digest: &str) -> bool {
        self.ever_in_force.contains(digest)
    }

    /// Returns whether an entry follows the last change of the rules.
    pub(super) fn is_under(&self, index: usize) -> bool {
        self.under.as_ref().is_none_or(|under| under.get(index) == Some(&true))
    }
}

fn rules_of<'a>(entries: &'a [Entry], indices: &[usize]) -> Option<&'a FlightRules> {
    match &entries.get(*indices.last()?)?.act {
        Act::Rules { rules } => Some(rules),
        _ => None,
    }
}

fn keys_of<'a>(entries: &'a [Entry], indices: &[usize]) -> BTreeSet<&'a PublicKey> {
    indices.iter().filter_map(|&index| entries.get(index)?.key.as_ref()).collect()
}

/// For each entry, whether it is the one at `first`, or was made after it.
pub(super) fn followers(entries: &[Entry], first: usize) -> Vec<bool> {
    let mut digests: BTreeSet<&str> = BTreeSet::new();
    let follows = entries.iter().enumerate().map(|(index, entry)| {
        let follows = index == first || entry.former.iter().any(|former| digests.contains(former.as_str()));
        if follows {
            digests.insert(entry.digest());
        }
        follows
    });
    follows.collect()
}

/// Flight rules that weaken the board, and that the board in force has not agreed to.
#[derive(Clone, Debug)]
pub struct Proposal<'a> {
    /// Who asked for them, and who has agreed, in order.
    pub by: Vec<&'a Entry>,
    pub rules: &'a FlightRules,
    /// How many approvals of the board in force those people could give.
    pub agreed: usize,
    /// How many approvals the board in force needs.
    pub wanted: usize,
}

impl Proposal<'_> {
    /// Returns how far the board in force agrees: `1 of 2 approvals of the board in force`.
    pub fn consent(&self) -> String {
        format!("{} of {} approvals of the board in force", self.agreed, self.wanted)
    }
}

impl Record {
    /// The flight rules that are in force, with who put them into force; `None` while no one has set any.
    pub fn ruled(&self) -> Option<(&Entry, &FlightRules)> {
        let indices = &self.ruling().set_by;
        Some((self.entries().get(*indices.last()?)?, rules_of(self.entries(), indices)?))
    }

    /// Returns who set the flight rules in force, and who agreed to them; empty while no one has set any.
    pub fn rules_by(&self) -> Vec<&Entry> {
        self.at(&self.ruling().set_by)
    }

    /// Returns who set the board in force, and who agreed to it; empty while no one has set any.
    pub fn board_by(&self) -> Vec<&Entry> {
        self.at(&self.ruling().board_by)
    }

    /// Returns the first two entries that set different flight rules without knowing of each other, where neither board is at
    /// least as strict as the other: nothing is approved in this history any more.
    pub fn conflicting_rules(&self) -> Vec<&Entry> {
        self.at(&self.ruling().conflicting)
    }

    /// Returns the last entry that sets flight rules, if all such entries are signed with unknown keys: the usual board is in
    /// force then, which whoever left out the key of the right person may complete.
    pub fn unknown_rules(&self) -> Option<&Entry> {
        let sets_rules = |entry: &Entry| matches!(entry.act, Act::Rules { .. });
        let mut unknown = self
            .checked()
            .filter(|(entry, check)| sets_rules(entry) && check.signature == Signature::Unknown);
        self.ruled().is_none().then(|| unknown.next_back())?.map(|(entry, _)| entry)
    }

    /// Changes of the board that wait for the board in force.
    pub fn proposals(&self) -> Vec<Proposal<'_>> {
        let board = &self.rules().board;
        let proposal = |indices: &Vec<usize>| {
            let rules = rules_of(self.entries(), indices)?;
            let agreed = seat::filled(board, &keys_of(self.entries(), indices));
            Some(Proposal { by: self.at(indices), rules, agreed, wanted: seat::wanted(board) })
        };
        self.ruling().proposed.iter().filter_map(proposal).collect()
    }

    /// Returns what was found of an entry, in words, with the reason if it has no effect: `valid`, `unknown key: …`.
    pub fn words_of(&self, entry: &Entry, check: &Check) -> String {
        match self.without_effect(entry) {
            Some(reason) => format!("{}; {reason}", check.words()),
            None => check.words(),
        }
    }

    /// Returns why an entry that counts has no effect, if it sets flight rules to which the board did not agree.
    pub fn without_effect(&self, entry: &Entry) -> Option<String> {
        let index = self.number(entry.digest()).checked_sub(1)?;
        if !self.ruling().without_effect.contains(&index) {
            return None;
        }
        let mut proposals = self.proposals().into_iter();
        let open = proposals.find(|proposal| proposal.by.iter().any(|it| it.digest() == entry.digest()));
        Some(match open {
            Some(open) => format!("weakens the board, with {}", open.consent()),
            None => "weakened the board, which did not agree".to_owned(),
        })
    }

    fn at(&self, indices: &[usize]) -> Vec<&Entry> {
        indices.iter().filter_map(|&index| self.entries().get(index)).collect()
    }
}
