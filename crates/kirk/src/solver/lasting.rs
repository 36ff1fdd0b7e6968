//! Variables that keep their values (SPEC 10.2): which change comes first, which one each requirement rests on, and that
//! nothing comes between the two.
//!
//! Two changes that exclude each other are ordered by a choice point. Where a requirement rests on a change, each other
//! one that would break it comes before that change, or after the requirement.

use std::collections::BTreeMap;

use tpn::{CausalLink, LabelId, Ordering};

use super::encode::{Part, Problem};
use super::growth::{CLAUSE, Growth, LINK, ORDER, Unencoded};
use super::interval::Interval;
use super::literal::Literal;
use super::premise::Premise;
use super::solution::Kept;
use super::tours::MAX_MOVEMENTS;
use super::{ChoicePoint, ChoicePointKind, Solver};
use crate::demands::LastingVariable;
use crate::failure::Member;
use crate::structure::Relation;
use crate::trace::{Departing, TreeChoice};

/// Pairs of so few movements as a tour may have.
const MAX_PAIRS: usize = MAX_MOVEMENTS * MAX_MOVEMENTS;

/// So many effects on one variable are told to exclude each other as a set.
const MANY_EFFECTS: usize = 5;

/// What the solver knows of variables that keep their values.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sides {
    /// The literals of both orders of each pair of changes that exclude each other and that nesting does not order, the
    /// textually earlier one first.
    pub(super) orders: BTreeMap<(LabelId, LabelId), [Literal; 2]>,
    /// What each requirement may rest on.
    pub(super) carriers: Vec<(LabelId, Vec<(LabelId, Literal)>)>,
    /// That a requirement is over before a change that would break it.
    pub(super) kept_before: Vec<(Ordering, Literal)>,
    /// That a movement sets out where another change has left its vehicle.
    pub(super) departures: Vec<(Departing, Literal)>,
    /// How long a movement takes at least, by the literal of where it begins.
    pub(super) min_movements: BTreeMap<Literal, i64>,
}

