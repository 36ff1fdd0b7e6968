//! Interchange with plan-schema (DESIGN 4.4): temporal plan networks as other tools write and read them, JSON or EDN.

mod edn;
mod read;
#[cfg(test)]
mod tests;
mod write;

use std::collections::BTreeMap;

use serde_json::{Map, Value};

pub use edn::EdnError;
pub use write::write;

use tpn::network::Network;

/// Why a file is not a network.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanSchemaError {
    /// It is neither JSON nor EDN.
    #[error("this is neither JSON ({json}) nor EDN ({edn})")]
    Notation { json: String, edn: EdnError },
    /// It is data, but not a map of objects with a network.
    #[error("{0}")]
    Shape(String),
    /// An object refers to one that is not there.
    #[error("`{from}` refers to `{to}`, which is not in the file")]
    Dangling {
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
pub(crate) const BETWEEN_THREADS: &str = "between-threads";

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
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let value = match serde_json::from_str::<Value>(text) {
            Ok(value) => value,
            Err(json) => {
                edn::parse(text).map_err(|edn| PlanSchemaError::Notation { json: json.to_string(), edn })?
            }
        };
        match value {
            Value::Object(objects) => Self::of_objects(objects),
            Value::Array(_) if text.contains("plan/by-plid") => Err(PlanSchemaError::Shape(
                "plans merged by plan-schema are not supported; open the plan network, usually named `.tpn.edn`"
                    .to_owned(),
            )),
            _ => Err(PlanSchemaError::Shape("the file must be a map of objects".to_owned())),
        }
    }

    /// Reads objects by uid, as a file has them.
    pub(crate) fn of_objects(objects: Map<String, Value>) -> Result<Self, PlanSchemaError> {
        read::read(objects)
    }

    /// Returns what the file says and planning does not honor, in words, each with how often: costs and rewards,
    /// durations that are not the executive's to choose, guards, probabilities, and kinds of object that are not known.
    pub fn not_honored(&self) -> Vec<String> {
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        for object in self.objects.values().filter(|object| object.is_object()) {
            for said in said_in_vain(object) {
                *counts.entry(said).or_default() += 1;
            }
        }
        let told = |(what, count)| if count == 1 { what } else { format!("{what} ({count} times)") };
        counts.into_iter().map(told).collect()
    }

    /// The file again in JSON, unknown keys included.
    pub fn to_json(&self) -> Value {
        Value::Object(self.objects.clone())
    }
}

/// Returns what one object says that planning does not honor.
fn said_in_vain(object: &Value) -> Vec<String> {
    const KNOWN: [&str; 11] = [
        "network",
        "state",
        "c-begin",
        "c-end",
        "p-begin",
        "p-end",
        "activity",
        "null-activity",
        "delay-activity",
        "temporal-constraint",
        "",
    ];
    let kind = read::kind(object).to_ascii_lowercase();
    let mut said = Vec::new();
    if kind.contains("cost") {
        said.push("a limit on cost".to_owned());
    } else if kind.contains("reward") {
        said.push("a limit on reward".to_owned());
    } else if !KNOWN.contains(&kind.as_str()) {
        said.push(format!("an object of the unknown type `{kind}`"));
    }
    let counts = |key: &str| object.get(key).and_then(Value::as_f64).is_some_and(|number| number != 0.0);
    if counts("cost") {
        said.push("a cost".to_owned());
    }
    if counts("reward") {
        said.push("a reward".to_owned());
    }
    let holds = |key: &str| object.get(key).is_some_and(|value| !is_nothing(value));
    if kind == "c-begin" && object.get("controllable") == Some(&Value::Bool(false)) {
        said.push("a choice that is not controllable".to_owned());
    }
    if holds("state-constraint") {
        said.push("a state constraint".to_owned());
    }
    if (kind.ends_with("activity") || kind == "temporal-constraint")
        && object.get("controllable") == Some(&Value::Bool(false))
    {
        said.push("a duration that is not controllable".to_owned());
    }
    if read::is_variable(object.get("value")) {
        said.push("bounds given by a variable, which has its default value".to_owned());
    }
    if holds("guard") || holds("guards") {
        said.push("a guard".to_owned());
    }
    if let Some(named) = object.get("probability").and_then(Value::as_str) {
        said.push(format!("the probability `{named}`"));
    } else if holds("probability") || holds("probabilities") {
        said.push("a probability".to_owned());
    }
    said
}

fn is_nothing(value: &Value) -> bool {
    match value {
        Value::Null => true,
        Value::Array(items) => items.is_empty(),
        Value::Object(members) => members.is_empty(),
        Value::String(text) => text.is_empty(),
        Value::Bool(_) | Value::Number(_) => false,
    }
}
