//! The run that is watched, many runs with chance, and pinned events.

use std::collections::BTreeMap;

use exact::{Bound, Time};
use executive::{Actor, Course, Disturbance, Ending, Entry, Happening};
use review::contradict::{Tried, Verdict};
use review::flight_rule::proof::Proven;
use serde::Serialize;
use serde_json::{Value, json};
use snapshot::Snapshot;
use tpn::Network;
use tpn::plan_json::plan_to_json;
#[cfg(test)]
use ts_rs::TS;

use crate::state::AppState;
use crate::state::execution::{Pending, has_come};
use crate::state::selection::duration_name;
use crate::state::{pins, playback};

/// A run of the mission at the time shown.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct Execution {
    #[cfg_attr(test, ts(type = "\"under-way\" | \"finished\" | \"stopped\""))]
    pub status: &'static str,
    /// How the whole run ends.
    #[cfg_attr(test, ts(type = "\"finished\" | \"stopped\""))]
    pub ending: Ending,
    /// Whether Enroute is simulating a newer run.
    pub is_working: bool,
    pub time: f64,
    pub replans: usize,
    pub under_way: Vec<String>,
    pub holding: Vec<String>,
    pub waited_for: Vec<String>,
    pub deadline: Option<Deadline>,
    #[cfg_attr(test, ts(type = "Record<string, unknown>[]"))]
    pub disturbances: Vec<Disturbance>,
    /// What has happened up to the time shown.
    #[cfg_attr(test, ts(type = "({ time: Time; event: string } & Record<string, unknown>)[]"))]
    pub log: Vec<Entry>,
}

/// The next event that must happen, and its latest time.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Deadline {
    pub event: String,
    #[cfg_attr(test, ts(type = "Time"))]
    pub time: Time,
}

/// The results of Monte Carlo runs.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct Robustness {
    #[cfg_attr(test, ts(type = "number"))]
    pub runs: u64,
    pub is_running: bool,
    pub probability: f64,
    /// The 95% confidence interval.
    pub interval: [f64; 2],
    /// The events that broke plans, the worst first.
    pub worst: Vec<String>,
}

/// The search for counterexamples of the passed items of the present review.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct Contradiction {
    pub is_running: bool,
    /// How many schedules and runs have been tried, of how many; `null` unless a search is running.
    #[cfg_attr(test, ts(type = "[number, number] | null"))]
    pub progress: Option<[u64; 2]>,
    pub items: Vec<TriedItem>,
}

/// The search for a counterexample of one item.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct TriedItem {
    /// The item.
    pub text: String,
    #[cfg_attr(test, ts(type = "\"survived\" | \"contradicted\" | \"not-tried\""))]
    pub status: Verdict,
    /// The result, in one sentence.
    pub outcome: String,
}

/// Which flight rules hold in every plan of the mission.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct RuleProofs {
    pub is_running: bool,
    /// How many rules have a verdict, of how many; `null` unless a proof is running.
    #[cfg_attr(test, ts(type = "[number, number] | null"))]
    pub progress: Option<[usize; 2]>,
    pub rules: Vec<ProvenRule>,
}

/// The result for one rule.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct ProvenRule {
    /// The text of the rule.
    pub rule: String,
    #[cfg_attr(
        test,
        ts(
            type = "\"holds\" | \"never-applies\" | \"broken\" | \"unsure\" | \"open\" | \"unreadable\" | \"no-plan\""
        )
    )]
    pub verdict: &'static str,
    /// The result, in one sentence.
    pub outcome: String,
}

/// Events pinned to times on the timeline, and the windows that they leave to all events.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Pinned {
    pub events: BTreeMap<String, f64>,
    #[cfg_attr(test, ts(type = "Record<string, [Time, Time]>"))]
    pub windows: Value,
    /// The run against the environment, if the environment chooses something in this plan.
    pub run: Option<NatureRun>,
}

/// A run in which the environment's durations are chosen one by one.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
#[cfg_attr(test, derive(TS))]
pub struct NatureRun {
    /// The present time.
    pub now: f64,
    /// What happened, in the order of time.
    pub acts: Vec<Act>,
    /// The durations that the environment is choosing, and when each may still end.
    #[cfg_attr(test, ts(type = "Record<string, [Time, Time]>"))]
    pub under_way: BTreeMap<String, [Value; 2]>,
    /// What could happen earlier if the environment ended something earlier.
    pub waiting: Vec<Waiting>,
    /// What happens next if the environment lets everything last.
    pub next: Option<Act>,
}

/// An act of the executive or of the environment.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Act {
    pub time: f64,
    /// The events at that instant.
    pub events: Vec<String>,
    /// The duration that the environment ends there; `null` if the executive acts.
    pub nature: Option<String>,
}

