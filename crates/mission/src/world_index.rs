//! What a mission's names mean in its world, looked up by name: missions may have thousands of vehicles, locations and
//! movements.

use std::collections::BTreeMap;

use rmpl::program::{LocationDecl, PrimitiveDecl, Program};
use snapshot::vehicle::Moving;
use tpn::Occurrence;

use crate::traverse::Waypoint;

/// The locations, vehicles and primitives of a program by name. Of several with one name, the first counts.
pub(crate) struct WorldIndex<'program> {
    locations: BTreeMap<&'program str, &'program LocationDecl>,
    vehicles: BTreeMap<&'program str, usize>,
    primitives: BTreeMap<&'program str, &'program PrimitiveDecl>,
}

impl<'program> WorldIndex<'program> {
    pub(crate) fn new(program: &'program Program) -> Self {
        let (world, primitives) = (&program.world, &program.primitives);
        let vehicles = world.vehicles.iter().enumerate();
        Self {
            locations: first_of(world.locations.iter().map(|it| (it.name.text.as_str(), it))),
            vehicles: first_of(vehicles.map(|(vehicle, it)| (it.name.text.as_str(), vehicle))),
            primitives: first_of(primitives.iter().map(|it| (it.name.text.as_str(), it))),
        }
    }

    /// The middle of a location.
    pub(crate) fn waypoint(&self, name: &str) -> Option<Waypoint> {
        let location = self.locations.get(name)?;
        let position_m = location.position_m.into();
        Some(Waypoint { name: location.name.text.clone(), position_m, slot: 0, is_behind: false })
    }

    /// The position of a vehicle in the program's world.
    pub(crate) fn vehicle(&self, name: &str) -> Option<usize> {
        self.vehicles.get(name).copied()
    }

    /// Returns what `occurrence` moves, if it is a traverse.
    pub(crate) fn moving(&self, occurrence: &Occurrence) -> Option<Moving<'program>> {
        Moving::of(self.primitives.get(occurrence.activity.as_str())?, occurrence)
    }
}

fn first_of<'program, T>(named: impl Iterator<Item = (&'program str, T)>) -> BTreeMap<&'program str, T> {
    let mut first = BTreeMap::new();
    for (name, it) in named {
        first.entry(name).or_insert(it);
    }
    first
}
