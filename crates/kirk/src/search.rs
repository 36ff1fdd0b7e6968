//! The search: choices of alternatives, then of causal links, then of orders of threats, on one stack of choice points
//! (SPEC 5.4), with backtracking or conflict-directed backjumping (SPEC 5.6).
//!
//! Both searches try decisions in textual order with their alternatives from left to right, requirements in textual
//! order with assertions in textual order, and conflicting pairs in textual order with the textual order of the pair
//! first; jumping back skips only what cannot hold a plan. So both find the same first plan, the canonical one.

use std::collections::BTreeSet;

use stn::{Inconsistency, Overflow, PointId, Stn, Tag};
use tpn::{CausalLink, DecisionId, LabelId, Ordering};

use crate::failure::FailureKind;
use crate::leaf::Leaf;
use crate::levels::{Kind, Level, LevelSet, Nogoods};
use crate::lookahead::Lookahead;
use crate::model::{Context, INFINITE, Model, ModelArc, NONE};
use crate::options::{Stats, Termination};
use crate::record::DeadEnds;
use crate::structure::{Structure, TreeState};
use crate::trace::{Event, Recorder, TreeChoice, TreeNodeId, TreeStatus};

/// Tags from here on name levels, smaller ones arcs.
pub(crate) const LEVEL_TAG: Tag = 1 << 31;

/// The lower bound of an arc that has none; only parts of conflicts lack theirs.
pub(crate) const UNBOUNDED_BELOW: i64 = i64::MIN;

/// What a search is like.
#[derive(Clone, Debug, Default)]
pub(crate) struct Setup {
    /// Jump back over choices that have nothing to do with the failure, and learn.
    pub(crate) jumps: bool,
    pub(crate) gaps: Gaps,
    /// Use the program's structure for phase 1 if there is one; otherwise arcs are propagated as they are selected.
    pub(crate) by_structure: bool,
    /// Keep what every dead end rests on.
    pub(crate) records_dead_ends: bool,
    /// Whether the search goes on after a plan, so that going back does not mean failure.
    pub(crate) is_enumerating: bool,
    pub(crate) trace_events: Option<usize>,
    /// Labels that count; all if `None`. Assertions that do not count still support.
    pub(crate) active_labels: Option<Vec<bool>>,
    /// Decisions that have been made before: the alternative, or [`NONE`].
    pub(crate) assumed: Option<Vec<u32>>,
}

/// What a search makes of orders that fail only because of the gap they ask for, but would hold by touching if other
/// choices forced the intervals to (SPEC 5.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Gaps {
    /// Such a failure rests on every choice made, since none of them forces it.
    #[default]
    Exact,
    /// No choice is expected to: the failure rests on what contradicts the gap. Finds only plans, but may miss some.
    Trusted,
    /// Orders ask for no more than touching: where this finds nothing, there is no plan.
    Ignored,
}

/// How a search came to a halt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Halt {
    Solution,
    Exhausted,
    Stopped,
}

enum Next {
    Choice(Kind),
    Solution,
    DeadEnd,
}

pub(crate) struct Engine<'m> {
    pub(crate) model: &'m Model,
    pub(crate) setup: Setup,
    pub(crate) stn: Stn,
    /// The alternative of each decision, or [`NONE`].
    pub(crate) chosen: Vec<u32>,
    level_of: Vec<u32>,
    pub(crate) levels: Vec<Level>,
    structure: Option<&'m Structure>,
    tree: Option<TreeState>,
    lookahead: Option<Lookahead>,
    pub(crate) is_selected_node: Vec<bool>,
    pub(crate) is_selected_arc: Vec<bool>,
    pub(crate) selected_nodes: Vec<u32>,
    pub(crate) selected_arcs: Vec<u32>,
    frontier: BTreeSet<u32>,
    /// Of arcs and decisions, in networks whose structure is not known.
    found_contexts: Vec<Context>,
    found_decision_contexts: Vec<Context>,
    pub(crate) leaf: Leaf,
    /// The levels that the failure at hand rests on.
    pub(crate) conflict: LevelSet,
    nogoods: Nogoods,
    pub(crate) dead_ends: DeadEnds,
    pub(crate) recorder: Option<Recorder>,
    at: TreeNodeId,
    pub(crate) stats: Stats,
    has_begun: bool,
    /// Whether a failure has been put down to less than it may rest on; see [`Gaps::Trusted`].
    pub(crate) has_doubts: bool,
}

