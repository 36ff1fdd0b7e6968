//! What the app tells and hears through its host: remembered settings, addresses, and its state as plain JSON.

mod address;
mod announcement;
mod autosave;
mod remote;

use review::Record;
use review::keys::KeyRing;
use review::record::RecordError;

use crate::effect::Aside;
use crate::host::Host;
use crate::state::AppState;
use crate::state::keys::{KeyChange, KeysState};
use crate::state::review::ReviewState;
use crate::state::settings::Settings;

pub use address::{fragment, is_link_short, open_fragment, show_address};
pub use announcement::announcement;
pub use autosave::Autosave;
pub use remote::Remote;

/// What the board said of the open mission when that was last kept.
pub fn recall_review(host: &mut dyn Host, state: &mut AppState) {
    let mission = state.mission_key();
    let kept = host.stored(&ReviewState::key(&mission));
    let aside = host.stored(&ReviewState::aside_key(&mission, 0));
    let random = host.secret_bytes();
    state.reviewing().recall(kept.as_deref(), aside, random);
}

/// Keeps what the board said of the open mission; `joins` adds what is kept already, perhaps by another tab. A full
/// storage leaves what is kept as it was, and the app's own record too: the review then says that it is not kept. What
/// is kept and cannot be used is never written over: that of a later version of this program stays where it is, and
/// anything else is moved aside first.
pub fn keep_review(host: &mut dyn Host, state: &mut AppState, joins: bool) {
    let key = ReviewState::key(&state.mission_key());
    let outcome = make_way(host, state, &key, joins).and_then(|()| {
        if state.review.record().is_empty() {
            host.forget(&key);
            Ok(())
        } else {
            host.store(&key, &state.review.record().to_json()).map_err(|reason| reason.to_string())
        }
    });
    if outcome.is_ok() {
        autosave::tell_review(host, &state.mission_key());
    }
    state.review.kept(outcome);
}

/// Adds what another tab has kept of the open mission's review.
pub fn hear_review(host: &dyn Host, state: &mut AppState) {
    let kept = host.stored(&ReviewState::key(&state.mission_key()));
    if let Some(Ok(record)) = kept.map(|text| Record::from_json(&text)) {
        state.review.join(record);
        state.reviewing().judge();
    }
}

/// Where the keys are kept, beside the settings. Each change reads them first: another tab may have changed them.
const KEYS_KEY: &str = "enroute/keys-1";

/// The keys that are kept. Those that could not be kept here stay as they are.
pub fn recall_keys(host: &dyn Host, state: &mut AppState) {
    if state.keys.unkept().is_some() {
        return;
    }
    match kept_keys(host) {
        Some(Ok(ring)) => state.take_keys(ring, None),
        Some(Err(reason)) => state.window.failed(format!("Couldn't read the saved keys: {reason}")),
        None => {}
    }
}

fn kept_keys(host: &dyn Host) -> Option<Result<KeyRing, String>> {
    Some(KeyRing::from_json(&host.stored(KEYS_KEY)?).map_err(|error| error.to_string()))
}

/// Changes the keys, and keeps them. Keys that cannot be read are never written over.
pub fn change_keys(host: &mut dyn Host, state: &mut AppState, change: KeyChange) {
    let kept = kept_keys(host).filter(|_| state.keys.unkept().is_none());
    let kept = kept.unwrap_or_else(|| Ok(state.keys.ring.clone()));
    let name = match &change {
        KeyChange::Create(name) => Some(name.trim().to_owned()),
        KeyChange::Add(people) => {
            people.iter().find(|person| person.secret.is_some()).map(|person| person.name.clone())
        }
        KeyChange::Remove(_) => None,
    };
    let bytes = host.secret_bytes();
    let (ring, words) = match kept.and_then(|ring| KeysState::changed(&ring, change, bytes)) {
        Ok(changed) => changed,
        Err(reason) => {
            state.window.failed(reason);
            return;
        }
    };
    let unkept = host.store(KEYS_KEY, &ring.to_json(true)).err().map(|reason| reason.to_string());
    autosave::tell_keys(host);
    match &unkept {
        None => state.window.done(words),
        Some(reason) => {
            state.window.failed(format!("{words}, but saving failed: {reason}. Save your key to a file"));
        }
    }
    if let Some(name) = name {
        state.settings.reviewer = name;
    }
    state.take_keys(ring, unkept);
}

/// Joins what is kept, or sees that writing over it loses nothing.
fn make_way(host: &mut dyn Host, state: &mut AppState, key: &str, joins: bool) -> Result<(), String> {
    let Some(kept) = host.stored(key) else { return Ok(()) };
    match Record::from_json(&kept) {
        Ok(record) if joins => {
            state.review.join(record);
            state.reviewing().judge();
            Ok(())
        }
        Ok(_) => Ok(()),
        Err(newer @ RecordError::Newer { .. }) => Err(newer.to_string()),
        Err(_) => put_aside(host, state, &kept),
    }
}

/// Keeps a record that came with the open mission and cannot be used.
pub fn set_review_aside(host: &mut dyn Host, state: &mut AppState, aside: Aside) {
    let outcome = put_aside(host, state, &aside.text);
    state.review.set_aside(aside);
    if outcome.is_err() {
        state.review.kept(outcome);
    }
}

/// Records of one mission that are kept aside, at most.
const MAX_ASIDE: usize = 20;

fn put_aside(host: &mut dyn Host, state: &AppState, text: &str) -> Result<(), String> {
    let mission = state.mission_key();
    for number in 0..MAX_ASIDE {
        let key = ReviewState::aside_key(&mission, number);
        match host.stored(&key) {
            Some(known) if known == text => return Ok(()),
            Some(_) => {}
            None => return host.store(&key, text).map_err(|reason| reason.to_string()),
        }
    }
    Err("too many unreadable reviews have been set aside".to_owned())
}

const SETTINGS_KEY: &str = "enroute/settings-1";

/// The settings of the last run.
pub fn remembered_settings(host: &dyn Host) -> Option<Settings> {
    serde_json::from_str(&host.stored(SETTINGS_KEY)?).ok().map(Settings::checked)
}

/// Keeps the settings for the next run.
pub fn remember_settings(host: &mut dyn Host, settings: &Settings) {
    if let Ok(text) = serde_json::to_string(settings) {
        // What cannot be read, such as the settings of a later version of this program, is kept aside.
        if let Some(kept) = host.stored(SETTINGS_KEY).filter(|kept| !is_settings(kept)) {
            let _ = host.store(&format!("{SETTINGS_KEY}/aside"), &kept);
        }
        // A full storage only means that the settings are not remembered.
        let _ = host.store(SETTINGS_KEY, &text);
    }
}

fn is_settings(text: &str) -> bool {
    serde_json::from_str::<Settings>(text).is_ok()
}
