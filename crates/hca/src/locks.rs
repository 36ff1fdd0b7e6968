//! Locks of programs that run together (SPEC 8.5): who is granted what, whose goals are set aside, and who waits for whom.
//!
//! Whether constraints can hold together is decided by the values of their variables alone.

use std::collections::btree_map::{BTreeMap, Entry};

use rmpl::control::{Constraint, ConstraintKind};
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

use crate::automaton::{Automaton, CompositeId, Element, LocationId, TestId};
use crate::step::Stepper;
use crate::vocabulary::Variable;

/// Index of a lock.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct LockId(pub u32);

/// A lock of an automaton.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Lock {
    pub composite: CompositeId,
    /// How it is called, such as `LOCK Camera=On`.
    pub label: SmolStr,
    /// What is locked.
    pub test: TestId,
    /// Where it is waited for.
    pub waiting: LocationId,
    /// What asserts the constraint.
    pub assertion: LocationId,
    /// What is done while it is locked.
    pub body: Element,
    /// Whether something around it ends its waiting: TIMEOUT, WITHIN or DO-WATCHING.
    pub is_bounded: bool,
}

/// How a lock stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) enum LockState {
    #[default]
    Free,
    /// Since the end of this step, or since the program's start.
    Waiting(u64),
    Held {
        was_entailed: bool,
    },
}

impl LockState {
    /// The step since which it has been waited for, if it is.
    pub(crate) const fn waiting_since(&self) -> Option<u64> {
        match self {
            Self::Waiting(since) => Some(*since),
            Self::Free | Self::Held { .. } => None,
        }
    }
}

/// A lock of one of several programs, by the program's place.
type Which = (usize, LockId);

/// The locks of several programs.
struct Table<'programs, 'stepper> {
    programs: &'programs [&'stepper mut Stepper],
}

impl Table<'_, '_> {
    fn in_state(&self, is_such: impl Fn(LockState) -> bool) -> Vec<Which> {
        let each = self.programs.iter().enumerate().flat_map(|(program, stepper)| {
            let states = (0..).map(LockId).zip(stepper.lock_states().iter().copied());
            states.map(move |(lock, state)| ((program, lock), state))
        });
        each.filter(|(_, state)| is_such(*state)).map(|(which, _)| which).collect()
    }

    fn held(&self) -> Vec<Which> {
        self.in_state(|state| matches!(state, LockState::Held { .. }))
    }

    fn lock(&self, (program, lock): Which) -> Option<(&Automaton, &Lock)> {
        let automaton = &**self.programs.get(program)?.automaton();
        Some((automaton, automaton.locks.get(lock.0 as usize)?))
    }

    fn constraint(&self, which: Which) -> Option<(&Automaton, &Constraint)> {
        let (automaton, lock) = self.lock(which)?;
        Some((automaton, &automaton.guard(lock.test)?.constraint))
    }

    fn can_hold(&self, locks: &[Which], with: (&Automaton, &Constraint)) -> bool {
        let locks = locks.iter().filter_map(|which| self.constraint(*which));
        can_hold_together(&locks.chain([with]).collect::<Vec<_>>())
    }

    /// Returns whether a location of a program is part of what is done under a lock.
    fn is_under(&self, (program, location): (usize, LocationId), which: Which) -> bool {
        program == which.0
            && self
                .lock(which)
                .is_some_and(|(automaton, lock)| automaton.locations_of(lock.body).contains(&location.0))
    }

    /// The first minimal set of held locks that contradicts a waiting one; none if it is granted at the next chance.
    fn waits_for(&self, waiting: Which, held: &[Which]) -> Vec<Which> {
        let Some(wanted) = self.constraint(waiting) else { return Vec::new() };
        if self.can_hold(held, wanted) {
            return Vec::new();
        }
        let mut left = held.to_vec();
        for one in held.iter().rev() {
            let without: Vec<Which> = left.iter().filter(|known| *known != one).copied().collect();
            if !self.can_hold(&without, wanted) {
                left = without;
            }
        }
        left
    }
}

