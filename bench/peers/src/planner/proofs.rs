//! Solvers that look for the best and prove it, side by side.

use std::fs;
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

use anyhow::Result;
use exact::Time;
use kirk::{Options, Stats};
use serde::{Deserialize, Serialize};
use tpn::compile::{Top, compile};
use tpn::{Network, Plan};

use crate::stopwatch::Stopwatch;
use crate::table::{Table, figure, median, millis, quantile};
use crate::tools::{Tools, answer, source_path};

/// How long a solver may take for one instance.
pub(super) const LIMIT: Duration = Duration::from_secs(10);

/// What is told of each solver.
pub(super) const COLUMNS: [&str; 9] = [
    "instances",
    "number",
    "solver",
    "median ms",
    "worst ms",
    "first median ms",
    "unproven",
    "worse than the best known",
    "agrees",
];

/// The least value that was found, whether it is proven, and the time it took.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer {
    pub(super) value: Option<i64>,
    pub(super) is_proven: bool,
    pub(super) total: Duration,
    /// Until there was any solution, where that is known.
    pub(super) first: Option<Duration>,
}

/// The network of a mission.
pub(super) fn network_of(text: &str) -> Network {
    let (network, diagnostics) = compile(&rmpl::parse(text).program(), &Top::Scenario(None));
    network.unwrap_or_else(|| panic!("does not compile: {diagnostics:?}"))
}

/// Writes instances for other programs.
pub(super) fn files(
    tools: &Tools,
    folder: &str,
    name: &str,
    instances: &[impl Serialize],
) -> Result<Vec<PathBuf>> {
    let folder = tools.folder(folder)?;
    let mut files = Vec::new();
    for (index, instance) in instances.iter().enumerate() {
        let file = folder.join(format!("{}-{index}.json", name.replace(' ', "-")));
        fs::write(&file, serde_json::to_vec(instance)?)?;
        files.push(file);
    }
    Ok(files)
}

/// Ours, from a compiled network; without an objective it gives the first plan.
pub(super) fn ours(network: &Network, value: impl Fn(&Plan) -> Time) -> Answer {
    let (_, first) = timed(&Network { objective: Vec::new(), ..network.clone() });
    let (outcome, total) = timed(network);
    let plan = outcome.plans.first();
    Answer {
        value: plan.and_then(|plan| value(plan).to_string().parse().ok()),
        is_proven: plan.is_some_and(|plan| plan.quality.is_optimal == Some(true)),
        total,
        first: Some(first),
    }
}

fn timed(network: &Network) -> (kirk::Outcome, Duration) {
    let options = Options { explain: false, relax: false, ..Options::default() };
    let start = Stopwatch::start();
    let mut asked = 0_u32;
    let mut is_over = |_: &Stats| {
        asked += 1;
        asked.is_multiple_of(64) && start.elapsed() > LIMIT
    };
    let outcome = std::hint::black_box(kirk::plan(network, &options, &mut is_over));
    (outcome, start.elapsed())
}

/// Returns what a script answers, a line for each file.
pub(super) fn of_python(tools: &mut Tools, script: &str, files: &[PathBuf]) -> Result<Vec<Answer>, String> {
    let mut command = Command::new(tools.python()?);
    command.arg(source_path(script)).arg(LIMIT.as_secs().to_string());
    let text = answer(command.args(files), LIMIT * (2 * files.len() as u32 + 2))?;
    text.lines().map(python_answer).collect()
}

fn python_answer(line: &str) -> Result<Answer, String> {
    #[derive(Deserialize)]
    struct Line {
        value: Option<i64>,
        is_proven: bool,
        total_s: f64,
        first_s: Option<f64>,
    }
    let Line { value, is_proven, total_s, first_s } =
        serde_json::from_str(line).map_err(|error| error.to_string())?;
    let [total, first] = [Some(total_s), first_s].map(|time| time.map(Duration::from_secs_f64));
    Ok(Answer { value, is_proven, total: total.unwrap_or_default(), first })
}

/// Adds a row for each solver.
pub(super) fn add_rows(
    table: &mut Table,
    name: &str,
    count: usize,
    rows: &[(&str, Result<Vec<Answer>, String>)],
) {
    let found: Vec<&Vec<Answer>> = rows.iter().filter_map(|(_, answers)| answers.as_ref().ok()).collect();
    let best: Vec<Option<i64>> =
        (0..count).map(|index| found.iter().filter_map(|answers| answers[index].value).min()).collect();
    for (solver, answers) in rows {
        let mut cells = vec![name.to_owned(), count.to_string(), (*solver).to_owned()];
        match answers {
            Ok(answers) => {
                let times: Vec<f64> = answers.iter().map(|answer| millis(answer.total)).collect();
                let first: Option<Vec<f64>> = answers.iter().map(|answer| answer.first.map(millis)).collect();
                let unproven = answers.iter().filter(|answer| !answer.is_proven).count();
                let pairs = || answers.iter().zip(&best);
                let worse = pairs().filter(|(answer, best)| answer.value != **best).count();
                let is_wrong = pairs().any(|(answer, best)| answer.is_proven && answer.value != *best);
                cells.extend([
                    figure(median(&times)),
                    figure(quantile(&times, 1.0)),
                    first.map_or_else(|| "–".to_owned(), |first| figure(median(&first))),
                    unproven.to_string(),
                    worse.to_string(),
                    if is_wrong { "NO" } else { "yes" }.to_owned(),
                ]);
            }
            Err(why) => cells.push(why.clone()),
        }
        table.row(cells);
    }
}
