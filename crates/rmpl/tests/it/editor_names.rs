//! Navigation, renaming and highlighting.

use crate::fixture::{apply, fixture};
use rmpl::editor::{self, HighlightKind, RenameProblem};
use rmpl::{Span, parse};

/// The cursor's name has exactly the marked places; the one labeled `def` is its definition.
#[track_caller]
fn check_references(written: &str) {
    let fixture = fixture(written);
    let parse = parse(&fixture.text);
    let found = editor::references(&parse, fixture.cursor);
    let found: Vec<(Span, bool)> = found.iter().map(|place| (place.span, place.is_definition)).collect();
    let wanted: Vec<(Span, bool)> =
        fixture.marks.iter().map(|(span, label)| (*span, label == "def")).collect();
    assert_eq!(found, wanted);
    let definition = wanted.iter().find(|(_, is_definition)| *is_definition).map(|(span, _)| *span);
    assert_eq!(editor::definition(&parse, fixture.cursor), definition);
}

#[track_caller]
fn check_rename(before: &str, new_name: &str, after: &str) {
    let before = fixture(before);
    let edits = editor::rename(&parse(&before.text), before.cursor, new_name).unwrap();
    assert_eq!(apply(&before.text, &edits), fixture(after).text);
}

#[track_caller]
fn check_rename_refused(before: &str, new_name: &str, problem: RenameProblem) {
    let before = fixture(before);
    assert_eq!(editor::rename(&parse(&before.text), before.cursor, new_name), Err(problem));
}

#[test]
fn a_location_is_renamed_where_it_has_to_be_in_sight() {
    check_rename(
        "location BASE (0, 0);\nvehicle R : ATRV at BASE;\nprimitive A(p)[1,2] requires R.at in visible(BA$0SE) and R.at in visible(p);\nscenario S = { A(BASE) }",
        "CAMP",
        "location CAMP (0, 0);\nvehicle R : ATRV at CAMP;\nprimitive A(p)[1,2] requires R.at in visible(CAMP) and R.at in visible(p);\nscenario S = { A(CAMP) }",
    );
}

#[test]
fn an_activity_is_found_in_calls_with_and_without_parentheses() {
    check_references(
        "\
primitive Drive()[1,2];
//        ^^^^^ def
M() = { Drive() }
//      ^^^^^
scenario S = { Dri$0ve; Drive-Home() }
//             ^^^^^
",
    );
}

#[test]
fn a_variable_is_found_inside_a_condition_written_with_an_underscore() {
    check_references(
        "\
var PATH1 : {OK, BAD};
//  ^^^^^ def
M() = { do { A() } maintaining PATH1_OK }
//                             ^^^^^
scenario S = { PATH$01=OK [1,2]; PATH1_2 }
//             ^^^^^
",
    );
}

#[test]
fn a_value_is_found_for_its_variable_only() {
    check_references(
        "\
var P : {OK, BAD};
//       ^^ def
var Q : {OK, BAD};
scenario S = { P=O$0K [1,2]; Q=OK; not(P_OK) }
//               ^^
//                                     ^^
",
    );
}

#[test]
fn parameters_and_bound_names_stay_in_their_declaration() {
    check_references(
        "\
M(x)[l,u] = { do { A(x)[$0l*90%,u-l] } maintaining x }
//   ^ def
//                      ^
//                              ^
N(x)[l,u] = { A(x)[l,u] }
",
    );
}

#[test]
fn a_location_is_found_where_it_is_visited_and_where_a_vehicle_starts() {
    check_references(
        "\
location BASE (0, 0);
//       ^^^^ def
vehicle R : ATRV at BASE;
//                  ^^^^
scenario S = { Drive(BAS$0E) }
//                   ^^^^
",
    );
}

#[test]
fn a_constant_is_found_in_every_expression() {
    check_references(
        "\
const D$0AY = 24 * 60;
//    ^^^ def
const WEEK = 7 * DAY;
//               ^^^
primitive Drive(n)[n,DAY];
//                   ^^^
M(n)[l,DAY] = { Drive(DAY + 1)[l,2*DAY]; repeat DAY { Drive(DAY) }; Drive(WEEK) }
//     ^^^
//                    ^^^
//                                 ^^^
//                                              ^^^
//                                                          ^^^
scenario S[0,DAY] = { M(DAY=on); N() }
//           ^^^
",
    );
}

#[test]
fn a_parameter_is_found_in_bounds_conditions_and_behind_moves() {
    check_references(
        "\
primitive Drive(v, n)[n,2*n] moves v$0, R;
//              ^ def
//                                 ^
",
    );
    check_references(
        "\
M(x$0)[l,u] = { A(x+1)[x,u]; repeat x { B() }; do C() maintaining P=x and X in {a, x} }
//^ def
//              ^
//                   ^
//                                ^
//                                                                ^
//                                                                               ^
",
    );
}

