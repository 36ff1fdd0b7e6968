//! Which activities of a plan are traverses, from where to where they drive, and the paths that they take.

use snapshot::vehicle;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use exact::Rational;
use executive::facts::StandingPlace;
use motion::{DriveLimits, PlannerKind, Query, SearchResult, ShortcutSettings, VehicleModel};
use nalgebra::Point2;
use rmpl::Span;
use rmpl::program::{ObstacleShape, Per, Program, World};
use smol_str::SmolStr;
use snapshot::Leg;
use snapshot::ground::closed_to;
use snapshot::vehicle::Moving;
use terrain::ConfigurationSpace;
use tpn::{Network, OccurrenceId, OccurrenceKind, Plan};

use crate::ground::FreeSpace;
use crate::spots::{ON_THE_WAY, Positions, Spots};
use crate::world_index::WorldIndex;

/// A traverse of a plan: who drives, and through which places.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    pub occurrence: OccurrenceId,
    /// Indices of the vehicles into the program's world; the first leads.
    pub vehicles: Vec<usize>,
    /// The model whose ground the path must be: of the vehicles that drive, or of all if none drives, the widest.
    pub model: VehicleModel,
    /// Least and greatest speed in meters per second. At a least speed of 0 the vehicle may stop on its way.
    pub speed_mps: (Rational, Rational),
    /// What its vehicles may not enter.
    pub obstacles: Vec<ObstacleShape>,
    /// What the vehicles can do, all of them together, where that bounds how long the way takes.
    pub limits: Option<DriveLimits>,
    /// The location where the leader is before, if it is at one.
    pub from: Option<SmolStr>,
    /// The places, in order: where the leader is before, then those that the call names.
    pub waypoints: Vec<Waypoint>,
    /// How many others the leader drives with, or drove with when it came to where it starts: they move aside for each other,
    /// so that it may start a little beside its path.
    pub company: usize,
    /// Whether the leader followed another vehicle to where it starts.
    pub has_followed: bool,
}

/// A place that a route passes.
#[derive(Clone, Debug, PartialEq)]
pub struct Waypoint {
    /// The location's name.
    pub name: SmolStr,
    /// In meters.
    pub position_m: Point2<f64>,
    /// Which place of the location that is, where several vehicles stand there: 0 for the location itself.
    pub slot: usize,
    /// Whether it is the place of a follower in a formation whose leader has that place of the location.
    pub is_behind: bool,
}

/// Where the vehicles of a route are at its end, the leader's place first; nothing where its path is not known.
pub(crate) type FormationEnds<'ends> = &'ends dyn Fn(&Route) -> Vec<Point2<f64>>;

/// The routes of the traverses that `plan` selects, in order of their earliest departure. Each vehicle starts where its
/// previous movement left it, or from its own start (SPEC 1.8); one of `places`, from where it has stopped. Vehicles that
/// followed another one start from its place.
pub fn routes(network: &Network, program: &Program, plan: &Plan, places: &[StandingPlace]) -> Vec<Route> {
    routes_between(network, program, plan, places, &|_| Vec::new())
}

