//! Atoms of which at most one is true at any time, such as the places of one driver: they become the values of one state, so
//! that the planner knows that each excludes the others.
//!
//! A set of atoms is such a group if at most one is true at first, and every action that makes one true takes a true one away,
//! at the same instant or at its start (an invariant of weight one: Helmert 2009, here on objects and with durations).

use std::collections::{BTreeMap, BTreeSet};

use super::ground::{Action, Atom, Conditions, Ground, Snap};

/// An object whose atoms are of more kinds than this has no groups: all sets of kinds are tried.
const MAX_KINDS: usize = 6;

/// Atoms of one object of which at most one is true.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Group {
    pub(super) object: String,
    pub(super) atoms: BTreeSet<Atom>,
}

/// The groups of a task. No atom is in two of them.
#[derive(Debug, Default)]
pub(super) struct Groups {
    pub(super) all: Vec<Group>,
    of: BTreeMap<Atom, usize>,
}

impl Groups {
    pub(super) fn find(ground: &Ground) -> Self {
        let mut groups = Self::default();
        let candidates = candidates(ground);
        let objects: BTreeSet<&str> = candidates
            .iter()
            .flat_map(|atom| ground.atoms.all[*atom][1..].iter().map(String::as_str))
            .collect();
        for object in objects {
            let mut kinds: BTreeMap<(&str, usize), BTreeSet<Atom>> = BTreeMap::new();
            for atom in candidates.iter().filter(|atom| !groups.of.contains_key(atom)) {
                let words = &ground.atoms.all[*atom];
                if let Some(at) = words.iter().skip(1).position(|word| word == object) {
                    kinds.entry((words[0].as_str(), at)).or_default().insert(*atom);
                }
            }
            let kinds: Vec<BTreeSet<Atom>> = kinds.into_values().collect();
            if kinds.len() > MAX_KINDS {
                continue;
            }
            let union = |chosen: u32| -> BTreeSet<Atom> {
                let is_chosen = |(index, _): &(usize, &BTreeSet<Atom>)| (chosen >> index) & 1 == 1;
                kinds
                    .iter()
                    .enumerate()
                    .filter(is_chosen)
                    .flat_map(|(_, kind)| kind.iter().copied())
                    .collect()
            };
            let mut sets: Vec<BTreeSet<Atom>> = (1..1_u32 << kinds.len()).map(union).collect();
            sets.sort_by_key(|set| std::cmp::Reverse(set.len()));
            for atoms in sets {
                let is_new = atoms.iter().all(|atom| !groups.of.contains_key(atom));
                if atoms.len() > 1 && is_new && is_group(ground, &atoms) {
                    groups.of.extend(atoms.iter().map(|atom| (*atom, groups.all.len())));
                    groups.all.push(Group { object: object.to_owned(), atoms });
                }
            }
        }
        groups
    }

    /// The group of an atom.
    pub(super) fn of(&self, atom: Atom) -> Option<usize> {
        self.of.get(&atom).copied()
    }

    /// Returns whether conditions want two atoms of one group.
    pub(super) fn exclude(&self, conditions: &Conditions) -> bool {
        let mut wanted = BTreeSet::new();
        let true_ones = conditions.literals.iter().filter(|(_, value)| **value).map(|(atom, _)| *atom);
        true_ones.filter_map(|atom| self.of(atom)).any(|group| !wanted.insert(group))
    }
}

/// The atoms that actions set, that nothing wants to be false, and that change at no given time.
fn candidates(ground: &Ground) -> BTreeSet<Atom> {
    let snaps = ground.actions.iter().flat_map(Action::snaps);
    let mut found: BTreeSet<Atom> = snaps.flat_map(|snap| snap.sets.keys().copied()).collect();
    let conditions = ground.actions.iter().flat_map(Action::conditions).chain([&ground.goal]);
    for (atom, value) in conditions.flat_map(|conditions| &conditions.literals) {
        if !value {
            found.remove(atom);
        }
    }
    for (_, atom, _) in &ground.timed {
        found.remove(atom);
    }
    found
}

fn is_group(ground: &Ground, atoms: &BTreeSet<Atom>) -> bool {
    ground.initial.intersection(atoms).count() <= 1
        && ground.actions.iter().all(|action| keeps(action, atoms))
}

/// Returns whether an action leaves at most one of the atoms true.
fn keeps(action: &Action, atoms: &BTreeSet<Atom>) -> bool {
    let set = |snap: &Snap, wanted: bool| -> Vec<Atom> {
        let of_group = snap.sets.iter().filter(|(atom, value)| atoms.contains(atom) && **value == wanted);
        of_group.map(|(atom, _)| *atom).collect()
    };
    let is_true = |conditions: &Conditions, atom: &Atom| conditions.literals.get(atom) == Some(&true);
    let (added_first, taken_first) = (set(&action.start, true), set(&action.start, false));
    let (added_last, taken_last) = (set(&action.end, true), set(&action.end, false));
    // What is taken away is known to be true: otherwise another one would be lost.
    let takes_true_ones = taken_first.iter().all(|atom| is_true(&action.start.conditions, atom))
        && taken_last
            .iter()
            .all(|atom| is_true(&action.end.conditions, atom) || is_true(&action.throughout, atom));
    let stays = |conditions: &Conditions, added: &[Atom]| added.iter().all(|atom| is_true(conditions, atom));
    let starts_well =
        added_first.is_empty() || !taken_first.is_empty() || stays(&action.start.conditions, &added_first);
    let is_reserved = !taken_first.is_empty() && added_first.is_empty();
    let ends_well = added_last.is_empty()
        || !taken_last.is_empty()
        || is_reserved
        || stays(&action.end.conditions, &added_last);
    takes_true_ones && added_first.len() <= 1 && added_last.len() <= 1 && starts_well && ends_well
}
