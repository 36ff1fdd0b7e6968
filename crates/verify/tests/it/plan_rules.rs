//! Each rule of the check of plans (SPEC 5.5): a plan that keeps it, and what is said of plans that break it.

use exact::{Bound, Time};
use serde_json::json;
use tpn::plan_json::{PlanError, plan_from_json, plan_to_json};
use tpn::{CausalLink, Choice, DecisionId, LabelId, Network, NodeId, Ordering, Plan, Window};
use verify::{Rule, Violation, check_plan};

use crate::missions::{Sketch, event, label, network, plan, time, windows};

/// A choice, an Ask of `c` beside two Tells of it, and two values of V that conflict.
const TEXT: &str = "scenario S[0,40] = { choose { A()[3,5], B()[4,6] },
    { delay[2,2]; c [9,9]; delay[1,1]; c [9,9] }, { delay[0,inf]; do D()[2,3] maintaining c },
    { delay[0,inf]; V=X [4,5] }, { delay[0,inf]; V=Y [2,2] } }";

const ASK: &str = "Ask(c)@D#1";
const TELL: &str = "Tell(c)@Tell(c)#1";
const X: &str = "Tell(V=X)@Tell(V=X)#1";
const Y: &str = "Tell(V=Y)@Tell(V=Y)#1";

const GOOD: Sketch<'static> =
    Sketch { choices: &[(1, 0)], links: &[(ASK, TELL)], order: &[(X, Y)], states: &[], added: &[(X, Y)] };

fn good() -> (Network, Plan) {
    let network = network(TEXT);
    let plan = plan(&network, GOOD);
    (network, plan)
}

fn violations(network: &Network, plan: &Plan) -> Vec<Violation> {
    let verdict = check_plan(network, plan);
    assert_eq!(verdict.valid, verdict.violations.is_empty());
    verdict.violations
}

/// Returns what is said of the good plan after `change`.
fn changed(change: impl FnOnce(&Network, &mut Plan)) -> Vec<Violation> {
    let (network, mut plan) = good();
    change(&network, &mut plan);
    violations(&network, &plan)
}

/// Returns what is said of a plan of [`TEXT`].
fn said_of(sketch: Sketch<'_>) -> Vec<Violation> {
    let network = network(TEXT);
    violations(&network, &plan(&network, sketch))
}

/// Exactly one violation, of this rule, about these events and intervals, whose message has these words.
#[track_caller]
fn only(found: &[Violation], rule: Rule, names: &[&str], words: &str) {
    let [violation] = found else { panic!("not one violation: {found:#?}") };
    has(violation, rule, names, words);
}

#[track_caller]
fn has(violation: &Violation, rule: Rule, names: &[&str], words: &str) {
    assert_eq!(violation.rule, rule, "{violation:?}");
    let about: Vec<&str> = violation.events.iter().chain(&violation.intervals).map(String::as_str).collect();
    assert_eq!(about, names, "{violation:?}");
    assert!(violation.message.contains(words), "{violation:?}");
}

#[track_caller]
fn any(found: &[Violation], rule: Rule, words: &str) {
    let is_there = found.iter().any(|it| it.rule == rule && it.message.contains(words));
    assert!(is_there, "no {rule:?} says “{words}”: {found:#?}");
}

#[test]
fn plans_that_keep_all_rules_are_accepted() {
    assert_eq!(violations(&good().0, &good().1), []);
    // The other alternative, the other Tell, the other order.
    let others = Sketch {
        choices: &[(1, 1)],
        links: &[(ASK, "Tell(c)@Tell(c)#2")],
        order: &[(Y, X)],
        states: &[],
        added: &[(Y, X)],
    };
    assert_eq!(said_of(others), []);
}

