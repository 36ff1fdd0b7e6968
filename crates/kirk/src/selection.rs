//! Phase 1 arc by arc: selected nodes are expanded and the bounds of their arcs propagated (SPEC 5.1).

use stn::{Inconsistency, Overflow, PointId};
use tpn::{ArcId, NodeId};

use crate::model::{Context, INFINITE, ModelArc, NONE};
use crate::search::{Engine, UNBOUNDED_BELOW};
use crate::trace::Event;

impl Engine<'_> {
    /// Selects what every plan has. `false` if that is inconsistent.
    pub(crate) fn select_mandatory(&mut self) -> Result<bool, Overflow> {
        // Where nobody watches, all arcs are propagated at once.
        let is_bulk = self.recorder.is_none();
        self.select_node(self.model.start, Context::ALWAYS);
        if !self.expand(vec![self.model.start], Context::ALWAYS, is_bulk)? {
            return Ok(false);
        }
        if is_bulk { self.settle_selected() } else { Ok(true) }
    }

    /// Selects what an alternative brings. `false` if it is inconsistent; then `conflict` says why.
    pub(crate) fn select_alternative(&mut self, decision: u32, alternative: u32) -> Result<bool, Overflow> {
        let context = Context { decision, alternative };
        let arc = self.model.decisions[decision as usize].alternatives[alternative as usize];
        if !self.select_arc(arc, context, false)? {
            return Ok(false);
        }
        let target = self.model.arcs[arc as usize].to;
        if !self.select_node(target, context) {
            return Ok(true);
        }
        self.expand(vec![target], context, false)
    }

    /// Takes back the selection of all but the first `nodes` and `arcs`.
    pub(crate) fn deselect(&mut self, nodes: usize, arcs: usize) {
        while self.selected_nodes.len() > nodes {
            let Some(node) = self.selected_nodes.pop() else { return };
            self.is_selected_node[node as usize] = false;
            let decision = self.model.decision_of[node as usize];
            if decision != NONE {
                self.forget_decision(decision);
            }
        }
        while self.selected_arcs.len() > arcs {
            let Some(arc) = self.selected_arcs.pop() else { return };
            self.is_selected_arc[arc as usize] = false;
        }
    }

    /// Selects a node; `false` if it was before.
    pub(crate) fn select_node(&mut self, node: u32, context: Context) -> bool {
        if self.is_selected_node[node as usize] {
            return false;
        }
        self.is_selected_node[node as usize] = true;
        self.selected_nodes.push(node);
        let decision = self.model.decision_of[node as usize];
        if decision != NONE {
            self.reach_decision(decision, context);
        }
        true
    }

    /// Propagates everything pushed so far. `false` if it is inconsistent.
    pub(crate) fn settle_selected(&mut self) -> Result<bool, Overflow> {
        let mut order: Vec<PointId> = Vec::with_capacity(self.selected_nodes.len());
        order.extend(self.model.order.iter().filter(|point| self.is_selected_node[point.index()]));
        match self.stn.settle(&order) {
            Ok(()) => Ok(true),
            Err(Inconsistency::Overflow) => Err(Overflow),
            Err(Inconsistency::NegativeCycle) => {
                self.blame_cycle();
                Ok(false)
            }
        }
    }

    /// Expands selected nodes, the textually first one next.
    fn expand(&mut self, mut stack: Vec<u32>, context: Context, is_bulk: bool) -> Result<bool, Overflow> {
        let model = self.model;
        while let Some(node) = stack.pop() {
            if model.decision_of[node as usize] != NONE {
                continue;
            }
            self.log(|_| Event::Expand { node: NodeId(node) });
            for &arc in model.out_arcs(node) {
                if !self.select_arc(arc, context, is_bulk)? {
                    return Ok(false);
                }
            }
            for &arc in model.out_arcs(node).iter().rev() {
                let target = model.arcs[arc as usize].to;
                if self.select_node(target, context) {
                    stack.push(target);
                }
            }
        }
        Ok(true)
    }

    fn select_arc(&mut self, arc: u32, context: Context, is_bulk: bool) -> Result<bool, Overflow> {
        self.set_found_context(arc, context);
        self.is_selected_arc[arc as usize] = true;
        self.selected_arcs.push(arc);
        if is_bulk {
            self.push_arc(arc);
            return Ok(true);
        }
        self.log(|_| Event::AddArc { arc: ArcId(arc) });
        let ModelArc { lower, upper, from, to, .. } = self.model.arcs[arc as usize];
        let (from, to) = (PointId(from), PointId(to));
        let mut moved = 0;
        let mut result = Ok(());
        if lower != UNBOUNDED_BELOW {
            result = self.stn.insert(to, from, -lower, arc);
            moved += self.stn.num_changed();
        }
        if upper != INFINITE && result.is_ok() {
            result = self.stn.insert(from, to, upper, arc);
            moved += self.stn.num_changed();
        }
        match result {
            Ok(()) => {
                self.log(|_| Event::Propagate { moved: moved as u32 });
                Ok(true)
            }
            Err(Inconsistency::Overflow) => Err(Overflow),
            Err(Inconsistency::NegativeCycle) => {
                self.log(|engine| Event::Inconsistent { cycle: crate::record::cycle_of(engine) });
                self.blame_cycle();
                Ok(false)
            }
        }
    }
}
