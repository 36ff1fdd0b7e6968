//! Execution of a plan in a simulated world, with replanning when the plan can no longer be kept (SPEC 6.2).
//!
//! The clock jumps from one event to the next; nothing is sampled, so a run is exact, and the same inputs give the same
//! log. Start events call their activities, and events that only the plan restricts happen as early as they may. What
//! the world decides comes when the world says so: if that is outside the event's window, the plan is violated.

mod aborts;
mod frontier;
mod states;

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

use exact::{Bound, Overflow, Rational, Time};
use rmpl::program::Controllability;
use smol_str::SmolStr;
use stn::PointId;
use tpn::{
    ArcId, EventEnd, EventRef, Network, NodeId, OccurrenceId, OccurrenceKind, Plan, ResourceId, ValueId,
    VariableId,
};

use crate::activity_execution::{ActivityExecution, ActivityExecutor, AsPlanned, Ends, PlantReading};
use crate::adversary::Adversary;
use crate::arrivals::Arrivals;
use crate::dispatch::SettleError;
use crate::facts::Facts;
use crate::log::{Ending, Entry, Happening, NEEDED_UNTIL};
use crate::plan_network::PlanError;
use crate::stage::{ExecutedPlan, Stage};
use crate::world::World;
use crate::world_state::WorldState;
use aborts::{Retreat, stopped_for};
use frontier::Frontier;
use states::Odometer;

/// Makes a new plan from facts.
pub trait Replanner {
    /// The network with `facts` and a plan of it; an error says why there is none.
    fn replan(&mut self, facts: &Facts) -> Result<(Arc<Network>, Plan), String>;
}

/// How a run went.
#[derive(Clone, Debug, PartialEq)]
pub struct RunOutcome {
    /// What happened, in order.
    pub log: Vec<Entry>,
    pub ending: Ending,
    /// The plans that were executed, one after the other; there is at least one.
    pub plans: Vec<ExecutedPlan>,
}

impl RunOutcome {
    /// The plan that was executed last.
    pub fn last(&self) -> &ExecutedPlan {
        &self.plans[self.plans.len() - 1]
    }
}

/// A run that replans more often than this is stopped: something is wrong with the world or with the mission.
const MAX_REPLANS: usize = 50;

/// Executes `plan` in `world`, with activities that take as long as planned where the world does not say otherwise.
/// `num_program_nodes` is how many nodes the network has without inserted paths.
pub fn run(
    network: &Arc<Network>,
    plan: Plan,
    num_program_nodes: usize,
    world: &World,
    replanner: &mut dyn Replanner,
) -> Result<RunOutcome, PlanError> {
    let stage = Stage::new(Arc::clone(network), plan, &world.times(network)?)?;
    run_stage(stage, num_program_nodes, world, &mut AsPlanned, replanner)
}

/// Executes a plan that was made ready, in ticks that fit `world` and `executor`.
pub fn run_stage(
    stage: Stage,
    num_program_nodes: usize,
    world: &World,
    executor: &mut dyn ActivityExecutor,
    replanner: &mut dyn Replanner,
) -> Result<RunOutcome, PlanError> {
    let adversary = Adversary::of(world, &stage)?;
    let mut run = Run {
        state: WorldState::new(&stage.network),
        scheduled: world.scheduled(&stage.network),
        adversary,
        frontier: None,
        stage,
        num_program_nodes,
        world,
        executor,
        now: Time::ZERO,
        log: Vec::new(),
        coming: VecDeque::new(),
        executions: BTreeMap::new(),
        arrivals: Arrivals::default(),
        passes: BTreeMap::new(),
        odometers: VecDeque::new(),
        extra_m: BTreeMap::new(),
        counted_margins: BTreeMap::new(),
        num_changes: 0,
        readings: VecDeque::new(),
        estimated: BTreeMap::new(),
        off_plan: BTreeMap::new(),
        news: Facts::default(),
        plans: Vec::new(),
    };
    run.restart_frontier()?;
    let ending = run.run_to_end(replanner)?;
    let Run { stage, mut plans, log, .. } = run;
    plans.push(stage.close());
    Ok(RunOutcome { log, ending, plans })
}

