//! The drives that may end too late for a plan: driving can take longer than the path at its greatest speed, which is
//! what plans count.

use std::collections::{BTreeMap, BTreeSet};

use controllability::{PlanNetwork, Source, plan_network};
use exact::{Bound, Overflow, Scale, Time};
use snapshot::Snapshot;
use snapshot::vehicle::{model_of, moving};
use stn::PointId;
use tpn::{ArcId, ArcKind, Network, OccurrenceId, Plan};

/// The drives that a run of the plan may not be able to wait for, if they take as long as drivers were measured to take.
///
/// A plan can wait for a drive if it withstands the longest that all drives take, and if nothing before the drive sets
/// out has to be late for the sake of a deadline after it: once it has set out, its driver tells when it arrives, and
/// what is left waits for that. Whether something has to be late is judged by how far apart two events can be if
/// everything happens as soon as it may, which can take a drive for late that is not.
///
/// Takes as long as deciding whether the plan is controllable, once more than there are late drives, and a look at the
/// whole plan for each deadline that may be missed. Where times do not fit, all drives are late.
pub(super) fn late_drives(snapshot: &Snapshot, network: &Network, plan: &Plan) -> BTreeSet<OccurrenceId> {
    let unit_s = snapshot.program.options.time_unit.seconds();
    let mut late = BTreeSet::new();
    let mut longer = BTreeMap::new();
    for traverse in snapshot.traverses.iter() {
        let id = traverse.occurrence;
        let Some(arc) = network.occurrences[id.index()].arc else { continue };
        let arc = &network.arcs[arc.index()];
        let driven_s = driven_within_s(snapshot, network, traverse);
        if arc.is_contingent {
            let most_s = arc.upper.finite().map(|most| most.to_f64() * unit_s as f64);
            if most_s.is_some_and(|most_s| most_s < driven_s - 1e-3) {
                late.insert(id);
            }
            continue;
        }
        let least = Time::checked_sum(traverse.leg_figures.iter().map(|leg| leg.min_duration));
        let in_all = Time::from_f64_up(driven_s, 1000).and_then(|driven_s| driven_s.checked_div(unit_s));
        let slow = in_all
            .zip(least)
            .and_then(|(in_all, least)| Some(Slow { in_all, more: in_all.checked_sub(least)? }));
        match slow {
            Some(slow) => {
                if slow.more.is_positive() {
                    longer.insert(id, slow);
                }
            }
            None => {
                late.insert(id);
            }
        }
    }
    if !longer.is_empty() {
        let drives: Vec<OccurrenceId> = longer.keys().copied().collect();
        match late_where_longer(network, plan, longer) {
            Ok(those) => late.extend(those),
            Err(Overflow) => late.extend(drives),
        }
    }
    late
}

/// Returns how long the vehicles of a traverse take at most to drive it, by what drivers were measured to need.
pub(super) fn driven_within_s(snapshot: &Snapshot, network: &Network, traverse: &snapshot::Traverse) -> f64 {
    let program = &snapshot.program;
    let unit_s = program.options.time_unit.seconds() as f64;
    let least: f64 = traverse.leg_figures.iter().map(|leg| leg.min_duration.to_f64()).sum();
    let occurrence = &network.occurrences[traverse.occurrence.index()];
    let said_mps = moving(program, occurrence).and_then(|moving| moving.moves.speed_mps);
    let models = traverse.vehicles.iter().filter_map(|&vehicle| model_of(&program.world, vehicle as usize));
    let own_mps = models.map(|model| model.speed_mps).fold(f64::INFINITY, f64::min);
    let speed_mps = said_mps.map_or(own_mps, |(_, most)| most.to_f64().min(own_mps));
    motion::driven_within_s(least * unit_s, speed_mps, traverse.company as usize, traverse.rocks)
}

/// How long a drive takes at its longest.
struct Slow {
    in_all: Time,
    /// How much more that is than planned.
    more: Time,
}