#[test]
fn a_vehicle_is_found_where_it_is_handed_over_and_a_value_in_a_set() {
    check_references(
        "\
vehicle Scout : ATRV at BASE;
//      ^^^^^ def
scenario S = { Drive(Sco$0ut, BASE); Drive(Other, BASE) }
//                   ^^^^^
",
    );
    check_references(
        "\
var P : {OK, BAD};
//       ^^ def
scenario S = { P in {O$0K, BAD} [1,2]; Q in {OK, BAD}; ask P=BAD or P=OK }
//                   ^^
//                                                                  ^^
",
    );
}

#[test]
fn names_are_found_in_a_broken_program() {
    check_references(
        "\
primitive Drive( [1,2;
//        ^^^^^ def
scenario S = { { Drive(; Dr$0ive() }
//               ^^^^^
//                       ^^^^^
",
    );
}

#[test]
fn renaming_a_constant_changes_the_headers_that_name_it() {
    check_rename(
        "const H$0OUR = 60;\nprimitive A(n)[n,HOUR];\nM()[HOUR,u] = { A(HOUR*2)[0,u-HOUR] }\n",
        "SIXTY",
        "const SIXTY = 60;\nprimitive A(n)[n,SIXTY];\nM()[SIXTY,u] = { A(SIXTY*2)[0,u-SIXTY] }\n",
    );
}

#[test]
fn renaming_a_variable_changes_both_ways_of_writing_it() {
    check_rename(
        "var PA$0TH : {OK};\nscenario S = { do { A() } maintaining PATH_OK, PATH=OK [1,2] }",
        "ROAD",
        "var ROAD : {OK};\nscenario S = { do { A() } maintaining ROAD_OK, ROAD=OK [1,2] }",
    );
}

#[test]
fn renaming_is_refused_where_it_would_break_the_text() {
    let text = "M()[l$0,u] = { A()[l,u] }";
    check_rename_refused(text, "l-1", RenameProblem::HyphenInBounds);
    check_rename_refused(text, "u", RenameProblem::Taken);
    check_rename_refused(text, "do", RenameProblem::Keyword);
    check_rename_refused(text, "1a", RenameProblem::NoName);
    check_rename_refused("option str$0ict = 1;", "lax", RenameProblem::Fixed);
    check_rename_refused("scenario S $0 = { }", "T", RenameProblem::NothingHere);
}

#[test]
fn each_name_is_shown_as_what_it_stands_for() {
    use HighlightKind as Kind;
    let fixture = fixture(
        "\
var P : {OK};
//  ^ Variable
//       ^^ Value
primitive Drive(to)[1,2] moves R;
//        ^^^^^ Activity
//              ^^ Parameter
//                       ^^^^^ Keyword
//                             ^ Vehicle
M(x)[l,u] = { do { Drive(x)[l*90%,u] } maintaining P_OK } // done
//   ^ BoundName
//                       ^ Parameter
//                          ^ BoundName
//                                                 ^ Variable
//                                                   ^^ Value
//                                                        ^^^^^^^ Comment
",
    );
    let parse = parse(&fixture.text);
    let all = editor::highlight(&parse, Span::new(0, fixture.text.len() as u32));
    let kind_at = |span: Span| all.iter().find(|found| found.span == span).map(|found| found.kind);
    let kinds = [
        Kind::Variable,
        Kind::Value,
        Kind::Activity,
        Kind::Parameter,
        Kind::Keyword,
        Kind::Vehicle,
        Kind::BoundName,
        Kind::Comment,
    ];
    for (span, label) in &fixture.marks {
        let wanted = kinds.iter().find(|kind| format!("{kind:?}") == *label);
        assert_eq!(kind_at(*span).as_ref(), wanted, "{label} at {span:?}");
    }
    let sorted = all.windows(2).all(|pair| pair[0].span.end <= pair[1].span.start);
    assert!(sorted, "highlights do not overlap");
}

#[test]
fn highlighting_a_range_gives_what_the_whole_gives_there() {
    let text = include_str!("../../../../assets/missions/enroute.rmpl");
    let parse = parse(text);
    let all = editor::highlight(&parse, Span::new(0, text.len() as u32));
    for start in (0..text.len() as u32 - 200).step_by(97) {
        let range = Span::new(start, start + 200);
        let part = editor::highlight(&parse, range);
        let wanted =
            all.iter().filter(|found| found.span.start >= range.start && found.span.end <= range.end);
        assert!(wanted.clone().all(|found| part.contains(found)));
    }
}
