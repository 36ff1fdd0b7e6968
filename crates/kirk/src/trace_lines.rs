//! A trace as JSON lines, for tools that draw search trees: one object per event, then one per state of the search.

use serde_json::{Value, json};
use tpn::Network;

use crate::trace::{Constraint, CycleMember, Event, Trace, TreeNodeId, TreeStatus};

/// Writes `trace` as JSON lines.
///
/// The first line is the header `{"format":"enroute-trace/1",…}`. Events follow in order: `{"step","node","event",…}`
/// with names as in all output. Then the states: `{"node","parent","alternative","status","label","conflict"}`, where
/// `conflict` lists the constraints of the contradiction that ended the state, if one did.
pub fn trace_json_lines(network: &Network, trace: &Trace) -> String {
    let mut lines = vec![json!({
        "format": "enroute-trace/1",
        "events": trace.events.len(),
        "nodes": trace.tree.len(),
        "truncated": trace.is_truncated,
    })];
    let mut conflicts: Vec<Option<Value>> = vec![None; trace.tree.len()];
    for (step, entry) in trace.events.iter().enumerate() {
        let mut line = event_json(network, &entry.event);
        line["step"] = json!(step);
        line["node"] = json!(entry.tree_node);
        if let (Event::Inconsistent { .. }, Some(conflict)) =
            (&entry.event, conflicts.get_mut(entry.tree_node as usize))
        {
            *conflict = Some(line["cycle"].clone());
        }
        lines.push(line);
    }
    let mut last_parent = None;
    let mut alternative = 0;
    for (id, node) in (0_u32..).zip(&trace.tree) {
        // The states of one choice point stand side by side; a choice point is entered again as new states.
        alternative = if node.parent.is_some() && node.parent == last_parent { alternative + 1 } else { 0 };
        last_parent = node.parent;
        lines.push(json!({
            "node": id,
            "parent": node.parent,
            "alternative": node.parent.map(|_| alternative),
            "status": status_name(node.status),
            "label": trace.label(network, id as TreeNodeId),
            "conflict": conflicts[id as usize],
        }));
    }
    let mut text = String::new();
    for line in lines {
        text.push_str(&line.to_string());
        text.push('\n');
    }
    text
}

fn event_json(network: &Network, event: &Event) -> Value {
    let label = |id| network.label_name(id);
    match event {
        Event::Expand { node } => json!({ "event": "expand", "expanded": node.0 }),
        Event::Decide { decision, alternative } => {
            json!({ "event": "decide", "decision": Network::decision_name(*decision), "alternative": alternative })
        }
        Event::AddArc { arc } => json!({ "event": "add-arc", "arc": arc.0 }),
        Event::Propagate { moved } => json!({ "event": "propagate", "moved": moved }),
        Event::Inconsistent { cycle } => {
            let cycle: Vec<Value> = cycle.iter().map(|member| member_json(network, member)).collect();
            json!({ "event": "inconsistent", "cycle": cycle })
        }
        Event::Unclosable { ask } => json!({ "event": "unclosable", "ask": label(*ask) }),
        Event::TryLink { link } => {
            json!({ "event": "try-link", "ask": label(link.ask), "tell": label(link.tell) })
        }
        Event::Threat { left, right } => {
            json!({ "event": "threat", "left": label(*left), "right": label(*right) })
        }
        Event::TryOrder { order } => {
            json!({ "event": "try-order", "first": label(order.first), "then": label(order.then) })
        }
        Event::Unresolvable { left, right } => {
            json!({ "event": "unresolvable", "left": label(*left), "right": label(*right) })
        }
        Event::Known => json!({ "event": "known" }),
        Event::Backtrack { to } => json!({ "event": "backtrack", "to": to }),
        Event::Backjump { to, because } => json!({ "event": "backjump", "to": to, "because": because }),
        Event::Solution { plan } => json!({ "event": "solution", "plan": plan }),
        Event::Exhausted => json!({ "event": "exhausted" }),
    }
}

fn member_json(network: &Network, member: &CycleMember) -> Value {
    let constraint = match member.constraint {
        Constraint::Lower(arc) => json!({ "lower": arc.0 }),
        Constraint::Upper(arc) => json!({ "upper": arc.0 }),
        Constraint::Link(link) => {
            json!({ "ask": network.label_name(link.ask), "tell": network.label_name(link.tell) })
        }
        Constraint::Order(order) => {
            json!({ "first": network.label_name(order.first), "then": network.label_name(order.then) })
        }
    };
    json!({ "from": member.from.0, "to": member.to.0, "weight": member.weight, "constraint": constraint })
}

fn status_name(status: TreeStatus) -> &'static str {
    match status {
        TreeStatus::Unexplored => "unexplored",
        TreeStatus::Decision => "decision",
        TreeStatus::Failed => "failed",
        TreeStatus::Solution => "solution",
    }
}
