//! Planning with paths: plan, find paths for the traverses that the plan selected, insert them, and plan again.
//!
//! Inserted paths only add constraints. So when every traverse of a plan has its paths, that plan is the first plan of
//! the network with all paths, though none were computed for alternatives that the search never selects (SPEC 7.3).

use std::collections::BTreeMap;
use std::sync::Arc;

use executive::Facts;
use kirk::{Constraint, Options, Outcome, Stats, Status};
use num_traits::ToPrimitive as _;
use rmpl::program::Program;
use rmpl::{Bound, Diagnostic, Rational};
use terrain::Terrain;
use tpn::path::{PathLeg, TraversePath};
use tpn::{ArcId, ArcKind, Network, OccurrenceId, Plan};

use crate::driving::{self, Drive};
use crate::ground::Grounds;
use crate::snapshot::{Encounter, Leg, MapKey, Planning, Traverse, Undrivable, VehicleMotion};
use crate::traverse::{self, Paths, Route, Waypoint};

/// What to plan and how.
#[derive(Clone, Copy)]
pub struct Problem<'input> {
    /// The network of the program, without paths.
    pub network: &'input Arc<Network>,
    /// The program, for its world.
    pub program: &'input Program,
    /// The ground, if the mission has one.
    pub ground: Option<(&'input MapKey, &'input Arc<Terrain>)>,
    /// How to search.
    pub options: Options,
    /// Seeds path planning.
    pub seed: u64,
    /// What has already happened, when planning again during execution.
    pub facts: Option<&'input Facts>,
}

/// A mission, planned.
#[derive(Clone, Debug)]
pub struct Planned {
    /// The network with the paths of the plan's traverses.
    pub network: Arc<Network>,
    /// What planning found.
    pub planning: Arc<Planning>,
    /// The plan's traverses.
    pub traverses: Vec<Traverse>,
    /// Where vehicles are over time.
    pub motions: Vec<VehicleMotion>,
    /// Vehicles too near each other.
    pub encounters: Vec<Encounter>,
    /// What the author should know.
    pub warnings: Vec<Diagnostic>,
}

/// Rounds of planning and path finding; each adds the paths of at least one traverse or of a new start for one.
const MOST_ROUNDS: usize = 64;

/// A traverse as it stands in the network: its way, and its legs, or why it can't be driven.
struct Inserted {
    waypoints: Vec<Waypoint>,
    legs: Result<Vec<Leg>, Undrivable>,
    route: Route,
}

/// Plans `problem`. When `stop` says so before there is an answer, the outcome's status is [`Status::Limit`].
pub fn plan(
    problem: &Problem<'_>,
    grounds: &mut Grounds,
    paths: &mut Paths,
    stop: &mut dyn FnMut() -> bool,
) -> Planned {
    let mut inserted: BTreeMap<OccurrenceId, Inserted> = BTreeMap::new();
    let mut network = match problem.facts {
        Some(_) => Arc::new(with_paths(problem, &inserted)),
        None => Arc::clone(problem.network),
    };
    let mut outcome;
    let mut rounds = 0;
    loop {
        outcome = kirk::plan(&network, &problem.options, &mut |_: &Stats| stop());
        rounds += 1;
        let (Some(ground), Some(found)) = (problem.ground, outcome.plans.first()) else { break };
        if rounds > MOST_ROUNDS
            || !find_paths(problem, ground, &network, found, grounds, paths, &mut inserted)
        {
            break;
        }
        network = Arc::new(with_paths(problem, &inserted));
    }
    conclude(problem, grounds, network, outcome, inserted)
}

/// A network that was planned as it is, such as one that came without a program.
pub fn without_paths(network: &Arc<Network>, outcome: Outcome) -> Planned {
    let verdict = outcome.plans.first().map(|plan| verify::check_plan(network, plan));
    let planning = Arc::new(Planning { outcome, verdict, undrivable: Vec::new() });
    Planned {
        network: Arc::clone(network),
        planning,
        traverses: Vec::new(),
        motions: Vec::new(),
        encounters: Vec::new(),
        warnings: Vec::new(),
    }
}

