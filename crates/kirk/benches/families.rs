//! Time to the first plan, or to the proof that there is none, of missions by families (`tpn::families`).
//!
//! Prints the median, the worst case and what stayed unsolved; run with `cargo bench -p kirk --bench families`, with the
//! beginning of a family's name to see only that one.
#![expect(clippy::print_stdout, reason = "the table is what a benchmark is for")]

use std::time::Instant;

use kirk::{Options, Stats, Status};
use tpn::compile::{Top, compile};
use tpn::families::{JOB_SHOPS, chain, long_requirements, nested, open_shop, pigeonholes, symmetric};

/// Seconds after which a mission counts as unsolved.
const LIMIT: f64 = 10.0;

fn main() {
    let filter = std::env::args().skip(1).find(|argument| !argument.starts_with('-')).unwrap_or_default();
    println!("{:<28} {:>11} {:>11} {:>17}", "family", "median", "worst", "plan/none/limit");
    for (name, texts) in families() {
        if name.starts_with(&filter) {
            row(&name, &texts);
        }
    }
}

fn families() -> Vec<(String, Vec<String>)> {
    let mut families = Vec::new();
    for shop in JOB_SHOPS {
        for (what, horizon) in
            [("loose", shop.optimum * 3 / 2), ("optimum", shop.optimum), ("one below", shop.optimum - 1)]
        {
            families.push((format!("job shop {} {what}", shop.name), vec![shop.mission(horizon)]));
        }
    }
    let seeds = || 0..5_u64;
    for size in [3, 4, 5] {
        for percent in [100, 120] {
            let texts = seeds().map(|seed| open_shop(size, percent, seed)).collect();
            families.push((format!("open shop {size} {percent} %"), texts));
        }
    }
    for missing in [0, 1] {
        let texts = [5, 12, 40, 100].map(|count| pigeonholes(count, missing)).into();
        families.push((format!("pigeonholes, {missing} missing"), texts));
        let texts = [(10, 5), (20, 10), (50, 20)].map(|(count, ways)| symmetric(count, ways, missing)).into();
        families.push((format!("symmetric, {missing} missing"), texts));
    }
    for can_succeed in [true, false] {
        let texts = [10, 100, 1_000, 5_000].map(|count| chain(count, can_succeed)).into();
        families.push((format!("chain {can_succeed}"), texts));
    }
    for (asks, tells) in [(10, 6), (50, 20), (200, 40)] {
        for percent in [80, 100, 150] {
            let texts = seeds().map(|seed| long_requirements(asks, tells, seed, percent)).collect();
            families.push((format!("requirements {asks} {tells} {percent} %"), texts));
        }
    }
    for nodes in [100, 1_000, 3_000, 10_000, 30_000] {
        for percent in [90, 110, 200] {
            let texts = seeds().map(|seed| nested(nodes, percent, seed)).collect();
            families.push((format!("nested {nodes} {percent} %"), texts));
        }
    }
    families
}

fn row(name: &str, texts: &[String]) {
    let options = Options { explain: false, relax: false, ..Options::default() };
    let (mut times, mut answers) = (Vec::new(), [0, 0, 0]);
    for text in texts {
        let program = rmpl::parse(text).program();
        let (network, diagnostics) = compile(&program, &Top::Scenario(None));
        let network = network.unwrap_or_else(|| panic!("{name} does not compile: {diagnostics:?}"));
        let begun = Instant::now();
        let mut stop = |_: &Stats| begun.elapsed().as_secs_f64() > LIMIT;
        let outcome = std::hint::black_box(kirk::plan(&network, &options, &mut stop));
        times.push(begun.elapsed().as_secs_f64() * 1e3);
        let answer = match outcome.status {
            Status::Plan => 0,
            Status::NoPlan => 1,
            Status::Limit | Status::Error => 2,
        };
        answers[answer] += 1;
    }
    times.sort_by(f64::total_cmp);
    let [plans, none, limit] = answers;
    println!(
        "{name:<28} {:>8.3} ms {:>8.3} ms {plans:>9}/{none}/{limit}",
        times[times.len() / 2],
        times[times.len() - 1]
    );
}
