//! Plans in the JSON of DESIGN 4.2, by the names of DESIGN 4.1: writing them, and reading them for a given network.

use std::collections::BTreeMap;

use exact::{Bound, Time};
use serde::Deserialize as _;
use serde_json::{Map, Value, json};

use crate::network::{
    DecisionId, EventRef, LabelId, Network, NodeId, OccurrenceKind, Supply, UseId, VariableId,
};
use crate::plan::{CausalLink, Choice, Levels, Ordering, Plan, Quality, StateOrder, UseOrdering, Window};
use crate::selection::closure;

/// Why a JSON document is not a plan of a network.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// The document does not have the shape of DESIGN 4.2.
    #[error("{0}")]
    Shape(String),
    /// It names something that the network does not have.
    #[error("the network has no {kind} `{name}`")]
    Unknown {
        /// Event, interval, decision or alternative.
        kind: &'static str,
        name: String,
    },
}

/// How many pairs a document lists in `conflict_order` at most: there may be as many as the square of the mission.
const MAX_CONFLICTS_LISTED: usize = 10_000;

/// One plan of `network`. Windows of nodes without a name are left out; activities and conflicts are sorted by name.
pub fn plan_to_json(network: &Network, plan: &Plan) -> Value {
    let choices: Map<String, Value> = (plan.choices.iter())
        .map(|choice| (Network::decision_name(choice.decision), Value::from(choice.alternative)))
        .collect();
    let links: Vec<Value> = (plan.causal_links.iter())
        .map(|link| json!({"ask": network.label_name(link.ask), "tell": network.label_name(link.tell)}))
        .collect();
    let pair = |ordering: &Ordering| [network.label_name(ordering.first), network.label_name(ordering.then)];
    let mut conflict_order: Vec<[String; 2]> = plan.conflict_order.iter().map(pair).collect();
    conflict_order.sort();
    let omitted = plan.conflict_order_omitted + conflict_order.len().saturating_sub(MAX_CONFLICTS_LISTED);
    conflict_order.truncate(MAX_CONFLICTS_LISTED);
    let orderings: Vec<[String; 2]> = plan.orderings_added.iter().map(pair).collect();
    let windows: Map<String, Value> = (network.nodes.iter().zip(&plan.windows))
        .filter_map(|(node, window)| Some((node, (*window)?)))
        .flat_map(|(node, window)| node.events.iter().map(move |&event| (event, window)))
        .filter(|&(event, _)| plan.has_event(network, event))
        .map(|(event, window)| (network.event_name(event), json!([window.earliest, window.latest])))
        .collect();
    let mut document = json!({
        "choices": choices,
        "activities": selected_activities(network, plan),
        "causal_links": links,
        "conflict_order": conflict_order,
        "orderings_added": orderings,
        "windows": windows,
    });
    if let Value::Object(members) = &mut document {
        if omitted > 0 {
            members.insert("conflict_order_omitted".into(), omitted.into());
        }
        if !plan.state_order.is_empty() {
            members.insert("state_order".into(), state_order_to_json(network, plan));
        }
        add_resources(network, plan, members);
    }
    document
}

fn state_order_to_json(network: &Network, plan: &Plan) -> Value {
    let of_variable = plan.state_order.iter().map(|StateOrder { variable, producers }| {
        let names: Vec<String> = producers.iter().map(|&label| network.label_name(label)).collect();
        (network.variables[variable.index()].name.to_string(), json!(names))
    });
    Value::Object(of_variable.collect())
}

/// The lists of `state_order`, by variable.
fn state_order_from_json(
    network: &Network,
    names: &Names,
    plan: &Value,
) -> Result<Vec<StateOrder>, PlanError> {
    let Some(stated) = plan.get("state_order") else { return Ok(Vec::new()) };
    let Value::Object(stated) = stated else { return Err(shape("`state_order` must be an object")) };
    let variables: BTreeMap<&str, VariableId> = (network.variables.iter().enumerate())
        .map(|(index, variable)| (variable.name.as_str(), VariableId::from_index(index)))
        .collect();
    let mut found = Vec::with_capacity(stated.len());
    for (name, producers) in stated {
        let variable = *variables.get(name.as_str()).ok_or_else(|| unknown("state variable", name))?;
        let wrong = || shape(&format!("`state_order` needs a list of names for `{name}`"));
        let label = |producer: &Value| names.label(producer.as_str().ok_or_else(wrong)?);
        let producers = producers.as_array().ok_or_else(wrong)?.iter().map(label);
        let producers = producers.collect::<Result<Vec<LabelId>, PlanError>>()?;
        found.push(StateOrder { variable, producers });
    }
    found.sort_by_key(|order| order.variable);
    Ok(found)
}

