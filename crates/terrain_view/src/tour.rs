//! The camera that tours a run: it goes to the vehicle that has set out last, follows it and turns around it slowly, and
//! shows the whole map when nothing moves.

use std::f32::consts::PI;

use snapshot::VehicleMotion;

/// What the camera is on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shot {
    /// The whole map.
    #[default]
    Map,
    /// A vehicle, as an index into the program's world.
    Vehicle(usize),
}

/// The camera stays at a vehicle that stops for at most this share of the run.
const SHORT_STOP: f64 = 0.02;

/// Returns what the camera is on at `time` of a plan or run that ends at `end`.
pub fn shot(motions: &[VehicleMotion], time: f64, end: f64) -> Shot {
    let bridged = end * SHORT_STOP;
    let under_way = motions.iter().filter_map(|motion| {
        let drive = drives(motion, bridged).into_iter().find(|[from, to]| (*from..*to).contains(&time))?;
        Some((drive[0], motion.vehicle as usize))
    });
    let last = under_way.max_by(|left, right| left.0.total_cmp(&right.0).then(right.1.cmp(&left.1)));
    last.map_or(Shot::Map, |(_, vehicle)| Shot::Vehicle(vehicle))
}

/// Returns how far the camera has turned around what it is on at `time`: half way around in the whole run.
pub fn turn_rad(time: f64, end: f64) -> f32 {
    if end > 0.0 { (time / end) as f32 * PI } else { 0.0 }
}

/// From when to when a vehicle moves; stops of at most `bridged` belong to a drive.
fn drives(motion: &VehicleMotion, bridged: f64) -> Vec<[f64; 2]> {
    let mut found: Vec<[f64; 2]> = Vec::new();
    for pair in motion.keyframes.windows(2) {
        let [from, to] = [&pair[0], &pair[1]].map(|frame| frame.time.to_f64());
        let has_moved = (pair[1].position_m - pair[0].position_m).norm() > 1e-6;
        if !has_moved || to <= from {
            continue;
        }
        match found.last_mut() {
            Some(last) if from - last[1] <= bridged => last[1] = to,
            _ => found.push([from, to]),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use snapshot::Keyframe;

    use super::*;

    fn motion(vehicle: u32, places: &[(i64, f64)]) -> VehicleMotion {
        let frame = |&(time, east): &(i64, f64)| Keyframe {
            time: exact::Time::from(time),
            position_m: [east, 0.0].into(),
            heading_rad: 0.0,
        };
        VehicleMotion { vehicle, keyframes: places.iter().map(frame).collect() }
    }

    #[test]
    fn the_camera_is_on_the_vehicle_that_has_set_out_last_and_on_the_map_between_drives() {
        let rover = motion(0, &[(0, 0.0), (10, 0.0), (30, 50.0), (31, 50.0), (60, 90.0), (100, 90.0)]);
        let drone = motion(1, &[(0, 5.0), (20, 5.0), (25, 80.0), (100, 80.0)]);
        let motions = [rover, drone];
        let at = |time| shot(&motions, time, 100.0);
        assert_eq!([at(5.0), at(15.0), at(22.0)], [Shot::Map, Shot::Vehicle(0), Shot::Vehicle(1)]);
        assert_eq!([at(28.0), at(30.5), at(70.0)], [Shot::Vehicle(0), Shot::Vehicle(0), Shot::Map]);
    }
}
