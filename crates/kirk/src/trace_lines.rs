//! A trace as JSON lines, for tools that draw search trees: one object per event, then one per state of the search.

use serde_json::{Value, json};
use tpn::{Network, UseId};

use crate::trace::{
    Constraint, CycleMember, Departing, Event, SearchRound, Trace, TreeChoice, TreeNodeId, TreeStatus,
};

/// Writes `trace` as JSON lines.
///
/// The first line is the header `{"format":"enroute-trace/1",…}`. Events follow in order: `{"step","node","event",…}`
/// with names as in all output. Choices that are the reason of something are objects of the names in it. Then
/// the states: `{"node","parent","alternative","status","label","conflict"}`, where
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
    let mut alternative = 0;
    for (id, node) in (0_u32..).zip(&trace.tree) {
        // A choice point is entered again as new states.
        let is_next = id.checked_sub(1).is_some_and(|before| trace.are_alternatives(before, id));
        alternative = if is_next { alternative + 1 } else { 0 };
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
        Event::Backtrack { to } => json!({ "event": "backtrack", "to": to }),
        Event::Backjump { to, because } => json!({ "event": "backjump", "to": to, "because": because }),
        Event::Solution { plan } => json!({ "event": "solution", "plan": plan }),
        Event::Exhausted => json!({ "event": "exhausted" }),
        _ => learning_json(network, event),
    }
}

/// Returns what only searches that learn do.
fn learning_json(network: &Network, event: &Event) -> Value {
    let choices = |choices: &[TreeChoice]| -> Vec<Value> {
        choices.iter().map(|&choice| choice_json(network, choice)).collect()
    };
    let uses = |uses: &[UseId]| -> Vec<String> { uses.iter().map(|&used| network.use_name(used)).collect() };
    match event {
        Event::Begin(SearchRound { is_in_textual_order, is_best_first, values, bound }) => json!({
            "event": "begin",
            "textual": is_in_textual_order,
            "best-first": is_best_first,
            "values": values,
            "bound": bound,
        }),
        Event::TryUseOrder { order } => json!({
            "event": "try-use-order",
            "first": network.use_name(order.first),
            "then": network.use_name(order.then),
        }),
        Event::TryStart { used, by } => {
            json!({ "event": "try-start", "use": network.use_name(*used), "by": by })
        }
        Event::Imply { choice, holds, because } => json!({
            "event": "imply",
            "choice": choice_json(network, *choice),
            "holds": holds,
            "because": choices(because),
        }),
        Event::NoAlternative { decision } => {
            json!({ "event": "no-alternative", "decision": Network::decision_name(*decision) })
        }
        Event::Unsharable { uses: those } => json!({ "event": "unsharable", "uses": uses(those) }),
        Event::NotBetter { choices: those } => json!({ "event": "not-better", "choices": choices(those) }),
        Event::Clash { choices: those } => json!({ "event": "clash", "choices": choices(those) }),
        Event::Uncontrollable { choices: those } => {
            json!({ "event": "uncontrollable", "choices": choices(those) })
        }
        Event::Circle { orders } => json!({ "event": "circle", "orders": choices(orders) }),
        Event::NoRoomForGap => json!({ "event": "no-room-for-gap" }),
        Event::Known { choices: those } => json!({ "event": "known", "choices": choices(those) }),
        Event::Learn { choices: those } => json!({ "event": "learn", "choices": choices(those) }),
        Event::Overload { uses: those } => json!({ "event": "overload", "uses": uses(those) }),
        Event::OutOfRange { early, late } => {
            json!({ "event": "out-of-range", "early": uses(early), "late": uses(late) })
        }
        Event::Restart => json!({ "event": "restart" }),
        Event::Keep { orders, uses } => json!({
            "event": "keep",
            "orders": orders.iter().map(|&order| choice_json(network, TreeChoice::Order(order))).collect::<Vec<_>>(),
            "uses": uses.iter().map(|&order| choice_json(network, TreeChoice::UseOrder(order))).collect::<Vec<_>>(),
        }),
        Event::Bound { values } => json!({ "event": "bound", "values": values }),
        Event::Visit { values, waiting } => json!({ "event": "visit", "values": values, "waiting": waiting }),
        Event::Improve { values } => json!({ "event": "improve", "values": values }),
        _ => Value::Null,
    }
}

/// A choice: `{"decision","alternative"}`, `{"ask","tell"}`, `{"first","then"}` of conditions or of uses,
/// `{"use","by"}`, `{"use","after"}`, and `{"movement","before"}`.
fn choice_json(network: &Network, choice: TreeChoice) -> Value {
    let label = |id| network.label_name(id);
    match choice {
        TreeChoice::Decision { decision, alternative } => {
            json!({ "decision": Network::decision_name(decision), "alternative": alternative })
        }
        TreeChoice::Link(link) => json!({ "ask": label(link.ask), "tell": label(link.tell) }),
        TreeChoice::Order(order) => json!({ "first": label(order.first), "then": label(order.then) }),
        TreeChoice::NoLink { ask } => json!({ "ask": label(ask), "tell": null }),
        TreeChoice::UseOrder(order) => {
            json!({ "first": network.use_name(order.first), "then": network.use_name(order.then) })
        }
        TreeChoice::Start { used, by } => json!({ "use": network.use_name(used), "by": by }),
        TreeChoice::Later { used, than } => json!({ "use": network.use_name(used), "after": than }),
        TreeChoice::Apart => json!({ "apart": true }),
        TreeChoice::Departure(Departing { movement, before }) => {
            json!({ "movement": label(movement), "before": label(before) })
        }
    }
}

fn member_json(network: &Network, member: &CycleMember) -> Value {
    let constraint = match member.constraint {
        Constraint::Lower(arc) => json!({ "lower": arc.0 }),
        Constraint::Upper(arc) => json!({ "upper": arc.0 }),
        Constraint::Link(link) => choice_json(network, TreeChoice::Link(link)),
        Constraint::Order(order) => choice_json(network, TreeChoice::Order(order)),
        Constraint::UseOrder(order) => choice_json(network, TreeChoice::UseOrder(order)),
        Constraint::Departure(departing) => choice_json(network, TreeChoice::Departure(departing)),
    };
    json!({ "from": member.from.0, "to": member.to.0, "weight": member.weight, "constraint": constraint })
}

fn status_name(status: TreeStatus) -> &'static str {
    match status {
        TreeStatus::Unexplored => "unexplored",
        TreeStatus::Excluded => "excluded",
        TreeStatus::Decision => "decision",
        TreeStatus::Failed => "failed",
        TreeStatus::Solution => "solution",
    }
}