/// What a plan says of resources and of its worth, where the mission has them (SPEC 11, 12).
fn add_resources(network: &Network, plan: &Plan, members: &mut Map<String, Value>) {
    if !plan.levels.is_empty() {
        let ordered = plan.uses_ordered.iter();
        let ordered: Vec<[String; 2]> = ordered
            .map(|ordering| [network.use_name(ordering.first), network.use_name(ordering.then)])
            .collect();
        members.insert("uses_ordered".into(), json!(ordered));
        let resources: Map<String, Value> = (network.resources.iter().zip(&plan.levels))
            .map(|(resource, &levels)| (resource.name.to_string(), levels_to_json(resource.supply, levels)))
            .collect();
        members.insert("resources".into(), resources.into());
    }
    let quality = &plan.quality;
    if let Some(is_optimal) = quality.is_optimal {
        members.insert("optimal".into(), is_optimal.into());
    }
    if !network.worths.is_empty() || !network.objective.is_empty() {
        members.insert("cost".into(), json!(quality.cost));
        members.insert("reward".into(), json!(quality.reward));
        members.insert("end".into(), json!(quality.end));
        members.insert("length".into(), json!(quality.length_m));
    }
}

fn levels_to_json(supply: Supply, levels: Levels) -> Value {
    match (supply, levels) {
        (Supply::Reusable { capacity }, Levels::Peak(peak)) => json!({"capacity": capacity, "peak": peak}),
        (Supply::Reservoir { least, greatest, .. }, Levels::Range { low, high }) => {
            json!({"least": least, "greatest": greatest, "low": low, "high": high})
        }
        _ => Value::Null,
    }
}

/// The levels of all resources, in the network's order, as [`plan_to_json`] writes them.
fn levels_from_json(network: &Network, plan: &Value) -> Result<Vec<Levels>, PlanError> {
    let Some(stated) = plan.get("resources") else { return Ok(Vec::new()) };
    let number = |resource: &Value, member: &str| {
        let number = resource.get(member).cloned().and_then(|number| serde_json::from_value(number).ok());
        number.ok_or_else(|| shape(&format!("`{member}` of a resource must be an exact number")))
    };
    let levels = network.resources.iter().map(|resource| {
        let levels = stated
            .get(resource.name.as_str())
            .ok_or_else(|| shape(&format!("`resources` has no entry for `{}`", resource.name)))?;
        match resource.supply {
            Supply::Reusable { .. } => Ok(Levels::Peak(number(levels, "peak")?)),
            Supply::Reservoir { .. } => {
                Ok(Levels::Range { low: number(levels, "low")?, high: number(levels, "high")? })
            }
        }
    });
    levels.collect()
}

fn quality_from_json(plan: &Value) -> Quality {
    let number = |member: &str| {
        plan.get(member).cloned().and_then(|number| serde_json::from_value(number).ok()).unwrap_or_default()
    };
    Quality {
        cost: number("cost"),
        reward: number("reward"),
        end: plan.get("end").and_then(|end| Time::deserialize(end).ok()).unwrap_or_default(),
        length_m: plan.get("length").and_then(Value::as_f64).unwrap_or_default(),
        is_optimal: plan.get("optimal").and_then(Value::as_bool),
    }
}

/// The names of the primitives that the plan selects, sorted.
pub fn selected_activities(network: &Network, plan: &Plan) -> Vec<String> {
    let is_selected = |arc: crate::ArcId| plan.selected_arcs.get(arc.index()) == Some(&true);
    let primitives = network.occurrences.iter().filter(|occurrence| {
        occurrence.kind == OccurrenceKind::Primitive && occurrence.arc.is_some_and(is_selected)
    });
    let mut names: Vec<String> = primitives.map(|occurrence| occurrence.name.to_string()).collect();
    names.sort();
    names
}

