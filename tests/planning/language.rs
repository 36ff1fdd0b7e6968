//! The language and the network sentence by sentence: SPEC 1.3 to 1.7, 2.2 of the grammar's consequences, 3 and 5, each
//! with the smallest mission that shows it. Known answers are worked out by hand in the comments.

use acceptance::mission::{all_plans, compile, error_codes, first_plan, network, warning_codes};
use exact::{Bound, Time};
use kirk::Search;
use serde_json::{Value, json};
use tpn::plan_json::plan_to_json;
use tpn::{ArcKind, Network, Role, Top};

/// The windows of the first plan, which must exist and be the same with both searches.
fn windows(text: &str) -> Value {
    plan(text)["windows"].clone()
}

fn plan(text: &str) -> Value {
    let network = network(text);
    let [one, other] = [Search::Chronological, Search::ConflictDirected].map(|search| {
        let outcome = first_plan(&network, search);
        let plan = outcome.plans.first().unwrap_or_else(|| panic!("no plan, {search:?}:\n{text}"));
        plan_to_json(&network, plan)
    });
    assert_eq!(one, other, "{text}");
    one
}

fn has_plan(text: &str) -> bool {
    let network = network(text);
    let [one, other] = [Search::Chronological, Search::ConflictDirected]
        .map(|search| !first_plan(&network, search).plans.is_empty());
    assert_eq!(one, other, "{text}");
    one
}

fn plan_count(text: &str) -> usize {
    all_plans(&network(text), Search::ConflictDirected).plans.len()
}

/// The bounds of the only arc of an occurrence, as `[lower,upper]`.
fn duration(network: &Network, occurrence: &str) -> String {
    let found = network.occurrences.iter().find(|known| known.name == occurrence);
    let found = found.unwrap_or_else(|| panic!("there is no {occurrence}"));
    let arc = &network.arcs[found.arc.expect("it has an arc").index()];
    format!("[{},{}]", Bound::Finite(arc.lower), arc.upper)
}

fn labels(network: &Network) -> Vec<String> {
    (0..network.labels.len()).map(|label| network.label_name(tpn::LabelId::from_index(label))).collect()
}

// --- 1.3 -----------------------------------------------------------------------------------------------------------

#[test]
fn a_comma_binds_tighter_than_a_semicolon() {
    let found = windows("scenario S = { A()[2,2], B()[5,5]; C()[1,1] }");
    assert_eq!((&found["B#1.start"], &found["C#1.start"]), (&json!([0, 0]), &json!([5, "inf"])));
    assert_eq!(windows("scenario S = { {A()[2,2], B()[5,5]}; C()[1,1] }"), found);
}

#[test]
fn a_comma_in_choose_always_separates_alternatives() {
    let network = network("scenario S = { choose { A(); B(), {C(), D()} } }");
    assert_eq!(network.decisions[0].alternatives.len(), 2);
}

#[test]
fn a_last_semicolon_is_no_statement() {
    let plain = network("scenario S = { A(); choose { B(), C() } }");
    for text in
        ["scenario S = { A(); choose { B();, C(); }; }", "scenario S = { A(); choose { B(), C() }; };"]
    {
        let found = network_of(text);
        assert_eq!((found.nodes.len(), found.arcs.len()), (plain.nodes.len(), plain.arcs.len()), "{text}");
    }
    assert_eq!(error_codes("scenario S = { A();; B() }"), ["E-SYNTAX"]);
}

fn network_of(text: &str) -> Network {
    network(text)
}

#[test]
fn bounds_after_if_belong_to_its_body_and_after_do_to_the_whole() {
    let guarded = network("scenario S = { if c thennext A()[2,3] }");
    assert_eq!(duration(&guarded, "A#1"), "[2,3]");
    assert!(guarded.arcs.iter().all(|arc| arc.kind != ArcKind::Span));
    let kept = network("scenario S = { do A() maintaining c [2,3] }");
    assert_eq!(duration(&kept, "A#1"), "[0,inf]");
    let spans: Vec<String> = (kept.arcs.iter())
        .filter(|arc| arc.kind == ArcKind::Span)
        .map(|arc| format!("[{},{}]", Bound::Finite(arc.lower), arc.upper))
        .collect();
    assert_eq!(spans, ["[2,3]"]);
}

