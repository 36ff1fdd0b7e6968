//! Random missions as RMPL text, for tests and benchmarks: nested parallel, sequence and choose, bounds, conditions and
//! threats, like the random plans of the temporal plan network literature.
//!
//! A mission is built around a hidden witness schedule, so that feasible ones are feasible by construction and the
//! boundary is where it is said to be. The same recipe gives the same text on every machine.

use std::collections::BTreeMap;
use std::fmt::Write as _;

/// A small seeded generator (`SplitMix64`, Steele, Lea and Flood 2014): good enough for test data, and for nothing else.
#[derive(Clone, Debug)]
pub struct Rng(u64);

impl Rng {
    /// A generator that always gives the same numbers for the same seed.
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 bits.
    pub const fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        bits ^ (bits >> 31)
    }

    /// A number in `0..count`; 0 if `count` is 0.
    pub const fn below(&mut self, count: u64) -> u64 {
        if count == 0 { 0 } else { self.next_u64() % count }
    }

    /// A number in `least..=greatest`.
    pub const fn between(&mut self, least: i64, greatest: i64) -> i64 {
        least + self.below((greatest - least + 1) as u64) as i64
    }

    /// True in `percent` of 100 cases.
    pub const fn chance(&mut self, percent: u64) -> bool {
        self.below(100) < percent
    }
}

/// How much room a mission leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Tightness {
    /// Has a plan, with slack.
    Feasible,
    /// Has a plan, but hardly: composites, supports and the horizon leave no slack around the witness.
    Boundary,
    /// Has none: a boundary mission with one thing, late in the text, that misses by a single unit.
    Infeasible,
}

/// What to generate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Recipe {
    /// About how many nodes the network will have.
    pub nodes: usize,
    /// How much room it leaves.
    pub tightness: Tightness,
    /// Selects one of the missions.
    pub seed: u64,
}

/// The text of a mission; see the module's description.
pub fn mission(recipe: Recipe) -> String {
    let mut generator = Generator {
        rng: Rng::new(recipe.seed ^ (recipe.nodes as u64).rotate_left(32)),
        tightness: recipe.tightness,
        nodes: 2,
        supports: BTreeMap::new(),
        uses: BTreeMap::new(),
        support_variables: 1 + recipe.nodes as u64 / 60,
        mode_variables: 1 + recipe.nodes as u64 / 120,
    };
    let thread_count = match recipe.nodes {
        0..=60 => 2,
        61..=400 => 3,
        401..=3000 => 6,
        _ => 12,
    };
    let mut threads = Vec::new();
    let mut makespan = 0;
    for index in 0..thread_count {
        let budget = recipe.nodes * (index + 1) / thread_count;
        let (text, end) = generator.thread(budget);
        makespan = makespan.max(end);
        threads.push(text);
    }
    makespan = makespan.max(generator.latest_support());
    if recipe.tightness != Tightness::Feasible {
        let (text, end) = generator.bottleneck(recipe.tightness == Tightness::Infeasible);
        makespan = makespan.max(end);
        threads.push(text);
    }
    threads.extend(generator.exogenous());
    let horizon = match recipe.tightness {
        Tightness::Feasible => makespan + makespan / 4 + 10,
        Tightness::Boundary | Tightness::Infeasible => makespan,
    };
    let mut text = format!("// A random mission: {recipe:?}\nscenario Random[0,{horizon}] = {{\n");
    for (index, thread) in threads.iter().enumerate() {
        let separator = if index + 1 < threads.len() { "," } else { "" };
        let _ = writeln!(text, "  {{ {thread} }}{separator}");
    }
    text.push_str("}\n");
    text
}

struct Generator {
    rng: Rng,
    tightness: Tightness,
    /// About how many nodes the text so far compiles to.
    nodes: usize,
    /// Per supported variable, when the witness requires it.
    supports: BTreeMap<u64, Vec<(i64, i64)>>,
    /// Per mode variable, when the witness asserts which value.
    uses: BTreeMap<u64, Vec<(i64, i64, u64)>>,
    support_variables: u64,
    mode_variables: u64,
}

impl Generator {
    /// One thread of the scenario, until about `budget` nodes exist in all; its witness end.
    fn thread(&mut self, budget: usize) -> (String, i64) {
        let mut items = Vec::new();
        let mut now = 0;
        while items.is_empty() || self.nodes < budget {
            let depth = 1 + self.rng.below(3) as u32;
            let (text, end) = self.piece(depth, now, true);
            items.push(text);
            now = end;
        }
        (items.join("; "), now)
    }

    /// A statement that starts at `now` in the witness, and when it ends there. Pieces off the witness record nothing.
    fn piece(&mut self, depth: u32, now: i64, is_witness: bool) -> (String, i64) {
        if depth == 0 {
            return self.leaf(now, is_witness);
        }
        match self.rng.below(10) {
            0..=3 => self.sequence(depth, now, is_witness),
            4..=6 => self.parallel(depth, now, is_witness),
            _ => self.choose(depth, now, is_witness),
        }
    }

    fn sequence(&mut self, depth: u32, now: i64, is_witness: bool) -> (String, i64) {
        let mut items = Vec::new();
        let mut end = now;
        for _ in 0..self.rng.between(2, 4) {
            let (text, next) = self.piece(depth - 1, end, is_witness);
            items.push(text);
            end = next;
        }
        let bounds = self.composite_bounds(end - now);
        (format!("{{ {} }}{bounds}", items.join("; ")), end)
    }

