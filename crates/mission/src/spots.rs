//! Where vehicles stand at the locations that they come to (SPEC 10.3): in a plan, whose order decides, and in any plan of a
//! network, which is what bounds need.

use std::collections::{BTreeMap, BTreeSet};

use executive::facts::StandingPlace;
use motion::Formation;
use rmpl::program::Program;
use smol_str::SmolStr;
use snapshot::standing::{self, Start};
use snapshot::vehicle;
use tpn::{Network, NodeId, OccurrenceId};

use crate::traverse::Waypoint;
use crate::world_index::WorldIndex;

/// The slot of a place where a vehicle has stopped on its way, away from the location that it came from.
pub(crate) const ON_THE_WAY: usize = usize::MAX;

/// The places of a mission's vehicles.
pub(crate) struct Spots {
    flies: Vec<bool>,
    spacings_m: [f64; 2],
    /// Where each vehicle stands before it first moves.
    pub(crate) starts: Vec<Option<Waypoint>>,
}

impl Spots {
    pub(crate) fn new(network: &Network, program: &Program) -> Self {
        let world = &program.world;
        let starts = standing::starts(program, &network.occurrences);
        let start = |(vehicle, start): (&rmpl::program::VehicleDecl, Option<Start>)| {
            let Start { place_m, slot, .. } = start?;
            Some(Waypoint { name: vehicle.start.text.clone(), position_m: place_m, slot, is_behind: false })
        };
        Self {
            flies: (0..world.vehicles.len() as u32).map(|vehicle| vehicle::flies(world, vehicle)).collect(),
            spacings_m: [false, true].map(|fly| standing::spacing_m(program, fly)),
            starts: world.vehicles.iter().zip(starts).map(start).collect(),
        }
    }

    /// The place with a number at a location, for a vehicle.
    pub(crate) fn at(&self, location: &Waypoint, slot: usize, vehicle: usize) -> Waypoint {
        let spacing_m = self.spacings_m[usize::from(self.flies[vehicle])];
        let position_m = standing::place_m(location.position_m, slot, spacing_m);
        Waypoint { name: location.name.clone(), position_m, slot, is_behind: false }
    }

    /// The place of a location that vehicles take that come there together, the first of them leading: the first one at which
    /// none of the others stands, which are at `positions`.
    pub(crate) fn free(&self, location: &Waypoint, vehicles: &[usize], positions: &Positions) -> Waypoint {
        let Some(&leader) = vehicles.first() else { return location.clone() };
        // What is there already stays where it is.
        let others = positions.at(&location.name).filter(|&other| self.is_other(vehicles, other));
        let taken: BTreeSet<usize> =
            others.filter_map(|other| positions.of(other)).map(|place| place.slot).collect();
        let free = (0..taken.len()).find(|slot| !taken.contains(slot)).unwrap_or(taken.len());
        self.at(location, free, leader)
    }

    /// Returns whether a vehicle makes those that come together go aside: what flies is above what drives.
    fn is_other(&self, vehicles: &[usize], other: usize) -> bool {
        vehicles.first().is_some_and(|&leader| self.flies[leader] == self.flies[other])
            && !vehicles.contains(&other)
    }
}

/// Where each vehicle is.
pub(crate) struct Positions {
    of: Vec<Option<Waypoint>>,
    /// The vehicles at each location.
    at: BTreeMap<SmolStr, BTreeSet<usize>>,
}

impl Positions {
    pub(crate) fn new(of: Vec<Option<Waypoint>>) -> Self {
        let mut at: BTreeMap<SmolStr, BTreeSet<usize>> = BTreeMap::new();
        for (vehicle, place) in of.iter().enumerate() {
            if let Some(place) = place {
                at.entry(place.name.clone()).or_default().insert(vehicle);
            }
        }
        Self { of, at }
    }

