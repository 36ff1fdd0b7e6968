//! What is left of a plan's windows when some of its events are pinned to times: the live answer to dragging an event.
//!
//! Where nature chooses nothing, pins narrow the windows of everything else. Where it chooses durations, what is pinned is
//! what nature does, or a later time for what the executive does, in a run of the plan's strategy.

mod certain;
mod uncertain;

use exact::Time;
use tpn::{Network, NodeId, Plan};

use crate::plan_network::PlanError;
use crate::strategy::{Course, Strategy};

/// A plan some of whose events are pinned to times. The pins never contradict the plan or each other.
#[derive(Clone, Debug)]
pub struct PinnedPlan(Kind);

#[derive(Clone, Debug)]
enum Kind {
    Certain(Box<certain::Pins>),
    Uncertain(Box<uncertain::Pins>),
}

/// What both kinds do.
macro_rules! of_both {
    ($pinned:expr, $pins:ident => $answer:expr) => {
        match $pinned {
            Kind::Certain($pins) => $answer,
            Kind::Uncertain($pins) => $answer,
        }
    };
}

impl PinnedPlan {
    /// A plan without pins. Times are resolved to a tenth of the mission's unit or finer, where 64 bits allow it.
    pub fn new(network: &Network, plan: &Plan) -> Result<Self, PlanError> {
        let tenth = Time::ONE.checked_div(10).unwrap_or_default();
        Ok(Self(match Strategy::new(network, plan, &[tenth])? {
            Some(strategy) => Kind::Uncertain(Box::new(uncertain::Pins::new(strategy, network.nodes.len())?)),
            None => Kind::Certain(Box::new(certain::Pins::new(network, plan, tenth)?)),
        }))
    }

    /// Takes hold of an event and answers the window that the other pins leave it: [`PinnedPlan::move_to`] moves it
    /// within. `None` for an event that the plan does not select or whose time is not free.
    pub fn grab(&mut self, node: NodeId) -> Option<tpn::Window> {
        of_both!(&mut self.0, pins => pins.grab(node))
    }

    /// Pins the grabbed event to the moment of its window that is nearest to `time`, and changes all other windows with
    /// it. Answers the moment; `None` if nothing is grabbed.
    pub fn move_to(&mut self, time: Time) -> Option<Time> {
        of_both!(&mut self.0, pins => pins.move_to(time))
    }

    /// Lets go of the grabbed event; it stays where it is.
    pub fn drop_grabbed(&mut self) {
        of_both!(&mut self.0, pins => pins.drop_grabbed());
    }

    /// Puts the grabbed event back where it was before it was grabbed. Returns whether one was grabbed.
    pub fn put_back(&mut self) -> bool {
        of_both!(&mut self.0, pins => pins.put_back())
    }

    /// Takes away the pin of an event.
    pub fn release(&mut self, node: NodeId) {
        of_both!(&mut self.0, pins => pins.release(node));
    }

    /// Takes away all pins, and goes back to the start of the run.
    pub fn release_all(&mut self) {
        of_both!(&mut self.0, pins => pins.release_all());
    }

    /// The pinned events and their times, in the order of the events.
    pub fn pins(&self) -> Vec<(NodeId, Time)> {
        of_both!(&self.0, pins => pins.all())
    }

    /// The event that is being moved, and its window under the other pins.
    pub fn grabbed(&self) -> Option<(NodeId, tpn::Window)> {
        of_both!(&self.0, pins => pins.grabbed())
    }

    /// The windows under all pins, in the form of [`Plan::windows`].
    pub fn windows(&self, num_nodes: usize) -> Vec<Option<tpn::Window>> {
        match &self.0 {
            Kind::Certain(pins) => pins.windows(num_nodes),
            Kind::Uncertain(pins) => pins.course().windows.clone(),
        }
    }

    /// How the run stands in which nature does what is pinned; `None` if it chooses nothing in this plan.
    pub fn course(&self) -> Option<&Course> {
        match &self.0 {
            Kind::Certain(_) => None,
            Kind::Uncertain(pins) => Some(pins.course()),
        }
    }

    /// Whether nothing was pinned, and no time let pass.
    pub fn is_untouched(&self) -> bool {
        match &self.0 {
            Kind::Certain(pins) => pins.all().is_empty(),
            Kind::Uncertain(pins) => pins.is_untouched(),
        }
    }

    /// Takes the last step of a run back: what was chosen last, or the time that was let pass. Answers whether there was
    /// one.
    pub fn take_back(&mut self) -> bool {
        match &mut self.0 {
            Kind::Certain(_) => false,
            Kind::Uncertain(pins) => pins.take_back(),
        }
    }

    /// Begins a run, or lets time pass until the next thing happens. Answers whether something was left to happen.
    pub fn go_on(&mut self) -> bool {
        match &mut self.0 {
            Kind::Certain(_) => false,
            Kind::Uncertain(pins) => pins.go_on(),
        }
    }
}
