//! From plan-schema objects to a network.

use std::collections::BTreeMap;

use exact::{Bound, Time};
use rmpl::program::{Controllability, LabelMode};
use serde::Deserialize as _;
use serde_json::{Map, Value};
use smol_str::SmolStr;

use super::{BETWEEN_THREADS, Document, PlanSchemaError};
use tpn::network::{
    Arc, ArcId, ArcKind, Decision, DecisionId, EventEnd, EventRef, Extent, Label, LabelId, Network, Node,
    NodeId, Occurrence, OccurrenceId, OccurrenceKind, Role,
};
use tpn::vocabulary::Vocabulary;

/// So many members of a document are named when it is refused.
const MAX_MEMBERS: usize = 6;

/// Reads the network that `network-id` names.
pub(super) fn read(objects: Map<String, Value>) -> Result<Document, PlanSchemaError> {
    let read = with_known_types(&objects);
    let mut reader = Reader::new(&read);
    let network = reader.network_object()?;
    let threat_gap = reader.read_declarations(&network)?;
    let begin = reader.reference(&network, "begin-node")?;
    reader.walk(&begin)?;
    let end = reader.end_node(&network, &begin)?;
    let start = reader.node_of(&begin);
    let (node_uids, arc_uids, not_planned) = (reader.node_uids, reader.arc_uids, reader.not_planned);
    let mut network = Network {
        nodes: reader.nodes,
        arcs: reader.arcs,
        labels: reader.labels,
        decisions: reader.decisions,
        occurrences: reader.occurrences,
        variables: reader.vocabulary.variables,
        resources: Vec::new(),
        uses: Vec::new(),
        worths: Vec::new(),
        sights: Vec::new(),
        departures: Vec::new(),
        distances: Vec::new(),
        objective: Vec::new(),
        blocks: Vec::new(),
        root: None,
        start,
        end,
        threat_gap,
        controllability: Controllability::Dynamic,
        exchangeable: tpn::exchange::Exchangeable::default(),
        names: tpn::call_names::NamesOnDemand::default(),
    };
    link(&mut network);
    Ok(Document { network, objects, node_uids, arc_uids, not_planned })
}

/// The objects with their types in lower case, whatever case a tool writes.
fn with_known_types(objects: &Map<String, Value>) -> Map<String, Value> {
    let mut objects = objects.clone();
    for object in objects.values_mut() {
        if let Some(Value::String(kind)) = object.get_mut("tpn-type") {
            kind.make_ascii_lowercase();
        }
    }
    objects
}

struct Reader<'file> {
    objects: &'file Map<String, Value>,
    ids: BTreeMap<String, NodeId>,
    /// For a choice with constraints of its own: the node before it that carries them.
    before: BTreeMap<String, NodeId>,
    nodes: Vec<Node>,
    arcs: Vec<Arc>,
    labels: Vec<Label>,
    decisions: Vec<Decision>,
    occurrences: Vec<Occurrence>,
    counts: BTreeMap<SmolStr, u32>,
    vocabulary: Vocabulary,
    node_uids: Vec<Option<String>>,
    arc_uids: Vec<Option<String>>,
    not_planned: Vec<String>,
    /// Nodes that nothing leaves because they only show a contradiction.
    dead_ends: Vec<NodeId>,
}

/// An interval that is being read.
type Bounds = (Time, Bound);

impl<'file> Reader<'file> {
    fn new(objects: &'file Map<String, Value>) -> Self {
        Self {
            objects,
            ids: BTreeMap::new(),
            before: BTreeMap::new(),
            nodes: Vec::new(),
            arcs: Vec::new(),
            labels: Vec::new(),
            decisions: Vec::new(),
            occurrences: Vec::new(),
            counts: BTreeMap::new(),
            vocabulary: Vocabulary { is_complete: false, variables: Vec::new() },
            node_uids: Vec::new(),
            arc_uids: Vec::new(),
            not_planned: Vec::new(),
            dead_ends: Vec::new(),
        }
    }

