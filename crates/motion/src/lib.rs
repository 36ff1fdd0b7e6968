//! Rapidly-exploring random trees, vehicle models, kinodynamics and local avoidance.
//!
//! The way from a mission's declarations to a path:
//!
//! 1. [`vehicle_model`] gives the [`VehicleModel`] that a `vehicle` declaration names, and
//!    [`VehicleModel::configuration_space`] where it can be on a terrain with obstacles.
//! 2. [`plan_leg`] finds a short path between two waypoints, or says why there is none; [`Search`] is the same one
//!    sample at a time, with its trees, for display.
//! 3. [`time_path`] gives each segment of the path its least and greatest duration.
//!
//! Nothing here reads a clock or draws unseeded numbers: the same call gives the same bits natively and in wasm.

mod convoy;
mod detour;
mod driver;
mod fine_world;
mod formation;
mod kinodynamic;
mod leg;
mod nearest;
mod nearness;
mod passage;
mod path;
mod query;
mod range_sensor;
mod rrt;
mod rrt_connect;
mod rrt_star;
mod search;
mod separation;
mod shortcut;
mod simplification;
mod sonar;
mod timing;
mod trace;
mod trajectory;
mod tree;
mod vehicle;
mod way_around;

pub use convoy::{Convoy, ConvoyMember, OtherVehicle, Surroundings};
pub use driver::{
    DriveEvent, Driver, DriverSettings, HiddenRocks, driven_at_most_m, driven_within_s, min_driven_m,
};
pub use fine_world::FineWorld;
pub use formation::Formation;
pub use leg::{Leg, find_shortest_path, plan_leg};
pub use nearest::PointTree;
pub use nearness::{NearPieces, near_pieces};
pub use passage::narrow_passage;
pub use path::{Path, length_m};
pub use query::{Event, Failure, Growth, PlannerKind, Query, Settings, Statistics};
pub use range_sensor::{RangeScan, RangeSensor};
pub use search::{Search, SearchResult, find_path};
pub use separation::{Approach, Separation, TimedPoint, closest_approach};
pub use shortcut::{ShortcutSettings, shorten};
pub use simplification::simplify;
pub use sonar::{Echo, SonarArray};
pub use timing::{SegmentTiming, SpeedLimits, duration_millis, time_path, time_path_within};
pub use trace::{GrownVertex, GrowthStep, GrowthTrace, TracedSearch, trace};
pub use trajectory::{DriveLimits, MotionState, TimedState, Trajectory, drive_path, heading_difference};
pub use tree::{Root, Tree, Vertex};
pub use vehicle::{Drive, VEHICLE_MODELS, VehicleModel, vehicle_model};
pub use way_around::way_over_cells;
