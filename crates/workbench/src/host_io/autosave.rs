//! Keeps the missions beyond the end of this run, so that nothing is ever lost.
//!
//! Each change is written three times. At once, at the end of the frame that made it, the mission's texts go to a small
//! place that takes them synchronously (`writing`): a reload or a closed tab right after a key press finds them there. A
//! browser writes that place to its disk seconds later, so the texts go to the shelf at the same time, which is on the disk
//! when it answers (`typed`): a killed browser finds them there. A little later the whole mission goes to the shelf; only
//! then are the two copies let go. A tab owns its small copies, and never touches those of another one that may be alive.
//! Which mission is open is kept in both places, too. What is kept carries a checksum.

mod tabs;

pub(super) use tabs::{tell_keys, tell_review};

use std::collections::{BTreeMap, BTreeSet};

use smol_str::SmolStr;

use super::address::{is_first_example, named_mission, open_fragment};
use crate::command::Command;
use crate::effect::Effect;
use crate::host::{Host, ShelfContent, ShelfNews, ShelfRequest, StorageError};
use crate::library::{Change, Keeping, Mission, MissionError, MissionId, MissionKind, Open, Unreadable};
use crate::mission_file;
use crate::state::AppState;

/// The mission that was open last, and since when.
const LAST_KEY: &str = "enroute/open-1";
/// The example that was open last, and since when.
const EXAMPLE_KEY: &str = "enroute/example-1";
/// The same as [`LAST_KEY`] on the shelf.
const LAST_ON_SHELF: &str = "open";
/// Where the latest texts are written at once: by mission, and by the tab that writes.
const WRITING: &str = "enroute/writing-1/";
/// What the draft of earlier versions of this program was kept under.
const DRAFTS: [&str; 2] = ["enroute/draft-1/earlier", "enroute/draft-1"];
/// Where missions lie on the shelf.
const MISSIONS: &str = "mission/";
/// Where the latest texts of missions lie on the shelf until the whole mission is written.
const TYPED: &str = "typed/";
/// Where damaged missions are put whose texts were found elsewhere, before they are written again.
const ASIDE: &str = "aside/";

/// Whole missions are not written to the shelf more often than this, as long as their texts are.
const SECONDS_BETWEEN: f64 = 0.4;
/// What is typed is written to the shelf as soon as it has answered, and after this even if it has not.
const SECONDS_UNTIL_TYPED: f64 = 0.04;
/// Long texts are noted not more often than this.
const SECONDS_BETWEEN_LONG: f64 = 0.1;
/// What could not be written is tried again after this.
const SECONDS_UNTIL_AGAIN: f64 = 5.0;
/// A shelf that has not opened after this long is said to fail. It is still taken in when it opens later.
const SECONDS_UNTIL_SILENT: f64 = 15.0;
/// Longer texts are written at most ten times a second: the small place is slow with them, and not much larger than they are.
const LONG_TEXT_BYTES: usize = 400_000;
/// A mission that was changed longer ago than this is not mentioned.
const MILLIS_UNTIL_OLD: i64 = 10 * 60 * 1000;

/// Keeps the missions while they are edited.
#[derive(Debug)]
pub struct Autosave {
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
    /// Missions whose latest texts the shelf has not been told of.
    typed: BTreeSet<MissionId>,
    /// Latest texts that the shelf is writing: when it was asked, and when the mission was changed.
    typed_in_flight: BTreeMap<MissionId, (f64, i64)>,
    /// Missions of which the shelf may have the latest texts apart.
    typed_on_shelf: BTreeSet<MissionId>,
    /// Small copies of this tab, with when the mission was changed that they hold.
    written: BTreeMap<MissionId, i64>,
    /// Small copies of earlier runs, as they were found.
    found: BTreeMap<MissionId, Vec<(String, String)>>,
    /// Why the small place takes nothing, if so.
    small_refusal: Option<StorageError>,
    /// When the shelf was asked to open.
    asked_secs: f64,
    last_write_secs: f64,
    last_long_secs: f64,
    has_complained: bool,
    /// Whether the window forgets everything when it is closed.
    is_private: bool,
    has_told_private: bool,
    /// The mission that was noted as the one that was open last.
    last: Option<MissionId>,
    /// The example that was noted as the one that was open last.
    example: Option<SmolStr>,
    /// The mission that the shelf has noted so.
    last_on_shelf: Option<MissionId>,
    /// The one that was open last in earlier runs, as the shelf has it.
    found_last: Option<Last>,
    wanted: Wanted,
}

