//! A solution of the search as a plan: exact windows, links and orders.

use exact::Bound;
use tpn::{CausalLink, Choice, NodeId, Ordering, Plan, Window};

use crate::demanding;
use crate::levels::Kind;
use crate::model::INFINITE;
use crate::search::Engine;
use crate::unplannable::Unplannable;

/// The plan that the search stands at.
pub(crate) fn plan_at(engine: &mut Engine<'_>) -> Result<Plan, Unplannable> {
    let conflict_order = engine.conflict_order()?;
    let model = engine.model;
    let (latest, earliest) = engine.windows_now()?;
    let windows = (0..model.num_nodes).map(NodeId::from_index).map(|node| {
        let (latest, earliest) = (latest[node.index()], earliest[node.index()]);
        engine.is_selected_node[node].then(|| Window {
            earliest: if earliest == INFINITE { model.time(0) } else { model.time(-earliest) },
            latest: if latest == INFINITE { Bound::Infinite } else { Bound::Finite(model.time(latest)) },
        })
    });
    let windows: Vec<Option<Window>> = windows.collect();
    let choices = engine.chosen.iter_enumerated();
    let choices = choices
        .filter_map(|(decision, alternative)| Some(Choice { decision, alternative: (*alternative)? }))
        .collect();
    let mut causal_links = Vec::new();
    let mut orderings_added = Vec::new();
    for level in &engine.levels {
        let taken = level.next.saturating_sub(1);
        match &level.kind {
            Kind::Decision { .. } => {}
            Kind::Link { ask, tells, .. } => {
                causal_links.extend(tells.get(taken as usize).map(|&tell| CausalLink { ask: *ask, tell }));
            }
            &Kind::Threat { left, right, .. } => {
                let (first, then) = if taken == 0 { (left, right) } else { (right, left) };
                orderings_added.push(Ordering { first, then });
            }
        }
    }
    let selected_arcs = engine.is_selected_arc.raw.clone();
    let mut conflict_order: Vec<Ordering> =
        conflict_order.into_iter().map(|(first, then)| Ordering { first, then }).collect();
    let nested = demanding::nested_changes(model, &selected_arcs);
    if !nested.is_empty() {
        conflict_order.extend(nested);
        conflict_order.sort_by_key(|order| (order.first.min(order.then), order.first.max(order.then)));
    }
    Ok(Plan {
        choices,
        selected_nodes: engine.is_selected_node.raw.clone(),
        causal_links,
        conflict_order,
        orderings_added,
        uses_ordered: Vec::new(),
        levels: Vec::new(),
        quality: model.demands.quality(&selected_arcs, &windows),
        selected_arcs,
        windows,
    })
}
