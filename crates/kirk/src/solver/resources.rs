//! Resources (SPEC 11): where a solution takes more than there is, one of the orders that would fix it must hold.
//!
//! Uses that together take more than a resource has are a minimal critical set, and one of them must end before another
//! one starts (Laborie and Ghallab 1995). Of a reservoir that would run low, one of the productions that come too late
//! must come before one of the consumptions; of one that would run over, the other way round.

use std::collections::{BTreeMap, BTreeSet};

use rmpl::program::Change;
use tpn::{NodeId, UseId, UseOrdering};

use super::dispatch::CROWD;
use super::encode::{Part, Problem};
use super::goals::Weights;
use super::instants::Instants;
use super::interval::Interval;
use super::linear::LinearKind;
use super::literal::{Literal, Variable};
use super::premise::Premise;
use super::relaxation::{self, Row};
use super::{ChoicePoint, ChoicePointKind, Solver};
use crate::demands::{ModelSupply, ModelUse, excess, level_change};
use crate::failure::Member;
use crate::trace::{Event, TreeChoice};

/// Of larger sets of uses that exclude each other, only those in each other's way are ordered.
const MAX_PAIRS: usize = 4_000;

/// The same where uses are dispatched.
const MAX_DISPATCHED_PAIRS: usize = 20_000;

/// Of a reservoir with as many uses, sums say from the start what it has in all.
const MANY_USES: usize = 20;

/// A use of a resource in the solver.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task {
    pub(super) id: UseId,
    pub(super) interval: Interval,
    pub(super) change: Change,
    /// The maximum amount.
    pub(super) amount: i64,
    /// The minimum amount.
    pub(super) at_least: i64,
    /// Otherwise it takes nothing, but still gives.
    pub(super) is_active: bool,
    pub(super) start: NodeId,
    pub(super) end: NodeId,
    /// Of a condition on a level: what the level may not fall below, or not rise above.
    pub(super) level: Option<i64>,
}

impl Task {
    fn is_at_end(&self) -> bool {
        self.change == Change::Produces && self.level.is_none()
    }

    /// The event at which it changes a reservoir's level, or begins to ask for one.
    pub(super) fn moment_node(&self) -> NodeId {
        if self.is_at_end() { self.end } else { self.start }
    }

    /// When it changes a reservoir's level, or begins to ask for one.
    pub(super) fn moment(&self) -> Variable {
        if self.is_at_end() { self.interval.end } else { self.interval.start }
    }

    /// The last event at which it concerns a reservoir's level.
    pub(super) fn last_moment(&self) -> Variable {
        if self.level.is_some() { self.interval.end } else { self.moment() }
    }

    /// Returns whether it asks for a level from one event to another, and not just before one.
    pub(super) fn is_held(&self) -> bool {
        self.level.is_some() && self.start != self.end
    }

    /// Returns how far a level is beyond a bound that this use can break.
    pub(super) const fn excess(&self, level: i64, bound: i64) -> i64 {
        excess(self.change, level, bound)
    }

    /// The change of a reservoir's level: the greatest possible one if `is_most`, otherwise the least.
    pub(super) const fn level_change(&self, is_most: bool) -> i64 {
        level_change(self.change, [self.at_least, self.amount], is_most)
    }
}

#[derive(Clone, Debug)]
struct Shared {
    supply: ModelSupply,
    tasks: Vec<Task>,
    /// Whether uses that exclude each other are known to.
    has_exclusion: bool,
    /// Whether these are so many that not all orders of two are choice points.
    is_crowded: bool,
}

/// What the solver knows of resources.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shares {
    all: Vec<Shared>,
    /// That one use comes before another.
    orders: BTreeMap<(UseId, UseId), Literal>,
    ordered_pairs: BTreeSet<(UseId, UseId)>,
}

impl Shares {
    pub(super) const fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Returns how many uses all resources have.
    pub(super) fn num_uses(&self) -> usize {
        self.all.iter().map(|shared| shared.tasks.len()).sum()
    }

