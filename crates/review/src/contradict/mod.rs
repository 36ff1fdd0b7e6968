//! Looks for counterexamples of the lines of a review that have passed (SPEC 16.1): schedules of the plan, and undisturbed
//! runs of it, that contradict a line, and plans that are better than one that is called optimal.
//!
//! Nothing is proven by a line that survives; it says how it was tried. Lines about anything else are marked as not tried.

mod instant;
mod promise;
mod runs;
mod schedules;

use std::collections::BTreeMap;
use std::sync::Arc;

use exact::Time;
use executive::{Ending, Entry, Happening, Script};
use rmpl::program::Program;
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;
use snapshot::Snapshot;
use tpn::plan_json::node_name;
use tpn::{Network, NodeId, Plan};

pub(crate) use self::instant::Scheduled;
use self::promise::Promise;
use self::runs::Runs;
use self::schedules::{Made, Schedules};
use super::record::LineKey;
use super::{Review, Section, Status};

/// A line that has passed, how it was tried, and the counterexample if one was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tried {
    pub line: LineKey,
    /// How many different schedules were held against it, how many runs, and how many other plans; none of these if it cannot
    /// be tried that way.
    pub schedules: u64,
    pub runs: u64,
    pub plans: u64,
    /// What contradicts it, if something was found.
    pub counterexample: Option<Counterexample>,
}

/// What contradicts a line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Counterexample {
    /// In one sentence.
    pub text: String,
    /// The run that shows it: of a schedule one that is executed by it, otherwise the run that was found.
    #[serde(with = "snapshot::json_text")]
    pub script: Script,
}

/// How a line came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    Survived,
    Contradicted,
    NotTried,
}

/// How much is tried at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Effort {
    /// Schedules of the plan: the earliest, the latest, and others by chance.
    pub schedules: u64,
    /// Undisturbed runs: the environment's durations at their least, at their greatest, and otherwise.
    pub runs: u64,
    /// Chooses which.
    pub seed: u64,
}

impl Default for Effort {
    fn default() -> Self {
        Self { schedules: 200, runs: 20, seed: 0 }
    }
}

impl Tried {
    /// Returns how it came out.
    pub const fn verdict(&self) -> Verdict {
        match (&self.counterexample, self.schedules + self.runs + self.plans) {
            (Some(_), ..) => Verdict::Contradicted,
            (None, 0) => Verdict::NotTried,
            (None, ..) => Verdict::Survived,
        }
    }

    /// Returns how it was tried: `200 schedules and 20 runs`; empty if it was not.
    pub fn how(&self) -> String {
        let counted = |count: u64, one: &str, several: &str| match count {
            0 => None,
            1 => Some(format!("1 {one}")),
            count => Some(format!("{count} {several}")),
        };
        let parts = [
            counted(self.schedules, "schedule", "schedules"),
            counted(self.runs, "run", "runs"),
            counted(self.plans, "plan", "plans"),
        ];
        parts.into_iter().flatten().collect::<Vec<_>>().join(" and ")
    }

    /// Returns how it came out and how it was tried, in one sentence without an end.
    pub fn sentence(&self) -> String {
        match (self.verdict(), &self.counterexample) {
            (Verdict::Contradicted, Some(found)) if found.script == Script::default() => {
                format!("contradicted: {}", found.text)
            }
            (Verdict::Contradicted, Some(found)) if found.script.schedule.is_empty() => {
                format!("contradicted by a run: {}", found.text)
            }
            (Verdict::Contradicted, Some(found)) => format!("contradicted by a schedule: {}", found.text),
            (Verdict::Survived, _) => format!("survived {}", self.how()),
            _ => "not tried: schedules, runs and other plans cannot decide it".to_owned(),
        }
    }
}

/// The lines of a review under trial.
pub struct Trial {
    program: Arc<Program>,
    network: Arc<Network>,
    plan: Plan,
    lines: Vec<(Promise, Tried)>,
    effort: Effort,
    schedules: Option<Schedules>,
    /// How many schedules were made, those that were made before included.
    num_schedules: u64,
    runs: Runs,
    num_runs: u64,
    /// Whether other plans were looked for.
    has_plans: bool,
    /// Whether a line says that the plan may be late. What comes after a violation then is no more what the others promise.
    may_be_late: bool,
}

/// A run of a plan, as it is held against lines.
pub struct Observed<'a> {
    pub log: &'a [Entry],
    pub ending: Ending,
    /// Whether a vehicle sees a location at a time from where it then is; `None` if the ground does not tell.
    pub sight: &'a dyn Fn(&str, &str, Time) -> Option<Sight>,
}

