//! Durations that nature chooses: where they are written, what the program says of them, and that their word is not taken
//! from a mission that uses it as a name (SPEC 13.1).

use rmpl::program::{Bounds, Controllability, Program, Statement, StatementKind};
use rmpl::{Severity, format, parse};

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

/// The bounds as they are written, with `~` before those that are nature's.
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
    // Nature is not narrowed: around the call, its whole range still counts.
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
