//! Motion over time within a vehicle's limits: states, the step from one to the next, and driving a path exactly.

use nalgebra::{Isometry2, Point2, UnitComplex, Vector2, distance};
use serde::{Deserialize, Serialize};

use crate::path::{Path, between};
use crate::vehicle::{Drive, VehicleModel};

/// What a skid-steer vehicle can do (SPEC 7.2): a unicycle with limits on speeds, accelerations and wheels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DriveLimits {
    /// Greatest speed of the vehicle and of its wheels over the ground, in meters per second.
    pub speed_mps: f64,
    /// Greatest turning rate in radians per second.
    pub turn_rate_rps: f64,
    /// Greatest acceleration and deceleration in meters per second squared.
    pub acceleration_mps2: f64,
    /// Greatest change of the turning rate in radians per second squared.
    pub turn_acceleration_rps2: f64,
    /// Half the effective track in meters: the wheels run at v ± ω times this.
    pub half_track_m: f64,
}

impl DriveLimits {
    /// The limits of a vehicle; one that flies has no wheels.
    pub fn of(model: &VehicleModel) -> Self {
        let half_track_m = match model.drive {
            Drive::SkidSteer { track_m, slip, .. } => 0.5 * track_m * slip,
            Drive::Flight { .. } => 0.0,
        };
        Self {
            speed_mps: model.speed_mps,
            turn_rate_rps: model.turn_rate_rps,
            acceleration_mps2: model.acceleration_mps2,
            turn_acceleration_rps2: model.turn_acceleration_rps2,
            half_track_m,
        }
    }

    /// Returns what two vehicles can do that keep together.
    #[must_use]
    pub const fn of_both(self, other: Self) -> Self {
        Self {
            speed_mps: self.speed_mps.min(other.speed_mps),
            turn_rate_rps: self.turn_rate_rps.min(other.turn_rate_rps),
            acceleration_mps2: self.acceleration_mps2.min(other.acceleration_mps2),
            turn_acceleration_rps2: self.turn_acceleration_rps2.min(other.turn_acceleration_rps2),
            half_track_m: self.half_track_m.max(other.half_track_m),
        }
    }

    /// Returns how long turning on the spot takes, from rest to rest, in seconds.
    pub fn turn_s(&self, angle_rad: f64) -> f64 {
        rest_to_rest_s(angle_rad.abs(), self.turn_rate_in_place_rps(), self.turn_acceleration_rps2)
    }

    /// Returns how long driving straight on takes, from rest to rest, at most at a speed, in seconds.
    pub fn straight_s(&self, length_m: f64, speed_mps: f64) -> f64 {
        rest_to_rest_s(length_m, speed_mps.min(self.speed_mps), self.acceleration_mps2)
    }

    /// The greatest turning rate that the wheels allow in place.
    pub fn turn_rate_in_place_rps(&self) -> f64 {
        if self.half_track_m > 0.0 {
            self.turn_rate_rps.min(self.speed_mps / self.half_track_m)
        } else {
            self.turn_rate_rps
        }
    }
}

/// Where a vehicle is and how it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MotionState {
    /// Meters east and north.
    pub position_m: Point2<f64>,
    /// Radians counter-clockwise from east.
    pub heading_rad: f64,
    /// Meters per second forward; negative in reverse.
    pub speed_mps: f64,
    /// Radians per second counter-clockwise.
    pub turn_rate_rps: f64,
}

impl MotionState {
    /// A vehicle that stands at this place.
    pub const fn at_rest(position_m: Point2<f64>, heading_rad: f64) -> Self {
        Self { position_m, heading_rad, speed_mps: 0.0, turn_rate_rps: 0.0 }
    }

    /// Returns where the vehicle's own axes, ahead and to the left, lie in the world.
    pub fn world_from_body(self) -> Isometry2<f64> {
        Isometry2::new(self.position_m.coords, self.heading_rad)
    }

