//! Missions that no one made up for a planner: scheduling problems of the literature, and simple shapes that are hard for
//! searches that do not learn, as RMPL text for tests and benchmarks.
//!
//! Machines of a shop are variables: each operation asserts its job on its machine, so that operations of different jobs
//! exclude each other. The instances are those of Fisher and Thompson (1963, `ft`) and Lawrence (1984, `la`).

use std::fmt::Write as _;

use crate::generate::Rng;

/// A job shop: by job, its operations in order, each with its machine and its duration.
#[derive(Clone, Copy, Debug)]
pub struct JobShop {
    /// Its name in the literature.
    pub name: &'static str,
    /// The least time in which it can be done.
    pub optimum: i64,
    /// One line per job: machine, duration, machine, duration, …
    operations: &'static str,
}

/// The job shops, smallest first.
pub const JOB_SHOPS: [JobShop; 7] = [
    JobShop {
        name: "ft06",
        optimum: 55,
        operations: "2 1 0 3 1 6 3 7 5 3 4 6\n1 8 2 5 4 10 5 10 0 10 3 4\n2 5 3 4 5 8 0 9 1 1 4 7\n\
                     1 5 0 5 2 5 3 3 4 8 5 9\n2 9 1 3 4 5 5 4 0 3 3 1\n1 3 3 3 5 9 0 10 4 4 2 1",
    },
    JobShop {
        name: "la01",
        optimum: 666,
        operations: "1 21 0 53 4 95 3 55 2 34\n0 21 3 52 4 16 2 26 1 71\n3 39 4 98 1 42 2 31 0 12\n\
                     1 77 0 55 4 79 2 66 3 77\n0 83 3 34 2 64 1 19 4 37\n1 54 2 43 4 79 0 92 3 62\n\
                     3 69 4 77 1 87 2 87 0 93\n2 38 0 60 1 41 3 24 4 83\n3 17 1 49 4 25 0 44 2 98\n\
                     4 77 3 79 2 43 1 75 0 96",
    },
    JobShop {
        name: "la02",
        optimum: 655,
        operations: "0 20 3 87 1 31 4 76 2 17\n4 25 2 32 0 24 1 18 3 81\n1 72 2 23 4 28 0 58 3 99\n\
                     2 86 1 76 4 97 0 45 3 90\n4 27 0 42 3 48 2 17 1 46\n1 67 0 98 4 48 3 27 2 62\n\
                     4 28 1 12 3 19 0 80 2 50\n1 63 0 94 2 98 3 50 4 80\n4 14 0 75 2 50 1 41 3 55\n\
                     4 72 2 18 1 37 3 79 0 61",
    },
    JobShop {
        name: "la03",
        optimum: 597,
        operations: "1 23 2 45 0 82 4 84 3 38\n2 21 1 29 0 18 4 41 3 50\n2 38 3 54 4 16 0 52 1 52\n\
                     4 37 0 54 2 74 1 62 3 57\n4 57 0 81 1 61 3 68 2 30\n4 81 0 79 1 89 2 89 3 11\n\
                     3 33 2 20 0 91 4 20 1 66\n4 24 1 84 0 32 2 55 3 8\n4 56 0 7 3 54 2 64 1 39\n\
                     4 40 1 83 0 19 2 8 3 7",
    },
    JobShop {
        name: "la04",
        optimum: 590,
        operations: "0 12 2 94 3 92 4 91 1 7\n1 19 3 11 4 66 2 21 0 87\n1 14 0 75 3 13 4 16 2 20\n\
                     2 95 4 66 0 7 3 7 1 77\n1 45 3 6 4 89 0 15 2 34\n3 77 2 20 0 76 4 88 1 53\n\
                     2 74 1 88 0 52 3 27 4 9\n1 88 3 69 0 62 4 98 2 52\n2 61 4 9 0 62 1 52 3 90\n\
                     2 54 4 5 3 59 1 15 0 88",
    },
    JobShop {
        name: "la05",
        optimum: 593,
        operations: "1 72 0 87 4 95 2 66 3 60\n4 5 3 35 0 48 2 39 1 54\n1 46 3 20 2 21 0 97 4 55\n\
                     0 59 3 19 4 46 1 34 2 37\n4 23 2 73 3 25 1 24 0 28\n3 28 0 45 4 5 1 78 2 83\n\
                     0 53 3 71 1 37 4 29 2 12\n4 12 2 87 3 33 1 55 0 38\n2 49 3 83 1 40 0 48 4 7\n\
                     2 65 3 17 0 90 4 27 1 23",
    },
    JobShop {
        name: "ft10",
        optimum: 930,
        operations: "0 29 1 78 2 9 3 36 4 49 5 11 6 62 7 56 8 44 9 21\n\
                     0 43 2 90 4 75 9 11 3 69 1 28 6 46 5 46 7 72 8 30\n\
                     1 91 0 85 3 39 2 74 8 90 5 10 7 12 6 89 9 45 4 33\n\
                     1 81 2 95 0 71 4 99 6 9 8 52 7 85 3 98 9 22 5 43\n\
                     2 14 0 6 1 22 5 61 3 26 4 69 8 21 7 49 9 72 6 53\n\
                     2 84 1 2 5 52 3 95 8 48 9 72 0 47 6 65 4 6 7 25\n\
                     1 46 0 37 3 61 2 13 6 32 5 21 9 32 8 89 7 30 4 55\n\
                     2 31 0 86 1 46 5 74 4 32 6 88 8 19 9 48 7 36 3 79\n\
                     0 76 1 69 3 76 5 51 2 85 9 11 6 40 7 89 4 26 8 74\n\
                     1 85 0 13 2 61 6 7 8 64 9 76 5 47 3 52 4 90 7 45",
    },
];

