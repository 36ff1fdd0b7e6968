//! Networks in the JSON of DESIGN 4.2, written with everything planning needs, and read back.

use std::collections::BTreeMap;

use exact::{Bound, Time};
use rmpl::program::{Controllability, LabelMode};
use serde::Deserialize as _;
use serde_json::{Map, Value, json};
use smol_str::SmolStr;

use crate::call_names::NamesOnDemand;
use crate::exchange::Exchangeable;
use crate::network::{
    Arc, ArcId, ArcKind, Decision, DecisionId, EventEnd, EventRef, Extent, Label, LabelId, Network, Node,
    NodeId, Occurrence, OccurrenceId, OccurrenceKind, Resource, Role, Supply, Use, Variable, Worth,
};
use crate::sight::Sight;
use crate::text::kind_name;
use crate::vocabulary::Vocabulary;

/// Why a JSON document is not a network.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {problem}")]
pub struct NetworkError {
    /// Which part of the document.
    pub place: String,
    /// What is wrong with it.
    pub problem: String,
}

/// The members of an `enroute-tpn/1` document: `nodes`, `arcs`, `start`, `end`, and with them `occurrences`,
/// `variables` and `threat_gap`, so that the network can be read back and planned; `resources`, `uses`, `worths` and
/// `objective` where it has them.
pub fn network_to_json(network: &Network) -> Value {
    let nodes: Vec<Value> = (network.nodes.iter().enumerate())
        .map(|(id, node)| {
            let events: Vec<String> = node.events.iter().map(|&event| network.event_name(event)).collect();
            let mut members = object(json!({"id": id, "role": node.role, "events": events}));
            if let Some(decision) = node.decision {
                members.insert("decision".into(), Network::decision_name(decision).into());
            }
            Value::Object(members)
        })
        .collect();
    let arcs: Vec<Value> =
        network.arcs.iter().enumerate().map(|(id, arc)| arc_to_json(network, id, arc)).collect();
    let occurrences: Vec<Value> = (network.occurrences.iter())
        .map(|occurrence| {
            json!({
                "name": occurrence.name,
                "activity": occurrence.activity,
                "kind": occurrence.kind,
                "start": occurrence.start.0,
                "end": occurrence.end.0,
                "arc": occurrence.arc.map(|arc| arc.0),
                "arguments": occurrence.arguments,
                "parent": occurrence.parent.map(|parent| parent.0),
            })
        })
        .collect();
    let mut document = json!({
        "nodes": nodes,
        "arcs": arcs,
        "start": network.start.0,
        "end": network.end.0,
        "occurrences": occurrences,
        "variables": network.variables,
        "threat_gap": network.threat_gap,
    });
    if let Value::Object(members) = &mut document {
        let mut resources = network.resources.clone();
        for resource in &mut resources {
            resource.span = None;
        }
        let mut uses = network.uses.clone();
        for used in &mut uses {
            used.span = None;
        }
        let mut objective = network.objective.clone();
        for goal in &mut objective {
            goal.span = None;
        }
        insert_unless_empty(members, "resources", &resources);
        insert_unless_empty(members, "uses", &uses);
        insert_unless_empty(members, "worths", &network.worths);
        insert_unless_empty(members, "sights", &network.sights);
        insert_unless_empty(members, "objective", &objective);
        if network.controllability != Controllability::Dynamic {
            members.insert("controllability".into(), json!(network.controllability));
        }
    }
    document
}

fn insert_unless_empty<T: serde::Serialize>(members: &mut Map<String, Value>, name: &str, items: &[T]) {
    if !items.is_empty() {
        members.insert(name.to_owned(), json!(items));
    }
}

/// A list of the document, as [`network_to_json`] wrote it; nothing if it is not there.
fn read_list<T: serde::de::DeserializeOwned>(document: &Value, name: &str) -> Result<Vec<T>, NetworkError> {
    let list = document.get(name).cloned();
    list.map_or(Ok(Vec::new()), serde_json::from_value).map_err(|problem| error(name, &problem.to_string()))
}