#[test]
fn a_bare_name_is_a_call_where_one_exists_and_a_condition_elsewhere() {
    let network = network("primitive A()[1,2];\nB() = { A }\nscenario S = { A; B; c }");
    let names: Vec<&str> = network.occurrences.iter().map(|occurrence| occurrence.name.as_str()).collect();
    assert_eq!(names, ["scenario#1", "A#1", "B#1", "A#2", "Tell(c)#1"]);
    assert_eq!(duration(&network, "A#1"), "[1,2]");
}

#[test]
fn x_underscore_v_is_x_equals_v_only_where_x_is_known_to_have_values() {
    let text_of =
        |text: &str| network(text).labels.iter().map(|label| label.text.to_string()).collect::<Vec<_>>();
    // Declared, and V one of its values.
    assert_eq!(text_of("var P : {OK, BAD};\nscenario S = { P_OK [1,1] }"), ["P=OK"]);
    // Declared, but V no value of it: an atom of its own.
    assert_eq!(text_of("var P : {OK, BAD};\nscenario S = { P_UP [1,1] }"), ["P_UP"]);
    // Undeclared, with a literal P=… elsewhere in the file, even in an activity that is not called.
    assert_eq!(text_of("U() = { P=BAD }\nscenario S = { P_OK [1,1] }"), ["P=OK"]);
    assert_eq!(text_of("scenario S = { P_OK [1,1]; do A() watching P=X }"), ["P=OK", "not(P=X)"]);
    // Neither.
    assert_eq!(text_of("scenario S = { P_OK [1,1] }"), ["P_OK"]);
    // Split at the last underscore.
    assert_eq!(text_of("var A_B : {C, B_C};\nscenario S = { A_B_C [1,1] }"), ["A_B=C"]);
}

// --- 1.4 and 1.5 ---------------------------------------------------------------------------------------------------

#[test]
fn declared_and_called_bounds_are_intersected() {
    let network = network("primitive A()[2,8];\nscenario S = { A()[0,5]; A()[4,inf]; A() }");
    let found = ["A#1", "A#2", "A#3"].map(|name| duration(&network, name));
    assert_eq!(found, ["[2,5]", "[4,8]", "[2,8]"]);
    assert_eq!(error_codes("primitive A()[2,8];\nscenario S = { A()[9,10] }"), ["E-BOUNDS"]);
}

#[test]
fn header_names_are_bound_to_the_invocation_and_header_numbers_restrict_it() {
    let text = "Half()[l,u] = { A()[l/2,u/2] }\nWithin()[3,7] = { B() }\nMixed()[l,20] = { C()[l,l+1] }\n\
        scenario S = { Half()[4,10]; Half(); Within()[0,5]; Within(); Mixed()[6,30] }";
    let network = network(text);
    let expected = [
        ("Half#1", "[4,10]"),
        ("A#1", "[2,5]"),
        ("Half#2", "[0,inf]"),
        ("A#2", "[0,inf]"),
        ("Within#1", "[3,5]"),
        ("Within#2", "[3,7]"),
        ("Mixed#1", "[6,20]"),
        ("C#1", "[6,7]"),
    ];
    for (occurrence, bounds) in expected {
        assert_eq!(duration(&network, occurrence), bounds, "{occurrence}");
    }
    assert_eq!(error_codes("W()[3,7] = { B() }\nscenario S = { W()[8,9] }"), ["E-BOUNDS"]);
}

