//! What one schedule of a plan, or one run of it, says of a flight rule at one instant (SPEC 16.1). Nothing of how rules are
//! evaluated over all schedules is used.

use exact::{Rational, Time};
use executive::{Entry, Happening};
use rmpl::program::{Change, Program};
use rmpl::rule::{Activity, Formula, Moment, Rule};
use tpn::{
    Extent, LabelId, Network, NodeId, Occurrence, OccurrenceKind, Plan, Supply, ValueId, ValueSet, VariableId,
};

/// One schedule of a plan.
#[derive(Clone, Copy)]
pub(crate) struct Scheduled<'a> {
    pub(crate) program: &'a Program,
    pub(crate) network: &'a Network,
    pub(crate) plan: &'a Plan,
    pub(crate) times: &'a [Option<Time>],
    /// Whether an activity takes the least or greatest time that it is declared with, for a purpose.
    pub(crate) is_extreme: bool,
    /// The log of the run whose times these are: levels are what they came to in it.
    pub(crate) log: Option<&'a [Entry]>,
}

/// One time of it. At a moment, what touches it counts.
struct Instant<'a> {
    of: Scheduled<'a>,
    at: Time,
    touches: bool,
}

/// How an assertion of a variable stands to the values that are asked for.
struct Told {
    start: Time,
    end: Time,
    label: LabelId,
    extent: Extent,
    /// Whether it says that the variable has one of them, and that it has none.
    is: (bool, bool),
}

impl<'a> Scheduled<'a> {
    /// The first instant at which the rule is not known to hold, if there is one.
    pub(crate) fn first_breach(self, rule: &Rule) -> Option<Time> {
        let mut instants = self.instants(&rule.moment);
        instants.sort_unstable();
        instants.dedup();
        instants.into_iter().find(|&(at, touches)| !self.holds(rule, at, touches)).map(|(at, _)| at)
    }

    /// The level of a resource after each instant at which something happens.
    pub(super) fn levels(self, resource: &str) -> Vec<(Time, Rational)> {
        let mut times: Vec<Time> = self.times.iter().copied().flatten().collect();
        times.sort_unstable();
        times.dedup();
        let level = |at: Time| Some((at, Instant { of: self, at, touches: false }.level(resource)?));
        times.into_iter().filter_map(level).collect()
    }

    fn holds(self, rule: &Rule, at: Time, touches: bool) -> bool {
        let instant = Instant { of: self, at, touches };
        let is_asked = rule.during.as_ref().is_none_or(|during| !instant.known(during, true).1);
        !is_asked || instant.known(&rule.holds, false).0
    }

    fn time(self, node: NodeId) -> Option<Time> {
        self.times.get(node.index()).copied().flatten()
    }

    /// The instants of a moment that differ: what holds when something happens holds until something else does.
    fn instants(self, moment: &Moment) -> Vec<(Time, bool)> {
        let (start, end) = (self.time(self.network.start), self.time(self.network.end));
        let (Some(start), Some(end)) = (start, end) else { return Vec::new() };
        match moment {
            Moment::Throughout => self.between([start, end], start, None),
            Moment::Within { from, to } => {
                let from = start.checked_add(*from).unwrap_or(start);
                let to = to.finite().and_then(|to| start.checked_add(to));
                self.between([start, end], from, to)
            }
            Moment::Start(None) => vec![(start, true)],
            Moment::End(None) => vec![(end, true)],
            Moment::Start(Some(activity)) => {
                self.called(activity).filter_map(|it| Some((self.time(it.start)?, true))).collect()
            }
            Moment::End(Some(activity)) => {
                self.called(activity).filter_map(|it| Some((self.time(it.end)?, true))).collect()
            }
        }
    }

    /// The instants of a mission from its start to its end that lie from one time on and before another.
    fn between(self, [start, end]: [Time; 2], from: Time, to: Option<Time>) -> Vec<(Time, bool)> {
        let mut times: Vec<Time> = self.times.iter().copied().flatten().chain([from]).collect();
        times.sort_unstable();
        times.dedup();
        let is_inside = |at: Time| at >= from && to.is_none_or(|to| at < to);
        let all = times.into_iter().filter(|&at| at >= start && at < end && is_inside(at));
        let mut all: Vec<(Time, bool)> = all.map(|at| (at, false)).collect();
        all.extend(Some((end, true)).filter(|&(at, _)| is_inside(at)));
        all
    }

