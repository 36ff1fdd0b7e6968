//! Where vehicles are over time: the paths of a plan's traverses laid along the times of a schedule.
//!
//! The leader of a traverse drives its path at constant speed from the traverse's start to its end; the others keep
//! formation behind it. When the same vehicles drive on, their formation continues along the path before.

use std::collections::BTreeMap;
use std::sync::Arc;

use exact::Time;
use motion::{Formation, Path};
use nalgebra::{Point2, distance};
use snapshot::standing::Start;
use snapshot::{Keyframe, VehicleMotion};
use terrain::ConfigurationSpace;
use tpn::OccurrenceId;

/// One traverse with times: who drives which way, from when to when.
#[derive(Clone, Debug)]
pub struct Drive {
    pub occurrence: OccurrenceId,
    /// The vehicles, as indices into the program's world; the first leads.
    pub vehicles: Vec<u32>,
    /// Meters between the centers of two of them, at least.
    pub spacing_m: f64,
    /// Where they can be.
    pub space: Arc<ConfigurationSpace>,
    /// The leader's path.
    pub path: Path,
    /// Departure, in mission units.
    pub start: Time,
    /// Time of arrival.
    pub end: Time,
}

/// Times are rounded to this fraction of a unit: positions between keyframes are interpolated anyway.
const PARTS_PER_UNIT: u32 = 1000;
/// A vehicle sets out for a traverse from where it stands, if that is at most this far from where its way starts, in meters.
const SETS_OUT_WITHIN_M: f64 = 20.0;
/// Followers are placed this often along the leader's path, in meters.
const FOLLOWER_STEP_M: f64 = 0.4;
/// A place is left out where driving evenly past it comes this near to it, in meters.
pub(crate) const EVEN_M: f64 = 0.02;

/// The ways of the vehicles of each drive, the leader's first: a formation goes on from where the drive before it stopped.
pub(crate) fn all_tracks(drives: &[Drive]) -> Vec<Vec<Vec<Place>>> {
    drives.iter().enumerate().map(|(index, drive)| tracks(drive, &drives[..index])).collect()
}

/// The motions of all vehicles that move, in the order of the vehicles, by [`all_tracks`] of the drives. `starts` says where each
/// vehicle is at first.
pub(crate) fn motions(
    drives: &[Drive],
    all_tracks: &[Vec<Vec<Place>>],
    starts: &[Option<Start>],
) -> Vec<VehicleMotion> {
    let mut motions: BTreeMap<u32, Vec<Keyframe>> = BTreeMap::new();
    for (drive, tracks) in drives.iter().zip(all_tracks) {
        for (index, (vehicle, track)) in drive.vehicles.iter().zip(tracks).enumerate() {
            let Some(first) = track.first() else { continue };
            let start = starts.get(*vehicle as usize).copied().flatten();
            let frames = motions.entry(*vehicle).or_default();
            let place_m = frames
                .last()
                .map_or_else(|| place_before(drive, index, first.position_m, start), |last| last.position_m);
            // A vehicle that comes from elsewhere joins the formation on the way.
            let from = Some(place_m).filter(|place_m| distance(place_m, &first.position_m) > EVEN_M);
            frames.extend(keyframes(track, from, drive.start, drive.end));
        }
    }
    motions.into_iter().map(|(vehicle, keyframes)| VehicleMotion { vehicle, keyframes }).collect()
}

/// Returns how far from the start of its way a vehicle may be when a traverse starts, in meters: followers find their
/// places.
pub(crate) fn sets_out_within_m(drive: &Drive, index: usize) -> f64 {
    SETS_OUT_WITHIN_M + index as f64 * drive.spacing_m
}

/// Returns where a vehicle is before its first drive: in its place of that drive's formation, unless it starts too far
/// from there.
pub(crate) fn place_before(
    drive: &Drive,
    index: usize,
    in_formation_m: Point2<f64>,
    start: Option<Start>,
) -> Point2<f64> {
    let away =
        start.filter(|start| distance(&start.place_m, &in_formation_m) > sets_out_within_m(drive, index));
    away.map_or(in_formation_m, |start| start.place_m)
}

/// A place on the way of a vehicle, and which share of its time has then gone by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) share: f64,
    pub(crate) position_m: Point2<f64>,
}