    /// Each resource with its uses.
    pub(super) fn tasks(&self) -> Vec<(ModelSupply, Vec<Task>)> {
        self.all.iter().map(|shared| (shared.supply, shared.tasks.clone())).collect()
    }

    /// Returns what the literals of orders say in a record.
    pub(super) fn names(&self) -> impl Iterator<Item = (Literal, TreeChoice)> + '_ {
        let name = |(first, then)| TreeChoice::UseOrder(UseOrdering { first, then });
        self.orders.iter().map(move |(&pair, &order)| (order, name(pair)))
    }

    /// That one use comes before another, by both.
    pub(super) fn pairs(&self) -> impl Iterator<Item = (&(UseId, UseId), &Literal)> {
        self.orders.iter()
    }

    /// The literals of all orders.
    pub(super) fn orders(&self) -> impl Iterator<Item = Literal> + '_ {
        self.orders.values().copied()
    }
}

impl Problem<'_> {
    pub(super) fn add_resources(&mut self, solver: &mut Solver, part: Part<'_>) {
        let [mut taken, mut given] = [const { Taken::new() }; 2];
        for resource in &self.model.demands.resources {
            // Where the environment chooses, the level counts also where nothing is taken or given (SPEC 11).
            let counts =
                |used: &&ModelUse| used.amount > 0 || used.level.is_some() || self.model.has_uncertainty;
            let tasks = resource.uses.iter().filter(counts);
            let tasks = tasks.map(|used| {
                let is_active = part.active_uses.is_none_or(|active| active[used.id.index()]);
                let arc = &self.model.arcs[used.arc];
                let interval = Interval {
                    start: self.times[used.start],
                    end: self.times[used.end],
                    presence: self.presence(arc.context),
                    duration: if (arc.from, arc.to) == (used.start, used.end) { arc.lower.max(0) } else { 0 },
                };
                let ModelUse { id, change, amount, at_least, start, end, level, .. } = *used;
                Task { id, interval, change, amount, at_least, is_active, start, end, level }
            });
            let exists = |task: &Task| {
                solver.takes_nothing_for_granted() || !solver.trail.fails(task.interval.presence)
            };
            let tasks: Vec<Task> = tasks.filter(exists).collect();
            if !solver.takes_nothing_for_granted() {
                let [consumed, produced] = relaxation::amounts(&solver.trail, resource.supply, &tasks);
                if tasks.len() >= MANY_USES {
                    sum_up(solver, [&consumed, &produced]);
                }
                taken.add(consumed);
                given.add(produced);
            }
            self.shares.all.push(Shared {
                supply: resource.supply,
                tasks,
                has_exclusion: false,
                is_crowded: false,
            });
        }
        for all in [taken, given].into_iter().filter(|all| all.num_reservoirs > 1) {
            self.limit(solver, all.weights, all.most);
        }
    }

    /// Returns where the present solution takes more of a resource than there is: decides when one of those starts that
    /// are too much together, or adds choice points.
    pub(super) fn share(&mut self, solver: &mut Solver) -> Sharing {
        let mut found: Vec<Critical> = Vec::new();
        let mut excluding: Vec<usize> = Vec::new();
        for (index, shared) in self.shares.all.iter().enumerate() {
            let present: Vec<Task> = (shared.tasks.iter())
                .filter(|task| solver.trail.holds(task.interval.presence))
                .copied()
                .collect();
            match shared.supply {
                ModelSupply::Reusable { capacity } => {
                    let active: Vec<Task> = present.into_iter().filter(|task| task.is_active).collect();
                    let critical = overloads(&self.instants, &active, capacity);
                    if !critical.is_empty() && !shared.has_exclusion {
                        excluding.push(index);
                    }
                    let is_crowded = shared.is_crowded;
                    found.extend(critical.into_iter().map(|tasks| Critical::Overload { tasks, is_crowded }));
                }
                ModelSupply::Reservoir { least, greatest, level } => {
                    found.extend(out_of_range(
                        solver,
                        &self.instants,
                        &shared.tasks,
                        (least, greatest),
                        level,
                    ));
                }
            }
        }
        if found.is_empty() {
            return Sharing::Fits;
        }
        // Times that suit no one but the executive say nothing where the environment chooses.
        if !self.faces_nature
            && excluding.is_empty()
            && let Some(first) = found.iter().find_map(|critical| first_to_start(solver, critical))
        {
            if self.shares.num_uses() >= CROWD && self.can_dispatch() {
                self.go_on_dispatching(solver);
            }
            // It starts as early as it can, which makes others wait.
            self.start_at(solver, &first, solver.trail.least(first.interval.start));
            return Sharing::Decided;
        }
        for critical in &found {
            solver.tell(|| critical.event());
        }
        solver.retract(0);
        for index in excluding {
            self.exclude(solver, index, MAX_PAIRS);
        }
        for critical in found {
            match critical {
                Critical::Overload { tasks, .. } => self.resolve_overload(solver, &tasks),
                Critical::Late { early, late } => self.resolve_late(solver, &early, &late),
                Critical::Level { orders, present, .. } => self.resolve_by(solver, &orders, &present),
            }
        }
        Sharing::Restarted
    }

    /// Returns which uses the solution orders.
    pub(super) fn uses_ordered(&self, solver: &Solver) -> Vec<(UseId, UseId)> {
        let held = self.shares.orders.iter().filter(|(_, order)| solver.trail.holds(**order));
        held.map(|(&pair, _)| pair).collect()
    }

    /// Tells the solver of the uses that exclude each other two by two, for all shared resources.
    pub(super) fn exclude_all(&mut self, solver: &mut Solver) {
        for index in 0..self.shares.all.len() {
            if !self.shares.all[index].has_exclusion {
                self.exclude(solver, index, MAX_DISPATCHED_PAIRS);
            }
        }
    }

    pub(super) fn order_of_uses(&self, first: UseId, then: UseId) -> Option<Literal> {
        self.shares.orders.get(&(first, then)).copied()
    }

    /// Tells the solver of the uses that exclude each other two by two, of at most so many pairs.
    fn exclude(&mut self, solver: &mut Solver, index: usize, most_pairs: usize) {
        self.shares.all[index].has_exclusion = true;
        let Shared { supply: ModelSupply::Reusable { capacity }, tasks, .. } = self.shares.all[index].clone()
        else {
            return;
        };
        let shared = tasks.iter().filter(|task| task.is_active && task.interval.duration > 0);
        let premise = Premise::Resource(index);
        solver.cumulatives.add(capacity, shared.map(|task| (task.interval, task.amount)).collect(), premise);
        // More than half each.
        let large: Vec<Task> =
            tasks.into_iter().filter(|task| task.is_active && task.amount > capacity - task.amount).collect();
        if large.len() > 2 {
            solver.disjunctives.add_tasks(large.iter().map(|task| task.interval).collect(), premise);
        }
        if large.len() * large.len() / 2 > most_pairs {
            self.shares.all[index].is_crowded = true;
            return;
        }
        for (position, left) in large.iter().enumerate() {
            for right in &large[position + 1..] {
                self.resolve_overload(solver, &[*left, *right]);
            }
        }
    }

    /// One of these uses ends before another one starts.
    pub(super) fn resolve_overload(&mut self, solver: &mut Solver, tasks: &[Task]) {
        if let [left, right] = tasks
            && !self.shares.ordered_pairs.insert((left.id, right.id))
        {
            return;
        }
        let mut options = Vec::new();
        for (position, left) in tasks.iter().enumerate() {
            for right in &tasks[position + 1..] {
                for (first, then) in [(left, right), (right, left)] {
                    let ends = (first.interval.end, then.interval.start);
                    options.push(self.use_order(solver, first, then, ends));
                }
            }
        }
        from_uses(solver, tasks);
        add_resolvers(solver, options, tasks);
    }

    /// One of the late ones comes before one of the early ones.
    fn resolve_late(&mut self, solver: &mut Solver, early: &[Task], late: &[Task]) {
        let mut options = Vec::new();
        for first in late {
            for then in early {
                options.push(self.use_order(solver, first, then, (first.moment(), then.moment())));
            }
        }
        from_uses(solver, early);
        add_resolvers(solver, options, early);
    }

    /// One of these pairs is in this order where all the tasks are present.
    pub(super) fn resolve_by(&mut self, solver: &mut Solver, orders: &[(Task, Task)], present: &[Task]) {
        let options: Vec<Literal> = orders
            .iter()
            .map(|(first, then)| self.use_order(solver, first, then, (first.last_moment(), then.moment())))
            .collect();
        from_uses(solver, present);
        add_resolvers(solver, options, present);
    }

    /// Returns whether one of these pairs is in this order already.
    pub(super) fn is_resolved(&self, solver: &Solver, orders: &[(Task, Task)]) -> bool {
        let order = |(first, then): &(Task, Task)| self.shares.orders.get(&(first.id, then.id));
        orders.iter().any(|pair| order(pair).is_some_and(|&order| solver.trail.holds(order)))
    }

    /// The literal that one use comes before another.
    fn use_order(
        &mut self,
        solver: &mut Solver,
        first: &Task,
        then: &Task,
        (over, begun): (Variable, Variable),
    ) -> Literal {
        if let Some(&known) = self.shares.orders.get(&(first.id, then.id)) {
            return known;
        }
        let order = solver.boolean();
        solver.resize();
        // What the literal means; that it must hold is said elsewhere.
        solver.tell_structure();
        // Uses that overlap are all in the plan; a production or consumption that mends a level has to be added with its order.
        if first.change != Change::Uses {
            solver.imply(order, first.interval.presence);
            solver.imply(order, then.interval.presence);
        }
        let differences = solver.differences.len();
        solver.difference(begun, over, 0, [order; 2]);
        solver.check_differences(differences);
        self.shares.orders.insert((first.id, then.id), order);
        order
    }
}

