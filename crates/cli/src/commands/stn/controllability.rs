//! `enroute stn` for networks with contingent links: consistency and windows as for plain ones, and whether the network
//! is dynamically controllable; if not, the cycle and what would mend it.

use std::fmt::Write as _;

use anyhow::anyhow;
use serde_json::{Value, json};
use stnu::{Conflict, Document, Part, Relaxation, Verdict};

/// Larger networks are answered without what would mend them, which takes many checks.
const MAX_POINTS_FOR_RELAXATIONS: usize = 2_000;

/// Whether a network is controllable, and why not.
pub enum Controllability {
    /// Whatever nature chooses, execution can go on to the end.
    Controllable,
    /// It cannot, for this reason; the least changes of its members, if they were asked for.
    Uncontrollable(Conflict, Option<Vec<Relaxation>>),
}

/// Checks a network, and looks for what would mend it.
pub fn check(document: &Document) -> anyhow::Result<Controllability> {
    let network = &document.network;
    let never = &mut || false;
    let conflict = match stnu::check(network, never)? {
        Verdict::Controllable => return Ok(Controllability::Controllable),
        Verdict::Uncontrollable(conflict) => stnu::minimal(network, &conflict, never)?,
    };
    let relaxations = if network.num_points() <= MAX_POINTS_FOR_RELAXATIONS {
        Some(stnu::relaxations(network, &conflict, never)?)
    } else {
        None
    };
    Ok(Controllability::Uncontrollable(conflict, relaxations))
}

/// The network with its contingent links as ordinary bounds.
pub fn ordinary(document: &Document) -> anyhow::Result<stn::Document> {
    let mut edges: Vec<stn::DocumentEdge> = Vec::new();
    let mut add = |from: stnu::PointId, to: stnu::PointId, weight: i64| {
        edges.push(stn::DocumentEdge { from: stn::PointId(from.0), to: stn::PointId(to.0), weight });
    };
    for edge in document.network.edges() {
        add(edge.from, edge.to, edge.weight);
    }
    for link in document.network.links() {
        add(link.activation, link.end, link.upper);
        let lower = link.lower.checked_neg().ok_or_else(|| anyhow!("a time does not fit into 64 bits"))?;
        add(link.end, link.activation, lower);
    }
    Ok(stn::Document { names: document.names.clone(), edges })
}

/// The answer for people.
pub fn text(document: &Document, answer: &Controllability) -> String {
    let Controllability::Uncontrollable(conflict, relaxations) = answer else {
        return "controllable\n".to_owned();
    };
    let mut text = format!("not controllable: a semi-reducible cycle of weight -{}\n", conflict.deficit);
    for step in conflict.cycle.iter().flatten() {
        let case = match step.part {
            Part::Edge(_) => "",
            Part::Lower(_) => "  (as short as nature likes)",
            Part::Upper(_) => "  (as long as nature likes)",
        };
        let (from, to) = (document.name(step.from), document.name(step.to));
        let _ = writeln!(text, "{from} {} {to}{case}", step.weight);
    }
    for relaxation in relaxations.iter().flatten() {
        if let Some(value) = relaxation.sufficient {
            let _ = writeln!(text, "it would be controllable with {}", mend(document, relaxation, value));
        }
    }
    text
}

fn mend(document: &Document, relaxation: &Relaxation, value: i64) -> String {
    let old = relaxation.old;
    let network = &document.network;
    match relaxation.part {
        Part::Edge(id) => {
            let edge = network.edge(id);
            let (from, to) = (document.name(edge.from), document.name(edge.to));
            format!("{from} {value} {to} instead of {old}")
        }
        Part::Lower(id) | Part::Upper(id) => {
            let link = network.link(id);
            let (from, to) = (document.name(link.activation), document.name(link.end));
            let bound = if matches!(relaxation.part, Part::Lower(_)) { "at least" } else { "at most" };
            format!("{from} to {to} taking {bound} {value} instead of {old}")
        }
    }
}

/// The members `controllable`, `cycle`, and `relaxations` of the JSON document.
pub fn json(document: &Document, answer: &Controllability) -> (bool, Value, Value) {
    let Controllability::Uncontrollable(conflict, relaxations) = answer else {
        return (true, Value::Null, Value::Null);
    };
    let cycle = conflict.cycle.as_ref().map(|steps| {
        let steps = steps.iter().map(|step| {
            json!({
                "from": document.name(step.from),
                "weight": step.weight,
                "to": document.name(step.to),
                "case": case(step.part),
            })
        });
        steps.collect::<Vec<_>>()
    });
    let relaxations = relaxations.as_ref().map(|relaxations| {
        relaxations.iter().map(|relaxation| relaxation_json(document, relaxation)).collect::<Vec<_>>()
    });
    (false, json!(cycle), json!(relaxations))
}

fn case(part: Part) -> Value {
    match part {
        Part::Edge(_) => Value::Null,
        Part::Lower(_) => json!("lower"),
        Part::Upper(_) => json!("upper"),
    }
}

fn relaxation_json(document: &Document, relaxation: &Relaxation) -> Value {
    let network = &document.network;
    let (from, to) = match relaxation.part {
        Part::Edge(id) => (network.edge(id).from, network.edge(id).to),
        Part::Lower(id) | Part::Upper(id) => (network.link(id).activation, network.link(id).end),
    };
    json!({
        "from": document.name(from),
        "to": document.name(to),
        "case": case(relaxation.part),
        "value": relaxation.old,
        "resolving": relaxation.resolving,
        "sufficient": relaxation.sufficient,
    })
}
