//! Where vehicles stand that are at one location at the same time (SPEC 10.3): the first at the location itself, others
//! around it, so that none is inside another.
//!
//! Vehicles that start together and are moved together by one traverse keep formation and count as one here. Those that fly
//! are above those that drive, and neither makes the other go aside.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Point2, Vector2, distance};
use rmpl::program::{PrimitiveDecl, Program, World};
use smol_str::SmolStr;
use tpn::Occurrence;

use crate::vehicle;

/// Places on the first ring around a location; each further ring has so many more.
const ON_FIRST_RING: usize = 6;
/// Meters more than vehicles need to keep apart.
const ROOM_M: f64 = 0.1;

/// The place that each vehicle has where it starts: 0 for the location itself. Those that one of `occurrences` moves together,
/// whether it is selected or not, share one.
pub fn start_slots(program: &Program, occurrences: &[Occurrence]) -> Vec<usize> {
    let vehicles = &program.world.vehicles;
    let moves_several = |it: &&PrimitiveDecl| it.moves.as_ref().is_some_and(|moves| moves.vehicles.len() > 1);
    let primitives: Vec<&PrimitiveDecl> = program.primitives.iter().filter(moves_several).collect();
    let convoys: BTreeSet<Vec<&SmolStr>> = (occurrences.iter())
        .filter_map(|occurrence| {
            let primitive = primitives.iter().find(|it| it.name.text == occurrence.activity)?;
            Some(primitive.moved(&occurrence.arguments).collect())
        })
        .collect();
    let drive_together = |one: usize, other: usize| {
        let names = [one, other].map(|vehicle| &vehicles[vehicle].name.text);
        convoys.iter().any(|convoy| names.iter().all(|name| convoy.contains(name)))
    };
    let in_convoys: BTreeSet<&SmolStr> = convoys.iter().flatten().copied().collect();
    let mut slots: Vec<usize> = Vec::with_capacity(vehicles.len());
    // The vehicles so far that start at a location and drive in a convoy, and the next free place; those that fly apart from
    // those that drive.
    let mut starting: BTreeMap<(&str, bool), (Vec<usize>, usize)> = BTreeMap::new();
    for (vehicle, declared) in vehicles.iter().enumerate() {
        let flies = vehicle::flies(&program.world, vehicle as u32);
        let (before, free) = starting.entry((declared.start.text.as_str(), flies)).or_default();
        let group = before.iter().find(|&&other| drive_together(other, vehicle));
        let slot = group.map_or(*free, |&group| slots[group]);
        slots.push(slot);
        *free = (*free).max(slot + 1);
        if in_convoys.contains(&declared.name.text) {
            before.push(vehicle);
        }
    }
    slots
}

/// Meters between places at one location, of the vehicles that fly or of those that do not: twice the room that any two of
/// them need, so that one can drive between two others, and room for what follows them in formation.
pub fn spacing_m(program: &Program, fly: bool) -> f64 {
    2.0 * room_m(&program.world, fly) * most_together(program) as f64
}

/// Returns how many vehicles an activity moves at most, and at least one.
fn most_together(program: &Program) -> usize {
    let moves = program.primitives.iter().filter_map(|primitive| primitive.moves.as_ref());
    moves.map(|moves| moves.vehicles.len()).max().unwrap_or(1).max(1)
}

/// Meters between the centers of any two vehicles that fly, or do not, when they keep apart.
fn room_m(world: &World, fly: bool) -> f64 {
    let all = (0..world.vehicles.len() as u32).filter(|&vehicle| vehicle::flies(world, vehicle) == fly);
    let mut widest: Vec<f64> = all.map(|vehicle| vehicle::radius_m(world, vehicle)).collect();
    widest.sort_by(f64::total_cmp);
    let two: f64 = widest.iter().rev().take(2).sum();
    two + vehicle::GAP_M + ROOM_M
}

/// The place with a number at a location. Rings lie a spacing apart, and so do the places on each.
pub fn place_m(location_m: Point2<f64>, slot: usize, spacing_m: f64) -> Point2<f64> {
    let ring = ring(slot) as usize;
    if ring == 0 {
        return location_m;
    }
    let at = slot - 1 - ON_FIRST_RING * (ring * (ring - 1) / 2);
    // The corners of a hexagon, south first, and places between them.
    let high = 0.75_f64.sqrt();
    let corners = [(0.0, -1.0), (high, -0.5), (high, 0.5), (0.0, 1.0), (-high, 0.5), (-high, -0.5)]
        .map(|(east, north)| Vector2::new(east, north));
    let (corner, part) = (at / ring, (at % ring) as f64 / ring as f64);
    let (from, to) = (corners[corner % ON_FIRST_RING], corners[(corner + 1) % ON_FIRST_RING]);
    location_m + (from + (to - from) * part) * (spacing_m * ring as f64)
}

