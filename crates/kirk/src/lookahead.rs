//! What the choices made so far leave possible: finds dead ends in phase 2 before phase 1 is complete.
//!
//! A second network holds everything that the choices made so far select, with the hull of each open choice in its
//! place. Requirements that no assertion can carry any more and conflicting pairs that fit in no order end a branch at
//! once; where only one possibility is left it is put into this network, so that it tells on others. Everything here
//! follows from the choices, so that cutting a branch loses no plan; the network that plans come from is another one.

use stn::{Checkpoint, Inconsistency, Overflow, PointId, Stn, Tag};

use crate::model::{Context, INFINITE, Model, NONE};
use crate::structure::{Hull, Relation, Structure, TreeState};

/// The hull of an open choice holds whatever is chosen.
const HULL: Tag = 1 << 31;
/// Tags from here on are of consequences, by position in `reasons`.
const CONSEQUENCE: Tag = 1 << 30;

#[derive(Debug)]
pub(crate) struct Lookahead {
    stn: Stn,
    is_active_node: Vec<bool>,
    is_active_label: Vec<bool>,
    /// Where each active label stands in `labels`.
    label_position: Vec<u32>,
    /// Whether requirements that can still be carried are looked through for consequences again: worth its time once a
    /// complete choice has failed.
    pub(crate) is_thorough: bool,
    /// An assertion that could carry each requirement when it was checked last.
    witness: Vec<u32>,
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
    nodes: u32,
    labels: u32,
    reasons: u32,
}

