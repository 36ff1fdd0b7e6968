//! The paper's search (SPEC 5.1 to 5.4): on one stack alternatives of decisions, then causal links, then orders of threats;
//! on failure the last choice is undone that has an alternative left. Its first plan is the canonical one.
//!
//! Decisions are made in textual order with their alternatives from left to right, requirements in textual order with
//! assertions in textual order, and threats in textual order with the textual order of the pair first. Nothing is learned,
//! and everything that is done can be recorded.

use std::collections::BTreeSet;

use exact::Bound;
use stn::{Checkpoint, Inconsistency, PointId, Stn, Tag};
use tpn::{
    ArcId, CausalLink, Choice, DecisionId, DistinctPlans, LabelId, Network, NodeId, Ordering, Plan, Window,
};
use typed_index_collections::TiVec;

use crate::model::{INFINITE, Model, ModelArc, UNBOUNDED_BELOW, node, point};
use crate::options::{Options, Outcome, Stats, Status, Termination};
use crate::solver_search;
use crate::trace::{Constraint, CycleMember, Event, Recorder, TreeChoice, TreeNodeId, TreeStatus};
use crate::unplannable::Unplannable;

/// The plans of a network as the paper's search finds them, but for those that make all of some excluded choices.
pub(crate) fn search(
    network: &Network,
    model: &Model,
    options: &Options,
    excluded: &[Vec<Choice>],
    termination: &mut dyn Termination,
) -> Result<Outcome, Unplannable> {
    let mut search = ChronologicalSearch::new(model, options);
    let mut plans = DistinctPlans::new(network);
    let mut is_found = search.begin()?;
    let status = loop {
        is_found = is_found && search.next_solution(termination)?;
        if search.is_stopped {
            break Status::Limit;
        }
        if !is_found {
            search.exhausted(options.all);
            break if plans.plans().is_empty() { Status::NoPlan } else { Status::Plan };
        }
        let plan = search.plan()?;
        let makes = |choices: &Vec<Choice>| choices.iter().all(|choice| plan.choices.contains(choice));
        if excluded.iter().any(makes) {
            is_found = search.backtrack()?;
            continue;
        }
        let count = plans.plans().len();
        if plans.insert(plan) {
            search.log(|_| Event::Solution { plan: count as u32 });
        }
        if !options.all {
            break Status::Plan;
        }
        if plans.plans().len() >= options.max_plans {
            break Status::Limit;
        }
        is_found = search.backtrack()?;
    };
    Ok(Outcome {
        status,
        plans: plans.into_plans(),
        bound: None,
        failure: None,
        stats: search.stats,
        trace: search.recorder.map(|recorder| recorder.trace),
        unplannable: None,
    })
}

/// A choice that was made, with the alternatives that are left.
struct Level {
    kind: Kind,
    /// The alternative to try next.
    next: u32,
    /// How many there are.
    count: u32,
    checkpoint: Checkpoint,
    num_selected_nodes: usize,
    num_selected_arcs: usize,
    /// The state in which the choice is made, and the first of its alternatives' states.
    state: TreeNodeId,
    first_child: TreeNodeId,
}

/// What is chosen at a level.
enum Kind {
    Decision(DecisionId),
    /// `position` among the selected requirements; `tells` are the candidates.
    Link {
        position: usize,
        ask: LabelId,
        tells: Vec<LabelId>,
    },
    /// `position` among the conflicting pairs.
    Threat {
        position: usize,
        left: LabelId,
        right: LabelId,
    },
}

impl Kind {
    fn choice(&self, alternative: u32) -> TreeChoice {
        match self {
            &Self::Decision(decision) => TreeChoice::Decision { decision, alternative },
            Self::Link { ask, tells, .. } => {
                TreeChoice::Link(CausalLink { ask: *ask, tell: tells[alternative as usize] })
            }
            &Self::Threat { left, right, .. } => {
                let (first, then) = if alternative == 0 { (left, right) } else { (right, left) };
                TreeChoice::Order(Ordering { first, then })
            }
        }
    }
}

