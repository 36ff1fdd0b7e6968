//! Where vehicles are over time: the paths of a plan's traverses laid along the times of a schedule.
//!
//! The leader of a traverse drives its path at constant speed from the traverse's start to its end; the others follow
//! in its track, each a fixed distance behind the one before, and stop that much short of the end.

use rmpl::Rational;

use crate::snapshot::{Keyframe, VehicleMotion};

/// One traverse with times: who drives which way, from when to when.
#[derive(Clone, Debug)]
pub struct Drive {
    /// The vehicles, as indices into the program's world; the first leads.
    pub vehicles: Vec<u32>,
    /// How far behind the leader each vehicle drives, in metres; zero for the leader.
    pub behind_m: Vec<f64>,
    /// The leader's path, in metres.
    pub path_m: Vec<[f64; 2]>,
    /// Departure, in mission units.
    pub start: Rational,
    /// Arrival.
    pub end: Rational,
}

/// Times are rounded to this fraction of a unit: positions between keyframes are interpolated anyway.
const TICKS_PER_UNIT: f64 = 1000.0;

/// The motions of all vehicles that move, in the order of the vehicles.
pub fn motions(drives: &[Drive]) -> Vec<VehicleMotion> {
    let mut motions: Vec<VehicleMotion> = Vec::new();
    for drive in drives {
        for (&vehicle, &behind_m) in drive.vehicles.iter().zip(&drive.behind_m) {
            let at = motions.iter().position(|motion| motion.vehicle == vehicle).unwrap_or_else(|| {
                motions.push(VehicleMotion { vehicle, keyframes: Vec::new() });
                motions.len() - 1
            });
            let before = motions[at].keyframes.last().map(|frame| frame.position_m);
            let track = track_behind(&drive.path_m, behind_m, before);
            motions[at].keyframes.extend(keyframes(&track, drive.start, drive.end));
        }
    }
    motions.sort_by_key(|motion| motion.vehicle);
    motions
}

/// The way of a vehicle `behind_m` behind the leader: from where it is, or from behind the start, along the leader's
/// path, to `behind_m` before its end.
fn track_behind(path_m: &[[f64; 2]], behind_m: f64, before: Option<[f64; 2]>) -> Vec<[f64; 2]> {
    let (Some(&first), Some(&second)) = (path_m.first(), path_m.get(1)) else {
        return before.or(path_m.first().copied()).into_iter().collect();
    };
    if behind_m <= 0.0 {
        return path_m.to_vec();
    }
    let direction = unit(first, second);
    let start = before.unwrap_or([first[0] - direction[0] * behind_m, first[1] - direction[1] * behind_m]);
    let mut track = vec![start];
    let total: f64 = path_m.windows(2).map(|pair| distance(pair[0], pair[1])).sum();
    let mut left = total - behind_m;
    if left <= 0.0 {
        return track;
    }
    track.push(first);
    for pair in path_m.windows(2) {
        let length = distance(pair[0], pair[1]);
        if length >= left {
            let part = if length > 0.0 { left / length } else { 0.0 };
            track.push([0, 1].map(|axis| pair[0][axis] + part * (pair[1][axis] - pair[0][axis])));
            break;
        }
        track.push(pair[1]);
        left -= length;
    }
    track
}

fn keyframes(track: &[[f64; 2]], start: Rational, end: Rational) -> Vec<Keyframe> {
    let total: f64 = track.windows(2).map(|pair| distance(pair[0], pair[1])).sum();
    let mut frames = Vec::with_capacity(track.len());
    let (from, until) = (ratio(start), ratio(end));
    let mut driven = 0.0;
    for (index, &position_m) in track.iter().enumerate() {
        if index > 0 {
            driven += distance(track[index - 1], position_m);
        }
        let ahead = track.get(index + 1).copied();
        let heading_rad = match (ahead, index.checked_sub(1).map(|before| track[before])) {
            (Some(next), _) if distance(position_m, next) > 1e-9 => heading(position_m, next),
            (_, Some(before)) => heading(before, position_m),
            _ => 0.0,
        };
        let time = if index == 0 {
            start
        } else if index + 1 == track.len() || total <= 0.0 {
            end
        } else {
            let exact = from + driven / total * (until - from);
            Rational::new((exact * TICKS_PER_UNIT).round() as i64, TICKS_PER_UNIT as i64).clamp(start, end)
        };
        frames.push(Keyframe { time, position_m, heading_rad });
    }
    frames
}

fn ratio(time: Rational) -> f64 {
    *time.numer() as f64 / *time.denom() as f64
}

fn distance(from: [f64; 2], to: [f64; 2]) -> f64 {
    let (east, north) = (to[0] - from[0], to[1] - from[1]);
    (east * east + north * north).sqrt()
}

fn unit(from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    let length = distance(from, to).max(1e-12);
    [(to[0] - from[0]) / length, (to[1] - from[1]) / length]
}

fn heading(from: [f64; 2], to: [f64; 2]) -> f64 {
    libm::atan2(to[1] - from[1], to[0] - from[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive() -> Drive {
        Drive {
            vehicles: vec![0, 1],
            behind_m: vec![0.0, 2.0],
            path_m: vec![[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]],
            start: Rational::from(10),
            end: Rational::from(30),
        }
    }

    #[test]
    fn a_leader_drives_its_path_at_constant_speed() {
        let motions = motions(&[drive()]);
        assert_eq!(motions[0].at(5.0).map(|(place, _)| place), Some([0.0, 0.0]));
        assert_eq!(motions[0].at(15.0).map(|(place, _)| place), Some([5.0, 0.0]));
        assert_eq!(motions[0].at(20.0).map(|(place, _)| place), Some([10.0, 0.0]));
        assert_eq!(motions[0].at(99.0).map(|(place, _)| place), Some([10.0, 10.0]));
    }

    #[test]
    fn a_follower_keeps_behind_and_goes_on_from_where_it_stopped() {
        let mut second = drive();
        second.path_m = vec![[10.0, 10.0], [0.0, 10.0]];
        (second.start, second.end) = (Rational::from(40), Rational::from(50));
        let motions = motions(&[drive(), second]);
        let place = |time: f64| motions[1].at(time).map(|(place, _)| place);
        assert_eq!(place(0.0), Some([-2.0, 0.0]));
        assert_eq!(place(35.0), Some([10.0, 8.0]));
        assert_eq!(place(60.0), Some([2.0, 10.0]));
        let [leader, follower] =
            [motions[0].at(25.0), motions[1].at(25.0)].map(|it| it.unwrap_or_default().0);
        assert!((distance(leader, follower) - 2.0).abs() < 0.3, "{leader:?} {follower:?}");
    }
}
