//! Execution of a plan in a simulated world, with replanning when the plan can no longer be kept (SPEC 6.2).
//!
//! The clock jumps from one event to the next; nothing is sampled, so a run is exact, and the same inputs give the same
//! log. Start events call their activities, and events that only the plan restricts happen as early as they may. What
//! the world decides comes when the world says so: if that is outside the event's window, the plan is violated.

use std::sync::Arc;

use rmpl::Rational;
use stn::PointId;
use tpn::{EventEnd, EventRef, Network, NodeId, Occurrence, OccurrenceId, OccurrenceKind, Plan};

use crate::dispatch::{Dispatcher, NEVER};
use crate::facts::Facts;
use crate::log::{Ending, Entry, Happening};
use crate::plan_network::{PlanError, PlanNetwork};
use crate::world::World;

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
    /// How it ended.
    pub ending: Ending,
    /// The network of the last plan.
    pub network: Arc<Network>,
    /// The last plan.
    pub plan: Plan,
    /// When each node of it happened.
    pub times: Vec<Option<Rational>>,
}

/// A run that replans more often than this is stopped: something is wrong with the world or with the mission.
const MOST_REPLANS: usize = 50;

/// Executes `plan` in `world`. `num_program_nodes` is how many nodes the network has without inserted paths.
pub fn run(
    network: Arc<Network>,
    plan: Plan,
    num_program_nodes: usize,
    world: &World,
    replanner: &mut dyn Replanner,
) -> Result<RunOutcome, PlanError> {
    let mut run = Run {
        stage: Stage::new(network, plan)?,
        num_program_nodes,
        world,
        now: Rational::default(),
        log: Vec::new(),
        news: Facts::default(),
        replans: 0,
    };
    let ending = run.run_to_end(replanner)?;
    Ok(RunOutcome {
        log: run.log,
        ending,
        network: run.stage.network,
        plan: run.stage.plan,
        times: run.stage.times,
    })
}

struct Run<'a> {
    stage: Stage,
    num_program_nodes: usize,
    world: &'a World,
    now: Rational,
    log: Vec<Entry>,
    /// What the world has made known against the plan, kept over all replans.
    news: Facts,
    replans: usize,
}

/// The execution of one plan.
struct Stage {
    network: Arc<Network>,
    plan: Plan,
    made: PlanNetwork,
    dispatcher: Dispatcher,
    /// When each node happened.
    times: Vec<Option<Rational>>,
}

/// What comes next.
struct Next {
    point: PointId,
    time: Rational,
    violation: Option<Violation>,
}

struct Violation {
    reason: String,
    news: News,
}

enum News {
    None,
    Duration(OccurrenceId, Rational),
    Begins(OccurrenceId, Rational),
}

impl Stage {
    fn new(network: Arc<Network>, plan: Plan) -> Result<Self, PlanError> {
        let mut made = PlanNetwork::new(&network, &plan)?;
        let dispatcher = Dispatcher::new(&mut made)?;
        let times = vec![None; network.nodes.len()];
        Ok(Self { network, plan, made, dispatcher, times })
    }

    /// The window of a point in mission units; no latest time if it is not bounded.
    fn window(&self, point: PointId) -> (Rational, Option<Rational>) {
        let (earliest, latest) = self.dispatcher.window(point);
        (self.made.time(earliest), (latest != NEVER).then(|| self.made.time(latest)))
    }

    fn occurrence(&self, event: EventRef) -> &Occurrence {
        &self.network.occurrences[event.occurrence.index()]
    }

    fn name(&self, node: NodeId) -> String {
        tpn::plan_json::node_name(&self.network, node)
    }
}

