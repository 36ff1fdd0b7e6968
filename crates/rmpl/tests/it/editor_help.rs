//! Completion, hover and signature help.

use crate::fixture::fixture;
use exact::{Bound, Time};
use rmpl::editor::{self, Evaluation, EventWindow, Invocation};
use rmpl::parse;

/// All of `wanted` are offered at the cursor, and none of `unwanted`.
#[track_caller]
fn check_completion(written: &str, wanted: &[&str], unwanted: &[&str]) {
    let fixture = fixture(written);
    let completion = editor::complete(&parse(&fixture.text), fixture.cursor);
    let labels: Vec<&str> = completion.items.iter().map(|item| item.label.as_str()).collect();
    for label in wanted {
        assert!(labels.contains(label), "{label} is missing from {labels:?}");
    }
    for label in unwanted {
        assert!(!labels.contains(label), "{label} is offered in {labels:?}");
    }
}

const HEAD: &str = "\
var P : {OK, BAD};
location BASE (0, 0);
vehicle R : ATRV at BASE;
primitive Drive(to)[1,2] moves R;
Survey(x)[low,high] = { Drive(BASE) }
";

#[track_caller]
fn check_completion_in_mission(line: &str, wanted: &[&str], unwanted: &[&str]) {
    check_completion(&format!("{HEAD}{line}\n"), wanted, unwanted);
}

#[test]
fn a_statement_may_be_a_keyword_a_call_or_a_condition() {
    let everything = ["choose", "delay", "Drive", "Survey", "P"];
    check_completion_in_mission("scenario S = { $0 }", &everything, &["BASE", "low", "OK", "scenario"]);
    check_completion_in_mission("scenario S = { A(); $0", &everything, &["BASE"]);
    check_completion_in_mission("scenario S = { do $0 }", &everything, &["BASE"]);
}

#[test]
fn nature_chooses_for_primitives_and_not_for_definitions() {
    for call in ["Drive(BASE)", "delay", "P=OK"] {
        check_completion_in_mission(&format!("scenario S = {{ {call} $0 }}"), &["contingent"], &[]);
    }
    for call in ["Survey(BASE)", "Survey((BASE))", "Survey"] {
        check_completion_in_mission(&format!("scenario S = {{ {call} $0 }}"), &[], &["contingent"]);
    }
}

#[test]
fn what_is_typed_narrows_the_list() {
    check_completion_in_mission("scenario S = { Dr$0 }", &["Drive"], &["Survey", "choose"]);
    check_completion_in_mission("scenario S = { dr$0 }", &["Drive"], &["Survey"]);
}

#[test]
fn a_value_is_one_of_the_variables_domain() {
    check_completion_in_mission("scenario S = { P=$0 }", &["OK", "BAD"], &["Drive", "P", "choose"]);
    check_completion_in_mission("scenario S = { if P!=B$0", &["BAD"], &["OK"]);
}

#[test]
fn a_condition_offers_variables_and_no_activities() {
    check_completion_in_mission(
        "scenario S = { do { Drive(BASE) } maintaining $0 }",
        &["P", "not"],
        &["Drive", "BASE"],
    );
    check_completion_in_mission("scenario S = { if $0", &["P"], &["Survey"]);
}

#[test]
fn bounds_offer_the_names_of_their_own_header() {
    check_completion_in_mission("M()[l,u] = { Drive(BASE)[$0] }", &["l", "u", "inf"], &["low", "Drive"]);
    check_completion_in_mission("M()[l,u] = { Drive(BASE)[l,$0", &["u", "inf"], &["high"]);
}

#[test]
fn arguments_are_locations_and_parameters() {
    check_completion_in_mission("M(x)[l,u] = { Drive($0) }", &["BASE", "x"], &["Drive", "l", "choose"]);
}

#[test]
fn words_go_on_where_the_grammar_does() {
    check_completion_in_mission(
        "scenario S = { do { Drive(BASE) } $0 }",
        &["maintaining", "watching"],
        &["Drive"],
    );
    check_completion_in_mission("scenario S = { if P=OK $0 }", &["thennext"], &["P"]);
    check_completion_in_mission("vehicle Q : $0", &["ATRV", "ATRV-Jr", "Blimp"], &["R"]);
    check_completion_in_mission("vehicle Q : ATRV at $0", &["BASE"], &["ATRV"]);
    check_completion_in_mission("primitive Go(a)[1,2] moves $0", &["R"], &["BASE"]);
    check_completion_in_mission("option time_unit = $0", &["minute", "second"], &["P"]);
}

