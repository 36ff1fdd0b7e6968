//! Which flight rules are in force, since which entry, and who has agreed to them (SPEC 16.2).
//!
//! Every trusted person sets flight rules. Rules that weaken the board take effect once people who could complete the
//! board in force have signed the same rules: otherwise one person could set a board that this person alone completes.
//! If two people set rules without knowing of each other, the stricter board is in force; if neither is stricter, both are,
//! and nothing is approved until both boards agree to the same rules.

use std::collections::{BTreeMap, BTreeSet};

use super::FlightRules;
use super::check::{Check, Signature};
use super::keys::PublicKey;
use super::names;
use super::record::{Act, Entry, Record, USUAL_RULES};
use super::seat::{self, Seat};

/// Rules that may be in force at the same time. If more conflict, nothing is approved in this history any more.
const MAX_IN_FORCE: usize = 8;

/// Which flight rules a history has, by the indices of its entries.
#[derive(Clone, Debug, Default)]
pub(super) struct Ruling {
    /// The rules in force: one, or several that conflict. Empty only before a history was read.
    in_force: Vec<InForce>,
    /// Which entries follow the last change of the rules; `None` if they have never changed.
    under: Option<Vec<bool>>,
    /// Entries that set rules without effect.
    without_effect: BTreeSet<usize>,
    /// Those of them whose signers did not know stricter rules.
    unaware: BTreeSet<usize>,
    /// Whether each entry names rules that were in force then, and that its signer knew.
    under_own: Vec<bool>,
}

/// Rules in force.
#[derive(Clone, Debug)]
struct InForce {
    /// An entry that sets these rules; `None` of the usual rules if no one has set them.
    at: Option<usize>,
    digest: String,
    /// Entries that set them: the last one put them into force.
    set_by: Vec<usize>,
    /// Entries that set their board, perhaps with other flight rules.
    board_by: Vec<usize>,
    /// Which of the entries so far follow the last change to these rules, or are that change; `None` of the usual rules,
    /// which everyone knows.
    followers: Option<Vec<bool>>,
    /// Rules that weaken the board, by their digests.
    proposed: BTreeMap<String, Proposed>,
}

/// Rules that wait for the board.
#[derive(Clone, Debug, Default)]
struct Proposed {
    /// The first entry of each person who signed them.
    by: Vec<usize>,
    people: BTreeSet<PublicKey>,
    /// Later entries of the same people.
    again: BTreeSet<usize>,
}

/// What an entry that sets rules does to rules in force.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Effect {
    /// It sets the same rules.
    Keeps,
    /// It replaces them.
    Replaces,
    /// It replaces them if their board agrees.
    Weakens,
    /// Its signer did not know them, and neither board is at least as strict as the other.
    Conflicts,
    /// Its signer did not know them, and they are stricter.
    Nothing,
}

/// A history whose rules are looked at, entry by entry.
struct Entries<'a> {
    entries: &'a [Entry],
    /// Where each entry is, by its digest.
    indices: BTreeMap<&'a str, usize>,
}

impl<'a> Entries<'a> {
    fn new(entries: &'a [Entry]) -> Self {
        let indices = entries.iter().enumerate().map(|(index, entry)| (entry.digest(), index)).collect();
        Self { entries, indices }
    }

    /// Returns whether an entry was made after one that is marked.
    fn follows(&self, index: usize, marked: &[bool]) -> bool {
        let mut former = self.entries[index].former.iter().filter_map(|it| self.indices.get(it.as_str()));
        former.any(|&former| marked.get(former) == Some(&true))
    }

    fn rules(&self, in_force: &InForce) -> &'a FlightRules {
        in_force.at.and_then(|index| rules_of(&self.entries[index])).unwrap_or(&USUAL_RULES)
    }

    /// Returns what the entry at `index`, which sets `rules` with this digest, does to rules in force.
    fn effect(&self, index: usize, (rules, digest): (&FlightRules, &str), before: &InForce) -> Effect {
        let (board, new) = (&self.rules(before).board, &rules.board);
        if before.digest == digest {
            Effect::Keeps
        } else if !seat::weakens(board, new) {
            Effect::Replaces
        } else if before.is_known_to(index, &self.entries[index]) {
            Effect::Weakens
        } else if seat::weakens(new, board) {
            Effect::Conflicts
        } else {
            Effect::Nothing
        }
    }
}

