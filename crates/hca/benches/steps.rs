//! Steps per second of the interpreted automaton on orbit insertion: the nominal run and the failure at step 3.

#![expect(clippy::print_stdout, reason = "a benchmark prints its table")]

use std::time::Instant;

use hca::{Estimate, Stepper, Vocabulary, compile_text};

const PROGRAM: &str = include_str!("../../../tests/conformance/h01_orbit_nominal.rmpl");

fn main() {
    let automaton =
        compile_text(PROGRAM, &Vocabulary::default()).automaton.expect("orbit insertion compiles");
    let runs: [(&str, &[(&str, &str)]); 2] = [
        ("nominal", &[("Off", "Off"), ("Standby", "Standby"), ("Standby", "Standby"), ("Firing", "Standby")]),
        (
            "failure at step 3",
            &[
                ("Off", "Off"),
                ("Standby", "Standby"),
                ("Failed", "Standby"),
                ("Failed", "Standby"),
                ("Failed", "Firing"),
            ],
        ),
    ];
    println!("{:<20} {:>12} {:>14}", "orbit insertion", "steps", "steps/s");
    for (name, engines) in runs {
        let estimates: Vec<Estimate> = engines
            .iter()
            .map(|(a, b)| automaton.estimate([("EngineA", *a), ("EngineB", *b), ("Camera", "Off")]))
            .collect();
        let mut stepper = Stepper::new(&automaton);
        let start = stepper.standing();
        let mut steps = 0_u64;
        let begun = Instant::now();
        while begun.elapsed().as_secs_f64() < 1.0 {
            for _ in 0..10_000 {
                stepper.return_to(&start);
                for estimate in &estimates {
                    stepper.step(std::hint::black_box(estimate));
                    steps += 1;
                }
                assert!(std::hint::black_box(stepper.is_done()), "the program ends");
            }
        }
        println!("{name:<20} {steps:>12} {:>14.0}", steps as f64 / begun.elapsed().as_secs_f64());
    }
}
