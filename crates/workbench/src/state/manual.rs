//! The manual as it is looked at: which page, where on it, and what is looked for.

use crate::PanelKind;
use crate::manual::{self, Found};
use crate::state::AppState;

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

    /// What is looked for.
    pub fn query(&self) -> &str {
        &self.query
    }

    /// Where it stands.
    pub fn found(&self) -> &[Found] {
        &self.found
    }

    /// Counts the places that were opened.
    pub const fn opened(&self) -> u64 {
        self.opened
    }

    /// Whether there is a place to go back to.
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

impl AppState {
    /// The page and the section about what the pointer is over in the text, or else about what the caret is at while the
    /// text is the panel asked about: a problem there, or the part of the language.
    fn about_text(&self, panel: PanelKind) -> Option<(&'static str, String)> {
        let caret = || (panel == PanelKind::Editor).then(|| self.document.caret().head);
        let place = self.editor.hovered.or_else(caret)? as u32;
        let is_there = |span: rmpl::Span| span.start <= place && place <= span.end;
        let problem = self.snapshots.problems().iter().find(|problem| is_there(problem.span));
        problem.and_then(|problem| manual::about_code(&problem.code)).or_else(|| {
            let hover =
                rmpl::editor::hover(self.language.parse()?, place, &rmpl::editor::Evaluation::default())?;
            let (page, section) = manual::about_topic(hover.topic);
            Some((page, section.to_owned()))
        })
    }

    pub(super) fn apply_to_manual(&mut self, command: ManualCommand) {
        let manual = &mut self.manual;
        match command {
            ManualCommand::Open(page, section) => {
                manual.before.extend(manual.place.take());
                manual.go(Some((page, section)));
            }
            ManualCommand::About(panel) => {
                let about_text = self.about_text(panel);
                let (page, section) = about_text.unwrap_or_else(|| {
                    let (page, section) = panel.manual();
                    (page, section.to_owned())
                });
                return self.apply_to_manual(ManualCommand::Open(page, section));
            }
            ManualCommand::Search(query) => {
                manual.found = manual::search(&query);
                manual.query = query;
            }
            ManualCommand::Back => {
                let before = manual.before.pop();
                manual.go(before);
            }
            ManualCommand::Contents => {
                manual.before.extend(manual.place.take());
                manual.go(None);
            }
        }
        self.show_panel(PanelKind::Manual);
        self.active_panel = PanelKind::Manual;
    }
}
