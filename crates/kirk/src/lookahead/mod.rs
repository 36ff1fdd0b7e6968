//! What the choices made so far leave possible: finds dead ends in phase 2 before phase 1 is complete.
//!
//! A second network holds everything that the choices made so far select, with the hull of each open choice in its
//! place. Requirements that no assertion can carry any more and conflicting pairs that fit in no order end a branch at
//! once; where only one possibility is left it is put into this network, so that it tells on others. Everything here
//! follows from the choices, so that cutting a branch loses no plan; the network that plans come from is another one.

mod arrive;
mod check;
mod guess;

use stn::{Checkpoint, Inconsistency, Overflow, PointId, Stn, Tag};

use crate::model::{Context, INFINITE, Model, NONE};
use crate::structure::{Hull, Structure, TreeState};

/// The hull of an open choice holds whatever is chosen.
const HULL: Tag = 1 << 31;
/// Tags from here on are of consequences, by position in `reasons`.
const CONSEQUENCE: Tag = 1 << 30;

/// Tags up to here are of links that are guessed, by requirement; everything else has [`HULL`] in the second network.
const GUESS: Tag = 0;

/// The most decisions after which a requirement is looked through again although nothing ever followed from that.
const LONGEST_PAUSE: u32 = 63;

#[derive(Debug)]
pub(crate) struct Lookahead {
    /// What follows from the choices.
    stn: Stn,
    /// The same and the guessed links.
    guide: Stn,
    is_active_node: Vec<bool>,
    is_active_label: Vec<bool>,
    /// Where each active label stands in `labels`.
    label_position: Vec<u32>,
    /// Whether requirements that can still be carried are looked through for consequences again: worth its time once a
    /// complete choice has failed.
    pub(crate) is_thorough: bool,
    /// How often something has been decided.
    num_decided: u32,
    /// For each requirement when to look through it again, by `num_decided`, and the pause before that.
    due: Vec<(u32, u32)>,
    /// Requirements whose only possible link is part of the network whatever is chosen.
    is_linked: Vec<bool>,
    /// An assertion that could carry each requirement when it was checked last.
    witness: Vec<u32>,
    /// Where the two edges of each requirement's guessed link are, if it has one.
    guessed: Vec<Option<u32>>,
    /// The requirements in the order of their guesses.
    guesses: Vec<u32>,
    nodes: Vec<u32>,
    labels: Vec<u32>,
    /// The decisions that each consequence follows from.
    reasons: Vec<Vec<u32>>,
    marks: Vec<Mark>,
    /// The decisions that the failure at hand rests on.
    pub(crate) blamed: Vec<u32>,
    /// Room for what arrives.
    new_arcs: Vec<u32>,
    new_hulls: Vec<Hull>,
    /// The decisions whose hulls are among the arriving arcs, in order; [`NONE`] for parts without labels.
    hulls: Vec<u32>,
    /// Arcs being activated.
    arriving: Vec<Arriving>,
    rank: Vec<u32>,
    /// Bounds on each node's distances from and to the start that rest on nothing but its own context, so that most
    /// assertions that are too early or too late for a requirement are refused at once.
    from_start: Vec<i64>,
    to_start: Vec<i64>,
    /// Nodes that have just been activated.
    is_new: Vec<bool>,
}

#[derive(Clone, Copy, Debug)]
struct Arriving {
    from: u32,
    to: u32,
    lower: i64,
    upper: i64,
    tag: Tag,
}

#[derive(Clone, Copy, Debug)]
struct Mark {
    depth: u32,
    checkpoint: Checkpoint,
    guide_checkpoint: Checkpoint,
    nodes: u32,
    labels: u32,
    reasons: u32,
    guesses: u32,
}

