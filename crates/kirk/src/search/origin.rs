//! What the edges of the search's network rest on, packed into their tags.

use stn::Tag;
use tpn::ArcId;

use crate::ids::LevelId;

/// What an edge of the search's network rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// An arc, which is there by its context.
    Arc(ArcId),
    /// The link or the order that was chosen at a level.
    Level(LevelId),
}

const FIRST_LEVEL: Tag = 1 << 31;

impl Origin {
    pub(crate) fn tag(self) -> Tag {
        match self {
            Self::Arc(arc) => arc.0,
            Self::Level(level) => FIRST_LEVEL + usize::from(level) as Tag,
        }
    }

    pub(crate) fn of(tag: Tag) -> Self {
        match tag {
            FIRST_LEVEL.. => Self::Level(((tag - FIRST_LEVEL) as usize).into()),
            _ => Self::Arc(ArcId(tag)),
        }
    }
}