    /// The state after `seconds` in which speed and turning rate go toward targets as fast as the limits allow. Both
    /// change evenly within the step; the wheels' limit takes precedence over the target speed.
    pub fn after(self, speed_mps: f64, turn_rate_rps: f64, seconds: f64, limits: &DriveLimits) -> Self {
        let approach = |value: f64, target: f64, change: f64| value + (target - value).clamp(-change, change);
        let slowing = limits.acceleration_mps2 * seconds;
        let mut speed =
            approach(self.speed_mps, speed_mps.clamp(-limits.speed_mps, limits.speed_mps), slowing);
        let mut rate = approach(
            self.turn_rate_rps,
            turn_rate_rps.clamp(-limits.turn_rate_rps, limits.turn_rate_rps),
            limits.turn_acceleration_rps2 * seconds,
        );
        let room = limits.speed_mps - rate.abs() * limits.half_track_m;
        if speed.abs() > room {
            // Slow down for the turn if the brakes allow, otherwise turn less until they do.
            speed = speed.signum() * room.max(self.speed_mps.abs() - slowing).max(0.0);
            if limits.half_track_m > 0.0 {
                let greatest = ((limits.speed_mps - speed.abs()) / limits.half_track_m).max(0.0);
                rate = rate.clamp(-greatest, greatest);
            }
        }
        let heading_rad = self.heading_rad + 0.5 * (self.turn_rate_rps + rate) * seconds;
        let middle = 0.5 * (self.heading_rad + heading_rad);
        let ahead = 0.5 * (self.speed_mps + speed) * seconds;
        Self {
            position_m: self.position_m + UnitComplex::new(middle) * Vector2::new(ahead, 0.0),
            heading_rad,
            speed_mps: speed,
            turn_rate_rps: rate,
        }
    }
}

/// The difference of two headings, between -π and π.
pub fn heading_difference(from_rad: f64, to_rad: f64) -> f64 {
    let turns = (to_rad - from_rad) / std::f64::consts::TAU;
    (turns - (turns + 0.5).floor()) * std::f64::consts::TAU
}

/// A state at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TimedState {
    /// Seconds from the start.
    pub time_s: f64,
    /// The state then.
    pub state: MotionState,
}

/// States in order of time, close enough for straight lines between them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Trajectory {
    /// The first is at time 0.
    pub states: Vec<TimedState>,
}

impl Trajectory {
    /// The longest time between two states, in seconds.
    pub const STEP_S: f64 = 0.1;

    /// Seconds from the first to the last state.
    pub fn duration_s(&self) -> f64 {
        self.states.last().map_or(0.0, |last| last.time_s)
    }

    /// The places passed, without those in the middle of a straight stretch.
    pub fn path(&self) -> Path {
        let goes_straight = |index: usize| {
            let around = index.checked_sub(1).and_then(|before| self.states.get(before..index + 2));
            around.is_some_and(|around| {
                around.iter().all(|timed| {
                    timed.state.turn_rate_rps == 0.0 && timed.state.heading_rad == around[0].state.heading_rad
                })
            })
        };
        let mut points_m: Vec<Point2<f64>> = self
            .states
            .iter()
            .enumerate()
            .filter(|&(index, _)| !goes_straight(index))
            .map(|(_, timed)| timed.state.position_m)
            .collect();
        points_m.dedup();
        Path::new(points_m)
    }

    /// The state at a time, between the two nearest; the first and last state beyond the ends. `None` when empty.
    pub fn state_at(&self, time_s: f64) -> Option<MotionState> {
        let next = self.states.partition_point(|timed| timed.time_s <= time_s);
        let after = self.states.get(next).or(self.states.last())?;
        let before = if next == 0 { after } else { &self.states[next - 1] };
        let span = after.time_s - before.time_s;
        let share = if span > 0.0 { ((time_s - before.time_s) / span).clamp(0.0, 1.0) } else { 0.0 };
        let mix = |a: f64, b: f64| a + (b - a) * share;
        let (a, b) = (before.state, after.state);
        Some(MotionState {
            position_m: a.position_m + (b.position_m - a.position_m) * share,
            heading_rad: mix(a.heading_rad, b.heading_rad),
            speed_mps: mix(a.speed_mps, b.speed_mps),
            turn_rate_rps: mix(a.turn_rate_rps, b.turn_rate_rps),
        })
    }