    pub(crate) fn of(&self, vehicle: usize) -> Option<&Waypoint> {
        self.of.get(vehicle)?.as_ref()
    }

    /// The vehicles at a location.
    fn at(&self, location: &str) -> impl Iterator<Item = usize> {
        self.at.get(location).into_iter().flatten().copied()
    }

    pub(crate) fn set(&mut self, vehicle: usize, place: Waypoint) {
        if let Some(before) = self.of(vehicle).map(|before| before.name.clone())
            && let Some(there) = self.at.get_mut(&before)
        {
            there.remove(&vehicle);
        }
        self.at.entry(place.name.clone()).or_default().insert(vehicle);
        self.of[vehicle] = Some(place);
    }
}

/// A movement that brings vehicles to a location.
struct Arrival {
    occurrence: OccurrenceId,
    vehicles: Vec<usize>,
}

/// The alternatives of decisions in which alone an event is, in order.
type Context = BTreeSet<(usize, usize)>;

/// Where vehicles may stand in some plan of a network.
pub(crate) struct PossibleSpots<'mission> {
    spots: Spots,
    /// The vehicles that start at each location.
    starting: BTreeMap<SmolStr, Vec<usize>>,
    /// The movements that end at each location.
    arrivals: BTreeMap<SmolStr, Vec<Arrival>>,
    contexts: BTreeMap<OccurrenceId, Context>,
    stopped: &'mission [StandingPlace],
}

impl<'mission> PossibleSpots<'mission> {
    /// In plans of `network`, in which some vehicles may have stopped on their way.
    pub(crate) fn new(network: &Network, program: &Program, stopped: &'mission [StandingPlace]) -> Self {
        let index = WorldIndex::new(program);
        let of_events = contexts(network);
        let mut arrivals: BTreeMap<SmolStr, Vec<Arrival>> = BTreeMap::new();
        let mut contexts = BTreeMap::new();
        for (position, it) in network.occurrences.iter().enumerate() {
            let Some(moving) = index.moving(it) else { continue };
            let occurrence = OccurrenceId::from_index(position);
            let Some(last) = it.arguments.iter().filter_map(|name| index.waypoint(name)).next_back() else {
                continue;
            };
            let vehicles = moving.vehicles.iter().filter_map(|name| index.vehicle(name)).collect();
            arrivals.entry(last.name).or_default().push(Arrival { occurrence, vehicles });
            contexts.insert(occurrence, of_events[it.start.index()].clone().unwrap_or_default());
        }
        let spots = Spots::new(network, program);
        let mut starting: BTreeMap<SmolStr, Vec<usize>> = BTreeMap::new();
        for (vehicle, start) in spots.starts.iter().enumerate() {
            if let Some(start) = start {
                starting.entry(start.name.clone()).or_default().push(vehicle);
            }
        }
        Self { spots, starting, arrivals, contexts, stopped }
    }

    /// Returns where the leader of a movement may stand at a location before it; nowhere if nothing brings it there.
    pub(crate) fn before(&self, occurrence: OccurrenceId, leader: usize, at: &Waypoint) -> Vec<Waypoint> {
        let start = self.spots.starts[leader].iter().filter(|start| start.name == at.name).cloned();
        let arrivals = self.arrivals.get(&at.name).into_iter().flatten().filter(|arrival| {
            arrival.occurrence != occurrence
                && arrival.vehicles.contains(&leader)
                && self.can_be_together(arrival.occurrence, occurrence)
        });
        let highest =
            arrivals.map(|arrival| self.num_others(arrival.occurrence, &arrival.vehicles, at)).max();
        let slots = highest.into_iter().flat_map(|highest| 0..=highest);
        let stopped = self.stopped.iter().filter(|it| it.vehicle as usize == leader).map(|it| Waypoint {
            name: at.name.clone(),
            position_m: it.place_m.into(),
            slot: ON_THE_WAY,
            is_behind: false,
        });
        start.chain(slots.map(|slot| self.spots.at(at, slot, leader))).chain(stopped).collect()
    }

