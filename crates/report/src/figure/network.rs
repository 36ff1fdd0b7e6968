//! The network with the plan marked in it: whole where it fits on a sheet, otherwise whole on the screen, and on paper an
//! overview and what deserves a look.

use display::Theme;
use layout::list::network_before::{NetworkChanges, changes_list};
use layout::timeline::before::Before;
use layout::{BlockForm, NetworkDrawing, Options, OverlayCurve, OverlayKind, Room};
use review::record::Subject;
use review::{Review, Section, Status};
use snapshot::Snapshot;
use tpn::{LabelId, Network, NodeId, Plan};

use super::sheet::{Figure, HEIGHT, Medium, WIDTH};
use super::windows_before;

/// Sheets of a network on paper, the overview included.
const MAX_SHEETS: usize = 5;

/// A box has a sheet of its own if that shows events that no other does: one among so many at least.
const MIN_NEWS: usize = 5;

const ROOM: Room = Room { width: WIDTH, height: HEIGHT };

/// Something of the network that a sheet of its own may show.
struct Detail {
    words: String,
    nodes: Vec<NodeId>,
}

/// The network with the plan marked in it, and where it is too large for a sheet, what of the review's lines has not
/// passed in detail. Nothing without a network.
pub(crate) fn network(snapshot: &Snapshot, review: &Review) -> Vec<Figure> {
    let details = [Status::Failed, Status::Attention].into_iter().flat_map(|wanted| {
        let lines = Section::ALL.iter().flat_map(|&section| review.lines(section));
        lines
            .filter(move |line| line.status == wanted && !line.nodes.is_empty())
            .map(|line| Detail { words: line.text.clone(), nodes: line.nodes.clone() })
    });
    let caption = "Bold: selected by the plan. Numbers below events: time windows.";
    drawn(snapshot, None, ("Temporal plan network", caption), details)
}

/// The network with the plan marked in it and an approved one laid over it; nothing without one of them.
pub(crate) fn network_since(snapshot: &Snapshot, approved: &Subject) -> Vec<Figure> {
    let (Some(before), Some(network), Some(plan)) =
        (windows_before(approved), snapshot.network.as_deref(), snapshot.plan())
    else {
        return Vec::new();
    };
    let changes = NetworkChanges::new(&before, network, plan).changes;
    let details = changes.iter().map(|(occurrence, _)| {
        let occurrence = &network.occurrences[occurrence.index()];
        Detail { words: network.readable(&occurrence.name), nodes: vec![occurrence.start, occurrence.end] }
    });
    let caption = "“new”: not in the approved plan. Dashed, with “was”: different times in the approved plan. Crossed out: \
                   no longer in the plan.";
    drawn(snapshot, Some(&before), ("Network of the plan over the approved one", caption), details)
}

fn drawn(
    snapshot: &Snapshot,
    before: Option<&Before>,
    (title, caption): (&str, &str),
    details: impl Iterator<Item = Detail>,
) -> Vec<Figure> {
    let Some(network) = snapshot.network.as_deref() else { return Vec::new() };
    let figure = |drawing: &NetworkDrawing, caption: String, medium: Medium| Figure {
        drawing: svg(snapshot, network, drawing, before, title),
        caption,
        medium,
    };
    let whole = layout::network(network, &Options::default(), &display::approximate_text_width);
    if whole.bounds.width() <= WIDTH && whole.bounds.height() <= HEIGHT {
        return vec![figure(&whole, caption.to_owned(), Medium::Everywhere)];
    }
    let mut figures = vec![figure(&whole, caption.to_owned(), Medium::Screen)];
    for (words, sheet) in sheets(network, details) {
        let rest = if sheet.blocks.iter().any(|block| block.form == BlockForm::Collapsed) {
            format!(
                " {} of {} events are drawn; boxes replace the rest. Open this file on a screen for the complete drawing.",
                sheet.nodes.len(),
                network.nodes.len()
            )
        } else {
            String::new()
        };
        let caption = words.map_or_else(|| caption.to_owned(), |words| format!("In detail: {words}."));
        figures.push(figure(&sheet, format!("{caption}{rest}"), Medium::Paper));
    }
    figures
}

