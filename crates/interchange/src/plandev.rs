//! Plans of `PlanDev` (NASA's Aerie) as networks: each activity directive begins at its offset from the plan, or from the
//! start or end of the directive that it is anchored to.
//!
//! How long an activity takes is decided by the mission model, which the file does not have: it may take any time,
//! unless [`DURATION`] says how long. Tags, presets and the arguments of the simulation are not planned with.

mod interval;

use std::collections::BTreeMap;

use exact::Time;
use serde_json::{Map, Value, json};

use crate::plan_schema::{Document, PlanSchemaError};
use interval::{minutes_of, moment_of};

/// What an activity's `metadata` may say, and plans that are written for `PlanDev` do: how long it takes, as an interval.
pub const DURATION: &str = "enroute_duration";

/// Why a plan is not a network.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanDevError {
    /// A member is not there, or not what it has to be.
    #[error("{place} has no {member}")]
    Missing {
        /// The plan or a directive.
        place: String,
        /// The member, and of which kind it has to be.
        member: &'static str,
    },
    /// An interval that has no exact length: months and years, or none that fits.
    #[error(
        "{place}: `{text}` is not an interval; expected days, hours, minutes and seconds, such as `1 day 02:30:00`"
    )]
    Interval {
        /// The plan or a directive.
        place: String,
        /// What is there.
        text: String,
    },
    /// A moment that is none.
    #[error(
        "the plan: `{0}` is not a date that can be represented; expected a form such as `2030-01-01T00:00:00+00:00` or `2030-001T00:00:00`"
    )]
    Moment(String),
    /// A directive is anchored to one that is not there.
    #[error("{place} is anchored to {anchor}, which is not in the plan")]
    Anchor {
        /// The directive.
        place: String,
        /// What it names.
        anchor: i64,
    },
    /// Two directives have the same id.
    #[error("the plan has two directives {0}")]
    Twice(i64),
    /// A directive begins before the plan or after its end.
    #[error("{0} starts outside the plan")]
    Outside(String),
    /// The network that the plan comes to cannot be read.
    #[error(transparent)]
    Network(#[from] PlanSchemaError),
}

/// Returns whether a file is a plan of `PlanDev` rather than another document in JSON.
pub fn is_plan(file: &Value) -> bool {
    file.get("activities").is_some_and(Value::is_array)
        && ["start_time", "model_id", "simulation_arguments"].iter().any(|key| file.get(key).is_some())
}

/// The network of a plan, with times in minutes, the unit of networks that do not name one.
pub fn read(file: &Value) -> Result<Document, PlanDevError> {
    let plan = "the plan";
    let duration = match (file.get("duration"), file.get("start_time"), file.get("end_time")) {
        // As Aerie's command line writes plans.
        (None | Some(Value::Null), Some(start), Some(end)) => between(start, end)?,
        (duration, ..) => interval(plan, duration, "`duration`")?,
    };
    let activities = file.get("activities").and_then(Value::as_array);
    let activities = activities.ok_or_else(|| missing(plan, "list of `activities`"))?;
    let mut directives: BTreeMap<i64, &Value> = BTreeMap::new();
    for activity in activities {
        let id = activity.get("id").and_then(Value::as_i64);
        let id = id.ok_or_else(|| missing("an activity", "`id` that is a whole number"))?;
        if directives.insert(id, activity).is_some() {
            return Err(PlanDevError::Twice(id));
        }
    }
    let mut objects = Objects::default();
    objects.add("plan", json!({ "tpn-type": "network", "begin-node": BEGIN, "end-node": END }));
    objects.add(BEGIN, json!({ "tpn-type": "p-begin", "end-node": END }));
    objects.add(END, json!({ "tpn-type": "p-end" }));
    objects.constrain(BEGIN, END, duration);
    objects.leave(BEGIN, "the plan's time", json!({ "tpn-type": "null-activity", "end-node": END }));
    for (&id, activity) in &directives {
        objects.add_directive(id, activity, duration, &directives)?;
    }
    Ok(Document::of_objects(objects.0)?)
}

/// What names the type of a directive that has a name of its own, among its arguments.
pub const DIRECTIVE_TYPE: &str = "directive_type";

/// Returns whether a directive has no name of its own: only that of its type, or `Drive#2` in a plan that Enroute wrote for
/// `PlanDev`.
fn is_numbered(name: &str, kind: &str, is_ours: bool) -> bool {
    let number = name.strip_prefix(kind).and_then(|rest| rest.strip_prefix('#'));
    let is_number = |number: &str| !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
    name == kind || (is_ours && number.is_some_and(is_number))
}

const BEGIN: &str = "start of the plan";
const END: &str = "end of the plan";

/// Objects of plan-schema by uid.
#[derive(Default)]
struct Objects(Map<String, Value>);

impl Objects {
    fn add(&mut self, uid: &str, object: Value) {
        self.0.insert(uid.to_owned(), object);
    }