/// A conflicting pair of selected conditions, with what arcs and links say of it.
#[derive(Clone, Copy)]
struct Pair {
    left: LabelId,
    right: LabelId,
    /// Whether the left one comes first; `None` if neither does in every schedule, which is a threat (SPEC 5.3).
    is_left_first: Option<bool>,
}

enum Next {
    Choice(Kind),
    Solution,
    Failure,
}

/// Edges beyond this tag rest on a level, others on an arc.
const FIRST_LEVEL: Tag = 1 << 31;

struct ChronologicalSearch<'m> {
    model: &'m Model,
    stn: Stn,
    chosen: TiVec<DecisionId, Option<u32>>,
    levels: Vec<Level>,
    is_selected_node: TiVec<NodeId, bool>,
    is_selected_arc: TiVec<ArcId, bool>,
    selected_nodes: Vec<NodeId>,
    selected_arcs: Vec<ArcId>,
    /// Decisions that are reached and open.
    frontier: BTreeSet<DecisionId>,
    /// Selected requirements in textual order, of the present complete choice.
    asks: Vec<LabelId>,
    /// Conflicting pairs in textual order, of the present links; `None` until all are chosen.
    pairs: Option<Vec<Pair>>,
    recorder: Option<Recorder>,
    state: TreeNodeId,
    stats: Stats,
    is_stopped: bool,
}

impl<'m> ChronologicalSearch<'m> {
    fn new(model: &'m Model, options: &Options) -> Self {
        let mut stn = Stn::new(model.num_nodes);
        stn.reserve(model.arcs.len() * 2 + 64);
        stn.set_origin(point(model.start));
        Self {
            model,
            stn,
            chosen: vec![None; model.decisions.len()].into(),
            levels: Vec::new(),
            is_selected_node: vec![false; model.num_nodes].into(),
            is_selected_arc: vec![false; model.arcs.len()].into(),
            selected_nodes: Vec::with_capacity(model.num_nodes),
            selected_arcs: Vec::with_capacity(model.arcs.len()),
            frontier: BTreeSet::new(),
            asks: Vec::new(),
            pairs: None,
            recorder: options.trace_events.map(Recorder::new),
            state: 0,
            stats: Stats {
                nodes: model.num_nodes as u64,
                arcs: model.arcs.len() as u64,
                decisions: model.decisions.len() as u64,
                ..Stats::default()
            },
            is_stopped: false,
        }
    }

    /// Selects what every plan has. `false` if that is inconsistent.
    fn begin(&mut self) -> Result<bool, Unplannable> {
        // Where no one watches, all arcs are propagated at once.
        let is_bulk = self.recorder.is_none();
        self.select_node(self.model.start);
        let mut is_consistent = self.expand(vec![self.model.start], is_bulk)?;
        if is_consistent && is_bulk {
            is_consistent = self.is_consistent_after(|search| search.stn.settle(&search.model.order))?;
        }
        self.stats.conflicts += u64::from(!is_consistent);
        Ok(is_consistent)
    }

    /// Continues from the present state to the next solution. `false` if there is none, or the search is stopped.
    fn next_solution(&mut self, termination: &mut dyn Termination) -> Result<bool, Unplannable> {
        loop {
            let is_record_full = self.recorder.as_ref().is_some_and(|recorder| recorder.trace.is_truncated);
            if is_record_full || termination.should_stop(&self.stats) {
                self.is_stopped = true;
                return Ok(false);
            }
            let goes_on = match self.next()? {
                Next::Solution => {
                    self.set_status(self.state, TreeStatus::Solution);
                    return Ok(true);
                }
                Next::Choice(kind) => {
                    self.open_level(kind);
                    self.try_alternatives()? || self.backtrack()?
                }
                Next::Failure => {
                    self.set_status(self.state, TreeStatus::Failed);
                    self.backtrack()?
                }
            };
            if !goes_on {
                return Ok(false);
            }
        }
    }