    /// Returns how far the leader of a movement may be from these places, in meters, because it followed another
    /// vehicle there.
    pub(crate) fn behind_m(
        &self,
        occurrence: OccurrenceId,
        leader: usize,
        at: &Waypoint,
        spacing_m: impl Fn(&[usize]) -> f64,
    ) -> f64 {
        let arrivals = self.arrivals.get(&at.name).into_iter().flatten();
        let behind_m = arrivals.filter_map(|arrival| {
            let index = arrival.vehicles.iter().position(|&vehicle| vehicle == leader)?;
            let is_its = index > 0
                && arrival.occurrence != occurrence
                && self.can_be_together(arrival.occurrence, occurrence);
            is_its.then(|| Formation { spacing_m: spacing_m(&arrival.vehicles) }.reach_m(index))
        });
        behind_m.fold(0.0, f64::max)
    }

    /// Returns where vehicles may stand after a movement that brings them to a location.
    pub(crate) fn after(&self, occurrence: OccurrenceId, vehicles: &[usize], at: &Waypoint) -> Vec<Waypoint> {
        let Some(&leader) = vehicles.first() else { return vec![at.clone()] };
        let highest = self.num_others(occurrence, vehicles, at);
        (0..=highest).map(|slot| self.spots.at(at, slot, leader)).collect()
    }

    /// Returns how many vehicles may stand at a location when others come there in a movement.
    fn num_others(&self, occurrence: OccurrenceId, vehicles: &[usize], at: &Waypoint) -> usize {
        let starting = self.starting.get(&at.name).into_iter().flatten().copied();
        let arriving = self.arrivals.get(&at.name).into_iter().flatten();
        let arriving = arriving
            .filter(|arrival| self.can_be_together(arrival.occurrence, occurrence))
            .flat_map(|arrival| arrival.vehicles.iter().copied());
        let others: BTreeSet<usize> =
            starting.chain(arriving).filter(|&other| self.spots.is_other(vehicles, other)).collect();
        others.len()
    }

    /// Returns whether a plan may have both of two movements.
    fn can_be_together(&self, one: OccurrenceId, other: OccurrenceId) -> bool {
        let (Some(one), Some(other)) = (self.contexts.get(&one), self.contexts.get(&other)) else {
            return true;
        };
        let is_excluded = |&(decision, alternative): &(usize, usize)| {
            let mut chosen = other.range((decision, 0)..=(decision, usize::MAX));
            chosen.any(|&(_, it)| it != alternative)
        };
        !one.iter().any(is_excluded)
    }
}

/// The context of each event: what all ways from the start to it choose. `None` where no way leads.
fn contexts(network: &Network) -> Vec<Option<Context>> {
    let mut chosen: BTreeMap<usize, (usize, usize)> = BTreeMap::new();
    for (decision, it) in network.decisions.iter().enumerate() {
        chosen.extend(
            it.alternatives.iter().enumerate().map(|(number, arc)| (arc.index(), (decision, number))),
        );
    }
    let mut contexts: Vec<Option<Context>> = vec![None; network.nodes.len()];
    contexts[network.start.index()] = Some(Context::new());
    let mut open: Vec<NodeId> = vec![network.start];
    while let Some(node) = open.pop() {
        let Some(context) = contexts[node.index()].clone() else { continue };
        for arc in &network.nodes[node.index()].out_arcs {
            let to = network.arcs[arc.index()].to;
            let mut next = context.clone();
            next.extend(chosen.get(&arc.index()));
            let known = &mut contexts[to.index()];
            match known {
                Some(known) if known.is_subset(&next) => {}
                Some(known) => {
                    known.retain(|choice| next.contains(choice));
                    open.push(to);
                }
                None => {
                    *known = Some(next);
                    open.push(to);
                }
            }
        }
    }
    contexts
}
