//! Vehicles that would meet are kept apart (SPEC 10.3): where two traverses come too near each other, one is put before the
//! other, or led around where the other is then, and the mission is planned again.
//!
//! What has time for neither stays as it is, with its warning.

use snapshot::vehicle;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use exact::Rational;
use kirk::Options;
use rmpl::program::{Change, ObstacleShape};
use smol_str::format_smolstr;
use snapshot::vehicle::{WAY, is_way};
use snapshot::{SeparationViolation, VehicleMotion};
use tpn::worth;
use tpn::{Network, NodeId, OccurrenceId, Plan, Resource, ResourceId, Supply, Use};

use crate::planning::{self, Planned, Problem};

/// Orders that are tried for one mission, at most.
const MAX_TRIES: usize = 12;
/// Ways around that are looked for in one mission, at most.
const MAX_WAYS: usize = 12;
/// Ways around one another of the same two traverses: the way around takes longer, so that they meet elsewhere.
const MAX_WAYS_OF_PAIR: usize = 4;
/// Metres that a way around keeps beyond what is needed.
const SPARE_M: f64 = 0.3;
/// Metres between the places that a way around keeps out of.
const PLACE_STEP_M: f64 = 0.25;

/// Where the paths of traverses may not go, because other vehicles are there then.
pub type KeepOuts = BTreeMap<OccurrenceId, Vec<ObstacleShape>>;

/// `planned`, or a plan of the same mission in which fewer vehicles come too near each other.
pub(crate) fn kept_apart(
    problem: &Problem<'_>,
    mut planned: Planned,
    plan_again: &mut dyn FnMut(&Problem<'_>) -> Planned,
) -> Planned {
    let best = planned.planning.outcome.plans.first().cloned().map(|plan| (plan, planned.counted_m));
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
    let mut planned = led_around(&Problem { network: &network, options, ..*problem }, planned, plan_again);
    if let Some((best, counted_m)) = best {
        admit_worse(problem.network, (&best, counted_m), &mut planned);
    }
    planned
}

/// Where keeping apart made an optimal plan worse, nothing is proven but that none is better than it was without.
fn admit_worse(network: &Network, (best, counted_m): (&Plan, f64), planned: &mut Planned) {
    let own_m = planned.counted_m;
    let planning = Arc::make_mut(&mut planned.planning);
    let Some(plan) = planning.outcome.plans.first_mut() else { return };
    let values = |plan: &Plan, driven_m: f64| worth::goal_values(network, plan, driven_m);
    let (Some(before), Some(after)) = (values(best, counted_m), values(plan, own_m)) else { return };
    let mut goals = network.objective.iter().zip(before.iter().zip(&after));
    let differs = goals.find(|(_, (before, after))| before != after);
    if let Some((goal, (before, after))) = differs
        && (before > after) == goal.is_maximized
    {
        plan.quality.is_optimal = Some(false);
        planning.outcome.bound = Some(*before);
    }
}

/// `planned`, or a plan of the same mission in which fewer vehicles come too near each other, because the paths of some go
/// around where the others are then.
fn led_around(
    problem: &Problem<'_>,
    mut planned: Planned,
    plan_again: &mut dyn FnMut(&Problem<'_>) -> Planned,
) -> Planned {
    let mut keep_outs = KeepOuts::new();
    let mut tried: BTreeSet<(OccurrenceId, u32)> = BTreeSet::new();
    let mut ways = 0;
    while ways < MAX_WAYS {
        let untried = planned.separation_violations.iter().flat_map(goes_around).find_map(|(goes, stays)| {
            let occurrence = movement_at(&planned, goes)?.occurrence;
            (!tried.contains(&(occurrence, stays.vehicle))).then_some((occurrence, goes, stays))
        });
        let Some((occurrence, goes, stays)) = untried else { break };
        tried.insert((occurrence, stays.vehicle));
        let pair = [goes.vehicle, stays.vehicle];
        let mut wider = keep_outs.clone();
        let mut places = places(problem, &planned.motions, goes, stays);
        for _ in 0..MAX_WAYS_OF_PAIR {
            wider.entry(occurrence).or_default().append(&mut places);
            ways += 1;
            let other = plan_again(&Problem { keep_outs: Some(&wider), ..*problem });
            let is_valid = other.planning.verdict.as_ref().is_some_and(|verdict| verdict.valid);
            if !is_valid || !planning::has_plan(&other.planning.outcome) {
                break;
            }
            if other.separation_violations.len() < planned.separation_violations.len() {
                (keep_outs, planned) = (wider, other);
                break;
            }
            let again = other.separation_violations.iter().flat_map(goes_around).find(|(goes, stays)| {
                [goes.vehicle, stays.vehicle] == pair
                    && movement_at(&other, *goes).is_some_and(|movement| movement.occurrence == occurrence)
            });
            let Some((goes, stays)) = again else { break };
            places = self::places(problem, &other.motions, goes, stays);
        }
    }
    planned
}

/// A vehicle at the time of a violation.
#[derive(Clone, Copy)]
struct Party<'planned> {
    vehicle: u32,
    violation: &'planned SeparationViolation,
}

/// Who may go around whom.
fn goes_around(violation: &SeparationViolation) -> [(Party<'_>, Party<'_>); 2] {
    let [one, other] = violation.vehicles.map(|vehicle| Party { vehicle, violation });
    [(one, other), (other, one)]
}

/// What a vehicle is driving when it comes too near another one.
fn movement_at(planned: &Planned, party: Party<'_>) -> Option<Movement> {
    under_way(&movements(planned, party.vehicle), party.violation)
}

/// Where `stays` is while the two are too near each other, with the room that it needs.
fn places(
    problem: &Problem<'_>,
    motions: &[VehicleMotion],
    goes: Party<'_>,
    stays: Party<'_>,
) -> Vec<ObstacleShape> {
    let world = &problem.program.world;
    let of = |party: Party<'_>| motions.iter().find(|motion| motion.vehicle == party.vehicle);
    let (Some(goes_m), Some(stays_m)) = (of(goes), of(stays)) else { return Vec::new() };
    let radius_m = vehicle::radius_m(world, stays.vehicle) + vehicle::GAP_M + SPARE_M;
    let safety_m = radius_m + vehicle::radius_m(world, goes.vehicle);
    let violation = stays.violation;
    let end = |motion: &VehicleMotion| motion.keyframes.last().map_or(0.0, |frame| frame.time.to_f64());
    let last = end(goes_m).max(end(stays_m));
    let step = ((violation.time - violation.since) / 16.0).max(last / 4000.0);
    // While they are near each other, both ways in time from when they are nearest.
    let while_near = |direction: f64| {
        (0..4000)
            .map(move |count| violation.time + direction * step * f64::from(count))
            .take_while(move |time| (0.0..=last).contains(time))
            .map_while(|time| Some((goes_m.at(time)?.0, stays_m.at(time)?.0)))
            .take_while(|(one, other)| nalgebra::distance(one, other) < safety_m)
            .map(|(_, place)| place)
    };
    let mut places: Vec<nalgebra::Point2<f64>> = Vec::new();
    for place in while_near(1.0).chain(while_near(-1.0)) {
        if places.iter().all(|known| nalgebra::distance(known, &place) >= PLACE_STEP_M) {
            places.push(place);
        }
    }
    places.into_iter().map(|place| ObstacleShape::Circle { center_m: place.into(), radius_m }).collect()
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
