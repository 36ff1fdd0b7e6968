//! Movements whose order planning finds (SPEC 10.3): how long each takes at least from wherever its vehicle may be, and how
//! many meters it drives.
//!
//! Where several vehicles come to one location, each has a place of its own there, which depends on their order. So one leg
//! may have several ways. A bound holds for all of them: before a path is known, that of the straight line at the greatest
//! speed. The search for an order assumes more: that a leg takes what the paths that are known say.

use std::collections::{BTreeMap, BTreeSet};

use exact::{Rational, Time};
use nalgebra::{Point2, distance};
use rmpl::program::LabelMode;
use smol_str::{SmolStr, format_smolstr};
use snapshot::vehicle;
use tpn::worth::rounded_up;
use tpn::{Departure, Distance, Extent, LabelId, Network, OccurrenceId, ValueId, ValueSet, VariableId};

use crate::ground::{EndGround, Grounds, StandingGround};
use crate::planning::{self, Problem};
use crate::spots::PossibleSpots;
use crate::traverse::{self, Route, Waypoint};
use crate::world_index::WorldIndex;

/// How long the movements of a mission take, by where they start.
pub(crate) struct Departures<'mission> {
    problem: Problem<'mission>,
    index: WorldIndex<'mission>,
    spots: PossibleSpots<'mission>,
    movements: Vec<Movement>,
    /// What paths have told, of each way of a leg.
    known: BTreeMap<(OccurrenceId, SmolStr), Vec<Known>>,
}

/// What a path has told.
struct Known {
    waypoints: Vec<Waypoint>,
    /// `None` if it cannot be driven.
    least: Option<Time>,
    meters: Option<Rational>,
}

impl Known {
    fn ends_m(&self) -> Option<[Point2<f64>; 2]> {
        Some([self.waypoints.first()?.position_m, self.waypoints.last()?.position_m])
    }
}

struct Movement {
    occurrence: OccurrenceId,
    arrival: LabelId,
    /// Through the places that the call names; it starts wherever its leader is.
    route: Route,
    /// Where there is room at its ends, if its vehicles may stand beside a location.
    ground: Option<EndGround>,
    places: Vec<Place>,
}

/// A location where a movement may start.
struct Place {
    value: ValueId,
    middle: Waypoint,
    /// Whether something brings the vehicle there.
    is_reached: bool,
    /// Whether its vehicles may stand at several places there or where the movement ends.
    is_open: bool,
    /// By straight lines.
    straight: Bounds,
    /// How far its vehicle may be from these places, in meters, because it followed another one there.
    behind_m: f64,
}

/// The least that a leg takes, in time and in meters; no time where it cannot be driven.
#[derive(Clone, Copy, PartialEq)]
struct Bounds {
    least: Option<Time>,
    meters: Option<Rational>,
}

/// A way of a leg, with its ends as they are written, and where there is room for them.
struct Ends<'places> {
    from: &'places Waypoint,
    to: &'places Waypoint,
    free_m: [Point2<f64>; 2],
}

impl<'mission> Departures<'mission> {
    /// Of the traverses of a problem, by straight lines.
    pub(crate) fn new(problem: &Problem<'mission>, grounds: &mut Grounds) -> Self {
        let spots = PossibleSpots::new(problem.network, problem.program, planning::places(problem));
        let index = WorldIndex::new(problem.program);
        let (movements, known) = (Vec::new(), BTreeMap::new());
        let mut departures = Self { problem: *problem, index, spots, movements, known };
        let (arrivals, given) = (arrivals(problem.network), given_values(problem.network));
        // Of those that drive, and of those that fly.
        let mut standing: BTreeMap<bool, StandingGround> = BTreeMap::new();
        for (&occurrence, labels) in &arrivals {
            let movement = departures.movement(occurrence, labels, &given, (grounds, &mut standing));
            departures.movements.extend(movement);
        }
        departures
    }

    /// Returns whether the order of movements decides where some vehicle stands.
    pub(crate) fn are_open(&self) -> bool {
        self.movements.iter().any(|movement| movement.places.iter().any(|it| it.is_open && it.is_reached))
    }

    /// Returns whether a path has told how long a route takes.
    pub(crate) fn knows(&self, route: &Route) -> bool {
        route.from.is_none() || self.known_of(route).is_some()
    }