impl Run<'_> {
    fn run_to_end(&mut self, replanner: &mut dyn Replanner) -> Result<Ending, PlanError> {
        loop {
            let Some(next) = self.next() else {
                let is_over = self.stage.times[self.stage.network.end.index()].is_some();
                if is_over {
                    self.write(Happening::Finished);
                    return Ok(Ending::Finished);
                }
                self.write(Happening::Stopped { reason: "nothing can happen any more".to_owned() });
                return Ok(Ending::Stopped);
            };
            self.now = self.now.max(next.time);
            let violation = match next.violation {
                Some(violation) => Some(violation),
                None => self.happen(next.point).err(),
            };
            let Some(violation) = violation else { continue };
            self.write(Happening::Violation { reason: violation.reason });
            match violation.news {
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
            if let Some(reason) = self.replan(replanner)? {
                self.write(Happening::Stopped { reason });
                return Ok(Ending::Stopped);
            }
        }
    }

    /// The earliest thing that happens or goes wrong next; of several at one time the one that is first in the plan.
    fn next(&self) -> Option<Next> {
        let mut best: Option<Next> = None;
        for point in self.stage.made.all_points() {
            let node = self.stage.made.node(point);
            if self.stage.times[node.index()].is_some() {
                continue;
            }
            let is_settled = self.stage.dispatcher.is_settled(point);
            if !is_settled && !self.stage.dispatcher.is_enabled(point) {
                continue;
            }
            let Some(next) = self.candidate(point, node) else { continue };
            if best.as_ref().is_none_or(|best| next.time < best.time) {
                best = Some(next);
            }
        }
        best
    }

    /// When a point would happen, by the plan and by the world.
    fn candidate(&self, point: PointId, node: NodeId) -> Option<Next> {
        let (earliest, latest) = self.stage.window(point);
        let mut time = earliest.max(self.now);
        let mut known = News::None;
        for &event in &self.stage.network.nodes[node.index()].events {
            match self.by_world(event, time)? {
                ByWorld::Free => {}
                ByWorld::At(at, news) => (time, known) = (at, news),
            }
        }
        if time < earliest {
            let reason = format!(
                "{} came at {}, before it could at {}",
                self.stage.name(node),
                shown(time),
                shown(earliest)
            );
            return Some(Next { point, time, violation: Some(Violation { reason, news: known }) });
        }
        if let Some(latest) = latest.filter(|&latest| time > latest) {
            let reason = format!("{} had to come by {} and did not", self.stage.name(node), shown(latest));
            let time = latest.max(self.now);
            return Some(Next { point, time, violation: Some(Violation { reason, news: known }) });
        }
        Some(Next { point, time, violation: None })
    }

    /// When the world lets an event happen, given when the plan would. `None` while that is not known yet.
    fn by_world(&self, event: EventRef, planned: Rational) -> Option<ByWorld> {
        let occurrence = self.stage.occurrence(event);
        let started = self.stage.times[occurrence.start.index()];
        match (occurrence.kind, event.end) {
            (OccurrenceKind::Primitive, EventEnd::End) => {
                let Some(duration) = self.world.duration(&self.stage.network, occurrence) else {
                    return Some(ByWorld::Free);
                };
                // An activity that was given up in a replan has no more say.
                let started = started?;
                Some(ByWorld::At(started + duration, News::Duration(event.occurrence, duration)))
            }
            (OccurrenceKind::Assertion, EventEnd::Start) => {
                let begins = self.world.begins_at(occurrence).filter(|&at| at > planned);
                if let Some(at) = self.world.withdrawn_at(occurrence)
                    && at <= begins.unwrap_or(planned)
                    && !self.is_known_gone(event.occurrence)
                {
                    // It never begins: for planning it is over as soon as it would have begun.
                    let gone = News::Duration(event.occurrence, Rational::default());
                    return Some(ByWorld::At(planned - Rational::from(1), gone));
                }
                Some(begins.map_or(ByWorld::Free, |at| ByWorld::At(at, News::Begins(event.occurrence, at))))
            }
            (OccurrenceKind::Assertion, EventEnd::End) => {
                let started = started?;
                match self.world.withdrawn_at(occurrence) {
                    Some(at) if at >= started && at < planned => {
                        Some(ByWorld::At(at, News::Duration(event.occurrence, at - started)))
                    }
                    _ => Some(ByWorld::Free),
                }
            }
            _ => Some(ByWorld::Free),
        }
    }

    fn is_known_gone(&self, occurrence: OccurrenceId) -> bool {
        self.news
            .durations
            .iter()
            .any(|&(known, duration)| known == occurrence && duration == Rational::default())
    }

    /// A point happens now.
    fn happen(&mut self, point: PointId) -> Result<(), Violation> {
        let node = self.stage.made.node(point);
        let none = |reason: String| Violation { reason, news: News::None };
        let Some(ticks) = self.stage.made.ticks(self.now) else {
            return Err(none(format!("the plan's time is too coarse for {}", shown(self.now))));
        };
        if self.stage.dispatcher.settle(point, ticks).is_err() {
            return Err(none(format!("{} could not come at {}", self.stage.name(node), shown(self.now))));
        }
        self.stage.times[node.index()] = Some(self.now);
        for event in self.stage.network.nodes[node.index()].events.clone() {
            let name = self.stage.network.event_name(event).into();
            self.write(Happening::Executed { name });
        }
        Ok(())
    }

    /// Plans again from now; an answer says why there is no plan.
    fn replan(&mut self, replanner: &mut dyn Replanner) -> Result<Option<String>, PlanError> {
        self.replans += 1;
        if self.replans > MOST_REPLANS {
            return Ok(Some(format!("planned again {MOST_REPLANS} times without an end")));
        }
        let mut facts = Facts { now: self.now, ..self.news.clone() };
        let mut past: Vec<(Rational, usize)> = Vec::new();
        for (index, time) in self.stage.times.iter().enumerate() {
            let Some(time) = *time else { continue };
            if index < self.num_program_nodes {
                facts.happened.push((NodeId::from_index(index), time));
            } else if let Some(&event) = self.stage.network.nodes[index].events.first() {
                facts.passed.push((event, time));
            }
            past.push((time, index));
        }
        let (network, plan) = match replanner.replan(&facts) {
            Ok(found) => found,
            Err(reason) => return Ok(Some(reason)),
        };
        let changes = changed_choices(&self.stage.plan, &plan);
        self.write(Happening::Replanned { changes });
        let mut stage = Stage::new(network, plan)?;
        let happened = facts.happened.iter().map(|&(node, time)| (time, node));
        let passed = facts.passed.iter().filter_map(|&(event, time)| {
            let index = stage.network.nodes.iter().position(|node| node.events.contains(&event))?;
            Some((time, NodeId::from_index(index)))
        });
        let mut past: Vec<(Rational, NodeId)> = happened.chain(passed).collect();
        past.sort();
        for (time, node) in past {
            stage.times[node.index()] = Some(time);
            let settled = stage
                .made
                .point(node)
                .zip(stage.made.ticks(time))
                .map(|(point, ticks)| stage.dispatcher.settle(point, ticks));
            if !matches!(settled, Some(Ok(()))) {
                return Ok(Some(format!("the new plan does not keep {} in the past", stage.name(node))));
            }
        }
        self.stage = stage;
        Ok(None)
    }

    fn write(&mut self, happening: Happening) {
        self.log.push(Entry { time: self.now, happening });
    }
}

/// When the world lets something happen.
enum ByWorld {
    /// Whenever the plan says.
    Free,
    /// Just then, and what is learnt if the plan did not allow for it.
    At(Rational, News),
}

fn shown(time: Rational) -> String {
    rmpl::rational::display(time)
}

fn changed_choices(old: &Plan, new: &Plan) -> Vec<String> {
    new.choices
        .iter()
        .filter_map(|choice| {
            let before = old.choices.iter().find(|before| before.decision == choice.decision);
            let decision = Network::decision_name(choice.decision);
            match before {
                Some(before) if before.alternative == choice.alternative => None,
                Some(before) => Some(format!("{decision}: {} → {}", before.alternative, choice.alternative)),
                None => Some(format!("{decision}: {}", choice.alternative)),
            }
        })
        .collect()
}
