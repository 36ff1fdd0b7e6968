//! What the tooltip says of an item, and what a screen reader says of the whole.

use crate::counted;
use exact::Bound;
use layout::text::{bounds_label, label_words};
use layout::{Item, NetworkDrawing};
use rmpl::program::Controllability;
use tpn::{ArcKind, BlockId, Network, OccurrenceKind, Plan, Role};
use workbench::state::selection::node_name;

/// A heading and lines about an item of the drawing.
pub(super) fn describe(item: Item, network: &Network, plan: Option<&Plan>) -> Option<(String, Vec<String>)> {
    let (heading, lines) = named(item, network, plan)?;
    Some((network.readable(&heading), lines.iter().map(|line| network.readable(line)).collect()))
}

/// The same with identifiers of calls.
fn named(item: Item, network: &Network, plan: Option<&Plan>) -> Option<(String, Vec<String>)> {
    match item {
        Item::Node(id) => describe_node(id, network, plan),
        Item::Arc(id) => describe_arc(id, network, plan),
        Item::Label(id) => {
            let label = network.labels.get(id.index())?;
            let (_, arc) = describe_arc(label.arc, network, plan)?;
            let mut lines = vec![label_words(label)];
            lines.extend(arc);
            Some((network.label_name(id), lines))
        }
        Item::Block(id) => {
            let block = network.blocks.get(id.index())?;
            let name = match &block.kind {
                tpn::BlockKind::Scope { occurrence: Some(occurrence), .. } => {
                    network.occurrences.get(occurrence.index())?.name.to_string()
                }
                kind => layout::text::structure_name(kind).to_string(),
            };
            let ends = format!("{} → {}", node_name(network, block.start), node_name(network, block.end));
            Some((name, vec![ends, "double-click to expand or collapse".to_owned()]))
        }
    }
}

/// A box names so much of what it holds.
const MAX_INSIDE: usize = 12;

/// A heading and lines about a box that begins with block `first`.
pub(super) fn describe_box(
    title: &str,
    first: BlockId,
    network: &Network,
    drawing: &NetworkDrawing,
) -> (String, Vec<String>) {
    let is_inside = |occurrence: &&tpn::Occurrence| {
        let boxes = [occurrence.start, occurrence.end].map(|node| drawing.box_of(node));
        let is_this = |shape: Option<&layout::BlockShape>| shape.is_some_and(|it| it.block == Some(first));
        boxes.into_iter().any(is_this)
    };
    let bounds = |occurrence: &tpn::Occurrence| {
        let arc = occurrence.arc.and_then(|arc| network.arcs.get(arc.index()));
        arc.map_or_else(String::new, |arc| format!(" {}", bounds_label(arc.lower, arc.upper)))
    };
    let named = |it: &&tpn::Occurrence| {
        matches!(it.kind, OccurrenceKind::Primitive | OccurrenceKind::Activity | OccurrenceKind::Assertion)
    };
    let inside: Vec<&tpn::Occurrence> = network.occurrences.iter().filter(is_inside).filter(named).collect();
    let mut lines: Vec<String> = inside
        .iter()
        .take(MAX_INSIDE)
        .map(|it| format!("{}{}", network.readable(&it.name), bounds(it)))
        .collect();
    if let Some(more) = inside.len().checked_sub(MAX_INSIDE).filter(|&more| more > 0) {
        lines.push(format!("… and {more} more"));
    }
    lines.push("double-click or press Enter to expand".to_owned());
    (title.to_owned(), lines)
}

/// With more choices than this, no one wants to hear them one by one.
const MAX_CHOICES: usize = 30;

/// The drawing in a sentence.
pub(super) fn summary(network: &Network, plan: Option<&Plan>) -> String {
    let count = |number: usize, one: &str, many: &str| match number {
        1 => format!("1 {one}"),
        _ => format!("{number} {many}"),
    };
    let mut text = format!(
        "{}, {}, {}.",
        count(network.nodes.len(), "event", "events"),
        count(network.arcs.len(), "constraint", "constraints"),
        count(network.decisions.len(), "decision", "decisions")
    );
    let choices = plan.map(|plan| plan.choices.as_slice());
    match choices {
        None => {}
        Some([]) => text.push_str(" No decisions made."),
        Some(choices) if choices.len() > MAX_CHOICES => {
            text.push_str(&format!(" {} decisions made.", choices.len()));
        }
        Some(choices) => {
            let name = Network::decision_name;
            let choices = choices.iter().map(|it| format!("{}={}", name(it.decision), it.alternative));
            text.push_str(&format!(" Chosen: {}.", choices.collect::<Vec<_>>().join(", ")));
        }
    }
    text
}

