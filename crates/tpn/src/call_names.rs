//! What people read for a call: its activity with the arguments, instead of its identifier.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use smol_str::SmolStr;

/// Readable names for texts in which calls are identifiers: calls with their arguments (SPEC 17).
#[derive(Clone, Debug, Default)]
pub(crate) struct CallNames {
    by_identifier: BTreeMap<SmolStr, String>,
}

impl CallNames {
    /// The names for people, by identifier.
    pub(crate) const fn of(by_identifier: BTreeMap<SmolStr, String>) -> Self {
        Self { by_identifier }
    }

    /// The text with its identifiers of calls replaced by their readable names.
    pub(crate) fn in_text(&self, text: &str) -> String {
        let mut shown = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(at) = rest.find('#') {
            let is_of_name = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-');
            let start = rest[..at].trim_end_matches(is_of_name).len();
            let behind = &rest[at + 1..];
            let end = rest.len() - behind.trim_start_matches(|c: char| c.is_ascii_digit()).len();
            shown.push_str(&rest[..start]);
            let identifier = &rest[start..end];
            shown.push_str(self.by_identifier.get(identifier).map_or(identifier, String::as_str));
            rest = &rest[end..];
        }
        shown.push_str(rest);
        shown
    }
}

/// The names of a network's calls, made when they are first asked for: no part of what the network is.
#[derive(Debug, Default)]
pub struct NamesOnDemand(OnceLock<CallNames>);

impl Clone for NamesOnDemand {
    /// The copy may get other calls.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl PartialEq for NamesOnDemand {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl NamesOnDemand {
    pub(crate) fn get(&self, make: impl FnOnce() -> CallNames) -> &CallNames {
        self.0.get_or_init(make)
    }
}
