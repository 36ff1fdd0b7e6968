//! After any edits a text is as current as if it had been read afresh, and any text is read without loss.

use proptest::prelude::*;
use rmpl::syntax::SyntaxNode;
use rmpl::{Edit, Parse, Span, parse};

const MISSIONS: [&str; 6] = [
    include_str!("../../../../assets/missions/enroute.rmpl"),
    include_str!("../../../../assets/missions/threats.rmpl"),
    include_str!("../../../../tests/conformance/t30_second_search_example.rmpl"),
    "option strict = 1;\nvar P : {OK, BAD};\nA(x)[l,u] = { B()[l,u*2]; C }\nC() = { P_OK [1,2], { delay; tell not(P=BAD) } }\nscenario S[0,9] = { A(P); if P!=BAD thennext C() }\n",
    "const N = 2*M;\nconst M = 1.5h;\nvar X : {a, b};\nprimitive D(v, n)[n, N] moves v;\nA(c)[N,u] = { repeat 2 { do D(V, M+1) maintaining c and X in {a, b} } }\nscenario S[0,N] = { free A(X=a); if P or not (Q and R) thennext A(not P) else delay, P and Q [1,2] }\n",
    "state ARM : {IN, OUT} = IN;\nresource Power capacity N;\nresource Tank 0..9 = 4;\nobjective minimize 2*cost - end, maximize reward;\nlocation A (1, 2);\nvehicle V : ATRV at A;\nprimitive D(s, n)[1,2] requires at start ARM=OUT, V.at=s requires not ARM=IN sets ARM=IN, V.at=s uses Power n consumes Tank 2 per minute costs n per metre rewards 3;\nM(s)[l,u] = { unordered { D(s, 1); optional D(A, 2)[1,2] }; do D(s, 2) using Power 2 [0,9] }\nscenario S[0,9] = { M(A); do ARM=OUT [1,2] maintaining V.at=A }\n",
];

/// Pieces of text that turn up when people type, and others that should not matter.
const PIECES: [&str; 52] = [
    "",
    " ",
    "\n",
    ";",
    ",",
    "{",
    "}",
    "[",
    "]",
    "(",
    ")",
    "=",
    "%",
    "-",
    "x",
    "A()",
    "P=OK",
    "[0,5]",
    "//",
    "/*",
    "*/",
    "choose {",
    "var Q : {A, B};",
    "scenario T = {",
    "thennext ",
    "else ",
    " and ",
    " or ",
    " in {",
    "free ",
    "repeat N {",
    "const N = 3;",
    "N",
    "90s",
    ".",
    "..",
    ".at",
    "state X : {A, B} = A;",
    "resource ",
    "objective ",
    " requires ",
    " requires at start ",
    " sets X=A",
    " uses Power 2",
    " per minute",
    " costs ",
    " using ",
    "optional ",
    "unordered {",
    "\"",
    "∞",
    "é",
];

fn held(parse: &Parse) -> String {
    parse.declarations().flat_map(SyntaxNode::tokens).map(|token| token.text).collect()
}

fn assert_same_as_fresh(edited: &Parse) {
    let fresh = parse(edited.text());
    assert_eq!(held(edited), edited.text());
    assert_eq!(edited.diagnostics(), fresh.diagnostics(), "in {:?}", edited.text());
    assert_eq!(edited.program(), fresh.program(), "in {:?}", edited.text());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 768, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_is_held_byte_for_byte(text in "\\PC{0,200}") {
        prop_assert_eq!(held(&parse(&text)), text);
    }

    #[test]
    fn any_bytes_are_held_once_they_are_text(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        prop_assert_eq!(held(&parse(&text)), text);
    }

    #[test]
    fn edits_leave_a_parse_as_current_as_a_fresh_one(
        mission in 0..MISSIONS.len(),
        edits in proptest::collection::vec((any::<u32>(), 0_u32..12, 0..PIECES.len()), 1..8),
    ) {
        let mut edited = parse(MISSIONS[mission]);
        for (at, length, piece) in edits {
            let start = at % (edited.text().len() as u32 + 1);
            edited.edit(&Edit { span: Span::new(start, start + length), text: PIECES[piece].to_owned() });
            assert_same_as_fresh(&edited);
        }
    }
}

/// Who calls whom does not change here, but the place of the call does.
#[test]
fn a_circle_of_calls_moves_with_its_text() {
    let mut edited = parse("A() = { LIGHT; B() }\nB() = { A() }\n");
    edited.edit(&Edit { span: Span::new(8, 8), text: "DARK; ".to_owned() });
    assert_same_as_fresh(&edited);
}

/// The first name of a text is the one that its first activity calls.
#[test]
fn a_circle_is_found_where_calls_come_to_an_activity_without_any() {
    let mut edited = parse("P() = { delay }\n");
    edited.edit(&Edit { span: Span::new(8, 13), text: "P()".to_owned() });
    assert_same_as_fresh(&edited);
    assert_eq!(edited.diagnostics().iter().map(|it| it.code.0).collect::<Vec<_>>(), ["E-RECURSION"]);
}

#[test]
fn typing_a_mission_letter_by_letter_keeps_it_current() {
    for mission in [MISSIONS[3], MISSIONS[5]] {
        let mut edited = parse("");
        for (at, letter) in mission.char_indices() {
            edited.edit(&Edit { span: Span::new(at as u32, at as u32), text: letter.to_string() });
            assert_same_as_fresh(&edited);
        }
    }
}

#[test]
fn deep_nesting_is_reported_and_not_followed() {
    for (open, close) in [
        ("{", "}"),
        ("(", ")"),
        ("do ", ""),
        ("if c thennext ", ""),
        ("not ", ""),
        ("choose {", "}"),
        ("optional ", ""),
        ("unordered {", "}"),
        ("do do A using P ", "using Q"),
    ] {
        let text = format!("scenario S = {{ {}c{} }}", open.repeat(5000), close.repeat(5000));
        let parse = parse(&text);
        assert_eq!(held(&parse), text);
        assert!(!parse.diagnostics().is_empty(), "{open}");
        let _ = parse.program();
    }
    let sum = format!("primitive A()[0{}, inf];", "+1".repeat(20_000));
    assert_eq!(parse(&sum).diagnostics().len(), 1);
}

/// What a name with a dot means depends on its vehicle, also while that has no model.
#[test]
fn a_vehicle_that_loses_its_model_and_then_its_declaration_is_unknown() {
    let mut edited =
        parse("location A (1, 2);\nvehicle V : ATRV at A;\nprimitive D()[1,2] requires V.arm=OUT;\n");
    for (removed, inserted) in [(" : ATRV at A", ""), ("vehicle", "x"), ("x V", "vehicle V")] {
        let start = edited.text().find(removed).expect("it is there") as u32;
        let span = Span::new(start, start + removed.len() as u32);
        edited.edit(&Edit { span, text: inserted.to_owned() });
        assert_same_as_fresh(&edited);
    }
}