/// The ways of the vehicles of a drive by itself as paths, the leader's first.
pub(crate) fn tracks_m(drive: &Drive) -> Vec<Path> {
    let path = |track: Vec<Place>| {
        let mut points: Vec<Point2<f64>> = track.iter().map(|place| place.position_m).collect();
        points.dedup();
        Path::new(points)
    };
    tracks(drive, &[]).into_iter().map(path).collect()
}

/// The ways of the vehicles of a drive, the leader's first; `before` are the drives that came before it.
fn tracks(drive: &Drive, before: &[Drive]) -> Vec<Vec<Place>> {
    let length_m = drive.path.length_m();
    let share = |way_m: f64| if length_m > 0.0 { way_m / length_m } else { 1.0 };
    let mut leader = Vec::with_capacity(drive.path.points_m.len());
    let mut way_m = 0.0;
    for (index, &position_m) in drive.path.points_m.iter().enumerate() {
        if index > 0 {
            way_m += distance(&drive.path.points_m[index - 1], &position_m);
        }
        leader.push(Place { share: share(way_m), position_m });
    }
    let mut tracks = vec![leader];
    let followers = drive.vehicles.len() as u32 - 1;
    if followers == 0 {
        return tracks;
    }
    tracks.resize(drive.vehicles.len(), Vec::new());
    let (path, driven_m) = prolonged_back(drive, before);
    let formation = Formation { spacing_m: drive.spacing_m };
    let steps = (length_m / FOLLOWER_STEP_M).ceil().max(1.0) as u32;
    for step in 0..=steps {
        let part = f64::from(step) / f64::from(steps);
        let places = formation.positions_m(&drive.space, &path, driven_m + part * length_m, followers);
        for (track, &position_m) in tracks.iter_mut().zip(&places).skip(1) {
            track.push(Place { share: part, position_m });
        }
    }
    for track in tracks.iter_mut().skip(1) {
        *track = even_stretches(track);
    }
    tracks
}

/// The path with what the same vehicles drove directly before it, and how long that was in meters: the formation
/// continues from where it stopped.
fn prolonged_back(drive: &Drive, before: &[Drive]) -> (Path, f64) {
    let mut points: Vec<Point2<f64>> = drive.path.points_m.clone();
    let mut driven_m = 0.0;
    for earlier in before.iter().rev() {
        let ends_here = earlier.path.points_m.last() == points.first();
        if earlier.vehicles != drive.vehicles || !ends_here {
            let is_other_group = !earlier.vehicles.iter().any(|vehicle| drive.vehicles.contains(vehicle));
            if is_other_group {
                continue;
            }
            break;
        }
        driven_m += earlier.path.length_m();
        let mut longer = earlier.path.points_m.clone();
        longer.extend(points.iter().skip(1));
        points = longer;
    }
    (Path::new(points), driven_m)
}

/// The same way with fewer places: none that an even drive between its neighbors passes.
fn even_stretches(track: &[Place]) -> Vec<Place> {
    const LONGEST: usize = 64;
    let mut kept: Vec<Place> = track.first().copied().into_iter().collect();
    let mut from = 0;
    while from + 1 < track.len() {
        let is_even = |to: usize| {
            let (a, b) = (track[from], track[to]);
            track[from + 1..to].iter().all(|place| {
                let part = (place.share - a.share) / (b.share - a.share);
                distance(&mix(a.position_m, b.position_m, part), &place.position_m) <= EVEN_M
            })
        };
        let farthest = (from + LONGEST).min(track.len() - 1);
        let to = (from + 2..=farthest).take_while(|&to| is_even(to)).last().unwrap_or(from + 1);
        kept.push(track[to]);
        from = to;
    }
    kept
}

/// The share of a drive in which a vehicle that comes from elsewhere joins the others.
const JOINING: f64 = 0.1;

/// The way of a vehicle that joins the others from elsewhere.
pub(crate) fn joined_from(track: &[Place], position_m: Point2<f64>) -> Vec<Place> {
    let start = Place { share: 0.0, position_m };
    std::iter::once(start).chain(track.iter().copied().filter(|place| place.share >= JOINING)).collect()
}