/// Tells the solver that in all no more is taken of a reservoir than it has and is given, and no more given than it has
/// room for. That says for all sets of uses what one solution after the other would say for few of them; it does not say
/// which ones, so that explanations do without it.
fn sum_up(solver: &mut Solver, rows: [&Option<Row>; 2]) {
    for row in rows.into_iter().flatten() {
        let terms = row.terms.iter().map(|(&variable, &weight)| (weight, variable)).collect();
        solver.linears.add(terms, row.most, LinearKind::Amounts);
    }
}

/// What is taken of all reservoirs together, or given to them: where each alternative of a choice takes something of one of
/// them, all of them may be too little although none of them is (the pigeonhole principle).
struct Taken {
    weights: Weights,
    most: i128,
    num_reservoirs: usize,
}

impl Taken {
    const fn new() -> Self {
        Self { weights: Weights::new(), most: 0, num_reservoirs: 0 }
    }

    fn add(&mut self, row: Option<Row>) {
        let Some(row) = row else { return };
        self.num_reservoirs += 1;
        self.most += i128::from(row.most);
        for (variable, weight) in row.terms {
            *self.weights.entry(variable).or_default() += i128::from(weight);
        }
    }
}

/// What is told next comes from these uses.
fn from_uses(solver: &mut Solver, tasks: &[Task]) {
    solver.tell_from(tasks.iter().map(|task| Member::Use(task.id)));
}