/// Finds the paths that the plan needs and that are not in the network yet; whether there were any.
fn find_paths(
    problem: &Problem<'_>,
    (key, map): (&MapKey, &Arc<Terrain>),
    network: &Network,
    plan: &Plan,
    grounds: &mut Grounds,
    paths: &mut Paths,
    inserted: &mut BTreeMap<OccurrenceId, Inserted>,
) -> bool {
    let mut is_new = false;
    for route in traverse::routes(network, problem.program, plan) {
        if inserted.get(&route.occurrence).is_some_and(|known| known.waypoints == route.waypoints) {
            continue;
        }
        let space = grounds.space(key, map, &problem.program.world, route.model);
        let legs = paths.legs(&route, &space, problem.seed).map_err(|(leg, reason)| Undrivable {
            occurrence: route.occurrence,
            leg,
            reason,
        });
        is_new = true;
        let waypoints = route.waypoints.clone();
        inserted.insert(route.occurrence, Inserted { waypoints, legs, route });
    }
    is_new
}

/// The program's network with the paths inserted, or blocked where a traverse can't be driven.
fn with_paths(problem: &Problem<'_>, inserted: &BTreeMap<OccurrenceId, Inserted>) -> Network {
    let map = problem.ground.map(|(_, map)| map);
    let paths: Vec<TraversePath> = inserted
        .values()
        .filter_map(|traverse| traverse_path(&traverse.route, traverse.legs.as_ref().ok()?, map?))
        .collect();
    let unit_seconds = problem.program.options.time_unit.seconds();
    // A path that has no exact duration is no reason to give up the plan: the traverse keeps its own bounds.
    let mut network = tpn::path::insert_paths(problem.network, &paths, unit_seconds)
        .unwrap_or_else(|_| problem.network.as_ref().clone());
    for (&occurrence, traverse) in inserted {
        if traverse.legs.is_err() {
            block(&mut network, occurrence);
        }
    }
    match problem.facts {
        Some(facts) => facts.apply(&network, problem.network.nodes.len()),
        None => network,
    }
}

fn traverse_path(route: &Route, legs: &[Leg], map: &Terrain) -> Option<TraversePath> {
    let lengths = |leg: &Leg| PathLeg {
        segment_lengths_m: leg
            .points_m
            .windows(2)
            .map(|pair| map.draped_length_m(pair[0], pair[1]))
            .collect(),
    };
    let path = TraversePath {
        occurrence: route.occurrence,
        legs: legs.iter().map(lengths).filter(|leg| !leg.segment_lengths_m.is_empty()).collect(),
        speed_mps: route.speed_mps,
        may_stop: route.speed_mps.0 == Rational::default(),
    };
    (!path.legs.is_empty()).then_some(path)
}

/// Makes a traverse that can't be driven impossible: it would have to take no time and also one unit.
fn block(network: &mut Network, occurrence: OccurrenceId) {
    let (start, end, span) = {
        let traverse = &network.occurrences[occurrence.index()];
        (traverse.start, traverse.end, traverse.span)
    };
    for units in [0, 1] {
        let duration = Rational::from(units);
        let id = ArcId::from_index(network.arcs.len());
        network.arcs.push(tpn::Arc {
            from: start,
            to: end,
            lower: duration,
            upper: Bound::Finite(duration),
            kind: ArcKind::Path,
            labels: Vec::new(),
            occurrence: Some(occurrence),
            choice: None,
            span,
        });
        network.nodes[start.index()].out_arcs.push(id);
        network.nodes[end.index()].in_arcs.push(id);
    }
}

/// Tells of a blocked traverse what blocks it, instead of the contradiction that stands for it.
pub(crate) fn name_blocked(outcome: &mut Outcome, network: &Network, undrivable: &[Undrivable]) {
    let Some(failure) = &mut outcome.failure else { return };
    for reason in &mut failure.reasons {
        let blocked = reason.cycle.iter().find_map(|member| {
            let (Constraint::Lower(arc) | Constraint::Upper(arc)) = member.constraint else { return None };
            let arc = network.arcs.get(arc.index()).filter(|arc| arc.kind == ArcKind::Path)?;
            undrivable.iter().find(|traverse| Some(traverse.occurrence) == arc.occurrence)
        });
        if let Some(traverse) = blocked {
            let occurrence = &network.occurrences[traverse.occurrence.index()];
            reason.message = format!("{} can't be driven {}", occurrence.name, traverse.reason);
            reason.spans = occurrence.span.into_iter().collect();
        }
    }
    failure.relaxations.retain(|relaxation| {
        network.arcs.get(relaxation.arc.index()).is_some_and(|arc| arc.kind != ArcKind::Path)
    });
}

