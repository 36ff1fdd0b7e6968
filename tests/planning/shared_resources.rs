//! Activities that share resources: shortest schedules against all schedules that begin one activity after the other as
//! early as they can, among which the shortest one is (Sprecher, Kolisch and Drexl 1995).

use acceptance::mission::network;
use exact::Rational;
use kirk::{Options, Outcome, Status};
use tpn::generate::Rng;

/// Missions that are compared.
const MISSIONS: u64 = 150;

struct Activity {
    duration: i64,
    amounts: Vec<i64>,
    /// The one that comes before it in its branch.
    after: Option<usize>,
}

struct Project {
    capacities: Vec<i64>,
    activities: Vec<Activity>,
}

impl Project {
    fn random(seed: u64) -> Self {
        let mut random = Rng::new(seed);
        let mut whole = |low: i64, high: i64| random.between(low, high);
        let capacities: Vec<i64> = (0..whole(1, 2)).map(|_| whole(3, 7)).collect();
        let activities = (0..whole(4, 6) as usize)
            .map(|index| Activity {
                duration: whole(1, 5),
                amounts: capacities.iter().map(|&capacity| whole(0, (capacity - 1).min(4))).collect(),
                after: (index > 0 && whole(0, 2) == 0).then(|| index - 1),
            })
            .collect();
        Self { capacities, activities }
    }

    fn text(&self, horizon: i64, objective: &str) -> String {
        let mut text = String::new();
        for (index, capacity) in self.capacities.iter().enumerate() {
            text.push_str(&format!("resource R{index} capacity {capacity};\n"));
        }
        let mut branches: Vec<String> = Vec::new();
        for (index, activity) in self.activities.iter().enumerate() {
            let duration = activity.duration;
            let used = (0..).zip(&activity.amounts).filter(|&(_, &amount)| amount > 0);
            let uses: Vec<String> = used.map(|(resource, amount)| format!("R{resource} {amount}")).collect();
            let clause = if uses.is_empty() { String::new() } else { format!(" uses {}", uses.join(", ")) };
            text.push_str(&format!("primitive A{index}()[{duration},{duration}]{clause};\n"));
            match activity.after.and_then(|_| branches.last_mut()) {
                Some(branch) => branch.push_str(&format!("; delay; A{index}()")),
                None => branches.push(format!("delay; A{index}()")),
            }
        }
        let branches: Vec<String> = branches.iter().map(|branch| format!("{{ {branch} }}")).collect();
        text.push_str(&format!("{objective} scenario S[0,{horizon}] = {{ {} }}", branches.join(", ")));
        text
    }

    /// The end of the shortest schedule.
    fn shortest(&self) -> i64 {
        self.extend(&mut vec![None; self.activities.len()])
    }

    fn extend(&self, starts: &mut Vec<Option<i64>>) -> i64 {
        let end = |index: usize, start: i64| start + self.activities[index].duration;
        let mut shortest = i64::MAX;
        let mut is_whole = true;
        for index in 0..self.activities.len() {
            let before = self.activities[index].after.map(|before| (before, starts[before]));
            if starts[index].is_some() {
                continue;
            }
            is_whole = false;
            let from = match before {
                Some((_, None)) => continue,
                Some((before, Some(start))) => end(before, start),
                None => 0,
            };
            let start =
                (from..=200).find(|&start| self.fits(index, start, starts)).expect("there is room later");
            starts[index] = Some(start);
            shortest = shortest.min(self.extend(starts));
            starts[index] = None;
        }
        if is_whole {
            let ends = starts.iter().enumerate().filter_map(|(index, start)| Some(end(index, (*start)?)));
            return ends.max().unwrap_or(0);
        }
        shortest
    }

    fn fits(&self, index: usize, start: i64, starts: &[Option<i64>]) -> bool {
        let own = &self.activities[index];
        (start..start + own.duration).all(|time| {
            (0..self.capacities.len()).all(|resource| {
                let running = self.activities.iter().zip(starts).filter(|(other, begun)| {
                    begun.is_some_and(|begun| begun <= time && time < begun + other.duration)
                });
                let taken: i64 = running.map(|(other, _)| other.amounts[resource]).sum();
                taken + own.amounts[resource] <= self.capacities[resource]
            })
        })
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
