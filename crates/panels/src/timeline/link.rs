//! Causal links and orderings between bars: what is pointed at, and what is chosen.

use display::Point;
use display::geometry::distance_point_curve;
use egui::Pos2;
use layout::list::timeline::LinkCurve;
use layout::timeline::{Link, LinkKind};
use tpn::Network;
use workbench::state::Selection;

use super::paint::Painting;

/// How near the pointer must be.
const REACH: f64 = 5.0;

/// The link under the pointer.
pub(super) fn at<'a>(curves: &[LinkCurve<'a>], pointer: Pos2) -> Option<&'a Link> {
    let pointer = Point::new(f64::from(pointer.x), f64::from(pointer.y));
    let distance = |curve: &LinkCurve<'_>| distance_point_curve(pointer, curve.start, &[curve.piece]);
    let nearest = curves.iter().map(|curve| (distance(curve), curve.link));
    nearest.filter(|(distance, _)| *distance <= REACH).min_by(|a, b| a.0.total_cmp(&b.0)).map(|it| it.1)
}

/// Returns what a click on a link selects.
pub(super) fn selection(kind: LinkKind, network: &Network) -> Selection {
    match kind {
        LinkKind::Causal(link) => Selection::Link(link),
        LinkKind::Ordering(ordering) => Selection::Ordering(ordering),
        LinkKind::UseOrdering(ordering) => {
            let later = network.uses.get(ordering.then.index()).and_then(|used| used.owner);
            later.map_or(Selection::None, Selection::Occurrence)
        }
    }
}

/// Returns what a link is called.
pub(super) fn name(kind: LinkKind, network: &Network) -> String {
    match kind {
        LinkKind::UseOrdering(ordering) => {
            let [first, then] = [ordering.first, ordering.then].map(|used| network.use_name(used));
            network.readable(&format!("{first} before {then}"))
        }
        _ => selection(kind, network).title(Some(network)),
    }
}

/// Returns whether a link, or a bar at one of its ends, is selected or pointed at.
pub(super) fn is_chosen(painting: &Painting<'_>, link: &Link) -> bool {
    let (state, own) = (painting.context.state, selection(link.kind, painting.network));
    let touches = |chosen: &Selection| {
        let owners = [link.from.1, link.to.1].map(|bar| painting.chart.bars[bar].occurrence);
        *chosen == own || owners.into_iter().flatten().any(|owner| *chosen == Selection::Occurrence(owner))
    };
    touches(&state.selection) || touches(&state.hovered)
}
