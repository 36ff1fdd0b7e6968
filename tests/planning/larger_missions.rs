//! The abbreviations for larger missions (SPEC 14): each compiles to the network of what it represents, written out.

use acceptance::mission::{compile, error_codes, network};
use tpn::{LabelId, Network, Top};

/// Everything of a network but where it is written.
fn meaning(network: &Network) -> Vec<String> {
    let arcs = network.arcs.iter().map(|arc| {
        let labels: Vec<String> =
            arc.labels.iter().map(|&label| network.label_name(LabelId::from_index(label.index()))).collect();
        format!("{}→{} [{},{}] {:?} {labels:?}", arc.from.0, arc.to.0, arc.lower, arc.upper, arc.kind)
    });
    let occurrences = network.occurrences.iter().map(|it| format!("{} {:?}", it.name, it.arguments));
    arcs.chain(occurrences).collect()
}

#[track_caller]
fn same(short: &str, long: &str) {
    assert_eq!(meaning(&network(short)), meaning(&network(long)), "{short}\n{long}");
}

#[test]
fn a_constant_stands_for_its_value_wherever_an_expression_does() {
    same(
        "const DAY = 2 * HALF; const HALF = 12*60;
         primitive Drive()[HALF, DAY];
         Tour()[HALF, u] = { Drive()[HALF, u] }
         scenario S[0, DAY + 60] = { Tour()[0, DAY] }",
        "primitive Drive()[720, 1440];
         Tour()[12*60, u] = { Drive()[720, u] }
         scenario S[0, 1500] = { Tour()[0, 1440] }",
    );
}

#[test]
fn constants_that_name_each_other_or_nothing_are_mistakes() {
    let errors = |text: &str| compile(text, &Top::Scenario(None)).1;
    let codes = |text: &str| errors(text).iter().map(|it| it.code.0).collect::<Vec<_>>();
    assert_eq!(codes("const A = B; const B = A + 1; scenario S[0, A] = { delay }"), ["E-RECURSION"]);
    assert_eq!(error_codes("const A = 1; const A = 2; scenario S[0, A] = { delay }"), ["E-DUP"]);
    assert_eq!(error_codes("scenario S[0, A] = { delay }"), ["E-NAME"]);
    assert_eq!(codes("const A = inf; scenario S[0, A] = { delay }"), ["E-BOUNDS"]);
    assert_eq!(codes("const A = 1/0; scenario S[0, A] = { delay }"), ["E-BOUNDS"]);
}

#[test]
fn units_are_converted_exactly_to_the_missions_unit() {
    same("scenario S[1.5h, 2d] = { delay[90s, 15min] }", "scenario S[90, 2880] = { delay[1.5, 15] }");
    same(
        "option time_unit = second; scenario S[0, 1sol] = { delay[1min, 1h] }",
        "option time_unit = second; scenario S[0, 88775.244] = { delay[60, 3600] }",
    );
    // 88 775.244 s are 22 193 811 / 15 000 minutes.
    same("scenario S[0, 1sol] = { delay }", "scenario S[0, 22193811/15000] = { delay }");
}

#[test]
fn parameters_are_numbers_places_values_conditions_and_activities() {
    same(
        "const N = 3;
         primitive Sample(n)[n, 2*n];
         Rep(n, c)[l, u] = { do Sample(n)[n, 2*n] maintaining c; Sample(2*n)[l/2, u] }
         scenario S = { { delay; Rep(N, LIGHT=on)[20, 40] }, LIGHT=on [60, 60] }",
        "primitive Sample(n)[n, 2*n];
         Rep(n, c)[l, u] = { do Sample(3)[3, 6] maintaining LIGHT=on; Sample(6)[l/2, u] }
         scenario S = { { delay; Rep(3, LIGHT=on)[20, 40] }, LIGHT=on [60, 60] }",
    );
    same(
        "Guard(c) = { do Act() watching c; Inner(not c) }
         Inner(d) = { ask d }
         primitive Act();
         scenario S = { Guard(GO=now) }",
        "Guard(c) = { do Act() watching GO=now; Inner(not GO=now) }
         Inner(d) = { ask not GO=now }
         primitive Act();
         scenario S = { Guard(GO=now) }",
    );
}

