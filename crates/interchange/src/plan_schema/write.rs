//! From a network to plan-schema objects that other tools can read.

use std::collections::BTreeMap;

use exact::Bound;
use rmpl::program::LabelMode;
use serde_json::{Map, Value, json};

use super::BETWEEN_THREADS;
use tpn::network::{ArcId, ArcKind, BlockKind, Extent, Network, NodeId};

/// Writes `network` in plan-schema JSON.
///
/// A node of plan-schema is either the beginning or the end of a choice or parallel, so a node that is both becomes two
/// with a null activity between them. Conditions, which plan-schema does not know, are under the key `conditions` of
/// activities and constraints, and variables under `variables` of the network object.
pub fn write(network: &Network) -> Value {
    let mut writer = Writer { network, objects: Map::new(), ends: block_ends(network) };
    let network_object = json!({
        "uid": "net-1",
        "tpn-type": "network",
        "begin-node": writer.begin_uid(network.start),
        "end-node": end_uid(network.end),
        "variables": network.variables,
        "threat-gap": network.threat_gap,
    });
    for index in 0..network.nodes.len() {
        writer.node(NodeId::from_index(index));
    }
    let mut objects = writer.objects;
    objects.insert("net-1".into(), network_object);
    objects.insert("network-id".into(), "net-1".into());
    Value::Object(objects)
}

struct Writer<'network> {
    network: &'network Network,
    objects: Map<String, Value>,
    /// The last node of the choice or parallel that starts at a node.
    ends: BTreeMap<NodeId, NodeId>,
}

