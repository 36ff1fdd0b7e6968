//! Time to the first plan, or to the proof that there is none, of missions by families (`tpn::families`).
//!
//! Prints the median, the worst case and what stayed unsolved; run with `cargo bench -p kirk --bench families`, with the
//! beginning of a family's name to see only that one.
#![expect(clippy::print_stdout, reason = "the table is what a benchmark is for")]

use std::time::Instant;

use kirk::{Options, Stats, Status};
use tpn::compile::{Top, compile};
use tpn::families::{Family, families};

/// Seconds after which a mission counts as unsolved.
const LIMIT: f64 = 10.0;

fn main() {
    let filter = std::env::args().skip(1).find(|argument| !argument.starts_with('-')).unwrap_or_default();
    println!("{:<50} {:>11} {:>11} {:>17}", "family", "median", "worst", "plan/none/limit");
    for Family { name, missions } in families(30_000) {
        if name.starts_with(&filter) {
            row(&name, &missions);
        }
    }
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
        "{name:<50} {:>8.3} ms {:>8.3} ms {plans:>9}/{none}/{limit}",
        times[times.len() / 2],
        times[times.len() - 1]
    );
}
