//! Turning the network of another tool into a mission in RMPL.

use tpn::rmpl_text;

use crate::command::Availability;
use crate::state::{AppState, ToastKind};

/// What the version is called in which the text of the network is kept.
const VERSION: &str = "Network";

impl AppState {
    /// Whether the text is a network that was read as it stands.
    pub(crate) fn has_read_network(&self) -> Availability {
        if !self.language.is_network() {
            return Err("the text is not the network of another tool");
        }
        if self.snapshots.is_stale(self.document.revision()) {
            return Err("the network is still being read");
        }
        let is_read = self.shown().is_some_and(|shown| shown.network.is_some());
        if is_read { Ok(()) } else { Err("the network cannot be read") }
    }

    /// The text becomes that of a mission which compiles to the same network. What it was is kept as a version, beside
    /// the history of the text.
    pub(super) fn turn_into_rmpl(&mut self) {
        let text = match self.network_in_rmpl() {
            Ok(text) => text,
            Err(reason) => {
                self.toasts
                    .add(ToastKind::Failed, format!("The network cannot be written in RMPL: {reason}"));
                return;
            }
        };
        if self.refuses_text(text.len()) {
            return;
        }
        self.mission_of_its_own();
        self.library.keep_version(VERSION, self.frame.unix_millis);
        self.document.replace_all(&text);
        let words = format!(
            "The network is a mission in RMPL now. Undo brings it back, and the version \"{VERSION}\" keeps it"
        );
        self.toasts.add(ToastKind::Done, words);
    }

    fn network_in_rmpl(&self) -> Result<String, String> {
        self.has_read_network()?;
        let shown = self.shown().ok_or("the network is still being read")?;
        let network = shown.network.as_deref().ok_or("the network cannot be read")?;
        let said: Vec<String> = shown.problems.iter().map(|problem| problem.message.clone()).collect();
        rmpl_text::write(network, &said).map_err(|obstacle| obstacle.told(network, &[], &[]))
    }
}
