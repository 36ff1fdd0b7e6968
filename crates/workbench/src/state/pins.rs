//! Events that the user has pinned to times, to see what that leaves of the plan. The text does not change.

use std::sync::Arc;

use exact::Time;
use executive::{Course, PinnedPlan};
use snapshot::{Planning, Snapshot};
use tpn::{Network, NodeId, OccurrenceKind, Plan};

use crate::state::selection::node_name;

/// What can be done with pins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PinCommand {
    /// Takes hold of an event of the plan.
    Grab(NodeId),
    /// Moves the event that is held to a time, as far as its window goes.
    MoveTo(Time),
    /// Lets go of it; it stays where it was moved to.
    Drop,
    /// Pins an event to a time, as far as its window goes.
    Pin(NodeId, Time),
    /// Takes away the pin of an event.
    Release(NodeId),
    /// Takes away all pins, and goes back to the start of a run against the environment.
    ReleaseAll,
    /// Lets time pass until the next thing happens, in a plan some of whose durations the environment chooses.
    GoOn,
    /// Takes the last step of such a run back.
    TakeBack,
}

/// The pins of the plan that is shown, and what they leave of its windows.
#[derive(Debug, Default)]
pub struct Pins {
    pinned: Option<PinnedPlan>,
    /// What the pins belong to.
    planning: Option<Arc<Planning>>,
    /// The plan with the windows that the pins leave.
    plan: Option<Plan>,
    version: u64,
}

impl Pins {
    /// The plan with the windows that the pins leave; `None` without pins.
    pub fn plan(&self, snapshot: &Snapshot) -> Option<&Plan> {
        let same = self.planning.as_ref().zip(snapshot.planning.as_ref());
        same.is_some_and(|(own, shown)| Arc::ptr_eq(own, shown)).then_some(self.plan.as_ref()).flatten()
    }

    /// Grows whenever a window may have changed.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// The state of the run in which the environment does what is pinned; `None` before it starts, or if the environment chooses
    /// nothing.
    pub fn course(&self, snapshot: &Snapshot) -> Option<&Course> {
        self.plan(snapshot)?;
        self.pinned.as_ref()?.course()
    }

    /// The pinned events and their times.
    pub fn all(&self) -> Vec<(NodeId, Time)> {
        self.pinned.as_ref().map(PinnedPlan::pins).unwrap_or_default()
    }

    /// Returns whether no event is pinned, and no run has started.
    pub fn is_empty(&self) -> bool {
        self.pinned.as_ref().is_none_or(PinnedPlan::is_untouched)
    }

    /// The event that is held, and the window that it can be moved in.
    pub fn held(&self) -> Option<(NodeId, tpn::Window)> {
        self.pinned.as_ref()?.grabbed()
    }

    /// Does what `command` asks for. Fails, with a reason for the user, if the plan has no times to pin.
    pub fn apply(&mut self, command: PinCommand, snapshot: &Snapshot) -> Result<(), String> {
        self.prepare(snapshot)?;
        let Some(pinned) = &mut self.pinned else { return Ok(()) };
        match command {
            PinCommand::Grab(node) => {
                pinned.grab(node);
                return Ok(());
            }
            PinCommand::MoveTo(time) => {
                pinned.move_to(time);
            }
            PinCommand::Drop => {
                pinned.drop_grabbed();
                return Ok(());
            }
            PinCommand::Pin(node, time) => {
                pinned.grab(node).ok_or("the plan does not select this event")?;
                pinned.move_to(time);
                pinned.drop_grabbed();
            }
            PinCommand::Release(node) => pinned.release(node),
            PinCommand::ReleaseAll => pinned.release_all(),
            PinCommand::GoOn => {
                pinned.go_on();
            }
            PinCommand::TakeBack => {
                pinned.take_back();
            }
        }
        self.update(snapshot);
        Ok(())
    }