impl Problem<'_> {
    /// Adds the orders and links of all variables that keep their values.
    pub(super) fn add_lasting(
        &mut self,
        solver: &mut Solver,
        part: Part<'_>,
        growth: &mut Growth<'_>,
    ) -> Result<(), Unencoded> {
        let model = self.model;
        let is_active = |label: &LabelId| part.active_labels.is_none_or(|active| active[*label]);
        let mut changing: Vec<Vec<LabelId>> = Vec::with_capacity(model.demands.variables.len());
        let mut requirements: Vec<(LabelId, usize)> = Vec::new();
        for (index, variable) in model.demands.variables.iter().enumerate() {
            let exists = |label: &LabelId| {
                solver.takes_nothing_for_granted() || !solver.trail.fails(self.intervals[*label].presence)
            };
            changing.push(variable.changes.iter().copied().filter(is_active).filter(exists).collect());
            let asks = variable.asks.iter().copied().filter(is_active).filter(exists);
            requirements.extend(asks.map(|ask| (ask, index)));
        }
        // Links come before orders, both in textual order (SPEC 5.4).
        requirements.sort_unstable();
        for &(ask, index) in &requirements {
            self.add_carriers(solver, ask, &model.demands.variables[index], growth)?;
        }
        let mut pairs: Vec<(LabelId, LabelId)> = Vec::new();
        for changes in &changing {
            for (position, &left) in changes.iter().enumerate() {
                let later = &changes[position + 1..];
                growth.look_at(later.len())?;
                let before = pairs.len();
                pairs
                    .extend(later.iter().map(|&right| (left, right)).filter(|&pair| self.is_unordered(pair)));
                growth.add(ORDER * (pairs.len() - before))?;
            }
        }
        pairs.sort_unstable();
        for (left, right) in pairs {
            growth.look_at(ORDER)?;
            self.add_sides(solver, left, right);
        }
        for changes in &changing {
            self.exclude_effects(solver, changes);
        }
        self.add_threats(solver, &requirements, &changing, growth)?;
        for (variable, changes) in model.demands.variables.iter().zip(&changing) {
            // Between movements that do not count the vehicle is somewhere else.
            if variable.changes.iter().all(is_active) {
                self.add_departures(solver, variable, changes, growth)?;
            }
        }
        Ok(())
    }

    /// While an effect changes a variable nothing else may (SPEC 10.2, rule 2): of one variable no two overlap. Of few, their
    /// orders are soon gone through, and say more of a failure.
    fn exclude_effects(&self, solver: &mut Solver, changes: &[LabelId]) {
        let labels = &self.model.conditions.labels;
        let effects = changes.iter().copied().filter(|&change| labels[change].is_changing);
        let tasks: Vec<Interval> = effects.map(|effect| self.intervals[effect]).collect();
        if let Some(&first) = changes.first().filter(|_| tasks.len() >= MANY_EFFECTS) {
            solver.disjunctives.add_tasks(tasks, Premise::Variable(labels[first].variable));
        }
    }

    /// A movement takes at least as long as it does from where the one right before it ends (SPEC 10.3).
    fn add_departures(
        &mut self,
        solver: &mut Solver,
        variable: &LastingVariable,
        changes: &[LabelId],
        growth: &mut Growth<'_>,
    ) -> Result<(), Unencoded> {
        let model = self.model;
        solver.tell_from(changes.iter().copied().map(Member::Condition));
        let mut durations = vec![vec![None; changes.len()]; changes.len() + 1];
        for (column, &movement) in changes.iter().enumerate() {
            let Some(departures) = model.demands.departures.get(&movement) else { continue };
            let moving = self.intervals[movement];
            let mut found = vec![!moving.presence];
            let possible = self.undominated(movement, changes, |_| true);
            for before in variable.initial.into_iter().chain(possible.iter().copied()) {
                if before == movement || !self.can_be_together(before, movement) {
                    continue;
                }
                let is_initial = Some(before) == variable.initial;
                let order = if is_initial { Some(Literal::TRUE) } else { self.before(before, movement) };
                let Some(order) =
                    order.filter(|&order| solver.takes_nothing_for_granted() || !solver.trail.fails(order))
                else {
                    continue;
                };
                growth.add(LINK + CLAUSE * changes.len())?;
                let last = solver.boolean();
                solver.resize();
                solver.imply(last, order);
                solver.imply(last, moving.presence);
                solver.imply(last, self.intervals[before].presence);
                for &other in changes.iter().filter(|&&other| other != movement && other != before) {
                    // It is earlier still, or later than the movement.
                    let earlier = (!is_initial).then(|| self.before(other, before)).flatten();
                    let later = self.before(movement, other);
                    let other_presence = self.intervals[other].presence;
                    if self.can_be_together(other, movement) && self.can_be_together(other, before) {
                        let ways = [!last, !other_presence].into_iter().chain(earlier).chain(later);
                        solver.at_least_one(ways);
                    }
                }
                let departure =
                    departures.iter().find(|departure| model.conditions.gives_value(before, departure.from));
                let least = departure.map_or(Some(0), |departure| departure.least);
                let row = changes.iter().position(|&change| change == before).unwrap_or(changes.len());
                durations[row][column] = least.map(|least| least.max(moving.duration));
                match departure.map(|departure| departure.least) {
                    None => {}
                    Some(None) => solver.assert(!last),
                    Some(Some(least)) => {
                        let first = solver.differences.len();
                        solver.difference(moving.end, moving.start, -least, [last; 2]);
                        self.sides.min_movements.insert(last, least);
                        solver.check_differences(first);
                    }
                }
                self.sides.departures.push((Departing { movement, before }, last));
                found.push(last);
            }
            solver.at_least_one(found);
        }
        if self.are_movements_in_any_order(changes) {
            let movements = changes.iter().map(|&movement| self.intervals[movement]).collect();
            let quickest = solver.tours.add(movements, &durations);
            for (position, &first) in quickest.iter().enumerate() {
                for &then in &quickest[position + 1..] {
                    self.prefer_before(solver, changes[first], changes[then]);
                }
            }
        }
        Ok(())
    }

    /// Tries first that one change comes before another.
    fn prefer_before(&self, solver: &mut Solver, first: LabelId, then: LabelId) {
        let Some(order) = self.before(first, then) else { return };
        for id in solver.choice_points_of.iter(order.side.variable()) {
            let ChoicePoint { kind, options, last, .. } = &mut solver.choice_points[id];
            if *kind == ChoicePointKind::Sides
                && let Some(option) = options.iter().position(|&option| option == order)
            {
                *last = Some(option as u32);
            }
        }
    }

    /// Returns whether all changes of a variable are movements of which no two overlap, and planning orders most of
    /// them.
    fn are_movements_in_any_order(&self, changes: &[LabelId]) -> bool {
        let pairs = changes
            .iter()
            .enumerate()
            .flat_map(|(position, &left)| changes[position + 1..].iter().map(move |&right| (left, right)));
        let mut open = 0;
        for (left, right) in pairs.take(MAX_PAIRS) {
            if !self.can_be_together(left, right) {
                continue;
            }
            if self.before(left, right).is_none() {
                return false;
            }
            open += usize::from(self.model.nested_order(left, right) == Relation::Open);
        }
        open > changes.len()
            && changes.len() <= MAX_MOVEMENTS
            && changes.iter().all(|change| self.model.demands.departures.contains_key(change))
    }

    fn add_carriers(
        &mut self,
        solver: &mut Solver,
        ask: LabelId,
        variable: &LastingVariable,
        growth: &mut Growth<'_>,
    ) -> Result<(), Unencoded> {
        let asked = self.intervals[ask];
        solver.tell_from([Member::Condition(ask)]);
        // Nothing that is nested before what breaks the requirement can carry it.
        let breaks = |change: LabelId| self.model.conditions.breaks(change, ask);
        let possible = self.undominated(ask, &variable.changes, breaks);
        let is_broken = possible.len() < variable.changes.len();
        let initial = variable.initial.filter(|_| !is_broken);
        let carriers: Vec<LabelId> = initial
            .into_iter()
            .chain(possible)
            .filter(|&change| self.can_give(solver, ask, change))
            .collect();
        growth.look_at(variable.changes.len())?;
        growth.add(LINK * carriers.len())?;
        let is_only = carriers.len() == 1;
        let mut options = Vec::with_capacity(carriers.len());
        for change in carriers {
            options.push((change, if is_only { asked.presence } else { solver.boolean() }));
        }
        solver.resize();
        let first = solver.differences.len();
        for &(change, link) in &options {
            let given = self.intervals[change];
            solver.imply(link, given.presence);
            solver.imply(link, asked.presence);
            solver.difference(asked.start, self.ready[change], 0, [link; 2]);
        }
        let literals: Vec<Literal> = options.iter().map(|&(_, link)| link).collect();
        solver.check_differences(first);
        if !is_only {
            solver.at_least_one(literals.iter().copied().chain([!asked.presence]));
            let kind = ChoicePointKind::Carriers { ask };
            let when = vec![asked.presence];
            solver.add_exclusive_choice_point(ChoicePoint { when, kind, options: literals, last: None });
        }
        self.sides.carriers.push((ask, options));
        Ok(())
    }

    /// Returns whether a requirement could rest on a change, by their alternatives and windows.
    fn can_give(&self, solver: &Solver, ask: LabelId, change: LabelId) -> bool {
        let labels = &self.model.conditions.labels;
        // What is nested after the requirement comes too late, within an instant as well.
        let comes_too_late = self.model.nested_order(change, ask) == Relation::After;
        // Nothing rests on its own effect.
        let is_own_effect = labels[change].is_changing && labels[change].arc == labels[ask].arc;
        self.model.conditions.gives(change, ask)
            && !is_own_effect
            && self.can_be_together(ask, change)
            && !comes_too_late
            && (solver.takes_nothing_for_granted() || self.fit_windows(solver, ask, change))
    }

    /// Returns whether windows let a requirement rest on a change.
    fn fit_windows(&self, solver: &Solver, ask: LabelId, change: LabelId) -> bool {
        let (asked, given) = (self.intervals[ask], self.intervals[change]);
        !solver.trail.fails(given.presence)
            && solver.trail.least(self.ready[change]) <= solver.trail.most(asked.start)
    }

    /// Returns whether two changes exclude each other, and planning has to order them.
    fn is_unordered(&self, (left, right): (LabelId, LabelId)) -> bool {
        self.model.conditions.exclude(left, right)
            && self.can_be_together(left, right)
            && self.model.nested_order(left, right) == Relation::Open
    }

    /// A choice point of the orders of two changes that exclude each other.
    fn add_sides(&mut self, solver: &mut Solver, left: LabelId, right: LabelId) {
        let (one, other) = (self.intervals[left], self.intervals[right]);
        solver.tell_from([left, right].map(Member::Condition));
        let left_first = solver.boolean();
        let presences = [one.presence, other.presence];
        let is_certain = solver.are_certain(&presences);
        let right_first = if is_certain { !left_first } else { solver.boolean() };
        solver.resize();
        // As of other pairs, an order says nothing where they are not both there.
        if !is_certain {
            solver.at_least_one([!presences[0], !presences[1], left_first, right_first]);
        }
        let first = solver.differences.len();
        solver.difference(other.start, one.end, 0, [left_first; 2]);
        solver.difference(one.start, other.end, 0, [right_first; 2]);
        let kind = ChoicePointKind::Sides;
        let options = vec![left_first, right_first];
        solver.add_exclusive_choice_point(ChoicePoint {
            when: presences.to_vec(),
            kind,
            options,
            last: None,
        });
        solver.check_differences(first);
        self.sides.orders.insert((left, right), [left_first, right_first]);
    }

    /// That one change comes before another that it excludes.
    fn before(&self, first: LabelId, then: LabelId) -> Option<Literal> {
        match self.model.nested_order(first, then) {
            Relation::Before => Some(Literal::TRUE),
            Relation::After => Some(!Literal::TRUE),
            Relation::Open => {
                let orders = self.sides.orders.get(&(first.min(then), first.max(then)))?;
                Some(orders[usize::from(first > then)])
            }
        }
    }

    /// The changes that can be the last before a label: nesting puts no other one in between that comes in any case and
    /// that counts.
    fn undominated(
        &self,
        label: LabelId,
        changes: &[LabelId],
        counts: impl Fn(LabelId) -> bool,
    ) -> Vec<LabelId> {
        let model = self.model;
        let context = |label: LabelId| model.arcs[model.conditions.labels[label].arc].context;
        let is_certain = |change: LabelId| context(change).is_none_or(|own| Some(own) == context(label));
        let is_between = |&change: &LabelId| {
            counts(change) && is_certain(change) && model.nested_order(change, label) == Relation::Before
        };
        let last = changes.iter().rev().copied().find(is_between);
        let is_possible =
            |&change: &LabelId| last.is_none_or(|last| model.nested_order(change, last) != Relation::Before);
        changes.iter().copied().filter(is_possible).collect()
    }

    /// What would break a requirement comes before what it rests on, or after it.
    fn add_threats(
        &mut self,
        solver: &mut Solver,
        requirements: &[(LabelId, usize)],
        changing: &[Vec<LabelId>],
        growth: &mut Growth<'_>,
    ) -> Result<(), Unencoded> {
        for (position, &(ask, variable)) in requirements.iter().enumerate() {
            let asked = self.intervals[ask];
            let options = self.sides.carriers[position].1.clone();
            for &threat in &changing[variable] {
                growth.look_at(1 + options.len())?;
                if !self.model.conditions.breaks(threat, ask)
                    || !self.can_be_together(ask, threat)
                    || self.model.nested_order(ask, threat) == Relation::Before
                {
                    continue;
                }
                let threatening = self.intervals[threat];
                solver.tell_from([ask, threat].map(Member::Condition));
                let mut is_over: Option<Literal> = None;
                for &(change, link) in &options {
                    if change == threat || !self.can_be_together(change, threat) {
                        continue;
                    }
                    let is_before = self.before(threat, change);
                    if is_before == Some(Literal::TRUE) {
                        continue;
                    }
                    let kept_before = &mut self.sides.kept_before;
                    let after = *is_over.get_or_insert_with(|| {
                        let after = solver.boolean();
                        kept_before.push((Ordering { first: ask, then: threat }, after));
                        solver.resize();
                        let first = solver.differences.len();
                        solver.difference(threatening.start, asked.end, 0, [after; 2]);
                        solver.check_differences(first);
                        after
                    });
                    growth.add(CLAUSE)?;
                    let clause = [!link, !threatening.presence, after];
                    solver.at_least_one(clause.into_iter().chain(is_before));
                }
            }
        }
        Ok(())
    }

    /// Returns what the literals of variables that keep their values say.
    pub(super) fn names_of_kept(&self) -> Vec<(Literal, TreeChoice)> {
        let mut names = Vec::new();
        for (ask, options) in &self.sides.carriers {
            let link = |tell| TreeChoice::Link(CausalLink { ask: *ask, tell });
            names.extend(options.iter().map(|&(tell, literal)| (literal, link(tell))));
        }
        for (&(left, right), &[left_first, right_first]) in &self.sides.orders {
            names.push((left_first, TreeChoice::Order(Ordering { first: left, then: right })));
            names.push((right_first, TreeChoice::Order(Ordering { first: right, then: left })));
        }
        let kept_before = self.sides.kept_before.iter();
        names.extend(kept_before.map(|&(order, literal)| (literal, TreeChoice::Order(order))));
        let departures = self.sides.departures.iter();
        names.extend(departures.map(|&(departing, literal)| (literal, TreeChoice::Departure(departing))));
        names
    }

    /// Returns what the solver's solution says of variables that keep their values.
    pub(crate) fn kept(&self, solver: &Solver) -> Kept {
        let exists = |label: LabelId| solver.trail.holds(self.intervals[label].presence);
        let mut kept = Kept::default();
        for (ask, options) in self.sides.carriers.iter().filter(|(ask, _)| exists(*ask)) {
            if let Some((change, _)) = options.iter().find(|(_, link)| solver.trail.holds(*link)) {
                kept.links.push((*ask, *change));
            }
        }
        let over = self.sides.kept_before.iter().filter(|(_, after)| solver.trail.holds(*after));
        kept.over_before = over.map(|(order, _)| (order.first, order.then)).collect();
        for variable in &self.model.demands.variables {
            let mut changes: Vec<LabelId> =
                variable.changes.iter().copied().filter(|&change| exists(change)).collect();
            // Only those that begin and end at one instant may be in another order.
            changes.sort_by_key(|&change| {
                let Interval { start, end, .. } = self.intervals[change];
                (solver.trail.least(start), solver.trail.least(end), change)
            });
            let is_before = |first: LabelId, then: LabelId| {
                self.before(first, then).is_some_and(|literal| solver.trail.holds(literal))
            };
            kept.order.extend(variable.in_order(&self.model.conditions, &changes, is_before));
        }
        kept
    }

    /// The literals of the present solution's links and sides: a solution without one of them is another one.
    pub(crate) fn kept_literals(&self, solver: &Solver) -> Vec<Literal> {
        let links = self.sides.carriers.iter().flat_map(|(_, options)| options.iter().map(|&(_, link)| link));
        let orders = self.sides.orders.values().flatten().copied();
        links.chain(orders).filter(|&literal| solver.trail.holds(literal)).collect()
    }
}