/// An event that waits for the environment.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Waiting {
    pub event: String,
    /// The duration whose end it waits for.
    pub nature: String,
    /// The time until which it waits at most.
    pub until: f64,
}

fn nature_run(network: &Network, course: &Course) -> NatureRun {
    let act = |act: &executive::Act| Act {
        time: playback::number(act.time),
        events: pins::names_of_events(network, &act.events),
        nature: match act.actor {
            Actor::Nature(arc) => Some(duration_name(network, arc)),
            Actor::Executive => None,
        },
    };
    let ends = |window: tpn::Window| [json!(Bound::Finite(window.earliest)), json!(window.latest)];
    NatureRun {
        now: playback::number(course.now),
        acts: course.acts.iter().map(act).collect(),
        under_way: course
            .under_way
            .iter()
            .map(|it| (duration_name(network, it.natures), ends(it.window)))
            .collect(),
        waiting: course
            .waiting
            .iter()
            .map(|it| Waiting {
                event: pins::event_name(network, it.event),
                nature: duration_name(network, it.natures),
                until: playback::number(it.until),
            })
            .collect(),
        next: course.next.as_ref().map(act),
    }
}

pub(super) fn execution(state: &AppState) -> Option<Execution> {
    let run = state.execution.run().filter(|_| state.is_executing())?;
    let network = state.looked_at().and_then(|shown| shown.network.as_deref())?;
    let moment = state.execution.moment()?;
    let time = state.playback.time;
    let log: Vec<Entry> = run.log.iter().filter(|entry| has_come(entry.time, time)).cloned().collect();
    let status = match log.last().map(|entry| &entry.happening) {
        Some(Happening::Finished) => "finished",
        Some(Happening::Stopped { .. }) => "stopped",
        _ => "under-way",
    };
    let names = |pending: &[Pending]| -> Vec<String> {
        pending.iter().map(|it| network.occurrences[it.occurrence.index()].name.to_string()).collect()
    };
    Some(Execution {
        status,
        ending: run.ending,
        is_working: state.execution.is_working(),
        time,
        replans: log.iter().filter(|entry| matches!(entry.happening, Happening::Replanned { .. })).count(),
        under_way: names(&moment.under_way),
        holding: names(&moment.holding),
        waited_for: names(&moment.to_come),
        deadline: moment
            .deadline
            .map(|(event, latest)| Deadline { event: network.event_name(event), time: latest }),
        disturbances: state.execution.disturbances().to_vec(),
        log,
    })
}

pub(super) fn robustness(state: &AppState) -> Option<Robustness> {
    let tally = &state.robustness()?.tally;
    let (low, high) = tally.interval();
    Some(Robustness {
        runs: tally.runs,
        is_running: state.chance.is_running(),
        probability: tally.probability(),
        interval: [low, high],
        worst: tally.worst_events().into_iter().map(|(name, _)| name.to_string()).collect(),
    })
}

pub(super) fn contradiction(state: &AppState) -> Option<Contradiction> {
    let review = state.review.current()?;
    let progress = state.contradict.progress();
    let item = |tried: &Tried| TriedItem {
        text: tried.line.text.clone(),
        status: tried.verdict(),
        outcome: tried.sentence(),
    };
    let items: Vec<TriedItem> = state.contradict.of_review(review).map(item).collect();
    (progress.is_some() || !items.is_empty()).then_some(Contradiction {
        is_running: progress.is_some(),
        progress,
        items,
    })
}

pub(super) fn rule_proofs(state: &AppState) -> Option<RuleProofs> {
    let review = state.review.current()?;
    let progress = state.rule_proof.progress();
    let proven = |proven: &Proven| ProvenRule {
        rule: proven.rule.clone(),
        verdict: proven.verdict.name(),
        outcome: proven.verdict.sentence(),
    };
    let rules: Vec<ProvenRule> = state.rule_proof.of_content(&review.content_hash).map(proven).collect();
    (progress.is_some() || !rules.is_empty()).then_some(RuleProofs {
        is_running: progress.is_some(),
        progress,
        rules,
    })
}

pub(super) fn pinned(state: &AppState, snapshot: &Snapshot) -> Option<Pinned> {
    let (network, plan) = (snapshot.network.as_deref()?, state.pins.plan(snapshot)?);
    let pinned = state.pins.all();
    let events = pinned
        .iter()
        .map(|&(node, time)| (pins::event_name(network, node), playback::number(time)))
        .collect();
    let run = state.pins.course(snapshot).map(|course| nature_run(network, course));
    Some(Pinned { events, windows: plan_to_json(network, plan)["windows"].take(), run })
}
