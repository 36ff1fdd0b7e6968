//! What several tests of the planner need: missions compiled, plans told by names.

use std::collections::{BTreeMap, BTreeSet};

use exact::Bound;
use kirk::{Options, Outcome, Search, Unlimited};
use tpn::compile::{Top, compile};
use tpn::{Network, Plan};

/// The network of a mission that must compile.
pub(crate) fn network(text: &str) -> Network {
    let program = rmpl::parse(text).program();
    let (network, diagnostics) = compile(&program, &Top::Scenario(None));
    network.unwrap_or_else(|| panic!("does not compile: {diagnostics:?}\n{text}"))
}

/// All options at their defaults but these.
pub(crate) fn options(search: Search, all: bool) -> Options {
    Options { search, all, explain: false, relax: false, ..Options::default() }
}

/// Plans without a limit.
pub(crate) fn plan(network: &Network, search: Search, all: bool) -> Outcome {
    kirk::plan(network, &options(search, all), &mut Unlimited)
}

/// A plan in the names of the contracts, for comparison.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct NamedPlan {
    pub(crate) choices: BTreeMap<String, u64>,
    pub(crate) causal_links: BTreeSet<(String, String)>,
    pub(crate) conflict_order: BTreeSet<(String, String)>,
    /// Times as they are printed.
    pub(crate) windows: BTreeMap<String, (String, String)>,
}

/// Tells a plan in names.
pub(crate) fn named(network: &Network, plan: &Plan) -> NamedPlan {
    let mut windows = BTreeMap::new();
    for (node, window) in network.nodes.iter().zip(&plan.windows) {
        for &event in &node.events {
            if let Some(window) = window {
                let earliest = Bound::Finite(window.earliest).to_string();
                windows.insert(network.event_name(event), (earliest, window.latest.to_string()));
            }
        }
    }
    let name = |label| network.label_name(label);
    NamedPlan {
        choices: plan
            .choices
            .iter()
            .map(|choice| (Network::decision_name(choice.decision), u64::from(choice.alternative)))
            .collect(),
        causal_links: plan.causal_links.iter().map(|link| (name(link.ask), name(link.tell))).collect(),
        conflict_order: plan
            .conflict_order
            .iter()
            .map(|order| (name(order.first), name(order.then)))
            .collect(),
        windows,
    }
}
