//! An active schedule of what excludes each other at a complete choice: none of its intervals could begin earlier without
//! another one beginning later (Giffler and Thompson 1960).
//!
//! Where textual order has failed, tasks are placed one after the other, each as early as those placed before it allow. Of
//! those that compete for the place that ends first, the most urgent one by a priority rule gets it. Where none of a few
//! rules leads to times that fit, nothing is known, and the solver decides.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use tpn::LabelId;

use super::{Choices, Engine};
use crate::conditions::Conditions;
use crate::levels::Kind;
use crate::model::{INFINITE, node};
use crate::structure::Relation;
use crate::unplannable::Unplannable;

/// In one schedule, times move at most so often for each edge and pair there is.
const MAX_MOVES_EACH: usize = 8;
/// With more pairs than this they are ordered at once, if that can be done.
const MAX_PAIRS_IN_ORDER: usize = 16;
/// With more pairs than this they are ordered by rules before textual order is searched, whatever else was chosen.
const MAX_PAIRS_OF_CHOICE: usize = 20_000;
/// More pairs than this are left alone.
const MAX_PAIRS: usize = 1 << 23;
/// How many rivals in between are asked whether an order follows from theirs.
const MAX_ASKED: usize = 8;
/// The place of a task that has none yet.
const UNPLACED: u32 = u32::MAX;

/// What came of an attempt to choose all orders at once.
pub(super) enum Ordered {
    All,
    /// No schedule fits, and the search would hardly find one either.
    None,
    NotTried,
}

impl Engine<'_> {
    /// Before the first order is chosen: whether all of them could be chosen at once, as times that were given have them,
    /// or by a schedule. That may be the one in textual order, which the search would find, too; others only where there is
    /// nothing but orders to choose, or so many pairs that the search would take long to go through them.
    pub(super) fn order_at_once(&mut self) -> Result<Ordered, Unplannable> {
        let assumed = self.setup.assumed.as_ref().filter(|assumed| !assumed.times.is_empty());
        let given = assumed.filter(|_| !self.setup.orders_touching_last).map(|assumed| assumed.times.clone());
        let num_pairs = self.leaf.pairs.len();
        if given.is_none() && !(self.setup.schedules && num_pairs > MAX_PAIRS_IN_ORDER) {
            return Ok(Ordered::NotTried);
        }
        let Some(mut shop) = self.shop()? else { return Ok(Ordered::NotTried) };
        if let Some(times) = given {
            // What only touches must be forced to, which depends on what is ordered before it.
            let is_ordered = shop.is_schedule(times) && self.order_neighbours(&shop)?;
            return Ok(if is_ordered { Ordered::All } else { Ordered::NotTried });
        }
        let is_of_orders = self.model.decisions.is_empty() && self.leaf.asks.is_empty();
        if self.order_by(&mut shop, &[Rule::Textual])? {
            return Ok(Ordered::All);
        }
        if !is_of_orders && num_pairs <= MAX_PAIRS_OF_CHOICE {
            return Ok(Ordered::NotTried);
        }
        if self.order_by(&mut shop, &RULES)? {
            return Ok(Ordered::All);
        }
        Ok(if is_of_orders { Ordered::None } else { Ordered::NotTried })
    }

    /// Takes back the orders chosen so far and chooses those of an active schedule, if one is found. `false` if there is
    /// none, or what was chosen before is not complete.
    pub(crate) fn order_as_scheduled(&mut self) -> Result<bool, Unplannable> {
        self.drop_orders();
        let num_linked = self.levels.iter().filter(|level| matches!(level.kind, Kind::Link { .. })).count();
        if !self.leaf.is_ready || num_linked < self.leaf.asks.len() {
            return Ok(false);
        }
        match self.shop()? {
            Some(mut shop) => self.order_by(&mut shop, &RULES),
            None => Ok(false),
        }
    }

    /// Chooses the orders of the first of these schedules that there is.
    fn order_by(&mut self, shop: &mut Shop, rules: &[Rule]) -> Result<bool, Unplannable> {
        let Some(times) = rules.iter().find_map(|&rule| shop.schedule(rule)) else { return Ok(false) };
        self.stn.propose(times.iter().copied());
        let alternatives = vec![None; self.model.decisions.len()].into();
        let assumed = self.setup.assumed.replace(Choices { alternatives, times, ..Choices::default() });
        let is_ordered = self.order_neighbours(shop);
        self.setup.assumed = assumed;
        is_ordered
    }

    fn drop_orders(&mut self) {
        while matches!(self.levels.last().map(|level| &level.kind), Some(Kind::Threat { .. })) {
            if let Some(depth) = self.levels.last_key() {
                self.undo_alternative(depth);
                self.drop_level();
            }
        }
    }

    /// What there is to schedule: the pairs that neither nesting nor windows order.
    fn shop(&mut self) -> Result<Option<Shop>, Unplannable> {
        self.find_windows()?;
        let mut pairs = Vec::new();
        for position in 0..self.leaf.pairs.len() {
            let (left, right) = self.leaf.pairs[position];
            match self.ordered_by_windows(left, right) {
                Relation::Open => pairs.push(position as u32),
                order => self.leaf.is_swapped[position] = order == Relation::After,
            }
        }
        let is_small = !pairs.is_empty() && pairs.len() <= MAX_PAIRS;
        Ok(is_small.then(|| Shop::new(self, pairs)))
    }

    /// Orders what is scheduled one right after the other. The other pairs follow from that.
    fn order_neighbours(&mut self, shop: &Shop) -> Result<bool, Unplannable> {
        for &position in &shop.pairs {
            let (left, right) = self.leaf.pairs[position as usize];
            self.leaf.is_swapped[position as usize] = self.assumed_order(left, right) == Some(1);
        }
        for position in shop.neighbours(&self.model.conditions, &self.leaf.pairs) {
            let (left, right) = self.leaf.pairs[position as usize];
            match self.relation(left, right)? {
                Relation::Open => {
                    self.push_level(Kind::Threat { position, left, right });
                    if !self.try_alternatives()? {
                        self.drop_orders();
                        return Ok(false);
                    }
                }
                order => self.leaf.is_swapped[position as usize] = order == Relation::After,
            }
        }
        Ok(true)
    }
}

