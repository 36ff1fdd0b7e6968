//! What a refutation rests on: which parts of the problem its derivation uses (an unsatisfiable core; Zhang and Malik 2003).
//!
//! Whatever the solver is told has a premise. While it searches, each learned clause keeps what its analysis went through;
//! where everything is refuted, the walk back from there finds the premises. A core need not be minimal, and where
//! something has no premise in the mission's terms it says so ([`Premise::Unknown`]).

use std::collections::{BTreeMap, BTreeSet};

use tpn::ArcId;
use typed_index_collections::TiVec;

use super::Solver;
use super::encode::Problem;
use super::literal::{Literal, Side, Variable};
use super::premise::Premise;
use super::trail::Cause;
use crate::failure::Member;
use crate::ids::{ClauseId, CommonBoundId, DerivationId, DifferenceId, EventId};
use crate::trace::Constraint;

/// A premise that a derivation uses, and the sides that its conclusion was drawn from: of what is shared by many, those at
/// these sides count.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Used {
    premise: Premise,
    sides: Vec<Side>,
}

impl From<Premise> for Used {
    fn from(premise: Premise) -> Self {
        Self { premise, sides: Vec::new() }
    }
}

/// What one conclusion was drawn from.
#[derive(Clone, Debug, Default)]
struct Derivation {
    used: Vec<Used>,
    /// Other conclusions.
    concluded: Vec<DerivationId>,
    clauses: Vec<ClauseId>,
    differences: Vec<DifferenceId>,
    commons: Vec<CommonBoundId>,
    /// Bounds that hold whatever is decided.
    roots: Vec<EventId>,
}

/// The derivations of a search, where they are wanted.
#[derive(Clone, Debug, Default)]
pub(super) struct Derivations {
    /// Of what is being told.
    at_hand: Option<DerivationId>,
    differences: TiVec<DifferenceId, Option<DerivationId>>,
    clauses: BTreeMap<ClauseId, Option<DerivationId>>,
    /// Of bounds that were set without any other reason.
    units: BTreeMap<EventId, Option<DerivationId>>,
    all: TiVec<DerivationId, Derivation>,
    /// Of what is being concluded.
    open: Derivation,
    /// Whether `open` is the refutation of everything.
    is_refutation: bool,
}

impl Solver {
    /// Keeps what is derived from what, from now on. Before anything is told.
    pub(super) fn keep_derivations(&mut self) {
        self.derivations = Some(Box::default());
        self.differences.keeps_cycles = true;
    }

    /// What is told next comes from these premises.
    pub(super) fn tell_from_premises(&mut self, premises: impl IntoIterator<Item = Premise>) {
        let Some(derivations) = &mut self.derivations else { return };
        let used = premises.into_iter().map(Used::from).collect();
        let derivation = Derivation { used, ..Derivation::default() };
        derivations.at_hand = Some(derivations.all.push_and_get_key(derivation));
    }

    /// The same for parts of the mission.
    pub(super) fn tell_from(&mut self, members: impl IntoIterator<Item = Member>) {
        self.tell_from_premises(members.into_iter().map(Premise::Member));
    }

    /// What is told next is how the program is built.
    pub(super) fn tell_structure(&mut self) {
        if let Some(derivations) = &mut self.derivations {
            derivations.at_hand = None;
        }
    }

    /// Two steps of one difference were added.
    pub(super) fn told_difference(&mut self) {
        if let Some(derivations) = &mut self.derivations {
            derivations.differences.extend([derivations.at_hand; 2]);
        }
    }

    pub(super) fn told_clause(&mut self, clause: ClauseId) {
        if let Some(derivations) = &mut self.derivations {
            derivations.clauses.insert(clause, derivations.at_hand);
        }
    }

    /// Returns whether nothing may be taken for granted that has a reason, so that the reason is found.
    pub(super) const fn takes_nothing_for_granted(&self) -> bool {
        self.derivations.is_some()
    }

    /// Returns whether these hold, and may be taken for granted.
    pub(super) fn are_certain(&self, literals: &[Literal]) -> bool {
        let is_certain = |&literal: &Literal| {
            self.trail.holds(literal) && (literal == Literal::TRUE || !self.takes_nothing_for_granted())
        };
        literals.iter().all(is_certain)
    }