fn keyframes(track: &[Place], from: Option<Point2<f64>>, start: Time, end: Time) -> Vec<Keyframe> {
    let places = from.map_or_else(|| track.to_vec(), |position_m| joined_from(track, position_m));
    let (begin, length) = (start.to_f64(), end.to_f64() - start.to_f64());
    let mut heading_rad = 0.0;
    let mut frames = Vec::with_capacity(places.len());
    for (index, place) in places.iter().enumerate() {
        let next = places[index + 1..].iter().find(|next| is_apart(place, next));
        let before = places[..index].iter().rev().find(|before| is_apart(before, place));
        heading_rad = match (next, before) {
            (Some(next), _) => heading(place.position_m, next.position_m),
            (None, Some(before)) => heading(before.position_m, place.position_m),
            (None, None) => heading_rad,
        };
        let time = if index == 0 {
            start
        } else if index + 1 == places.len() {
            end
        } else {
            let exact = begin + place.share * length;
            Time::from_f64_nearest(exact, PARTS_PER_UNIT).unwrap_or(start).clamp(start, end)
        };
        frames.push(Keyframe { time, position_m: place.position_m, heading_rad });
    }
    frames
}

/// Returns whether two places are so far apart that the way between them shows a heading.
fn is_apart(a: &Place, b: &Place) -> bool {
    distance(&a.position_m, &b.position_m) > 1e-3
}

fn mix(from: Point2<f64>, to: Point2<f64>, part: f64) -> Point2<f64> {
    from + (to - from) * part
}

fn heading(from: Point2<f64>, to: Point2<f64>) -> f64 {
    let ahead = to - from;
    libm::atan2(ahead.y, ahead.x)
}

#[cfg(test)]
mod tests {
    use terrain::{GridFrame, Occupancy};

    use super::*;

    const SPACING_M: f64 = 2.0;

    fn drive(points_m: Vec<Point2<f64>>, times: [i64; 2]) -> Drive {
        let frame =
            GridFrame { width: 100, height: 100, cell_size_m: 0.6, origin_m: Point2::new(-20.0, -20.0) };
        Drive {
            occurrence: OccurrenceId::from_index(0),
            vehicles: vec![0, 1],
            spacing_m: SPACING_M,
            space: Arc::new(ConfigurationSpace::new(Occupancy::free(frame), 0.7)),
            path: Path::new(points_m),
            start: times[0].into(),
            end: times[1].into(),
        }
    }

    fn motions_of(drives: &[Drive]) -> Vec<VehicleMotion> {
        motions(drives, &all_tracks(drives), &[])
    }

    fn first() -> Drive {
        drive([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]].map(Point2::from).to_vec(), [10, 30])
    }

    #[test]
    fn a_leader_drives_its_path_at_constant_speed() {
        let motions = motions_of(&[first()]);
        assert_eq!(motions[0].at(5.0).map(|(place, _)| place), Some(Point2::new(0.0, 0.0)));
        assert_eq!(motions[0].at(15.0).map(|(place, _)| place), Some(Point2::new(5.0, 0.0)));
        assert_eq!(motions[0].at(20.0).map(|(place, _)| place), Some(Point2::new(10.0, 0.0)));
        assert_eq!(motions[0].at(99.0).map(|(place, _)| place), Some(Point2::new(10.0, 10.0)));
    }

    #[test]
    fn a_follower_never_comes_nearer_than_its_spacing_and_goes_on_from_where_it_stopped() {
        let second = drive([[10.0, 10.0], [0.0, 10.0]].map(Point2::from).to_vec(), [40, 50]);
        let motions = motions_of(&[first(), second]);
        let place = |vehicle: usize, time: f64| motions[vehicle].at(time).expect("it moves").0;
        for tenth in 0..600 {
            let time = f64::from(tenth) / 10.0;
            let apart = distance(&place(0, time), &place(1, time));
            assert!(apart >= SPACING_M - 2.0 * EVEN_M, "{apart} m apart at {time}");
            assert!(apart <= 3.0 * SPACING_M, "{apart} m apart at {time}");
        }
        assert_eq!(place(1, 30.0), place(1, 40.0));
        let moved = distance(&place(1, 39.9), &place(1, 40.1));
        assert!(moved < 0.5, "it jumps by {moved} m");
    }
}