impl Writer<'_> {
    fn node(&mut self, id: NodeId) {
        let (begin, end) = (self.begin_type(id), self.end_type(id));
        let incidence: Vec<String> = self.plain(&self.network.nodes[id.index()].in_arcs, &arc_uid);
        let activities: Vec<String> = self.plain(&self.network.nodes[id.index()].out_arcs, &arc_uid);
        let constraints = self.constraints(id);
        let between = format!("na-n{}", id.0);
        let is_split = begin.is_some() && end.is_some();
        let (first_out, second_in) = if is_split {
            (vec![between.clone()], vec![between.clone()])
        } else {
            (activities.clone(), incidence.clone())
        };
        if is_split {
            let first_type = end.unwrap_or("state");
            self.add(&end_uid(id), json!({
                "tpn-type": first_type, "activities": first_out, "incidence-set": incidence, "constraints": [],
            }));
            self.add(
                &between,
                json!({
                    "tpn-type": "null-activity", "end-node": self.begin_uid(id), "constraints": [],
                }),
            );
        }
        let mut node = json!({
            "tpn-type": begin.or(end).unwrap_or("state"),
            "activities": activities,
            "incidence-set": second_in,
            "constraints": constraints,
        });
        if let (Some(_), Some(end)) = (begin, self.ends.get(&id)) {
            node["end-node"] = end_uid(*end).into();
        }
        self.add(&self.begin_uid(id), node);
        let between_threads: Vec<ArcId> = self.constraints_from(id).collect();
        for &arc in self.network.nodes[id.index()].out_arcs.iter().chain(&between_threads) {
            self.arc(arc);
        }
    }

    fn arc(&mut self, id: ArcId) {
        let arc = &self.network.arcs[id.index()];
        let bounds = json!([arc.lower, upper(arc.upper)]);
        let constraint_uid = format!("tc-{}", id.0);
        if is_span(arc.kind) {
            let mut constraint = json!({
                "tpn-type": "temporal-constraint", "value": bounds, "end-node": end_uid(arc.to),
            });
            self.add_conditions(id, &mut constraint);
            if arc.kind == ArcKind::Constraint {
                constraint[BETWEEN_THREADS] = true.into();
            }
            self.add(&constraint_uid, constraint);
            return;
        }
        let is_timed = match arc.kind {
            ArcKind::Join => Bound::Finite(arc.lower) != Bound::ZERO || arc.upper != Bound::Infinite,
            ArcKind::Activity | ArcKind::Assertion | ArcKind::Delay => true,
            _ => Bound::Finite(arc.lower) != Bound::ZERO || arc.upper != Bound::ZERO,
        };
        let constraints = if is_timed { vec![constraint_uid.clone()] } else { Vec::new() };
        let mut object = json!({"end-node": end_uid(arc.to), "constraints": constraints});
        let occurrence = arc.occurrence.map(|occurrence| &self.network.occurrences[occurrence.index()]);
        match (arc.kind, occurrence) {
            (ArcKind::Activity | ArcKind::Assertion, Some(occurrence)) => {
                object["tpn-type"] = "activity".into();
                object["name"] = occurrence.activity.as_str().into();
                object["command"] = occurrence.activity.as_str().into();
                object["args"] = json!(occurrence.arguments);
                object["controllable"] = (!arc.is_contingent).into();
                object["cost"] = 0.into();
                object["reward"] = 0.into();
            }
            (ArcKind::Delay, _) => {
                object["tpn-type"] = "delay-activity".into();
                object["name"] = "Delay".into();
                object["controllable"] = (!arc.is_contingent).into();
            }
            _ => object["tpn-type"] = "null-activity".into(),
        }
        if let Some((_, alternative)) = arc.choice {
            object["order"] = alternative.into();
        }
        self.add_conditions(id, &mut object);
        self.add(&arc_uid(id), object);
        if is_timed {
            let constraint =
                json!({"tpn-type": "temporal-constraint", "value": bounds, "end-node": end_uid(arc.to)});
            self.add(&constraint_uid, constraint);
        }
    }

    fn add_conditions(&self, id: ArcId, object: &mut Value) {
        let conditions: Vec<Value> = (self.network.arcs[id.index()].labels.iter())
            .map(|&label| {
                let label = &self.network.labels[label.index()];
                let mode = if label.mode == LabelMode::Ask { "Ask" } else { "Tell" };
                // What is in sight is known on the mission's ground only: the places are named instead.
                let literal = match self.network.sight(label) {
                    Some(sight) => {
                        let places = self.network.value_names(&label.literal).join(", ");
                        format!("{} in {{{places}}}", self.network.variables[sight.variable.index()].name)
                    }
                    None => label.text.to_string(),
                };
                let mut condition = json!({"type": mode, "literal": literal});
                if label.extent != Extent::Arc {
                    condition["extent"] = json!(label.extent);
                }
                condition
            })
            .collect();
        if !conditions.is_empty() {
            object["conditions"] = conditions.into();
        }
    }

    fn add(&mut self, uid: &str, mut object: Value) {
        object["uid"] = uid.into();
        self.objects.insert(uid.to_owned(), object);
    }

    fn plain(&self, arcs: &[ArcId], uid: &dyn Fn(ArcId) -> String) -> Vec<String> {
        arcs.iter().filter(|arc| !is_span(self.network.arcs[arc.index()].kind)).map(|&arc| uid(arc)).collect()
    }

    fn constraints(&self, id: NodeId) -> Vec<String> {
        let spans = self.network.nodes[id.index()].out_arcs.iter();
        let spans = spans.filter(|arc| is_span(self.network.arcs[arc.index()].kind));
        let spans = spans.copied().chain(self.constraints_from(id));
        spans.map(|arc| format!("tc-{}", arc.0)).collect()
    }

    /// The bounds between threads that begin at a node.
    fn constraints_from(&self, id: NodeId) -> impl Iterator<Item = ArcId> + '_ {
        self.network.constraints().filter(move |arc| self.network.arcs[arc.index()].from == id)
    }

    fn begin_type(&self, id: NodeId) -> Option<&'static str> {
        let node = &self.network.nodes[id.index()];
        if node.decision.is_some() {
            return Some("c-begin");
        }
        let kinds = || node.out_arcs.iter().map(|arc| self.network.arcs[arc.index()].kind);
        let is_fork =
            kinds().any(|kind| kind == ArcKind::Fork) || kinds().filter(|&kind| !is_span(kind)).count() > 1;
        is_fork.then_some("p-begin")
    }

    fn end_type(&self, id: NodeId) -> Option<&'static str> {
        let mut kinds =
            self.network.nodes[id.index()].in_arcs.iter().map(|arc| self.network.arcs[arc.index()].kind);
        kinds.find_map(|kind| match kind {
            ArcKind::Join => Some("p-end"),
            ArcKind::Merge => Some("c-end"),
            _ => None,
        })
    }

    /// The uid of the object that arcs leave: the second one of a node that became two.
    fn begin_uid(&self, id: NodeId) -> String {
        let is_split = self.begin_type(id).is_some() && self.end_type(id).is_some();
        if is_split { format!("node-{}b", id.0) } else { end_uid(id) }
    }
}

/// The uid of the object that arcs enter.
fn end_uid(id: NodeId) -> String {
    format!("node-{}", id.0)
}

fn arc_uid(id: ArcId) -> String {
    format!("arc-{}", id.0)
}

fn is_span(kind: ArcKind) -> bool {
    matches!(kind, ArcKind::Composite | ArcKind::Span | ArcKind::Constraint)
}

fn upper(bound: Bound) -> Value {
    bound.finite().map_or_else(|| "Infinity".into(), |time| json!(time))
}

fn block_ends(network: &Network) -> BTreeMap<NodeId, NodeId> {
    let begins = network
        .blocks
        .iter()
        .filter(|block| matches!(block.kind, BlockKind::Parallel { .. } | BlockKind::Choose { .. }));
    begins.map(|block| (block.start, block.end)).collect()
}
