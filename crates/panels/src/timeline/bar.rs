//! What a bar represents: what a click on it selects, and its windows in words.

use layout::timeline::{Bar, BarKind};
use tpn::{Network, NodeId, Plan};
use workbench::state::Selection;
use workbench::time_text;

/// Returns what a click on a bar selects.
pub(super) fn selection(bar: &Bar, network: &Network) -> Selection {
    match (bar.occurrence, bar.label) {
        (Some(occurrence), _) if bar.is_complete(network) => Selection::Occurrence(occurrence),
        (_, Some(label)) => Selection::Label(label),
        (_, None) => Selection::None,
    }
}

/// Its windows in words.
pub(super) fn words(bar: &Bar, plan: &Plan) -> String {
    let interval = |node: NodeId| {
        plan.windows
            .get(node.index())
            .copied()
            .flatten()
            .map_or_else(String::new, |window| time_text::interval(window.earliest, window.latest))
    };
    if bar.kind.is_past() {
        let [from, to] = bar.scheduled().map(|time| (time * 1000.0).round() / 1000.0);
        let end = if bar.kind == BarKind::Aborted { "aborted" } else { "ended" };
        return format!("started {from}, {end} {to}; not in the current plan");
    }
    let windows = format!("starts {}, ends {}", interval(bar.events[0]), interval(bar.events[1]));
    match bar.natures {
        Some([least, greatest]) => {
            format!("{windows}; uncontrolled duration, {least} to {greatest}")
        }
        None => windows,
    }
}
