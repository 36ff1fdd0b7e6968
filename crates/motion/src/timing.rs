//! How long the pieces of a path take (SPEC 7.3).

use nalgebra::{Point2, distance};
use serde::{Deserialize, Serialize};
use terrain::Terrain;

use crate::path::Path;
use crate::trajectory::{DriveLimits, heading_difference};
use crate::vehicle::{Drive, VehicleModel};

/// The least and the greatest speed of a traverse in meters per second.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpeedLimits {
    /// 0 when the vehicle may stop: a segment then has no greatest duration.
    pub min_mps: f64,
    /// Must be positive.
    pub max_mps: f64,
}

/// What one segment of a path takes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SegmentTiming {
    /// Length in the plane in meters.
    pub plan_length_m: f64,
    /// Length over the ground in meters, or through the air for a vehicle that flies.
    pub ground_length_m: f64,
    /// Meters up for each meter forward from the segment's start to its end.
    pub grade: f64,
    /// The mean speed in meters per second at which the vehicle is there soonest, where slopes or its own limits keep it
    /// below the greatest speed; none where they do not.
    pub slope_speed_mps: Option<f64>,
    /// Least duration in milliseconds, rounded up.
    pub min_millis: u64,
    /// Greatest duration in milliseconds, rounded up and never below the least; none when the vehicle may stop.
    pub max_millis: Option<u64>,
}

/// The time in milliseconds for a length at a speed, rounded up. A millionth of a millisecond of rounding in the
/// division is not taken for another millisecond. `None` when it would never end.
pub fn duration_millis(length_m: f64, speed_mps: f64) -> Option<u64> {
    let millis = 1000.0 * length_m / speed_mps;
    // Beyond this a double no longer counts single milliseconds.
    (millis.is_finite() && millis < 9e15).then(|| (millis - 1e-6).ceil().max(0.0) as u64)
}

/// Least and greatest durations of the segments of a path: its length over the ground by the greatest and the least
/// speed. Where a slope does not let the vehicle reach the greatest speed, its speed on that slope counts.
pub fn time_path(
    path: &Path,
    terrain: &Terrain,
    model: &VehicleModel,
    speeds: SpeedLimits,
) -> Vec<SegmentTiming> {
    path.segments().map(|(from, to)| time_segment(from, to, terrain, model, speeds)).collect()
}

/// Returns what the segments of a path take where the vehicle holds its limits: it turns to face each on the spot and
/// drives it from rest to rest, as [`drive_path`](crate::drive_path) does, so that turning, speeding up and slowing
/// down count. `before` is how it faces at first, in radians; where that is not known, it may be the wrong way.
pub fn time_path_within(
    path: &Path,
    terrain: &Terrain,
    model: &VehicleModel,
    speeds: SpeedLimits,
    (limits, before): (&DriveLimits, Option<f64>),
) -> Vec<SegmentTiming> {
    let mut heading = before;
    let segments = path.segments().zip(time_path(path, terrain, model, speeds));
    segments
        .map(|((from, to), timing)| {
            let ahead = to - from;
            let next = libm::atan2(ahead.y, ahead.x);
            let turn = heading.map_or(std::f64::consts::PI, |heading| heading_difference(heading, next));
            heading = Some(next);
            let fastest = timing.slope_speed_mps.unwrap_or(speeds.max_mps);
            let seconds = limits.turn_s(turn) + limits.straight_s(timing.ground_length_m, fastest);
            if seconds <= 0.0 {
                return timing;
            }
            let mean_mps = timing.ground_length_m / seconds;
            let min_millis = duration_millis(timing.ground_length_m, mean_mps).unwrap_or(u64::MAX);
            let max_millis = timing.max_millis.map(|greatest| greatest.max(min_millis));
            SegmentTiming { slope_speed_mps: Some(mean_mps), min_millis, max_millis, ..timing }
        })
        .collect()
}

