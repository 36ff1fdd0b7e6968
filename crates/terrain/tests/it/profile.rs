//! The ground between two places: lengths of ground whose shape is known.

use nalgebra::Point2;
use terrain::{GridFrame, Terrain};

/// A plain of 100 m with a wall 10 m high across it, from 48 m to 52 m east.
fn walled() -> Terrain {
    let frame = GridFrame::new(100, 100, 1.0);
    let heights = (0..100 * 100).map(|index| if (48..52).contains(&(index % 100)) { 10.0 } else { 0.0 });
    Terrain::new(frame, heights.collect())
}

/// Ground that rises by 0.75 m for each meter east.
fn slope() -> Terrain {
    let frame = GridFrame::new(100, 100, 1.0);
    Terrain::new(frame, (0..100 * 100).map(|index| (index % 100) as f32 * 0.75).collect())
}

#[test]
fn on_an_even_slope_ground_and_straight_line_are_equally_long() {
    // 40 m east and 30 m up are 50 m.
    let profile = slope().profile(Point2::new(10.5, 20.5), Point2::new(50.5, 20.5)).expect("on the map");
    assert!((profile.straight_m - 50.0).abs() < 1e-6, "{}", profile.straight_m);
    assert!((profile.ground_m - 50.0).abs() < 1e-6, "{}", profile.ground_m);
    assert!((profile.climb_m[0] - 30.0).abs() < 1e-6 && profile.climb_m[1] == 0.0, "{:?}", profile.climb_m);
    assert!((profile.slope_max_rad - 0.75_f64.atan()).abs() < 1e-6);
    assert_eq!(profile.points_m.first(), Some(&Point2::new(0.0, 7.5)));
}

#[test]
fn over_a_wall_the_ground_is_longer_by_going_up_and_down() {
    let profile = walled().profile(Point2::new(20.5, 50.5), Point2::new(80.5, 50.5)).expect("on the map");
    assert!((profile.straight_m - 60.0).abs() < 1e-9);
    assert!((profile.climb_m[0] - 10.0).abs() < 1e-6 && (profile.climb_m[1] - 10.0).abs() < 1e-6);
    // Each flank leads 10 m up within one meter.
    let expected = 58.0 + 2.0 * 101.0_f64.sqrt();
    assert!((profile.ground_m - expected).abs() < 0.01, "{} {expected}", profile.ground_m);
}

#[test]
fn places_outside_the_map_have_no_profile() {
    assert_eq!(slope().profile(Point2::new(-1.0, 5.0), Point2::new(5.0, 5.0)), None);
}