/// A mission or an example that was open, and since when, in milliseconds since 1970.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Last {
    id: MissionId,
    since_millis: i64,
}

impl Last {
    /// Earlier versions of this program wrote the id alone.
    fn read(text: &str) -> Self {
        let (id, since) = text.split_once(' ').unwrap_or((text, "0"));
        Self { id: MissionId(id.into()), since_millis: since.parse().unwrap_or_default() }
    }

    fn write(&self) -> String {
        format!("{} {}", self.id.0, self.since_millis)
    }
}

/// What is to be opened as soon as the shelf is known, unless something is edited before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wanted {
    Nothing,
    /// The mission of the last run.
    Last,
    /// The mission that the address names.
    Named,
}

/// How the shelf does.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Shelf {
    Opening,
    Ready,
    Failing(StorageError),
}

impl Autosave {
    /// Takes in what is kept.
    pub fn start(state: &mut AppState, host: &mut dyn Host) -> Self {
        let seed = host.random();
        state.library.seed_ids(seed);
        let mut autosave = Self {
            tab: format!("{seed:x}"),
            noted_revision: state.document.revision(),
            agreed: None,
            shelf: Shelf::Opening,
            waiting: BTreeSet::new(),
            waiting_maps: BTreeSet::new(),
            in_flight: BTreeSet::new(),
            typed: BTreeSet::new(),
            typed_in_flight: BTreeMap::new(),
            typed_on_shelf: BTreeSet::new(),
            written: BTreeMap::new(),
            found: BTreeMap::new(),
            small_refusal: None,
            asked_secs: host.monotonic_secs(),
            last_write_secs: f64::NEG_INFINITY,
            last_long_secs: f64::NEG_INFINITY,
            has_complained: false,
            is_private: false,
            has_told_private: false,
            last: None,
            example: None,
            last_on_shelf: None,
            found_last: None,
            wanted: Wanted::Nothing,
        };
        autosave.read_small_copies(state, host);
        autosave.take_drafts(state, host);
        if let Some(outcome) = host.open_shelf() {
            autosave.opened(state, host, outcome);
        }
        autosave
    }

    /// Opens what the address names, or else what was open last in earlier runs.
    pub fn open_first(&mut self, state: &mut AppState, host: &dyn Host) {
        let fragment = host.fragment();
        let named = named_mission(&fragment);
        if self.shelf == Shelf::Opening && named.is_some_and(|id| state.library.mission(&id).is_none()) {
            self.wanted = Wanted::Named;
        } else if open_fragment(state, &fragment) {
            self.mention_last(state, host);
        } else {
            self.reopen(state, host);
        }
    }

    /// Returns whether something else is to be opened as soon as the shelf is known.
    pub fn wants_another(&self) -> bool {
        self.wanted != Wanted::Nothing
    }

    /// Opens what was open last in earlier runs, since nothing else was asked for: a mission, or an example.
    fn reopen(&mut self, state: &mut AppState, host: &dyn Host) {
        let mission = self.last_mission(state, host);
        // A mission that was open later may still be on its way from the shelf.
        let small = host.stored(LAST_KEY).map_or(0, |text| Last::read(&text).since_millis);
        let since = mission.as_ref().map_or(small, |last| last.since_millis);
        let example = host.stored(EXAMPLE_KEY).map(|text| Last::read(&text));
        if let Some(example) = example.filter(|example| example.since_millis > since) {
            self.wanted = Wanted::Nothing;
            state.apply(Command::OpenExample(example.id.0));
            return;
        }
        match mission {
            Some(last) => {
                self.wanted = Wanted::Nothing;
                state.open_mission(&last.id);
                let name = state.mission.clone();
                state.window.done(format!("Restored “{name}” from your last session"));
            }
            None if self.shelf == Shelf::Opening => self.wanted = Wanted::Last,
            None => self.wanted = Wanted::Nothing,
        }
    }

