//! What a rule means of a plan: the instants that break it, as a condition on which events have come.

mod breach;
mod known;
mod words;

use std::ops::ControlFlow;

use exact::{Bound, Rational, Time};
use rmpl::program::{Change as Changes, Program};
use rmpl::rule::{Activity, Moment, Rule};
use tpn::{Network, NodeId, OccurrenceKind, Plan, PlanOrder, Supply};

use self::breach::{Breach, at_levels, earliest};
use self::known::{Asked, Reading};
use super::cases::{Condition, MAX_PAIRS, TooMany, each_case};
use super::cut::{Edge, Times, joined};
use super::level::{Change, Resource};
use super::{Finding, Outcome};

/// The times that a rule names.
pub(super) fn times_of(rule: &Rule) -> Vec<Time> {
    match rule.moment {
        Moment::Within { from, to } => [Some(from), to.finite()].into_iter().flatten().collect(),
        Moment::Throughout | Moment::Start(_) | Moment::End(_) => Vec::new(),
    }
}

/// A plan, and when its events can be.
pub(super) struct Meaning<'a> {
    program: &'a Program,
    network: &'a Network,
    plan: &'a Plan,
    times: Times,
    resources: Vec<Resource>,
    /// Which of two intervals that must not overlap comes first.
    order: PlanOrder,
}

/// Where instants are looked for.
struct Place {
    scope: Condition,
    /// An instant at which something starts or ends: what touches it counts, as for `requires at start`.
    is_instant: bool,
}

impl<'a> Meaning<'a> {
    pub(super) fn new(program: &'a Program, network: &'a Network, plan: &'a Plan, times: Times) -> Self {
        let resources = (0..network.resources.len()).map(|index| resource(network, plan, index)).collect();
        Self { program, network, plan, times, resources, order: PlanOrder::new(plan) }
    }

    /// Holds the plan against a rule; `None` if there are too many cases.
    pub(super) fn examine(
        &mut self,
        text: &str,
        rule: &Rule,
        stop: &mut dyn FnMut() -> bool,
    ) -> Option<Finding> {
        let (mut applies, mut doubts, mut breaches) = (Vec::new(), Vec::new(), Vec::new());
        for place in self.places(&rule.moment)? {
            let reading = if place.is_instant { Reading::Touching } else { Reading::Between };
            // Where something touches the end of what is looked at, it is looked at still.
            let during = |meaning: &Self, asked: Asked| match &rule.during {
                Some(during) => meaning.condition(during, asked, reading.of_negation()),
                None => Condition::All(Vec::new()),
            };
            let looked_at = Condition::All(vec![place.scope.clone(), during(self, Asked::NotDenied)]);
            applies.extend(self.breaches(&looked_at, stop).ok()?.into_iter().map(|it| it.stretch));
            let not_held = self.condition(&rule.holds, Asked::NotKnown, reading);
            let doubt = Condition::All(vec![looked_at, not_held]);
            let found = self.breaches(&doubt, stop).ok()?;
            if !found.is_empty() {
                let denied = self.condition(&rule.holds, Asked::Denied, reading);
                let broken = Condition::All(vec![doubt, during(self, Asked::Known), denied]);
                breaches.extend(self.breaches(&broken, stop).ok()?);
            }
            doubts.extend(found);
        }
        let is_broken = !breaches.is_empty();
        let stretches = |breaches: &[Breach]| joined(breaches.iter().map(|it| it.stretch).collect());
        let (breaks, open) = (stretches(&breaches), stretches(&doubts));
        let told = if is_broken { &breaks } else { &open };
        let Some(breach) = earliest(if is_broken { breaches } else { doubts }) else {
            let outcome = if applies.is_empty() { Outcome::NeverApplies } else { Outcome::Holds };
            return Some(Finding { applies: joined(applies), ..Finding::without_times(text, outcome) });
        };
        let nodes = self.decisive(&breach);
        let stretch = told.iter().find(|it| it.from <= breach.stretch.from && breach.stretch.to <= it.to);
        let words = self.words(*stretch.unwrap_or(&breach.stretch), &breach, &nodes);
        let mut names: Vec<String> = nodes.iter().filter_map(|&(node, _)| self.owner(node)).collect();
        names.dedup();
        let outcome = if is_broken { Outcome::Broken(words) } else { Outcome::Unsure(words) };
        let nodes = nodes.into_iter().map(|(node, _)| node).collect();
        Some(Finding { rule: text.to_owned(), outcome, applies: joined(applies), breaks, open, names, nodes })
    }

