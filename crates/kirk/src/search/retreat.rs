//! Going back from a failure: what it rests on, what is learned from it, and to which level it leads.

use stn::Overflow;
use tpn::LabelId;

use super::Engine;
use crate::failure::FailureKind;
use crate::levels::Kind;
use crate::model::NONE;
use crate::trace::{Event, TreeStatus};

impl Engine<'_> {
    /// Removes the topmost level, whose alternatives have all failed.
    pub(super) fn exhaust_level(&mut self) {
        let Some(level) = self.levels.pop() else { return };
        self.at = level.tree_node;
        self.set_status(self.at, TreeStatus::Failed);
        self.conflict.clone_from(&level.conflict);
        match level.kind {
            Kind::Decision { decision } => {
                self.level_of[decision as usize] = NONE;
                if self.structure.is_none() {
                    self.frontier.insert(decision);
                }
                self.blame_context(self.decision_context(decision));
            }
            Kind::Link { ask, tells, .. } => {
                self.log(|_| Event::Unclosable { ask: LabelId(ask) });
                if tells.is_empty() {
                    self.meet_dead_end(FailureKind::OpenCondition);
                }
                self.dead_ends.add_label(ask);
                self.blame_link(ask);
            }
            Kind::Threat { left, right, .. } => {
                self.log(|_| Event::Unresolvable { left: LabelId(left), right: LabelId(right) });
                self.dead_ends.add_label(left);
                self.dead_ends.add_label(right);
                for label in [left, right] {
                    self.blame_context(self.context(self.model.conditions.labels[label as usize].arc));
                }
            }
        }
    }

    /// A requirement fails because it is selected, and because other assertions are not.
    fn blame_link(&mut self, ask: u32) {
        let model = self.model;
        self.blame_context(self.context(model.conditions.labels[ask as usize].arc));
        for tell in model.conditions.supporters(ask) {
            if self.is_selected_label(tell) {
                continue;
            }
            if !model.has_contexts {
                self.conflict.insert_all_below(self.levels.len() as u32);
                return;
            }
            let mut context = model.arcs[model.conditions.labels[tell as usize].arc as usize].context;
            while context.decision != NONE {
                let chosen = self.chosen[context.decision as usize];
                if chosen != NONE && chosen != context.alternative {
                    self.blame_decision(context.decision);
                    break;
                }
                context = model.decisions[context.decision as usize].context;
            }
        }
    }

    /// Goes back from a failure that rests on `conflict` to a level with an alternative that may avoid it.
    /// `false` if there is none.
    pub(super) fn retreat(&mut self) -> Result<bool, Overflow> {
        loop {
            let last = (self.levels.len() as u32).checked_sub(1);
            let target = if self.setup.jumps { self.conflict.highest() } else { last };
            self.learn(target);
            let Some(target) = target else { return Ok(false) };
            self.stats.backtracks += 1;
            self.stats.jumped_over += u64::from(last.unwrap_or(0) - target);
            self.log_retreat(target);
            while self.levels.len() as u32 > target + 1 {
                let depth = self.levels.len() - 1;
                self.undo_alternative(depth);
                self.drop_level();
            }
            self.undo_alternative(target as usize);
            self.conflict.remove(target);
            let Self { levels, conflict, .. } = self;
            levels[target as usize].conflict.union(conflict);
            if self.try_alternatives()? {
                return Ok(true);
            }
        }
    }

    /// Removes a level that is jumped over.
    fn drop_level(&mut self) {
        let Some(level) = self.levels.pop() else { return };
        self.at = level.tree_node;
        if let Kind::Decision { decision } = level.kind {
            self.level_of[decision as usize] = NONE;
            if self.structure.is_none() {
                self.frontier.insert(decision);
            }
        }
    }

    /// Keeps the failure at hand, if it rests on decisions alone.
    fn learn(&mut self, target: Option<u32>) {
        let is_about_decisions = target.is_none_or(|target| {
            self.levels.get(target as usize).is_some_and(|level| matches!(level.kind, Kind::Decision { .. }))
        });
        if !is_about_decisions {
            return;
        }
        if self.setup.records_dead_ends {
            self.flush_dead_end();
        }
        if self.setup.jumps && target.is_some() && !self.setup.is_enumerating {
            let choices: Vec<(u32, u32)> = self.blamed_choices().collect();
            self.stats.nogoods += u64::from(self.nogoods.learn(&choices));
        }
    }

    /// The decisions that the failure at hand rests on, with their alternatives, in the order they were taken.
    pub(crate) fn blamed_choices(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.conflict.iter().filter_map(|level| match self.levels.get(level as usize)?.kind {
            Kind::Decision { decision } => Some((decision, self.chosen[decision as usize])),
            _ => None,
        })
    }

    pub(super) fn flush_dead_end(&mut self) {
        let mut choices: Vec<(u32, u32)> = self.blamed_choices().collect();
        let mut next = 0;
        while let Some(&(decision, _)) = choices.get(next) {
            let context = self.decision_context(decision);
            if context.decision != NONE && !choices.contains(&(context.decision, context.alternative)) {
                choices.push((context.decision, context.alternative));
            }
            next += 1;
        }
        choices.sort_unstable();
        if let Some(dead_end) = self.dead_ends.flush(choices) {
            self.dead_ends.found.push(dead_end);
        }
    }

    fn log_retreat(&mut self, target: u32) {
        let jumps = self.setup.jumps;
        let depth = self.levels.len() as u32;
        self.log(|engine| {
            let to = engine.levels[target as usize].tree_node;
            if jumps && target + 1 < depth {
                let states = engine.conflict.iter().filter_map(|level| {
                    let level = engine.levels.get(level as usize)?;
                    Some(level.first_child + level.next.saturating_sub(1))
                });
                Event::Backjump { to, because: states.collect() }
            } else {
                Event::Backtrack { to }
            }
        });
        self.at = self.levels[target as usize].tree_node;
    }
}
