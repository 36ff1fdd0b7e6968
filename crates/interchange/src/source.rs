//! Reading a network from a file, whichever of the known formats it is in.

use serde_json::Value;

use crate::geojson;
use crate::plan_schema::{Document, PlanSchemaError};
use crate::plandev::{self, PlanDevError};
use crate::ptpn::{self, PtpnError, is_ptpn};
use tpn::network::Network;
use tpn::network_json::{NetworkError, network_from_json};

/// Why a file is not a network.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReadError {
    /// It is an `enroute-tpn/1` document, but not a well-formed one.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// It is XML, but no pTPN that can be read.
    #[error(transparent)]
    Ptpn(#[from] PtpnError),
    /// It is a plan of `PlanDev` that cannot be read.
    #[error(transparent)]
    PlanDev(#[from] PlanDevError),
    /// It is JSON of another kind.
    #[error("this is {0}")]
    Other(&'static str),
    /// It is not a plan-schema file either.
    #[error(transparent)]
    PlanSchema(#[from] PlanSchemaError),
}

/// Returns whether a text is to be read as a network: it begins with a map of JSON or EDN or as a pTPN, as no mission
/// in RMPL does.
pub fn is_network_text(text: &str) -> bool {
    if is_ptpn(text) {
        return true;
    }
    let mut rest = text.strip_prefix('\u{feff}').unwrap_or(text).trim_start();
    // Comments of EDN.
    while let Some(comment) = rest.strip_prefix(';') {
        rest = comment.split_once('\n').map_or("", |(_, rest)| rest).trim_start();
    }
    let first = rest.strip_prefix('{').map(str::trim_start);
    first.is_some_and(|first| first.starts_with(['"', ':']))
}

/// Returns whether the text of a file is that of a network, and not of another document in JSON.
pub fn is_network_file(text: &str) -> bool {
    let is_ours = || text.contains("\"nodes\"") && text.contains("\"arcs\"") && text.contains("enroute-tpn/");
    let is_theirs = || ["network-id", "tpn-type"].iter().any(|key| text.contains(key));
    is_network_text(text) && (is_ptpn(text) || is_theirs() || is_ours() || is_plandev_text(text))
}

/// Returns whether the text of a file is a plan of `PlanDev`.
pub fn is_plandev_text(text: &str) -> bool {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    text.contains("\"activities\"")
        && serde_json::from_str(text).is_ok_and(|file: Value| plandev::is_plan(&file))
}

/// A network as it was written.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// Our own JSON (DESIGN 4.2).
    Enroute(Box<Network>),
    /// Another tool's (DESIGN 4.4), as plan-schema says it.
    PlanSchema(Box<Document>),
}

impl Source {
    /// Reads `text`: `enroute-tpn/1` JSON, plan-schema in JSON or EDN, a pTPN, or a plan of `PlanDev`.
    pub fn read(text: &str) -> Result<Self, ReadError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        if is_ptpn(text) {
            return Ok(Self::PlanSchema(Box::new(ptpn::read(text)?)));
        }
        if let Ok(value) = serde_json::from_str::<Value>(text) {
            if value.get("nodes").is_some() && value.get("arcs").is_some() {
                return Ok(Self::Enroute(Box::new(network_from_json(&value)?)));
            }
            if plandev::is_plan(&value) {
                return Ok(Self::PlanSchema(Box::new(plandev::read(&value)?)));
            }
            if let Some(kind) = kind_of_other(&value) {
                return Err(ReadError::Other(kind));
            }
        }
        Ok(Self::PlanSchema(Box::new(Document::parse(text)?)))
    }

    /// Returns what the file says and planning does not honor, in words.
    pub fn not_honored(&self) -> Vec<String> {
        match self {
            Self::Enroute(_) => Vec::new(),
            Self::PlanSchema(document) => document.not_honored(),
        }
    }

    /// The network that was read, whatever the format.
    pub fn into_network(self) -> Network {
        match self {
            Self::Enroute(network) => *network,
            Self::PlanSchema(document) => document.network,
        }
    }
}

/// Returns what a document in JSON is that has no network, as far as its members tell, and what to do with it.
fn kind_of_other(document: &Value) -> Option<&'static str> {
    let has = |key: &str| document.get(key).is_some();
    let format = document.get("format").and_then(Value::as_str).unwrap_or_default();
    let ours = [
        (
            "enroute-plan/",
            "a plan that Enroute wrote, not its mission; give it to `enroute verify` with the mission",
        ),
        ("enroute-review/", "a review history; use `enroute review`"),
        ("enroute-simulate/", "the log of a simulation, not a network"),
        ("enroute-robustness/", "a Monte Carlo result; use `enroute report --robustness`"),
        ("enroute-schedule/", "a schedule that Enroute exported, not a network"),
        ("enroute-", "a document of Enroute that has no network"),
    ];
    if let Some((_, kind)) = ours.into_iter().find(|(start, _)| format.starts_with(start)) {
        return Some(kind);
    }
    if geojson::is_geojson(document) {
        return Some("GeoJSON; use `enroute import`");
    }
    let of_simulation =
        ["spans", "resources", "realProfiles", "discreteProfiles", "profiles", "simulationEvents"];
    let is_list_of_spans = document.get("spans").is_some_and(Value::is_array);
    if of_simulation.iter().filter(|key| has(key)).count() > 1
        || is_list_of_spans
        || has("simulation_dataset_id")
    {
        return Some("the result of a simulation in PlanDev (Aerie), not a plan; export the plan");
    }
    if has("openmct") && has("rootId") {
        return Some("an export of Open MCT objects; an Open MCT plan has no network");
    }
    let is_activity = |it: &Value| ["start", "end"].iter().all(|key| it.get(key).is_some());
    let is_open_mct =
        |group: &Value| group.as_array().is_some_and(|group| group.first().is_none_or(is_activity));
    let has_activities = |group: &Value| group.as_array().is_some_and(|group| !group.is_empty());
    let groups = document.as_object();
    if groups.is_some_and(|it| it.values().all(is_open_mct) && it.values().any(has_activities)) {
        return Some("a plan of Open MCT: it has times, but no network that could be planned");
    }
    if has("$schema") && has("properties") {
        return Some("a JSON Schema, not a network");
    }
    if document.get("type").and_then(Value::as_str) == Some("Topology") {
        return Some("TopoJSON; convert it to GeoJSON, then use `enroute import`");
    }
    if has("nbformat") && has("cells") {
        return Some("a Jupyter notebook, not a network");
    }
    let first = document.as_array().and_then(|packets| packets.first());
    if first.and_then(|packet| packet.get("id")).and_then(Value::as_str) == Some("document") {
        return Some("CZML, a scene of Cesium, not a network");
    }
    if has("steps") && (has("metadata") || has("id")) {
        return Some("a sequence of commands (SeqJSON), not a plan; export the plan");
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_documents_are_called_what_they_are() {
        for (text, told) in [
            (r#"{"Group": [{"name": "a", "start": 1, "end": 2, "type": "g"}]}"#, "a plan of Open MCT"),
            (r#"{"openmct": {}, "rootId": "x"}"#, "Open MCT objects"),
            (r#"{"spans": [], "resources": {}}"#, "simulation in PlanDev"),
            (r#"{"realProfiles": {}, "discreteProfiles": {}}"#, "simulation in PlanDev"),
            (r#"{"spans": []}"#, "simulation in PlanDev"),
            (r#"{"type": "Topology", "objects": {}}"#, "TopoJSON"),
            (r#"{"cells": [], "nbformat": 4}"#, "notebook"),
            (r#"[{"id": "document", "version": "1.0"}]"#, "CZML"),
            (r#"{"id": "s1", "metadata": {}, "steps": []}"#, "SeqJSON"),
            (r#"{"type": "Point", "coordinates": [1, 2]}"#, "GeoJSON"),
            (r#"{"format": "enroute-plan/1", "plans": []}"#, "a plan that Enroute wrote"),
            (r#"{"format": "enroute-path/1"}"#, "a document of Enroute"),
        ] {
            let error = Source::read(text).expect_err("it is no network").to_string();
            assert!(error.contains(told), "{text}: {error}");
        }
    }

    #[test]
    fn networks_and_missions_are_told_apart_by_how_they_begin() {
        for text in ["{\"a\": 1}", "\u{feff}{ :network-id :a }", "; made by hand\n{:a 1}", "{\n  \"a\": {}}"]
        {
            assert!(is_network_text(text), "{text}");
        }
        for text in ["", "{", "{ A(); B() }", "scenario S { }", "[1]", "// {\"a\": 1}", ";"] {
            assert!(!is_network_text(text), "{text}");
        }
        assert!(is_network_text("<?xml version=\"1.0\"?>\n<tpns/>") && !is_network_text("<svg/>"));
        assert!(is_network_file("{:network-id :a}"));
        assert!(is_network_file("\u{feff}{ \"activities\": [], \"model_id\": 1 }"));
        assert!(!is_network_file("{ \"activities\": [], \"format\": \"enroute-schedule/1\" }"));
        assert!(!is_network_file("{\"format\": \"enroute-review/1\"}"));
    }
}