#[test]
fn what_larger_missions_are_written_with_is_offered_in_its_place() {
    let check = |line: &str, wanted: &[&str], unwanted: &[&str]| {
        check_completion_in_mission(&format!("const DAY = 24*60;\n{line}"), wanted, unwanted);
    };
    check("scenario S = { $0 }", &["repeat", "free", "if … thennext … else"], &["const", "DAY"]);
    check("scenario S = { if P=OK thennext Drive(BASE) $0 }", &["else"], &["P", "DAY"]);
    check("scenario S = { if P=OK thennext Drive(BASE) else $0 }", &["Drive", "P", "choose"], &["BASE"]);
    check("scenario S = { if P=OK $0 }", &["thennext", "and", "or"], &["P"]);
    check("scenario S = { do Drive(BASE) maintaining P=OK and $0 }", &["P", "not"], &["Drive"]);
    check("scenario S = { do Drive(BASE) maintaining P in {OK, $0} }", &["OK", "BAD"], &["P", "choose"]);
    check("scenario S = { repeat $0 }", &["DAY", "inf"], &["P", "Drive"]);
    check("scenario S = { free $0 }", &["Drive", "choose"], &["DAY"]);
    check("M(x)[l,u] = { Drive(BASE)[0,$0", &["DAY", "l", "u", "x"], &["Drive"]);
    check("M(x)[l,u] = { Drive($0) }", &["DAY", "BASE", "R", "x"], &["choose"]);
    check("primitive Go(v, to)[1,2] moves $0", &["v", "R"], &["DAY"]);
    check("const HALF = $0", &["DAY"], &["Drive", "P"]);
    check("$0", &["const"], &["DAY"]);
}

#[test]
fn between_declarations_only_declarations_are_offered() {
    check_completion_in_mission("$0", &["var", "primitive", "scenario"], &["Drive", "choose"]);
}

#[test]
fn nothing_is_offered_in_comments_and_texts() {
    check_completion("// Dr$0\nprimitive Drive()[1,2];", &[], &["Drive", "var"]);
    check_completion("terrain \"ta$0\";", &[], &["var"]);
}

#[test]
fn a_text_in_quotes_says_what_it_names_and_is_replaced_between_its_quotes() {
    for (written, wants) in [
        ("terrain \"ta$0\";", Some(editor::Wanted::Map)),
        ("terrain \"$0\";", Some(editor::Wanted::Map)),
        ("import \"wor$0\";", Some(editor::Wanted::File)),
        ("terrain \"tai\"$0;", None),
    ] {
        let fixture = fixture(written);
        let completion = editor::complete(&parse(&fixture.text), fixture.cursor);
        assert_eq!(completion.wants, wants, "{written}");
        if wants.is_some() {
            let replaced = &fixture.text[completion.replaces.range()];
            assert!(!replaced.contains('"') && written.contains(replaced), "{written}: {replaced}");
        }
    }
}

#[test]
fn a_call_is_completed_with_the_cursor_between_its_parentheses() {
    let fixture = fixture(&format!("{HEAD}scenario S = {{ Dr$0 }}\n"));
    let completion = editor::complete(&parse(&fixture.text), fixture.cursor);
    assert_eq!(completion.items[0].insert, "Drive($1)$0");
    assert_eq!(&fixture.text[completion.replaces.range()], "Dr");
}

fn day() -> Evaluation {
    Evaluation {
        invocations: vec![Invocation {
            activity: "Survey".into(),
            occurrence: "Survey#1".into(),
            lower: Time::from(450),
            upper: Bound::Finite(Time::from(540)),
        }],
        windows: Vec::new(),
    }
}

/// The hover at the cursor contains `wanted`.
#[track_caller]
fn check_hover(written: &str, evaluation: &Evaluation, wanted: &str) {
    let fixture = fixture(written);
    let hover = editor::hover(&parse(&fixture.text), fixture.cursor, evaluation).expect("a hover");
    assert!(hover.markdown.contains(wanted), "{}", hover.markdown);
}

#[test]
fn a_bound_shows_its_value_in_each_invocation() {
    check_hover("Survey()[l,u] = { A()[l*9$00%,u] }", &day(), "`l*90%`  \n= **405** in Survey#1");
    check_hover(
        "Survey()[l,u] = { A()[l,$0u*10%] }",
        &day(),
        "`u`  \n= **540** in Survey#1  \n`u*10%` = **54** in Survey#1",
    );
    check_hover("Survey()[l,u] = { A()[1+$02*3,u] }", &Evaluation::default(), "= **7**");
}

