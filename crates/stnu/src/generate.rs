//! Seeded networks for tests and benchmarks: the same seed gives the same network everywhere.
//!
//! The kinds follow the public benchmarks of the field: workflows of nested sequences and parallel branches, job shops,
//! trees, and networks without structure around a hidden schedule.

use crate::network::{Link, Network, PointId};

/// A seeded generator of numbers (splitmix64).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The sequence of a seed.
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next number.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// A number below `bound`, which must not be 0.
    pub fn below(&mut self, bound: usize) -> usize {
        (self.bits() % bound as u64) as usize
    }

    /// A number from `least` to `greatest`, both included; the range must not be empty.
    pub fn between(&mut self, least: i64, greatest: i64) -> i64 {
        least + (self.bits() % (greatest - least + 1) as u64) as i64
    }

    /// True in `percent` of a hundred cases.
    pub fn chance(&mut self, percent: u64) -> bool {
        self.bits() % 100 < percent
    }
}

/// What a network is like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Nested sequences and parallel branches of tasks, with deadlines around blocks.
    Workflow,
    /// Jobs of operations in sequence, with a given order on each machine and a deadline for all.
    JobShop,
    /// Each point a while after an earlier one, with bounds between random pairs.
    Tree,
    /// Constraints between random points that a hidden schedule keeps, with slack.
    Scattered,
    /// The same, but only between points that the hidden schedule has near each other: many links await many others.
    Near,
}

/// The size and tightness of a network.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// What it is like.
    pub kind: Kind,
    /// About how many time points it has.
    pub points: usize,
    /// About how many contingent links it has.
    pub links: usize,
    /// By how many hundredths deadlines exceed what is needed if everything takes as long as it may. Workflows and job
    /// shops are controllable if it is not negative.
    pub slack_percent: i64,
}

/// The network of a seed.
pub fn network(shape: Shape, seed: u64) -> Network {
    let mut builder =
        Builder { network: Network::new(1), random: Random::new(seed), shape, tasks: 0, links: 0 };
    match shape.kind {
        Kind::Workflow => builder.workflow(),
        Kind::JobShop => builder.job_shop(),
        Kind::Tree => builder.tree(),
        Kind::Scattered => builder.scattered(),
        Kind::Near => builder.near(),
    }
    builder.network
}

struct Builder {
    network: Network,
    random: Random,
    shape: Shape,
    /// How many tasks there will be.
    tasks: usize,
    links: usize,
}

/// Two points and the most that can be between them.
struct Block {
    start: PointId,
    end: PointId,
    most: i64,
}

impl Builder {
    fn bound(&mut self, from: PointId, to: PointId, lower: i64, upper: Option<i64>) {
        if let Some(upper) = upper {
            self.network.add_edge(from, to, upper);
        }
        self.network.add_edge(to, from, -lower);
    }

    fn deadline(&self, most: i64) -> i64 {
        most + most * self.shape.slack_percent / 100
    }

    /// A task, contingent as often as makes the wanted number of links.
    fn task(&mut self) -> Block {
        let (start, end) = (self.network.add_point(), self.network.add_point());
        let lower = self.random.between(1, 30);
        let upper = lower + self.random.between(1, 30);
        if self.random.below(self.tasks.max(1)) < self.shape.links {
            let link = Link { activation: start, end, lower, upper };
            self.links += usize::from(self.network.add_link(link).is_ok());
        } else {
            self.bound(start, end, lower, Some(upper));
        }
        Block { start, end, most: upper }
    }

    fn workflow(&mut self) {
        // A task has two points; so has a parallel block, of which there are about a quarter as many.
        self.tasks = (self.shape.points * 2 / 5).max(1);
        let whole = self.block(self.tasks);
        self.bound(PointId(0), whole.start, 0, None);
        let deadline = self.deadline(whole.most);
        self.bound(whole.start, whole.end, 0, Some(deadline));
    }

    fn block(&mut self, tasks: usize) -> Block {
        if tasks <= 1 {
            return self.task();
        }
        let first = self.random.between(1, tasks as i64 - 1) as usize;
        if tasks == 2 || self.random.chance(60) {
            let (one, other) = (self.block(first), self.block(tasks - first));
            let gap = self.random.between(0, 10);
            let upper = if self.random.chance(50) { Some(gap + 20) } else { None };
            self.bound(one.end, other.start, gap, upper);
            return Block { start: one.start, end: other.end, most: one.most + gap + other.most };
        }
        let (start, end) = (self.network.add_point(), self.network.add_point());
        let mut most = 0;
        for part in [first, tasks - first] {
            let branch = self.block(part);
            self.bound(start, branch.start, 0, None);
            self.bound(branch.end, end, 0, None);
            most = most.max(branch.most);
        }
        if self.random.chance(30) {
            let deadline = self.deadline(most);
            self.bound(start, end, 0, Some(deadline));
        }
        Block { start, end, most }
    }

