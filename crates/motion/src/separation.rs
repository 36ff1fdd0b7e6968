//! How near two moving vehicles come to each other: exact for straight motion at constant speed between given times.
//!
//! On each interval of time one vehicle, seen from the other, moves along a segment. The closest approach is that
//! segment's nearest point to the origin; the separation is violated from where the segment enters the disc of the
//! safety radius.

use crate::path::between;
use nalgebra::{Point2, distance};
use parry2d_f64::query::details::ray_toi_with_ball;
use parry2d_f64::query::{PointQueryWithLocation as _, Ray};
use parry2d_f64::shape::Segment;
use serde::{Deserialize, Serialize};

/// A place at a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimedPoint {
    /// Seconds.
    pub time_s: f64,
    /// Meters east and north.
    pub position_m: Point2<f64>,
}

/// Two vehicles at one time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Separation {
    /// When, in seconds.
    pub time_s: f64,
    /// Where both are then, in meters.
    pub positions_m: [Point2<f64>; 2],
    /// How far apart, in meters.
    pub distance_m: f64,
}

/// What happens between two vehicles that move at the same time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Approach {
    /// When they are nearest to each other; the first such time.
    pub closest: Separation,
    /// When they first come within the safety radius, if they do.
    pub violation: Option<Separation>,
}

/// Returns how near two vehicles come while both are under way, and when they first come closer than `safety_m`. Times
/// must not decrease along a track. `None` when they are never under way at the same time. Linear in the number of
/// points.
pub fn closest_approach(a: &[TimedPoint], b: &[TimedPoint], safety_m: f64) -> Option<Approach> {
    let start = a.first()?.time_s.max(b.first()?.time_s);
    let end = a.last()?.time_s.min(b.last()?.time_s);
    if start > end {
        return None;
    }
    let mut times: Vec<f64> = a.iter().chain(b).map(|point| point.time_s).collect();
    times.retain(|&time| time > start && time < end);
    times.push(start);
    times.push(end);
    times.sort_by(f64::total_cmp);
    times.dedup();
    // On each interval both move straight at constant speed.
    let (mut track_a, mut track_b) = (Follow::new(a), Follow::new(b));
    let mut from = separation(start, track_a.at(start), track_b.at(start));
    let mut found = Approach { closest: from, violation: (from.distance_m < safety_m).then_some(from) };
    for &time in &times[1..] {
        let to = separation(time, track_a.at(time), track_b.at(time));
        examine(&mut found, from, to, safety_m);
        from = to;
    }
    Some(found)
}

fn separation(time_s: f64, a: Point2<f64>, b: Point2<f64>) -> Separation {
    Separation { time_s, positions_m: [a, b], distance_m: distance(&a, &b) }
}

/// Looks for the closest approach and the first violation between two times.
fn examine(found: &mut Approach, from: Separation, to: Separation, safety_m: f64) {
    let relative = |moment: &Separation| Point2::from(moment.positions_m[1] - moment.positions_m[0]);
    let motion = Segment::new(relative(&from), relative(&to));
    let at = |share: f64| {
        let time_s = from.time_s + (to.time_s - from.time_s) * share;
        let [a, b] = [0, 1].map(|vehicle| between(from.positions_m[vehicle], to.positions_m[vehicle], share));
        separation(time_s, a, b)
    };
    let (_, location) = motion.project_local_point_and_get_location(&Point2::origin(), true);
    let nearest_share = location.barycentric_coordinates()[1];
    let nearest = at(nearest_share);
    for moment in [nearest, to] {
        if moment.distance_m < found.closest.distance_m {
            found.closest = moment;
        }
    }
    if found.violation.is_none() && nearest.distance_m.min(to.distance_m) < safety_m {
        let ray = Ray::new(motion.a, motion.scaled_direction());
        let (_, entry) = ray_toi_with_ball(&Point2::origin(), safety_m, &ray, true);
        found.violation = Some(at(entry.unwrap_or(nearest_share).min(1.0)));
    }
}

