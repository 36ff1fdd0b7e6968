//! What parry says of shapes, against formulae written out here that share nothing with it.

use motion::{FineWorld, RangeSensor, TimedPoint, closest_approach};
use nalgebra::Point2;
use terrain::{Obstacle, Random};

type Pair = [f64; 2];

/// Discs as center and radius, and faces by their ends.
#[derive(Default)]
struct Things {
    discs: Vec<(Pair, f64)>,
    faces: Vec<[Pair; 2]>,
}

/// Random discs and triangles, for the world and for the formulae.
fn things(random: &mut Random) -> (FineWorld, Things) {
    let (mut world, mut things) = (FineWorld::default(), Things::default());
    for _ in 0..6 {
        let (center, radius_m) = ([random.range(-9.0, 9.0), random.range(-9.0, 9.0)], random.range(0.1, 1.5));
        world.add(&Obstacle::Circle { center_m: center.into(), radius_m });
        things.discs.push((center, radius_m));
        let corners: [Pair; 3] = std::array::from_fn(|_| [random.range(-9.0, 9.0), random.range(-9.0, 9.0)]);
        world.add(&Obstacle::Polygon { corners_m: corners.map(Point2::from).to_vec() });
        things.faces.extend((0..3).map(|corner| [corners[corner], corners[(corner + 1) % 3]]));
    }
    (world, things)
}

fn distance([ax, ay]: Pair, [bx, by]: Pair) -> f64 {
    ((bx - ax) * (bx - ax) + (by - ay) * (by - ay)).sqrt()
}

fn distance_to_segment(point: Pair, [a, b]: [Pair; 2]) -> f64 {
    let side = [b[0] - a[0], b[1] - a[1]];
    let squared = side[0] * side[0] + side[1] * side[1];
    let share = (((point[0] - a[0]) * side[0] + (point[1] - a[1]) * side[1]) / squared).clamp(0.0, 1.0);
    distance(point, [a[0] + side[0] * share, a[1] + side[1] * share])
}

/// Returns where a ray meets the circle around a disc, by the chord that it cuts.
fn range_to_disc(origin: Pair, direction: Pair, (center, radius): (Pair, f64)) -> f64 {
    let offset = [center[0] - origin[0], center[1] - origin[1]];
    let along = offset[0] * direction[0] + offset[1] * direction[1];
    let across = offset[0] * direction[1] - offset[1] * direction[0];
    let half_chord = radius * radius - across * across;
    if half_chord < 0.0 || along + half_chord.sqrt() < 0.0 {
        return f64::INFINITY;
    }
    (along - half_chord.sqrt()).max(0.0)
}

/// Returns where a ray crosses a segment, by the areas that the two span.
fn range_to_face(origin: Pair, direction: Pair, [a, b]: [Pair; 2]) -> f64 {
    let side = [b[0] - a[0], b[1] - a[1]];
    let offset = [a[0] - origin[0], a[1] - origin[1]];
    let turn = direction[0] * side[1] - direction[1] * side[0];
    let range = (offset[0] * side[1] - offset[1] * side[0]) / turn;
    let share = (offset[0] * direction[1] - offset[1] * direction[0]) / turn;
    if range >= 0.0 && (0.0..=1.0).contains(&share) { range } else { f64::INFINITY }
}

#[test]
fn the_nearest_surface_is_that_of_the_formulae() {
    for seed in 0..200 {
        let mut random = Random::from_seed(seed);
        let (world, things) = things(&mut random);
        for _ in 0..20 {
            let point = [random.range(-12.0, 12.0), random.range(-12.0, 12.0)];
            let discs =
                things.discs.iter().map(|(center, radius)| (distance(point, *center) - radius).max(0.0));
            let faces = things.faces.iter().map(|&face| distance_to_segment(point, face));
            let expected = discs.chain(faces).fold(f64::INFINITY, f64::min);
            let found = world.distance_m(point.into());
            assert!((found - expected).abs() < 1e-12, "seed {seed} at {point:?}: {found}, not {expected}");
            let reach = random.range(0.5, 6.0);
            let near = world.around(point.into(), reach).distance_m(point.into());
            let is_near = expected <= reach;
            assert_eq!(near.is_finite(), is_near, "seed {seed} at {point:?} within {reach}");
            assert!(!is_near || near == found, "seed {seed} at {point:?} within {reach}");
        }
    }
}

