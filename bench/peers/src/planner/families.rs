//! First plans, and proofs that there is none, of missions by families (`tpn::families`): ours beside aries.
//!
//! A mission counts as unsolved after [`LIMIT`]. Ratios are of each mission alone, aries to ours; a solver that gave up
//! counts with the time it was given, and a mission that both gave up on does not count.

use std::time::Duration;

use kirk::{Options, Stats};
use tpn::Network;
use tpn::compile::{Top, compile};
use tpn::families::{Family, families};

use super::instance::Instance;
use super::{Answer, Verdict, aries, best, verdict};
use crate::stopwatch::Stopwatch;
use crate::table::{Table, figure, median, millis, quantile, ratio};

/// How long a solver may take for one mission.
const LIMIT: Duration = Duration::from_secs(10);

/// Prints the table of the families whose names begin with one of `wanted`; all if there are none.
pub(crate) fn compare(wanted: &[String], quick: bool) {
    let mut table = Table::new(
        "Planner, by families: first plan, or proof that there is none",
        &[
            "family",
            "missions",
            "ours ms: median",
            "90 %",
            "worst",
            "unsolved",
            "aries ms: median",
            "90 %",
            "worst",
            "unsolved",
            "times as fast: median",
            "worst",
            "agrees",
        ],
    );
    for family in families(if quick { 1_000 } else { 10_000 }) {
        if wanted.is_empty() || wanted.iter().any(|name| family.name.starts_with(name)) {
            table.row(row(&family));
        }
    }
    table.note("Times are of the processor and hold encoding and solving, from a compiled network in memory; each mission counts with its best of up to twenty tries within a third of a second, in both solvers alike. Unsolved after ten seconds of one try.");
    table.print();
}

fn row(family: &Family) -> Vec<String> {
    let mut answers = Vec::new();
    for text in &family.missions {
        let network = network(text);
        let instance = Instance::of(&network);
        let ours = repeated(|| ours(&network));
        let theirs = repeated(|| aries::solve(&instance, LIMIT));
        answers.push((ours, theirs));
    }
    let ours: Vec<Answer> = answers.iter().map(|&(ours, _)| ours).collect();
    let theirs: Vec<Answer> = answers.iter().map(|&(_, theirs)| theirs).collect();
    let mut cells = vec![family.name.clone(), family.missions.len().to_string()];
    cells.extend(columns(&ours));
    cells.extend(columns(&theirs));
    let is_open = |answer: Answer| answer.verdict == Verdict::Limit;
    let compared = answers.iter().filter(|&&(ours, theirs)| !is_open(ours) || !is_open(theirs));
    let times: Vec<f64> =
        compared.map(|(ours, theirs)| theirs.total.as_secs_f64() / ours.total.as_secs_f64()).collect();
    cells.extend([ratio(median(&times), 1.0), ratio(quantile(&times, 0.0), 1.0)]);
    let agrees = |&(ours, theirs): &(Answer, Answer)| {
        is_open(ours) || is_open(theirs) || ours.verdict == theirs.verdict
    };
    cells.push(if answers.iter().all(agrees) { "yes" } else { "NO" }.to_owned());
    cells
}

fn columns(answers: &[Answer]) -> [String; 4] {
    let times: Vec<f64> = answers.iter().map(|answer| millis(answer.total)).collect();
    let unsolved = answers.iter().filter(|answer| answer.verdict == Verdict::Limit).count();
    [
        figure(median(&times)),
        figure(quantile(&times, 0.9)),
        figure(quantile(&times, 1.0)),
        if unsolved == 0 { "–".to_owned() } else { unsolved.to_string() },
    ]
}

/// The best of as many tries as fit into a third of a second.
fn repeated(mut solve: impl FnMut() -> Answer) -> Answer {
    let first = solve();
    let tries = (0.3 / first.total.as_secs_f64().max(1e-6)).min(20.0) as u32;
    if tries < 2 {
        return first;
    }
    let again = best(tries, solve);
    if again.total < first.total { again } else { first }
}

fn ours(network: &Network) -> Answer {
    let options = Options { explain: false, relax: false, ..Options::default() };
    let start = Stopwatch::start();
    let mut asked = 0_u32;
    let mut is_over = |_: &Stats| {
        asked += 1;
        asked.is_multiple_of(64) && start.elapsed() > LIMIT
    };
    let outcome = std::hint::black_box(kirk::plan(network, &options, &mut is_over));
    Answer { verdict: verdict(outcome.status), encoding: Duration::ZERO, total: start.elapsed() }
}

fn network(text: &str) -> Network {
    let (network, diagnostics) = compile(&rmpl::parse(text).program(), &Top::Scenario(None));
    network.unwrap_or_else(|| panic!("does not compile: {diagnostics:?}\n{text}"))
}
