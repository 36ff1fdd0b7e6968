//! What the editor knows of vehicle models, fleets, groups and kinds of parameters (SPEC 17).

use crate::fixture::{self, fixture, renames};
use rmpl::editor::{self, HighlightKind, OutlineKind, RenameProblem};
use rmpl::{Span, parse};

const HEAD: &str = "\
location BASE (0, 0);
model Scout { resource battery 0..9 = 5; state drill : {STOWED, OUT} = STOWED; }
model Digger extends Scout { resource shovel; }
vehicle R1, R2 : Scout at BASE;
vehicle S[1..4] : Digger at BASE;
vehicle T : ATRV at BASE;
group Team = R1, S;
";

/// All of `wanted` are offered at the cursor, and none of `unwanted`.
#[track_caller]
fn completes(line: &str, wanted: &[&str], unwanted: &[&str]) {
    fixture::completes(HEAD, line, wanted, unwanted);
}

#[test]
fn models_fleets_and_their_statements_are_completed() {
    completes("$0", &["model", "group", "vehicle"], &["battery"]);
    completes("model M $0", &["extends"], &["body"]);
    completes("model M extends $0", &["Scout", "ATRV"], &["body"]);
    completes("model M { $0", &["body", "slope", "resource", "state"], &["primitive"]);
    completes("model M { mast 1; $0", &["body", "turning"], &["ATRV"]);
    completes("model M { slope 20 $0", &["degrees"], &["body"]);
    completes("model M { body 2 $0", &["x"], &["mast"]);
    completes("model M { state leg : {IN, OFF} = $0", &["IN", "OFF"], &["STOWED"]);
    completes("vehicle V, W : $0", &["Scout", "Digger", "Blimp"], &["BASE"]);
    completes("vehicle V, W : Scout $0", &["at"], &[]);
    completes("group G = $0", &["R1", "S", "Team", "BASE"], &["Scout"]);
    completes("primitive P(r : $0", &["vehicle", "number", "Scout", "ATRV"], &["R1"]);
    completes("primitive P(r)[1,2] requires r.$0", &["at", "drill", "battery"], &[]);
    completes("primitive P(r)[1,2] uses R1.$0", &["battery"], &["shovel"]);
    completes("primitive P(r)[1,2] uses $0", &["r", "R2"], &["BASE"]);
    completes("primitive P(r)[1,2] requires R1.drill=$0", &["STOWED", "OUT"], &["BASE"]);
    completes("const L = 3; primitive P(r)[1,2] requires R1.battery >= $0", &["L"], &["STOWED"]);
    completes("primitive P(r)[1,2] requires R1.battery >= 3 $0", &["at start", "and", "uses"], &["L"]);
    completes("primitive P(r)[1,2] requires R1.battery >= 3 at $0", &["start"], &["and"]);
    completes("scenario X = { if R1.battery < $0", &[], &["STOWED"]);
    completes("scenario X = { $0", &["any", "each"], &[]);
    completes("scenario X = { any r in $0", &["Team", "S"], &["R1", "BASE"]);
    completes("scenario X = { each r in Team { P($0", &["r", "R1"], &[]);
}

#[track_caller]
fn hovers(line: &str, wanted: &[&str]) {
    fixture::hovers(HEAD, line, wanted);
}

#[test]
fn hovering_shows_declarations_and_what_words_mean() {
    hovers("primitive P(r)[1,2] requires R1.dri$0ll=OUT;", &["model Scout { resource battery"]);
    hovers("vehicle V : Digg$0er at BASE;", &["model Digger extends Scout"]);
    hovers("scenario X = { any r in Te$0am { delay } }", &["group Team = R1, S"]);
    hovers("scenario X = { P(S$0[2]) }", &["vehicle S[1..4] : Digger at BASE"]);
    hovers("scenario X = { an$0y r in Team { delay } }", &["one member"]);
    hovers("scenario X = { ea$0ch r in Team { delay } }", &["every member"]);
    hovers("model M { tur$0ning 3; }", &["tightest turn"]);
    hovers("primitive P(r)[1,2] requires r.bat$0tery >= 3;", &["model Scout { resource battery"]);
    hovers("primitive P(r)[1,2] requires r.battery >$0= 3;", &["just before the start"]);
}

