//! The configuration space against independent ways to compute the same: dense samples, brute force over all cells,
//! and flood fill.

use nalgebra::{Isometry2, Point2, Vector2};
use parry2d_f64::shape::{Cuboid, Segment};
use terrain::{
    Cell, CellState, Collision, ConfigurationSpace, GridFrame, Obstacle, Occupancy, Random, Terrain,
    Traversability,
};

fn random_grid(random: &mut Random, density: f64) -> (GridFrame, Vec<bool>) {
    let frame = GridFrame {
        width: 8 + random.below(40),
        height: 8 + random.below(40),
        cell_size_m: 0.5 + random.unit(),
        origin_m: Point2::new(random.range(-50.0, 50.0), random.range(-50.0, 50.0)),
    };
    let occupied = (0..frame.cell_count()).map(|_| random.unit() < density).collect();
    (frame, occupied)
}

fn random_point(frame: &GridFrame, random: &mut Random) -> Point2<f64> {
    frame.to_meters(Point2::new(
        random.unit() * f64::from(frame.width),
        random.unit() * f64::from(frame.height),
    ))
}

/// Meters from a point to the nearest occupied square, over all squares.
fn distance_by_brute_force(frame: &GridFrame, occupied: &[bool], point: Point2<f64>) -> f64 {
    let mut least = f64::INFINITY;
    for (index, _) in occupied.iter().enumerate().filter(|(_, occupied)| **occupied) {
        let center = frame.center_m(frame.cell(index));
        let half = 0.5 * frame.cell_size_m;
        let across = ((point.x - center.x).abs() - half).max(0.0);
        let along = ((point.y - center.y).abs() - half).max(0.0);
        least = least.min((across * across + along * along).sqrt());
    }
    least
}

#[test]
fn clearance_is_the_distance_to_the_nearest_square_less_the_radius() {
    for seed in 0..40 {
        let mut random = Random::from_seed(seed);
        let density = 0.2 * random.unit();
        let (frame, occupied) = random_grid(&mut random, density);
        let radius = 2.0 * random.unit();
        let space = ConfigurationSpace::new(Occupancy::from_obstacles(frame, &occupied), radius);
        for _ in 0..60 {
            let point = random_point(&frame, &mut random);
            let distance = distance_by_brute_force(&frame, &occupied, point);
            let clearance = space.clearance_m(point).unwrap();
            if distance > 0.0 && distance.is_finite() {
                assert!((clearance - (distance - radius)).abs() < 1e-9, "seed {seed} at {point:?}");
            } else if distance == 0.0 {
                assert!(clearance <= -radius, "seed {seed} at {point:?}: {clearance}");
            }
            if (distance - radius).abs() > 1e-7 {
                assert_eq!(space.is_free(point), distance > radius, "seed {seed} at {point:?}");
            }
        }
    }
}

#[test]
fn a_free_segment_is_free_at_every_dense_sample_and_a_blocked_one_comes_too_near_somewhere() {
    let (mut free, mut blocked) = (0, 0);
    for seed in 0..60 {
        let mut random = Random::from_seed(1000 + seed);
        let density = 0.15 * random.unit() * random.unit();
        let (frame, occupied) = random_grid(&mut random, density);
        let radius = if seed % 3 == 0 { 0.0 } else { 2.5 * random.unit() };
        let space = ConfigurationSpace::new(Occupancy::from_obstacles(frame, &occupied), radius);
        for _ in 0..25 {
            let (a, b) = (random_point(&frame, &mut random), random_point(&frame, &mut random));
            let samples = 1500;
            let least = (0..=samples)
                .map(|sample| {
                    let share = f64::from(sample) / f64::from(samples);
                    let point = a + (b - a) * share;
                    distance_by_brute_force(&frame, &occupied, point)
                })
                .fold(f64::INFINITY, f64::min);
            let length = (b - a).norm();
            // Between two samples the distance can be less than at both by at most half their spacing.
            let doubt = 0.5 * length / f64::from(samples);
            if space.is_segment_free(a, b) {
                free += 1;
                assert!(least >= radius - 1e-7, "seed {seed}: {a:?} to {b:?} comes to {least} of {radius}");
                assert!(radius > 0.0 || least > 0.0, "seed {seed}: {a:?} to {b:?} hits");
            } else {
                blocked += 1;
                assert!(
                    least <= radius + doubt,
                    "seed {seed}: {a:?} to {b:?} stays {least} of {radius} away"
                );
            }
        }
    }
    assert!(free > 200 && blocked > 200, "{free} free, {blocked} blocked");
}

