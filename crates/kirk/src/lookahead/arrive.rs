//! What a choice brings into the network of the look-ahead: its arcs, labels, and the hulls of its open choices.

use stn::{Inconsistency, PointId};

use super::{Arriving, HULL, Lookahead};
use crate::model::{INFINITE, Model};
use crate::structure::Structure;

impl Lookahead {
    /// Puts the arcs that an alternative, or the root, brings into `arriving`.
    pub(super) fn collect(&mut self, model: &Model, structure: &Structure, alternative: Option<(u32, u32)>) {
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

    pub(super) fn activate_node(&mut self, node: u32) -> bool {
        let is_new = !self.is_active_node[node as usize];
        if is_new {
            self.is_active_node[node as usize] = true;
            self.nodes.push(node);
        }
        is_new
    }

    /// Inserts the arriving arcs with the new nodes as early as their predecessors allow, so that little moves.
    pub(super) fn insert_arriving(
        &mut self,
        first_node: usize,
        decision_node: u32,
    ) -> Result<(), Inconsistency> {
        let Self { stn, guide, nodes, arriving, rank, .. } = self;
        let start = stn.schedule()[decision_node as usize];
        let guided_start = guide.schedule()[decision_node as usize];
        for &node in &nodes[first_node..] {
            stn.set_free_time(PointId(node), start);
            guide.set_free_time(PointId(node), guided_start);
        }
        arriving.sort_by_key(|arc| rank[arc.from as usize]);
        for arc in arriving.iter() {
            let time =
                stn.schedule()[arc.from as usize].checked_add(arc.lower).ok_or(Inconsistency::Overflow)?;
            if time > stn.schedule()[arc.to as usize] {
                stn.set_free_time(PointId(arc.to), time);
            }
            let time =
                guide.schedule()[arc.from as usize].checked_add(arc.lower).ok_or(Inconsistency::Overflow)?;
            if time > guide.schedule()[arc.to as usize] {
                guide.set_free_time(PointId(arc.to), time);
            }
        }
        for position in 0..self.arriving.len() {
            let arc = self.arriving[position];
            let upper = (arc.upper != INFINITE).then_some(arc.upper);
            self.constrain(PointId(arc.from), PointId(arc.to), (arc.lower, upper), arc.tag)?;
        }
        Ok(())
    }

    /// Bounds the times of new nodes by what arrived with them.
    pub(super) fn bound_new_nodes(&mut self, first_node: usize) {
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
