//! Durations that the environment chooses: where they are written, what the program says of them, and that their word
//! is not taken from a mission that uses it as a name (SPEC 13.1).

use crate::fixture::fixture;
use rmpl::editor::{self, Evaluation, EventWindow, HighlightKind};
use rmpl::program::{Bounds, Controllability, Program, Statement, StatementKind};
use rmpl::{Severity, Span, format, parse};

#[track_caller]
fn program(text: &str) -> Program {
    let parsed = parse(text);
    let errors: Vec<_> =
        parsed.diagnostics().into_iter().filter(|it| it.severity == Severity::Error).collect();
    assert!(errors.is_empty(), "{text}\n{errors:?}");
    parsed.program()
}

fn steps(program: &Program) -> &[Statement] {
    let StatementKind::Sequence(steps) = &program.scenarios[0].body.kind else { panic!("a sequence") };
    steps
}

/// The bounds as they are written, with `~` before those that are the environment's.
fn shown(text: &str, bounds: Option<&Bounds>) -> String {
    bounds.map_or(String::new(), |bounds| {
        let word = if bounds.is_contingent { "~" } else { "" };
        format!("{word}{}", &text[bounds.span.range()])
    })
}

#[test]
fn the_word_stands_before_bounds_of_one_interval() {
    let text = "primitive Drive(to) contingent [20,40] moves R costs 3; primitive Dig()[1,2]; vehicle R : ATRV at B;\
                location B (0,0); var X : {A, B};\
                scenario S = { Drive(B); Dig() contingent [1,2]; Dig contingent [1,1]; X=A contingent [3,4];\
                ask X in {A, B} contingent [5,6]; not X=A contingent [5,6]; delay contingent [7,8]; delay[1,2] }";
    let program = program(text);
    assert_eq!(shown(text, program.primitives[0].bounds.as_ref()), "~contingent [20,40]");
    assert!(program.primitives[0].moves.is_some() && program.primitives[0].costs.len() == 1);
    let found: Vec<String> = steps(&program).iter().map(|step| shown(text, step.bounds.as_ref())).collect();
    let wanted = [
        "",
        "~contingent [1,2]",
        "~contingent [1,1]",
        "~contingent [3,4]",
        "~contingent [5,6]",
        "~contingent [5,6]",
        "~contingent [7,8]",
        "[1,2]",
    ];
    assert_eq!(found, wanted);
}

#[test]
fn behind_a_prefix_and_in_a_condition_it_belongs_to_what_it_stands_behind() {
    let text = "primitive A(); scenario S = { free A() contingent [1,2]; optional A() contingent [1,2];\
                do A() contingent [1,2] maintaining L; if L thennext A() contingent [1,2] else A() contingent [1,2];\
                choose { A() contingent [1,2], delay contingent [1,2] }; L }";
    let program = program(text);
    let count = format!("{:?}", program.scenarios[0]).matches("is_contingent: true").count();
    assert_eq!(count, 7);
}

#[test]
fn a_mission_may_use_the_word_as_a_name() {
    let text = "const contingent = 3; resource R capacity 4;\nprimitive contingent(contingent)[1,contingent];\
                state X : {contingent, B} = contingent;\
                scenario S = { contingent(2); do { contingent(1) } using R contingent; contingent(2)[1,2] }";
    let program = program(text);
    assert!(!format!("{program:?}").contains("is_contingent: true"));
    let StatementKind::Using(_, _, amount) = &steps(&program)[1].kind else { panic!("a use") };
    assert!(amount.is_some());
    // Directly before brackets it is the word: an amount of that name is written in parentheses.
    let found =
        parse("resource R; primitive A(); scenario S = { do A() using R contingent [1,2] }").diagnostics();
    assert_eq!(found.iter().map(|it| it.code.0).collect::<Vec<_>>(), ["E-CONTINGENT"]);
}