/// Sets of numbers by number, one behind the other.
struct Rows<T> {
    first: Vec<u32>,
    cells: Vec<T>,
}

impl<T: Copy + Default> Rows<T> {
    fn new(rows: usize, entries: impl Iterator<Item = (usize, T)> + Clone) -> Self {
        let mut first = vec![0_u32; rows + 1];
        for (row, _) in entries.clone() {
            first[row + 1] += 1;
        }
        for row in 0..rows {
            first[row + 1] += first[row];
        }
        let mut next = first.clone();
        let mut cells = vec![T::default(); first[rows] as usize];
        for (row, cell) in entries {
            cells[next[row] as usize] = cell;
            next[row] += 1;
        }
        Self { first, cells }
    }

    fn row(&self, row: usize) -> &[T] {
        &self.cells[self.range(row)]
    }

    fn range(&self, row: usize) -> std::ops::Range<usize> {
        self.first[row] as usize..self.first[row + 1] as usize
    }
}

/// Tasks over difference constraints: intervals that begin together, some of which exclude those of other tasks.
struct Shop {
    /// What there is to order, by position among the pairs of the leaf.
    pairs: Vec<u32>,
    /// The label of each interval, in ascending order.
    labels: Vec<LabelId>,
    /// The points at which each interval starts and ends.
    intervals: Vec<(usize, usize)>,
    /// The task of each interval.
    task_of: Vec<u32>,
    /// By task: its intervals.
    tasks: Rows<u32>,
    /// By interval: those that exclude it.
    rivals: Rows<u32>,
    /// By point: the intervals that end there.
    ending: Rows<u32>,
    /// By point: others that are at most so much earlier.
    edges: Rows<(u32, i64)>,
    gap: i64,
    earliest: Vec<i64>,
    latest: Vec<i64>,

    times: Vec<i64>,
    /// When each task is placed.
    place_of: Vec<u32>,
    num_placed: u32,
    /// By interval: how long its rivals without a place take together.
    work: Vec<i64>,
    moved: VecDeque<u32>,
    is_waiting: Vec<bool>,
    moves_left: usize,
}