    /// Tells of the mission of the last run where the address names another one: a browser that was killed may open an
    /// address of before the edit that made the mission.
    fn mention_last(&self, state: &mut AppState, host: &dyn Host) {
        let last = self.last_mission(state, host).filter(|it| state.library.open_id() != Some(&it.id));
        let Some(mission) = last.and_then(|it| state.library.mission(&it.id)) else { return };
        if state.frame.unix_millis - mission.changed_millis < MILLIS_UNTIL_OLD {
            let text = format!("“{}”, which you edited last, is in File > Missions", mission.name);
            state.window.info(&text);
        }
    }

    /// The mission that was open last, if it is still there.
    fn last_mission(&self, state: &AppState, host: &dyn Host) -> Option<Last> {
        let small = host.stored(LAST_KEY).map(|text| Last::read(&text));
        let is_there =
            |last: &Last| state.library.mission(&last.id).is_some_and(|it| it.deleted_millis.is_none());
        let all = [self.found_last.clone(), small].into_iter().flatten().filter(is_there);
        all.max_by_key(|last| last.since_millis)
    }

    /// Writes down what has changed. Returns after how many seconds it wants to be asked again, if it does.
    pub fn follow(&mut self, state: &mut AppState, host: &mut dyn Host, now_secs: f64) -> Option<f64> {
        let opening_wait = self.wait_for_shelf(now_secs);
        if self.wants_another() && (state.document.is_modified() || !is_first_example(state)) {
            // The user went on with something else meanwhile.
            self.wanted = Wanted::Nothing;
            state.window.ask(Effect::ShowAddress);
        }
        let mut wait = None;
        let is_long = state.document.text().len() > LONG_TEXT_BYTES;
        let long_wait = self.last_long_secs + SECONDS_BETWEEN_LONG - now_secs;
        if self.noted_revision != state.document.revision() {
            if is_long && long_wait > 0.0 {
                wait = Some(long_wait);
            } else {
                self.last_long_secs = now_secs;
                self.note(state, host);
            }
        }
        self.take_changes(state, host);
        let typed_wait = self.write_typed(state, host, now_secs);
        let shelf_wait = self.write_to_shelf(state, host, now_secs);
        self.judge(state);
        [opening_wait, wait, typed_wait, shelf_wait].into_iter().flatten().reduce(f64::min)
    }

    /// Gives up waiting for a shelf that does not open. Returns how many seconds it still waits, if it does.
    fn wait_for_shelf(&mut self, now_secs: f64) -> Option<f64> {
        if self.shelf != Shelf::Opening {
            return None;
        }
        let wait = self.asked_secs + SECONDS_UNTIL_SILENT - now_secs;
        if wait > 0.0 {
            return Some(wait);
        }
        let reason = "the browser's database doesn't respond".to_owned();
        self.shelf = Shelf::Failing(StorageError::Unavailable { reason });
        None
    }

    /// Writes everything down now: the page is about to close.
    pub fn keep_now(&mut self, state: &mut AppState, host: &mut dyn Host) {
        self.note(state, host);
        self.take_changes(state, host);
        self.write_to_shelf(state, host, f64::INFINITY);
    }

    /// Writes a text of the open mission to the shelf that the next frame will have. What that frame has is written in any case.
    pub fn keep_ahead(&mut self, state: &AppState, host: &mut dyn Host, text: &str) {
        let Some(mission) = state.library.open_mission().filter(|_| self.shelf == Shelf::Ready) else {
            return;
        };
        let mut ahead = mission.latest();
        ahead.say(text);
        ahead.changed_millis = mission.changed_millis + 1;
        host.use_shelf(ShelfRequest::Write {
            key: typed_key(&mission.id),
            bytes: ahead.to_checked_json().into_bytes(),
            token: mission.changed_millis,
        });
        self.typed_on_shelf.insert(mission.id.clone());
        self.typed.insert(mission.id.clone());
    }