    fn known_of(&self, route: &Route) -> Option<&Known> {
        let known = self.known.get(&(route.occurrence, route.from.clone()?))?;
        known.iter().find(|known| known.waypoints == route.waypoints)
    }

    /// Learns how long a route takes at least, `None` if it cannot be driven, and its meters.
    pub(crate) fn learn(&mut self, route: &Route, least: Option<Time>, meters: Option<Rational>) {
        if let Some(from) = &route.from {
            // The exact time comes with the path; a rounder one that is a little less keeps the planner's numbers small.
            let least = least.map(|least| round_down(least.to_f64()).unwrap_or_default());
            let known = Known { waypoints: route.waypoints.clone(), least, meters };
            self.known.entry((route.occurrence, from.clone())).or_default().push(known);
        }
    }

    /// At most so many routes of legs of which nothing is known yet, the shortest first.
    pub(crate) fn unknown(&self, most: usize) -> Vec<Route> {
        let open = self.movements.iter().flat_map(|movement| {
            let is_known =
                |place: &Place| self.known.contains_key(&(movement.occurrence, place.middle.name.clone()));
            let places = movement.places.iter().filter(move |place| !is_known(place));
            places.filter_map(move |place| Some((place.straight.meters?, movement, place)))
        });
        let mut open: Vec<(Rational, &Movement, &Place)> = open.collect();
        open.sort_by_key(|&(meters, movement, place)| (meters, movement.occurrence, place.value));
        let routes = open.into_iter().filter_map(|(_, movement, place)| {
            let (from, to) = self.ends(movement, &place.middle);
            self.route(movement, from.first()?, to.first()?)
        });
        routes.filter(|route| !self.knows(route)).take(most).collect()
    }

    /// The way of the leg of a route that bounds it from below, if its path is not known.
    pub(crate) fn shortest_unknown(&self, route: &Route) -> Option<Route> {
        let movement = self.movements.iter().find(|it| it.occurrence == route.occurrence)?;
        let place = movement.places.iter().find(|it| Some(&it.middle.name) == route.from.as_ref())?;
        if !place.is_open {
            return None;
        }
        let known = self.known.get(&(movement.occurrence, place.middle.name.clone()))?;
        let (from, to) = self.ends(movement, &place.middle);
        let open = pairs(movement, &from, &to).filter(|ends| !is_known(known, ends));
        let open = open.filter_map(|ends| Some((self.straight(movement, &ends).least?, ends)));
        let (least, ends) = open.min_by_key(|(least, _)| *least)?;
        let is_lower = known.iter().filter_map(|known| known.least).all(|known| least < known);
        is_lower.then(|| self.route(movement, ends.from, ends.to)).flatten()
    }

    /// Returns what the search for an order assumes: that each leg takes what its quickest known path does.
    pub(crate) fn assumed(&self) -> Vec<Departure> {
        self.listed(|movement, place| self.assumed_of(movement, place).least)
    }

    /// Returns what holds wherever vehicles stand.
    pub(crate) fn bounds(&self) -> Vec<Departure> {
        self.listed(|movement, place| self.bounds_of(movement, place).least)
    }

    /// Returns what is known of these routes, each of which starts where it does and nowhere else; bounds for all
    /// others.
    pub(crate) fn only(&self, routes: &[Route]) -> Vec<Departure> {
        self.listed(|movement, place| {
            let Some(route) = routes.iter().find(|route| route.occurrence == movement.occurrence) else {
                return self.bounds_of(movement, place).least;
            };
            let is_its = route.from.as_ref() == Some(&place.middle.name);
            let known = self.known_of(route).filter(|_| is_its);
            known.map_or_else(
                || is_its.then(|| self.bounds_of(movement, place).least).flatten(),
                |it| it.least,
            )
        })
    }

    /// Returns how many meters each movement is assumed to drive from each place: of several paths of one leg, the
    /// longest.
    pub(crate) fn assumed_distances(&self) -> Vec<Distance> {
        self.distances(|movement, place| self.assumed_of(movement, place).meters)
    }

    /// Returns how many meters each movement drives at least from each place, wherever vehicles stand.
    pub(crate) fn distance_bounds(&self) -> Vec<Distance> {
        self.distances(|movement, place| self.bounds_of(movement, place).meters)
    }