#[test]
fn quick_fixes_leave_the_word_out_or_move_it_to_the_one_activity() {
    let fixed = |text: &str| -> Vec<String> {
        let found = parse(text).diagnostics();
        let found: Vec<_> = found.iter().filter(|it| it.code.0 == "E-CONTINGENT").collect();
        assert_eq!(found.len(), 1, "{text}");
        let fix = |fix: &rmpl::Fix| {
            let mut mended = text.to_owned();
            for edit in fix.edits.iter().rev() {
                mended.replace_range(edit.span.range(), &edit.text);
            }
            assert!(parse(&mended).diagnostics().iter().all(|it| it.severity != Severity::Error), "{mended}");
            mended
        };
        found[0].fixes.iter().map(fix).collect()
    };
    assert_eq!(
        fixed("scenario S = { do Drive() maintaining L contingent [1,2] }"),
        [
            "scenario S = { do Drive() contingent [1,2] maintaining L }",
            "scenario S = { do Drive() maintaining L [1,2] }",
        ]
    );
    assert_eq!(
        fixed("scenario S = { {{ Drive() }} contingent [1,2] }"),
        ["scenario S = { {{ Drive() contingent [1,2] }} }", "scenario S = { {{ Drive() }} [1,2] }"]
    );
    assert_eq!(
        fixed("scenario S = { { Drive(); Dig() } contingent [1,2] }"),
        ["scenario S = { { Drive(); Dig() } [1,2] }"]
    );
    assert_eq!(fixed("scenario S = { { Drive()[1,2] } contingent [1,2] }").len(), 1);
    assert_eq!(fixed("scenario S contingent [1,2] = { Drive() }"), ["scenario S [1,2] = { Drive() }"]);
    assert_eq!(fixed("A() contingent [1,2] = { Drive() }\nscenario S = { A() }").len(), 1);
    assert_eq!(fixed("A() = { Drive() }\nscenario S = { A() contingent [1,2] }").len(), 1);
    assert_eq!(fixed("A() = { Drive() }\nscenario S = { A contingent [1,2] }").len(), 1);
}

#[test]
fn bounds_that_require_something_of_nature_are_no_contradiction_and_no_slack_that_is_not() {
    let codes = |text: &str| -> Vec<&str> {
        parse(text).diagnostics().iter().map(|it| it.code.0).collect::<Vec<_>>()
    };
    let scenario = |body: &str| format!("primitive Drive() contingent [20,40];\nscenario S = {{ {body} }}");
    assert_eq!(codes(&scenario("Drive()[20,50]")), ["W-SLACK"]);
    assert_eq!(codes(&scenario("Drive()[50,60]")), ["W-WINDOW"]);
    assert_eq!(codes(&scenario("Drive()[30,35]")), [""; 0]);
    // The environment is not narrowed: around the call, its whole range still counts.
    assert_eq!(codes(&scenario("{ Drive()[30,35]; Drive() }[30,90]")), ["W-SLACK"]);
    assert_eq!(codes(&scenario("{ Drive()[30,35]; Drive() }[50,90]")), [""; 0]);
    // Contingent bounds say who chooses, whatever they exclude.
    assert_eq!(codes(&scenario("Drive() contingent [20,40]")), [""; 0]);
    assert_eq!(codes(&scenario("Drive() contingent [25,30]")), [""; 0]);
    assert_eq!(codes(&scenario("Drive() contingent [10,30]")), ["E-BOUNDS"]);
    assert_eq!(
        codes(&scenario("{ Drive() contingent [25,30]; delay contingent [1,2] }[20,40]")),
        ["W-SLACK"]
    );
}

#[test]
fn the_option_takes_three_words() {
    let asked = |value: &str| program(&format!("option controllability = {value};")).options.controllability;
    assert_eq!(asked("strong"), Controllability::Strong);
    assert_eq!(asked("dynamic"), Controllability::Dynamic);
    assert_eq!(asked("none"), Controllability::None);
    assert_eq!(program("").options.controllability, Controllability::Dynamic);
    for wrong in ["1", "maybe"] {
        let found = parse(&format!("option controllability = {wrong};")).diagnostics();
        assert_eq!(found.iter().map(|it| it.code.0).collect::<Vec<_>>(), ["E-VALUE"]);
    }
}

