//! What a line of a review promises, and what of a schedule or of a run is otherwise.

use exact::{Bound, Rational, Time};
use executive::{Ending, Entry, Happening};
use rmpl::program::LabelMode;
use rmpl::rule::Rule;
use smol_str::SmolStr;
use snapshot::Snapshot;
use tpn::{LabelId, Levels, Network, NodeId, OccurrenceId, Plan};

use super::Observed;
use super::instant::Scheduled;
use crate::demand_lines::{in_any_order, required_sight, sight_text};
use crate::lines;
use crate::overlaps::{occupied, owners};
use crate::{Outcome, Review, Section, TimeRange, flight_rule};

/// What a line promises that can be looked at.
pub(super) enum Promise {
    /// A schedule keeps all that the independent checker asks for.
    Valid,
    /// The second event is so much later than the first; with the names of both.
    Range([NodeId; 2], [Vec<String>; 2], TimeRange),
    /// A level, or what is in use, stays between these.
    Levels { resource: String, low: Rational, high: Rational },
    /// A rule of the mission holds.
    Rule(Box<Rule>),
    /// An activity takes so long.
    Lasts { activity: String, range: TimeRange },
    /// Runs come to the end by this plan.
    Runs,
    /// No plan is better.
    Optimal,
    /// While a condition lasts, the vehicle sees the location, or does not; with the names of its two events.
    Sees { vehicle: String, location: SmolStr, is_seen: bool, events: [Vec<String>; 2] },
    /// Runs take no other alternative of a decision.
    Chosen { decision: String },
    /// What changes a variable comes in the order of these ranks: the nodes, and by whom.
    InOrder { variable: SmolStr, nodes: Vec<(usize, NodeId)>, by: Vec<(usize, String)> },
    /// No two of these are under way at a time.
    Apart(Vec<Performed>),
    /// Vehicles touch in no run.
    NoContact,
    /// Each activity can take as short and as long as it is declared with, if the others leave it room.
    DeclaredDurations,
    /// Nothing that is looked at here.
    Nothing,
}

/// An activity of one vehicle.
pub(super) struct Performed {
    name: SmolStr,
    start: NodeId,
    end: NodeId,
    /// Whether it takes some resource whole: two that do are declared to go together.
    is_occupying: bool,
}

impl Promise {
    /// Returns what a line of a review promises.
    pub(super) fn of_line(
        snapshot: &Snapshot,
        (network, plan): (&Network, &Plan),
        review: &Review,
        section: Section,
        index: usize,
    ) -> Self {
        let range = |nodes: [NodeId; 2], range: TimeRange| {
            Self::Range(nodes, nodes.map(|node| names(network, plan, node)), range)
        };
        let found = match section {
            Section::Plan => {
                let text = review.plan[index].text.as_str();
                if [lines::PLAN, lines::ACCEPTED].contains(&text) || text.starts_with(lines::REJECTED) {
                    Some(Self::Valid)
                } else if [lines::DYNAMIC, lines::STRONG].iter().any(|it| text.starts_with(it)) {
                    Some(Self::Runs)
                } else if text.starts_with(lines::OBJECTIVE) && plan.quality.is_optimal == Some(true) {
                    Some(Self::Optimal)
                } else {
                    None
                }
            }
            Section::Choices => Some(Self::Chosen { decision: review.choices[index].name.clone() }),
            Section::CausalLinks => {
                let of = &review.causal_links[index];
                let is_it = |link: &&tpn::CausalLink| {
                    network.label_name(link.ask) == of.ask && network.label_name(link.tell) == of.tell
                };
                // What lasts has its margin up to the next change, which has a line of its own.
                plan.causal_links.iter().find(is_it).map(|link| {
                    let (asked, told) = (network.interval(link.ask), network.interval(link.tell));
                    if of.is_lasting {
                        range([network.ready(link.tell), asked.0], of.lead)
                    } else {
                        range([asked.1, told.1], of.margin)
                    }
                })
            }
            Section::Conflicts => {
                let of = &review.conflicts[index];
                <[NodeId; 2]>::try_from(of.line.nodes.as_slice()).ok().map(|nodes| range(nodes, of.gap))
            }
            Section::States => Self::of_state(network, plan, &review.states[index]),
            Section::Resources => {
                let of = &review.resources[index];
                let (low, high) = match of.levels {
                    Levels::Range { low, high } => (low, high),
                    Levels::Peak(peak) => (Rational::ZERO, peak),
                };
                Some(Self::Levels { resource: of.name.clone(), low, high })
            }
            Section::Overlaps => {
                let vehicle = review.overlaps[index].names.first();
                vehicle.map(|vehicle| Self::Apart(performed(snapshot, network, plan, vehicle)))
            }
            Section::Traverses => {
                let of = &review.traverses[index];
                Some(Self::Lasts { activity: of.name.clone(), range: of.duration })
            }
            Section::MissionRules => review.rules.rules.get(index).and_then(|rule| {
                let holds =
                    review.findings.iter().any(|it| it.rule == rule.rule && it.outcome == Outcome::Holds);
                let read =
                    flight_rule::read(&snapshot.program, network, &rule.rule).ok().filter(|_| holds)?;
                Some(Self::Rule(Box::new(read)))
            }),
            Section::Durations
            | Section::Events
            | Section::SeparationViolations
            | Section::Robustness
            | Section::Warnings => None,
        };
        found.unwrap_or(Self::Nothing)
    }