#[test]
fn the_plan_of_the_enroute_mission_has_the_published_windows() {
    let text = include_str!("../../../../tests/conformance/t01_enroute_scenario.rmpl");
    let network = network(text);
    let (wait, proceed) = ("Tell(not(PROCEED=OK))@Group-Wait#1", "Tell(PROCEED=OK)@Tell(PROCEED=OK)#1");
    let good = plan(
        &network,
        Sketch {
            choices: &[(1, 0)],
            links: &[("Ask(PATH1=OK)@Group-Traverse-Path#1", "Tell(PATH1=OK)@Tell(PATH1=OK)#1")],
            order: &[(wait, proceed)],
            states: &[],
            added: &[(wait, proceed)],
        },
    );
    assert_eq!(violations(&network, &good), []);
    // The table of SPEC 3.6.
    let windows = &plan_to_json(&network, &good)["windows"];
    for (event, window) in [
        ("Group-Enroute#1.start", json!([10, 55])),
        ("Group-Traverse-Path#1.end", json!([415, 460])),
        ("Group-Wait#1.end", json!([415, 514])),
        ("Group-Transmit#1.end", json!([415, 462])),
        ("Group-Enroute#1.end", json!([460, 595])),
        ("Tell(PROCEED=OK)#1.start", json!([460, 600])),
        ("scenario#1.end", json!([660, 800])),
    ] {
        assert_eq!(windows[event], window, "{event}");
    }
}

#[test]
fn a_plan_of_another_network_is_refused_before_it_is_looked_at() {
    let refused = |change: fn(&mut Plan), words: &str| {
        only(&changed(|_, plan| change(plan)), Rule::Form, &[], words);
    };
    refused(|plan| plan.selected_nodes.truncate(3), "its nodes differ");
    refused(|plan| plan.selected_arcs.push(true), "its arcs differ");
    refused(|plan| plan.windows.clear(), "one window for each node");
    refused(|plan| plan.causal_links[0].tell = LabelId(99), "unknown interval");
    refused(|plan| plan.causal_links[0].ask = LabelId(u32::MAX), "unknown interval");
    refused(|plan| plan.conflict_order[0].then = LabelId(99), "unknown interval");
    refused(|plan| plan.orderings_added[0].first = LabelId(99), "unknown interval");
    let stray = |plan: &mut Plan| plan.choices.push(Choice { decision: DecisionId(7), alternative: 0 });
    refused(stray, "unknown decision");
}

#[test]
fn names_that_the_network_does_not_have_make_no_plan() {
    let (network, plan) = good();
    let written = plan_to_json(&network, &plan);
    let read = plan_from_json(&network, &written).expect("its own names");
    assert_eq!(violations(&network, &read), []);
    assert_eq!(plan_to_json(&network, &read), written);
    for (pointer, name, kind) in [
        ("/causal_links/0/ask", "Ask(c)@D#2", "labeled interval"),
        ("/causal_links/0/tell", "Tell(c)", "labeled interval"),
        ("/conflict_order/0/0", "", "labeled interval"),
        ("/orderings_added/0/1", "Tell(V=Y)@Tell(V=Y)#01", "labeled interval"),
    ] {
        let mut wrong = written.clone();
        *wrong.pointer_mut(pointer).expect("it is there") = json!(name);
        let unknown = PlanError::Unknown { kind, name: name.to_owned() };
        assert_eq!(plan_from_json(&network, &wrong), Err(unknown), "{pointer}");
    }
    for (member, wrong_member) in [
        ("choices", json!({"D2": 0})),
        ("choices", json!({"D0": 0})),
        ("choices", json!({"D1": 9})),
        ("choices", json!({"D1": -1})),
        ("choices", json!({"A": 0})),
        ("windows", json!({"A#1.middle": [0, 1]})),
        ("windows", json!({"A#1.end": [1]})),
        ("windows", json!({"A#1.end": ["1/0", 2]})),
        ("causal_links", json!([[ASK, TELL]])),
        ("conflict_order", json!([[X, Y, X]])),
    ] {
        let mut wrong = written.clone();
        wrong[member] = wrong_member;
        // Read or not, it does not pass.
        let accepted = plan_from_json(&network, &wrong).is_ok_and(|plan| check_plan(&network, &plan).valid);
        assert!(!accepted, "{member}: {}", wrong[member]);
    }
}

