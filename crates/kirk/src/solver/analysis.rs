//! Conflict analysis: from a conflict back to the one literal of its level that everything went through (1-UIP).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::Solver;
use super::literal::Literal;
use super::trail::{Cause, Conflict};
use crate::ids::EventId;

/// What a conflict teaches.
#[derive(Debug)]
pub(crate) struct Learned {
    /// The first literal is the one that holds from now on; the second, if any, is of `level`.
    pub(crate) clause: Vec<Literal>,
    pub(crate) level: u32,
    pub(crate) num_levels: u32,
}

/// Room for analysis.
#[derive(Clone, Debug, Default)]
pub(crate) struct Analysis {
    /// Literals of the conflict's level that are still to be explained, by their event.
    open: BinaryHeap<(EventId, Reverse<i64>)>,
    /// Literals of lower levels.
    lower: Vec<Literal>,
    reason: Conflict,
}

impl Solver {
    /// Returns what a conflict teaches; `None` if there is no solution. The conflict's literals hold.
    pub(super) fn analyze(&mut self, conflict: &[Literal]) -> Option<Learned> {
        let levels = conflict.iter().map(|&literal| self.level_of(literal));
        let level = levels.max().unwrap_or(0);
        if level == 0 {
            return None;
        }
        let mut analysis = std::mem::take(&mut self.analysis);
        analysis.open.clear();
        analysis.lower.clear();
        for &literal in conflict {
            self.meet(literal, level, &mut analysis);
        }
        let decisive = loop {
            let (event, Reverse(mut most)) = analysis.open.pop()?;
            while let Some(&(same, Reverse(other))) = analysis.open.peek()
                && same == event
            {
                most = most.min(other);
                analysis.open.pop();
            }
            let literal = Literal::new(self.trail.events[event].side, most);
            self.bump(literal);
            if analysis.open.is_empty() {
                break literal;
            }
            let mut reason = std::mem::take(&mut analysis.reason);
            reason.clear();
            self.explain(literal, event, &mut reason);
            self.conclude_by(event, &reason);
            for &literal in &reason {
                self.meet(literal, level, &mut analysis);
            }
            analysis.reason = reason;
        };
        // Of several bounds of one side the tightest one implies the others.
        analysis.lower.sort_unstable_by_key(|literal| (literal.side, literal.most));
        analysis.lower.dedup_by_key(|literal| literal.side);
        let lower = analysis.lower.iter().copied();
        let kept: Vec<Literal> = lower
            .filter(|&literal| !decisive.implies(literal) && !self.is_implied(literal, &analysis))
            .collect();
        for &literal in &kept {
            self.bump(literal);
        }
        self.analysis = analysis;
        let mut clause = vec![!decisive];
        clause.extend(kept.iter().map(|&literal| !literal));
        let mut levels: Vec<u32> = kept.iter().map(|&literal| self.level_of(literal)).collect();
        let mut back = 0;
        for (position, &level) in (1..).zip(&levels) {
            if level > back {
                back = level;
                clause.swap(1, position);
            }
        }
        levels.sort_unstable();
        levels.dedup();
        Some(Learned { clause, level: back, num_levels: levels.len() as u32 + 1 })
    }

    pub(super) fn level_of(&self, literal: Literal) -> u32 {
        self.trail.implying_event(literal).map_or(0, |event| self.trail.events[event].level)
    }

    fn meet(&self, literal: Literal, level: u32, analysis: &mut Analysis) {
        debug_assert!(self.trail.holds(literal), "reasons hold");
        let Some(event) = self.trail.implying_event(literal) else { return };
        match self.trail.events[event].level {
            0 => {}
            lower if lower < level => analysis.lower.push(literal),
            _ => analysis.open.push((event, Reverse(literal.most))),
        }
    }

    /// Returns whether a literal follows from the others of lower levels.
    fn is_implied(&mut self, literal: Literal, analysis: &Analysis) -> bool {
        let Some(event) = self.trail.implying_event(literal) else { return false };
        if self.trail.events[event].cause == Cause::Decision {
            return false;
        }
        let mut reason = Vec::new();
        self.explain(literal, event, &mut reason);
        let is_implied = reason.iter().all(|&part| {
            let known = analysis.lower.binary_search_by_key(&part.side, |known| known.side);
            // What came later may rest on this one.
            let is_known = known.is_ok_and(|position| {
                let known = analysis.lower[position];
                known.implies(part) && self.trail.implying_event(known) < Some(event)
            });
            is_known || self.level_of(part) == 0
        });
        if is_implied {
            self.conclude_by(event, &reason);
        }
        is_implied
    }

    /// Why a literal holds whose event is given: other literals that hold and imply it.
    pub(super) fn explain(&mut self, literal: Literal, event: EventId, reason: &mut Conflict) {
        if let Cause::Clause(id) = self.trail.events[event].cause {
            self.clauses.bump(id);
        }
        self.reason_of(literal, event, reason);
    }

    /// The same without a trace in the search.
    pub(super) fn reason_of(&self, literal: Literal, event: EventId, reason: &mut Conflict) {
        match self.trail.events[event].cause {
            Cause::Decision => {}
            Cause::Clause(id) => {
                let others = self.clauses.literals(id).iter().filter(|other| !literal_is(**other, literal));
                reason.extend(others.map(|&other| !other));
            }
            Cause::Difference(id) => self.differences.explain(&self.trail, literal, id, reason),
            Cause::Refuted(id) => self.differences.explain_refuted(&self.trail, id, event, reason),
            Cause::Empty(variable) => {
                let most = self.trail.bound_before(variable.upper(), event);
                reason.push(Literal::new(variable.upper(), most));
                reason.push(!Literal::new(variable.upper(), most));
            }
            Cause::Implied(side) => reason.push(side.decided()),
            Cause::Alternatives(id) => {
                self.alternatives.explain(&self.trail, literal, id, event, reason);
            }
            Cause::Noted(note) => reason.extend_from_slice(self.trail.noted(note)),
        }
    }
}

/// Returns whether a clause's literal is the one that it made hold, of which `literal` is a consequence.
fn literal_is(other: Literal, literal: Literal) -> bool {
    other.side == literal.side
}
