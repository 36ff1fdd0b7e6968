//! The search: choices of alternatives, then of causal links, then of orders of threats, on one stack of choice points
//! (SPEC 5.4), with backtracking or conflict-directed backjumping (SPEC 5.6).
//!
//! Both searches try decisions in textual order with their alternatives from left to right, requirements in textual
//! order with assertions in textual order, and conflicting pairs in textual order with the textual order of the pair
//! first; jumping back skips only what cannot hold a plan, and an assertion that windows refuse is tried last, where it
//! fails as it would have failed before. So both find the same first plan, the canonical one, where this search comes to an
//! end; where the one that jumps back meets many failures, an active schedule is tried, and then the solver takes over.

mod active_schedule;
mod apply;
mod origin;
mod retreat;
mod setup;

use std::collections::BTreeSet;

use stn::Stn;
use tpn::{ArcId, CausalLink, DecisionId, LabelId, NodeId, Ordering};
use typed_index_collections::TiVec;

use crate::failure::FailureKind;
use crate::ids::LevelId;
use crate::leaf::Leaf;
use crate::levels::{Kind, Level, LevelSet, Nogoods};
use crate::lookahead::Lookahead;
use crate::model::{Context, INFINITE, Model, ModelArc, point};
use crate::options::{Stats, Termination};
use crate::record::FailureRecorder;
use crate::structure::{Structure, TreeState};
use crate::trace::{Event, Recorder, TreeChoice, TreeNodeId, TreeStatus};
use crate::unplannable::Unplannable;

use active_schedule::Ordered;
pub(crate) use origin::Origin;
pub(crate) use setup::{Choices, Gaps, Halt, Setup};

/// The lower bound of an arc that has none; only parts of conflicts lack theirs.
pub(crate) const UNBOUNDED_BELOW: i64 = i64::MIN;

enum Next {
    Choice(Kind),
    Solution,
    Failure,
    Stop,
}