    /// Returns how many meters these routes drive, and bounds for all others.
    pub(crate) fn distances_of(&self, routes: &[Route]) -> Vec<Distance> {
        self.distances(|movement, place| {
            let is_its = |route: &&Route| {
                route.occurrence == movement.occurrence && route.from.as_ref() == Some(&place.middle.name)
            };
            let known = routes.iter().find(is_its).and_then(|route| self.known_of(route));
            known.map_or_else(|| self.bounds_of(movement, place).meters, |known| known.meters)
        })
    }

    /// Returns whether what is assumed holds wherever vehicles stand.
    pub(crate) fn is_bounded_as_assumed(&self) -> bool {
        self.movements.iter().all(|movement| {
            let mut reached = movement.places.iter().filter(|place| place.is_open && place.is_reached);
            reached.all(|place| self.assumed_of(movement, place) == self.bounds_of(movement, place))
        })
    }

    /// Returns how many meters each movement drives at least, wherever it starts.
    pub(crate) fn min_meters(&self) -> BTreeMap<OccurrenceId, Rational> {
        let least = |movement: &Movement| {
            let reached = movement.places.iter().filter(|place| place.is_reached);
            let meters = reached.filter_map(|place| self.bounds_of(movement, place).meters).min()?;
            Some((movement.occurrence, meters))
        };
        self.movements.iter().filter_map(least).collect()
    }

    fn assumed_of(&self, movement: &Movement, place: &Place) -> Bounds {
        match self.known.get(&(movement.occurrence, place.middle.name.clone())) {
            Some(known) => Bounds {
                least: known.iter().filter_map(|known| known.least).min(),
                meters: known.iter().filter_map(|known| known.meters).max(),
            },
            None => place.straight,
        }
    }

    fn bounds_of(&self, movement: &Movement, place: &Place) -> Bounds {
        let Some(known) = self.known.get(&(movement.occurrence, place.middle.name.clone())) else {
            return place.straight;
        };
        let (from, to) = if place.is_open { self.ends(movement, &place.middle) } else { Default::default() };
        let open = pairs(movement, &from, &to).filter(|ends| !is_known(known, ends));
        let open: Vec<Bounds> = open.map(|ends| self.straight(movement, &ends)).collect();
        let known = known.iter().map(|known| Bounds { least: known.least, meters: known.meters });
        self.nearer(movement, min_of(known.chain(open)), place.behind_m)
    }

    /// Bounds of a movement that may start so many meters nearer to its goal.
    fn nearer(&self, movement: &Movement, bounds: Bounds, by_m: f64) -> Bounds {
        if by_m <= 0.0 {
            return bounds;
        }
        let by_units = by_m / movement.route.speed_mps.1.to_f64() / self.unit_seconds();
        let sooner = |least: Time| round_down((least.to_f64() - by_units).max(0.0)).unwrap_or_default();
        let shorter =
            |meters: Rational| parts_rounded_down((meters.to_f64() - by_m).max(0.0)).unwrap_or_default();
        Bounds { least: bounds.least.map(sooner), meters: bounds.meters.map(shorter) }
    }

    fn unit_seconds(&self) -> f64 {
        self.problem.program.options.time_unit.seconds() as f64
    }

    fn listed(&self, least: impl Fn(&Movement, &Place) -> Option<Time>) -> Vec<Departure> {
        let mut departures = Vec::new();
        for movement in &self.movements {
            let arrival = movement.arrival;
            departures.extend(movement.places.iter().map(|place| Departure {
                arrival,
                from: place.value,
                least: least(movement, place),
            }));
        }
        departures
    }

    fn distances(&self, meters: impl Fn(&Movement, &Place) -> Option<Rational>) -> Vec<Distance> {
        let mut distances = Vec::new();
        for movement in &self.movements {
            let arrival = movement.arrival;
            distances.extend(movement.places.iter().filter_map(|place| {
                Some(Distance { arrival, from: place.value, meters: meters(movement, place)? })
            }));
        }
        distances
    }

