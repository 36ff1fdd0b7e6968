//! `enroute stn` for networks with contingent links: consistency and windows as for plain ones, and whether the network
//! is dynamically controllable; if not, the cycle and what would fix it.

use std::fmt::Write as _;

use anyhow::anyhow;
use serde_json::{Value, json};
use stn::{Inconsistency, Stn};
use stnu::{Conflict, Document, Edge, Part, Relaxation, Verdict};

/// Larger networks are answered without what would fix them, which takes many checks.
const MAX_POINTS_FOR_RELAXATIONS: usize = 2_000;

/// Whether a network is controllable, and why not.
pub enum Controllability {
    /// Whatever the environment chooses, execution can continue to the end.
    Controllable,
    /// It cannot, for this reason; the least changes of its members, if they were asked for.
    Uncontrollable(Conflict, Option<Vec<Relaxation>>),
}

/// Checks a network, and looks for what would fix it.
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

/// The network with its contingent links as ordinary bounds, and whether it is consistent.
pub fn ordinary(document: &Document) -> anyhow::Result<(Stn, Result<(), Inconsistency>)> {
    let network = &document.network;
    let mut edges: Vec<Edge> = network.edges().to_vec();
    for link in network.links() {
        edges.push(Edge { from: link.activation, to: link.end, weight: link.upper });
        let weight = link.lower.checked_neg().ok_or_else(|| anyhow!("a time does not fit into 64 bits"))?;
        edges.push(Edge { from: link.end, to: link.activation, weight });
    }
    let mut stn = Stn::new(network.num_points());
    stn.reserve(edges.len());
    for (position, edge) in (0..).zip(&edges) {
        let (from, to) = (stn::PointId(edge.from.0), stn::PointId(edge.to.0));
        if let Err(inconsistency) = stn.insert(from, to, edge.weight, position) {
            return Ok((stn, Err(inconsistency)));
        }
    }
    Ok((stn, Ok(())))
}

/// The answer for people.
pub fn text(document: &Document, answer: &Controllability) -> String {
    let Controllability::Uncontrollable(conflict, relaxations) = answer else {
        return "controllable\n".to_owned();
    };
    let mut text =
        format!("not controllable: a semi-reducible cycle of weight -{}\n", document.time(conflict.deficit));
    for step in conflict.cycle.iter().flatten() {
        let case = match step.part {
            Part::Edge(_) => "",
            Part::Lower(_) => "  (shortest contingent duration)",
            Part::Upper(_) => "  (longest contingent duration)",
        };
        let (from, to) = (document.name(step.from), document.name(step.to));
        let _ = writeln!(text, "{from} {} {to}{case}", document.time(step.weight));
    }
    for relaxation in relaxations.iter().flatten() {
        if let Some(value) = relaxation.sufficient {
            let _ = writeln!(text, "fix: {}", mend(document, relaxation, value));
        }
    }
    text
}

fn mend(document: &Document, relaxation: &Relaxation, value: i64) -> String {
    let (value, old) = (document.time(value), document.time(relaxation.old));
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
                "weight": document.time(step.weight),
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
        "value": document.time(relaxation.old),
        "resolving": relaxation.resolving.map(|tick| document.time(tick)),
        "sufficient": relaxation.sufficient.map(|tick| document.time(tick)),
    })
}
