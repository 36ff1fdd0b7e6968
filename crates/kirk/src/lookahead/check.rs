//! Whether requirements can still be carried, and whether conflicting intervals still fit in some order.

use stn::{Inconsistency, PointId};
use tpn::LabelId;

use super::{Lookahead, MAX_PAUSE, Origin, context_of, interval, link_edges};
use crate::model::{Alternatives, INFINITE, Model};
use crate::structure::{Relation, Structure};
use crate::unplannable::Unplannable;

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
    pub(crate) fn refuses_link(&self, model: &Model, ask: LabelId, tell: LabelId) -> bool {
        link_edges(model, ask, tell).iter().any(|&edge| self.is_refused(edge))
    }

    /// Whether nothing is contradicted; otherwise conflict analysis finds the decisions that the contradiction rests on.
    pub(super) fn is_ok(
        &mut self,
        model: &Model,
        result: Result<(), Inconsistency>,
    ) -> Result<bool, Unplannable> {
        match result {
            Ok(()) => Ok(true),
            Err(Inconsistency::Overflow(overflow)) => Err(overflow.into()),
            Err(Inconsistency::NegativeCycle) => {
                self.add_cycle_to_conflict(model);
                Ok(false)
            }
        }
    }

    fn add_cycle_to_conflict(&mut self, model: &Model) {
        for edge in self.stn.cycle() {
            match Origin::of(edge.tag) {
                Origin::Relaxation => {}
                Origin::Consequence(consequence) => {
                    self.conflict.extend_from_slice(&self.reasons[consequence]);
                }
                Origin::Arc(arc) => {
                    self.conflict.extend(model.arcs[arc].context.map(|choice| choice.decision));
                }
            }
        }
    }

    fn add_label_to_conflict(&mut self, model: &Model, label: LabelId) {
        self.conflict.extend(context_of(model, label).map(|choice| choice.decision));
    }

    pub(super) fn check_labels(
        &mut self,
        model: &Model,
        structure: &Structure,
        chosen: &Alternatives,
        first: usize,
    ) -> Result<bool, Unplannable> {
        for position in 0..first {
            let label = self.labels[position];
            if !self.is_in_question(model, label) {
                continue;
            }
            if !self.check_ask_again(model, chosen, label)? {
                return Ok(false);
            }
        }
        // Without choices the search looks at each pair as soon as this does.
        let looks_at_pairs = !model.decisions.is_empty();
        for position in first..self.labels.len() {
            let label = self.labels[position];
            if self.is_in_question(model, label) {
                if !self.check_ask(model, chosen, label)? {
                    return Ok(false);
                }
                self.guess_carrier(model, label)?;
            }
            if !looks_at_pairs {
                continue;
            }
            for other in model.conditions.conflicts(label) {
                let is_earlier = self.is_active_label[other] && self.label_position[other] < position as u32;
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
            let is_left = |lookahead: &Self, tell: LabelId| {
                !lookahead.is_active_label[tell] || !lookahead.refuses_link(model, ask, tell)
            };
            let mut left = model.conditions.supporters(ask).filter(|&tell| is_left(self, tell));
            match (left.next(), left.next()) {
                (None, _) => return false,
                (Some(only), None) if self.is_active_label[only] => {
                    let consequence = self.reasons.push_and_get_key(Vec::new());
                    let tag = Origin::Consequence(consequence).tag();
                    for (from, to, weight) in link_edges(model, ask, only) {
                        self.stn.push(from, to, weight, tag);
                    }
                    self.is_linked[ask] = true;
                }
                _ => {}
            }
        }
        true
    }

    /// Whether a label is a requirement that is not linked for good.
    fn is_in_question(&self, model: &Model, label: LabelId) -> bool {
        model.conditions.labels[label].is_ask && !self.is_linked[label]
    }

    /// Whether two conflicting intervals fit in some order.
    fn check_pair(
        &mut self,
        model: &Model,
        structure: &Structure,
        left: LabelId,
        right: LabelId,
    ) -> Result<bool, Unplannable> {
        let arc = |label: LabelId| model.conditions.labels[label].arc;
        if arc(left) == arc(right) {
            self.conflict.clear();
            self.add_label_to_conflict(model, left);
            return Ok(false);
        }
        if structure.relation(arc(left), arc(right)) != Relation::Open {
            return Ok(true);
        }
        // Edges that put the left one first, and the right one first: touching is allowed for, since it may be entailed.
        let order = |first: LabelId, then: LabelId| {
            let (_, first_end) = interval(model, first);
            let (then_start, _) = interval(model, then);
            (then_start, first_end, -model.gap_after[first])
        };
        let (left_first, right_first) = (order(left, right), order(right, left));
        if self.holds(left_first) || self.holds(right_first) {
            return Ok(true);
        }
        self.conflict.clear();
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
    fn check_ask(&mut self, model: &Model, chosen: &Alternatives, ask: LabelId) -> Result<bool, Unplannable> {
        self.conflict.clear();
        let mut only = None;
        for tell in model.conditions.supporters(ask) {
            match self.candidate(model, chosen, ask, tell)? {
                Candidate::Impossible => {}
                // What is open may be chosen later; two possibilities leave nothing to conclude.
                Candidate::Open => return Ok(true),
                Candidate::Possible if only.is_some() => return Ok(true),
                Candidate::Possible => {
                    self.witness[ask] = Some(tell);
                    only = Some(tell);
                }
            }
        }
        let Some(only) = only else {
            self.add_label_to_conflict(model, ask);
            return Ok(false);
        };
        let edges = link_edges(model, ask, only);
        self.conclude(model, &[ask, only], &edges)
    }

    /// Whether some assertion can carry a requirement that was checked before; most can still be carried as was guessed.
    ///
    /// Where that needs a thorough look and nothing follows from it, the next one is put off for twice as long.
    fn check_ask_again(
        &mut self,
        model: &Model,
        chosen: &Alternatives,
        ask: LabelId,
    ) -> Result<bool, Unplannable> {
        let has_guess = self.guessed[ask].is_some() || self.guess_carrier(model, ask)?;
        let is_due = self.is_thorough && self.num_decided >= self.due[ask].0;
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
            let (due, pause) = &mut self.due[ask];
            *pause = if has_followed { 0 } else { (*pause * 2 + 1).min(MAX_PAUSE) };
            *due = self.num_decided + *pause;
        }
        Ok(is_possible)
    }

    /// Whether some selected assertion carries a requirement in the present schedule.
    fn is_carried(&self, model: &Model, ask: LabelId) -> bool {
        let mut carriers = model.conditions.supporters(ask);
        carriers.any(|tell| {
            self.is_active_label[tell] && link_edges(model, ask, tell).iter().all(|&edge| self.holds(edge))
        })
    }

    /// Whether the assertion found last can still carry a requirement.
    fn can_stay(&mut self, model: &Model, chosen: &Alternatives, ask: LabelId) -> Result<bool, Unplannable> {
        let Some(tell) = self.witness[ask].filter(|&tell| self.is_active_label[tell]) else {
            return Ok(false);
        };
        Ok(matches!(self.candidate(model, chosen, ask, tell)?, Candidate::Possible))
    }

    fn candidate(
        &mut self,
        model: &Model,
        chosen: &Alternatives,
        ask: LabelId,
        tell: LabelId,
    ) -> Result<Candidate, Unplannable> {
        if !self.is_active_label[tell] {
            let mut context = context_of(model, tell);
            while let Some(choice) = context {
                if chosen[choice.decision].is_some_and(|taken| taken != choice.alternative) {
                    self.conflict.push(choice.decision);
                    return Ok(Candidate::Impossible);
                }
                context = model.decisions[choice.decision].context;
            }
            return Ok(Candidate::Open);
        }
        let edges = link_edges(model, ask, tell);
        if edges.iter().all(|&edge| self.holds(edge)) || edges.iter().all(|&edge| self.is_guided(edge)) {
            return Ok(Candidate::Possible);
        }
        if edges.iter().any(|&edge| self.is_refused(edge)) {
            self.add_label_to_conflict(model, tell);
            return Ok(Candidate::Impossible);
        }
        // A contradiction with an edge of the link rests on the labels' own choices.
        let admitted = self.stn.admits_all(&edges, Origin::Relaxation.tag());
        if self.is_ok(model, admitted)? {
            return Ok(Candidate::Possible);
        }
        self.add_label_to_conflict(model, tell);
        Ok(Candidate::Impossible)
    }

    /// Adds what is left as a consequence of `conflict` and of the labels' choices. `false` if it does not fit either.
    fn conclude(
        &mut self,
        model: &Model,
        labels: &[LabelId],
        edges: &[(PointId, PointId, i64)],
    ) -> Result<bool, Unplannable> {
        for &label in labels {
            self.add_label_to_conflict(model, label);
        }
        self.conflict.sort_unstable();
        self.conflict.dedup();
        let origin = Origin::Consequence(self.reasons.push_and_get_key(self.conflict.clone()));
        for &(from, to, weight) in edges {
            let inserted = self.insert((from, to, weight), origin);
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

    fn admits(&mut self, model: &Model, edge: (PointId, PointId, i64)) -> Result<bool, Unplannable> {
        if self.is_guided(edge) {
            return Ok(true);
        }
        let (from, to, weight) = edge;
        let admitted = self.stn.admits(from, to, weight, Origin::Relaxation.tag());
        self.is_ok(model, admitted)
    }
}
