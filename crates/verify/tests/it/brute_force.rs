//! A second checker, naive on purpose: it lists every schedule in whole units and looks at each. Bounds and gaps are whole,
//! so that what all these schedules keep, all schedules keep (the vertices of a simple temporal network are whole).

use std::collections::BTreeSet;

use exact::Bound;
use rmpl::program::LabelMode;
use tpn::{Label, LabelId, Network, NodeId, Plan, ValueSet, Window};

use crate::missions::{Constraint, closure, constraints, time, units};

/// A time for each node, in units; those of nodes that are not selected mean nothing.
pub type Schedule = Vec<i64>;

/// All schedules of the selected nodes within the constraints, from 0 to `horizon`; `None` where there are too many.
pub fn schedules(network: &Network, plan: &Plan, horizon: i64, most: usize) -> Option<Vec<Schedule>> {
    let constraints = constraints(network, plan);
    let mut order = vec![network.start];
    for at in 0..network.nodes.len() {
        let Some(&node) = order.get(at) else { break };
        for &arc in &network.nodes[node.index()].out_arcs {
            let to = network.arcs[arc.index()].to;
            if plan.selected_arcs[arc.index()] && !order.contains(&to) {
                order.push(to);
            }
        }
    }
    let mut found = Vec::new();
    let mut times = vec![None; network.nodes.len()];
    extend(&constraints, &order, 0, horizon, &mut times, &mut found, most).then_some(found)
}

/// Adds all schedules that complete `times`; returns whether there are not too many.
fn extend(
    constraints: &[Constraint],
    order: &[NodeId],
    at: usize,
    horizon: i64,
    times: &mut Vec<Option<i64>>,
    found: &mut Vec<Schedule>,
    most: usize,
) -> bool {
    let Some(&node) = order.get(at) else {
        found.push(times.iter().map(|time| time.unwrap_or(0)).collect());
        return found.len() <= most;
    };
    let latest = if at == 0 { 0 } else { horizon };
    for time in 0..=latest {
        times[node.index()] = Some(time);
        let is_kept = constraints.iter().filter(|it| it.from == node || it.to == node).all(|it| {
            match (times[it.from.index()], times[it.to.index()]) {
                (Some(from), Some(to)) => is_within(it, to - from),
                _ => true,
            }
        });
        if is_kept && !extend(constraints, order, at + 1, horizon, times, found, most) {
            return false;
        }
    }
    times[node.index()] = None;
    true
}

fn is_within(constraint: &Constraint, duration: i64) -> bool {
    let upper = match constraint.upper {
        Bound::Finite(upper) => units(upper),
        Bound::Infinite => i64::MAX,
    };
    (units(constraint.lower)..=upper).contains(&duration)
}

/// Returns whether the definitions accept a plan, given all its schedules up to the horizon that bounds them.
pub fn accepts_plan(network: &Network, plan: &Plan, schedules: &[Schedule]) -> bool {
    let choices = &plan.choices;
    let (nodes, arcs) = closure(network, choices);
    let decided: BTreeSet<_> = choices.iter().map(|choice| choice.decision).collect();
    let reached: BTreeSet<_> =
        (network.nodes.iter().zip(&nodes)).filter(|(_, is)| **is).filter_map(|(it, _)| it.decision).collect();
    let is_selection = decided.len() == choices.len()
        && decided == reached
        && (plan.selected_nodes == nodes && plan.selected_arcs == arcs && nodes[network.end.index()]);
    is_selection
        && has_links(network, plan)
        && !schedules.is_empty()
        && has_orders(network, plan, schedules)
        && has_windows(network, plan, schedules)
}

fn has_links(network: &Network, plan: &Plan) -> bool {
    let asks = selected(network, plan, LabelMode::Ask);
    let linked: Vec<LabelId> = plan.causal_links.iter().map(|link| link.ask).collect();
    let tells = selected(network, plan, LabelMode::Tell);
    linked.len() == asks.len()
        && asks.iter().all(|ask| linked.contains(ask))
        && (plan.causal_links.iter()).all(|link| {
            let (ask, tell) = (&network.labels[link.ask.index()], &network.labels[link.tell.index()]);
            // The constraints of the link see to it that the Tell contains the Ask.
            tells.contains(&link.tell)
                && same_variable(ask, tell)
                && values(network, tell).is_subset(&values(network, ask))
        })
}

fn has_orders(network: &Network, plan: &Plan, schedules: &[Schedule]) -> bool {
    let pairs = conflicting(network, plan);
    let said: Vec<(LabelId, LabelId)> = plan.conflict_order.iter().map(|it| (it.first, it.then)).collect();
    let is_pair =
        |one: LabelId, other: LabelId| pairs.contains(&(one, other)) || pairs.contains(&(other, one));
    let each_once = pairs.iter().all(|&(one, other)| {
        let ways =
            said.iter().filter(|&&it| it == (one, other) || it == (other, one)).collect::<BTreeSet<_>>();
        ways.len() == 1
    });
    let all_hold = said.iter().all(|&(first, then)| {
        let (end, start) = (span(network, first).1, span(network, then).0);
        let gap = if is_instant(network, first) { units(network.threat_gap) } else { 0 };
        let is_one_arc = network.labels[first.index()].arc == network.labels[then.index()].arc;
        is_pair(first, then) && !is_one_arc && schedules.iter().all(|at| at[start] - at[end] >= gap)
    });
    let added_are_said = plan
        .orderings_added
        .iter()
        .all(|it| said.contains(&(it.first, it.then)) || said.contains(&(it.then, it.first)));
    each_once && all_hold && added_are_said
}