/// What a vehicle sees of a location.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    pub is_seen: bool,
    /// Where the vehicle is, in meters.
    pub from_m: [f64; 2],
}

impl Trial {
    /// Of all lines that have passed, or of one of them; `None` without a plan.
    pub fn new(snapshot: &Snapshot, review: &Review, only: Option<&LineKey>, effort: Effort) -> Option<Self> {
        let (network, plan) = (Arc::clone(snapshot.network.as_ref()?), snapshot.plan()?.clone());
        let mut lines = Vec::new();
        for section in Section::ALL {
            let of_lines = review.lines(section).into_iter().enumerate();
            let of_lines = of_lines.filter(|(_, line)| line.status == Status::Passed).map(|(index, line)| {
                let promise = Promise::of_line(snapshot, (&network, &plan), review, section, index);
                (promise, LineKey::new(section, line))
            });
            let settled = review.settled(section);
            let settled = settled.map(|line| (Promise::of_nothing(section), LineKey::new(section, &line)));
            for (promise, line) in of_lines.chain(settled) {
                if only.is_none_or(|only| *only == line) {
                    lines.push((
                        promise,
                        Tried { line, schedules: 0, runs: 0, plans: 0, counterexample: None },
                    ));
                }
            }
        }
        let has_drives = !snapshot.traverses.is_empty();
        Some(Self {
            program: Arc::clone(&snapshot.program),
            schedules: Schedules::new(&network, &plan, effort.seed),
            runs: Runs::new(&network, &plan, has_drives, effort.seed),
            network,
            plan,
            lines,
            effort,
            num_schedules: 0,
            num_runs: 0,
            has_plans: false,
            may_be_late: review.traverses.iter().any(|it| it.may_be_late),
        })
    }

    /// Returns how many schedules and runs have been made, and how many are to be made.
    pub const fn progress(&self) -> [u64; 2] {
        let Effort { schedules, runs, .. } = self.effort;
        [self.num_schedules + self.num_runs, schedules + runs]
    }

    /// Holds one more schedule against the lines without a counterexample. Returns whether there was one to try.
    pub fn try_schedule(&mut self) -> bool {
        let is_wanted = self.num_schedules < self.effort.schedules
            && self
                .lines
                .iter()
                .any(|(promise, it)| it.counterexample.is_none() && promise.is_of_schedules());
        let made = self.schedules.as_mut().filter(|_| is_wanted).map(Schedules::make);
        let (times, is_extreme) = match made {
            Some(Made::New { times, is_extreme }) => (times, is_extreme),
            Some(Made::Impossible(activity, duration)) => {
                self.num_schedules += 1;
                let text = format!("no schedule lets {activity} last {}", duration.readable());
                for tried in self.declared_durations() {
                    tried.schedules += 1;
                    let script = Script::default();
                    tried.counterexample = Some(Counterexample { text: text.clone(), script });
                }
                return true;
            }
            Some(Made::Known { is_extreme }) => {
                self.num_schedules += 1;
                self.declared_durations().for_each(|tried| tried.schedules += u64::from(is_extreme));
                return true;
            }
            Some(Made::Overflow) | None => {
                self.num_schedules = self.effort.schedules;
                return false;
            }
        };
        self.num_schedules += 1;
        let scheduled = Scheduled {
            program: &self.program,
            network: &self.network,
            plan: &self.plan,
            times: &times,
            is_extreme,
            log: None,
        };
        for (promise, tried) in &mut self.lines {
            if tried.counterexample.is_some() {
                continue;
            }
            let Some(found) = promise.broken_by_schedule(scheduled) else { continue };
            tried.schedules += 1;
            tried.counterexample = found.map(|text| Counterexample {
                text,
                script: Script {
                    schedule: named_times(&self.network, &self.plan, &times),
                    ..Script::default()
                },
            });
        }
        true
    }

    /// The lines about declared durations without a counterexample.
    fn declared_durations(&mut self) -> impl Iterator<Item = &mut Tried> {
        let stand = self.lines.iter_mut().filter(|(_, tried)| tried.counterexample.is_none());
        stand.filter(|(it, _)| matches!(it, Promise::DeclaredDurations)).map(|(_, tried)| tried)
    }

    /// The next run to make; `None` when there is none, or no line without a counterexample is about runs.
    pub fn next_run(&mut self) -> Option<Script> {
        let is_wanted = self.num_runs < self.effort.runs
            && self.lines.iter().any(|(promise, it)| it.counterexample.is_none() && promise.is_of_runs());
        let script = if is_wanted { self.runs.next() } else { None };
        self.num_runs = if script.is_some() { self.num_runs + 1 } else { self.effort.runs };
        script
    }

