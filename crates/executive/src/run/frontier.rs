//! What may happen next in a plan whose durations the executive chooses: events of which all that they follow has
//! happened, and those that the world decides, in order of time. An event is looked at when something that matters for it
//! has changed.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::sync::Arc;

use exact::Time;
use stn::PointId;
use tpn::NodeId;

use super::{Next, Run};
use crate::plan_network::PlanError;
use crate::stage::Stage;

/// The events that may be next, by when that would be.
#[derive(Debug, Default)]
pub(super) struct Frontier {
    /// The time, the event's rank, and the event; out of date where the event has another time by now.
    heap: BinaryHeap<Reverse<(Time, u32, u32)>>,
    /// How many nodes that each node follows have not happened.
    missing: Vec<u32>,
    followers: Arc<[Vec<NodeId>]>,
    /// Events that others must come before, by those.
    waiting: BTreeMap<PointId, Vec<PointId>>,
}

impl Frontier {
    fn of(stage: &Stage) -> Self {
        Self {
            heap: BinaryHeap::new(),
            missing: stage.missing(),
            followers: stage.followers(),
            waiting: BTreeMap::new(),
        }
    }
}

impl Run<'_> {
    /// Begins the frontier of the present plan again, if it has one.
    pub(super) fn restart_frontier(&mut self) -> Result<(), PlanError> {
        if self.stage.dispatch.withstands_nature() {
            self.frontier = None;
            return Ok(());
        }
        self.frontier = Some(Frontier::of(&self.stage));
        for point in self.stage.made.all_points() {
            self.look_at(point)?;
        }
        Ok(())
    }

    /// The event that is next by the frontier.
    pub(super) fn next_of_frontier(&mut self) -> Result<Option<Next>, PlanError> {
        loop {
            let Some(frontier) = &mut self.frontier else { return Ok(None) };
            let Some(&Reverse((time, rank, point))) = frontier.heap.peek() else { return Ok(None) };
            let next = self.waiting_point(PointId(point))?;
            let key = next.as_ref().map(|next| self.key(next));
            if key == Some((time, rank, point)) {
                return Ok(next);
            }
            let Some(frontier) = &mut self.frontier else { return Ok(None) };
            frontier.heap.pop();
            if key.is_some() {
                self.look_at(PointId(point))?;
            }
        }
    }

    fn key(&self, next: &Next) -> (Time, u32, u32) {
        (next.time, self.stage.rank(next.point), next.point.0)
    }

    /// When an event would happen, if it may.
    fn waiting_point(&self, point: PointId) -> Result<Option<Next>, PlanError> {
        let Some(frontier) = &self.frontier else { return Ok(None) };
        let node = self.stage.made.node(point);
        let is_over = self.stage.times[node.index()].is_some();
        if is_over || !self.stage.dispatch.is_enabled(point) {
            return Ok(None);
        }
        if frontier.missing[node.index()] > 0 && !self.is_reported(point)? {
            return Ok(None);
        }
        self.candidate(point, node)
    }

    /// Lists an event if it may happen. It is looked at again when it may come later by the time that it is next, and when
    /// it has to come earlier at once.
    fn look_at(&mut self, point: PointId) -> Result<(), PlanError> {
        let Some(next) = self.waiting_point(point)? else {
            let node = self.stage.made.node(point);
            if self.stage.times[node.index()].is_none() && self.is_driven(point)? {
                // Nothing else happens before: only the adversary knows when the environment ends a duration, and an
                // event that waits for its turn comes at its own time.
                let next = if self.is_natures(node) { None } else { self.candidate(point, node)? };
                let ticks = next.and_then(|next| self.stage.made.scale().ticks(next.time).ok());
                self.stage.dispatch.expect(point, ticks.unwrap_or(i64::MAX));
            }
            return Ok(());
        };
        let key = self.key(&next);
        if let Some(frontier) = &mut self.frontier {
            frontier.heap.push(Reverse(key));
        }
        if next.time > self.stage.window(point).0.max(self.now) {
            let ticks = self.stage.made.scale().ticks(next.time);
            self.stage.dispatch.expect(point, ticks.unwrap_or(i64::MAX));
        }
        Ok(())
    }

    /// Another event must come before `point`, which is looked at again then.
    pub(super) fn wait_for(&mut self, point: PointId, other: PointId) {
        if let Some(frontier) = &mut self.frontier {
            // What an adversary lets happen is not listed.
            if frontier.heap.peek().is_some_and(|Reverse((.., first))| *first == point.0) {
                frontier.heap.pop();
            }
            frontier.waiting.entry(other).or_default().push(point);
        }
    }

    /// An event has happened: what follows it may be next, and what it changed may come at another time.
    pub(super) fn look_beyond(&mut self, point: PointId) -> Result<(), PlanError> {
        let Some(frontier) = &mut self.frontier else { return Ok(()) };
        let node = self.stage.made.node(point);
        let followers = Arc::clone(&frontier.followers);
        let waiting = frontier.waiting.remove(&point).unwrap_or_default();
        for follower in &followers[node.index()] {
            let missing = &mut frontier.missing[follower.index()];
            *missing = missing.saturating_sub(1);
        }
        let late = self.stage.dispatch.take_late();
        for &follower in &followers[node.index()] {
            if let Some(point) = self.stage.made.point(follower) {
                self.look_at(point)?;
            }
        }
        for point in waiting.into_iter().chain(late) {
            self.look_at(point)?;
        }
        Ok(())
    }
}