/// The plans of a document: `enroute-plan/1` with its `plans`, or a single plan.
pub fn plans_from_json(network: &Network, document: &Value) -> Result<Vec<Plan>, PlanError> {
    match document.get("plans") {
        Some(Value::Array(plans)) => plans.iter().map(|plan| plan_from_json(network, plan)).collect(),
        Some(_) => Err(shape("`plans` must be a list")),
        None => Ok(vec![plan_from_json(network, document)?]),
    }
}

/// Reads one plan. What it selects follows from its choices; its windows are taken as they are, and so are its
/// `activities`, which [`stated_activities`] gives.
pub fn plan_from_json(network: &Network, plan: &Value) -> Result<Plan, PlanError> {
    if !plan.is_object() {
        return Err(shape("a plan must be an object with `choices` and `windows`"));
    }
    let names = Names::new(network);
    let mut choices = Vec::new();
    for (name, alternative) in members(plan, "choices")? {
        choices.push(choice(network, name, alternative)?);
    }
    choices.sort_unstable();
    let (selected_nodes, selected_arcs) = closure(network, &choices);
    let mut causal_links = Vec::new();
    for link in items(plan, "causal_links")? {
        let label = |member: &str| {
            let name = link.get(member).and_then(Value::as_str);
            names.label(
                name.ok_or_else(|| shape("a causal link must be an object with the names `ask` and `tell`"))?,
            )
        };
        causal_links.push(CausalLink { ask: label("ask")?, tell: label("tell")? });
    }
    causal_links.sort_unstable();
    let orderings = |member: &str| -> Result<Vec<Ordering>, PlanError> {
        let pair = |pair: &Value| match pair.as_array().map(Vec::as_slice) {
            Some([Value::String(first), Value::String(then)]) => {
                Ok(Ordering { first: names.label(first)?, then: names.label(then)? })
            }
            _ => Err(shape(&format!("`{member}` must be a list of pairs of names"))),
        };
        items(plan, member)?.iter().map(pair).collect()
    };
    let mut uses_ordered = Vec::new();
    for pair in items(plan, "uses_ordered")? {
        let Some([Value::String(first), Value::String(then)]) = pair.as_array().map(Vec::as_slice) else {
            return Err(shape("`uses_ordered` must be a list of pairs of names"));
        };
        uses_ordered.push(UseOrdering { first: names.used(first)?, then: names.used(then)? });
    }
    let mut windows: Vec<Option<Window>> = vec![None; network.nodes.len()];
    for (event, window) in members(plan, "windows")? {
        let node = names.event(event)?;
        let read = read_window(window)
            .ok_or_else(|| shape(&format!("the window of `{event}` must be a pair of exact times")))?;
        if windows[node.index()].is_some_and(|known| known != read) {
            return Err(shape(&format!(
                "`{event}` has two windows, under different names of the same event"
            )));
        }
        windows[node.index()] = Some(read);
    }
    Ok(Plan {
        choices,
        selected_nodes,
        selected_arcs,
        causal_links,
        conflict_order: orderings("conflict_order")?,
        conflict_order_omitted: omitted(plan)?,
        state_order: state_order_from_json(network, &names, plan)?,
        orderings_added: orderings("orderings_added")?,
        uses_ordered,
        levels: levels_from_json(network, plan)?,
        quality: quality_from_json(plan),
        windows,
    })
}

/// Returns how many pairs `conflict_order` leaves out.
fn omitted(plan: &Value) -> Result<usize, PlanError> {
    let Some(stated) = plan.get("conflict_order_omitted") else { return Ok(0) };
    let count = stated.as_u64().and_then(|count| usize::try_from(count).ok());
    count.ok_or_else(|| shape("`conflict_order_omitted` must be a number of pairs"))
}

/// The `activities` that a plan's JSON states, sorted, if it does.
pub fn stated_activities(plan: &Value) -> Option<Vec<String>> {
    let stated = plan.get("activities")?.as_array()?;
    let mut names: Vec<String> = stated.iter().filter_map(|name| Some(name.as_str()?.to_owned())).collect();
    names.sort();
    Some(names)
}

