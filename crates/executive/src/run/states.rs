//! What the world does to states and levels while a plan runs, and what of the plan that breaks (SPEC 6.2, 10, 11).
//!
//! A plan keeps its states and resources by itself: its causal links and orderings hold in every schedule. What breaks them
//! comes from outside: disturbances, and vehicles that drive farther than planned. A change that something still to come
//! relies on breaks the plan at once, so that there is time to plan again.

use exact::{Overflow, Rational, Time};
use rmpl::program::Change;
use smol_str::SmolStr;
use tpn::{
    Extent, LabelId, Network, NodeId, OccurrenceId, OccurrenceKind, ResourceId, Supply, UseId, ValueId,
    ValueSet, VariableId,
};

use super::{News, Run, Violation, shown};
use crate::activity_execution::{ActivityExecution, PlantReading};
use crate::log::Happening;
use crate::plan_network::PlanError;
use crate::world::WorldChange;
use crate::world_state::Lack;

/// A traverse has driven so many meters more than its path has.
pub(super) struct Odometer {
    pub(super) at: Time,
    pub(super) occurrence: OccurrenceId,
    extra_m: Rational,
}

impl Run<'_> {
    /// Lets the world continue until `until`, or until it breaks the plan.
    pub(super) fn let_world_act(&mut self, until: Time) -> Result<Option<Violation>, PlanError> {
        loop {
            let driven = self.odometers.front().map(|odometer| odometer.at);
            let changed = self.world.changes().get(self.num_changes).map(WorldChange::at);
            let read = self.readings.front().map(|reading| reading.at);
            let next = driven.into_iter().chain(changed).chain(read).min().filter(|&at| at <= until);
            if next.unwrap_or(until) > self.now
                && let Some(violation) = self.lack()
            {
                return Ok(Some(violation));
            }
            let Some(at) = next else { return Ok(None) };
            self.advance(at);
            let violation = if driven == Some(at) {
                self.count_meters()
            } else if read == Some(at) {
                self.read_plant()?
            } else {
                self.change_world()?
            };
            if violation.is_some() {
                return Ok(violation);
            }
        }
    }

    /// Takes in how far a traverse that has started at a time will have driven, and when.
    pub(super) fn expect_meters(
        &mut self,
        occurrence: OccurrenceId,
        started: Time,
        execution: &ActivityExecution,
    ) -> Result<(), Overflow> {
        self.counted_margins.insert(occurrence, execution.counted_margins);
        for &(after, extra_m) in &execution.extra_meters {
            let at = started.checked_add(after).ok_or(Overflow)?;
            let place = self.odometers.partition_point(|before| before.at <= at);
            self.odometers.insert(place, Odometer { at, occurrence, extra_m });
        }
        Ok(())
    }

    /// Returns what happens to an event's states and levels is written down, and what is required just then is looked
    /// at. An effect on what is read from the plant is what the plant is estimated to be (SPEC 15).
    pub(super) fn change_states(&mut self, node: NodeId) -> Option<Violation> {
        let stage = &self.stage;
        let happenings = self.state.happen(&stage.network, &stage.effects, node);
        for &requirement in stage.effects.beginning_at(node) {
            if stage.times[stage.network.interval(requirement).1.index()].is_none() {
                self.state.require(&stage.network, requirement);
            }
        }
        for &requirement in stage.effects.ending_at(node) {
            self.state.release(&stage.network, requirement);
            let (start, _) = stage.network.interval(requirement);
            if stage.times[start.index()] == Some(self.now) {
                self.state.need_now(requirement);
            }
        }
        for happening in happenings {
            self.write(happening);
        }
        let network = std::sync::Arc::clone(&self.stage.network);
        let given = self.stage.effects.given_at(node);
        let violations = given.into_iter().map(|label| self.check_effect(&network, label));
        let violation = violations.collect::<Vec<_>>().into_iter().flatten().next();
        violation.or(self.give_for_meters(&network, node))
    }

    /// Checks what an activity has set against the estimate: what it relies on is lost where that says otherwise.
    fn check_effect(&mut self, network: &Network, label: LabelId) -> Option<Violation> {
        let of = &network.labels[label.index()];
        let variable = of.literal.variable;
        let described = &network.variables[variable.index()];
        described.component()?;
        let initial = || {
            let first = network
                .labels
                .iter()
                .find(|label| label.extent == Extent::Initial && label.literal.variable == variable)?;
            match &first.literal.values {
                ValueSet::In(values) => values.first().copied(),
                ValueSet::NotIn(_) => None,
            }
        };
        let estimated = self.estimated.get(&variable).copied().or_else(initial)?;
        if of.literal.values.contains(estimated) {
            return None;
        }
        let value = described.values.get(estimated.index()).map_or("", |value| value.as_str());
        let name =
            of.owner.map_or_else(SmolStr::default, |owner| network.occurrences[owner.index()].name.clone());
        let text = format!("has ended, but {} is estimated to be {value}, not {}", described.name, of.text);
        self.write(Happening::Progress { name, text });
        if let Some(happening) = self.state.set_value(network, variable, estimated) {
            self.write(happening);
        }
        self.news.outcomes.push((label, estimated));
        self.lost_requirement(variable, estimated)
    }

    /// The plant is found to be otherwise than before. While an activity changes what is read nothing comes of that: what
    /// it says to have set is checked when it is over.
    fn read_plant(&mut self) -> Result<Option<Violation>, PlanError> {
        let Some(PlantReading { variable, value, .. }) = self.readings.pop_front() else { return Ok(None) };
        let network = std::sync::Arc::clone(&self.stage.network);
        let Some((variable, value)) = named(&network, &variable, &value) else { return Ok(None) };
        self.estimated.insert(variable, value);
        if self.state.value(variable) == Some(value) {
            return Ok(None);
        }
        self.take_value(&network, variable, value)
    }

    /// A variable has another value, which no one planned.
    fn take_value(
        &mut self,
        network: &Network,
        variable: VariableId,
        value: ValueId,
    ) -> Result<Option<Violation>, PlanError> {
        let Some(happening) = self.state.set_value(network, variable, value) else { return Ok(None) };
        self.write(happening);
        self.news.states.retain(|&(known, _, at)| (known, at) != (variable, self.now));
        self.news.states.push((variable, value, self.now));
        self.end_assertions(variable, value)?;
        Ok(self.lost_requirement(variable, value))
    }

    /// Returns what is not as it must be when the present instant is over.
    fn lack(&self) -> Option<Violation> {
        let network = &self.stage.network;
        let lack = self.state.lack(network)?;
        let now = shown(self.now);
        let (node, reason) = match lack {
            Lack::Value(label) => {
                let of = &network.labels[label.index()];
                let variable = of.literal.variable;
                let is = self.state.words(network, variable);
                let name = &network.variables[variable.index()].name;
                let reason =
                    format!("{} needs {}, but {name} is {is} at {now}", self.needing(label), of.text);
                (network.interval(label).0, reason)
            }
            Lack::Condition(used) => {
                let of = &network.uses[used.index()];
                let asks = of.level_text(&network.resources).unwrap_or_default();
                let level = self.state.level(of.resource).readable();
                (of.start, format!("{} needs {asks}, but the level is {level} at {now}", self.user(used)))
            }
            Lack::Level(resource) => {
                let of = &network.resources[resource.index()];
                let (name, level) = (&of.name, self.state.level(resource));
                let limit = match of.supply {
                    Supply::Reusable { capacity } => format!("of a capacity of {}", capacity.readable()),
                    Supply::Reservoir { least, .. } if level < least => {
                        format!("below its minimum of {}", least.readable())
                    }
                    Supply::Reservoir { greatest, .. } => {
                        format!("above its maximum of {}", greatest.readable())
                    }
                };
                (network.start, format!("{name} is at {} at {now}, {limit}", level.readable()))
            }
        };
        let name = self.stage.name(node).into();
        Some(Violation::new(name, reason, News::None))
    }

    /// Returns who a requirement belongs to.
    fn needing(&self, label: tpn::LabelId) -> String {
        let network = &self.stage.network;
        let owner = network.labels[label.index()].owner;
        owner.map_or_else(
            || network.label_name(label),
            |owner| network.occurrences[owner.index()].name.to_string(),
        )
    }

    /// Returns who uses a resource, or asks for its level.
    fn user(&self, used: UseId) -> String {
        let network = &self.stage.network;
        let owner = network.uses[used.index()].owner;
        owner.map_or_else(
            || network.use_name(used),
            |owner| network.occurrences[owner.index()].name.to_string(),
        )
    }

    /// A traverse has driven farther than the plan counts at most, or is there: what it takes for each meter is known.
    fn count_meters(&mut self) -> Option<Violation> {
        let Odometer { occurrence, extra_m, .. } = self.odometers.pop_front()?;
        let before_m = self.extra_m.insert(occurrence, extra_m);
        let [taken_m, _] = self.counted_margins.get(&occurrence).copied().unwrap_or_default();
        self.news.driven.push(occurrence);
        // What was counted before it set out is part of what it has driven.
        let since_m = extra_m.checked_sub(before_m.unwrap_or(taken_m))?;
        let network = std::sync::Arc::clone(&self.stage.network);
        let cause = driven(&network, occurrence, extra_m);
        let mut violation = None;
        let taken = |used: &&tpn::Use| used.owner == Some(occurrence) && used.change == Change::Consumes;
        for used in network.uses.iter().filter(taken) {
            let Supply::Reservoir { greatest, .. } = network.resources[used.resource.index()].supply else {
                continue;
            };
            let by = used.per_meter.checked_mul(since_m).and_then(Rational::checked_neg);
            let Some(mut by) = by.filter(|by| !by.is_zero()) else { continue };
            if by.is_positive() {
                // What was not taken after all fills a reservoir, and no more.
                let room = greatest.checked_sub(self.state.level(used.resource)).unwrap_or_default();
                by = by.min(room.max(Rational::ZERO));
            }
            let found = self.move_level(used.resource, by, Some(occurrence), Some(&cause));
            violation = violation.or(found);
        }
        violation
    }

    /// A traverse is over: counts what it gives for the meters beyond those that the plan counts at least.
    fn give_for_meters(&mut self, network: &Network, node: NodeId) -> Option<Violation> {
        let mut violation = None;
        let given = |used: &&tpn::Use| used.end == node && used.change == Change::Produces;
        for used in network.uses.iter().filter(given) {
            let Some(occurrence) = used.owner else { continue };
            let Some(&extra_m) = self.extra_m.get(&occurrence) else { continue };
            let [_, given_m] = self.counted_margins.get(&occurrence).copied().unwrap_or_default();
            let by = extra_m.checked_add(given_m).and_then(|more_m| used.per_meter.checked_mul(more_m));
            let Some(by) = by.filter(|by| !by.is_zero()) else { continue };
            let cause = driven(network, occurrence, extra_m);
            let found = self.move_level(used.resource, by, Some(occurrence), Some(&cause));
            violation = violation.or(found);
        }
        violation
    }

    /// A disturbance of a state or a level happens.
    fn change_world(&mut self) -> Result<Option<Violation>, PlanError> {
        let Some(change) = self.world.changes().get(self.num_changes) else { return Ok(None) };
        self.num_changes += 1;
        let network = std::sync::Arc::clone(&self.stage.network);
        match change {
            WorldChange::State { variable, value, .. } => {
                let Some((variable, value)) = named(&network, variable, value) else { return Ok(None) };
                self.take_value(&network, variable, value)
            }
            WorldChange::Level { resource, level, .. } => {
                let is_named = |it: &tpn::Resource| it.name == *resource;
                let Some(index) = network.resources.iter().position(is_named) else { return Ok(None) };
                let resource = ResourceId::from_index(index);
                let by = level.checked_sub(self.state.level(resource)).unwrap_or_default();
                Ok(self.move_level(resource, by, None, None))
            }
        }
    }

    /// Assertions under way that a value contradicts are over, for planning as well.
    fn end_assertions(&mut self, variable: VariableId, value: ValueId) -> Result<(), PlanError> {
        let network = std::sync::Arc::clone(&self.stage.network);
        for (index, occurrence) in network.occurrences.iter().enumerate() {
            let Some(arc) = occurrence.arc.filter(|_| occurrence.kind == OccurrenceKind::Assertion) else {
                continue;
            };
            let started = self.stage.times[occurrence.start.index()];
            let has_ended = self.stage.times[occurrence.end.index()].is_some();
            let Some(started) = started.filter(|&started| !has_ended && started < self.now) else { continue };
            let is_contradicted = network.arcs[arc.index()].labels.iter().any(|label| {
                let label = &network.labels[label.index()];
                label.mode == rmpl::program::LabelMode::Tell
                    && label.literal.variable == variable
                    && !label.literal.values.contains(value)
            });
            if is_contradicted {
                let held = self.now.checked_sub(started).ok_or(Overflow)?;
                self.learn(News::Duration(OccurrenceId::from_index(index), held));
            }
        }
        Ok(())
    }

    /// Returns what relied on the value that a variable had, if something did: the first such requirement that still
    /// continues, or is to come.
    fn lost_requirement(&self, variable: VariableId, value: ValueId) -> Option<Violation> {
        let (network, effects) = (&self.stage.network, &self.stage.effects);
        let has_come = |node: NodeId| self.stage.times[node.index()].is_some();
        let earliest = |node: NodeId| self.stage.made.point(node).map(|point| self.stage.window(point).0);
        let mut first: Option<(Time, tpn::LabelId)> = None;
        for &label in &effects.requirements {
            let literal = &network.labels[label.index()].literal;
            let (start, end) = network.interval(label);
            if literal.variable != variable || literal.values.contains(value) || has_come(end) {
                continue;
            }
            let carrier = effects.carriers.get(&label);
            let (Some(from), Some(until)) = (earliest(start), earliest(end)) else { continue };
            let is_given_later = carrier.is_some_and(|&carrier| !has_come(network.ready(carrier)));
            // What can be over this very instant may not mind.
            let may_be_over = has_come(start) && until <= self.now;
            if !is_given_later && !may_be_over && first.is_none_or(|(earlier, _)| from < earlier) {
                first = Some((from, label));
            }
        }
        let (from, label) = first?;
        let (start, end) = network.interval(label);
        let when = if has_come(start) {
            format!("until {}", shown(earliest(end)?))
        } else {
            format!("at {}", shown(from.max(self.now)))
        };
        let of = &network.variables[variable.index()];
        let reason = format!(
            "{} needs {} {when}, but {} became {} at {}",
            self.needing(label),
            network.labels[label.index()].text,
            of.name,
            of.values.get(value.index()).map_or("", |value| value.as_str()),
            shown(self.now)
        );
        Some(Violation::new(self.stage.name(start).into(), reason, News::None))
    }

    /// A reservoir's level changes otherwise than planned: the plan is broken if it does not keep the level in its range any
    /// more, whatever the schedule.
    fn move_level(
        &mut self,
        resource: ResourceId,
        by: Rational,
        owner: Option<OccurrenceId>,
        cause: Option<&str>,
    ) -> Option<Violation> {
        let network = std::sync::Arc::clone(&self.stage.network);
        let happening = self.state.move_level(&network, resource, by, owner)?;
        self.state.ask_kept(&network);
        self.write(happening);
        self.news.levels.push((resource, by, self.now));
        let off = self.off_plan.entry(resource).or_default();
        *off = off.checked_add(by).unwrap_or(*off);
        let off = *off;
        let Supply::Reservoir { least, greatest, .. } = network.resources[resource.index()].supply else {
            return None;
        };
        let mut coming: Vec<(Time, UseId)> = Vec::new();
        for &used in &self.stage.effects.moves {
            let of = &network.uses[used.index()];
            let has_come = self.stage.times[of.moment().index()].is_some();
            let point = self.stage.made.point(of.moment());
            if let Some(point) = point.filter(|_| of.resource == resource && !has_come) {
                coming.push((self.stage.window(point).0.max(self.now), used));
            }
        }
        let lost = self.lost_condition(resource, &coming);
        if lost.is_none() && self.keeps_range(resource, &coming, (least, greatest)) {
            return None;
        }
        let name = &network.resources[resource.index()].name;
        let stands = format!(
            "{name} is at {} at {}, {} {} than planned{}",
            self.state.level(resource).readable(),
            shown(self.now),
            magnitude(off).readable(),
            if off.is_negative() { "less" } else { "more" },
            cause.map_or_else(String::new, |cause| format!(", for {cause}"))
        );
        if let Some(condition) = lost {
            let of = &network.uses[condition.index()];
            let asks = of.level_text(&network.resources).unwrap_or_default();
            let reason = format!(
                "{} needs {asks}, which the plan no longer keeps in every schedule: {stands}",
                self.user(condition)
            );
            return Some(Violation::new(self.stage.name(of.start).into(), reason, News::None));
        }
        Some(self.lost_range(resource, coming, (least, greatest), &stands))
    }

    /// The first condition on a level, still to come or going on, that what is to come does not keep in every schedule from
    /// where the level is now (SPEC 17).
    fn lost_condition(&self, resource: ResourceId, coming: &[(Time, UseId)]) -> Option<UseId> {
        let network = &self.stage.network;
        let moment = |used: UseId| network.uses[used.index()].moment();
        let is_before = |one: NodeId, other: NodeId| one != other && self.stage.happens_before(one, other);
        let has_come = |node: NodeId| self.stage.times[node.index()].is_some();
        let is_lost = |id: &&UseId| {
            let of = &network.uses[id.index()];
            let Some(level) = of.level.filter(|_| of.resource == resource && !has_come(of.end)) else {
                return false;
            };
            let is_maximum = of.change == Change::Produces;
            let breaks = |reached: Option<Rational>| {
                reached.is_some_and(|reached| !level.order.holds(reached, level.bound))
            };
            if !of.is_lasting() {
                let counts = |&&(_, used): &&(Time, UseId)| {
                    let event = moment(used);
                    if network.uses[used.index()].change == of.change {
                        event != of.start && !is_before(of.start, event)
                    } else {
                        is_before(event, of.start)
                    }
                };
                return breaks(self.level_after(resource, is_maximum, coming.iter().filter(counts)));
            }
            if has_come(of.start) && breaks(self.level_after(resource, is_maximum, [].iter())) {
                return true;
            }
            coming.iter().any(|&(_, at)| {
                let event = moment(at);
                let is_apart =
                    is_before(of.end, event) || (!has_come(of.start) && is_before(event, of.start));
                network.uses[at.index()].change == of.change
                    && !is_apart
                    && breaks(self.level_after(resource, is_maximum, self.worst_before(coming, at)))
            })
        };
        self.stage.effects.conditions.iter().find(is_lost).copied()
    }

    /// Returns what counts of what is to come when one use happens, where as much of its own kind has happened as may,
    /// and of the other kind what must.
    fn worst_before<'c>(
        &'c self,
        coming: &'c [(Time, UseId)],
        at: UseId,
    ) -> impl Iterator<Item = &'c (Time, UseId)> {
        let network = &self.stage.network;
        let is_gain = move |used: UseId| network.uses[used.index()].change == Change::Produces;
        let moment = move |used: UseId| network.uses[used.index()].moment();
        coming.iter().filter(move |&&(_, other)| {
            if is_gain(other) == is_gain(at) {
                // What happens after it does not count.
                let is_later = self.stage.happens_before(moment(at), moment(other));
                !is_later || self.stage.happens_before(moment(other), moment(at))
            } else {
                self.stage.happens_before(moment(other), moment(at))
            }
        })
    }

    /// The greatest possible level after these if `is_most`, otherwise the least.
    fn level_after<'c>(
        &self,
        resource: ResourceId,
        is_most: bool,
        mut uses: impl Iterator<Item = &'c (Time, UseId)>,
    ) -> Option<Rational> {
        let now = self.possible_levels(resource)?[usize::from(is_most)];
        uses.try_fold(now, |level, &(_, used)| {
            let changes = self.stage.network.uses[used.index()].level_changes();
            level.checked_add(changes[usize::from(is_most)])
        })
    }

    /// That a level will not stay in its range: what takes it out of it, if what is to come comes as early as it may.
    fn lost_range(
        &self,
        resource: ResourceId,
        coming: Vec<(Time, UseId)>,
        (least, greatest): (Rational, Rational),
        stands: &str,
    ) -> Violation {
        let network = &self.stage.network;
        let (node, reason) =
            if let Some((at, used, level)) = self.first_out_of_range(resource, coming, (least, greatest)) {
                let of = &network.uses[used.index()];
                let who = self.user(used);
                let (verb, with, limit) = if level < least {
                    ("needs", "of", format!("below {}", least.readable()))
                } else {
                    ("gives", "to", format!("above {}", greatest.readable()))
                };
                let name = &network.resources[resource.index()].name;
                let (amount, level, at) = (of.readable_amount(), level.readable(), shown(at));
                let taken = format!("which would take it to {level}, {limit}");
                (of.moment(), format!("{who} {verb} {amount} {with} {name} at {at}, {taken}: {stands}"))
            } else {
                let range = format!("between {} and {}", least.readable(), greatest.readable());
                let text = format!("{stands}: the plan no longer keeps its level {range} in every schedule");
                (network.start, text)
            };
        Violation::new(self.stage.name(node).into(), reason, News::None)
    }

    /// Returns whether what is to come keeps a level in its range in every schedule (SPEC 11), from where it is now.
    fn keeps_range(
        &self,
        resource: ResourceId,
        coming: &[(Time, UseId)],
        (least, greatest): (Rational, Rational),
    ) -> bool {
        let is_gain = |used: UseId| self.stage.network.uses[used.index()].change == Change::Produces;
        coming.iter().all(|&(_, at)| {
            let level = self.level_after(resource, is_gain(at), self.worst_before(coming, at));
            level.is_none_or(|level| if is_gain(at) { level <= greatest } else { level >= least })
        })
    }

    /// The present level as it is counted, and its maximum: traverses under way may take less than is counted.
    fn possible_levels(&self, resource: ResourceId) -> Option<[Rational; 2]> {
        let network = &self.stage.network;
        let now = self.state.level(resource);
        let has_come = |node: NodeId| self.stage.times[node.index()].is_some();
        let mut most = now;
        for &used in &self.stage.effects.moves {
            let of = &network.uses[used.index()];
            let is_known = of.owner.is_some_and(|owner| self.extra_m.contains_key(&owner));
            let is_under_way = has_come(of.start) && !has_come(of.end) && !is_known;
            if of.resource == resource && of.change == Change::Consumes && is_under_way {
                most = most.checked_add(of.amount.checked_sub(of.at_least)?)?;
            }
        }
        Some([now, most])
    }

    /// Returns where the level first leaves its range if all that is to come comes as early as it may.
    fn first_out_of_range(
        &self,
        resource: ResourceId,
        mut coming: Vec<(Time, UseId)>,
        (least, greatest): (Rational, Rational),
    ) -> Option<(Time, UseId, Rational)> {
        coming.sort_unstable();
        let [mut low, mut high] = self.possible_levels(resource)?;
        // What may be given back while traverses are under way fills nothing before something is produced.
        let mut produced = None;
        for (index, &(at, used)) in coming.iter().enumerate() {
            let of = &self.stage.network.uses[used.index()];
            let [less, more] = of.level_changes();
            (low, high) = (low.checked_add(less)?, high.checked_add(more)?);
            if of.change == Change::Produces {
                produced = Some(used);
            }
            // Only the level after an instant counts.
            if coming.get(index + 1).is_some_and(|&(next, _)| next == at) {
                continue;
            }
            if low < least {
                return Some((at, used, low));
            }
            if let Some(used) = produced.take().filter(|_| high > greatest) {
                return Some((at, used, high));
            }
        }
        None
    }
}

/// A variable that keeps its value and one of its values, by their names.
fn named(network: &Network, variable: &str, value: &str) -> Option<(VariableId, ValueId)> {
    let is_named = |it: &tpn::Variable| it.is_lasting && it.name == variable;
    let index = network.variables.iter().position(is_named)?;
    let known = network.variables[index].values.iter().position(|known| known == value)?;
    Some((VariableId::from_index(index), ValueId::from_index(known)))
}

/// Returns how far a traverse has driven, in words for the cause of a violation.
fn driven(network: &Network, occurrence: OccurrenceId, extra_m: Rational) -> String {
    format!(
        "{} has driven {} m {} than its path",
        network.occurrences[occurrence.index()].name,
        magnitude(extra_m).readable(),
        if extra_m.is_negative() { "less" } else { "more" }
    )
}

/// A number without its sign.
fn magnitude(number: Rational) -> Rational {
    if number.is_negative() { number.checked_neg().unwrap_or_default() } else { number }
}
