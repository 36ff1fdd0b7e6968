//! Turning the network of another tool into a mission in RMPL, and writing networks for other tools.

use interchange::is_plandev_text;
use interchange::ptpn::{self, is_ptpn};
use interchange::{plan_schema, rmpl_text};

use crate::command::Availability;
use crate::state::{AppState, Effect, ToastKind};

/// What the version is called in which the text of the network is kept.
const VERSION: &str = "Network";

/// A notation of networks that other tools read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NetworkForm {
    /// plan-schema, in JSON.
    PlanSchema,
    /// The XML of `RMPyL`.
    Ptpn,
}

/// What a file with the text of a network ends in.
pub(super) fn network_ending(text: &str) -> &'static str {
    if is_ptpn(text) {
        ".tpn"
    } else if text.contains(":network-id") {
        ".tpn.edn"
    } else if is_plandev_text(text) {
        ".plandev.json"
    } else {
        ".tpn.json"
    }
}

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

    /// Writes the network as it is shown. A file that another tool wrote in this notation is saved as it was written, with
    /// what is not understood.
    pub(super) fn write_network(&mut self, form: NetworkForm) {
        match self.network_as(form) {
            Ok((ending, text)) => {
                let name = format!("{}{ending}", self.mission);
                self.effects.push(Effect::SaveFile { name, bytes: text.into_bytes() });
            }
            Err(reason) => {
                self.toasts.add(ToastKind::Failed, format!("The network is not written: {reason}"));
            }
        }
    }

    fn network_as(&self, form: NetworkForm) -> Result<(&'static str, String), String> {
        let text = self.document.text();
        let is_written_so = match form {
            NetworkForm::PlanSchema => text.contains("tpn-type") && !is_ptpn(text) && !is_plandev_text(text),
            NetworkForm::Ptpn => is_ptpn(text),
        };
        if self.language.is_network() && is_written_so {
            return Ok((network_ending(text), text.to_owned()));
        }
        if self.snapshots.is_stale(self.document.revision()) {
            return Err("what is shown is of an earlier text".to_owned());
        }
        let network = self.shown().and_then(|shown| shown.network.as_deref());
        let network = network.ok_or("there is none")?;
        match form {
            NetworkForm::PlanSchema => {
                let text = serde_json::to_string_pretty(&plan_schema::write(network));
                Ok((".tpn.json", format!("{}\n", text.map_err(|error| error.to_string())?)))
            }
            NetworkForm::Ptpn => Ok((".tpn", ptpn::write(network).map_err(|error| error.to_string())?)),
        }
    }

    fn network_in_rmpl(&self) -> Result<String, String> {
        self.has_read_network()?;
        let shown = self.shown().ok_or("the network is still being read")?;
        let network = shown.network.as_deref().ok_or("the network cannot be read")?;
        let said: Vec<String> = shown.problems.iter().map(|problem| problem.message.clone()).collect();
        rmpl_text::write(network, &said).map_err(|obstacle| obstacle.told(network, &[], &[]))
    }
}
