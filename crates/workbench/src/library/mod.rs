//! The library: the missions that a user has, and what is done with them. It knows no storage: what must be kept
//! it leaves behind as changes.
//!
//! Examples, and what links hold, are not missions of the library until they are edited: then a copy of its own begins,
//! and the original stays what it was.

mod base64;
mod command;
mod mission;
mod picture;
mod template;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use smol_str::{SmolStr, format_smolstr};
use text_editing::Document;

pub use command::LibraryCommand;
pub use mission::{
    FORMAT, MAIN_TEXT, MapFile, Mission, MissionError, MissionId, MissionKind, SavedLayout, TextFile, Version,
};
pub(crate) use mission::{joined, print};
pub use picture::picture;
pub use template::{TEMPLATES, Template, template};

use mission::split;

/// What the user has open.
#[derive(Clone, Debug, PartialEq)]
pub enum Open {
    /// A text that is not a mission of the library unless it is edited.
    Original {
        /// What its copy will be.
        kind: MissionKind,
        /// The text as it came.
        source: Arc<str>,
    },
    /// A mission of the library.
    Mission(MissionId),
}

/// Something that must be kept, or need not be any more.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Change {
    /// This mission is new, or something of it was changed.
    Kept(MissionId),
    /// The text of this mission was changed.
    Typed(MissionId),
    /// This mission has another map of this name.
    Map(MissionId, SmolStr),
    /// This mission was thrown away for good.
    Dropped(MissionId),
}

/// How keeping goes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Keeping {
    /// The missions of earlier runs are still being read.
    #[default]
    Opening,
    /// Everything is kept.
    Kept,
    /// Everything is kept until the window is closed: it is a private one.
    UntilClosed,
    /// Only the latest text is kept, in a small place beside; the reason.
    LatestOnly(String),
    /// Nothing is kept beyond the end of this run; the reason.
    Nothing(String),
}

/// Something that was kept and cannot be read. It stays where it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unreadable {
    /// The key under which it is kept.
    pub key: String,
    /// Why it cannot be read.
    pub reason: String,
    /// What is kept there.
    pub bytes: Arc<[u8]>,
}

/// The user's missions, and which of them is open.
#[derive(Debug)]
pub struct Library {
    missions: Vec<Mission>,
    open: Open,
    changes: BTreeSet<Change>,
    /// How keeping goes.
    pub keeping: Keeping,
    /// What cannot be read.
    pub unreadable: Vec<Unreadable>,
    /// The texts of other missions that were open in this run, with their histories.
    pub(crate) set_aside: BTreeMap<MissionId, Document>,
    seed: u64,
    count: u64,
}

/// Versions that a mission has at most; the oldest goes first.
const MAX_VERSIONS: usize = 100;

/// A deleted mission can be brought back for so long.
const DELETED_MILLIS: i64 = 30 * 24 * 3600 * 1000;

impl Library {
    /// An empty library with an original open.
    pub fn new(kind: MissionKind, source: &str) -> Self {
        Self {
            missions: Vec::new(),
            open: Open::Original { kind, source: source.into() },
            changes: BTreeSet::new(),
            keeping: Keeping::default(),
            unreadable: Vec::new(),
            set_aside: BTreeMap::new(),
            seed: 0,
            count: 0,
        }
    }

    /// Makes the ids of this run differ from those of all others; `seed` is a random number.
    pub fn seed_ids(&mut self, seed: u64) {
        self.seed = seed;
    }

    /// The missions that are not deleted, those changed last first.
    pub fn missions(&self) -> Vec<&Mission> {
        let mut missions: Vec<&Mission> =
            self.missions.iter().filter(|it| it.deleted_millis.is_none()).collect();
        missions.sort_by(|a, b| b.changed_millis.cmp(&a.changed_millis).then_with(|| a.id.cmp(&b.id)));
        missions
    }

    /// The missions that were deleted and can be brought back, the last one first.
    pub fn deleted(&self) -> Vec<&Mission> {
        let mut missions: Vec<&Mission> =
            self.missions.iter().filter(|it| it.deleted_millis.is_some()).collect();
        missions.sort_by_key(|it| std::cmp::Reverse(it.deleted_millis));
        missions
    }

