//! Phase 1 arc by arc: selected nodes are expanded and the bounds of their arcs propagated (SPEC 5.1).

use stn::{Inconsistency, PointId};
use tpn::{ArcId, Choice, NodeId};

use crate::model::{Context, INFINITE, ModelArc, node, point};
use crate::search::{Engine, Origin, UNBOUNDED_BELOW};
use crate::trace::Event;
use crate::unplannable::Unplannable;

impl Engine<'_> {
    /// Selects what every plan has. `false` if that is inconsistent.
    pub(crate) fn select_mandatory(&mut self) -> Result<bool, Unplannable> {
        // Where nobody watches, all arcs are propagated at once.
        let is_bulk = self.recorder.is_none();
        self.select_node(self.model.start, None);
        if !self.expand(vec![self.model.start], None, is_bulk)? {
            return Ok(false);
        }
        if is_bulk { self.settle_selected() } else { Ok(true) }
    }

    /// Selects what an alternative brings. `false` if it is inconsistent; then `conflict` says why.
    pub(crate) fn select_alternative(&mut self, choice: Choice) -> Result<bool, Unplannable> {
        let context = Some(choice);
        let arc = self.model.decisions[choice.decision].alternatives[choice.alternative as usize];
        if !self.select_arc(arc, context, false)? {
            return Ok(false);
        }
        let target = self.model.arcs[arc].to;
        if !self.select_node(target, context) {
            return Ok(true);
        }
        self.expand(vec![target], context, false)
    }

    /// Takes back the selection of all but the first `nodes` and `arcs`.
    pub(crate) fn deselect(&mut self, nodes: usize, arcs: usize) {
        while self.selected_nodes.len() > nodes {
            let Some(node) = self.selected_nodes.pop() else { return };
            self.is_selected_node[node] = false;
            if let Some(decision) = self.model.decision_of[node] {
                self.forget_decision(decision);
            }
        }
        while self.selected_arcs.len() > arcs {
            let Some(arc) = self.selected_arcs.pop() else { return };
            self.is_selected_arc[arc] = false;
        }
    }

    /// Selects a node; `false` if it was before.
    pub(crate) fn select_node(&mut self, node: NodeId, context: Context) -> bool {
        if self.is_selected_node[node] {
            return false;
        }
        self.is_selected_node[node] = true;
        self.selected_nodes.push(node);
        if let Some(decision) = self.model.decision_of[node] {
            self.reach_decision(decision, context);
        }
        true
    }

    /// Propagates everything pushed so far. `false` if it is inconsistent.
    pub(crate) fn settle_selected(&mut self) -> Result<bool, Unplannable> {
        let mut order: Vec<PointId> = Vec::with_capacity(self.selected_nodes.len());
        order.extend(self.model.order.iter().filter(|&&point| self.is_selected_node[node(point)]));
        match self.stn.settle(&order) {
            Ok(()) => Ok(true),
            Err(Inconsistency::Overflow(overflow)) => Err(overflow.into()),
            Err(Inconsistency::NegativeCycle) => {
                self.add_cycle_to_conflict();
                Ok(false)
            }
        }
    }

    /// Expands selected nodes, the textually first one next.
    fn expand(
        &mut self,
        mut stack: Vec<NodeId>,
        context: Context,
        is_bulk: bool,
    ) -> Result<bool, Unplannable> {
        let model = self.model;
        while let Some(node) = stack.pop() {
            if model.decision_of[node].is_some() {
                continue;
            }
            self.log(|_| Event::Expand { node });
            for &arc in model.out_arcs(node) {
                if !self.select_arc(arc, context, is_bulk)? {
                    return Ok(false);
                }
            }
            for &arc in model.out_arcs(node).iter().rev() {
                let target = model.arcs[arc].to;
                if self.select_node(target, context) {
                    stack.push(target);
                }
            }
        }
        Ok(true)
    }

    fn select_arc(&mut self, arc: ArcId, context: Context, is_bulk: bool) -> Result<bool, Unplannable> {
        self.set_found_context(arc, context);
        self.is_selected_arc[arc] = true;
        self.selected_arcs.push(arc);
        if is_bulk {
            self.push_arc(arc);
            return Ok(true);
        }
        self.log(|_| Event::AddArc { arc });
        let ModelArc { lower, upper, from, to, .. } = self.model.arcs[arc];
        let (from, to, tag) = (point(from), point(to), Origin::Arc(arc).tag());
        let mut moved = 0;
        let mut result = Ok(());
        if lower != UNBOUNDED_BELOW {
            result = self.stn.insert(to, from, -lower, tag);
            moved += self.stn.num_changed();
        }
        if upper != INFINITE && result.is_ok() {
            result = self.stn.insert(from, to, upper, tag);
            moved += self.stn.num_changed();
        }
        match result {
            Ok(()) => {
                self.log(|_| Event::Propagate { moved: moved as u32 });
                Ok(true)
            }
            Err(Inconsistency::Overflow(overflow)) => Err(overflow.into()),
            Err(Inconsistency::NegativeCycle) => {
                self.log(|engine| Event::Inconsistent { cycle: crate::record::cycle_of(engine) });
                self.add_cycle_to_conflict();
                Ok(false)
            }
        }
    }
}