#[test]
fn choices_are_made_exactly_where_decisions_are_reached() {
    any(
        &changed(|_, plan| plan.choices.clear()),
        Rule::Selection,
        "the plan reaches D1, but does not decide it",
    );
    any(&changed(|_, plan| plan.choices[0].alternative = 2), Rule::Selection, "D1 has no alternative 2");
    let twice = changed(|_, plan| plan.choices.push(plan.choices[0]));
    only(&twice, Rule::Selection, &[], "the plan decides D1 twice");
    let both = Choice { decision: DecisionId(0), alternative: 1 };
    any(&changed(|_, plan| plan.choices.push(both)), Rule::Selection, "the plan decides D1 twice");
    // Another alternative than the one that is selected.
    let other = changed(|_, plan| plan.choices[0].alternative = 1);
    any(&other, Rule::Selection, "A#1.start is selected, but no selected arc leads to it");
    any(&other, Rule::Selection, "B#1.start follows from the plan's choices, but is not selected");
    // A decision inside an alternative that is not taken.
    let network = network("scenario S = { choose { A(), { choose { B(), C() } } } }");
    let good = plan(&network, Sketch { choices: &[(1, 0)], ..Sketch::default() });
    assert_eq!(violations(&network, &good), []);
    let more = plan(&network, Sketch { choices: &[(1, 0), (2, 0)], ..Sketch::default() });
    only(&violations(&network, &more), Rule::Selection, &[], "the plan decides D2, but never reaches it");
}

#[test]
fn every_node_and_arc_that_is_selected_or_left_out_wrongly_is_named() {
    let (network, good) = good();
    let name = |node: NodeId| tpn::plan_json::node_name(&network, node);
    for index in 0..network.arcs.len() {
        let mut wrong = good.clone();
        wrong.selected_arcs[index] = !wrong.selected_arcs[index];
        let found = violations(&network, &wrong);
        // A label that was on the arc is missed, too.
        let (selection, others): (Vec<_>, Vec<_>) = found.iter().partition(|it| it.rule == Rule::Selection);
        assert!(others.iter().all(|it| it.rule == Rule::Support), "arc {index}: {found:#?}");
        let [violation] = &selection[..] else { panic!("arc {index}: {found:#?}") };
        let words = if good.selected_arcs[index] {
            "is not selected"
        } else {
            "does not follow from the plan's choices"
        };
        assert!(violation.message.contains(words), "{violation:?}");
        let arc = &network.arcs[index];
        for (event, node) in violation.events.iter().zip([arc.from, arc.to]) {
            assert!(network.nodes[node.index()].events.is_empty() || *event == name(node), "{violation:?}");
        }
    }
    for index in 0..network.nodes.len() {
        let mut wrong = good.clone();
        wrong.selected_nodes[index] = !wrong.selected_nodes[index];
        let found = violations(&network, &wrong);
        let [violation] = &found[..] else { panic!("node {index}: {found:#?}") };
        let words =
            if good.selected_nodes[index] { "is not selected" } else { "no selected arc leads to it" };
        assert_eq!(violation.rule, Rule::Selection);
        assert!(violation.message.contains(words), "{violation:?}");
    }
}

#[test]
fn arcs_of_another_alternative_do_not_belong_to_a_plan() {
    let found = changed(|network, plan| {
        plan.selected_arcs[network.decisions[0].alternatives[1].index()] = true;
    });
    let [violation] = &found[..] else { panic!("{found:#?}") };
    assert_eq!((violation.rule, violation.events[1].as_str()), (Rule::Selection, "B#1.start"));
}

#[test]
fn the_end_must_be_reached() {
    let (mut network, plan) = good();
    network.end = event(&network, "B#1.end");
    any(&violations(&network, &plan), Rule::Selection, "the end B#1.end is not selected");
}

#[test]
fn an_activity_without_its_body_is_not_expanded() {
    let text = "Act() = { A()[1,2] } scenario S[0,9] = { Act(), C() }";
    let mut network = network(text);
    assert_eq!(violations(&network, &plan(&network, Sketch::default())), []);
    let start = event(&network, "Act#1.start");
    let arcs = network.arcs.clone();
    network.nodes[start.index()].out_arcs.retain(|arc| arcs[arc.index()].kind == tpn::ArcKind::Composite);
    let mut headless = plan(&network, Sketch::default());
    // Of what is left, all is selected that an arc leads to.
    let body = event(&network, "A#1.start");
    for (index, arc) in network.arcs.iter().enumerate() {
        let is_body = arc.to == body || arc.from == body || arc.from == event(&network, "A#1.end");
        if is_body {
            headless.selected_arcs[index] = false;
        }
    }
    for node in [body, event(&network, "A#1.end")] {
        headless.selected_nodes[node.index()] = false;
        headless.windows[node.index()] = None;
    }
    let found = violations(&network, &headless);
    any(&found, Rule::Selection, "the activity that starts at Act#1.start is not expanded");
    assert!(found.iter().all(|it| it.events == ["Act#1.start"]), "{found:#?}");
}