#[test]
fn parameters_are_substituted_in_calls_conditions_and_bare_names() {
    let text = "primitive Wave()[1,1];\n\
        Go(path, at, what) = { do Drive(at, 5) maintaining path; what; path }\n\
        scenario S = { Go(PATH1_OK, HILL, Wave), PATH1=BAD }";
    let network = network(text);
    let names: Vec<&str> = network.occurrences.iter().map(|occurrence| occurrence.name.as_str()).collect();
    assert_eq!(names, ["scenario#1", "Go#1", "Drive#1", "Wave#1", "Tell(PATH1=OK)#1", "Tell(PATH1=BAD)#1"]);
    assert_eq!(network.occurrences[2].arguments, ["HILL", "5"]);
    assert_eq!(labels(&network)[0], "Ask(PATH1=OK)@Drive#1");
}

#[test]
fn substitution_passes_through_nested_calls() {
    let text = "Outer(x) = { Inner(x) }\nInner(y) = { do A(y) watching V=y }\nscenario S = { Outer(RED) }";
    assert_eq!(labels(&network(text)), ["Tell(not(V=RED))@A#1"]);
}

#[test]
fn bounds_are_exact_rationals() {
    let text = "A()[l,u] = { B()[l*90%,u*90%] }\nscenario S = { A()[455,1000/3] }";
    assert_eq!(error_codes(text), ["E-BOUNDS"], "455 is more than 1000/3");
    let found = network("A()[l,u] = { B()[l*90%,u*90%] }\nscenario S = { A()[1000/3,455] }");
    assert_eq!(duration(&found, "B#1"), "[300,409.5]");
    let found = network(
        "scenario S = { A()[1/3+1/6,0.1*3]; A()[0,0.3] }".replace("1/3+1/6,0.1*3", "0.1*3,1/3+1/6").as_str(),
    );
    assert_eq!(duration(&found, "A#1"), "[0.3,0.5]");
    assert_eq!(windows("scenario S = { A()[1/3,1/3]; B()[1/3,1/3] }")["B#1.end"], json!(["2/3", "2/3"]));
}

#[test]
fn infinity_follows_its_rules() {
    let found =
        network("scenario S = { A()[inf*0,inf]; B()[0,inf-5]; C()[0,inf*2+1]; D()[0,inf*90%]; E()[1,∞] }");
    let durations: Vec<String> =
        ["A#1", "B#1", "C#1", "D#1", "E#1"].iter().map(|name| duration(&found, name)).collect();
    assert_eq!(durations, ["[0,inf]", "[0,inf]", "[0,inf]", "[0,inf]", "[1,inf]"]);
}

#[test]
fn bounds_that_are_none_are_refused_once() {
    for bounds in ["[5,3]", "[inf,inf]", "[0-1,3]", "[0,1/0]", "[0,5-9]", "[0,4000000000*4000000000]"] {
        assert_eq!(error_codes(&format!("scenario S = {{ A(){bounds} }}")), ["E-BOUNDS"], "{bounds}");
    }
    // Expanded twice, told once.
    assert_eq!(error_codes("A()[l,u] = { B()[u,l] }\nscenario S = { A()[1,2]; A()[3,4] }"), ["E-BOUNDS"]);
    // Wrong even where nothing calls it.
    assert_eq!(error_codes("U() = { B()[2,1] }\nscenario S = { A() }"), ["E-BOUNDS"]);
    assert_eq!(error_codes("scenario S[9,1] = { A() }"), ["E-BOUNDS"]);
}

// --- 1.6 -----------------------------------------------------------------------------------------------------------

#[test]
fn durations_without_bounds_have_their_defaults() {
    let found = network("primitive P()[1,2];\nscenario S = { A(); P(); c; ask c; delay }");
    let names = ["A#1", "P#1", "Tell(c)#1", "Ask(c)#1", "delay#1"];
    let durations = names.map(|name| duration(&found, name));
    assert_eq!(durations, ["[0,inf]", "[1,2]", "[0,0]", "[0,0]", "[0,inf]"]);
}

// --- 1.7 -----------------------------------------------------------------------------------------------------------

