//! Alternatives that are taken back while they run (SPEC 15): what is under way in one is ended early, if all of it can be,
//! and the mission continues by another alternative. What was executed stays executed.

use exact::{Overflow, Rational, Time};
use rmpl::program::{Change, LabelMode};
use tpn::{Choice, Extent, LabelId, NodeId, OccurrenceId, OccurrenceKind, UseId, ValueSet};

use super::{News, Replanner, Run, shown};
use crate::facts::{StandingPlace, TakenBack};
use crate::log::{Entry, Happening};
use crate::plan_network::PlanError;

/// What came of looking for an alternative to take back.
pub(super) enum Retreat {
    /// There is a plan without it.
    Planned,
    /// There is none; what stood in the way, if that was an activity that cannot be ended early.
    Impossible(Option<String>),
}

/// What a started alternative holds.
struct Begun {
    choice: Choice,
    /// Its primitives that have started, and of them those that continue.
    started: Vec<OccurrenceId>,
    running: Vec<OccurrenceId>,
    /// By node: whether it belongs to it alone.
    is_own: Vec<bool>,
}

impl Run<'_> {
    /// Gives up the innermost started alternative without which there is a plan.
    pub(super) fn take_back(&mut self, replanner: &mut dyn Replanner) -> Result<Retreat, PlanError> {
        let mut hindrance = None;
        for begun in self.begun_alternatives() {
            let fixed = begun.running.iter().find(|id| self.abort_time(**id).is_none());
            if let Some(id) = fixed {
                let name = &self.stage.network.occurrences[id.index()].name;
                hindrance = Some(format!("{name} is in progress and cannot be ended early"));
                break;
            }
            let takes = begun.running.iter().filter_map(|&id| self.abort_time(id)).max().unwrap_or_default();
            let since = self.now.checked_add(takes).ok_or(Overflow)?;
            let (news, log_length) = (self.news.clone(), self.log.len());
            let places = self.executor.whereabouts(&self.stage.network, &begun.started, self.now);
            self.keep_what_was_done(&begun);
            let stands = |(vehicle, place_m)| StandingPlace { vehicle, place_m, since };
            self.news.places.retain(|it| places.iter().all(|(vehicle, _)| *vehicle != it.vehicle));
            self.news.places.extend(places.into_iter().map(stands));
            self.news.taken_back.push(TakenBack { choice: begun.choice, since });
            for &id in &begun.running {
                let name = self.stage.network.occurrences[id.index()].name.clone();
                let text = match self.abort_time(id) {
                    Some(takes) if takes.is_positive() => {
                        format!("is being ended early, until {}", shown(since))
                    }
                    _ => "is ended early".to_owned(),
                };
                self.write(Happening::Progress { name, text });
            }
            let network = std::sync::Arc::clone(&self.stage.network);
            let (changing, used) = self.under_way(&begun);
            let num_plans = self.plans.len();
            if let Some(reason) = self.replan(replanner)? {
                if self.plans.len() > num_plans {
                    // The new plan is followed already, and does not keep the past.
                    return Ok(Retreat::Impossible(Some(reason)));
                }
                self.news = news;
                self.log.truncate(log_length);
                continue;
            }
            self.executor.abandon(&network, &begun.started, self.now);
            for &id in &begun.running {
                self.executions.remove(&id);
                self.coming.retain(|(of, _)| *of != id);
                self.odometers.retain(|odometer| odometer.occurrence != id);
                if since > self.now {
                    let name = network.occurrences[id.index()].name.clone();
                    let happening = Happening::Progress { name, text: "has ended".to_owned() };
                    let at = self.coming.partition_point(|(_, before)| before.time <= since);
                    self.coming.insert(at, (id, Entry { time: since, happening }));
                }
            }
            for happening in self.state.abandon(&network, &changing, &used) {
                self.write(happening);
            }
            self.revise()?;
            return Ok(Retreat::Planned);
        }
        Ok(Retreat::Impossible(hindrance))
    }

    /// Returns how long ending an activity early takes, if that can be done.
    fn abort_time(&self, id: OccurrenceId) -> Option<Time> {
        let occurrence = &self.stage.network.occurrences[id.index()];
        occurrence.aborts.map(|range| self.world.abort_time(occurrence, range))
    }

    /// The alternatives that have started and are not over, the innermost first.
    fn begun_alternatives(&self) -> Vec<Begun> {
        let (network, plan) = (&self.stage.network, &self.stage.plan);
        let has_come = |node: NodeId| self.stage.times[node.index()].is_some();
        let mut begun: Vec<(usize, Begun)> = Vec::new();
        for &choice in &plan.choices {
            let Some(decision) = network.decisions.get(choice.decision.index()) else { continue };
            if decision.alternatives.len() < 2 {
                continue;
            }
            let is_own = network.own_nodes(choice.decision, choice.alternative);
            let selected = || {
                let nodes = is_own.iter().zip(&plan.selected_nodes).enumerate();
                nodes
                    .filter(|(_, (own, selected))| **own && **selected)
                    .map(|(index, _)| NodeId::from_index(index))
            };
            let size = selected().count();
            // It continues until what all alternatives lead to has come.
            let goes_on = network.arcs.iter().zip(&plan.selected_arcs).any(|(arc, selected)| {
                *selected && arc.to != network.start && is_own[arc.from.index()] && !has_come(arc.to)
            });
            if !selected().any(has_come) || !goes_on {
                continue;
            }
            let ids = (0..network.occurrences.len()).map(OccurrenceId::from_index);
            let is_started = |id: &OccurrenceId| {
                let it = &network.occurrences[id.index()];
                it.kind == OccurrenceKind::Primitive
                    && is_own[it.start.index()]
                    && plan.selected_nodes[it.start.index()]
                    && has_come(it.start)
            };
            let started: Vec<OccurrenceId> = ids.filter(is_started).collect();
            let goes_on = |id: &&OccurrenceId| !has_come(network.occurrences[id.index()].end);
            let running = started.iter().filter(goes_on).copied().collect();
            begun.push((size, Begun { choice, started, running, is_own }));
        }
        begun.sort_by_key(|(size, _)| *size);
        begun.into_iter().map(|(_, begun)| begun).collect()
    }

    /// The changes of variables and the uses of resources that are under way in an alternative.
    fn under_way(&self, begun: &Begun) -> (Vec<LabelId>, Vec<UseId>) {
        let (network, plan) = (&self.stage.network, &self.stage.plan);
        let has_come = |node: NodeId| self.stage.times[node.index()].is_some();
        let changing = (0..network.labels.len()).map(LabelId::from_index).filter(|&id| {
            let label = &network.labels[id.index()];
            let (start, end) = network.interval(id);
            label.mode == LabelMode::Tell
                && plan.selected_arcs[label.arc.index()]
                && begun.is_own[start.index()]
                && has_come(start)
                && !has_come(end)
        });
        let used = (0..network.uses.len()).map(UseId::from_index).filter(|&id| {
            let used = &network.uses[id.index()];
            used.change == Change::Uses
                && plan.selected_arcs[used.arc.index()]
                && begun.is_own[used.start.index()]
                && has_come(used.start)
                && !has_come(used.end)
        });
        (changing.collect(), used.collect())
    }

    /// What an alternative has done to variables and levels is the world's doing once its activities are in no plan any more.
    fn keep_what_was_done(&mut self, begun: &Begun) {
        let network = std::sync::Arc::clone(&self.stage.network);
        let times = &self.stage.times;
        for (index, label) in network.labels.iter().enumerate() {
            let id = LabelId::from_index(index);
            let ready = network.ready(id);
            let is_done = label.mode == LabelMode::Tell
                && label.extent != Extent::Initial
                && network.is_lasting(id)
                && self.stage.plan.selected_arcs[label.arc.index()]
                && begun.is_own[network.interval(id).0.index()];
            let (Some(at), true) = (times[ready.index()], is_done) else { continue };
            if let ValueSet::In(values) = &label.literal.values
                && let Some(&value) = values.first()
            {
                self.news.states.push((label.literal.variable, value, at));
            }
        }
        for used in &network.uses {
            let moment = used.moment();
            if !self.stage.plan.selected_arcs[used.arc.index()] || !begun.is_own[used.start.index()] {
                continue;
            }
            let by = match used.change {
                Change::Uses => None,
                Change::Produces => Some(used.counted()),
                Change::Consumes => used.counted().checked_neg(),
            };
            if let (Some(by), Some(at)) = (by.filter(|by| *by != Rational::ZERO), times[moment.index()]) {
                self.news.levels.push((used.resource, by, at));
            }
        }
    }

    /// The requirement that news of a condition takes away from an activity under way or to come, in words.
    pub(super) fn lost_need(&self, news: &News) -> Option<String> {
        let News::Duration(told, held) = news else { return None };
        let (network, plan) = (&self.stage.network, &self.stage.plan);
        let occurrence = &network.occurrences[told.index()];
        let arc = occurrence.arc.filter(|_| occurrence.kind == OccurrenceKind::Assertion)?;
        let over = self.stage.times[occurrence.start.index()]?.checked_add(*held)?;
        let has_come = |node: NodeId| self.stage.times[node.index()].is_some();
        let lost = plan.causal_links.iter().find(|link| {
            network.labels[link.tell.index()].arc == arc && !has_come(network.interval(link.ask).1)
        })?;
        let (start, end) = network.interval(lost.ask);
        let moment = |node: NodeId| self.stage.made.point(node).map(|point| self.stage.window(point).0);
        let text = &network.labels[lost.ask.index()].text;
        let who = network.labels[lost.ask.index()]
            .owner
            .filter(|owner| network.occurrences[owner.index()].kind == OccurrenceKind::Primitive);
        let who = who.or_else(|| self.activity_within(start, end));
        let who = who.map_or_else(
            || network.label_name(lost.ask),
            |owner| network.occurrences[owner.index()].name.to_string(),
        );
        let when = if has_come(start) {
            format!("until {}", shown(moment(end)?))
        } else {
            format!("at {}", shown(moment(start)?.max(self.now)))
        };
        Some(format!("{who} needs {text} {when}, but {text} holds only until {}", shown(over)))
    }

    /// The first activity that an interval begins with, or else lies in it.
    fn activity_within(&self, start: NodeId, end: NodeId) -> Option<OccurrenceId> {
        let network = &self.stage.network;
        let time = |node: NodeId| self.stage.made.point(node).map(|point| self.stage.window(point).0);
        let (from, until) = (time(start)?, time(end)?);
        let is_within = |id: &OccurrenceId| {
            let it = &network.occurrences[id.index()];
            let goes_on = self.stage.times[it.end.index()].is_none();
            it.kind == OccurrenceKind::Primitive
                && goes_on
                && self.stage.precedes(start, it.start)
                && self.stage.precedes(it.end, end)
                && time(it.start).is_some_and(|time| time >= from)
                && time(it.end).is_some_and(|time| time <= until)
        };
        (0..network.occurrences.len()).map(OccurrenceId::from_index).find(is_within)
    }
}

/// Returns why a run is stopped: what was needed, and what cannot be given up, or why there is no
/// plan.
pub(super) fn stopped_for(need: Option<&str>, no_plan: &str, hindrance: Option<&str>) -> String {
    match (need, hindrance) {
        (Some(need), Some(hindrance)) => format!("{need}. {hindrance}."),
        (Some(need), None) => {
            let mut letters = no_plan.chars();
            let first: String = letters.next().into_iter().flat_map(char::to_uppercase).collect();
            format!("{need}. {first}{}.", letters.as_str())
        }
        (None, Some(hindrance)) => format!("{no_plan}; {hindrance}"),
        (None, None) => no_plan.to_owned(),
    }
}