/// One of these orders holds where all the tasks are present.
fn add_resolvers(solver: &mut Solver, options: Vec<Literal>, present: &[Task]) {
    let when: Vec<Literal> = present.iter().map(|task| task.interval.presence).collect();
    solver.at_least_one(options.iter().copied().chain(when.iter().map(|&presence| !presence)));
    if options.len() > 1 {
        let kind = ChoicePointKind::Resolvers;
        solver.add_choice_point(ChoicePoint { when, kind, options, last: None }, 0.0);
    }
}

/// Whether a solution takes no more of any resource than there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sharing {
    Fits,
    /// No, and now one task starts as early as it can.
    Decided,
    /// No, and there are new choice points; everything was taken back.
    Restarted,
}

/// The task that can start first of those that are too much together, if starts are to be decided: not of two whose orders
/// are choice points, nor of what has no time-table. Every other time between restarts orders are chosen instead, where
/// there are not too many: starts soon give a plan where there is room, orders prove where there is none.
fn first_to_start(solver: &Solver, critical: &Critical) -> Option<Task> {
    let Critical::Overload { tasks, is_crowded } = critical else { return None };
    if !is_crowded && (tasks.len() < 3 || solver.restarts % 2 == 1) {
        return None;
    }
    let times =
        |task: &Task| (solver.trail.least(task.interval.start), solver.trail.most(task.interval.start));
    let is_open = |task: &&Task| task.interval.duration > 0 && times(task).0 < times(task).1;
    tasks.iter().filter(is_open).min_by_key(|task| (times(task), task.id)).copied()
}