/// Missions of one kind.
#[derive(Clone, Debug)]
pub struct Family {
    pub name: String,
    pub missions: Vec<String>,
}

/// All families, in sizes from ten to `max_nodes` nodes.
pub fn families(max_nodes: usize) -> Vec<Family> {
    let mut families = Vec::new();
    let mut add = |name: String, missions: Vec<String>| families.push(Family { name, missions });
    for (what, horizon) in JOB_SHOP_HORIZONS {
        let of = |shop: &JobShop| shop.mission(horizon(shop.optimum));
        let small = JOB_SHOPS.iter().filter(|shop| shop.name != "ft10");
        add(format!("job shops ft06, la01 to la05, {what}"), small.map(of).collect());
        let large = JOB_SHOPS.iter().filter(|shop| shop.name == "ft10");
        add(format!("job shop ft10, {what}"), large.map(of).collect());
    }
    for size in [3, 4, 5] {
        for percent in [100, 120] {
            let missions = (0..5).map(|seed| open_shop(size, percent, seed)).collect();
            add(format!("open shops {size} × {size}, {percent} % of the bound"), missions);
        }
    }
    for (missing, what) in [(0, "just enough time"), (1, "one unit missing")] {
        add(format!("pigeonholes, {what}"), [5, 12, 40, 100].map(|count| pigeonholes(count, missing)).into());
        let sizes = [(10, 5), (20, 10), (50, 20)];
        add(
            format!("symmetric choices, {what}"),
            sizes.map(|(count, ways)| symmetric(count, ways, missing)).into(),
        );
    }
    for (can_succeed, what) in [(true, "fits"), (false, "does not")] {
        let missions = [10, 100, 1_000, 5_000].map(|count| chain(count, can_succeed)).into();
        add(format!("chains whose end {what}"), missions);
    }
    for (asks, tells) in [(10, 6), (50, 20), (200, 40)] {
        for percent in [80, 100, 150] {
            let missions = (0..5).map(|seed| long_requirements(asks, tells, seed, percent)).collect();
            add(format!("{asks} requirements, {tells} assertions, {percent} % time"), missions);
        }
    }
    for (nodes, seeds) in [(100, 9), (1_000, 9), (3_000, 9), (10_000, 5), (30_000, 3)] {
        for percent in [90, 110, 200] {
            if nodes <= max_nodes {
                let missions = (0..seeds).map(|seed| nested(nodes, percent, seed)).collect();
                add(format!("nested, {nodes} nodes, {percent} % time"), missions);
            }
        }
    }
    families
}

type Horizon = fn(i64) -> i64;

const JOB_SHOP_HORIZONS: [(&str, Horizon); 3] = [
    ("half as much again", |optimum| optimum * 3 / 2),
    ("the optimum", |optimum| optimum),
    ("one below", |optimum| optimum - 1),
];

impl JobShop {
    /// The jobs, each with its operations in order: a machine, and how long it takes.
    pub fn jobs(&self) -> Vec<Vec<(i64, i64)>> {
        let jobs = self.operations.lines().map(|line| {
            let numbers: Vec<i64> =
                line.split_ascii_whitespace().filter_map(|number| number.parse().ok()).collect();
            numbers.chunks_exact(2).map(|operation| (operation[0], operation[1])).collect()
        });
        jobs.collect()
    }

