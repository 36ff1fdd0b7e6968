//! The state as plain JSON, for host pages and tests (DESIGN 4.3).

use executive::Happening;
use mission::paths_json::traverses_json;
use mission::review::{Review, Section};
use mission::{Problem, Snapshot};
use serde_json::{Value, json};
use tpn::Network;
use tpn::plan_json::plan_to_json;

use super::hca_json::hca_json;
use crate::state::execution::{Pending, has_come};
use crate::state::pins;
use crate::state::review::Signed;
use crate::state::search::{Counts, Recording};
use crate::state::selection::node_name;
use crate::state::{AppState, Status};

/// The state. `revision` is the text's; everything that was worked out is under the revision it belongs to, which is
/// the same once `status` is not `working`.
pub fn state_json(state: &AppState) -> Value {
    let latest = state.snapshots.latest();
    let shown = state.looked_at();
    let network = shown.and_then(|shown| shown.network.as_deref());
    let planning = shown.and_then(|shown| shown.planning.as_deref());
    let plan = network.zip(shown.and_then(|shown| shown.plan()));
    let failure = planning.and_then(|planning| planning.outcome.failure.as_ref());
    let verdict = planning.and_then(|planning| planning.verdict.as_ref());
    let problems = latest.map(|latest| latest.problems.iter().map(problem_json).collect::<Vec<_>>());
    let caret = state.document.caret();
    json!({
        "revision": state.document.revision(),
        "answeredRevision": latest.map(|latest| latest.revision),
        "shownRevision": shown.map(|shown| shown.revision),
        "status": status_name(state.status()),
        "isStale": state.snapshots.is_stale(state.document.revision()),
        "mission": state.mission.as_str(),
        "workspace": state.workspace.name(),
        "activePanel": state.active_panel.name(),
        "panels": state.panels_on_screen.iter().map(|panel| panel.name()).collect::<Vec<_>>(),
        "theme": state.settings.theme,
        "diagnostics": problems.unwrap_or_default(),
        "tpn": network.map(|network| json!({
            "nodes": network.nodes.len(),
            "arcs": network.arcs.len(),
            "decisions": network.decisions.len(),
            "occurrences": network.occurrences.len(),
        })),
        "plan": plan.map(|(network, plan)| plan_to_json(network, plan)),
        "verdict": verdict.map(verdict_json),
        "failure": network.zip(failure).map(|(network, failure)| failure_json(network, failure)),
        "review": review_json(state),
        "compare": state.compare.reference().map(|side| json!({ "with": side.name, "planned": side.is_planned })),
        "search": search_json(state),
        "hca": hca_json(&state.automaton, state.document.revision()),
        "vehicles": shown.map(|shown| vehicles_json(state, shown)).unwrap_or_default(),
        "traverses": shown
            .zip(network)
            .map(|(shown, network)| traverses_json(&shown.traverses, network, &shown.program.world)),
        "time": state.playback.time,
        "endTime": state.playback.end,
        "isPlaying": state.playback.is_playing,
        "timeRange": state.time_range,
        "pinned": shown.and_then(|shown| pinned_json(state, shown)),
        "execution": execution_json(state),
        "robustness": robustness_json(state),
        "selection": state.selection.to_json(network),
        "caret": { "anchor": caret.anchor, "head": caret.head },
        "canUndo": state.document.can_undo(),
        "canRedo": state.document.can_redo(),
        "dialog": state.dialog.as_ref().map(crate::Dialog::name),
        "terrain": terrain_json(state),
        "toasts": state.toasts.shown().iter().map(|toast| toast.text.as_str()).collect::<Vec<_>>(),
        "renderer": state.frame.renderer,
        "timings": timings_json(state),
    })
}