    fn parallel(&mut self, depth: u32, now: i64, is_witness: bool) -> (String, i64) {
        let mut branches = Vec::new();
        let mut end = now;
        self.nodes += 2;
        for _ in 0..self.rng.between(2, 3) {
            let (text, branch_end) = self.piece(depth - 1, now, is_witness);
            branches.push(text);
            end = end.max(branch_end);
        }
        let bounds = self.composite_bounds(end - now);
        (format!("{{ {} }}{bounds}", branches.join(", ")), end)
    }

    fn choose(&mut self, depth: u32, now: i64, is_witness: bool) -> (String, i64) {
        let count = self.rng.between(2, 3);
        let chosen = self.rng.between(0, count - 1);
        let mut alternatives = Vec::new();
        let mut end = now;
        self.nodes += 2;
        for index in 0..count {
            let (text, alternative_end) = self.piece(depth - 1, now, is_witness && index == chosen);
            alternatives.push(text);
            if index == chosen {
                end = alternative_end;
            }
        }
        (format!("choose {{ {} }}", alternatives.join(", ")), end)
    }

    fn leaf(&mut self, now: i64, is_witness: bool) -> (String, i64) {
        let duration = self.rng.between(2, 20);
        self.nodes += 2;
        match self.rng.below(20) {
            0..=2 => self.supported(now, duration, is_witness),
            3 => self.mode(now, duration, is_witness),
            4 => (format!("delay[0,{}]", duration * 2), now + self.rng.between(0, duration)),
            _ => {
                let activity = self.rng.below(12);
                (format!("Task{activity}(){}", self.leaf_bounds(duration)), now + duration)
            }
        }
    }

    /// An activity that needs a condition which an exogenous thread will assert; off the witness perhaps one that
    /// nothing asserts.
    fn supported(&mut self, now: i64, duration: i64, is_witness: bool) -> (String, i64) {
        let bounds = self.leaf_bounds(duration);
        let activity = self.rng.below(12);
        if !is_witness && self.rng.chance(40) {
            return (format!("do Task{activity}(){bounds} maintaining BLOCKED=no"), now + duration);
        }
        let variable = self.rng.below(self.support_variables);
        if is_witness {
            self.supports.entry(variable).or_default().push((now, now + duration));
        }
        (format!("do Task{activity}(){bounds} maintaining LIGHT{variable}=on"), now + duration)
    }

    /// An assertion that threatens the others of its variable, with the freedom to wait for its turn.
    fn mode(&mut self, now: i64, duration: i64, is_witness: bool) -> (String, i64) {
        let variable = self.rng.below(self.mode_variables);
        let value = self.rng.below(3);
        self.nodes += 1;
        let mut start = now;
        if is_witness {
            let uses = self.uses.entry(variable).or_default();
            uses.sort_unstable();
            for &(from, to, other) in uses.iter() {
                if other != value && from <= start + duration && start <= to {
                    start = to + 1;
                }
            }
            uses.push((start, start + duration, value));
        }
        let bounds = self.leaf_bounds(duration);
        (format!("{{ delay[0,inf]; MODE{variable}=m{value} {bounds} }}"), start + duration)
    }

    fn leaf_bounds(&mut self, duration: i64) -> String {
        let slack = match self.tightness {
            Tightness::Feasible => 4,
            Tightness::Boundary | Tightness::Infeasible => 1,
        };
        let lower = (duration - self.rng.between(0, slack)).max(0);
        format!("[{lower},{}]", duration + self.rng.between(0, slack))
    }

    fn composite_bounds(&mut self, duration: i64) -> String {
        if self.rng.chance(60) {
            return String::new();
        }
        self.nodes += 1;
        match self.tightness {
            Tightness::Feasible => format!("[0,{}]", duration + duration / 4 + 5),
            Tightness::Boundary | Tightness::Infeasible => format!("[0,{duration}]"),
        }
    }

    /// Three assertions that exclude each other in just enough time, or in one unit less.
    fn bottleneck(&mut self, misses: bool) -> (String, i64) {
        let lengths = [self.rng.between(3, 9), self.rng.between(3, 9), self.rng.between(3, 9)];
        let needed = lengths.iter().sum::<i64>() + 2;
        let branches: Vec<String> = (lengths.iter().enumerate())
            .map(|(index, length)| format!("{{ delay[0,inf]; ARM=a{index} [{length},{length}] }}"))
            .collect();
        let upper = if misses { needed - 1 } else { needed };
        self.nodes += 9;
        (format!("{{ {} }}[0,{upper}]", branches.join(", ")), needed)
    }

    fn latest_support(&self) -> i64 {
        self.supports.values().flatten().map(|&(_, to)| to).max().unwrap_or(0)
    }

    /// The threads that assert what the witness requires, with as much slack as the tightness allows.
    fn exogenous(&mut self) -> Vec<String> {
        let supports = std::mem::take(&mut self.supports);
        let mut threads = Vec::new();
        for (variable, mut intervals) in supports {
            intervals.sort_unstable();
            let mut merged: Vec<(i64, i64)> = Vec::new();
            for (from, to) in intervals {
                match merged.last_mut() {
                    Some(last) if from <= last.1 + 1 => last.1 = last.1.max(to),
                    _ => merged.push((from, to)),
                }
            }
            let mut now = 0;
            let mut items = Vec::new();
            for (from, to) in merged {
                items.push(format!("delay[{0},{0}]; LIGHT{variable}=on [{1},{1}]", from - now, to - from));
                now = to;
            }
            threads.push(items.join("; "));
        }
        threads
    }
}