fn arc_to_json(network: &Network, id: usize, arc: &Arc) -> Value {
    let labels: Vec<Value> = (arc.labels.iter())
        .map(|&label| {
            let label = &network.labels[label.index()];
            let mut members = object(json!({"type": mode_name(label.mode), "literal": label.text}));
            if network.sight(label).is_some() {
                members.insert("values".into(), network.value_names(&label.literal).into());
            }
            if label.extent != Extent::Arc {
                members.insert("extent".into(), json!(label.extent));
            }
            if let Some(owner) = label.owner {
                members.insert("owner".into(), network.occurrences[owner.index()].name.as_str().into());
            }
            Value::Object(members)
        })
        .collect();
    let mut members = object(json!({
        "id": id,
        "from": arc.from.0,
        "to": arc.to.0,
        "lower": arc.lower,
        "upper": arc.upper,
        "kind": kind_name(arc.kind),
        "labels": labels,
    }));
    if arc.is_contingent {
        members.insert("contingent".into(), true.into());
    }
    if let Some(occurrence) = arc.occurrence {
        members.insert("activity".into(), network.occurrences[occurrence.index()].name.as_str().into());
    }
    if let Some((decision, alternative)) = arc.choice {
        members.insert("decision".into(), Network::decision_name(decision).into());
        members.insert("alternative".into(), alternative.into());
    }
    Value::Object(members)
}

/// Reads a network that [`network_to_json`] wrote; of a document without `occurrences` and `variables`, they are made
/// from the events and labels. Structure and places in a text are not part of the document.
pub fn network_from_json(document: &Value) -> Result<Network, NetworkError> {
    let mut reader = Reader::default();
    let nodes = list(document, "nodes")?;
    let arcs = list(document, "arcs")?;
    reader.nodes = vec![Node::default(); nodes.len()];
    reader.read_occurrences(document, arcs.len())?;
    for (index, node) in nodes.iter().enumerate() {
        reader.read_node(index, node)?;
    }
    let variables: Vec<Variable> = match document.get("variables") {
        Some(variables) => serde_json::from_value(variables.clone())
            .map_err(|problem| error("variables", &problem.to_string()))?,
        None => Vec::new(),
    };
    let mut vocabulary = Vocabulary { is_complete: document.get("variables").is_some(), variables };
    for (index, arc) in arcs.iter().enumerate() {
        reader.read_arc(index, arc, &mut vocabulary)?;
    }
    reader.check_decisions()?;
    let start = reader.node_id(document.get("start"), "start")?;
    let end = reader.node_id(document.get("end"), "end")?;
    let threat_gap = match document.get("threat_gap") {
        Some(gap) => Time::deserialize(gap).map_err(|_| error("threat_gap", "is not an exact time"))?,
        None => Time::ONE,
    };
    let controllability = match document.get("controllability") {
        Some(kind) => Controllability::deserialize(kind)
            .map_err(|_| error("controllability", "is `strong`, `dynamic` or `none`"))?,
        None => Controllability::Dynamic,
    };
    let (resources, uses): (Vec<Resource>, Vec<Use>) =
        (read_list(document, "resources")?, read_list(document, "uses")?);
    let worths: Vec<Worth> = read_list(document, "worths")?;
    let sights: Vec<Sight> = read_list(document, "sights")?;
    if sights.iter().any(|sight| sight.variable.index() >= vocabulary.variables.len()) {
        return Err(error("sights", "names a variable that does not exist"));
    }
    let is_known = |used: &Use| {
        used.resource.index() < resources.len()
            && used.arc.index() < reader.arcs.len()
            && used.start.index().max(used.end.index()) < reader.nodes.len()
            && used.owner.is_none_or(|owner| owner.index() < reader.occurrences.len())
    };
    if !uses.iter().all(is_known) {
        return Err(error("uses", "names a resource, an arc or a node that does not exist"));
    }
    let is_condition = |used: &Use| {
        used.level.is_none_or(|level| {
            matches!(resources[used.resource.index()].supply, Supply::Reservoir { .. })
                && used.change == level.change()
                && used.amount.is_zero()
        })
    };
    if !uses.iter().all(is_condition) {
        let problem = "compares the level of what is not a reservoir, or of a use that changes it";
        return Err(error("uses", problem));
    }
    if worths.iter().any(|worth| worth.arc.index() >= reader.arcs.len()) {
        return Err(error("worths", "names an arc that does not exist"));
    }
    Ok(Network {
        departures: Vec::new(),
        distances: Vec::new(),
        resources,
        uses,
        worths,
        objective: read_list(document, "objective")?,
        nodes: reader.nodes,
        arcs: reader.arcs,
        labels: reader.labels,
        decisions: reader.decisions,
        occurrences: reader.occurrences,
        variables: vocabulary.variables,
        sights,
        blocks: Vec::new(),
        root: None,
        start,
        end,
        threat_gap,
        controllability,
        exchangeable: Exchangeable::default(),
        names: NamesOnDemand::default(),
    })
}

