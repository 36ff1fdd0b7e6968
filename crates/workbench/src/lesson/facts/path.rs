//! The search for a path that is looked at, sample by sample.

use nalgebra::Point2;

use super::{Fact, Of, count, fact, measured, truth, words};
use crate::state::AppState;
use crate::state::growth::Shown;

pub(super) const FACTS: &[Fact] = &[
    fact("samples", Of::Nothing, "how many samples are drawn of the search for a path", |state, _| {
        count(growth(state)?.samples() as usize)
    }),
    fact("all-samples", Of::Nothing, "how many samples the whole search draws", |state, _| {
        count(growth(state)?.total as usize)
    }),
    fact(
        "vertices",
        Of::Nothing,
        "how many vertices its trees have by now, their roots included",
        |state, _| count(growth(state)?.vertices() as usize),
    ),
    fact("sample", Of::Nothing, "where the last sample lies", |state, _| {
        place(growth(state)?.last()?.sample_m)
    }),
    fact(
        "nearest",
        Of::Nothing,
        "the vertex that was nearest to it, from which the tree grew",
        |state, _| place(growth(state)?.last()?.added.first()?.from_m),
    ),
    fact("steered", Of::Nothing, "the vertex that was added towards it", |state, _| {
        place(growth(state)?.last()?.added.first()?.point_m)
    }),
    fact("stride", Of::Nothing, "how many metres the tree grew towards it", |state, _| {
        let grown = growth(state)?.last()?.added.first()?;
        measured((grown.point_m - grown.from_m).norm())
    }),
    fact("blocked", Of::Nothing, "whether an obstacle was in the way of the last sample", |state, _| {
        truth(growth(state)?.last()?.added.is_empty())
    }),
    fact("path-found", Of::Nothing, "whether there is a path by now", |state, _| {
        truth(growth(state)?.length_m().is_some())
    }),
    fact("path-length", Of::Nothing, "the metres of the best path by now", |state, _| {
        measured(growth(state)?.length_m()?)
    }),
];

fn growth(state: &AppState) -> Option<&Shown> {
    state.terrain.growth.shown()
}

fn place(point: Point2<f64>) -> Option<super::Value> {
    words(format!("({:.1}, {:.1})", point.x, point.y))
}