    /// Returns what a section promises that has passed because it has no lines.
    pub(super) const fn of_nothing(section: Section) -> Self {
        match section {
            Section::Conflicts => Self::Valid,
            Section::SeparationViolations => Self::NoContact,
            Section::Durations => Self::DeclaredDurations,
            _ => Self::Nothing,
        }
    }

    /// Returns what a line about a state, or about the movements of a vehicle, promises: its changes are the plan's, in
    /// its order. A line without any is about all requirements.
    fn of_state(network: &Network, plan: &Plan, line: &crate::Line) -> Option<Self> {
        if line.nodes.is_empty() {
            return Some(Self::Valid);
        }
        if let Some(sight) = Self::of_sight(network, plan, line) {
            return Some(sight);
        }
        // A required level is part of what each schedule is checked for.
        let is_level = |used: &tpn::Use| {
            let level = used.level_text(&network.resources);
            line.nodes == [used.start, used.end] && level.is_some_and(|level| line.text.contains(&level))
        };
        if network.uses.iter().any(is_level) {
            return Some(Self::Valid);
        }
        if let [name] = line.names.as_slice() {
            let stays = network.variables.iter().find(|it| it.name == *name && it.is_lasting);
            if let Some(variable) = stays {
                return Some(Self::InOrder {
                    variable: variable.name.clone(),
                    nodes: Vec::new(),
                    by: Vec::new(),
                });
            }
        }
        let told = |variable: usize| {
            let labels = network.labels.iter().enumerate().filter(move |(_, label)| {
                label.literal.variable.index() == variable
                    && label.mode == LabelMode::Tell
                    && plan.selected_arcs.get(label.arc.index()) == Some(&true)
            });
            labels.map(|(at, label)| (network.ready(LabelId::from_index(at)), label.owner))
        };
        let is_its = |&variable: &usize| {
            let is_told = |node: &NodeId| told(variable).any(|(ready, _)| ready == *node);
            let owners = told(variable).filter_map(|(_, owner)| owner);
            let mut by: Vec<&str> = owners.map(|id| network.occurrences[id.index()].name.as_str()).collect();
            let mut named: Vec<&str> = line.names.iter().map(String::as_str).collect();
            by.sort_unstable();
            named.sort_unstable();
            network.variables[variable].is_lasting && by == named && line.nodes.iter().all(is_told)
        };
        let variable = (0..network.variables.len()).find(is_its)?;
        let order = plan.state_order.iter().find(|order| order.variable.index() == variable)?;
        let (mut nodes, mut by) = (Vec::new(), Vec::new());
        for (rank, group) in in_any_order(network, &order.producers).into_iter().enumerate() {
            for label in group {
                nodes.push((rank, network.ready(label)));
                let owner = network.labels[label.index()].owner;
                by.extend(owner.map(|id| (rank, network.occurrences[id.index()].name.to_string())));
            }
        }
        Some(Self::InOrder { variable: network.variables[variable].name.clone(), nodes, by })
    }

