//! Steps per second on orbit insertion: our interpreted automaton against the statechart engine `XState`.

use std::process::Command;
use std::time::Duration;

use anyhow::{Context as _, Result};
use hca::{Estimate, Stepper, Vocabulary, compile_text};
use serde::Deserialize;

use crate::stopwatch::Stopwatch;
use crate::table::{Table, ratio};
use crate::tools::{Absent, Tools, answer};

const PROGRAM: &str = include_str!("../../../tests/conformance/h01_orbit_nominal.rmpl");

/// What is estimated of both engines after each step, and how many locations are marked then (SPEC 8.4).
type Course = (&'static str, &'static [(&'static str, &'static str, usize)]);

const COURSES: [Course; 2] = [
    (
        "nominal",
        &[("Off", "Off", 4), ("Standby", "Standby", 2), ("Standby", "Standby", 2), ("Firing", "Standby", 0)],
    ),
    (
        "engine A fails at step 3",
        &[
            ("Off", "Off", 4),
            ("Standby", "Standby", 2),
            ("Failed", "Standby", 1),
            ("Failed", "Standby", 1),
            ("Failed", "Firing", 0),
        ],
    ),
];

/// Prints one table.
pub(crate) fn compare(tools: &mut Tools, quick: bool) -> Result<()> {
    let mut table =
        Table::new("Automata: steps per second on orbit insertion", &["run", "engine", "steps/s", "ours is"]);
    let seconds = if quick { 0.2 } else { 2.0 };
    for (name, course) in COURSES {
        let ours = ours(course, seconds)?;
        table.row(vec![
            name.to_owned(),
            "ours, interpreted".to_owned(),
            format!("{ours:.0}"),
            ratio(1.0, 1.0),
        ]);
        for (engine, how) in
            [("XState 5.33.3, `transition`", "transition"), ("XState 5.33.3, an actor", "actor")]
        {
            let cells = match xstate(tools, how, course, seconds) {
                Ok(steps) => vec![format!("{steps:.0}"), ratio(ours, steps)],
                Err(why) => vec![why],
            };
            table.row([name.to_owned(), engine.to_owned()].into_iter().chain(cells).collect());
        }
    }
    table.row(vec![
        "nominal".into(),
        "a state machine compiled by hand to Rust".into(),
        "200 million, from the issue: not run".into(),
    ]);
    table.row(vec![
        "15 breakers, 8 lamps".into(),
        "Livingstone 2, a diagnosis".into(),
        "1.3 ms, from the issue: not run".into(),
    ]);
    table.note("The statechart says what the control program says, region by region; after every step of a first run the number of its active states is compared with the locations that SPEC 8.4 has marked. Our estimation on the breakers is in `cargo xtask bench plant`.");
    table.print();
    Ok(())
}

fn ours(course: &[(&str, &str, usize)], seconds: f64) -> Result<f64> {
    let automaton =
        compile_text(PROGRAM, &Vocabulary::default()).automaton.context("orbit insertion compiles")?;
    let estimates: Vec<Estimate> = (course.iter())
        .map(|(a, b, _)| automaton.estimate([("EngineA", *a), ("EngineB", *b), ("Camera", "Off")]))
        .collect();
    let start_marking = automaton.start();
    let mut stepper = Stepper::new(&automaton);
    let mut steps = 0_u64;
    let begun = Stopwatch::start();
    while begun.elapsed().as_secs_f64() < seconds {
        for _ in 0..10_000 {
            stepper.set_marking(&start_marking);
            for estimate in &estimates {
                stepper.step(std::hint::black_box(estimate));
                steps += 1;
            }
            assert!(std::hint::black_box(stepper.is_done()), "the program ends");
        }
    }
    Ok(steps as f64 / begun.elapsed().as_secs_f64())
}

fn xstate(tools: &mut Tools, how: &str, course: &[(&str, &str, usize)], seconds: f64) -> Result<f64, Absent> {
    #[derive(Deserialize)]
    struct Measured {
        steps_per_second: f64,
    }
    let folder = tools.node()?;
    let course = serde_json::to_string(course).map_err(|error| error.to_string())?;
    let mut command = Command::new("node");
    command.args(["automata.mjs", how, &seconds.to_string(), &course]).current_dir(folder);
    let text = answer(&mut command, Duration::from_mins(1))?;
    let measured: Measured = serde_json::from_str(&text).map_err(|error| format!("failed: {error}"))?;
    Ok(measured.steps_per_second)
}