    /// The mission of this id, deleted or not.
    pub fn mission(&self, id: &MissionId) -> Option<&Mission> {
        self.missions.iter().find(|mission| mission.id == *id)
    }

    fn mission_mut(&mut self, id: &MissionId) -> Option<&mut Mission> {
        self.missions.iter_mut().find(|mission| mission.id == *id)
    }

    /// Returns what the user has open.
    pub fn open(&self) -> &Open {
        &self.open
    }

    /// The id of the open mission, if it is one of the library.
    pub fn open_id(&self) -> Option<&MissionId> {
        match &self.open {
            Open::Mission(id) => Some(id),
            Open::Original { .. } => None,
        }
    }

    /// The open mission, if it is one of the library.
    pub fn open_mission(&self) -> Option<&Mission> {
        self.mission(self.open_id()?)
    }

    /// An original is open from here on.
    pub fn show_original(&mut self, kind: MissionKind, source: &str) {
        self.open = Open::Original { kind, source: source.into() };
    }

    /// A mission is open from here on. Returns whether there is such a mission; one that was deleted is brought back.
    pub fn show(&mut self, id: &MissionId) -> bool {
        if self.mission(id).is_none() {
            return false;
        }
        self.restore(id);
        self.open = Open::Mission(id.clone());
        true
    }

    /// Begins a mission; it is not opened.
    pub fn add(&mut self, name: &str, kind: MissionKind, text: &str, now_millis: i64) -> MissionId {
        let id = self.fresh_id();
        let mission = Mission {
            id: id.clone(),
            name: self.free_name(name),
            kind,
            created_millis: now_millis,
            changed_millis: now_millis,
            deleted_millis: None,
            texts: split(text, MAIN_TEXT),
            maps: Vec::new(),
            versions: Vec::new(),
            review: None,
            picture: Vec::new(),
            layouts: Vec::new(),
        };
        self.missions.push(mission);
        self.changes.insert(Change::Kept(id.clone()));
        id
    }

    /// Adds a mission that came as a file, as one of its own even if the library has one with its id.
    pub fn add_from_file(&mut self, mission: Mission, now_millis: i64) -> MissionId {
        let id = self.fresh_id();
        let name = self.free_name(&mission.name);
        for map in &mission.maps {
            self.changes.insert(Change::Map(id.clone(), map.name.clone()));
        }
        self.missions.push(Mission {
            id: id.clone(),
            name,
            kind: MissionKind::File,
            changed_millis: now_millis,
            deleted_millis: None,
            review: None,
            ..mission
        });
        self.changes.insert(Change::Kept(id.clone()));
        id
    }

    /// The open text says this now. An original that says something else than it did becomes a mission of its own,
    /// called like `name`. Returns whether it became one now.
    pub fn edited(&mut self, name: &str, text: &str, now_millis: i64) -> bool {
        match &self.open {
            Open::Original { source, .. } if **source == *text => false,
            Open::Original { kind, .. } => {
                let kind = *kind;
                let name =
                    if kind == MissionKind::Example { format!("{name} (copy)") } else { name.to_owned() };
                let id = self.add(&name, kind, text, now_millis);
                self.open = Open::Mission(id);
                true
            }
            Open::Mission(id) => {
                let id = id.clone();
                if let Some(mission) = self.mission_mut(&id)
                    && !mission.says(text)
                {
                    mission.say(text);
                    mission.changed_millis = now_millis.max(mission.changed_millis + 1);
                    self.changes.insert(Change::Typed(id));
                }
                false
            }
        }
    }

    /// Gives a mission another name; an empty one changes nothing.
    pub fn rename(&mut self, id: &MissionId, name: &str, now_millis: i64) {
        let name = name.trim();
        if let Some(mission) = self.mission_mut(id)
            && !name.is_empty()
            && mission.name != name
        {
            mission.name = name.into();
            self.touch(id, now_millis);
        }
    }