    fn called(self, activity: &Activity) -> impl Iterator<Item = &'a Occurrence> {
        self.network.occurrences.iter().filter(move |it| {
            matches!(it.kind, OccurrenceKind::Primitive | OccurrenceKind::Activity)
                && it.activity == activity.name
                && activity.arguments.as_ref().is_none_or(|arguments| *arguments == it.arguments)
                && it.arc.is_none_or(|arc| self.plan.selected_arcs.get(arc.index()) == Some(&true))
                && self.time(it.start).is_some()
        })
    }

    /// The value of a variable that is in no plan because nothing needs or changes it.
    fn declared(self, name: &str) -> Option<&'a str> {
        let variable = self.program.variables.iter().find(|it| it.name.text == name);
        if let Some(variable) = variable {
            return variable.initial.as_ref().filter(|_| !variable.is_from_plant).map(|it| it.text.as_str());
        }
        let vehicle = name.strip_suffix(".at")?;
        let mut vehicles = self.program.world.vehicles.iter();
        vehicles.find(|it| it.name.text == vehicle).map(|it| it.start.text.as_str())
    }
}

impl Instant<'_> {
    fn is_inside(&self, start: Time, end: Option<Time>) -> bool {
        start <= self.at && end.is_none_or(|end| self.at < end || (self.touches && self.at == end))
    }

    /// Returns whether a condition is known to hold, and whether its negation is. Strictly, what both touch is neither.
    fn known(&self, formula: &Formula, is_strict: bool) -> (bool, bool) {
        match formula {
            Formula::Not(inner) => {
                let (yes, no) = self.known(inner, true);
                (no, yes)
            }
            Formula::All(parts) => {
                let known: Vec<_> = parts.iter().map(|part| self.known(part, is_strict)).collect();
                (known.iter().all(|it| it.0), known.iter().any(|it| it.1))
            }
            Formula::Any(parts) => {
                let known: Vec<_> = parts.iter().map(|part| self.known(part, is_strict)).collect();
                (known.iter().any(|it| it.0), known.iter().all(|it| it.1))
            }
            Formula::Is { variable, values } => strictly(is_strict, self.variable(variable, values)),
            Formula::Underway(activity) => strictly(is_strict, self.is_under_way(activity)),
            Formula::Amount { resource, order, amount } => {
                let Some(level) = self.level(resource) else { return (false, false) };
                let is_so = order.holds(level, *amount);
                (is_so, !is_so)
            }
        }
    }

    fn is_under_way(&self, activity: &Activity) -> (bool, bool) {
        let (mut yes, mut no) = (false, true);
        for it in self.of.called(activity) {
            let (Some(start), Some(end)) = (self.of.time(it.start), self.of.time(it.end)) else { continue };
            yes |= self.is_inside(start, Some(end));
            let touches_outside = self.touches && self.at == start;
            no &= self.at < start || self.at >= end || touches_outside;
        }
        (yes, no)
    }

    fn variable(&self, name: &str, values: &[smol_str::SmolStr]) -> (bool, bool) {
        let network = self.of.network;
        let Some(index) = network.variables.iter().position(|it| it.name == name) else {
            return self.of.declared(name).map_or((false, false), |value| {
                let is_so = values.iter().any(|it| it == value);
                (is_so, !is_so)
            });
        };
        let variable = &network.variables[index];
        let is_asked = |id: &ValueId| variable.values.get(id.index()).is_some_and(|it| values.contains(it));
        let is = |set: &ValueSet| match set {
            ValueSet::In(ids) => (ids.iter().all(is_asked), !ids.iter().any(is_asked)),
            ValueSet::NotIn(ids) if variable.closed => {
                let all = (0..variable.values.len()).map(ValueId::from_index);
                let left: Vec<ValueId> = all.filter(|id| !ids.contains(id)).collect();
                (left.iter().all(is_asked), !left.iter().any(is_asked))
            }
            ValueSet::NotIn(ids) => {
                let excluded = |value: &smol_str::SmolStr| {
                    ids.iter().any(|id| variable.values.get(id.index()) == Some(value))
                };
                (false, values.iter().all(excluded))
            }
        };
        let told = self.of.plan.told(network, VariableId::from_index(index)).into_iter().filter_map(|id| {
            let label = &network.labels[id.index()];
            let (start, end) = network.interval(id);
            let (start, end) = (self.of.time(start)?, self.of.time(end)?);
            Some(Told { start, end, label: id, extent: label.extent, is: is(&label.literal.values) })
        });
        let told: Vec<Told> = told.collect();
        let (mut yes, mut no) = (false, false);
        if !variable.is_lasting {
            for it in told.iter().filter(|it| self.is_inside(it.start, Some(it.end))) {
                yes |= it.is.0;
                no |= it.is.1;
            }
            return (yes, no);
        }
        for (at, it) in told.iter().enumerate() {
            let ready = if it.extent == Extent::Effect { it.end } else { it.start };
            let literal = |it: &Told| &network.labels[it.label.index()].literal;
            let next = told[at + 1..].iter().find(|next| {
                next.extent == Extent::Effect || it.extent == Extent::Effect || literal(next) != literal(it)
            });
            if self.is_inside(ready, next.map(|next| next.start)) {
                yes |= it.is.0;
                no |= it.is.1;
            }
        }
        (yes, no)
    }

    /// The level of a reservoir, or what is in use of another resource. What starts at a moment does not count at it.
    fn level(&self, name: &str) -> Option<Rational> {
        self.of.log.map_or_else(|| self.planned_level(name), |log| self.level_in_run(name, log))
    }

    fn level_in_run(&self, name: &str, log: &[Entry]) -> Option<Rational> {
        let resource = self.of.network.resources.iter().find(|it| it.name == name)?;
        let has_started = |by: &str| {
            let owner = self.of.network.occurrences.iter().find(|it| it.name == by);
            owner.and_then(|it| self.of.time(it.start)).is_some_and(|start| start < self.at)
        };
        let mut shown = resource.supply.initial_level();
        let mut level = shown;
        for entry in log.iter().take_while(|entry| entry.time <= self.at) {
            let Happening::Level { resource: of, level: then, by } = &entry.happening else { continue };
            if *of != resource.name {
                continue;
            }
            let change = then.checked_sub(shown)?;
            shown = *then;
            // At a moment what is produced then is there, and what starts to take or to use then has not done so yet.
            let is_produced = matches!(resource.supply, Supply::Reservoir { .. }) && change > Rational::ZERO;
            let is_there = is_produced || by.as_ref().is_none_or(|by| has_started(by));
            if !self.touches || entry.time < self.at || is_there {
                level = level.checked_add(change)?;
            }
        }
        Some(level)
    }

    fn planned_level(&self, name: &str) -> Option<Rational> {
        let network = self.of.network;
        let index = network.resources.iter().position(|it| it.name == name)?;
        let mut level = network.resources[index].supply.initial_level();
        for used in network.uses.iter().filter(|it| {
            it.resource.index() == index && self.of.plan.selected_arcs.get(it.arc.index()) == Some(&true)
        }) {
            let (start, end) = (self.of.time(used.start)?, self.of.time(used.end)?);
            let has_started = start < self.at || (start == self.at && !self.touches);
            let has_ended = end <= self.at;
            match used.change {
                Change::Uses if has_started && !has_ended => level = level.checked_add(used.amount)?,
                Change::Consumes if has_started => level = level.checked_sub(used.counted())?,
                Change::Produces if has_ended => level = level.checked_add(used.counted())?,
                Change::Uses | Change::Consumes | Change::Produces => {}
            }
        }
        Some(level)
    }
}

/// Returns what holds and what does not where something both holds and does not: neither, if it has to be strict.
const fn strictly(is_strict: bool, (yes, no): (bool, bool)) -> (bool, bool) {
    if is_strict && yes && no { (false, false) } else { (yes, no) }
}
