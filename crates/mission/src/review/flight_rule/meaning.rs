//! What a rule means of a plan: the instants that break it, as a condition on which events have come.

use std::collections::BTreeSet;
use std::ops::ControlFlow;

use exact::{Bound, Rational, Time};
use rmpl::program::{Change as Changes, LabelMode};
use rmpl::rule::{Activity, Formula, Moment, Order, Rule};
use tpn::{Extent, LabelId, Network, NodeId, OccurrenceKind, Plan, Supply, ValueSet};

use super::cases::{Case, Condition, TooMany, each_case};
use super::cut::{Edge, Times, joined};
use super::level::{Change, Resource, Wanted};
use super::{Finding, Outcome, Stretch};

/// The times that a rule names.
pub(super) fn times_of(rule: &Rule) -> Vec<Time> {
    match rule.moment {
        Moment::Within { from, to } => [Some(from), to.finite()].into_iter().flatten().collect(),
        Moment::Throughout | Moment::Start(_) | Moment::End(_) => Vec::new(),
    }
}

/// What is asked of a condition: what holds is known, or not known, or the contrary is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Asked {
    Known,
    NotKnown,
    Denied,
    NotDenied,
}

impl Asked {
    /// What is asked of a condition when this is asked of its negation.
    const fn of_negation(self) -> Self {
        match self {
            Self::Known => Self::Denied,
            Self::NotKnown => Self::NotDenied,
            Self::Denied => Self::Known,
            Self::NotDenied => Self::NotKnown,
        }
    }
}

/// A plan, and when its events can be.
pub(super) struct Meaning<'a> {
    network: &'a Network,
    plan: &'a Plan,
    times: Times,
    resources: Vec<Resource>,
    /// Which of two intervals that must not overlap comes first.
    orders: BTreeSet<(LabelId, LabelId)>,
}

/// Where instants are looked for.
struct Place {
    scope: Condition,
    /// An instant at which something starts or ends: what touches it counts, as for `requires at start`.
    is_instant: bool,
}

/// A case that breaks a rule, and from when to when.
struct Breach {
    case: Case,
    stretch: Stretch,
    level: Option<Level>,
}

/// A level that breaks a rule.
#[derive(Clone)]
struct Level {
    resource: usize,
    amount: Rational,
    /// What has led to it.
    by: Vec<NodeId>,
}

/// Resources with more changes than this are not drawn change by change.
const MAX_DRAWN: usize = 120;

