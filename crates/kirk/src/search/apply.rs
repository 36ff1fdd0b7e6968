//! Taking an alternative of a level: choosing, linking, ordering.

use stn::{Inconsistency, Overflow, PointId, Tag};
use tpn::{CausalLink, DecisionId, LabelId, Ordering};

use super::{Engine, Gaps, LEVEL_TAG};
use crate::failure::FailureKind;
use crate::levels::Kind;
use crate::model::NONE;
use crate::structure::Structure;
use crate::trace::Event;

impl Engine<'_> {
    /// Takes an alternative at a level. `false` if it fails at once; then `conflict` says why.
    pub(super) fn apply(&mut self, depth: usize, alternative: u32) -> Result<bool, Overflow> {
        let tag = LEVEL_TAG + depth as Tag;
        match self.levels[depth].kind {
            Kind::Decision { decision } => self.choose(depth, decision, alternative),
            Kind::Link { ask, ref tells, .. } => {
                let tell = tells[alternative as usize];
                self.stats.links_tried += 1;
                // Windows that hold with one link do not hold with another.
                self.leaf.has_windows = false;
                self.log(|_| Event::TryLink { link: CausalLink { ask: LabelId(ask), tell: LabelId(tell) } });
                let (ask_start, ask_end) = self.model.interval(ask);
                let (tell_start, tell_end) = self.model.interval(tell);
                let edges = [(ask_start, tell_start, 0), (tell_end, ask_end, 0)];
                self.insert(&edges, tag, FailureKind::OpenCondition)
            }
            Kind::Threat { position, left, right } => {
                let (first, then) = if alternative == 0 { (left, right) } else { (right, left) };
                self.leaf.is_swapped[position as usize] = alternative == 1;
                self.stats.orderings_tried += 1;
                self.log(|_| Event::TryOrder {
                    order: Ordering { first: LabelId(first), then: LabelId(then) },
                });
                let (_, first_end) = self.model.interval(first);
                let (then_start, _) = self.model.interval(then);
                let gap = match self.setup.gaps {
                    Gaps::Ignored => self.model.gap_after[first as usize],
                    Gaps::Exact | Gaps::Trusted => self.model.gap,
                };
                if self.insert(&[(then_start, first_end, -gap)], tag, FailureKind::Threat)? {
                    return Ok(true);
                }
                self.blame_touching(depth);
                Ok(false)
            }
        }
    }

    /// An order that fails only because of gaps could still hold by touching, if other choices forced it to: then the
    /// failure rests on all choices, because none of them does. Every order in the contradiction asks for its gap.
    fn blame_touching(&mut self, depth: usize) {
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
                self.conflict.insert_all_below(depth as u32);
            }
        }
    }

    /// By how much the order added at a level asks for more than what counts as ordered once it is entailed.
    fn excess_gap(&self, tag: Tag) -> i64 {
        let Some(level) = tag.checked_sub(LEVEL_TAG).and_then(|depth| self.levels.get(depth as usize)) else {
            return 0;
        };
        let Kind::Threat { left, right, .. } = level.kind else { return 0 };
        let first = if level.next == 1 { left } else { right };
        self.model.gap - self.model.gap_after[first as usize]
    }

    fn choose(&mut self, depth: usize, decision: u32, alternative: u32) -> Result<bool, Overflow> {
        self.leaf.is_ready = false;
        self.chosen[decision as usize] = alternative;
        self.log(|_| Event::Decide { decision: DecisionId(decision), alternative });
        if self.setup.is_checking {
            return Ok(true);
        }
        if self.setup.jumps
            && let Some(others) = self.nogoods.find(&self.chosen, decision, alternative)
        {
            let others: Vec<u32> = others.iter().map(|&(other, _)| other).collect();
            self.conflict.insert(depth as u32);
            for other in others {
                self.blame_decision(other);
            }
            self.log(|_| Event::Known);
            return Ok(false);
        }
        if let (Some(structure), Some(tree)) = (self.structure, &mut self.tree) {
            let Err(block) = structure.decide(tree, &self.chosen, decision, alternative)? else {
                return self.look_ahead(depth, structure, decision, alternative);
            };
            let Self { tree: Some(tree), chosen, level_of, conflict, .. } = self else { return Ok(false) };
            structure.explain(tree, chosen, block, &mut |blamed| {
                let level = level_of[blamed as usize];
                if level != NONE {
                    conflict.insert(level);
                }
            });
            self.conflict.insert(depth as u32);
            self.meet_dead_end(FailureKind::Temporal);
            return Ok(false);
        }
        let is_consistent = self.select_alternative(decision, alternative)?;
        if !is_consistent {
            self.conflict.insert(depth as u32);
            self.meet_dead_end(FailureKind::Temporal);
        }
        Ok(is_consistent)
    }

    /// Whether what an alternative brings leaves something for phase 2.
    fn look_ahead(
        &mut self,
        depth: usize,
        structure: &Structure,
        decision: u32,
        alternative: u32,
    ) -> Result<bool, Overflow> {
        let (Some(lookahead), Some(tree)) = (&mut self.lookahead, &self.tree) else { return Ok(true) };
        if lookahead.decide(self.model, structure, tree, &self.chosen, (decision, alternative), depth)? {
            return Ok(true);
        }
        for position in 0..lookahead.blamed.len() {
            let blamed = self.lookahead.as_ref().map_or(NONE, |lookahead| lookahead.blamed[position]);
            self.blame_decision(blamed);
        }
        self.conflict.insert(depth as u32);
        self.meet_dead_end(FailureKind::OpenCondition);
        Ok(false)
    }

    /// Adds what a link or an order asks for.
    fn insert(
        &mut self,
        edges: &[(PointId, PointId, i64)],
        tag: Tag,
        kind: FailureKind,
    ) -> Result<bool, Overflow> {
        match self.stn.insert_all(edges, tag) {
            Ok(()) => {
                let moved = self.stn.num_changed() as u32;
                self.log(|_| Event::Propagate { moved });
                Ok(true)
            }
            Err(Inconsistency::Overflow) => Err(Overflow),
            Err(Inconsistency::NegativeCycle) => {
                self.log(|engine| Event::Inconsistent { cycle: crate::record::cycle_of(engine) });
                self.blame_cycle();
                self.meet_dead_end(kind);
                Ok(false)
            }
        }
    }
}
