//! Looks for counterexamples of the lines of a review that have passed (SPEC 16.1): schedules of the plan, and runs of it, in
//! which something is otherwise than a line says.
//!
//! Nothing is proven by a line that survives; it says how it was tried. Lines that are neither about schedules nor about
//! runs are not tried, and said to be so.

mod instant;
mod schedules;

use exact::{Bound, Rational, Time};
use executive::{Ending, Entry, Happening};
use rmpl::rule::Rule;
use snapshot::Snapshot;
use tpn::{Levels, Network, NodeId, Plan};

use self::instant::Scheduled;
use self::schedules::Schedules;
use super::flight_rule;
use super::{Outcome, Review, Section, Status, TimeRange};

/// A line that has passed, how it was tried, and the counterexample if one was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Tried {
    pub section: Section,
    pub text: String,
    /// How many schedules and runs were held against it; neither if it cannot be tried that way.
    pub schedules: usize,
    pub runs: usize,
    /// What contradicts it, if something was found.
    pub counterexample: Option<Counterexample>,
}

/// What contradicts a line.
#[derive(Clone, Debug, PartialEq)]
pub struct Counterexample {
    /// In one sentence.
    pub text: String,
    /// The times of events, by name, of a schedule; none if it is a run.
    pub schedule: Vec<(String, Time)>,
    /// The seed of the run.
    pub seed: Option<u64>,
}

/// What a line promises that can be looked at.
enum Promise {
    /// A schedule keeps all that the independent checker asks for.
    Valid,
    /// The second event is so much later than the first.
    Range([NodeId; 2], TimeRange),
    /// A level, or what is in use, stays between these.
    Levels { resource: String, low: Rational, high: Rational },
    /// A rule of the mission holds.
    Rule(Box<Rule>),
    /// An activity takes so long.
    Lasts { activity: String, range: TimeRange },
    /// Runs come to the end by this plan.
    Runs,
    /// Nothing that is looked at here.
    Nothing,
}

/// The lines of a review under trial.
pub struct Trial<'a> {
    snapshot: &'a Snapshot,
    network: &'a Network,
    plan: &'a Plan,
    lines: Vec<(Promise, Tried)>,
}

impl<'a> Trial<'a> {
    /// Of all lines that have passed; `None` without a plan.
    pub fn new(snapshot: &'a Snapshot, review: &Review) -> Option<Self> {
        let (network, plan) = (snapshot.network.as_deref()?, snapshot.plan()?);
        let mut lines = Vec::new();
        for section in Section::ALL {
            for (index, line) in review.lines(section).into_iter().enumerate() {
                if line.status != Status::Passed {
                    continue;
                }
                let text = line.text.clone();
                let tried = Tried { section, text, schedules: 0, runs: 0, counterexample: None };
                lines.push((promise(snapshot, network, plan, review, section, index), tried));
            }
        }
        Some(Self { snapshot, network, plan, lines })
    }

    /// Holds so many schedules against the lines, or fewer if `stop` says so; seeds choose which.
    pub fn try_schedules(&mut self, count: usize, seed: u64, stop: &mut dyn FnMut() -> bool) {
        let Some(mut schedules) = Schedules::new(self.network, self.plan, seed) else { return };
        for _ in 0..count {
            if stop() {
                return;
            }
            let Some(times) = schedules.next() else { return };
            let scheduled = Scheduled {
                program: &self.snapshot.program,
                network: self.network,
                plan: self.plan,
                times: &times,
            };
            for (promise, tried) in &mut self.lines {
                if tried.counterexample.is_some() {
                    continue;
                }
                let Some(found) = promise.broken_by_schedule(scheduled) else { continue };
                tried.schedules += 1;
                tried.counterexample = found.map(|text| Counterexample {
                    text,
                    schedule: named_times(self.network, self.plan, &times),
                    seed: None,
                });
            }
        }
    }

    /// Holds an undisturbed run of the plan against the lines; `seed` made it.
    pub fn try_run(&mut self, log: &[Entry], ending: Ending, seed: u64) {
        for (promise, tried) in &mut self.lines {
            if tried.counterexample.is_some() {
                continue;
            }
            let Some(found) = promise.broken_by_run(log, ending) else { continue };
            tried.runs += 1;
            tried.counterexample =
                found.map(|text| Counterexample { text, schedule: Vec::new(), seed: Some(seed) });
        }
    }

    /// The lines with how they were tried, in the order of the review.
    pub fn into_tried(self) -> Vec<Tried> {
        self.lines.into_iter().map(|(_, tried)| tried).collect()
    }
}