    /// Returns what a line about what a vehicle sees promises.
    fn of_sight(network: &Network, plan: &Plan, line: &crate::Line) -> Option<Self> {
        plan.causal_links.iter().find_map(|link| {
            let (vehicle, location, is_seen) = required_sight(network, link.ask)?;
            let (start, end) = network.interval(link.ask);
            let is_its =
                line.nodes == [start, end] && line.text == network.readable(&sight_text(network, *link)?);
            is_its.then(|| Self::Sees {
                vehicle: vehicle.to_owned(),
                location: location.clone(),
                is_seen,
                events: [start, end].map(|node| names(network, plan, node)),
            })
        })
    }

    /// Returns whether a schedule says something of it.
    pub(super) const fn is_of_schedules(&self) -> bool {
        !matches!(
            self,
            Self::Lasts { .. }
                | Self::Runs
                | Self::NoContact
                | Self::Chosen { .. }
                | Self::Optimal
                | Self::Sees { .. }
                | Self::Nothing
        )
    }

    /// Returns whether a run says something of it.
    pub(super) const fn is_of_runs(&self) -> bool {
        !matches!(self, Self::Valid | Self::DeclaredDurations | Self::Optimal | Self::Nothing)
    }

    /// Returns whether another plan says something of it.
    pub(super) const fn is_of_plans(&self) -> bool {
        matches!(self, Self::Optimal)
    }

    /// Returns what contradicts it in a schedule, if something does; `None` if the schedule says nothing of it.
    #[expect(clippy::option_option, reason = "the outer one is what schedules say nothing of")]
    pub(super) fn broken_by_schedule(&self, of: Scheduled<'_>) -> Option<Option<String>> {
        match self {
            Self::Valid => {
                let verdict = verify::check_schedule(of.network, of.plan, of.times);
                Some(verdict.violations.first().map(|it| it.message.clone()))
            }
            Self::Range([from, to], _, range) => {
                outside(of.times[from.index()]?, of.times[to.index()]?, *range)
            }
            Self::Levels { resource, low, high } => {
                let broken = of.levels(resource).into_iter().find(|(_, level)| level < low || level > high);
                Some(broken.map(|(at, level)| format!("at {} it is {}", at.readable(), level.readable())))
            }
            Self::Rule(rule) => Some(breach(rule, of)),
            Self::DeclaredDurations => of.is_extreme.then_some(None),
            // One value is in every order.
            Self::InOrder { nodes, .. } if nodes.len() < 2 => None,
            Self::InOrder { nodes, .. } => {
                let known = nodes.iter().filter_map(|&(rank, node)| Some((rank, of.times[node.index()]?)));
                let times: Vec<(usize, Time)> = known.collect();
                let late = times.iter().enumerate().find_map(|(at, &(rank, then))| {
                    let before = times[..at].iter().filter(|(earlier, _)| *earlier < rank);
                    let last = before.map(|&(_, time)| time).max()?;
                    (last > then).then_some([last, then])
                });
                Some(late.map(|pair| {
                    let [first, then] = pair.map(Time::readable);
                    format!("the first change ends at {first}, but the next change already at {then}")
                }))
            }
            Self::Apart(all) => {
                let time = |node: NodeId| of.times.get(node.index()).copied().flatten();
                Some(overlap(all, |it| Some([time(it.start)?, time(it.end)?])))
            }
            Self::Lasts { .. }
            | Self::Runs
            | Self::NoContact
            | Self::Chosen { .. }
            | Self::Optimal
            | Self::Sees { .. }
            | Self::Nothing => None,
        }
    }

    /// Returns whether it says that nothing goes wrong in a run, and so still holds or not after something has.
    pub(super) const fn is_of_whole_runs(&self) -> bool {
        matches!(self, Self::Runs | Self::NoContact)
    }

