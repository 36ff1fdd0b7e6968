//! Checking from scratch, inserting one edge with undo, conflicts and the dispatchable form, on generated networks.
//!
//! Prints a table of medians; run with `cargo bench -p stnu`.
#![expect(clippy::print_stdout, reason = "the table is what a benchmark is for")]

use std::time::Instant;

use stnu::generate::{Kind, Random, Shape};
use stnu::{Checker, Dispatchable, Edge, Network, PointId, Verdict, check, generate, minimal};

const SEEDS: u64 = 3;

fn main() {
    println!(
        "| kind | points | links | edges | check ms | worst ms | controllable | edge and undo ms | dispatchable ms |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for kind in [Kind::Workflow, Kind::JobShop, Kind::Tree, Kind::Scattered, Kind::Near] {
        for (points, links) in [(100, 10), (1_000, 100), (10_000, 100), (10_000, 1_000)] {
            row(Shape { kind, points, links, slack_percent: if kind == Kind::Scattered { 900 } else { 5 } });
        }
    }
    for kind in [Kind::Workflow, Kind::JobShop] {
        conflict_row(Shape { kind, points: 1_000, links: 100, slack_percent: -60 });
    }
}

fn row(shape: Shape) {
    let networks: Vec<Network> = (0..SEEDS).map(|seed| generate::network(shape, seed)).collect();
    let mut controllable = 0;
    let mut checks: Vec<f64> = networks
        .iter()
        .map(|network| millis(|| controllable += u32::from(is_controllable(network))))
        .collect();
    checks.sort_by(f64::total_cmp);
    let edges: Vec<f64> = networks.iter().take(1).filter_map(edge_and_undo).collect();
    let forms = if matches!(shape.kind, Kind::Scattered | Kind::Near) && shape.points > 1_000 {
        Vec::new()
    } else {
        networks.iter().map(|network| millis(|| Dispatchable::new(network, &mut || false))).collect()
    };
    println!(
        "| {:?} | {} | {} | {} | {:.3} | {:.3} | {controllable} of {SEEDS} | {} | {} |",
        shape.kind,
        networks[0].num_points(),
        networks[0].links().len(),
        networks[0].edges().len(),
        checks[checks.len() / 2],
        checks[checks.len() - 1],
        median(edges),
        median(forms),
    );
}

/// Returns what an edge between random points costs that was not there before, and its undo.
fn edge_and_undo(network: &Network) -> Option<f64> {
    let mut checker = Checker::build(network.clone(), &mut || false).ok()?;
    let mut random = Random::new(1);
    let mut point = || PointId(random.below(network.num_points()) as u32);
    let edges: Vec<Edge> = (0..20)
        .map(|_| (point(), point()))
        .map(|(from, to)| {
            let schedule = checker.schedule();
            Edge { from, to, weight: schedule[to.index()] - schedule[from.index()] + 100 }
        })
        .collect();
    let all = millis(|| {
        for edge in &edges {
            let checkpoint = checker.checkpoint();
            // A refusal takes itself back.
            let _ = checker.insert(&[*edge], &mut || false);
            checker.rollback(checkpoint);
        }
    });
    Some(all / edges.len() as f64)
}

fn conflict_row(shape: Shape) {
    let mut times = Vec::new();
    let mut members = 0;
    for seed in 0..SEEDS {
        let network = generate::network(shape, seed);
        let Ok(Verdict::Uncontrollable(conflict)) = check(&network, &mut || false) else { continue };
        times.push(millis(|| {
            members = minimal(&network, &conflict, &mut || false).map_or(0, |c| c.members.len());
        }));
    }
    println!(
        "{:?}, {} points: a minimal conflict, {members} members the last: {} ms",
        shape.kind,
        shape.points,
        median(times)
    );
}

fn is_controllable(network: &Network) -> bool {
    check(network, &mut || false) == Ok(Verdict::Controllable)
}

fn millis<T>(run: impl FnOnce() -> T) -> f64 {
    let start = Instant::now();
    std::hint::black_box(run());
    start.elapsed().as_secs_f64() * 1e3
}

fn median(mut times: Vec<f64>) -> String {
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).map_or("–".to_owned(), |time| format!("{time:.4}"))
}
