//! What nature chooses (SPEC 13.1): where everything is decided, whatever it chooses must leave the executive times.
//!
//! The constraints in force and the durations that the environment chooses are a simple temporal network with
//! uncertainty. A semi-reducible negative cycle of it rests on literals, one of which must not hold. Resources must
//! suffice for all times: uses that nothing orders count together.

use std::collections::{BTreeMap, BTreeSet};

use rmpl::program::Change;
use stn::{PointId, Stn};
use stnu::{Link, LinkError, Part, StrongVerdict, Undecided, Verdict};
use tpn::{NodeId, UseId};
use typed_index_collections::TiVec;

use super::Solver;
use super::encode::Problem;
use super::literal::{Literal, Variable};
use super::premise::Premise;
use super::resources::{Task, ids};
use crate::antichain::heaviest_antichain;
use crate::demands::ModelSupply;
use crate::instants::Before;
use crate::model::UNBOUNDED_BELOW;
use crate::model::{INFINITE, ModelArc};
use crate::trace::Event;

/// Larger conflicts are not made minimal.
const MAX_MINIMIZED: usize = 60;

/// The constraints of a solution, with the literals that each rests on.
struct InForce {
    points: TiVec<Variable, Option<u32>>,
    count: usize,
    edges: Vec<(Edge, Vec<Literal>)>,
    /// How long movements take at least from where they begin, by their first and last events: that raises the
    /// environment's least duration, and asks nothing of the environment (SPEC 13.1).
    movements: BTreeMap<(Variable, Variable), (i64, Literal)>,
}

/// `to − from ≤ weight`.
#[derive(Clone, Copy)]
struct Edge {
    from: u32,
    to: u32,
    weight: i64,
}

