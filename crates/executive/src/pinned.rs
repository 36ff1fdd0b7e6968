//! What is left of a plan's windows when some of its events are pinned to times: the live answer to dragging an event.
//!
//! Where the environment chooses nothing, pins narrow the windows of everything else. Where it chooses durations, what
//! is pinned is what the environment does, or a later time for what the executive does, in a run of the plan's
//! strategy. How events are grabbed, moved, put back and released is the same.

mod constrained;
mod run;

use std::collections::BTreeMap;

use exact::{Bound, Scale, Time};
use tpn::{Network, NodeId, Plan, Window};

use crate::dispatch::NEVER;
use crate::plan_network::PlanError;
use crate::strategy::{Course, Strategy};

/// A plan some of whose events are pinned to times. The pins never contradict the plan or each other.
#[derive(Clone, Debug)]
pub struct PinnedPlan {
    pins: Pins,
    scale: Scale,
    grabbed: Option<Grabbed>,
    effect: Effect,
}

/// Pinned events and their times, in ticks.
type Pins = BTreeMap<NodeId, i64>;

/// The event that is being moved.
#[derive(Clone, Copy, Debug)]
struct Grabbed {
    node: NodeId,
    /// Where it was pinned before, if it was.
    before: Option<i64>,
    /// Its window under the other pins, in ticks.
    window: (i64, i64),
}

/// What pins do to the plan.
#[derive(Clone, Debug)]
enum Effect {
    Constrained(Box<constrained::Constrained>),
    Run(Box<run::Run>),
}

/// What both kinds do.
macro_rules! of_both {
    ($effect:expr, $each:ident => $answer:expr) => {
        match $effect {
            Effect::Constrained($each) => $answer,
            Effect::Run($each) => $answer,
        }
    };
}

impl PinnedPlan {
    /// A plan without pins. Times are resolved to a tenth of the mission's unit or finer, where 64 bits allow it.
    pub fn new(network: &Network, plan: &Plan) -> Result<Self, PlanError> {
        let tenth = Time::ONE.checked_div(10).unwrap_or_default();
        let (scale, effect) = if let Some(strategy) = Strategy::new(network, plan, &[tenth])? {
            let run = run::Run::new(strategy, network.nodes.len())?;
            (run.scale(), Effect::Run(Box::new(run)))
        } else {
            let constrained = constrained::Constrained::new(network, plan, tenth)?;
            (constrained.scale(), Effect::Constrained(Box::new(constrained)))
        };
        Ok(Self { pins: Pins::new(), scale, grabbed: None, effect })
    }

    /// Takes hold of an event and answers the window that the other pins leave it: [`PinnedPlan::move_to`] moves it
    /// within. `None` for an event that the plan does not select or whose time is not free.
    pub fn grab(&mut self, node: NodeId) -> Option<Window> {
        self.grabbed = None;
        let mut others = self.pins.clone();
        let before = others.remove(&node);
        let window = of_both!(&mut self.effect, effect => effect.hold(node, &others))?;
        self.grabbed = Some(Grabbed { node, before, window });
        self.grabbed().map(|(_, window)| window)
    }

    /// Pins the grabbed event to the moment of its window that is nearest to `time`, and changes all other windows with
    /// it. Answers the moment; `None` if nothing is grabbed.
    pub fn move_to(&mut self, time: Time) -> Option<Time> {
        let Grabbed { node, before, window } = self.grabbed?;
        let latest = window.1.min(i64::MAX / 4);
        let ticks = self.scale.nearest_tick(time).min(latest).max(window.0);
        if let Effect::Run(run) = &mut self.effect
            && self.pins.get(&node).copied() == before
        {
            // The first move of this drag; the others belong to it.
            run.keep_step(&self.pins);
        }
        self.pins.insert(node, ticks);
        of_both!(&mut self.effect, effect => effect.move_held(ticks, &self.pins));
        Some(self.scale.time(ticks))
    }

    /// Lets go of the grabbed event; it stays where it is.
    pub fn drop_grabbed(&mut self) {
        self.grabbed = None;
    }

    /// Puts the grabbed event back where it was before it was grabbed. Returns whether one was grabbed.
    pub fn put_back(&mut self) -> bool {
        let Some(Grabbed { node, before, .. }) = self.grabbed.take() else { return false };
        match before {
            Some(time) => self.pins.insert(node, time),
            None => self.pins.remove(&node),
        };
        self.follow();
        true
    }

    /// Takes away the pin of an event.
    pub fn release(&mut self, node: NodeId) {
        self.grabbed = None;
        self.pins.remove(&node);
        self.follow();
    }

    /// Takes away all pins, and goes back to the start of the run.
    pub fn release_all(&mut self) {
        self.grabbed = None;
        self.pins.clear();
        if let Effect::Run(run) = &mut self.effect {
            run.restart();
        }
        self.follow();
    }

    fn follow(&mut self) {
        of_both!(&mut self.effect, effect => effect.follow(&self.pins));
    }

    /// The pinned events and their times, in the order of the events.
    pub fn pins(&self) -> Vec<(NodeId, Time)> {
        let at = |(&node, &ticks): (&NodeId, &i64)| match &self.effect {
            Effect::Constrained(_) => Some((node, self.scale.time(ticks))),
            Effect::Run(run) => {
                let window = run.course().windows.get(node.index()).copied().flatten();
                window.map(|window| (node, window.earliest))
            }
        };
        self.pins.iter().filter_map(at).collect()
    }

    /// The event that is being moved, and its window under the other pins.
    pub fn grabbed(&self) -> Option<(NodeId, Window)> {
        let Grabbed { node, window: (earliest, latest), .. } = self.grabbed?;
        let time = |ticks| self.scale.time(ticks);
        let latest = if latest == NEVER { Bound::Infinite } else { Bound::Finite(time(latest)) };
        Some((node, Window { earliest: time(earliest), latest }))
    }

    /// The windows under all pins, in the form of [`Plan::windows`].
    pub fn windows(&self, num_nodes: usize) -> Vec<Option<Window>> {
        match &self.effect {
            Effect::Constrained(constrained) => constrained.windows(num_nodes),
            Effect::Run(run) => run.course().windows.clone(),
        }
    }

    /// The state of the run in which the environment does what is pinned; `None` if it chooses nothing in this plan.
    pub fn course(&self) -> Option<&Course> {
        match &self.effect {
            Effect::Constrained(_) => None,
            Effect::Run(run) => Some(run.course()),
        }
    }

    /// Returns whether nothing was pinned, and no time let pass.
    pub fn is_untouched(&self) -> bool {
        let has_begun = matches!(&self.effect, Effect::Run(run) if run.has_begun());
        self.pins.is_empty() && !has_begun
    }

    /// Takes the last step of a run back: what was chosen last, or the time that was let pass. Answers whether there was
    /// one.
    pub fn take_back(&mut self) -> bool {
        let Effect::Run(run) = &mut self.effect else { return false };
        self.grabbed = None;
        let Some(pins) = run.take_back() else { return false };
        self.pins = pins;
        self.follow();
        true
    }

    /// Begins a run, or lets time pass until the next thing happens. Answers whether something was left to happen.
    pub fn go_on(&mut self) -> bool {
        let Effect::Run(run) = &mut self.effect else { return false };
        self.grabbed = None;
        let has_next = run.go_on(&self.pins);
        if has_next {
            self.follow();
        }
        has_next
    }
}
