//! What the editor knows of states, resources, objectives and the places of vehicles.

use crate::fixture::{self, fixture, renames};
use rmpl::editor::{self, FoldKind, HighlightKind, OutlineKind};
use rmpl::{Span, parse};

const HEAD: &str = "\
const DEPTH = 3;
state ARM : {STOWED, OUT} = STOWED;
var LIGHT : {ON, OFF};
resource Power capacity 3;
resource Battery 0..100 = 40;
location BASE (0, 0);
vehicle Scout : ATRV at BASE;
primitive Deploy()[1,2] requires at start ARM=STOWED sets ARM=OUT uses Power 2;
";

/// All of `wanted` are offered at the cursor, and none of `unwanted`.
#[track_caller]
fn completes(line: &str, wanted: &[&str], unwanted: &[&str]) {
    fixture::completes(HEAD, line, wanted, unwanted);
}

#[test]
fn declarations_are_completed_word_by_word() {
    completes("$0", &["state", "resource", "objective", "var"], &["ARM", "requires"]);
    completes("state TOOL : {NONE, DRILL} = $0", &["NONE", "DRILL"], &["ARM", "TOOL"]);
    completes("state TOOL : $0", &[], &["NONE", "state"]);
    completes("resource Crew $0", &["capacity", "DEPTH"], &["Power", "per"]);
    completes("resource Crew capacity $0", &["DEPTH"], &["capacity"]);
    completes("resource Crew 0..$0", &["DEPTH"], &["capacity"]);
    completes("resource Crew 0..9 = $0", &["DEPTH"], &["capacity"]);
    completes("objective $0", &["minimize", "maximize"], &["cost"]);
    completes("objective minimize $0", &["cost", "reward", "end", "length"], &["maximize", "DEPTH"]);
    completes("objective minimize 2 * co$0", &["cost"], &["end"]);
    completes("objective minimize cost, m$0", &["minimize", "maximize"], &["reward"]);
}

#[test]
fn clauses_are_completed_by_what_they_are_about() {
    let words = ["requires", "sets", "uses", "consumes", "produces", "costs", "rewards", "moves", "runs"];
    completes("primitive Dig(s)[1,2] $0", &words, &["ARM", "Power", "per"]);
    completes("primitive Dig(s)[1,2] re$0", &["requires", "rewards"], &["sets"]);
    completes(
        "primitive Dig(s)[1,2] requires $0",
        &["ARM", "LIGHT", "Scout.at", "s", "not", "at start"],
        &["Power", "Deploy", "BASE", "choose"],
    );
    completes("primitive Dig(s)[1,2] requires at start $0", &["ARM", "Scout.at"], &["Power", "at start"]);
    completes("primitive Dig(s)[1,2] requires ARM=$0", &["STOWED", "OUT", "s"], &["ARM", "BASE"]);
    completes("primitive Dig(s)[1,2] requires ARM=OUT $0", &["and", "sets", "uses"], &["ARM", "or"]);
    completes("primitive Dig(s)[1,2] requires ARM=OUT, $0", &["LIGHT", "not"], &["Power"]);
    completes("primitive Dig(s)[1,2] requires ARM=OUT and $0", &["LIGHT"], &["sets"]);
    completes("primitive Dig(s)[1,2] requires ARM in {$0", &["STOWED", "OUT"], &["ARM"]);
    completes("primitive Dig(s)[1,2] requires Scout.$0", &["at"], &["ARM", "start"]);
    completes("primitive Dig(s)[1,2] requires Scout.at=$0", &["BASE", "s"], &["OUT", "Scout"]);
    completes("primitive Dig(s)[1,2] requires Scout.at in {$0", &["BASE"], &["OUT"]);
    completes("primitive Dig(s)[1,2] requires Scout.at in $0", &["visible", "{ … }"], &["BASE", "sets"]);
    completes("primitive Dig(s)[1,2] requires Scout.at in visible($0", &["BASE", "s"], &["ARM", "Scout"]);
    completes("scenario S[0,9] = { ask Scout.at in visible($0", &["BASE"], &["ARM", "Scout"]);
    completes("primitive Dig(s)[1,2] sets $0", &["ARM", "Scout.at", "s"], &["LIGHT", "Power", "not"]);
    completes("primitive Dig(s)[1,2] sets ARM=$0", &["STOWED", "OUT"], &["BASE"]);
    completes("primitive Dig(s)[1,2] sets ARM=OUT, $0", &["ARM", "Scout.at"], &["LIGHT"]);
    completes("primitive Dig(s)[1,2] sets ARM=OUT $0", &["uses", "costs"], &["ARM", "and"]);
    completes("primitive Dig(s)[1,2] sets Scout.at=$0", &["BASE", "s"], &["OUT"]);
    completes("primitive Dig(s)[1,2] uses $0", &["Power", "Battery", "s"], &["ARM", "DEPTH"]);
    completes("primitive Dig(s)[1,2] uses Power $0", &["DEPTH", "s", "consumes"], &["Power"]);
    completes("primitive Dig(s)[1,2] uses Power 2, $0", &["Battery"], &["DEPTH"]);
    completes("primitive Dig(s)[1,2] consumes Battery 2 $0", &["per", "sets"], &["DEPTH", "Battery"]);
    completes("primitive Dig(s)[1,2] consumes Battery 2 * $0", &["DEPTH", "s"], &["per"]);
    completes("primitive Dig(s)[1,2] consumes Battery 2 per $0", &["minute", "hour", "metre"], &["DEPTH"]);
    completes("primitive Dig(s)[1,2] consumes Battery 2 per minute $0", &["sets"], &["per", "minute"]);
    completes("primitive Dig(s)[1,2] costs $0", &["DEPTH", "s"], &["Power"]);
    completes("primitive Dig(s)[1,2] moves Scout $0", &["speed", "requires", "runs"], &["Scout"]);
    completes("primitive Dig(s)[1,2] moves Scout speed (1, 2) $0", &["requires", "runs"], &["speed"]);
}

