//! Each rule of the check of schedules (SPEC 5.5): times that keep it, and what is said of times that break it.

use exact::Time;
use tpn::{Network, Plan};
use verify::{Rule, Violation, check_schedule, earliest_schedule};

use crate::missions::{Sketch, event, network, plan, time};

const TEXT: &str = "scenario S[0,40] = { choose { A()[3,5], B()[4,6] },
    { delay[2,2]; c [9,9]; delay[1,1]; c [9,9] }, { delay[0,inf]; do D()[2,3] maintaining c },
    { delay[0,inf]; V=X [4,5] }, { delay[0,inf]; V=Y [2,2] } }";

/// A plan of [`TEXT`] without its links and orderings: a schedule needs none.
fn good() -> (Network, Plan) {
    let network = network(TEXT);
    let plan = plan(&network, Sketch { choices: &[(1, 0)], ..Sketch::default() });
    (network, plan)
}

/// A schedule of [`TEXT`] with some events at other times.
fn violations(others: &[(&str, i64)]) -> Vec<Violation> {
    let (network, plan) = good();
    let mut times = earliest_schedule(&plan);
    let merge = network.nodes[event(&network, "A#1.end").index()].out_arcs[0];
    let merge = network.arcs[merge.index()].to.index();
    let base = [
        ("delay#3.end", 2),
        ("D#1.start", 2),
        ("D#1.end", 4),
        ("Tell(V=X)#1.start", 0),
        ("Tell(V=X)#1.end", 4),
        ("delay#5.end", 5),
        ("Tell(V=Y)#1.start", 5),
        ("Tell(V=Y)#1.end", 7),
        ("scenario#1.end", 40),
    ];
    for &(name, at) in base.iter().chain(others) {
        times[event(&network, name).index()] = Some(time(at));
    }
    times[merge] = times[event(&network, "A#1.end").index()];
    let verdict = check_schedule(&network, &plan, &times);
    assert_eq!(verdict.valid, verdict.violations.is_empty());
    verdict.violations
}

#[track_caller]
fn only(found: &[Violation], rule: Rule, names: &[&str], words: &str) {
    let [violation] = found else { panic!("not one violation: {found:#?}") };
    let about: Vec<&str> = violation.events.iter().chain(&violation.intervals).map(String::as_str).collect();
    assert_eq!((violation.rule, about.as_slice()), (rule, names), "{violation:?}");
    assert!(violation.message.contains(words), "{violation:?}");
}

#[test]
fn a_schedule_that_keeps_all_rules_is_accepted() {
    assert_eq!(violations(&[]), []);
    // At the other ends of the durations, inside the other assertion of c.
    let later = [
        ("A#1.end", 5),
        ("delay#3.end", 17),
        ("D#1.start", 17),
        ("D#1.end", 20),
        ("Tell(V=X)#1.end", 5),
        ("scenario#1.end", 21),
    ];
    assert_eq!(violations(&later), []);
}

#[test]
fn every_selected_event_has_one_time() {
    let (network, plan) = good();
    let times = earliest_schedule(&plan);
    let short = check_schedule(&network, &plan, &times[1..]);
    only(&short.violations, Rule::Form, &[], "its nodes differ");
    let mut missing = times.clone();
    missing[event(&network, "D#1.end").index()] = None;
    only(&check_schedule(&network, &plan, &missing).violations, Rule::Form, &["D#1.end"], "has no time");
}

