//! The formatter's layout, and its promises: it is idempotent, keeps comments, and never changes the meaning.

use crate::written;
use proptest::prelude::*;
use rmpl::syntax::SyntaxNode;
use rmpl::{format, parse};

#[track_caller]
fn check(before: &str, after: &str) {
    assert_eq!(format(before), after);
    assert_eq!(format(after), after, "formatting twice");
}

#[test]
fn a_line_stays_a_line() {
    check("scenario   S[0,9]={A( );B()}", "scenario S[0,9] = { A(); B() }\n");
    check("var P:{OK ,BAD} ;", "var P : {OK, BAD};\n");
    check("primitive Go( from,to ) [ 1 , 2 ];", "primitive Go(from, to)[1,2];\n");
    check("option threat_gap=2;", "option threat_gap = 2;\n");
}

#[test]
fn conditions_are_tight_and_their_bounds_stand_apart() {
    check(
        "scenario S={PATH1 = OK[450,450];! c;not( d )[5,7]}",
        "scenario S = { PATH1=OK [450,450]; !c; not(d) [5,7] }\n",
    );
}

#[test]
fn what_larger_missions_are_written_with_has_its_blanks() {
    check("const  DAY=24*(60-N)+1.5h ;", "const DAY = 24 * (60 - N) + 1.5h;\n");
    check("scenario S={repeat(1+2){A()[1,2*n]}}", "scenario S = { repeat (1 + 2) { A()[1,2*n] } }\n");
    check(
        "scenario S={repeat n*2{A()};repeat 3{B()}}",
        "scenario S = { repeat n * 2 { A() }; repeat 3 { B() } }\n",
    );
    check(
        "scenario S={if a and!b thennext A()else B()[1,2];free{A()},free A()}",
        "scenario S = { if a and !b thennext A() else B()[1,2]; free { A() }, free A() }\n",
    );
    check(
        "scenario S={do A(n+1,X = on,not P,-5) maintaining(a or b)and X in{on ,off}}",
        "scenario S = { do A(n + 1, X=on, not P, -5) maintaining (a or b) and X in {on, off} }\n",
    );
    check(
        "scenario S={not(a or b)[1,2];ask a and not b [1,2]}",
        "scenario S = { not(a or b) [1,2]; ask a and not b [1,2] }\n",
    );
}

#[test]
fn what_is_in_sight_is_written_like_a_call() {
    check(
        "primitive A(r,p)[1,2] requires r.at in visible ( p )and not(r.at in visible(B));",
        "primitive A(r, p)[1,2] requires r.at in visible(p) and not(r.at in visible(B));\n",
    );
    check("scenario S={ask R.at in visible(B)[1,2]}", "scenario S = { ask R.at in visible(B) [1,2] }\n");
}

#[test]
fn the_papers_text_is_laid_out_by_its_structure() {
    let paper = include_str!("../../../../tests/conformance/c01_enroute_verbatim.rmpl");
    check(
        paper,
        "Group-Enroute()[l,u] = {\n  \
           choose {\n    \
             do {\n      Group-Traverse-Path(PATH1_1, PATH1_2, PATH1_3, TAI_POS)[l*90%,u*90%];\n    } maintaining PATH1_OK,\n    \
             do {\n      Group-Traverse-Path(PATH2_1, PATH2_2, PATH2_3, TAI_POS)[l*90%,u*90%];\n    } maintaining PATH2_OK\n  \
           };\n  \
           {\n    \
             Group-Transmit(MCC, ARRIVED_TAI)[0,2],\n    \
             do {\n      Group-Wait(TAI_HOLD1, TAI_HOLD2)[0,u*10%]\n    } watching PROCEED_OK\n  \
           }\n\
         }\n",
    );
}

#[test]
fn comments_and_single_blank_lines_are_kept() {
    check(
        "// First.\n\n\n\nprimitive A()[1,2];   // takes one or two\n/* B */ primitive B()[1,2];\nscenario S = { // threads\n// go\nA();\n\n\nB() // last\n// end\n}\n",
        "// First.\n\nprimitive A()[1,2]; // takes one or two\n/* B */\nprimitive B()[1,2];\nscenario S = { // threads\n  // go\n  A();\n\n  B() // last\n  // end\n}\n",
    );
}

