//! What the choices made so far leave possible: finds failures in phase 2 before phase 1 is complete.
//!
//! A second network holds everything that the choices made so far select, with the relaxation of each open choice in its
//! place. Requirements that no assertion can carry any more and conflicting pairs that fit in no order end a branch at
//! once; where only one possibility is left it is put into this network, so that it tells on others. Everything here
//! follows from the choices, so that cutting a branch loses no plan; the network that plans come from is another one.

mod arrive;
mod check;
mod guess;
mod origin;

use stn::{Checkpoint, Inconsistency, PointId, Stn};
use tpn::{ArcId, BlockId, Choice, DecisionId, LabelId, NodeId};
use typed_index_collections::TiVec;

use crate::ids::{ConsequenceId, LevelId};
use crate::model::{Alternatives, Context, INFINITE, Model, node, point};
use crate::structure::{BlockRelaxation, Structure, TreeState};
use crate::unplannable::Unplannable;
use origin::{GuideOrigin, Origin};

/// The most decisions after which a requirement is looked through again although nothing ever followed from that.
const MAX_PAUSE: u32 = 63;

#[derive(Debug)]
pub(crate) struct Lookahead {
    /// What follows from the choices.
    stn: Stn,
    /// The same and the guessed links.
    guide: Stn,
    is_active_node: TiVec<NodeId, bool>,
    is_active_label: TiVec<LabelId, bool>,
    /// Where each active label stands in `labels`.
    label_position: TiVec<LabelId, u32>,
    /// Whether requirements that can still be carried are looked through for consequences again: worth its time once a
    /// complete choice has failed.
    pub(crate) is_thorough: bool,
    /// How often something has been decided.
    num_decided: u32,
    /// For each requirement when to look through it again, by `num_decided`, and the pause before that.
    due: TiVec<LabelId, (u32, u32)>,
    /// Requirements whose only possible link is part of the network whatever is chosen.
    is_linked: TiVec<LabelId, bool>,
    /// An assertion that could carry each requirement when it was checked last.
    witness: TiVec<LabelId, Option<LabelId>>,
    /// Where the two edges of each requirement's guessed link are, if it has one.
    guessed: TiVec<LabelId, Option<u32>>,
    /// The requirements in the order of their guesses.
    guesses: Vec<LabelId>,
    nodes: Vec<NodeId>,
    labels: Vec<LabelId>,
    /// The decisions that each consequence follows from.
    reasons: TiVec<ConsequenceId, Vec<DecisionId>>,
    marks: Vec<Mark>,
    /// The decisions that the failure at hand rests on.
    pub(crate) conflict: Vec<DecisionId>,
    /// Room for what arrives.
    new_arcs: Vec<ArcId>,
    new_relaxations: Vec<BlockRelaxation>,
    /// The decisions whose relaxations are among the arriving arcs, in order; `None` for parts without labels.
    relaxations: Vec<Option<DecisionId>>,
    /// Arcs being activated.
    arriving: Vec<Arriving>,
    rank: TiVec<NodeId, u32>,
    /// Bounds on each node's distances from and to the start that rest on nothing but its own context, so that most
    /// assertions that are too early or too late for a requirement are refused at once.
    from_start: Vec<i64>,
    to_start: Vec<i64>,
    /// Nodes that have just been activated.
    is_new: TiVec<NodeId, bool>,
}

#[derive(Clone, Copy, Debug)]
struct Arriving {
    from: NodeId,
    to: NodeId,
    lower: i64,
    upper: i64,
    origin: Origin,
}

#[derive(Clone, Copy, Debug)]
struct Mark {
    depth: LevelId,
    checkpoint: Checkpoint,
    guide_checkpoint: Checkpoint,
    nodes: u32,
    labels: u32,
    reasons: u32,
    guesses: u32,
}