/// Meters between a segment and the nearest occupied square, by parry's convex distance.
fn distance_by_parry(frame: &GridFrame, occupied: &[bool], a: Point2<f64>, b: Point2<f64>) -> f64 {
    let half = 0.5 * frame.cell_size_m;
    let square = Cuboid::new(Vector2::new(half, half));
    let segment = Segment::new(a, b);
    occupied
        .iter()
        .enumerate()
        .filter(|(_, occupied)| **occupied)
        .map(|(index, _)| {
            let center = frame.center_m(frame.cell(index));
            let world_from_square = Isometry2::translation(center.x, center.y);
            parry2d_f64::query::distance(&Isometry2::identity(), &segment, &world_from_square, &square)
                .unwrap()
        })
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn a_segment_is_free_exactly_when_parry_measures_at_least_the_radius() {
    let (mut free, mut blocked) = (0, 0);
    for seed in 0..60 {
        let mut random = Random::from_seed(3000 + seed);
        let density = 0.1 * random.unit() * random.unit();
        let (frame, occupied) = random_grid(&mut random, density);
        let radius = 0.1 + 2.0 * random.unit();
        let space = ConfigurationSpace::new(Occupancy::from_obstacles(frame, &occupied), radius);
        for _ in 0..30 {
            let (a, b) = (random_point(&frame, &mut random), random_point(&frame, &mut random));
            let distance = distance_by_parry(&frame, &occupied, a, b);
            // parry iterates to a tolerance.
            if (distance - radius).abs() < 1e-6 {
                continue;
            }
            let found = space.is_segment_free(a, b);
            assert_eq!(
                found,
                distance > radius,
                "seed {seed}: {a:?} to {b:?}, {distance} m, radius {radius}"
            );
            if found { free += 1 } else { blocked += 1 }
        }
    }
    assert!(free > 200 && blocked > 200, "{free} free, {blocked} blocked");
}

#[test]
fn a_segment_is_free_in_both_directions_or_in_neither() {
    for seed in 0..40 {
        let mut random = Random::from_seed(2000 + seed);
        let (frame, occupied) = random_grid(&mut random, 0.05);
        let space = ConfigurationSpace::new(Occupancy::from_obstacles(frame, &occupied), random.unit());
        for _ in 0..50 {
            let (a, b) = (random_point(&frame, &mut random), random_point(&frame, &mut random));
            assert_eq!(space.is_segment_free(a, b), space.is_segment_free(b, a), "seed {seed}: {a:?} {b:?}");
        }
    }
}

#[test]
fn the_least_clearance_of_a_segment_agrees_with_dense_samples() {
    let mut random = Random::from_seed(31);
    let (frame, occupied) = random_grid(&mut random, 0.03);
    let space = ConfigurationSpace::new(Occupancy::from_obstacles(frame, &occupied), 0.4);
    for _ in 0..60 {
        let (a, b) = (random_point(&frame, &mut random), random_point(&frame, &mut random));
        let sampled = (0..=2000)
            .map(|sample| {
                let share = f64::from(sample) / 2000.0;
                space.clearance_m(a + (b - a) * share).unwrap()
            })
            .fold(f64::INFINITY, f64::min);
        let found = space.segment_clearance_m(a, b).unwrap();
        if sampled > -0.4 {
            assert!((found - sampled).abs() < 0.03 * frame.cell_size_m, "{found} instead of {sampled}");
        }
    }
}

#[test]
fn a_point_vehicle_does_not_slip_between_cells_that_share_a_corner() {
    let frame = GridFrame::new(4, 4, 1.0);
    let mut occupied = vec![false; 16];
    occupied[frame.index(Cell { column: 1, row: 2 })] = true;
    occupied[frame.index(Cell { column: 2, row: 1 })] = true;
    let space = ConfigurationSpace::new(Occupancy::from_obstacles(frame, &occupied), 0.0);
    assert!(!space.is_segment_free(Point2::new(1.5, 1.5), Point2::new(2.5, 2.5)));
    assert!(!space.is_segment_free(Point2::new(2.5, 2.5), Point2::new(1.5, 1.5)));
    assert!(space.is_segment_free(Point2::new(0.5, 1.5), Point2::new(1.99, 1.5)));
}

#[test]
fn a_point_on_the_west_border_of_a_free_cell_belongs_to_it() {
    let frame = GridFrame::new(3, 3, 1.0);
    let mut occupied = vec![false; 9];
    occupied[frame.index(Cell { column: 0, row: 1 })] = true;
    let space = ConfigurationSpace::new(Occupancy::from_obstacles(frame, &occupied), 0.0);
    assert!(space.is_free(Point2::new(1.0, 1.0)));
    assert!(space.is_segment_free(Point2::new(1.0, 0.0), Point2::new(1.0, 3.0)));
    assert!(!space.is_segment_free(Point2::new(1.5, 1.5), Point2::new(0.9, 1.5)));
}

#[test]
fn the_borders_of_the_map_can_be_reached_but_not_left() {
    let space = ConfigurationSpace::new(Occupancy::free(GridFrame::new(7, 5, 0.6)), 0.5);
    let far = space.frame().far_corner_m();
    assert!(space.is_segment_free(Point2::origin(), far));
    assert!(space.is_segment_free(far, Point2::new(0.0, far.y)));
    assert!(!space.is_segment_free(Point2::origin(), far + Vector2::new(0.01, 0.0)));
    assert_eq!(space.collision_at(Point2::new(-1.0, 0.0)), Some(Collision::OutsideMap));
    assert_eq!(space.clearance_m(Point2::new(1.0, 1.0)), Some(f64::INFINITY));
}

#[test]
fn what_is_in_the_way_is_named() {
    let frame = GridFrame::new(20, 20, 0.5);
    let mut occupancy = Occupancy::free(frame);
    occupancy.mark(&Obstacle::Circle { center_m: Point2::new(5.0, 5.0), radius_m: 1.0 }, CellState::Obstacle);
    let space = ConfigurationSpace::new(occupancy, 0.5);
    let Some(Collision::Cell { state, .. }) = space.collision_at(Point2::new(6.6, 5.1)) else {
        panic!("free")
    };
    assert_eq!(state, CellState::Obstacle);
    assert_eq!(space.collision_at(Point2::new(8.0, 8.0)), None);
}

/// A square wall around the middle of a map, with a gap of some cells in its north side.
fn fortress(gap_cells: u32) -> (GridFrame, Vec<bool>) {
    let frame = GridFrame::new(40, 40, 1.0);
    let mut occupied = vec![false; frame.cell_count()];
    for step in 10..=30 {
        for cell in [(step, 10), (step, 30), (10, step), (30, step)] {
            occupied[frame.index(Cell { column: cell.0, row: cell.1 })] = true;
        }
    }
    for column in 20..20 + gap_cells {
        occupied[frame.index(Cell { column, row: 30 })] = false;
    }
    (frame, occupied)
}

#[test]
fn a_closed_wall_separates_and_an_open_one_does_not() {
    for (gap_cells, radius, separated) in
        [(0, 0.0, true), (0, 0.4, true), (1, 0.0, false), (1, 0.45, false), (3, 1.4, false), (3, 1.0, false)]
    {
        let (frame, occupied) = fortress(gap_cells);
        let space = ConfigurationSpace::new(Occupancy::from_obstacles(frame, &occupied), radius);
        let (inside, outside) = (Point2::new(20.5, 20.5), Point2::new(3.0, 3.0));
        assert_eq!(space.are_separated(inside, outside), separated, "gap {gap_cells}, radius {radius}");
        assert_eq!(
            space.are_separated_finely(inside, outside),
            separated,
            "gap {gap_cells}, radius {radius}"
        );
        assert!(!space.are_separated(outside, Point2::new(37.0, 37.0)));
    }
}

#[test]
fn a_gap_too_narrow_for_the_vehicle_separates() {
    for (gap_cells, radius) in [(1, 0.7), (2, 1.2), (3, 1.75)] {
        let (frame, occupied) = fortress(gap_cells);
        let space = ConfigurationSpace::new(Occupancy::from_obstacles(frame, &occupied), radius);
        assert!(
            space.are_separated_finely(Point2::new(20.5, 20.5), Point2::new(3.0, 3.0)),
            "gap {gap_cells}, radius {radius}"
        );
    }
}

#[test]
fn cells_that_only_share_corners_close_a_ring() {
    let frame = GridFrame::new(9, 9, 1.0);
    let mut occupied = vec![false; 81];
    for step in 0_u32..=3 {
        for (column, row) in
            [(4 - step, 1 + step), (4 + step, 1 + step), (4 - step, 7 - step), (4 + step, 7 - step)]
        {
            occupied[frame.index(Cell { column, row })] = true;
        }
    }
    let space = ConfigurationSpace::new(Occupancy::from_obstacles(frame, &occupied), 0.0);
    assert!(space.are_separated(Point2::new(4.5, 4.5), Point2::new(0.5, 0.5)));
}

/// The planner and the review ask the same question: what is free is not too steep, to the last bit.
#[test]
fn a_way_through_free_cells_is_never_steeper_than_the_vehicle_climbs() {
    const MAX_GRADE: f64 = 0.364;
    let (mut free, mut steepest) = (0, 0.0_f64);
    for seed in 0..20 {
        let mut random = Random::from_seed(seed);
        let frame = GridFrame::new(40, 40, 0.6);
        let heights = (0..frame.cell_count()).map(|_| random.range(0.0, 0.6) as f32).collect();
        let terrain = Terrain::new(frame, heights);
        let ground = Traversability::Ground { max_grade: MAX_GRADE, rock_diameter_m: 0.5 };
        let space = ConfigurationSpace::new(Occupancy::of_terrain(&terrain, &[], &ground), 0.3);
        for _ in 0..2000 {
            let from = Point2::new(random.range(0.0, 24.0), random.range(0.0, 24.0));
            let to = from + Vector2::new(random.range(-4.0, 4.0), random.range(-4.0, 4.0));
            if space.is_segment_free(from, to) {
                free += 1;
                let slope_rad = terrain.steepest_slope_rad(&[from, to]);
                assert!(
                    slope_rad <= MAX_GRADE.atan() + 1e-12,
                    "seed {seed}: {slope_rad} from {from} to {to}"
                );
                steepest = steepest.max(slope_rad);
            }
        }
    }
    assert!(free > 100 && steepest > 0.9 * MAX_GRADE.atan(), "{free} ways, up to {steepest}");
}

#[test]
fn the_slope_of_a_way_is_that_of_the_ramp_that_it_crosses() {
    let frame = GridFrame::new(40, 40, 0.5);
    // Level, then a ramp of 3 in 10 from 10 to 15 m east, then level again.
    let height = |index: usize| (0.3 * ((index % 40) as f64 * 0.5 - 10.0).clamp(0.0, 5.0)) as f32;
    let terrain = Terrain::new(frame, (0..frame.cell_count()).map(height).collect());
    let slope = |points: &[[f64; 2]]| {
        let points: Vec<Point2<f64>> = points.iter().copied().map(Point2::from).collect();
        terrain.steepest_slope_rad(&points)
    };
    assert_eq!(slope(&[[1.0, 5.0], [8.0, 15.0]]), 0.0);
    assert!((slope(&[[1.0, 5.0], [19.0, 15.0]]) - 0.3_f64.atan()).abs() < 1e-6);
    assert!((slope(&[[12.0, 2.0], [12.0, 18.0]]) - 0.3_f64.atan()).abs() < 1e-6, "along it, it is as steep");
    assert!((slope(&[[12.0, 2.0]]) - 0.3_f64.atan()).abs() < 1e-6, "so it is for a vehicle that stands");
}
