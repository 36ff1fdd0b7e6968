//! Runs of a plan's execution strategy in which someone chooses what the environment does, duration by duration (SPEC
//! 13.2): what the executive does then, what it waits for, and what may still come.
//!
//! The executive does everything as early as it may, but for what was put to a later time. A duration that no one has
//! chosen lasts as long as it can.

use std::collections::BTreeMap;

use exact::{Bound, Scale, Time};
use stn::PointId;
use tpn::{ArcId, Network, NodeId, Plan, Window};

use crate::dispatch::{Dispatch, NEVER};
use crate::plan_network::{PlanError, PlanNetwork};
use crate::progress::Waiting;

/// The strategy of a plan that withstands the environment.
#[derive(Clone, Debug)]
pub struct Strategy {
    made: PlanNetwork,
    /// At the start, before anything else has happened.
    begin: Dispatch,
    /// The points that come at one instant always, by their first one; events with names first.
    instants: Vec<Vec<PointId>>,
    /// The instant of each point.
    instant_of: Vec<usize>,
}

/// Who makes an event happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Actor {
    Executive,
    /// The environment, at the end of a duration that it chose.
    Nature(ArcId),
}

/// What comes at one instant because someone acts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Act {
    pub time: Time,
    /// What happens, at least one event; those with names first.
    pub events: Vec<NodeId>,
    pub actor: Actor,
    /// When it could have happened, with what happened before.
    pub window: Window,
}

/// A duration that the environment is choosing: it has started and has not ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnderWay {
    /// The uncontrolled duration.
    pub natures: ArcId,
    /// When it began.
    pub began: Time,
    /// When it may still end.
    pub window: Window,
}

/// How a run stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    pub now: Time,
    /// What happened so far, in the order of time.
    pub acts: Vec<Act>,
    /// What the environment is choosing, in the order of the arcs.
    pub under_way: Vec<UnderWay>,
    /// What could happen earlier if the environment ended something earlier.
    pub waiting: Vec<Waiting>,
    /// What happens next if the environment lets everything last; nothing at the end of the run.
    pub next: Option<Act>,
    /// When each event of the plan happened or may still happen, in the form of [`Plan::windows`].
    pub windows: Vec<Option<Window>>,
}

/// A run, as far as it was played.
#[derive(Clone, Debug)]
pub(crate) struct Play {
    dispatch: Dispatch,
    acts: Vec<RawAct>,
}

/// An act in ticks, by the number of its instant.
#[derive(Clone, Copy, Debug)]
struct RawAct {
    time: i64,
    instant: usize,
    actor: Actor,
    window: (i64, i64),
}

/// Times that were chosen, in ticks: of the end of a duration of the environment's, or of an event of the executive's.
pub(crate) type Choices = BTreeMap<NodeId, i64>;

impl Strategy {
    /// The strategy of `plan`, with times as fine as `grid` asks; `None` if the environment chooses nothing in it, or
    /// if it does not withstand the environment.
    pub fn new(network: &Network, plan: &Plan, grid: &[Time]) -> Result<Option<Self>, PlanError> {
        if !plan.has_natures_choice(network) {
            return Ok(None);
        }
        let mut made = PlanNetwork::new(network, plan)?;
        let mut finer = made.clone();
        if finer.refine_for(network, plan, grid).is_ok() {
            made = finer;
        }
        let mut begin = Dispatch::new(network, plan, &made)?;
        if !begin.withstands_nature() {
            return Ok(None);
        }
        begin.settle(made.origin(), 0).map_err(|_| PlanError::Inconsistent)?;
        let mut instants: Vec<Vec<PointId>> = Vec::new();
        let mut of_component: BTreeMap<usize, usize> = BTreeMap::new();
        let mut instant_of = Vec::new();
        for point in made.all_points() {
            let instant = *of_component.entry(begin.component(point)).or_insert(instants.len());
            if instant == instants.len() {
                instants.push(Vec::new());
            }
            instants[instant].push(point);
            instant_of.push(instant);
        }
        for points in &mut instants {
            points.sort_by_key(|&point| network.nodes[made.node(point).index()].events.is_empty());
        }
        Ok(Some(Self { made, begin, instants, instant_of }))
    }

    /// The ticks of its times.
    pub(crate) const fn scale(&self) -> Scale {
        self.made.scale()
    }

    /// Returns whether the plan selects an event.
    pub(crate) fn is_selected(&self, node: NodeId) -> bool {
        self.made.point(node).is_some()
    }