    /// A mission that is like this one, with versions and maps.
    pub fn duplicate(&mut self, id: &MissionId, now_millis: i64) -> Option<MissionId> {
        let original = self.mission(id)?.clone();
        let copy = self.fresh_id();
        let stem = stem_of_copy(&original.name).unwrap_or(&original.name);
        let name = self.free_name(&format!("{stem} (copy)"));
        for map in &original.maps {
            self.changes.insert(Change::Map(copy.clone(), map.name.clone()));
        }
        self.missions.push(Mission {
            id: copy.clone(),
            name,
            created_millis: now_millis,
            changed_millis: now_millis,
            deleted_millis: None,
            ..original
        });
        self.changes.insert(Change::Kept(copy.clone()));
        Some(copy)
    }

    /// Deletes a mission; it can be brought back.
    pub fn delete(&mut self, id: &MissionId, now_millis: i64) {
        if let Some(mission) = self.mission_mut(id) {
            mission.deleted_millis = Some(now_millis);
            self.changes.insert(Change::Kept(id.clone()));
        }
    }

    /// Brings a deleted mission back.
    pub fn restore(&mut self, id: &MissionId) {
        if let Some(mission) = self.mission_mut(id)
            && mission.deleted_millis.take().is_some()
        {
            self.changes.insert(Change::Kept(id.clone()));
        }
    }

    /// Throws away what was deleted long ago.
    pub fn drop_old(&mut self, now_millis: i64) {
        let is_old = |mission: &Mission| {
            mission.deleted_millis.is_some_and(|deleted| now_millis - deleted > DELETED_MILLIS)
        };
        for mission in self.missions.extract_if(.., |mission| is_old(mission)) {
            self.changes.insert(Change::Dropped(mission.id));
        }
    }

    /// Keeps the texts of the open mission as a version of this name. Returns whether a mission is open.
    pub fn keep_version(&mut self, name: &str, now_millis: i64) -> bool {
        let Some(id) = self.open_id().cloned() else { return false };
        let Some(texts) = self.mission(&id).map(|mission| mission.texts.clone()) else { return false };
        self.add_version(&id, Version { name: name.to_owned(), at_millis: now_millis, texts });
        true
    }

    /// Adds a version to a mission.
    pub fn add_version(&mut self, id: &MissionId, version: Version) {
        if let Some(mission) = self.mission_mut(id) {
            mission.versions.push(version);
            let surplus = mission.versions.len().saturating_sub(MAX_VERSIONS);
            mission.versions.drain(..surplus);
            self.changes.insert(Change::Kept(id.clone()));
        }
    }

    /// Adds a version to a mission, in the place of its last one if that has the same name.
    pub fn put_version(&mut self, id: &MissionId, version: Version) {
        if let Some(mission) = self.mission_mut(id) {
            mission.versions.pop_if(|last| last.name == version.name);
        }
        self.add_version(id, version);
    }

    /// The open mission of the library has this map.
    pub fn take_map(&mut self, map: MapFile, now_millis: i64) {
        let Some(id) = self.open_id().cloned() else { return };
        let Some(mission) = self.mission_mut(&id) else { return };
        let name = map.name.clone();
        mission.maps.retain(|it| it.name != name);
        mission.maps.push(map);
        self.changes.insert(Change::Map(id.clone(), name));
        self.touch(&id, now_millis);
    }

    /// A map of a mission was read from where it is kept.
    pub fn map_read(&mut self, id: &MissionId, name: &str, bytes: &[u8]) {
        if let Some(mission) = self.mission_mut(id)
            && let Some(map) = mission.maps.iter_mut().find(|map| map.name == name)
        {
            map.bytes = Some(bytes.into());
        }
    }

    /// Adds a layout to the open mission, replacing one of the same name. Returns its number.
    pub fn add_layout(&mut self, name: &str, workspace: &str, now_millis: i64) -> Option<usize> {
        let id = self.open_id().cloned()?;
        let mission = self.mission_mut(&id)?;
        mission.layouts.retain(|layout| layout.name != name);
        let (name, workspace) = (name.to_owned(), workspace.to_owned());
        mission.layouts.push(SavedLayout { name, workspace, tiles: String::new() });
        let number = mission.layouts.len() - 1;
        self.touch(&id, now_millis);
        Some(number)
    }

    /// Stores the panels of a layout with their places, as the front end has written them.
    pub fn set_layout(&mut self, number: usize, tiles: String) {
        let Some(id) = self.open_id().cloned() else { return };
        if let Some(layout) = self.mission_mut(&id).and_then(|it| it.layouts.get_mut(number)) {
            layout.tiles = tiles;
            self.changes.insert(Change::Kept(id));
        }
    }

