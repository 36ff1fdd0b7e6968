//! What the edges of the look-ahead's networks rest on, packed into their tags.

use stn::Tag;
use tpn::{ArcId, LabelId};

use crate::ids::ConsequenceId;

/// What an edge of the network that follows from the choices rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// An arc, which is there by its context.
    Arc(ArcId),
    /// What follows from some choices.
    Consequence(ConsequenceId),
    /// The relaxation of an open choice, which holds whatever is chosen.
    Relaxation,
}

/// The same of the network with guessed links.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum GuideOrigin {
    /// It is part of the other network.
    Known,
    /// The link that is guessed for a requirement.
    Guess(LabelId),
}

const RELAXATION: Tag = 1 << 31;
const FIRST_CONSEQUENCE: Tag = 1 << 30;
const KNOWN: Tag = Tag::MAX;

impl Origin {
    pub(super) fn tag(self) -> Tag {
        match self {
            Self::Arc(arc) => arc.0,
            Self::Consequence(consequence) => FIRST_CONSEQUENCE + usize::from(consequence) as Tag,
            Self::Relaxation => RELAXATION,
        }
    }

    pub(super) fn of(tag: Tag) -> Self {
        match tag {
            RELAXATION => Self::Relaxation,
            FIRST_CONSEQUENCE.. => Self::Consequence(((tag - FIRST_CONSEQUENCE) as usize).into()),
            _ => Self::Arc(ArcId(tag)),
        }
    }
}

impl GuideOrigin {
    pub(super) const fn tag(self) -> Tag {
        match self {
            Self::Known => KNOWN,
            Self::Guess(ask) => ask.0,
        }
    }

    pub(super) const fn of(tag: Tag) -> Self {
        if tag == KNOWN { Self::Known } else { Self::Guess(LabelId(tag)) }
    }
}