impl<'m> Engine<'m> {
    pub(crate) fn new(model: &'m Model, setup: Setup) -> Self {
        let structure =
            model.structure.as_ref().filter(|_| setup.by_structure && setup.trace_events.is_none());
        let mut stn = Stn::new(model.num_nodes);
        stn.reserve(model.arcs.len() * 2 + 64);
        stn.set_origin(PointId(model.start));
        let stats = Stats {
            nodes: model.num_nodes as u64,
            arcs: model.arcs.len() as u64,
            decisions: model.decisions.len() as u64,
            ..Stats::default()
        };
        let (num_arcs, num_decisions) =
            if model.has_contexts { (0, 0) } else { (model.arcs.len(), model.decisions.len()) };
        Self {
            model,
            stn,
            chosen: vec![NONE; model.decisions.len()],
            level_of: vec![NONE; model.decisions.len()],
            levels: Vec::new(),
            structure,
            tree: structure.map(Structure::start),
            lookahead: structure
                .filter(|_| !model.conditions.labels.is_empty())
                .map(|_| Lookahead::new(model)),
            is_selected_node: vec![false; model.num_nodes],
            is_selected_arc: vec![false; model.arcs.len()],
            selected_nodes: Vec::with_capacity(model.num_nodes),
            selected_arcs: Vec::with_capacity(model.arcs.len()),
            frontier: BTreeSet::new(),
            found_contexts: vec![Context::ALWAYS; num_arcs],
            found_decision_contexts: vec![Context::ALWAYS; num_decisions],
            leaf: Leaf::default(),
            conflict: LevelSet::default(),
            nogoods: Nogoods::new(model.decisions.len()),
            dead_ends: DeadEnds::default(),
            recorder: setup.trace_events.map(Recorder::new),
            at: 0,
            stats,
            has_begun: false,
            has_doubts: false,
            setup,
        }
    }

    /// Searches for the next plan.
    pub(crate) fn run(&mut self, termination: &mut dyn Termination) -> Result<Halt, Overflow> {
        if self.has_begun {
            // The plan found last rests on every choice made.
            self.conflict.clear();
            self.conflict.insert_all_below(self.levels.len() as u32);
            if !self.retreat()? {
                return Ok(self.exhausted());
            }
        } else {
            self.has_begun = true;
            if !self.begin()? {
                self.meet_dead_end(FailureKind::Temporal);
                self.flush_dead_end();
                return Ok(self.exhausted());
            }
        }
        loop {
            if termination.should_stop(&self.stats) {
                return Ok(Halt::Stopped);
            }
            let goes_on = match self.next()? {
                Next::Solution => {
                    self.set_status(self.at, TreeStatus::Solution);
                    return Ok(Halt::Solution);
                }
                Next::Choice(kind) => {
                    self.push_level(kind);
                    self.try_alternatives()? || self.retreat()?
                }
                Next::DeadEnd => {
                    self.set_status(self.at, TreeStatus::Failed);
                    self.retreat()?
                }
            };
            if !goes_on {
                return Ok(self.exhausted());
            }
        }
    }

    /// Whether phase 1 goes by the program's structure.
    pub(crate) fn has_structure(&self) -> bool {
        self.structure.is_some()
    }

    /// Looks ahead more thoroughly from now on.
    pub(crate) fn look_harder(&mut self) {
        if let Some(lookahead) = &mut self.lookahead {
            lookahead.is_thorough = true;
        }
    }

    /// Records an event, if the search is recorded.
    pub(crate) fn log(&mut self, event: impl FnOnce(&Self) -> Event) {
        if self.recorder.is_some() {
            let event = event(self);
            let at = self.at;
            if let Some(recorder) = &mut self.recorder {
                recorder.record(at, event);
            }
        }
    }

    /// The innermost choice that selects an arc.
    pub(crate) fn context(&self, arc: u32) -> Context {
        if self.model.has_contexts {
            self.model.arcs[arc as usize].context
        } else {
            self.found_contexts[arc as usize]
        }
    }

    pub(crate) fn is_active(&self, label: u32) -> bool {
        self.setup.active_labels.as_ref().is_none_or(|active| active[label as usize])
    }

    pub(crate) fn is_selected_label(&self, label: u32) -> bool {
        self.is_selected_arc[self.model.conditions.labels[label as usize].arc as usize]
    }

    /// Adds to the failure's reasons what the network's contradiction rests on.
    pub(crate) fn blame_cycle(&mut self) {
        for position in 0..self.stn.cycle().len() {
            let tag = self.stn.cycle()[position].tag;
            if tag >= LEVEL_TAG {
                self.conflict.insert(tag - LEVEL_TAG);
            } else {
                self.blame_context(self.context(tag));
            }
        }
        if self.setup.records_dead_ends {
            let members = crate::record::cycle_of(self);
            self.dead_ends.add_cycle(members);
        }
    }