    /// The shop as a mission that must be over by `horizon`.
    pub fn mission(&self, horizon: i64) -> String {
        let jobs = self.jobs();
        let branches = (0..).zip(&jobs).map(|(job, operations)| {
            let operation = |&(machine, duration): &(i64, i64)| {
                format!("delay[0,inf]; {}", use_of(machine, job, duration))
            };
            operations.iter().map(operation).collect::<Vec<_>>().join("; ")
        });
        scenario(&format!("{} by {horizon}", self.name), horizon, branches)
    }
}

/// An open shop: every job uses every machine once, in any order. `percent` of the least possible horizon.
pub fn open_shop(size: usize, percent: i64, seed: u64) -> String {
    let mut rng = Rng::new(seed ^ (size as u64) << 40);
    let durations: Vec<Vec<i64>> =
        (0..size).map(|_| (0..size).map(|_| rng.between(1, 20)).collect()).collect();
    let jobs = durations.iter().map(|job| job.iter().sum::<i64>());
    let machines = (0..size).map(|machine| durations.iter().map(|job| job[machine]).sum::<i64>());
    let least = jobs.chain(machines).max().unwrap_or(0);
    let mut branches = Vec::new();
    for (job, durations) in (0..).zip(&durations) {
        for (machine, &duration) in (0..).zip(durations) {
            // A job is busy with one machine at a time.
            branches.push(format!(
                "delay[0,inf]; {{ {}, JOB{job}=m{machine} [{duration},{duration}] }}",
                use_of(machine, job, duration)
            ));
        }
    }
    scenario(&format!("open shop {size} seed {seed}"), least * percent / 100, branches)
}

/// `count` uses of one resource, ten minutes each, in a horizon that is `missing` too short.
pub fn pigeonholes(count: usize, missing: i64) -> String {
    let branches = (0..count as i64).map(|pigeon| format!("delay[0,inf]; {}", use_of(0, pigeon, 10)));
    scenario(&format!("{count} pigeons, {missing} missing"), count as i64 * 10 - missing, branches)
}

/// `count` choices between `ways` alternatives that are all alike, all of which use one resource, in a horizon that is
/// `missing` too short.
pub fn symmetric(count: usize, ways: usize, missing: i64) -> String {
    let branches = (0..count).map(|choice| {
        let way = |way: usize| format!("{{ delay[0,inf]; ARM=c{choice}w{way} [5,5] }}");
        format!("choose {{ {} }}", (0..ways).map(way).collect::<Vec<_>>().join(", "))
    });
    scenario(&format!("{count} choices of {ways} alike"), count as i64 * 5 - missing, branches)
}

/// `count` choices one after the other; that only the last alternative of the first one leaves what the last one needs
/// shows at the very end.
pub fn chain(count: usize, can_succeed: bool) -> String {
    let mut steps = vec!["choose { { KEY=a [1,1]; delay[0,0] }, { KEY=b [1,1]; delay[0,0] } }".to_owned()];
    for step in 0..count {
        let [one, other] = [step % 3 + 1, step % 2 + 1];
        steps.push(format!("choose {{ delay[{one},{}], STEP{step}=x [{other},{}] }}", one + 1, other + 2));
    }
    let needed = if can_succeed { "b" } else { "c" };
    let keys = "choose { { LOCK=a [1,inf] }, { LOCK=b [1,inf] } }";
    steps.push(format!("do {{ Open()[1,1] }} maintaining KEY={needed}"));
    let text = format!("{}; delay[0,0]", steps.join("; "));
    let horizon = count as i64 * 5 + 10;
    // The key holds for as long as its choice says.
    let text = text
        .replace("KEY=a [1,1]; delay[0,0]", "HAND=a [1,1]; delay[0,0]")
        .replace("KEY=b [1,1]; delay[0,0]", "HAND=b [1,1]; delay[0,0]");
    let keys = keys.replace("LOCK", "KEY");
    scenario(&format!("chain of {count}"), horizon, [text, keys])
}

