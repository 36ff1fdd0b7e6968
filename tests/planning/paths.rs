//! Paths in the network (SPEC 7.3), by the worked example there.

use acceptance::mission::{first_plan, network};
use exact::{Rational, Time};
use kirk::Search;
use serde::Deserialize as _;
use serde_json::{Value, json};
use tpn::path::{PathError, PathLeg, TraversePath, insert_path};
use tpn::plan_json::plan_to_json;
use tpn::{ArcKind, Network, OccurrenceId};

/// The network with a path inserted.
pub(crate) fn with_path(
    network: &Network,
    path: &TraversePath,
    unit_seconds: i64,
) -> Result<Network, PathError> {
    let mut network = network.clone();
    insert_path(&mut network, path, unit_seconds)?;
    Ok(network)
}

fn enroute() -> Network {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("conformance/t01_enroute_scenario.rmpl");
    network(&std::fs::read_to_string(path).expect("the case is there"))
}

fn traverse(network: &Network, name: &str) -> OccurrenceId {
    let index =
        network.occurrences.iter().position(|occurrence| occurrence.name == name).expect("the traverse");
    OccurrenceId::from_index(index)
}

fn legs(lengths: &[&[f64]]) -> Vec<PathLeg> {
    lengths
        .iter()
        .map(|lengths| PathLeg { segment_lengths_m: lengths.to_vec(), ..PathLeg::default() })
        .collect()
}

fn spec_path(network: &Network, lengths: &[&[f64]], may_stop: bool) -> TraversePath {
    TraversePath {
        occurrence: traverse(network, "Group-Traverse-Path#1"),
        legs: legs(lengths),
        speed_mps: (Rational::new(45, 1000).expect("a speed"), Rational::new(5, 100).expect("a speed")),
        may_stop,
    }
}

fn nearest_thousandth(time: Time) -> i64 {
    let half = Time::new(1, 2000).and_then(|half| time.checked_add(half));
    half.and_then(|time| time.integer_parts(1000)).expect("a small time")
}

/// A time of a window, rounded to thousandths of a minute for comparison with the printed table.
fn thousandths(value: &Value) -> i64 {
    nearest_thousandth(Time::deserialize(value).expect("an exact time"))
}

#[test]
fn the_worked_example_has_its_waypoint_windows() {
    let before = enroute();
    let path = spec_path(&before, &[&[300.0], &[500.0], &[415.0]], false);
    let network = with_path(&before, &path, 60).expect("a path");
    assert_eq!((network.nodes.len(), network.arcs.len()), (before.nodes.len() + 2, before.arcs.len() + 3));
    let durations: Vec<(i64, i64)> = (network.arcs.iter())
        .filter(|arc| arc.kind == ArcKind::Path)
        .map(|arc| {
            let upper = arc.upper.finite().expect("it may not stop");
            (nearest_thousandth(arc.lower), nearest_thousandth(upper))
        })
        .collect();
    assert_eq!(durations, [(100_000, 111_111), (166_667, 185_185), (138_333, 153_704)]);
    for search in [Search::Chronological, Search::ConflictDirected] {
        let outcome = first_plan(&network, search);
        let plan = plan_to_json(&network, &outcome.plans[0]);
        let window = |event: &str| {
            let window = &plan["windows"][event];
            (thousandths(&window[0]), thousandths(&window[1]))
        };
        assert_eq!(window("Group-Traverse-Path#1.leg1.vertex1"), (110_000, 155_000));
        assert_eq!(window("Group-Traverse-Path#1.leg2.vertex1"), (276_667, 321_667));
        // The path says no more than the traverse already did.
        assert_eq!(plan["windows"]["Group-Traverse-Path#1.start"], json!([10, 55]));
        assert_eq!(plan["windows"]["Group-Traverse-Path#1.end"], json!([415, 460]));
    }
}