#[derive(Default)]
struct Reader {
    nodes: Vec<Node>,
    arcs: Vec<Arc>,
    labels: Vec<Label>,
    decisions: Vec<Decision>,
    occurrences: Vec<Occurrence>,
    by_name: BTreeMap<SmolStr, OccurrenceId>,
}

impl Reader {
    fn read_occurrences(&mut self, document: &Value, arc_count: usize) -> Result<(), NetworkError> {
        let Some(occurrences) = document.get("occurrences").and_then(Value::as_array) else { return Ok(()) };
        for (index, value) in occurrences.iter().enumerate() {
            let place = format!("occurrences[{index}]");
            let kind: OccurrenceKind = serde_json::from_value(value.get("kind").cloned().unwrap_or_default())
                .map_err(|problem| error(&place, &problem.to_string()))?;
            let small = |member: &str, limit: usize| -> Result<Option<u32>, NetworkError> {
                match value.get(member) {
                    None | Some(Value::Null) => Ok(None),
                    Some(number) => match number.as_u64().filter(|&number| number < limit as u64) {
                        Some(number) => Ok(Some(number as u32)),
                        None => Err(error(&place, &format!("`{member}` is out of range"))),
                    },
                }
            };
            let arguments = value.get("arguments").and_then(Value::as_array).into_iter().flatten();
            self.add_occurrence(Occurrence {
                name: text(value, "name", &place)?,
                activity: text(value, "activity", &place)?,
                kind,
                start: self.node_id(value.get("start"), &place)?,
                end: self.node_id(value.get("end"), &place)?,
                arc: small("arc", arc_count)?.map(ArcId),
                arguments: arguments.filter_map(|argument| argument.as_str().map(SmolStr::new)).collect(),
                parent: small("parent", index)?.map(OccurrenceId),
                aborts: None,
                span: None,
            });
        }
        Ok(())
    }

    fn add_occurrence(&mut self, occurrence: Occurrence) -> OccurrenceId {
        let id = OccurrenceId::from_index(self.occurrences.len());
        self.by_name.insert(occurrence.name.clone(), id);
        self.occurrences.push(occurrence);
        id
    }

    fn read_node(&mut self, index: usize, value: &Value) -> Result<(), NetworkError> {
        let place = format!("nodes[{index}]");
        if value.get("id").is_some_and(|id| id.as_u64() != Some(index as u64)) {
            return Err(error(&place, "node ids must count from 0, in order"));
        }
        if let Some(role) = value.get("role") {
            self.nodes[index].role = serde_json::from_value(role.clone())
                .map_err(|problem| error(&place, &problem.to_string()))?;
        }
        if let Some(name) = value.get("decision") {
            let decision = decision_id(Some(name), &place)?;
            self.decision_at(decision, &place)?.node = NodeId::from_index(index);
            self.nodes[index].decision = Some(decision);
            self.nodes[index].role = Role::Decision;
        }
        for event in value.get("events").and_then(Value::as_array).into_iter().flatten() {
            let event = event.as_str().ok_or_else(|| error(&place, "an event must be a name"))?;
            let event = self.event(event, NodeId::from_index(index), &place)?;
            self.nodes[index].events.push(event);
        }
        Ok(())
    }

    fn event(&mut self, name: &str, node: NodeId, place: &str) -> Result<EventRef, NetworkError> {
        let (name, end) = split_event(name)
            .ok_or_else(|| error(place, &format!("`{name}` is not the name of an event")))?;
        let occurrence = match self.by_name.get(name) {
            Some(&known) => known,
            None => self.add_occurrence(Occurrence {
                name: name.into(),
                activity: name.rsplit_once('#').map_or(name, |(activity, _)| activity).into(),
                kind: kind_by_name(name),
                start: node,
                end: node,
                arc: None,
                arguments: Vec::new(),
                parent: None,
                aborts: None,
                span: None,
            }),
        };
        match end {
            EventEnd::Start => self.occurrences[occurrence.index()].start = node,
            EventEnd::End => self.occurrences[occurrence.index()].end = node,
            EventEnd::PathVertex { .. } => {}
        }
        Ok(EventRef { occurrence, end })
    }