impl<'a> Meaning<'a> {
    pub(super) fn new(network: &'a Network, plan: &'a Plan, times: Times) -> Self {
        let resources = (0..network.resources.len()).map(|index| resource(network, plan, index)).collect();
        let orders = plan.conflict_order.iter().map(|it| (it.first, it.then)).collect();
        Self { network, plan, times, resources, orders }
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
            let is_instant = place.is_instant;
            let during = |meaning: &Self, asked: Asked| match &rule.during {
                Some(during) => meaning.condition(during, asked, is_instant),
                None => Condition::All(Vec::new()),
            };
            let looked_at = Condition::All(vec![place.scope.clone(), during(self, Asked::NotDenied)]);
            applies.extend(self.breaches(&looked_at, stop).ok()?.into_iter().map(|it| it.stretch));
            let not_held = self.condition(&rule.holds, Asked::NotKnown, is_instant);
            let doubt = Condition::All(vec![looked_at, not_held]);
            let found = self.breaches(&doubt, stop).ok()?;
            if !found.is_empty() {
                let denied = self.condition(&rule.holds, Asked::Denied, is_instant);
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

    fn condition(&self, formula: &Formula, asked: Asked, is_instant: bool) -> Condition {
        let all = |parts: &[Formula]| parts.iter().map(|it| self.condition(it, asked, is_instant)).collect();
        match formula {
            Formula::Not(inner) => self.condition(inner, asked.of_negation(), is_instant),
            Formula::All(parts) => match asked {
                Asked::Known | Asked::NotDenied => Condition::All(all(parts)),
                Asked::NotKnown | Asked::Denied => Condition::Any(all(parts)),
            },
            Formula::Any(parts) => match asked {
                Asked::Known | Asked::NotDenied => Condition::Any(all(parts)),
                Asked::NotKnown | Asked::Denied => Condition::All(all(parts)),
            },
            Formula::Is { variable, values } => {
                let known = |is_among: bool| self.is_one_of(variable, values, is_among, is_instant);
                match asked {
                    Asked::Known => known(true),
                    Asked::NotKnown => known(true).negated(),
                    Asked::Denied => known(false),
                    Asked::NotDenied => known(false).negated(),
                }
            }
            Formula::Underway(activity) => {
                let inside = |(start, end)| between(start, end, is_instant);
                let outside = |(start, end)| {
                    Condition::Any(vec![
                        Condition::Edge(Edge::future(start, is_instant)),
                        Condition::Edge(Edge::past(end, true)),
                    ])
                };
                match asked {
                    Asked::Known => Condition::Any(self.occurrences(activity).map(inside).collect()),
                    Asked::NotDenied => {
                        Condition::All(self.occurrences(activity).map(outside).collect()).negated()
                    }
                    Asked::NotKnown => {
                        Condition::Any(self.occurrences(activity).map(inside).collect()).negated()
                    }
                    Asked::Denied => Condition::All(self.occurrences(activity).map(outside).collect()),
                }
            }
            Formula::Amount { resource, order, amount } => {
                let Some(resource) = self.network.resources.iter().position(|it| it.name == *resource) else {
                    return Condition::Any(Vec::new());
                };
                let (is_above, may_equal) = match order {
                    Order::Below => (false, false),
                    Order::AtMost => (false, true),
                    Order::Above => (true, false),
                    Order::AtLeast => (true, true),
                };
                let wanted = Wanted { resource, is_above, amount: *amount, may_equal, is_instant };
                Condition::Level(match asked {
                    Asked::Known | Asked::NotDenied => wanted,
                    Asked::NotKnown | Asked::Denied => wanted.negated(),
                })
            }
        }
    }

    /// It is known that a variable has one of these values, or that it has another.
    fn is_one_of(
        &self,
        variable: &str,
        values: &[smol_str::SmolStr],
        is_among: bool,
        is_instant: bool,
    ) -> Condition {
        let Some(index) = self.network.variables.iter().position(|it| it.name == variable) else {
            return Condition::Any(Vec::new());
        };
        let declared = &self.network.variables[index];
        let is_meant = |value: tpn::ValueId| {
            declared.values.get(value.index()).is_some_and(|name| values.contains(name))
        };
        let is_told = |set: &ValueSet| match set {
            ValueSet::In(ids) => ids.iter().all(|&id| is_meant(id) == is_among),
            ValueSet::NotIn(ids) if declared.closed => {
                let left = (0..declared.values.len()).map(tpn::ValueId::from_index);
                left.filter(|id| !ids.contains(id)).all(|id| is_meant(id) == is_among)
            }
            // Of all that it may be besides, only that it is none of these is known.
            ValueSet::NotIn(ids) => {
                let named = |value: &smol_str::SmolStr| declared.values.iter().position(|it| it == value);
                let is_excluded =
                    |value| named(value).is_some_and(|at| ids.contains(&tpn::ValueId::from_index(at)));
                !is_among && values.iter().all(is_excluded)
            }
        };
        let mut told: Vec<LabelId> = (self.network.labels.iter().enumerate())
            .filter(|(_, label)| {
                label.literal.variable.index() == index
                    && label.mode == LabelMode::Tell
                    && self.plan.selected_arcs.get(label.arc.index()) == Some(&true)
            })
            .map(|(at, _)| LabelId::from_index(at))
            .collect();
        let is_meant = |label: &LabelId| is_told(&self.network.labels[label.index()].literal.values);
        if !declared.is_lasting {
            let parts = told.into_iter().filter(is_meant).map(|label| {
                let (start, end) = self.network.interval(label);
                between(start, end, is_instant)
            });
            return Condition::Any(parts.collect());
        }
        told.sort_by_key(|&label| self.begins(label));
        let parts = (0..told.len()).filter(|&at| is_meant(&told[at])).map(|at| {
            let mut edges = vec![Condition::Edge(Edge::past(self.network.ready(told[at]), true))];
            let next = self.next_changes(&told, at);
            edges.extend(
                next.into_iter()
                    .map(|next| Condition::Edge(Edge::future(self.network.interval(next).0, is_instant))),
            );
            Condition::All(edges)
        });
        Condition::Any(parts.collect())
    }

    /// What sorts changes of one variable: the first value, then by when they can begin.
    fn begins(&self, label: LabelId) -> (bool, Option<Time>, Option<Time>) {
        let earliest = |node: NodeId| {
            self.plan.windows.get(node.index()).copied().flatten().map(|window| window.earliest)
        };
        let is_first = self.network.labels[label.index()].extent == Extent::Initial;
        (!is_first, earliest(self.network.interval(label).0), earliest(self.network.ready(label)))
    }

    /// Those of the sorted changes of a variable that may be the first to end what the one at `at` has made.
    fn next_changes(&self, told: &[LabelId], at: usize) -> Vec<LabelId> {
        let own = &self.network.labels[told[at].index()];
        let mut next: Vec<LabelId> = Vec::new();
        for &label in &told[at + 1..] {
            let other = &self.network.labels[label.index()];
            // What gives the same value at once ends nothing.
            let is_change = other.is_changing() || own.is_changing() || other.literal != own.literal;
            let is_after = own.extent == Extent::Initial || self.is_ordered(told[at], label);
            if !is_change || !is_after {
                continue;
            }
            if next.iter().any(|&earlier| self.is_ordered(earlier, label)) {
                break;
            }
            next.push(label);
        }
        next
    }

    fn is_ordered(&self, first: LabelId, then: LabelId) -> bool {
        self.orders.contains(&(first, then))
    }

    /// The cases that meet a condition, with when that is.
    fn breaches(
        &mut self,
        condition: &Condition,
        stop: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<Breach>, TooMany> {
        let mut found = Vec::new();
        let mut is_decided = true;
        let resources = &self.resources;
        each_case(&mut self.times, condition, stop, &mut |times, case| {
            match at_levels(times, resources, case) {
                Some(more) => found.extend(more),
                None => is_decided = false,
            }
            if is_decided { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        })?;
        if is_decided { Ok(found) } else { Err(TooMany) }
    }

    /// The events of a case that say when it is, without those that others imply, and whether they have come.
    fn decisive(&mut self, breach: &Breach) -> Vec<(NodeId, bool)> {
        let case = &breach.case;
        let (start, end) = (self.network.start, self.network.end);
        let by = breach.level.iter().flat_map(|level| level.by.iter().copied());
        let past = case.past.iter().map(|it| it.node).chain(by).filter(|&node| node != start);
        let past: Vec<NodeId> = past.collect();
        // Before the end is everything that does not happen at it.
        let future = case.future.iter().map(|it| it.node);
        let future = future.filter(|node| *node != start && (*node != end || past.contains(node)));
        let future: Vec<NodeId> = future.collect();
        let mut decisive = Vec::new();
        for (nodes, is_past) in [(past, true), (future, false)] {
            for (at, &node) in nodes.iter().enumerate() {
                let mut is_implied = decisive.contains(&(node, is_past));
                for (other_at, &other) in nodes.iter().enumerate() {
                    // Of what comes first and then, the later one says more of the past, the earlier one of the future.
                    let (first, then) = if is_past { (node, other) } else { (other, node) };
                    let is_ordered =
                        other != node && !self.times.fits(Edge::past(then, true), Edge::future(first, false));
                    let is_tied =
                        is_ordered && !self.times.fits(Edge::past(first, true), Edge::future(then, false));
                    is_implied |= is_ordered && (!is_tied || other_at < at);
                }
                if !is_implied {
                    decisive.push((node, is_past));
                }
            }
        }
        decisive
    }

    /// The event by which people know a node: that of an activity or an assertion rather than that of a delay.
    fn event(&self, node: NodeId) -> Option<&tpn::EventRef> {
        let events = &self.network.nodes.get(node.index())?.events;
        let is_telling = |event: &&tpn::EventRef| {
            let kind = self.network.occurrences.get(event.occurrence.index()).map(|it| it.kind);
            matches!(kind, Some(OccurrenceKind::Primitive | OccurrenceKind::Assertion))
        };
        events.iter().find(is_telling).or(events.first())
    }

    fn owner(&self, node: NodeId) -> Option<String> {
        let event = self.event(node)?;
        Some(self.network.occurrences.get(event.occurrence.index())?.name.to_string())
    }

    /// When a breach is, and between what.
    fn words(&self, stretch: Stretch, breach: &Breach, decisive: &[(NodeId, bool)]) -> String {
        let Stretch { from, to } = stretch;
        let mut words = match to {
            Bound::Finite(to) if to == from => format!("at {}", from.readable()),
            Bound::Finite(to) => format!("from {} to {}", from.readable(), to.readable()),
            Bound::Infinite => format!("from {} on", from.readable()),
        };
        let name = |node: NodeId| Some(self.network.event_name(*self.event(node)?));
        // The event of an instant bounds it from both sides.
        let is_at = |node: NodeId| [true, false].iter().all(|&side| decisive.contains(&(node, side)));
        let at = decisive.iter().find(|it| is_at(it.0)).and_then(|it| name(it.0));
        if let Some(at) = at {
            words.push_str(&format!(", with {at}"));
        }
        for (word, is_past) in [("after", true), ("before", false)] {
            let events = decisive.iter().filter(|it| it.1 == is_past && !is_at(it.0));
            let events: Vec<String> = events.filter_map(|it| name(it.0)).take(MAX_NAMED).collect();
            if !events.is_empty() {
                words.push_str(&format!(", {word} {}", events.join(" and ")));
            }
        }
        if let Some(level) = &breach.level {
            let name = &self.network.resources[level.resource].name;
            words.push_str(&format!(": {name} is {}", level.amount.readable()));
        }
        words
    }
}

/// How many events a sentence names on each side.
const MAX_NAMED: usize = 3;

/// Between two events; at an instant, what touches it counts.
fn between(start: NodeId, end: NodeId, is_instant: bool) -> Condition {
    Condition::All(vec![
        Condition::Edge(Edge::past(start, true)),
        Condition::Edge(Edge::future(end, is_instant)),
    ])
}

fn earliest(breaches: impl IntoIterator<Item = Breach>) -> Option<Breach> {
    breaches.into_iter().min_by_key(|it| (it.stretch.from, it.stretch.to))
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
        match used.change {
            Changes::Uses => {
                changes.push(Change { node: used.start, more: used.amount, is_start: true });
                changes.push(Change { node: used.end, more: less(used.amount), is_start: false });
            }
            Changes::Consumes => {
                changes.push(Change { node: used.start, more: less(used.amount), is_start: true });
            }
            Changes::Produces => {
                changes.push(Change { node: used.end, more: used.amount, is_start: false });
            }
        }
    }
    let first = match supply {
        Supply::Reusable { .. } => Rational::ZERO,
        Supply::Reservoir { level, .. } => level,
    };
    Resource { first, changes }
}

/// Where the levels of a case are as it wants them, and when; `None` if that cannot be told.
fn at_levels(times: &mut Times, resources: &[Resource], case: &Case) -> Option<Vec<Breach>> {
    let range = times.range(&case.past, &case.future);
    let Some(level) = met(times, resources, case)? else { return Some(Vec::new()) };
    let whole = |times: &Times| {
        vec![Breach { case: case.clone(), stretch: times.stretch(range), level: level.clone() }]
    };
    let Some(Level { resource, .. }) = &level else { return Some(whole(times)) };
    let changes = &resources[*resource].changes;
    if changes.len() > MAX_DRAWN {
        return Some(whole(times));
    }
    // The level that can be reached changes only where an event can come, or has to have come.
    let start = times.start();
    let mut bounds = vec![range.0];
    bounds.extend(range.1);
    for change in changes {
        bounds.push(times.earliest(change.node));
        bounds.extend(times.latest(change.node));
    }
    bounds.retain(|&at| at >= range.0 && range.1.is_none_or(|to| at <= to));
    bounds.sort_unstable();
    bounds.dedup();
    let mut found = Vec::new();
    for (index, &at) in bounds.iter().enumerate() {
        let next = bounds.get(index + 1).copied();
        let point = [Edge::past(start, true).after(at), Edge::future(start, true).after(at)];
        let behind: Vec<Edge> = std::iter::once(Edge::past(start, false).after(at))
            .chain(next.map(|next| Edge::future(start, false).after(next)))
            .collect();
        for (edges, stretch) in [(point.to_vec(), (at, Some(at))), (behind, (at, next))] {
            let Some(case) = narrowed(times, case, &edges) else { continue };
            if let Some(level) = met(times, resources, &case)? {
                let stretch = times.stretch(stretch);
                found.push(Breach { case, stretch, level });
            }
        }
    }
    Some(found)
}

/// The case with more said of its events, if an instant still fits.
fn narrowed(times: &mut Times, case: &Case, edges: &[Edge]) -> Option<Case> {
    let mut narrow = case.clone();
    for &edge in edges {
        let others = if edge.is_past { &narrow.future } else { &narrow.past };
        let fits = |other: &Edge| {
            if edge.is_past { times.fits(edge, *other) } else { times.fits(*other, edge) }
        };
        if !others.iter().all(fits) {
            return None;
        }
        if edge.is_past { narrow.past.push(edge) } else { narrow.future.push(edge) }
    }
    Some(narrow)
}

/// Whether the levels of a case can be as it wants them, with one of them; `None` if that cannot be told.
#[expect(clippy::option_option, reason = "the outer one is what cannot be told")]
fn met(times: &mut Times, resources: &[Resource], case: &Case) -> Option<Option<Option<Level>>> {
    let mut is_met_together = case.levels.is_empty();
    let mut shown = None;
    for wanted in &case.levels {
        let resource = &resources[wanted.resource];
        let (level, has_come) = resource.furthest(times, case, wanted)?;
        if !wanted.is_met_by(level) {
            return Some(None);
        }
        shown = shown.or_else(|| {
            let leads = |change: &Change| change.more.is_positive() == wanted.is_above;
            let come = resource.changes.iter().zip(&has_come);
            let by = come.filter(|(change, has_come)| **has_come && leads(change));
            let by = by.map(|(change, _)| change.node).collect();
            Some(Level { resource: wanted.resource, amount: level, by })
        });
        // What several levels want at one instant is met if the same events meet all of them.
        is_met_together |= case.levels.iter().all(|other| {
            other.resource == wanted.resource
                && resource.level(&has_come).is_some_and(|level| other.is_met_by(level))
        });
    }
    is_met_together.then_some(Some(shown))
}