    /// Returns what contradicts it in an undisturbed run, if something does; `None` if the run says nothing of it.
    /// `executed` is the plan at the times of the run, if the run kept it.
    #[expect(clippy::option_option, reason = "the outer one is what runs say nothing of")]
    pub(super) fn broken_by_run(
        &self,
        run: &Observed<'_>,
        executed: Option<Scheduled<'_>>,
    ) -> Option<Option<String>> {
        let Observed { log, ending, sight } = *run;
        let came = |event: &str| {
            let is_it =
                |entry: &&Entry| matches!(&entry.happening, Happening::Executed { name } if name == event);
            log.iter().find(is_it).map(|entry| entry.time)
        };
        // A contact contradicts that vehicles keep apart, and stops what it is not about.
        let has_contact =
            log.iter().any(|entry| matches!(entry.happening, Happening::Violation { is_contact: true, .. }));
        match self {
            Self::Runs | Self::Lasts { .. } if has_contact => None,
            Self::Runs => {
                let violation = log.iter().find_map(|entry| match &entry.happening {
                    Happening::Violation { reason, .. } => {
                        Some(format!("at {}: {reason}", entry.time.readable()))
                    }
                    _ => None,
                });
                let unfinished =
                    (ending != Ending::Finished).then(|| "the run did not reach the end".to_owned());
                Some(violation.or(unfinished))
            }
            Self::NoContact => Some(log.iter().find_map(|entry| match &entry.happening {
                Happening::Violation { reason, is_contact: true, .. } => {
                    Some(format!("at {}: {reason}", entry.time.readable()))
                }
                _ => None,
            })),
            Self::Chosen { decision } => {
                let taken = format!("{decision} takes ");
                let other = log.iter().find_map(|entry| match &entry.happening {
                    Happening::Replanned { changes } => {
                        let change = changes.iter().find(|it| it.starts_with(&taken))?;
                        Some(format!("at {}: {change}", entry.time.readable()))
                    }
                    _ => None,
                });
                Some(other)
            }
            Self::Range(_, names, range) => {
                let time = |names: &Vec<String>| names.iter().find_map(|name| came(name));
                outside(time(&names[0])?, time(&names[1])?, *range)
            }
            Self::Levels { resource, low, high } => {
                let broken = log.iter().find_map(|entry| match &entry.happening {
                    Happening::Level { resource: of, level, .. } if of.as_str() == resource => (level < low
                        || level > high)
                        .then(|| format!("at {} it is {}", entry.time.readable(), level.readable())),
                    _ => None,
                });
                Some(broken)
            }
            Self::Lasts { activity, range } => {
                // What was never started says nothing.
                let started = came(&format!("{activity}.start"))?;
                let end = format!("{activity}.end");
                let Some(ended) = came(&end) else {
                    // What stopped for another reason in the middle says nothing either.
                    let stopped_by = log.iter().rev().find_map(|entry| match &entry.happening {
                        Happening::Violation { name, .. } => Some(name),
                        _ => None,
                    });
                    let lasted = log.last()?.time.checked_sub(started)?;
                    let is_stopped = stopped_by.is_some_and(|name| *name != end)
                        && Bound::Finite(lasted) <= range.greatest;
                    return (!is_stopped).then(|| Some("it did not end".to_owned()));
                };
                let lasted = ended.checked_sub(started)?;
                let is_in = lasted >= range.least && Bound::Finite(lasted) <= range.greatest;
                Some((!is_in).then(|| format!("it took {}, not {range}", lasted.readable())))
            }
            Self::InOrder { variable, by, .. } => Some(out_of_order(log, variable, by)),
            Self::Apart(all) => {
                let end = log.last().map_or(Time::ZERO, |entry| entry.time);
                let ended = |it: &Performed| came(&format!("{}.end", it.name)).unwrap_or(end);
                Some(overlap(all, |it| Some([came(&format!("{}.start", it.name))?, ended(it)])))
            }
            Self::Sees { vehicle, location, is_seen, events } => {
                let time = |names: &Vec<String>| names.iter().find_map(|name| came(name));
                let from = time(&events[0])?;
                let until = time(&events[1]).or_else(|| log.last().map(|entry| entry.time))?;
                let middle = from.checked_add(until)?.checked_div(2)?;
                let seen = [from, middle, until].map(|at| Some((at, sight(vehicle, location, at)?)));
                let [first, ..] = seen;
                first?;
                let broken = seen.into_iter().flatten().find(|(_, sight)| sight.is_seen != *is_seen);
                Some(broken.map(|(at, sight)| {
                    let [east, north] = sight.from_m;
                    let verb = if sight.is_seen { "sees" } else { "does not see" };
                    format!("at {} {vehicle} {verb} {location} from ({east:.2}, {north:.2})", at.readable())
                }))
            }
            Self::Rule(rule) => executed.map(|of| breach(rule, of)),
            Self::Valid | Self::DeclaredDurations | Self::Optimal | Self::Nothing => None,
        }
    }
}

