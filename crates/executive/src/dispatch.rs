//! Dispatch of a plan (SPEC 6.2, 13.2): when its events may happen, and what those that happened leave possible.
//!
//! All plans are dispatched alike but for how the time of one event narrows the windows of the others. A plan that
//! withstands the environment goes through its dispatchable form with waits: the environment's events are observed,
//! never chosen, and what is tied to them comes with them. In every other plan windows are kept exact on the
//! elimination tree of its network, each event in time logarithmic in their number where that is narrow. A dispatchable
//! form would do there as well, but it has windows of enabled events only, and is cubic in the number of events at worst.

use std::sync::Arc;

use controllability::plan_network;
use stn::{PointId, Refusal, Unfolding};
use stnu::{DispatchError, Dispatchable, Dispatcher, LinkId, Status};
use tpn::{ArcId, Network, Plan};

use crate::plan_network::{PlanError, PlanNetwork};

/// No upper bound.
pub(crate) const NEVER: i64 = i64::MAX;

/// Why an event cannot have come at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SettleError {
    /// It came outside its window.
    OutOfWindow,
    /// This event, of which nothing is known yet, must come first.
    NotYet(PointId),
    /// This event, which follows, could only come at a time that does not fit.
    Overflow(PointId),
}

/// The state of a dispatch.
#[derive(Clone, Debug)]
pub(crate) struct Dispatch {
    /// The present, in ticks, where something waits for the environment.
    now: i64,
    propagation: Propagation,
}

/// How the time of an event narrows the windows of the others.
#[derive(Clone, Debug)]
enum Propagation {
    Tree(Box<Tree>),
    Waits(Box<Waits>),
}

#[derive(Clone, Debug)]
struct Tree {
    unfolding: Unfolding,
    /// The points that must come after each because of one constraint between the two.
    later: Arc<[Vec<PointId>]>,
    /// How many of those that must come before each have not been settled.
    earlier: Vec<u32>,
}

/// Events that `[0,0]` ties to one instant are one component.
#[derive(Clone, Debug)]
struct Waits {
    dispatcher: Dispatcher<Arc<Dispatchable>>,
    /// The component of each event.
    components: Arc<[PointId]>,
    /// Durations that end where another one ends, and so have an end of their own: the event's component.
    own_ends: Arc<[(PointId, LinkId)]>,
    /// The arc whose duration each link is.
    arcs: Arc<[ArcId]>,
}

/// What a point waits for, and until when at most, in ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Awaited {
    pub(crate) natures: ArcId,
    pub(crate) until: i64,
}

impl Dispatch {
    /// Prepares a plan for dispatch, in the ticks of `made`.
    pub(crate) fn new(network: &Network, plan: &Plan, made: &PlanNetwork) -> Result<Self, PlanError> {
        let waits = if plan.has_natures_choice(network) { Waits::new(network, plan, made)? } else { None };
        let propagation = match waits {
            Some(waits) => Propagation::Waits(Box::new(waits)),
            None => Propagation::Tree(Box::new(Tree::new(made)?)),
        };
        Ok(Self { now: 0, propagation })
    }

    /// Returns whether the environment chooses durations, and the plan withstands that.
    pub(crate) const fn withstands_nature(&self) -> bool {
        matches!(self.propagation, Propagation::Waits(_))
    }

    pub(crate) const fn now(&self) -> i64 {
        self.now
    }

    /// When a point may happen next, in ticks: as early as its waits let it if nature ends nothing before; no later than
    /// [`NEVER`] if it is not bounded. Meaningless for one that is not enabled where something waits for nature.
    pub(crate) fn window(&self, point: PointId) -> (i64, i64) {
        match &self.propagation {
            Propagation::Tree(tree) => {
                let (earliest, latest) = tree.unfolding.window(point);
                (earliest, latest.unwrap_or(NEVER))
            }
            Propagation::Waits(waits) => match waits.status(point) {
                Status::Executed(time) => (time, time),
                Status::Enabled { from, until, .. } => (from.max(0), until.unwrap_or(NEVER)),
                Status::Contingent { from, until } => (from, until),
                Status::Blocked(_) | Status::Inactive => (self.now, NEVER),
            },
        }
    }

