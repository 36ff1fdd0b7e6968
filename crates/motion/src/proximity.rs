//! How near two moving vehicles come to each other: exact for straight motion at constant speed between given times.

use serde::{Deserialize, Serialize};

use crate::geometry::{between, distance};

/// A place at a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimedPoint {
    /// Seconds.
    pub time_s: f64,
    /// Metres east and north.
    pub position_m: [f64; 2],
}

/// Two vehicles at one time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Encounter {
    /// When, in seconds.
    pub time_s: f64,
    /// Where both are then, in metres.
    pub positions_m: [[f64; 2]; 2],
    /// How far apart, in metres.
    pub distance_m: f64,
}

/// What happens between two vehicles that move at the same time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Proximity {
    /// When they are nearest to each other; the first such time.
    pub closest: Encounter,
    /// When they first come within the safety radius, if they do.
    pub conflict: Option<Encounter>,
}

/// How near two vehicles come while both are under way, and when they first come closer than `safety_m`. Times must not
/// decrease along a track. `None` when they are never under way at the same time. Linear in the number of points.
pub fn proximity(a: &[TimedPoint], b: &[TimedPoint], safety_m: f64) -> Option<Proximity> {
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
    let mut from = encounter(start, track_a.at(start), track_b.at(start));
    let mut found = Proximity { closest: from, conflict: (from.distance_m < safety_m).then_some(from) };
    for &time in &times[1..] {
        let to = encounter(time, track_a.at(time), track_b.at(time));
        examine(&mut found, from, to, safety_m);
        from = to;
    }
    Some(found)
}

fn encounter(time_s: f64, a: [f64; 2], b: [f64; 2]) -> Encounter {
    Encounter { time_s, positions_m: [a, b], distance_m: distance(a, b) }
}

/// Looks for the closest approach and the first conflict between two times.
fn examine(found: &mut Proximity, from: Encounter, to: Encounter, safety_m: f64) {
    let offset = |moment: &Encounter| {
        let [a, b] = moment.positions_m;
        [b[0] - a[0], b[1] - a[1]]
    };
    let (first, last) = (offset(&from), offset(&to));
    let change = [last[0] - first[0], last[1] - first[1]];
    // The squared distance at a share of the interval is square · share² + 2 · slope · share + start.
    let square = change[0] * change[0] + change[1] * change[1];
    let slope = first[0] * change[0] + first[1] * change[1];
    let start = first[0] * first[0] + first[1] * first[1];
    let at = |share: f64| {
        let time_s = from.time_s + (to.time_s - from.time_s) * share;
        encounter(
            time_s,
            between(from.positions_m[0], to.positions_m[0], share),
            between(from.positions_m[1], to.positions_m[1], share),
        )
    };
    let nearest = if square > 0.0 { (-slope / square).clamp(0.0, 1.0) } else { 0.0 };
    for moment in [at(nearest), to] {
        if moment.distance_m < found.closest.distance_m {
            found.closest = moment;
        }
    }
    if found.conflict.is_none() && at(nearest).distance_m.min(to.distance_m) < safety_m {
        let rest = slope * slope - square * (start - safety_m * safety_m);
        let entry = if square > 0.0 && rest >= 0.0 { (-slope - rest.sqrt()) / square } else { 0.0 };
        found.conflict = Some(at(entry.clamp(0.0, 1.0)));
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

    fn at(&mut self, time_s: f64) -> [f64; 2] {
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
        points.iter().map(|&(time_s, x, y)| TimedPoint { time_s, position_m: [x, y] }).collect()
    }

    #[test]
    fn crossing_ways_meet_at_the_right_time_and_place() {
        let a = track(&[(0.0, -10.0, 0.0), (20.0, 10.0, 0.0)]);
        let b = track(&[(0.0, 0.0, -10.0), (20.0, 0.0, 10.0)]);
        let found = proximity(&a, &b, 2.0).unwrap();
        assert_eq!((found.closest.time_s, found.closest.distance_m), (10.0, 0.0));
        // They are 2 m apart √2 m, and so √2 s, before the crossing.
        let conflict = found.conflict.unwrap();
        assert!((conflict.time_s - (10.0 - 2.0_f64.sqrt())).abs() < 1e-9);
        assert!((conflict.distance_m - 2.0).abs() < 1e-9);
    }

    #[test]
    fn passing_the_same_place_at_different_times_is_no_conflict() {
        let a = track(&[(0.0, -10.0, 0.0), (20.0, 10.0, 0.0)]);
        let b = track(&[(0.0, 0.0, -30.0), (20.0, 0.0, -10.0), (40.0, 0.0, 10.0)]);
        let found = proximity(&a, &b, 2.0).unwrap();
        assert_eq!(found.conflict, None);
        assert!(found.closest.distance_m > 10.0);
        let later = track(&[(30.0, -10.0, 0.0), (50.0, 10.0, 0.0)]);
        assert_eq!(proximity(&a, &later, 2.0), None);
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
                        let position_m = [random.range(0.0, 30.0), random.range(0.0, 30.0)];
                        TimedPoint { time_s, position_m }
                    })
                    .collect::<Vec<_>>()
            };
            let (a, b) = (wander(0.0), wander(4.0));
            let Some(found) = proximity(&a, &b, 5.0) else { continue };
            let (start, end) =
                (a[0].time_s.max(b[0].time_s), a.last().unwrap().time_s.min(b.last().unwrap().time_s));
            let (mut follow_a, mut follow_b) = (Follow::new(&a), Follow::new(&b));
            let mut least = f64::INFINITY;
            let mut first_near = None;
            for step in 0..=20_000 {
                let time = start + (end - start) * f64::from(step) / 20_000.0;
                let apart = distance(follow_a.at(time), follow_b.at(time));
                least = least.min(apart);
                if apart < 5.0 && first_near.is_none() {
                    first_near = Some(time);
                }
            }
            assert!(found.closest.distance_m <= least + 1e-9, "seed {seed}");
            assert!(found.closest.distance_m >= least - 0.2, "seed {seed}");
            if let Some(time) = first_near {
                assert!((found.conflict.unwrap().time_s - time).abs() < 0.02, "seed {seed}");
            }
        }
    }
}
