//! What is in the way of planning a network at all.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};
use tpn::{Network, NodeId};

/// Something of a network, or of what planning it takes, does not fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unplannable {
    /// A time does not fit into 64 bits after scaling by the common denominator: that of this event, or its distance from
    /// another; of several at one time any of them.
    Time(NodeId),
    /// There are more possible causal links and orders than memory is taken for.
    Links,
    /// The network's choices are not nested, and it has something that is planned by what each of them brings: states,
    /// resources, objectives, durations that nature chooses, constraints between threads, or several plans to compare.
    Entangled,
}

impl Unplannable {
    /// A time at an event.
    pub(crate) const fn at(event: NodeId) -> Self {
        Self::Time(event)
    }

    /// In the author's terms.
    pub(crate) fn message(self, network: &Network) -> String {
        match self {
            Self::Time(event) => {
                let what = "a time is too large to represent exactly";
                match name(network, event) {
                    Some(event) => format!("{what}: that of {event}"),
                    None => what.to_owned(),
                }
            }
            Self::Links => {
                "the mission is too large to plan: it has more than a million possible causal links and orderings"
                    .to_owned()
            }
            Self::Entangled => {
                "this network cannot be planned: its choices are not nested, or a minimum is negative. States, resources, \
                 objectives, uncontrolled durations and constraints between threads need nested choices and minimums of at \
                 least 0."
                    .to_owned()
            }
        }
    }
}

impl From<stn::Overflow> for Unplannable {
    fn from(overflow: stn::Overflow) -> Self {
        Self::Time(NodeId(overflow.point.0))
    }
}

/// Returns what people call an event: its innermost name, where it has one, otherwise that of the nearest event after
/// it.
fn name(network: &Network, event: NodeId) -> Option<String> {
    let mut seen = vec![false; network.nodes.len()];
    let mut open = VecDeque::from([event]);
    while let Some(node) = open.pop_front() {
        let Some(found) = network.nodes.get(node.index()) else { continue };
        if let Some(&named) = found.events.last() {
            return Some(network.event_name(named));
        }
        if !std::mem::replace(&mut seen[node.index()], true) {
            open.extend(found.out_arcs.iter().map(|arc| network.arcs[arc.index()].to));
        }
    }
    None
}