#[test]
fn rays_end_where_the_formulae_say() {
    let sensor = RangeSensor { noise_m: 0.0, ..RangeSensor::SICK };
    let (mut met, mut missed) = (0, 0);
    for seed in 0..100 {
        let mut random = Random::from_seed(seed);
        let (world, things) = things(&mut random);
        let origin = [random.range(-9.0, 9.0), random.range(-9.0, 9.0)];
        let scan = sensor.scan(&world, origin.into(), random.range(-3.0, 3.0), &mut Random::from_seed(0));
        for (ray, found) in scan.ranges_m.iter().enumerate() {
            let angle = scan.first_ray_rad + scan.resolution_rad * ray as f64;
            let direction = [angle.cos(), angle.sin()];
            let discs = things.discs.iter().map(|&disc| range_to_disc(origin, direction, disc));
            let faces = things.faces.iter().map(|&face| range_to_face(origin, direction, face));
            let expected = discs.chain(faces).fold(f64::INFINITY, f64::min);
            if let Some(range) = found {
                met += 1;
                assert!((range - expected).abs() < 1e-9, "seed {seed}, ray {ray}: {range}, not {expected}");
            } else {
                missed += 1;
                assert!(expected > sensor.range_m, "seed {seed}, ray {ray}: nothing, not {expected}");
            }
        }
    }
    assert!(met > 1000 && missed > 1000, "{met} met, {missed} missed");
}

#[test]
fn the_separation_of_two_straight_ways_is_that_of_the_quadratic() {
    let (mut near, mut far) = (0, 0);
    for seed in 0..400 {
        let mut random = Random::from_seed(seed);
        let mut place = || [random.range(0.0, 30.0), random.range(0.0, 30.0)];
        let ways = [[place(), place()], [place(), place()]];
        let track = |[from, to]: [Pair; 2]| {
            [(0.0, from), (10.0, to)].map(|(time_s, at)| TimedPoint { time_s, position_m: at.into() })
        };
        let safety_m = random.range(1.0, 8.0);
        let found = closest_approach(&track(ways[0]), &track(ways[1]), safety_m).expect("both are under way");
        // The squared distance at a share of the time is square · share² + 2 · slope · share + start.
        let offset = |end: usize| [0, 1].map(|axis| ways[1][end][axis] - ways[0][end][axis]);
        let (first, last) = (offset(0), offset(1));
        let change = [last[0] - first[0], last[1] - first[1]];
        let square = change[0] * change[0] + change[1] * change[1];
        let slope = first[0] * change[0] + first[1] * change[1];
        let start = first[0] * first[0] + first[1] * first[1];
        let share = (-slope / square).clamp(0.0, 1.0);
        let min_m = (square * share * share + 2.0 * slope * share + start).max(0.0).sqrt();
        assert!((found.closest.distance_m - min_m).abs() < 1e-9, "seed {seed}: {found:?}, not {min_m}");
        if (min_m - safety_m).abs() < 1e-6 {
            continue;
        }
        assert_eq!(found.violation.is_some(), min_m < safety_m, "seed {seed}");
        let Some(violation) = found.violation else {
            far += 1;
            continue;
        };
        near += 1;
        let rest = slope * slope - square * (start - safety_m * safety_m);
        let entry_s = 10.0 * ((-slope - rest.sqrt()) / square).max(0.0);
        assert!((violation.time_s - entry_s).abs() < 1e-6, "seed {seed}: {violation:?}, not {entry_s}");
    }
    assert!(near > 50 && far > 50, "{near} near, {far} far");
}
