//! Contact of vehicles in a run: the discs that hold their bodies in every heading touch. That is a violation, whatever the
//! plan says (SPEC 7.4).

use exact::Time;
use executive::Contact;
use motion::TimedPoint;
use rmpl::program::Program;
use snapshot::vehicle::{flies, radius_m};
use snapshot::{Executed, SimulatedDrive, standing};
use tpn::{Network, OccurrenceId};

use super::ticks_per_unit;
use crate::traverse;

/// Two vehicles that touch in what was driven.
pub(super) struct Touching {
    pub(super) contact: Contact,
    /// When, in mission units.
    pub(super) time: f64,
    pub(super) vehicles: [u32; 2],
}

/// The first contact of any two vehicles in what was driven. A vehicle that does not drive stands where it is.
pub(super) fn first_contact(
    program: &Program,
    network: &Network,
    drives: &[SimulatedDrive],
) -> Option<Touching> {
    let (touch, pair) = first_touch(program, &tracks(program, network, drives))?;
    let under_way = drives.iter().rev().find(|drive| {
        let is_in_it = drive.vehicles.iter().any(|it| pair.contains(&it.vehicle));
        is_in_it && drive.start.to_f64() <= touch.time_s
    })?;
    let contact = contact(program, network, under_way.occurrence, (touch, pair))?;
    Some(Touching { contact, time: touch.time_s, vehicles: pair })
}

/// The first contact of any two vehicles in a run whose traverses are not driven: vehicles keep an even pace along the
/// paths of the plan that is executed at the time.
pub(crate) fn first_on_paths(program: &Program, plans: &[Executed]) -> Option<Contact> {
    let mut tracks = vec![Vec::new(); program.world.vehicles.len()];
    for (index, executed) in plans.iter().enumerate() {
        let from = executed.from.to_f64();
        let until = plans.get(index + 1).map_or(f64::INFINITY, |next| next.from.to_f64());
        for motion in &executed.motions {
            let Some(track) = tracks.get_mut(motion.vehicle as usize) else { continue };
            let at = |time_s: f64| motion.at(time_s).map(|(position_m, _)| TimedPoint { time_s, position_m });
            track.extend(at(from));
            let between =
                motion.keyframes.iter().filter(|frame| (from..until).contains(&frame.time.to_f64()));
            track
                .extend(between.map(|it| TimedPoint { time_s: it.time.to_f64(), position_m: it.position_m }));
            track.extend(at(until).filter(|_| until.is_finite()));
        }
    }
    let (touch, pair) = first_touch(program, &until_the_last(tracks))?;
    let executed = plans.iter().rev().find(|executed| executed.from.to_f64() <= touch.time_s)?;
    let routes = traverse::routes(&executed.network, program, &executed.plan, &[]).into_iter();
    let started = routes.filter_map(|route| {
        let is_in_it = route.vehicles.iter().any(|&vehicle| pair.contains(&(vehicle as u32)));
        let occurrence = executed.network.occurrences.get(route.occurrence.index())?;
        let start = executed.times.get(occurrence.start.index()).copied().flatten()?.to_f64();
        (is_in_it && start <= touch.time_s).then_some((start, route.occurrence))
    });
    let (_, under_way) = started.max_by(|(one, _), (other, _)| one.total_cmp(other))?;
    contact(program, &executed.network, under_way, (touch, pair))
}

/// When the first two vehicles touch.
fn first_touch(program: &Program, tracks: &[Vec<TimedPoint>]) -> Option<(motion::Separation, [u32; 2])> {
    let world = &program.world;
    let body = |vehicle: u32| (flies(world, vehicle), radius_m(world, vehicle));
    let tracks: Vec<_> = (0..).zip(tracks).map(|(vehicle, track)| (vehicle, track, body(vehicle))).collect();
    let mut first: Option<(motion::Separation, [u32; 2])> = None;
    for (index, (one, track, (flies, radius_m))) in tracks.iter().enumerate() {
        for (other, other_track, (other_flies, other_radius_m)) in &tracks[index + 1..] {
            if flies != other_flies {
                continue;
            }
            let approach = motion::closest_approach(track, other_track, radius_m + other_radius_m);
            let Some(touch) = approach.and_then(|approach| approach.violation) else { continue };
            if first.is_none_or(|(first, _)| touch.time_s < first.time_s) {
                first = Some((touch, [*one, *other]));
            }
        }
    }
    first
}

fn contact(
    program: &Program,
    network: &Network,
    under_way: OccurrenceId,
    (touch, pair): (motion::Separation, [u32; 2]),
) -> Option<Contact> {
    let vehicles = &program.world.vehicles;
    let name = |vehicle: u32| vehicles.get(vehicle as usize).map_or("?", |it| it.name.text.as_str());
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
    Some(Contact { at, name: network.occurrences.get(under_way.index())?.name.clone(), reason })
}

/// Returns where each vehicle is over time, in mission units.
fn tracks(program: &Program, network: &Network, drives: &[SimulatedDrive]) -> Vec<Vec<TimedPoint>> {
    let all = || drives.iter().flat_map(|drive| &drive.vehicles);
    let starts =
        standing::starts(program, &network.occurrences).into_iter().zip(0..).map(|(start, vehicle)| {
            let first = all().find(|it| it.vehicle == vehicle).and_then(|it| it.frames.first());
            let position_m = first.map_or(start?.place_m, |first| first.position_m);
            Some(TimedPoint { time_s: 0.0, position_m })
        });
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
    until_the_last(tracks)
}

/// Tracks that all end when the last one does: a vehicle that has arrived stands there.
fn until_the_last(mut tracks: Vec<Vec<TimedPoint>>) -> Vec<Vec<TimedPoint>> {
    let end = tracks.iter().filter_map(|track| track.last()).map(|last| last.time_s).fold(0.0, f64::max);
    for track in &mut tracks {
        track.extend(track.last().map(|last| TimedPoint { time_s: end, ..*last }));
    }
    tracks
}
