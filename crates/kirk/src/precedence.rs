//! What links, orders and departures say about times, as edges of a simple temporal network.

use stn::PointId;
use tpn::{UseId, UseOrdering};

use crate::demands::{ModelSupply, ModelUse};
use crate::model::{Model, point};
use crate::trace::{Departing, TreeChoice};

/// `to − from ≤ weight`.
pub(crate) type StnEdge = (PointId, PointId, i64);

/// Returns what a choice says about times.
pub(crate) fn edges(model: &Model, choice: TreeChoice) -> Vec<StnEdge> {
    match choice {
        TreeChoice::Decision { .. }
        | TreeChoice::NoLink { .. }
        | TreeChoice::Later { .. }
        | TreeChoice::Apart => Vec::new(),
        TreeChoice::Link(link) => {
            let (ask_start, ask_end) = model.interval(link.ask);
            let (tell_start, tell_end) = model.interval(link.tell);
            let label = &model.conditions.labels[link.tell];
            if label.is_lasting {
                let ready = if label.is_changing { tell_end } else { tell_start };
                vec![(ask_start, ready, 0)]
            } else {
                vec![(ask_start, tell_start, 0), (tell_end, ask_end, 0)]
            }
        }
        TreeChoice::Order(order) => {
            let is_lasting = model.conditions.labels[order.first].is_lasting;
            let gap = if is_lasting { 0 } else { model.gap_before(order.then, model.gap) };
            vec![(model.interval(order.then).0, model.interval(order.first).1, -gap)]
        }
        TreeChoice::UseOrder(order) => use_order(model, order).into_iter().collect(),
        TreeChoice::Start { used, by } => {
            let start = find_use(model, used).map(|(_, used)| point(used.start));
            start
                .zip(model.units(by).ok())
                .map(|(start, by)| (point(model.start), start, by))
                .into_iter()
                .collect()
        }
        TreeChoice::Departure(Departing { movement, before }) => {
            let departures = model.demands.departures.get(&movement);
            let departure = departures.and_then(|departures| {
                departures.iter().find(|departure| model.conditions.gives_value(before, departure.from))
            });
            let (start, end) = model.interval(movement);
            let least = departure.and_then(|departure| departure.least);
            least.map(|least| (end, start, -least)).into_iter().collect()
        }
    }
}

fn use_order(model: &Model, order: UseOrdering) -> Option<StnEdge> {
    let ((supply, first), (_, then)) = (find_use(model, order.first)?, find_use(model, order.then)?);
    let (earlier, later) = match supply {
        ModelSupply::Reusable { .. } => (first.end, then.start),
        ModelSupply::Reservoir { .. } => (first.last_moment(), then.moment()),
    };
    Some((point(later), point(earlier), 0))
}

fn find_use(model: &Model, id: UseId) -> Option<(ModelSupply, &ModelUse)> {
    model.demands.resources.iter().find_map(|resource| {
        let used = resource.uses.iter().find(|used| used.id == id)?;
        Some((resource.supply, used))
    })
}