impl Problem<'_> {
    /// Excludes the present solution if the environment can make it fail. `Some(false)` if it cannot, `None` if no one knows.
    pub(super) fn withstand(&mut self, solver: &mut Solver, stop: &mut dyn FnMut() -> bool) -> Option<bool> {
        if !self.faces_nature {
            return Some(false);
        }
        let in_force = self.in_force(solver);
        let is_broken = self.share_in_all_schedules(solver, &in_force)?;
        if is_broken {
            return Some(true);
        }
        let Some(reason) = self.failure(solver, &in_force, stop)? else { return Some(false) };
        solver.stats.conflicts += 1;
        solver.stats.nogoods += 1;
        solver.record_refusal(&reason, |choices| Event::Uncontrollable { choices });
        solver.retract(0);
        solver.tell_from_premises([Premise::Unknown]);
        solver.at_least_one(reason.into_iter().map(|literal| !literal));
        Some(true)
    }

    fn in_force(&self, solver: &Solver) -> InForce {
        let trail = &solver.trail;
        let mut in_force = InForce {
            points: vec![None; trail.num_variables()].into(),
            count: 0,
            edges: Vec::with_capacity(solver.differences.len()),
            movements: BTreeMap::new(),
        };
        if self.model.is_strong {
            // What is tied to an event of the environment's is one with it.
            for arc in self.ties(solver) {
                let (from, to) = (self.times[arc.from], self.times[arc.to]);
                let [one, other] = [from, to].map(|variable| in_force.point_of(variable));
                in_force
                    .points
                    .iter_mut()
                    .filter(|own| **own == Some(other))
                    .for_each(|own| *own = Some(one));
            }
        }
        let links: BTreeSet<(Variable, Variable)> = self
            .model
            .arcs
            .iter()
            .filter(|arc| self.is_link(solver, arc))
            .map(|arc| self.ends(arc))
            .collect();
        for (from, to, weight, when) in solver.differences.constraints() {
            let rests_on = [when[0], when[1], trail.presence(from), trail.presence(to)];
            if let Some(&least) = self.sides.min_movements.get(&when[0])
                && links.contains(&(to, from))
            {
                if trail.holds(when[0]) {
                    in_force.movements.insert((to, from), (least, when[0]));
                }
                continue;
            }
            if rests_on.iter().all(|&literal| trail.holds(literal)) {
                in_force.add((from, to, weight), &rests_on);
            }
        }
        self.add_strict_gaps(solver, &mut in_force);
        in_force
    }

    /// The gaps before what the environment executes only with other choices than the present ones.
    fn add_strict_gaps(&self, solver: &Solver, in_force: &mut InForce) {
        let natures = self.natures_variables(solver);
        let chosen: Vec<Literal> = self.chosen(solver).collect();
        for (&(left, right), &[left_first, right_first]) in &self.orders {
            for (first, then, order) in [(left, right, left_first), (right, left, right_first)] {
                let (over, begun) = (self.intervals[first].end, self.intervals[then].start);
                let gap = self.model.gap;
                if solver.trail.holds(order) && gap > self.gap_between(first, then) && !natures[begun] {
                    let rests_on: Vec<Literal> = chosen.iter().copied().chain([order]).collect();
                    in_force.add((begun, over, -gap), &rests_on);
                }
            }
        }
    }

    pub(super) fn chosen<'s>(&'s self, solver: &'s Solver) -> impl Iterator<Item = Literal> + 's {
        self.alternatives.iter().flatten().copied().filter(|&taken| solver.trail.holds(taken))
    }

    /// Returns which times the environment chooses in the present solution: ends of its durations, and what is tied to
    /// them.
    fn natures_variables(&self, solver: &Solver) -> TiVec<Variable, bool> {
        let mut natures: TiVec<Variable, bool> = vec![false; solver.trail.num_variables()].into();
        for arc in &self.model.arcs {
            if !solver.trail.holds(self.presence(arc.context)) {
                continue;
            }
            if arc.is_uncertain {
                natures[self.times[arc.to]] = true;
            }
        }
        let mut ties: Vec<(Variable, Variable)> =
            self.ties(solver).map(|arc| (self.times[arc.from], self.times[arc.to])).collect();
        loop {
            let before = ties.len();
            ties.retain(|&(from, to)| {
                let is_natures = natures[from] || natures[to];
                if is_natures {
                    (natures[from], natures[to]) = (true, true);
                }
                !is_natures
            });
            if ties.len() == before {
                return natures;
            }
        }
    }

    /// Returns whether nature chooses an arc's duration in the present solution. With one side only it is a constraint
    /// like others.
    fn is_link(&self, solver: &Solver, arc: &ModelArc) -> bool {
        arc.is_uncertain
            && arc.lower != UNBOUNDED_BELOW
            && arc.upper != INFINITE
            && solver.trail.holds(self.presence(arc.context))
    }

    fn ends(&self, arc: &ModelArc) -> (Variable, Variable) {
        (self.times[arc.from], self.times[arc.to])
    }

    /// Returns what keeps two times of the present solution at one.
    fn ties<'s>(&'s self, solver: &'s Solver) -> impl Iterator<Item = &'s ModelArc> + 's {
        self.model.arcs.iter().filter(|arc| {
            arc.is_tie && self.times[arc.from] != self.times[arc.to] && self.is_present(solver, arc)
        })
    }

    /// The literals that make the present solution fail, if the environment can. `None` if no one knows.
    #[expect(clippy::option_option, reason = "what is not known is not what there is none of")]
    fn failure(
        &self,
        solver: &Solver,
        in_force: &InForce,
        stop: &mut dyn FnMut() -> bool,
    ) -> Option<Option<Vec<Literal>>> {
        let mut network = stnu::Network::new(in_force.count);
        for &(Edge { from, to, weight }, _) in &in_force.edges {
            network.add_edge(stnu::PointId(from), stnu::PointId(to), weight);
        }
        let mut presences: Vec<[Literal; 2]> = Vec::new();
        for arc in self.model.arcs.iter().filter(|arc| self.is_link(solver, arc)) {
            let presence = self.presence(arc.context);
            let (from, to) = self.ends(arc);
            let (Some(activation), Some(end)) = (in_force.point(from), in_force.point(to)) else { continue };
            let (least, begins) =
                in_force.movements.get(&(from, to)).copied().unwrap_or((arc.lower, Literal::TRUE));
            // One that takes longer than it may is not a solution.
            let lower = arc.lower.max(least).min(arc.upper);
            let mut link = Link { activation, end, lower, upper: arc.upper };
            let mut added = network.add_link(link);
            if matches!(added, Err(LinkError::EndTaken(_))) {
                // Two ends at one time are two points at one time.
                link.end = network.add_point();
                network.add_edge(end, link.end, 0);
                network.add_edge(link.end, end, 0);
                added = network.add_link(link);
            }
            match added {
                Ok(_) => presences.push([presence, begins]),
                // The environment may choose more than no time between events that are at one time.
                Err(_) if arc.upper > 0 => {
                    return Some(Some(self.chosen(solver).chain([presence]).collect()));
                }
                Err(_) => {}
            }
        }
        let of_edge =
            |id: stnu::EdgeId| in_force.edges.get(id.index()).map(|(_, rests_on)| rests_on.as_slice());
        let mut reason: Vec<Literal> = if self.model.is_strong {
            match stnu::check_strong(&network) {
                Ok(StrongVerdict::Controllable(_)) => return Some(None),
                Ok(StrongVerdict::Uncontrollable(edges)) => {
                    let edges = edges.into_iter().filter_map(of_edge).flatten().copied();
                    edges.chain(presences.into_iter().flatten()).chain(self.chosen(solver)).collect()
                }
                Err(Undecided::Overflow | Undecided::Stopped) => return None,
            }
        } else {
            let conflict = match stnu::check(&network, stop) {
                Ok(Verdict::Controllable) => return Some(None),
                Ok(Verdict::Uncontrollable(conflict)) => conflict,
                Err(Undecided::Overflow | Undecided::Stopped) => return None,
            };
            let is_small = conflict.members.len() <= MAX_MINIMIZED;
            let conflict = match is_small.then(|| stnu::minimal(&network, &conflict, stop)) {
                Some(Ok(minimal)) => minimal,
                Some(Err(_)) | None => conflict,
            };
            let mut reason = Vec::new();
            for member in &conflict.members {
                match member.part {
                    Part::Edge(id) => reason.extend(of_edge(id).into_iter().flatten().copied()),
                    Part::Lower(id) | Part::Upper(id) => reason.extend(presences[id.index()]),
                }
            }
            reason
        };
        reason.sort_unstable();
        reason.dedup();
        reason.retain(|&literal| literal != Literal::TRUE);
        Some(Some(reason))
    }

    /// Adds choice points where some schedule of the present solution takes more of a resource than there is. `None` if
    /// times do not fit.
    fn share_in_all_schedules(&mut self, solver: &mut Solver, in_force: &InForce) -> Option<bool> {
        if self.shares.is_empty() {
            return Some(false);
        }
        let mut stn = Stn::new(in_force.count);
        for &(Edge { from, to, weight }, _) in &in_force.edges {
            stn.insert(PointId(from), PointId(to), weight, 0).ok()?;
        }
        let mut happens = HappensBefore::new(self, solver);
        for (supply, tasks) in self.shares.tasks() {
            let present: Vec<Task> =
                tasks.iter().filter(|task| solver.trail.holds(task.interval.presence)).copied().collect();
            match supply {
                ModelSupply::Reusable { capacity } => {
                    let active: Vec<Task> = present.into_iter().filter(|task| task.is_active).collect();
                    let at = |variable| solver.trail.least(variable);
                    let orders = (&mut stn, &mut happens);
                    if let Some(critical) = unordered(orders, in_force, at, (&active, capacity))? {
                        solver.tell(|| Event::Overload { uses: ids(&critical) });
                        solver.retract(0);
                        self.resolve_overload(solver, &critical);
                        return Some(true);
                    }
                }
                ModelSupply::Reservoir { least, greatest, level } => {
                    let critical =
                        out_of_range((&mut stn, &mut happens), in_force, &present, (least, greatest), level)?;
                    let Some(Excess { used, counted, mending, held: around }) = critical else { continue };
                    let is_late = |task: &&Task| {
                        let is_own = used.level.is_some() && task.moment_node() == used.start;
                        task.change != used.change
                            && task.level.is_none()
                            && !is_own
                            && !mending.contains(&task.id)
                    };
                    let late: Vec<Task> = tasks.iter().filter(is_late).copied().collect();
                    // Another one of its kind comes after it, or one of the other kind before it; or it comes before or after
                    // the level is asked for.
                    let orders: Vec<(Task, Task)> = (late.iter().map(|&other| (other, used)))
                        .chain(counted.iter().map(|&other| (used, other)))
                        .chain(around.iter().flat_map(|&around| Self::apart(used, around)))
                        .collect();
                    let is_known = self.is_resolved(solver, &orders);
                    let held = self.decided(solver);
                    if is_known {
                        solver.stats.conflicts += 1;
                        solver.record_refusal(&held, |choices| Event::Uncontrollable { choices });
                    } else {
                        let early: Vec<Task> = counted.iter().chain([&used]).copied().collect();
                        solver.tell(|| Event::OutOfRange { early: ids(&early), late: ids(&late) });
                    }
                    solver.retract(0);
                    if is_known {
                        // An order that would fix it holds, and events at one time undo it.
                        solver.tell_from_premises([Premise::Unknown]);
                        solver.at_least_one(held.into_iter().map(|literal| !literal));
                    } else {
                        let present: Vec<Task> = counted.into_iter().chain([used]).chain(around).collect();
                        self.resolve_by(solver, &orders, &present);
                    }
                    return Some(true);
                }
            }
        }
        Some(false)
    }

    /// The orders in which a change is not part of a condition on the level that lasts: what happens at the events of the
    /// condition is.
    fn apart(used: Task, condition: Task) -> Vec<(Task, Task)> {
        let moment = used.moment_node();
        let before = (moment != condition.start).then_some((used, condition));
        let after = (moment != condition.end).then_some((condition, used));
        before.into_iter().chain(after).collect()
    }

    /// All decisions that hold.
    fn decided(&self, solver: &Solver) -> Vec<Literal> {
        let own = self.alternatives.iter().flatten().chain(self.orders.values().flatten()).copied();
        let links = self.carriers.iter().flat_map(|(_, options)| options.iter().map(|&(_, link)| link));
        let shared = self.shares.orders();
        let mut held: Vec<Literal> =
            own.chain(links).chain(shared).filter(|&literal| solver.trail.holds(literal)).collect();
        held.extend(self.kept_literals(solver));
        held
    }
}