#[test]
fn constants_and_units_show_their_values() {
    let head = "// A day has them.\nconst DAY = 24 * HOUR;\nconst HOUR = 60;\n";
    let check = |line: &str, wanted: &str| check_hover(&format!("{head}{line}"), &day(), wanted);
    check(
        "scenario S[0,D$0AY] = { delay }",
        "```rmpl\nconst DAY = 24 * HOUR\n```\n\nA day has them.\n\n= **1440**",
    );
    check("scenario S[0,DAY$0+HOUR] = { delay }", "const DAY");
    check("scenario S[0,2*DAY$0+HOUR*2] = { delay }", "const DAY");
    check("scenario S[0,2$0*DAY] = { delay }", "`2*DAY`  \n= **2880**");
    check(
        "Survey()[l,u] = { A()[DAY,$0u+HOUR] }",
        "`u`  \n= **540** in Survey#1  \n`u+HOUR` = **600** in Survey#1",
    );
    check("Survey()[l,HOUR] = { A()[0,H$0OUR] }", "= **60**");
    check("primitive A()[9$00s, 1.5h];", "`90s`  \n= **1.5**");
    check("option time_unit = second;\nprimitive A()[9s, 1s$0ol];", "= **88775.244**");
    check("const A = B;\nconst B = A;\nscenario S[0,A$0] = { delay }", "const A = B");
    check("scenario S = { rep$0eat 3 { A() } }", "copies of A");
    check("scenario S = { if P thennext A() el$0se B() }", "where it is false");
}

#[test]
fn a_name_shows_its_declaration_and_the_comment_above_it() {
    let text =
        "// Not this.\n\n// Drives on.\nprimitive Drive(to)\n  [20,30];\nscenario S = { Dr$0ive(BASE) }";
    check_hover(text, &Evaluation::default(), "```rmpl\nprimitive Drive(to) [20,30]\n```\n\nDrives on.");
    check_hover("var P : {OK, BAD};\nscenario S = { $0P=OK }", &Evaluation::default(), "var P : {OK, BAD}");
    check_hover("scenario S = { del$0ay }", &Evaluation::default(), "[0,inf]");
}

#[test]
fn a_call_shows_the_windows_of_the_current_plan() {
    let text = "primitive A()[1,2];\nscenario S = { A$0() }";
    let at = text.find("A$0").unwrap() as u32;
    let window = EventWindow {
        span: rmpl::Span::new(at, at + 3),
        event: "A#1.start".into(),
        earliest: Time::from(10),
        latest: Bound::Finite(Time::from(55)),
    };
    let evaluation = Evaluation { invocations: Vec::new(), windows: vec![window] };
    check_hover(text, &evaluation, "A#1.start in [10,55]");
}

#[test]
fn signature_help_names_the_parameter_being_written() {
    let fixture = fixture("primitive Drive(from, to)[20,30];\nscenario S = { Drive(BASE, $0");
    let signature = editor::signature_at(&parse(&fixture.text), fixture.cursor).expect("a signature");
    assert_eq!(signature.label, "primitive Drive(from, to)[20,30]");
    assert_eq!(signature.active, 1);
    assert_eq!(&signature.label[signature.parameters[1].range()], "to");
}

#[test]
fn brackets_of_declarations_say_what_they_want() {
    for (written, label, active) in [
        ("location A (1, $0", "location NAME (EAST, NORTH)", "NORTH"),
        ("obstacle O circle (1, 2, $0);", "circle (EAST, NORTH, RADIUS)", "RADIUS"),
        ("keepout O circle (1, 2, $0) for R;", "circle (EAST, NORTH, RADIUS)", "RADIUS"),
        ("primitive Drive(a)[$0", "[MIN, MAX]", "MIN"),
        ("scenario S = { delay[3,$0] }", "[MIN, MAX]", "MAX"),
        ("state X : {$0", "{VALUE, …}", "VALUE"),
    ] {
        let fixture = fixture(written);
        let signature = editor::signature_at(&parse(&fixture.text), fixture.cursor).expect(written);
        assert_eq!(signature.label, label, "{written}");
        assert_eq!(&signature.label[signature.parameters[signature.active as usize].range()], active);
    }
    let fixture = fixture("scenario S = { $0 }");
    assert_eq!(editor::signature_at(&parse(&fixture.text), fixture.cursor), None);
}

#[test]
fn what_is_not_declared_can_be_declared_by_a_fix() {
    let text = "location A (0, 0);\nvehicle R : ATRV at BASE;\nscenario S = { Drive(A, A)[2,5] }\n";
    let found = parse(text);
    let fixes: Vec<_> = found.diagnostics().into_iter().flat_map(|it| it.fixes).collect();
    for (label, inserted) in [
        ("Declare primitive `Drive`", "primitive Drive(p1, p2)[2,5];\n"),
        ("Declare activity `Drive`", "Drive(p1, p2)[l,u] = {\n  delay[l,u]\n}\n"),
        ("Declare location `BASE`", "location BASE (0, 0);\n"),
    ] {
        let fix = fixes.iter().find(|fix| fix.label == label).unwrap_or_else(|| panic!("{label}: {fixes:?}"));
        assert_eq!(fix.edits[0].text, inserted);
        let mut mended = text.to_owned();
        for edit in fix.edits.iter().rev() {
            mended.replace_range(edit.span.range(), &edit.text);
        }
        let left = parse(&mended).diagnostics();
        let name = label.split('`').nth(1).expect("a name");
        assert!(left.iter().all(|it| !it.message.contains(&format!("`{name}` is declared"))), "{left:?}");
    }
}