fn describe_node(id: tpn::NodeId, network: &Network, plan: Option<&Plan>) -> Option<(String, Vec<String>)> {
    let node = network.nodes.get(id.index())?;
    let mut lines: Vec<String> = Vec::new();
    if let Some(decision) = node.decision {
        let count = network.decisions.get(decision.index()).map_or(0, |it| it.alternatives.len());
        let chosen = plan.and_then(|plan| plan.choices.iter().find(|choice| choice.decision == decision));
        lines.push(match chosen {
            Some(choice) => {
                format!("{}, {} chosen", counted(count as u64, "alternative"), choice.alternative)
            }
            None => counted(count as u64, "alternative"),
        });
    }
    lines.extend(node.events.iter().skip(1).map(|&event| network.event_name(event)));
    if node.role == Role::Structural && node.events.is_empty() {
        lines.push("fork, join or merge".to_owned());
    }
    match plan.and_then(|plan| plan.windows.get(id.index())) {
        Some(Some(window)) => {
            lines.push(format!("window {}", bounds_label(window.earliest, window.latest)));
            lines.push(match window.latest.checked_sub(window.earliest) {
                Some(Bound::Finite(slack)) => format!("slack {slack}"),
                Some(Bound::Infinite) => "slack ∞".to_owned(),
                None => "slack too large to calculate".to_owned(),
            });
        }
        Some(None) => lines.push("not selected by the plan".to_owned()),
        None => {}
    }
    Some((format!("{} ({})", node_name(network, id), id.0), lines))
}

fn describe_arc(id: tpn::ArcId, network: &Network, plan: Option<&Plan>) -> Option<(String, Vec<String>)> {
    let arc = network.arcs.get(id.index())?;
    let occurrence = arc.occurrence.and_then(|id| network.occurrences.get(id.index()));
    let mut lines = Vec::new();
    if let Some(occurrence) = occurrence.filter(|it| !it.arguments.is_empty()) {
        let complete = format!("{}({})", occurrence.activity, occurrence.arguments.join(", "));
        // The heading leaves arguments of long calls out.
        lines.extend((network.readable(&occurrence.name) != complete).then_some(complete));
    }
    lines.push(format!("{} {}", kind_name(arc.kind), bounds_label(arc.lower, arc.upper)));
    if arc.is_contingent {
        lines.push(match network.controllability {
            Controllability::None => "contingent, but planned as if controllable".to_owned(),
            _ => "contingent: the environment chooses, and the executive observes the end".to_owned(),
        });
    }
    let labels = arc.labels.iter().filter_map(|label| network.labels.get(label.index()));
    lines.extend(labels.map(label_words));
    if plan.is_some_and(|plan| plan.selected_arcs.get(id.index()) == Some(&false)) {
        lines.push("not selected by the plan".to_owned());
    }
    let ends = format!("{} → {}", node_name(network, arc.from), node_name(network, arc.to));
    let heading = match (occurrence, arc.choice) {
        (Some(occurrence), _) => occurrence.name.to_string(),
        (None, Some((decision, alternative))) => {
            format!("{} = {alternative}", Network::decision_name(decision))
        }
        (None, None) => ends.clone(),
    };
    if heading != ends {
        lines.push(ends);
    }
    Some((heading, lines))
}

const fn kind_name(kind: ArcKind) -> &'static str {
    match kind {
        ArcKind::Activity => "duration",
        ArcKind::Assertion => "assertion",
        ArcKind::Delay => "delay",
        ArcKind::Composite => "activity",
        ArcKind::Span => "bounds",
        ArcKind::Point => "guard",
        ArcKind::Glue => "then",
        ArcKind::Fork => "fork",
        ArcKind::Join => "join",
        ArcKind::Choice => "choice",
        ArcKind::Merge => "merge",
        ArcKind::Path => "path",
        ArcKind::Constraint => "constraint",
    }
}
