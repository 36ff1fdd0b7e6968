//! Plans of networks without choices: everything is selected, as early as the lower bounds allow.

use exact::{Bound, Time};
use tpn::{Network, Plan, Quality, Window};

/// Each event may come `slack` units later than at the earliest; without, as late as it likes.
pub fn earliest_plan(network: &Network, slack: Option<i64>) -> Plan {
    let mut earliest = vec![Time::ZERO; network.nodes.len()];
    let mut has_changed = true;
    while std::mem::take(&mut has_changed) {
        for arc in &network.arcs {
            let reached = earliest[arc.from.index()].checked_add(arc.lower).expect("a small time");
            if reached > earliest[arc.to.index()] {
                earliest[arc.to.index()] = reached;
                has_changed = true;
            }
        }
    }
    let latest = |earliest: Time| match slack {
        Some(slack) => Bound::Finite(earliest.checked_add(slack.into()).expect("a small time")),
        None => Bound::Infinite,
    };
    Plan {
        choices: Vec::new(),
        selected_nodes: vec![true; network.nodes.len()],
        selected_arcs: vec![true; network.arcs.len()],
        causal_links: Vec::new(),
        conflict_order: Vec::new(),
        conflict_order_omitted: 0,
        state_order: Vec::new(),
        orderings_added: Vec::new(),
        uses_ordered: Vec::new(),
        levels: Vec::new(),
        quality: Quality::default(),
        windows: earliest.iter().map(|&it| Some(Window { earliest: it, latest: latest(it) })).collect(),
    }
}