    /// Goes one step back: puts the event that is held back to where it was, or else takes all pins away. Answers
    /// whether there was something to take back.
    pub fn step_back(&mut self, snapshot: Option<&Arc<Snapshot>>) -> bool {
        let had_pins = !self.is_empty();
        let (Some(pinned), Some(snapshot)) = (&mut self.pinned, snapshot) else { return false };
        let was_held = pinned.put_back();
        if !was_held {
            pinned.release_all();
        }
        self.update(snapshot);
        was_held || had_pins
    }

    /// Takes the pins over to a new plan: those of events that are still there and may still happen then.
    pub fn follow(&mut self, before: Option<&Snapshot>, after: &Snapshot) {
        let old = std::mem::take(self);
        self.version = old.version + 1;
        let names = before.and_then(|before| before.network.as_deref()).map_or_else(Vec::new, |network| {
            old.all().into_iter().map(|(node, time)| (event_name(network, node), time)).collect()
        });
        let Some(network) = after.network.as_deref().filter(|_| !names.is_empty()) else { return };
        for (name, time) in names {
            let Some(node) = event_by_name(network, &name) else { continue };
            if self.apply(PinCommand::Pin(node, time), after).is_err() {
                return;
            }
            if self.all().iter().any(|&(pinned, moved)| pinned == node && moved != time) {
                let _ = self.apply(PinCommand::Release(node), after);
            }
        }
    }

    fn prepare(&mut self, snapshot: &Snapshot) -> Result<(), String> {
        let (Some(network), Some(planning), Some(plan)) =
            (snapshot.network.as_deref(), &snapshot.planning, snapshot.plan())
        else {
            return Err("no plan".to_owned());
        };
        let is_current = self.planning.as_ref().is_some_and(|own| Arc::ptr_eq(own, planning));
        if !is_current || self.pinned.is_none() {
            let pinned = PinnedPlan::new(network, plan);
            self.pinned = Some(pinned.map_err(|reason| format!("cannot pin events: {reason}"))?);
            self.planning = Some(Arc::clone(planning));
            self.plan = None;
        }
        Ok(())
    }

    fn update(&mut self, snapshot: &Snapshot) {
        self.version += 1;
        let (Some(network), Some(pinned)) = (snapshot.network.as_deref(), &self.pinned) else { return };
        if pinned.is_untouched() {
            self.plan = None;
            return;
        }
        let windows = pinned.windows(network.nodes.len());
        match &mut self.plan {
            Some(plan) => plan.windows = windows,
            None => self.plan = snapshot.plan().map(|plan| Plan { windows, ..plan.clone() }),
        }
    }
}

/// The name of an event; of those that happen at once, that of an activity rather than that of a delay.
pub fn event_name(network: &Network, node: NodeId) -> String {
    let rank =
        |event: &&tpn::EventRef| match network.occurrences.get(event.occurrence.index()).map(|it| it.kind) {
            Some(OccurrenceKind::Primitive | OccurrenceKind::Activity) => 0,
            Some(OccurrenceKind::Assertion) => 1,
            _ => 2,
        };
    let events = network.nodes.get(node.index()).into_iter().flat_map(|it| &it.events);
    match events.min_by_key(rank) {
        Some(&event) => network.event_name(event),
        None => node_name(network, node),
    }
}

/// The names of all events of some nodes.
pub fn names_of_events(network: &Network, nodes: &[NodeId]) -> Vec<String> {
    let events =
        nodes.iter().filter_map(|node| network.nodes.get(node.index())).flat_map(|node| &node.events);
    events.map(|&event| network.event_name(event)).collect()
}

/// The event of this name: `Group-Wait#1.start`.
pub fn event_by_name(network: &Network, name: &str) -> Option<NodeId> {
    let is_named = |node: &tpn::Node| node.events.iter().any(|&event| network.event_name(event) == name);
    network.nodes.iter().position(is_named).map(NodeId::from_index)
}
