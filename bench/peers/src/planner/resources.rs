//! Shortest schedules of activities that share resources, found and proven: ours beside aries and CP-SAT.
//!
//! A project is chains of activities, each with a duration and what it takes of each resource. Ours gets it as a mission
//! (`resource … capacity`, `uses`, `objective minimize end`), CP-SAT as cumulative constraints, aries as `no_overlap` where
//! a resource serves one at a time, and otherwise task by task: what runs at its start takes no more than there is.

use std::fs;
use std::process::Command;
use std::time::Duration;

use anyhow::Result;
use aries_solver::prelude::{Interval, LinSum, Lit, Model, SearchLimit, Solver, Var, leq, no_overlap, or};
use kirk::{Options, Stats};
use serde::{Deserialize, Serialize};
use tpn::compile::{Top, compile};
use tpn::families::JOB_SHOPS;
use tpn::generate::Rng;

use crate::stopwatch::Stopwatch;
use crate::table::{Table, figure, median, millis, quantile};
use crate::tools::{Tools, answer, source_path};

/// How long a solver may take for one project.
const LIMIT: Duration = Duration::from_secs(10);

/// What is to be scheduled.
#[derive(Serialize)]
struct Project {
    capacities: Vec<i64>,
    /// Activities that follow each other, perhaps with pauses.
    chains: Vec<Vec<Activity>>,
}

#[derive(Serialize)]
struct Activity {
    duration: i64,
    /// Of each resource.
    amounts: Vec<i64>,
}

/// The best end that was found, whether it is proven, and the time it took.
#[derive(Clone, Copy, Debug)]
struct Answer {
    end: Option<i64>,
    is_proven: bool,
    total: Duration,
}

/// Prints the table.
pub(crate) fn compare(tools: &mut Tools, quick: bool) -> Result<()> {
    let mut table = Table::new(
        "Resources: shortest schedules, proven",
        &[
            "projects",
            "number",
            "solver",
            "median ms",
            "worst ms",
            "unproven",
            "longer than the best known",
            "agrees",
        ],
    );
    let count = if quick { 2 } else { 5 };
    let small = JOB_SHOPS.iter().filter(|shop| shop.name != "ft10");
    let mut families = vec![(
        "job shops ft06, la01 to la05".to_owned(),
        small.take(if quick { 1 } else { 6 }).map(|shop| Project::of_shop(&shop.jobs())).collect(),
    )];
    for (tasks, resources) in [(10, 1), (20, 1), (40, 1), (10, 3), (20, 3), (30, 3)] {
        let what =
            if resources == 1 { "loose activities, one resource" } else { "in chains, three resources" };
        let projects: Vec<Project> =
            (1..=count).map(|seed| Project::random(tasks, resources, seed)).collect();
        families.push((format!("{tasks} {what}"), projects));
    }
    for (name, projects) in families {
        compare_family(tools, &mut table, &name, &projects)?;
    }
    table.note("Times are of the processor and hold encoding, the first schedule and the proof, from a compiled network in memory, one try each; a project whose proof is missing counts with the ten seconds it had. CP-SAT has one worker and its presolve.");
    table.print();
    Ok(())
}