    pub(crate) fn push(&mut self, seconds: f64, state: MotionState) {
        let time_s = self.duration_s() + seconds;
        self.states.push(TimedState { time_s, state });
    }

    pub(crate) fn last(&self) -> MotionState {
        self.states.last().map(|timed| timed.state).unwrap_or_default()
    }

    /// Brakes until the vehicle stands.
    pub(crate) fn stop(&mut self, limits: &DriveLimits) {
        while self.last().speed_mps != 0.0 || self.last().turn_rate_rps != 0.0 {
            let next = self.last().after(0.0, 0.0, Self::STEP_S, limits);
            self.push(Self::STEP_S, next);
        }
    }

    /// From rest, turns on the spot to face a place and drives straight to it, exactly, to stand there.
    pub(crate) fn drive_to(&mut self, goal_m: Point2<f64>, limits: &DriveLimits) {
        let start = self.last();
        let length = distance(&start.position_m, &goal_m);
        if length == 0.0 {
            return;
        }
        let ahead = goal_m - start.position_m;
        let bearing = libm::atan2(ahead.y, ahead.x);
        let turn = heading_difference(start.heading_rad, bearing);
        for step in rest_to_rest(turn.abs(), limits.turn_rate_in_place_rps(), limits.turn_acceleration_rps2) {
            let state = MotionState {
                heading_rad: start.heading_rad + turn.signum() * step.way,
                turn_rate_rps: turn.signum() * step.rate,
                ..start
            };
            self.push(step.seconds, state);
        }
        let heading_rad = start.heading_rad + turn;
        for step in rest_to_rest(length, limits.speed_mps, limits.acceleration_mps2) {
            let position_m = between(start.position_m, goal_m, step.way / length);
            self.push(
                step.seconds,
                MotionState { position_m, heading_rad, speed_mps: step.rate, turn_rate_rps: 0.0 },
            );
        }
    }
}

/// Drives along a path: stands at each corner, turns on the spot, and drives straight on.
pub fn drive_path(path: &Path, heading_rad: f64, limits: &DriveLimits) -> Trajectory {
    let mut trajectory = Trajectory::default();
    if let Some((&first, rest)) = path.points_m.split_first() {
        trajectory.states.push(TimedState { time_s: 0.0, state: MotionState::at_rest(first, heading_rad) });
        for &point in rest {
            trajectory.drive_to(point, limits);
        }
    }
    trajectory
}

/// The duration of the fastest motion over a way from rest to rest.
fn rest_to_rest_s(way: f64, max_rate: f64, acceleration: f64) -> f64 {
    if way <= 0.0 {
        return 0.0;
    }
    let peak = max_rate.min((way * acceleration).sqrt());
    peak / acceleration + way / peak
}

struct ProfileStep {
    /// Since the step before.
    seconds: f64,
    /// How far it has come.
    way: f64,
    rate: f64,
}

/// The fastest motion over a way from rest to rest: speeding up, holding, slowing down evenly.
fn rest_to_rest(way: f64, max_rate: f64, acceleration: f64) -> Vec<ProfileStep> {
    if way <= 0.0 {
        return Vec::new();
    }
    let peak = max_rate.min((way * acceleration).sqrt());
    let ramp_s = peak / acceleration;
    let total_s = rest_to_rest_s(way, max_rate, acceleration);
    let count = (total_s / Trajectory::STEP_S).ceil().max(1.0);
    let seconds = total_s / count;
    (1..=count as u64)
        .map(|step| {
            let time = seconds * step as f64;
            let rest = (total_s - time).max(0.0);
            if step as f64 == count {
                ProfileStep { seconds, way, rate: 0.0 }
            } else if time < ramp_s {
                ProfileStep { seconds, way: 0.5 * acceleration * time * time, rate: acceleration * time }
            } else if rest < ramp_s {
                ProfileStep {
                    seconds,
                    way: way - 0.5 * acceleration * rest * rest,
                    rate: acceleration * rest,
                }
            } else {
                ProfileStep { seconds, way: peak * (time - 0.5 * ramp_s), rate: peak }
            }
        })
        .collect()
}
