//! The board of a review: the roles that have to approve.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

/// A role of the board.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Seat {
    /// What it is called.
    pub role: String,
    /// How many people in this role have to approve.
    pub approvals: u32,
}

/// The role of a board that nobody has set up.
pub const DEFAULT_ROLE: &str = "Reviewer";

/// Roles that a board has, at most.
pub const MAX_SEATS: usize = 12;

/// Approvals that a role needs, at most.
pub const MAX_APPROVALS: u32 = 9;

/// The board that nobody has set up: one reviewer.
pub(super) fn default_board() -> Vec<Seat> {
    vec![Seat { role: DEFAULT_ROLE.to_owned(), approvals: 1 }]
}

/// What is wrong with a board, if something is.
pub(super) fn problem(board: &[Seat]) -> Option<&'static str> {
    let roles: BTreeSet<&str> = board.iter().map(|seat| seat.role.trim()).collect();
    match board {
        [] => Some("someone must approve"),
        _ if board.len() > MAX_SEATS => Some("a board has at most 12 roles"),
        _ if roles.contains("") => Some("a role has a name"),
        _ if roles.len() < board.len() => Some("each role has a name of its own"),
        _ if board.iter().any(|seat| !(1..=MAX_APPROVALS).contains(&seat.approvals)) => {
            Some("a role needs 1 to 9 approvals")
        }
        _ => None,
    }
}
