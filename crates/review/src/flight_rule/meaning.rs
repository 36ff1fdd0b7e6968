//! What a rule means of a plan: the instants that break it, as a condition on which events have come.

mod breach;
mod known;
mod words;

use std::ops::ControlFlow;

use exact::{Bound, Time};
use rmpl::program::Program;
use rmpl::rule::{Activity, Moment, Rule};
use tpn::{Network, NodeId, Occurrence, OccurrenceKind, Plan, PlanOrder};

pub(super) use self::breach::Breach;
use self::breach::{at_levels, earliest};
pub(super) use self::known::{Asked, Reading, tells, untouched};
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
pub(super) struct Place<'network> {
    /// Between these events.
    pub(super) edges: Vec<Edge>,
    /// An instant at which something starts or ends: what touches it counts, as for `requires at start`.
    pub(super) is_instant: bool,
    /// The activity whose moment it is.
    pub(super) of: Option<&'network Occurrence>,
}

impl<'a> Meaning<'a> {
    pub(super) fn new(program: &'a Program, network: &'a Network, plan: &'a Plan, times: Times) -> Self {
        let resources = (0..network.resources.len()).map(|index| resource(network, plan, index)).collect();
        Self { program, network, plan, times, resources, order: PlanOrder::new(plan) }
    }

    /// Holds the plan against a rule; with the earliest breach, or what is not sure, if there is one. `None` if there are too
    /// many cases.
    pub(super) fn examine(
        &mut self,
        text: &str,
        rule: &Rule,
        stop: &mut dyn FnMut() -> bool,
    ) -> Option<(Finding, Option<Breach>)> {
        let (mut applies, mut doubts, mut breaches) = (Vec::new(), Vec::new(), Vec::new());
        for place in self.places(&rule.moment)? {
            let reading = if place.is_instant { Reading::Touching } else { Reading::Between };
            // Where something touches the end of what is looked at, it is looked at still.
            let during = |meaning: &Self, asked: Asked| match &rule.during {
                Some(during) => meaning.condition(during, asked, reading.of_negation()),
                None => Condition::All(Vec::new()),
            };
            let scope = Condition::All(place.edges.iter().copied().map(Condition::Edge).collect());
            let looked_at = Condition::All(vec![scope, during(self, Asked::NotDenied)]);
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
            let finding = Finding { applies: joined(applies), ..Finding::without_times(text, outcome) };
            return Some((finding, None));
        };
        let nodes = self.decisive(&breach);
        let stretch = told.iter().find(|it| it.from <= breach.stretch.from && breach.stretch.to <= it.to);
        let words = self.words(*stretch.unwrap_or(&breach.stretch), &breach, &nodes);
        let words = self.network.readable(&words);
        let mut names: Vec<String> = nodes.iter().filter_map(|&(node, _)| self.owner(node)).collect();
        names.dedup();
        let outcome = if is_broken { Outcome::Broken(words) } else { Outcome::Unsure(words) };
        let nodes = nodes.into_iter().map(|(node, _)| node).collect();
        let rule = text.to_owned();
        let (applies, place) = (joined(applies), String::new());
        let finding = Finding { rule, outcome, applies, breaks, open, names, nodes, place };
        Some((finding, Some(breach)))
    }

    /// The times of an execution that has an instant of a breach, by node: the earliest ones.
    pub(super) fn execution(&self, breach: &Breach) -> Option<Vec<Option<Time>>> {
        let mut edges = [breach.case.past.clone(), breach.case.future.clone()].concat();
        edges.extend(breach.level.iter().flat_map(|level| level.edges.iter().copied()));
        self.times.execution(self.network, self.plan, &edges)
    }

    fn places(&self, moment: &Moment) -> Option<Vec<Place<'a>>> {
        let of = match moment {
            Moment::Start(of) | Moment::End(of) => of.as_ref(),
            Moment::Throughout | Moment::Within { .. } => None,
        };
        let occurrences = of.into_iter().flat_map(|of| self.selected(of));
        places(self.network, moment, occurrences, |time| self.times.ticks(time))
    }

    /// The activities of the plan that are meant.
    fn selected(&self, of: &Activity) -> impl Iterator<Item = &'a Occurrence> {
        let plan = self.plan;
        meant(self.network, of).filter(move |it| {
            it.arc.is_none_or(|arc| plan.selected_arcs.get(arc.index()) == Some(&true))
                && plan.selected_nodes.get(it.start.index()) == Some(&true)
        })
    }

    /// These, from start to end.
    fn occurrences(&self, of: &Activity) -> impl Iterator<Item = (NodeId, NodeId)> {
        self.selected(of).map(|it| (it.start, it.end))
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
    let selected = network.uses.iter().filter(|used| {
        used.resource.index() == index && plan.selected_arcs.get(used.arc.index()) == Some(&true)
    });
    Resource {
        first: network.resources[index].supply.initial_level(),
        changes: selected.flat_map(Change::of_use).collect(),
    }
}

/// Returns where a rule of a mission looks at instants; `None` if times are too large. `occurrences` are the activities
/// that its moment is about, and `ticks` tells a time in ticks.
pub(super) fn places<'network>(
    network: &Network,
    moment: &Moment,
    occurrences: impl Iterator<Item = &'network Occurrence>,
    ticks: impl Fn(Time) -> Option<i64>,
) -> Option<Vec<Place<'network>>> {
    let (start, end) = (network.start, network.end);
    let at = |node: NodeId| vec![Edge::past(node, true), Edge::future(node, true)];
    let instant = |node: NodeId| Place { edges: at(node), is_instant: true, of: None };
    let within = vec![Edge::past(start, true), Edge::future(end, false)];
    Some(match moment {
        Moment::Throughout => vec![Place { edges: within, is_instant: false, of: None }, instant(end)],
        Moment::Within { from, to } => {
            let mut bounds = vec![Edge::past(start, true).after(ticks(*from)?)];
            if let Bound::Finite(to) = *to {
                bounds.push(Edge::future(start, false).after(ticks(to)?));
            }
            vec![
                Place { edges: [within, bounds.clone()].concat(), is_instant: false, of: None },
                Place { edges: [bounds, at(end)].concat(), is_instant: true, of: None },
            ]
        }
        Moment::Start(None) => vec![instant(start)],
        Moment::End(None) => vec![instant(end)],
        Moment::Start(Some(_)) => occurrences.map(|it| Place { of: Some(it), ..instant(it.start) }).collect(),
        Moment::End(Some(_)) => occurrences.map(|it| Place { of: Some(it), ..instant(it.end) }).collect(),
    })
}

/// The activities of a network that a rule means.
pub(super) fn meant<'network>(
    network: &'network Network,
    of: &Activity,
) -> impl Iterator<Item = &'network Occurrence> {
    network.occurrences.iter().filter(move |it| {
        matches!(it.kind, OccurrenceKind::Primitive | OccurrenceKind::Activity)
            && it.activity == of.name
            && of.arguments.as_ref().is_none_or(|arguments| *arguments == it.arguments)
    })
}