    fn network_object(&self) -> Result<String, PlanSchemaError> {
        if let Some(uid) = self.objects.get("network-id").and_then(Value::as_str) {
            self.object("network-id", uid)?;
            return Ok(uid.to_owned());
        }
        let named = self.objects.iter().find(|(_, object)| kind(object) == "network");
        let is_hierarchical = |object: &Value| {
            object.get("type").and_then(Value::as_str).is_some_and(|kind| kind.starts_with("htn-"))
        };
        let missing = || {
            let problem = if self.objects.values().any(is_hierarchical) {
                "hierarchical task networks (HTN) are not supported; open the plan network, usually named `.tpn.json`"
                    .to_owned()
            } else if self.objects.is_empty() {
                "the document is empty".to_owned()
            } else {
                let members: Vec<String> =
                    self.objects.keys().take(MAX_MEMBERS).map(|key| format!("`{key}`")).collect();
                let more = if self.objects.len() > MAX_MEMBERS { ", …" } else { "" };
                format!(
                    "the file needs a `network-id` or a network object; it has {}{more}",
                    members.join(", ")
                )
            };
            PlanSchemaError::Shape(problem)
        };
        named.map(|(uid, _)| uid.clone()).ok_or_else(missing)
    }

    /// Returns what this program writes into the network object beside the standard keys: variables, and the threat
    /// gap.
    fn read_declarations(&mut self, network: &str) -> Result<Time, PlanSchemaError> {
        let object = self.object(network, network)?;
        if let Some(variables) = object.get("variables")
            && let Ok(variables) = serde_json::from_value(variables.clone())
        {
            self.vocabulary = Vocabulary { is_complete: true, variables };
        }
        let gap = object.get("threat-gap").and_then(|gap| Time::deserialize(gap).ok());
        Ok(gap.unwrap_or(Time::ONE))
    }

