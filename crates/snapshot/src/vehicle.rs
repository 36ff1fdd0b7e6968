//! Vehicles of a mission's world: how wide they are, whether they fly, and which activities move them.

use rmpl::program::{Moves, Name, Program, World};
use smol_str::SmolStr;
use tpn::{Occurrence, Resource};

/// Room between vehicles beyond their radii, in metres: what a formation keeps and what others have to.
pub const GAP_M: f64 = 1.0;

/// Whether a vehicle is in the air, above all that is on the ground.
pub fn flies(world: &World, vehicle: u32) -> bool {
    let model = world.vehicles.get(vehicle as usize).and_then(|it| motion::vehicle_model(&it.model.text));
    model.is_some_and(|model| matches!(model.drive, motion::Drive::Flight { .. }))
}

/// A vehicle's circumradius in metres.
pub fn radius_m(world: &World, vehicle: u32) -> f64 {
    let model = world.vehicles.get(vehicle as usize).and_then(|it| motion::vehicle_model(&it.model.text));
    model.map_or(0.5, |model| model.circumradius_m)
}

/// What the order of two traverses that would meet is called, as a resource that the mission does not have.
pub const WAY: &str = "way#";

/// Whether a resource is the order of two traverses that would meet.
pub fn is_way(resource: &Resource) -> bool {
    resource.name.starts_with(WAY)
}

/// What a call of a traverse moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Moving<'program> {
    /// The clause of the primitive.
    pub moves: &'program Moves,
    /// The vehicles by name, parameters replaced by the arguments of the call; the first leads.
    pub vehicles: Vec<SmolStr>,
}

/// What `occurrence` moves, if it is a traverse.
pub fn moving<'program>(program: &'program Program, occurrence: &Occurrence) -> Option<Moving<'program>> {
    let primitive = program.primitives.iter().find(|it| it.name.text == occurrence.activity)?;
    let moves = primitive.moves.as_ref()?;
    let named = |vehicle: &Name| {
        let formal = primitive.formals.iter().position(|formal| formal.text == vehicle.text);
        formal.and_then(|at| occurrence.arguments.get(at)).unwrap_or(&vehicle.text).clone()
    };
    Some(Moving { moves, vehicles: moves.vehicles.iter().map(named).collect() })
}