    pub(crate) fn blame_context(&mut self, context: Context) {
        if context.decision != NONE {
            self.blame_decision(context.decision);
        }
    }

    pub(crate) fn push_arc(&mut self, arc: u32) {
        let ModelArc { lower, upper, from, to, .. } = self.model.arcs[arc as usize];
        if upper != INFINITE {
            self.stn.push(PointId(from), PointId(to), upper, arc);
        }
        if lower != UNBOUNDED_BELOW {
            self.stn.push(PointId(to), PointId(from), -lower, arc);
        }
    }

    pub(crate) fn meet_dead_end(&mut self, kind: FailureKind) {
        self.stats.conflicts += 1;
        if self.setup.records_dead_ends {
            self.dead_ends.meet(kind);
        }
    }

    fn exhausted(&mut self) -> Halt {
        self.log(|_| Event::Exhausted);
        Halt::Exhausted
    }

    fn blame_decision(&mut self, decision: u32) {
        let level = self.level_of[decision as usize];
        if level != NONE {
            self.conflict.insert(level);
        }
    }

    fn set_status(&mut self, node: TreeNodeId, status: TreeStatus) {
        if let Some(recorder) = &mut self.recorder {
            recorder.set_status(node, status);
        }
    }

    /// What every plan has. `false` if that alone is inconsistent.
    fn begin(&mut self) -> Result<bool, Overflow> {
        self.conflict.clear();
        if let Some(structure) = self.structure {
            if structure.is_empty() {
                return Ok(false);
            }
            return match &mut self.lookahead {
                Some(lookahead) => lookahead.begin(self.model, structure, &self.chosen),
                None => Ok(true),
            };
        }
        self.select_mandatory()
    }

    /// What to do next in the present state.
    fn next(&mut self) -> Result<Next, Overflow> {
        let (first_ask, first_pair) = match self.levels.last().map(|level| &level.kind) {
            None => {
                if let Some(decision) = self.next_decision(0) {
                    return Ok(Next::Choice(Kind::Decision { decision }));
                }
                (0, 0)
            }
            Some(&Kind::Decision { decision }) => {
                if let Some(decision) = self.next_decision(decision + 1) {
                    return Ok(Next::Choice(Kind::Decision { decision }));
                }
                (0, 0)
            }
            Some(&Kind::Link { position, .. }) => (position + 1, 0),
            Some(&Kind::Threat { position, .. }) => (NONE, position + 1),
        };
        if !self.leaf.is_ready && !self.make_leaf()? {
            return Ok(Next::DeadEnd);
        }
        if let Some(&ask) = self.leaf.asks.get(first_ask as usize) {
            let conditions = &self.model.conditions;
            let tells = conditions.supporters(ask).filter(|&tell| self.is_selected_label(tell)).collect();
            return Ok(Next::Choice(Kind::Link { position: first_ask, ask, tells }));
        }
        match self.next_threat(first_pair)? {
            Some((position, left, right)) => {
                self.log(|_| Event::Threat { left: LabelId(left), right: LabelId(right) });
                Ok(Next::Choice(Kind::Threat { position, left, right }))
            }
            None => Ok(Next::Solution),
        }
    }

    /// The first decision in textual order that is reached and open. Of a nested program it is `from` or later.
    fn next_decision(&self, from: u32) -> Option<u32> {
        if self.structure.is_none() {
            return self.frontier.first().copied();
        }
        (from..self.chosen.len() as u32).find(|&decision| {
            let context = self.model.decisions[decision as usize].context;
            context.decision == NONE || self.chosen[context.decision as usize] == context.alternative
        })
    }

    fn push_level(&mut self, kind: Kind) {
        let (next, end) = match &kind {
            Kind::Decision { decision } => {
                let assumed = self.setup.assumed.as_ref().map_or(NONE, |assumed| assumed[*decision as usize]);
                let count = self.model.decisions[*decision as usize].alternatives.len() as u32;
                if assumed == NONE { (0, count) } else { (assumed, assumed + 1) }
            }
            Kind::Link { tells, .. } => (0, tells.len() as u32),
            Kind::Threat { .. } => (0, 2),
        };
        let depth = self.levels.len() as u32;
        if let Kind::Decision { decision } = kind {
            self.level_of[decision as usize] = depth;
            self.frontier.remove(&decision);
        }
        let choices = (0..end).map(|alternative| tree_choice(&kind, alternative));
        let at = self.at;
        let first_child = self.recorder.as_mut().map_or(0, |recorder| recorder.branch(at, choices));
        self.levels.push(Level {
            kind,
            next,
            end,
            conflict: LevelSet::default(),
            checkpoint: self.stn.checkpoint(),
            tree_mark: self.tree.as_ref().map_or(0, Structure::mark),
            num_selected_nodes: self.selected_nodes.len() as u32,
            num_selected_arcs: self.selected_arcs.len() as u32,
            tree_node: self.at,
            first_child,
        });
    }