    /// Returns what a point happens together with, by number.
    pub(crate) fn component(&self, point: PointId) -> usize {
        match &self.propagation {
            Propagation::Tree(_) => point.index(),
            Propagation::Waits(waits) => waits.components[point.index()].index(),
        }
    }

    /// Returns whether the time of a point is settled.
    pub(crate) fn is_settled(&self, point: PointId) -> bool {
        match &self.propagation {
            Propagation::Tree(tree) => tree.unfolding.has_happened(point),
            Propagation::Waits(waits) => matches!(waits.status(point), Status::Executed(_)),
        }
    }

    /// Returns whether each point that must come before this one, because of one constraint between the two, has its
    /// time.
    pub(crate) fn is_enabled(&self, point: PointId) -> bool {
        match &self.propagation {
            Propagation::Tree(tree) => tree.earlier[point.index()] == 0,
            Propagation::Waits(waits) => {
                matches!(waits.status(point), Status::Enabled { .. } | Status::Contingent { .. })
            }
        }
    }

    /// Settles the time of a point: the executive's happens, or the environment's is seen. Refused, with everything as
    /// before, where another point must come first that has not.
    pub(crate) fn settle(&mut self, point: PointId, ticks: i64) -> Result<(), SettleError> {
        let (earliest, latest) = self.window(point);
        if ticks < earliest || ticks > latest {
            return Err(SettleError::OutOfWindow);
        }
        if self.is_settled(point) {
            return Ok(());
        }
        match &mut self.propagation {
            Propagation::Tree(tree) => tree.settle(point, ticks),
            Propagation::Waits(waits) => {
                let settled = waits.settle(point, ticks);
                self.now = waits.dispatcher.now();
                settled.map_err(|error| match error {
                    DispatchError::Overflow => SettleError::Overflow(point),
                    _ => SettleError::OutOfWindow,
                })
            }
        }
    }

    /// Lets time pass, up to the first event that must come.
    pub(crate) fn advance(&mut self, ticks: i64) {
        if let Propagation::Waits(waits) = &mut self.propagation {
            let until = ticks.min(waits.dispatcher.deadline().unwrap_or(NEVER)).max(self.now);
            // Never beyond what is due, and never back: it cannot be refused.
            let _ = waits.dispatcher.advance(until);
            self.now = waits.dispatcher.now();
        }
    }

    /// When each of `points` may still happen: at the earliest if the environment ends early what it waits for.
    pub(crate) fn windows(
        &self,
        points: impl Iterator<Item = PointId>,
    ) -> Result<Vec<(i64, i64)>, PlanError> {
        let Propagation::Waits(waits) = &self.propagation else {
            return Ok(points.map(|point| self.window(point)).collect());
        };
        let windows = waits.dispatcher.windows().map_err(|_| PlanError::Overflow)?;
        let window = |point: PointId| windows[waits.components[point.index()].index()];
        Ok(points.map(window).map(|window| (window.earliest, window.latest.unwrap_or(NEVER))).collect())
    }

    /// The duration of the environment's that ends at a point, if one does and it has started; when it began.
    pub(crate) fn under_way(&self, point: PointId) -> Option<(ArcId, i64)> {
        let Propagation::Waits(waits) = &self.propagation else { return None };
        let Status::Contingent { .. } = waits.status(point) else { return None };
        let network = &waits.dispatcher.form().network;
        let link = network.link_ending_at(waits.components[point.index()])?;
        let began = waits.dispatcher.times()[network.link(link).activation.index()]?;
        Some((waits.arcs[link.index()], began))
    }

