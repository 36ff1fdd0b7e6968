//! Contact of vehicles in a run: the discs that hold their bodies in every heading touch. That is a violation, whatever the
//! plan says (SPEC 7.4).

use exact::Time;
use executive::Contact;
use motion::TimedPoint;
use nalgebra::Point2;
use rmpl::program::Program;
use snapshot::vehicle::{flies, radius_m};
use snapshot::{SimulatedDrive, standing};
use tpn::Network;

use super::ticks_per_unit;

/// The first contact of any two vehicles in what was driven. A vehicle that does not drive stands where it is.
pub(super) fn first_contact(
    program: &Program,
    network: &Network,
    drives: &[SimulatedDrive],
) -> Option<Contact> {
    let world = &program.world;
    let tracks = tracks(program, drives);
    let mut first: Option<(motion::Separation, [u32; 2])> = None;
    for (index, one) in tracks.iter().enumerate() {
        for (other_index, other) in tracks.iter().enumerate().skip(index + 1) {
            let pair = [index as u32, other_index as u32];
            if flies(world, pair[0]) != flies(world, pair[1]) {
                continue;
            }
            let reach_m = radius_m(world, pair[0]) + radius_m(world, pair[1]);
            let touch = motion::closest_approach(one, other, reach_m).and_then(|approach| approach.violation);
            let Some(touch) = touch else { continue };
            if first.is_none_or(|(first, _)| touch.time_s < first.time_s) {
                first = Some((touch, pair));
            }
        }
    }
    let (touch, pair) = first?;
    let name = |vehicle: u32| world.vehicles.get(vehicle as usize).map_or("?", |it| it.name.text.as_str());
    let under_way = drives.iter().rev().find(|drive| {
        let is_in_it = drive.vehicles.iter().any(|it| pair.contains(&it.vehicle));
        is_in_it && drive.start.to_f64() <= touch.time_s
    })?;
    let place = nalgebra::center(&touch.positions_m[0], &touch.positions_m[1]);
    let at = Time::from_f64_nearest(touch.time_s, ticks_per_unit(program))?;
    let reason = format!(
        "{} and {} touch near ({:.1}, {:.1}) at {:.2}: their centers are {:.2} m apart, and their bodies reach that far",
        name(pair[0]),
        name(pair[1]),
        place.x,
        place.y,
        touch.time_s,
        touch.distance_m
    );
    Some(Contact { at, name: network.occurrences.get(under_way.occurrence.index())?.name.clone(), reason })
}

/// Where each vehicle is over time, in mission units.
fn tracks(program: &Program, drives: &[SimulatedDrive]) -> Vec<Vec<TimedPoint>> {
    let start = |place: Option<Point2<f64>>| place.map(|position_m| TimedPoint { time_s: 0.0, position_m });
    let starts = standing::own_starts_m(program).into_iter().map(start);
    let mut tracks: Vec<Vec<TimedPoint>> = starts.map(|start| start.into_iter().collect()).collect();
    for drive in drives {
        for vehicle in &drive.vehicles {
            let Some(track) = tracks.get_mut(vehicle.vehicle as usize) else { continue };
            let Some(first) = vehicle.frames.first() else { continue };
            track.extend(track.last().map(|last| TimedPoint { time_s: first.time, ..*last }));
            let frames = vehicle.frames.iter();
            track.extend(frames.map(|it| TimedPoint { time_s: it.time, position_m: it.position_m }));
        }
    }
    let end = tracks.iter().filter_map(|track| track.last()).map(|last| last.time_s).fold(0.0, f64::max);
    for track in &mut tracks {
        track.extend(track.last().map(|last| TimedPoint { time_s: end, ..*last }));
    }
    tracks
}
