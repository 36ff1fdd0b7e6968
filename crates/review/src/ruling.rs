//! Which flight rules are in force, since which entry, and who has agreed to them (SPEC 16.2).
//!
//! Every trusted person sets flight rules. Rules that weaken the board take effect once people who could complete the
//! board in force have signed the same rules: otherwise one person could set a board that this person alone completes.

use std::collections::BTreeSet;

use super::FlightRules;
use super::check::Check;
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
    /// Which entries follow the last change of the rules; `None` if they have never changed.
    under: Option<Vec<bool>>,
    /// Changes that the board in force has not agreed to, each with the entries that ask for it.
    proposed: Vec<Vec<usize>>,
    /// Entries that set rules to which the board did not agree.
    without_effect: BTreeSet<usize>,
}

impl Ruling {
    /// Of entries in order, with what was found of each.
    pub(super) fn new(entries: &[Entry], checks: &[Check]) -> Self {
        let usual = FlightRules::default();
        let mut ruling = Self::default();
        let (mut in_force, mut digest, mut since) = (&usual, usual.digest(), None);
        for (index, (entry, check)) in entries.iter().zip(checks).enumerate() {
            let Act::Rules { rules } = &entry.act else { continue };
            if !check.counts() {
                continue;
            }
            if rules == in_force {
                // No change: approvals before it are of the same rules.
                if ruling.set_by.is_empty() {
                    (ruling.set_by, ruling.board_by) = (vec![index], vec![index]);
                }
                continue;
            }
            let mut signed = vec![index];
            if seat::weakens(&in_force.board, &rules.board) {
                // Who agreed to leave other rules than these did not agree to leave these.
                if !ruling.set_by.is_empty() && entry.rules != digest {
                    ruling.without_effect.insert(index);
                    continue;
                }
                let same = |indices: &Vec<usize>| rules_of(entries, indices) == Some(rules);
                if let Some(known) = ruling.proposed.iter().position(same) {
                    signed = ruling.proposed.remove(known);
                    signed.push(index);
                }
                if seat::filled(&in_force.board, &keys_of(entries, &signed)) < seat::wanted(&in_force.board) {
                    ruling.without_effect.insert(index);
                    ruling.proposed.push(signed);
                    continue;
                }
            }
            ruling.without_effect.retain(|index| !signed.contains(index));
            if rules.board != in_force.board || ruling.board_by.is_empty() {
                ruling.board_by.clone_from(&signed);
            }
            (in_force, digest, since) = (rules, rules.digest(), Some(index));
            ruling.set_by = signed;
            ruling.proposed.clear();
        }
        ruling.under = since.map(|since| followers(entries, since));
        ruling
    }

    /// Whether an entry follows the last change of the rules.
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
    /// How far the board in force agrees: `1 of 2 approvals of the board in force`.
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

    /// Who set the flight rules in force, and who agreed to them; empty while no one has set any.
    pub fn rules_by(&self) -> Vec<&Entry> {
        self.at(&self.ruling().set_by)
    }

    /// Who set the board in force, and who agreed to it; empty while no one has set any.
    pub fn board_by(&self) -> Vec<&Entry> {
        self.at(&self.ruling().board_by)
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

    /// What was found of an entry, in words, with the reason if it has no effect: `valid`, `unknown key: …`.
    pub fn words_of(&self, entry: &Entry, check: &Check) -> String {
        match self.without_effect(entry) {
            Some(reason) => format!("{}; {reason}", check.words()),
            None => check.words(),
        }
    }

    /// Why an entry that counts has no effect, if it sets flight rules to which the board did not agree.
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
