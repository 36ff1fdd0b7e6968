//! The clearance map of one vehicle, kept until its ground, its obstacles or the vehicle change.

use std::sync::Arc;

use rmpl::program::ObstacleShape;
use smol_str::SmolStr;
use snapshot::{MapKey, Snapshot};
use terrain::Terrain;
use workbench::state::Selection;
use workbench::state::growth::obstacles;

use super::card::selected_traverse;

/// The last clearance map, with what it was made from.
#[derive(Clone, Debug, PartialEq)]
pub struct Clearance {
    map: MapKey,
    obstacles: Vec<ObstacleShape>,
    /// The model of the vehicle whose room it shows.
    pub model: SmolStr,
    /// Metres from the vehicle's rim to the nearest obstacle, one number per cell, rows from the south.
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
        let wanted = vehicle(snapshot, selection).and_then(|index| world.vehicles.get(index));
        let name = wanted.map_or(motion::VEHICLE_MODELS[0].name, |vehicle| vehicle.model.text.as_str());
        let model = motion::vehicle_model(name)?;
        let shapes: Vec<ObstacleShape> = world.obstacles.iter().map(|it| it.shape.clone()).collect();
        if let Some(before) = before
            && before.map == *key
            && before.model == model.name
            && before.obstacles == shapes
        {
            return Some(before);
        }
        let space = model.configuration_space(map, &obstacles(world));
        Some(Self {
            map: key.clone(),
            obstacles: shapes,
            model: SmolStr::new(model.name),
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
