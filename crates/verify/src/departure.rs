//! How long movements take at least from where they start (SPEC 10.3), as far as the network knows that.

use std::collections::BTreeSet;

use exact::Time;
use tpn::{Departure, LabelId, Network, Plan, ValueSet};

use crate::labels;

/// A selected movement with the producer right before it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Movement {
    pub(crate) arrival: LabelId,
    pub(crate) before: LabelId,
    /// What it takes at least from where that producer leaves the vehicle; `None` if it cannot be driven from there.
    pub(crate) least: Option<Time>,
}

/// The movements whose start the plan's order of changes decides and the network knows.
pub(crate) fn of_plan(network: &Network, plan: &Plan) -> Vec<Movement> {
    let arrivals = arrivals(network, plan);
    if arrivals.is_empty() {
        return Vec::new();
    }
    let mut found = Vec::new();
    let neighbors = plan.state_order.iter().flat_map(|order| order.producers.array_windows());
    for &[before, arrival] in neighbors.filter(|[_, arrival]| arrivals.contains(arrival)) {
        if let Some(departure) = known(network, arrival, before) {
            found.push(Movement { arrival, before, least: departure.least });
        }
    }
    found
}

/// The selected movements of which the network knows something.
pub(crate) fn arrivals(network: &Network, plan: &Plan) -> BTreeSet<LabelId> {
    (network.departures.iter())
        .map(|departure| departure.arrival)
        .filter(|&arrival| labels::is_selected(network, plan, arrival))
        .collect()
}

/// Returns what the network knows of a movement that starts where a producer leaves the vehicle.
pub(crate) fn known(network: &Network, arrival: LabelId, before: LabelId) -> Option<&Departure> {
    let values = &network.labels[before.index()].literal.values;
    let starts_there = |departure: &&Departure| {
        departure.arrival == arrival && *values == ValueSet::In(vec![departure.from])
    };
    network.departures.iter().find(starts_there)
}
