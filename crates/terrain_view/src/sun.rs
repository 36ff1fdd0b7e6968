//! Where the sun is, and how much light there is: as set, or by the time of day of the mission's clock.

use std::f32::consts::FRAC_PI_2;
use std::f64::consts::TAU;

use glam::Vec3;

/// The light that the ground is drawn in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Toward the sun, a unit vector, at least a little above the horizon.
    pub toward: Vec3,
    /// From 0 in the night to 1 by day.
    pub daylight: f32,
}

/// The latitude of a mission's ground, which no map tells: the sun culminates in the south.
const LATITUDE_RAD: f64 = 0.6;
const DAY_SECS: f64 = 86_400.0;
/// Lower suns throw shadows too long to be of use.
const MIN_HEIGHT_RAD: f32 = 0.06;
/// How fast the light rises from the horizon to the sky above while the sun sinks below it.
const DUSK: f32 = 6.0;

impl Sun {
    /// The sun in a direction, clockwise from north, at a height over the horizon, both in degrees.
    pub fn fixed(azimuth_deg: f32, height_deg: f32) -> Self {
        let height_rad = height_deg.to_radians().max(MIN_HEIGHT_RAD);
        let (east, north) = azimuth_deg.to_radians().sin_cos();
        let flat = height_rad.cos();
        Self { toward: Vec3::new(east * flat, north * flat, height_rad.sin()), daylight: 1.0 }
    }

    /// The sun at so many seconds after midnight, on a day as long as its night. Below the horizon, what light there is
    /// comes from the sky above.
    pub fn at_time_of_day(secs: f64) -> Self {
        let (sin, cos) = ((secs / DAY_SECS - 0.5) * TAU).sin_cos();
        let [east, north, up] =
            [-sin, -cos * LATITUDE_RAD.sin(), cos * LATITUDE_RAD.cos()].map(|it| it as f32);
        let height_rad = up.clamp(-1.0, 1.0).asin();
        let daylight = ((height_rad + 0.08) / 0.24).clamp(0.0, 1.0);
        let light_rad = height_rad.max(MIN_HEIGHT_RAD + DUSK * (MIN_HEIGHT_RAD - height_rad)).min(FRAC_PI_2);
        Self { daylight, ..Self::fixed(east.atan2(north).to_degrees(), light_rad.to_degrees()) }
    }

    /// The same sun in one of the directions, about two degrees apart, for which shadows are found.
    #[must_use]
    pub fn stepped(self) -> Self {
        const STEP_RAD: f32 = 0.035;
        let step = |angle_rad: f32| (angle_rad / STEP_RAD).round() * STEP_RAD;
        let azimuth_rad = step(self.toward.x.atan2(self.toward.y));
        let height_rad = step(self.toward.z.asin());
        Self { toward: Self::fixed(azimuth_rad.to_degrees(), height_rad.to_degrees()).toward, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOUR_SECS: f64 = 3600.0;

    #[test]
    fn the_sun_rises_in_the_east_culminates_in_the_south_and_sets_in_the_west() {
        let at = |hour: f64| Sun::at_time_of_day(hour * HOUR_SECS);
        assert!(at(7.0).toward.x > 0.9 && at(17.0).toward.x < -0.9);
        let noon = at(12.0);
        assert!(noon.toward.y < -0.5 && noon.toward.z > 0.8 && noon.toward.x.abs() < 1e-5, "{noon:?}");
        assert_eq!([at(0.0).daylight, at(3.0).daylight, noon.daylight], [0.0, 0.0, 1.0]);
        assert!(at(0.0).toward.z > 0.9, "what light there is comes from above");
        let day_after = Sun::at_time_of_day(35.0 * HOUR_SECS);
        assert!((day_after.toward - at(11.0).toward).length() < 1e-5);
    }

    #[test]
    fn directions_are_those_of_the_compass_and_steps_are_small() {
        let north_west = Sun::fixed(315.0, 45.0).toward;
        assert!((north_west - Vec3::new(-0.5, 0.5, 0.5_f32.sqrt())).length() < 1e-5, "{north_west}");
        let stepped = Sun::fixed(311.0, 44.0).stepped();
        assert!(stepped.toward.angle_between(Sun::fixed(311.0, 44.0).toward) < 0.03);
        assert_eq!(
            stepped.stepped().toward.to_array().map(|it| (it * 1e4).round()),
            stepped.toward.to_array().map(|it| (it * 1e4).round())
        );
    }
}