/// What makes one task more urgent than another.
#[derive(Clone, Copy)]
enum Urgency {
    /// That it must begin early.
    LatestStart,
    /// How much work waits for what it uses, too.
    WorkOfAll,
    /// How much work waits for the most wanted of what it uses, too.
    WorkOfOne,
}

/// How a schedule is made.
#[derive(Clone, Copy)]
enum Rule {
    /// What is written first is placed first.
    Textual,
    /// Of those that can begin first, the most urgent one is placed, so that nothing waits without need.
    NonDelay(Urgency),
    /// Of those that can begin before the first one ends, the most urgent one is placed.
    Active(Urgency),
}

/// The rules that are tried, in this order.
const RULES: [Rule; 4] = [
    Rule::NonDelay(Urgency::WorkOfOne),
    Rule::NonDelay(Urgency::LatestStart),
    Rule::Active(Urgency::WorkOfAll),
    Rule::Active(Urgency::WorkOfOne),
];

impl Shop {
    fn new(engine: &Engine<'_>, pairs: Vec<u32>) -> Self {
        let both = |&position: &u32| <[LabelId; 2]>::from(engine.leaf.pairs[position as usize]);
        let mut labels: Vec<LabelId> = pairs.iter().flat_map(both).collect();
        labels.sort_unstable();
        labels.dedup();
        let mut number = vec![0_u32; engine.model.conditions.labels.len()];
        for (position, &label) in labels.iter().enumerate() {
            number[usize::from(label)] = position as u32;
        }
        let num_points = engine.stn.num_points();
        let mut task_at = vec![UNPLACED; num_points];
        let (mut intervals, mut task_of) = (Vec::new(), Vec::new());
        let mut num_tasks = 0;
        for &label in &labels {
            let (start, end) = engine.model.interval(label);
            intervals.push((start.index(), end.index()));
            let task = &mut task_at[engine.model.representative(node(start)).index()];
            if *task == UNPLACED {
                *task = num_tasks;
                num_tasks += 1;
            }
            task_of.push(*task);
        }
        let tasks = (0..).zip(&task_of).map(|(interval, &task)| (task as usize, interval));
        let tasks = Rows::new(num_tasks as usize, tasks);
        let rivals = pairs.iter().flat_map(|pair| {
            let [left, right] = both(pair).map(|label| number[usize::from(label)]);
            [(left as usize, right), (right as usize, left)]
        });
        let rivals = Rows::new(intervals.len(), rivals);
        let ending = (0..).zip(&intervals).map(|(interval, &(_, end))| (end, interval));
        let ending = Rows::new(num_points, ending);
        let stn = &engine.stn;
        let edges = (0..stn.num_edges()).filter_map(|position| stn.edge(position));
        let edges = edges.map(|edge| (edge.to.index(), (edge.from.index() as u32, edge.weight)));
        let edges = Rows::new(num_points, edges);
        let (latest, to_start) = engine.leaf.windows();
        let earliest = to_start.iter().map(|&distance| if distance == INFINITE { 0 } else { -distance });
        Self {
            times: Vec::new(),
            place_of: Vec::new(),
            num_placed: 0,
            work: Vec::new(),
            moved: VecDeque::new(),
            is_waiting: vec![false; num_points],
            moves_left: 0,
            gap: engine.model.gap,
            earliest: earliest.collect(),
            latest: latest.to_vec(),
            pairs,
            labels,
            intervals,
            task_of,
            tasks,
            rivals,
            ending,
            edges,
        }
    }

    /// Times by point that fit, if this attempt finds some.
    fn schedule(&mut self, rule: Rule) -> Option<Vec<i64>> {
        self.times.clone_from(&self.earliest);
        let num_tasks = self.tasks.first.len() - 1;
        self.place_of.clear();
        self.place_of.resize(num_tasks, UNPLACED);
        self.moves_left = MAX_MOVES_EACH * (self.edges.cells.len() + self.rivals.cells.len());
        self.num_placed = 0;
        let placed = match rule {
            Rule::Textual => (0..num_tasks).try_for_each(|task| self.place(task)),
            Rule::NonDelay(urgency) => self.place_by_urgency(urgency, true),
            Rule::Active(urgency) => self.place_by_urgency(urgency, false),
        };
        self.is_waiting.fill(false);
        self.moved.clear();
        placed.map(|()| self.times.clone())
    }

