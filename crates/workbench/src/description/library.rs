//! The user's missions, as host pages see them.

use serde::Serialize;
#[cfg(test)]
use ts_rs::TS;

use crate::library::{Keeping, MissionKind};
use crate::state::AppState;

/// The missions that the user has.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Library {
    /// The id of the open mission; `null` for an original that no one has edited.
    pub open: Option<String>,
    /// The missions without the deleted ones, the last changed one first.
    pub missions: Vec<KeptMission>,
    /// How many deleted missions can be restored.
    pub deleted: usize,
    /// How many saved items are unreadable.
    pub unreadable: usize,
    /// Whether missions are saved beyond the end of this run.
    #[cfg_attr(test, ts(type = "\"opening\" | \"kept\" | \"until-closed\" | \"latest-only\" | \"nothing\""))]
    pub keeping: &'static str,
}

/// A mission of the library.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct KeptMission {
    pub id: String,
    pub name: String,
    #[cfg_attr(test, ts(type = "\"own\" | \"example\" | \"lesson\" | \"shared\" | \"file\""))]
    pub kind: MissionKind,
    /// In milliseconds since 1970, UTC.
    #[cfg_attr(test, ts(type = "number"))]
    pub created: i64,
    /// In milliseconds since 1970, UTC.
    #[cfg_attr(test, ts(type = "number"))]
    pub changed: i64,
    /// The names of its texts, the main one first.
    pub texts: Vec<String>,
    /// The names of its maps.
    pub maps: Vec<String>,
    /// The names of its versions, the oldest first.
    pub versions: Vec<String>,
}

pub(super) fn library(state: &AppState) -> Library {
    let library = &state.library;
    let missions = library.missions().into_iter().map(|mission| KeptMission {
        id: mission.id.0.to_string(),
        name: mission.name.to_string(),
        kind: mission.kind,
        created: mission.created_millis,
        changed: mission.changed_millis,
        texts: mission.texts.iter().map(|file| file.name.to_string()).collect(),
        maps: mission.maps.iter().map(|map| map.name.to_string()).collect(),
        versions: mission.versions.iter().map(|version| version.name.clone()).collect(),
    });
    Library {
        open: library.open_id().map(|id| id.0.to_string()),
        missions: missions.collect(),
        deleted: library.deleted().len(),
        unreadable: library.unreadable.len(),
        keeping: match library.keeping {
            Keeping::Opening => "opening",
            Keeping::Kept => "kept",
            Keeping::UntilClosed => "until-closed",
            Keeping::LatestOnly(_) => "latest-only",
            Keeping::Nothing(_) => "nothing",
        },
    }
}
