//! The check of a schedule (SPEC 5.5, 10, 11): one time for each selected event. It needs no links and no orderings.

mod order;
mod resources;
mod state;

use exact::{Bound, Time};
use rmpl::program::LabelMode;
use tpn::{LabelId, Network, NodeId, Plan};

use crate::labels::{self, Interval, interval};
use crate::uncertainty::natures_events;
use crate::{Rule, Verdict, Violation, node_name, selection};

/// The earliest time of every selected event of `plan`, from its windows: a schedule, if the plan is valid.
pub fn earliest_schedule(plan: &Plan) -> Vec<Option<Time>> {
    plan.windows.iter().map(|window| window.map(|window| window.earliest)).collect()
}

/// Checks the times of `plan`'s selected nodes, indexed by node; the selection is checked as that of a plan is.
///
/// A `[0,0]` interval holds at one instant, which must lie outside conflicting intervals, their start included. With a
/// threat gap of zero the rule is that of planning (SPEC 5.3): of two conflicting intervals one ends no later than the
/// other starts, instants and intervals without length included. An interval that begins at an event that the environment
/// executes may begin at such an instant: there is no gap before it (SPEC 13.1).
///
/// What happens at one instant may happen in any order that follows the text and keeps the rules of state that lasts and of
/// resources (SPEC 10.4). That is decided for twelve events at one instant, whatever they are about, and for as many as one
/// likes whose order is plain; a schedule for which it cannot be decided is refused, with [`Rule::Form`].
pub fn check_schedule(network: &Network, plan: &Plan, times: &[Option<Time>]) -> Verdict {
    if let Err(verdict) = selection::check_form(network, plan) {
        return verdict;
    }
    let mut violations = Vec::new();
    if times.len() != network.nodes.len() {
        return Verdict::new(vec![Violation::new(
            Rule::Form,
            "the schedule belongs to a different network: its nodes differ",
        )]);
    }
    selection::check_selection(network, plan, &mut violations);
    for (index, &selected) in plan.selected_nodes.iter().enumerate() {
        if selected && times[index].is_none() {
            let name = node_name(network, NodeId::from_index(index));
            violations
                .push(Violation::new(Rule::Form, format!("{name} has no time")).with_events(vec![name]));
        }
    }
    if violations.is_empty() {
        let natures = natures_events(network, &plan.selected_arcs);
        let schedule = Schedule { network, plan, times, natures };
        schedule.check_durations(&mut violations);
        schedule.check_supports(&mut violations);
        schedule.check_conflicts(&mut violations);
        schedule.check_states(&mut violations);
        schedule.check_resources(&mut violations);
        // What times alone forbid is told apart; the order within instants says no more then.
        if violations.is_empty() {
            schedule.check_order(&mut violations);
        }
    }
    Verdict::new(violations)
}

struct Schedule<'schedule> {
    network: &'schedule Network,
    plan: &'schedule Plan,
    times: &'schedule [Option<Time>],
    /// By node, whether the environment executes it.
    natures: Vec<bool>,
}

impl Schedule<'_> {
    fn time(&self, node: NodeId) -> Time {
        self.times[node.index()].unwrap_or_default()
    }

    fn check_durations(&self, violations: &mut Vec<Violation>) {
        for (index, arc) in self.network.arcs.iter().enumerate() {
            if !self.plan.selected_arcs[index] {
                continue;
            }
            let names = vec![node_name(self.network, arc.from), node_name(self.network, arc.to)];
            let message = match self.time(arc.to).checked_sub(self.time(arc.from)) {
                None => {
                    format!("the time from {} to {} is too long to represent exactly", names[0], names[1])
                }
                Some(duration) if duration < arc.lower || Bound::Finite(duration) > arc.upper => format!(
                    "from {} to {} is {}, outside [{},{}]",
                    names[0],
                    names[1],
                    Bound::Finite(duration),
                    Bound::Finite(arc.lower),
                    arc.upper
                ),
                Some(_) => continue,
            };
            violations.push(Violation::new(Rule::Duration, message).with_events(names));
        }
    }

    fn check_supports(&self, violations: &mut Vec<Violation>) {
        let mut selected = labels::selected(self.network, self.plan);
        selected.retain(|&label| !labels::is_lasting(self.network, label));
        let (asks, tells): (Vec<LabelId>, Vec<LabelId>) =
            selected.iter().partition(|label| self.network.labels[label.index()].mode == LabelMode::Ask);
        for ask in asks {
            let required = interval(self.network, ask);
            let is_supported = tells.iter().any(|&tell| {
                let asserted = interval(self.network, tell);
                self.network.labels[tell.index()].literal.supports(&self.network.labels[ask.index()].literal)
                    && self.time(asserted.start) <= self.time(required.start)
                    && self.time(required.end) <= self.time(asserted.end)
            });
            if !is_supported {
                let name = self.network.label_name(ask);
                let message = format!("{name} is not inside an assertion that supports it");
                violations.push(Violation::new(Rule::Support, message).with_intervals(vec![name]));
            }
        }
    }

    fn check_conflicts(&self, violations: &mut Vec<Violation>) {
        let selected = labels::selected(self.network, self.plan);
        for (one, other) in labels::conflicting_pairs(self.network, &selected) {
            if self.overlap(interval(self.network, one), interval(self.network, other)) {
                let names = vec![self.network.label_name(one), self.network.label_name(other)];
                let message = format!("{} and {} hold at the same time", names[0], names[1]);
                violations.push(Violation::new(Rule::Conflict, message).with_intervals(names));
            }
        }
    }

    fn overlap(&self, one: Interval, other: Interval) -> bool {
        if one.label != other.label
            && self.network.labels[one.label.index()].arc == self.network.labels[other.label.index()].arc
        {
            return true;
        }
        let times = |interval: Interval| (self.time(interval.start), self.time(interval.end));
        let ((from, to), (start, end)) = (times(one), times(other));
        if self.network.threat_gap.is_zero() {
            return to > start && end > from;
        }
        let is_natures = |interval: Interval| self.natures[interval.start.index()];
        match (one.is_instant, other.is_instant) {
            (true, true) => from == start && !is_natures(one) && !is_natures(other),
            (true, false) => from < end && (start < from || (start == from && !is_natures(other))),
            (false, true) => start < to && (from < start || (from == start && !is_natures(one))),
            (false, false) => from.max(start) < to.min(end),
        }
    }
}
