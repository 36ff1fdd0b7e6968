//! First plans, and proofs that there is none, of the same random missions by all planners.

mod aries;
pub(crate) mod families;
mod instance;
pub(crate) mod objectives;
mod proofs;
pub(crate) mod resources;

use std::fs;
use std::process::Command;
use std::time::Duration;

use anyhow::Result;
use instance::Instance;
use kirk::{ExpansionLimit, Options, Planner, Status};
use serde::Deserialize;
use tpn::Network;
use tpn::compile::{Top, compile};
use tpn::generate::{Recipe, Tightness, mission};

use crate::stopwatch::Stopwatch;
use crate::table::{Table, figure, median, millis, quantile, ratio};
use crate::tools::{Absent, Tools, answer, source_path};

/// How long a solver may take for one mission.
const LIMIT: Duration = Duration::from_secs(20);

/// What a solver found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Verdict {
    Plan,
    /// A proof that there is none.
    NoPlan,
    /// Neither in the time it had.
    Limit,
}

/// What a solver found, and how long it took.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answer {
    pub(crate) verdict: Verdict,
    /// The share of `total` for telling the solver the problem.
    pub(crate) encoding: Duration,
    pub(crate) total: Duration,
}

/// One mission in all its forms.
struct Case {
    network: Network,
    instance: Instance,
    seed: u64,
}

/// Prints one table.
pub(crate) fn compare(tools: &mut Tools, quick: bool) -> Result<()> {
    let mut table = Table::new(
        "Planner: first plan, or proof that there is none",
        &[
            "missions",
            "nodes",
            "solver",
            "median ms",
            "encoding ms",
            "worst ms",
            "of ours",
            "worst of ours",
            "plan / none / limit",
            "agrees",
        ],
    );
    let sizes: &[(usize, u64)] = if quick { &[(100, 3)] } else { &[(100, 15), (1_000, 15), (10_000, 7)] };
    for tightness in [Tightness::Feasible, Tightness::Boundary, Tightness::Infeasible] {
        for &(nodes, count) in sizes {
            compare_missions(tools, &mut table, tightness, nodes, count)?;
        }
    }
    table.note("Times are of the processor and hold encoding and solving, from a compiled network in memory; each mission is solved 100 times, from 10,000 nodes on ten times (CP-SAT and Z3 three times and once) and its best time counts. CP-SAT has one worker and no presolve.");
    table.note("All solvers but ours get one and the same constraint problem: choices, time bounds, causal links and the orders of conflicting conditions (`src/planner/instance.rs`).");
    table.print();
    Ok(())
}

fn compare_missions(
    tools: &mut Tools,
    table: &mut Table,
    tightness: Tightness,
    nodes: usize,
    count: u64,
) -> Result<()> {
    let folder = tools.folder("planner")?;
    let mut cases = Vec::new();
    let mut files = Vec::new();
    for seed in 0..count {
        let network = network(Recipe { nodes, tightness, seed });
        let instance = Instance::of(&network);
        let file = folder.join(format!("{tightness:?}-{nodes}-{seed}.json").to_lowercase());
        fs::write(&file, serde_json::to_vec(&instance)?)?;
        files.push(file);
        cases.push(Case { network, instance, seed });
    }
    let repeats = if nodes < 10_000 { 3 } else { 1 };
    // Small missions are over before caches and branch predictors have warmed up to them.
    let tries = (100_000 / nodes as u32).clamp(10, 100);
    let ours: Vec<Answer> = cases.iter().map(|case| best(tries, || ours(&case.network))).collect();
    let mut rows = vec![
        ("ours".to_owned(), Ok(ours.clone())),
        (
            "ours, again after one bound changed".to_owned(),
            Ok(cases.iter().filter_map(|case| again(&case.network, tries)).collect()),
        ),
        (
            "aries-solver 0.6.0".to_owned(),
            Ok(cases.iter().map(|case| best(tries, || aries::solve(&case.instance, LIMIT))).collect()),
        ),
    ];
    for (name, solver) in [("OR-tools CP-SAT", "cp-sat"), ("Z3", "z3")] {
        let answers = tools.python().and_then(|python| {
            let mut command = Command::new(python);
            command.arg(source_path("planner.py")).args([
                solver,
                &repeats.to_string(),
                &LIMIT.as_secs().to_string(),
            ]);
            let limit = LIMIT * (repeats * files.len() as u32 + 2);
            python_answers(&answer(command.args(&files), limit)?)
        });
        rows.push((name.to_owned(), answers));
    }
    let (our_median, our_worst) = summary(&ours);
    for (name, answers) in rows {
        let mut cells = vec![format!("{tightness:?}").to_lowercase(), nodes.to_string(), name.clone()];
        match answers {
            Ok(answers) => {
                let (middle, worst) = summary(&answers);
                let encoding: Vec<f64> = answers.iter().map(|answer| millis(answer.encoding)).collect();
                let number = |verdict| answers.iter().filter(|answer| answer.verdict == verdict).count();
                cells.extend([
                    figure(middle),
                    if name.starts_with("ours") { "–".to_owned() } else { figure(median(&encoding)) },
                    figure(worst),
                    ratio(middle, our_median),
                    ratio(worst, our_worst),
                    format!(
                        "{} / {} / {}",
                        number(Verdict::Plan),
                        number(Verdict::NoPlan),
                        number(Verdict::Limit)
                    ),
                    if name.contains("again") {
                        "–".to_owned()
                    } else {
                        agreement(&cases, &ours, &answers)
                    },
                ]);
            }
            Err(why) => cells.push(why),
        }
        table.row(cells);
    }
    Ok(())
}