impl InForce {
    fn add(&mut self, (from, to, weight): (Variable, Variable, i64), rests_on: &[Literal]) {
        let (from, to) = (self.point_of(from), self.point_of(to));
        let mut rests_on: Vec<Literal> =
            rests_on.iter().copied().filter(|&literal| literal != Literal::TRUE).collect();
        rests_on.sort_unstable();
        rests_on.dedup();
        self.edges.push((Edge { from, to, weight }, rests_on));
    }

    fn point_of(&mut self, variable: Variable) -> u32 {
        let count = &mut self.count;
        *self.points[variable].get_or_insert_with(|| {
            *count += 1;
            *count as u32 - 1
        })
    }

    fn point(&self, variable: Variable) -> Option<stnu::PointId> {
        self.points[variable].map(stnu::PointId)
    }
}

/// What happens before what in a solution, where both come at one time.
struct HappensBefore<'a> {
    problem: &'a Problem<'a>,
    solver: &'a Solver,
    /// By event, what happens right after it; once it was asked for.
    after: Option<TiVec<NodeId, Vec<NodeId>>>,
    /// By event, whether each other one happens after it: of those that were asked for.
    found: BTreeMap<NodeId, TiVec<NodeId, bool>>,
}

impl<'a> HappensBefore<'a> {
    const fn new(problem: &'a Problem<'a>, solver: &'a Solver) -> Self {
        Self { problem, solver, after: None, found: BTreeMap::new() }
    }

