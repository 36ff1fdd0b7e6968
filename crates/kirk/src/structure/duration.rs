//! The duration of each block before any choice.

use stn::Overflow;

use super::{Duration, Shape, Structure, add, bounds, intersect, sum_of};
use crate::enclosed::Durations;
use crate::model::{INFINITE, Model, NONE};

impl Structure {
    pub(super) fn initial_duration(&self, model: &Model, id: usize) -> Result<Duration, Overflow> {
        let duration = self.nested_duration(id)?;
        let enclosed = self.blocks[id].enclosed;
        if enclosed == NONE || duration.is_empty() {
            return Ok(duration);
        }
        Ok(match self.enclosed[enclosed as usize].durations(model) {
            Durations::Never => Duration::NEVER,
            Durations::Unknown => duration,
            Durations::Between(lower, upper) => {
                let (lower, upper) = intersect((duration.lower, duration.upper()), (lower, upper));
                Duration::new(lower, upper)
            }
        })
    }

    fn nested_duration(&self, id: usize) -> Result<Duration, Overflow> {
        let block = &self.blocks[id];
        let parts = self.children(id).iter().map(|&child| {
            let inside = self.initial[child as usize];
            if inside.is_empty() {
                Ok(None)
            } else {
                add(inside, self.blocks[child as usize].around).map(Some)
            }
        });
        Ok(match block.shape {
            Shape::Leaf => Duration::new(block.own.0, block.own.1),
            Shape::Sequence => {
                let mut sum = Duration::new(0, 0);
                for part in parts {
                    let Some(part) = part? else { return Ok(Duration::NEVER) };
                    sum = sum_of(sum, part)?;
                }
                sum
            }
            Shape::Guard => {
                let mut sum = Duration::new(block.own.0, block.own.1);
                for part in parts {
                    let Some(part) = part? else { return Ok(Duration::NEVER) };
                    sum = sum_of(sum, part)?;
                }
                sum
            }
            Shape::Intersection => {
                let mut common = block.own;
                for part in parts {
                    let Some(part) = part? else { return Ok(Duration::NEVER) };
                    common = intersect(common, (part.lower, part.upper()));
                }
                Duration::new(common.0, common.1)
            }
            Shape::Choice(_) => {
                let mut hull: Option<(i64, i64)> = None;
                for part in parts {
                    let Some(part) = part? else { continue };
                    let (lower, upper) = hull.unwrap_or((part.lower, part.upper()));
                    hull = Some((lower.min(part.lower), upper.max(part.upper())));
                }
                hull.map_or(Duration::NEVER, |(lower, upper)| Duration::new(lower, upper))
            }
        })
    }

    /// The bounds of a block's own arcs.
    pub(super) fn own_bounds(&self, model: &Model, id: usize) -> (i64, i64) {
        self.own_arcs(id).iter().fold((0, INFINITE), |own, &arc| intersect(own, bounds(model, arc)))
    }

    /// What the arcs around a block add to its duration.
    pub(super) fn around(&self, model: &Model, id: usize) -> Result<(i64, i64), Overflow> {
        let (enter, leave) = self.blocks[id].around_arcs;
        let bounds = |arc: u32| if arc == NONE { (0, 0) } else { bounds(model, arc) };
        let (enter, leave) = (bounds(enter), bounds(leave));
        let lower = enter.0.checked_add(leave.0).ok_or(Overflow)?;
        let upper = match (enter.1, leave.1) {
            (INFINITE, _) | (_, INFINITE) => INFINITE,
            (enter, leave) => enter.checked_add(leave).ok_or(Overflow)?,
        };
        Ok((lower, upper))
    }
}