#[test]
fn statements_offer_what_is_optional_unordered_and_used() {
    completes("M(x) = { $0 }", &["optional", "unordered", "do … using", "ARM", "Scout.at"], &["Power"]);
    completes("M(x) = { optional $0 }", &["Deploy", "choose"], &["Power"]);
    completes("M(x) = { do Deploy() $0 }", &["maintaining", "watching", "using"], &["Power"]);
    completes("M(x) = { do Deploy() using $0 }", &["Power", "Battery"], &["ARM", "Deploy"]);
    completes("M(x) = { do Deploy() maintaining Scout.$0 }", &["at"], &["ARM"]);
    completes("M(x) = { do Deploy() maintaining Scout.at=$0 }", &["BASE", "x"], &["OUT"]);
    completes("M(x) = { ask ARM=$0 }", &["OUT", "STOWED", "x"], &["ARM"]);
}

#[track_caller]
fn hovers(line: &str, wanted: &[&str]) {
    fixture::hovers(
        &format!("{HEAD}primitive Dig(s)[1,2] requires ARM=OUT, Scout.at=s consumes Battery 2;\n"),
        line,
        wanted,
    );
}

#[test]
fn hovering_tells_what_lasts_who_changes_it_and_who_needs_it() {
    hovers(
        "M() = { ask AR$0M=OUT; do Deploy() watching ARM=STOWED }",
        &[
            "```rmpl\nstate ARM : {STOWED, OUT} = STOWED\n```",
            "Set by `Deploy`",
            "Needed by `Deploy`, `Dig`, `M`",
        ],
    );
    hovers("M() = { AR$0M=OUT }", &["Set by `Deploy`, `M`", "Needed by `Deploy`, `Dig`"]);
    hovers("M() = { do Deploy() using Po$0wer }", &["resource Power capacity 3", "Used by `Deploy`, `M`"]);
    hovers(
        "primitive C()[1,2] produces Bat$0tery 3;",
        &["0..100 = 40", "Consumed by `Dig`", "Produced by `C`"],
    );
    hovers(
        "primitive D(to)[1,2] moves Scout; M() = { ask Sco$0ut.at=BASE }",
        &["vehicle Scout", "Moved by `D`", "`Scout.at`: needed by `Dig`, `M`"],
    );
    hovers("objective minimize co$0st;", &["total cost of the selected activities"]);
    hovers("primitive A()[1,2] con$0sumes Battery 1;", &["when the activity starts"]);
    hovers("M() = { opt$0ional Deploy() }", &["may include or skip A"]);
    hovers("sta$0te T : {A, B} = A;", &["keeps its value"]);
    hovers("M() = { ask Scout.a$0t=BASE }", &["the location of the vehicle V"]);
}