    fn node(&mut self, uid: &str) {
        self.0.entry(uid).or_insert_with(|| json!({ "tpn-type": "state" }));
    }

    fn list(&mut self, uid: &str, key: &str, item: &str) {
        if let Some(Value::Object(object)) = self.0.get_mut(uid)
            && let Value::Array(list) = object.entry(key).or_insert_with(|| json!([]))
        {
            list.push(item.into());
        }
    }

    /// An arc that leaves a node.
    fn leave(&mut self, node: &str, uid: &str, arc: Value) {
        self.add(uid, arc);
        self.list(node, "activities", uid);
    }

    /// `to` comes exactly so long after `from`, a node or an arc.
    fn constrain(&mut self, from: &str, to: &str, after: Time) {
        let uid = format!("from {from} to {to}");
        let value = [after, after];
        self.add(&uid, json!({ "tpn-type": "temporal-constraint", "end-node": to, "value": value }));
        self.list(from, "constraints", &uid);
    }

    fn add_directive(
        &mut self,
        id: i64,
        activity: &Value,
        duration: Time,
        directives: &BTreeMap<i64, &Value>,
    ) -> Result<(), PlanDevError> {
        let place = format!("directive {id}");
        let [wait, start, end] = ["wait for", "start of", "end of"].map(|what| format!("{what} {place}"));
        let kind = activity.get("type").and_then(Value::as_str).filter(|kind| !kind.is_empty());
        let kind = kind.ok_or_else(|| missing(&place, "`type`"))?;
        let name = activity.get("name").and_then(Value::as_str).map(str::trim);
        let taken = activity.get("metadata").and_then(|metadata| metadata.get(DURATION));
        let name = name.filter(|name| !name.is_empty() && !is_numbered(name, kind, taken.is_some()));
        let name = name.unwrap_or(kind);
        let arguments = activity.get("arguments").and_then(Value::as_object).into_iter().flatten();
        let mut arguments: Vec<String> = arguments.map(|(name, value)| format!("{name}={value}")).collect();
        if name != kind {
            arguments.push(format!("{DIRECTIVE_TYPE}={kind}"));
        }
        self.leave(BEGIN, &wait, json!({ "tpn-type": "delay-activity", "end-node": start }));
        self.node(&start);
        self.node(&end);
        let arc = json!({
            "tpn-type": "activity",
            "name": name,
            "args": arguments,
            "end-node": end,
            "controllable": taken.is_some(),
        });
        self.leave(&start, &place, arc);
        if taken.is_some() {
            let taken = interval(&place, taken, "`enroute_duration`")?;
            self.constrain(&place, &end, taken);
        }
        let after = format!("after {place}");
        self.leave(&end, &after, json!({ "tpn-type": "null-activity", "end-node": END }));

        let offset = interval(&place, activity.get("start_offset"), "`start_offset`")?;
        let is_of_start = activity.get("anchored_to_start").and_then(Value::as_bool).unwrap_or(true);
        let unreadable = || PlanDevError::Outside(place.clone());
        match activity.get("anchor_id").and_then(Value::as_i64) {
            None => {
                let since = if is_of_start { Some(offset) } else { duration.checked_add(offset) };
                let since = since.filter(|since| !since.is_negative()).ok_or_else(unreadable)?;
                self.constrain(&wait, &start, since);
            }
            Some(anchor) => {
                if !directives.contains_key(&anchor) {
                    return Err(PlanDevError::Anchor { place, anchor });
                }
                let side = if is_of_start { "start of" } else { "end of" };
                let anchor = format!("{side} directive {anchor}");
                if offset.is_negative() {
                    let before = offset.checked_neg().ok_or_else(unreadable)?;
                    self.constrain(&start, &anchor, before);
                } else {
                    // The anchor may come later in the file.
                    self.node(&anchor);
                    self.constrain(&anchor, &start, offset);
                }
            }
        }
        Ok(())
    }
}

fn missing(place: &str, member: &'static str) -> PlanDevError {
    PlanDevError::Missing { place: place.to_owned(), member }
}

fn interval(place: &str, value: Option<&Value>, member: &'static str) -> Result<Time, PlanDevError> {
    let text = value.and_then(Value::as_str).ok_or_else(|| missing(place, member))?;
    let wrong = || PlanDevError::Interval { place: place.to_owned(), text: text.to_owned() };
    minutes_of(text).ok_or_else(wrong)
}

/// The minutes from one moment to a later one.
fn between(start: &Value, end: &Value) -> Result<Time, PlanDevError> {
    let moment = |value: &Value| {
        let wrong = || PlanDevError::Moment(value.as_str().map_or_else(|| value.to_string(), str::to_owned));
        value.as_str().and_then(moment_of).ok_or_else(wrong)
    };
    let duration = moment(end)?.checked_sub(moment(start)?).filter(|duration| !duration.is_negative());
    duration.ok_or_else(|| PlanDevError::Moment(end.to_string()))
}