fn conclude(
    problem: &Problem<'_>,
    grounds: &mut Grounds,
    network: Arc<Network>,
    mut outcome: Outcome,
    inserted: BTreeMap<OccurrenceId, Inserted>,
) -> Planned {
    let verdict = outcome.plans.first().map(|plan| verify::check_plan(&network, plan));
    let warnings = traverse::check(problem.network, problem.program);
    let mut traverses = Vec::new();
    let mut drives = Vec::new();
    let mut radii_m: BTreeMap<u32, f64> = BTreeMap::new();
    if let (Some((key, map)), Some(plan)) = (problem.ground, outcome.plans.first()) {
        for route in traverse::routes(&network, problem.program, plan) {
            let Some(Inserted { legs: Ok(legs), .. }) = inserted.get(&route.occurrence) else { continue };
            let points: Vec<[f64; 2]> = joined(legs);
            let space = grounds.space(key, map, &problem.program.world, route.model);
            traverses.push(Traverse {
                occurrence: route.occurrence,
                vehicles: route.vehicles.iter().map(|&vehicle| vehicle as u32).collect(),
                length_m: traverse::length_m(&points),
                clearance_m: traverse::clearance_m(&space, &points),
                slope_max_rad: traverse::steepest_slope_rad(map, &points),
                legs: legs.clone(),
            });
            drives.extend(drive(problem.program, &network, plan, &route, points, &mut radii_m));
        }
    }
    let motions = driving::motions(&drives);
    let encounters = encounters(&drives, &motions, &radii_m);
    let undrivable: Vec<Undrivable> =
        inserted.into_values().filter_map(|traverse| traverse.legs.err()).collect();
    name_blocked(&mut outcome, &network, &undrivable);
    let planning = Arc::new(Planning { outcome, verdict, undrivable });
    Planned { network, planning, traverses, motions, encounters, warnings }
}

/// Where the vehicles are over time when `plan` is driven along known `traverses`.
pub fn motions_of(
    program: &Program,
    network: &Network,
    plan: &Plan,
    traverses: &[Traverse],
) -> Vec<VehicleMotion> {
    let routes = traverse::routes(network, program, plan);
    let drives: Vec<Drive> = routes
        .iter()
        .filter_map(|route| {
            let traverse = traverses.iter().find(|traverse| traverse.occurrence == route.occurrence)?;
            drive(program, network, plan, route, joined(&traverse.legs), &mut BTreeMap::new())
        })
        .collect();
    driving::motions(&drives)
}

fn joined(legs: &[Leg]) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    for leg in legs {
        let repeated = usize::from(!points.is_empty());
        points.extend(leg.points_m.iter().skip(repeated));
    }
    points
}

/// Room between vehicles that follow each other, beyond their radii, in metres.
const FORMATION_GAP_M: f64 = 1.0;

fn drive(
    program: &Program,
    network: &Network,
    plan: &Plan,
    route: &Route,
    path_m: Vec<[f64; 2]>,
    radii_m: &mut BTreeMap<u32, f64>,
) -> Option<Drive> {
    let occurrence = &network.occurrences[route.occurrence.index()];
    let start = plan.windows[occurrence.start.index()]?.earliest;
    let end = plan.windows[occurrence.end.index()]?.earliest;
    let mut behind_m = Vec::new();
    let mut behind = 0.0;
    let mut ahead_radius_m = None;
    for &vehicle in &route.vehicles {
        let model = motion::vehicle_model(&program.world.vehicles[vehicle].model.text);
        let radius_m = model.map_or(0.5, |model| model.circumradius_m);
        radii_m.insert(vehicle as u32, radius_m);
        if let Some(ahead) = ahead_radius_m {
            behind += ahead + radius_m + FORMATION_GAP_M;
        }
        ahead_radius_m = Some(radius_m);
        behind_m.push(behind);
    }
    let vehicles = route.vehicles.iter().map(|&vehicle| vehicle as u32).collect();
    Some(Drive { vehicles, behind_m, path_m, start, end })
}

