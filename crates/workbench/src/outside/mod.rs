//! What the app tells and hears through its host: remembered settings, addresses, and its state as plain JSON.

mod address;
mod keeper;
mod page_state;

use mission::review::Record;

use crate::host::Host;
use crate::state::review::ReviewState;
use crate::state::{AppState, Settings};

pub use address::{fragment, open_fragment, show_address};
pub use keeper::Keeper;
pub use page_state::PageState;

/// What reviewers said of the open mission when it was last kept.
pub fn recall_review(host: &dyn Host, state: &mut AppState) {
    let kept = host.stored(&ReviewState::key(&state.mission_key()));
    state.recall_review(kept.as_deref());
}

/// Keeps what reviewers said of the open mission; `joins` adds what is kept already, perhaps by another tab. A full
/// storage leaves what is kept as it was, and the app's own record too: the review then says that it is not kept.
pub fn keep_review(host: &mut dyn Host, state: &mut AppState, joins: bool) {
    let key = ReviewState::key(&state.mission_key());
    if joins && let Some(Ok(kept)) = host.stored(&key).map(|text| Record::from_json(&text)) {
        state.review.join(kept);
        state.judge_reviews();
    }
    let outcome = if state.review.record().is_empty() {
        host.forget(&key);
        Ok(())
    } else {
        host.store(&key, &state.review.record().to_json())
    };
    state.review.kept(outcome.map_err(|reason| reason.to_string()));
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
