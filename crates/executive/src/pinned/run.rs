//! Pins in a plan some of whose durations the environment chooses: choices in a run of its strategy, which goes as far
//! as the last of them or as time was let pass.

use exact::Scale;
use tpn::NodeId;

use super::Pins;
use crate::dispatch::NEVER;
use crate::plan_network::PlanError;
use crate::strategy::{Course, Play, Strategy};

/// A run whose choices are the pins.
#[derive(Clone, Debug)]
pub(super) struct Run {
    strategy: Strategy,
    num_nodes: usize,
    /// How far time was let pass, in ticks; `None` before anything has been asked for.
    until: Option<i64>,
    /// The choices before each step, and how far time had passed, the first step first.
    steps: Vec<(Pins, Option<i64>)>,
    course: Course,
    /// The run before the event that was grabbed last can come: no later than this, all runs are one.
    held: Play,
}

impl Run {
    pub(super) fn new(strategy: Strategy, num_nodes: usize) -> Result<Self, PlanError> {
        let held = strategy.play();
        let course = strategy.course(&held, num_nodes)?;
        Ok(Self { strategy, num_nodes, until: None, steps: Vec::new(), course, held })
    }

    pub(super) const fn scale(&self) -> Scale {
        self.strategy.scale()
    }

    pub(super) const fn course(&self) -> &Course {
        &self.course
    }

    /// Takes hold of an event under the choices of others; its window.
    pub(super) fn hold(&mut self, node: NodeId, others: &Pins) -> Option<(i64, i64)> {
        if !self.strategy.is_selected(node) {
            return None;
        }
        let mut whole = self.strategy.play();
        self.strategy.play_on(&mut whole, others, NEVER).ok()?;
        let (_, window) = self.strategy.window_of(&whole, node)?;
        let mut play = self.strategy.play();
        let is_earlier = |(_, time): &(&NodeId, &i64)| **time < window.0;
        let earlier: Pins = others.iter().filter(is_earlier).map(|(&node, &time)| (node, time)).collect();
        self.strategy.play_on(&mut play, &earlier, window.0.saturating_sub(1)).ok()?;
        if self.strategy.window_of(&play, node).is_some() {
            // A choice that comes earlier in the text of the run than it was made for: begin again at every move.
            play = self.strategy.play();
        }
        self.held = play;
        Some(window)
    }

    /// Keeps where the run is, to come back to.
    pub(super) fn keep_step(&mut self, choices: &Pins) {
        self.steps.push((choices.clone(), self.until));
    }

    /// The held event is chosen to come at another time of its window.
    pub(super) fn move_held(&mut self, _: i64, choices: &Pins) {
        self.play(self.held.clone(), choices);
    }

    /// Plays the run again from its start, with these choices.
    pub(super) fn follow(&mut self, choices: &Pins) {
        self.play(self.strategy.play(), choices);
    }

    /// Goes back to the start, which has no steps before it.
    pub(super) fn restart(&mut self) {
        self.steps.clear();
        self.until = None;
    }

    pub(super) const fn has_begun(&self) -> bool {
        self.until.is_some()
    }

    /// Begins, or lets time pass until the next thing happens. Returns whether something was left to happen.
    pub(super) fn go_on(&mut self, choices: &Pins) -> bool {
        if choices.is_empty() && self.until.is_none() {
            // The run begins with what happens at once.
            self.until = Some(0);
            return true;
        }
        let Some(next) = &self.course.next else { return false };
        let until = self.scale().nearest_tick(next.time);
        self.keep_step(choices);
        self.until = Some(until);
        true
    }

    /// Forgets the last step; the choices before it.
    pub(super) fn take_back(&mut self) -> Option<Pins> {
        let (choices, until) = self.steps.pop()?;
        self.until = until;
        Some(choices)
    }

    /// Plays on from a state that the choices have in common with the run.
    fn play(&mut self, mut play: Play, choices: &Pins) {
        let last = choices.values().copied().max();
        let played = match self.until.max(last) {
            Some(until) => self.strategy.play_on(&mut play, choices, until),
            None => Ok(()),
        };
        // The strategy withstands every choice inside the environment's ranges: a run cannot end otherwise.
        if played.is_ok()
            && let Ok(course) = self.strategy.course(&play, self.num_nodes)
        {
            self.course = course;
        }
    }
}
