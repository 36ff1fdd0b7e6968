//! Vehicles of a mission's world: how wide they are, whether they fly, and which activities move them.

use motion::VehicleModel;
use rmpl::program::{Moves, PrimitiveDecl, Program, Property, World};
use smol_str::SmolStr;
use tpn::{Occurrence, Resource};

/// Room between vehicles beyond their radii, in meters: what a formation keeps and what others have to.
pub const GAP_M: f64 = 1.0;

/// The model of this name: a built-in one, or one that the mission declares, with what the models that it extends say. Its
/// wheels, and what else no property says, are those of the built-in model that it is made from. `None` if there is none.
pub fn model(world: &World, name: &str) -> Option<VehicleModel> {
    let mut model = *motion::vehicle_model(rmpl::fleet::built_in(world, name)?)?;
    let lineage = rmpl::fleet::lineage(world, name);
    let mut turning_radius_m = None;
    for property in rmpl::fleet::properties(&lineage) {
        match property {
            Property::Body { length_m, width_m } => model = model.with_body(length_m, width_m),
            Property::Speed { min_mps, max_mps } => {
                (model.min_speed_mps, model.speed_mps) = (min_mps.to_f64(), max_mps.to_f64());
            }
            Property::Slope { angle_rad } => model = model.with_slope(angle_rad),
            Property::Clearance { size_m } => model = model.with_clearance(size_m),
            Property::Turning { radius_m } => turning_radius_m = Some(radius_m),
            Property::Mast { height_m } => model.mast_m = height_m,
            Property::Flies { altitude_band_m } => model = model.with_altitude_band(altitude_band_m),
        }
    }
    // The radius is that at the greatest speed, whichever model says that.
    Some(turning_radius_m.map_or(model, |radius_m| model.with_turning_radius(radius_m)))
}

/// The model of a vehicle, by its index.
pub fn model_of(world: &World, vehicle: usize) -> Option<VehicleModel> {
    model(world, &world.vehicles.get(vehicle)?.model.text)
}

/// Returns whether a vehicle is in the air, above all that is on the ground.
pub fn flies(world: &World, vehicle: u32) -> bool {
    let model = model_of(world, vehicle as usize);
    model.is_some_and(|model| matches!(model.drive, motion::Drive::Flight { .. }))
}

/// A vehicle's circumradius in meters.
pub fn radius_m(world: &World, vehicle: u32) -> f64 {
    let model = model_of(world, vehicle as usize);
    model.map_or(0.5, |model| model.circumradius_m)
}

/// What the order of two traverses that would meet is called, as a resource that the mission does not have.
pub const WAY: &str = "way#";

/// Returns whether a resource is the order of two traverses that would meet.
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

/// Returns what `occurrence` moves, if it is a traverse.
pub fn moving<'program>(program: &'program Program, occurrence: &Occurrence) -> Option<Moving<'program>> {
    Moving::of(program.primitives.iter().find(|it| it.name.text == occurrence.activity)?, occurrence)
}

impl<'program> Moving<'program> {
    /// Returns what a call of `primitive` moves, if it is a traverse.
    pub fn of(primitive: &'program PrimitiveDecl, occurrence: &Occurrence) -> Option<Self> {
        let moves = primitive.moves.as_ref()?;
        Some(Self { moves, vehicles: primitive.moved(&occurrence.arguments).cloned().collect() })
    }
}

#[cfg(test)]
mod tests {
    use super::model;

    #[test]
    fn a_model_has_what_it_says_and_otherwise_what_it_extends() {
        let world = rmpl::parse(
            "model Scout { body 0.6 x 0.42; speed (0.01, 0.8); slope 20 degrees; turning 50 cm; }
             model Fast extends Scout { speed (0, 7.2 km/h); mast 3; }
             model Ship { flies (20, 30); clearance 9; }
             model Round extends Round { mast 3; }",
        )
        .program()
        .world;
        let rover = *motion::vehicle_model("ATRV").expect("built in");
        let scout = rover.with_body(0.6, 0.42).with_slope(20_f64.to_radians());
        let scout = motion::VehicleModel { speed_mps: 0.8, min_speed_mps: 0.01, ..scout };
        assert_eq!(model(&world, "Scout"), Some(scout.with_turning_radius(0.5)));
        let fast = motion::VehicleModel { speed_mps: 2.0, min_speed_mps: 0.0, mast_m: 3.0, ..scout };
        assert_eq!(model(&world, "Fast"), Some(fast.with_turning_radius(0.5)));
        let ship = motion::vehicle_model("Blimp").expect("built in").with_altitude_band([20.0, 30.0]);
        assert_eq!(model(&world, "Ship"), Some(ship.with_clearance(9.0)));
        assert_eq!(model(&world, "ATRV"), Some(rover));
        assert_eq!(model(&world, "Round"), None);
        assert_eq!(model(&world, "Tank"), None);
    }
}
