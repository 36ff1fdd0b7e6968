//! Simple temporal networks whose arcs come one by one, by ours and by the difference logic of `aries-solver`.

use aries_solver::prelude::{Model, Solver, Var, leq};
use stn::{PointId, Stn};
use tpn::generate::Rng;

use crate::stopwatch::Stopwatch;
use crate::table::{Table, figure, median, millis, quantile, ratio};

/// An edge: `time of to − time of from ≤ weight`.
type Edge = (u32, u32, i32);

/// No event is later than this in the hidden schedule.
const HORIZON: i32 = 10_000;

/// Prints one table.
pub(crate) fn compare(quick: bool) {
    let mut table = Table::new(
        "Simple temporal networks: random arcs, consistent after each",
        &["points", "arcs", "solver", "median ms", "worst ms", "of ours"],
    );
    let sizes: &[(u32, usize)] = if quick { &[(1_000, 4_000)] } else { &[(1_000, 4_000), (10_000, 40_000)] };
    for &(points, count) in sizes {
        let networks: Vec<Vec<Edge>> = (0..11).map(|seed| random(seed, points, count)).collect();
        let run = |solve: fn(u32, &[Edge]) -> f64| -> Vec<f64> {
            networks.iter().map(|edges| solve(points, edges)).collect()
        };
        let ours = run(ours);
        let rows = [
            ("ours, checked after each arc", &ours),
            ("aries-solver 0.6.0, propagated after each arc", &run(aries_one_by_one)),
            ("aries-solver 0.6.0, propagated once at the end", &run(aries_at_once)),
        ];
        for (name, times) in rows {
            table.row(vec![
                points.to_string(),
                count.to_string(),
                name.to_owned(),
                figure(median(times)),
                figure(quantile(times, 1.0)),
                ratio(median(times), median(&ours)),
            ]);
        }
    }
    table.note("Eleven networks each, consistent by a hidden schedule with up to 200 units of slack per arc. `aries-solver` also keeps the windows of all points, which ours does not until asked; its time holds telling it the arcs.");
    table.print();
}

/// Edges that a hidden schedule keeps.
fn random(seed: u64, points: u32, count: usize) -> Vec<Edge> {
    let mut rng = Rng::new(seed);
    let hidden: Vec<i64> = (0..points).map(|_| rng.between(0, i64::from(HORIZON) - 1)).collect();
    (0..count)
        .map(|_| {
            let (from, to) = (rng.below(u64::from(points)), rng.below(u64::from(points)));
            let weight = hidden[to as usize] - hidden[from as usize] + rng.between(0, 199);
            (from as u32, to as u32, weight as i32)
        })
        .filter(|(from, to, _)| from != to)
        .collect()
}

fn ours(points: u32, edges: &[Edge]) -> f64 {
    let mut stn = Stn::new(points as usize);
    stn.reserve(edges.len());
    let start = Stopwatch::start();
    for (tag, &(from, to, weight)) in (0..).zip(edges) {
        let kept = stn.insert(PointId(from), PointId(to), i64::from(weight), tag).is_ok();
        assert!(kept, "the hidden schedule keeps all arcs");
    }
    millis(start.elapsed())
}

fn aries_one_by_one(points: u32, edges: &[Edge]) -> f64 {
    aries(points, edges, true)
}

fn aries_at_once(points: u32, edges: &[Edge]) -> f64 {
    aries(points, edges, false)
}

fn aries(points: u32, edges: &[Edge], one_by_one: bool) -> f64 {
    let mut model = Model::new();
    let times: Vec<Var> = (0..points).map(|_| model.new_variable(0, HORIZON)).collect();
    let mut solver = Solver::new(model);
    let start = Stopwatch::start();
    for &(from, to, weight) in edges {
        solver.enforce(leq(times[to as usize] - weight, times[from as usize]));
        if one_by_one {
            assert!(solver.propagate().is_ok(), "the hidden schedule keeps all arcs");
        }
    }
    assert!(solver.propagate().is_ok(), "the hidden schedule keeps all arcs");
    millis(start.elapsed())
}