#[test]
fn a_requirement_has_exactly_one_link_to_a_tell_that_supports_it() {
    only(&said_of(Sketch { links: &[], ..GOOD }), Rule::Support, &[ASK], "has no causal link");
    let twice = Sketch { links: &[(ASK, TELL), (ASK, "Tell(c)@Tell(c)#2")], ..GOOD };
    only(&said_of(twice), Rule::Support, &[ASK], "has 2 causal links");
    only(
        &said_of(Sketch { links: &[(ASK, TELL), (ASK, TELL)], ..GOOD }),
        Rule::Support,
        &[ASK],
        "has 2 causal links",
    );
    let other = Sketch { links: &[(ASK, X)], ..GOOD };
    only(&said_of(other), Rule::Support, &[ASK, X], "does not make the requirement hold");
    // The two ends exchanged, which leaves the requirement without a link.
    let turned = said_of(Sketch { links: &[(TELL, ASK)], ..GOOD });
    has(&turned[0], Rule::Support, &[TELL, ASK], "from an assertion to a requirement");
    has(&turned[1], Rule::Support, &[ASK], "has no causal link");
    let tells = said_of(Sketch { links: &[(ASK, TELL), (X, X)], ..GOOD });
    only(&tells, Rule::Support, &[X, X], "from an assertion to a requirement");
    let itself = said_of(Sketch { links: &[(ASK, ASK)], ..GOOD });
    only(&itself, Rule::Support, &[ASK, ASK], "from an assertion to a requirement");
}

#[test]
fn links_join_what_the_plan_selects() {
    let network =
        network("scenario S[0,20] = { choose { c [9,9], do B()[1,1] maintaining c }, { ask c }, c [0,5] }");
    let (ask, chosen, beside) = ("Ask(c)@ask(c)#1", "Tell(c)@Tell(c)#1", "Tell(c)@Tell(c)#2");
    let names: Vec<String> =
        (0..network.labels.len()).map(|label| network.label_name(LabelId::from_index(label))).collect();
    let ask =
        names.iter().find(|name| name.starts_with("Ask(c)@") && *name != "Ask(c)@B#1").map_or(ask, |it| it);
    let said = |choices: &[(u32, u32)], links: &[(&str, &str)]| {
        violations(&network, &plan(&network, Sketch { choices, links, ..Sketch::default() }))
    };
    assert_eq!(said(&[(1, 0)], &[(ask, chosen)]), []);
    assert_eq!(said(&[(1, 1)], &[(ask, beside), ("Ask(c)@B#1", beside)]), []);
    // To a Tell of an alternative that is not taken.
    let found = said(&[(1, 1)], &[(ask, chosen), ("Ask(c)@B#1", beside)]);
    only(&found, Rule::Support, &[ask, chosen], "does not select");
    // Of an Ask that is not taken.
    let found = said(&[(1, 0)], &[(ask, chosen), ("Ask(c)@B#1", beside)]);
    only(&found, Rule::Support, &["Ask(c)@B#1", beside], "does not select");
}