    /// The movement of an occurrence whose effects are `labels`, from each place that something in the network gives its leader.
    fn movement(
        &self,
        occurrence: OccurrenceId,
        labels: &[LabelId],
        given: &BTreeMap<VariableId, BTreeSet<ValueId>>,
        (grounds, standing): (&mut Grounds, &mut BTreeMap<bool, StandingGround>),
    ) -> Option<Movement> {
        let network = self.problem.network;
        let moving = self.index.moving(&network.occurrences[occurrence.index()])?;
        let name = format_smolstr!("{}.at", moving.vehicles.first()?);
        let variable_of = |label: LabelId| network.labels[label.index()].literal.variable;
        let is_arrival = |&label: &LabelId| network.variables[variable_of(label).index()].name == name;
        let arrival = labels.iter().copied().find(is_arrival)?;
        let variable = &network.variables[variable_of(arrival).index()];
        let route = self.route_from(occurrence, None)?;
        let mut movement = Movement { occurrence, arrival, route, ground: None, places: Vec::new() };
        let to = self.after(&movement);
        for &value in given.get(&variable_of(arrival)).into_iter().flatten() {
            let name = variable.values.get(value.index());
            let Some(middle) = name.and_then(|name| self.index.waypoint(name)) else { continue };
            let from = self.before(&movement, &middle);
            let is_beside = from.iter().chain(&to).any(|place| place.slot > 0);
            if let Some(ground) = self.problem.ground.filter(|_| is_beside && movement.ground.is_none()) {
                let world = &self.problem.program.world;
                let flies = vehicle::flies(world, movement.route.vehicles[0] as u32);
                let standing =
                    standing.entry(flies).or_insert_with(|| grounds.standing(ground, world, flies)).clone();
                let space = planning::space(&self.problem, ground, grounds, &movement.route).exact;
                movement.ground = Some(EndGround { standing, space });
            }
            let straights = pairs(&movement, &from, &to).map(|ends| self.straight(&movement, &ends));
            let (world, leader) = (&self.problem.program.world, movement.route.vehicles[0]);
            let spacing_m = |vehicles: &[usize]| planning::spacing_m(world, vehicles);
            let behind_m = self.spots.behind_m(occurrence, leader, &middle, spacing_m);
            let place = Place {
                value,
                is_reached: !self.spots.before(occurrence, leader, &middle).is_empty(),
                is_open: from.len() > 1 || to.len() > 1 || behind_m > 0.0,
                straight: self.nearer(&movement, min_of(straights), behind_m),
                behind_m,
                middle,
            };
            movement.places.push(place);
        }
        Some(movement)
    }

    /// Returns where a movement may start at a location, and where it may end.
    fn ends(&self, movement: &Movement, at: &Waypoint) -> (Vec<Waypoint>, Vec<Waypoint>) {
        (self.before(movement, at), self.after(movement))
    }

    fn before(&self, movement: &Movement, at: &Waypoint) -> Vec<Waypoint> {
        let mut from = self.spots.before(movement.occurrence, movement.route.vehicles[0], at);
        if from.is_empty() {
            from.push(at.clone());
        }
        from
    }

    fn after(&self, movement: &Movement) -> Vec<Waypoint> {
        let Route { vehicles, waypoints, .. } = &movement.route;
        let to = waypoints.last().map(|last| self.spots.after(movement.occurrence, vehicles, last));
        to.unwrap_or_default()
    }

    fn route_from(&self, occurrence: OccurrenceId, from: Option<&Waypoint>) -> Option<Route> {
        let world = &self.problem.program.world;
        traverse::route_from(self.problem.network, (world, &self.index), occurrence, from)
    }

    /// A movement from one place to another one.
    fn route(&self, movement: &Movement, from: &Waypoint, to: &Waypoint) -> Option<Route> {
        let mut route = self.route_from(movement.occurrence, Some(from))?;
        *route.waypoints.last_mut()? = to.clone();
        Some(route)
    }

    /// Returns what a movement takes along straight lines.
    fn straight(&self, movement: &Movement, ends: &Ends<'_>) -> Bounds {
        let named = &movement.route.waypoints;
        let [from_m, to_m] = ends.free_m;
        let meters = match named.as_slice() {
            // A drive to where the vehicle is takes nothing.
            [] => 0.0,
            [only] if only.position_m == from_m => 0.0,
            [_] => distance(&from_m, &to_m),
            [first, .., _] => {
                let last_m = named[named.len() - 2].position_m;
                let inner = named[..named.len() - 1].windows(2);
                let inner: f64 = inner.map(|pair| distance(&pair[0].position_m, &pair[1].position_m)).sum();
                distance(&from_m, &first.position_m) + inner + distance(&last_m, &to_m)
            }
        };
        let speed_mps = movement.route.speed_mps.1.to_f64();
        let least = round_down(meters / speed_mps / self.unit_seconds());
        Bounds { least: Some(least.unwrap_or_default()), meters: parts_rounded_down(meters) }
    }
}

