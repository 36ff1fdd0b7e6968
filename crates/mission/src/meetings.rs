//! Vehicles that would meet are kept apart in time (SPEC 10.3): where two traverses come too near each other, one is put
//! before the other, and the mission is planned again.
//!
//! What is in order already, or has no time to wait, stays as it is, with its warning.

use std::collections::BTreeSet;
use std::sync::Arc;

use exact::Rational;
use kirk::Options;
use rmpl::program::Change;
use smol_str::format_smolstr;
use tpn::{Network, NodeId, OccurrenceId, Resource, ResourceId, Supply, Use};

use crate::planning::{self, Planned, Problem};
use crate::snapshot::SeparationViolation;

/// Orders that are tried for one mission, at most.
const MAX_TRIES: usize = 12;
/// What the order of two traverses that would meet is called, as a resource that the mission does not have.
const WAY: &str = "way#";

/// Whether a resource is the order of two traverses that would meet.
pub fn is_way(resource: &Resource) -> bool {
    resource.name.starts_with(WAY)
}

/// `planned`, or a plan of the same mission in which fewer vehicles come too near each other.
pub(crate) fn kept_apart(
    problem: &Problem<'_>,
    mut planned: Planned,
    plan_again: &mut dyn FnMut(&Problem<'_>) -> Planned,
) -> Planned {
    let mut network = Arc::clone(problem.network);
    let mut tried: BTreeSet<(OccurrenceId, OccurrenceId)> = BTreeSet::new();
    let options = Options { explain: false, relax: false, ..problem.options };
    while tried.len() < MAX_TRIES {
        let untried = orders(&planned).into_iter().find(|order| !tried.contains(order));
        let Some((first, then)) = untried else { break };
        tried.insert((first, then));
        let ordered = Arc::new(with_order(&network, first, then));
        let other = plan_again(&Problem { network: &ordered, options, ..*problem });
        let is_valid = other.planning.verdict.as_ref().is_some_and(|verdict| verdict.valid);
        let is_better = other.separation_violations.len() < planned.separation_violations.len();
        if is_valid && is_better && planning::has_plan(&other.planning.outcome) {
            (network, planned) = (ordered, other);
        }
    }
    planned
}

/// The orders of two traverses that may keep vehicles apart, the likeliest first: who is nearer to being out of the way goes
/// first.
fn orders(planned: &Planned) -> Vec<(OccurrenceId, OccurrenceId)> {
    let mut orders = Vec::new();
    for violation in &planned.separation_violations {
        let [one, other] = violation.vehicles.map(|vehicle| movements(planned, vehicle));
        let pairs = match (under_way(&one, violation), under_way(&other, violation)) {
            (Some(one), Some(other)) => {
                let (earlier, later) = if one.start <= other.start { (one, other) } else { (other, one) };
                vec![(earlier, later), (later, earlier)]
            }
            (Some(moving), None) => beside(&moving, &other),
            (None, Some(moving)) => beside(&moving, &one),
            (None, None) => Vec::new(),
        };
        orders.extend(pairs.into_iter().map(|(first, then)| (first.occurrence, then.occurrence)));
    }
    orders
}

/// A vehicle that stands in the way drives on before, or comes there after.
fn beside(moving: &Movement, standing: &[Movement]) -> Vec<(Movement, Movement)> {
    let next = standing.iter().find(|it| it.start >= moving.start).map(|next| (*next, *moving));
    let last = standing.iter().rev().find(|it| it.end <= moving.end).map(|last| (*moving, *last));
    next.into_iter().chain(last).filter(|(first, then)| first.occurrence != then.occurrence).collect()
}

/// One traverse of a vehicle in the plan's earliest schedule.
#[derive(Clone, Copy, Debug)]
struct Movement {
    occurrence: OccurrenceId,
    start: f64,
    end: f64,
}

fn movements(planned: &Planned, vehicle: u32) -> Vec<Movement> {
    let Some(plan) = planned.planning.outcome.plans.first() else { return Vec::new() };
    let earliest = |node: NodeId| plan.windows[node.index()].map(|window| window.earliest.to_f64());
    let own = planned.traverses.iter().filter(|traverse| traverse.vehicles.contains(&vehicle));
    let mut movements: Vec<Movement> = own
        .filter_map(|traverse| {
            let of = &planned.network.occurrences[traverse.occurrence.index()];
            let (start, end) = (earliest(of.start)?, earliest(of.end)?);
            Some(Movement { occurrence: traverse.occurrence, start, end })
        })
        .collect();
    movements.sort_by(|one, other| one.start.total_cmp(&other.start));
    movements
}

fn under_way(movements: &[Movement], violation: &SeparationViolation) -> Option<Movement> {
    movements.iter().find(|it| it.start <= violation.time && violation.time <= it.end).copied()
}

/// The network in which a traverse starts only after another one has ended: it takes what the other one leaves.
fn with_order(network: &Network, first: OccurrenceId, then: OccurrenceId) -> Network {
    let mut network = network.clone();
    let resource = ResourceId::from_index(network.resources.len());
    let number = network.resources.iter().filter(|resource| is_way(resource)).count() + 1;
    network.resources.push(Resource {
        name: format_smolstr!("{WAY}{number}"),
        supply: Supply::Reservoir { least: Rational::ZERO, greatest: Rational::ONE, level: Rational::ZERO },
        span: None,
    });
    for (owner, change) in [(first, Change::Produces), (then, Change::Consumes)] {
        let of = &network.occurrences[owner.index()];
        let Some(arc) = of.arc else { continue };
        let (start, end, span) = (of.start, of.end, of.span);
        network.uses.push(Use {
            resource,
            change,
            amount: Rational::ONE,
            per_metre: Rational::ZERO,
            arc,
            start,
            end,
            owner: Some(owner),
            span,
        });
    }
    network
}