/// Event times by name, as `enroute execute` and schedules give them, as times by node.
pub fn times_from_json(network: &Network, times: &Value) -> Result<Vec<Option<Time>>, PlanError> {
    let names = Names::new(network);
    let mut by_node = vec![None; network.nodes.len()];
    let Value::Object(times) = times else {
        return Err(shape("times must be an object that maps events to numbers"));
    };
    for (event, time) in times {
        let read = Time::deserialize(time)
            .map_err(|reason| shape(&format!("the time of `{event}` is not exact: {reason}")))?;
        by_node[names.event(event)?.index()] = Some(read);
    }
    Ok(by_node)
}

/// Nodes and labels by their names.
pub struct Names {
    events: BTreeMap<String, NodeId>,
    labels: BTreeMap<String, LabelId>,
    uses: BTreeMap<String, UseId>,
}

impl Names {
    /// Indexes a network.
    pub fn new(network: &Network) -> Self {
        let mut events = BTreeMap::new();
        for (index, node) in network.nodes.iter().enumerate() {
            for &event in &node.events {
                events.insert(network.event_name(event), NodeId::from_index(index));
            }
        }
        let labels = (0..network.labels.len()).map(LabelId::from_index);
        let uses = (0..network.uses.len()).map(UseId::from_index);
        Self {
            events,
            labels: labels.map(|label| (network.label_name(label), label)).collect(),
            uses: uses.map(|used| (network.use_name(used), used)).collect(),
        }
    }

    /// The node of an event.
    pub fn event(&self, name: &str) -> Result<NodeId, PlanError> {
        self.events.get(name).copied().ok_or_else(|| unknown("event", name))
    }

    /// A use of a resource.
    pub fn used(&self, name: &str) -> Result<UseId, PlanError> {
        self.uses.get(name).copied().ok_or_else(|| unknown("use of a resource", name))
    }

    /// A labeled interval.
    pub fn label(&self, name: &str) -> Result<LabelId, PlanError> {
        self.labels.get(name).copied().ok_or_else(|| unknown("labeled interval", name))
    }
}

fn choice(network: &Network, name: &str, alternative: &Value) -> Result<Choice, PlanError> {
    let number = name.strip_prefix('D').and_then(|number| number.parse::<u32>().ok());
    let index = number.and_then(|number| number.checked_sub(1)).ok_or_else(|| unknown("decision", name))?;
    let decision = network.decisions.get(index as usize).ok_or_else(|| unknown("decision", name))?;
    let alternative =
        alternative.as_u64().ok_or_else(|| shape("a choice must be the number of an alternative"))?;
    if alternative >= decision.alternatives.len() as u64 {
        return Err(unknown("alternative", &format!("{name}: {alternative}")));
    }
    Ok(Choice { decision: DecisionId(index), alternative: alternative as u32 })
}

/// The name of a node: its first event's, or `node 7`.
pub fn node_name(network: &Network, node: NodeId) -> String {
    match network.nodes[node.index()].events.first() {
        Some(&EventRef { occurrence, end }) => network.event_name(EventRef { occurrence, end }),
        None => format!("node {}", node.0),
    }
}

fn read_window(value: &Value) -> Option<Window> {
    let [earliest, latest] = value.as_array()?.as_slice() else { return None };
    Some(Window { earliest: Time::deserialize(earliest).ok()?, latest: Bound::deserialize(latest).ok()? })
}

fn members<'value>(
    plan: &'value Value,
    member: &str,
) -> Result<Box<dyn Iterator<Item = (&'value String, &'value Value)> + 'value>, PlanError> {
    match plan.get(member) {
        Some(Value::Object(members)) => Ok(Box::new(members.iter())),
        Some(_) => Err(shape(&format!("`{member}` is not an object"))),
        None => Err(shape(&format!("the plan has no `{member}`"))),
    }
}

fn items<'value>(plan: &'value Value, member: &str) -> Result<&'value [Value], PlanError> {
    match plan.get(member) {
        Some(Value::Array(items)) => Ok(items),
        Some(_) => Err(shape(&format!("`{member}` is not a list"))),
        None => Ok(&[]),
    }
}

fn shape(message: &str) -> PlanError {
    PlanError::Shape(message.to_owned())
}

fn unknown(kind: &'static str, name: &str) -> PlanError {
    PlanError::Unknown { kind, name: name.to_owned() }
}
