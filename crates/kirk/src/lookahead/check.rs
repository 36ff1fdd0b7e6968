//! Whether requirements can still be carried, and whether conflicting intervals still fit in some order.

use stn::{Inconsistency, Overflow, PointId, Tag};

use super::{CONSEQUENCE, HULL, LONGEST_PAUSE, Lookahead, context_of, interval, link_edges};
use crate::model::{INFINITE, Model, NONE};
use crate::structure::{Relation, Structure};

/// What can become of one assertion for a requirement.
enum Candidate {
    Possible,
    Open,
    Impossible,
}

impl Lookahead {
    /// Whether the start of everything keeps `to − from ≤ weight` from holding, by the nodes' own contexts.
    pub(super) fn is_refused(&self, (from, to, weight): (PointId, PointId, i64)) -> bool {
        let (latest, least) = (self.from_start[from.index()], self.to_start[to.index()]);
        latest != INFINITE
            && least != INFINITE
            && latest
                .checked_add(weight)
                .and_then(|time| time.checked_add(least))
                .is_some_and(|slack| slack < 0)
    }

    /// Whether that is so for what a link asks for.
    pub(crate) fn refuses_link(&self, model: &Model, ask: u32, tell: u32) -> bool {
        link_edges(model, ask, tell).iter().any(|&edge| self.is_refused(edge))
    }

    /// Turns a contradiction into blame.
    pub(super) fn is_ok(
        &mut self,
        model: &Model,
        result: Result<(), Inconsistency>,
    ) -> Result<bool, Overflow> {
        match result {
            Ok(()) => Ok(true),
            Err(Inconsistency::Overflow) => Err(Overflow),
            Err(Inconsistency::NegativeCycle) => {
                self.blame_cycle(model);
                Ok(false)
            }
        }
    }

    fn blame_cycle(&mut self, model: &Model) {
        for edge in self.stn.cycle() {
            if edge.tag == HULL {
                continue;
            }
            if edge.tag >= CONSEQUENCE {
                self.blamed.extend_from_slice(&self.reasons[(edge.tag - CONSEQUENCE) as usize]);
            } else {
                let context = model.arcs[edge.tag as usize].context;
                if context.decision != NONE {
                    self.blamed.push(context.decision);
                }
            }
        }
    }

    fn blame_label(&mut self, model: &Model, label: u32) {
        let context = context_of(model, label);
        if context.decision != NONE {
            self.blamed.push(context.decision);
        }
    }