/// Grants waiting locks: those that have waited longest first, then in the order of the programs and of the text.
pub fn grant(programs: &mut [&mut Stepper]) {
    let table = Table { programs };
    let mut waiting: Vec<(u64, Which)> = Vec::new();
    for which in table.in_state(|state| matches!(state, LockState::Waiting(_))) {
        let waited = table.programs.get(which.0).and_then(|stepper| stepper.waited(which.1));
        waiting.extend(waited.filter(|waited| *waited > 0).map(|waited| (waited, which)));
    }
    waiting.sort_by_key(|(waited, which)| (std::cmp::Reverse(*waited), *which));
    for (_, which) in waiting {
        let table = Table { programs };
        let is_free = table.constraint(which).is_some_and(|wanted| table.can_hold(&table.held(), wanted));
        if let Some(stepper) = programs.get_mut(which.0).filter(|_| is_free) {
            stepper.grant(which.1);
        }
    }
}

/// Finds the marked locations whose goals cannot hold together with what is locked around them.
pub fn set_aside(programs: &mut [&mut Stepper]) {
    if programs.iter().all(|stepper| stepper.lock_states().is_empty()) {
        return;
    }
    let table = Table { programs };
    let held = table.held();
    let mut aside: Vec<Vec<LocationId>> = Vec::with_capacity(table.programs.len());
    for (program, stepper) in table.programs.iter().enumerate() {
        let automaton = stepper.automaton();
        let is_aside = |location: &LocationId| {
            let assertion = automaton.location(*location).and_then(|data| data.assertion.as_ref());
            let goal = assertion.and_then(|assertion| automaton.guard(assertion.test));
            let around: Vec<Which> =
                held.iter().filter(|which| !table.is_under((program, *location), **which)).copied().collect();
            goal.is_some_and(|goal| !table.can_hold(&around, (automaton, &goal.constraint)))
        };
        aside.push(if held.is_empty() {
            Vec::new()
        } else {
            stepper.marking().iter().filter(is_aside).collect()
        });
    }
    for (stepper, aside) in programs.iter_mut().zip(&aside) {
        stepper.set_locations_aside(aside);
    }
}

/// The names of locks that wait for each other in a ring which nothing around them ends.
pub fn deadlock(programs: &[&mut Stepper]) -> Option<Vec<SmolStr>> {
    let table = Table { programs };
    let held = table.held();
    let waiting = table.in_state(|state| matches!(state, LockState::Waiting(_)));
    let is_endless = |which: &Which| table.lock(*which).is_some_and(|(_, lock)| !lock.is_bounded);
    let mut next: BTreeMap<Which, Vec<Which>> = BTreeMap::new();
    for which in waiting.iter().filter(|which| is_endless(which)) {
        next.insert(*which, table.waits_for(*which, &held).into_iter().filter(is_endless).collect());
    }
    for which in held.iter().filter(|which| is_endless(which)) {
        let inside = |other: &Which| {
            let place = table.lock(*other).map(|(_, lock)| (other.0, lock.waiting));
            place.is_some_and(|place| table.is_under(place, *which))
        };
        next.insert(
            *which,
            waiting.iter().filter(|other| is_endless(other) && inside(other)).copied().collect(),
        );
    }
    let ring = next.keys().find_map(|first| ring_from(*first, &next))?;
    let label = |which: &Which| table.lock(*which).map(|(_, lock)| lock.label.clone());
    Some(ring.iter().filter_map(label).collect())
}