    /// Tries the alternatives that are left at the topmost level. `false` if none stands: then the level is gone and
    /// `conflict` says what that rests on.
    fn try_alternatives(&mut self) -> Result<bool, Overflow> {
        let depth = self.levels.len() - 1;
        loop {
            let level = &mut self.levels[depth];
            if level.next == level.end {
                break;
            }
            let alternative = level.next;
            level.next += 1;
            self.at = level.first_child + alternative;
            self.stats.expanded += 1;
            self.conflict.clear();
            self.set_status(self.at, TreeStatus::Decision);
            if self.apply(depth, alternative)? {
                return Ok(true);
            }
            self.set_status(self.at, TreeStatus::Failed);
            if self.setup.records_dead_ends && matches!(self.levels[depth].kind, Kind::Decision { .. }) {
                self.flush_dead_end();
            }
            self.undo_alternative(depth);
            self.conflict.remove(depth as u32);
            let Self { levels, conflict, .. } = self;
            levels[depth].conflict.union(conflict);
        }
        self.exhaust_level();
        Ok(false)
    }

    /// Takes an alternative at a level. `false` if it fails at once; then `conflict` says why.
    fn apply(&mut self, depth: usize, alternative: u32) -> Result<bool, Overflow> {
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
                Ok(self.insert(ask_start, tell_start, 0, tag, FailureKind::OpenCondition)?
                    && self.insert(tell_end, ask_end, 0, tag, FailureKind::OpenCondition)?)
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
                if self.insert(then_start, first_end, -gap, tag, FailureKind::Threat)? {
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
            if self.setup.gaps == Gaps::Trusted {
                self.has_doubts = true;
            } else {
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

    /// Adds `to − from ≤ weight` for a link or an order.
    fn insert(
        &mut self,
        from: PointId,
        to: PointId,
        weight: i64,
        tag: Tag,
        kind: FailureKind,
    ) -> Result<bool, Overflow> {
        match self.stn.insert(from, to, weight, tag) {
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

    /// Takes back what the present alternative of a level did.
    fn undo_alternative(&mut self, depth: usize) {
        let level = &self.levels[depth];
        let checkpoint = level.checkpoint;
        if let Kind::Decision { decision } = level.kind {
            self.leaf.is_ready = false;
            self.chosen[decision as usize] = NONE;
            if let Some(tree) = &mut self.tree {
                Structure::undo(tree, level.tree_mark);
                if let Some(lookahead) = &mut self.lookahead {
                    lookahead.undo(depth);
                }
                return;
            }
            let (nodes, arcs) = (level.num_selected_nodes, level.num_selected_arcs);
            self.deselect(nodes as usize, arcs as usize);
        }
        self.stn.rollback(checkpoint);
    }

    /// Removes the topmost level, whose alternatives have all failed.
    fn exhaust_level(&mut self) {
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
    fn retreat(&mut self) -> Result<bool, Overflow> {
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

    fn flush_dead_end(&mut self) {
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

    /// The innermost choice that reaches a decision.
    fn decision_context(&self, decision: u32) -> Context {
        if self.model.has_contexts {
            self.model.decisions[decision as usize].context
        } else {
            self.found_decision_contexts[decision as usize]
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

    /// Inserts a decision that has been reached, or an arc's context, in networks of unknown structure.
    pub(crate) fn reach_decision(&mut self, decision: u32, context: Context) {
        if self.structure.is_none() {
            self.frontier.insert(decision);
        }
        if !self.model.has_contexts {
            self.found_decision_contexts[decision as usize] = context;
        }
    }

    pub(crate) fn forget_decision(&mut self, decision: u32) {
        self.frontier.remove(&decision);
    }

    pub(crate) fn set_found_context(&mut self, arc: u32, context: Context) {
        if !self.model.has_contexts {
            self.found_contexts[arc as usize] = context;
        }
    }
}

fn tree_choice(kind: &Kind, alternative: u32) -> TreeChoice {
    match kind {
        &Kind::Decision { decision } => TreeChoice::Decision { decision: DecisionId(decision), alternative },
        Kind::Link { ask, tells, .. } => {
            TreeChoice::Link(CausalLink { ask: LabelId(*ask), tell: LabelId(tells[alternative as usize]) })
        }
        &Kind::Threat { left, right, .. } => {
            let (first, then) = if alternative == 0 { (left, right) } else { (right, left) };
            TreeChoice::Order(Ordering { first: LabelId(first), then: LabelId(then) })
        }
    }
}
