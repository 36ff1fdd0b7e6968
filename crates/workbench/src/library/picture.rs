//! A picture of a plan, small enough to be kept beside its mission.

use snapshot::Snapshot;

/// Bars that a picture has at most.
const MAX_BARS: usize = 40;

/// The activities of a plan in its earliest schedule, or what it asserts where it has none, each as start, end and row; no two
/// in a row overlap.
pub fn picture(shown: &Snapshot) -> Option<Vec<[u16; 3]>> {
    let (network, plan) = (shown.network.as_deref()?, shown.plan()?);
    let earliest = |node: tpn::NodeId| Some(plan.windows.get(node.index())?.as_ref()?.earliest.to_f64());
    let whole = earliest(network.end).filter(|&whole| whole > 0.0)?;
    let share = |time: f64| (time / whole * 1000.0).clamp(0.0, 1000.0) as u16;
    let bars_of = |kind| -> Vec<[u16; 2]> {
        let such = network.occurrences.iter().filter(|it| it.kind == kind);
        let times = such.filter_map(|it| Some([share(earliest(it.start)?), share(earliest(it.end)?)]));
        times.take(MAX_BARS).collect()
    };
    let mut bars = bars_of(tpn::OccurrenceKind::Primitive);
    if bars.is_empty() {
        bars = bars_of(tpn::OccurrenceKind::Assertion);
    }
    bars.sort_unstable();
    let mut row_ends: Vec<u16> = Vec::new();
    let placed = bars.into_iter().map(|[start, end]| {
        let free = row_ends.iter().position(|&row_end| row_end <= start);
        let row = free.unwrap_or(row_ends.len());
        match row_ends.get_mut(row) {
            Some(row_end) => *row_end = end,
            None => row_ends.push(end),
        }
        [start, end, row as u16]
    });
    Some(placed.collect())
}