    fn job_shop(&mut self) {
        self.tasks = (self.shape.points / 2).max(1);
        let machines = (self.tasks as f64).sqrt().ceil() as usize;
        let mut free: Vec<Option<PointId>> = vec![None; machines];
        let mut machine_most = vec![0_i64; machines];
        let mut job: Option<PointId> = None;
        let (mut job_most, mut all_most) = (0_i64, 0_i64);
        for task in 0..self.tasks {
            if task.is_multiple_of(machines) {
                (job, job_most) = (None, 0);
            }
            // Each job visits the machines in an order of its own.
            let machine = (task + task / machines * 7) % machines;
            let Block { start, end, most } = self.task();
            for before in [job, free[machine]].into_iter().flatten() {
                self.bound(before, start, 0, None);
            }
            self.bound(PointId(0), start, 0, None);
            let begin = job_most.max(machine_most[machine]);
            (job, job_most) = (Some(end), begin + most);
            (free[machine], machine_most[machine]) = (Some(end), begin + most);
            all_most = all_most.max(begin + most);
        }
        let deadline = self.deadline(all_most);
        for end in free.into_iter().flatten() {
            self.network.add_edge(PointId(0), end, deadline);
        }
    }

    fn tree(&mut self) {
        let mut most = vec![0_i64];
        let mut links = self.shape.links;
        for child in 1..self.shape.points {
            let parent = self.random.below(child);
            let (parent_id, child_id) = (PointId(parent as u32), self.network.add_point());
            let lower = self.random.between(0, 20);
            let upper = lower + self.random.between(1, 20);
            most.push(most[parent] + upper);
            if self.random.below(self.shape.points - child) < links {
                links -= 1;
                // The child is new, so that it can end a link.
                let link = Link { activation: parent_id, end: child_id, lower, upper };
                self.links += usize::from(self.network.add_link(link).is_ok());
            } else {
                self.bound(parent_id, child_id, lower, Some(upper));
            }
        }
        for _ in 0..self.shape.points / 2 {
            let (one, other) = (self.random.below(most.len()), self.random.below(most.len()));
            let weight = self.deadline(most[other].max(most[one]));
            self.network.add_edge(PointId(one as u32), PointId(other as u32), weight);
        }
    }

    fn scattered(&mut self) {
        let hidden = self.hidden_schedule(10_000);
        for _ in 0..self.shape.points * 3 {
            let (from, to) = (self.random.below(hidden.len()), self.random.below(hidden.len()));
            let slack = self.random.between(0, 200) * (100 + self.shape.slack_percent).max(0) / 100;
            let weight = hidden[to] - hidden[from] + slack;
            self.network.add_edge(PointId(from as u32), PointId(to as u32), weight);
        }
    }

    fn near(&mut self) {
        let hidden = self.hidden_schedule(10 * self.shape.points as i64);
        let mut in_time: Vec<usize> = (0..hidden.len()).collect();
        in_time.sort_by_key(|&point| (hidden[point], point));
        for _ in 0..self.shape.points * 6 {
            let place = self.random.below(hidden.len());
            let other = (place + self.random.between(1, 30) as usize).min(hidden.len() - 1);
            let (mut from, mut to) = (in_time[place], in_time[other]);
            if self.random.chance(50) {
                (from, to) = (to, from);
            }
            let slack = self.random.between(60, 120) * (100 + self.shape.slack_percent).max(0) / 100;
            let weight = hidden[to] - hidden[from] + slack;
            self.network.add_edge(PointId(from as u32), PointId(to as u32), weight);
        }
    }

    /// Points with times, and contingent links between some of them.
    fn hidden_schedule(&mut self, horizon: i64) -> Vec<i64> {
        let mut hidden = vec![0];
        while self.network.num_points() < self.shape.points {
            let point = self.network.add_point();
            let activation = self.random.below(hidden.len());
            if self.random.below(self.shape.points) < self.shape.links * 2 {
                let lower = self.random.between(1, 30);
                let upper = lower + self.random.between(1, 30);
                hidden.push(hidden[activation] + self.random.between(lower, upper));
                let link = Link { activation: PointId(activation as u32), end: point, lower, upper };
                self.links += usize::from(self.network.add_link(link).is_ok());
            } else {
                hidden.push(self.random.between(0, horizon));
            }
        }
        hidden
    }
}