pub(crate) struct Engine<'m> {
    pub(crate) model: &'m Model,
    pub(crate) setup: Setup,
    pub(crate) stn: Stn,
    /// The alternative of each decision, where one is taken.
    pub(crate) chosen: TiVec<DecisionId, Option<u32>>,
    level_of: TiVec<DecisionId, Option<LevelId>>,
    pub(crate) levels: TiVec<LevelId, Level>,
    structure: Option<&'m Structure>,
    tree: Option<TreeState>,
    pub(crate) lookahead: Option<Lookahead>,
    pub(crate) is_selected_node: TiVec<NodeId, bool>,
    pub(crate) is_selected_arc: TiVec<ArcId, bool>,
    pub(crate) selected_nodes: Vec<NodeId>,
    pub(crate) selected_arcs: Vec<ArcId>,
    frontier: BTreeSet<DecisionId>,
    /// Of arcs and decisions, in networks whose structure is not known.
    found_contexts: TiVec<ArcId, Context>,
    found_decision_contexts: TiVec<DecisionId, Context>,
    pub(crate) leaf: Leaf,
    /// The levels that the failure at hand rests on.
    pub(crate) conflict: LevelSet,
    nogoods: Nogoods,
    pub(crate) failures: FailureRecorder,
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

        let stats = Stats {
            nodes: model.num_nodes as u64,
            arcs: model.arcs.len() as u64,
            decisions: model.decisions.len() as u64,
            ..Stats::default()
        };
        let (num_arcs, num_decisions) =
            if model.has_contexts { (0, 0) } else { (model.arcs.len(), model.decisions.len()) };
        let mut engine = Self {
            model,
            stn: Stn::new(0),
            chosen: vec![None; model.decisions.len()].into(),
            level_of: vec![None; model.decisions.len()].into(),
            levels: TiVec::new(),
            structure,
            tree: structure.map(Structure::start),
            lookahead: structure
                .filter(|_| !model.conditions.labels.is_empty())
                .map(|_| Lookahead::new(model)),
            is_selected_node: vec![false; model.num_nodes].into(),
            is_selected_arc: vec![false; model.arcs.len()].into(),
            selected_nodes: Vec::with_capacity(model.num_nodes),
            selected_arcs: Vec::with_capacity(model.arcs.len()),
            frontier: BTreeSet::new(),
            found_contexts: vec![None; num_arcs].into(),
            found_decision_contexts: vec![None; num_decisions].into(),
            leaf: Leaf::default(),
            conflict: LevelSet::default(),
            nogoods: Nogoods::new(model.decisions.len()),
            failures: FailureRecorder::default(),
            recorder: setup.trace_events.map(Recorder::new),
            at: 0,
            stats,
            has_begun: false,
            has_doubts: false,
            setup,
        };
        if structure.is_none() {
            engine.prepare_stn();
        }
        engine
    }

    /// Gives the network of times its points, which a search by structure does not need before all choices are made.
    pub(crate) fn prepare_stn(&mut self) {
        if self.stn.num_points() == 0 {
            self.stn.resize(self.model.num_nodes);
            self.stn.reserve(self.model.arcs.len() * 2 + 64);
            self.stn.set_origin(point(self.model.start));
        }
    }

    /// Searches for the next plan.
    pub(crate) fn run(&mut self, termination: &mut dyn Termination) -> Result<Halt, Unplannable> {
        if self.has_begun {
            // The plan found last rests on every choice made.
            self.conflict.clear();
            self.conflict.insert_all_below(self.levels.next_key());
            if !self.retreat()? {
                return Ok(self.exhausted());
            }
        } else {
            self.has_begun = true;
            if !self.begin()? {
                self.meet_failure(FailureKind::Temporal);
                self.record_failure();
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
                Next::Stop => return Ok(Halt::Stopped),
                Next::Choice(kind) => {
                    self.push_level(kind);
                    self.try_alternatives()? || self.retreat()?
                }
                Next::Failure => {
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
    pub(crate) fn context(&self, arc: ArcId) -> Context {
        if self.model.has_contexts { self.model.arcs[arc].context } else { self.found_contexts[arc] }
    }

    pub(crate) fn is_active(&self, label: LabelId) -> bool {
        self.setup.active_labels.as_ref().is_none_or(|active| active[label])
    }

    pub(crate) fn is_selected_label(&self, label: LabelId) -> bool {
        self.is_selected_arc[self.model.conditions.labels[label].arc]
    }

    /// Adds to the failure's reasons what the network's contradiction rests on.
    pub(crate) fn add_cycle_to_conflict(&mut self) {
        for position in 0..self.stn.cycle().len() {
            match Origin::of(self.stn.cycle()[position].tag) {
                Origin::Level(level) => self.conflict.insert(level),
                Origin::Arc(arc) => self.add_context_to_conflict(self.context(arc)),
            }
        }
        if self.setup.records_failures {
            let members = crate::record::cycle_of(self);
            self.failures.add_cycle(members);
        }
    }

    pub(crate) fn add_context_to_conflict(&mut self, context: Context) {
        if let Some(choice) = context {
            self.add_decision_to_conflict(choice.decision);
        }
    }

    pub(crate) fn push_arc(&mut self, arc: ArcId) {
        let ModelArc { lower, upper, from, to, .. } = self.model.arcs[arc];
        let (from, to, tag) = (point(from), point(to), Origin::Arc(arc).tag());
        if upper != INFINITE {
            self.stn.push(from, to, upper, tag);
        }
        if lower != UNBOUNDED_BELOW {
            self.stn.push(to, from, -lower, tag);
        }
    }

    pub(crate) fn meet_failure(&mut self, kind: FailureKind) {
        self.stats.conflicts += 1;
        if self.setup.records_failures {
            self.failures.meet(kind);
        }
    }

    fn exhausted(&mut self) -> Halt {
        self.log(|_| Event::Exhausted);
        if !self.setup.is_enumerating {
            self.set_status(0, TreeStatus::Failed);
        }
        Halt::Exhausted
    }

    fn add_decision_to_conflict(&mut self, decision: DecisionId) {
        if let Some(level) = self.level_of[decision] {
            self.conflict.insert(level);
        }
    }

    fn set_status(&mut self, node: TreeNodeId, status: TreeStatus) {
        if let Some(recorder) = &mut self.recorder {
            recorder.set_status(node, status);
        }
    }

    /// What every plan has. `false` if that alone is inconsistent.
    fn begin(&mut self) -> Result<bool, Unplannable> {
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
    fn next(&mut self) -> Result<Next, Unplannable> {
        let (first_ask, first_pair) = match self.levels.last().map(|level| &level.kind) {
            None => {
                if let Some(decision) = self.next_decision(None) {
                    return Ok(Next::Choice(Kind::Decision { decision }));
                }
                (Some(0), 0)
            }
            Some(&Kind::Decision { decision }) => {
                if let Some(decision) = self.next_decision(Some(decision)) {
                    return Ok(Next::Choice(Kind::Decision { decision }));
                }
                (Some(0), 0)
            }
            Some(&Kind::Link { position, .. }) => (Some(position + 1), 0),
            Some(&Kind::Threat { position, .. }) => (None, position + 1),
        };
        if !self.leaf.is_ready && !self.make_leaf()? {
            return Ok(Next::Failure);
        }
        if let Some(position) = first_ask
            && let Some(&ask) = self.leaf.asks.get(position as usize)
        {
            let conditions = &self.model.conditions;
            let assumed = self.setup.assumed.as_ref();
            let assumed = assumed.and_then(|assumed| assumed.carriers.get(ask).copied().flatten());
            let mut tells: Vec<LabelId> = conditions
                .supporters(ask)
                .filter(|&tell| self.is_selected_label(tell) && assumed.is_none_or(|assumed| assumed == tell))
                .collect();
            if let Some(lookahead) = &self.lookahead {
                // What windows refuse fails: it is tried last, for what that failure rests on.
                tells.sort_by_key(|&tell| lookahead.refuses_link(self.model, ask, tell));
            }
            return Ok(Next::Choice(Kind::Link { position, ask, tells }));
        }
        if first_pair == 0 {
            self.find_pairs();
            match self.order_at_once()? {
                Ordered::All => return Ok(Next::Solution),
                Ordered::None => return Ok(Next::Stop),
                Ordered::NotTried => {}
            }
        }
        match self.next_threat(first_pair)? {
            Some((position, left, right)) => {
                self.log(|_| Event::Threat { left, right });
                Ok(Next::Choice(Kind::Threat { position, left, right }))
            }
            None => Ok(Next::Solution),
        }
    }

    /// The first decision in textual order that is reached and open. Of a nested program it is later than `last`.
    fn next_decision(&self, last: Option<DecisionId>) -> Option<DecisionId> {
        if self.structure.is_none() && !self.setup.is_checking {
            return self.frontier.first().copied();
        }
        let first = last.map_or(0, |last| last.index() + 1);
        (first..self.chosen.len()).map(DecisionId::from_index).find(|&decision| {
            let context = self.model.decisions[decision].context;
            context.is_none_or(|outer| self.chosen[outer.decision] == Some(outer.alternative))
        })
    }

    fn push_level(&mut self, kind: Kind) {
        let (next, end) = match &kind {
            Kind::Decision { decision } => {
                let assumed = self.setup.assumed.as_ref();
                let assumed = assumed.and_then(|assumed| assumed.alternatives[*decision]);
                let count = self.model.decisions[*decision].alternatives.len() as u32;
                assumed.map_or((0, count), |assumed| (assumed, assumed + 1))
            }
            Kind::Link { tells, .. } => (0, tells.len() as u32),
            &Kind::Threat { left, right, .. } => match self.assumed_order(left, right) {
                Some(order) => (order, order + 1),
                None => (0, 2),
            },
        };
        if let Kind::Decision { decision } = kind {
            self.level_of[decision] = Some(self.levels.next_key());
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
    fn try_alternatives(&mut self) -> Result<bool, Unplannable> {
        let Some(depth) = self.levels.last_key() else { return Ok(false) };
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
            if self.setup.records_failures && matches!(self.levels[depth].kind, Kind::Decision { .. }) {
                self.record_failure();
            }
            self.undo_alternative(depth);
            self.conflict.remove(depth);
            let Self { levels, conflict, .. } = self;
            levels[depth].conflict.union(conflict);
        }
        self.exhaust_level();
        Ok(false)
    }

    /// Takes back what the present alternative of a level did.
    fn undo_alternative(&mut self, depth: LevelId) {
        let level = &self.levels[depth];
        let checkpoint = level.checkpoint;
        if let Kind::Decision { decision } = level.kind {
            self.leaf.is_ready = false;
            self.chosen[decision] = None;
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
    fn decision_context(&self, decision: DecisionId) -> Context {
        if self.model.has_contexts {
            self.model.decisions[decision].context
        } else {
            self.found_decision_contexts[decision]
        }
    }

    /// Inserts a decision that has been reached, or an arc's context, in networks of unknown structure.
    pub(crate) fn reach_decision(&mut self, decision: DecisionId, context: Context) {
        if self.structure.is_none() {
            self.frontier.insert(decision);
        }
        if !self.model.has_contexts {
            self.found_decision_contexts[decision] = context;
        }
    }

    pub(crate) fn forget_decision(&mut self, decision: DecisionId) {
        self.frontier.remove(&decision);
    }

    pub(crate) fn set_found_context(&mut self, arc: ArcId, context: Context) {
        if !self.model.has_contexts {
            self.found_contexts[arc] = context;
        }
    }
}

fn tree_choice(kind: &Kind, alternative: u32) -> TreeChoice {
    match kind {
        &Kind::Decision { decision } => TreeChoice::Decision { decision, alternative },
        Kind::Link { ask, tells, .. } => {
            TreeChoice::Link(CausalLink { ask: *ask, tell: tells[alternative as usize] })
        }
        &Kind::Threat { left, right, .. } => {
            let (first, then) = if alternative == 0 { (left, right) } else { (right, left) };
            TreeChoice::Order(Ordering { first, then })
        }
    }
}