#[test]
fn every_error_has_its_code_and_comes_alone() {
    let cases = [
        ("scenario S = { A() @ }", "E-LEX"),
        ("scenario S = { A( }", "E-SYNTAX"),
        ("scenario S = { choose A() }", "E-SYNTAX"),
        ("scenario S = { do A() }", "E-SYNTAX"),
        ("primitive A(); primitive A(); scenario S = { A() }", "E-DUP"),
        ("var V : {X}; var V : {Y}; scenario S = { V=X }", "E-DUP"),
        ("A() = { B() } A() = { C() } scenario S = { A() }", "E-DUP"),
        ("option strict = 1; scenario S = { A() }", "E-UNDEF"),
        ("primitive A(x); scenario S = { A() }", "E-ARITY"),
        ("A(x) = { B(x) } scenario S = { A(P, Q) }", "E-ARITY"),
        ("A()[l,u] = { B()[x,u] } scenario S = { A() }", "E-NAME"),
        ("scenario S = { A()[l,5] }", "E-NAME"),
        ("A() = { B() }", "E-NOSCENARIO"),
        ("primitive A()[1,2];", "E-NOSCENARIO"),
        ("A() = { A() } scenario S = { A() }", "E-RECURSION"),
        ("A() = { choose { B(), C() } } B() = { {A(), D()} } scenario S = { X() }", "E-RECURSION"),
        ("var V : {X, Y}; scenario S = { do A() maintaining V=Z }", "E-VALUE"),
        ("var V : {X, Y}; scenario S = { not V=Z [1,2] }", "E-VALUE"),
        ("var V : {X, Y}; Go(v) = { V=v } scenario S = { Go(X); Go(Z) }", "E-VALUE"),
        ("var V : {X, Y}; Go(c) = { do A() maintaining c } scenario S = { Go(V) }", "E-VALUE"),
    ];
    for (text, code) in cases {
        assert_eq!(error_codes(text), [code], "{text}");
    }
}

#[test]
fn an_undeclared_activity_is_a_primitive_with_a_warning() {
    let text = "scenario S = { A()[1,2] }";
    assert!(error_codes(text).is_empty());
    assert!(warning_codes(text).contains(&"W-UNDEF"));
    assert_eq!(duration(&network(text), "A#1"), "[1,2]");
}

#[test]
fn circles_that_arguments_close_are_found() {
    assert_eq!(error_codes("A(f) = { f }\nB() = { A(B) }\nscenario S = { B() }"), ["E-RECURSION"]);
}

#[test]
fn expansion_that_would_never_fit_is_refused() {
    let mut text = String::from("A0() = { P(); P() }\n");
    for level in 1..40 {
        text.push_str(&format!("A{level}() = {{ A{0}(); A{0}() }}\n", level - 1));
    }
    text.push_str("scenario S = { A39() }");
    assert_eq!(error_codes(&text), ["E-LIMIT"]);
}

// --- 3.1 to 3.3 ----------------------------------------------------------------------------------------------------

#[test]
fn only_alternatives_leave_a_decision() {
    let texts = [
        "scenario S[1,9] = { choose { A(), B() } }",
        "scenario S = { choose { A(), B() }[1,9] }",
        "scenario S = { { choose { A(), B() }; C() }[1,9] }",
        "scenario S = { do choose { A(), B() } maintaining c }",
        "scenario S = { do { choose { A(), B() }[1,2] } watching c [3,4] }",
        "scenario S = { delay[1,2]; choose { delay[3,4], B() } }",
        "scenario S = { {A(), B()}; choose { choose { A(), B() }, C() } }",
        "scenario S = { if c thennext choose { A(), B() } }",
    ];
    for text in texts {
        let network = network(text);
        for node in &network.nodes {
            for &arc in &node.out_arcs {
                let is_choice = network.arcs[arc.index()].kind == ArcKind::Choice;
                assert_eq!(is_choice, node.decision.is_some(), "{text}");
            }
            assert_eq!(node.role == Role::Decision, node.decision.is_some(), "{text}");
        }
        assert_eq!(network.nodes[network.start.index()].decision, None, "{text}");
    }
}