/// The cursor's name has exactly the marked places; the one labeled `def` is its definition.
#[track_caller]
fn references(written: &str) {
    let fixture = fixture(written);
    let found = editor::references(&parse(&fixture.text), fixture.cursor);
    let found: Vec<(Span, bool)> = found.iter().map(|place| (place.span, place.is_definition)).collect();
    let wanted: Vec<(Span, bool)> =
        fixture.marks.iter().map(|(span, label)| (*span, label == "def")).collect();
    assert_eq!(found, wanted);
}

#[test]
fn states_and_their_values_are_found_in_clauses() {
    references(
        "\
state ARM : {IN, OUT} = IN;
//    ^^^ def
primitive P(s)[1,2] requires ARM=OUT and not AR$0M=IN sets ARM=OUT;
//                           ^^^
//                                           ^^^
//                                                       ^^^
M(ARM) = { ask ARM=IN }
N() = { do P(1) watching ARM_OUT }
//                       ^^^
",
    );
    references(
        "\
state ARM : {IN, OUT} = IN;
//               ^^^ def
state LEG : {OUT, IN} = OUT;
primitive P(OUT)[1,2] requires ARM=OUT;
primitive Q()[1,2] requires ARM=OUT sets ARM=OU$0T;
//                              ^^^
//                                           ^^^
N() = { do P(1) watching ARM_OUT }
//                           ^^^
",
    );
    references(
        "\
state ARM : {IN, OUT} = I$0N;
//           ^^ def
//                      ^^
",
    );
}

#[test]
fn vehicles_and_locations_are_found_in_places() {
    references(
        "\
location A (1, 2);
vehicle Scout : ATRV at A;
//      ^^^^^ def
primitive D(to)[1,2] moves Scout;
//                         ^^^^^
primitive P(Scout)[1,2] requires Scout.at=A;
primitive Q()[1,2] requires Sc$0out.at=A sets Scout.at=A;
//                          ^^^^^
//                                          ^^^^^
M() = { Scout.at in {A} }
//      ^^^^^
",
    );
    references(
        "\
location A (1, 2);
//       ^ def
vehicle V : ATRV at A;
//                  ^
primitive Q(v)[1,2] requires V.at=A, v.at in {A$0, B} sets V.at=A;
//                                ^
//                                            ^
//                                                            ^
",
    );
}

#[test]
fn resources_are_found_where_something_is_done_to_them() {
    references(
        "\
resource Power capacity Power;
//       ^^^^^ def
const Power = 3;
primitive P()[1,2] uses Power Power, Other consumes Power 2;
//                      ^^^^^
//                                                  ^^^^^
M() = { do P() using Po$0wer Power; do P() maintaining Power }
//                   ^^^^^
",
    );
}

#[test]
fn renaming_reaches_every_clause() {
    renames(
        "state AR$0M : {IN, OUT} = IN;\nprimitive P()[1,2] requires ARM_IN sets ARM=OUT;\n",
        "LEG",
        "state LEG : {IN, OUT} = IN;\nprimitive P()[1,2] requires LEG_IN sets LEG=OUT;\n",
    );
    renames(
        "state ARM : {IN, OUT} = IN;\nprimitive P()[1,2] requires ARM_I$0N sets ARM=IN;\n",
        "STOWED",
        "state ARM : {STOWED, OUT} = STOWED;\nprimitive P()[1,2] requires ARM_STOWED sets ARM=STOWED;\n",
    );
    renames(
        "location A (1, 2);\nvehicle Scout : ATRV at A;\nM() = { ask Sco$0ut.at=A; do delay watching not (Scout.at=A) }\n",
        "Rover-1",
        "location A (1, 2);\nvehicle Rover-1 : ATRV at A;\nM() = { ask Rover-1.at=A; do delay watching not (Rover-1.at=A) }\n",
    );
    renames(
        "resource Power;\nM() = { do delay using Pow$0er }\n",
        "Drill",
        "resource Drill;\nM() = { do delay using Drill }\n",
    );
    renames(
        "primitive P(v$0, n)[1,2] requires v.at=n sets v.at=n costs n;\n",
        "rover",
        "primitive P(rover, n)[1,2] requires rover.at=n sets rover.at=n costs n;\n",
    );
}

