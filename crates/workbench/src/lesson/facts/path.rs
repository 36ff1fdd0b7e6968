//! The searches for a path that are looked at, sample by sample.

use nalgebra::{Point2, Vector2};
use rmpl::program::ObstacleShape;

use super::{Fact, Of, count, fact, measured, truth, words};
use crate::state::AppState;
use crate::state::growth::{Counts, Planners, Shown};

/// The first search, or that of a planner.
const SEARCH: Of = Of::Maybe("rrt-star");

pub(super) const FACTS: &[Fact] = &[
    fact("samples", SEARCH, "how many samples are drawn of the search for a path", |state, of| {
        count(counts(state, of)?.samples as usize)
    }),
    fact("all-samples", Of::Nothing, "how many samples the whole search draws", |state, _| {
        count(growth(state)?.total() as usize)
    }),
    fact("vertices", SEARCH, "how many vertices its trees have by now, their roots included", |state, of| {
        count(counts(state, of)?.vertices as usize)
    }),
    fact("checks", SEARCH, "how many straight pieces of ground it has checked for obstacles", |state, of| {
        count(counts(state, of)?.checks as usize)
    }),
    fact("sample", Of::Nothing, "where the last sample lies", |state, _| {
        place(growth(state)?.last()?.sample_m)
    }),
    fact("nearest", Of::Nothing, "the vertex that was nearest to it", |state, _| {
        place(growth(state)?.last()?.nearest_m)
    }),
    fact("steered", Of::Nothing, "the vertex that was added towards it", |state, _| {
        place(growth(state)?.last()?.steered_m()?)
    }),
    fact("stride", Of::Nothing, "how many metres the tree grew towards it", |state, _| {
        let step = growth(state)?.last()?;
        measured((step.steered_m()? - step.nearest_m).norm())
    }),
    fact("blocked", Of::Nothing, "whether an obstacle was in the way of the last sample", |state, _| {
        truth(growth(state)?.last()?.added.is_empty())
    }),
    fact("path-found", SEARCH, "whether there is a path by now", |state, of| {
        truth(counts(state, of)?.length_m.is_some())
    }),
    fact("path-length", SEARCH, "the metres of the best path by now", |state, of| {
        measured(counts(state, of)?.length_m?)
    }),
    fact("race", Of::Nothing, "whether all planners are shown side by side", |state, _| {
        truth(growth(state).is_some_and(Shown::is_race))
    }),
    fact("obstacles", Of::Nothing, "how many obstacles the mission has", |state, _| {
        count(state.shown()?.program.world.obstacles.len())
    }),
    fact(
        "passes",
        Of::Something("Ridge, Scarp"),
        "whether a planned path leads between the middles of two obstacles",
        |state, names| {
            let (one, other) = names.split_once(',')?;
            let snapshot = state.shown()?;
            let middle = |name: &str| {
                let obstacles = &snapshot.program.world.obstacles;
                Some(middle(&obstacles.iter().find(|it| it.name.text == name.trim())?.shape))
            };
            let (from, to) = (middle(one)?, middle(other)?);
            let legs = snapshot.traverses.iter().flat_map(|it| &it.legs);
            truth(legs.flat_map(|leg| leg.points_m.windows(2)).any(|it| crosses([it[0], it[1]], [from, to])))
        },
    ),
];

/// The middle of an obstacle's corners.
fn middle(shape: &ObstacleShape) -> Point2<f64> {
    match shape {
        ObstacleShape::Circle { center_m, .. } => (*center_m).into(),
        ObstacleShape::Polygon { corners_m } => {
            let sum: Vector2<f64> = corners_m.iter().map(|&corner| Vector2::from(corner)).sum();
            Point2::from(sum / corners_m.len().max(1) as f64)
        }
    }
}

/// Whether two lines have a point in common.
fn crosses([a, b]: [Point2<f64>; 2], [c, d]: [Point2<f64>; 2]) -> bool {
    let turn = |from: Point2<f64>, to: Point2<f64>, at: Point2<f64>| (to - from).perp(&(at - from));
    turn(a, b, c) * turn(a, b, d) <= 0.0 && turn(c, d, a) * turn(c, d, b) <= 0.0
}

fn growth(state: &AppState) -> Option<&Shown> {
    state.terrain.growth.shown()
}

/// What a search has done: the first one, or that of the planner of this name.
fn counts(state: &AppState, planner: &str) -> Option<Counts> {
    let shown = growth(state)?;
    if planner.is_empty() {
        return Some(shown.counts());
    }
    let Planners::One(planner) = Planners::named(planner)? else { return None };
    let at = shown.searches.iter().position(|search| search.planner == Some(planner))?;
    Some(shown.counts_of(at))
}

fn place(point: Point2<f64>) -> Option<super::Value> {
    words(format!("({:.1}, {:.1})", point.x, point.y))
}