    /// Returns what to do next in the present state.
    fn next(&mut self) -> Result<Next, Unplannable> {
        if let Some(&decision) = self.frontier.first() {
            return Ok(Next::Choice(Kind::Decision(decision)));
        }
        let (first_ask, first_pair) = match self.levels.last().map(|level| &level.kind) {
            None | Some(Kind::Decision(_)) => {
                if !self.begin_phase_2() {
                    self.stats.conflicts += 1;
                    return Ok(Next::Failure);
                }
                (0, 0)
            }
            Some(&Kind::Link { position, .. }) => (position + 1, 0),
            Some(&Kind::Threat { position, .. }) => (self.asks.len(), position + 1),
        };
        if let Some(&ask) = self.asks.get(first_ask) {
            let tells = self.model.conditions.supporters(ask);
            let tells = tells.filter(|&tell| self.is_selected(tell)).collect();
            return Ok(Next::Choice(Kind::Link { position: first_ask, ask, tells }));
        }
        if self.pairs.is_none() {
            self.pairs = Some(self.find_pairs()?);
        }
        Ok(match self.next_threat(first_pair)? {
            Some(position) => {
                let Pair { left, right, .. } = self.pairs.as_deref().unwrap_or(&[])[position];
                self.log(|_| Event::Threat { left, right });
                Next::Choice(Kind::Threat { position, left, right })
            }
            None => Next::Solution,
        })
    }

    /// Prepares phase 2 of a complete choice. `false` if it contradicts itself on one arc.
    fn begin_phase_2(&mut self) -> bool {
        self.stats.leaves += 1;
        let conditions = &self.model.conditions;
        let is_ask = |label: &LabelId| conditions.labels[*label].is_ask && self.is_selected(*label);
        self.asks = conditions.labels.keys().filter(is_ask).collect();
        !conditions.self_conflicting.iter().any(|&(label, _)| self.is_selected(label))
    }

    /// The conflicting pairs, and which of them the selected arcs and links put in an order.
    fn find_pairs(&mut self) -> Result<Vec<Pair>, Unplannable> {
        let model = self.model;
        let mut pairs = Vec::new();
        for left in model.conditions.labels.keys() {
            if !self.is_selected(left) {
                continue;
            }
            for right in model.conditions.later_conflicts(left) {
                if !self.is_selected(right) {
                    continue;
                }
                let gap_after = |label: LabelId| model.gap_after[label];
                let is_left_first = if self.is_before(left, right, gap_after(left))? {
                    Some(true)
                } else if self.is_before(right, left, gap_after(right))? {
                    Some(false)
                } else {
                    None
                };
                pairs.push(Pair { left, right, is_left_first });
            }
        }
        Ok(pairs)
    }

    /// The position of the first threat from `first` on that no orders taken so far resolve.
    fn next_threat(&mut self, first: usize) -> Result<Option<usize>, Unplannable> {
        let count = self.pairs.as_ref().map_or(0, Vec::len);
        for position in first..count {
            let Some(&Pair { left, right, is_left_first: None }) =
                self.pairs.as_ref().and_then(|pairs| pairs.get(position))
            else {
                continue;
            };
            let gap = self.model.gap;
            if !self.is_before(left, right, gap)? && !self.is_before(right, left, gap)? {
                return Ok(Some(position));
            }
        }
        Ok(None)
    }

    fn open_level(&mut self, kind: Kind) {
        let count = match &kind {
            &Kind::Decision(decision) => {
                self.frontier.remove(&decision);
                self.model.decisions[decision].alternatives.len()
            }
            Kind::Link { tells, .. } => tells.len(),
            Kind::Threat { .. } => 2,
        } as u32;
        let (state, choices) = (self.state, (0..count).map(|alternative| kind.choice(alternative)));
        let first_child = self.recorder.as_mut().map_or(0, |recorder| recorder.branch(state, choices));
        self.levels.push(Level {
            kind,
            next: 0,
            count,
            checkpoint: self.stn.checkpoint(),
            num_selected_nodes: self.selected_nodes.len(),
            num_selected_arcs: self.selected_arcs.len(),
            state,
            first_child,
        });
    }