/// Whether all verdicts are ours, or for which missions they are not.
fn agreement(cases: &[Case], ours: &[Answer], theirs: &[Answer]) -> String {
    let differ: Vec<String> = (cases.iter().zip(ours).zip(theirs))
        .filter(|((_, our), their)| {
            our.verdict != their.verdict && ![our.verdict, their.verdict].contains(&Verdict::Limit)
        })
        .map(|((case, our), their)| {
            format!("seed {}: {:?}, ours {:?}", case.seed, their.verdict, our.verdict)
        })
        .collect();
    if differ.is_empty() { "yes".to_owned() } else { format!("NO: {}", differ.join("; ")) }
}

fn summary(answers: &[Answer]) -> (f64, f64) {
    let times: Vec<f64> = answers.iter().map(|answer| millis(answer.total)).collect();
    (median(&times), quantile(&times, 1.0))
}

fn best(repeats: u32, mut solve: impl FnMut() -> Answer) -> Answer {
    let mut best = solve();
    for _ in 1..repeats {
        let answer = solve();
        if answer.total < best.total {
            best = answer;
        }
    }
    best
}

fn ours(network: &Network) -> Answer {
    plan(network, &Options { explain: false, relax: false, ..Options::default() })
}

fn plan(network: &Network, options: &Options) -> Answer {
    let start = Stopwatch::start();
    let outcome = std::hint::black_box(kirk::plan(network, options, &mut ExpansionLimit(20_000)));
    Answer { verdict: verdict(outcome.status), encoding: Duration::ZERO, total: start.elapsed() }
}

/// The best of planning again while one bound goes to and fro by a unit.
fn again(network: &Network, tries: u32) -> Option<Answer> {
    let is_activity = |arc: &tpn::Arc| arc.kind == tpn::ArcKind::Activity && arc.upper.finite().is_some();
    let position = network.arcs.iter().rposition(is_activity)?;
    let (lower, upper) = (network.arcs[position].lower, network.arcs[position].upper);
    let options = Options { explain: false, relax: false, ..Options::default() };
    let mut planner = Planner::new(network.clone(), None);
    let mut change = 0;
    let mut step = || {
        change += 1;
        let one = exact::Time::from(change % 2);
        let wider = upper.checked_add(exact::Bound::Finite(one)).unwrap_or(upper);
        let start = Stopwatch::start();
        planner.set_bounds(tpn::ArcId::from_index(position), lower, wider);
        let outcome = std::hint::black_box(planner.plan(&options, &mut ExpansionLimit(20_000)));
        Answer { verdict: verdict(outcome.status), encoding: Duration::ZERO, total: start.elapsed() }
    };
    step();
    Some(best(tries.max(5), step))
}

fn verdict(status: Status) -> Verdict {
    match status {
        Status::Plan => Verdict::Plan,
        Status::NoPlan => Verdict::NoPlan,
        Status::Limit | Status::Error => Verdict::Limit,
    }
}

fn network(recipe: Recipe) -> Network {
    let program = rmpl::parse(&mission(recipe)).program();
    let (network, diagnostics) = compile(&program, &Top::Scenario(None));
    network.unwrap_or_else(|| panic!("{recipe:?} does not compile: {diagnostics:?}"))
}

/// The answers of `planner.py`, one JSON object per line.
fn python_answers(text: &str) -> Result<Vec<Answer>, Absent> {
    #[derive(Deserialize)]
    struct Line {
        verdict: Verdict,
        encoding_s: f64,
        total_s: f64,
    }
    text.lines()
        .map(|line| {
            let line: Line = serde_json::from_str(line).map_err(|error| format!("failed: {error}"))?;
            Ok(Answer {
                verdict: line.verdict,
                encoding: Duration::from_secs_f64(line.encoding_s),
                total: Duration::from_secs_f64(line.total_s),
            })
        })
        .collect()
}
