//! The search: choices of alternatives, then of causal links, then of orders of threats, on one stack of choice points
//! (SPEC 5.4), with backtracking or conflict-directed backjumping (SPEC 5.6).
//!
//! Both searches try decisions in textual order with their alternatives from left to right, requirements in textual
//! order with assertions in textual order, and conflicting pairs in textual order with the textual order of the pair
//! first; jumping back skips only what cannot hold a plan, and an assertion that windows refuse is tried last, where it
//! fails as it would have failed before. So both find the same first plan, the canonical one, where this search comes to an
//! end; where the one that jumps back meets many failures, the solver takes over.

mod apply;
mod retreat;
mod setup;

use std::collections::BTreeSet;

use stn::{Overflow, PointId, Stn, Tag};
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

pub(crate) use setup::{Choices, Gaps, Halt, Setup};

/// Tags from here on name levels, smaller ones arcs.
pub(crate) const LEVEL_TAG: Tag = 1 << 31;

/// The lower bound of an arc that has none; only parts of conflicts lack theirs.
pub(crate) const UNBOUNDED_BELOW: i64 = i64::MIN;

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
    pub(crate) lookahead: Option<Lookahead>,
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
    /// Whether an order has failed only because of gaps: then the failure may be put down to less than it rests on
    /// ([`Gaps::Trusted`]), and need not last when bounds become tighter.
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
            let is_record_full = self.recorder.as_ref().is_some_and(|recorder| recorder.trace.is_truncated);
            if is_record_full || termination.should_stop(&self.stats) {
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
        if self.setup.is_checking {
            return Ok(true);
        }
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
            let assumed = self.setup.assumed.as_ref();
            let assumed =
                assumed.and_then(|assumed| assumed.carriers.get(ask as usize)).copied().unwrap_or(NONE);
            let mut tells: Vec<u32> = conditions
                .supporters(ask)
                .filter(|&tell| self.is_selected_label(tell) && (assumed == NONE || assumed == tell))
                .collect();
            if let Some(lookahead) = &self.lookahead {
                // What windows refuse fails: it is tried last, for what that failure rests on.
                tells.sort_by_key(|&tell| lookahead.refuses_link(self.model, ask, tell));
            }
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
        if self.structure.is_none() && !self.setup.is_checking {
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
                let assumed = self.setup.assumed.as_ref();
                let assumed = assumed.map_or(NONE, |assumed| assumed.alternatives[*decision as usize]);
                let count = self.model.decisions[*decision as usize].alternatives.len() as u32;
                if assumed == NONE { (0, count) } else { (assumed, assumed + 1) }
            }
            Kind::Link { tells, .. } => (0, tells.len() as u32),
            &Kind::Threat { left, right, .. } => match self.assumed_order(left, right) {
                Some(order) => (order, order + 1),
                None => (0, 2),
            },
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

    /// The innermost choice that reaches a decision.
    fn decision_context(&self, decision: u32) -> Context {
        if self.model.has_contexts {
            self.model.decisions[decision as usize].context
        } else {
            self.found_decision_contexts[decision as usize]
        }
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
