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

mod altitude;
mod convoy;
mod detour;
mod driver;
mod formation;
mod geometry;
mod kinodynamic;
mod laser;
mod leg;
mod nearest;
mod path;
mod proximity;
mod rrt;
mod rrt_connect;
mod rrt_star;
mod search;
mod shortcut;
mod thin;
mod timing;
mod trace;
mod trajectory;
mod tree;
mod vehicle;
mod way_around;

pub use altitude::path_in_space;
pub use convoy::{Convoy, ConvoyMember, Surroundings};
pub use driver::{DriveEvent, Driver, DriverSettings};
pub use formation::Formation;
pub use laser::{FineWorld, LaserModel, LaserScan};
pub use leg::{Leg, LegFailure, find_shortest_path, plan_leg, plan_legs};
pub use nearest::PointTree;
pub use path::Path;
pub use proximity::{Encounter, Proximity, TimedPoint, proximity};
pub use search::{
    Event, Failure, Growth, PlannerKind, Query, Search, SearchResult, Settings, Statistics, find_path,
};
pub use shortcut::{ShortcutSettings, shorten};
pub use thin::thin;
pub use timing::{SegmentTiming, SpeedLimits, duration_millis, time_path};
pub use trace::{GrownVertex, GrowthStep, GrowthTrace, TracedSearch, trace};
pub use trajectory::{DriveLimits, MotionState, TimedState, Trajectory, drive_path, heading_difference};
pub use tree::{Root, Tree, Vertex};
pub use vehicle::{Drive, VEHICLE_MODELS, VehicleModel, vehicle_model};
