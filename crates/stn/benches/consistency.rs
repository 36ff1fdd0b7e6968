//! Incremental consistency of random networks, and of networks with the structure of missions in two orders.
//!
//! Prints a table of medians; run with `cargo bench -p stn`.
#![expect(clippy::print_stdout, reason = "the table is what a benchmark is for")]

use std::time::{Duration, Instant};

use stn::{PointId, Stn};

fn main() {
    println!("{:<44} {:>12}", "network", "median");
    for (points, edges) in [(1_000, 4_000), (10_000, 40_000)] {
        row(&format!("random, {points} points, {edges} edges, one by one"), |seed| {
            random(seed, points, edges)
        });
    }
    for points in [2_000, 20_000] {
        row(&format!("nested, {points} points, settled in order"), |_| nested(points, true));
        row(&format!("nested, {points} points, one by one"), |_| nested(points, false));
    }
}

fn row(name: &str, run: impl Fn(u64) -> Duration) {
    let mut times: Vec<Duration> = (0..21).map(run).collect();
    times.sort_unstable();
    println!("{name:<44} {:>9.3} ms", times[times.len() / 2].as_secs_f64() * 1e3);
}

/// Edges of a hidden schedule with slack, so that the network is consistent; the time to insert them all.
fn random(seed: u64, points: usize, edges: usize) -> Duration {
    let mut state = seed;
    let mut next = |bound: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % bound
    };
    let hidden: Vec<i64> = (0..points).map(|_| next(10_000) as i64).collect();
    let edges: Vec<(u32, u32, i64)> = (0..edges)
        .map(|_| {
            let (from, to) = (next(points as u64) as usize, next(points as u64) as usize);
            (from as u32, to as u32, hidden[to] - hidden[from] + next(200) as i64)
        })
        .collect();
    let mut stn = Stn::new(points);
    stn.reserve(edges.len());
    let start = Instant::now();
    for (tag, &(from, to, weight)) in (0..).zip(&edges) {
        assert!(
            stn.insert(PointId(from), PointId(to), weight, tag).is_ok(),
            "the hidden schedule keeps all edges"
        );
    }
    start.elapsed()
}

/// A sequence of steps in threads of twenty, each with a bound around it.
fn nested(points: usize, is_bulk: bool) -> Duration {
    let mut stn = Stn::new(points);
    stn.reserve(points * 3);
    let order: Vec<PointId> = (0..points as u32).map(PointId).collect();
    let start = Instant::now();
    for point in 1..points as u32 {
        let (from, to) = (PointId(point - 1), PointId(point));
        if is_bulk {
            stn.push(to, from, -5, point);
            stn.push(from, to, 9, point);
        } else {
            assert!(stn.constrain(from, to, 5, Some(9), point).is_ok(), "consistent");
        }
        if point % 20 == 0 {
            let from = PointId(point - 20);
            if is_bulk {
                stn.push(to, from, -120, point);
            } else {
                assert!(stn.constrain(from, to, 120, None, point).is_ok(), "consistent");
            }
        }
    }
    if is_bulk {
        assert!(stn.settle(&order).is_ok(), "consistent");
    }
    start.elapsed()
}
