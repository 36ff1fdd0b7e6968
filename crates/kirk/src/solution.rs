//! A solution of the search as a plan: exact windows, links and orders.

use exact::Bound;
use stn::Overflow;
use tpn::{CausalLink, Choice, DecisionId, LabelId, Ordering, Plan, Window};

use crate::levels::Kind;
use crate::model::{INFINITE, NONE};
use crate::search::Engine;

/// The plan that the search stands at.
pub(crate) fn plan_at(engine: &mut Engine<'_>) -> Result<Plan, Overflow> {
    let conflict_order = engine.conflict_order()?;
    let model = engine.model;
    let (latest, earliest) = engine.windows_now()?;
    let windows = (0..model.num_nodes).map(|node| {
        let (latest, earliest) = (latest[node], earliest[node]);
        engine.is_selected_node[node].then(|| Window {
            earliest: if earliest == INFINITE { model.time(0) } else { model.time(-earliest) },
            latest: if latest == INFINITE { Bound::Infinite } else { Bound::Finite(model.time(latest)) },
        })
    });
    let windows = windows.collect();
    let choices = (0..).zip(&engine.chosen).filter(|&(_, &alternative)| alternative != NONE);
    let choices = choices
        .map(|(decision, &alternative)| Choice { decision: DecisionId(decision), alternative })
        .collect();
    let mut causal_links = Vec::new();
    let mut orderings_added = Vec::new();
    for level in &engine.levels {
        let taken = level.next.saturating_sub(1);
        match &level.kind {
            Kind::Decision { .. } => {}
            Kind::Link { ask, tells, .. } => {
                let tell = tells.get(taken as usize).copied().unwrap_or(NONE);
                causal_links.push(CausalLink { ask: LabelId(*ask), tell: LabelId(tell) });
            }
            &Kind::Threat { left, right, .. } => {
                let (first, then) = if taken == 0 { (left, right) } else { (right, left) };
                orderings_added.push(Ordering { first: LabelId(first), then: LabelId(then) });
            }
        }
    }
    Ok(Plan {
        choices,
        selected_nodes: engine.is_selected_node.clone(),
        selected_arcs: engine.is_selected_arc.clone(),
        causal_links,
        conflict_order: conflict_order
            .into_iter()
            .map(|(first, then)| Ordering { first: LabelId(first), then: LabelId(then) })
            .collect(),
        orderings_added,
        windows,
    })
}