    /// The event `first` is a bound that was set at the root by what is being told, since these literals hold.
    pub(super) fn told_unit(&mut self, first: EventId, others: &[Literal]) {
        if self.derivations.is_none() || first >= self.trail.events.next_key() {
            return;
        }
        self.begin_derivation(&[]);
        self.conclude_from_told();
        self.conclude_from(others);
        self.concluded(None, first);
    }

    /// These literals hold and cannot, whatever is decided, by what is being told.
    pub(super) fn told_refutation(&mut self, conflict: &[Literal]) {
        self.begin_derivation(&[]);
        self.conclude_from_told();
        self.conclude_from(conflict);
        self.concluded_refutation();
    }

    fn conclude_from_told(&mut self) {
        if let Some(derivations) = &mut self.derivations
            && let Some(at_hand) = derivations.at_hand
        {
            derivations.open.used.extend_from_slice(&derivations.all[at_hand].used);
        }
    }

    /// Begins the analysis of a conflict.
    pub(super) fn begin_derivation(&mut self, conflict: &[Literal]) {
        let Some(derivations) = &mut self.derivations else { return };
        derivations.open = Derivation::default();
        if !conflict.is_empty() {
            let sides = conflict.iter().map(|literal| literal.side).collect();
            derivations.open.used.push(Used { premise: self.trail.premise, sides });
        }
    }

    /// A conclusion rests on literals; those that hold whatever is decided are explained at the end.
    pub(super) fn conclude_from(&mut self, literals: &[Literal]) {
        let Some(derivations) = &mut self.derivations else { return };
        for &literal in literals {
            if let Some(event) = self.trail.implying_event(literal)
                && self.trail.events[event].level == 0
            {
                derivations.open.roots.push(event);
            }
        }
    }

    /// A conclusion rests on the reason of an event.
    pub(super) fn conclude_by(&mut self, event: EventId, reason: &[Literal]) {
        let Some(derivations) = &mut self.derivations else { return };
        let open = &mut derivations.open;
        match self.trail.events[event].cause {
            // The event may be taken back before anybody asks for it.
            Cause::Decision => open.concluded.extend(derivations.units.get(&event).copied().flatten()),
            Cause::Empty(_) | Cause::Implied(_) => {}
            Cause::Clause(clause) => open.clauses.push(clause),
            Cause::Difference(id) | Cause::Refuted(id) => open.differences.push(id),
            Cause::Alternatives(id) => open.commons.push(id),
            Cause::Noted(note) => {
                let sides = reason.iter().map(|literal| literal.side).collect();
                open.used.push(Used { premise: self.trail.premise_of(note), sides });
            }
        }
        self.conclude_from(reason);
    }

    /// What was concluded is a clause, or a bound that holds whatever is decided.
    pub(super) fn concluded(&mut self, clause: Option<ClauseId>, event: EventId) {
        let Some(derivations) = &mut self.derivations else { return };
        let id = derivations.all.push_and_get_key(std::mem::take(&mut derivations.open));
        match clause {
            Some(clause) => derivations.clauses.insert(clause, Some(id)),
            None => derivations.units.insert(event, Some(id)),
        };
    }

    /// What was concluded is that there is no solution.
    pub(super) fn concluded_refutation(&mut self) {
        if let Some(derivations) = &mut self.derivations {
            derivations.is_refutation = true;
        }
    }

    /// Returns what the refutation rests on. `None` if there is none, or if it was not kept.
    fn core(&self) -> Option<BTreeSet<Used>> {
        let derivations = self.derivations.as_ref().filter(|derivations| derivations.is_refutation)?;
        let mut walk = Walk::new(self, derivations);
        walk.take(&derivations.open);
        walk.run();
        Some(walk.used)
    }
}

impl Problem<'_> {
    /// The parts of the mission that the refutation rests on. `None` if there is no refutation, if it was not kept, or if it
    /// rests on something that has no name.
    pub(crate) fn core(&self, solver: &Solver) -> Option<Vec<Member>> {
        let mut members = BTreeSet::new();
        for Used { premise, sides } in solver.core()? {
            let is_among = |times: [Variable; 2]| {
                times.iter().any(|time| sides.iter().any(|side| side.variable() == *time))
            };
            let lower = |arc: ArcId| Member::Bound(Constraint::Lower(arc));
            match premise {
                Premise::Structure | Premise::Cycle(_) => {}
                Premise::Member(member) => {
                    members.insert(member);
                }
                Premise::Variable(variable) => {
                    for (id, label) in self.model.conditions.labels.iter_enumerated() {
                        let interval = &self.intervals[id];
                        if label.variable == variable && is_among([interval.start, interval.end]) {
                            members.extend([Member::Condition(id), lower(label.arc)]);
                        }
                    }
                }
                Premise::Resource(index) => {
                    for used in &self.model.demands.resources[index].uses {
                        if is_among([used.start, used.end].map(|node| self.times[node])) {
                            members.extend([Member::Use(used.id), lower(used.arc)]);
                        }
                    }
                }
                Premise::Unknown => return None,
            }
        }
        Some(members.into_iter().collect())
    }
}