impl InForce {
    fn new(at: Option<usize>, digest: String, set_by: Vec<usize>, num_before: usize) -> Self {
        // Only the entry that set the rules follows them so far.
        let followers = at.map(|_| {
            let mut followers = vec![false; num_before];
            followers.push(true);
            followers
        });
        let board_by = set_by.clone();
        Self { at, digest, set_by, board_by, followers, proposed: BTreeMap::new() }
    }

    /// Returns whether the signer of an entry knew these rules: it follows them, and names them. What it follows does not
    /// suffice, because everyone chooses that.
    fn is_known_to(&self, index: usize, entry: &Entry) -> bool {
        let is_known =
            |followers: &Vec<bool>| followers[index] && entry.rules.split(' ').any(|it| it == self.digest);
        self.followers.as_ref().is_none_or(is_known)
    }
}

impl Ruling {
    /// Of entries in order, with what was found of each. Everyone chooses the dates of their entries, and what these
    /// follow, so the order decides nothing between entries that do not follow each other: only the stricter board has effect.
    pub(super) fn new(entries: &[Entry], checks: &[Check]) -> Self {
        let usual = InForce::new(None, USUAL_RULES.digest(), Vec::new(), 0);
        let mut ruling = Self { in_force: vec![usual], ..Self::default() };
        let all = Entries::new(entries);
        for (index, (entry, check)) in entries.iter().zip(checks).enumerate() {
            for in_force in &mut ruling.in_force {
                if let Some(followers) = &mut in_force.followers {
                    let follows = all.follows(index, followers);
                    followers.push(follows);
                }
            }
            ruling.under_own.push(ruling.in_force.iter().any(|it| {
                let follows = it.followers.as_ref().is_none_or(|followers| followers[index]);
                it.digest == entry.rules && follows
            }));
            if let Some(rules) = rules_of(entry).filter(|_| check.counts()) {
                ruling.add(&all, index, rules);
            }
        }
        ruling.under = ruling.in_force.last().and_then(|it| it.followers.clone());
        ruling
    }

    /// Takes in an entry that sets rules, after all before it.
    fn add(&mut self, all: &Entries<'_>, index: usize, rules: &FlightRules) {
        let digest = rules.digest();
        let effects: Vec<Effect> =
            self.in_force.iter().map(|before| all.effect(index, (rules, &digest), before)).collect();
        if let ([Effect::Keeps], [only]) = (effects.as_slice(), self.in_force.as_mut_slice()) {
            // No change: approvals before it are of the same rules.
            if only.set_by.is_empty() {
                (only.at, only.set_by, only.board_by) = (Some(index), vec![index], vec![index]);
            }
            return;
        }
        if effects.contains(&Effect::Nothing) || self.in_force.len() > MAX_IN_FORCE {
            self.without_effect.insert(index);
            self.unaware.insert(index);
            return;
        }
        let mut signed = vec![index];
        let mut is_agreed = true;
        let weakened =
            self.in_force.iter_mut().zip(&effects).filter(|(_, effect)| **effect == Effect::Weakens);
        for (before, _) in weakened {
            let board = &all.rules(before).board;
            let proposed = before.proposed.entry(digest.clone()).or_default();
            let is_new = all.entries[index].key.clone().is_some_and(|key| proposed.people.insert(key));
            if is_new {
                proposed.by.push(index);
            } else {
                proposed.again.insert(index);
            }
            is_agreed &= seat::filled(board, &proposed.people.iter().collect()) >= seat::wanted(board);
            signed.clone_from(&proposed.by);
        }
        if !is_agreed {
            self.without_effect.insert(index);
            return;
        }
        for proposed in self.in_force.iter().filter_map(|before| before.proposed.get(&digest)) {
            for index in proposed.by.iter().chain(&proposed.again) {
                self.without_effect.remove(index);
            }
        }
        if effects.contains(&Effect::Keeps)
            && effects.iter().all(|it| matches!(it, Effect::Keeps | Effect::Conflicts))
        {
            return;
        }
        let mut new = InForce::new(Some(index), digest.clone(), signed, index);
        let replaced = self.in_force.iter().zip(&effects).filter(|(_, effect)| **effect != Effect::Conflicts);
        let same = |before: &&InForce| !before.board_by.is_empty() && all.rules(before).board == rules.board;
        if let Some(before) = replaced.map(|(before, _)| before).find(same) {
            new.board_by.clone_from(&before.board_by);
        }
        let mut effects = effects.iter();
        self.in_force.retain(|_| effects.next() == Some(&Effect::Conflicts));
        self.in_force.push(new);
    }

