//! A small network whose windows and negative cycle can be worked out by hand.

use stn::{Inconsistency, PointId, Stn, Tag};

/// Z, A to D: `(from, weight, to)` means `to − from ≤ weight`.
const EDGES: [(u32, i64, u32); 8] =
    [(0, 12, 1), (1, 5, 2), (2, 3, 1), (2, 7, 0), (4, 6, 0), (4, 11, 3), (3, 9, 4), (1, 4, 3)];

fn network(edges: &[(u32, i64, u32)]) -> (Stn, Result<(), Inconsistency>) {
    let mut stn = Stn::new(5);
    let result = (0..)
        .zip(edges)
        .try_for_each(|(tag, &(from, weight, to))| stn.insert(PointId(from), PointId(to), weight, tag));
    (stn, result)
}

#[test]
fn windows_are_relative_to_a_point() {
    let (mut stn, consistent) = network(&EDGES);
    assert_eq!(consistent, Ok(()));
    let windows = stn.windows(PointId(0)).expect("small numbers");
    // A − Z ≤ 12; Z − A ≤ 5 + 7 by way of B, so A − Z ≥ −12.
    assert_eq!((windows[1].earliest, windows[1].latest), (Some(-12), Some(12)));
    assert_eq!((windows[2].earliest, windows[2].latest), (Some(-7), Some(17)));
}

#[test]
fn a_negative_cycle_names_its_edges() {
    let mut edges = EDGES;
    (edges[0].1, edges[3].1) = (-4, -3);
    let (stn, consistent) = network(&edges);
    assert_eq!(consistent, Err(Inconsistency::NegativeCycle));
    let mut tags: Vec<Tag> = stn.cycle().iter().map(|edge| edge.tag).collect();
    tags.sort_unstable();
    // Z → A (−4), A → B (5), B → Z (−3) weighs −2.
    assert_eq!(tags, [0, 1, 3]);
}