    fn read_arc(
        &mut self,
        index: usize,
        value: &Value,
        vocabulary: &mut Vocabulary,
    ) -> Result<(), NetworkError> {
        let place = format!("arcs[{index}]");
        let id = ArcId::from_index(index);
        if value.get("id").is_some_and(|id| id.as_u64() != Some(index as u64)) {
            return Err(error(&place, "arc ids must count from 0, in order"));
        }
        let (from, to) = (self.node_id(value.get("from"), &place)?, self.node_id(value.get("to"), &place)?);
        let lower = value.get("lower").and_then(|lower| Time::deserialize(lower).ok());
        let lower = lower.ok_or_else(|| error(&place, "`lower` must be a time"))?;
        let upper = value.get("upper").and_then(|upper| Bound::deserialize(upper).ok());
        let upper = upper.ok_or_else(|| error(&place, "`upper` must be a time or `inf`"))?;
        if Bound::Finite(lower) > upper {
            return Err(error(&place, "`lower` is greater than `upper`"));
        }
        let is_contingent = match value.get("contingent") {
            Some(flag) => {
                flag.as_bool().ok_or_else(|| error(&place, "`contingent` must be `true` or `false`"))?
            }
            None => false,
        };
        if is_contingent && (lower < Time::ZERO || upper.finite().is_none()) {
            return Err(error(&place, "a contingent duration needs finite bounds of at least 0"));
        }
        let kind: ArcKind =
            serde_json::from_value(value.get("kind").cloned().unwrap_or_else(|| "glue".into()))
                .map_err(|problem| error(&place, &problem.to_string()))?;
        let occurrence = match value.get("activity").and_then(Value::as_str) {
            Some(name) => Some(
                *self.by_name.get(name).ok_or_else(|| error(&place, &format!("`{name}` has no events")))?,
            ),
            None => None,
        };
        if let Some(occurrence) = occurrence
            && kind != ArcKind::Path
        {
            self.occurrences[occurrence.index()].arc = Some(id);
        }
        let mut arc = Arc { is_contingent, occurrence, ..Arc::bare(from, to, (lower, upper), kind) };
        for label in value.get("labels").and_then(Value::as_array).into_iter().flatten() {
            let label = self.read_label(label, id, occurrence, vocabulary, &place)?;
            arc.labels.push(LabelId::from_index(self.labels.len()));
            self.labels.push(label);
        }
        if value.get("decision").is_some() {
            let decision = decision_id(value.get("decision"), &place)?;
            let alternative = value.get("alternative").and_then(Value::as_u64);
            let known = self.decision_at(decision, &place)?;
            if alternative != Some(known.alternatives.len() as u64) {
                return Err(error(&place, "alternatives must be numbered from 0, in order"));
            }
            arc.choice = Some((decision, known.alternatives.len() as u32));
            known.alternatives.push(id);
        }
        if kind != ArcKind::Constraint {
            self.nodes[from.index()].out_arcs.push(id);
            self.nodes[to.index()].in_arcs.push(id);
        }
        self.arcs.push(arc);
        Ok(())
    }

    fn read_label(
        &self,
        value: &Value,
        arc: ArcId,
        arc_owner: Option<OccurrenceId>,
        vocabulary: &mut Vocabulary,
        place: &str,
    ) -> Result<Label, NetworkError> {
        let mode = match value.get("type").and_then(Value::as_str) {
            Some("Ask") => LabelMode::Ask,
            Some("Tell") => LabelMode::Tell,
            _ => return Err(error(place, "the `type` of a label must be `Ask` or `Tell`")),
        };
        let text = text(value, "literal", place)?;
        // A condition on what is in sight names the places that it comes to.
        let values: Option<Vec<&str>> = value
            .get("values")
            .and_then(Value::as_array)
            .map(|values| values.iter().filter_map(Value::as_str).collect());
        let literal = match text.trim_start_matches("not(").split_once(" in ").zip(values) {
            Some(((variable, _), values)) => vocabulary.one_of(variable, &values),
            None => vocabulary.literal(&text),
        };
        let literal = literal
            .ok_or_else(|| error(place, &format!("`{text}` is not a condition on a declared variable")))?;
        let owner = match value.get("owner").and_then(Value::as_str) {
            Some(name) => self.by_name.get(name).copied(),
            None => arc_owner,
        };
        let extent = match value.get("extent") {
            None => Extent::Arc,
            Some(extent) => serde_json::from_value(extent.clone())
                .map_err(|problem| error(place, &format!("a label's `extent`: {problem}")))?,
        };
        Ok(Label { arc, mode, extent, literal, text, owner, span: None })
    }