    /// Returns whether an event happens before another one, or is it.
    fn is_before(&mut self, first: NodeId, then: NodeId) -> bool {
        let Self { problem, solver, after, found } = self;
        let nodes = problem.model.num_nodes;
        let after = after.get_or_insert_with(|| {
            let mut after: TiVec<NodeId, Vec<NodeId>> = vec![Vec::new(); nodes].into();
            for Before { first, then, .. } in problem.happens_before(solver) {
                after[first].push(then);
            }
            after
        });
        let found = found.entry(first).or_insert_with(|| {
            let mut found: TiVec<NodeId, bool> = vec![false; nodes].into();
            found[first] = true;
            let mut open = vec![first];
            while let Some(node) = open.pop() {
                open.extend(
                    after[node].iter().copied().filter(|&next| !std::mem::replace(&mut found[next], true)),
                );
            }
            found
        });
        found[then]
    }
}

/// Returns whether one time is never later than others; by position in `then`.
fn is_before(stn: &mut Stn, in_force: &InForce, first: Variable, then: &[Variable]) -> Option<Vec<bool>> {
    let Some(first) = in_force.points[first] else { return Some(vec![false; then.len()]) };
    let mut row = Vec::new();
    stn.distances_to(PointId(first), &mut row).ok()?;
    Some(then.iter().map(|&then| in_force.points[then].is_some_and(|then| row[then as usize] <= 0)).collect())
}