#[test]
fn names_are_renamed_wherever_they_stand() {
    renames(
        "location A (0, 0);\nvehicle S$0[1..2] : ATRV at A;\ngroup G = S, S[1];\nprimitive P(r)[1,2] requires S[1].at=A moves S[2];\nscenario X = { P(S[2]); each r in S P(r) }",
        "Team",
        "location A (0, 0);\nvehicle Team[1..2] : ATRV at A;\ngroup G = Team, Team[1];\nprimitive P(r)[1,2] requires Team[1].at=A moves Team[2];\nscenario X = { P(Team[2]); each r in Team P(r) }",
    );
    renames(
        "resource arm;\nmodel M { resource arm; }\nlocation A (0, 0);\nvehicle R : M at A;\nprimitive P(r)[1,2] uses r.ar$0m, R.arm, arm;",
        "tool",
        "resource arm;\nmodel M { resource tool; }\nlocation A (0, 0);\nvehicle R : M at A;\nprimitive P(r)[1,2] uses r.tool, R.tool, arm;",
    );
    renames(
        "resource Fu$0el 0..9 = 5;\nprimitive P()[1,2] requires Fuel >= 3 at start consumes Fuel 1;\nscenario X = { if Fuel < 2 thennext P() }",
        "Tank",
        "resource Tank 0..9 = 5;\nprimitive P()[1,2] requires Tank >= 3 at start consumes Tank 1;\nscenario X = { if Tank < 2 thennext P() }",
    );
    renames(
        "model M { mast 1; }\nmodel N extends M { mast 2; }\nlocation A (0, 0);\nvehicle R : M at A;\nprimitive P(r : M$0)[1,2];",
        "Scout",
        "model Scout { mast 1; }\nmodel N extends Scout { mast 2; }\nlocation A (0, 0);\nvehicle R : Scout at A;\nprimitive P(r : Scout)[1,2];",
    );
    renames(
        "scenario X = { each r$0 in G { P(r); r.at=A } }",
        "rover",
        "scenario X = { each rover in G { P(rover); rover.at=A } }",
    );
    renames(
        "model M { state leg : {IN, OFF} = IN; }\nlocation A (0, 0);\nvehicle R : M at A;\nprimitive P(r)[1,2] requires r.leg=I$0N sets R.leg=OFF;",
        "INSIDE",
        "model M { state leg : {INSIDE, OFF} = INSIDE; }\nlocation A (0, 0);\nvehicle R : M at A;\nprimitive P(r)[1,2] requires r.leg=INSIDE sets R.leg=OFF;",
    );
    let built_in = fixture("location A (0, 0);\nvehicle R : AT$0RV at A;");
    let refused = editor::rename(&parse(&built_in.text), built_in.cursor, "Tank");
    assert_eq!(refused, Err(RenameProblem::Fixed));
}

#[test]
fn the_outline_lists_each_vehicle() {
    let outline = editor::outline(&parse(HEAD));
    let found: Vec<(OutlineKind, &str, &str)> =
        outline.iter().map(|item| (item.kind, item.name.as_str(), item.detail.as_str())).collect();
    assert_eq!(
        found,
        [
            (OutlineKind::Location, "BASE", "(0, 0)"),
            (OutlineKind::Model, "Scout", ""),
            (OutlineKind::Model, "Digger", "extends Scout"),
            (OutlineKind::Vehicle, "R1", ": Scout at BASE"),
            (OutlineKind::Vehicle, "R2", ": Scout at BASE"),
            (OutlineKind::Group, "S", "[1..4] : Digger at BASE"),
            (OutlineKind::Vehicle, "T", ": ATRV at BASE"),
            (OutlineKind::Group, "Team", "R1, S"),
        ]
    );
}

#[test]
fn words_and_names_of_fleets_are_highlighted() {
    let text = "model M { resource arm; mast 1; }\nscenario X = { each r in S unordered P(r, S[2]) }";
    let parse = parse(text);
    let kind = |word: &str| {
        let start = text.find(word).expect("it is there") as u32;
        let found = editor::highlight(&parse, Span::new(0, text.len() as u32));
        found.into_iter().find(|it| it.span.start == start).map(|it| it.kind)
    };
    assert_eq!(kind("model"), Some(HighlightKind::Keyword));
    assert_eq!(kind("M {"), Some(HighlightKind::Vehicle));
    assert_eq!(kind("arm"), Some(HighlightKind::Variable));
    assert_eq!(kind("mast"), Some(HighlightKind::Keyword));
    assert_eq!(kind("each"), Some(HighlightKind::Keyword));
    assert_eq!(kind("r in"), Some(HighlightKind::Parameter));
    assert_eq!(kind("S unordered"), Some(HighlightKind::Vehicle));
    assert_eq!(kind("unordered"), Some(HighlightKind::Keyword));
    assert_eq!(kind("S[2]"), Some(HighlightKind::Vehicle));
}

#[test]
fn a_parameter_with_a_kind_is_one_parameter_of_a_signature() {
    let fixture = fixture("primitive Drive(r : vehicle, to)[20,30];\nscenario S = { Drive(R1, $0");
    let signature = editor::signature_at(&parse(&fixture.text), fixture.cursor).expect("a signature");
    let parameters: Vec<&str> = signature.parameters.iter().map(|it| &signature.label[it.range()]).collect();
    assert_eq!((parameters.as_slice(), signature.active), (["r : vehicle", "to"].as_slice(), 1));
}