#[test]
fn every_id_of_the_network_stays_valid() {
    let before = enroute();
    let path = spec_path(&before, &[&[100.0, 200.0], &[500.0], &[15.0, 200.0, 200.0]], true);
    let after = with_path(&before, &path, 60).expect("a path");
    // Six segments: five new events, named by leg and vertex; the last vertex is the traverse's end.
    assert_eq!(after.nodes.len(), before.nodes.len() + 5);
    assert_eq!(after.arcs.len(), before.arcs.len() + 6);
    let names: Vec<String> = (after.nodes[before.nodes.len()..].iter())
        .flat_map(|node| &node.events)
        .map(|&event| after.event_name(event))
        .collect();
    let expected = ["leg1.vertex1", "leg1.vertex2", "leg2.vertex1", "leg3.vertex1", "leg3.vertex2"];
    assert_eq!(names, expected.map(|vertex| format!("Group-Traverse-Path#1.{vertex}")));
    for (index, arc) in before.arcs.iter().enumerate() {
        let same = &after.arcs[index];
        assert_eq!((same.from, same.to, same.lower, same.upper), (arc.from, arc.to, arc.lower, arc.upper));
        assert_eq!((&same.labels, same.occurrence, same.choice), (&arc.labels, arc.occurrence, arc.choice));
    }
    assert_eq!((&after.labels, &after.decisions), (&before.labels, &before.decisions));
    // The arc of the traverse spans the path and still carries the condition.
    let spanning = &after.arcs
        [after.occurrences[traverse(&after, "Group-Traverse-Path#1").index()].arc.expect("an arc").index()];
    assert_eq!((spanning.kind, spanning.labels.len()), (ArcKind::Span, 1));
    assert!(
        after
            .arcs
            .iter()
            .filter(|arc| arc.kind == ArcKind::Path)
            .all(|arc| arc.upper == exact::Bound::Infinite)
    );
}

#[test]
fn a_path_that_takes_too_long_fails_its_alternative() {
    let before = enroute();
    // 1,464 m at 0.05 m/s are 488 minutes, above 486.
    let path = spec_path(&before, &[&[1464.0]], true);
    let network = with_path(&before, &path, 60).expect("a path");
    assert!(first_plan(&network, Search::Chronological).plans.is_empty());
    assert!(first_plan(&network, Search::ConflictDirected).plans.is_empty());
}

#[test]
fn seconds_are_thousandths_of_a_millisecond_count() {
    let before = network("option time_unit = second;\nscenario S = { Drive(A)[0,inf] }");
    let path = TraversePath {
        occurrence: traverse(&before, "Drive#1"),
        legs: legs(&[&[10.0]]),
        speed_mps: (Rational::ZERO, Rational::from(3)),
        may_stop: false,
    };
    let after = with_path(&before, &path, 1).expect("a path");
    let arc = after.arcs.last().expect("an arc");
    // 10 / 3 s, rounded up to the millisecond; at speed zero there is no greatest duration.
    assert_eq!((arc.lower, arc.upper), (Time::new(3334, 1000).expect("a fraction"), exact::Bound::Infinite));
}

#[test]
fn a_slope_that_slows_the_rover_down_makes_its_segment_longer_in_time() {
    let before = enroute();
    let mut path = spec_path(&before, &[&[300.0, 500.0], &[415.0]], false);
    // 300 m at 0.04 m/s are 125 minutes, more than the 111 at the least speed; 500 m at 0.048 are 173.611 minutes.
    path.legs[0].slope_speeds_mps = vec![Some(0.04), Some(0.048)];
    let after = with_path(&before, &path, 60).expect("a path");
    let durations: Vec<(i64, i64)> = (after.arcs.iter())
        .filter(|arc| arc.kind == ArcKind::Path)
        .map(|arc| (arc.lower, arc.upper.finite().expect("it may not stop")))
        .map(|(lower, upper)| {
            let thousandths = nearest_thousandth;
            (thousandths(lower), thousandths(upper))
        })
        .collect();
    assert_eq!(durations, [(125_000, 125_000), (173_611, 185_185), (138_333, 153_704)]);
}

#[test]
fn what_is_no_path_is_refused() {
    let network = enroute();
    let good = spec_path(&network, &[&[300.0]], false);
    let refused = |path: TraversePath| with_path(&network, &path, 60).expect_err("no path");
    assert_eq!(refused(TraversePath { legs: Vec::new(), ..good.clone() }), PathError::Empty);
    assert_eq!(
        refused(TraversePath { occurrence: OccurrenceId(9999), ..good.clone() }),
        PathError::NoTraverse
    );
    assert!(matches!(
        refused(TraversePath { legs: legs(&[&[f64::NAN]]), ..good.clone() }),
        PathError::Length(_)
    ));
    let still = (Rational::ZERO, Rational::ZERO);
    assert!(matches!(refused(TraversePath { speed_mps: still, ..good }), PathError::Speed(..)));
}
