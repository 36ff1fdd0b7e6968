//! What the app tells and hears through its host: remembered settings, addresses, and its state as plain JSON.

mod address;
mod draft;
mod hca_json;
mod state_json;

use crate::host::Host;
use crate::state::Settings;

pub use address::{fragment, open_fragment};
pub use draft::DraftKeeper;
pub use state_json::state_json;

const SETTINGS_KEY: &str = "enroute/settings-1";

/// The settings of the last run.
pub fn remembered_settings(host: &dyn Host) -> Option<Settings> {
    serde_json::from_str(&host.stored(SETTINGS_KEY)?).ok()
}

/// Keeps the settings for the next run.
pub fn remember_settings(host: &mut dyn Host, settings: &Settings) {
    if let Ok(text) = serde_json::to_string(settings) {
        // A full storage only means that the settings are not remembered.
        let _ = host.store(SETTINGS_KEY, &text);
    }
}
