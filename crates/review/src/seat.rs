//! The board of a review: the roles that have to approve.

use std::collections::BTreeSet;

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

    /// Whether the owner of a key approves in this role.
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

/// What is wrong with a board, if something is.
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