fn time_segment(
    from_m: Point2<f64>,
    to_m: Point2<f64>,
    terrain: &Terrain,
    model: &VehicleModel,
    speeds: SpeedLimits,
) -> SegmentTiming {
    let plan_length_m = distance(&from_m, &to_m);
    let mut ground_length_m = plan_length_m;
    let mut grade = 0.0;
    let mut slowest = speeds.max_mps;
    if let Drive::SkidSteer { .. } = model.drive {
        // The time of a segment is the sum over pieces of different slope; an equal speed over the whole length gives
        // the same sum.
        let mut seconds = 0.0;
        let mut is_limited = false;
        ground_length_m = 0.0;
        let ground = terrain.drape(from_m, to_m);
        for pair in ground.windows(2) {
            let ahead = distance(&pair[0].xy(), &pair[1].xy());
            let up = pair[1].z - pair[0].z;
            let length = (ahead * ahead + up * up).sqrt();
            let limit = if ahead > 0.0 { model.speed_on_grade_mps(up / ahead) } else { model.speed_mps };
            ground_length_m += length;
            is_limited |= limit < speeds.max_mps;
            seconds += length / limit.min(speeds.max_mps);
        }
        if seconds > 0.0 && is_limited {
            slowest = ground_length_m / seconds;
        }
        if let (Some(first), Some(last)) = (ground.first(), ground.last())
            && plan_length_m > 0.0
        {
            grade = (last.z - first.z) / plan_length_m;
        }
    }
    let slope_speed_mps = (slowest < speeds.max_mps).then_some(slowest);
    let min_millis = duration_millis(ground_length_m, slowest).unwrap_or(u64::MAX);
    let max_millis =
        duration_millis(ground_length_m, speeds.min_mps).map(|greatest| greatest.max(min_millis));
    SegmentTiming { plan_length_m, ground_length_m, grade, slope_speed_mps, min_millis, max_millis }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicle::vehicle_model;
    use terrain::GridFrame;

    #[test]
    fn the_legs_of_the_papers_example_take_405_to_450_minutes() {
        // SPEC 7.3: legs of 300, 500 and 415 m at 0.045 to 0.05 m/s.
        let terrain = Terrain::flat(GridFrame::new(2200, 4, 0.6));
        let path = Path::new([0.0, 300.0, 800.0, 1215.0].map(|east| Point2::new(east, 1.0)).to_vec());
        let speeds = SpeedLimits { min_mps: 0.045, max_mps: 0.05 };
        let timings = time_path(&path, &terrain, vehicle_model("ATRV").unwrap(), speeds);
        let least: Vec<u64> = timings.iter().map(|timing| timing.min_millis).collect();
        assert_eq!(least, [6_000_000, 10_000_000, 8_300_000]);
        let greatest: Vec<u64> = timings.iter().map(|timing| timing.max_millis.unwrap()).collect();
        // 111.11…, 185.185… and 153.703… minutes, rounded up to the millisecond.
        assert_eq!(greatest, [6_666_667, 11_111_112, 9_222_223]);
        assert_eq!(least.iter().sum::<u64>(), 405 * 60_000);
    }

    #[test]
    fn a_vehicle_that_may_stop_has_no_greatest_duration() {
        let terrain = Terrain::flat(GridFrame::new(10, 10, 1.0));
        let path = Path::new(vec![Point2::new(1.0, 1.0), Point2::new(5.0, 1.0)]);
        let speeds = SpeedLimits { min_mps: 0.0, max_mps: 0.8 };
        let timing = time_path(&path, &terrain, vehicle_model("ATRV").unwrap(), speeds)[0];
        assert_eq!((timing.min_millis, timing.max_millis), (5000, None));
    }

    #[test]
    fn a_slope_makes_the_way_longer_and_slower() {
        let frame = GridFrame::new(40, 10, 1.0);
        let heights = (0..400).map(|index| 0.2 * (index % 40) as f32).collect();
        let terrain = Terrain::new(frame, heights);
        let path = Path::new(vec![Point2::new(5.0, 5.0), Point2::new(25.0, 5.0)]);
        let model = vehicle_model("ATRV").unwrap();
        let timing = |max_mps| time_path(&path, &terrain, model, SpeedLimits { min_mps: 0.1, max_mps })[0];
        let length = 20.0 * 1.04_f64.sqrt();
        assert!((timing(0.2).ground_length_m - length).abs() < 1e-4);
        assert!((timing(0.2).grade - 0.2).abs() < 1e-5);
        assert_eq!(timing(0.2).min_millis, (length / 0.2 * 1000.0).ceil() as u64);
        // 0.8 m/s is out of reach at a grade of 0.2 of at most 0.364.
        let reachable = model.speed_on_grade_mps(0.2);
        let expected = (length / reachable * 1000.0).ceil();
        assert!((timing(0.8).min_millis as f64 - expected).abs() <= 1.0);
        assert!((timing(0.8).slope_speed_mps.unwrap() - reachable).abs() < 1e-6);
        assert_eq!(timing(0.2).slope_speed_mps, None);
    }
}