    /// The decision of that number; numbers beyond any sensible count are refused, gaps are found at the end.
    fn decision_at(&mut self, decision: DecisionId, place: &str) -> Result<&mut Decision, NetworkError> {
        if decision.index() >= self.nodes.len() {
            return Err(error(place, "decisions must be numbered from D1 without gaps"));
        }
        while self.decisions.len() <= decision.index() {
            self.decisions.push(Decision {
                node: NodeId(u32::MAX),
                alternatives: Vec::new(),
                alternative_spans: Vec::new(),
                span: None,
            });
        }
        Ok(&mut self.decisions[decision.index()])
    }

    fn check_decisions(&self) -> Result<(), NetworkError> {
        for (index, decision) in self.decisions.iter().enumerate() {
            let name = Network::decision_name(DecisionId::from_index(index));
            let Some(node) = self.nodes.get(decision.node.index()) else {
                return Err(error(&name, "has no node"));
            };
            if decision.alternatives.is_empty() || node.out_arcs != decision.alternatives {
                return Err(error(
                    &name,
                    "the out-arcs of its node must be exactly its alternatives, at least one",
                ));
            }
        }
        Ok(())
    }

    fn node_id(&self, value: Option<&Value>, place: &str) -> Result<NodeId, NetworkError> {
        let id = value.and_then(Value::as_u64).filter(|&id| id < self.nodes.len() as u64);
        id.map(|id| NodeId(id as u32)).ok_or_else(|| error(place, "names a node that does not exist"))
    }
}

fn split_event(name: &str) -> Option<(&str, EventEnd)> {
    if let Some(name) = name.strip_suffix(".start") {
        return Some((name, EventEnd::Start));
    }
    if let Some(name) = name.strip_suffix(".end") {
        return Some((name, EventEnd::End));
    }
    let (rest, vertex) = name.rsplit_once(".vertex")?;
    let (name, leg) = rest.rsplit_once(".leg")?;
    Some((name, EventEnd::PathVertex { leg: leg.parse().ok()?, vertex: vertex.parse().ok()? }))
}

fn kind_by_name(name: &str) -> OccurrenceKind {
    if name.starts_with("delay#") {
        OccurrenceKind::Delay
    } else if name.starts_with("scenario#") {
        OccurrenceKind::Scenario
    } else if name.starts_with("Tell(") || name.starts_with("Ask(") {
        OccurrenceKind::Assertion
    } else {
        OccurrenceKind::Primitive
    }
}

fn mode_name(mode: LabelMode) -> &'static str {
    match mode {
        LabelMode::Ask => "Ask",
        LabelMode::Tell => "Tell",
    }
}

fn decision_id(value: Option<&Value>, place: &str) -> Result<DecisionId, NetworkError> {
    let number = value.and_then(Value::as_str).and_then(|name| name.strip_prefix('D')?.parse::<u32>().ok());
    let index = number.and_then(|number| number.checked_sub(1));
    index.map(DecisionId).ok_or_else(|| error(place, "a decision must be named D1, D2, …"))
}

fn list<'value>(document: &'value Value, member: &str) -> Result<&'value [Value], NetworkError> {
    let list = document.get(member).and_then(Value::as_array);
    list.map(Vec::as_slice).ok_or_else(|| error(member, "is not a list"))
}

fn text(value: &Value, member: &str, place: &str) -> Result<SmolStr, NetworkError> {
    let text = value.get(member).and_then(Value::as_str);
    text.map(SmolStr::new).ok_or_else(|| error(place, &format!("has no `{member}`")))
}

fn object(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(members) => members,
        _ => Map::new(),
    }
}

fn error(place: &str, problem: &str) -> NetworkError {
    NetworkError { place: place.to_owned(), problem: problem.to_owned() }
}