/// What can become of one assertion for a requirement.
enum Candidate {
    Possible,
    Open,
    Impossible,
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
            stn,
            is_active_node: vec![false; model.num_nodes],
            is_active_label: vec![false; model.conditions.labels.len()],
            label_position: vec![0; model.conditions.labels.len()],
            is_thorough: false,
            witness: vec![NONE; model.conditions.labels.len()],
            nodes: Vec::with_capacity(model.num_nodes),
            labels: Vec::with_capacity(model.conditions.labels.len()),
            reasons: Vec::new(),
            marks: Vec::new(),
            blamed: Vec::new(),
            new_arcs: Vec::new(),
            new_hulls: Vec::new(),
            hulls: Vec::new(),
            arriving: Vec::new(),
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
        let checkpoint = self.stn.checkpoint();
        // A schedule in which the first alternatives fit needs little repair when they are taken.
        let mut hulls = self.hulls.iter().copied();
        for position in 0..self.arriving.len() {
            let mut arc = self.arriving[position];
            if arc.tag == HULL
                && let Some(decision) = hulls.next()
                && decision != NONE
                && let Some((lower, upper)) = structure.first_alternative(decision)?
            {
                (arc.lower, arc.upper) = (lower, upper);
            }
            push(&mut self.stn, arc);
        }
        let order: Vec<PointId> =
            model.order.iter().copied().filter(|point| self.is_active_node[point.index()]).collect();
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
        let start = PointId(model.twin[model.start as usize]);
        self.stn.sweep_distances(start, &order, &mut self.from_start, &mut self.to_start)?;
        self.check_labels(model, structure, chosen, 0)
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
        self.marks.push(Mark {
            depth: depth as u32,
            checkpoint: self.stn.checkpoint(),
            nodes: self.nodes.len() as u32,
            labels: self.labels.len() as u32,
            reasons: self.reasons.len() as u32,
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
        for node in self.nodes.drain(mark.nodes as usize..) {
            self.is_active_node[node as usize] = false;
        }
        for label in self.labels.drain(mark.labels as usize..) {
            self.is_active_label[label as usize] = false;
        }
        self.reasons.truncate(mark.reasons as usize);
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
        let inserted = self.stn.constrain(from, to, hull.lower, upper, tag);
        if !self.is_ok(model, inserted)? {
            return Ok(false);
        }
        self.check_labels(model, structure, chosen, self.labels.len())
    }

    /// Puts the arcs that an alternative, or the root, brings into `arriving`.
    fn collect(&mut self, model: &Model, structure: &Structure, alternative: Option<(u32, u32)>) {
        let mut arcs = std::mem::take(&mut self.new_arcs);
        let mut hulls = std::mem::take(&mut self.new_hulls);
        let (mut arrive, mut hull) = (|arc| arcs.push(arc), |hull| hulls.push(hull));
        match alternative {
            Some(alternative) => structure.emit_alternative(alternative, &mut arrive, &mut hull),
            None => structure.emit_root(&mut arrive, &mut hull),
        }
        for &arc in &arcs {
            self.arrive(model, arc);
        }
        for hull in &hulls {
            let (from, to) = (model.twin[hull.from as usize], model.twin[hull.to as usize]);
            self.activate_node(from);
            self.activate_node(to);
            self.hulls.push(hull.decision);
            self.arriving.push(Arriving { from, to, lower: hull.lower, upper: hull.upper, tag: HULL });
        }
        arcs.clear();
        hulls.clear();
        (self.new_arcs, self.new_hulls) = (arcs, hulls);
    }

    fn arrive(&mut self, model: &Model, arc: u32) {
        let bounds = &model.arcs[arc as usize];
        let (from, to) = (model.twin[bounds.from as usize], model.twin[bounds.to as usize]);
        self.activate_node(from);
        self.activate_node(to);
        if from != to || bounds.lower > 0 || bounds.upper < 0 {
            self.arriving.push(Arriving { from, to, lower: bounds.lower, upper: bounds.upper, tag: arc });
        }
        for &label in model.conditions.labels_of(arc) {
            self.is_active_label[label as usize] = true;
            self.label_position[label as usize] = self.labels.len() as u32;
            self.labels.push(label);
        }
    }

    fn activate_node(&mut self, node: u32) -> bool {
        let is_new = !self.is_active_node[node as usize];
        if is_new {
            self.is_active_node[node as usize] = true;
            self.nodes.push(node);
        }
        is_new
    }

    /// Inserts the arriving arcs with the new nodes as early as their predecessors allow, so that little moves.
    fn insert_arriving(&mut self, first_node: usize, decision_node: u32) -> Result<(), Inconsistency> {
        let Self { stn, nodes, arriving, rank, .. } = self;
        let start = stn.schedule()[decision_node as usize];
        for &node in &nodes[first_node..] {
            stn.set_free_time(PointId(node), start);
        }
        arriving.sort_by_key(|arc| rank[arc.from as usize]);
        for arc in arriving.iter() {
            let time =
                stn.schedule()[arc.from as usize].checked_add(arc.lower).ok_or(Inconsistency::Overflow)?;
            if time > stn.schedule()[arc.to as usize] {
                stn.set_free_time(PointId(arc.to), time);
            }
        }
        for position in 0..self.arriving.len() {
            let arc = self.arriving[position];
            self.stn.constrain(
                PointId(arc.from),
                PointId(arc.to),
                arc.lower,
                (arc.upper != INFINITE).then_some(arc.upper),
                arc.tag,
            )?;
        }
        Ok(())
    }

    /// Bounds the times of new nodes by what arrived with them.
    fn bound_new_nodes(&mut self, first_node: usize) {
        let Self { nodes, arriving, from_start, to_start, is_new, .. } = self;
        for &node in &nodes[first_node..] {
            is_new[node as usize] = true;
            (from_start[node as usize], to_start[node as usize]) = (INFINITE, INFINITE);
        }
        let mut relax = |arc: &Arriving| {
            let (from, to) = (arc.from as usize, arc.to as usize);
            if is_new[to] {
                shorten(from_start, from, to, arc.upper);
                shorten(to_start, from, to, -arc.lower);
            }
            if is_new[from] {
                shorten(from_start, to, from, -arc.lower);
                shorten(to_start, to, from, arc.upper);
            }
        };
        for _ in 0..2 {
            for arc in arriving.iter().chain(arriving.iter().rev()) {
                relax(arc);
            }
        }
        for &node in &nodes[first_node..] {
            is_new[node as usize] = false;
        }
    }

    /// Whether the start of everything keeps `to − from ≤ weight` from holding, by the nodes' own contexts.
    fn is_refused(&self, (from, to, weight): (PointId, PointId, i64)) -> bool {
        let (latest, least) = (self.from_start[from.index()], self.to_start[to.index()]);
        latest != INFINITE
            && least != INFINITE
            && latest
                .checked_add(weight)
                .and_then(|time| time.checked_add(least))
                .is_some_and(|slack| slack < 0)
    }

    /// Turns a contradiction into blame.
    fn is_ok(&mut self, model: &Model, result: Result<(), Inconsistency>) -> Result<bool, Overflow> {
        match result {
            Ok(()) => Ok(true),
            Err(Inconsistency::Overflow) => Err(Overflow),
            Err(Inconsistency::NegativeCycle) => {
                self.blame_cycle(model);
                Ok(false)
            }
        }
    }

    fn blame_cycle(&mut self, model: &Model) {
        for edge in self.stn.cycle() {
            if edge.tag == HULL {
                continue;
            }
            if edge.tag >= CONSEQUENCE {
                self.blamed.extend_from_slice(&self.reasons[(edge.tag - CONSEQUENCE) as usize]);
            } else {
                let context = model.arcs[edge.tag as usize].context;
                if context.decision != NONE {
                    self.blamed.push(context.decision);
                }
            }
        }
    }

    fn blame_label(&mut self, model: &Model, label: u32) {
        let context = context_of(model, label);
        if context.decision != NONE {
            self.blamed.push(context.decision);
        }
    }

    fn check_labels(
        &mut self,
        model: &Model,
        structure: &Structure,
        chosen: &[u32],
        first: usize,
    ) -> Result<bool, Overflow> {
        for position in 0..first {
            // The schedule shows that most of the earlier requirements can still be carried.
            let label = self.labels[position];
            if model.conditions.labels[label as usize].is_ask
                && !self.is_carried(model, label)
                && (self.is_thorough || !self.can_stay(model, chosen, label)?)
                && !self.check_ask(model, chosen, label)?
            {
                return Ok(false);
            }
        }
        for position in first..self.labels.len() {
            let label = self.labels[position];
            if model.conditions.labels[label as usize].is_ask && !self.check_ask(model, chosen, label)? {
                return Ok(false);
            }
            for other in model.conditions.conflicts(label) {
                let is_earlier = self.is_active_label[other as usize]
                    && self.label_position[other as usize] < position as u32;
                if is_earlier && !self.check_pair(model, structure, label, other)? {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    /// Whether two conflicting intervals fit in some order.
    fn check_pair(
        &mut self,
        model: &Model,
        structure: &Structure,
        left: u32,
        right: u32,
    ) -> Result<bool, Overflow> {
        let arc = |label: u32| model.conditions.labels[label as usize].arc;
        if arc(left) == arc(right) {
            self.blamed.clear();
            self.blame_label(model, left);
            return Ok(false);
        }
        if structure.relation(arc(left), arc(right)) != Relation::Open {
            return Ok(true);
        }
        // Edges that put the left one first, and the right one first: touching is allowed for, since it may be entailed.
        let order = |first: u32, then: u32| {
            let (_, first_end) = interval(model, first);
            let (then_start, _) = interval(model, then);
            (then_start, first_end, -model.gap_after[first as usize])
        };
        let (left_first, right_first) = (order(left, right), order(right, left));
        if self.holds(left_first) || self.holds(right_first) {
            return Ok(true);
        }
        self.blamed.clear();
        if self.admits(model, left_first)? {
            if self.admits(model, right_first)? {
                return Ok(true);
            }
            self.conclude(model, &[left, right], &[left_first])
        } else {
            self.conclude(model, &[left, right], &[right_first])
        }
    }

    /// Whether some assertion can carry a requirement.
    fn check_ask(&mut self, model: &Model, chosen: &[u32], ask: u32) -> Result<bool, Overflow> {
        self.blamed.clear();
        let mut only = NONE;
        for tell in model.conditions.supporters(ask) {
            match self.candidate(model, chosen, ask, tell)? {
                Candidate::Impossible => {}
                // What is open may be chosen later; two possibilities leave nothing to conclude.
                Candidate::Open => return Ok(true),
                Candidate::Possible if only != NONE => return Ok(true),
                Candidate::Possible => {
                    self.witness[ask as usize] = tell;
                    only = tell;
                }
            }
        }
        if only == NONE {
            self.blame_label(model, ask);
            return Ok(false);
        }
        let edges = link_edges(model, ask, only);
        self.conclude(model, &[ask, only], &edges)
    }

    /// Whether some selected assertion carries a requirement in the present schedule.
    fn is_carried(&self, model: &Model, ask: u32) -> bool {
        let mut carriers = model.conditions.supporters(ask);
        carriers.any(|tell| {
            self.is_active_label[tell as usize]
                && link_edges(model, ask, tell).iter().all(|&edge| self.holds(edge))
        })
    }

    /// Whether the assertion found last can still carry a requirement.
    fn can_stay(&mut self, model: &Model, chosen: &[u32], ask: u32) -> Result<bool, Overflow> {
        let tell = self.witness[ask as usize];
        if tell == NONE || !self.is_active_label[tell as usize] {
            return Ok(false);
        }
        Ok(matches!(self.candidate(model, chosen, ask, tell)?, Candidate::Possible))
    }

    fn candidate(
        &mut self,
        model: &Model,
        chosen: &[u32],
        ask: u32,
        tell: u32,
    ) -> Result<Candidate, Overflow> {
        if !self.is_active_label[tell as usize] {
            let mut context = context_of(model, tell);
            while context.decision != NONE {
                let taken = chosen[context.decision as usize];
                if taken != NONE && taken != context.alternative {
                    self.blamed.push(context.decision);
                    return Ok(Candidate::Impossible);
                }
                context = model.decisions[context.decision as usize].context;
            }
            return Ok(Candidate::Open);
        }
        let edges = link_edges(model, ask, tell);
        if edges.iter().all(|&edge| self.holds(edge)) {
            return Ok(Candidate::Possible);
        }
        if edges.iter().any(|&edge| self.is_refused(edge)) {
            self.blame_label(model, tell);
            return Ok(Candidate::Impossible);
        }
        let checkpoint = self.stn.checkpoint();
        let mut result = Ok(());
        for (from, to, weight) in edges {
            // A contradiction with the first edge rests on the label's own choices.
            result = result.and_then(|()| self.stn.insert(from, to, weight, HULL));
        }
        self.stn.rollback(checkpoint);
        if self.is_ok(model, result)? {
            return Ok(Candidate::Possible);
        }
        self.blame_label(model, tell);
        Ok(Candidate::Impossible)
    }

    /// Adds what is left as a consequence of `blamed` and of the labels' choices. `false` if it does not fit either.
    fn conclude(
        &mut self,
        model: &Model,
        labels: &[u32],
        edges: &[(PointId, PointId, i64)],
    ) -> Result<bool, Overflow> {
        for &label in labels {
            self.blame_label(model, label);
        }
        self.blamed.sort_unstable();
        self.blamed.dedup();
        let tag = CONSEQUENCE + self.reasons.len() as Tag;
        self.reasons.push(self.blamed.clone());
        for &(from, to, weight) in edges {
            let inserted = self.stn.insert(from, to, weight, tag);
            if !self.is_ok(model, inserted)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether the present schedule keeps `to − from ≤ weight`.
    fn holds(&self, (from, to, weight): (PointId, PointId, i64)) -> bool {
        let schedule = self.stn.schedule();
        schedule[to.index()].checked_sub(schedule[from.index()]).is_some_and(|distance| distance <= weight)
    }

    fn admits(
        &mut self,
        model: &Model,
        (from, to, weight): (PointId, PointId, i64),
    ) -> Result<bool, Overflow> {
        let admitted = self.stn.admits(from, to, weight, HULL);
        self.is_ok(model, admitted)
    }
}

/// Bounds the distance of `to` by that of `from` and an edge.
fn shorten(distances: &mut [i64], from: usize, to: usize, weight: i64) {
    if distances[from] != INFINITE
        && weight != INFINITE
        && let Some(reached) = distances[from].checked_add(weight)
    {
        distances[to] = distances[to].min(reached);
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