#[test]
fn the_words_of_clauses_are_shown_as_words() {
    use HighlightKind as Kind;
    let fixture = fixture(
        "\
state ARM : {IN} = IN;
//^^^ Keyword
//    ^^^ Variable
//           ^^ Value
//                 ^^ Value
  resource Power 0..9 = 3;
//^^^^^^^^ Keyword
//         ^^^^^ Variable
//                ^^ Operator
  objective maximize reward;
//^^^^^^^^^ Keyword
//          ^^^^^^^^ Keyword
//                   ^^^^^^ Keyword
primitive P(s)[1,2] requires at start V.at=s sets ARM=s uses Power s per minute;
//                  ^^^^^^^^ Keyword
//                           ^^ Keyword
//                              ^^^^^ Keyword
//                                    ^ Vehicle
//                                      ^^ Keyword
//                                         ^ Parameter
//                                           ^^^^ Keyword
//                                                ^^^ Variable
//                                                    ^ Parameter
//                                                      ^^^^ Keyword
//                                                           ^^^^^ Variable
//                                                                 ^ Parameter
//                                                                   ^^^ Keyword
//                                                                       ^^^^^^ Keyword
M() = { optional P(1); unordered { P(1) }; do P(1) using Power }
//      ^^^^^^^^ Keyword
//                     ^^^^^^^^^ Keyword
//                                                 ^^^^^ Keyword
//                                                       ^^^^^ Variable
",
    );
    let all = editor::highlight(&parse(&fixture.text), Span::new(0, fixture.text.len() as u32));
    let kinds = [Kind::Variable, Kind::Value, Kind::Parameter, Kind::Keyword, Kind::Vehicle, Kind::Operator];
    for (span, label) in &fixture.marks {
        let wanted = kinds.iter().find(|kind| format!("{kind:?}") == *label);
        let found = all.iter().find(|found| found.span.end == span.end).map(|found| found.kind);
        assert_eq!(found.as_ref(), wanted, "{label} at {:?}", &fixture.text[span.range()]);
    }
}

#[test]
fn the_outline_and_the_folds_know_states_and_resources() {
    let text = "state ARM : {IN,\n OUT} = IN;\nstate LEG : {A, B} = A;\nresource Power capacity 3;\nresource Fuel 0..9 = 3;\n";
    let parse = parse(text);
    let outline: Vec<_> =
        editor::outline(&parse).into_iter().map(|item| (item.kind, item.name, item.detail)).collect();
    let item = |kind, name: &str, detail: &str| (kind, name.to_owned(), detail.to_owned());
    assert_eq!(
        outline,
        [
            item(OutlineKind::State, "ARM", ": {IN, OUT} = IN"),
            item(OutlineKind::State, "LEG", ": {A, B} = A"),
            item(OutlineKind::Resource, "Power", "capacity 3"),
            item(OutlineKind::Resource, "Fuel", "0..9 = 3"),
        ]
    );
    let folds: Vec<(FoldKind, usize)> = editor::folds(&parse)
        .into_iter()
        .map(|fold| (fold.kind, text[fold.span.range()].matches('\n').count()))
        .collect();
    assert_eq!(folds, [(FoldKind::Declarations, 2), (FoldKind::Braces, 1), (FoldKind::Declarations, 1)]);
}

#[test]
fn a_signature_shows_the_clauses() {
    let fixture =
        fixture("primitive Dig(site, n)[1,2] requires V.at=site uses Power n;\nM() = { Dig(A, $0 }");
    let signature = editor::signature_at(&parse(&fixture.text), fixture.cursor).expect("a signature");
    assert_eq!(signature.label, "primitive Dig(site, n)[1,2] requires V.at=site uses Power n");
    assert_eq!(signature.active, 1);
}
