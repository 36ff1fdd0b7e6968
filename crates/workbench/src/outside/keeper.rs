//! Keeps the missions beyond the end of this run, so that nothing is ever lost.
//!
//! Each change is written twice. At once, at the end of the frame that made it, the mission's texts go to a small place
//! that takes them synchronously (`writing`): a reload, a crash or a closed tab right after a key press finds them
//! there. A little later the whole mission goes to the shelf, which is large and answers when it is done; only then is
//! the small copy let go. A tab owns its small copies, and never touches those of another one that may be alive.

mod tabs;

use std::collections::{BTreeMap, BTreeSet};

use smol_str::SmolStr;

use crate::host::{Host, ShelfContent, ShelfNews, ShelfRequest, StorageError};
use crate::library::{Change, Keeping, Mission, MissionError, MissionId, MissionKind, Unreadable};
use crate::mission_file;
use crate::state::AppState;

/// The mission that was open last.
const LAST_KEY: &str = "enroute/open-1";
/// Where the latest texts are written at once: by mission, and by the tab that writes.
const WRITING: &str = "enroute/writing-1/";
/// What the draft of earlier versions of this program was kept under.
const DRAFTS: [&str; 2] = ["enroute/draft-1/earlier", "enroute/draft-1"];
/// Where missions lie on the shelf.
const MISSIONS: &str = "mission/";

/// The shelf is not written more often than this, as long as the small place takes what is typed.
const SECONDS_BETWEEN: f64 = 0.4;
/// What could not be written is tried again after this.
const SECONDS_UNTIL_AGAIN: f64 = 5.0;
/// Longer texts are written at most so often: the small place is slow with them, and not much larger than they are.
const LONG_TEXT_BYTES: usize = 400_000;

/// Keeps the missions while they are edited.
#[derive(Debug)]
pub struct Keeper {
    /// This tab, among those that show the page.
    tab: String,
    /// The revision of the open text that was noted last.
    noted_revision: u64,
    /// The text that this tab and the others agree on, and the mission it belongs to.
    agreed: Option<(MissionId, u64)>,
    shelf: Shelf,
    /// Missions that the shelf has not been told of as they are now.
    waiting: BTreeSet<MissionId>,
    /// Maps that the shelf has not taken yet.
    waiting_maps: BTreeSet<(MissionId, SmolStr)>,
    /// Missions that the shelf is writing.
    in_flight: BTreeSet<MissionId>,
    /// Small copies of this tab, with when the mission was changed that they hold.
    written: BTreeMap<MissionId, i64>,
    /// Small copies of earlier runs, as they were found.
    found: BTreeMap<MissionId, Vec<(String, String)>>,
    /// Why the small place takes nothing, if so.
    small_refusal: Option<StorageError>,
    last_write_secs: f64,
    last_long_secs: f64,
    has_complained: bool,
    /// The mission that was noted as the one that was open last.
    last: Option<MissionId>,
    /// Whether the open mission is to be the one of the last run as soon as it is known.
    wants_last: bool,
}

/// How the shelf does.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Shelf {
    Opening,
    Ready,
    Failing(StorageError),
}

impl Keeper {
    /// Takes in what is kept.
    pub fn start(state: &mut AppState, host: &mut dyn Host) -> Self {
        let seed = host.random();
        state.library.seed_ids(seed);
        let mut keeper = Self {
            tab: format!("{seed:x}"),
            noted_revision: state.document.revision(),
            agreed: None,
            shelf: Shelf::Opening,
            waiting: BTreeSet::new(),
            waiting_maps: BTreeSet::new(),
            in_flight: BTreeSet::new(),
            written: BTreeMap::new(),
            found: BTreeMap::new(),
            small_refusal: None,
            last_write_secs: f64::NEG_INFINITY,
            last_long_secs: f64::NEG_INFINITY,
            has_complained: false,
            last: None,
            wants_last: false,
        };
        keeper.read_small_copies(state, host);
        keeper.take_drafts(state, host);
        if let Some(outcome) = host.open_shelf() {
            keeper.opened(state, outcome);
        }
        keeper
    }