/// The search: `step` counts from 1 and is 0 while the plan is shown.
fn search_json(state: &AppState) -> Value {
    let recordings = state.search.recordings(state.shown());
    let side = state.search.side();
    let step = state.search.step().map_or(0, |step| step.step + 1);
    let known = state.search.shown().map(|view| {
        let network = view.recording.network();
        let entry = view.recording.trace().events.get(view.step.step);
        let mut known = plan_to_json(network, &view.plan);
        known["event"] = json!(entry.map(|entry| event_name(&entry.event)));
        known["text"] = json!(entry.map(|entry| crate::state::search::wording::event(network, &entry.event)));
        known["state"] = json!(view.step.tree_node);
        known["cycle"] = view.step.cycle.iter().map(|it| json!(node_name(network, it.from))).collect();
        known
    });
    let compared: Vec<Value> = recordings
        .iter()
        .enumerate()
        .filter_map(|(side, recording)| {
            let searched = recording.searched()?;
            let counts = Counts::of(recording.trace());
            Some(json!({
                "search": searched.search,
                "status": searched.status,
                "step": state.search.view(side).map_or(0, |view| view.step.step + 1),
                "steps": recording.steps(),
                "states": counts.states,
                "propagations": counts.propagations,
                "backtracks": counts.backtracks,
                "deadEnds": counts.failures,
                "millis": searched.millis,
            }))
        })
        .collect();
    json!({
        "step": step,
        "steps": recordings.get(side).or(recordings.first()).map_or(0, Recording::steps),
        "isPlaying": state.search.is_playing,
        "stepsPerSecond": state.search.steps_per_sec,
        "breakpoints": state.search.breakpoints,
        "known": known,
        "compare": state.search.compares().then(|| json!({
            "side": side,
            "isLinked": state.search.is_linked(),
            "searches": compared,
        })),
    })
}

/// The name of an event of the search, as in recorded searches on the command line.
fn event_name(event: &kirk::Event) -> &'static str {
    use kirk::Event;
    match event {
        Event::Expand { .. } => "expand",
        Event::Decide { .. } => "decide",
        Event::AddArc { .. } => "add-arc",
        Event::Propagate { .. } => "propagate",
        Event::Inconsistent { .. } => "inconsistent",
        Event::Unclosable { .. } => "unclosable",
        Event::TryLink { .. } => "try-link",
        Event::Threat { .. } => "threat",
        Event::TryOrder { .. } => "try-order",
        Event::Unresolvable { .. } => "unresolvable",
        Event::Known => "known",
        Event::Backtrack { .. } => "backtrack",
        Event::Backjump { .. } => "backjump",
        Event::Solution { .. } => "solution",
        Event::Exhausted => "exhausted",
    }
}

/// What is done on the terrain.
fn terrain_json(state: &AppState) -> Value {
    let terrain = &state.terrain;
    let growth = terrain.growth.shown().map(|shown| {
        json!({
            "planner": crate::state::growth::planner_title(terrain.growth.planner),
            "leg": shown.leg,
            "samples": shown.samples(),
            "total": shown.total,
            "vertices": shown.vertices(),
            "length": shown.length_m(),
        })
    });
    let time = state.playback.time;
    let drives = state.run_shown().map_or(&[][..], |run| run.drives.as_slice());
    let rays: usize = drives
        .iter()
        .flat_map(|drive| &drive.vehicles)
        .filter(|it| it.frames.last().is_some_and(|last| last.time > time))
        .filter_map(|it| it.at(time))
        .map(|frame| frame.rays_m.len())
        .sum();
    json!({
        "tool": terrain.tool.name(),
        "points": terrain.points_m,
        "clearance": state.settings.views.terrain.clearance,
        "rays": rays,
        "growth": growth,
    })
}

