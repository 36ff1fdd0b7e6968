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
            "Search in text order, learning a conflict from each failure.",
            "Ruled out for every choice: ARM=STOWED for Look#1 from the start of the mission.",
            "For every choice: ARM=STOWED for Look#1 from Stow#1.",
            "The times are consistent, and the choices imply all necessary orderings.",
            "Plan found.",
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
            "Search in text order, learning a conflict from each failure.",
            "For every choice: R1.at=B for Look#1 from Drive(B).",
            "Order Drive(B) before Drive(C): both move R1.",
            "Drive(B) before Drive(C) implies Look#1 before Drive(C).",
            "The times are consistent. The plan keeps these orderings: Drive(B) before Drive(C) and Look#1 before Drive(C).",
            "Plan found.",
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
            "Search in text order, learning a conflict from each failure.",
            "Together Radio#1, Arm#1 and Heat#1 take 9 of Power, which has 7: one must wait for another.",
            "Restart with all learned conflicts.",
            "Order Heat#1 before Radio#1: both use Power.",
            "The times are consistent. The plan keeps these orderings: Heat#1 before Radio#1 (Power).",
            "Plan found.",
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
            "Search in text order, learning a conflict from each failure.",
            "Drive#1 and Drive#2 take Battery below 10: Charge#1 must come before one of them.",
            "Restart with all learned conflicts.",
            "For every choice: Charge#1 before Drive#2 (Battery).",
            "The times are consistent. The plan keeps these orderings: Charge#1 before Drive#2 (Battery).",
            "Plan found.",
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
            "Find a first plan, then improve it.",
            "Decide D1: Long#1.",
            "The times are consistent, and the choices imply all necessary orderings.",
            "Best plan so far: end 5.",
            "Search for a better plan than end 5: less end; no plan has less than 2.",
            "Ruled out for every choice: Long#1 in D1.",
            "For every choice: Short#1 in D1.",
            "The times are consistent, and the choices imply all necessary orderings.",
            "Best plan so far: end 2.",
            "Search for a better plan than end 2: less end; no plan has less than 2.",
            "Ruled out for every choice: Long#1 in D1.",
            "For every choice: Short#1 in D1.",
            "Failure: no plan is better than the best plan found.",
            "No alternatives left.",
            "Plan found.",
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
            "Expand the state with the best bound first. The first complete plan is optimal.",
            "Continue here: best possible cost 4; no other state is open.",
            "Decide D1: Long#1.",
            "Long#1 in D1 rules out Walk#1 in D2.",
            "Long#1 in D1 implies Ride#1 in D2.",
            "Open: no plan from this state is better than cost 8.",
            "Decide D1: Short#1.",
            "Open: no plan from this state is better than cost 5.",
            "Continue here: best possible cost 5; 1 other state is open.",
            "Decide D2: Walk#1.",
            "Open: no plan from this state is better than cost 5.",
            "Decide D2: Ride#1.",
            "Open: no plan from this state is better than cost 9.",
            "Continue here: best possible cost 5; 2 other states are open.",
            "The times are consistent, and the choices imply all necessary orderings.",
            "Closed: no plan from this state is better than the best plan found.",
            "Closed: no plan from this state is better than the best plan found.",
            "Best plan so far: cost 5.",
            "Plan found.",
        ],
    );
}

#[test]
fn nature() {
    check(
        "primitive Drive() contingent [10,20]; primitive Walk()[12,13];
         scenario S[0,30] = { choose { Drive(), Walk() } [0,15] }",
        &[
            "Search in text order, learning a conflict from each failure.",
            "Decide D1: Drive#1.",
            "Failure: the mission is not controllable with Drive#1 in D1. Learned: never Drive#1 in D1.",
            "Backjump to the start: the failure depends only on Drive#1 in D1.",
            "Ruled out for every choice: Drive#1 in D1.",
            "For every choice: Walk#1 in D1.",
            "The times are consistent, and the choices imply all necessary orderings.",
            "Plan found.",
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
            "Search in text order, learning a conflict from each failure.",
            "Order Drive(B) before Drive(C): both move R1.",
            "Drive(B) before Drive(C) implies Drive(B) before Drive(A).",
            "Drive(B) before Drive(C) implies Drive(A) before Drive(C).",
            "Failure: Drive(B), Drive(C) and Drive(A) need at least 30, but the scenario allows only 25: 5 too long.",
            "Learned: never Drive(B) before Drive(C).",
            "Backjump to the start: the failure depends only on Drive(B) before Drive(C).",
            "For every choice: Drive(C) before Drive(B).",
            "For every choice: Drive(C) before Drive(A).",
            "For every choice: Drive(A) before Drive(B).",
            "Failure: Drive(B), Drive(C) and Drive(A) need at least 30, but the scenario allows only 25: 5 too long.",
            "No alternatives left.",
        ],
    );
}
