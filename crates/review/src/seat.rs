//! The board of a review: the roles that have to approve.

use std::collections::BTreeSet;
use std::iter;

use serde::{Deserialize, Serialize};

use super::keys::PublicKey;
use super::names;

/// A role of the board.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Seat {
    /// What it is called.
    pub role: String,
    /// How many people in this role have to approve.
    pub approvals: u32,
    /// The keys whose approvals count in this role; if there are none, every trusted key.
    #[serde(default)]
    pub people: Vec<PublicKey>,
}

impl Seat {
    /// A role in which every trusted key can approve.
    pub fn new(role: &str, approvals: u32) -> Self {
        Self { role: role.to_owned(), approvals, people: Vec::new() }
    }

    /// Returns whether the owner of a key approves in this role.
    pub fn admits(&self, key: &PublicKey) -> bool {
        self.people.is_empty() || self.people.contains(key)
    }
}

/// The role of a board that no one has set up.
pub const DEFAULT_ROLE: &str = "Reviewer";

/// Roles that a board has, at most.
pub const MAX_SEATS: usize = 12;

/// Approvals that a role needs, at most.
pub const MAX_APPROVALS: u32 = 9;

/// The board that no one has set up: one reviewer.
pub(super) fn default_board() -> Vec<Seat> {
    vec![Seat::new(DEFAULT_ROLE, 1)]
}

/// Returns whether a board is weaker than another one: a role is missing, needs fewer approvals, or admits more people.
pub(super) fn weakens(before: &[Seat], after: &[Seat]) -> bool {
    let keeps = |seat: &Seat| {
        after.iter().any(|new| {
            let admits_no_others = seat.people.is_empty()
                || (!new.people.is_empty() && new.people.iter().all(|key| seat.admits(key)));
            new.role == seat.role && new.approvals >= seat.approvals && admits_no_others
        })
    };
    !before.iter().all(keeps)
}

/// Returns how many approvals a board needs.
pub(super) fn wanted(board: &[Seat]) -> usize {
    board.iter().map(|seat| seat.approvals as usize).sum()
}

/// Returns how many approvals of a board these people could give at most, each of them one.
pub(super) fn filled(board: &[Seat], people: &BTreeSet<&PublicKey>) -> usize {
    let places: Vec<&Seat> =
        board.iter().flat_map(|seat| iter::repeat_n(seat, seat.approvals as usize)).collect();
    let mut taken: Vec<Option<&PublicKey>> = vec![None; places.len()];
    people.iter().filter(|key| seats_one(&places, &mut taken, &mut BTreeSet::new(), key)).count()
}

/// Finds a place for a person, perhaps by moving others (a maximum matching by augmenting paths).
fn seats_one<'a>(
    places: &[&Seat],
    taken: &mut [Option<&'a PublicKey>],
    seen: &mut BTreeSet<usize>,
    key: &'a PublicKey,
) -> bool {
    for (place, seat) in places.iter().enumerate() {
        if !seat.admits(key) || !seen.insert(place) {
            continue;
        }
        let is_free = match taken[place] {
            None => true,
            Some(other) => seats_one(places, taken, seen, other),
        };
        if is_free {
            taken[place] = Some(key);
            return true;
        }
    }
    false
}

/// Returns what is wrong with a board, if something is.
pub(super) fn problem(board: &[Seat]) -> Option<&'static str> {
    let are_alike = |(index, seat): (usize, &Seat)| {
        board[..index].iter().any(|other| names::are_alike(&seat.role, &other.role))
    };
    match board {
        [] => Some("someone must approve"),
        _ if board.len() > MAX_SEATS => Some("a board has at most 12 roles"),
        _ if board.iter().any(|seat| seat.role.trim().is_empty()) => Some("every role needs a name"),
        _ if board.iter().any(|seat| names::problem(&seat.role).is_some()) => {
            Some("a role's name must have visible letters, of one script in each word")
        }
        _ if board.iter().enumerate().any(are_alike) => {
            Some("the names of two roles must differ in more than case, accents, spaces or signs")
        }
        _ if board.iter().any(|seat| !(1..=MAX_APPROVALS).contains(&seat.approvals)) => {
            Some("a role needs 1 to 9 approvals")
        }
        _ if board.iter().any(has_too_few_people) => {
            Some("a role must name each person once, and at least as many people as it needs approvals")
        }
        _ => None,
    }
}

fn has_too_few_people(seat: &Seat) -> bool {
    let people: BTreeSet<&PublicKey> = seat.people.iter().collect();
    people.len() < seat.people.len() || (1..seat.approvals as usize).contains(&people.len())
}

#[cfg(test)]
mod tests {
    use super::super::record_tests::key;
    use super::*;

    fn named(role: &str, approvals: u32, people: &[&str]) -> Seat {
        let people = people.iter().map(|name| key(name).public()).collect();
        Seat { people, ..Seat::new(role, approvals) }
    }

    #[test]
    fn a_board_is_weaker_if_a_role_is_missing_needs_less_or_admits_more() {
        let before = [named("Science", 2, &[]), named("Safety", 1, &["Grace", "Ada"])];
        let with = |science: Seat, safety: Seat| weakens(&before, &[science, safety]);
        let (science, safety) = (before[0].clone(), before[1].clone());
        assert!(!with(science.clone(), safety.clone()));
        assert!(!weakens(&before, &[safety.clone(), named("Press", 1, &[]), science.clone()]));
        assert!(!with(named("Science", 3, &["Ada", "Grace", "Eve"]), named("Safety", 1, &["Grace"])));
        assert!(with(named("Science", 1, &[]), safety.clone()));
        assert!(with(named("Press", 2, &[]), safety));
        assert!(with(science.clone(), named("Safety", 1, &[])));
        assert!(with(science, named("Safety", 1, &["Grace", "Eve"])));
    }

    #[test]
    fn each_person_gives_one_approval_in_a_role_that_admits_that_person() {
        let board = [named("Science", 2, &[]), named("Safety", 1, &["Grace"])];
        let filled_by = |names: &[&str]| {
            let keys: Vec<PublicKey> = names.iter().map(|name| key(name).public()).collect();
            filled(&board, &keys.iter().collect())
        };
        assert_eq!(wanted(&board), 3);
        assert_eq!(filled_by(&["Ada", "Chair", "Eve"]), 2);
        // In either order, Grace takes the place that only she may take.
        for names in [["Grace", "Ada", "Chair"], ["Ada", "Chair", "Grace"]] {
            assert_eq!(filled_by(&names), 3, "{names:?}");
        }
    }
}
