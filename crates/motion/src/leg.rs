//! Paths for the legs of a traverse: through its waypoints in order.

use serde::{Deserialize, Serialize};
use terrain::ConfigurationSpace;

use crate::geometry::distance;
use crate::path::Path;
use crate::search::{Failure, PlannerKind, Query, Settings, Statistics, find_path};
use crate::shortcut::ShortcutSettings;

/// A leg of a traverse.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Leg {
    /// From one waypoint to the next, exactly.
    pub path: Path,
    /// What the search took.
    pub statistics: Statistics,
}

/// A leg that can't be driven, or for which no path was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LegFailure {
    /// Which leg: 0 goes from the first waypoint to the second.
    pub leg: usize,
    /// Why.
    pub failure: Failure,
}

/// How often a leg is searched: obstacles leave several ways around, and one search takes any of them.
const TRIES: u64 = 6;

/// A short path between two waypoints: the shortest of a few found by RRT-Connect and shortened. The result depends on
/// nothing but the arguments, so a caller can keep it under them. Another seed may find a shorter path, or one where
/// this seed failed.
pub fn plan_leg(
    space: &ConfigurationSpace,
    query: Query,
    seed: u64,
    stop: &mut dyn FnMut(&Statistics) -> bool,
) -> Result<Leg, Failure> {
    let straight = distance(query.start_m, query.goal_m);
    let mut best: Option<(f64, Leg)> = None;
    for attempt in 0..TRIES {
        let seed = seed.wrapping_mul(TRIES).wrapping_add(attempt);
        let settings = Settings { seed, ..Settings::of(PlannerKind::RrtConnect) };
        let shortcut = ShortcutSettings { seed, ..ShortcutSettings::default() };
        let result = find_path(space, query, &settings, Some(&shortcut), stop);
        let path = match (result.path, &best) {
            (Ok(path), _) => path,
            // What one search found is good although a further one did not finish.
            (Err(_), Some(_)) => break,
            (Err(failure), None) => return Err(failure),
        };
        let length = path.length_m();
        if best.as_ref().is_none_or(|(least, _)| length < *least) {
            best = Some((length, Leg { path, statistics: result.statistics }));
        }
        if length <= straight * (1.0 + 1e-9) {
            break;
        }
    }
    best.map(|(_, leg)| leg).ok_or(Failure::NotFound { samples: 0 })
}

/// Paths from each waypoint to the next.
pub fn plan_legs(
    space: &ConfigurationSpace,
    waypoints_m: &[[f64; 2]],
    seed: u64,
    stop: &mut dyn FnMut(&Statistics) -> bool,
) -> Result<Vec<Leg>, LegFailure> {
    waypoints_m
        .windows(2)
        .enumerate()
        .map(|(leg, pair)| {
            let query = Query { start_m: pair[0], goal_m: pair[1] };
            plan_leg(space, query, seed, stop).map_err(|failure| LegFailure { leg, failure })
        })
        .collect()
}