#[test]
fn a_tell_that_cannot_contain_the_requirement_is_a_contradiction() {
    // The first c is over at 11, and D cannot start before 12.
    let text = TEXT.replace("{ delay[0,inf]; do D()", "{ delay[12,inf]; do D()");
    let network = network(&text);
    let good = plan(&network, Sketch { links: &[(ASK, "Tell(c)@Tell(c)#2")], ..GOOD });
    assert_eq!(violations(&network, &good), []);
    let found = violations(&network, &plan(&network, Sketch { links: &[(ASK, TELL)], ..GOOD }));
    let [violation] = &found[..] else { panic!("{found:#?}") };
    assert_eq!(violation.rule, Rule::Temporal);
    assert!(violation.message.contains(&format!("{ASK} must be inside {TELL}")), "{violation:?}");
    assert!(violation.message.contains("takes [12,inf]"), "{violation:?}");
    assert!(violation.events.iter().any(|event| event == "D#1.end"), "{violation:?}");
    // It may hold longer than the assertion.
    let longer = TEXT.replace("do D()[2,3]", "do D()[9.5,10]");
    let longer = crate::missions::network(&longer);
    let found = violations(&longer, &plan(&longer, GOOD));
    any(&found, Rule::Temporal, "to D#1.end takes [9.5,10]");
}

#[test]
fn orderings_that_go_round_in_a_cycle_contradict_each_other() {
    let round = said_of(Sketch { added: &[(X, Y), (Y, X)], ..GOOD });
    let [violation] = &round[..] else { panic!("{round:#?}") };
    assert_eq!(violation.rule, Rule::Temporal);
    for order in [format!("{X} must come before {Y}"), format!("{Y} must come before {X}")] {
        assert!(violation.message.contains(&order), "{violation:?}");
    }
    // An interval before itself.
    any(
        &said_of(Sketch { added: &[(X, Y), (X, X)], ..GOOD }),
        Rule::Temporal,
        &format!("{X} must come before {X}"),
    );
}

#[test]
fn a_horizon_that_is_too_short_is_named() {
    let network = network(&TEXT.replace("S[0,40]", "S[0,20]"));
    let found = violations(&network, &plan(&network, GOOD));
    any(&found, Rule::Temporal, "takes [0,20]");
    assert_eq!(found.len(), 1);
}

#[test]
fn the_order_of_a_conflict_is_said_once_and_holds() {
    let unsaid = said_of(Sketch { order: &[], added: &[], ..GOOD });
    only(&unsaid, Rule::Conflict, &[X, Y], "does not say which of");
    let both = said_of(Sketch { order: &[(X, Y), (Y, X)], ..GOOD });
    only(&both, Rule::Conflict, &[X, Y], "ordered in both directions");
    let loose = said_of(Sketch { added: &[], ..GOOD });
    only(&loose, Rule::Conflict, &[X, Y], "may overlap");
    let turned = said_of(Sketch { order: &[(Y, X)], ..GOOD });
    only(&turned, Rule::Conflict, &[Y, X], "may overlap");
    let no_conflict = said_of(Sketch { order: &[(X, Y), (TELL, ASK)], ..GOOD });
    only(&no_conflict, Rule::Conflict, &[TELL, ASK], "do not conflict or are not selected");
    // Added, and said of no conflict.
    let later = "Tell(c)@Tell(c)#2";
    let unsaid = said_of(Sketch { added: &[(X, Y), (TELL, later)], ..GOOD });
    only(&unsaid, Rule::Conflict, &[TELL, later], "but the plan's conflict order lacks this pair");
}

#[test]
fn an_order_of_intervals_that_are_not_selected_is_refused() {
    let network = network("scenario S[0,20] = { choose { c [1,1], d [1,1] }, { delay[5,5]; not c [1,1] } }");
    let (c, not_c) = ("Tell(c)@Tell(c)#1", "Tell(not(c))@Tell(not(c))#1");
    let said = |choices: &[(u32, u32)], order: &[(&str, &str)]| {
        violations(&network, &plan(&network, Sketch { choices, order, ..Sketch::default() }))
    };
    assert_eq!(said(&[(1, 0)], &[(c, not_c)]), []);
    assert_eq!(said(&[(1, 1)], &[]), []);
    only(&said(&[(1, 1)], &[(c, not_c)]), Rule::Conflict, &[c, not_c], "are not selected");
}

#[test]
fn labels_of_one_arc_cannot_conflict() {
    let network = network("scenario S[0,9] = { do c [2,3] watching c }");
    let (asserted, watched) = ("Tell(c)@Tell(c)#1", "Tell(not(c))@Tell(c)#1");
    for order in [&[][..], &[(asserted, watched)], &[(watched, asserted)]] {
        let found = violations(&network, &plan(&network, Sketch { order, ..Sketch::default() }));
        only(&found, Rule::Conflict, &[asserted, watched], "are on the same arc");
    }
}