    /// Takes in what the shelf answers.
    pub fn hear(&mut self, state: &mut AppState, host: &mut dyn Host, news: ShelfNews) {
        match news {
            ShelfNews::Opened(outcome) => {
                self.note(state, host);
                self.opened(state, host, outcome);
                // Another tab may have gone on with the mission that is open here.
                let kept = state.library.open_mission().map(Mission::joined_text);
                if let Some(kept) = kept.filter(|kept| kept != state.document.text()) {
                    state.adopt_text(&kept);
                }
                let wanted = std::mem::replace(&mut self.wanted, Wanted::Nothing);
                match wanted {
                    _ if state.document.is_modified() => {}
                    Wanted::Nothing => {}
                    Wanted::Last => self.reopen(state, host),
                    Wanted::Named => self.open_first(state, host),
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

    /// The window forgets everything when it is closed.
    pub fn note_private(&mut self, state: &mut AppState) {
        self.is_private = true;
        self.judge(state);
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
                    self.typed.insert(id.clone());
                    self.waiting.insert(id);
                }
                Change::Kept(id) => {
                    self.write_small_copy(state, host, &id);
                    tabs::tell_mission(state, host, &id);
                    self.typed.insert(id.clone());
                    self.waiting.insert(id);
                }
                Change::Map(id, name) => {
                    self.waiting_maps.insert((id, name));
                }
                Change::Dropped(id) => {
                    host.use_shelf(ShelfRequest::Remove { key: mission_key(&id) });
                    host.use_shelf(ShelfRequest::Remove { key: typed_key(&id) });
                    host.forget(&self.small_key(&id));
                }
            }
        }
        self.note_open(state, host);
    }

    /// Notes which mission is open, in both places.
    fn note_open(&mut self, state: &AppState, host: &mut dyn Host) {
        let Some(id) = state.library.open_id() else {
            // What is opened again later is the last one from then on.
            self.last = None;
            self.last_on_shelf = None;
            self.note_example(state, host);
            return;
        };
        self.example = None;
        let last = Last { id: id.clone(), since_millis: state.frame.unix_millis };
        if self.last.as_ref() != Some(id) {
            // Without it another mission is open at the next start, and nothing is lost.
            let _ = host.store(LAST_KEY, &last.write());
            self.last = Some(id.clone());
        }
        if self.last_on_shelf.as_ref() != Some(id) && self.shelf == Shelf::Ready {
            let bytes = last.write().into_bytes();
            host.use_shelf(ShelfRequest::Write { key: LAST_ON_SHELF.to_owned(), bytes, token: 0 });
            self.last_on_shelf = Some(id.clone());
        }
    }

    /// Notes which example is open, unless what was open last is still to be opened.
    fn note_example(&mut self, state: &AppState, host: &mut dyn Host) {
        let is_example = matches!(state.library.open(), Open::Original { kind: MissionKind::Example, .. });
        if !is_example || self.wants_another() || self.example.as_ref() == Some(&state.mission) {
            return;
        }
        let last = Last { id: MissionId(state.mission.clone()), since_millis: state.frame.unix_millis };
        // Without it another mission is open at the next start, and nothing is lost.
        let _ = host.store(EXAMPLE_KEY, &last.write());
        self.example = Some(state.mission.clone());
    }

    fn write_small_copy(&mut self, state: &AppState, host: &mut dyn Host, id: &MissionId) {
        let Some(mission) = state.library.mission(id) else { return };
        let outcome = host.store(&self.small_key(id), &mission.latest().to_checked_json());
        if outcome.is_ok() {
            self.written.insert(id.clone(), mission.changed_millis);
        }
        self.small_refusal = outcome.err();
    }

    /// Writes the texts that the shelf does not have yet, each as soon as its last one is written.
    fn write_typed(&mut self, state: &AppState, host: &mut dyn Host, now_secs: f64) -> Option<f64> {
        if self.shelf != Shelf::Ready {
            return None;
        }
        let mut wait: Option<f64> = None;
        for id in std::mem::take(&mut self.typed) {
            let Some(mission) = state.library.mission(&id) else { continue };
            let busy_secs = self
                .typed_in_flight
                .get(&id)
                .map(|(asked_secs, _)| asked_secs + SECONDS_UNTIL_TYPED - now_secs)
                .filter(|&busy_secs| busy_secs > 0.0);
            if let Some(busy_secs) = busy_secs {
                wait = Some(wait.map_or(busy_secs, |wait| wait.min(busy_secs)));
                self.typed.insert(id);
                continue;
            }
            host.use_shelf(ShelfRequest::Write {
                key: typed_key(&id),
                bytes: mission.latest().to_checked_json().into_bytes(),
                token: mission.changed_millis,
            });
            self.typed_in_flight.insert(id.clone(), (now_secs, mission.changed_millis));
            self.typed_on_shelf.insert(id);
        }
        wait
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
                    bytes: mission.without_maps().to_checked_json().into_bytes(),
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
        if let Some(id) = key.strip_prefix(TYPED).map(|id| MissionId(id.into())) {
            if self.typed_in_flight.get(&id).is_some_and(|&(_, asked)| asked <= token) {
                self.typed_in_flight.remove(&id);
            }
            if outcome.is_err() {
                self.waiting.insert(id);
            }
        }
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
                let is_all = state.library.mission(&id).is_some_and(|it| it.changed_millis <= token);
                if is_all && !self.typed_in_flight.contains_key(&id) && self.typed_on_shelf.remove(&id) {
                    host.use_shelf(ShelfRequest::Remove { key: typed_key(&id) });
                }
                // What earlier runs left is on the shelf now, unless another tab continues writing there.
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

    fn opened(
        &mut self,
        state: &mut AppState,
        host: &mut dyn Host,
        outcome: Result<ShelfContent, StorageError>,
    ) {
        let content = match outcome {
            Ok(content) => content,
            Err(reason) => {
                self.shelf = Shelf::Failing(reason);
                self.judge(state);
                return;
            }
        };
        self.shelf = Shelf::Ready;
        let mut damaged = Vec::new();
        for (key, bytes) in content {
            if key == LAST_ON_SHELF {
                self.found_last = str::from_utf8(&bytes).ok().map(Last::read);
            } else if key.starts_with(ASIDE) {
                Self::set_aside(state, key, &bytes, "the file is damaged");
            } else if let Some(id) = key.strip_prefix(MISSIONS).or_else(|| key.strip_prefix(TYPED)) {
                match read_mission(&bytes, id) {
                    Ok(mission) if key.starts_with(TYPED) => {
                        let id = mission.id.clone();
                        self.typed_on_shelf.insert(id.clone());
                        if state.library.take_in(mission) {
                            state.library.must_keep(&id);
                        }
                    }
                    Ok(mission) => {
                        state.library.take_in(mission);
                    }
                    Err(reason) => damaged.push((key, bytes, reason)),
                }
            }
        }
        for (key, bytes, reason) in damaged {
            let id = key.split_once('/').map(|(_, id)| MissionId(id.into()));
            // Another copy brings the texts, and writes them where this one lies.
            let key = if id.is_some_and(|id| state.library.mission(&id).is_some()) {
                let aside = format!("{ASIDE}{key}");
                let write = ShelfRequest::Write { key: aside.clone(), bytes: bytes.clone(), token: 0 };
                host.use_shelf(write);
                aside
            } else {
                key
            };
            Self::set_aside(state, key, &bytes, &reason);
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
            let copy = state.library.mission(&id).map(|mission| mission.latest().to_checked_json());
            let is_kept = copy.is_some_and(|copy| host.store(&self.small_key(&id), &copy).is_ok());
            if is_kept {
                // A place that is read only keeps the draft, and it becomes another copy next time.
                let last = Last { id, since_millis: state.frame.unix_millis };
                let _ = host.store(LAST_KEY, &last.write());
                host.forget(key);
            }
        }
    }

    /// Says how keeping goes.
    fn judge(&mut self, state: &mut AppState) {
        let keeping = match (&self.shelf, &self.small_refusal) {
            (Shelf::Opening, None) => Keeping::Opening,
            (Shelf::Ready, _) if self.is_private => Keeping::UntilClosed,
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
            Keeping::UntilClosed if !std::mem::replace(&mut self.has_told_private, true) => {
                let text = "Private window: closing it deletes your missions. Save them to files.";
                state.window.info(text);
            }
            Keeping::Kept | Keeping::UntilClosed if std::mem::take(&mut self.has_complained) => {
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

fn typed_key(id: &MissionId) -> String {
    format!("{TYPED}{}", id.0)
}

/// Reads a mission that is kept under this id.
fn read_mission(bytes: &[u8], id: &str) -> Result<Mission, String> {
    let text = str::from_utf8(bytes).map_err(|error| MissionError::Damaged(error.to_string()).to_string())?;
    let mission = Mission::from_json(text).map_err(|error| error.to_string())?;
    if mission.id.0 == id { Ok(mission) } else { Err("the identifiers differ".to_owned()) }
}

fn map_key(id: &MissionId, name: &str) -> String {
    format!("map/{}/{name}", id.0)
}

fn map_of(key: &str) -> Option<(MissionId, SmolStr)> {
    let (id, name) = key.strip_prefix("map/")?.split_once('/')?;
    Some((MissionId(id.into()), name.into()))
}