/// What is wrong with a solution.
enum Critical {
    /// These uses are too much together.
    Overload { tasks: Vec<Task>, is_crowded: bool },
    /// Unless one of the late ones comes before one of the early ones, the early ones are too much.
    Late { early: Vec<Task>, late: Vec<Task> },
    /// Unless one of these pairs is in this order, a condition on the level does not hold.
    Level { orders: Vec<(Task, Task)>, present: Vec<Task>, late: Vec<Task> },
}

impl Critical {
    fn event(&self) -> Event {
        match self {
            Self::Overload { tasks, .. } => Event::Overload { uses: ids(tasks) },
            Self::Late { early, late } | Self::Level { present: early, late, .. } => {
                Event::OutOfRange { early: ids(early), late: ids(late) }
            }
        }
    }
}

/// The uses of tasks.
pub(super) fn ids(tasks: &[Task]) -> Vec<UseId> {
    tasks.iter().map(|task| task.id).collect()
}

/// Sets of uses that are looked for in one solution, at most.
const MAX_OVERLOADS: usize = 32;

/// Minimal sets of uses that overlap in the least times and are too much together, in order of time; once a set is found,
/// the last of it to start counts no more.
fn overloads(instants: &Instants, present: &[Task], capacity: i64) -> Vec<Vec<Task>> {
    let at = |node: NodeId| instants.position(node);
    // Where only some bounds count, as in explanations, a use may end before it starts.
    let lasts = |task: &&Task| at(task.start) <= at(task.end);
    let mut by_start: Vec<&Task> = present.iter().filter(lasts).collect();
    by_start.sort_by_key(|task| (at(task.start), at(task.end), task.id));
    let mut running: Vec<&Task> = Vec::new();
    let mut found = Vec::new();
    for &task in &by_start {
        running.retain(|other| at(other.end) > at(task.start));
        running.push(task);
        let sum: i64 = running.iter().map(|task| task.amount).sum();
        if sum > capacity {
            found.push(minimal(running.clone(), sum - capacity));
            running.pop();
            if found.len() == MAX_OVERLOADS {
                break;
            }
        }
    }
    found
}

/// Leaves out what is not needed for an excess, the smallest first.
pub(super) fn minimal(mut tasks: Vec<&Task>, mut excess: i64) -> Vec<Task> {
    tasks.sort_by_key(|task| (task.amount, task.id));
    tasks.retain(|task| {
        let is_needed = task.amount >= excess;
        if !is_needed {
            excess -= task.amount;
        }
        is_needed
    });
    tasks.sort_by_key(|task| task.id);
    tasks.into_iter().copied().collect()
}