    fn places(&self, moment: &Moment) -> Option<Vec<Place>> {
        let (start, end) = (self.network.start, self.network.end);
        let at = |node: NodeId| {
            Condition::All(vec![
                Condition::Edge(Edge::past(node, true)),
                Condition::Edge(Edge::future(node, true)),
            ])
        };
        let instant = |node: NodeId| Place { scope: at(node), is_instant: true };
        let within =
            vec![Condition::Edge(Edge::past(start, true)), Condition::Edge(Edge::future(end, false))];
        Some(match moment {
            Moment::Throughout => {
                vec![Place { scope: Condition::All(within), is_instant: false }, instant(end)]
            }
            Moment::Within { from, to } => {
                let mut bounds =
                    vec![Condition::Edge(Edge::past(start, true).after(self.times.ticks(*from)?))];
                if let Bound::Finite(to) = *to {
                    let to = self.times.ticks(to)?;
                    bounds.push(Condition::Edge(Edge::future(start, false).after(to)));
                }
                let inside = [within, bounds.clone()].concat();
                bounds.push(at(end));
                vec![
                    Place { scope: Condition::All(inside), is_instant: false },
                    Place { scope: Condition::All(bounds), is_instant: true },
                ]
            }
            Moment::Start(None) => vec![instant(start)],
            Moment::End(None) => vec![instant(end)],
            Moment::Start(Some(of)) => self.occurrences(of).map(|(start, _)| instant(start)).collect(),
            Moment::End(Some(of)) => self.occurrences(of).map(|(_, end)| instant(end)).collect(),
        })
    }

    /// The activities of the plan that are meant, from start to end.
    fn occurrences(&self, of: &Activity) -> impl Iterator<Item = (NodeId, NodeId)> {
        let is_meant = move |it: &&tpn::Occurrence| {
            matches!(it.kind, OccurrenceKind::Primitive | OccurrenceKind::Activity)
                && it.activity == of.name
                && of.arguments.as_ref().is_none_or(|arguments| *arguments == it.arguments)
        };
        let is_selected = |it: &&tpn::Occurrence| {
            let arc = it.arc.is_none_or(|arc| self.plan.selected_arcs.get(arc.index()) == Some(&true));
            arc && self.plan.selected_nodes.get(it.start.index()) == Some(&true)
        };
        self.network.occurrences.iter().filter(is_meant).filter(is_selected).map(|it| (it.start, it.end))
    }

    /// The cases that meet a condition, with when that is.
    fn breaches(
        &mut self,
        condition: &Condition,
        stop: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<Breach>, TooMany> {
        let mut found = Vec::new();
        let mut is_decided = true;
        let mut pairs = MAX_PAIRS;
        let resources = &self.resources;
        each_case(&mut self.times, condition, stop, &mut |times, case| {
            match at_levels(times, resources, case, &mut pairs) {
                Some(more) => found.extend(more),
                None => is_decided = false,
            }
            if is_decided { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        })?;
        if is_decided { Ok(found) } else { Err(TooMany) }
    }
}

/// The changes of a resource in a plan.
fn resource(network: &Network, plan: &Plan, index: usize) -> Resource {
    let supply = network.resources[index].supply;
    let selected = network.uses.iter().filter(|used| {
        used.resource.index() == index && plan.selected_arcs.get(used.arc.index()) == Some(&true)
    });
    let less = |amount: Rational| amount.checked_neg().unwrap_or(Rational::ZERO);
    let mut changes = Vec::new();
    for used in selected.filter(|used| !used.amount.is_zero()) {
        let (start, end, amount) = (used.start, used.end, used.amount);
        if used.change == Changes::Uses {
            changes.push(Change { node: start, more: [amount; 2], is_start: true });
            changes.push(Change { node: end, more: [less(amount); 2], is_start: false });
        } else {
            let is_start = used.change == Changes::Consumes;
            changes.push(Change { node: used.moment(), more: used.level_changes(), is_start });
        }
    }
    let first = match supply {
        Supply::Reusable { .. } => Rational::ZERO,
        Supply::Reservoir { level, .. } => level,
    };
    Resource { first, changes }
}