#[test]
fn bounds_of_a_choice_hold_for_every_alternative() {
    let found = windows("scenario S = { choose { A(), B() }[3,4]; C()[1,1] }");
    assert_eq!(found["A#1.end"], json!([3, 4]));
    assert_eq!(found["C#1.end"], json!([4, 5]));
}

#[test]
fn parallel_branches_start_at_the_same_instant_and_wait_for_each_other() {
    let found = windows("scenario S = { { A()[1,2], { B()[3,4]; C()[1,1] } }; D()[0,0] }");
    assert_eq!((&found["A#1.start"], &found["B#1.start"]), (&json!([0, 0]), &json!([0, 0])));
    // Not before both are done, but perhaps later: the join may idle.
    assert_eq!(found["D#1.start"], json!([4, "inf"]));
}

#[test]
fn a_sequence_never_idles() {
    let found = windows("scenario S = { A()[1,1]; B()[2,2]; C()[3,3] }");
    assert_eq!(found["C#1.start"], json!([3, 3]));
}

#[test]
fn an_empty_block_takes_no_time() {
    let found = windows("scenario S = { A()[1,1]; {}; B()[1,1]; choose { {}, C() } }");
    assert_eq!(found["B#1.start"], json!([1, 1]));
    assert!(has_plan("scenario S = {}"));
}

#[test]
fn occurrences_are_counted_in_textual_expansion_order_over_all_alternatives() {
    let text =
        "Sub() = { A(); c }\nscenario S = { choose { {A(); Sub()}, Sub() }; A(); delay; not c; delay; c }";
    let network = network(text);
    let names: Vec<&str> = network.occurrences.iter().map(|occurrence| occurrence.name.as_str()).collect();
    let expected = [
        "scenario#1",
        "A#1",
        "Sub#1",
        "A#2",
        "Tell(c)#1",
        "Sub#2",
        "A#3",
        "Tell(c)#2",
        "A#4",
        "delay#1",
        "Tell(not(c))#1",
        "delay#2",
        "Tell(c)#3",
    ];
    assert_eq!(names, expected);
}

#[test]
fn decisions_are_numbered_in_textual_order() {
    let network = network("scenario S = { choose { choose { A(), B() }, C() }; choose { D(), E() } }");
    let firsts: Vec<String> = (network.decisions.iter())
        .map(|decision| {
            let source = decision.span.expect("it is written somewhere");
            format!("{}", source.start)
        })
        .collect();
    let mut sorted = firsts.clone();
    sorted.sort_by_key(|start| start.parse::<u32>().expect("a number"));
    assert_eq!(firsts, sorted);
    assert_eq!(network.decisions.len(), 3);
}

#[test]
fn maintaining_labels_a_single_arc_or_spans_a_composite() {
    let single = network("scenario S = { do A()[1,2] maintaining c }");
    assert_eq!((labels(&single), single.arcs.len()), (vec!["Ask(c)@A#1".to_owned()], 1));
    let composite = network("scenario S = { do { A()[1,2]; B()[3,4] } maintaining c }");
    let span = &composite.arcs[composite.labels[0].arc.index()];
    assert_eq!((span.kind, span.lower, span.upper), (ArcKind::Span, Time::ZERO, Bound::Infinite));
    assert_eq!(labels(&composite), ["Ask(c)@do#1"]);
    let instance = network("Sub() = { A(); B() }\nscenario S = { do Sub() watching c }");
    assert_eq!(labels(&instance), ["Tell(not(c))@Sub#1"]);
    let assertion = network("scenario S = { do c [5,5] maintaining d }");
    assert_eq!(labels(&assertion), ["Tell(c)@Tell(c)#1", "Ask(d)@Tell(c)#1"]);
}

#[test]
fn names_of_intervals_are_unique() {
    let text = "scenario S = { do { A(); B() } maintaining c; do { A(); B() } maintaining c; if c thennext A(); \
        if c thennext A(); do do A() maintaining c maintaining c; do {A(), B()} watching c; c; c }";
    let mut names = labels(&network(text));
    let count = names.len();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), count);
}