    /// Returns whether other plans are still to be compared with the plan, for a line without a counterexample.
    pub fn wants_plans(&self) -> bool {
        let is_open = |(promise, it): &(Promise, Tried)| it.counterexample.is_none() && promise.is_of_plans();
        !self.has_plans && self.lines.iter().any(is_open)
    }

    /// Holds other plans of the mission, in their networks, against the line that none is better.
    pub fn try_plans(&mut self, others: &[(Arc<Network>, Plan)]) {
        self.has_plans = true;
        let better = others.iter().find(|(network, other)| {
            tpn::worth::compare(network, other, &self.plan) == std::cmp::Ordering::Less
        });
        let found = better.map(|(network, other)| Counterexample {
            text: format!("another plan has {}", tpn::worth::words(network, other).unwrap_or_default()),
            script: Script::default(),
        });
        for (_, tried) in self.lines.iter_mut().filter(|(promise, _)| promise.is_of_plans()) {
            tried.plans += others.len() as u64;
            tried.counterexample = tried.counterexample.take().or_else(|| found.clone());
        }
    }

    /// Holds an undisturbed run of the plan against the lines without a counterexample; `script` made it.
    pub fn try_run(&mut self, script: &Script, run: &Observed<'_>) {
        let is_violation = |entry: &Entry| matches!(entry.happening, Happening::Violation { .. });
        let kept = match run.log.iter().position(is_violation) {
            Some(violation) if self.may_be_late => {
                Observed { log: &run.log[..=violation], ending: Ending::Stopped, sight: run.sight }
            }
            _ => Observed { ..*run },
        };
        let is_open_rule = |(promise, it): &(Promise, Tried)| {
            matches!(promise, Promise::Rule(_)) && it.counterexample.is_none()
        };
        let times = (self.lines.iter().any(is_open_rule))
            .then(|| executed_times(&self.network, &self.plan, run))
            .flatten();
        let executed = times.as_ref().map(|times| Scheduled {
            program: &self.program,
            network: &self.network,
            plan: &self.plan,
            times,
            is_extreme: false,
            log: Some(run.log),
        });
        for (promise, tried) in &mut self.lines {
            if tried.counterexample.is_some() {
                continue;
            }
            let run = if promise.is_of_whole_runs() { run } else { &kept };
            let Some(found) = promise.broken_by_run(run, executed) else { continue };
            tried.runs += 1;
            tried.counterexample = found.map(|text| Counterexample { text, script: script.clone() });
        }
    }

    /// The lines with how they were tried, in the order of the review.
    pub fn tried(&self) -> impl Iterator<Item = &Tried> {
        self.lines.iter().map(|(_, tried)| tried)
    }
}

/// When the nodes of a plan were executed in a run that kept the plan to its end; `None` if one with events was not.
fn executed_times(network: &Network, plan: &Plan, run: &Observed<'_>) -> Option<Vec<Option<Time>>> {
    let is_other = |it: &Happening| matches!(it, Happening::Violation { .. } | Happening::Replanned { .. });
    if run.ending != Ending::Finished || run.log.iter().any(|entry| is_other(&entry.happening)) {
        return None;
    }
    let executed = run.log.iter().filter_map(|entry| match &entry.happening {
        Happening::Executed { name } => Some((name.as_str(), entry.time)),
        _ => None,
    });
    let executed: BTreeMap<&str, Time> = executed.collect();
    let time = |node: &tpn::Node| {
        let mut events = node.events.iter().filter(|&&event| plan.has_event(network, event)).peekable();
        events.peek()?;
        Some(events.find_map(|&event| executed.get(network.event_name(event).as_str()).copied()))
    };
    network.nodes.iter().map(|node| time(node).map_or(Some(None), |it| it.map(Some))).collect()
}

/// The times of the events that have names, and of nodes without events.
pub(crate) fn named_times(network: &Network, plan: &Plan, times: &[Option<Time>]) -> BTreeMap<SmolStr, Time> {
    let mut named = BTreeMap::new();
    for (index, (node, time)) in network.nodes.iter().zip(times).enumerate() {
        let Some(time) = *time else { continue };
        let events = node.events.iter().filter(|&&event| plan.has_event(network, event));
        let mut names: Vec<String> = events.map(|&event| network.event_name(event)).collect();
        if names.is_empty() {
            names.push(node_name(network, NodeId::from_index(index)));
        }
        named.extend(names.into_iter().map(|name| (SmolStr::from(name), time)));
    }
    named
}

#[cfg(test)]
mod tests;