fn compare_family(tools: &mut Tools, table: &mut Table, name: &str, projects: &[Project]) -> Result<()> {
    let folder = tools.folder("resources")?;
    let mut files = Vec::new();
    for (index, project) in projects.iter().enumerate() {
        let file = folder.join(format!("{}-{index}.json", name.replace(' ', "-")));
        fs::write(&file, serde_json::to_vec(project)?)?;
        files.push(file);
    }
    let ours: Vec<Answer> = projects.iter().map(ours).collect();
    let theirs: Vec<Answer> = projects.iter().map(aries).collect();
    let cp_sat = tools.python().and_then(|python| {
        let mut command = Command::new(python);
        command.arg(source_path("resources.py")).arg(LIMIT.as_secs().to_string());
        let text = answer(command.args(&files), LIMIT * (2 * files.len() as u32 + 2))?;
        text.lines().map(python_answer).collect::<Result<Vec<Answer>, String>>()
    });
    let rows = [("ours", Ok(ours)), ("aries-solver 0.6.0", Ok(theirs)), ("OR-tools CP-SAT", cp_sat)];
    let found: Vec<&Vec<Answer>> = rows.iter().filter_map(|(_, answers)| answers.as_ref().ok()).collect();
    let best: Vec<Option<i64>> = (0..projects.len())
        .map(|index| found.iter().filter_map(|answers| answers[index].end).min())
        .collect();
    for (solver, answers) in &rows {
        let mut cells = vec![name.to_owned(), projects.len().to_string(), (*solver).to_owned()];
        match answers {
            Ok(answers) => {
                let times: Vec<f64> = answers.iter().map(|answer| millis(answer.total)).collect();
                let unproven = answers.iter().filter(|answer| !answer.is_proven).count();
                let pairs = || answers.iter().zip(&best);
                let longer = pairs().filter(|(answer, best)| answer.end != **best).count();
                let is_wrong = pairs().any(|(answer, best)| answer.is_proven && answer.end != *best);
                cells.extend([
                    figure(median(&times)),
                    figure(quantile(&times, 1.0)),
                    unproven.to_string(),
                    longer.to_string(),
                    if is_wrong { "NO" } else { "yes" }.to_owned(),
                ]);
            }
            Err(why) => cells.push(why.clone()),
        }
        table.row(cells);
    }
    Ok(())
}

impl Project {
    fn of_shop(jobs: &[Vec<(i64, i64)>]) -> Self {
        let machines = jobs.iter().flatten().map(|&(machine, _)| machine + 1).max().unwrap_or(0);
        let activity = |&(machine, duration): &(i64, i64)| Activity {
            duration,
            amounts: (0..machines).map(|other| i64::from(other == machine)).collect(),
        };
        Self {
            capacities: vec![1; machines as usize],
            chains: jobs.iter().map(|job| job.iter().map(activity).collect()).collect(),
        }
    }

    fn random(tasks: usize, resources: usize, seed: u64) -> Self {
        let mut random = Rng::new(seed << 32 | (tasks as u64) << 8 | resources as u64);
        let capacities = (0..resources).map(|_| random.between(8, 12)).collect();
        let mut chains: Vec<Vec<Activity>> = Vec::new();
        let mut left = tasks as i64;
        while left > 0 {
            let length = if resources == 1 { 1 } else { random.between(2, 5).min(left) };
            left -= length;
            let mut activity = || Activity {
                duration: random.between(1, 10),
                amounts: (0..resources)
                    .map(|_| if resources == 1 || random.chance(60) { random.between(1, 6) } else { 0 })
                    .collect(),
            };
            chains.push((0..length).map(|_| activity()).collect());
        }
        Self { capacities, chains }
    }

    fn horizon(&self) -> i64 {
        self.chains.iter().flatten().map(|activity| activity.duration).sum()
    }

    fn text(&self) -> String {
        let mut text = String::new();
        for (index, capacity) in self.capacities.iter().enumerate() {
            text.push_str(&format!("resource R{index} capacity {capacity};\n"));
        }
        let mut branches = Vec::new();
        let mut number = 0;
        for chain in &self.chains {
            let mut steps = Vec::new();
            for Activity { duration, amounts } in chain {
                let used = amounts.iter().enumerate().filter(|&(_, &amount)| amount > 0);
                let uses: Vec<String> =
                    used.map(|(resource, amount)| format!("R{resource} {amount}")).collect();
                let clause =
                    if uses.is_empty() { String::new() } else { format!(" uses {}", uses.join(", ")) };
                text.push_str(&format!("primitive A{number}()[{duration},{duration}]{clause};\n"));
                steps.push(format!("delay; A{number}()"));
                number += 1;
            }
            branches.push(format!("{{ {} }}", steps.join("; ")));
        }
        let (horizon, branches) = (self.horizon(), branches.join(", "));
        text.push_str(&format!("objective minimize end;\nscenario S[0,{horizon}] = {{ {branches} }}\n"));
        text
    }
}

