//! A time that does not fit, and the event at which that was found.

use std::collections::VecDeque;

use tpn::{Network, NodeId};

/// A time does not fit into 64 bits after scaling by the common denominator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TimeOverflow {
    /// The event whose time it is, or whose distance from another; of several at one time any of them.
    pub(crate) event: NodeId,
}

impl TimeOverflow {
    /// At an event.
    pub(crate) const fn at(event: NodeId) -> Self {
        Self { event }
    }

    /// In the author's terms.
    pub(crate) fn message(self, network: &Network) -> String {
        let what = "a time does not fit into 64 bits after scaling by the common denominator";
        match name(network, self.event) {
            Some(event) => format!("{what}: that of {event}"),
            None => what.to_owned(),
        }
    }
}

impl From<stn::Overflow> for TimeOverflow {
    fn from(overflow: stn::Overflow) -> Self {
        Self::at(NodeId(overflow.point.0))
    }
}

/// What people call an event: its innermost name, where it has one, otherwise that of the nearest event after it.
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
