//! The duration of each block before any choice.

use stn::Overflow;
use tpn::{BlockKind, Network};

use super::{Duration, Shape, Structure, add, between, bounds, intersect, saturating_upper, sum_of};
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
        let parts = block.children.iter().map(|&child| {
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

    /// What the structural arcs around a child add; `None` if there are none where there must be.
    pub(super) fn around(
        &self,
        network: &Network,
        model: &Model,
        id: usize,
        position: usize,
    ) -> Result<Option<(i64, i64)>, Overflow> {
        let block = &network.blocks[id];
        let children = &self.blocks[id].children;
        let child = &network.blocks[children[position] as usize];
        let (enter, leave) = match self.blocks[id].shape {
            Shape::Leaf => return Ok(Some((0, 0))),
            Shape::Sequence => {
                let next =
                    children.get(position + 1).map_or(block.end, |&next| network.blocks[next as usize].start);
                let enter =
                    if position == 0 { between(model, block.start.0, child.start.0) } else { Some((0, 0)) };
                (enter, between(model, child.end.0, next.0))
            }
            Shape::Guard => {
                let BlockKind::Guard { arc, .. } = &block.kind else { return Ok(None) };
                let inside = network.arcs[arc.index()].to.0;
                (between(model, inside, child.start.0), between(model, child.end.0, block.end.0))
            }
            Shape::Choice(decision) => {
                let arc = model.decisions[decision as usize].alternatives.get(position).copied();
                let enter = arc.and_then(|arc| {
                    let after = between(model, model.arcs[arc as usize].to, child.start.0)?;
                    let choice = bounds(model, arc);
                    Some((choice.0.checked_add(after.0)?, saturating_upper(choice.1, after.1)))
                });
                (enter, between(model, child.end.0, block.end.0))
            }
            Shape::Intersection => {
                (between(model, block.start.0, child.start.0), between(model, child.end.0, block.end.0))
            }
        };
        let (Some(enter), Some(leave)) = (enter, leave) else { return Ok(None) };
        let lower = enter.0.checked_add(leave.0).ok_or(Overflow)?;
        let upper = match (enter.1, leave.1) {
            (INFINITE, _) | (_, INFINITE) => INFINITE,
            (enter, leave) => enter.checked_add(leave).ok_or(Overflow)?,
        };
        Ok(Some((lower, upper)))
    }
}