/// A schedule is one of a selection: leaving activities out does not make it valid.
#[test]
fn what_is_scheduled_is_a_whole_selection() {
    let (network, plan) = good();
    let times = earliest_schedule(&plan);
    let rules = |plan: &Plan| {
        let verdict = check_schedule(&network, plan, &times);
        verdict.violations.iter().map(|it| it.rule).collect::<Vec<_>>()
    };
    // D is left out, and with it what it requires.
    let mut without = plan.clone();
    let (start, end) = (event(&network, "D#1.start"), event(&network, "D#1.end"));
    for (index, arc) in network.arcs.iter().enumerate() {
        if arc.from == start && arc.to == end {
            without.selected_arcs[index] = false;
        }
    }
    assert!(rules(&without).contains(&Rule::Selection), "{:?}", rules(&without));
    let mut nothing = plan.clone();
    nothing.selected_arcs.fill(false);
    nothing.selected_nodes.fill(false);
    assert!(rules(&nothing).contains(&Rule::Selection));
    let mut undecided = plan.clone();
    undecided.choices.clear();
    assert!(rules(&undecided).contains(&Rule::Selection));
}

#[test]
fn durations_stay_within_their_bounds() {
    let named = ["A#1.start", "A#1.end"];
    only(&violations(&[("A#1.end", 6)]), Rule::Duration, &named, "is 6, outside [3,5]");
    only(&violations(&[("A#1.end", 2)]), Rule::Duration, &named, "is 2, outside [3,5]");
    assert_eq!(violations(&[("A#1.end", 3)]), []);
    only(&violations(&[("A#1.end", -1)]), Rule::Duration, &named, "is -1, outside [3,5]");
    let late = violations(&[("scenario#1.end", 41)]);
    only(&late, Rule::Duration, &["scenario#1.start", "scenario#1.end"], "is 41, outside [0,40]");
    // A sequence never idles.
    let idle = violations(&[("Tell(c)#1.end", 12)]);
    let spans: Vec<&str> = idle.iter().map(|it| it.events[0].as_str()).collect();
    assert_eq!(spans, ["delay#1.end", "Tell(c)#1.end"], "{idle:#?}");
    assert!(idle.iter().all(|it| it.rule == Rule::Duration), "{idle:#?}");
}

#[test]
fn times_that_are_too_far_apart_are_refused() {
    let (network, plan) = good();
    let mut times = earliest_schedule(&plan);
    times[event(&network, "scenario#1.start").index()] = Some(time(i64::MIN));
    let verdict = check_schedule(&network, &plan, &times);
    assert!(
        verdict.violations.iter().any(|it| it.message.contains("too long to represent exactly")),
        "{verdict:#?}"
    );
}

#[test]
fn requirements_lie_inside_one_assertion() {
    let at =
        |start: i64, end: i64| violations(&[("delay#3.end", start), ("D#1.start", start), ("D#1.end", end)]);
    // c holds during [2,11] and [12,21].
    for (start, end) in [(2, 4), (9, 11), (8, 11), (12, 14), (19, 21)] {
        assert_eq!(at(start, end), [], "[{start},{end}]");
    }
    // Before, across the gap between the two, and after.
    for (start, end) in [(0, 2), (1, 3), (9, 12), (10, 12), (11, 13), (19, 22), (30, 32)] {
        only(&at(start, end), Rule::Support, &["Ask(c)@D#1"], "not inside an assertion");
    }
}

#[test]
fn conflicting_intervals_do_not_overlap() {
    let names = ["Tell(V=X)@Tell(V=X)#1", "Tell(V=Y)@Tell(V=Y)#1"];
    let at = |start: i64| {
        violations(&[("delay#5.end", start), ("Tell(V=Y)#1.start", start), ("Tell(V=Y)#1.end", start + 2)])
    };
    // V=X holds during [0,4]; touching is not an overlap.
    assert_eq!(at(4), []);
    assert_eq!(at(5), []);
    for start in 0..4 {
        only(&at(start), Rule::Conflict, &names, "hold at the same time");
    }
}

