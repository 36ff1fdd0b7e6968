//! Paths and separation violations as JSON, the same from the command line and from the page.

use rmpl::program::World;
use serde_json::{Value, json};
use tpn::Network;

use crate::{SeparationViolation, Traverse};

/// The traverses of a plan with the vertices of their paths and what each leg comes to.
pub fn traverses_json(traverses: &[Traverse], network: &Network, world: &World) -> Value {
    traverses.iter().map(|traverse| traverse_json(traverse, network, world)).collect()
}

fn traverse_json(traverse: &Traverse, network: &Network, world: &World) -> Value {
    let legs = traverse.legs.iter().zip(&traverse.leg_figures).map(|(leg, figures)| {
        json!({
            "to": leg.to,
            "path": leg.points_m,
            "length_m": figures.length_m,
            "min_clearance_m": figures.min_clearance_m.is_finite().then_some(figures.min_clearance_m),
            "max_slope_deg": figures.max_slope_deg,
            "duration": [figures.min_duration, figures.max_duration],
        })
    });
    let occurrence = network.occurrences.get(traverse.occurrence.index());
    json!({
        "activity": occurrence.map(|occurrence| occurrence.name.as_str()),
        "vehicles": traverse.vehicles.iter().map(|&vehicle| name(world, vehicle)).collect::<Vec<_>>(),
        "legs": legs.collect::<Vec<_>>(),
    })
}

/// Vehicles that come too near each other, with times in mission units.
pub fn separation_violations_json(violations: &[SeparationViolation], world: &World) -> Value {
    let one = |violation: &SeparationViolation| {
        json!({
            "vehicles": violation.vehicles.map(|vehicle| name(world, vehicle)),
            "since": violation.since,
            "time": violation.time,
            "position_m": violation.position_m,
            "distance_m": violation.distance_m,
            "least_m": violation.min_m,
            "in_earliest_schedule": violation.schedule.is_empty(),
        })
    };
    violations.iter().map(one).collect()
}

fn name(world: &World, vehicle: u32) -> Option<&str> {
    Some(world.vehicles.get(vehicle as usize)?.name.text.as_str())
}