impl Lookahead {
    pub(crate) fn new(model: &Model) -> Self {
        let mut rank: TiVec<NodeId, u32> = vec![0; model.num_nodes].into();
        for (position, &point) in (0..).zip(&model.order) {
            rank[node(point)] = position;
        }
        let mut stn = Stn::new(model.num_nodes);
        stn.reserve(model.arcs.len() * 2 + 64);
        stn.set_origin(model.representative(model.start));
        Self {
            guide: stn.clone(),
            stn,
            is_active_node: vec![false; model.num_nodes].into(),
            is_active_label: vec![false; model.conditions.labels.len()].into(),
            label_position: vec![0; model.conditions.labels.len()].into(),
            is_thorough: false,
            num_decided: 0,
            due: vec![(0, 0); model.conditions.labels.len()].into(),
            is_linked: vec![false; model.conditions.labels.len()].into(),
            witness: vec![None; model.conditions.labels.len()].into(),
            guessed: vec![None; model.conditions.labels.len()].into(),
            guesses: Vec::new(),
            nodes: Vec::with_capacity(model.num_nodes),
            labels: Vec::with_capacity(model.conditions.labels.len()),
            reasons: TiVec::new(),
            marks: Vec::new(),
            conflict: Vec::new(),
            new_arcs: Vec::with_capacity(model.arcs.len()),
            new_relaxations: Vec::with_capacity(model.decisions.len()),
            relaxations: Vec::with_capacity(model.decisions.len()),
            arriving: Vec::with_capacity(model.arcs.len()),
            rank,
            from_start: Vec::new(),
            to_start: Vec::new(),
            is_new: vec![false; model.num_nodes].into(),
        }
    }

    /// Activates what every plan has. `false` if that has no plan.
    pub(crate) fn begin(
        &mut self,
        model: &Model,
        structure: &Structure,
        chosen: &Alternatives,
    ) -> Result<bool, Unplannable> {
        self.conflict.clear();
        self.activate_node(model.representatives[model.start]);
        self.collect(model, structure, None);
        // A schedule in which the first alternatives fit needs little repair when they are taken.
        for position in 0..self.arriving.len() {
            if self.arriving[position].origin != Origin::Relaxation {
                push(&mut self.stn, self.arriving[position]);
            }
        }
        let checkpoint = self.stn.checkpoint();
        self.arriving.retain(|arc| arc.origin == Origin::Relaxation);
        for (&relaxation, &decision) in self.arriving.iter().zip(&self.relaxations) {
            let first = decision.map(|decision| structure.first_alternative(decision)).transpose()?.flatten();
            let (lower, upper) = first.unwrap_or((relaxation.lower, relaxation.upper));
            push(&mut self.stn, Arriving { lower, upper, ..relaxation });
        }
        let mut order = Vec::with_capacity(model.num_nodes);
        order.extend(model.order.iter().filter(|&&point| self.is_active_node[node(point)]));
        let guessed = self.stn.settle(&order);
        self.stn.rollback(checkpoint);
        for position in 0..self.arriving.len() {
            push(&mut self.stn, self.arriving[position]);
        }
        let settled = match guessed {
            Ok(()) => Ok(()),
            Err(Inconsistency::NegativeCycle) => self.stn.settle(&order),
            overflow => overflow,
        };
        self.arriving.clear();
        self.relaxations.clear();
        if !self.is_ok(model, settled)? {
            return Ok(false);
        }
        if !self.link_by_windows(model, &order)? {
            return Ok(false);
        }
        self.guide.copy_as(&self.stn, GuideOrigin::Known.tag());
        let num_edges = self.stn.num_edges();
        if !self.check_labels(model, structure, chosen, 0)? {
            return Ok(false);
        }
        self.narrow_windows(num_edges, &order)?;
        Ok(true)
    }

    /// Links, as far as windows alone tell, what every plan has; each link narrows the windows of others.
    fn link_by_windows(&mut self, model: &Model, order: &[PointId]) -> Result<bool, Unplannable> {
        let start = model.representative(model.start);
        self.stn.sweep_distances(start, order, &mut self.from_start, &mut self.to_start)?;
        loop {
            let num_edges = self.stn.num_edges();
            if !self.link_what_windows_leave(model) {
                return Ok(false);
            }
            if self.stn.num_edges() == num_edges {
                return Ok(true);
            }
            let settled = self.stn.settle(order);
            if !self.is_ok(model, settled)? {
                return Ok(false);
            }
            self.narrow_windows(num_edges, order)?;
        }
    }

    /// Narrows the windows of all active nodes by the edges from the given one on.
    fn narrow_windows(&mut self, first_edge: usize, order: &[PointId]) -> Result<(), Unplannable> {
        Ok(self.stn.tighten_distances(first_edge, order, &mut self.from_start, &mut self.to_start)?)
    }

