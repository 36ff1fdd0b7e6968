//! Vehicles that would meet are kept apart (SPEC 10.3): where two traverses come too near each other in some schedule, one is
//! put before the other, or led around where the other can be then, and the mission is planned again.
//!
//! What has time for neither stays as it is, with its warning.

use snapshot::vehicle;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use exact::Rational;
use kirk::Options;
use nalgebra::Point2;
use rmpl::program::{Change, ObstacleShape};
use smol_str::format_smolstr;
use snapshot::vehicle::{WAY, is_way};
use tpn::worth;
use tpn::{Network, OccurrenceId, Plan, Resource, ResourceId, Supply, Use};

use crate::planning::{self, Planned, Problem};
use crate::separation::Meeting;

/// Orders that are tried in vain for one mission, and ways around, at most: while vehicles meet in the earliest schedule, and
/// while they meet only in others.
const MAX_IN_VAIN: usize = 12;
const MAX_IN_VAIN_FOR_OTHERS: usize = 4;
/// Ways around of the same traverse, at most: on the way around it may meet others, or the same vehicle elsewhere.
const MAX_WAYS_OF_TRAVERSE: usize = 4;
/// Meters that a way around keeps beyond what is needed.
const SPARE_M: f64 = 0.3;

/// Where the paths of traverses may not go, because other vehicles are there then.
pub type KeepOuts = BTreeMap<OccurrenceId, Vec<ObstacleShape>>;

/// Plans a mission again; `None` if planning is to stop.
type PlanAgain<'a> = dyn FnMut(&Problem<'_>) -> Option<Planned> + 'a;

/// `planned`, or a plan of the same mission in which fewer vehicles come too near each other.
pub(crate) fn kept_apart(
    problem: &Problem<'_>,
    mut planned: Planned,
    plan_again: &mut PlanAgain<'_>,
) -> Planned {
    let best = best_plan(&planned).map(|(plan, counted_m)| (plan.clone(), counted_m));
    let mut network = Arc::clone(problem.network);
    let mut tried: BTreeSet<(OccurrenceId, OccurrenceId)> = BTreeSet::new();
    let options = Options { explain: false, relax: false, ..problem.options };
    let mut in_vain = 0;
    while in_vain < max_in_vain(&planned) {
        let orders = planned.meetings.iter().flat_map(|meeting| meeting.orders.iter().copied());
        let untried = orders.into_iter().find(|order| !tried.contains(order));
        let Some((first, then)) = untried else { break };
        tried.insert((first, then));
        let ordered = Arc::new(with_order(&network, first, then));
        let other = plan_again(&Problem { network: &ordered, options, ..*problem });
        let Some(other) = other else { break };
        let is_valid = other.planning.verdict.as_ref().is_some_and(|verdict| verdict.valid);
        let has_plan = planning::has_plan(&other.planning.outcome);
        if is_valid && has_plan && is_better(problem.network, &planned, &other) {
            (network, planned) = (ordered, other);
        } else {
            in_vain += 1;
        }
    }
    let mut planned = led_around(&Problem { network: &network, options, ..*problem }, planned, plan_again);
    if let Some((best, counted_m)) = best {
        admit_worse(problem.network, (&best, counted_m), &mut planned);
    }
    planned
}

/// The first plan, with the meters that are counted for it.
pub(crate) fn best_plan(planned: &Planned) -> Option<(&Plan, f64)> {
    Some((planned.planning.outcome.plans.first()?, planned.counted_m))
}

/// Returns how many pairs meet in the earliest schedule.
fn num_in_earliest(planned: &Planned) -> usize {
    planned.meetings.iter().filter(|meeting| meeting.violation.schedule.is_empty()).count()
}

fn max_in_vain(planned: &Planned) -> usize {
    if num_in_earliest(planned) > 0 { MAX_IN_VAIN } else { MAX_IN_VAIN_FOR_OTHERS }
}

/// Returns whether fewer vehicles meet in another plan; those that meet in the earliest schedule count twice. For
/// schedules that need not come about the objective gives up nothing.
fn is_better(network: &Network, planned: &Planned, other: &Planned) -> bool {
    let (before, after) = (num_in_earliest(planned), num_in_earliest(other));
    let is_fewer = other.meetings.len() + after < planned.meetings.len() + before;
    let is_worse = || {
        let plans = best_plan(planned).zip(best_plan(other));
        plans.is_some_and(|(first, second)| lost(network, first, second).is_some())
    };
    is_fewer && (after < before || !is_worse())
}