/// The first event after which a reservoir's level is out of its range. What the solution does not select may come before
/// that in another one.
fn out_of_range(
    solver: &Solver,
    instants: &Instants,
    tasks: &[Task],
    (least, greatest): (i64, i64),
    initial: i64,
) -> Option<Critical> {
    let mut in_order: Vec<&Task> =
        tasks.iter().filter(|task| solver.trail.holds(task.interval.presence)).collect();
    in_order.sort_by_key(|task| (instants.position(task.moment_node()), task.id));
    // What is not active counts only where it helps.
    let (mut low, mut high) = (initial, initial);
    let held: Vec<&Task> = in_order.iter().copied().filter(|task| task.is_active && task.is_held()).collect();
    let mut from = 0;
    while from < in_order.len() {
        // Changes at one event are one change.
        let event = in_order[from].moment_node();
        let count = in_order[from..].iter().take_while(|task| task.moment_node() == event).count();
        let broken = |condition: &Task, (low, high): (i64, i64), upto: usize| {
            let level = if condition.change == Change::Produces { high } else { low };
            let excess = condition.excess(level, condition.level?);
            (excess > 0).then(|| broken_level(tasks, &in_order[..upto], condition, excess))
        };
        let asked = in_order[from..from + count].iter().filter(|task| task.is_active && task.level.is_some());
        let mut before = asked.filter(|task| !task.is_held());
        if let Some(critical) = before.find_map(|&condition| broken(condition, (low, high), from)) {
            return Some(critical);
        }
        for task in &in_order[from..from + count] {
            let gives = task.change == Change::Produces;
            low += if task.is_active || gives { task.level_change(false) } else { 0 };
            high += if task.is_active || !gives { task.level_change(true) } else { 0 };
        }
        from += count;
        let here = instants.position(event);
        let is_within =
            |task: &&&Task| (instants.position(task.start)..=instants.position(task.end)).contains(&here);
        let mut during = held.iter().filter(is_within);
        if let Some(critical) = during.find_map(|&condition| broken(condition, (low, high), from)) {
            return Some(critical);
        }
        let (excess, early_change) = if low < least {
            (least - low, Change::Consumes)
        } else if high > greatest {
            (high - greatest, Change::Produces)
        } else {
            continue;
        };
        let changes = in_order[..from].iter().copied().filter(|task| task.level.is_none());
        let (counted, mending): (Vec<&Task>, Vec<&Task>) =
            changes.partition(|task| task.change == early_change);
        let counted = counted.into_iter().filter(|task| task.is_active).collect();
        let is_late = |task: &&Task| {
            task.change != early_change
                && task.level.is_none()
                && mending.iter().all(|counted| counted.id != task.id)
        };
        let late = tasks.iter().filter(is_late).copied().collect();
        return Some(Critical::Late { early: minimal(counted, excess), late });
    }
    None
}

/// The repairs of a condition on a level that fails after the changes of `happened`, which went too far by `excess`: enough
/// changes of its own kind come later, or one of the other kind comes earlier.
fn broken_level(tasks: &[Task], happened: &[&Task], condition: &Task, excess: i64) -> Critical {
    let counted = |task: &&&Task| task.change == condition.change && task.is_active && task.level.is_none();
    let early = minimal(happened.iter().filter(counted).copied().collect(), excess);
    let has_happened = |task: &Task| happened.iter().any(|other| other.id == task.id);
    let is_late =
        |task: &&Task| task.change != condition.change && task.level.is_none() && !has_happened(task);
    let late: Vec<Task> = tasks.iter().filter(is_late).copied().collect();
    let mut orders: Vec<(Task, Task)> = Vec::new();
    // What changes the level at the event that a condition begins or ends at is neither before nor after it.
    orders.extend(
        late.iter().filter(|task| task.moment_node() != condition.start).map(|&task| (task, *condition)),
    );
    orders.extend(
        early.iter().filter(|task| task.moment_node() != condition.end).map(|&task| (*condition, task)),
    );
    if condition.is_held() {
        orders.extend(early.iter().flat_map(|&task| late.iter().map(move |&other| (other, task))));
    }
    let present = early.into_iter().chain([*condition]).collect();
    Critical::Level { orders, present, late }
}
