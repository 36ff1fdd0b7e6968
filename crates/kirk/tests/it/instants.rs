//! The order of events within one instant (SPEC 10.4).

use crate::support::{network, plan};
use kirk::{Search, Status};

/// The end of the plan of a mission, which the checker accepts; `None` if there is none.
fn end_of_plan(text: &str) -> Option<String> {
    let network = network(text);
    let outcome = plan(&network, Search::ConflictDirected, false);
    assert_ne!(outcome.status, Status::Limit, "{text}");
    let plan = outcome.plans.first()?;
    let verdict = verify::check_plan(&network, plan);
    assert!(verdict.violations.is_empty(), "{verdict:?}\n{text}");
    Some(plan.quality.end.to_string())
}

#[test]
fn activities_without_length_do_not_support_each_other_in_a_circle() {
    for count in 2..6 {
        let next = |at: usize| (at + 1) % count;
        let states = (0..count).map(|at| format!("state X{at} : {{F, T}} = F;"));
        let activities = (0..count)
            .map(|at| format!("primitive A{at}()[0,1] requires at start X{at}=T sets X{}=T;", next(at)));
        let calls = (0..count).map(|at| format!("free A{at}()")).collect::<Vec<_>>().join(", ");
        let circle: String = states.chain(activities).collect();
        assert_eq!(end_of_plan(&format!("{circle} scenario S[0,50] = {{ {calls} }}")), None);
        // With a beginning, all of them follow at once.
        let begun = format!(
            "{circle} primitive Crank()[30,30] sets X0=T; objective minimize end;
             scenario S[0,50] = {{ {calls}, optional Crank() }}"
        );
        assert_eq!(end_of_plan(&begun).as_deref(), Some("30"));
    }
}

#[test]
fn what_comes_later_in_a_sequence_supports_nothing_before_it() {
    let text = |sequence: &str| {
        format!(
            "state DOOR : {{OPEN, SHUT}} = SHUT; primitive Open()[0,0] sets DOOR=OPEN;
             primitive Look()[0,0] requires DOOR=OPEN; scenario S[0,10] = {{ {sequence} }}"
        )
    };
    assert_eq!(end_of_plan(&text("Look(); Open()")), None);
    assert_eq!(end_of_plan(&text("Open(); Look()")).as_deref(), Some("0"));
    assert_eq!(end_of_plan(&text("free Look(), free Open()")).as_deref(), Some("0"));
}

#[test]
fn an_assertion_supports_what_is_maintained_exactly_around_it() {
    let text = |declared: &str| {
        format!(
            "{declared} scenario M[0,60] = {{ delay; do {{ ARM=OUT [10,10] }} maintaining ARM=OUT; delay }}"
        )
    };
    assert_eq!(end_of_plan(&text("state ARM : {STOWED, OUT} = STOWED;")).as_deref(), Some("10"));
    assert_eq!(end_of_plan(&text("var ARM : {STOWED, OUT};")).as_deref(), Some("10"));
}

#[test]
fn production_counts_only_where_it_happens_before_the_consumption() {
    let text = |calls: &str| {
        format!(
            "resource Bat 0..10 = 0; primitive P()[0,0] produces Bat 5; primitive C()[0,0] consumes Bat 5;
             scenario S[0,100] = {{ {calls} }}"
        )
    };
    assert_eq!(end_of_plan(&text("C(); P()")), None);
    assert_eq!(end_of_plan(&text("P(); C()")).as_deref(), Some("0"));
    assert_eq!(end_of_plan(&text("C(), P()")).as_deref(), Some("0"));
    assert_eq!(end_of_plan(&text("{ delay; C() }, { delay[4,4]; P() }")).as_deref(), Some("4"));
}

#[test]
fn uses_without_length_take_turns_within_an_instant() {
    let text = |capacity: i64| {
        format!(
            "resource Cam capacity {capacity}; primitive Shoot()[0,0] uses Cam;
             primitive Film()[5,5] uses Cam; scenario S[0,5] = {{ Shoot(), Shoot(), Film() }}"
        )
    };
    // All start at one time: the shots come one after the other, before the film.
    assert_eq!(end_of_plan(&text(1)).as_deref(), Some("5"));
}