/// The warning about `none` comes and goes with the durations that it is about, wherever they stand.
#[test]
fn ignoring_nature_is_warned_of_only_where_nature_chooses_something() {
    let head = "option controllability = none;\nprimitive Drive()[20,40];\n";
    let mut parsed = parse(&format!("{head}scenario S = {{ Drive() }}"));
    assert_eq!(parsed.diagnostics(), []);
    let at = head.len() as u32 - 9;
    let insertion = rmpl::Edit { span: rmpl::Span::new(at, at), text: " contingent ".to_owned() };
    parsed.edit(&insertion);
    assert_eq!(parsed.text().lines().nth(1), Some("primitive Drive() contingent [20,40];"));
    let codes: Vec<&str> = parsed.diagnostics().iter().map(|it| it.code.0).collect();
    assert_eq!(codes, ["W-CONTROLLABILITY"]);
    parsed.edit(&rmpl::Edit { span: rmpl::Span::new(at, at + 12), text: String::new() });
    assert_eq!(parsed.diagnostics(), []);
}

#[test]
fn formatting_is_stable_and_puts_one_blank_around_the_word() {
    let text = "scenario S={Drive()contingent[1,2];delay  contingent   [1,2];X=Y contingent[1,2]}";
    let formatted = format(text);
    assert_eq!(
        formatted,
        "scenario S = { Drive() contingent [1,2]; delay contingent [1,2]; X=Y contingent [1,2] }\n"
    );
    assert_eq!(format(&formatted), formatted);
}

const HEAD: &str = "const LONG = 40;\nvar LIGHT : {ON, OFF};\nlocation BASE (0, 0);\n\
                    primitive Drive(to) contingent [LONG/2,LONG];\nprimitive Dig()[1,2];\n";

/// Returns what completing offers at the cursor, with what it writes.
fn offered(line: &str) -> Vec<(String, String)> {
    let fixture = fixture(&format!("{HEAD}{line}\n"));
    let completion = editor::complete(&parse(&fixture.text), fixture.cursor);
    completion.items.into_iter().map(|item| (item.label, item.insert)).collect()
}

#[test]
fn the_word_is_offered_where_bounds_may_stand_and_nowhere_else() {
    let template = ("contingent".to_owned(), "contingent [$1,$2]$0".to_owned());
    for line in [
        "primitive Talk(x) $0",
        "primitive Talk(x) cont$0",
        "M() = { Dig() $0 }",
        "M() = { LIGHT=ON $0 }",
        "M() = { ask LIGHT=ON co$0 }",
        "M() = { delay $0 }",
        "M() = { Dig(); do Dig() $0 }",
        "M() = { if LIGHT=ON thennext Dig() $0 }",
    ] {
        assert!(offered(line).contains(&template), "{line}: {:?}", offered(line));
    }
    for line in [
        "primitive Talk(x)[1,2] $0",
        "primitive Talk(x) contingent $0",
        "M() = { Dig()[1,2] $0 }",
        "M() = { Dig() contingent $0 }",
        "M() = { { Dig() } $0 }",
        "M() = { do Dig() maintaining LIGHT=ON $0 }",
        "M() = { if LIGHT=ON $0 }",
        "M() = { $0 }",
        "M() = { Drive($0) }",
    ] {
        assert!(offered(line).iter().all(|(label, _)| label != "contingent"), "{line}: {:?}", offered(line));
    }
    let delay = ("delay contingent".to_owned(), "delay contingent [$1,$2]$0".to_owned());
    assert!(offered("M() = { $0 }").contains(&delay));
}

#[test]
fn the_option_and_its_values_are_offered() {
    assert!(offered("option $0").iter().any(|(label, _)| label == "controllability"));
    let mut values: Vec<String> = offered("option controllability = $0").into_iter().map(|it| it.0).collect();
    values.sort();
    assert_eq!(values, ["dynamic", "none", "strong"]);
}