/// An overview, the details that it does not show, and as long as there are sheets its boxes, each with its words.
fn sheets(network: &Network, details: impl Iterator<Item = Detail>) -> Vec<(Option<String>, NetworkDrawing)> {
    let options = Options::default();
    let measure = &display::approximate_text_width;
    let fitted = |focus| layout::fitted(network, &options, focus, ROOM, measure);
    let mut sheets = vec![(None, fitted(None))];
    for detail in details {
        if sheets.len() == MAX_SHEETS {
            break;
        }
        let is_shown = |drawing: &NetworkDrawing| detail.nodes.iter().all(|&it| drawing.node(it).is_some());
        if sheets.iter().any(|(_, drawing)| is_shown(drawing)) {
            continue;
        }
        let openings = layout::openings(network, &options, None, Some(ROOM), &detail.nodes, measure);
        let drawing = fitted(openings.last().copied());
        // What is too far apart for one sheet is in none.
        if is_shown(&drawing) {
            sheets.push((Some(detail.words), drawing));
        }
    }
    let boxes = sheets[0].1.blocks.iter().filter(|it| it.form == BlockForm::Collapsed);
    let boxes: Vec<_> = boxes.map(|it| (it.block.zip(it.last), it.title.to_string())).collect();
    for (focus, title) in boxes {
        if sheets.len() == MAX_SHEETS {
            break;
        }
        let drawing = fitted(focus);
        let is_new = |node: NodeId| sheets.iter().all(|(_, other)| other.node(node).is_none());
        let news = drawing.nodes.iter().filter(|node| is_new(node.id)).count();
        if news * MIN_NEWS >= network.nodes.len().min(drawing.nodes.len()) {
            sheets.push((Some(title), drawing));
        }
    }
    sheets
}

fn svg(
    snapshot: &Snapshot,
    network: &Network,
    drawing: &NetworkDrawing,
    before: Option<&Before>,
    title: &str,
) -> String {
    let measure = &display::approximate_text_width;
    let plan = snapshot.plan();
    let (mut overlays, mut notes) = (Vec::new(), Vec::new());
    if let Some(plan) = plan {
        overlays.extend(layout::overlay::causal_links(drawing, network, plan));
        overlays.extend(layout::overlay::orderings(drawing, network, plan));
        overlays.retain(|curve| has_drawn_end(curve, drawing, (network, plan)));
        notes.extend(layout::overlay::windows(drawing, plan, Options::default().window_width, measure));
    }
    let state =
        layout::NetworkState { plan, overlays: &overlays, notes: &notes, parts: layout::Parts::default() };
    let mut list = layout::network_list(drawing, network, &state);
    let Some((before, plan)) = before.zip(plan) else {
        return display::svg(&[&list], Theme::Light, title);
    };
    let changes = NetworkChanges::new(before, network, plan);
    let changes = changes_list(drawing, (network, plan), &changes, measure);
    list.frame = changes.frame;
    display::svg(&[&list, &changes], Theme::Light, title)
}

/// Returns whether one end of a causal link or an ordering at least is not a box: between boxes they would only hide
/// the rest.
fn has_drawn_end(curve: &OverlayCurve, drawing: &NetworkDrawing, (network, plan): (&Network, &Plan)) -> bool {
    let number = curve.number as usize;
    let ends = match curve.kind {
        OverlayKind::CausalLink => {
            let from = |label: LabelId| network.arcs[network.labels[label.index()].arc.index()].from;
            plan.causal_links.get(number).map(|link| [link.tell, link.ask].map(from))
        }
        _ => match plan.orderings_added.get(number) {
            Some(ordering) => Some([network.interval(ordering.first).1, network.interval(ordering.then).0]),
            None => plan.uses_ordered.get(number - plan.orderings_added.len()).map(|ordering| {
                let precedence = ordering.precedence(network);
                [precedence.earlier, precedence.later]
            }),
        },
    };
    ends.is_some_and(|ends| ends.into_iter().any(|node| drawing.node(node).is_some()))
}
