//! Reading a network from a file, whichever of the known formats it is in.

use serde_json::Value;

use crate::network::Network;
use crate::network_json::{NetworkError, network_from_json};
use crate::plan_schema::{Document, PlanSchemaError};

/// Why a file is no network.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReadError {
    /// It is an `enroute-tpn/1` document, but not a well-formed one.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// It is no plan-schema file either.
    #[error(transparent)]
    PlanSchema(#[from] PlanSchemaError),
}

/// Whether a text is to be read as a network: it begins with a map of JSON or EDN, as no mission in RMPL does.
pub fn is_network_text(text: &str) -> bool {
    let mut rest = text.strip_prefix('\u{feff}').unwrap_or(text).trim_start();
    // Comments of EDN.
    while let Some(comment) = rest.strip_prefix(';') {
        rest = comment.split_once('\n').map_or("", |(_, rest)| rest).trim_start();
    }
    let first = rest.strip_prefix('{').map(str::trim_start);
    first.is_some_and(|first| first.starts_with(['"', ':']))
}

/// Whether the text of a file is that of a network, and not of another document in JSON.
pub fn is_network_file(text: &str) -> bool {
    let is_ours = || text.contains("\"nodes\"") && text.contains("\"arcs\"") && text.contains("enroute-tpn/");
    is_network_text(text) && (["network-id", "tpn-type"].iter().any(|key| text.contains(key)) || is_ours())
}

/// A network as it was written.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// Our own JSON (DESIGN 4.2).
    Enroute(Box<Network>),
    /// Another tool's (DESIGN 4.4).
    PlanSchema(Box<Document>),
}

impl Source {
    /// Reads `text`: `enroute-tpn/1` JSON, or plan-schema in JSON or EDN.
    pub fn read(text: &str) -> Result<Self, ReadError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        if let Ok(value) = serde_json::from_str::<Value>(text)
            && value.get("nodes").is_some()
            && value.get("arcs").is_some()
        {
            return Ok(Self::Enroute(Box::new(network_from_json(&value)?)));
        }
        Ok(Self::PlanSchema(Box::new(Document::parse(text)?)))
    }

    /// What the file says and planning does not honour, in words.
    pub fn not_honoured(&self) -> Vec<String> {
        match self {
            Self::Enroute(_) => Vec::new(),
            Self::PlanSchema(document) => document.not_honoured(),
        }
    }

    /// The network.
    pub fn into_network(self) -> Network {
        match self {
            Self::Enroute(network) => *network,
            Self::PlanSchema(document) => document.network,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn networks_and_missions_are_told_apart_by_how_they_begin() {
        for text in ["{\"a\": 1}", "\u{feff}{ :network-id :a }", "; made by hand\n{:a 1}", "{\n  \"a\": {}}"]
        {
            assert!(is_network_text(text), "{text}");
        }
        for text in ["", "{", "{ A(); B() }", "scenario S { }", "[1]", "// {\"a\": 1}", ";"] {
            assert!(!is_network_text(text), "{text}");
        }
        assert!(is_network_file("{:network-id :a}"));
        assert!(!is_network_file("{\"format\": \"enroute-review/1\"}"));
    }
}
