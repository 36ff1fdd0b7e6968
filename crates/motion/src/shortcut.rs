//! Shortening a path: straight pieces between any two of its points where the way is free.
//!
//! A coarse look at the ground finds shorter ways around obstacles, if there are any. Where there are none, random
//! shortcuts (Geraerts and Overmars 2007) find the coarse shape. Then every corner is cut as far as obstacles allow,
//! round after round. Every edge of the result was checked exactly; that it is the shortest path of all is likely but
//! not proved.

use nalgebra::{Point2, distance};
use serde::{Deserialize, Serialize};
use terrain::{ConfigurationSpace, Random};

use crate::path::{Path, between};
use crate::way_around::way_around;

/// How much to try.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShortcutSettings {
    /// Random shortcuts tried.
    pub attempts: u32,
    /// Rounds of cutting every corner; they end early when a round gains less than a ten-thousandth.
    pub corner_rounds: u32,
    /// Blocks of the ground, at most, in which another way around the obstacles is looked for; 0 for none.
    pub blocks: u32,
    /// Where random choices come from.
    pub seed: u64,
}

impl Default for ShortcutSettings {
    fn default() -> Self {
        Self { attempts: 100, corner_rounds: 12, blocks: 600, seed: 1 }
    }
}

/// A path between the same ends that is no longer and as free as the given one. A path that is not free is only
/// shortened where it can be.
pub fn shorten(space: &ConfigurationSpace, path: &Path, settings: &ShortcutSettings) -> Path {
    let mut points = path.points_m.clone();
    points.dedup();
    skip_corners(space, &mut points);
    let (Some(&first), Some(&last)) = (points.first(), points.last()) else { return path.clone() };
    let other = (settings.blocks > 0 && points.len() > 2)
        .then(|| way_around(space, [first, last], length(&points), settings.blocks))
        .flatten();
    let Some(mut other) = other else {
        take_shortcuts(space, &mut points, settings);
        pull_tight(space, &mut points, settings);
        return Path::new(points);
    };
    pull_tight(space, &mut other, settings);
    if length(&points) < length(&other) * WORTHWHILE {
        take_shortcuts(space, &mut points, settings);
        pull_tight(space, &mut points, settings);
    }
    Path::new(if length(&points) < length(&other) { points } else { other })
}

/// A path at most so many times as long as the one another way around may be shorter still once it is tight.
const WORTHWHILE: f64 = 1.05;

fn take_shortcuts(space: &ConfigurationSpace, points: &mut Vec<Point2<f64>>, settings: &ShortcutSettings) {
    let mut random = Random::from_seed(settings.seed);
    for _ in 0..settings.attempts {
        if points.len() < 3 {
            break;
        }
        random_shortcut(space, points, &mut random);
    }
    skip_corners(space, points);
}

fn pull_tight(space: &ConfigurationSpace, points: &mut Vec<Point2<f64>>, settings: &ShortcutSettings) {
    for _ in 0..settings.corner_rounds {
        if points.len() < 3 {
            break;
        }
        let before = length(points);
        cut_corners(space, points);
        skip_corners(space, points);
        if length(points) > before * (1.0 - 1e-4) {
            break;
        }
    }
}

fn length(points: &[Point2<f64>]) -> f64 {
    points.windows(2).map(|pair| distance(&pair[0], &pair[1])).sum()
}

/// Leaves out every corner that the straight way around it makes needless.
fn skip_corners(space: &ConfigurationSpace, points: &mut Vec<Point2<f64>>) {
    let mut kept = 0;
    while kept + 2 < points.len() {
        // The farthest point in sight, looked for by doubling and then stepping back.
        let mut reach = 2;
        let mut seen = 1;
        while kept + reach < points.len() && space.is_segment_free(points[kept], points[kept + reach]) {
            seen = reach;
            reach *= 2;
        }
        let mut high = reach.min(points.len() - kept);
        while high > seen + 1 {
            let middle = seen + (high - seen) / 2;
            if space.is_segment_free(points[kept], points[kept + middle]) {
                seen = middle;
            } else {
                high = middle;
            }
        }
        points.drain(kept + 1..kept + seen);
        kept += 1;
    }
}

/// Tries to go straight between two random points of the path.
fn random_shortcut(space: &ConfigurationSpace, points: &mut Vec<Point2<f64>>, random: &mut Random) {
    let total = length(points);
    let (a, b) = (random.unit() * total, random.unit() * total);
    let (first, second) = (locate(points, a.min(b)), locate(points, a.max(b)));
    if first.0 == second.0 || !space.is_segment_free(first.1, second.1) {
        return;
    }
    points.splice(first.0 + 1..=second.0, [first.1, second.1]);
    points.dedup();
}

/// The segment and the point at a distance along the path.
fn locate(points: &[Point2<f64>], distance_m: f64) -> (usize, Point2<f64>) {
    let mut rest = distance_m;
    for (index, pair) in points.windows(2).enumerate() {
        let length = distance(&pair[0], &pair[1]);
        if rest <= length && length > 0.0 {
            return (index, between(pair[0], pair[1], rest / length));
        }
        rest -= length;
    }
    (points.len() - 2, points[points.len() - 1])
}

/// Cuts every corner as far as obstacles allow.
fn cut_corners(space: &ConfigurationSpace, points: &mut Vec<Point2<f64>>) {
    const HALVINGS: u32 = 7;
    let mut cut = Vec::with_capacity(2 * points.len());
    cut.push(points[0]);
    for index in 1..points.len() - 1 {
        let (before, corner, after) = (cut[cut.len() - 1], points[index], points[index + 1]);
        // Equal shares of both sides, found by halving; the whole of a side is left to skipping.
        let (mut free, mut blocked) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let share = 0.5 * (free + blocked);
            if space.is_segment_free(between(corner, before, share), between(corner, after, share)) {
                free = share;
            } else {
                blocked = share;
            }
        }
        if free > 0.0 {
            cut.push(between(corner, before, free));
            cut.push(between(corner, after, free));
        } else {
            cut.push(corner);
        }
    }
    cut.push(points[points.len() - 1]);
    cut.dedup();
    *points = cut;
}