#[test]
fn asks_conflict_like_tells() {
    let text =
        "scenario S[0,30] = { { delay; do A()[2,2] maintaining c }, { delay; do B()[2,2] maintaining not c },
        { c [10,10]; not c [10,10] } }";
    let network = network(text);
    let (a, b) = ("Ask(c)@A#1", "Ask(not(c))@B#1");
    let (c, not_c) = ("Tell(c)@Tell(c)#1", "Tell(not(c))@Tell(not(c))#1");
    let links = &[(a, c), (b, not_c)][..];
    let every: &[(&str, &str)] = &[(a, b), (a, not_c), (c, b), (c, not_c)];
    assert_eq!(
        violations(&network, &plan(&network, Sketch { links, order: every, ..Sketch::default() })),
        []
    );
    for left_out in 0..every.len() {
        let mut order = every.to_vec();
        let (one, other) = order.remove(left_out);
        let found =
            violations(&network, &plan(&network, Sketch { links, order: &order, ..Sketch::default() }));
        assert_eq!(found.len(), 1, "{found:#?}");
        assert_eq!(found[0].rule, Rule::Conflict);
        assert!([one, other].iter().all(|name| found[0].intervals.iter().any(|it| it == name)), "{found:#?}");
    }
}

/// Touching is before, except behind an instant, which needs the gap (SPEC 5.3).
#[test]
fn intervals_may_touch_and_instants_only_without_a_gap() {
    let cases = [
        // First, then, and whether the order holds with a gap of 1 and of 0.
        ("c [5,5]; not c [5,5]", "Tell(c)@Tell(c)#1", "Tell(not(c))@Tell(not(c))#1", true, true),
        ("not c [5,5]; c", "Tell(not(c))@Tell(not(c))#1", "Tell(c)@Tell(c)#1", true, true),
        ("c; not c [5,5]", "Tell(c)@Tell(c)#1", "Tell(not(c))@Tell(not(c))#1", false, true),
        ("c; not c", "Tell(c)@Tell(c)#1", "Tell(not(c))@Tell(not(c))#1", false, true),
        ("c; delay[1,1]; not c", "Tell(c)@Tell(c)#1", "Tell(not(c))@Tell(not(c))#1", true, true),
        ("c [0,1]; not c", "Tell(c)@Tell(c)#1", "Tell(not(c))@Tell(not(c))#1", true, true),
    ];
    for (body, first, then, with_gap, without) in cases {
        for (gap, expected) in [(1, with_gap), (0, without)] {
            let network = network(&format!("option threat_gap = {gap}; scenario S[0,20] = {{ {body} }}"));
            let found = violations(
                &network,
                &plan(&network, Sketch { order: &[(first, then)], ..Sketch::default() }),
            );
            if expected {
                assert_eq!(found, [], "{body}, gap {gap}");
            } else {
                only(&found, Rule::Conflict, &[first, then], "may overlap");
            }
        }
    }
}

#[test]
fn an_added_ordering_keeps_the_gap_of_the_mission() {
    for (gap, earliest) in [("0", time(4)), ("1", time(5)), ("2.5", Time::new(13, 2).expect("a fraction"))] {
        let network = network(&format!("option threat_gap = {gap}; {TEXT}"));
        let good = plan(&network, GOOD);
        assert_eq!(violations(&network, &good), []);
        let start = event(&network, "Tell(V=Y)#1.start").index();
        assert_eq!(good.windows[start].map(|window| window.earliest), Some(earliest), "gap {gap}");
    }
}