    /// Opens the mission of the last run, since nothing else was asked for.
    pub fn reopen(&mut self, state: &mut AppState, host: &dyn Host) {
        let last = host.stored(LAST_KEY).map(|id| MissionId(id.into()));
        match last.filter(|id| state.library.mission(id).is_some_and(|it| it.deleted_millis.is_none())) {
            Some(id) => {
                self.wants_last = false;
                state.open_mission(&id);
                state.window.done("Restored your last session");
            }
            None => self.wants_last = self.shelf == Shelf::Opening,
        }
    }

    /// Writes down what has changed. Returns after how many seconds it wants to be asked again, if it does.
    pub fn follow(&mut self, state: &mut AppState, host: &mut dyn Host, now_secs: f64) -> Option<f64> {
        let mut wait = None;
        let is_long = state.document.text().len() > LONG_TEXT_BYTES;
        let long_wait = self.last_long_secs + SECONDS_BETWEEN - now_secs;
        if self.noted_revision != state.document.revision() {
            if is_long && long_wait > 0.0 {
                wait = Some(long_wait);
            } else {
                self.last_long_secs = now_secs;
                self.note(state, host);
            }
        }
        self.take_changes(state, host);
        let shelf_wait = self.write_to_shelf(state, host, now_secs);
        self.judge(state);
        wait.into_iter().chain(shelf_wait).reduce(f64::min)
    }

    /// Writes everything down now: the page is about to close.
    pub fn keep_now(&mut self, state: &mut AppState, host: &mut dyn Host) {
        self.note(state, host);
        self.take_changes(state, host);
        self.write_to_shelf(state, host, f64::INFINITY);
    }

    /// Takes in what the shelf answers.
    pub fn hear(&mut self, state: &mut AppState, host: &mut dyn Host, news: ShelfNews) {
        match news {
            ShelfNews::Opened(outcome) => {
                self.note(state, host);
                self.opened(state, outcome);
                // Another tab may have gone on with the mission that is open here.
                let kept = state.library.open_mission().map(Mission::joined_text);
                if let Some(kept) = kept.filter(|kept| kept != state.document.text()) {
                    state.adopt_text(&kept);
                }
                if std::mem::take(&mut self.wants_last) && !state.document.is_modified() {
                    self.reopen(state, host);
                }
            }
            ShelfNews::Written { key, token, outcome } => self.written(state, host, &key, token, outcome),
            ShelfNews::Read { key, outcome } => {
                let Some((id, name)) = map_of(&key) else { return };
                match outcome {
                    Ok(Some(bytes)) => {
                        state.library.map_read(&id, &name, &bytes);
                        if state.library.open_id() == Some(&id) {
                            state.import_map(name, bytes);
                        }
                    }
                    Ok(None) => {
                        state.window.failed(format!("The map {name} is no longer saved. Import it again."));
                    }
                    Err(reason) => {
                        let text = format!("Couldn't read map {name}: {reason}");
                        state.window.failed(text);
                    }
                }
            }
        }
    }

    /// Asks the shelf for a map.
    pub fn read_map(host: &mut dyn Host, id: &MissionId, name: &str) {
        host.use_shelf(ShelfRequest::Read { key: map_key(id, name) });
    }

    fn note(&mut self, state: &mut AppState, host: &mut dyn Host) {
        self.noted_revision = state.document.revision();
        state.note_text();
        self.tell_text(state, host);
    }

    fn take_changes(&mut self, state: &mut AppState, host: &mut dyn Host) {
        for change in state.library.take_changes() {
            match change {
                Change::Typed(id) => {
                    self.write_small_copy(state, host, &id);
                    self.waiting.insert(id);
                }
                Change::Kept(id) => {
                    self.write_small_copy(state, host, &id);
                    tabs::tell_mission(state, host, &id);
                    self.waiting.insert(id);
                }
                Change::Map(id, name) => {
                    self.waiting_maps.insert((id, name));
                }
                Change::Dropped(id) => {
                    host.use_shelf(ShelfRequest::Remove { key: mission_key(&id) });
                    host.forget(&self.small_key(&id));
                }
            }
        }
        if let Some(id) = state.library.open_id().filter(|&id| self.last.as_ref() != Some(id)) {
            // Without it another mission is open at the next start, and nothing is lost.
            let _ = host.store(LAST_KEY, &id.0);
            self.last = Some(id.clone());
        }
    }

