//! The drawings of a report as SVG.

mod map;
mod timeline;

use display::Theme;
use layout::list::network_before::{NetworkChanges, changes_list};
use layout::timeline::before::Before;
use mission::Snapshot;
use mission::review::record::Subject;

use crate::escape::escaped;

pub(crate) use map::map;
pub use timeline::{rule_tracks, windows_before};
pub(crate) use timeline::{timeline, timeline_since};

/// A drawing with what is to be said of it, as HTML.
pub(crate) fn framed(drawing: &str, caption: &str) -> String {
    // A drawing inside HTML needs no namespace of its own.
    let drawing = drawing.replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
    format!("<figure>\n{drawing}<figcaption>{}</figcaption>\n</figure>\n", escaped(caption))
}

/// The network with the plan marked in it; `None` without a network.
pub(crate) fn network(snapshot: &Snapshot) -> Option<String> {
    drawn(snapshot, None, "Temporal plan network")
}

/// The network with the plan marked in it and an approved one laid over it; `None` without one of them.
pub(crate) fn network_since(snapshot: &Snapshot, approved: &Subject) -> Option<String> {
    let before = windows_before(approved)?;
    drawn(snapshot, Some(&before), "Network of the plan over the approved one")
}

fn drawn(snapshot: &Snapshot, before: Option<&Before>, title: &str) -> Option<String> {
    let network = snapshot.network.as_deref()?;
    let measure = &display::approximate_text_width;
    let options = layout::Options::default();
    let drawing = layout::network(network, &options, measure);
    let plan = snapshot.plan();
    let (mut overlays, mut notes) = (Vec::new(), Vec::new());
    if let Some(plan) = plan {
        overlays.extend(layout::overlay::causal_links(&drawing, network, plan));
        overlays.extend(layout::overlay::orderings(&drawing, network, plan));
        notes.extend(layout::overlay::windows(&drawing, plan, options.window_width, measure));
    }
    let state =
        layout::NetworkState { plan, overlays: &overlays, notes: &notes, parts: layout::Parts::default() };
    let mut list = layout::network_list(&drawing, network, &state);
    let Some((before, plan)) = before.zip(plan) else {
        return Some(display::svg(&[&list], Theme::Light, title));
    };
    let changes = NetworkChanges::new(before, network, plan);
    let changes = changes_list(&drawing, (network, plan), &changes, measure);
    list.frame = changes.frame;
    Some(display::svg(&[&list, &changes], Theme::Light, title))
}