    /// Removes a layout from the open mission.
    pub fn remove_layout(&mut self, number: usize, now_millis: i64) {
        let Some(id) = self.open_id().cloned() else { return };
        if let Some(mission) = self.mission_mut(&id).filter(|mission| number < mission.layouts.len()) {
            mission.layouts.remove(number);
            self.touch(&id, now_millis);
        }
    }

    /// A small picture of the open mission's plan. It is kept with the next change.
    pub fn take_picture(&mut self, picture: Vec<[u16; 3]>) {
        if let Some(id) = self.open_id().cloned()
            && let Some(mission) = self.mission_mut(&id)
            && mission.picture != picture
        {
            mission.picture = picture;
            self.changes.insert(Change::Typed(id));
        }
    }

    /// Takes in a mission as it is kept, or as another tab has it. The newer one of two counts; versions, and what was
    /// read of maps, are never lost, whoever has them. Returns whether its texts are those that count.
    pub fn take_in(&mut self, mut kept: Mission) -> bool {
        let Some(known) = self.mission_mut(&kept.id) else {
            self.missions.push(kept);
            return true;
        };
        let is_newer = kept.changed_millis >= known.changed_millis;
        if !is_newer {
            std::mem::swap(known, &mut kept);
        }
        // From here on `kept` is the newer one, and `known` gives it what it lacks.
        for map in kept.maps.iter_mut().filter(|map| map.bytes.is_none()) {
            let read = known.maps.iter().find(|it| it.name == map.name);
            map.bytes = read.and_then(|it| it.bytes.clone());
        }
        let missing: Vec<Version> =
            known.versions.iter().filter(|it| !kept.versions.contains(it)).cloned().collect();
        kept.versions.extend(missing);
        kept.versions.sort_by_key(|version| version.at_millis);
        if kept.picture.is_empty() {
            kept.picture = std::mem::take(&mut known.picture);
        }
        *known = kept;
        is_newer
    }

    /// Forgets a mission that another tab has thrown away.
    pub fn forget(&mut self, id: &MissionId) {
        if self.open_id() != Some(id) {
            self.missions.retain(|mission| mission.id != *id);
        }
    }

    /// Notes that a mission must be kept.
    pub fn must_keep(&mut self, id: &MissionId) {
        self.changes.insert(Change::Kept(id.clone()));
    }

    /// Takes what must be kept.
    pub fn take_changes(&mut self) -> BTreeSet<Change> {
        std::mem::take(&mut self.changes)
    }

    fn touch(&mut self, id: &MissionId, now_millis: i64) {
        if let Some(mission) = self.mission_mut(id) {
            mission.changed_millis = now_millis.max(mission.changed_millis + 1);
        }
        self.changes.insert(Change::Kept(id.clone()));
    }

    fn fresh_id(&mut self) -> MissionId {
        loop {
            self.count += 1;
            let id = MissionId(format_smolstr!("{:x}-{:x}", self.seed, self.count));
            if self.mission(&id).is_none() {
                return id;
            }
        }
    }

    /// A name that no other mission has: the wished one, or one with a number.
    fn free_name(&self, wished: &str) -> SmolStr {
        let wished = if wished.trim().is_empty() { "Mission" } else { wished.trim() };
        let is_free = |name: &str| {
            self.missions.iter().all(|mission| mission.deleted_millis.is_some() || mission.name != name)
        };
        if is_free(wished) {
            return wished.into();
        }
        let numbered = |number: usize| {
            stem_of_copy(wished).map_or_else(
                || format_smolstr!("{wished} {number}"),
                |stem| format_smolstr!("{stem} (copy {number})"),
            )
        };
        // Of so many names one is free.
        let last = self.missions.len() + 2;
        (2..last).map(numbered).find(|name| is_free(name)).unwrap_or_else(|| numbered(last))
    }
}

/// Returns what is copied, of a name such as `Threats (copy 2)`.
fn stem_of_copy(name: &str) -> Option<&str> {
    let (stem, number) = name.strip_suffix(')')?.rsplit_once(" (copy")?;
    number.chars().all(|c| c == ' ' || c.is_ascii_digit()).then_some(stem)
}