    fn write_small_copy(&mut self, state: &AppState, host: &mut dyn Host, id: &MissionId) {
        let Some(mission) = state.library.mission(id) else { return };
        let outcome = host.store(&self.small_key(id), &mission.latest().to_json());
        if outcome.is_ok() {
            self.written.insert(id.clone(), mission.changed_millis);
        }
        self.small_refusal = outcome.err();
    }

    fn write_to_shelf(&mut self, state: &AppState, host: &mut dyn Host, now_secs: f64) -> Option<f64> {
        if self.shelf == Shelf::Opening || self.waiting.is_empty() && self.waiting_maps.is_empty() {
            return None;
        }
        let pause = match (&self.shelf, &self.small_refusal) {
            (Shelf::Failing(_), _) => SECONDS_UNTIL_AGAIN,
            (_, Some(_)) => 0.0,
            (_, None) => SECONDS_BETWEEN,
        };
        let wait = self.last_write_secs + pause - now_secs;
        if wait > 0.0 {
            return Some(wait);
        }
        if now_secs.is_finite() {
            self.last_write_secs = now_secs;
        }
        for (id, name) in std::mem::take(&mut self.waiting_maps) {
            let maps = state.library.mission(&id).map(|mission| &mission.maps);
            let map = maps.and_then(|maps| maps.iter().find(|map| map.name == name));
            if let Some(bytes) = map.and_then(|map| map.bytes.clone()) {
                host.use_shelf(ShelfRequest::Write {
                    key: map_key(&id, &name),
                    bytes: bytes.to_vec(),
                    token: 0,
                });
            }
        }
        let (busy, ready) = std::mem::take(&mut self.waiting)
            .into_iter()
            .partition::<BTreeSet<_>, _>(|id| self.in_flight.contains(id) && now_secs.is_finite());
        self.waiting = busy;
        for id in ready {
            if let Some(mission) = state.library.mission(&id) {
                host.use_shelf(ShelfRequest::Write {
                    key: mission_key(&id),
                    bytes: mission.to_json_without_maps().into_bytes(),
                    token: mission.changed_millis,
                });
                self.in_flight.insert(id);
            }
        }
        None
    }

    fn written(
        &mut self,
        state: &AppState,
        host: &mut dyn Host,
        key: &str,
        token: i64,
        outcome: Result<(), StorageError>,
    ) {
        let map = map_of(key);
        let id = key.strip_prefix(MISSIONS).map(|id| MissionId(id.into()));
        if let Some(id) = &id {
            self.in_flight.remove(id);
        }
        match outcome {
            Ok(()) => {
                self.shelf = Shelf::Ready;
                let Some(id) = id else { return };
                if self.written.get(&id).is_some_and(|&changed| changed <= token) {
                    self.written.remove(&id);
                    host.forget(&self.small_key(&id));
                }
                // What earlier runs left is on the shelf now, unless another tab goes on writing there.
                for (key, value) in self.found.remove(&id).unwrap_or_default() {
                    if host.stored(&key).as_deref() == Some(value.as_str()) {
                        host.forget(&key);
                    }
                }
            }
            Err(reason) => {
                self.shelf = Shelf::Failing(reason);
                self.last_write_secs = state.frame.now_secs;
                self.waiting.extend(id);
                self.waiting_maps.extend(map);
            }
        }
    }

    fn opened(&mut self, state: &mut AppState, outcome: Result<ShelfContent, StorageError>) {
        let content = match outcome {
            Ok(content) => content,
            Err(reason) => {
                self.shelf = Shelf::Failing(reason);
                self.judge(state);
                return;
            }
        };
        self.shelf = Shelf::Ready;
        for (key, bytes) in content {
            if let Some(id) = key.strip_prefix(MISSIONS) {
                let read = str::from_utf8(&bytes)
                    .map_err(|error| MissionError::Damaged(error.to_string()))
                    .and_then(Mission::from_json);
                match read {
                    Ok(mission) if mission.id.0 == id => {
                        state.library.take_in(mission);
                    }
                    Ok(_) => Self::set_aside(state, key, &bytes, "the identifiers differ"),
                    Err(error) => Self::set_aside(state, key, &bytes, &error.to_string()),
                }
            }
        }
        state.library.drop_old(state.frame.unix_millis);
        self.judge(state);
    }