/// The run of the mission at the time shown; null unless one is watched.
fn execution_json(state: &AppState) -> Value {
    let run = state.execution.run().filter(|_| state.is_executing());
    let network = state.looked_at().and_then(|shown| shown.network.as_deref());
    let Some(((run, moment), network)) = run.zip(state.execution.moment()).zip(network) else {
        return Value::Null;
    };
    let time = state.playback.time;
    let log: Vec<&executive::Entry> = run.log.iter().filter(|entry| has_come(entry.time, time)).collect();
    let replans = log.iter().filter(|entry| matches!(entry.happening, Happening::Replanned { .. })).count();
    let status = match log.last().map(|entry| &entry.happening) {
        Some(Happening::Finished) => "finished",
        Some(Happening::Stopped { .. }) => "stopped",
        _ => "under-way",
    };
    let names = |pending: &[Pending]| -> Vec<String> {
        pending.iter().map(|it| network.occurrences[it.occurrence.index()].name.to_string()).collect()
    };
    json!({
        "status": status,
        "ending": run.ending,
        "isWorking": state.execution.is_working(),
        "time": time,
        "replans": replans,
        "underWay": names(&moment.under_way),
        "holding": names(&moment.holding),
        "waitedFor": names(&moment.to_come),
        "deadline": moment.deadline.map(|(event, latest)| json!({
            "event": network.event_name(event),
            "time": latest,
        })),
        "disturbances": state.execution.disturbances(),
        "log": log,
    })
}

/// What is known of the plan's robustness; null until runs were made.
fn robustness_json(state: &AppState) -> Value {
    let Some(robustness) = state.robustness() else {
        return Value::Null;
    };
    let (low, high) = robustness.tally.interval();
    json!({
        "runs": robustness.tally.runs,
        "isRunning": state.chance.is_running(),
        "probability": robustness.tally.probability(),
        "interval": [low, high],
        "worst": robustness.tally.worst_events().into_iter().map(|(name, _)| name).collect::<Vec<_>>(),
    })
}

/// Why there is no plan.
fn failure_json(network: &Network, failure: &kirk::Failure) -> Value {
    let reasons: Vec<Value> = failure
        .reasons
        .iter()
        .map(|reason| {
            let choices: serde_json::Map<String, Value> = reason
                .choices
                .iter()
                .map(|choice| (Network::decision_name(choice.decision), json!(choice.alternative)))
                .collect();
            json!({ "choices": choices, "kind": reason.kind.name(), "message": reason.message })
        })
        .collect();
    let labels = |label| network.label_name(label);
    let conditions: Vec<String> = failure
        .reasons
        .iter()
        .flat_map(|reason| &reason.conflict)
        .filter_map(|member| match member {
            kirk::Member::Condition(label) => Some(labels(*label)),
            kirk::Member::Bound(_) => None,
        })
        .collect();
    json!({
        "reasons": reasons,
        "conditions": conditions,
        "relaxations": failure.relaxations.iter().map(|it| it.label.as_str()).collect::<Vec<_>>(),
    })
}

/// The review: `null` before the first one of this mission. `hash` is that of what was reviewed, `currentHash` that of
/// the present content; `stale` says that they differ.
fn review_json(state: &AppState) -> Value {
    let record = state.review.record();
    let sign_off = |sign_off: &mission::review::record::SignOff, is_stale: bool| {
        json!({
            "name": sign_off.name,
            "time": sign_off.time,
            "hash": sign_off.content_hash,
            "stale": is_stale,
        })
    };
    let signed = match state.review.signed() {
        Signed::Never => Value::Null,
        Signed::Current(by) => sign_off(by, false),
        Signed::Stale(by) => sign_off(by, true),
    };
    let shown = state.review.shown(state.settings.plan.search);
    json!({
        "hash": shown.map(|(review, _)| review.content_hash.as_str()),
        "currentHash": state.review.hash(),
        "stale": shown.is_some_and(|(_, is_stale)| is_stale),
        "running": state.review.is_running(),
        "status": shown.map(|(review, _)| review.status),
        "counts": shown.map(|(review, _)| {
            let [passed, attention, failed] = review.counts();
            json!({ "passed": passed, "attention": attention, "failed": failed })
        }),
        "items": shown.map(|(review, _)| review_items(review)).unwrap_or_default(),
        "signed": signed,
        "comments": record.comments,
        "unkept": state.review.unkept(),
    })
}