    fn object(&self, from: &str, uid: &str) -> Result<&'file Value, PlanSchemaError> {
        let found = self.objects.get(uid).filter(|object| object.is_object());
        found.ok_or_else(|| PlanSchemaError::Dangling { from: from.to_owned(), to: uid.to_owned() })
    }

    fn reference(&self, from: &str, key: &str) -> Result<String, PlanSchemaError> {
        let uid = self.object(from, from)?.get(key).and_then(Value::as_str);
        let uid = uid.ok_or_else(|| PlanSchemaError::Shape(format!("`{from}` has no `{key}`")))?;
        self.object(from, uid)?;
        Ok(uid.to_owned())
    }

    /// The network's end: as it says, or as its first node says, or the only node that nothing leaves.
    fn end_node(&self, network: &str, begin: &str) -> Result<NodeId, PlanSchemaError> {
        for (from, key) in [(network, "end-node"), (begin, "end-node")] {
            let named = self.object(from, from)?.get(key).and_then(Value::as_str);
            if let Some(&node) = named.and_then(|uid| self.ids.get(uid)) {
                return Ok(node);
            }
        }
        let mut leaves = vec![false; self.nodes.len()];
        for arc in self.arcs.iter().filter(|arc| arc.kind != ArcKind::Span) {
            leaves[arc.from.index()] = true;
        }
        for dead in &self.dead_ends {
            leaves[dead.index()] = true;
        }
        let mut ends = (0..self.nodes.len()).filter(|&node| !leaves[node]);
        match (ends.next(), ends.next()) {
            (Some(end), None) => Ok(NodeId::from_index(end)),
            _ => Err(PlanSchemaError::Shape(
                "the network needs an `end-node` or exactly one last node".to_owned(),
            )),
        }
    }

    /// Returns where arcs into a node lead.
    fn node_of(&self, uid: &str) -> NodeId {
        self.before.get(uid).or_else(|| self.ids.get(uid)).copied().unwrap_or(NodeId(0))
    }

    /// Gives every node that can be reached a number, depth first in the order of the arcs, then reads what leaves it.
    fn walk(&mut self, begin: &str) -> Result<(), PlanSchemaError> {
        let mut order: Vec<String> = Vec::new();
        let mut stack = vec![begin.to_owned()];
        while let Some(uid) = stack.pop() {
            if self.ids.contains_key(&uid) {
                continue;
            }
            let node = self.add_node(Some(uid.clone()));
            self.ids.insert(uid.clone(), node);
            let object = self.object(&uid, &uid)?;
            let is_choice = kind(object) == "c-begin";
            if is_choice && list(object, "constraints").any(|uid| self.is_temporal(uid)) {
                let before = self.add_node(None);
                self.before.insert(uid.clone(), before);
            }
            for arc in self.out_arcs(&uid)?.iter().rev() {
                stack.push(self.reference(arc, "end-node")?);
            }
            order.push(uid);
        }
        for uid in &order {
            self.read_node(uid)?;
        }
        Ok(())
    }

    fn add_node(&mut self, uid: Option<String>) -> NodeId {
        self.nodes.push(Node::default());
        self.node_uids.push(uid);
        NodeId::from_index(self.nodes.len() - 1)
    }

    fn is_temporal(&self, uid: &str) -> bool {
        self.objects.get(uid).is_some_and(|object| kind(object) == "temporal-constraint")
    }

    /// The arcs that leave a node: by their `order` where they have one, otherwise as the file lists them.
    fn out_arcs(&self, uid: &str) -> Result<Vec<String>, PlanSchemaError> {
        let object = self.object(uid, uid)?;
        let mut arcs: Vec<(i64, String)> = Vec::new();
        for arc in list(object, "activities") {
            let order = self.object(uid, arc)?.get("order").and_then(Value::as_i64).unwrap_or(0);
            arcs.push((order, arc.to_owned()));
        }
        arcs.sort_by_key(|(order, _)| *order);
        Ok(arcs.into_iter().map(|(_, arc)| arc).collect())
    }

    fn read_node(&mut self, uid: &str) -> Result<(), PlanSchemaError> {
        let object = self.object(uid, uid)?;
        let node = self.ids[uid];
        let arcs = self.out_arcs(uid)?;
        let carrier = self.before.get(uid).copied();
        if let Some(before) = carrier {
            self.add_arc(before, node, ArcKind::Glue, (Time::ZERO, Bound::ZERO), None);
        }
        let decision = (kind(object) == "c-begin" && !arcs.is_empty()).then(|| {
            self.nodes[node.index()].decision = Some(DecisionId::from_index(self.decisions.len()));
            self.decisions.push(Decision {
                node,
                alternatives: Vec::new(),
                alternative_spans: Vec::new(),
                span: None,
            });
            DecisionId::from_index(self.decisions.len() - 1)
        });
        let mut only: Option<ArcId> = None;
        for arc in &arcs {
            only = Some(self.read_arc(uid, arc, node, decision)?);
        }
        // A constraint of a node with a single arc to the same place is the duration of that arc.
        let single = only.filter(|_| arcs.len() == 1 && decision.is_none());
        for constraint in list(object, "constraints") {
            let Some((bounds, end)) = self.constraint(uid, constraint)? else { continue };
            let to = self.reachable(&end).unwrap_or(node);
            match single {
                Some(arc) if self.arcs[arc.index()].to == to => {
                    self.tighten(arc, bounds, constraint);
                    let object = self.object(uid, constraint)?;
                    self.read_labels(arc, object, constraint)?;
                }
                _ if to != node => {
                    let object = self.object(uid, constraint)?;
                    let is_between = object.get(BETWEEN_THREADS).and_then(Value::as_bool) == Some(true);
                    let (from, kind) = if is_between {
                        (node, ArcKind::Constraint)
                    } else {
                        (carrier.unwrap_or(node), ArcKind::Span)
                    };
                    let span = self.add_arc(from, to, kind, bounds, Some(constraint));
                    let object = self.object(uid, constraint)?;
                    self.read_labels(span, object, constraint)?;
                }
                _ if self.ids.get(&end) == Some(&node) => self.add_self_loop(node, bounds, constraint),
                _ => self.not_planned.push(constraint.to_owned()),
            }
        }
        Ok(())
    }

    /// A constraint from an event to itself: it allows 0, and then says nothing, or nothing can keep it.
    fn add_self_loop(&mut self, node: NodeId, bounds: Bounds, constraint: &str) {
        if bounds.0 > Time::ZERO {
            let dead = self.add_node(None);
            self.dead_ends.push(dead);
            self.add_arc(node, dead, ArcKind::Glue, (Time::ZERO, Bound::ZERO), None);
            self.add_arc(node, dead, ArcKind::Span, bounds, Some(constraint));
        }
    }

    /// The node of `uid` if anything leads to it; constraints on what cannot happen mean nothing.
    fn reachable(&self, uid: &str) -> Option<NodeId> {
        self.ids.get(uid).copied()
    }

    fn read_arc(
        &mut self,
        from_uid: &str,
        uid: &str,
        from: NodeId,
        decision: Option<DecisionId>,
    ) -> Result<ArcId, PlanSchemaError> {
        let object = self.object(from_uid, uid)?;
        let to_uid = self.reference(uid, "end-node")?;
        let (zero, any) = ((Time::ZERO, Bound::ZERO), (Time::ZERO, Bound::Infinite));
        let to_kind = kind(self.object(uid, &to_uid)?).to_owned();
        let is_null = kind(object) == "null-activity";
        let is_guard = is_null && object.get("conditions").is_some();
        let (arc_kind, default) = match kind(object) {
            "null-activity" if is_guard => (ArcKind::Point, zero),
            "null-activity" if to_kind == "p-end" => (ArcKind::Join, any),
            "null-activity" if to_kind == "c-end" => (ArcKind::Merge, zero),
            "null-activity" if kind(self.object(from_uid, from_uid)?) == "p-begin" => (ArcKind::Fork, zero),
            "null-activity" => (ArcKind::Glue, zero),
            "delay-activity" => (ArcKind::Delay, any),
            _ => (ArcKind::Activity, any),
        };
        let mut to = self.node_of(&to_uid);
        let mut start = from;
        // Only choice arcs leave a decision, and they take no time: an activity there starts at a node of its own.
        if let Some(decision) = decision {
            let alternative = self.decisions[decision.index()].alternatives.len() as u32;
            let is_plain = arc_kind != ArcKind::Activity
                && arc_kind != ArcKind::Delay
                && list(object, "constraints").next().is_none()
                && !is_guard
                && to_kind != "p-end";
            let target = if is_plain { to } else { self.add_node(None) };
            let choice = self.add_arc(from, target, ArcKind::Choice, zero, is_plain.then_some(uid));
            self.arcs[choice.index()].choice = Some((decision, alternative));
            self.decisions[decision.index()].alternatives.push(choice);
            if is_plain {
                return Ok(choice);
            }
            start = target;
        }
        if start == to {
            to = self.add_node(None);
        }
        let arc = self.add_arc(start, to, arc_kind, default, Some(uid));
        if !is_null {
            self.name_occurrence(arc, object);
        }
        self.read_labels(arc, object, uid)?;
        for constraint in list(object, "constraints") {
            let Some((bounds, end)) = self.constraint(uid, constraint)? else { continue };
            match self.reachable(&end) {
                Some(other) if self.node_of(&end) != to && other != start => {
                    self.add_arc(start, other, ArcKind::Span, bounds, Some(constraint));
                }
                _ if is_null && arc_kind != ArcKind::Point => self.replace(arc, bounds),
                _ => self.tighten(arc, bounds, constraint),
            }
        }
        Ok(arc)
    }

    /// The bounds of a temporal constraint and where it ends; `None`, and noted, for constraints on cost or reward.
    fn constraint(&mut self, from: &str, uid: &str) -> Result<Option<(Bounds, String)>, PlanSchemaError> {
        let object = self.object(from, uid)?;
        if kind(object) != "temporal-constraint" {
            self.not_planned.push(uid.to_owned());
            return Ok(None);
        }
        let error =
            |problem: &str| PlanSchemaError::Bounds { uid: uid.to_owned(), problem: problem.to_owned() };
        // What is left out bounds nothing, and a variable for bounds is at its default.
        let value = object.get("value");
        let value = if is_variable(value) { value.and_then(|value| value.get("default")) } else { value };
        let (lower, upper) = match value {
            None | Some(Value::Null) => (&Value::Null, &Value::Null),
            Some(Value::Array(sides)) if sides.is_empty() => (&Value::Null, &Value::Null),
            Some(Value::Array(sides)) => match sides.as_slice() {
                [lower, upper] => (lower, upper),
                _ => return Err(error("`value` must be a pair of bounds")),
            },
            Some(_) => return Err(error("`value` must be a pair of bounds")),
        };
        let lower = match lower {
            Value::Null => Time::ZERO,
            lower => Time::deserialize(lower).map_err(|_| error("the minimum is not a time"))?,
        };
        let upper = match upper {
            Value::Null => Bound::Infinite,
            upper => Bound::deserialize(upper).map_err(|_| error("the maximum is not a time"))?,
        };
        if lower.is_negative() || Bound::Finite(lower) > upper {
            return Err(error("the bounds must satisfy 0 ≤ minimum ≤ maximum"));
        }
        // Without an end of its own, a constraint is about what lists it, where that has one.
        let has_end = |object: &Value| object.get("end-node").is_some_and(|end| !end.is_null());
        let owner = if !has_end(object) && has_end(self.object(from, from)?) { from } else { uid };
        Ok(Some(((lower, upper), self.reference(owner, "end-node")?)))
    }

    /// Narrows the duration of an activity; what cannot be narrowed gets an arc beside it.
    fn tighten(&mut self, arc: ArcId, bounds: Bounds, constraint: &str) {
        let own = &mut self.arcs[arc.index()];
        let both = (own.lower.max(bounds.0), own.upper.min(bounds.1));
        let is_duration = matches!(own.kind, ArcKind::Activity | ArcKind::Assertion | ArcKind::Delay);
        // Constraints that contradict each other make the network inconsistent, not unreadable.
        if is_duration && Bound::Finite(both.0) <= both.1 {
            (own.lower, own.upper) = both;
        } else {
            let (from, to) = (own.from, own.to);
            self.add_arc(from, to, ArcKind::Span, bounds, Some(constraint));
        }
    }

    /// An explicit constraint says what a null activity takes, which is otherwise nothing.
    fn replace(&mut self, arc: ArcId, bounds: Bounds) {
        let own = &mut self.arcs[arc.index()];
        (own.lower, own.upper) = bounds;
    }

    fn add_arc(
        &mut self,
        from: NodeId,
        to: NodeId,
        kind: ArcKind,
        bounds: Bounds,
        uid: Option<&str>,
    ) -> ArcId {
        self.arcs.push(Arc::bare(from, to, bounds, kind));
        self.arc_uids.push(uid.map(str::to_owned));
        ArcId::from_index(self.arcs.len() - 1)
    }

    fn name_occurrence(&mut self, arc: ArcId, object: &Value) {
        let text = |key: &str| object.get(key).and_then(Value::as_str).filter(|name| !name.is_empty());
        let (activity, kind) = if kind(object) == "delay-activity" {
            (SmolStr::new("delay"), OccurrenceKind::Delay)
        } else {
            let name = text("command").or_else(|| text("name")).unwrap_or("activity");
            let is_assertion =
                object.get("conditions").is_some() && (name.starts_with("Tell(") || name.starts_with("Ask("));
            let kind = if is_assertion { OccurrenceKind::Assertion } else { OccurrenceKind::Primitive };
            (SmolStr::new(name), kind)
        };
        let count = self.counts.entry(activity.clone()).or_insert(0);
        *count += 1;
        let arguments = object.get("args").and_then(Value::as_array).into_iter().flatten();
        let arguments = arguments.map(|argument| match argument {
            Value::String(text) => text.into(),
            other => SmolStr::from(other.to_string()),
        });
        let id = OccurrenceId::from_index(self.occurrences.len());
        let own = &mut self.arcs[arc.index()];
        own.occurrence = Some(id);
        if kind == OccurrenceKind::Assertion {
            own.kind = ArcKind::Assertion;
        }
        self.occurrences.push(Occurrence {
            name: format!("{activity}#{count}").into(),
            activity,
            kind,
            start: own.from,
            end: own.to,
            arc: Some(arc),
            arguments: arguments.collect(),
            parent: None,
            aborts: None,
            span: None,
        });
    }

    /// `conditions` is this program's own key: `[{"type": "Ask" | "Tell", "literal": "X=V"}, …]`.
    fn read_labels(&mut self, arc: ArcId, object: &Value, uid: &str) -> Result<(), PlanSchemaError> {
        for label in object.get("conditions").and_then(Value::as_array).into_iter().flatten() {
            let wrong = || PlanSchemaError::Shape(format!("the condition of `{uid}` must be a literal"));
            let mode = match label.get("type").and_then(Value::as_str) {
                Some("Ask") => LabelMode::Ask,
                Some("Tell") => LabelMode::Tell,
                _ => return Err(wrong()),
            };
            let text = label.get("literal").and_then(Value::as_str).ok_or_else(wrong)?;
            let literal = self.vocabulary.literal(text).ok_or_else(wrong)?;
            let owner = self.arcs[arc.index()].occurrence;
            self.arcs[arc.index()].labels.push(LabelId::from_index(self.labels.len()));
            let extent = match label.get("extent") {
                None => Extent::Arc,
                Some(extent) => serde_json::from_value(extent.clone()).map_err(|_| wrong())?,
            };
            self.labels.push(Label { arc, mode, extent, literal, text: text.into(), owner, span: None });
        }
        Ok(())
    }
}

