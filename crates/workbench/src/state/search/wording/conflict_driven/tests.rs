//! What records of small missions say, sentence by sentence.

use kirk::{Options, Search, Unlimited};
use tpn::{Top, compile};

use super::super::event;

fn sentences(text: &str, search: Search) -> Vec<String> {
    let (network, diagnostics) = compile(&rmpl::parse(text).program(), &Top::Scenario(None));
    let network = network.unwrap_or_else(|| panic!("{diagnostics:?}"));
    let options = Options { search, trace_events: Some(1_000), ..Options::default() };
    let trace = kirk::plan(&network, &options, &mut Unlimited).trace.expect("it was asked for");
    trace.events.iter().map(|entry| event(&network, &trace, &entry.event)).collect()
}

#[track_caller]
fn check(text: &str, expected: &[&str]) {
    check_search(text, Search::default(), expected);
}

#[track_caller]
fn check_search(text: &str, search: Search, expected: &[&str]) {
    let sentences = sentences(text, search);
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
            "Look for a plan that is better than end 5: with less end; no plan has less than 2.",
            "Whatever is chosen, D1=0 is ruled out.",
            "Whatever is chosen: D1=1.",
            "The times fit, and what must be kept of their order follows from the choices.",
            "The best plan so far: end 2.",
            "Look for a plan that is better than end 2: with less end; no plan has less than 2.",
            "Whatever is chosen, D1=0 is ruled out.",
            "Whatever is chosen: D1=1.",
            "Failure: no plan is better than the best one found.",
            "Nothing is left to try.",
            "This is a plan.",
        ],
    );
}

#[test]
fn best_first() {
    check_search(
        "primitive Long()[5,9] costs 3; primitive Short()[2,3] costs 4; primitive Walk()[8,8] costs 1; primitive Ride()[2,2] costs 5;
         objective minimize cost;
         scenario S[0,10] = { choose { Long(), Short() }; choose { Walk(), Ride() } }",
        Search::BestFirst,
        &[
            "Always go on where the best plan may still be. The first plan that is finished is the best one.",
            "Go on here, where no plan is better than cost 4; nothing else is open.",
            "Decide D1 = 0: Long#1.",
            "D1=0 rules out D2=0.",
            "From D1=0 it follows: D2=1.",
            "Open: with this no plan is better than cost 8.",
            "Decide D1 = 1: Short#1.",
            "Open: with this no plan is better than cost 5.",
            "Go on here: of all that is open this may become best, with cost 5; one other state is open.",
            "Decide D2 = 0: Walk#1.",
            "Open: with this no plan is better than cost 5.",
            "Decide D2 = 1: Ride#1.",
            "Open: with this no plan is better than cost 9.",
            "Go on here: of all that is open this may become best, with cost 5; 2 other states are open.",
            "The times fit, and what must be kept of their order follows from the choices.",
            "Closed: no plan with this is better than the one that was found.",
            "Closed: no plan with this is better than the one that was found.",
            "The best plan so far: cost 5.",
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
            "Back to the start: the failure has to do with D1=0 alone.",
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
