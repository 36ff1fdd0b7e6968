//! The searches for a path that are looked at, sample by sample.

use nalgebra::{Point2, Vector2};
use rmpl::program::ObstacleShape;

use super::{Row, count, measured, truth, words};
use crate::description::Description;
use crate::description::terrain::PathSearch;
use crate::lesson::Value;
use crate::state::growth::Planners;

pub(super) const VALUES: &[Row] = &[
    ("samples", |it, of| count(growing(it, of)?.samples as usize)),
    ("all-samples", |it, _| count(it.terrain().growth.as_ref()?.total as usize)),
    ("vertices", |it, of| count(growing(it, of)?.vertices as usize)),
    ("checks", |it, of| count(growing(it, of)?.checks as usize)),
    ("sample", |it, _| place(it.last_sample()?.sample_m)),
    ("nearest", |it, _| place(it.last_sample()?.nearest_m)),
    ("steered", |it, _| place(it.last_sample()?.steered_m()?)),
    ("stride", |it, _| {
        let step = it.last_sample()?;
        measured((step.steered_m()? - step.nearest_m).norm())
    }),
    ("blocked", |it, _| truth(it.last_sample()?.added.is_empty())),
    ("path-found", |it, of| truth(growing(it, of)?.length.is_some())),
    ("path-length", |it, of| measured(growing(it, of)?.length?)),
    ("race", |it, _| truth(it.terrain().growth.as_ref().is_some_and(|growth| growth.searches.len() > 1))),
    ("obstacles", |it, _| count(it.shown()?.program.world.obstacles.len())),
    ("passes", |it, names| {
        let (one, other) = names.split_once(',')?;
        let snapshot = it.shown()?;
        let middle = |name: &str| {
            let obstacles = &snapshot.program.world.obstacles;
            Some(middle(&obstacles.iter().find(|it| it.name.text == name.trim())?.shape))
        };
        let (from, to) = (middle(one)?, middle(other)?);
        let legs = snapshot.traverses.iter().flat_map(|it| &it.legs);
        truth(legs.flat_map(|leg| leg.points_m.windows(2)).any(|it| crosses([it[0], it[1]], [from, to])))
    }),
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

/// Returns whether two lines have a point in common.
fn crosses([a, b]: [Point2<f64>; 2], [c, d]: [Point2<f64>; 2]) -> bool {
    let turn = |from: Point2<f64>, to: Point2<f64>, at: Point2<f64>| (to - from).perp(&(at - from));
    turn(a, b, c) * turn(a, b, d) <= 0.0 && turn(c, d, a) * turn(c, d, b) <= 0.0
}

/// Returns what a search has done: the first one, or that of the planner of this name.
fn growing<'a>(it: &'a Description<'_>, planner: &str) -> Option<&'a PathSearch> {
    let searches = &it.terrain().growth.as_ref()?.searches;
    if planner.is_empty() {
        return searches.first();
    }
    let title = Planners::named(planner).filter(|it| matches!(it, Planners::One(_)))?.title();
    searches.iter().find(|search| search.planner == title)
}

fn place(point: Point2<f64>) -> Option<Value> {
    words(format!("({:.1}, {:.1})", point.x, point.y))
}