/// A walk back through derivations.
struct Walk<'a> {
    solver: &'a Solver,
    derivations: &'a Derivations,
    used: BTreeSet<Used>,
    events: Vec<EventId>,
    open: Vec<DerivationId>,
    met_events: BTreeSet<EventId>,
    met: BTreeSet<DerivationId>,
}

impl<'a> Walk<'a> {
    fn new(solver: &'a Solver, derivations: &'a Derivations) -> Self {
        Self {
            solver,
            derivations,
            used: BTreeSet::new(),
            events: Vec::new(),
            open: Vec::new(),
            met_events: BTreeSet::new(),
            met: BTreeSet::new(),
        }
    }

    fn run(&mut self) {
        loop {
            if let Some(id) = self.open.pop() {
                self.take(&self.derivations.all[id]);
            } else if let Some(event) = self.events.pop() {
                self.take_event(event);
            } else {
                return;
            }
        }
    }

    fn take(&mut self, derivation: &Derivation) {
        for used in &derivation.used {
            self.take_premise(used.premise, &used.sides);
        }
        for &id in &derivation.concluded {
            self.take_source(Some(id));
        }
        for &clause in &derivation.clauses {
            self.take_clause(clause);
        }
        for &difference in &derivation.differences {
            self.take_source(self.derivations.differences[difference]);
        }
        for &common in &derivation.commons {
            self.take_common(common);
        }
        for &event in &derivation.roots {
            self.meet(event);
        }
    }

    /// What something comes from; `None` if that is how the program is built.
    fn take_source(&mut self, source: Option<DerivationId>) {
        if let Some(id) = source.filter(|&id| self.met.insert(id)) {
            self.open.push(id);
        }
    }

    fn take_clause(&mut self, clause: ClauseId) {
        match self.derivations.clauses.get(&clause) {
            Some(&source) => self.take_source(source),
            None => self.take_premise(Premise::Unknown, &[]),
        }
    }

    fn take_premise(&mut self, premise: Premise, sides: &[Side]) {
        match premise {
            Premise::Structure => {}
            Premise::Cycle(id) => {
                for &difference in self.solver.differences.cycle(id) {
                    self.take_source(self.derivations.differences[difference]);
                }
            }
            Premise::Variable(_) | Premise::Resource(_) => {
                self.used.insert(Used { premise, sides: sides.to_vec() });
            }
            Premise::Member(_) | Premise::Unknown => {
                self.used.insert(Used { premise, sides: Vec::new() });
            }
        }
    }

    fn take_common(&mut self, common: CommonBoundId) {
        for premise in self.solver.alternatives.premises(common) {
            self.take_premise(premise, &[]);
        }
    }

    fn meet(&mut self, event: EventId) {
        if self.met_events.insert(event) {
            self.events.push(event);
        }
    }

    /// A bound that holds whatever is decided.
    fn take_event(&mut self, event: EventId) {
        let trail = &self.solver.trail;
        let mut reason = Vec::new();
        let whole = Literal::new(trail.events[event].side, trail.events[event].most);
        self.solver.reason_of(whole, event, &mut reason);
        match trail.events[event].cause {
            Cause::Decision => match self.derivations.units.get(&event) {
                Some(&source) => self.take_source(source),
                None => self.take_premise(Premise::Unknown, &[]),
            },
            Cause::Empty(_) | Cause::Implied(_) => {}
            Cause::Clause(clause) => self.take_clause(clause),
            Cause::Difference(id) | Cause::Refuted(id) => {
                self.take_source(self.derivations.differences[id]);
            }
            Cause::Alternatives(id) => self.take_common(id),
            Cause::Noted(note) => {
                let sides: Vec<Side> = reason.iter().map(|literal| literal.side).collect();
                self.take_premise(trail.premise_of(note), &sides);
            }
        }
        for literal in reason {
            if let Some(event) = trail.implying_event(literal) {
                self.meet(event);
            }
        }
    }
}