impl Lookahead {
    pub(crate) fn new(model: &Model) -> Self {
        let mut rank = vec![0; model.num_nodes];
        for (position, point) in (0..).zip(&model.order) {
            rank[point.index()] = position;
        }
        let mut stn = Stn::new(model.num_nodes);
        stn.reserve(model.arcs.len() * 2 + 64);
        stn.set_origin(PointId(model.twin[model.start as usize]));
        Self {
            guide: stn.clone(),
            stn,
            is_active_node: vec![false; model.num_nodes],
            is_active_label: vec![false; model.conditions.labels.len()],
            label_position: vec![0; model.conditions.labels.len()],
            is_thorough: false,
            num_decided: 0,
            due: vec![(0, 0); model.conditions.labels.len()],
            is_linked: vec![false; model.conditions.labels.len()],
            witness: vec![NONE; model.conditions.labels.len()],
            guessed: vec![None; model.conditions.labels.len()],
            guesses: Vec::new(),
            nodes: Vec::with_capacity(model.num_nodes),
            labels: Vec::with_capacity(model.conditions.labels.len()),
            reasons: Vec::new(),
            marks: Vec::new(),
            blamed: Vec::new(),
            new_arcs: Vec::with_capacity(model.arcs.len()),
            new_hulls: Vec::with_capacity(model.decisions.len()),
            hulls: Vec::with_capacity(model.decisions.len()),
            arriving: Vec::with_capacity(model.arcs.len()),
            rank,
            from_start: Vec::new(),
            to_start: Vec::new(),
            is_new: vec![false; model.num_nodes],
        }
    }

    /// Activates what every plan has. `false` if that has no plan.
    pub(crate) fn begin(
        &mut self,
        model: &Model,
        structure: &Structure,
        chosen: &[u32],
    ) -> Result<bool, Overflow> {
        self.blamed.clear();
        self.activate_node(model.twin[model.start as usize]);
        self.collect(model, structure, None);
        // A schedule in which the first alternatives fit needs little repair when they are taken.
        for position in 0..self.arriving.len() {
            if self.arriving[position].tag != HULL {
                push(&mut self.stn, self.arriving[position]);
            }
        }
        let checkpoint = self.stn.checkpoint();
        self.arriving.retain(|arc| arc.tag == HULL);
        for (&hull, &decision) in self.arriving.iter().zip(&self.hulls) {
            let first = if decision == NONE { None } else { structure.first_alternative(decision)? };
            let (lower, upper) = first.unwrap_or((hull.lower, hull.upper));
            push(&mut self.stn, Arriving { lower, upper, ..hull });
        }
        let mut order = Vec::with_capacity(model.num_nodes);
        order.extend(model.order.iter().filter(|point| self.is_active_node[point.index()]));
        let guessed = self.stn.settle(&order);
        self.stn.rollback(checkpoint);
        for position in 0..self.arriving.len() {
            push(&mut self.stn, self.arriving[position]);
        }
        let settled = match guessed {
            Ok(()) => Ok(()),
            Err(Inconsistency::Overflow) => Err(Inconsistency::Overflow),
            Err(Inconsistency::NegativeCycle) => self.stn.settle(&order),
        };
        self.arriving.clear();
        self.hulls.clear();
        if !self.is_ok(model, settled)? {
            return Ok(false);
        }
        if !self.link_by_windows(model, &order)? {
            return Ok(false);
        }
        self.guide.copy_as(&self.stn, HULL);
        let num_edges = self.stn.num_edges();
        if !self.check_labels(model, structure, chosen, 0)? {
            return Ok(false);
        }
        self.narrow_windows(num_edges, &order)?;
        Ok(true)
    }