#[test]
fn an_if_asks_for_one_instant_before_its_body() {
    // The condition holds from 3 to 5; the guard is at the start of A, which then continues without it.
    let text = "scenario S = { { delay[0,inf]; if c thennext A()[10,10] }, { delay[3,3]; c [2,2] } }";
    assert_eq!(windows(text)["A#1.start"], json!([3, 5]));
}

#[test]
fn the_horizon_is_the_bound_on_the_scenario() {
    assert!(has_plan("scenario S[0,5] = { A()[5,9] }"));
    assert!(!has_plan("scenario S[0,4] = { A()[5,9] }"));
    assert_eq!(windows("scenario S[7,8] = { A()[1,1], B()[2,2] }")["scenario#1.end"], json!([7, 8]));
}

#[test]
fn an_activity_can_be_compiled_alone() {
    let (network, _) = compile("A(x)[l,u] = { B(x)[l,u] }", &Top::activity("A"));
    let network = network.expect("it compiles");
    assert_eq!(network.event_name(network.nodes[network.start.index()].events[0]), "A#1.start");
    assert_eq!(network.occurrences[1].arguments, ["x"]);
    let (missing, diagnostics) = compile("A() = { B() }", &Top::activity("Z"));
    assert!(missing.is_none());
    assert!(diagnostics.iter().any(|found| found.code.0 == "E-UNDEF"));
    let (missing, diagnostics) = compile("scenario S = { A() }", &Top::Scenario(Some("Z".into())));
    assert!(missing.is_none());
    assert!(diagnostics.iter().any(|found| found.code.0 == "E-NOSCENARIO"));
}

#[test]
fn the_first_scenario_is_the_default_and_others_have_names() {
    let text = "scenario S = { A() }\nscenario T = { B(); C() }";
    let count = |top: Top| compile(text, &top).0.expect("it compiles").occurrences.len();
    assert_eq!((count(Top::Scenario(None)), count(Top::Scenario(Some("T".into())))), (2, 3));
}

// --- 3.1 literals, 3.7, 5.2, 5.3 -----------------------------------------------------------------------------------

#[test]
fn literals_are_sets_of_values() {
    // Each in one instant of parallel threads: conflicts make the mission impossible.
    let holds = |declared: &str, one: &str, other: &str| {
        has_plan(&format!("{declared} scenario S[0,2] = {{ {one} [2,2], {other} [2,2] }}"))
    };
    assert!(!holds("", "V=A", "V=B"));
    assert!(holds("", "V=A", "V=A"));
    assert!(!holds("", "V=A", "not V=A"));
    assert!(holds("", "V=A", "not V=B"));
    assert!(holds("", "not V=A", "not V=B"), "an open domain has other values");
    assert!(holds("var V : {A, B, C};", "not V=A", "not V=B"), "C is left");
    assert!(!holds("var V : {A, B};", "not V=A", "not V=B"), "nothing is left");
    assert!(!holds("", "c", "not c"));
    assert!(!holds("", "c", "ask not c"));
    assert!(holds("", "c", "not d"));
    assert!(!holds("", "V=A", "V!=A"));
    assert!(holds("", "c", "not not c"));
}

#[test]
fn an_assertion_supports_what_follows_from_it() {
    let supports = |declared: &str, tell: &str, ask: &str| {
        has_plan(&format!("{declared} scenario S = {{ {tell} [5,5], {{ delay[1,1]; ask {ask} [2,2] }} }}"))
    };
    assert!(supports("", "V=A", "V=A"));
    assert!(supports("", "V=A", "not V=B"));
    assert!(!supports("", "not V=B", "V=A"));
    assert!(supports("var V : {A, B};", "not V=B", "V=A"), "the only other value");
    assert!(!supports("", "c", "d"));
    assert!(supports("", "c", "not not c"));
    // A negated Boolean is its other value.
    assert!(supports("", "not c", "not c"));
}