    /// A run that has just started.
    pub(crate) fn play(&self) -> Play {
        Play { dispatch: self.begin.clone(), acts: Vec::new() }
    }

    /// Plays on: everything that comes up to `until`, and all that is chosen, if the environment keeps to `choices`.
    pub(crate) fn play_on(&self, play: &mut Play, choices: &Choices, until: i64) -> Result<(), PlanError> {
        let mut chosen: BTreeMap<usize, i64> = BTreeMap::new();
        for (&node, &ticks) in choices {
            let Some(point) = self.made.point(node) else { continue };
            let instant = self.instant_of[point.index()];
            if !play.dispatch.is_settled(self.instants[instant][0]) {
                chosen.insert(instant, ticks);
            }
        }
        while let Some(act) = self.next(play, &chosen) {
            if act.time > until && chosen.is_empty() {
                break;
            }
            let settled = play.dispatch.settle(self.instants[act.instant][0], act.time);
            settled.map_err(|_| PlanError::Inconsistent)?;
            chosen.remove(&act.instant);
            play.acts.push(act);
        }
        play.dispatch.advance(until);
        Ok(())
    }

    /// Returns what happens next, the environment first.
    fn next(&self, play: &Play, chosen: &BTreeMap<usize, i64>) -> Option<RawAct> {
        let act = |instant: usize| {
            let point = self.instants[instant][0];
            if !play.dispatch.is_enabled(point) {
                return None;
            }
            let (from, until) = play.dispatch.window(point);
            let soonest = from.max(play.dispatch.now());
            let until = until.max(soonest);
            let (actor, time) = match play.dispatch.under_way(point) {
                Some((arc, _)) => (Actor::Nature(arc), until),
                None => (Actor::Executive, soonest),
            };
            let time = chosen.get(&instant).map_or(time, |&wanted| wanted.clamp(soonest, until));
            Some(RawAct { time, instant, actor, window: (from, until) })
        };
        (0..self.instants.len())
            .filter_map(act)
            .min_by_key(|act| (act.time, act.actor == Actor::Executive, act.instant))
    }

    /// When the event of `node` happened in a run, and could have happened.
    pub(crate) fn window_of(&self, play: &Play, node: NodeId) -> Option<(i64, (i64, i64))> {
        let instant = self.instant_of[self.made.point(node)?.index()];
        play.acts.iter().find(|act| act.instant == instant).map(|act| (act.time, act.window))
    }

    /// Returns how a run stands.
    pub(crate) fn course(&self, play: &Play, num_nodes: usize) -> Result<Course, PlanError> {
        let scale = self.scale();
        let time = |ticks: i64| scale.time(ticks);
        let bound = |ticks: i64| if ticks == NEVER { Bound::Infinite } else { Bound::Finite(time(ticks)) };
        let in_words = |act: RawAct| Act {
            time: time(act.time),
            events: self.instants[act.instant].iter().map(|&point| self.made.node(point)).collect(),
            actor: act.actor,
            window: Window { earliest: time(act.window.0), latest: bound(act.window.1) },
        };
        let mut under_way = Vec::new();
        let mut waiting = Vec::new();
        for points in &self.instants {
            let point = points[0];
            if let Some((natures, began)) = play.dispatch.under_way(point) {
                let (from, until) = play.dispatch.window(point);
                let from = from.max(play.dispatch.now());
                let window = Window { earliest: time(from), latest: bound(until) };
                under_way.push(UnderWay { natures, began: time(began), window });
            }
            for awaited in play.dispatch.awaited(point) {
                let event = self.made.node(point);
                waiting.push(Waiting { event, natures: awaited.natures, until: time(awaited.until) });
            }
        }
        under_way.sort_by_key(|it| it.natures);
        waiting.sort_by_key(|it| (it.event, it.natures));
        let mut windows = vec![None; num_nodes];
        let found = play.dispatch.windows(self.made.all_points())?;
        for (point, (earliest, latest)) in self.made.all_points().zip(found) {
            let window = Window { earliest: time(earliest), latest: bound(latest) };
            windows[self.made.node(point).index()] = Some(window);
        }
        Ok(Course {
            now: time(play.dispatch.now()),
            acts: play.acts.iter().map(|&act| in_words(act)).collect(),
            under_way,
            waiting,
            next: self.next(play, &BTreeMap::new()).map(in_words),
            windows,
        })
    }
}
