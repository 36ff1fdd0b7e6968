//! Lines of sight over ground whose shape is known, and over random ground against many samples.

use nalgebra::Point2;
use terrain::{GridFrame, Random, Terrain};

/// A plain of 100 m with a wall across it, from 48 m to 52 m east.
fn walled(height_m: f32) -> Terrain {
    let frame = GridFrame::new(100, 100, 1.0);
    let heights = (0..100 * 100).map(|index| if (48..52).contains(&(index % 100)) { height_m } else { 0.0 });
    Terrain::new(frame, heights.collect())
}

/// A plain with a crest 10 m high at 50.5 m east, whose flanks are one meter wide.
fn crested() -> Terrain {
    let heights = (0..100 * 100).map(|index| if index % 100 == 50 { 10.0 } else { 0.0 });
    Terrain::new(GridFrame::new(100, 100, 1.0), heights.collect())
}

fn is_clear(ground: &Terrain, ends: [[f64; 2]; 2], heights_m: [f64; 2]) -> bool {
    let sight = ground.line_of_sight(ends[0].into(), ends[1].into(), heights_m).expect("on the map");
    sight.blocked_at_m.is_none()
}

#[test]
fn a_wall_hides_what_is_behind_it_and_its_near_flank_is_told() {
    let ground = walled(10.0);
    let (west, east) = (Point2::new(20.5, 50.5), Point2::new(80.5, 50.5));
    let at = ground.line_of_sight(west, east, [1.5, 1.5]).expect("on the map").blocked_at_m.expect("hidden");
    // The flank rises from 0 to 10 m between the centers at 47.5 m and 48.5 m.
    assert!((at.x - 47.65).abs() < 1e-9 && (at.y - 50.5).abs() < 1e-9 && (at.z - 1.5).abs() < 1e-9, "{at}");
    let back = ground.line_of_sight(east, west, [1.5, 1.5]).expect("on the map").blocked_at_m;
    assert!((back.expect("hidden").x - 52.35).abs() < 1e-9);
}

#[test]
fn one_side_and_eyes_above_the_wall_are_clear() {
    let ground = walled(10.0);
    assert!(is_clear(&ground, [[20.5, 20.5], [40.5, 80.5]], [1.5, 1.5]));
    assert!(is_clear(&ground, [[20.5, 50.5], [80.5, 50.5]], [10.5, 10.5]));
    assert!(is_clear(&ground, [[20.5, 50.5], [50.5, 50.5]], [1.5, 1.5]), "the top of the wall is seen");
}

#[test]
fn heights_of_both_ends_count_and_touching_is_clear() {
    let ground = walled(10.0);
    let ends = [[0.5, 50.5], [99.5, 50.5]];
    // The line touches the edges of the wall's top at 10 m from both sides.
    assert!(is_clear(&ground, ends, [10.0, 10.0]));
    assert!(!is_clear(&ground, ends, [9.999, 10.0]) && !is_clear(&ground, ends, [10.0, 9.999]));
    // From 2 m on the west, the line over the near edge at 48.5 m is at 18.5 m in the east.
    assert!(is_clear(&ground, ends, [2.0, 18.6]) && !is_clear(&ground, ends, [2.0, 18.4]));
    assert!(is_clear(&ground, [ends[1], ends[0]], [18.6, 2.0]));
}

#[test]
fn a_crest_between_samples_hides() {
    // Half a cell apart from this place, samples of the crest come to 7.5 m at most.
    let ground = crested();
    assert!(!is_clear(&ground, [[20.25, 50.5], [80.25, 50.5]], [8.0, 8.0]));
    assert!(is_clear(&ground, [[20.25, 50.5], [80.25, 50.5]], [10.0, 10.0]));
}

#[test]
fn where_there_is_no_height_nothing_is_in_the_way() {
    let heights = (0..100 * 100).map(|index| if (40..60).contains(&(index % 100)) { f32::NAN } else { 0.0 });
    let ground = Terrain::new(GridFrame::new(100, 100, 1.0), heights.collect());
    assert!(is_clear(&ground, [[20.5, 50.5], [80.5, 50.5]], [0.5, 0.5]));
    let (on, off) = (Point2::new(20.5, 50.5), Point2::new(50.5, 50.5));
    assert_eq!(ground.line_of_sight(on, off, [1.0, 1.0]), None, "the other end has no height");
    assert_eq!(ground.line_of_sight(on, Point2::new(20.5, 200.0), [1.0, 1.0]), None);
    assert!(is_clear(&ground, [[20.5, 50.5], [20.5, 50.5]], [1.0, 2.0]), "a place sees what is above it");
}

/// Random ground of random roughness, with cells without height and with cells that are obstacles.
fn random_ground(random: &mut Random) -> Terrain {
    let frame = GridFrame { width: 14, height: 11, cell_size_m: 0.6, origin_m: Point2::new(-3.0, 7.0) };
    let roughness = random.unit();
    let count = frame.cell_count();
    let mut heights: Vec<f32> = (0..count).map(|_| (6.0 * roughness * random.unit()) as f32).collect();
    let mut obstacles = vec![false; count];
    for at in 0..count {
        let kind = random.unit();
        if kind < 0.04 {
            heights[at] = f32::NAN;
        }
        obstacles[at] = (0.04..0.08).contains(&kind);
    }
    Terrain::new(frame, heights).with_obstacles(obstacles)
}

#[test]
fn over_random_ground_it_agrees_with_many_samples() {
    const SAMPLES: u32 = 6_000;
    let mut blocked_count = 0;
    let mut tried = 0;
    for seed in 0..400 {
        let mut random = Random::from_seed(seed);
        let ground = random_ground(&mut random);
        let frame = *ground.frame();
        let mut place = || {
            let share = nalgebra::Vector2::new(random.unit(), random.unit());
            frame.origin_m + frame.extent_m().component_mul(&share)
        };
        let (from, to) = (place(), place());
        let heights_m = [4.0 * random.unit(), 4.0 * random.unit()];
        let Some(sight) = ground.line_of_sight(from, to, heights_m) else { continue };
        tried += 1;
        let (first, last) = (ground.height_at(from).unwrap(), ground.height_at(to).unwrap());
        let over = |share: f64| {
            let line = first + heights_m[0] + (last + heights_m[1] - first - heights_m[0]) * share;
            ground.height_at(from + (to - from) * share).map_or(f64::NEG_INFINITY, |ground| ground - line)
        };
        let samples = (0..=SAMPLES).map(|at| f64::from(at) / f64::from(SAMPLES));
        let first_over = samples.clone().find(|&share| over(share) > 1e-6);
        match sight.blocked_at_m {
            None => assert_eq!(first_over, None, "seed {seed}: clear, but the ground is above the line"),
            Some(at) => {
                blocked_count += 1;
                let share = (at.xy() - from).norm() / (to - from).norm();
                assert!(
                    first_over.is_none_or(|first| first > share - 1e-9),
                    "seed {seed}: {share} {first_over:?}"
                );
                // Right behind the place the ground is over the line; steps at obstacles are as sharp as that.
                let near = (0..200).map(|step| over((share + f64::from(step) * 1e-7).min(1.0)));
                assert!(near.fold(f64::NEG_INFINITY, f64::max) > -1e-6, "seed {seed}: {share}");
            }
        }
    }
    assert!(tried > 300 && blocked_count > 60 && tried - blocked_count > 60, "{tried} {blocked_count}");
}