/// Links arcs to their nodes and events to theirs.
fn link(network: &mut Network) {
    for (index, arc) in network.arcs.iter().enumerate().filter(|(_, arc)| arc.kind != ArcKind::Constraint) {
        network.nodes[arc.from.index()].out_arcs.push(ArcId::from_index(index));
        network.nodes[arc.to.index()].in_arcs.push(ArcId::from_index(index));
    }
    for (index, occurrence) in network.occurrences.iter().enumerate() {
        let id = OccurrenceId::from_index(index);
        network.nodes[occurrence.start.index()]
            .events
            .push(EventRef { occurrence: id, end: EventEnd::Start });
        network.nodes[occurrence.end.index()].events.push(EventRef { occurrence: id, end: EventEnd::End });
    }
    for node in &mut network.nodes {
        node.role = match (node.decision, node.events.is_empty()) {
            (Some(_), _) => Role::Decision,
            (None, false) => Role::Event,
            (None, true) => Role::Structural,
        };
    }
}

/// Returns whether bounds are a variable (`lvar`) of Pamela.
pub(super) fn is_variable(value: Option<&Value>) -> bool {
    value.and_then(|value| value.get("type")).and_then(Value::as_str) == Some("lvar")
}

pub(super) fn kind(object: &Value) -> &str {
    object.get("tpn-type").and_then(Value::as_str).unwrap_or("")
}

fn list<'value>(object: &'value Value, key: &str) -> impl Iterator<Item = &'value str> {
    object.get(key).and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str)
}