    /// The ends of the environment's that a point waits for, though all that must come before it has.
    pub(crate) fn awaited(&self, point: PointId) -> Vec<Awaited> {
        let Propagation::Waits(waits) = &self.propagation else { return Vec::new() };
        let Status::Enabled { waits: links, .. } = waits.status(point) else { return Vec::new() };
        let natures = |link: LinkId| waits.arcs[link.index()];
        links.into_iter().map(|(link, until)| Awaited { natures: natures(link), until }).collect()
    }

    /// The world lets a point come at a time: what comes with it or after it waits.
    pub(crate) fn expect(&mut self, point: PointId, ticks: i64) {
        if let Propagation::Tree(tree) = &mut self.propagation {
            tree.unfolding.expect(point, ticks);
        }
    }

    /// The expected points that have to come earlier since this was asked.
    pub(crate) fn take_late(&mut self) -> Vec<PointId> {
        match &mut self.propagation {
            Propagation::Tree(tree) => tree.unfolding.take_late(),
            Propagation::Waits(_) => Vec::new(),
        }
    }
}

impl Tree {
    fn new(plan: &PlanNetwork) -> Result<Self, PlanError> {
        let unfolding = Unfolding::new(&plan.stn, plan.origin())?;
        let mut later = vec![Vec::new(); plan.stn.num_points()];
        let mut earlier = vec![0; later.len()];
        for edge in (0..plan.stn.num_edges()).filter_map(|position| plan.stn.edge(position)) {
            if edge.weight < 0 {
                later[edge.to.index()].push(edge.from);
                earlier[edge.from.index()] += 1;
            }
        }
        Ok(Self { unfolding, later: later.into(), earlier })
    }

    fn settle(&mut self, point: PointId, ticks: i64) -> Result<(), SettleError> {
        self.unfolding.happen(point, ticks).map_err(|refusal| match refusal {
            Refusal::NotYet(other) => SettleError::NotYet(other),
            Refusal::Overflow(other) => SettleError::Overflow(other),
        })?;
        for later in &self.later[point.index()] {
            self.earlier[later.index()] -= 1;
        }
        Ok(())
    }
}

impl Waits {
    /// `None` for a plan that is not controllable.
    fn new(network: &Network, plan: &Plan, made: &PlanNetwork) -> Result<Option<Self>, PlanError> {
        let read = plan_network(network, &plan.selected_arcs, &plan.precedences(network), made.scale())?;
        let Some(form) = Dispatchable::new(&read.network, &mut || false)? else { return Ok(None) };
        let component = |point| read.point(made.node(point)).ok_or(PlanError::Inconsistent);
        let components: Result<Arc<[_]>, PlanError> = made.all_points().map(component).collect();
        let links = (0..read.network.links().len() as u32).map(LinkId);
        let own_ends = links.clone().zip(read.network.links()).filter_map(|(id, link)| {
            let is_own = read.nodes(link.end).is_empty();
            read.point(network.arcs[read.arc(id).index()].to).filter(|_| is_own).map(|at| (at, id))
        });
        Ok(Some(Self {
            own_ends: own_ends.collect(),
            arcs: links.map(|id| read.arc(id)).collect(),
            dispatcher: Dispatcher::new(Arc::new(form), 0),
            components: components?,
        }))
    }

    fn status(&self, point: PointId) -> Status {
        self.dispatcher.status(self.components[point.index()])
    }

    fn settle(&mut self, point: PointId, ticks: i64) -> Result<(), DispatchError> {
        let component = self.components[point.index()];
        self.dispatcher.advance(ticks)?;
        match self.dispatcher.form().network.link_ending_at(component) {
            Some(link) => self.dispatcher.observe(link)?,
            None => self.dispatcher.execute(component)?,
        }
        for &(_, link) in self.own_ends.iter().filter(|(at, _)| *at == component) {
            self.dispatcher.observe(link)?;
        }
        Ok(())
    }
}