    /// Links, as far as windows alone tell, what every plan has; each link narrows the windows of others.
    fn link_by_windows(&mut self, model: &Model, order: &[PointId]) -> Result<bool, Overflow> {
        let start = PointId(model.twin[model.start as usize]);
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
    fn narrow_windows(&mut self, first_edge: usize, order: &[PointId]) -> Result<(), Overflow> {
        self.stn.tighten_distances(first_edge, order, &mut self.from_start, &mut self.to_start)
    }

    /// Activates what an alternative brings. `false` if it has no plan; then `blamed` says why.
    pub(crate) fn decide(
        &mut self,
        model: &Model,
        structure: &Structure,
        tree: &TreeState,
        chosen: &[u32],
        (decision, alternative): (u32, u32),
        depth: usize,
    ) -> Result<bool, Overflow> {
        self.blamed.clear();
        self.num_decided += 1;
        self.marks.push(Mark {
            depth: depth as u32,
            checkpoint: self.stn.checkpoint(),
            guide_checkpoint: self.guide.checkpoint(),
            nodes: self.nodes.len() as u32,
            labels: self.labels.len() as u32,
            reasons: self.reasons.len() as u32,
            guesses: self.guesses.len() as u32,
        });
        let first_label = self.labels.len();
        let first_node = self.nodes.len();
        if let Some((part, hull)) = structure.label_free_part(tree, decision) {
            return self.tighten(model, structure, tree, chosen, part, hull);
        }
        self.collect(model, structure, Some((decision, alternative)));
        let decision_node = structure.decision_node(decision);
        let inserted = self.insert_arriving(first_node, model.twin[decision_node as usize]);
        if inserted.is_ok() {
            self.bound_new_nodes(first_node);
        }
        self.arriving.clear();
        self.hulls.clear();
        if !self.is_ok(model, inserted)? {
            return Ok(false);
        }
        self.check_labels(model, structure, chosen, first_label)
    }

    /// Takes back the [`Lookahead::decide`] at a level, if there was one.
    pub(crate) fn undo(&mut self, depth: usize) {
        let Some(mark) = self.marks.pop_if(|mark| mark.depth == depth as u32) else { return };
        self.stn.rollback(mark.checkpoint);
        self.guide.rollback(mark.guide_checkpoint);
        for node in self.nodes.drain(mark.nodes as usize..) {
            self.is_active_node[node as usize] = false;
        }
        for label in self.labels.drain(mark.labels as usize..) {
            self.is_active_label[label as usize] = false;
        }
        self.reasons.truncate(mark.reasons as usize);
        self.forget_guesses(mark.guesses as usize);
    }

    /// A time for each node that fits all that is known to hold, and the guessed links; for nodes that are not in this
    /// network the time of the start.
    pub(crate) fn likely_times<'l>(&'l self, model: &'l Model) -> impl Iterator<Item = i64> + 'l {
        let schedule = self.guide.schedule();
        let start = schedule[model.twin[model.start as usize] as usize];
        model.twin.iter().map(move |&twin| {
            if self.is_active_node[twin as usize] { schedule[twin as usize] } else { start }
        })
    }

    /// Takes into account what a decision does to the duration of a part without labels.
    fn tighten(
        &mut self,
        model: &Model,
        structure: &Structure,
        tree: &TreeState,
        chosen: &[u32],
        part: u32,
        hull: Hull,
    ) -> Result<bool, Overflow> {
        let (from, to) = (PointId(model.twin[hull.from as usize]), PointId(model.twin[hull.to as usize]));
        let mut reason = Vec::new();
        structure.explain(tree, chosen, part, &mut |decision| reason.push(decision));
        reason.sort_unstable();
        reason.dedup();
        let tag = CONSEQUENCE + self.reasons.len() as Tag;
        self.reasons.push(reason);
        let upper = (hull.upper != INFINITE).then_some(hull.upper);
        let inserted = self.constrain(from, to, (hull.lower, upper), tag);
        if !self.is_ok(model, inserted)? {
            return Ok(false);
        }
        self.check_labels(model, structure, chosen, self.labels.len())
    }
}

fn push(stn: &mut Stn, arc: Arriving) {
    let (from, to) = (PointId(arc.from), PointId(arc.to));
    if arc.upper != INFINITE {
        stn.push(from, to, arc.upper, arc.tag);
    }
    stn.push(to, from, -arc.lower, arc.tag);
}

fn context_of(model: &Model, label: u32) -> Context {
    model.arcs[model.conditions.labels[label as usize].arc as usize].context
}

/// The ends of a labelled interval, by the nodes that stand for theirs.
fn interval(model: &Model, label: u32) -> (PointId, PointId) {
    let (start, end) = model.interval(label);
    (PointId(model.twin[start.index()]), PointId(model.twin[end.index()]))
}

/// The assertion begins no later than the requirement, and ends no earlier.
fn link_edges(model: &Model, ask: u32, tell: u32) -> [(PointId, PointId, i64); 2] {
    let (ask_start, ask_end) = interval(model, ask);
    let (tell_start, tell_end) = interval(model, tell);
    [(ask_start, tell_start, 0), (tell_end, ask_end, 0)]
}