    /// Returns whether the rules that an entry names were in force then, and its signer knew them.
    pub(super) fn was_under_own(&self, index: usize) -> bool {
        self.under_own.get(index) == Some(&true)
    }

    /// Returns whether an entry follows the last change of the rules.
    pub(super) fn is_under(&self, index: usize) -> bool {
        self.under.as_ref().is_none_or(|under| under.get(index) == Some(&true))
    }

    /// Returns what an entry signs as the rules that its signer knows: the digests of all that are in force.
    pub(super) fn digests(&self) -> String {
        let digests: Vec<&str> = self.in_force.iter().map(|it| it.digest.as_str()).collect();
        if digests.is_empty() { USUAL_RULES.digest() } else { digests.join(" ") }
    }
}

fn rules_of(entry: &Entry) -> Option<&FlightRules> {
    match &entry.act {
        Act::Rules { rules } => Some(rules),
        _ => None,
    }
}

/// For each entry, whether it is the one at `first`, or was made after it.
pub(super) fn followers(entries: &[Entry], first: usize) -> Vec<bool> {
    let all = Entries::new(entries);
    let mut marked = Vec::with_capacity(entries.len());
    for index in 0..entries.len() {
        marked.push(index == first || all.follows(index, &marked));
    }
    marked
}

/// The bit that many entries with unknown keys share.
const LAST_BIT: u128 = 1 << 127;

/// Flight rules that an unknown key has set.
struct Unsettled<'a> {
    entry: &'a Entry,
    board: &'a [Seat],
    bit: u128,
}

/// Flight rules that weaken the board, and that the board in force has not agreed to.
#[derive(Clone, Debug)]
pub struct Proposal<'a> {
    /// Who asked for them, and who has agreed, in order.
    pub by: Vec<&'a Entry>,
    pub rules: &'a FlightRules,
    /// Who set the board that has to agree, if several are in force.
    pub of: Option<&'a str>,
    /// How many approvals of that board those people could give.
    pub agreed: usize,
    /// How many approvals that board needs.
    pub wanted: usize,
}

impl Proposal<'_> {
    /// Returns how far the board in force agrees: `1 of 2 approvals of the board in force`.
    pub fn consent(&self) -> String {
        let board = match self.of {
            None => "the board in force".to_owned(),
            Some(by) => format!("the board that {} set", names::one_line(by)),
        };
        format!("{} of {} approvals of {board}", self.agreed, self.wanted)
    }
}

impl Record {
    /// The flight rules that are in force, with who put them into force; `None` while no one has set any.
    pub fn ruled(&self) -> Option<(&Entry, &FlightRules)> {
        let entry = self.entries().get(*self.ruling().in_force.last()?.set_by.last()?)?;
        Some((entry, rules_of(entry)?))
    }

    /// Returns who set the flight rules in force, and who agreed to them; empty while no one has set any.
    pub fn rules_by(&self) -> Vec<&Entry> {
        self.ruling().in_force.last().map_or_else(Vec::new, |in_force| self.at(&in_force.set_by))
    }

    /// Returns who set the board in force, and who agreed to it; empty while no one has set any.
    pub fn board_by(&self) -> Vec<&Entry> {
        self.ruling().in_force.last().map_or_else(Vec::new, |in_force| self.at(&in_force.board_by))
    }

    /// Returns the entries that put different flight rules into force without knowing of each other, where neither board is at
    /// least as strict as the other: nothing is approved until both boards agree to the same rules.
    pub fn conflicting_rules(&self) -> Vec<&Entry> {
        let [_, _, ..] = self.ruling().in_force.as_slice() else { return Vec::new() };
        let last: Vec<usize> =
            self.ruling().in_force.iter().filter_map(|in_force| in_force.set_by.last().copied()).collect();
        self.at(&last)
    }

