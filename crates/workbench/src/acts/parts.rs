//! Parts of the state lent together, for what is done to one with the help of others.

use crate::state::AppState;
use crate::state::editing::Writing;
use crate::state::part::Part;
use crate::state::review::Reviewing;
use crate::state::settings::Settings;
use crate::state::terrain::TerrainState;

impl AppState {
    /// The text, with what its commands read and change of other parts.
    pub(crate) fn writing(&mut self) -> Writing<'_> {
        self.on_terrain().2
    }

    /// The ground with the settings of its view, and the text in which things are declared on it.
    pub(crate) fn on_terrain(&mut self) -> (&mut Part<TerrainState>, &mut Part<Settings>, Writing<'_>) {
        let main_text = self.main_text();
        let writing = Writing {
            document: &mut self.document,
            language: &mut self.language,
            editor: &mut self.editor,
            selection: &mut self.selection,
            window: &mut self.window,
            snapshots: &self.snapshots,
            maps: &self.maps,
            mission: &self.mission,
            main_text,
            now_secs: self.frame.now_secs,
        };
        (&mut self.terrain, &mut self.settings, writing)
    }

    /// The review, with what it is about.
    pub(crate) fn reviewing(&mut self) -> Reviewing<'_> {
        let mission_key = self.mission_key();
        Reviewing {
            review: &mut self.review,
            keys: &self.keys,
            chance: &mut self.chance,
            settings: &mut self.settings,
            window: &mut self.window,
            document: &mut self.document,
            snapshots: &self.snapshots,
            mission: &self.mission,
            mission_key,
            unix_millis: self.frame.unix_millis,
        }
    }
}