fn ours(project: &Project) -> Answer {
    let (network, diagnostics) = compile(&rmpl::parse(&project.text()).program(), &Top::Scenario(None));
    let network = network.unwrap_or_else(|| panic!("does not compile: {diagnostics:?}"));
    let options = Options { explain: false, relax: false, ..Options::default() };
    let start = Stopwatch::start();
    let mut asked = 0_u32;
    let mut is_over = |_: &Stats| {
        asked += 1;
        asked.is_multiple_of(64) && start.elapsed() > LIMIT
    };
    let outcome = std::hint::black_box(kirk::plan(&network, &options, &mut is_over));
    let total = start.elapsed();
    let plan = outcome.plans.first();
    let end = plan.and_then(|plan| plan.quality.end.to_string().parse().ok());
    Answer { end, is_proven: plan.is_some_and(|plan| plan.quality.is_optimal == Some(true)), total }
}

fn aries(project: &Project) -> Answer {
    let start = Stopwatch::start();
    let mut model = Model::new();
    let horizon = project.horizon() as i32;
    // Of each activity its start, its duration and what it takes.
    let mut tasks: Vec<(Var, i32, &[i64])> = Vec::new();
    for chain in &project.chains {
        let mut before: Option<(Var, i32)> = None;
        for activity in chain {
            let duration = activity.duration as i32;
            let begins: Var = model.new_variable(0, horizon - duration);
            if let Some((before, lasted)) = before {
                model.enforce(leq(before + lasted, begins));
            }
            before = Some((begins, duration));
            tasks.push((begins, duration, &activity.amounts));
        }
    }
    for (resource, &capacity) in project.capacities.iter().enumerate() {
        let takers = || tasks.iter().filter(move |(_, _, amounts)| amounts[resource] > 0);
        if capacity == 1 {
            let own: Vec<Interval> = takers()
                .map(|&(begins, duration, _)| Interval::new_fixed_duration(begins, duration))
                .collect();
            model.enforce(no_overlap(own));
            continue;
        }
        for &(begins, _, amounts) in takers() {
            let mut taken = LinSum::cst(amounts[resource] as i32);
            for &(other, lasted, amounts) in takers().filter(|other| other.0 != begins) {
                let runs = model.new_variable(0, 1);
                let has_begun: Lit = model.reify(leq(other, begins));
                let is_over: Lit = model.reify(leq(other + lasted, begins));
                model.enforce(or([runs.geq(1), !has_begun, is_over]));
                taken += runs * (amounts[resource] as i32);
            }
            model.enforce(leq(taken, capacity as i32));
        }
    }
    let end: Var = model.new_variable(0, horizon);
    let ends: Vec<_> = tasks.iter().map(|&(begins, lasted, _)| begins + lasted).collect();
    for last in ends {
        model.enforce(leq(last, end));
    }
    let mut best = None;
    let mut solver = Solver::new(model);
    let found = solver.minimize_with_callback(
        end,
        |value, _| best = Some(i64::from(value)),
        SearchLimit::duration(LIMIT),
    );
    let total = start.elapsed();
    match found {
        Ok(Some((value, _))) => Answer { end: Some(i64::from(value)), is_proven: true, total },
        Ok(None) => Answer { end: None, is_proven: true, total },
        Err(_) => Answer { end: best, is_proven: false, total },
    }
}

fn python_answer(line: &str) -> Result<Answer, String> {
    #[derive(Deserialize)]
    struct Line {
        end: Option<i64>,
        is_proven: bool,
        total_s: f64,
    }
    let Line { end, is_proven, total_s } = serde_json::from_str(line).map_err(|error| error.to_string())?;
    Ok(Answer { end, is_proven, total: Duration::from_secs_f64(total_s) })
}