/// Vehicles of different traverses that come nearer than the sum of their radii and the formation gap.
fn encounters(drives: &[Drive], motions: &[VehicleMotion], radii_m: &BTreeMap<u32, f64>) -> Vec<Encounter> {
    let together = |a: u32, b: u32| {
        drives.iter().any(|drive| drive.vehicles.contains(&a) && drive.vehicles.contains(&b))
    };
    let timed: Vec<Vec<(f64, [f64; 2])>> = motions
        .iter()
        .map(|motion| motion.keyframes.iter().map(|frame| (units(frame.time), frame.position_m)).collect())
        .collect();
    let mut found = Vec::new();
    for (index, first) in motions.iter().enumerate() {
        for (offset, second) in motions[index + 1..].iter().enumerate() {
            if together(first.vehicle, second.vehicle) {
                continue;
            }
            let radius = |motion: &VehicleMotion| radii_m.get(&motion.vehicle).copied().unwrap_or(0.5);
            let safe_m = radius(first) + radius(second) + FORMATION_GAP_M;
            if let Some((time, position_m, distance_m)) = nearest(&timed[index], &timed[index + 1 + offset])
                && distance_m < safe_m
            {
                found.push(Encounter {
                    vehicles: [first.vehicle, second.vehicle],
                    time,
                    position_m,
                    distance_m,
                });
            }
        }
    }
    found
}

fn units(time: Rational) -> f64 {
    time.to_f64().unwrap_or(0.0)
}

/// When and where two moving points are nearest: exact on each stretch on which both move evenly.
fn nearest(a: &[(f64, [f64; 2])], b: &[(f64, [f64; 2])]) -> Option<(f64, [f64; 2], f64)> {
    let mut times: Vec<f64> = a.iter().chain(b).map(|&(time, _)| time).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let last = *times.last()?;
    times.push(last + 1.0);
    let mut best: Option<(f64, [f64; 2], f64)> = None;
    for pair in times.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let apart = |time: f64| {
            let (here, there) = (position(a, time), position(b, time));
            [there[0] - here[0], there[1] - here[1]]
        };
        let (begin, end) = (apart(from), apart(to));
        let change = [end[0] - begin[0], end[1] - begin[1]];
        let speed_squared = change[0] * change[0] + change[1] * change[1];
        let along = if speed_squared > 0.0 {
            (-(begin[0] * change[0] + begin[1] * change[1]) / speed_squared).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let time = from + along * (to - from);
        let at = [begin[0] + along * change[0], begin[1] + along * change[1]];
        let distance_m = (at[0] * at[0] + at[1] * at[1]).sqrt();
        if best.is_none_or(|(_, _, least)| distance_m < least) {
            let here = position(a, time);
            best = Some((time, [here[0] + at[0] / 2.0, here[1] + at[1] / 2.0], distance_m));
        }
    }
    best
}

fn position(track: &[(f64, [f64; 2])], time: f64) -> [f64; 2] {
    let after = track.partition_point(|&(at, _)| at <= time);
    let Some(&(from, here)) = track.get(after.saturating_sub(1)) else { return [0.0, 0.0] };
    match track.get(after).filter(|_| after > 0) {
        Some(&(to, there)) if to > from => {
            let part = (time - from) / (to - from);
            [here[0] + part * (there[0] - here[0]), here[1] + part * (there[1] - here[1])]
        }
        _ => here,
    }
}

/// The latest time anything of the plan can happen, as far as it is bounded, for time axes.
pub fn horizon(plan: &Plan) -> Rational {
    plan.windows
        .iter()
        .flatten()
        .map(|window| match window.latest {
            Bound::Finite(latest) => latest,
            Bound::Infinite => window.earliest,
        })
        .max()
        .unwrap_or_default()
}

/// Whether an outcome has a plan.
pub fn has_plan(outcome: &Outcome) -> bool {
    outcome.status == Status::Plan && !outcome.plans.is_empty()
}
