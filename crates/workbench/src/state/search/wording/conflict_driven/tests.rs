//! What records of small missions say, sentence by sentence.

use kirk::{Options, Unlimited};
use tpn::{Top, compile};

use super::super::event;

fn sentences(text: &str) -> Vec<String> {
    let (network, diagnostics) = compile(&rmpl::parse(text).program(), &Top::Scenario(None));
    let network = network.unwrap_or_else(|| panic!("{diagnostics:?}"));
    let options = Options { trace_events: Some(1_000), ..Options::default() };
    let trace = kirk::plan(&network, &options, &mut Unlimited).trace.expect("it was asked for");
    trace.events.iter().map(|entry| event(&network, &trace, &entry.event)).collect()
}

#[track_caller]
fn check(text: &str, expected: &[&str]) {
    let sentences = sentences(text);
    assert_eq!(sentences, expected, "{sentences:#?}");
}

#[test]
fn a_state() {
    check(
        "state ARM : {STOWED, OUT} = STOWED;
         primitive Look()[2,2] requires ARM=STOWED;
         primitive Deploy()[1,1] sets ARM=OUT;
         primitive Stow()[1,1] sets ARM=STOWED;
         scenario S[0,4] = { { delay[1,2]; Look(); delay }, { delay; Deploy(); delay; Stow(); delay } }",
        &[
            "Search in the order of the text. Each failure teaches what never to choose together again.",
            "Whatever is chosen, ARM=STOWED for Look#1 from the start of the mission is ruled out.",
            "Whatever is chosen: ARM=STOWED for Look#1 from Stow#1.",
            "The times fit, and what must be kept of their order follows from the choices.",
            "This is a plan.",
        ],
    );
}

#[test]
fn one_vehicle() {
    check(
        "location A (0, 0); location B (30, 0); location C (60, 0);
         vehicle R1 : ATRV-Jr at A;
         primitive Drive(to)[10,20] moves R1 speed (0.02, 0.5);
         primitive Look()[5,5] requires R1.at=B;
         scenario S[0,30] = { free Drive(B), free Drive(C), free Look() }",
        &[
            "Search in the order of the text. Each failure teaches what never to choose together again.",
            "Whatever is chosen: R1.at=B for Look#1 from Drive#1.",
            "Drive#1 comes before Drive#2: both move R1.",
            "From Drive#1 before Drive#2 it follows: Look#1 before Drive#2.",
            "The times fit. Of their order the plan keeps Drive#1 before Drive#2 and Look#1 before Drive#2.",
            "This is a plan.",
        ],
    );
}

#[test]
fn a_resource() {
    check(
        "resource Power capacity 7;
         primitive Radio()[5,5] uses Power 3;
         primitive Arm()[5,5] uses Power 3;
         primitive Heat()[5,5] uses Power 3;
         scenario S[0,10] = { free Radio(), Arm(), Heat() }",
        &[
            "Search in the order of the text. Each failure teaches what never to choose together again.",
            "Together Radio#1, Arm#1 and Heat#1 take 9 of Power, which has 7: one must wait for another.",
            "Back to the start, with all that was learned.",
            "Heat#1 comes before Radio#1: both use Power.",
            "The times fit. Of their order the plan keeps Heat#1 before Radio#1 (Power).",
            "This is a plan.",
        ],
    );
}

#[test]
fn a_reservoir() {
    check(
        "resource Battery 10..100 = 60;
         primitive Drive()[5,5] consumes Battery 30;
         primitive Charge()[6,6] produces Battery 40;
         scenario S[0,20] = { { Drive(); delay[0,2]; Drive() }, { delay; Charge(); delay } }",
        &[
            "Search in the order of the text. Each failure teaches what never to choose together again.",
            "Drive#1 and Drive#2 take Battery below 10: Charge#1 must come before one of them.",
            "Back to the start, with all that was learned.",
            "Whatever is chosen: Charge#1 before Drive#2 (Battery).",
            "The times fit. Of their order the plan keeps Charge#1 before Drive#2 (Battery).",
            "This is a plan.",
        ],
    );
}

#[test]
fn an_objective() {
    check(
        "primitive Long()[5,9] costs 1; primitive Short()[2,3] costs 4;
         objective minimize end;
         scenario S[0,20] = { choose { Long(), Short() } }",
        &[
            "Look for some plan first, and then for better and better ones.",
            "Decide D1 = 0: Long#1.",
            "The times fit, and what must be kept of their order follows from the choices.",
            "The best plan so far: end 5.",
            "Look for a plan that is better than end 5: with less end.",
            "Whatever is chosen, D1=0 is ruled out.",
            "Whatever is chosen: D1=1.",
            "The times fit, and what must be kept of their order follows from the choices.",
            "The best plan so far: end 2.",
            "Look for a plan that is better than end 2: with less end.",
            "Whatever is chosen, D1=0 is ruled out.",
            "Whatever is chosen: D1=1.",
            "Failure: no plan is better than the best one found.",
            "Nothing is left to try.",
            "This is a plan.",
        ],
    );
}

#[test]
fn nature() {
    check(
        "primitive Drive() contingent [10,20]; primitive Walk()[12,13];
         scenario S[0,30] = { choose { Drive(), Walk() } [0,15] }",
        &[
            "Search in the order of the text. Each failure teaches what never to choose together again.",
            "Decide D1 = 0: Drive#1.",
            "Failure: with D1=0 nature can choose durations that leave no times. Learned: never D1=0.",
            "Back to the start, with all that was learned.",
            "Whatever is chosen, D1=0 is ruled out.",
            "Whatever is chosen: D1=1.",
            "The times fit, and what must be kept of their order follows from the choices.",
            "This is a plan.",
        ],
    );
}

#[test]
fn too_many_drives() {
    check(
        "location A (0, 0); location B (30, 0); location C (60, 0);
         vehicle R1 : ATRV-Jr at A;
         primitive Drive(to)[10,20] moves R1 speed (0.02, 0.5);
         scenario S[0,25] = { free Drive(B), free Drive(C), free Drive(A) }",
        &[
            "Search in the order of the text. Each failure teaches what never to choose together again.",
            "Drive#1 comes before Drive#2: both move R1.",
            "From Drive#1 before Drive#2 it follows: Drive#1 before Drive#3.",
            "From Drive#1 before Drive#2 it follows: Drive#3 before Drive#2.",
            "Failure: Drive#1, Drive#2 and Drive#3 need at least 30, but the scenario allows only 25: 5 too much.",
            "Learned: never Drive#1 before Drive#2.",
            "Back to the start: the failure has to do with Drive#1 before Drive#2 alone.",
            "Whatever is chosen: Drive#2 before Drive#1.",
            "Whatever is chosen: Drive#2 before Drive#3.",
            "Whatever is chosen: Drive#3 before Drive#1.",
            "Failure: Drive#1, Drive#2 and Drive#3 need at least 30, but the scenario allows only 25: 5 too much.",
            "Nothing is left to try.",
        ],
    );
}