#[test]
fn repeat_is_so_many_copies() {
    same(
        "primitive A(); Twice(n) = { repeat n { A()[1,2]; delay[3,3] } }
         scenario S = { Twice(2); repeat 0 { A() }; repeat 1 { A() } }",
        "primitive A(); Twice(n) = { { A()[1,2]; delay[3,3] }; { A()[1,2]; delay[3,3] } }
         scenario S = { Twice(2); {}; A() }",
    );
    let codes = error_codes;
    assert_eq!(codes("scenario S = { repeat 1.5 { delay } }"), ["E-BOUNDS"]);
    assert_eq!(codes("scenario S = { repeat (0-1) { delay } }"), ["E-BOUNDS"]);
    assert_eq!(codes("scenario S = { repeat (inf) { delay } }"), ["E-BOUNDS"]);
    assert_eq!(codes("scenario S = { repeat 999999999999 { delay } }"), ["E-LIMIT"]);
    // What has nothing in it takes room all the same.
    assert_eq!(codes("scenario S = { repeat 400000 { repeat 400000 { {} } } }"), ["E-LIMIT"]);
    let twice = "A() = { repeat 1000 { B() } } B() = { repeat 1000 { delay } } scenario S = { A() }";
    let (_, diagnostics) = compile(twice, &Top::Scenario(None));
    let error = diagnostics.iter().find(|it| it.severity == rmpl::Severity::Error);
    let message = &error.expect("too many copies").message;
    assert!(message.contains("`repeat`") && message.contains("more than 500000 events"), "{message}");
}

#[test]
fn else_is_a_choice_between_a_condition_and_its_negation() {
    same(
        "primitive A(); primitive B(); var X : {on, off};
         scenario S = { if X=on thennext A()[1,2] else B()[3,4] }",
        "primitive A(); primitive B(); var X : {on, off};
         scenario S = { choose { if X=on thennext A()[1,2], if not X=on thennext B()[3,4] } }",
    );
}

#[test]
fn what_is_asked_of_several_is_asked_of_each_and_or_is_a_choice() {
    let head = "primitive A(); ";
    let same = |short: &str, long: &str| same(&format!("{head}{short}"), &format!("{head}{long}"));
    same(
        "scenario S = { do A()[1,2] maintaining P and not Q=on }",
        "scenario S = { do do A()[1,2] maintaining P maintaining not Q=on }",
    );
    same(
        "scenario S = { do A() maintaining P or (Q and R) }",
        "scenario S = { choose { do A() maintaining P, do do A() maintaining Q maintaining R } }",
    );
    same(
        "scenario S = { if not (P or Q) thennext A() }",
        "scenario S = { if not Q thennext if not P thennext A() }",
    );
    same(
        "scenario S = { ask P or Q [5,5]; ask (P and Q) [1,1] }",
        "scenario S = { choose { ask P[5,5], ask Q[5,5] }; do ask P[1,1] maintaining Q }",
    );
}

#[test]
fn what_is_told_of_several_is_told_of_each() {
    let network = network("scenario S = { P and not Q [5,5]; { delay } }");
    let labels: Vec<String> =
        (0..network.labels.len()).map(|label| network.label_name(LabelId::from_index(label))).collect();
    assert_eq!(labels, ["Tell(P)@Tell(P)#1", "Tell(not(Q))@Tell(P)#1"]);
    assert_eq!(error_codes("scenario S = { P or Q [5,5] }"), ["E-SYNTAX"]);
    // Watching `a and b` would assert that one of the two is false, and leave open which.
    assert_eq!(error_codes("primitive A(); scenario S = { do A() watching P and Q }"), ["E-SYNTAX"]);
    same(
        "primitive A(); scenario S = { do A() watching P or Q }",
        "primitive A(); scenario S = { do do A() watching P watching Q }",
    );
}

