//! What tabs that show the same missions tell each other, so that they agree or say that they do not.

use serde::{Deserialize, Serialize};

use crate::effect::Effect;
use crate::host::Host;
use crate::host_io::autosave::Autosave;
use crate::library::{Mission, MissionId, Version, print};
use crate::state::AppState;

/// What a tab says.
#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
enum Message {
    /// The main text of a mission was changed.
    Text {
        id: MissionId,
        /// The print of the text that the change was made to.
        base: u64,
        text: String,
        changed_millis: i64,
    },
    /// A mission is new, or something else of it was changed.
    Mission { json: String },
    /// Something was done for the review of a mission: it is kept.
    Review { mission: String },
    /// The keys of people were changed: they are kept.
    Keys,
}

/// What a tab calls the version of another one that it could not agree with.
const OTHER_TAB: &str = "From another tab";

impl Autosave {
    /// Tells the text of the open mission, if it is not what the tabs agree on.
    pub(super) fn tell_text(&mut self, state: &AppState, host: &mut dyn Host) {
        let Some(mission) = state.library.open_mission() else { return };
        let text = mission.joined_text();
        let now = print(&text);
        let base = match &self.agreed {
            Some((id, base)) if *id == mission.id => *base,
            _ => now,
        };
        if base != now {
            let message =
                Message::Text { id: mission.id.clone(), base, text, changed_millis: mission.changed_millis };
            tell(host, &message);
        }
        self.agreed = Some((mission.id.clone(), now));
    }

    /// Takes in what another tab says.
    pub fn hear_tab(&mut self, state: &mut AppState, message: &str) {
        // Another version of the program may say what is not known here.
        let Ok(message) = serde_json::from_str(message) else { return };
        match message {
            Message::Review { mission } if state.mission_key() == mission => {
                state.window.ask(Effect::HearReview);
            }
            Message::Review { .. } => {}
            Message::Keys => state.window.ask(Effect::RecallKeys),
            Message::Text { id, base, text, changed_millis } => {
                self.hear_text(state, &id, base, &text, changed_millis);
            }
            Message::Mission { json } => {
                let Ok(mut mission) = Mission::from_json(&json) else { return };
                let is_open = state.library.open_id() == Some(&mission.id);
                // The open text is told by itself, and must not change under the caret here.
                if is_open {
                    mission.say(state.document.text());
                }
                state.library.take_in(mission);
                if let Some(open) = state.library.open_mission().filter(|_| is_open) {
                    state.mission = open.name.clone();
                }
            }
        }
    }

    fn hear_text(
        &mut self,
        state: &mut AppState,
        id: &MissionId,
        base: u64,
        text: &str,
        changed_millis: i64,
    ) {
        let is_open = state.library.open_id() == Some(id);
        let Some(mut mission) = state.library.mission(id).cloned() else { return };
        if !is_open {
            mission.say(text);
            state.library.take_in(Mission { changed_millis, ..mission });
            return;
        }
        let mine = print(state.document.text());
        if mine == print(text) {
            self.agreed = Some((id.clone(), mine));
        } else if mine == base {
            state.adopt_text(text);
            self.noted_revision = state.document.revision();
            state.note_text();
            self.agreed = Some((id.clone(), print(text)));
        } else {
            mission.say(text);
            let version =
                Version { name: OTHER_TAB.to_owned(), at_millis: changed_millis, texts: mission.texts };
            state.library.put_version(id, version);
            let text = "This mission was also edited in another tab. The other tab's text was saved as a \
                        version.";
            state.window.failed(text);
        }
    }
}

/// Tells everything of a mission but its maps.
pub(super) fn tell_mission(state: &AppState, host: &mut dyn Host, id: &MissionId) {
    if let Some(mission) = state.library.mission(id) {
        tell(host, &Message::Mission { json: mission.without_maps().to_json() });
    }
}

/// Tells that the review of a mission has been kept.
pub fn tell_review(host: &mut dyn Host, mission: &str) {
    tell(host, &Message::Review { mission: mission.to_owned() });
}

/// Tells that the keys of people have been kept.
pub fn tell_keys(host: &mut dyn Host) {
    tell(host, &Message::Keys);
}

fn tell(host: &mut dyn Host, message: &Message) {
    if let Ok(text) = serde_json::to_string(message) {
        host.tell_tabs(&text);
    }
}
