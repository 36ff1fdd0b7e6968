//! The manual as it is looked at: which page, where on it, and what is looked for.

use crate::manual::{self, Found};
use crate::panel_kind::PanelKind;
use crate::state::window::Window;

/// The manual as it is looked at.
#[derive(Debug, Default)]
pub struct ManualState {
    place: Option<(&'static str, String)>,
    before: Vec<(&'static str, String)>,
    query: String,
    found: Vec<Found>,
    /// Counts the places that were opened, so that the panel scrolls to each once.
    opened: u64,
}

/// What can be asked of the manual.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ManualCommand {
    /// Opens a page at a section; an empty section is its beginning.
    Open(&'static str, String),
    /// Opens what tells about the part of the text under the pointer, or else about a panel.
    About(PanelKind),
    /// Looks for words; nothing shows the page again.
    Search(String),
    /// Back to the place before.
    Back,
    /// Shows the contents.
    Contents,
}

impl ManualState {
    /// The page and the section that are shown; nothing while the contents are.
    pub fn place(&self) -> Option<(&'static str, &str)> {
        self.place.as_ref().map(|(page, section)| (*page, section.as_str()))
    }

    /// Returns what is looked for.
    pub fn query(&self) -> &str {
        &self.query
    }

    /// The places in the manual that have the searched words.
    pub fn found(&self) -> &[Found] {
        &self.found
    }

    /// Counts the places that were opened.
    pub const fn opened(&self) -> u64 {
        self.opened
    }

    /// Returns whether there is a place to go back to.
    pub fn can_go_back(&self) -> bool {
        !self.before.is_empty()
    }

    fn go(&mut self, place: Option<(&'static str, String)>) {
        self.query.clear();
        self.found.clear();
        self.place = place;
        self.opened += 1;
    }
}

impl ManualState {
    /// Does what a command asks for; `about_text` is the page and the section about what is pointed at in the text.
    pub(crate) fn apply(
        &mut self,
        command: ManualCommand,
        about_text: Option<(&'static str, String)>,
        window: &mut Window,
    ) {
        match command {
            ManualCommand::Open(page, section) => {
                self.open(page, section);
                // Who follows a link with the keyboard reads on there.
                window.turn_to(PanelKind::Manual);
                window.focus_panel(PanelKind::Manual);
                return;
            }
            ManualCommand::About(panel) => {
                let (page, section) = about_text.unwrap_or_else(|| (panel.manual(), String::new()));
                self.open(page, section);
            }
            ManualCommand::Search(query) => {
                self.found = manual::search(&query);
                self.query = query;
            }
            ManualCommand::Back => {
                let before = self.before.pop();
                self.go(before);
            }
            ManualCommand::Contents => {
                self.before.extend(self.place.take());
                self.go(None);
            }
        }
        window.turn_to(PanelKind::Manual);
    }

    fn open(&mut self, page: &'static str, section: String) {
        self.before.extend(self.place.take());
        self.go(Some((page, section)));
    }
}