/// Returns how far from its location a vehicle may stand, in meters, with its body and as much room again.
pub fn reach_m(program: &Program) -> f64 {
    let world = &program.world;
    let all = || 0..world.vehicles.len() as u32;
    let away_m = |fly: bool| {
        let last = all().filter(|&vehicle| vehicle::flies(world, vehicle) == fly).count().saturating_sub(1);
        // What follows in formation is behind the place of its leader.
        let formation_m = room_m(world, fly) * (most_together(program) - 1) as f64;
        f64::from(ring(last)) * spacing_m(program, fly) + formation_m
    };
    let widest_m = all().map(|vehicle| vehicle::radius_m(world, vehicle)).fold(0.0, f64::max);
    away_m(false).max(away_m(true)) + 2.0 * widest_m
}

/// The number of the ring of a place.
fn ring(slot: usize) -> u32 {
    let (mut ring, mut last) = (0, 0);
    while last < slot {
        ring += 1;
        last += ON_FIRST_RING * ring as usize;
    }
    ring
}

/// Where a vehicle stands from the beginning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// In meters. Of those that share a place for their formation, the first is there, and the others stand around it.
    pub place_m: Point2<f64>,
    /// The number of its place at the location: see [`start_slots`].
    pub slot: usize,
}

/// Returns where each vehicle stands before it first moves; `None` if its start is not declared.
pub fn starts(program: &Program, occurrences: &[Occurrence]) -> Vec<Option<Start>> {
    let world = &program.world;
    let spacings_m = [false, true].map(|fly| spacing_m(program, fly));
    let rooms_m = [false, true].map(|fly| room_m(world, fly));
    let mut locations: BTreeMap<&str, Point2<f64>> = BTreeMap::new();
    for location in &world.locations {
        locations.entry(&location.name.text).or_insert_with(|| location.position_m.into());
    }
    let slots = start_slots(program, occurrences);
    let keys = world.vehicles.iter().zip(slots).enumerate().map(|(vehicle, (declared, slot))| {
        (declared.start.text.as_str(), slot, vehicle::flies(world, vehicle as u32))
    });
    let keys: Vec<(&str, usize, bool)> = keys.collect();
    let mut before: BTreeMap<(&str, usize, bool), usize> = BTreeMap::new();
    let starts = keys.into_iter().map(|key| {
        let (location, slot, flies) = key;
        let (spacing_m, room_m) = (spacings_m[usize::from(flies)], rooms_m[usize::from(flies)]);
        let before = before.entry(key).or_default();
        let middle_m = place_m(*locations.get(location)?, slot, spacing_m);
        let start = Start { place_m: place_m(middle_m, *before, room_m), slot };
        *before += 1;
        Some(start)
    });
    starts.collect()
}

/// The vehicle that is nearest to a place and nearer than so many meters, of those with `places` that are none of `vehicles` and,
/// as the first of these does, drive or fly.
pub fn nearest_other(
    world: &World,
    vehicles: &[u32],
    (place_m, within_m): (Point2<f64>, f64),
    places: impl Iterator<Item = (u32, Point2<f64>)>,
) -> Option<u32> {
    let flies = vehicle::flies(world, *vehicles.first()?);
    let others =
        places.filter(|(vehicle, _)| !vehicles.contains(vehicle) && vehicle::flies(world, *vehicle) == flies);
    let away = others.map(|(vehicle, other_m)| (distance(&other_m, &place_m), vehicle));
    let nearest = away.min_by(|one, other| one.0.total_cmp(&other.0));
    nearest.filter(|(away_m, _)| *away_m < within_m).map(|(_, vehicle)| vehicle)
}

#[cfg(test)]
mod tests {
    use nalgebra::distance;

    use super::*;

    #[test]
    fn places_at_one_location_are_a_spacing_apart() {
        let location = Point2::new(10.0, -4.0);
        let places: Vec<Point2<f64>> = (0..37).map(|slot| place_m(location, slot, 2.0)).collect();
        assert_eq!(places[0], location);
        for (index, place) in places.iter().enumerate() {
            for other in &places[..index] {
                assert!(distance(place, other) > 2.0 - 1e-9, "{place} and {other}");
            }
        }
        // Three rings.
        assert!(places.iter().all(|place| distance(place, &location) < 6.0 + 1e-9));
    }
}