/// The drives that may be late if they take so much longer.
fn late_where_longer(
    network: &Network,
    plan: &Plan,
    mut longer: BTreeMap<OccurrenceId, Slow>,
) -> Result<BTreeSet<OccurrenceId>, Overflow> {
    let network = &executed(network, plan, &longer)?;
    let scale =
        longer.values().try_fold(controllability::scale(network)?, |scale, slow| scale.refined(slow.more))?;
    let mut late = BTreeSet::new();
    let slow = loop {
        let slow = driven(network, plan, &longer, scale)?;
        // Nothing stops it, so that only numbers can keep it from an answer.
        let refutation = slow.refute(network.controllability, &mut || false).map_err(|_| Overflow)?;
        let Some(refutation) = refutation else { break slow };
        let drive = |source: &Source| match source {
            Source::Arc(arc, _) => network.arcs[arc.index()].occurrence.filter(|it| longer.contains_key(it)),
            Source::Precedence(_) | Source::Tie(_) => None,
        };
        let refuted: BTreeSet<OccurrenceId> = refutation.sources.iter().filter_map(drive).collect();
        if refuted.is_empty() {
            // The plan is invalid even without slow drives. The checker reports that.
            return Ok(late);
        }
        longer.retain(|drive, _| !refuted.contains(drive));
        late.extend(refuted);
    };
    let quick = driven(network, plan, &BTreeMap::new(), scale)?;
    let point = |node| slow.point(node).map(PointId::index);
    let drive = |(&drive, &arc): (&OccurrenceId, &ArcId)| {
        let arc = &network.arcs[arc.index()];
        let is_longer = longer.contains_key(&drive);
        is_longer.then_some(Drive { id: drive, start: point(arc.from)?, on_the_way: point(arc.to)? })
    };
    let drives: Vec<Drive> = first_segments(network, plan).iter().filter_map(drive).collect();
    late.extend(Execution::new(&quick, &slow).late(&drives));
    Ok(late)
}

/// The network of a plan as it is executed. The executive lets a drive exceed the duration at its least speed if its driver
/// needs more, so the greatest durations allow for `longer`.
fn executed(
    network: &Network,
    plan: &Plan,
    longer: &BTreeMap<OccurrenceId, Slow>,
) -> Result<Network, Overflow> {
    let mut executed = executive::executed_network(network, plan).map_err(|_| Overflow)?.into_owned();
    for (drive, slow) in longer {
        if let Some(whole) = network.occurrences[drive.index()].arc {
            let own = network.arcs[whole.index()].upper;
            let most = &mut executed.arcs[whole.index()].upper;
            *most = (*most).max(own.min(Bound::Finite(slow.in_all)));
        }
    }
    Ok(executed)
}

/// The network of a plan with drives that take at least so much longer than planned; each vertex of their paths may be
/// passed so much later.
fn driven(
    network: &Network,
    plan: &Plan,
    longer: &BTreeMap<OccurrenceId, Slow>,
    scale: Scale,
) -> Result<PlanNetwork, Overflow> {
    let mut network = network.clone();
    for (drive, first) in first_segments(&network, plan) {
        if let Some(slow) = longer.get(&drive) {
            let arc = &mut network.arcs[first.index()];
            arc.lower = arc.lower.checked_add(slow.more).ok_or(Overflow)?;
        }
    }
    plan_network(&network, &plan.selected_arcs, &plan.precedences(&network), scale)
}

/// The first segment of the path of each drive.
fn first_segments(network: &Network, plan: &Plan) -> BTreeMap<OccurrenceId, ArcId> {
    let selected = network.arcs.iter().zip(&plan.selected_arcs).enumerate();
    let first = selected.filter_map(|(index, (arc, &is_selected))| {
        let drive = arc.occurrence.filter(|_| is_selected && arc.kind == ArcKind::Path)?;
        let is_first = arc.from == network.occurrences[drive.index()].start;
        is_first.then_some((drive, ArcId::from_index(index)))
    });
    first.collect()
}