#[test]
fn one_assertion_contains_the_whole_requirement() {
    let text = |asked: i64| {
        format!("scenario S = {{ {{ c [3,3]; c [3,3] }}, {{ delay[0,inf]; ask c [{asked},{asked}] }} }}")
    };
    assert_eq!(plan_count(&text(3)), 2);
    assert!(!has_plan(&text(4)), "consecutive assertions do not combine");
}

#[test]
fn there_is_no_persistence_and_no_default_truth() {
    assert!(!has_plan("scenario S = { c [1,1]; ask c }".replace("ask c", "delay[1,1]; ask c").as_str()));
    assert!(!has_plan("scenario S = { ask c }"));
    assert!(!has_plan("scenario S = { ask not c }"));
    // Touching is being inside: the last instant of the assertion.
    assert!(has_plan("scenario S = { c [1,1]; ask c }"));
}

#[test]
fn an_assertion_on_the_same_arc_closes_a_requirement() {
    assert!(has_plan("scenario S = { do c [5,5] maintaining c }"));
    assert!(!has_plan("scenario S = { do c [5,5] maintaining not c }"), "conflicting labels on one arc");
    assert!(!has_plan("scenario S = { do c [5,5] watching c }"), "told true and false on one arc");
}

#[test]
fn watching_asserts_that_the_condition_is_false_meanwhile() {
    // It can close a requirement for the negation, and a requirement for the condition must be outside.
    assert!(has_plan("scenario S = { do A()[5,5] watching c, { delay[1,1]; ask not c [2,2] } }"));
    assert!(!has_plan("scenario S[0,5] = { do A()[5,5] watching c, { delay[1,1]; c [2,2] } }"));
    let found = plan("scenario S = { do A()[5,5] watching c, { delay[0,inf]; c [2,2] } }");
    assert_eq!(found["windows"]["Tell(c)#1.start"], json!([6, "inf"]));
    assert_eq!(found["orderings_added"], json!([["Tell(not(c))@A#1", "Tell(c)@Tell(c)#1"]]));
    // Watching the negation asserts the condition.
    assert!(has_plan("scenario S = { do A()[5,5] watching not c, ask c [3,3] }"));
}

#[test]
fn the_watched_activity_keeps_its_least_duration() {
    assert!(!has_plan("scenario S[0,9] = { do A()[5,9] watching c, { delay[3,3]; c [1,1] } }"));
}

#[test]
fn conflicts_that_touch_are_in_order_and_orderings_leave_a_gap() {
    // In a sequence they touch, and that is not an overlap.
    assert_eq!(windows("scenario S = { c [5,5]; not c [5,5] }")["Tell(not(c))#1.start"], json!([5, 5]));
    // Freely ordered, the second starts one unit later; with a gap of zero it may touch.
    let text = "scenario S = { { delay[0,inf]; c [5,5] }, not c [5,5] }";
    assert_eq!(windows(text)["Tell(c)#1.start"], json!([6, "inf"]));
    let with_gap =
        |gap: &str| windows(&format!("option threat_gap = {gap};\n{text}"))["Tell(c)#1.start"].clone();
    assert_eq!(with_gap("0"), json!([5, "inf"]));
    assert_eq!(with_gap("0.5"), json!([5.5, "inf"]));
    assert_eq!(with_gap("3"), json!([8, "inf"]));
}

#[test]
fn an_instant_needs_its_gap_even_where_order_is_given() {
    // c at one instant, then its negation at the same time: the instant would lie in the other's start.
    assert!(!has_plan("scenario S = { c; not c [5,5] }"));
    assert!(has_plan("scenario S = { c; delay[1,1]; not c [5,5] }"));
    assert!(!has_plan("scenario S = { c; delay[0.5,0.5]; not c [5,5] }"));
    assert!(has_plan("option threat_gap = 0.5; scenario S = { c; delay[0.5,0.5]; not c [5,5] }"));
    // The end of an interval is outside it.
    assert!(has_plan("scenario S = { c [5,5]; not c }"));
    assert!(!has_plan("scenario S = { c; not c }"));
}

