//! Shortest schedules of activities that share resources, found and proven: ours beside aries and CP-SAT.
//!
//! A project is chains of activities, each with a duration and what it takes of each resource. Ours gets it as a mission
//! (`resource … capacity`, `uses`, `objective minimize end`), CP-SAT as cumulative constraints, aries as `no_overlap` where
//! a resource serves one at a time, and otherwise task by task: what runs at its start takes no more than there is.

use anyhow::Result;
use aries_solver::prelude::{Interval, LinSum, Lit, Model, SearchLimit, Solver, Var, leq, no_overlap, or};
use serde::Serialize;
use tpn::families::JOB_SHOPS;
use tpn::generate::Rng;

use super::proofs::{self, Answer, LIMIT, network_of};
use crate::stopwatch::Stopwatch;
use crate::table::Table;
use crate::tools::Tools;

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

/// Prints the table.
pub(crate) fn compare(tools: &mut Tools, quick: bool) -> Result<()> {
    let mut table = Table::new("Resources: shortest schedules, proven", &proofs::COLUMNS);
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
    let files = proofs::files(tools, "resources", name, projects)?;
    let ours: Vec<Answer> = projects.iter().map(ours).collect();
    let theirs: Vec<Answer> = projects.iter().map(aries).collect();
    let cp_sat = proofs::of_python(tools, "resources.py", &files);
    let rows = [("ours", Ok(ours)), ("aries-solver 0.6.0", Ok(theirs)), ("OR-tools CP-SAT", cp_sat)];
    proofs::add_rows(table, name, projects.len(), &rows);
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
    proofs::ours(&network_of(&project.text()), |plan| plan.quality.end)
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
        Ok(Some((value, _))) => Answer { value: Some(i64::from(value)), is_proven: true, total, first: None },
        Ok(None) => Answer { value: None, is_proven: true, total, first: None },
        Err(_) => Answer { value: best, is_proven: false, total, first: None },
    }
}