    pub(super) fn check_labels(
        &mut self,
        model: &Model,
        structure: &Structure,
        chosen: &[u32],
        first: usize,
    ) -> Result<bool, Overflow> {
        for position in 0..first {
            let label = self.labels[position];
            if !self.is_in_question(model, label) {
                continue;
            }
            if !self.check_ask_again(model, chosen, label)? {
                return Ok(false);
            }
        }
        for position in first..self.labels.len() {
            let label = self.labels[position];
            if self.is_in_question(model, label) {
                if !self.check_ask(model, chosen, label)? {
                    return Ok(false);
                }
                self.guess_carrier(model, label)?;
            }
            for other in model.conditions.conflicts(label) {
                let is_earlier = self.is_active_label[other as usize]
                    && self.label_position[other as usize] < position as u32;
                if is_earlier && !self.check_pair(model, structure, label, other)? {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    /// Links each requirement that every plan has to the assertion that carries it, where windows leave one only; the
    /// network is to be settled then. `false` if they leave none.
    pub(super) fn link_what_windows_leave(&mut self, model: &Model) -> bool {
        for position in 0..self.labels.len() {
            let ask = self.labels[position];
            if !self.is_in_question(model, ask) {
                continue;
            }
            let is_left = |lookahead: &Self, tell: u32| {
                !lookahead.is_active_label[tell as usize] || !lookahead.refuses_link(model, ask, tell)
            };
            let mut left = model.conditions.supporters(ask).filter(|&tell| is_left(self, tell));
            match (left.next(), left.next()) {
                (None, _) => return false,
                (Some(only), None) if self.is_active_label[only as usize] => {
                    let tag = CONSEQUENCE + self.reasons.len() as Tag;
                    self.reasons.push(Vec::new());
                    for (from, to, weight) in link_edges(model, ask, only) {
                        self.stn.push(from, to, weight, tag);
                    }
                    self.is_linked[ask as usize] = true;
                }
                _ => {}
            }
        }
        true
    }

    /// Whether a label is a requirement that is not linked for good.
    fn is_in_question(&self, model: &Model, label: u32) -> bool {
        model.conditions.labels[label as usize].is_ask && !self.is_linked[label as usize]
    }

    /// Whether two conflicting intervals fit in some order.
    fn check_pair(
        &mut self,
        model: &Model,
        structure: &Structure,
        left: u32,
        right: u32,
    ) -> Result<bool, Overflow> {
        let arc = |label: u32| model.conditions.labels[label as usize].arc;
        if arc(left) == arc(right) {
            self.blamed.clear();
            self.blame_label(model, left);
            return Ok(false);
        }
        if structure.relation(arc(left), arc(right)) != Relation::Open {
            return Ok(true);
        }
        // Edges that put the left one first, and the right one first: touching is allowed for, since it may be entailed.
        let order = |first: u32, then: u32| {
            let (_, first_end) = interval(model, first);
            let (then_start, _) = interval(model, then);
            (then_start, first_end, -model.gap_after[first as usize])
        };
        let (left_first, right_first) = (order(left, right), order(right, left));
        if self.holds(left_first) || self.holds(right_first) {
            return Ok(true);
        }
        self.blamed.clear();
        if self.admits(model, left_first)? {
            if self.admits(model, right_first)? {
                return Ok(true);
            }
            self.conclude(model, &[left, right], &[left_first])
        } else {
            self.conclude(model, &[left, right], &[right_first])
        }
    }

    /// Whether some assertion can carry a requirement.
    fn check_ask(&mut self, model: &Model, chosen: &[u32], ask: u32) -> Result<bool, Overflow> {
        self.blamed.clear();
        let mut only = NONE;
        for tell in model.conditions.supporters(ask) {
            match self.candidate(model, chosen, ask, tell)? {
                Candidate::Impossible => {}
                // What is open may be chosen later; two possibilities leave nothing to conclude.
                Candidate::Open => return Ok(true),
                Candidate::Possible if only != NONE => return Ok(true),
                Candidate::Possible => {
                    self.witness[ask as usize] = tell;
                    only = tell;
                }
            }
        }
        if only == NONE {
            self.blame_label(model, ask);
            return Ok(false);
        }
        let edges = link_edges(model, ask, only);
        self.conclude(model, &[ask, only], &edges)
    }

    /// Whether some assertion can carry a requirement that was checked before; most can still be carried as was guessed.
    ///
    /// Where that needs a thorough look and nothing follows from it, the next one is put off for twice as long.
    fn check_ask_again(&mut self, model: &Model, chosen: &[u32], ask: u32) -> Result<bool, Overflow> {
        let has_guess = self.guessed[ask as usize].is_some() || self.guess_carrier(model, ask)?;
        let is_due = self.is_thorough && self.num_decided >= self.due[ask as usize].0;
        let is_settled = if is_due {
            self.is_carried(model, ask)
        } else {
            has_guess || self.can_stay(model, chosen, ask)?
        };
        if is_settled {
            return Ok(true);
        }
        let num_reasons = self.reasons.len();
        let is_possible = self.check_ask(model, chosen, ask)?;
        if is_due {
            let has_followed = !is_possible || self.reasons.len() > num_reasons;
            let (due, pause) = &mut self.due[ask as usize];
            *pause = if has_followed { 0 } else { (*pause * 2 + 1).min(LONGEST_PAUSE) };
            *due = self.num_decided + *pause;
        }
        Ok(is_possible)
    }

    /// Whether some selected assertion carries a requirement in the present schedule.
    fn is_carried(&self, model: &Model, ask: u32) -> bool {
        let mut carriers = model.conditions.supporters(ask);
        carriers.any(|tell| {
            self.is_active_label[tell as usize]
                && link_edges(model, ask, tell).iter().all(|&edge| self.holds(edge))
        })
    }

    /// Whether the assertion found last can still carry a requirement.
    fn can_stay(&mut self, model: &Model, chosen: &[u32], ask: u32) -> Result<bool, Overflow> {
        let tell = self.witness[ask as usize];
        if tell == NONE || !self.is_active_label[tell as usize] {
            return Ok(false);
        }
        Ok(matches!(self.candidate(model, chosen, ask, tell)?, Candidate::Possible))
    }

    fn candidate(
        &mut self,
        model: &Model,
        chosen: &[u32],
        ask: u32,
        tell: u32,
    ) -> Result<Candidate, Overflow> {
        if !self.is_active_label[tell as usize] {
            let mut context = context_of(model, tell);
            while context.decision != NONE {
                let taken = chosen[context.decision as usize];
                if taken != NONE && taken != context.alternative {
                    self.blamed.push(context.decision);
                    return Ok(Candidate::Impossible);
                }
                context = model.decisions[context.decision as usize].context;
            }
            return Ok(Candidate::Open);
        }
        let edges = link_edges(model, ask, tell);
        if edges.iter().all(|&edge| self.holds(edge)) || edges.iter().all(|&edge| self.is_guided(edge)) {
            return Ok(Candidate::Possible);
        }
        if edges.iter().any(|&edge| self.is_refused(edge)) {
            self.blame_label(model, tell);
            return Ok(Candidate::Impossible);
        }
        // A contradiction with an edge of the link rests on the labels' own choices.
        let admitted = self.stn.admits_all(&edges, HULL);
        if self.is_ok(model, admitted)? {
            return Ok(Candidate::Possible);
        }
        self.blame_label(model, tell);
        Ok(Candidate::Impossible)
    }

    /// Adds what is left as a consequence of `blamed` and of the labels' choices. `false` if it does not fit either.
    fn conclude(
        &mut self,
        model: &Model,
        labels: &[u32],
        edges: &[(PointId, PointId, i64)],
    ) -> Result<bool, Overflow> {
        for &label in labels {
            self.blame_label(model, label);
        }
        self.blamed.sort_unstable();
        self.blamed.dedup();
        let tag = CONSEQUENCE + self.reasons.len() as Tag;
        self.reasons.push(self.blamed.clone());
        for &(from, to, weight) in edges {
            let inserted = self.insert((from, to, weight), tag);
            if !self.is_ok(model, inserted)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether the schedule that keeps the guesses, too, keeps `to − from ≤ weight`.
    fn is_guided(&self, (from, to, weight): (PointId, PointId, i64)) -> bool {
        let schedule = self.guide.schedule();
        schedule[to.index()].checked_sub(schedule[from.index()]).is_some_and(|distance| distance <= weight)
    }

    /// Whether the present schedule keeps `to − from ≤ weight`.
    fn holds(&self, (from, to, weight): (PointId, PointId, i64)) -> bool {
        let schedule = self.stn.schedule();
        schedule[to.index()].checked_sub(schedule[from.index()]).is_some_and(|distance| distance <= weight)
    }

    fn admits(&mut self, model: &Model, edge: (PointId, PointId, i64)) -> Result<bool, Overflow> {
        if self.is_guided(edge) {
            return Ok(true);
        }
        let (from, to, weight) = edge;
        let admitted = self.stn.admits(from, to, weight, HULL);
        self.is_ok(model, admitted)
    }
}