/// That a rule is not known to hold at some time.
fn breach(rule: &Rule, of: Scheduled<'_>) -> Option<String> {
    of.first_breach(rule).map(|at| format!("it is not known to hold at {}", at.readable()))
}

/// That one time is not so much later than another.
#[expect(clippy::option_option, reason = "the outer one is a distance that does not fit")]
fn outside(from: Time, to: Time, range: TimeRange) -> Option<Option<String>> {
    let apart = to.checked_sub(from)?;
    let is_in = apart >= range.least && Bound::Finite(apart) <= range.greatest;
    Some((!is_in).then(|| format!("it is {} apart, not {range}", apart.readable())))
}

/// The names of what happens at a node.
fn names(network: &Network, plan: &Plan, node: NodeId) -> Vec<String> {
    let events = network.nodes[node.index()].events.iter();
    events.filter(|&&event| plan.has_event(network, event)).map(|&event| network.event_name(event)).collect()
}

/// Returns what of a run changes a variable otherwise than in this order.
fn out_of_order(log: &[Entry], variable: &SmolStr, order: &[(usize, String)]) -> Option<String> {
    let mut next = 0;
    for entry in log {
        let Happening::State { variable: of, value: Some(value), by } = &entry.happening else { continue };
        if of != variable {
            continue;
        }
        // What holds from the start on, or is read from the plant, is changed by no one.
        let Some(by) = by else { continue };
        match order.iter().find(|(_, name)| name == by.as_str()) {
            Some(&(rank, _)) if rank >= next => next = rank,
            Some(_) => return Some(format!("at {} {by} is too late", entry.time.readable())),
            None => return Some(format!("at {} {by} makes it {value}", entry.time.readable())),
        }
    }
    None
}

/// The activities of a vehicle that the plan selects.
fn performed(snapshot: &Snapshot, network: &Network, plan: &Plan, vehicle: &str) -> Vec<Performed> {
    let occupied = occupied(network);
    let own = owners(snapshot, network, plan);
    let own = own.into_iter().filter(|(_, vehicles)| vehicles.contains(vehicle));
    let performed = |id: OccurrenceId| {
        let of = &network.occurrences[id.index()];
        let is_occupying = occupied.contains(&id);
        Performed { name: of.name.clone(), start: of.start, end: of.end, is_occupying }
    };
    own.map(|(id, _)| performed(id)).collect()
}

/// Two activities that are under way at a time, and are not declared to go together.
fn overlap(all: &[Performed], times: impl Fn(&Performed) -> Option<[Time; 2]>) -> Option<String> {
    let mut known: Vec<(&Performed, [Time; 2])> =
        all.iter().filter_map(|it| Some((it, times(it)?))).filter(|(_, [start, end])| start < end).collect();
    known.sort_by_key(|&(_, [start, _])| start);
    let mut pairs =
        known.iter().enumerate().flat_map(|(at, one)| known[at + 1..].iter().map(move |other| (one, other)));
    pairs.find_map(|((one, [_, end]), (other, [start, _]))| {
        let is_declared = one.is_occupying && other.is_occupying;
        (start < end && !is_declared)
            .then(|| format!("at {} {} and {} are both in progress", start.readable(), one.name, other.name))
    })
}
