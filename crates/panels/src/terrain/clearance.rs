//! The clearance map of one vehicle, kept until its ground, its obstacles or the vehicle change.

use std::sync::Arc;

use motion::VehicleModel;
use rmpl::program::ObstacleShape;
use smol_str::SmolStr;
use snapshot::ground::closed_to;
use snapshot::{MapKey, Snapshot};
use terrain::{Obstacle, Terrain};
use workbench::state::Selection;

use super::card::selected_traverse;

/// The last clearance map, with what it was made from.
#[derive(Clone, Debug, PartialEq)]
pub struct Clearance {
    map: MapKey,
    obstacles: Vec<ObstacleShape>,
    /// The name of the model of the vehicle whose room it shows.
    pub model: SmolStr,
    vehicle: VehicleModel,
    /// Meters from the vehicle's rim to the nearest obstacle, one number per cell, rows from the south.
    pub room_m: Arc<[f32]>,
}

impl Clearance {
    /// The clearance map for what is selected: `before` if nothing changed. `None` when there is no known vehicle.
    pub fn updated(
        before: Option<Self>,
        key: &MapKey,
        map: &Terrain,
        snapshot: &Snapshot,
        selection: &Selection,
    ) -> Option<Self> {
        let world = &snapshot.program.world;
        let wanted = vehicle(snapshot, selection);
        let declared = wanted.and_then(|index| world.vehicles.get(index));
        let name = declared.map_or(motion::VEHICLE_MODELS[0].name, |vehicle| vehicle.model.text.as_str());
        let vehicle = snapshot::vehicle::model(world, name)?;
        let occurrence = selected_traverse(snapshot, selection).map(|it| it.occurrence);
        let network = snapshot.network.as_deref();
        let driven = network.zip(occurrence).and_then(|(it, driven)| it.occurrences.get(driven.index()));
        let activity = driven.map_or("", |it| it.activity.as_str());
        let vehicles: Vec<usize> = wanted.into_iter().collect();
        let closed = closed_to(world, &vehicles, activity);
        let shapes: Vec<ObstacleShape> = closed.map(|it| it.shape.clone()).collect();
        if let Some(before) = before
            && before.map == *key
            && before.model == name
            && before.vehicle == vehicle
            && before.obstacles == shapes
        {
            return Some(before);
        }
        let obstacles: Vec<Obstacle> = shapes.iter().map(snapshot::ground::obstacle).collect();
        let space = vehicle.configuration_space(map, &obstacles);
        Some(Self {
            map: key.clone(),
            obstacles: shapes,
            model: SmolStr::new(name),
            vehicle,
            room_m: space.clearance_map_m().into(),
        })
    }
}

/// The vehicle that is selected, or that leads the selected traverse, or the first.
pub fn vehicle(snapshot: &Snapshot, selection: &Selection) -> Option<usize> {
    let vehicles = &snapshot.program.world.vehicles;
    if let Selection::Vehicle(name) = selection {
        return vehicles.iter().position(|it| it.name.text == *name);
    }
    let leader = selected_traverse(snapshot, selection).and_then(|it| it.vehicles.first().copied());
    leader.map(|leader| leader as usize).or(if vehicles.is_empty() { None } else { Some(0) })
}