/// Uses that some schedule has at one time, and that are too much together, if there are any.
#[expect(clippy::option_option, reason = "what is not known is not what there is none of")]
fn unordered(
    (stn, happens): (&mut Stn, &mut HappensBefore<'_>),
    in_force: &InForce,
    at: impl Fn(Variable) -> i64,
    (tasks, capacity): (&[Task], i64),
) -> Option<Option<Vec<Task>>> {
    let total: i64 = tasks.iter().map(|task| task.amount).sum();
    if total <= capacity {
        return Some(None);
    }
    let starts: Vec<Variable> = tasks.iter().map(|task| task.interval.start).collect();
    let ends: Vec<Variable> = tasks.iter().map(|task| task.interval.end).collect();
    let mut order = Vec::with_capacity(tasks.len());
    for (position, &end) in ends.iter().enumerate() {
        let mut row = is_before(stn, in_force, end, &starts)?;
        row[position] = false;
        order.push(row);
    }
    // Of an end and a start that are at one time in every schedule, the end has to happen before the start (SPEC 10.4).
    for (then, &start) in starts.iter().enumerate() {
        let meets = |first: usize, order: &[Vec<bool>]| order[first][then] && at(ends[first]) == at(start);
        if (0..tasks.len()).any(|first| meets(first, &order)) {
            let is_tied = is_before(stn, in_force, start, &ends)?;
            for first in (0..tasks.len()).filter(|&first| is_tied[first]) {
                order[first][then] &= happens.is_before(tasks[first].end, tasks[then].start);
            }
        }
    }
    let weights: Vec<i64> = tasks.iter().map(|task| task.amount).collect();
    let antichain = heaviest_antichain(&weights, &order);
    if antichain.weight <= capacity {
        return Some(None);
    }
    let together = antichain.members.iter().map(|&member| &tasks[member]).collect();
    Some(Some(super::resources::minimal(together, antichain.weight - capacity)))
}

/// What puts a level out of range in some schedule.
struct Excess {
    /// After this use it is.
    used: Task,
    /// Those of its kind that may come before it.
    counted: Vec<Task>,
    /// Those of the other kind that do.
    mending: Vec<UseId>,
    /// The condition on the level that may go on then, if the range alone would allow it.
    held: Option<Task>,
}

/// The first excess.
#[expect(clippy::option_option, reason = "what is not known is not what there is none of")]
fn out_of_range(
    (stn, happens): (&mut Stn, &mut HappensBefore<'_>),
    in_force: &InForce,
    tasks: &[Task],
    (least, greatest): (i64, i64),
    level: i64,
) -> Option<Option<Excess>> {
    let count = tasks.len();
    let moments: Vec<Variable> = tasks.iter().map(Task::moment).collect();
    let ends = tasks.iter().map(|task| task.interval.end);
    let moments_and_ends: Vec<Variable> = moments.iter().copied().chain(ends).collect();
    let mut order = Vec::with_capacity(count);
    for &moment in &moments {
        order.push(is_before(stn, in_force, moment, &moments_and_ends)?);
    }
    // Two that always come at one time are in order only if one happens before the other (SPEC 10.4).
    let moment = |task: usize| tasks[task].moment_node();
    let is_first = |happens: &mut HappensBefore<'_>, first: usize, then: usize| {
        order[first][then] && (!order[then][first] || happens.is_before(moment(first), moment(then)))
    };
    let held: Vec<(Task, usize, Vec<bool>)> = (tasks.iter().enumerate())
        .filter(|(_, task)| task.is_active && task.is_held())
        .map(|(at, task)| Some((*task, at, is_before(stn, in_force, task.interval.end, &moments)?)))
        .collect::<Option<_>>()?;
    for (now, used) in tasks.iter().enumerate() {
        if !used.is_active || used.is_held() {
            continue;
        }
        let (mut extreme, mut counted, mut mending) = (level, Vec::new(), Vec::new());
        for (then, other) in tasks.iter().enumerate().filter(|(_, other)| other.level.is_none()) {
            let is_same = other.change == used.change;
            let counts = if then == now {
                true
            } else if used.level.is_some() && other.moment_node() == used.start {
                false
            } else if is_same {
                other.is_active && !is_first(happens, now, then)
            } else {
                is_first(happens, then, now)
            };
            if counts {
                extreme += other.level_change(used.change == Change::Produces);
                if !is_same {
                    mending.push(other.id);
                } else if then != now {
                    counted.push(*other);
                }
            }
        }
        let limit = if used.change == Change::Produces { greatest } else { least };
        let mut excess = |held: Option<Task>| {
            let (counted, mending) = (std::mem::take(&mut counted), std::mem::take(&mut mending));
            Some(Some(Excess { used: *used, counted, mending, held }))
        };
        if used.excess(extreme, used.level.unwrap_or(limit)) > 0 {
            return excess(None);
        }
        let around = held.iter().find(|(condition, at, after)| {
            let node = used.moment_node();
            let is_after = after[now] && (!order[now][count + at] || happens.is_before(condition.end, node));
            let is_apart = (is_first(happens, now, *at) && node != condition.start)
                || (is_after && node != condition.end);
            used.level.is_none()
                && condition.change == used.change
                && !is_apart
                && condition.level.is_some_and(|bound| used.excess(extreme, bound) > 0)
        });
        if let Some(&(condition, ..)) = around {
            return excess(Some(condition));
        }
    }
    Some(None)
}