/// The verdict on three intervals of c beside each other: an instant, an interval, and an instant of the opposite.
fn instants(gap: i64, at: i64, [from, to]: [i64; 2], other: i64) -> Vec<Violation> {
    let text = format!(
        "option threat_gap = {gap};
        scenario S = {{ {{ delay; c }}, {{ delay; not c [0,5] }}, {{ delay; not c }} }}"
    );
    let network = network(&text);
    let plan = plan(&network, Sketch::default());
    let mut times: Vec<Option<Time>> = vec![Some(time(0)); network.nodes.len()];
    for (name, units) in [
        ("delay#1.end", at),
        ("Tell(c)#1.start", at),
        ("Tell(c)#1.end", at),
        ("delay#2.end", from),
        ("Tell(not(c))#1.start", from),
        ("Tell(not(c))#1.end", to),
        ("delay#3.end", other),
        ("Tell(not(c))#2.start", other),
        ("Tell(not(c))#2.end", other),
        ("scenario#1.end", 100),
    ] {
        times[event(&network, name).index()] = Some(time(units));
    }
    check_schedule(&network, &plan, &times).violations
}

#[test]
fn an_instant_lies_outside_what_it_conflicts_with() {
    let (instant, interval, other) =
        ("Tell(c)@Tell(c)#1", "Tell(not(c))@Tell(not(c))#1", "Tell(not(c))@Tell(not(c))#2");
    assert_eq!(instants(1, 9, [10, 15], 20), []);
    assert_eq!(instants(1, 15, [10, 15], 20), [], "at the end, which is outside");
    for at in [10, 12, 14] {
        only(&instants(1, at, [10, 15], 20), Rule::Conflict, &[instant, interval], "at the same time");
    }
    only(&instants(1, 20, [10, 15], 20), Rule::Conflict, &[instant, other], "at the same time");
}

/// With gap 0 one ends no later than the other starts: an instant may be at the start, and at another instant, but what
/// has no length may not lie inside.
#[test]
fn without_a_gap_touching_is_allowed_everywhere() {
    let (instant, interval) = ("Tell(c)@Tell(c)#1", "Tell(not(c))@Tell(not(c))#1");
    for at in [9, 10, 15, 20] {
        assert_eq!(instants(0, at, [10, 15], 20), [], "at {at}");
    }
    for at in [11, 14] {
        only(&instants(0, at, [10, 15], 20), Rule::Conflict, &[instant, interval], "at the same time");
    }
    // Both of them without length, at the same time.
    assert_eq!(instants(0, 10, [10, 10], 20), []);
}

/// An interval whose length may be zero and is zero, inside another: with a gap the rule is that of intervals, which do
/// not overlap; without one it is that of ends and starts.
#[test]
fn an_interval_that_happens_to_have_no_length() {
    let verdict = |gap: i64, at: i64| {
        let network = network(&format!(
            "option threat_gap = {gap}; scenario S[0,20] = {{ c [5,5], {{ delay; not c [0,3] }} }}"
        ));
        let plan = plan(&network, Sketch::default());
        let mut times = earliest_schedule(&plan);
        for (name, units) in [
            ("delay#1.end", at),
            ("Tell(not(c))#1.start", at),
            ("Tell(not(c))#1.end", at),
            ("scenario#1.end", 10),
        ] {
            times[event(&network, name).index()] = Some(time(units));
        }
        check_schedule(&network, &plan, &times).violations
    };
    let names = ["Tell(c)@Tell(c)#1", "Tell(not(c))@Tell(not(c))#1"];
    for at in [0, 5, 7] {
        assert_eq!(verdict(0, at), [], "at {at}");
    }
    for at in [1, 4] {
        only(&verdict(0, at), Rule::Conflict, &names, "at the same time");
    }
    for at in 0..=7 {
        assert_eq!(verdict(1, at), [], "at {at}");
    }
}

#[test]
fn labels_of_one_arc_that_conflict_never_have_a_schedule() {
    let network = network("scenario S[0,9] = { do c [0,3] watching c }");
    let plan = plan(&network, Sketch::default());
    let verdict = check_schedule(&network, &plan, &earliest_schedule(&plan));
    only(&verdict.violations, Rule::Conflict, &["Tell(c)@Tell(c)#1", "Tell(not(c))@Tell(c)#1"], "same time");
}