    /// Tries the alternatives that are left at the topmost level. `false` if none stands: then the level is gone.
    fn try_alternatives(&mut self) -> Result<bool, Unplannable> {
        let depth = self.levels.len() - 1;
        while self.levels[depth].next < self.levels[depth].count {
            let level = &mut self.levels[depth];
            let alternative = level.next;
            level.next += 1;
            self.state = level.first_child + alternative;
            self.stats.expanded += 1;
            self.set_status(self.state, TreeStatus::Decision);
            if self.take(depth, alternative)? {
                return Ok(true);
            }
            self.stats.conflicts += 1;
            self.set_status(self.state, TreeStatus::Failed);
            self.undo(depth);
        }
        self.close_level();
        Ok(false)
    }

    /// Removes the topmost level, whose alternatives have all failed.
    fn close_level(&mut self) {
        let Some(level) = self.levels.pop() else { return };
        self.state = level.state;
        self.set_status(self.state, TreeStatus::Failed);
        match level.kind {
            Kind::Decision(decision) => {
                self.frontier.insert(decision);
            }
            Kind::Link { ask, tells, .. } => {
                self.stats.conflicts += u64::from(tells.is_empty());
                self.log(|_| Event::Unclosable { ask });
            }
            Kind::Threat { left, right, .. } => self.log(|_| Event::Unresolvable { left, right }),
        }
    }