/// Returns what the first goal of the objective in which two plans differ had with the first of them, if the second is
/// worse in it. Both come with the meters that are counted for them.
fn lost(
    network: &Network,
    (first, first_m): (&Plan, f64),
    (second, second_m): (&Plan, f64),
) -> Option<Rational> {
    let before = worth::goal_values(network, first, first_m)?;
    let after = worth::goal_values(network, second, second_m)?;
    let mut goals = network.objective.iter().zip(before.into_iter().zip(after));
    let (goal, (before, after)) = goals.find(|(_, (before, after))| before != after)?;
    ((before > after) == goal.is_maximized).then_some(before)
}

/// Where keeping apart made an optimal plan worse, nothing is proven but that none is better than it was without.
fn admit_worse(network: &Network, best: (&Plan, f64), planned: &mut Planned) {
    let own_m = planned.counted_m;
    let planning = Arc::make_mut(&mut planned.planning);
    let Some(plan) = planning.outcome.plans.first_mut() else { return };
    if let Some(before) = lost(network, best, (plan, own_m)) {
        plan.quality.is_optimal = Some(false);
        planning.outcome.bound = Some(before);
    }
}

/// `planned`, or a plan of the same mission in which fewer vehicles come too near each other, because the paths of some go
/// around where the others can be then.
fn led_around(problem: &Problem<'_>, mut planned: Planned, plan_again: &mut PlanAgain<'_>) -> Planned {
    let mut keep_outs = KeepOuts::new();
    let mut tried: BTreeSet<(OccurrenceId, u32)> = BTreeSet::new();
    let mut in_vain = 0;
    while in_vain < max_in_vain(&planned) {
        let untried = planned.meetings.iter().flat_map(ways_around);
        let Some(way) = untried.into_iter().find(|way| !tried.contains(&way.key())) else { break };
        tried.insert(way.key());
        let mut wider = keep_outs.clone();
        let mut places = way.places(problem);
        for _ in 0..MAX_WAYS_OF_TRAVERSE {
            wider.entry(way.occurrence).or_default().append(&mut places);
            let other = plan_again(&Problem { keep_outs: Some(&wider), ..*problem });
            let Some(other) = other else { return planned };
            let is_valid = other.planning.verdict.as_ref().is_some_and(|verdict| verdict.valid);
            let fits = is_valid && planning::has_plan(&other.planning.outcome);
            if fits && is_better(problem.network, &planned, &other) {
                (keep_outs, planned) = (wider, other);
                break;
            }
            in_vain += 1;
            let mut again = other.meetings.iter().flat_map(ways_around);
            let again = fits.then(|| again.find(|again| again.occurrence == way.occurrence)).flatten();
            let Some(again) = again else { break };
            places = again.places(problem);
        }
    }
    planned
}

/// A traverse that could go around where another vehicle is.
struct WayAround {
    occurrence: OccurrenceId,
    /// Who can be there.
    stays: u32,
    /// Where that one can be while the other one is near, in meters.
    places_m: Vec<Point2<f64>>,
}

impl WayAround {
    /// Returns what is tried once.
    const fn key(&self) -> (OccurrenceId, u32) {
        (self.occurrence, self.stays)
    }

    /// The places with the room that the one that stays needs.
    fn places(&self, problem: &Problem<'_>) -> Vec<ObstacleShape> {
        let world = &problem.program.world;
        let radius_m = vehicle::radius_m(world, self.stays) + vehicle::GAP_M + SPARE_M;
        let circle = |place: &Point2<f64>| ObstacleShape::Circle { center_m: (*place).into(), radius_m };
        self.places_m.iter().map(circle).collect()
    }
}

/// Returns who may go around whom.
fn ways_around(meeting: &Meeting) -> Vec<WayAround> {
    let way = |index: usize| {
        let stays = meeting.vehicles[1 - index];
        let places_m = meeting.places_m[1 - index].clone();
        Some(WayAround { occurrence: meeting.movements[index]?, stays, places_m })
    };
    [0, 1].into_iter().filter_map(way).collect()
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
            at_least: Rational::ONE,
            per_meter: Rational::ZERO,
            arc,
            start,
            end,
            owner: Some(owner),
            level: None,
            span,
        });
    }
    network
}
