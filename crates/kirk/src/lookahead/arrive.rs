//! What a choice brings into the network of the look-ahead: its arcs, labels, and the relaxations of its open choices.

use stn::{Inconsistency, Overflow};
use tpn::{ArcId, Choice, NodeId};

use super::{Arriving, Lookahead, Origin};
use crate::model::{INFINITE, Model, point};
use crate::structure::Structure;

impl Lookahead {
    /// Puts the arcs that an alternative, or the root, brings into `arriving`.
    pub(super) fn collect(&mut self, model: &Model, structure: &Structure, alternative: Option<Choice>) {
        let mut arcs = std::mem::take(&mut self.new_arcs);
        let mut relaxations = std::mem::take(&mut self.new_relaxations);
        let (mut arrive, mut relaxation) = (|arc| arcs.push(arc), |relaxation| relaxations.push(relaxation));
        match alternative {
            Some(alternative) => structure.emit_alternative(alternative, &mut arrive, &mut relaxation),
            None => structure.emit_root(&mut arrive, &mut relaxation),
        }
        for &arc in &arcs {
            self.arrive(model, arc);
        }
        for relaxation in &relaxations {
            let (from, to) = (model.representatives[relaxation.from], model.representatives[relaxation.to]);
            self.activate_node(from);
            self.activate_node(to);
            self.relaxations.push(relaxation.decision);
            self.arriving.push(Arriving {
                from,
                to,
                lower: relaxation.lower,
                upper: relaxation.upper,
                origin: Origin::Relaxation,
            });
        }
        arcs.clear();
        relaxations.clear();
        (self.new_arcs, self.new_relaxations) = (arcs, relaxations);
    }

    fn arrive(&mut self, model: &Model, arc: ArcId) {
        let bounds = &model.arcs[arc];
        let (from, to) = (model.representatives[bounds.from], model.representatives[bounds.to]);
        self.activate_node(from);
        self.activate_node(to);
        if from != to || bounds.lower > 0 || bounds.upper < 0 {
            self.arriving.push(Arriving {
                from,
                to,
                lower: bounds.lower,
                upper: bounds.upper,
                origin: Origin::Arc(arc),
            });
        }
        for &label in model.conditions.labels_of(arc) {
            self.is_active_label[label] = true;
            self.label_position[label] = self.labels.len() as u32;
            self.labels.push(label);
        }
    }

    pub(super) fn activate_node(&mut self, node: NodeId) -> bool {
        let is_new = !self.is_active_node[node];
        if is_new {
            self.is_active_node[node] = true;
            self.nodes.push(node);
        }
        is_new
    }

    /// Inserts the arriving arcs with the new nodes as early as their predecessors allow, so that little moves.
    pub(super) fn insert_arriving(
        &mut self,
        first_node: usize,
        decision_node: NodeId,
    ) -> Result<(), Inconsistency> {
        let Self { stn, guide, nodes, arriving, rank, .. } = self;
        let start = stn.schedule()[decision_node.index()];
        let guided_start = guide.schedule()[decision_node.index()];
        for &node in &nodes[first_node..] {
            stn.set_free_time(point(node), start);
            guide.set_free_time(point(node), guided_start);
        }
        arriving.sort_by_key(|arc| rank[arc.from]);
        for arc in arriving.iter() {
            let (from, to) = (arc.from.index(), point(arc.to));
            for network in [&mut *stn, &mut *guide] {
                let time = network.schedule()[from].checked_add(arc.lower).ok_or(Overflow { point: to })?;
                if time > network.schedule()[to.index()] {
                    network.set_free_time(to, time);
                }
            }
        }
        for position in 0..self.arriving.len() {
            let arc = self.arriving[position];
            let upper = (arc.upper != INFINITE).then_some(arc.upper);
            self.constrain(point(arc.from), point(arc.to), (arc.lower, upper), arc.origin)?;
        }
        Ok(())
    }

    /// Bounds the times of new nodes by what arrived with them.
    pub(super) fn bound_new_nodes(&mut self, first_node: usize) {
        let Self { nodes, arriving, from_start, to_start, is_new, .. } = self;
        for &node in &nodes[first_node..] {
            is_new[node] = true;
            (from_start[node.index()], to_start[node.index()]) = (INFINITE, INFINITE);
        }
        let mut relax = |arc: &Arriving| {
            let (from, to) = (arc.from.index(), arc.to.index());
            if is_new[arc.to] {
                shorten(from_start, from, to, arc.upper);
                shorten(to_start, from, to, -arc.lower);
            }
            if is_new[arc.from] {
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
            is_new[node] = false;
        }
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
