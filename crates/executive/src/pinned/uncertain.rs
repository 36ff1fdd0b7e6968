//! Pins in a plan some of whose durations nature chooses: choices in a run of its strategy, which goes as far as the last
//! of them or as time was let pass.

use exact::{Bound, Time};
use tpn::{NodeId, Window};

use crate::dispatch::NEVER;
use crate::plan_network::PlanError;
use crate::strategy::{Choices, Course, Play, Strategy};

/// The choices of a run.
#[derive(Clone, Debug)]
pub(super) struct Pins {
    strategy: Strategy,
    num_nodes: usize,
    choices: Choices,
    /// How far time was let pass, in ticks; `None` before anything has been asked for.
    until: Option<i64>,
    /// The choices before each step, and how far time had passed, the first step first.
    steps: Vec<(Choices, Option<i64>)>,
    course: Course,
    grabbed: Option<Grabbed>,
}

/// The event that is being moved.
#[derive(Clone, Debug)]
struct Grabbed {
    node: NodeId,
    /// Where it was pinned before, if it was.
    before: Option<i64>,
    /// Its window under the other choices, in ticks.
    window: (i64, i64),
    /// The run before it can come: no later than this, all runs are one.
    play: Play,
}

impl Pins {
    pub(super) fn new(strategy: Strategy, num_nodes: usize) -> Result<Self, PlanError> {
        let course = strategy.course(&strategy.play(), num_nodes)?;
        Ok(Self {
            strategy,
            num_nodes,
            choices: Choices::new(),
            until: None,
            steps: Vec::new(),
            course,
            grabbed: None,
        })
    }

    pub(super) fn grab(&mut self, node: NodeId) -> Option<Window> {
        self.grabbed = None;
        if !self.strategy.is_selected(node) {
            return None;
        }
        let mut others = self.choices.clone();
        let before = others.remove(&node);
        let mut whole = self.strategy.play();
        self.strategy.play_on(&mut whole, &others, NEVER).ok()?;
        let (_, window) = self.strategy.window_of(&whole, node)?;
        let mut play = self.strategy.play();
        others.retain(|_, time| *time < window.0);
        self.strategy.play_on(&mut play, &others, window.0.saturating_sub(1)).ok()?;
        if self.strategy.window_of(&play, node).is_some() {
            // A choice that comes earlier in the text of the run than it was made for: begin again at every move.
            play = self.strategy.play();
        }
        self.grabbed = Some(Grabbed { node, before, window, play });
        self.grabbed().map(|(_, window)| window)
    }

    pub(super) fn move_to(&mut self, time: Time) -> Option<Time> {
        let grabbed = self.grabbed.as_ref()?;
        let (node, before) = (grabbed.node, grabbed.before);
        let wanted = self.strategy.scale().nearest_tick(time);
        let ticks = wanted.clamp(grabbed.window.0, grabbed.window.1);
        let play = grabbed.play.clone();
        if self.choices.get(&node).copied() == before {
            // The first move of this drag; the others belong to it.
            self.steps.push((self.choices.clone(), self.until));
        }
        self.choices.insert(node, ticks);
        self.replay(Some(play));
        Some(self.strategy.scale().time(ticks))
    }

    pub(super) fn drop_grabbed(&mut self) {
        self.grabbed = None;
    }

    pub(super) fn put_back(&mut self) -> bool {
        let Some(grabbed) = self.grabbed.take() else { return false };
        match grabbed.before {
            Some(time) => self.choices.insert(grabbed.node, time),
            None => self.choices.remove(&grabbed.node),
        };
        self.replay(None);
        true
    }

    pub(super) fn release(&mut self, node: NodeId) {
        self.grabbed = None;
        self.choices.remove(&node);
        self.replay(None);
    }

    pub(super) fn release_all(&mut self) {
        self.grabbed = None;
        self.choices.clear();
        self.steps.clear();
        self.until = None;
        self.replay(None);
    }

    pub(super) fn all(&self) -> Vec<(NodeId, Time)> {
        let at =
            |node: NodeId| self.course.windows.get(node.index()).copied().flatten().map(|it| it.earliest);
        self.choices.keys().filter_map(|&node| Some((node, at(node)?))).collect()
    }

    pub(super) fn grabbed(&self) -> Option<(NodeId, Window)> {
        let grabbed = self.grabbed.as_ref()?;
        let time = |ticks: i64| self.strategy.scale().time(ticks);
        let latest = match grabbed.window.1 {
            NEVER => Bound::Infinite,
            latest => Bound::Finite(time(latest)),
        };
        Some((grabbed.node, Window { earliest: time(grabbed.window.0), latest }))
    }

    pub(super) const fn course(&self) -> &Course {
        &self.course
    }

    /// Lets time pass until the next thing happens.
    pub(super) fn go_on(&mut self) -> bool {
        self.grabbed = None;
        if self.is_untouched() {
            // The run begins with what happens at once.
            self.until = Some(0);
            self.replay(None);
            return true;
        }
        let Some(next) = &self.course.next else { return false };
        self.steps.push((self.choices.clone(), self.until));
        self.until = Some(self.strategy.scale().nearest_tick(next.time));
        self.replay(None);
        true
    }

    pub(super) fn is_untouched(&self) -> bool {
        self.choices.is_empty() && self.until.is_none()
    }

    pub(super) fn take_back(&mut self) -> bool {
        self.grabbed = None;
        let Some((choices, until)) = self.steps.pop() else { return false };
        (self.choices, self.until) = (choices, until);
        self.replay(None);
        true
    }

    /// Plays the run anew, or on from a state that the choices have in common with it.
    fn replay(&mut self, begun: Option<Play>) {
        let last = self.choices.values().copied().max();
        let mut play = begun.unwrap_or_else(|| self.strategy.play());
        let played = match self.until.max(last) {
            Some(until) => self.strategy.play_on(&mut play, &self.choices, until),
            None => Ok(()),
        };
        // The strategy withstands every choice inside nature's ranges: a run cannot end otherwise.
        if played.is_ok()
            && let Ok(course) = self.strategy.course(&play, self.num_nodes)
        {
            self.course = course;
        }
    }
}