    /// Places all tasks. `None` if something comes too late.
    fn place_by_urgency(&mut self, urgency: Urgency, is_non_delay: bool) -> Option<()> {
        self.sum_work();
        let tasks = 0..self.place_of.len();
        let mut waiting: BinaryHeap<Reverse<(i64, usize)>> =
            tasks.map(|task| Reverse((self.end(task), task))).collect();
        while let Some(Reverse((end, first))) = waiting.pop() {
            if self.place_of[first] != UNPLACED {
                continue;
            }
            let now = self.end(first);
            if now > end {
                waiting.push(Reverse((now, first)));
                continue;
            }
            let chosen = self.most_urgent(first, urgency, is_non_delay);
            if chosen != first {
                waiting.push(Reverse((end, first)));
            }
            self.reduce_work(chosen);
            self.place(chosen)?;
        }
        Some(())
    }

    /// Takes these times for a schedule. `false` if they leave less than the gap between some pair.
    fn is_schedule(&mut self, times: Vec<i64>) -> bool {
        self.times = times;
        let ranks = self.ranks();
        (0..self.intervals.len()).all(|interval| {
            let end = self.times[self.intervals[interval].1];
            let rivals = self.rivals.row(interval).iter().map(|&rival| rival as usize);
            let mut later = rivals.filter(|&rival| ranks[rival] > ranks[interval]);
            later.all(|rival| self.times[self.intervals[rival].0].checked_sub(end) >= Some(self.gap))
        })
    }

    /// Which interval comes first in the schedule; instants at one time as they are written.
    fn ranks(&self) -> Vec<u32> {
        let mut order: Vec<usize> = (0..self.intervals.len()).collect();
        order.sort_by_key(|&interval| {
            let (start, end) = self.intervals[interval];
            (self.times[start], self.times[end])
        });
        let mut ranks = vec![0; order.len()];
        for (rank, interval) in (0..).zip(order) {
            ranks[interval] = rank;
        }
        ranks
    }

    /// The pairs, in textual order, from whose orders in the schedule found last those of all others follow.
    ///
    /// Of two rivals that come after an interval and exclude each other, the later one comes after the earlier one. Few
    /// rivals are asked for that: an order too many is harmless.
    fn neighbours(&self, conditions: &Conditions, pairs: &[(LabelId, LabelId)]) -> Vec<u32> {
        let ranks = self.ranks();
        let mut neighbours = Vec::new();
        let (mut later, mut next) = (Vec::new(), Vec::new());
        for interval in 0..self.intervals.len() {
            let rivals = self.rivals.row(interval).iter().map(|&rival| rival as usize);
            later.clear();
            later.extend(rivals.filter(|&rival| ranks[rival] > ranks[interval]));
            later.sort_unstable_by_key(|&rival| ranks[rival]);
            next.clear();
            for &rival in &later {
                let start = self.times[self.intervals[rival].0];
                let follows = next.iter().rev().take(MAX_ASKED).any(|&between: &usize| {
                    self.times[self.intervals[between].1] <= start
                        && conditions.conflict(self.labels[between], self.labels[rival])
                });
                if !follows {
                    next.push(rival);
                    let (one, other) = (self.labels[interval], self.labels[rival]);
                    neighbours.push((one.min(other), one.max(other)));
                }
            }
        }
        neighbours.sort_unstable();
        let positions = neighbours.iter().filter_map(|pair| {
            let at = self.pairs.binary_search_by(|&position| pairs[position as usize].cmp(pair));
            at.ok().map(|at| self.pairs[at])
        });
        positions.collect()
    }

    fn sum_work(&mut self) {
        self.work.clear();
        for interval in 0..self.intervals.len() {
            let durations = self.rivals.row(interval).iter().map(|&rival| self.duration(rival as usize));
            self.work.push(durations.fold(0, i64::saturating_add));
        }
    }

    /// The least time that an interval takes.
    fn duration(&self, interval: usize) -> i64 {
        let (start, end) = self.intervals[interval];
        self.earliest[end] - self.earliest[start]
    }

    /// Where a task begins.
    fn start_point(&self, task: usize) -> usize {
        self.intervals[self.tasks.row(task)[0] as usize].0
    }