    /// Returns the last entry that sets flight rules with an unknown key, until someone who has seen it settles it: the owner of
    /// this copy, with any rules, or a trusted person with a board that is not weaker. Otherwise, a reader who lacks the key
    /// of the right person would get a weaker board.
    pub fn unknown_rules(&self) -> Option<&Entry> {
        let mut unknown: Vec<Unsettled<'_>> = Vec::new();
        // Which of the entries with unknown keys each entry follows, by their bits.
        let mut known: Vec<u128> = Vec::with_capacity(self.entries().len());
        let mut bit = 1;
        for (entry, check) in self.checked() {
            let former = entry.former.iter().filter_map(|former| self.number(former).checked_sub(1));
            let mut follows = former.filter_map(|former| known.get(former)).fold(0, |all, bits| all | bits);
            if let Some(rules) = rules_of(entry) {
                if check.signature == Signature::Unknown && check.problem.is_none() {
                    unknown.push(Unsettled { entry, board: &rules.board, bit });
                    follows |= bit;
                    // All others share the last one.
                    bit = bit.checked_shl(1).filter(|bit| *bit != 0).unwrap_or(LAST_BIT);
                } else if check.counts() {
                    let is_own = entry.key.as_ref().is_some_and(|key| self.trust().is_own(key));
                    unknown.retain(|it| {
                        let is_known = follows & it.bit != 0 && (is_own || it.bit != LAST_BIT);
                        !is_known || (!is_own && seat::weakens(it.board, &rules.board))
                    });
                }
            }
            known.push(follows);
        }
        unknown.last().filter(|_| !self.has_required_rules()).map(|it| it.entry)
    }

    /// Returns whether one set of flight rules is in force, and no unknown key has set others since.
    pub fn has_settled_rules(&self) -> bool {
        self.ruling().in_force.len() <= 1 && self.unknown_rules().is_none()
    }

    /// Changes of the board that wait for the board in force.
    pub fn proposals(&self) -> Vec<Proposal<'_>> {
        let proposals = self.ruling().in_force.iter().flat_map(|in_force| {
            in_force.proposed.values().filter_map(|proposed| self.proposal(in_force, proposed))
        });
        let mut proposals: Vec<Proposal<'_>> = proposals.collect();
        proposals.sort_by_key(|proposal| proposal.by.first().map(|entry| self.number(entry.digest())));
        proposals
    }

    fn proposal(&self, in_force: &InForce, proposed: &Proposed) -> Option<Proposal<'_>> {
        let by = self.at(&proposed.by);
        let rules = rules_of(by.first()?)?;
        let board = in_force.at.and_then(|index| rules_of(self.entries().get(index)?));
        let board = &board.unwrap_or(&USUAL_RULES).board;
        let agreed = seat::filled(board, &proposed.people.iter().collect());
        let is_one_of_several = self.ruling().in_force.len() > 1;
        let of = in_force.set_by.last().filter(|_| is_one_of_several);
        let of = of.and_then(|&index| Some(self.entries().get(index)?.by.as_str()));
        Some(Proposal { by, rules, of, agreed, wanted: seat::wanted(board) })
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
        let in_force = &self.ruling().in_force;
        if in_force.len() > 1 && in_force.iter().any(|it| it.set_by.last() == Some(&index)) {
            return Some("conflicts with other flight rules".to_owned());
        }
        if !self.ruling().without_effect.contains(&index) {
            return None;
        }
        let digest = rules_of(entry)?.digest();
        let open = in_force.iter().find_map(|it| Some((it, it.proposed.get(&digest)?)));
        let open =
            open.filter(|(_, proposed)| proposed.by.contains(&index) || proposed.again.contains(&index));
        Some(match open.and_then(|(in_force, proposed)| self.proposal(in_force, proposed)) {
            Some(open) => format!("weakens the board, with {}", open.consent()),
            None if self.ruling().unaware.contains(&index) => {
                "was set without knowing of stricter rules".to_owned()
            }
            None => "weakened the board, which did not agree".to_owned(),
        })
    }

    fn at(&self, indices: &[usize]) -> Vec<&Entry> {
        indices.iter().filter_map(|&index| self.entries().get(index)).collect()
    }
}

#[cfg(test)]
mod random_tests;