/// The same, where vehicles that followed another one start from where their formation `ends`.
pub(crate) fn routes_between(
    network: &Network,
    program: &Program,
    plan: &Plan,
    places: &[StandingPlace],
    ends: FormationEnds<'_>,
) -> Vec<Route> {
    let world = &program.world;
    let spots = Spots::new(network, program);
    let index = WorldIndex::new(program);
    let mut positions = Positions::new(spots.starts.clone());
    let mut moving: Vec<(OccurrenceId, Moving<'_>)> = network
        .occurrences
        .iter()
        .enumerate()
        .filter(|(_, it)| it.kind == OccurrenceKind::Primitive && plan.selected_nodes[it.start.index()])
        .filter_map(|(position, it)| Some((OccurrenceId::from_index(position), index.moving(it)?)))
        .collect();
    let departure = |id: OccurrenceId| {
        let start = network.occurrences[id.index()].start;
        plan.windows[start.index()].map(|window| window.earliest)
    };
    moving.sort_by_key(|(id, _)| (departure(*id), *id));
    let moving = in_plan_order(network, plan, moving);
    let mut routes = Vec::new();
    // Who drove with each vehicle last: how many, and whether it followed.
    let mut company = vec![(0, false); world.vehicles.len()];
    let mut stopped: Vec<&StandingPlace> = places.iter().collect();
    for (id, moving) in moving {
        let start = network.occurrences[id.index()].start;
        let starts = plan.windows[start.index()].map(|window| window.earliest);
        stopped.retain(|it| {
            let place = positions.of(it.vehicle as usize);
            let Some(place) = place.filter(|_| starts >= Some(it.since)) else { return true };
            let position_m = it.place_m.into();
            let place = Waypoint { position_m, slot: ON_THE_WAY, is_behind: false, ..place.clone() };
            positions.set(it.vehicle as usize, place);
            false
        });
        let place_of = |vehicle: usize| positions.of(vehicle).cloned();
        let Some(mut route) = route(network, (world, &index), id, &moving, &place_of) else { continue };
        let followers = route.vehicles.len() - 1;
        (route.company, route.has_followed) = company[route.vehicles[0]];
        route.company = route.company.max(followers);
        if let Some(last) = route.waypoints.last_mut() {
            *last = spots.free(last, &route.vehicles, &positions);
            let last = last.clone();
            let ends_m = if followers > 0 { ends(&route) } else { Vec::new() };
            for (index, &vehicle) in route.vehicles.iter().enumerate() {
                let behind_m = ends_m.get(index).filter(|_| index > 0);
                let behind =
                    behind_m.map(|&position_m| Waypoint { position_m, is_behind: true, ..last.clone() });
                positions.set(vehicle, behind.unwrap_or_else(|| last.clone()));
                company[vehicle] = (followers, index > 0);
            }
        }
        routes.push(route);
    }
    routes
}

/// Movements in the order of departures: of those that depart at one time, because some take no time, each comes after the ones
/// before it in the order that the plan gives the values of a state.
fn in_plan_order<'program>(
    network: &Network,
    plan: &Plan,
    moving: Vec<(OccurrenceId, Moving<'program>)>,
) -> Vec<(OccurrenceId, Moving<'program>)> {
    let order: Vec<OccurrenceId> = moving.iter().map(|&(id, _)| id).collect();
    let mut open: BTreeMap<OccurrenceId, Moving<'program>> = moving.into_iter().collect();
    let mut before: BTreeMap<OccurrenceId, Vec<OccurrenceId>> = BTreeMap::new();
    let owner = |label: tpn::LabelId| network.labels[label.index()].owner.filter(|id| open.contains_key(id));
    for state in &plan.state_order {
        let owners: Vec<OccurrenceId> = state.producers.iter().filter_map(|&label| owner(label)).collect();
        for pair in owners.windows(2) {
            before.entry(pair[1]).or_default().push(pair[0]);
        }
    }
    let mut ordered = Vec::with_capacity(order.len());
    for id in order {
        let mut next = vec![id];
        while let Some(&id) = next.last() {
            if let Some(earlier) = before.remove(&id) {
                next.extend(earlier);
            } else {
                next.pop();
                ordered.extend(open.remove_entry(&id));
            }
        }
    }
    ordered
}

fn route(
    network: &Network,
    (world, index): (&World, &WorldIndex<'_>),
    id: OccurrenceId,
    moving: &Moving<'_>,
    place_of: &dyn Fn(usize) -> Option<Waypoint>,
) -> Option<Route> {
    let vehicles: Vec<usize> = moving.vehicles.iter().filter_map(|name| index.vehicle(name)).collect();
    let &leader = vehicles.first()?;
    let models = || vehicles.iter().filter_map(|&vehicle| vehicle::model_of(world, vehicle));
    let drives = |model: &VehicleModel| matches!(model.drive, motion::Drive::SkidSteer { .. });
    let widest = |a: &VehicleModel, b: &VehicleModel| {
        (drives(a), a.radius_m()).partial_cmp(&(drives(b), b.radius_m())).unwrap_or(Ordering::Equal)
    };
    let model = models().max_by(widest)?;
    let own_mps = models().map(|model| model.speed_mps).fold(f64::INFINITY, f64::min);
    let before = place_of(leader);
    let from = before.as_ref().map(|before| before.name.clone());
    let mut waypoints: Vec<Waypoint> = before.into_iter().collect();
    let arguments = &network.occurrences[id.index()].arguments;
    let named: Vec<Waypoint> = arguments.iter().filter_map(|name| index.waypoint(name)).collect();
    if named.is_empty() {
        return None;
    }
    waypoints.extend(named);
    // Of two locations with one position, the vehicle is at the one that the call names.
    waypoints.dedup_by(|next, before| {
        let is_same = next.position_m == before.position_m;
        if is_same {
            std::mem::swap(next, before);
        }
        is_same
    });
    let min_mps = models().map(|model| model.min_speed_mps).fold(0.0, f64::max);
    let own_speed_mps =
        (Rational::from_f64_nearest(min_mps.min(own_mps), 1000)?, Rational::from_f64_nearest(own_mps, 1000)?);
    let speed_mps = moving.moves.speed_mps.unwrap_or(own_speed_mps);
    let limits = models()
        .map(|model| DriveLimits::of(&model))
        .reduce(DriveLimits::of_both)
        .filter(|_| moving.moves.is_kinodynamic);
    let activity = &network.occurrences[id.index()].activity;
    let obstacles = closed_to(world, &vehicles, activity).map(|it| it.shape.clone()).collect();
    let (company, has_followed) = (vehicles.len() - 1, false);
    Some(Route {
        occurrence: id,
        vehicles,
        model,
        speed_mps,
        obstacles,
        limits,
        from,
        waypoints,
        company,
        has_followed,
    })
}

/// The route of a traverse whose leader is at a place before, or just the places that its call names; `None` if it is no
/// traverse, or names none.
pub(crate) fn route_from(
    network: &Network,
    (world, index): (&World, &WorldIndex<'_>),
    occurrence: OccurrenceId,
    place: Option<&Waypoint>,
) -> Option<Route> {
    let moving = index.moving(&network.occurrences[occurrence.index()])?;
    route(network, (world, index), occurrence, &moving, &|_| place.cloned())
}

/// Returns what is wrong with the `moves` clauses and calls of a program: a traverse without places or vehicles is an
/// ordinary activity, and its author should know.
pub fn check(network: &Network, program: &Program) -> Vec<rmpl::Diagnostic> {
    let world = &program.world;
    let index = WorldIndex::new(program);
    let mut found: Vec<rmpl::Diagnostic> = Vec::new();
    let mut warned: BTreeSet<Span> = BTreeSet::new();
    let mut warn = |span: Span, message: String| {
        if warned.insert(span) {
            found.push(rmpl::Diagnostic::warning(rmpl::Code("W-TRAVERSE"), span, message));
        }
    };
    for occurrence in &network.occurrences {
        let Some(moving) = index.moving(occurrence) else { continue };
        let Some(span) = occurrence.span else { continue };
        if !occurrence.arguments.iter().any(|name| index.waypoint(name).is_some()) {
            let name = &occurrence.activity;
            warn(span, format!("`{name}` moves vehicles, but no argument of this call is a location"));
        }
        for (vehicle, written) in moving.vehicles.iter().zip(&moving.moves.vehicles) {
            if index.vehicle(vehicle).is_none() {
                let place = if *vehicle == written.text { written.span } else { span };
                warn(place, format!("unknown vehicle `{vehicle}`"));
            }
        }
    }
    if world.locations.is_empty() {
        for primitive in &program.primitives {
            let amounts =
                primitive.uses.iter().filter_map(|used| used.amount.as_ref()).chain(&primitive.costs);
            for amount in amounts.filter(|amount| amount.per == Some(Per::Meter)) {
                let message =
                    "amounts per metre count as 0, because the mission has no locations and so no paths";
                found.push(rmpl::Diagnostic::warning(rmpl::Code("W-TRAVERSE"), amount.span, message));
            }
        }
    }
    for vehicle in &world.vehicles {
        if vehicle::model(world, &vehicle.model.text).is_none() {
            let known: Vec<&str> = motion::VEHICLE_MODELS.iter().map(|model| model.name).collect();
            let message = format!("unknown vehicle model `{}`", vehicle.model.text);
            let hint = format!("the models are {}", known.join(", "));
            found.push(
                rmpl::Diagnostic::warning(rmpl::Code("W-TRAVERSE"), vehicle.model.span, message)
                    .with_hint(hint),
            );
        }
        if index.waypoint(&vehicle.start.text).is_none() {
            let message = format!("unknown location `{}`", vehicle.start.text);
            found.push(rmpl::Diagnostic::error(rmpl::Code("E-UNDEF"), vehicle.start.span, message));
        }
    }
    found
}

/// Paths that were found, or not, kept by everything they depend on.
#[derive(Default)]
pub struct Paths {
    known: Vec<(LegKey, Result<Leg, String>)>,
    searches: u64,
}

/// What kind of path is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preference {
    /// One that keeps away from obstacles where that costs little.
    Roomy,
    /// The shortest that many seeds find: for a traverse that has no time for more.
    Shortest,
}

/// A leg's inputs. The free space represents map, obstacles and vehicle: it is shared while they stay the same.
struct LegKey {
    space: Arc<ConfigurationSpace>,
    from_m: Point2<f64>,
    to_m: Point2<f64>,
    seed: u64,
    preference: Preference,
}

/// Legs kept; a mission in work has far fewer, and each holds its search tree.
const MAX_LEGS: usize = 128;

impl Paths {
    /// Returns how many legs were really searched for, not taken from those kept.
    pub const fn searches(&self) -> u64 {
        self.searches
    }

    /// The legs of a route. A leg that can't be driven gives its number, from 1, and the reason.
    pub fn legs(
        &mut self,
        route: &Route,
        space: &FreeSpace,
        seed: u64,
        preference: Preference,
    ) -> Result<Vec<Leg>, (u32, String)> {
        let pairs = route.waypoints.windows(2);
        pairs
            .enumerate()
            .map(|(index, pair)| {
                self.leg(space, &pair[0], &pair[1], seed, preference)
                    .map_err(|reason| (index as u32 + 1, reason))
            })
            .collect()
    }

    fn leg(
        &mut self,
        space: &FreeSpace,
        from: &Waypoint,
        to: &Waypoint,
        seed: u64,
        preference: Preference,
    ) -> Result<Leg, String> {
        let matches = |key: &LegKey| {
            Arc::ptr_eq(&key.space, &space.exact)
                && key.from_m == from.position_m
                && key.to_m == to.position_m
                && (key.seed, key.preference) == (seed, preference)
        };
        if let Some(at) = self.known.iter().position(|(key, _)| matches(key)) {
            let kept = self.known.remove(at);
            let leg = kept.1.clone();
            self.known.push(kept);
            return leg.map(|leg| Leg { to: to.name.clone(), ..leg });
        }
        self.searches += 1;
        let leg = find_leg(space, from, to, seed, preference);
        if self.known.len() >= MAX_LEGS {
            drop(self.known.remove(0));
        }
        let key = LegKey {
            space: Arc::clone(&space.exact),
            from_m: from.position_m,
            to_m: to.position_m,
            seed,
            preference,
        };
        self.known.push((key, leg.clone()));
        leg
    }
}

/// Meters that a path may be longer for each corner that it does without: corners become events of the plan.
const CORNER_EXTRA_M: f64 = 0.3;
/// How much longer a path may be for keeping away from obstacles: this share and so many meters.
const ROOMY_SHARE: f64 = 1.06;
const ROOMY_EXTRA_M: f64 = 2.0;
/// Searches for each leg: obstacles leave several ways around, and one search may miss the shortest.
const TRIES: u32 = 2;
const TRIES_FOR_SHORTEST: u32 = 12;
/// How closely the ground is looked at for the shortest path ([`ShortcutSettings::blocks`]).
const BLOCKS_FOR_SHORTEST: u32 = 10_000;
/// Edges of a search tree that reach across a map at most.
const STEPS_ACROSS: f64 = 60.0;
/// Samples of a search that can be shown one by one.
const MAX_TRACED_STEPS: usize = 4000;

/// Searches for one leg; says why there is none, for the author.
fn find_leg(
    free: &FreeSpace,
    from: &Waypoint,
    to: &Waypoint,
    seed: u64,
    preference: Preference,
) -> Result<Leg, String> {
    let query = Query { start_m: from.position_m, goal_m: to.position_m };
    let shortcut = ShortcutSettings { seed, ..ShortcutSettings::default() };
    let (tries, shortcut, roomy) = match preference {
        Preference::Roomy => (TRIES, shortcut, free.roomy.as_slice()),
        Preference::Shortest => {
            let closely = ShortcutSettings { blocks: BLOCKS_FOR_SHORTEST, ..shortcut };
            (TRIES_FOR_SHORTEST, closely, &[][..])
        }
    };
    let defaults = motion::Settings::of(PlannerKind::RrtConnect);
    let frame = free.exact.frame();
    let longer_side_m = f64::from(frame.width.max(frame.height)) * frame.cell_size_m;
    // On a large map, short edges would not get anywhere.
    let step_m = defaults.step_m.max(longer_side_m / STEPS_ACROSS);
    let settings = motion::Settings { seed, step_m, ..defaults };
    let search = |space: &ConfigurationSpace| {
        motion::find_shortest_path(space, query, &settings, &shortcut, tries, &mut |_| false)
    };
    let mut found = search(&free.exact);
    let mut space: &ConfigurationSpace = &free.exact;
    let path = found.path.as_ref();
    let length_m =
        path.map_err(|failure| format!("from {} to {}: {failure}", from.name, to.name))?.length_m();
    let longest_m = length_m * ROOMY_SHARE + ROOMY_EXTRA_M;
    for wider in roomy {
        let other = search(wider);
        if other.path.as_ref().is_ok_and(|path| path.length_m() <= longest_m) {
            (found, space) = (other, wider);
            break;
        }
    }
    let SearchResult { path: Ok(path), trees, statistics, seed, .. } = found else {
        return Err(format!("from {} to {}: no path", from.name, to.name));
    };
    let tree_m = trees.iter().flat_map(|tree| {
        tree.vertices.iter().filter_map(|vertex| {
            let parent = tree.vertices.get(vertex.parent? as usize)?;
            Some([parent.point_m, vertex.point_m])
        })
    });
    let settings = motion::Settings { seed, ..settings };
    let growth = motion::trace(space, query, settings, MAX_TRACED_STEPS).unwrap_or_default();
    Ok(Leg {
        to: to.name.clone(),
        tree_m: Arc::new(tree_m.collect()),
        growth: Arc::new(growth),
        points_m: motion::simplify(space, &path, CORNER_EXTRA_M).points_m,
        samples: statistics.samples,
    })
}

/// The least distance from the vehicle's rim to an obstacle along a path, in meters.
pub fn clearance_m(space: &ConfigurationSpace, points_m: &[Point2<f64>]) -> f64 {
    points_m
        .windows(2)
        .filter_map(|pair| space.segment_clearance_m(pair[0], pair[1]))
        .fold(f64::INFINITY, f64::min)
}