#[test]
fn every_window_is_checked_at_both_sides() {
    let (network, good) = good();
    for node in 0..network.nodes.len() {
        let Some(window) = good.windows[node] else { continue };
        let moved = |time: Time, thirds: i64| {
            let moved = Time::new(thirds, 3).and_then(|thirds| time.checked_add(thirds));
            moved.expect("a small time")
        };
        let Bound::Finite(latest) = window.latest else { panic!("the horizon bounds every event") };
        let wrong_windows = [
            Window { earliest: moved(window.earliest, -1), ..window },
            Window { earliest: moved(window.earliest, 1), ..window },
            Window { latest: Bound::Finite(moved(latest, -1)), ..window },
            Window { latest: Bound::Finite(moved(latest, 1)), ..window },
            Window { latest: Bound::Infinite, ..window },
        ];
        let name = network.nodes[node].events.first().map(|&event| network.event_name(event));
        for wrong_window in wrong_windows {
            let mut wrong = good.clone();
            wrong.windows[node] = Some(wrong_window);
            let found = violations(&network, &wrong);
            assert_eq!(found.len(), 1, "node {node}: {found:#?}");
            assert_eq!(found[0].rule, Rule::Window);
            assert!(name.is_none() || found[0].events == name.as_slice(), "{found:#?}");
        }
        // Plans that are read back have windows only where events have names.
        let mut absent = good.clone();
        absent.windows[node] = None;
        assert_eq!(violations(&network, &absent).len(), usize::from(name.is_some()), "node {node}");
    }
    let unselected = event(&network, "B#1.start").index();
    let found = changed(|_, plan| plan.windows[unselected] = plan.windows[0]);
    only(&found, Rule::Window, &["B#1.start"], "is absent, not [0,0]");
}

#[test]
fn an_event_without_a_bound_has_an_infinite_window() {
    let network = network("scenario S = { A() }");
    let good = plan(&network, Sketch::default());
    assert_eq!(violations(&network, &good), []);
    let end = network.end.index();
    let mut wrong = good.clone();
    wrong.windows[end] = Some(Window { earliest: time(0), latest: Bound::Finite(time(1_000_000)) });
    only(&violations(&network, &wrong), Rule::Window, &["scenario#1.end"], "[0,inf], not [0,1000000]");
}

#[test]
fn bounds_that_cannot_be_checked_exactly_are_refused() {
    let (mut network, plan) = good();
    // Five primes of nine digits have no common denominator that fits.
    for (arc, prime) in
        [999_999_937, 999_999_929, 999_999_893, 999_999_883, 999_999_797].into_iter().enumerate()
    {
        network.arcs[arc].lower = Time::new(1, prime).expect("a fraction");
    }
    only(&violations(&network, &plan), Rule::Form, &[], "too large");
}

#[test]
fn the_largest_bounds_do_not_overflow() {
    // A horizon near the greatest number, and an ordering that goes round it.
    let mut network = network(TEXT);
    for arc in &mut network.arcs {
        if arc.upper == Bound::Finite(time(40)) {
            arc.upper = Bound::Finite(time(i64::MAX));
        }
    }
    let mut round = plan(&crate::missions::network(TEXT), GOOD);
    assert!(violations(&network, &round).iter().all(|it| it.rule == Rule::Window));
    round.orderings_added.push(Ordering { first: label(&network, Y), then: label(&network, X) });
    any(&violations(&network, &round), Rule::Temporal, "are inconsistent");
}

/// Every way to link and order the intervals of a plan wrongly by one entry.
#[test]
fn no_other_link_or_order_of_two_labels_passes() {
    let (network, good) = good();
    let labels = || (0..network.labels.len()).map(LabelId::from_index);
    for one in labels() {
        for other in labels() {
            let link = CausalLink { ask: one, tell: other };
            let mut linked = good.clone();
            linked.causal_links = vec![link];
            linked.windows = windows(&network, &linked);
            let is_right = one == label(&network, ASK)
                && [TELL, "Tell(c)@Tell(c)#2"].iter().any(|&tell| other == label(&network, tell));
            assert_eq!(check_plan(&network, &linked).valid, is_right, "{link:?}");
            let ordering = Ordering { first: one, then: other };
            let mut ordered = good.clone();
            (ordered.conflict_order, ordered.orderings_added) = (vec![ordering], vec![ordering]);
            ordered.windows = windows(&network, &ordered);
            let pair = [label(&network, X), label(&network, Y)];
            let is_right = one != other && pair.contains(&one) && pair.contains(&other);
            assert_eq!(check_plan(&network, &ordered).valid, is_right, "{ordering:?}");
        }
    }
}
