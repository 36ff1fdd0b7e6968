//! The duration of each block before any choice.

use tpn::{ArcId, BlockId};

use super::{Duration, Shape, Structure, bounds, intersect, sum_of};
use crate::model::{INFINITE, Model};
use crate::unplannable::Unplannable;

impl Structure {
    pub(super) fn initial_duration(&self, id: BlockId) -> Result<Duration, Unplannable> {
        let block = &self.blocks[id];
        let children = self.children(id);
        let parts = children.iter().map(|&child| {
            let inside = self.initial[child];
            if inside.is_empty() { Ok(None) } else { self.with_around(inside, child).map(Some) }
        });
        Ok(match block.shape {
            Shape::Leaf => Duration::new(block.own.0, block.own.1),
            Shape::Sequence => {
                let mut sum = Duration::new(0, 0);
                for (&child, part) in children.iter().zip(parts) {
                    let Some(part) = part? else { return Ok(Duration::NEVER) };
                    sum = sum_of(sum, part).ok_or_else(|| self.overflow(child))?;
                }
                sum
            }
            Shape::Guard => {
                let mut sum = Duration::new(block.own.0, block.own.1);
                for (&child, part) in children.iter().zip(parts) {
                    let Some(part) = part? else { return Ok(Duration::NEVER) };
                    sum = sum_of(sum, part).ok_or_else(|| self.overflow(child))?;
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
                let mut relaxation: Option<(i64, i64)> = None;
                for part in parts {
                    let Some(part) = part? else { continue };
                    let (lower, upper) = relaxation.unwrap_or((part.lower, part.upper()));
                    relaxation = Some((lower.min(part.lower), upper.max(part.upper())));
                }
                relaxation.map_or(Duration::NEVER, |(lower, upper)| Duration::new(lower, upper))
            }
        })
    }

    /// The bounds of a block's own arcs.
    pub(super) fn own_bounds(&self, model: &Model, id: BlockId) -> (i64, i64) {
        self.own_arcs(id).iter().fold((0, INFINITE), |own, &arc| intersect(own, bounds(model, arc)))
    }

    /// Returns what the arcs around a block add to its duration.
    pub(super) fn around(&self, model: &Model, id: BlockId) -> Result<(i64, i64), Unplannable> {
        let (enter, leave) = self.blocks[id].around_arcs;
        let bounds = |arc: Option<ArcId>| arc.map_or((0, 0), |arc| bounds(model, arc));
        let (enter, leave) = (bounds(enter), bounds(leave));
        let lower = enter.0.checked_add(leave.0).ok_or_else(|| self.overflow(id))?;
        let upper = match (enter.1, leave.1) {
            (INFINITE, _) | (_, INFINITE) => INFINITE,
            (enter, leave) => enter.checked_add(leave).ok_or_else(|| self.overflow(id))?,
        };
        Ok((lower, upper))
    }
}