#[track_caller]
fn hovered(line: &str, evaluation: &Evaluation) -> (String, String) {
    let fixture = fixture(&format!("{HEAD}{line}"));
    let hover = editor::hover(&parse(&fixture.text), fixture.cursor, evaluation).expect("a hover");
    (fixture.text[hover.span.range()].to_owned(), hover.markdown)
}

#[test]
fn hovering_tells_what_nature_chooses_and_what_is_left_to_the_executive() {
    let nothing = Evaluation::default();
    for line in ["M() = { Dig() con$0tingent [1+1,LONG] }", "primitive Talk() con$0tingent[2,LONG];"] {
        let (word, markdown) = hovered(line, &nothing);
        assert_eq!(word, "contingent");
        assert!(markdown.contains("the environment chooses the duration"), "{markdown}");
        assert!(markdown.contains("decides the start"), "{markdown}");
        assert!(markdown.contains("**2** to **40**"), "{markdown}");
    }
    // What depends on the call is not shown as one value; where the plan is known, its windows are.
    let line = "M()[l,u] = { Dig() con$0tingent [l,u] }";
    let at = format!("{HEAD}{line}").find("Dig() con").expect("there") as u32;
    let window = EventWindow {
        span: Span::new(at, at + 22),
        event: "Dig#1.end".into(),
        earliest: exact::Time::from(1),
        latest: exact::Bound::Finite(exact::Time::from(9)),
    };
    let evaluation = Evaluation { invocations: Vec::new(), windows: vec![window] };
    let (_, markdown) = hovered(line, &evaluation);
    assert!(!markdown.contains("Uncontrolled duration"), "{markdown}");
    assert!(markdown.contains("Dig#1.end in [1,9]"), "{markdown}");
    let (_, markdown) = hovered("M() = { Dri$0ve(BASE) }", &nothing);
    assert!(markdown.contains("primitive Drive(to) contingent [LONG/2,LONG]"), "{markdown}");
    assert!(markdown.contains("The environment chooses the duration"), "{markdown}");
    let (_, markdown) = hovered("M() = { Di$0g() }", &nothing);
    assert!(!markdown.contains("environment"), "{markdown}");
    let (_, markdown) = hovered("optio$0n strict = 1;", &nothing);
    assert!(markdown.contains("`controllability`"), "{markdown}");
}

#[test]
fn the_word_is_shown_as_one_and_signatures_and_outlines_hold_it() {
    let text =
        format!("{HEAD}primitive contingent();\nM() = {{ contingent() contingent [1,2]; Drive(BASE) }}");
    let parsed = parse(&text);
    let whole = Span::new(0, text.len() as u32);
    let kinds: Vec<HighlightKind> = editor::highlight(&parsed, whole)
        .into_iter()
        .filter(|it| &text[it.span.range()] == "contingent")
        .map(|it| it.kind)
        .collect();
    assert_eq!(
        kinds,
        [HighlightKind::Keyword, HighlightKind::Activity, HighlightKind::Activity, HighlightKind::Keyword]
    );
    let inside = text.find("BASE) }").expect("the call") as u32;
    let signature = editor::signature_at(&parsed, inside).expect("a signature");
    assert_eq!(signature.label, "primitive Drive(to) contingent [LONG/2,LONG]");
    assert_eq!(&signature.label[signature.parameters[0].range()], "to");
    let outline = editor::outline(&parsed);
    let drive = outline.iter().find(|item| item.name == "Drive").expect("it is declared");
    assert_eq!(drive.detail, "(to) contingent [LONG/2,LONG]");
    // The name is renamed everywhere, and the word stays.
    let call = text.find("contingent() contingent").expect("the call") as u32;
    let edits = editor::rename(&parsed, call + 1, "nature").expect("it is a name");
    assert_eq!(edits.len(), 2);
    assert!(editor::rename(&parsed, call + 15, "nature").is_err());
}
