//! The check that a plan can be kept whatever durations the environment chooses (SPEC 13.1), in the author's terms.

use std::collections::BTreeMap;

use exact::Bound;
use rmpl::program::Controllability;
use tpn::{Arc, ArcId, EventEnd, EventRef, Network, Plan};

use super::constraints::Constraints;
use crate::controllability::{Link, Part, refute_dynamic, refute_strong};
use crate::distance::Edge;
use crate::uncertainty::is_uncertain;
use crate::{Rule, Violation, node_name};

/// The constraints of a plan, parted into what the executive must keep and what the environment chooses.
struct Parted {
    points: usize,
    edges: Vec<Edge>,
    links: Vec<Link>,
    /// Indexed by link.
    arcs: Vec<ArcId>,
}

impl Parted {
    /// Makes one point of events that `[0,0]` ties to one instant: they are the environment's if one of them is, and
    /// what the environment ends has no time beforehand.
    fn merge(&mut self, network: &Network, plan: &Plan) {
        let mut first: Vec<u32> = (0..network.nodes.len() as u32).collect();
        let is_tie = |arc: &Arc| arc.lower.is_zero() && arc.upper == Bound::ZERO && !arc.is_contingent;
        let ties = network.arcs.iter().zip(&plan.selected_arcs);
        for (arc, _) in ties.filter(|(arc, is_selected)| **is_selected && is_tie(arc)) {
            let (one, other) = (first[arc.from.index()], first[arc.to.index()]);
            first.iter_mut().filter(|of| **of == other).for_each(|of| *of = one);
        }
        for edge in &mut self.edges {
            (edge.from, edge.to) = (first[edge.from as usize], first[edge.to as usize]);
        }
        for link in &mut self.links {
            (link.start, link.end) = (first[link.start as usize], first[link.end as usize]);
        }
    }

    /// Gives a link an end of its own where another one ends already, or where it begins: that it ends there at the same
    /// instant is a constraint.
    fn part_ends(&mut self) {
        let mut ending: BTreeMap<u32, usize> = BTreeMap::new();
        for place in 0..self.links.len() {
            let Link { start, end, .. } = self.links[place];
            let mut at = start;
            while let Some(&before) = ending.get(&at) {
                at = self.links[before].start;
            }
            let mut own = end;
            if at == end || ending.contains_key(&end) {
                own = self.points as u32;
                self.points += 1;
                self.edges.push(Edge { from: own, to: end, weight: 0, reason: TIE });
                self.edges.push(Edge { from: end, to: own, weight: 0, reason: TIE });
            }
            ending.insert(own, place);
            self.links[place].end = own;
        }
    }
}

/// What the reason of an edge is that says that a link ends where its arc does.
const TIE: u32 = u32::MAX;

/// Whether the plan withstands the environment as far as the mission asks.
pub(super) fn check_controllability(
    network: &Network,
    plan: &Plan,
    constraints: &Constraints,
    violations: &mut Vec<Violation>,
) {
    let uncertain: Vec<ArcId> = (0..network.arcs.len())
        .map(ArcId::from_index)
        .filter(|&arc| is_uncertain(network, &plan.selected_arcs, arc))
        .collect();
    if uncertain.is_empty() {
        return;
    }
    let mut parted = match part(network, constraints, uncertain) {
        Ok(parted) => parted,
        Err(violation) => return violations.push(*violation),
    };
    let is_strong = network.controllability == Controllability::Strong;
    if is_strong {
        parted.merge(network, plan);
    }
    parted.part_ends();
    let refute = if is_strong { refute_strong } else { refute_dynamic };
    if let Some(parts) = refute(parted.points, &parted.edges, &parted.links) {
        violations.push(describe(network, constraints, &parted, &parts, is_strong));
    }
}

fn part(
    network: &Network,
    constraints: &Constraints,
    uncertain: Vec<ArcId>,
) -> Result<Parted, Box<Violation>> {
    let mut parted =
        Parted { points: network.nodes.len(), edges: Vec::new(), links: Vec::new(), arcs: uncertain };
    for &id in &parted.arcs {
        let arc = &network.arcs[id.index()];
        let lower = constraints.least(id);
        let Some(upper) = constraints.greatest(id).filter(|&upper| lower >= 0 && lower <= upper) else {
            let (from, to) = (node_name(network, arc.from), node_name(network, arc.to));
            let (lower, upper) = (Bound::Finite(arc.lower), arc.upper);
            let message =
                format!("the contingent duration from {from} to {to} needs finite bounds: [{lower},{upper}]");
            return Err(Box::new(Violation::new(Rule::Form, message).with_events(vec![from, to])));
        };
        parted.links.push(Link { start: arc.from.0, end: arc.to.0, lower, upper });
    }
    parted
        .edges
        .extend(constraints.edges.iter().filter(|edge| !constraints.is_range(network, edge, &parted.arcs)));
    Ok(parted)
}

/// Whose duration an arc is, and the events between which it is.
fn name(network: &Network, arc: &Arc) -> (String, [String; 2]) {
    if let Some(id) = arc.occurrence
        && let Some(occurrence) = network.occurrences.get(id.index())
    {
        let event = |end| network.event_name(EventRef { occurrence: id, end });
        return (occurrence.name.to_string(), [event(EventEnd::Start), event(EventEnd::End)]);
    }
    let names = [node_name(network, arc.from), node_name(network, arc.to)];
    (format!("{} to {}", names[0], names[1]), names)
}

fn describe(
    network: &Network,
    constraints: &Constraints,
    parted: &Parted,
    parts: &[Part],
    is_strong: bool,
) -> Violation {
    let (mut ranges, mut kept, mut events) = (Vec::new(), Vec::new(), Vec::new());
    for part in parts {
        match *part {
            Part::Link(link) => {
                let id = parted.arcs[link];
                let arc = &network.arcs[id.index()];
                let (who, names) = name(network, arc);
                let lower = constraints.unscaled(constraints.least(id)).unwrap_or(arc.lower);
                ranges.push(format!("{who} takes [{},{}]", lower.readable(), arc.upper.readable()));
                for name in names {
                    if !events.contains(&name) {
                        events.push(name);
                    }
                }
            }
            Part::Reason(TIE) => {}
            Part::Reason(reason) => {
                let told = constraints.tell(network, reason);
                if let Some(told) = told.filter(|told| !kept.contains(told)) {
                    kept.push(told);
                }
            }
        }
    }
    let looked = if is_strong {
        "no schedule fixed in advance can keep"
    } else {
        "no execution strategy can guarantee"
    };
    let what = if kept.is_empty() { "that they end together".to_owned() } else { kept.join("; ") };
    let ranges = ranges.join(", ");
    let message = if ranges.is_empty() {
        format!("these constraints are inconsistent: {what}")
    } else {
        format!("{ranges} (uncontrolled), and {looked} this: {what}")
    };
    Violation::new(Rule::Controllability, message).with_events(events)
}
