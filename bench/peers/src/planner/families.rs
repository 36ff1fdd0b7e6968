//! First plans, and proofs that there is none, of missions by families (`tpn::families`): ours beside aries.
//!
//! A mission counts as unsolved after [`LIMIT`]. Ratios are of each mission alone, aries to ours; a solver that gave up
//! counts with the time it was given, and a mission that both gave up on does not count.

use std::path::{Path, PathBuf};
use std::time::Duration;

use kirk::{Options, Stats};
use tpn::Network;
use tpn::compile::{Top, compile};
use tpn::families::{Family, families};
use interchange::Source;

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
            "90%",
            "worst",
            "unsolved",
            "aries ms: median",
            "90%",
            "worst",
            "unsolved",
            "times as fast: median",
            "worst",
            "agrees",
        ],
    );
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|wanted| name.starts_with(wanted));
    for Family { name, missions } in families(if quick { 1_000 } else { 30_000 }) {
        if is_wanted(&name) {
            let networks: Vec<Network> = missions.iter().map(|text| network(text)).collect();
            table.row(row(&name, &networks));
        }
    }
    if is_wanted(REAL) {
        match real_networks() {
            networks if networks.is_empty() => table.note("No file of `../shared/data/tpn` is here."),
            networks => table.row(row(REAL, &networks)),
        }
    }
    table.note("Times are of the processor and hold encoding and solving, from a compiled network in memory; each mission counts with its best of up to twenty tries within a third of a second, in both solvers alike. Unsolved after ten seconds of one try.");
    table.print();
}

/// The networks that another tool's authors wrote.
const REAL: &str = "plan-schema networks by others";

/// Those of `../shared/data/tpn` that can be read; none where that is absent.
fn real_networks() -> Vec<Network> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/tpn");
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    let texts = paths.iter().filter_map(|path| std::fs::read_to_string(path).ok());
    texts.filter_map(|text| Some(Source::read(&text).ok()?.into_network())).collect()
}

fn row(name: &str, networks: &[Network]) -> Vec<String> {
    let mut answers = Vec::new();
    for network in networks {
        let instance = Instance::of(network);
        let ours = repeated(|| ours(network));
        let theirs = repeated(|| aries::solve(&instance, LIMIT));
        answers.push((ours, theirs));
    }
    let ours: Vec<Answer> = answers.iter().map(|&(ours, _)| ours).collect();
    let theirs: Vec<Answer> = answers.iter().map(|&(_, theirs)| theirs).collect();
    let mut cells = vec![name.to_owned(), networks.len().to_string()];
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