    /// Activates what an alternative brings. `false` if it has no plan; then `conflict` says why.
    pub(crate) fn decide(
        &mut self,
        model: &Model,
        structure: &Structure,
        tree: &TreeState,
        chosen: &Alternatives,
        choice: Choice,
        depth: LevelId,
    ) -> Result<bool, Unplannable> {
        self.conflict.clear();
        self.num_decided += 1;
        self.marks.push(Mark {
            depth,
            checkpoint: self.stn.checkpoint(),
            guide_checkpoint: self.guide.checkpoint(),
            nodes: self.nodes.len() as u32,
            labels: self.labels.len() as u32,
            reasons: self.reasons.len() as u32,
            guesses: self.guesses.len() as u32,
        });
        let first_label = self.labels.len();
        let first_node = self.nodes.len();
        if let Some((part, relaxation)) = structure.label_free_part(tree, choice.decision) {
            return self.tighten(model, structure, tree, chosen, part, relaxation);
        }
        self.collect(model, structure, Some(choice));
        let decision_node = structure.decision_node(choice.decision);
        let inserted = self.insert_arriving(first_node, model.representatives[decision_node]);
        if inserted.is_ok() {
            self.bound_new_nodes(first_node);
        }
        self.arriving.clear();
        self.relaxations.clear();
        if !self.is_ok(model, inserted)? {
            return Ok(false);
        }
        self.check_labels(model, structure, chosen, first_label)
    }

    /// Takes back the [`Lookahead::decide`] at a level, if there was one.
    pub(crate) fn undo(&mut self, depth: LevelId) {
        let Some(mark) = self.marks.pop_if(|mark| mark.depth == depth) else { return };
        self.stn.rollback(mark.checkpoint);
        self.guide.rollback(mark.guide_checkpoint);
        for node in self.nodes.drain(mark.nodes as usize..) {
            self.is_active_node[node] = false;
        }
        for label in self.labels.drain(mark.labels as usize..) {
            self.is_active_label[label] = false;
        }
        self.reasons.truncate(mark.reasons as usize);
        self.forget_guesses(mark.guesses as usize);
    }

    /// A time for each node that fits all that is known to hold, and the guessed links; for nodes that are not in this
    /// network the time of the start.
    pub(crate) fn likely_times<'l>(&'l self, model: &'l Model) -> impl Iterator<Item = i64> + 'l {
        let schedule = self.guide.schedule();
        let start = schedule[model.representatives[model.start].index()];
        model.representatives.iter().map(move |&representative| {
            if self.is_active_node[representative] { schedule[representative.index()] } else { start }
        })
    }

    /// Takes into account what a decision does to the duration of a part without labels.
    fn tighten(
        &mut self,
        model: &Model,
        structure: &Structure,
        tree: &TreeState,
        chosen: &Alternatives,
        part: BlockId,
        relaxation: BlockRelaxation,
    ) -> Result<bool, Unplannable> {
        let (from, to) = (model.representative(relaxation.from), model.representative(relaxation.to));
        let mut reason = Vec::new();
        structure.explain(tree, chosen, part, &mut |decision| reason.push(decision));
        reason.sort_unstable();
        reason.dedup();
        let origin = Origin::Consequence(self.reasons.push_and_get_key(reason));
        let upper = (relaxation.upper != INFINITE).then_some(relaxation.upper);
        let inserted = self.constrain(from, to, (relaxation.lower, upper), origin);
        if !self.is_ok(model, inserted)? {
            return Ok(false);
        }
        self.check_labels(model, structure, chosen, self.labels.len())
    }
}

fn push(stn: &mut Stn, arc: Arriving) {
    let (from, to, tag) = (point(arc.from), point(arc.to), arc.origin.tag());
    if arc.upper != INFINITE {
        stn.push(from, to, arc.upper, tag);
    }
    stn.push(to, from, -arc.lower, tag);
}

fn context_of(model: &Model, label: LabelId) -> Context {
    model.arcs[model.conditions.labels[label].arc].context
}

/// The ends of a labelled interval, by the nodes that stand for theirs.
fn interval(model: &Model, label: LabelId) -> (PointId, PointId) {
    let (start, end) = model.interval(label);
    (model.representative(node(start)), model.representative(node(end)))
}

/// The assertion begins no later than the requirement, and ends no earlier.
fn link_edges(model: &Model, ask: LabelId, tell: LabelId) -> [(PointId, PointId, i64); 2] {
    let (ask_start, ask_end) = interval(model, ask);
    let (tell_start, tell_end) = interval(model, tell);
    [(ask_start, tell_start, 0), (tell_end, ask_end, 0)]
}
