//! Going back from a failure: what it rests on, what is learned from it, and to which level it leads.

use tpn::{Choice, LabelId};

use super::{Engine, Gaps};
use crate::failure::FailureKind;
use crate::ids::LevelId;
use crate::levels::Kind;
use crate::trace::{Event, TreeChoice, TreeStatus};
use crate::unplannable::Unplannable;

impl Engine<'_> {
    /// Removes the topmost level, whose alternatives have all failed.
    pub(super) fn exhaust_level(&mut self) {
        let Some(level) = self.levels.pop() else { return };
        self.at = level.tree_node;
        self.set_status(self.at, TreeStatus::Failed);
        self.conflict.clone_from(&level.conflict);
        match level.kind {
            Kind::Decision { decision } => {
                self.level_of[decision] = None;
                if self.structure.is_none() {
                    self.frontier.insert(decision);
                }
                self.add_context_to_conflict(self.decision_context(decision));
            }
            Kind::Link { ask, tells, .. } => {
                self.log(|_| Event::Unclosable { ask });
                if tells.is_empty() {
                    self.meet_failure(FailureKind::OpenCondition);
                }
                self.failures.add_label(ask);
                self.add_link_to_conflict(ask);
            }
            Kind::Threat { left, right, .. } => {
                self.log(|_| Event::Unresolvable { left, right });
                self.failures.add_label(left);
                self.failures.add_label(right);
                for label in [left, right] {
                    self.add_context_to_conflict(self.context(self.model.conditions.labels[label].arc));
                }
            }
        }
    }

    /// A requirement fails because it is selected, and because other assertions are not.
    fn add_link_to_conflict(&mut self, ask: LabelId) {
        let model = self.model;
        self.add_context_to_conflict(self.context(model.conditions.labels[ask].arc));
        for tell in model.conditions.supporters(ask) {
            if self.is_selected_label(tell) {
                continue;
            }
            if !model.has_contexts {
                self.conflict.insert_all_below(self.levels.next_key());
                return;
            }
            let mut context = model.arcs[model.conditions.labels[tell].arc].context;
            while let Some(choice) = context {
                if self.chosen[choice.decision].is_some_and(|taken| taken != choice.alternative) {
                    self.add_decision_to_conflict(choice.decision);
                    break;
                }
                context = model.decisions[choice.decision].context;
            }
        }
    }

    /// Goes back from a failure that rests on `conflict` to a level with an alternative that may avoid it.
    /// `false` if there is none.
    pub(super) fn retreat(&mut self) -> Result<bool, Unplannable> {
        loop {
            let last = self.levels.last_key();
            let target = if self.setup.jumps { self.conflict.highest() } else { last };
            self.learn(target);
            let Some(target) = target else {
                self.record_left_levels(None);
                return Ok(false);
            };
            self.stats.backtracks += 1;
            self.stats.jumped_over += (self.levels.len() - usize::from(target)) as u64 - 1;
            self.log_retreat(target);
            self.record_left_levels(Some(target));
            while let Some(depth) = self.levels.last_key().filter(|&depth| depth > target) {
                self.undo_alternative(depth);
                self.drop_level();
            }
            self.undo_alternative(target);
            self.conflict.remove(target);
            let Self { levels, conflict, .. } = self;
            levels[target].conflict.union(conflict);
            if self.try_alternatives()? {
                return Ok(true);
            }
        }
    }

    /// Records that the present alternative of a level has failed, and that no alternative of the levels above it avoids
    /// that failure; without a level, that none of any level does.
    fn record_left_levels(&mut self, target: Option<LevelId>) {
        let Some(recorder) = self.recorder.as_mut().filter(|_| !self.setup.is_enumerating) else { return };
        for (depth, level) in self.levels.iter_enumerated().filter(|(depth, _)| Some(*depth) >= target) {
            let count = if Some(depth) == target { level.next } else { level.end };
            recorder.leave(level.first_child, level.next, count);
        }
    }

    /// Removes a level that is jumped over.
    pub(super) fn drop_level(&mut self) {
        let Some(level) = self.levels.pop() else { return };
        self.at = level.tree_node;
        if let Kind::Decision { decision } = level.kind {
            self.level_of[decision] = None;
            if self.structure.is_none() {
                self.frontier.insert(decision);
            }
        }
    }

    /// Keeps the failure at hand, if it rests on decisions alone.
    fn learn(&mut self, target: Option<LevelId>) {
        let is_about_decisions = target.is_none_or(|target| {
            self.levels.get(target).is_some_and(|level| matches!(level.kind, Kind::Decision { .. }))
        });
        if !is_about_decisions {
            return;
        }
        if self.setup.records_failures {
            self.record_failure();
        }
        if self.setup.jumps && target.is_some() && !self.setup.is_enumerating {
            let choices: Vec<Choice> = self.conflict_choices().collect();
            if self.nogoods.learn(&choices) {
                self.stats.nogoods += 1;
                if self.has_doubts && self.setup.gaps == Gaps::Trusted {
                    // It may hold in this search alone.
                    return;
                }
                self.log(|_| Event::Learn { choices: choices.into_iter().map(TreeChoice::from).collect() });
            }
        }
    }

    /// The decisions that the failure at hand rests on, with their alternatives, in the order they were taken.
    pub(crate) fn conflict_choices(&self) -> impl Iterator<Item = Choice> + '_ {
        self.conflict.iter().filter_map(|level| match self.levels.get(level)?.kind {
            Kind::Decision { decision } => Some(Choice { decision, alternative: self.chosen[decision]? }),
            _ => None,
        })
    }

    pub(super) fn record_failure(&mut self) {
        let mut choices: Vec<Choice> = self.conflict_choices().collect();
        let mut next = 0;
        while let Some(&choice) = choices.get(next) {
            let context = self.decision_context(choice.decision);
            choices.extend(context.filter(|outer| !choices.contains(outer)));
            next += 1;
        }
        choices.sort_unstable();
        if let Some(failure) = self.failures.flush(choices) {
            self.failures.found.push(failure);
        }
    }

    fn log_retreat(&mut self, target: LevelId) {
        let jumps = self.setup.jumps;
        let is_last = self.levels.last_key() == Some(target);
        self.log(|engine| {
            let to = engine.levels[target].tree_node;
            if jumps && !is_last {
                let states = engine.conflict.iter().filter_map(|level| {
                    let level = engine.levels.get(level)?;
                    Some(level.first_child + level.next.saturating_sub(1))
                });
                Event::Backjump { to, because: states.collect() }
            } else {
                Event::Backtrack { to }
            }
        });
        self.at = self.levels[target].tree_node;
    }
}
