//! Traverses as vehicles drove them in simulation, moment by moment.

use exact::Time;
use nalgebra::Point2;
use serde::{Deserialize, Serialize};
use tpn::OccurrenceId;

/// A traverse as it was driven.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SimulatedDrive {
    pub occurrence: OccurrenceId,
    /// When it started, in mission units.
    pub start: Time,
    /// How long it took until the last vehicle was there; absent if it never was.
    pub duration: Option<Time>,
    /// The vehicles, the leader first.
    pub vehicles: Vec<SimulatedVehicle>,
    /// How far the leader drove, in meters.
    pub driven_m: f64,
    /// How often another way was looked for.
    pub reroutes: u32,
    /// The least distance of a vehicle's rim from anything it could touch, in meters; infinite in an empty world.
    pub min_clearance_m: f64,
}

/// One vehicle's part in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SimulatedVehicle {
    /// Index into the program's world.
    pub vehicle: u32,
    /// What it did, in order of time.
    pub frames: Vec<DriveFrame>,
}

/// A vehicle at one moment of its drive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DriveFrame {
    /// In mission units from the start of the mission.
    pub time: f64,
    /// Meters east and north.
    pub position_m: Point2<f64>,
    /// Radians counter-clockwise from east.
    pub heading_rad: f64,
    /// Meters per second.
    pub speed_mps: f64,
    /// Where the rays of its range sensor met something, in meters.
    pub rays_m: Vec<Point2<f32>>,
    /// Where it meant to drive next, from where it was: along its path, or around what it had seen.
    pub plan_m: Vec<Point2<f32>>,
}

impl SimulatedVehicle {
    /// Returns what it was doing at `time`, in mission units; `None` before it set out.
    pub fn at(&self, time: f64) -> Option<&DriveFrame> {
        let after = self.frames.partition_point(|frame| frame.time <= time);
        self.frames.get(after.checked_sub(1)?)
    }

    /// Returns where it was at `time`, on an even way between frames; `None` before it set out.
    pub fn place_m(&self, time: f64) -> Option<Point2<f64>> {
        let after = self.frames.partition_point(|frame| frame.time <= time);
        let before = self.frames.get(after.checked_sub(1)?)?;
        let Some(next) = self.frames.get(after) else { return Some(before.position_m) };
        let share = (time - before.time) / (next.time - before.time);
        Some(before.position_m + (next.position_m - before.position_m) * share)
    }
}
