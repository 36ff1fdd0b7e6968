//! What is done on the terrain, and where the vehicles are.

use rmpl::program::World;
use serde::Serialize;
use snapshot::Snapshot;
#[cfg(test)]
use ts_rs::TS;

use crate::state::AppState;
use crate::state::growth::{Planners, Search, Shown};

/// The tool on the terrain, and what the terrain shows.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Terrain {
    #[cfg_attr(
        test,
        ts(
            type = "\"look\" | \"measure\" | \"location\" | \"circle\" | \"appear\" | \"polygon\" | \"wall\" | \"vehicle\""
        )
    )]
    pub tool: &'static str,
    /// The places that the tool has so far, in meters east and north.
    pub points: Vec<[f64; 2]>,
    /// Whether the clearance map is shown.
    pub clearance: bool,
    /// How many rays of range sensors are drawn.
    pub rays: usize,
    /// Whether a video is recorded.
    pub recording: bool,
    pub growth: Option<PathGrowth>,
}

/// The search for a path, sample by sample.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct PathGrowth {
    /// The planner whose searches are shown.
    pub planner: &'static str,
    pub leg: usize,
    pub samples: u32,
    pub total: u32,
    pub vertices: u32,
    /// The length of the best path so far, in meters.
    pub length: Option<f64>,
    /// What the last sample did, in a sentence.
    pub sentence: Option<String>,
    /// What each search has done by now; several of them race.
    pub searches: Vec<PathSearch>,
}

/// A search for a path up to the current sample.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct PathSearch {
    pub planner: &'static str,
    pub samples: u32,
    pub vertices: u32,
    /// Straight pieces of ground that were checked for obstacles.
    pub checks: u32,
    /// The length of the best path so far, in meters.
    pub length: Option<f64>,
    /// Whether the core has drawn all samples.
    pub complete: bool,
    /// Why there is no search.
    pub refusal: Option<String>,
}

/// Where a vehicle is: meters, and radians counter-clockwise from east.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Vehicle {
    pub name: String,
    pub x: f64,
    pub y: f64,
    /// The height of the ground there, for a blimp its height over it; `null` off the map.
    pub z: Option<f64>,
    pub heading: f64,
    pub time: f64,
}

pub(super) fn terrain(state: &AppState) -> Terrain {
    let terrain = &state.terrain;
    let time = state.playback.time;
    let drives = state.run_shown().map_or(&[][..], |run| run.drives.as_slice());
    let rays = drives
        .iter()
        .flat_map(|drive| &drive.vehicles)
        .filter(|it| it.frames.last().is_some_and(|last| last.time > time))
        .filter_map(|it| it.at(time))
        .map(|frame| frame.rays_m.len());
    Terrain {
        tool: terrain.tool.name(),
        points: terrain.points_m.iter().map(|point| [point.x, point.y]).collect(),
        clearance: state.settings.views.terrain.clearance,
        rays: rays.sum(),
        recording: terrain.film.is_some(),
        growth: terrain.growth.shown().map(|shown| path_growth(terrain.growth.planners, shown)),
    }
}

fn path_growth(planners: Planners, shown: &Shown) -> PathGrowth {
    let counts = shown.counts();
    let search = |(at, search): (usize, &Search)| {
        let counts = shown.counts_of(at);
        PathSearch {
            planner: search.planner.map_or(Planners::AsPlanned, Planners::One).title(),
            samples: counts.samples,
            vertices: counts.vertices,
            checks: counts.checks,
            length: counts.length_m,
            complete: search.is_complete(),
            refusal: search.refusal().map(str::to_owned),
        }
    };
    PathGrowth {
        planner: planners.title(),
        leg: shown.leg,
        samples: shown.samples(),
        total: shown.total(),
        vertices: counts.vertices,
        length: counts.length_m,
        sentence: shown.sentence(),
        searches: shown.searches.iter().enumerate().map(search).collect(),
    }
}

pub(super) fn vehicles(state: &AppState, snapshot: &Snapshot) -> Vec<Vehicle> {
    let time = state.playback.time;
    let ground = state.maps.of(snapshot);
    let vehicles = &snapshot.program.world.vehicles;
    snapshot
        .motions
        .iter()
        .filter_map(|motion| {
            let (place, heading) = motion.at(time)?;
            let vehicle = vehicles.get(motion.vehicle as usize)?;
            let height = ground.and_then(|ground| ground.height_at(place));
            Some(Vehicle {
                name: vehicle.name.text.to_string(),
                x: place.x,
                y: place.y,
                z: height
                    .map(|height| height + flight_height_m(&snapshot.program.world, &vehicle.model.text)),
                heading,
                time,
            })
        })
        .collect()
}

/// Returns how high over the ground a vehicle of this model is drawn; 0 for what drives.
fn flight_height_m(world: &World, model: &str) -> f64 {
    match snapshot::vehicle::model(world, model).map(|model| model.drive) {
        Some(motion::Drive::Flight { altitude_band_m: [low, high], .. }) => f64::midpoint(low, high),
        _ => 0.0,
    }
}
