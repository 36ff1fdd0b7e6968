//! Variables that keep their values over time (SPEC 10): which value holds from when to when, who changes it, and who
//! needs it.
//!
//! In every schedule of a plan the changes of a variable come in one order, so each value lasts from the event that
//! makes it hold to the start of the next change.

use std::cmp::Ordering::{Greater, Less};

use rmpl::program::LabelMode;
use smol_str::{SmolStr, format_smolstr};
use tpn::{Extent, Label, LabelId, Network, Plan, PlanOrder, ValueSet};

use super::row::{Bar, BarKind, Item, RowKind, times};

/// The rows of the variables of a plan that keep their values, each with the number of its variable.
pub(super) fn items(network: &Network, plan: &Plan) -> Vec<(usize, Item)> {
    let order = PlanOrder::new(plan);
    let tracks = network.variables.iter().enumerate().filter(|(_, variable)| variable.is_lasting);
    tracks
        .filter_map(|(index, variable)| {
            let bars = track(network, plan, &order, index);
            let item = Item { kind: RowKind::State, name: variable.name.clone(), key: None, depth: 1, bars };
            (!item.bars.is_empty()).then_some((index, item))
        })
        .collect()
}

/// The bars of one variable: its changes and values in their order, then who needs them.
fn track(network: &Network, plan: &Plan, order: &PlanOrder, variable: usize) -> Vec<Bar> {
    let is_selected = |label: &Label| {
        label.literal.variable.index() == variable && plan.selected_arcs.get(label.arc.index()) == Some(&true)
    };
    let labels = || {
        let all = network.labels.iter().enumerate();
        all.filter(|(_, label)| is_selected(label)).map(|(index, _)| LabelId::from_index(index))
    };
    let is_told = |label: &LabelId| network.labels[label.index()].mode == LabelMode::Tell;
    let producers = in_order(network, plan, order, labels().filter(is_told).collect());
    let mut bars = Vec::new();
    for (at, &label) in producers.iter().enumerate() {
        let (start, _) = network.interval(label);
        let ready = network.ready(label);
        if network.labels[label.index()].is_changing() {
            bars.extend(bar(network, plan, label, BarKind::Changing, [start, ready]));
        }
        let until = producers.get(at + 1).map_or(network.end, |&next| network.interval(next).0);
        bars.extend(bar(network, plan, label, BarKind::Value, [ready, until]));
    }
    for label in labels().filter(|label| !is_told(label)) {
        let (start, end) = network.interval(label);
        bars.extend(bar(network, plan, label, BarKind::Need, [start, end]));
    }
    bars
}

fn bar(
    network: &Network,
    plan: &Plan,
    label: LabelId,
    kind: BarKind,
    events: [tpn::NodeId; 2],
) -> Option<Bar> {
    let [start, end] = times(plan, events)?;
    let written = &network.labels[label.index()];
    Some(Bar {
        kind,
        occurrence: written.owner,
        label: Some(label),
        events,
        name: values(network, written),
        category: None,
        start,
        end,
        free: [start, end],
        natures: None,
        labels: Vec::new(),
    })
}

/// Changes from first to last: by when they begin and are done in the earliest schedule, and, of those at one instant, as
/// the plan orders them.
fn in_order(network: &Network, plan: &Plan, order: &PlanOrder, mut producers: Vec<LabelId>) -> Vec<LabelId> {
    let key = |label: LabelId| {
        let events = [network.interval(label).0, network.ready(label)];
        let is_first = network.labels[label.index()].extent == Extent::Initial;
        (!is_first, times(plan, events).map_or([0.0; 2], |[start, ready]| [start[0], ready[0]]))
    };
    let compare = |&left: &LabelId, &right: &LabelId| {
        let (one, other) = (key(left), key(right));
        let by_time = one.1[0].total_cmp(&other.1[0]).then(one.1[1].total_cmp(&other.1[1]));
        one.0.cmp(&other.0).then(by_time)
    };
    producers.sort_by(compare);
    // Few share an instant; among them the plan's own order is followed as far as it says one.
    for at in 1..producers.len() {
        for back in (1..=at).rev() {
            let (left, right) = (producers[back - 1], producers[back]);
            let is_tied = !matches!(compare(&left, &right), Less | Greater);
            if !is_tied || !order.is_before(right, left) {
                break;
            }
            producers.swap(back - 1, back);
        }
    }
    producers
}

/// The values of a condition without its variable: `OUT`, `not IN`, `A or B`.
fn values(network: &Network, label: &Label) -> SmolStr {
    let Some(variable) = network.variables.get(label.literal.variable.index()) else {
        return label.text.clone();
    };
    let names = |ids: &[tpn::ValueId]| {
        let names: Vec<&str> =
            ids.iter().filter_map(|id| variable.values.get(id.index())).map(SmolStr::as_str).collect();
        names.join(" or ")
    };
    match &label.literal.values {
        ValueSet::In(ids) => names(ids).into(),
        ValueSet::NotIn(ids) => format_smolstr!("not {}", names(ids)),
    }
}

/// Returns what a bar of a state track represents, in lines: which value, who made it so, and who needs it.
pub fn words(network: &Network, plan: &Plan, bar: &Bar) -> Vec<String> {
    lines(network, plan, bar).iter().map(|line| network.readable(line)).collect()
}

/// The same with identifiers of calls.
fn lines(network: &Network, plan: &Plan, bar: &Bar) -> Vec<String> {
    let Some((id, label)) = bar.label.and_then(|id| Some((id, network.labels.get(id.index())?))) else {
        return Vec::new();
    };
    let owner_of = |label: LabelId| {
        let owner = network.labels.get(label.index())?.owner?;
        Some(network.occurrences.get(owner.index())?.name.as_str())
    };
    let variable = network.variables.get(label.literal.variable.index()).map_or("", |it| it.name.as_str());
    let owner = owner_of(id).unwrap_or("the mission");
    match bar.kind {
        BarKind::Need => {
            let carrier = plan.causal_links.iter().find(|link| link.ask == id);
            let mut lines = vec![format!("{owner} {}", crate::text::label_words(label))];
            lines.extend(carrier.map(|link| format!("supported by {}", network.label_name(link.tell))));
            lines
        }
        BarKind::Changing => vec![format!("{variable} is changing: {owner} sets it to {}", bar.name)],
        _ => {
            let from = match label.extent {
                Extent::Initial => format!("{variable} is initially {}", bar.name),
                Extent::Effect => format!("{variable} is {}, set by {owner}", bar.name),
                _ => format!("{variable} is {}, asserted by {owner}", bar.name),
            };
            let needed = plan.causal_links.iter().filter(|link| link.tell == id);
            let needed: Vec<&str> = needed.filter_map(|link| owner_of(link.ask)).collect();
            let needed = if needed.is_empty() {
                "no activity needs it".to_owned()
            } else {
                format!("required by {}", needed.join(", "))
            };
            vec![from, needed]
        }
    }
}
