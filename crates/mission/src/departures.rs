//! Movements whose order planning finds (SPEC 10.3): how long each takes at least from wherever its vehicle may be, and how
//! many meters it drives. Before a path is known that is the straight line, at the greatest speed; what a path says holds
//! for every plan with that leg.

use snapshot::vehicle;
use std::collections::BTreeMap;

use exact::{Rational, Time};
use rmpl::program::Program;
use smol_str::{SmolStr, format_smolstr};
use tpn::worth::rounded_up;
use tpn::{Departure, Distance, Extent, LabelId, Network, OccurrenceId, ValueId};

use crate::traverse::{self, Route};

/// How long the movements of a mission take, by where they start.
pub(crate) struct Departures {
    movements: Vec<Movement>,
    /// What paths have told; `None` of what cannot be driven.
    known: BTreeMap<(OccurrenceId, SmolStr), Known>,
    /// The routes whose paths were asked. Where several vehicles stand at one place each has a spot of its own there, so
    /// that one leg can have several.
    asked: Vec<Route>,
}

/// What a path has told.
#[derive(Clone, Copy)]
struct Known {
    least: Option<Time>,
    meters: Option<Rational>,
}

struct Movement {
    occurrence: OccurrenceId,
    arrival: LabelId,
    /// Each place, with the time that the straight line takes and its meters.
    places: Vec<(ValueId, SmolStr, Option<Time>, Option<Rational>)>,
}

impl Departures {
    /// Of the traverses of `network`, by straight lines.
    pub(crate) fn new(network: &Network, program: &Program) -> Self {
        let movements = (0..network.occurrences.len())
            .map(OccurrenceId::from_index)
            .filter_map(|occurrence| movement(network, program, occurrence));
        Self { movements: movements.collect(), known: BTreeMap::new(), asked: Vec::new() }
    }

    /// Whether a path has told how long a route takes.
    pub(crate) fn knows(&self, route: &Route) -> bool {
        let is_it = |asked: &Route| {
            (asked.occurrence, &asked.from, &asked.waypoints)
                == (route.occurrence, &route.from, &route.waypoints)
        };
        route.from.is_none() || self.asked.iter().any(is_it)
    }

    /// Learns how long a route takes at least, `None` if it cannot be driven, and its meters. Of several paths of one leg,
    /// the quickest one bounds the time, because no plan may be refused, and the longest one counts for meters.
    pub(crate) fn learn(&mut self, route: &Route, least: Option<Time>, meters: Option<Rational>) {
        if let Some(from) = &route.from {
            // The exact time comes with the path; a rounder one that is a little less keeps the planner's numbers small.
            let least = least.map(|least| round_down(least.to_f64()).unwrap_or_default());
            let key = (route.occurrence, from.clone());
            let earlier = self.known.get(&key).copied();
            let quickest = earlier.and_then(|earlier| earlier.least);
            let least = least.map(|least| quickest.map_or(least, |quickest| quickest.min(least)));
            let longest = earlier.and_then(|earlier| earlier.meters).max(meters);
            self.known.insert(key, Known { least, meters: longest });
            self.asked.push(route.clone());
        }
    }

    /// At most so many routes whose paths were not asked yet, the shortest first.
    pub(crate) fn unknown(&self, network: &Network, program: &Program, most: usize) -> Vec<Route> {
        let open = self.movements.iter().flat_map(|movement| {
            let is_known = |place: &SmolStr| self.known.contains_key(&(movement.occurrence, place.clone()));
            let places = movement.places.iter().filter(move |(_, place, _, _)| !is_known(place));
            places.filter_map(|(_, place, _, meters)| Some(((*meters)?, movement.occurrence, place)))
        });
        let mut open: Vec<(Rational, OccurrenceId, &SmolStr)> = open.collect();
        open.sort_unstable();
        let routes = open
            .into_iter()
            .filter_map(|(_, occurrence, place)| traverse::route_from(network, program, occurrence, place));
        routes.filter(|route| !self.knows(route)).take(most).collect()
    }

    /// All that is known, for the planner.
    pub(crate) fn all(&self) -> Vec<Departure> {
        self.listed(|_, _| true)
    }

    /// What is known of these routes, each of which starts where it does and nowhere else.
    pub(crate) fn only(&self, routes: &[Route]) -> Vec<Departure> {
        self.listed(|occurrence, place| {
            let route = routes.iter().find(|route| route.occurrence == occurrence);
            route.is_none_or(|route| route.from.as_ref() == Some(place))
        })
    }

    /// How many meters each movement drives at least from each place.
    pub(crate) fn distances(&self) -> Vec<Distance> {
        let all = self.movements.iter().flat_map(|movement| {
            movement.places.iter().filter_map(move |(from, place, _, straight)| {
                let known = self.known.get(&(movement.occurrence, place.clone()));
                let meters = known.and_then(|known| known.meters).or(*straight)?;
                Some(Distance { arrival: movement.arrival, from: *from, meters })
            })
        });
        all.collect()
    }

    fn listed(&self, is_possible: impl Fn(OccurrenceId, &SmolStr) -> bool) -> Vec<Departure> {
        let mut departures = Vec::new();
        for movement in &self.movements {
            for (value, place, straight, _) in &movement.places {
                let known = self.known.get(&(movement.occurrence, place.clone())).map(|known| known.least);
                let least = match (known, straight) {
                    _ if !is_possible(movement.occurrence, place) => None,
                    (Some(known), _) => known,
                    (None, Some(straight)) => Some(*straight),
                    (None, None) => continue,
                };
                departures.push(Departure { arrival: movement.arrival, from: *value, least });
            }
        }
        departures
    }
}

/// How many meters of a route were counted when its plan was chosen: the most that any planned path of it has.
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

fn movement(network: &Network, program: &Program, occurrence: OccurrenceId) -> Option<Movement> {
    let moving = vehicle::moving(program, &network.occurrences[occurrence.index()])?;
    let name = format_smolstr!("{}.at", moving.vehicles.first()?);
    let is_arrival = |label: &&tpn::Label| {
        label.owner == Some(occurrence)
            && label.extent == Extent::Effect
            && network.variables[label.literal.variable.index()].name == name
    };
    let position = network.labels.iter().position(|label| is_arrival(&label))?;
    let variable = &network.variables[network.labels[position].literal.variable.index()];
    let unit_seconds = program.options.time_unit.seconds();
    let places = variable.values.iter().enumerate().map(|(index, place)| {
        let route = traverse::route_from(network, program, occurrence, place);
        let meters = route.as_ref().map(straight_meters);
        let least =
            route.as_ref().zip(meters).and_then(|(route, meters)| straight(route, meters, unit_seconds));
        (ValueId::from_index(index), place.clone(), least, meters.and_then(parts_rounded_down))
    });
    Some(Movement { occurrence, arrival: LabelId::from_index(position), places: places.collect() })
}

/// The length of a route along straight lines.
fn straight_meters(route: &Route) -> f64 {
    let pairs = route.waypoints.windows(2);
    pairs.map(|pair| nalgebra::distance(&pair[0].position_m, &pair[1].position_m)).sum()
}

/// The time of a route along straight lines at the greatest speed.
fn straight(route: &Route, meters: f64, unit_seconds: i64) -> Option<Time> {
    let speed_mps = route.speed_mps.1.to_f64();
    round_down(meters / speed_mps / Rational::from_integer(unit_seconds).to_f64())
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