/// The windows over all schedules; there is one for each selected node.
pub fn windows(plan: &Plan, schedules: &[Schedule]) -> Vec<Option<Window>> {
    let window = |(node, &is_selected): (usize, &bool)| {
        let earliest = schedules.iter().map(|at| at[node]).min()?;
        let latest = schedules.iter().map(|at| at[node]).max()?;
        is_selected.then_some(Window { earliest: time(earliest), latest: Bound::Finite(time(latest)) })
    };
    plan.selected_nodes.iter().enumerate().map(window).collect()
}

fn has_windows(network: &Network, plan: &Plan, schedules: &[Schedule]) -> bool {
    let exact = windows(plan, schedules);
    // A plan that is read back has windows of named events only.
    (0..network.nodes.len()).all(|node| {
        let is_unreported = plan.windows[node].is_none() && network.nodes[node].events.is_empty();
        plan.windows[node] == exact[node] || is_unreported
    })
}

/// Returns whether the definitions accept a schedule of a plan's selection, which must be a closed one.
pub fn accepts_schedule(network: &Network, plan: &Plan, at: &Schedule) -> bool {
    let arcs = network.arcs.iter().zip(&plan.selected_arcs).filter(|(_, is_selected)| **is_selected);
    let keeps_durations = arcs.map(|(arc, _)| arc).all(|arc| {
        let constraint = Constraint { from: arc.from, to: arc.to, lower: arc.lower, upper: arc.upper };
        is_within(&constraint, at[arc.to.index()] - at[arc.from.index()])
    });
    let tells = selected(network, plan, LabelMode::Tell);
    let is_supported = |ask: LabelId| {
        tells.iter().any(|&tell| {
            let (required, asserted) = (&network.labels[ask.index()], &network.labels[tell.index()]);
            let ((start, end), (from, to)) = (span(network, ask), span(network, tell));
            same_variable(required, asserted)
                && values(network, asserted).is_subset(&values(network, required))
                && at[from] <= at[start]
                && at[end] <= at[to]
        })
    };
    keeps_durations
        && selected(network, plan, LabelMode::Ask).into_iter().all(is_supported)
        && conflicting(network, plan).into_iter().all(|(one, other)| !overlap(network, at, one, other))
}

fn overlap(network: &Network, at: &Schedule, one: LabelId, other: LabelId) -> bool {
    if network.labels[one.index()].arc == network.labels[other.index()].arc {
        return true;
    }
    let ((from, to), (start, end)) = (span(network, one), span(network, other));
    let (from, to, start, end) = (at[from], at[to], at[start], at[end]);
    if units(network.threat_gap) == 0 {
        return !(to <= start || end <= from);
    }
    match (is_instant(network, one), is_instant(network, other)) {
        (true, true) => from == start,
        (true, false) => (start..end).contains(&from),
        (false, true) => (from..to).contains(&start),
        (false, false) => from.max(start) < to.min(end),
    }
}

fn selected(network: &Network, plan: &Plan, mode: LabelMode) -> Vec<LabelId> {
    (0..network.labels.len())
        .map(LabelId::from_index)
        .filter(|label| {
            let label = &network.labels[label.index()];
            label.mode == mode && plan.selected_arcs[label.arc.index()]
        })
        .collect()
}

/// The pairs of selected labels that can never hold together.
pub fn conflicting(network: &Network, plan: &Plan) -> Vec<(LabelId, LabelId)> {
    let mut labels = selected(network, plan, LabelMode::Ask);
    labels.extend(selected(network, plan, LabelMode::Tell));
    labels.sort_unstable();
    let mut pairs = Vec::new();
    for (index, &one) in labels.iter().enumerate() {
        for &other in &labels[index + 1..] {
            let (first, second) = (&network.labels[one.index()], &network.labels[other.index()]);
            if same_variable(first, second) && values(network, first).is_disjoint(&values(network, second)) {
                pairs.push((one, other));
            }
        }
    }
    pairs
}

fn same_variable(one: &Label, other: &Label) -> bool {
    one.literal.variable == other.literal.variable
}

/// The values that a label allows, by name; of an open domain `…` represents all that no label names.
fn values(network: &Network, label: &Label) -> BTreeSet<String> {
    let variable = &network.variables[label.literal.variable.index()];
    let named = |ids: &[tpn::ValueId]| -> BTreeSet<String> {
        ids.iter().map(|value| variable.values[value.index()].to_string()).collect()
    };
    match &label.literal.values {
        ValueSet::In(ids) => named(ids),
        ValueSet::NotIn(ids) => {
            let mut all: BTreeSet<String> = variable.values.iter().map(ToString::to_string).collect();
            if !variable.closed {
                all.insert("…".to_owned());
            }
            &all - &named(ids)
        }
    }
}

/// The indices of a label's first and last event.
fn span(network: &Network, label: LabelId) -> (usize, usize) {
    let arc = &network.arcs[network.labels[label.index()].arc.index()];
    (arc.from.index(), arc.to.index())
}

fn is_instant(network: &Network, label: LabelId) -> bool {
    let arc = &network.arcs[network.labels[label.index()].arc.index()];
    arc.lower == time(0) && arc.upper == Bound::Finite(time(0))
}