#[test]
fn requirements_conflict_with_requirements_and_assertions_alike() {
    // Both requirements are supported by assertions that would overlap if they did.
    let text = |horizon: i64| {
        format!(
            "scenario S[0,{horizon}] = {{ {{ delay[0,inf]; V=A [4,4] }}, {{ delay[0,inf]; V=B [4,4] }},
              {{ delay[0,inf]; ask V=A [4,4] }}, {{ delay[0,inf]; ask V=B [4,4] }} }}"
        )
    };
    assert!(!has_plan(&text(8)));
    assert_eq!(plan_count(&text(9)), 2);
}

#[test]
fn labels_of_alternatives_that_are_not_taken_do_not_count() {
    let text = "scenario S[0,5] = { choose { c [5,5], d [5,5] }, not c [5,5] }";
    assert_eq!(plan(text)["choices"], json!({"D1": 1}));
    // A decision inside an alternative that is not taken is not decided.
    let nested = "scenario S = { choose { A(), choose { B(), C() } } }";
    assert_eq!(plan(nested)["choices"], json!({"D1": 0}));
    assert_eq!(plan_count(nested), 3);
}

#[test]
fn links_orderings_and_choices_are_all_tried_before_there_is_no_plan() {
    // The first assertion that fits is too early for the second requirement's order: t18 and t35 in one.
    let text = "scenario S[0,30] = { { V=A [6,6]; delay[4,4]; V=A [6,6] },
        { delay[0,inf]; do Scan()[5,5] maintaining V=A }, { delay[2,2]; W=B [5,5] },
        { delay[0,inf]; do { ask V=A [3,3]; delay[0,0] } watching W=B [3,3] } }";
    assert!(has_plan(text));
    let found = all_plans(&network(text), Search::Chronological);
    for plan in &found.plans {
        assert!(!plan.causal_links.is_empty());
    }
}

#[test]
fn the_first_plan_is_lexicographically_first() {
    let text = "scenario S = { choose { A(), B() }, { c [9,9], c [9,9] }, { delay[1,1]; ask c [1,1] },
        { delay[0,inf]; V=X [1,1] }, { delay[0,inf]; V=Y [1,1] } }";
    let found = plan(text);
    assert_eq!(found["choices"], json!({"D1": 0}));
    assert_eq!(found["causal_links"][0]["tell"], json!("Tell(c)@Tell(c)#1"));
    assert_eq!(found["conflict_order"], json!([["Tell(V=X)@Tell(V=X)#1", "Tell(V=Y)@Tell(V=Y)#1"]]));
    assert_eq!(plan_count(text), 2 * 2 * 2);
}

#[test]
fn the_worked_variants_of_the_enroute_scenario_have_their_windows() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("conformance/t01_enroute_scenario.rmpl");
    let text = std::fs::read_to_string(path).expect("the case is there");
    // SPEC 3.6: a wait of [0,45] as the figure prints changes only node 10.
    let printed = text.replace("[0,u*10%]", "[0,45]");
    assert_ne!(printed, text);
    let (found, before) = (windows(&printed), windows(&text));
    assert_eq!(found["Group-Wait#1.end"], json!([415, 505]));
    for (event, window) in before.as_object().expect("windows") {
        if event != "Group-Wait#1.end" {
            assert_eq!(found[event], *window, "{event}");
        }
    }
    // A threat gap of zero changes no window of a single event.
    assert_eq!(windows(&format!("option threat_gap = 0;\n{text}")), before);
    // 404 minutes of PATH1 are less than the 405 that the traverse needs.
    assert!(has_plan(&text.replace("PATH1=OK [450,450]", "PATH1=OK [405,405]")));
    assert!(!has_plan(&text.replace("PATH1=OK [450,450]", "PATH1=OK [404,404]")));
}