    /// When a task begins, as things stand.
    fn start(&self, task: usize) -> i64 {
        self.times[self.start_point(task)]
    }

    /// When a task ends, as things stand.
    fn end(&self, task: usize) -> i64 {
        let ends =
            self.tasks.row(task).iter().map(|&interval| self.times[self.intervals[interval as usize].1]);
        ends.max().unwrap_or(0)
    }

    /// Of a task and its rivals that compete for its place, the one that is hurried most.
    fn most_urgent(&self, first: usize, urgency: Urgency, is_non_delay: bool) -> usize {
        let by_urgency = |task: usize| {
            let intervals = self.tasks.row(task);
            let works = intervals.iter().map(|&interval| self.work[interval as usize]);
            let work = match urgency {
                Urgency::LatestStart => 0,
                Urgency::WorkOfAll => works.fold(0, i64::saturating_add),
                Urgency::WorkOfOne => works.max().unwrap_or(0),
            };
            let start = self.start_point(task);
            (self.latest[start].saturating_sub(work), self.times[start], task)
        };
        let rivals = self.tasks.row(first).iter().flat_map(|&interval| self.rivals.row(interval as usize));
        let rivals = rivals.map(|&rival| self.task_of[rival as usize] as usize);
        let rivals = rivals.filter(|&rival| self.place_of[rival] == UNPLACED);
        let end = if is_non_delay {
            rivals.clone().map(|rival| self.start(rival)).min().unwrap_or(i64::MAX).min(self.start(first)) + 1
        } else {
            self.end(first)
        };
        let competing = rivals.chain([first]).filter(|&task| self.start(task) < end);
        competing.min_by_key(|&task| by_urgency(task)).unwrap_or(first)
    }

    /// What is placed waits for nothing.
    fn reduce_work(&mut self, placed: usize) {
        for position in self.tasks.range(placed) {
            let interval = self.tasks.cells[position] as usize;
            let duration = self.duration(interval);
            for position in self.rivals.range(interval) {
                let rival = self.rivals.cells[position] as usize;
                self.work[rival] = self.work[rival].saturating_sub(duration);
            }
        }
    }

    /// Places a task, and makes its rivals without a place begin after it. `None` if something comes too late then.
    fn place(&mut self, task: usize) -> Option<()> {
        self.place_of[task] = self.num_placed;
        self.num_placed += 1;
        for position in self.tasks.range(task) {
            let interval = self.tasks.cells[position] as usize;
            for position in self.rivals.range(interval) {
                let rival = self.rivals.cells[position] as usize;
                if self.place_of[self.task_of[rival] as usize] == UNPLACED {
                    let time = self.times[self.intervals[interval].1].saturating_add(self.gap);
                    self.delay(self.intervals[rival].0, time)?;
                    self.settle()?;
                }
            }
        }
        Some(())
    }

    /// Moves a point to `time` at the earliest.
    fn delay(&mut self, point: usize, time: i64) -> Option<()> {
        if time <= self.times[point] {
            return Some(());
        }
        if time > self.latest[point] || self.moves_left == 0 {
            return None;
        }
        self.moves_left -= 1;
        self.times[point] = time;
        if !self.is_waiting[point] {
            self.is_waiting[point] = true;
            self.moved.push_back(point as u32);
        }
        Some(())
    }

    /// Moves what has to move with the points that have moved.
    fn settle(&mut self) -> Option<()> {
        while let Some(point) = self.moved.pop_front() {
            let point = point as usize;
            self.is_waiting[point] = false;
            let time = self.times[point];
            for position in self.edges.range(point) {
                let (other, weight) = self.edges.cells[position];
                self.delay(other as usize, time.saturating_sub(weight))?;
            }
            for position in self.ending.range(point) {
                let ended = self.ending.cells[position] as usize;
                let place = self.place_of[self.task_of[ended] as usize];
                if place == UNPLACED {
                    continue;
                }
                for position in self.rivals.range(ended) {
                    let rival = self.rivals.cells[position] as usize;
                    if self.place_of[self.task_of[rival] as usize] > place {
                        self.delay(self.intervals[rival].0, time.saturating_add(self.gap))?;
                    }
                }
            }
        }
        Some(())
    }
}