/// Reads places off a track at times that don't decrease.
struct Follow<'a> {
    track: &'a [TimedPoint],
    next: usize,
}

impl<'a> Follow<'a> {
    const fn new(track: &'a [TimedPoint]) -> Self {
        Self { track, next: 0 }
    }

    fn at(&mut self, time_s: f64) -> Point2<f64> {
        while self.next + 1 < self.track.len() && self.track[self.next].time_s < time_s {
            self.next += 1;
        }
        let after = self.track[self.next];
        let before = self.track[self.next.saturating_sub(1)];
        let span = after.time_s - before.time_s;
        if span > 0.0 {
            let share = ((time_s - before.time_s) / span).clamp(0.0, 1.0);
            between(before.position_m, after.position_m, share)
        } else {
            after.position_m
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrain::Random;

    fn track(points: &[(f64, f64, f64)]) -> Vec<TimedPoint> {
        points.iter().map(|&(time_s, x, y)| TimedPoint { time_s, position_m: Point2::new(x, y) }).collect()
    }

    #[test]
    fn crossing_ways_meet_at_the_right_time_and_place() {
        let a = track(&[(0.0, -10.0, 0.0), (20.0, 10.0, 0.0)]);
        let b = track(&[(0.0, 0.0, -10.0), (20.0, 0.0, 10.0)]);
        let found = closest_approach(&a, &b, 2.0).unwrap();
        assert_eq!((found.closest.time_s, found.closest.distance_m), (10.0, 0.0));
        // They are 2 m apart √2 m, and so √2 s, before the crossing.
        let violation = found.violation.unwrap();
        assert!((violation.time_s - (10.0 - 2.0_f64.sqrt())).abs() < 1e-9);
        assert!((violation.distance_m - 2.0).abs() < 1e-9);
    }

    #[test]
    fn passing_the_same_place_at_different_times_is_no_violation() {
        let a = track(&[(0.0, -10.0, 0.0), (20.0, 10.0, 0.0)]);
        let b = track(&[(0.0, 0.0, -30.0), (20.0, 0.0, -10.0), (40.0, 0.0, 10.0)]);
        let found = closest_approach(&a, &b, 2.0).unwrap();
        assert_eq!(found.violation, None);
        assert!(found.closest.distance_m > 10.0);
        let later = track(&[(30.0, -10.0, 0.0), (50.0, 10.0, 0.0)]);
        assert_eq!(closest_approach(&a, &later, 2.0), None);
    }

    #[test]
    fn agrees_with_a_dense_sample_of_time() {
        for seed in 0..40 {
            let mut random = Random::from_seed(seed);
            let mut wander = |start: f64| {
                let mut time_s = start;
                let points = 3 + random.below(6);
                (0..points)
                    .map(|_| {
                        time_s += random.range(0.0, 9.0);
                        let position_m = Point2::new(random.range(0.0, 30.0), random.range(0.0, 30.0));
                        TimedPoint { time_s, position_m }
                    })
                    .collect::<Vec<_>>()
            };
            let (a, b) = (wander(0.0), wander(4.0));
            let Some(found) = closest_approach(&a, &b, 5.0) else { continue };
            let (start, end) =
                (a[0].time_s.max(b[0].time_s), a.last().unwrap().time_s.min(b.last().unwrap().time_s));
            let (mut follow_a, mut follow_b) = (Follow::new(&a), Follow::new(&b));
            let mut least = f64::INFINITY;
            let mut first_near = None;
            for step in 0..=20_000 {
                let time = start + (end - start) * f64::from(step) / 20_000.0;
                let apart = distance(&follow_a.at(time), &follow_b.at(time));
                least = least.min(apart);
                if apart < 5.0 && first_near.is_none() {
                    first_near = Some(time);
                }
            }
            assert!(found.closest.distance_m <= least + 1e-9, "seed {seed}");
            assert!(found.closest.distance_m >= least - 0.2, "seed {seed}");
            if let Some(time) = first_near {
                assert!((found.violation.unwrap().time_s - time).abs() < 0.02, "seed {seed}");
            }
        }
    }
}