/// `asks` long requirements and `tells` assertions of each of a few conditions that could carry them, where assertions of
/// other values stand in between.
pub fn long_requirements(asks: usize, tells: usize, seed: u64, percent: i64) -> String {
    let mut rng = Rng::new(seed ^ (asks as u64) << 20 ^ (tells as u64) << 40);
    let conditions = 1 + asks as u64 / 8;
    let mut branches = Vec::new();
    let mut length = 0;
    for condition in 0..conditions {
        let mut steps = Vec::new();
        let mut total = 0;
        for tell in 0..tells {
            let holds = rng.between(15, 40);
            total += holds + 4;
            let value = if tell % 2 == 0 { "day" } else { "night" };
            steps.push(format!("delay[1,4]; SKY{condition}={value} [{holds},{}]", holds + 5));
        }
        length = length.max(total);
        branches.push(steps.join("; "));
    }
    for ask in 0..asks {
        let (condition, needs) = (rng.below(conditions), rng.between(5, 14));
        let value = if rng.chance(60) { "day" } else { "night" };
        let (first, then) = (rng.between(0, 20), rng.between(5, 14));
        let other = rng.below(conditions);
        branches.push(format!(
            "delay[{first},inf]; do {{ Look{ask}()[{needs},{}] }} maintaining SKY{condition}={value}; delay[0,inf]; \
             do {{ Send{ask}()[{then},{}] }} maintaining SKY{other}=day",
            needs + 3,
            then + 3
        ));
    }
    scenario(
        &format!("{asks} requirements, {tells} assertions, seed {seed}"),
        length * percent / 100,
        branches,
    )
}

/// Deep nesting of sequence, parallel and choose, where 60 % of the steps have a condition. `percent` of a horizon that
/// is about long enough.
pub fn nested(nodes: usize, percent: i64, seed: u64) -> String {
    let mut nesting =
        Nesting { rng: Rng::new(seed ^ (nodes as u64).rotate_left(24)), variables: 2 + nodes as u64 / 50 };
    let threads = 2 + nodes / 500;
    let mut branches = Vec::new();
    let mut longest = 0;
    for _ in 0..threads {
        let (text, length) = nesting.block(nodes / threads / 3, 0);
        longest = longest.max(length);
        branches.push(text);
    }
    let horizon = longest * percent / 100 + 10;
    for variable in 0..nesting.variables {
        branches.push(format!("delay[0,inf]; LIGHT{variable}=on [{},inf]; delay[0,inf]", horizon * 3 / 4));
    }
    scenario(&format!("nested {nodes} {percent} % seed {seed}"), horizon, branches)
}

struct Nesting {
    rng: Rng,
    variables: u64,
}

impl Nesting {
    /// A block of about so many steps, and how long it takes at least if nothing waits.
    fn block(&mut self, steps: usize, depth: u32) -> (String, i64) {
        if steps <= 1 || depth > 40 {
            return self.step();
        }
        let parts = 2 + self.rng.below(3) as usize;
        let parts: Vec<(String, i64)> =
            (0..parts.min(steps)).map(|_| self.block(steps / parts, depth + 1)).collect();
        let texts: Vec<&str> = parts.iter().map(|(text, _)| text.as_str()).collect();
        let lengths = parts.iter().map(|&(_, length)| length);
        match self.rng.below(10) {
            0..=3 => (format!("{{ {} }}", texts.join("; ")), lengths.sum()),
            4..=6 => (format!("{{ {} }}", texts.join(", ")), lengths.max().unwrap_or(0)),
            _ => (format!("choose {{ {} }}", texts.join(", ")), lengths.max().unwrap_or(0)),
        }
    }

    fn step(&mut self) -> (String, i64) {
        let least = self.rng.between(1, 9);
        let bounds = format!("[{least},{}]", least + self.rng.between(0, 6));
        let variable = self.rng.below(self.variables);
        match self.rng.below(10) {
            0..=2 => {
                let value = self.rng.below(4);
                (format!("{{ delay[0,inf]; MODE{variable}=v{value} {bounds} }}"), least + 4)
            }
            3..=5 => {
                (format!("{{ delay[0,inf]; do {{ Work(){bounds} }} maintaining LIGHT{variable}=on }}"), least)
            }
            6 => (format!("delay{bounds}"), least),
            _ => (format!("Work(){bounds}"), least),
        }
    }
}

fn use_of(machine: i64, job: i64, duration: i64) -> String {
    format!("M{machine}=j{job} [{duration},{duration}]")
}

/// Parallel branches; touching is allowed, as it is in the literature.
fn scenario(title: &str, horizon: i64, branches: impl IntoIterator<Item = String>) -> String {
    let mut text = format!("// {title}\noption threat_gap = 0;\nscenario Mission[0,{horizon}] = {{\n");
    for (position, branch) in branches.into_iter().enumerate() {
        let separator = if position > 0 { ",\n" } else { "" };
        let _ = write!(text, "{separator}  {{ {branch}; delay[0,inf] }}");
    }
    text.push_str("\n}\n");
    text
}
