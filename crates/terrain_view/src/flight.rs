//! A flight of the camera from one view to another: it starts and ends gently, and climbs when the way is long.

use std::f32::consts::{PI, TAU};

use crate::camera::Camera;

/// A flight under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    from: Camera,
    to: Camera,
    begun_secs: f64,
    duration_secs: f64,
}

impl Flight {
    /// A flight that begins now.
    pub fn new(from: Camera, to: Camera, now_secs: f64) -> Self {
        let way = from.target_m.distance(to.target_m) / from.distance_m.min(to.distance_m).max(1.0);
        let turns = (from.distance_m / to.distance_m).ln().abs();
        let duration_secs = f64::from(0.35 + 0.12 * way.min(4.0) + 0.12 * turns.min(3.0));
        Self { from, to, begun_secs: now_secs, duration_secs }
    }

    /// The view at a time, and whether the flight is over.
    pub fn at(&self, now_secs: f64) -> (Camera, bool) {
        let part = ((now_secs - self.begun_secs) / self.duration_secs).clamp(0.0, 1.0) as f32;
        let eased = part * part * (3.0 - 2.0 * part);
        let mix = |from: f32, to: f32| from + (to - from) * eased;
        let way_m = self.from.target_m.distance(self.to.target_m);
        let lowest_m = self.from.distance_m.min(self.to.distance_m);
        // High enough in the middle to see where it goes.
        let climb = (1.0 + 0.35 * way_m / lowest_m.max(1.0)).ln() * 4.0 * eased * (1.0 - eased) * 0.5;
        let camera = Camera {
            target_m: self.from.target_m.lerp(self.to.target_m, eased),
            yaw_rad: self.from.yaw_rad + turn(self.from.yaw_rad, self.to.yaw_rad) * eased,
            pitch_rad: mix(self.from.pitch_rad, self.to.pitch_rad),
            distance_m: (mix(self.from.distance_m.ln(), self.to.distance_m.ln()) + climb).exp(),
        };
        if part >= 1.0 { (self.to, true) } else { (camera, false) }
    }

    /// The same flight to a target that moves.
    pub fn toward(self, target_m: glam::Vec3) -> Self {
        Self { to: Camera { target_m, ..self.to }, ..self }
    }
}

/// The shorter turn from one direction to another.
fn turn(from_rad: f32, to_rad: f32) -> f32 {
    (to_rad - from_rad + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn a_flight_begins_and_ends_where_it_should_and_turns_the_short_way() {
        let from = Camera { yaw_rad: 3.0, ..Camera::overview(Vec3::ZERO, 300.0) };
        let to =
            Camera { target_m: Vec3::new(90.0, 40.0, 2.0), yaw_rad: -3.0, pitch_rad: 0.5, distance_m: 30.0 };
        let flight = Flight::new(from, to, 10.0);
        assert!((flight.at(10.0).0.distance_m - from.distance_m).abs() < 0.01);
        assert_eq!(flight.at(99.0), (to, true));
        let (middle, is_over) = flight.at(10.3);
        assert!(!is_over && (3.0..3.3).contains(&middle.yaw_rad), "{}", middle.yaw_rad);
    }

    #[test]
    fn a_long_flight_climbs_on_the_way() {
        let near = |east: f32| Camera::overview(Vec3::new(east, 0.0, 0.0), 10.0);
        let flight = Flight::new(near(0.0), near(500.0), 0.0);
        let highest = (0..40).map(|step| flight.at(f64::from(step) * 0.05).0.distance_m).fold(0.0, f32::max);
        assert!(highest > 2.0 * near(0.0).distance_m, "{highest}");
    }
}