    /// Undoes the last choice, and tries what is left. `false` if there is nothing left at all.
    fn backtrack(&mut self) -> Result<bool, Unplannable> {
        while let Some(depth) = self.levels.len().checked_sub(1) {
            self.stats.backtracks += 1;
            let to = self.levels[depth].state;
            self.log(|_| Event::Backtrack { to });
            self.state = to;
            self.undo(depth);
            if self.try_alternatives()? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Takes back what the present alternative of a level did.
    fn undo(&mut self, depth: usize) {
        let level = &self.levels[depth];
        let (nodes, arcs, checkpoint) = (level.num_selected_nodes, level.num_selected_arcs, level.checkpoint);
        match level.kind {
            Kind::Decision(decision) => {
                self.pairs = None;
                self.chosen[decision] = None;
                self.deselect(nodes, arcs);
            }
            // What arcs and links say of a pair was found without orders.
            Kind::Link { .. } => self.pairs = None,
            Kind::Threat { .. } => {}
        }
        self.stn.rollback(checkpoint);
    }

    /// Takes an alternative of a level. `false` if that is inconsistent.
    fn take(&mut self, depth: usize, alternative: u32) -> Result<bool, Unplannable> {
        let model = self.model;
        let edges = match self.levels[depth].kind.choice(alternative) {
            TreeChoice::Decision { decision, alternative } => {
                self.chosen[decision] = Some(alternative);
                self.log(|_| Event::Decide { decision, alternative });
                return self.select_alternative(Choice { decision, alternative });
            }
            TreeChoice::Link(link) => {
                self.stats.links_tried += 1;
                self.log(|_| Event::TryLink { link });
                let ((ask_start, ask_end), (tell_start, tell_end)) =
                    (model.interval(link.ask), model.interval(link.tell));
                vec![(ask_start, tell_start, 0), (tell_end, ask_end, 0)]
            }
            TreeChoice::Order(order) => {
                self.stats.orderings_tried += 1;
                self.log(|_| Event::TryOrder { order });
                vec![(model.interval(order.then).0, model.interval(order.first).1, -model.gap)]
            }
            _ => Vec::new(),
        };
        let tag = FIRST_LEVEL + depth as Tag;
        self.is_consistent_after(|search| search.stn.insert_all(&edges, tag))
    }

    /// Selects what an alternative brings. `false` if it is inconsistent.
    fn select_alternative(&mut self, choice: Choice) -> Result<bool, Unplannable> {
        let arc = self.model.decisions[choice.decision].alternatives[choice.alternative as usize];
        if !self.select_arc(arc, false)? {
            return Ok(false);
        }
        let target = self.model.arcs[arc].to;
        Ok(!self.select_node(target) || self.expand(vec![target], false)?)
    }

    fn select_node(&mut self, node: NodeId) -> bool {
        if std::mem::replace(&mut self.is_selected_node[node], true) {
            return false;
        }
        self.selected_nodes.push(node);
        self.frontier.extend(self.model.decision_of[node]);
        true
    }

    fn deselect(&mut self, nodes: usize, arcs: usize) {
        for node in self.selected_nodes.split_off(nodes) {
            self.is_selected_node[node] = false;
            if let Some(decision) = self.model.decision_of[node] {
                self.frontier.remove(&decision);
            }
        }
        for arc in self.selected_arcs.split_off(arcs) {
            self.is_selected_arc[arc] = false;
        }
    }

    /// Selects what follows from nodes that are selected. `false` if it is inconsistent.
    fn expand(&mut self, mut stack: Vec<NodeId>, is_bulk: bool) -> Result<bool, Unplannable> {
        let model = self.model;
        while let Some(node) = stack.pop() {
            if model.decision_of[node].is_some() {
                continue;
            }
            self.log(|_| Event::Expand { node });
            for &arc in model.out_arcs(node) {
                if !self.select_arc(arc, is_bulk)? {
                    return Ok(false);
                }
            }
            for &arc in model.out_arcs(node).iter().rev() {
                let target = model.arcs[arc].to;
                if self.select_node(target) {
                    stack.push(target);
                }
            }
        }
        Ok(true)
    }

    fn select_arc(&mut self, arc: ArcId, is_bulk: bool) -> Result<bool, Unplannable> {
        self.is_selected_arc[arc] = true;
        self.selected_arcs.push(arc);
        let ModelArc { lower, upper, from, to, .. } = self.model.arcs[arc];
        let (from, to, tag) = (point(from), point(to), arc.0);
        let mut edges = Vec::with_capacity(2);
        if lower != UNBOUNDED_BELOW {
            edges.push((to, from, -lower));
        }
        if upper != INFINITE {
            edges.push((from, to, upper));
        }
        if is_bulk {
            for (from, to, weight) in edges {
                self.stn.push(from, to, weight, tag);
            }
            return Ok(true);
        }
        self.log(|_| Event::AddArc { arc });
        self.is_consistent_after(|search| search.stn.insert_all(&edges, tag))
    }

    /// Returns whether what is added to the network of times is consistent.
    fn is_consistent_after(
        &mut self,
        add: impl FnOnce(&mut Self) -> Result<(), Inconsistency>,
    ) -> Result<bool, Unplannable> {
        match add(self) {
            Ok(()) => {
                let moved = self.stn.num_changed() as u32;
                self.log(|_| Event::Propagate { moved });
                Ok(true)
            }
            Err(Inconsistency::Overflow(overflow)) => Err(overflow.into()),
            Err(Inconsistency::NegativeCycle) => {
                self.log(|search| Event::Inconsistent { cycle: search.cycle() });
                Ok(false)
            }
        }
    }

    /// The contradiction that was just met.
    fn cycle(&self) -> Vec<CycleMember> {
        let members = self.stn.cycle().iter().filter_map(|edge| {
            let constraint = if let Some(depth) = edge.tag.checked_sub(FIRST_LEVEL) {
                let level = self.levels.get(depth as usize)?;
                match level.kind.choice(level.next.checked_sub(1)?) {
                    TreeChoice::Link(link) => Constraint::Link(link),
                    TreeChoice::Order(order) => Constraint::Order(order),
                    _ => return None,
                }
            } else {
                let id = ArcId(edge.tag);
                let arc = &self.model.arcs[id];
                let is_upper = node(edge.from) == arc.from && edge.weight == arc.upper;
                if is_upper { Constraint::Upper(id) } else { Constraint::Lower(id) }
            };
            let weight = self.model.time(edge.weight);
            Some(CycleMember { constraint, from: node(edge.from), to: node(edge.to), weight })
        });
        members.collect()
    }

    fn is_selected(&self, label: LabelId) -> bool {
        self.is_selected_arc[self.model.conditions.labels[label].arc]
    }

    /// Returns whether one interval ends at least `gap` before another starts, in every schedule.
    fn is_before(&mut self, first: LabelId, then: LabelId, gap: i64) -> Result<bool, Unplannable> {
        let (end, start) = (self.model.interval(first).1, self.model.interval(then).0);
        let room = |times: &[i64], later: PointId, earlier: PointId| {
            i128::from(times[later.index()]) - i128::from(times[earlier.index()])
        };
        if room(self.stn.schedule(), start, end) < i128::from(gap) {
            return Ok(false);
        }
        match self.stn.admits(end, start, gap - 1, FIRST_LEVEL + self.levels.len() as Tag) {
            Ok(()) => Ok(false),
            Err(Inconsistency::NegativeCycle) => Ok(true),
            Err(Inconsistency::Overflow(overflow)) => Err(overflow.into()),
        }
    }

    /// The plan that the search is at.
    fn plan(&mut self) -> Result<Plan, Unplannable> {
        let model = self.model;
        let mut conflict_order = Vec::new();
        for Pair { left, right, is_left_first } in self.pairs.clone().unwrap_or_default() {
            // What is in both orders at once, as intervals without length at one instant are, is in the textual one.
            let is_left_first =
                is_left_first == Some(true) || self.is_before(left, right, model.gap_after[left])?;
            let (first, then) = if is_left_first { (left, right) } else { (right, left) };
            conflict_order.push(Ordering { first, then });
        }
        conflict_order.sort_by_key(|order| (order.first.min(order.then), order.first.max(order.then)));
        let (mut latest, mut earliest) = (Vec::new(), Vec::new());
        self.stn.sweep_distances(point(model.start), &model.order, &mut latest, &mut earliest)?;
        let windows = (0..model.num_nodes).map(|position| {
            let (latest, earliest) = (latest[position], earliest[position]);
            self.is_selected_node[NodeId::from_index(position)].then(|| Window {
                earliest: if earliest == INFINITE { model.time(0) } else { model.time(-earliest) },
                latest: if latest == INFINITE { Bound::Infinite } else { Bound::Finite(model.time(latest)) },
            })
        });
        let windows: Vec<Option<Window>> = windows.collect();
        let chosen = self.chosen.iter_enumerated();
        let (mut causal_links, mut orderings_added) = (Vec::new(), Vec::new());
        for level in &self.levels {
            match level.kind.choice(level.next - 1) {
                TreeChoice::Link(link) => causal_links.push(link),
                TreeChoice::Order(order) => orderings_added.push(order),
                _ => {}
            }
        }
        let selected_arcs = self.is_selected_arc.raw.clone();
        Ok(Plan {
            choices: chosen
                .filter_map(|(decision, alternative)| Some(Choice { decision, alternative: (*alternative)? }))
                .collect(),
            selected_nodes: self.is_selected_node.raw.clone(),
            causal_links,
            conflict_order,
            conflict_order_omitted: 0,
            state_order: solver_search::nested_changes(model, self.is_selected_arc.as_ref()),
            orderings_added,
            uses_ordered: Vec::new(),
            levels: Vec::new(),
            quality: model.demands.quality(&selected_arcs, &windows),
            selected_arcs,
            windows,
        })
    }

    fn exhausted(&mut self, is_enumerating: bool) {
        self.log(|_| Event::Exhausted);
        if !is_enumerating {
            self.set_status(0, TreeStatus::Failed);
        }
    }

    /// Records an event, if the search is recorded.
    fn log(&mut self, event: impl FnOnce(&Self) -> Event) {
        if self.recorder.is_some() {
            let (event, state) = (event(self), self.state);
            if let Some(recorder) = &mut self.recorder {
                recorder.record(state, event);
            }
        }
    }

    fn set_status(&mut self, state: TreeNodeId, status: TreeStatus) {
        if let Some(recorder) = &mut self.recorder {
            recorder.set_status(state, status);
        }
    }
}