struct Run<'a> {
    stage: Stage,
    num_program_nodes: usize,
    world: &'a World,
    executor: &'a mut dyn ActivityExecutor,
    now: Time,
    log: Vec<Entry>,
    /// What is known to be seen of the activities under way, in order of time.
    coming: VecDeque<(OccurrenceId, Entry)>,
    /// When the activities that were started will be over.
    executions: BTreeMap<OccurrenceId, Ends>,
    /// When those of them that drive arrive.
    arrivals: Arrivals,
    /// After how long from their traverse's start path vertices are passed.
    passes: BTreeMap<OccurrenceId, Vec<(EventRef, Time)>>,
    /// What is so in the world.
    state: WorldState,
    /// How far the traverses under way will have driven, in order of time.
    odometers: VecDeque<Odometer>,
    /// How many meters more than their paths have traverses have driven so far.
    extra_m: BTreeMap<OccurrenceId, Rational>,
    /// How many meters more than their paths have the plan counts for traverses at most, and how many fewer at least.
    counted_margins: BTreeMap<OccurrenceId, [Rational; 2]>,
    /// How many of the world's changes have happened.
    num_changes: usize,
    /// What will be read from the plant, in order of time.
    readings: VecDeque<PlantReading>,
    /// What was read from it last; before, it is as it begins.
    estimated: BTreeMap<VariableId, ValueId>,
    /// How far reservoirs have come off the present plan by what no one planned.
    off_plan: BTreeMap<ResourceId, Rational>,
    /// What the world has made known against the plan, kept over all replans.
    news: Facts,
    /// The plans that were given up.
    plans: Vec<ExecutedPlan>,
    /// When each node is to happen at the earliest, by the schedule of the first plan; empty without one.
    scheduled: Vec<Option<Time>>,
    /// Who makes the present plan fail, if someone does.
    adversary: Option<Adversary>,
    /// What may be next in a plan with many events.
    frontier: Option<Frontier>,
}

/// What comes next.
struct Next {
    point: PointId,
    time: Time,
    violation: Option<Violation>,
}

struct Violation {
    /// The event that could not be kept.
    name: SmolStr,
    reason: String,
    news: News,
    /// Whether no plan can fix it: an activity that was started never ends.
    is_final: bool,
    /// Whether two vehicles touch.
    is_contact: bool,
}

impl Violation {
    /// A violation that replanning may fix.
    const fn new(name: SmolStr, reason: String, news: News) -> Self {
        Self { name, reason, news, is_final: false, is_contact: false }
    }
}

#[derive(Clone, Copy)]
enum News {
    None,
    Duration(OccurrenceId, Time),
    Begins(OccurrenceId, Time),
}

/// What decides when a node happens.
#[derive(Clone, Copy)]
enum Decider {
    /// The environment, which ends this duration there.
    Nature(ArcId),
    /// What the world makes of this event.
    Event(EventRef),
}

/// When the world lets something happen.
enum ByWorld {
    /// Whenever the plan says.
    Free,
    /// Just then, and what is learned if the plan did not allow for it.
    At(Time, News),
    /// Not at all, which is known from this time on; why, and what is learned.
    Gone(Time, String, News),
    /// Not at all, which is known only when its time is over; why.
    Never(String),
}