    /// Something kept cannot be read: it stays where it is, and can be saved as a file.
    fn set_aside(state: &mut AppState, key: String, bytes: &[u8], reason: &str) {
        state.library.unreadable.push(Unreadable { key, reason: reason.to_owned(), bytes: bytes.into() });
        let count = state.library.unreadable.len();
        let what = if count == 1 { "A saved mission" } else { "Saved missions" };
        let text = format!("{what} can't be opened ({reason}). To export it, choose File > Missions….");
        state.window.failed(text);
    }

    fn read_small_copies(&mut self, state: &mut AppState, host: &dyn Host) {
        let mut keys: Vec<String> =
            host.stored_keys().into_iter().filter(|key| key.starts_with(WRITING)).collect();
        keys.sort();
        for key in keys {
            let Some(value) = host.stored(&key) else { continue };
            match Mission::from_json(&value) {
                Ok(mission) => {
                    let id = mission.id.clone();
                    state.library.take_in(mission);
                    state.library.must_keep(&id);
                    self.found.entry(id).or_default().push((key, value));
                }
                Err(error) => Self::set_aside(state, key, value.as_bytes(), &error.to_string()),
            }
        }
    }

    /// What an earlier version of this program kept becomes missions.
    fn take_drafts(&self, state: &mut AppState, host: &mut dyn Host) {
        for key in DRAFTS {
            let Some(text) = host.stored(key) else { continue };
            let draft: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
            let (Some(name), Some(source)) = (draft["name"].as_str(), draft["source"].as_str()) else {
                continue;
            };
            let (kind, name) = match mission_file::example(name) {
                Some(example) => (MissionKind::Example, format!("{} (copy)", example.title)),
                None => (MissionKind::File, name.to_owned()),
            };
            let id = state.library.add(&name, kind, source, state.frame.unix_millis);
            let copy = state.library.mission(&id).map(|mission| mission.latest().to_json());
            let is_kept = copy.is_some_and(|copy| host.store(&self.small_key(&id), &copy).is_ok());
            if is_kept {
                // A place that is read only keeps the draft, and it becomes another copy next time.
                let _ = host.store(LAST_KEY, &id.0);
                host.forget(key);
            }
        }
    }

    /// Says how keeping goes.
    fn judge(&mut self, state: &mut AppState) {
        let keeping = match (&self.shelf, &self.small_refusal) {
            (Shelf::Opening, None) => Keeping::Opening,
            (Shelf::Ready, _) => Keeping::Kept,
            (Shelf::Failing(reason), None) => Keeping::LatestOnly(reason.to_string()),
            (Shelf::Opening, Some(reason)) | (Shelf::Failing(reason), Some(_)) => {
                Keeping::Nothing(reason.to_string())
            }
        };
        if keeping == state.library.keeping {
            return;
        }
        match &keeping {
            Keeping::Nothing(reason) if !std::mem::replace(&mut self.has_complained, true) => {
                let text = format!(
                    "Saving failed ({reason}). Save your mission to a file before you close this window."
                );
                state.window.failed(text);
            }
            Keeping::LatestOnly(reason) if !std::mem::replace(&mut self.has_complained, true) => {
                let text =
                    format!("Maps and versions can't be saved ({reason}). Save your mission to a file.");
                state.window.failed(text);
            }
            Keeping::Kept if std::mem::take(&mut self.has_complained) => {
                state.window.done("Saving works again");
            }
            _ => {}
        }
        state.library.keeping = keeping;
    }

    fn small_key(&self, id: &MissionId) -> String {
        format!("{WRITING}{}/{}", id.0, self.tab)
    }
}

fn mission_key(id: &MissionId) -> String {
    format!("{MISSIONS}{}", id.0)
}

fn map_key(id: &MissionId, name: &str) -> String {
    format!("map/{}/{name}", id.0)
}

fn map_of(key: &str) -> Option<(MissionId, SmolStr)> {
    let (id, name) = key.strip_prefix("map/")?.split_once('/')?;
    Some((MissionId(id.into()), name.into()))
}