#[test]
fn a_set_of_values_is_one_literal() {
    let text = "var X : {a, b, c}; primitive A();
        scenario S = { { delay; do A()[1,1] maintaining X in {a, b} }, { X=b [5,5]; X=c [5,5] } }";
    let network = network(text);
    assert_eq!(network.label_name(LabelId(0)), "Ask(X in {a, b})@A#1");
    let literal = |label: usize| &network.labels[label].literal;
    assert!(literal(1).supports(literal(0)) && !literal(2).supports(literal(0)));
    assert!(literal(2).conflicts(literal(0)) && !literal(1).conflicts(literal(0)));
    assert_eq!(error_codes("var X : {a, b}; scenario S = { X in {a, d} [1,1] }"), ["E-VALUE"]);
    same(
        "var X : {a, b, c}; scenario S = { not (X in {a, b}) [1,1] }",
        "var X : {a, b, c}; scenario S = { not X in {a, b} [1,1] }",
    );
}

#[test]
fn free_lets_a_branch_start_later() {
    same(
        "primitive A(); scenario S = { free A()[1,2], free { A(); A() } }",
        "primitive A(); scenario S = { { delay; A()[1,2] }, { delay; { A(); A() } } }",
    );
}

#[test]
fn the_new_words_stay_names_where_their_forms_cannot_begin() {
    let text = "var repeat : {free, else}; primitive free(); primitive and();
        scenario S = { free(); repeat=free [1,2]; or [1,1]; and; in [2,2]; const [1,1]; do free maintaining else }";
    assert!(error_codes(text).is_empty(), "{:?}", error_codes(text));
}

#[test]
fn nested_choices_of_or_are_refused_before_they_fill_the_memory() {
    let mut text = "A()".to_owned();
    for level in 0..60 {
        text = format!("do {{ {text} }} maintaining P{level} or Q{level}");
    }
    assert_eq!(error_codes(&format!("primitive A(); scenario S = {{ {text} }}")), ["E-LIMIT"]);
}

#[test]
fn what_is_joined_nests_no_deeper_than_can_be_compiled() {
    let joined = |count: usize, word: &str| {
        let names: Vec<String> = (0..count).map(|number| format!("P{number}")).collect();
        names.join(word)
    };
    let codes = |statement: &str| error_codes(&format!("primitive A(); scenario S = {{ {statement} }}"));
    for count in [300, 100_000] {
        assert_eq!(codes(&format!("do A() maintaining {}", joined(count, " and "))), ["E-LIMIT"]);
        assert_eq!(codes(&format!("do A() watching {}", joined(count, " or "))), ["E-LIMIT"]);
        assert_eq!(codes(&format!("if {} thennext A() else A()", joined(count, " or "))), ["E-LIMIT"]);
        assert_eq!(codes(&format!("ask {} [1,1]", joined(count, " and "))), ["E-LIMIT"]);
        assert_eq!(codes(&format!("{} [1,1]", joined(count, " and "))), ["E-LIMIT"]);
    }
    assert_eq!(codes(&format!("do A() maintaining {}", joined(300, " or "))), [""; 0]);
    assert_eq!(codes(&format!("{} [1,1]", joined(100, " and "))), [""; 0]);
}

#[test]
fn an_argument_is_one_literal() {
    assert!(error_codes("primitive A(c); scenario S = { A(X=on and P) }").contains(&"E-SYNTAX"));
    assert!(error_codes("primitive A(c); scenario S = { A(not (P or Q)) }").contains(&"E-SYNTAX"));
    same(
        "primitive A(); B(c) = { do A() maintaining c } scenario S = { B(X in {a, b}); B(not P) }",
        "primitive A(); B(c) = { do A() maintaining c } scenario S = { B(X in {a, b}); B(!P) }",
    );
}
