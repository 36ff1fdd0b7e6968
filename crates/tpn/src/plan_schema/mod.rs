//! Interchange with plan-schema (DESIGN 4.4): temporal plan networks as other tools write and read them, JSON or EDN.

mod edn;
mod read;
mod write;

use serde_json::{Map, Value};

pub use edn::EdnError;
pub use write::write;

use crate::network::Network;

/// Why a file is no network.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanSchemaError {
    /// It is neither JSON nor EDN.
    #[error("this is neither JSON ({json}) nor EDN ({edn})")]
    Notation {
        /// Why not JSON.
        json: String,
        /// Why not EDN.
        edn: EdnError,
    },
    /// It is data, but not a map of objects with a network.
    #[error("{0}")]
    Shape(String),
    /// An object refers to one that is not there.
    #[error("`{from}` refers to `{to}`, which the file does not have")]
    Dangling {
        /// The object.
        from: String,
        /// What it names.
        to: String,
    },
    /// A bound is not an exact time, or the lower one is greater.
    #[error("`{uid}`: {problem}")]
    Bounds {
        /// The constraint.
        uid: String,
        /// What is wrong with it.
        problem: String,
    },
}

/// What says of a temporal constraint that it is between threads, so that it selects neither of its events.
const BETWEEN_THREADS: &str = "between-threads";

/// A network of another tool, with everything its file says.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// The network as planning sees it. It has no structure and no places in a text.
    pub network: Network,
    /// All objects as they were read, by uid, with every key: [`Document::to_json`] writes them back.
    pub objects: Map<String, Value>,
    /// The uid of each node; `None` for one that was added to carry the bounds of a choice.
    pub node_uids: Vec<Option<String>>,
    /// The uid of the object that each arc comes from.
    pub arc_uids: Vec<Option<String>>,
    /// What was read but means nothing to planning: costs, rewards and kinds of object that are not known.
    pub not_planned: Vec<String>,
}

impl Document {
    /// Reads a file in either notation.
    pub fn parse(text: &str) -> Result<Self, PlanSchemaError> {
        let value = match serde_json::from_str::<Value>(text) {
            Ok(value) => value,
            Err(json) => {
                edn::parse(text).map_err(|edn| PlanSchemaError::Notation { json: json.to_string(), edn })?
            }
        };
        match value {
            Value::Object(objects) => read::read(objects),
            _ => Err(PlanSchemaError::Shape("the file is not a map of objects".to_owned())),
        }
    }

    /// Whether `text` looks like a plan-schema file in either notation, rather than a mission in RMPL.
    pub fn looks_like(text: &str) -> bool {
        let text = text.trim_start();
        text.starts_with('{') && (text.contains("network-id") || text.contains("tpn-type"))
    }

    /// The file again in JSON, unknown keys included.
    pub fn to_json(&self) -> Value {
        Value::Object(self.objects.clone())
    }
}
