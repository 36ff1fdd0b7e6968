//! A text that is a network of another tool (plan-schema, or our own JSON) instead of a mission in RMPL.

use std::sync::Arc;

use interchange::Source;
use rmpl::diagnostics::{network, unreadable_network};
use rmpl::{Diagnostic, Severity};
use tpn::Network;

/// A network as its text says.
#[derive(Clone, Debug)]
pub(crate) struct NetworkText {
    text: String,
    /// The network, if the text can be read.
    pub(crate) network: Option<Arc<Network>>,
    /// What is to be said of the text.
    pub(crate) found: Vec<Diagnostic>,
}

impl NetworkText {
    /// Reads a text for which [`interchange::is_network_text`] holds.
    pub(crate) fn read(text: &str) -> Self {
        let (network, found) = match Source::read(text) {
            Ok(source) => {
                let not_honored = source.not_honored();
                let told = (!not_honored.is_empty()).then(|| network::not_honored(&not_honored));
                (Some(Arc::new(source.into_network())), told.into_iter().collect())
            }
            Err(reason) => (None, vec![unreadable_network::unreadable(&reason.to_string())]),
        };
        Self { text: text.to_owned(), network, found }
    }

    /// Returns whether it was read from this text.
    pub(crate) fn is_of(&self, text: &str) -> bool {
        self.text == text
    }

    /// Returns whether there is nothing wrong with it.
    pub(crate) fn is_sound(&self) -> bool {
        self.found.iter().all(|found| found.severity != Severity::Error)
    }
}