#[test]
fn the_world_is_laid_out_too() {
    check(
        "terrain \"plain\" cell 0.5 origin( 0,-1 );location BASE( 40,-42 );obstacle Rock circle(1,2,3);keepout  Dish circle(1,2,3)for R,ATRV ;vehicle R:ATRV at BASE;primitive D(a)[1,2] moves R speed(0.1,0.2);",
        "terrain \"plain\" cell 0.5 origin (0, -1);\nlocation BASE (40, -42);\nobstacle Rock circle (1, 2, 3);\nkeepout Dish circle (1, 2, 3) for R, ATRV;\nvehicle R : ATRV at BASE;\nprimitive D(a)[1,2] moves R speed (0.1, 0.2);\n",
    );
}

#[test]
fn a_long_line_is_broken_at_its_outermost_braces() {
    let before = format!(
        "scenario S = {{ {} }}",
        ["{ Activity-Number-One(SITE); Activity-Number-Two(SITE) }"; 2].join(", ")
    );
    check(
        &before,
        "scenario S = {\n  { Activity-Number-One(SITE); Activity-Number-Two(SITE) },\n  { Activity-Number-One(SITE); Activity-Number-Two(SITE) }\n}\n",
    );
}

#[test]
fn a_declaration_with_a_mistake_is_left_alone() {
    check("primitive A( [1,2];\nprimitive   B()[1,2];\n", "primitive A( [1,2];\nprimitive B()[1,2];\n");
}

/// What is missing is reported where the next declaration begins.
#[test]
fn a_declaration_without_its_end_is_left_alone() {
    let text = "scenario S = {\n  { A();  B() },\nlocation X (1, 2);\n";
    check(text, text);
}

fn significant(text: &str) -> Vec<String> {
    let parse = parse(text);
    let tokens = parse.declarations().flat_map(SyntaxNode::tokens);
    tokens.map(|token| token.text.trim().to_owned()).filter(|text| !text.is_empty()).collect()
}

const PIECES: [&str; 34] = [
    "A()",
    "B(x, y)",
    "C",
    "P=OK",
    "not(c)",
    "!d",
    "delay",
    "[0,5]",
    "[l*90%,u-l]",
    "{",
    "}",
    "{",
    "}",
    ";",
    ",",
    "choose {",
    "do",
    "maintaining c",
    "watching d",
    "if e",
    "thennext",
    "\n",
    "\n\n",
    " ",
    "// note\n",
    "/* note */",
    "M()[l,u] = {",
    "scenario S[0,9] = {",
    "primitive A()[1,2];",
    "var P : {OK, BAD};",
    "location X (1, -2);",
    "(",
    ")",
    "tell c",
];

/// The meaning without its places.
fn meaning(text: &str) -> String {
    let shown = format!("{:?}", parse(text).program());
    let mut parts = shown.split("Span {");
    let first = parts.next().unwrap_or("").to_owned();
    parts.fold(first, |sum, part| sum + part.split_once('}').map_or("", |(_, rest)| rest))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn formatting_a_sound_mission_keeps_its_meaning_and_is_idempotent(seed in any::<u64>()) {
        let text = written::mission(seed);
        let before = parse(&text);
        prop_assert!(before.diagnostics().iter().all(|it| it.code.0 != "E-SYNTAX"), "{}", text);
        let formatted = format(&text);
        prop_assert_eq!(significant(&formatted), significant(&text));
        prop_assert_eq!(meaning(&formatted), meaning(&text));
        prop_assert_eq!(format(&formatted), formatted);
    }

    #[test]
    fn formatting_keeps_every_token_and_is_idempotent(
        pieces in proptest::collection::vec((0..PIECES.len(), any::<bool>()), 0..40),
    ) {
        let text: String =
            pieces.iter().flat_map(|&(piece, space)| [PIECES[piece], if space { " " } else { "" }]).collect();
        let formatted = format(&text);
        prop_assert_eq!(significant(&formatted), significant(&text));
        let codes = |text: &str| parse(text).diagnostics().iter().map(|it| it.code.0).collect::<Vec<_>>();
        prop_assert_eq!(codes(&formatted), codes(&text));
        prop_assert_eq!(format(&formatted), formatted.clone());
    }
}

#[test]
fn formatting_the_missions_keeps_their_meaning_and_needs_to_be_done_once() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/missions");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "rmpl") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        if rmpl::control::is_control_text(&text) {
            continue;
        }
        let formatted = format(&text);
        assert_eq!(significant(&formatted), significant(&text), "{path:?}");
        assert_eq!(format(&formatted), formatted, "{path:?}");
        seen += 1;
    }
    assert!(seen >= 3);
}