impl Run<'_> {
    fn run_to_end(&mut self, replanner: &mut dyn Replanner) -> Result<Ending, PlanError> {
        loop {
            let next = self.next()?;
            let Some(next) = self.contact_before(next.as_ref()).or(next) else {
                let is_over = self.stage.times[self.stage.network.end.index()].is_some();
                if is_over {
                    self.write(Happening::Finished);
                    return Ok(Ending::Finished);
                }
                self.write(Happening::Stopped { reason: "no further event can happen".to_owned() });
                return Ok(Ending::Stopped);
            };
            let now = self.now;
            let violation = match self.let_world_act(next.time)? {
                Some(violation) => Some(violation),
                // What is next may be otherwise now.
                None if self.now > now => continue,
                None => {
                    self.advance(next.time);
                    match next.violation {
                        Some(violation) => Some(violation),
                        None => self.happen(next.point)?,
                    }
                }
            };
            let Some(violation) = violation else { continue };
            let Violation { name, reason, news, is_final, is_contact } = violation;
            self.write(Happening::Violation { name, reason: reason.clone(), is_contact });
            if is_final {
                self.write(Happening::Stopped { reason });
                return Ok(Ending::Stopped);
            }
            let need = self.lost_need(&news);
            self.learn(news);
            let num_plans = self.plans.len();
            let Some(no_plan) = self.replan(replanner)? else { continue };
            // A plan that does not keep the past is not fixed by giving up more.
            let has_new_plan = self.plans.len() > num_plans;
            let retreat = if has_new_plan { Retreat::Impossible(None) } else { self.take_back(replanner)? };
            let Retreat::Impossible(hindrance) = retreat else { continue };
            let reason = stopped_for(need.as_deref(), &no_plan, hindrance.as_deref());
            self.write(Happening::Stopped { reason });
            return Ok(Ending::Stopped);
        }
    }

    /// That vehicles touch, if they do no later than what comes next.
    fn contact_before(&self, next: Option<&Next>) -> Option<Next> {
        let contact = self.executor.contact()?;
        let time = contact.at.max(self.now);
        if next.is_some_and(|next| next.time < time) {
            return None;
        }
        let violation = Violation::new(contact.name, contact.reason, News::None);
        let violation = Some(Violation { is_final: true, is_contact: true, ..violation });
        Some(Next { point: self.stage.made.origin(), time, violation })
    }

    /// Time continues; what is seen of the activities under way is written down.
    fn advance(&mut self, time: Time) {
        if time > self.now {
            self.state.advance();
        }
        while let Some((occurrence, entry)) = self.coming.pop_front_if(|(_, entry)| entry.time <= time) {
            let end = self.stage.network.occurrences[occurrence.index()].end;
            if self.stage.times[end.index()].is_none() {
                self.now = self.now.max(entry.time);
                self.log.push(entry);
            }
        }
        self.now = self.now.max(time);
    }

    fn learn(&mut self, news: News) {
        match news {
            News::None => {}
            News::Duration(occurrence, duration) => {
                self.news.durations.retain(|&(known, _)| known != occurrence);
                self.news.durations.push((occurrence, duration));
            }
            News::Begins(occurrence, time) => {
                self.news.begins.retain(|&(known, _)| known != occurrence);
                self.news.begins.push((occurrence, time));
            }
        }
    }

    /// The earliest thing that happens or goes wrong next; of several at one time the one that is first in the plan
    /// (SPEC 10.4).
    fn next(&mut self) -> Result<Option<Next>, PlanError> {
        if self.frontier.is_some() {
            let next = self.next_of_frontier()?;
            return match &self.adversary {
                Some(adversary) => self.opposed(adversary, next),
                None => Ok(next),
            };
        }
        let mut at_once: Vec<Next> = Vec::new();
        let driven = self.driven()?;
        for point in self.stage.made.all_points() {
            let node = self.stage.made.node(point);
            if self.stage.times[node.index()].is_some() {
                continue;
            }
            let is_settled = self.stage.dispatch.is_settled(point);
            if !is_settled && !self.stage.dispatch.is_enabled(point) {
                continue;
            }
            // What the world reports comes whether it is its turn or not.
            if !self.stage.is_next(node) && !self.is_reported(point)? {
                continue;
            }
            // What comes together with a report waits for it.
            let waits = driven.contains(&self.stage.dispatch.component(point));
            if !is_settled && waits && !self.is_driven(point)? {
                continue;
            }
            let Some(next) = self.candidate(point, node)? else { continue };
            if at_once.first().is_some_and(|first| next.time < first.time) {
                at_once.clear();
            }
            if at_once.first().is_none_or(|first| next.time == first.time) {
                at_once.push(next);
            }
        }
        let best = self.first_of(at_once);
        match &self.adversary {
            Some(adversary) => self.opposed(adversary, best),
            None => Ok(best),
        }
    }

    /// Returns what is first of that which may happen at one time. What the environment does is seen before the
    /// executive continues, unless that is before it in the plan.
    fn first_of(&self, mut at_once: Vec<Next>) -> Option<Next> {
        let node = |next: &Next| self.stage.made.node(next.point);
        at_once.sort_by_key(|next| self.stage.rank(next.point));
        let natures = at_once.iter().position(|next| self.is_natures(node(next)));
        let first = natures.map_or(0, |natures| {
            let is_before = |next: &Next| self.stage.happens_before(node(next), node(&at_once[natures]));
            at_once[..natures].iter().position(is_before).unwrap_or(natures)
        });
        (first < at_once.len()).then(|| at_once.swap_remove(first))
    }

    /// Returns whether the environment ends a duration at a node.
    fn is_natures(&self, node: NodeId) -> bool {
        let asked = self.stage.network.controllability != Controllability::None || self.adversary.is_some();
        asked && self.stage.natures.contains_key(&node)
    }

    /// When the environment ends a duration that it chooses, from all that is known of it.
    fn by_nature(&self, id: ArcId) -> Result<Option<ByWorld>, Overflow> {
        let arc = &self.stage.network.arcs[id.index()];
        let Some(started) = self.stage.times[arc.from.index()].filter(|_| self.adversary.is_none()) else {
            return Ok(None);
        };
        let Some(occurrence) = arc.occurrence else {
            return Ok(Some(ByWorld::At(started.checked_add(arc.lower).ok_or(Overflow)?, News::None)));
        };
        let described = &self.stage.network.occurrences[occurrence.index()];
        let chosen = match (self.world.duration(&self.stage.network, described)?, arc.upper) {
            (Some(given), _) => given,
            (None, Bound::Finite(upper)) => self.world.chosen(described, [arc.lower, upper]),
            (None, Bound::Infinite) => arc.lower,
        };
        let duration = match self.executions.get(&occurrence) {
            Some(Ends::Never(reason)) => return Ok(Some(ByWorld::Never(reason.clone()))),
            Some(Ends::After(duration)) => *duration,
            // An activity that is early waits until the environment ends it.
            Some(Ends::NotBefore(duration)) => chosen.max(*duration),
            Some(Ends::AsPlanned) | None => chosen,
        };
        let at = started.checked_add(duration).ok_or(Overflow)?;
        Ok(Some(ByWorld::At(at, News::Duration(occurrence, duration))))
    }

    /// Returns what decides when a node happens besides the plan, in order: nature's durations that end there, then its
    /// events.
    fn deciders(&self, node: NodeId) -> Vec<Decider> {
        let arcs = self.stage.natures.get(&node).filter(|_| self.is_natures(node));
        let natures = arcs.into_iter().flatten().map(|&arc| Decider::Nature(arc));
        let own = self.stage.events(node).filter(|event| {
            // When the environment ends it was said above; what is asserted may still be withdrawn.
            let occurrence = self.stage.occurrence(*event);
            let is_end = event.end == EventEnd::End && occurrence.kind != OccurrenceKind::Assertion;
            !(is_end && arcs.zip(occurrence.arc).is_some_and(|(arcs, arc)| arcs.contains(&arc)))
        });
        natures.chain(own.map(Decider::Event)).collect()
    }

    fn decision(&self, decider: &Decider, planned: Time) -> Result<Option<ByWorld>, Overflow> {
        match *decider {
            Decider::Nature(arc) => self.by_nature(arc),
            Decider::Event(event) => self.by_world(event, planned),
        }
    }

    /// The components of which some member's time is not for the executive to choose.
    fn driven(&self) -> Result<BTreeSet<usize>, PlanError> {
        let mut driven = BTreeSet::new();
        for point in self.stage.made.all_points() {
            if !self.stage.dispatch.is_settled(point) && self.is_driven(point)? {
                driven.insert(self.stage.dispatch.component(point));
            }
        }
        Ok(driven)
    }

    /// Returns whether the world has decided when a point happens at the earliest, or that it does not.
    fn is_driven(&self, point: PointId) -> Result<bool, PlanError> {
        self.is_decided(point, |_| true)
    }

    /// Returns whether the world has decided when a point happens, or that it does not, and the plan cannot delay it.
    /// The end of an activity that waits when it is early, such as a drive that has arrived, does not count: the plan
    /// can delay it.
    fn is_reported(&self, point: PointId) -> Result<bool, PlanError> {
        self.is_decided(point, |decider| match decider {
            Decider::Nature(_) => true,
            Decider::Event(event) => {
                let ends = self.executions.get(&event.occurrence).filter(|_| event.end == EventEnd::End);
                !matches!(ends, Some(Ends::NotBefore(_)))
            }
        })
    }

    /// Returns whether a decider that counts has decided when a point happens, or that it does not.
    fn is_decided(&self, point: PointId, counts: impl Fn(&Decider) -> bool) -> Result<bool, PlanError> {
        let planned = self.stage.window(point).0.max(self.now);
        let node = self.stage.made.node(point);
        if self.is_natures(node) {
            // No one waits for the end of what has not started.
            let began = |arc: &ArcId| {
                let from = self.stage.network.arcs[arc.index()].from;
                self.stage.times[from.index()].is_some()
            };
            return Ok(self.stage.natures.get(&node).is_some_and(|arcs| arcs.iter().all(began)));
        }
        for decider in self.deciders(node).into_iter().filter(counts) {
            let decided = self.decision(&decider, planned).map_err(|_| self.too_large(node))?;
            if decided.is_some_and(|decided| !matches!(decided, ByWorld::Free)) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Returns what happens to a node would happen at a time that does not fit.
    fn too_large(&self, node: NodeId) -> PlanError {
        PlanError::TooLate { event: self.stage.name(node) }
    }

    /// When a point would happen, by the plan and by the world.
    fn candidate(&self, point: PointId, node: NodeId) -> Result<Option<Next>, PlanError> {
        let (earliest, latest) = self.stage.window(point);
        let mut time = earliest.max(self.now);
        let pace = self.pace(node).map_err(|_| self.too_large(node))?;
        time = pace.map_or(time, |pace| time.max(pace));
        if let Some(scheduled) = self.scheduled.get(node.index()).copied().flatten() {
            time = time.max(latest.map_or(scheduled, |latest| scheduled.min(latest)));
        }
        if let Some(leaving) = self.arrivals.leaving_time(&self.stage, point) {
            time = time.max(latest.map_or(leaving, |latest| leaving.min(latest)));
        }
        let mut known = News::None;
        let violation = |time: Time, reason: String, news: News| {
            let name = self.stage.name(node).into();
            Next { point, time, violation: Some(Violation::new(name, reason, news)) }
        };
        for decider in self.deciders(node) {
            let decided = self.decision(&decider, time).map_err(|_| self.too_large(node))?;
            let Some(decided) = decided else { return Ok(None) };
            match decided {
                ByWorld::Free => {}
                ByWorld::At(at, news) => (time, known) = (at, news),
                ByWorld::Gone(at, reason, news) => {
                    return Ok(Some(violation(at.max(self.now), reason, news)));
                }
                ByWorld::Never(reason) => {
                    let Some(latest) = latest else { return Ok(None) };
                    let latest = latest.max(self.now);
                    let mut next = violation(latest, self.too_late(node, latest, Some(&reason)), News::None);
                    if let Some(violation) = &mut next.violation {
                        violation.is_final = true;
                    }
                    return Ok(Some(next));
                }
            }
        }
        if let Some(latest) = latest.filter(|_| self.stage.guides.contains_key(&node)) {
            // Vertices are not deadlines: whether the traverse is late shows at its end.
            time = time.min(latest.max(self.now));
        }
        Ok(Some(self.at(point, time, known)))
    }

    /// When a vertex of a path is passed of which no one reports that, so that the whole traverse takes as long as it
    /// does: as early as its speeds allow.
    fn pace(&self, node: NodeId) -> Result<Option<Time>, Overflow> {
        let Some(guide) = self.stage.guides.get(&node) else { return Ok(None) };
        let occurrence = &self.stage.network.occurrences[guide.traverse.index()];
        let Some(started) = self.stage.times[occurrence.start.index()] else { return Ok(None) };
        let is_reported = self.passes.contains_key(&guide.traverse);
        let given = self.world.duration(&self.stage.network, occurrence)?;
        let duration = match (given, self.executions.get(&guide.traverse)) {
            _ if is_reported => return Ok(None),
            (Some(given), _) => given,
            (None, Some(Ends::After(duration))) => *duration,
            _ => {
                let Some(end) = self.stage.made.point(occurrence.end) else { return Ok(None) };
                self.stage.window(end).0.checked_sub(started).ok_or(Overflow)?
            }
        };
        let late = match guide.max_after {
            Bound::Infinite => Time::ZERO,
            Bound::Finite(after) => duration.checked_sub(after).ok_or(Overflow)?,
        };
        let after = guide.min_before.max(late).min(duration);
        Ok(Some(started.checked_add(after).ok_or(Overflow)?))
    }

    /// A point happens at a time that may be outside its window; what is learned then.
    fn at(&self, point: PointId, time: Time, news: News) -> Next {
        let node = self.stage.made.node(point);
        let (earliest, latest) = self.stage.window(point);
        let (time, reason) = match latest {
            _ if time < earliest => (time, self.too_early(node, time, earliest)),
            Some(latest) if time > latest => (latest.max(self.now), self.too_late(node, latest, None)),
            _ => return Next { point, time, violation: None },
        };
        let name = self.stage.name(node).into();
        Next { point, time, violation: Some(Violation::new(name, reason, news)) }
    }

    /// Returns what the environment does against the executive, given what that would do next.
    fn opposed(&self, adversary: &Adversary, best: Option<Next>) -> Result<Option<Next>, PlanError> {
        if best.as_ref().is_some_and(|best| best.violation.is_some()) {
            return Ok(best);
        }
        let next = best.as_ref().map(|best| (self.stage.made.node(best.point), best.time));
        let Some((arc, time)) = adversary.answer(&self.stage, self.now, next)? else { return Ok(best) };
        let described = &self.stage.network.arcs[arc.index()];
        let Some(point) = self.stage.made.point(described.to) else { return Ok(best) };
        let began = self.stage.times[described.from.index()];
        let lasted = began.and_then(|began| time.checked_sub(began));
        let news = described.occurrence.zip(lasted);
        let news = news.map_or(News::None, |(occurrence, lasted)| News::Duration(occurrence, lasted));
        Ok(Some(self.at(point, time, news)))
    }

    fn too_early(&self, node: NodeId, time: Time, earliest: Time) -> String {
        let (name, time, earliest) = (self.stage.name(node), shown(time), shown(earliest));
        let withdrawn = self.stage.events(node).find_map(|event| {
            let occurrence = self.stage.occurrence(event);
            let is_end = occurrence.kind == OccurrenceKind::Assertion && event.end == EventEnd::End;
            is_end.then_some(&occurrence.name)
        });
        match withdrawn {
            Some(condition) => {
                format!("{condition} was withdrawn at {time}{NEEDED_UNTIL}{earliest}")
            }
            None => format!("{name} happened at {time}, before its earliest time {earliest}"),
        }
    }

    fn too_late(&self, node: NodeId, latest: Time, reason: Option<&str>) -> String {
        let (name, latest) = (self.stage.name(node), shown(latest));
        let because = reason.map_or_else(String::new, |reason| format!(": {reason}"));
        format!("{name} did not happen by its latest time {latest}{because}")
    }

    /// When the world lets an event happen, given when the plan would. `None` while that is not known yet.
    fn by_world(&self, event: EventRef, planned: Time) -> Result<Option<ByWorld>, Overflow> {
        let occurrence = self.stage.occurrence(event);
        let started = self.stage.times[occurrence.start.index()];
        let decided = match (occurrence.kind, event.end) {
            (OccurrenceKind::Primitive, EventEnd::PathVertex { .. }) => {
                let mut passes = self.passes.get(&event.occurrence).into_iter().flatten();
                let Some(&(_, after)) = passes.find(|(vertex, _)| *vertex == event) else {
                    return Ok(Some(ByWorld::Free));
                };
                let Some(started) = started else { return Ok(None) };
                let news = match self.executions.get(&event.occurrence) {
                    Some(Ends::After(all) | Ends::NotBefore(all)) => News::Duration(event.occurrence, *all),
                    _ => News::None,
                };
                ByWorld::At(started.checked_add(after).ok_or(Overflow)?.max(planned), news)
            }
            (OccurrenceKind::Primitive, EventEnd::End) => {
                let given = self.world.duration(&self.stage.network, occurrence)?;
                let execution = self.executions.get(&event.occurrence);
                let duration = match (given, execution) {
                    (Some(given), _) => given,
                    (None, Some(Ends::After(duration))) => *duration,
                    (None, Some(Ends::NotBefore(duration))) => {
                        let Some(started) = started else { return Ok(None) };
                        planned.checked_sub(started).ok_or(Overflow)?.max(*duration)
                    }
                    (None, Some(Ends::Never(reason))) => return Ok(Some(ByWorld::Never(reason.clone()))),
                    (None, Some(Ends::AsPlanned) | None) => return Ok(Some(ByWorld::Free)),
                };
                // An activity that was given up in a replan has no more say.
                let Some(started) = started else { return Ok(None) };
                let at = started.checked_add(duration).ok_or(Overflow)?;
                ByWorld::At(at, News::Duration(event.occurrence, duration))
            }
            (OccurrenceKind::Assertion, EventEnd::Start) => {
                let begins = self.world.begins_at(occurrence).filter(|&at| at > planned);
                if let Some(at) = self.world.withdrawn_at(occurrence)
                    && at <= begins.unwrap_or(planned)
                    && !self.is_known_gone(event.occurrence)
                {
                    // It never begins: for planning it is over as soon as it would have started.
                    let gone = News::Duration(event.occurrence, Time::ZERO);
                    let reason =
                        format!("{} was withdrawn at {} before it started", occurrence.name, shown(at));
                    return Ok(Some(ByWorld::Gone(at, reason, gone)));
                }
                begins.map_or(ByWorld::Free, |at| ByWorld::At(at, News::Begins(event.occurrence, at)))
            }
            (OccurrenceKind::Assertion, EventEnd::End) => {
                let Some(started) = started else { return Ok(None) };
                let overridden = self.world.overridden_at(&self.stage.network, occurrence, started);
                match self.world.withdrawn_at(occurrence).into_iter().chain(overridden).min() {
                    Some(at) if at >= started && at < planned => {
                        let held = at.checked_sub(started).ok_or(Overflow)?;
                        ByWorld::At(at, News::Duration(event.occurrence, held))
                    }
                    _ => ByWorld::Free,
                }
            }
            _ => ByWorld::Free,
        };
        Ok(Some(decided))
    }

    fn is_known_gone(&self, occurrence: OccurrenceId) -> bool {
        self.news.durations.iter().any(|&(known, duration)| known == occurrence && duration.is_zero())
    }

    /// A point happens now, if it can.
    fn happen(&mut self, point: PointId) -> Result<Option<Violation>, PlanError> {
        let node = self.stage.made.node(point);
        // Ticks are fine enough for all times that the world and the executor bring.
        let ticks = self.stage.made.scale().ticks(self.now).map_err(|_| self.too_large(node))?;
        match self.stage.dispatch.settle(point, ticks) {
            Ok(()) => {}
            // What the environment does waits for no one.
            Err(SettleError::NotYet(other)) if self.adversary.is_some() && self.is_natures(node) => {
                let (name, other) = (self.stage.name(node), self.stage.name(self.stage.made.node(other)));
                let reason =
                    format!("{name} happened at {}, but {other} had to happen first", shown(self.now));
                return Ok(Some(Violation::new(name.into(), reason, News::None)));
            }
            Err(SettleError::NotYet(other)) => {
                self.wait_for(point, other);
                return Ok(None);
            }
            Err(SettleError::Overflow(point)) => return Err(self.too_large(self.stage.made.node(point))),
            Err(SettleError::OutOfWindow) => {
                let name = self.stage.name(node);
                let reason = format!("{name} could not happen at {}", shown(self.now));
                return Ok(Some(Violation::new(name.into(), reason, News::None)));
            }
        }
        self.stage.times[node.index()] = Some(self.now);
        let events: Vec<EventRef> = self.stage.events(node).collect();
        for event in events {
            let name = self.stage.network.event_name(event).into();
            self.write(Happening::Executed { name });
            self.begin(event)?;
        }
        let violation = self.change_states(node);
        self.look_beyond(point)?;
        Ok(violation)
    }

    /// Calls the activity whose start has just happened.
    fn begin(&mut self, event: EventRef) -> Result<(), PlanError> {
        let occurrence = self.stage.occurrence(event);
        let is_start = occurrence.kind == OccurrenceKind::Primitive && event.end == EventEnd::Start;
        let end = format!("{}.end", occurrence.name);
        let too_late = |_: Overflow| PlanError::TooLate { event: end.clone() };
        // Whose end an adversary chooses is known only when it ends.
        if self.adversary.is_some() && self.is_natures(occurrence.end) {
            return Ok(());
        }
        if !is_start {
            return Ok(());
        }
        if let Some(given) = self.world.duration(&self.stage.network, occurrence).map_err(too_late)? {
            return self.expect_duration(event.occurrence, Some(given));
        }
        let execution =
            self.executor.start(&self.stage.network, event.occurrence, self.now).map_err(too_late)?;
        self.expect_meters(event.occurrence, self.now, &execution).map_err(too_late)?;
        self.revise()?;
        self.expect_duration(event.occurrence, execution.ends.least())?;
        self.arrivals.expect(&mut self.stage, event.occurrence, &execution.ends)?;
        self.expect(event.occurrence, execution);
        Ok(())
    }

    /// Takes in how long an activity under way takes at least, or that it never ends.
    fn expect_duration(&mut self, occurrence: OccurrenceId, least: Option<Time>) -> Result<(), PlanError> {
        if !self.stage.expect(occurrence, least)? {
            return Ok(());
        }
        // Its ticks may be others than before.
        self.arrivals = Arrivals::all(&mut self.stage, &self.executions)?;
        self.restart_frontier()
    }

    /// Takes in how an activity will go.
    fn expect(&mut self, occurrence: OccurrenceId, execution: ActivityExecution) {
        self.executions.insert(occurrence, execution.ends);
        for (event, after) in execution.passes {
            self.passes.entry(event.occurrence).or_default().push((event, after));
        }
        for entry in execution.entries {
            let at = self.coming.partition_point(|(_, before)| before.time <= entry.time);
            self.coming.insert(at, (occurrence, entry));
        }
    }

    /// Takes in what will go otherwise than it was said.
    fn revise(&mut self) -> Result<(), PlanError> {
        let Some(revision) = self.executor.revise() else { return Ok(()) };
        for (occurrence, mut execution) in revision.executions {
            let described = &self.stage.network.occurrences[occurrence.index()];
            let event = format!("{}.end", described.name);
            let too_late = |_: Overflow| PlanError::TooLate { event: event.clone() };
            let started = self.stage.times[described.start.index()];
            let Some(started) = started.filter(|_| self.executions.contains_key(&occurrence)) else {
                continue;
            };
            let now = self.now;
            self.coming.retain(|(of, entry)| *of != occurrence || entry.time <= now);
            execution.entries.retain(|entry| entry.time > now);
            self.passes.remove(&occurrence);
            self.odometers.retain(|odometer| odometer.occurrence != occurrence || odometer.at <= now);
            let since = now.checked_sub(started).ok_or(Overflow).map_err(too_late)?;
            execution.extra_meters.retain(|&(after, _)| after > since);
            self.expect_meters(occurrence, started, &execution).map_err(too_late)?;
            self.expect_duration(occurrence, execution.ends.least())?;
            self.expect(occurrence, execution);
        }
        if let Some(readings) = revision.readings {
            self.readings = readings.into();
        }
        self.arrivals = Arrivals::all(&mut self.stage, &self.executions)?;
        Ok(())
    }

    /// Plans again from now; an answer says why there is no plan.
    fn replan(&mut self, replanner: &mut dyn Replanner) -> Result<Option<String>, PlanError> {
        if self.plans.len() >= MAX_REPLANS {
            return Ok(Some(format!("stopped after {MAX_REPLANS} replans")));
        }
        let mut facts = Facts { now: self.now, ..self.news.clone() };
        for (index, time) in self.stage.times.iter().enumerate() {
            let Some(time) = *time else { continue };
            if index < self.num_program_nodes {
                facts.happened.push((NodeId::from_index(index), time));
            } else if let Some(&event) = self.stage.network.nodes[index].events.first() {
                facts.passed.push((event, time));
            }
        }
        let (network, plan) = match replanner.replan(&facts) {
            Ok(found) => found,
            Err(reason) => return Ok(Some(reason)),
        };
        let changes = changed_choices(&network, &self.stage.plan, &plan);
        self.write(Happening::Replanned { changes });
        let mut grid = self.world.times(&network)?;
        grid.push(self.executor.granularity());
        grid.push(self.now);
        let mut stage = Stage::new(network, plan, &grid)?;
        stage.from = self.now;
        // What was given up is in no plan any more.
        let given_up: Vec<Vec<bool>> = facts
            .taken_back
            .iter()
            .map(|it| stage.network.own_nodes(it.choice.decision, it.choice.alternative))
            .collect();
        let is_kept = |node: NodeId| given_up.iter().all(|own| !own[node.index()]);
        let happened = facts.happened.iter().filter(|(node, _)| is_kept(*node));
        let happened = happened.map(|&(node, time)| (time, node));
        let passed = facts.passed.iter().filter_map(|&(event, time)| {
            let index = stage.network.nodes.iter().position(|node| node.events.contains(&event))?;
            Some((time, NodeId::from_index(index)))
        });
        let past: Vec<(Time, NodeId)> =
            happened.chain(passed).chain(facts.world_nodes(&stage.network)).collect();
        let kept = stage.enter_past(past);
        self.off_plan.clear();
        let times = &stage.times;
        self.state.follow(&stage.network, &stage.plan, &stage.effects, |node| times[node.index()].is_some());
        self.adversary = Adversary::of(self.world, &stage)?;
        let before = std::mem::replace(&mut self.stage, stage);
        self.plans.push(before.close());
        self.scheduled.clear();
        for (&occurrence, ends) in &self.executions {
            self.stage.expect(occurrence, ends.least())?;
        }
        self.arrivals = Arrivals::all(&mut self.stage, &self.executions)?;
        self.restart_frontier()?;
        Ok(kept.err().map(|node| {
            format!("the new plan changes {}, which has already happened", self.stage.name(node))
        }))
    }

    fn write(&mut self, happening: Happening) {
        self.log.push(Entry { time: self.now, happening });
    }
}

fn shown(time: Time) -> String {
    time.readable()
}

fn changed_choices(network: &Network, old: &Plan, new: &Plan) -> Vec<String> {
    new.choices
        .iter()
        .filter_map(|choice| {
            let before = old.choices.iter().find(|before| before.decision == choice.decision);
            let decision = Network::decision_name(choice.decision);
            let name = |alternative: u32| network.alternative_name(choice.decision, alternative);
            let taken = name(choice.alternative);
            match before {
                Some(before) if before.alternative == choice.alternative => None,
                Some(before) => {
                    let before = name(before.alternative);
                    Some(format!("{decision} takes {taken} instead of {}", tpn::other_choice(&before)))
                }
                None => Some(format!("{decision} takes {taken}")),
            }
        })
        .collect()
}
