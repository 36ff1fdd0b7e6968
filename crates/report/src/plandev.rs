//! A plan's schedule as a plan of `PlanDev` (NASA's Aerie): one activity directive for each primitive, at its offset from the
//! start of the plan.

use exact::Time;
use interchange::plandev::{DIRECTIVE_TYPE, DURATION};
use jiff::Timestamp;
use review::schedule::scheduled;
use rmpl::program::{Program, TimeUnit};
use serde_json::{Map, Value, json};
use snapshot::Snapshot;
use tpn::{Occurrence, OccurrenceKind};

use crate::calendar::Calendar;
use crate::export::About;

/// The plan under the name of its scenario, as version 2 of `PlanDev`'s transfer format. `None` without a plan or a calendar,
/// or beyond what microseconds can count.
///
/// Times are those of the earliest schedule, rounded down to the microsecond. An argument is called what its primitive
/// declares, or `argument1` and so on; how long an activity takes is in its `metadata`, since `PlanDev`'s models decide
/// on that themselves. `model_id` is 0: `PlanDev` asks for the model when it reads a plan.
pub fn plandev(snapshot: &Snapshot, about: &About<'_>) -> Option<Value> {
    let calendar = about.calendar?;
    let network = snapshot.network.as_deref()?;
    let plan = about.plan.or_else(|| snapshot.plan())?;
    let unit = snapshot.program.options.time_unit;
    let mut activities = Vec::new();
    for row in scheduled(network, plan) {
        let occurrence = &network.occurrences[row.occurrence.index()];
        if occurrence.kind != OccurrenceKind::Primitive {
            continue;
        }
        let duration = row.end.earliest.checked_sub(row.start.earliest)?;
        activities.push(json!({
            "anchor_id": null,
            "anchored_to_start": true,
            "arguments": arguments(occurrence, &snapshot.program),
            "id": activities.len() + 1,
            "metadata": {
                DURATION: interval(duration, unit)?,
                "enroute_content_hash": about.content_hash,
                "enroute_plan_status": about.status_in_words(),
            },
            "name": directive_name(occurrence),
            "start_offset": interval(row.start.earliest, unit)?,
            "tags": [],
            "type": said_type(occurrence).unwrap_or(&occurrence.activity),
        }));
    }
    let end = plan.windows.get(network.end.index())?.as_ref()?.earliest;
    let scenario = network.occurrences.iter().find(|found| found.kind == OccurrenceKind::Scenario);
    Some(json!({
        "activities": activities,
        "duration": interval(end, unit)?,
        "id": 0,
        "model_id": 0,
        "name": scenario.map_or("Plan", |scenario| scenario.name.as_str()),
        "simulation_arguments": {},
        "start_time": start_time(calendar),
        "tags": [],
        "version": "2",
    }))
}

/// The name that a plan of `PlanDev` said before, which need not be the only one of its kind, or what the occurrence is called.
fn directive_name(occurrence: &Occurrence) -> &str {
    if said_type(occurrence).is_some() { &occurrence.activity } else { &occurrence.name }
}

/// The type that a plan of `PlanDev` said before.
fn said_type(occurrence: &Occurrence) -> Option<&str> {
    let mut said = occurrence.arguments.iter().filter_map(|argument| argument.split_once('='));
    said.find(|(name, _)| *name == DIRECTIVE_TYPE).map(|(_, kind)| kind)
}

/// By name: what a plan of `PlanDev` said before, `name=value`, or what the mission calls it.
fn arguments(occurrence: &Occurrence, program: &Program) -> Map<String, Value> {
    let declared = program.primitives.iter().find(|primitive| primitive.name.text == occurrence.activity);
    let named = |(index, argument): (usize, &smol_str::SmolStr)| {
        if let Some((name, value)) = argument.split_once('=')
            && let Ok(value) = serde_json::from_str(value)
        {
            return (name.to_owned(), value);
        }
        let formal = declared.and_then(|primitive| primitive.formals.get(index));
        let name = formal.map_or_else(|| format!("argument{}", index + 1), |formal| formal.text.to_string());
        (name, Value::String(argument.to_string()))
    };
    let is_type = |argument: &smol_str::SmolStr| {
        argument.split_once('=').is_some_and(|(name, _)| name == DIRECTIVE_TYPE)
    };
    let arguments = occurrence.arguments.iter().enumerate().filter(|(_, argument)| !is_type(argument));
    arguments.map(named).collect()
}

/// As `PostgreSQL` writes intervals, to the microsecond before.
fn interval(time: Time, unit: TimeUnit) -> Option<String> {
    let micros = time.checked_mul(exact::Rational::from(unit.seconds()))?.integer_parts(1_000_000)?;
    let (seconds, fraction) = (micros.div_euclid(1_000_000), micros.rem_euclid(1_000_000));
    let [hours, minutes, seconds] = [seconds / 3_600, seconds / 60 % 60, seconds % 60];
    let fraction = if fraction == 0 { String::new() } else { format!(".{fraction:06}") };
    Some(format!("{hours:02}:{minutes:02}:{seconds:02}{fraction}"))
}

fn start_time(calendar: &Calendar) -> String {
    let start: Timestamp = calendar.epoch();
    start.strftime("%Y-%m-%dT%H:%M:%S%.f+00:00").to_string()
}