/// A drive in the network.
struct Drive {
    id: OccurrenceId,
    /// The point where it sets out.
    start: usize,
    /// The end of its first segment.
    on_the_way: usize,
}

/// A plan whose events happen as soon as they may, each after all that it follows, whatever that takes.
struct Execution {
    steps: Vec<Step>,
    deadlines: Vec<Deadline>,
    /// By point, the steps that lead to it.
    before: Vec<Vec<usize>>,
    /// By point, the steps that lead on.
    after: Vec<Vec<usize>>,
    /// All points, each after those that it follows, but for those that follow each other at one instant.
    order: Vec<usize>,
    origin: usize,
}

/// One event follows another, by this many ticks.
struct Step {
    from: usize,
    to: usize,
    least: i64,
    most: i64,
}

/// An event has to come no later than this many ticks after another.
struct Deadline {
    since: usize,
    event: usize,
    within: i64,
}

impl Execution {
    /// Of a plan with its drives at their shortest and at their longest.
    fn new(quick: &PlanNetwork, slow: &PlanNetwork) -> Self {
        let points = quick.network.num_points();
        let (mut steps, mut deadlines) = (Vec::new(), Vec::new());
        for (least, most) in quick.network.edges().iter().zip(slow.network.edges()) {
            let (from, to) = (least.from.index(), least.to.index());
            let link = quick.network.link_ending_at(least.from).map(|link| quick.network.link(link));
            if least.weight > 0 {
                deadlines.push(Deadline { since: from, event: to, within: least.weight });
            } else if let Some(link) = link {
                // The environment waits for nothing.
                let within = link.lower + least.weight;
                deadlines.push(Deadline { since: link.activation.index(), event: to, within });
            } else {
                steps.push(Step { from: to, to: from, least: -least.weight, most: -most.weight });
            }
        }
        steps.extend(quick.network.links().iter().map(|link| Step {
            from: link.activation.index(),
            to: link.end.index(),
            least: link.lower,
            most: link.upper,
        }));
        let (mut before, mut after) = (vec![Vec::new(); points], vec![Vec::new(); points]);
        for (index, step) in steps.iter().enumerate() {
            before[step.to].push(index);
            after[step.from].push(index);
        }
        let mut missing: Vec<usize> = before.iter().map(Vec::len).collect();
        let mut order: Vec<usize> = (0..points).filter(|&point| missing[point] == 0).collect();
        let mut next = 0;
        while let Some(&point) = order.get(next) {
            for &step in &after[point] {
                let to = steps[step].to;
                missing[to] -= 1;
                if missing[to] == 0 {
                    order.push(to);
                }
            }
            next += 1;
        }
        order.extend((0..points).filter(|&point| missing[point] > 0));
        Self { steps, deadlines, before, after, order, origin: quick.origin.index() }
    }

    /// The drives for which a deadline after them may be missed, because they set out only after what it counts from. What
    /// comes after they have set out waits for them, and with it what follows that.
    fn late(&mut self, drives: &[Drive]) -> BTreeSet<OccurrenceId> {
        let mut late = BTreeSet::new();
        let mut open = std::mem::take(&mut self.deadlines);
        loop {
            let is_after_a_drive = self.reached(drives.iter().map(|drive| drive.on_the_way), false, |_| true);
            let earliest = self.times(self.origin, false, |step| step.least);
            let latest = self.times(self.origin, false, |step| step.most);
            let is_met = |deadline: &Deadline| {
                let quick = match (earliest[deadline.since], latest[deadline.event]) {
                    (Some(since), Some(event)) => event.saturating_sub(since) <= deadline.within,
                    _ => false,
                };
                !is_after_a_drive[deadline.event] || quick || self.is_met(deadline, earliest[deadline.since])
            };
            let (met, missed): (Vec<Deadline>, Vec<Deadline>) = open.into_iter().partition(is_met);
            if missed.is_empty() {
                return late;
            }
            for deadline in missed {
                let before_event = self.reached([deadline.event], true, |_| true);
                // What waits for another event may still come before it.
                let before_since = self.reached([deadline.since], true, |step| step.least >= 0);
                let may_be_late = |drive: &&Drive| {
                    let has_set_out = before_since[drive.start] && drive.start != deadline.since;
                    before_event[drive.on_the_way] && !has_set_out
                };
                late.extend(drives.iter().filter(may_be_late).map(|drive| drive.id));
                let waits = -deadline.within;
                self.add_step(Step { from: deadline.event, to: deadline.since, least: waits, most: waits });
            }
            open = met;
        }
    }

