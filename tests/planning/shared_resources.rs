//! Activities that share resources: shortest schedules against all schedules that begin one activity after the other as
//! early as they can, among which the shortest one is (Sprecher, Kolisch and Drexl 1995).

use acceptance::mission::network;
use exact::Rational;
use kirk::{Options, Outcome, Status};
use tpn::generate::Rng;

/// Missions that are compared.
const MISSIONS: u64 = 600;

struct Activity {
    duration: i64,
    amounts: Vec<i64>,
}

/// Activities that start together.
struct Block {
    activities: Vec<Activity>,
    /// The one that comes before it in its branch.
    after: Option<usize>,
}

struct Project {
    capacities: Vec<i64>,
    blocks: Vec<Block>,
}

impl Project {
    fn random(seed: u64) -> Self {
        let mut random = Rng::new(seed);
        let mut whole = |low: i64, high: i64| random.between(low, high);
        let capacities: Vec<i64> = (0..whole(1, 2)).map(|_| whole(3, 7)).collect();
        let blocks = (0..whole(4, 5) as usize)
            .map(|index| {
                let together = 1 + whole(0, 3) / 3;
                let activities = (0..together).map(|_| Activity {
                    duration: whole(1, 5),
                    amounts: capacities
                        .iter()
                        .map(|&capacity| whole(0, (capacity / together).min(4)))
                        .collect(),
                });
                let activities: Vec<Activity> = activities.collect();
                Block { activities, after: (index > 0 && whole(0, 2) == 0).then(|| index - 1) }
            })
            .collect();
        Self { capacities, blocks }
    }

    fn text(&self, horizon: i64, objective: &str) -> String {
        let mut text = String::new();
        for (index, capacity) in self.capacities.iter().enumerate() {
            text.push_str(&format!("resource R{index} capacity {capacity};\n"));
        }
        let mut branches: Vec<String> = Vec::new();
        for (index, block) in self.blocks.iter().enumerate() {
            let mut calls = Vec::new();
            for (part, Activity { duration, amounts }) in block.activities.iter().enumerate() {
                let used = (0..).zip(amounts).filter(|&(_, &amount)| amount > 0);
                let uses: Vec<String> =
                    used.map(|(resource, amount)| format!("R{resource} {amount}")).collect();
                let clause =
                    if uses.is_empty() { String::new() } else { format!(" uses {}", uses.join(", ")) };
                text.push_str(&format!("primitive A{index}{part}()[{duration},{duration}]{clause};\n"));
                calls.push(format!("A{index}{part}()"));
            }
            let block_text = format!("delay; {{ {} }}", calls.join(", "));
            match block.after.and_then(|_| branches.last_mut()) {
                Some(branch) => branch.push_str(&format!("; {block_text}")),
                None => branches.push(block_text),
            }
        }
        let branches: Vec<String> = branches.iter().map(|branch| format!("{{ {branch} }}")).collect();
        text.push_str(&format!("{objective} scenario S[0,{horizon}] = {{ {} }}", branches.join(", ")));
        text
    }

    /// The end of the shortest schedule.
    fn shortest(&self) -> i64 {
        self.extend(&mut vec![None; self.blocks.len()])
    }

    fn extend(&self, starts: &mut Vec<Option<i64>>) -> i64 {
        let mut shortest = i64::MAX;
        let mut is_complete = true;
        for index in 0..self.blocks.len() {
            let before = self.blocks[index].after.map(|before| (before, starts[before]));
            if starts[index].is_some() {
                continue;
            }
            is_complete = false;
            let from = match before {
                Some((_, None)) => continue,
                Some((before, Some(start))) => start + self.blocks[before].duration(),
                None => 0,
            };
            let start =
                (from..=200).find(|&start| self.fits(index, start, starts)).expect("there is room later");
            starts[index] = Some(start);
            shortest = shortest.min(self.extend(starts));
            starts[index] = None;
        }
        if is_complete {
            let ends = self
                .blocks
                .iter()
                .zip(starts)
                .filter_map(|(block, start)| Some((*start)? + block.duration()));
            return ends.max().unwrap_or(0);
        }
        shortest
    }

    fn fits(&self, index: usize, start: i64, starts: &[Option<i64>]) -> bool {
        let own = &self.blocks[index];
        (0..own.duration()).all(|time| {
            (0..self.capacities.len()).all(|resource| {
                let begun =
                    self.blocks.iter().zip(starts).filter_map(|(block, begun)| Some((block, (*begun)?)));
                let taken: i64 =
                    begun.map(|(block, begun)| block.takes(resource, start + time - begun)).sum();
                taken + own.takes(resource, time) <= self.capacities[resource]
            })
        })
    }
}

impl Block {
    fn duration(&self) -> i64 {
        self.activities.iter().map(|activity| activity.duration).max().unwrap_or(0)
    }

    /// Returns what it takes some time after its start.
    fn takes(&self, resource: usize, time: i64) -> i64 {
        let running = self.activities.iter().filter(|activity| (0..activity.duration).contains(&time));
        running.map(|activity| activity.amounts[resource]).sum()
    }
}

fn planned(text: &str) -> Outcome {
    let outcome = kirk::plan(&network(text), &Options::default(), &mut kirk::Unlimited);
    for plan in &outcome.plans {
        let verdict = verify::check_plan(&network(text), plan);
        assert!(verdict.valid, "{text}\n{verdict:?}");
    }
    outcome
}

#[test]
fn the_shortest_schedules_are_found_and_nothing_shorter() {
    for seed in 0..MISSIONS {
        let project = Project::random(seed);
        let shortest = project.shortest();
        let text = project.text(200, "objective minimize end;");
        let outcome = planned(&text);
        let quality = &outcome.plans[0].quality;
        assert_eq!(quality.is_optimal, Some(true), "{text}");
        assert_eq!(quality.end.units(), Rational::from(shortest), "{text}");
        assert_eq!(planned(&project.text(shortest, "")).status, Status::Plan, "{text}");
        let short = project.text(shortest - 1, "");
        assert_eq!(planned(&short).status, Status::NoPlan, "{short}");
    }
}

#[test]
fn work_that_does_not_fit_is_refused_before_anything_is_tried() {
    // Of eight, twelve activities of five each exclude each other, and twelve of three fill the gaps: 12 * 5 units of time.
    let large: Vec<String> = (0..12).map(|_| "{ delay; Large() }".to_owned()).collect();
    let small: Vec<String> = (0..12).map(|_| "{ delay; Small() }".to_owned()).collect();
    let text = |horizon: u32| {
        format!(
            "resource Power capacity 8; primitive Large()[5,5] uses Power 5; primitive Small()[5,5] uses Power 3;
            scenario S[0,{horizon}] = {{ {}, {} }}",
            large.join(", "),
            small.join(", ")
        )
    };
    assert_eq!(planned(&text(60)).status, Status::Plan);
    let refused = Options { explain: false, relax: false, ..Options::default() };
    let outcome = kirk::plan(&network(&text(59)), &refused, &mut kirk::Unlimited);
    assert_eq!(outcome.status, Status::NoPlan);
    assert!(outcome.stats.conflicts < 100, "{:?}", outcome.stats);
}