fn review_items(review: &Review) -> Vec<Value> {
    let items = Section::ALL.iter().flat_map(|&section| {
        review.lines(section).into_iter().map(move |line| {
            json!({
                "section": section,
                "status": line.status,
                "text": line.text,
                "line": line.line_number,
                "names": line.names,
            })
        })
    });
    items.collect()
}

fn verdict_json(verdict: &verify::Verdict) -> Value {
    json!({
        "valid": verdict.valid,
        "violations": verdict.violations.iter().map(|it| it.message.as_str()).collect::<Vec<_>>(),
    })
}

fn problem_json(problem: &Problem) -> Value {
    json!({
        "code": problem.code.as_str(),
        "severity": problem.severity,
        "message": problem.message,
        "span": {
            "start": problem.span.start,
            "end": problem.span.end,
            "line": problem.line,
            "column": problem.column,
        },
        "hint": problem.hint,
        "fixes": problem.fixes.iter().map(|fix| fix.label.as_str()).collect::<Vec<_>>(),
    })
}

/// The events that are pinned, and the windows that they leave to all events; `null` without any.
fn pinned_json(state: &AppState, snapshot: &Snapshot) -> Option<Value> {
    let (network, plan) = (snapshot.network.as_deref()?, state.pins.plan(snapshot)?);
    let pinned = state.pins.all();
    let events: serde_json::Map<String, Value> = pinned
        .iter()
        .map(|&(node, time)| (pins::event_name(network, node), json!(crate::state::playback::number(time))))
        .collect();
    let windows = plan_to_json(network, plan)["windows"].take();
    Some(json!({ "events": events, "windows": windows }))
}

/// Where the vehicles are; `z` is the height of the ground under them, or their flight over it.
fn vehicles_json(state: &AppState, snapshot: &Snapshot) -> Vec<Value> {
    let time = state.playback.time;
    let ground = snapshot.map.as_ref().and_then(|key| state.maps.get(key));
    let vehicles = &snapshot.program.world.vehicles;
    snapshot
        .motions
        .iter()
        .filter_map(|motion| {
            let (place, heading) = motion.at(time)?;
            let vehicle = vehicles.get(motion.vehicle as usize)?;
            let name = vehicle.name.text.as_str();
            let z = ground
                .and_then(|ground| ground.height_at(place))
                .map(|height| height + flight_height_m(&vehicle.model.text));
            Some(
                json!({ "name": name, "x": place.x, "y": place.y, "z": z, "heading": heading, "time": time }),
            )
        })
        .collect()
}

fn timings_json(state: &AppState) -> Value {
    let timings = state.shown().map(|shown| shown.timings).unwrap_or_default();
    let layout = state.frame.layout_millis;
    let revision = state.document.revision();
    let answer = state.frame.answer.filter(|answer| answer.revision == revision);
    let worked_out = timings.parse_millis + timings.compile_millis + timings.plan_millis;
    json!({
        "parse": timings.parse_millis,
        "compile": timings.compile_millis,
        "plan": timings.plan_millis,
        "layout": layout,
        "total": worked_out + layout,
        "frame": state.frame.cpu_millis,
        "wholeFrame": state.frame.whole_millis,
        "answerFrame": answer.map(|answer| answer.cpu_millis),
        "shownAt": answer.map(|answer| answer.done_secs * 1000.0),
    })
}

fn status_name(status: Status) -> &'static str {
    match status {
        Status::Working => "working",
        Status::Broken => "broken",
        Status::Empty => "empty",
        Status::Program => "program",
        Status::Plan => "plan",
        Status::NoPlan => "no-plan",
    }
}

/// How high over the ground a vehicle of this model is drawn; 0 for what drives.
fn flight_height_m(model: &str) -> f64 {
    match motion::vehicle_model(model).map(|model| model.drive) {
        Some(motion::Drive::Flight { altitude_band_m: [low, high], .. }) => f64::midpoint(low, high),
        _ => 0.0,
    }
}