    fn add_step(&mut self, step: Step) {
        self.before[step.to].push(self.steps.len());
        self.after[step.from].push(self.steps.len());
        self.steps.push(step);
    }

    /// Returns whether a deadline is met whatever anything takes, as far as this shows it. `earliest` is when the event
    /// that it counts from can happen.
    ///
    /// An event comes right after one of those that it follows, so it is at most as far from `since` as the farthest of
    /// these, and what they take; and it is never farther than what there is at least between it and a later `since`.
    fn is_met(&self, deadline: &Deadline, earliest: Option<i64>) -> bool {
        let until_since = self.times(deadline.since, true, |step| step.least);
        let mut farthest: Vec<Option<i64>> = vec![None; self.before.len()];
        farthest[self.origin] = earliest.map(|earliest| -earliest);
        for _ in 0..=self.order.len() {
            let mut has_changed = false;
            for &point in &self.order {
                let steps = self.before[point].iter().map(|&step| &self.steps[step]);
                let by_steps =
                    steps.filter_map(|step| Some(farthest[step.from]?.saturating_add(step.most))).max();
                let at_most = until_since[point].map(|until_since| -until_since);
                let found = match (by_steps, at_most) {
                    (Some(by_steps), Some(at_most)) => Some(by_steps.min(at_most)),
                    (by_steps, _) => by_steps,
                };
                if found > farthest[point] {
                    (farthest[point], has_changed) = (found, true);
                }
            }
            if !has_changed {
                break;
            }
        }
        farthest[deadline.event].is_some_and(|event| event <= deadline.within)
    }

    /// Returns how long after one point each other comes, or how long before it, by the longest way along the steps.
    fn times(&self, from: usize, is_before: bool, length: impl Fn(&Step) -> i64) -> Vec<Option<i64>> {
        let mut times: Vec<Option<i64>> = vec![None; self.before.len()];
        times[from] = Some(0);
        for _ in 0..=self.order.len() {
            let mut has_changed = false;
            for place in 0..self.order.len() {
                let place = if is_before { self.order.len() - 1 - place } else { place };
                let point = self.order[place];
                let Some(time) = times[point] else { continue };
                let next = if is_before { &self.before[point] } else { &self.after[point] };
                for step in next.iter().map(|&step| &self.steps[step]) {
                    let to = if is_before { step.from } else { step.to };
                    let at = Some(time.saturating_add(length(step)));
                    if at > times[to] {
                        (times[to], has_changed) = (at, true);
                    }
                }
            }
            if !has_changed {
                break;
            }
        }
        times
    }

    /// These points and those after them, or before them, along some of the steps.
    fn reached(
        &self,
        from: impl IntoIterator<Item = usize>,
        is_before: bool,
        counts: impl Fn(&Step) -> bool,
    ) -> Vec<bool> {
        let mut reached = vec![false; self.before.len()];
        let mut open: Vec<usize> = from.into_iter().collect();
        while let Some(point) = open.pop() {
            if !std::mem::replace(&mut reached[point], true) {
                let next = if is_before { &self.before[point] } else { &self.after[point] };
                let steps = next.iter().map(|&step| &self.steps[step]).filter(|step| counts(step));
                open.extend(steps.map(|step| if is_before { step.from } else { step.to }));
            }
        }
        reached
    }
}