/// What a line of a review promises.
fn promise(
    snapshot: &Snapshot,
    network: &Network,
    plan: &Plan,
    review: &Review,
    section: Section,
    index: usize,
) -> Promise {
    let found = match section {
        Section::Plan => {
            let text = review.plan[index].text.as_str();
            if text.starts_with("the independent checker") {
                Some(Promise::Valid)
            } else if text.contains("(dynamically controllable)") || text.contains("(strongly controllable)")
            {
                Some(Promise::Runs)
            } else {
                None
            }
        }
        Section::CausalLinks => {
            let of = &review.causal_links[index];
            let is_it = |link: &&tpn::CausalLink| {
                network.label_name(link.ask) == of.ask && network.label_name(link.tell) == of.tell
            };
            // What lasts has its margin up to the next change, which has a line of its own.
            plan.causal_links.iter().find(is_it).map(|link| {
                let (asked, told) = (network.interval(link.ask), network.interval(link.tell));
                if of.is_lasting {
                    Promise::Range([network.ready(link.tell), asked.0], of.lead)
                } else {
                    Promise::Range([asked.1, told.1], of.margin)
                }
            })
        }
        Section::Conflicts => {
            let of = &review.conflicts[index];
            <[NodeId; 2]>::try_from(of.line.nodes.as_slice()).ok().map(|nodes| Promise::Range(nodes, of.gap))
        }
        Section::Resources => {
            let of = &review.resources[index];
            let (low, high) = match of.levels {
                Levels::Range { low, high } => (low, high),
                Levels::Peak(peak) => (Rational::ZERO, peak),
            };
            Some(Promise::Levels { resource: of.name.clone(), low, high })
        }
        Section::Traverses => {
            let of = &review.traverses[index];
            Some(Promise::Lasts { activity: of.name.clone(), range: of.duration })
        }
        Section::MissionRules => review.rules.rules.get(index).and_then(|rule| {
            let holds = review.findings.iter().any(|it| it.rule == rule.rule && it.outcome == Outcome::Holds);
            let read = flight_rule::read(&snapshot.program, network, &rule.rule).ok().filter(|_| holds)?;
            Some(Promise::Rule(Box::new(read)))
        }),
        _ => None,
    };
    found.unwrap_or(Promise::Nothing)
}

impl Promise {
    /// What contradicts it in a schedule, if something does; `None` if schedules say nothing of it.
    #[expect(clippy::option_option, reason = "the outer one is what schedules say nothing of")]
    fn broken_by_schedule(&self, of: Scheduled<'_>) -> Option<Option<String>> {
        match self {
            Self::Valid => {
                let verdict = verify::check_schedule(of.network, of.plan, of.times);
                Some(verdict.violations.first().map(|it| it.message.clone()))
            }
            Self::Range([from, to], range) => {
                let apart = of.times[to.index()]?.checked_sub(of.times[from.index()]?)?;
                let is_in = apart >= range.least && Bound::Finite(apart) <= range.greatest;
                Some((!is_in).then(|| format!("it is {} apart, not {range}", apart.readable())))
            }
            Self::Levels { resource, low, high } => {
                let broken = of.levels(resource).into_iter().find(|(_, level)| level < low || level > high);
                Some(broken.map(|(at, level)| format!("at {} it is {}", at.readable(), level.readable())))
            }
            Self::Rule(rule) => {
                let breach = of.first_breach(rule);
                Some(breach.map(|at| format!("it is not known to hold at {}", at.readable())))
            }
            Self::Lasts { .. } | Self::Runs | Self::Nothing => None,
        }
    }

    /// What contradicts it in an undisturbed run, if something does; `None` if runs say nothing of it.
    #[expect(clippy::option_option, reason = "the outer one is what runs say nothing of")]
    fn broken_by_run(&self, log: &[Entry], ending: Ending) -> Option<Option<String>> {
        match self {
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
                let came = |end: &str| {
                    let event = format!("{activity}.{end}");
                    let is_it = |entry: &&Entry| matches!(&entry.happening, Happening::Executed { name } if *name == event);
                    log.iter().find(is_it).map(|entry| entry.time)
                };
                // What was never started says nothing.
                let started = came("start")?;
                let Some(ended) = came("end") else {
                    return Some(Some("it did not come to its end".to_owned()));
                };
                let lasted = ended.checked_sub(started)?;
                let is_in = lasted >= range.least && Bound::Finite(lasted) <= range.greatest;
                Some((!is_in).then(|| format!("it took {}, not {range}", lasted.readable())))
            }
            Self::Valid | Self::Range(..) | Self::Rule(_) | Self::Nothing => None,
        }
    }
}

/// The times of the events that have names, in order.
fn named_times(network: &Network, plan: &Plan, times: &[Option<Time>]) -> Vec<(String, Time)> {
    let nodes = network.nodes.iter().zip(times).filter_map(|(node, time)| Some((node, (*time)?)));
    let mut named: Vec<(String, Time)> = nodes
        .flat_map(|(node, time)| {
            let events = node.events.iter().filter(move |&&event| plan.has_event(network, event));
            events.map(move |&event| (network.event_name(event), time))
        })
        .collect();
    named.sort_by(|left, right| (left.1, &left.0).cmp(&(right.1, &right.0)));
    named
}

#[cfg(test)]
mod tests;
