//! JSON documents about a mission: what was observed, what disturbs it, what is uncertain, and what a board says.

use std::sync::LazyLock;

use exact::Time;
use executive::{Observations, Script};
use mission::programs::Programs;
use review::{FlightRules, Record};
use serde::Deserialize as _;
use serde_json::Value;
use snapshot::Uncertainty;
use tpn::{NodeId, Plan};

use super::missions::{example, shared_network};
use super::{NOTHING, Outcome, Reader, magnitude, nothing, read, refused, text_of};

/// Places and obstacles in `GeoJSON`: what they come to is text of the language.
pub(super) const PLACES: Reader = Reader {
    name: "geojson",
    seeds: &[],
    words: &[
        "\"type\": \"Point\"",
        "\"type\": \"Polygon\"",
        "\"coordinates\": ",
        "\"radius_m\": ",
        "\"name\": \"choose\"",
        "\"units\": \"metres\"",
        "\"origin\": [0, 90]",
        "\"crs\": ",
        "null",
        "[[[",
        "1e308",
        "-180",
    ],
    mend: nothing,
    exercise: places,
    tested: 1200,
    keeps_form: 3,
    cost: 1,
};

fn places(input: &[u8]) -> Outcome {
    match interchange::geojson::declarations(
        "site.geojson",
        &text_of(input),
        &interchange::geojson::Frame::default(),
    ) {
        Ok(lines) => {
            let parse = rmpl::parse(&lines);
            assert!(parse.diagnostics().is_empty(), "{lines}");
            let world = parse.program().world;
            read(&format!("{} {}", magnitude(world.locations.len()), magnitude(world.obstacles.len())))
        }
        Err(reason) => refused(&reason.to_string()),
    }
}

/// What happened, of a mission and its plan: held against the plan.
pub(super) const OBSERVATIONS: Reader = Reader {
    name: "observations",
    seeds: &[],
    words: &["\"executed\"", "\"now\"", "\"M.start\"", "0.1", "\"1/3\""],
    mend: nothing,
    exercise: observations,
    tested: 2000,
    keeps_form: 3,
    cost: 1,
};

static PLAN: LazyLock<Plan> = LazyLock::new(|| {
    let outcome = kirk::plan(&shared_network(), &kirk::Options::default(), &mut |_: &kirk::Stats| false);
    outcome.plans.into_iter().next().expect("the example has a plan")
});

fn observations(input: &[u8]) -> Outcome {
    let (_, network) = example();
    let Ok(document) = serde_json::from_str::<Value>(&text_of(input)) else { return NOTHING };
    let times = match tpn::plan_json::times_from_json(network, &document["executed"]) {
        Ok(times) => times,
        Err(reason) => return refused(&reason.to_string()),
    };
    let executed: Vec<(NodeId, Time)> =
        times.iter().enumerate().filter_map(|(at, time)| Some((NodeId::from_index(at), (*time)?))).collect();
    let latest = executed.iter().map(|&(_, time)| time).max().unwrap_or_default();
    let now = document.get("now").map_or(Some(latest), |now| Time::deserialize(now).ok());
    let Some(now) = now else { return NOTHING };
    let progress = executive::progress(network, &PLAN, &Observations { executed, now });
    match progress {
        Ok(progress) => read(&format!("{progress:?}")),
        Err(reason) => refused(&reason.to_string()),
    }
}

/// Scripts of what disturbs a run.
pub(super) const DISTURBANCES: Reader = Reader {
    name: "disturbances",
    seeds: &[],
    words: &[
        "\"disturbances\"",
        "\"kind\"",
        "\"seed\"",
        "\"at\"",
        "\"duration\"",
        "\"Rover1\"",
        "\"Base\"",
        "1e-9",
    ],
    mend: nothing,
    exercise: disturbances,
    tested: 2000,
    keeps_form: 3,
    cost: 1,
};

static PROGRAMS: LazyLock<Programs> = LazyLock::new(|| {
    let (program, network) = example();
    Programs::compile(program, Some(network)).0
});

fn disturbances(input: &[u8]) -> Outcome {
    let (program, network) = example();
    let script = match serde_json::from_str::<Script>(&text_of(input)) {
        Ok(script) => script,
        Err(reason) => return refused(&reason.to_string()),
    };
    let checked = mission::execution::check_script(network, program, &PROGRAMS, &script);
    let written = serde_json::to_string(&script).expect("it is written");
    assert_eq!(serde_json::from_str::<Script>(&written).ok(), Some(script), "what is written can be read");
    read(&format!("{checked:?}"))
}

/// What may come otherwise than planned.
pub(super) const UNCERTAINTY: Reader = Reader {
    name: "uncertainty",
    seeds: &[],
    words: &["\"durations\"", "\"share\"", "\"normal\"", "\"uniform\"", "\"Drive\"", "0.5"],
    mend: nothing,
    exercise: uncertainty,
    tested: 2000,
    keeps_form: 3,
    cost: 1,
};

fn uncertainty(input: &[u8]) -> Outcome {
    match serde_json::from_str::<Uncertainty>(&text_of(input)) {
        Ok(uncertainty) => read(&format!("{:?}", uncertainty.problem(example().1))),
        Err(reason) => refused(&reason.to_string()),
    }
}

/// What a board said: read, written and joined.
pub(super) const REVIEWS: Reader = Reader {
    name: "reviews",
    seeds: &[],
    words: &[
        "\"entries\"",
        "\"digest\"",
        "\"said\"",
        "\"former\"",
        "\"approve\"",
        "\"comment\"",
        "\"enroute-review/3\"",
        "\"signature\"",
        "\"key\"",
        "\"waive\"",
        "\"subjects\"",
    ],
    mend: nothing,
    exercise: reviews,
    tested: 1200,
    keeps_form: 3,
    cost: 1,
};

fn reviews(input: &[u8]) -> Outcome {
    match Record::from_json(&text_of(input)) {
        Ok(record) => {
            let written = record.to_json();
            let mut again = Record::from_json(&written).expect("what is written can be read");
            assert_eq!(again, record, "what is written can be read");
            assert_eq!(again.merge(record.clone()), 0, "joined with itself");
            read(&format!("{}", record.entries().len()))
        }
        Err(reason) => refused(&reason.to_string()),
    }
}

pub(super) const FLIGHT_RULES: Reader = Reader {
    name: "flight-rules",
    seeds: &[],
    words: &[
        "\"format\"",
        "\"enroute-rules/1\"",
        "\"margin\"",
        "\"reserves\"",
        "\"success_rate\"",
        "\"rules\"",
        "\"board\"",
        "null",
    ],
    mend: nothing,
    exercise: flight_rules,
    tested: 2000,
    keeps_form: 3,
    cost: 1,
};

fn flight_rules(input: &[u8]) -> Outcome {
    match FlightRules::from_json(&text_of(input)) {
        Ok(rules) => {
            assert_eq!(FlightRules::from_json(&rules.to_json()), Ok(rules), "what is written can be read");
            read("")
        }
        Err(reason) => refused(&reason),
    }
}
