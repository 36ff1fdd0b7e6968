//! Taking an alternative of a level: choosing, linking, ordering.

use stn::{Inconsistency, PointId, Tag};
use tpn::{CausalLink, Choice, Ordering};

use super::{Engine, Gaps, Origin};
use crate::failure::FailureKind;
use crate::ids::LevelId;
use crate::levels::Kind;
use crate::structure::Structure;
use crate::trace::{Event, TreeChoice};
use crate::unplannable::Unplannable;

impl Engine<'_> {
    /// Takes an alternative at a level. `false` if it fails at once; then `conflict` says why.
    pub(super) fn apply(&mut self, depth: LevelId, alternative: u32) -> Result<bool, Unplannable> {
        let tag = Origin::Level(depth).tag();
        match self.levels[depth].kind {
            Kind::Decision { decision } => self.choose(depth, Choice { decision, alternative }),
            Kind::Link { ask, ref tells, .. } => {
                let tell = tells[alternative as usize];
                self.stats.links_tried += 1;
                // Windows that hold with one link do not hold with another.
                self.leaf.has_windows = false;
                self.log(|_| Event::TryLink { link: CausalLink { ask, tell } });
                let (ask_start, ask_end) = self.model.interval(ask);
                let (tell_start, tell_end) = self.model.interval(tell);
                let edges = [(ask_start, tell_start, 0), (tell_end, ask_end, 0)];
                self.insert(&edges, tag, FailureKind::OpenCondition)
            }
            Kind::Threat { position, left, right } => {
                let (first, then) = if alternative == 0 { (left, right) } else { (right, left) };
                self.leaf.is_swapped[position as usize] = alternative == 1;
                self.stats.orderings_tried += 1;
                self.log(|_| Event::TryOrder { order: Ordering { first, then } });
                let (_, first_end) = self.model.interval(first);
                let (then_start, _) = self.model.interval(then);
                let gap = match self.setup.gaps {
                    Gaps::Ignored => self.model.gap_after[first],
                    Gaps::Exact | Gaps::Trusted => self.model.gap,
                };
                if self.insert(&[(then_start, first_end, -gap)], tag, FailureKind::Threat)? {
                    return Ok(true);
                }
                self.add_touching_to_conflict(depth);
                Ok(false)
            }
        }
    }

    /// An order that fails only because of gaps could still hold by touching, if other choices forced it to: then the
    /// failure rests on all choices, because none of them does. Every order in the contradiction asks for its gap.
    fn add_touching_to_conflict(&mut self, depth: LevelId) {
        if self.setup.gaps == Gaps::Ignored {
            return;
        }
        let weights = self
            .stn
            .cycle()
            .iter()
            .map(|edge| i128::from(edge.weight) + i128::from(self.excess_gap(edge.tag)));
        if weights.sum::<i128>() >= 0 {
            self.has_doubts = true;
            if self.setup.gaps == Gaps::Exact {
                self.conflict.insert_all_below(depth);
            }
        }
    }

    /// By how much the order added at a level asks for more than what counts as ordered once it is entailed.
    fn excess_gap(&self, tag: Tag) -> i64 {
        let Origin::Level(level) = Origin::of(tag) else { return 0 };
        let Some(level) = self.levels.get(level) else { return 0 };
        let Kind::Threat { left, right, .. } = level.kind else { return 0 };
        let first = if level.next == 1 { left } else { right };
        self.model.gap - self.model.gap_after[first]
    }

    fn choose(&mut self, depth: LevelId, choice: Choice) -> Result<bool, Unplannable> {
        self.leaf.is_ready = false;
        let Choice { decision, alternative } = choice;
        self.chosen[decision] = Some(alternative);
        self.log(|_| Event::Decide { decision, alternative });
        if self.setup.is_checking {
            return Ok(true);
        }
        if self.setup.jumps
            && let Some(others) = self.nogoods.find(&self.chosen, choice)
        {
            let others: Vec<Choice> = others.to_vec();
            self.conflict.insert(depth);
            for other in &others {
                self.add_decision_to_conflict(other.decision);
            }
            self.log(|_| {
                let made = others.iter().copied().chain([choice]);
                Event::Known { choices: made.map(TreeChoice::from).collect() }
            });
            return Ok(false);
        }
        if let (Some(structure), Some(tree)) = (self.structure, &mut self.tree) {
            let Err(block) = structure.decide(tree, &self.chosen, choice)? else {
                return self.look_ahead(depth, structure, choice);
            };
            let Self { tree: Some(tree), chosen, level_of, conflict, .. } = self else { return Ok(false) };
            structure.explain(tree, chosen, block, &mut |decision| {
                if let Some(level) = level_of[decision] {
                    conflict.insert(level);
                }
            });
            self.conflict.insert(depth);
            self.meet_failure(FailureKind::Temporal);
            return Ok(false);
        }
        let is_consistent = self.select_alternative(choice)?;
        if !is_consistent {
            self.conflict.insert(depth);
            self.meet_failure(FailureKind::Temporal);
        }
        Ok(is_consistent)
    }

    /// Whether what an alternative brings leaves something for phase 2.
    fn look_ahead(
        &mut self,
        depth: LevelId,
        structure: &Structure,
        choice: Choice,
    ) -> Result<bool, Unplannable> {
        let (Some(lookahead), Some(tree)) = (&mut self.lookahead, &self.tree) else { return Ok(true) };
        if lookahead.decide(self.model, structure, tree, &self.chosen, choice, depth)? {
            return Ok(true);
        }
        for position in 0..lookahead.conflict.len() {
            if let Some(lookahead) = &self.lookahead {
                self.add_decision_to_conflict(lookahead.conflict[position]);
            }
        }
        self.conflict.insert(depth);
        self.meet_failure(FailureKind::OpenCondition);
        Ok(false)
    }

    /// Adds what a link or an order asks for.
    fn insert(
        &mut self,
        edges: &[(PointId, PointId, i64)],
        tag: Tag,
        kind: FailureKind,
    ) -> Result<bool, Unplannable> {
        match self.stn.insert_all(edges, tag) {
            Ok(()) => {
                let moved = self.stn.num_changed() as u32;
                self.log(|_| Event::Propagate { moved });
                Ok(true)
            }
            Err(Inconsistency::Overflow(overflow)) => Err(overflow.into()),
            Err(Inconsistency::NegativeCycle) => {
                self.log(|engine| Event::Inconsistent { cycle: crate::record::cycle_of(engine) });
                self.add_cycle_to_conflict();
                self.meet_failure(kind);
                Ok(false)
            }
        }
    }
}