/// The effects of each occurrence, in order.
fn arrivals(network: &Network) -> BTreeMap<OccurrenceId, Vec<LabelId>> {
    let mut arrivals: BTreeMap<OccurrenceId, Vec<LabelId>> = BTreeMap::new();
    for (position, label) in network.labels.iter().enumerate() {
        if let Some(owner) = label.owner.filter(|_| label.extent == Extent::Effect) {
            arrivals.entry(owner).or_default().push(LabelId::from_index(position));
        }
    }
    arrivals
}

/// The values that something gives each variable: no vehicle departs from a place to which nothing brings it.
fn given_values(network: &Network) -> BTreeMap<VariableId, BTreeSet<ValueId>> {
    let mut given: BTreeMap<VariableId, BTreeSet<ValueId>> = BTreeMap::new();
    for label in network.labels.iter().filter(|label| label.mode == LabelMode::Tell) {
        if let ValueSet::In(values) = &label.literal.values {
            given.entry(label.literal.variable).or_default().extend(values);
        }
    }
    given
}

/// The ways from each of some places to each of others.
fn pairs<'places>(
    movement: &Movement,
    from: &'places [Waypoint],
    to: &'places [Waypoint],
) -> impl Iterator<Item = Ends<'places>> {
    let free_m = |places: &[Waypoint]| -> Vec<Point2<f64>> {
        let free_m = |place: &Waypoint| {
            movement.ground.as_ref().map_or(place.position_m, |ground| ground.free_m(place))
        };
        places.iter().map(free_m).collect()
    };
    let (from_m, to_m) = (free_m(from), free_m(to));
    from.iter().zip(from_m).flat_map(move |(from, from_m)| {
        let to: Vec<_> = to.iter().zip(to_m.iter().copied()).collect();
        to.into_iter().map(move |(to, to_m)| Ends { from, to, free_m: [from_m, to_m] })
    })
}

fn is_known(known: &[Known], ends: &Ends<'_>) -> bool {
    known.iter().any(|known| known.ends_m() == Some([ends.from.position_m, ends.to.position_m]))
}

/// Returns what all of some ways take at least.
fn min_of(ways: impl IntoIterator<Item = Bounds>) -> Bounds {
    let (mut least, mut meters) = (None, None);
    for way in ways {
        least = [least, way.least].into_iter().flatten().min();
        meters = [meters, way.meters].into_iter().flatten().min();
    }
    Bounds { least, meters }
}

/// Returns how many meters of a route were counted when its plan was chosen: the most that any planned path of it has.
pub(crate) fn counted_m(network: &Network, route: &Route) -> f64 {
    let is_its = |distance: &&tpn::Distance| {
        let arrival = &network.labels[distance.arrival.index()];
        let place = network.variables[arrival.literal.variable.index()].values.get(distance.from.index());
        arrival.owner == Some(route.occurrence) && place == route.from.as_ref()
    };
    network.distances.iter().find(is_its).map_or(0.0, |distance| distance.meters.to_f64())
}

/// Writes down how many meters a route drives that was planned.
pub(crate) fn record(network: &mut Network, route: &Route, length_m: f64) {
    let Some((from, meters)) = route.from.as_ref().zip(rounded_up(length_m)) else { return };
    let Network { labels, variables, distances, .. } = network;
    for distance in distances {
        let arrival = &labels[distance.arrival.index()];
        let variable = &variables[arrival.literal.variable.index()];
        let place = variable.values.get(distance.from.index());
        if arrival.owner == Some(route.occurrence) && place == Some(from) {
            distance.meters = meters;
        }
    }
}

/// A time that is no greater, in thousandths of the mission's unit.
fn round_down(units: f64) -> Option<Time> {
    parts_rounded_down(units).map(Time::from_units)
}

/// A number that is no greater, in thousandths.
fn parts_rounded_down(units: f64) -> Option<Rational> {
    const PARTS: i64 = 1000;
    // What is a hair less is still a lower bound.
    let parts = (units * PARTS as f64 * (1.0 - 1e-9)).floor();
    (parts.is_finite() && parts < 1e15).then_some(parts as i64).and_then(|parts| Rational::new(parts, PARTS))
}
