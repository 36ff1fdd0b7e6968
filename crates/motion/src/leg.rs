//! Paths for the legs of a traverse: through its waypoints in order.

use nalgebra::distance;
use serde::{Deserialize, Serialize};
use terrain::ConfigurationSpace;

use crate::path::Path;
use crate::query::{Failure, PlannerKind, Query, Settings, Statistics};
use crate::search::{SearchResult, find_path};
use crate::shortcut::ShortcutSettings;

/// A leg of a traverse.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Leg {
    /// From one waypoint to the next, exactly.
    pub path: Path,
    /// What the search took.
    pub statistics: Statistics,
}

/// How often a leg is searched: obstacles leave several ways around, and one search may miss the shortest.
const TRIES: u32 = 2;

/// A short path between two waypoints: the shortest of a few found by RRT-Connect and shortened. The result depends on
/// nothing but the arguments, so a caller can keep it under them. Another seed may find a shorter path, or one where
/// this seed failed.
///
/// ```
/// use terrain::{CellState, ConfigurationSpace, GridFrame, Obstacle, Occupancy};
///
/// // 40 × 40 meters with a round obstacle in the middle, for a vehicle of half a meter.
/// let mut ground = Occupancy::free(GridFrame::new(40, 40, 1.0));
/// ground.mark(&Obstacle::Circle { center_m: [20.0, 20.0].into(), radius_m: 8.0 }, CellState::Obstacle);
/// let space = ConfigurationSpace::new(ground, 0.5);
/// let query = motion::Query { start_m: [2.0, 20.0].into(), goal_m: [38.0, 20.0].into() };
/// let leg = motion::plan_leg(&space, query, 1, &mut |_| false).expect("there is room around it");
/// assert!(leg.path.length_m() > 36.0);
/// // The same seed finds the same path.
/// assert_eq!(motion::plan_leg(&space, query, 1, &mut |_| false), Ok(leg));
/// ```
pub fn plan_leg(
    space: &ConfigurationSpace,
    query: Query,
    seed: u64,
    stop: &mut dyn FnMut(&Statistics) -> bool,
) -> Result<Leg, Failure> {
    let settings = Settings { seed, ..Settings::of(PlannerKind::RrtConnect) };
    let shortcut = ShortcutSettings { seed, ..ShortcutSettings::default() };
    let result = find_shortest_path(space, query, &settings, &shortcut, TRIES, stop);
    Ok(Leg { path: result.path?, statistics: result.statistics })
}

/// The shortest of some paths found with different seeds, the first with those of the settings, each shortened. The
/// trees and counts are those of the search that found it. Searching ends early when a path is straight, and with the
/// first failure when nothing was found before.
pub fn find_shortest_path(
    space: &ConfigurationSpace,
    query: Query,
    settings: &Settings,
    shortcut: &ShortcutSettings,
    tries: u32,
    stop: &mut dyn FnMut(&Statistics) -> bool,
) -> SearchResult {
    let length = |result: &SearchResult| result.path.as_ref().map_or(f64::INFINITY, Path::length_m);
    let straight = distance(&query.start_m, &query.goal_m) * (1.0 + 1e-9);
    let mut best = find_path(space, query, settings, Some(shortcut), stop);
    for attempt in 1..u64::from(tries) {
        if best.path.is_err() || length(&best) <= straight {
            break;
        }
        // Far from the seeds that a caller counts through.
        let seed = settings.seed ^ attempt.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let result = find_path(space, query, &Settings { seed, ..*settings }, Some(shortcut), stop);
        if length(&result) < length(&best) {
            best = result;
        }
    }
    best
}
