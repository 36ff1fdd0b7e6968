//! Time to the first plan of random missions, to the proof that there is none, and to a new plan after an edit.
//!
//! Prints a table of medians and worst cases; run with `cargo bench -p kirk`.
#![expect(clippy::print_stdout, reason = "the table is what a benchmark is for")]

use std::time::{Duration, Instant};

use kirk::{ExpansionLimit, Options, Planner, Search, Status};
use tpn::Network;
use tpn::compile::{Top, compile};
use tpn::generate::{Recipe, Tightness, mission};

const MISSIONS: u64 = 15;

fn main() {
    println!(
        "{:<12} {:>7} {:>10} {:>10} {:>9} {:>8} {:>7}",
        "missions", "nodes", "median", "worst", "expanded", "leaves", "answers"
    );
    for tightness in [Tightness::Feasible, Tightness::Boundary, Tightness::Infeasible] {
        for nodes in [100, 1_000, 10_000] {
            row(tightness, nodes);
        }
    }
    for nodes in [100, 1_000, 10_000] {
        replan(nodes);
    }
}

/// One bound changes by one unit, to and fro, and the mission is planned again.
fn replan(nodes: usize) {
    let options = Options { explain: false, relax: false, ..Options::default() };
    let (mut wider_than_ever, mut within) = (Vec::new(), Vec::new());
    for seed in 0..MISSIONS {
        let network = network(Recipe { nodes, tightness: Tightness::Feasible, seed });
        let is_activity = |arc: &tpn::Arc| arc.kind == tpn::ArcKind::Activity && arc.upper.finite().is_some();
        let Some(position) = network.arcs.iter().rposition(is_activity) else { continue };
        let (lower, upper) = (network.arcs[position].lower, network.arcs[position].upper);
        let mut planner = Planner::new(network, None);
        planner.plan(&options, &mut ExpansionLimit(20_000));
        for change in 1..6 {
            let one = exact::Time::from(change % 2);
            let start = Instant::now();
            let wider = upper.checked_add(exact::Bound::Finite(one)).unwrap_or(upper);
            planner.set_bounds(tpn::ArcId::from_index(position), lower, wider);
            std::hint::black_box(planner.plan(&options, &mut ExpansionLimit(20_000)));
            if change == 1 { &mut wider_than_ever } else { &mut within }.push(start.elapsed());
        }
    }
    for (what, mut times) in [("again, wider", wider_than_ever), ("again", within)] {
        times.sort_unstable();
        let (median, worst) = (times[times.len() / 2], times[times.len() - 1]);
        let milliseconds = |time: Duration| time.as_secs_f64() * 1e3;
        println!("{what:<12} {nodes:>7} {:>7.3} ms {:>7.3} ms", milliseconds(median), milliseconds(worst));
    }
}

fn row(tightness: Tightness, nodes: usize) {
    let options =
        Options { search: Search::ConflictDirected, explain: false, relax: false, ..Options::default() };
    let mut times = Vec::new();
    let (mut expanded, mut leaves, mut answers) = (0, 0, [0, 0, 0]);
    for seed in 0..MISSIONS {
        let network = network(Recipe { nodes, tightness, seed });
        let mut best = Duration::MAX;
        for _ in 0..5 {
            let start = Instant::now();
            let outcome = std::hint::black_box(kirk::plan(&network, &options, &mut ExpansionLimit(20_000)));
            best = best.min(start.elapsed());
            expanded = expanded.max(outcome.stats.expanded);
            leaves = leaves.max(outcome.stats.leaves);
            let answer = match outcome.status {
                Status::Plan => 0,
                Status::NoPlan => 1,
                Status::Limit | Status::Error => 2,
            };
            answers[answer] += 1;
        }
        times.push(best);
    }
    times.sort_unstable();
    let (median, worst) = (times[times.len() / 2], times[times.len() - 1]);
    println!(
        "{:<12} {nodes:>7} {:>7.3} ms {:>7.3} ms {expanded:>9} {leaves:>8} {answers:?}",
        format!("{tightness:?}").to_lowercase(),
        median.as_secs_f64() * 1e3,
        worst.as_secs_f64() * 1e3,
    );
}

fn network(recipe: Recipe) -> Network {
    let program = rmpl::parse(&mission(recipe)).program();
    let (network, diagnostics) = compile(&program, &Top::Scenario(None));
    network.unwrap_or_else(|| panic!("{recipe:?} does not compile: {diagnostics:?}"))
}
