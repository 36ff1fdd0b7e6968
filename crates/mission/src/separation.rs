//! Separation violations: vehicles of different traverses that come too near each other, with time and place.

use motion::TimedPoint;
use rmpl::Diagnostic;
use rmpl::program::World;
use snapshot::vehicle::{GAP_M, flies, radius_m};
use snapshot::{SeparationViolation, VehicleMotion};
use tpn::Network;

use crate::driving::Drive;

/// Vehicles that don't drive together and come nearer than the sum of their radii and [`GAP_M`], at the earliest
/// schedule. A vehicle that has not begun to move or has stopped is where it is.
pub fn violations(drives: &[Drive], motions: &[VehicleMotion], world: &World) -> Vec<SeparationViolation> {
    let together = |a: u32, b: u32| {
        drives.iter().any(|drive| drive.vehicles.contains(&a) && drive.vehicles.contains(&b))
    };
    let last = drives.iter().map(|drive| drive.end.to_f64()).fold(0.0, f64::max);
    let tracks: Vec<Vec<TimedPoint>> = motions.iter().map(|motion| track(motion, last)).collect();
    let mut found = Vec::new();
    for (index, (first, first_track)) in motions.iter().zip(&tracks).enumerate() {
        for (second, second_track) in motions.iter().zip(&tracks).skip(index + 1) {
            let [one, other] = [first.vehicle, second.vehicle];
            if together(one, other) || flies(world, one) != flies(world, other) {
                continue;
            }
            let safety_m = radius_m(world, first.vehicle) + radius_m(world, second.vehicle) + GAP_M;
            let Some(near) = motion::closest_approach(first_track, second_track, safety_m) else { continue };
            let Some(violation) = near.violation else { continue };
            let [a, b] = near.closest.positions_m;
            found.push(SeparationViolation {
                vehicles: [first.vehicle, second.vehicle],
                since: violation.time_s,
                time: near.closest.time_s,
                position_m: nalgebra::center(&a, &b),
                distance_m: near.closest.distance_m,
            });
        }
    }
    found
}

/// Tells the author, at the traverse of the second vehicle.
pub fn warnings(
    violations: &[SeparationViolation],
    drives: &[Drive],
    network: &Network,
    world: &World,
) -> Vec<Diagnostic> {
    let name = |vehicle: u32| world.vehicles.get(vehicle as usize).map_or("?", |it| it.name.text.as_str());
    violations
        .iter()
        .filter_map(|violation| {
            let [first, second] = violation.vehicles;
            let under_way = |drive: &&Drive| {
                drive.vehicles.contains(&second) && drive.start.to_f64() <= violation.time
            };
            let own = |drive: &&Drive| drive.vehicles.contains(&second);
            let others = |drive: &&Drive| drive.vehicles.contains(&first);
            let drive = drives.iter().rev().find(under_way);
            let drive = drive.or_else(|| drives.iter().find(own)).or_else(|| drives.iter().find(others))?;
            let span = network.occurrences.get(drive.occurrence.index())?.span?;
            let place = violation.position_m;
            let message = format!(
                "{} and {} come within {:.1} m of each other near ({:.0}, {:.0}) at {:.1}, in the plan's \
                 earliest schedule",
                name(first),
                name(second),
                violation.distance_m,
                place.x,
                place.y,
                violation.time
            );
            Some(Diagnostic::warning(SeparationViolation::CODE, span, message).with_hint(
                "give one of them time to wait or to go around the other; vehicles of one traverse keep formation",
            ))
        })
        .collect()
}

/// The positions of a vehicle from the mission's start till all have stopped.
fn track(motion: &VehicleMotion, last: f64) -> Vec<TimedPoint> {
    let frames = motion.keyframes.iter();
    let mut points: Vec<TimedPoint> = frames
        .map(|frame| TimedPoint { time_s: frame.time.to_f64(), position_m: frame.position_m })
        .collect();
    if let (Some(&first), Some(&end)) = (points.first(), points.last()) {
        points.insert(0, TimedPoint { time_s: 0.0, ..first });
        points.push(TimedPoint { time_s: last.max(end.time_s), ..end });
    }
    points
}