/// The shortest way from a lock back to itself, if there is one.
fn ring_from(first: Which, next: &BTreeMap<Which, Vec<Which>>) -> Option<Vec<Which>> {
    let mut before: BTreeMap<Which, Which> = BTreeMap::new();
    let mut reached = std::collections::VecDeque::from([first]);
    while let Some(at) = reached.pop_front() {
        for &to in next.get(&at).into_iter().flatten() {
            if to == first {
                let mut ring = vec![at];
                while let Some(&earlier) = ring.last().and_then(|last| before.get(last)) {
                    ring.push(earlier);
                }
                ring.reverse();
                return Some(ring);
            }
            if let Entry::Vacant(place) = before.entry(to) {
                place.insert(at);
                reached.push_back(to);
            }
        }
    }
    None
}

/// Returns whether some values of their variables satisfy several constraints; variables of one name are one.
pub(crate) fn can_hold_together(constraints: &[(&Automaton, &Constraint)]) -> bool {
    let mut counts: BTreeMap<&str, Domain<'_>> = BTreeMap::new();
    for (automaton, constraint) in constraints {
        domains(automaton, constraint, &mut counts);
    }
    search(constraints, &counts, &mut BTreeMap::new())
}

/// The values of a variable that constraints speak of; the empty one represents all others of an open domain.
type Domain<'data> = Vec<&'data str>;

fn domains<'data>(
    automaton: &'data Automaton,
    constraint: &'data Constraint,
    into: &mut BTreeMap<&'data str, Domain<'data>>,
) {
    match &constraint.kind {
        ConstraintKind::Not(inner) => domains(automaton, inner, into),
        ConstraintKind::And(parts) | ConstraintKind::Or(parts) => {
            for part in parts {
                domains(automaton, part, into);
            }
        }
        ConstraintKind::Equals { variable, value } => {
            let known = into.entry(&variable.text).or_default();
            let data: Option<&Variable> =
                automaton.variable(&variable.text).and_then(|id| automaton.variables.get(id.0 as usize));
            let values = data.into_iter().flat_map(|data| data.values.iter().map(SmolStr::as_str));
            let other = data.is_none_or(|data| !data.closed).then_some("");
            for value in values.chain([value.text.as_str()]).chain(other) {
                if !known.contains(&value) {
                    known.push(value);
                }
            }
        }
        _ => {}
    }
}

fn search<'data>(
    constraints: &[(&Automaton, &Constraint)],
    domains: &BTreeMap<&'data str, Domain<'data>>,
    chosen: &mut BTreeMap<&'data str, &'data str>,
) -> bool {
    let mut is_open = false;
    for (_, constraint) in constraints {
        match truth(constraint, chosen) {
            Some(false) => return false,
            Some(true) => {}
            None => is_open = true,
        }
    }
    if !is_open {
        return true;
    }
    let Some((&name, values)) = domains.iter().find(|(name, _)| !chosen.contains_key(*name)) else {
        return true;
    };
    for &value in values {
        chosen.insert(name, value);
        if search(constraints, domains, chosen) {
            return true;
        }
    }
    chosen.remove(name);
    false
}

/// Three-valued: `None` while what was chosen leaves it open.
fn truth(constraint: &Constraint, chosen: &BTreeMap<&str, &str>) -> Option<bool> {
    match &constraint.kind {
        ConstraintKind::True => Some(true),
        ConstraintKind::False | ConstraintKind::Parameter(_) | ConstraintKind::Unreadable => Some(false),
        ConstraintKind::Equals { variable, value } => {
            Some(*chosen.get(variable.text.as_str())? == value.text.as_str())
        }
        ConstraintKind::Not(inner) => truth(inner, chosen).map(|value| !value),
        ConstraintKind::And(parts) => joined(parts, chosen, false),
        ConstraintKind::Or(parts) => joined(parts, chosen, true),
    }
}

fn joined(parts: &[Constraint], chosen: &BTreeMap<&str, &str>, deciding: bool) -> Option<bool> {
    let mut result = Some(!deciding);
    for part in parts {
        match truth(part, chosen) {
            Some(value) if value == deciding => return Some(deciding),
            Some(_) => {}
            None => result = None,
        }
    }
    result
}
