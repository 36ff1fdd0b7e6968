//! Drawing as edits of a text.

use rmpl::Span;

use super::{Change, Place, Wrapping, draw, neighbor};

/// The span of a piece of the text.
fn at(text: &str, piece: &str) -> Span {
    let start = text.find(piece).unwrap_or_else(|| panic!("no {piece} in {text}"));
    Span::new(start as u32, (start + piece.len()) as u32)
}

/// The only file.
fn only_file(parse: &rmpl::Parse) -> Span {
    Span::new(0, parse.text().len() as u32)
}

fn changed(text: &str, change: &Change) -> String {
    let parse = rmpl::parse(text);
    draw(&parse, only_file(&parse), change)
        .unwrap_or_else(|reason| panic!("{change:?}: {reason}\n{text}"))
        .apply(text)
}

/// Changes the body of a scenario, and returns the new body.
fn body(body: &str, change: impl Fn(&str) -> Change) -> String {
    let text = format!("scenario S = {{{body}}}\n");
    let changed = changed(&text, &change(&text));
    let inner = changed.strip_prefix("scenario S = {").and_then(|it| it.strip_suffix("}\n"));
    inner.unwrap_or_else(|| panic!("{changed}")).to_owned()
}

fn insert(at: Place) -> Change {
    Change::Insert { text: "N()".to_owned(), at }
}

const LINES: &str = "\n  A();\n  B(), C(); // both\n  D()\n";

#[test]
fn what_is_added_stands_in_a_line_of_its_own_where_the_others_do() {
    let add =
        |piece: &'static str, place: fn(Span) -> Place| body(LINES, |text| insert(place(at(text, piece))));
    assert_eq!(add("A()", Place::After), LINES.replace("A();\n", "A();\n  N();\n"));
    assert_eq!(add("A()", Place::Before), LINES.replace("A();\n", "N();\n  A();\n"));
    assert_eq!(add("D()", Place::After), LINES.replace("D()", "D();\n  N()"));
    assert_eq!(add("D()", Place::Before), LINES.replace("D()", "N();\n  D()"));
    assert_eq!(add("C()", Place::After), LINES.replace("C()", "{ C(); N() }"));
    assert_eq!(add("B()", Place::Beside), LINES.replace("B(),", "B(), N(),"));
    assert_eq!(add("A()", Place::Beside), LINES.replace("A()", "{ A(), N() }"));
    assert_eq!(add("D()", |_| Place::End), LINES.replace("D()", "D();\n  N()"));
    let instead = LINES.replace("A();", "choose {\n    A(),\n    N()\n  };");
    assert_eq!(add("A()", Place::Instead), instead);
}

#[test]
fn what_is_added_in_a_line_of_others_stays_in_it() {
    let add =
        |text: &'static str, place: fn(Span) -> Place| body(text, |text| insert(place(at(text, "A()"))));
    assert_eq!(add(" A(); B() ", Place::After), " A(); N(); B() ");
    assert_eq!(add(" B(); A() ", Place::After), " B(); A(); N() ");
    assert_eq!(add(" A() ", Place::Beside), " A(), N() ");
    assert_eq!(add(" optional A() ", Place::After), " optional { A(); N() } ");
    assert_eq!(add(" choose { A(), B() } ", Place::Instead), " choose { A(), N(), B() } ");
    assert_eq!(add(" choose { A(), B() } ", Place::After), " choose { A(); N(), B() } ");
    assert_eq!(add(" A(); B() ", |_| Place::Thread), " {\n  A(); B()\n},\nN() ");
}

#[test]
fn an_empty_scenario_and_a_text_without_one_take_the_first_activity() {
    let text = "scenario S = { }\n";
    assert_eq!(changed(text, &insert(Place::End)), "scenario S = {\n  N()\n}\n");
    let text = "location A (1, 2);\n";
    let expected = "location A (1, 2);\n\nscenario Mission = {\n  N()\n}\n";
    assert_eq!(changed(text, &insert(Place::Thread)), expected);
    let new = Change::New { at: Place::End };
    let expected = "primitive Activity1()[1,5];\n\nscenario Mission = {\n  Activity1()\n}\n";
    assert_eq!(changed("", &new), expected);
    let drawn = draw(&rmpl::parse(""), Span::default(), &new).expect("it can be drawn");
    let named: Vec<&str> = drawn.typed_over.iter().map(|span| &expected[span.range()]).collect();
    assert_eq!(named, ["Activity1", "Activity1"], "a name that is typed goes to both");
}

#[test]
fn what_would_be_empty_goes_with_what_is_deleted() {
    let delete = |text: &'static str| body(text, |text| Change::Delete(at(text, "A()")));
    assert_eq!(delete("\n  A();\n  B()\n"), "\n  B()\n");
    assert_eq!(delete("\n  B(); // first\n  A()\n"), "\n  B() // first\n");
    assert_eq!(delete(" A(); B() "), " B() ");
    assert_eq!(delete(" B(), A() "), " B() ");
    assert_eq!(delete(" B(); optional A()[1,2] "), " B() ");
    assert_eq!(delete(" B(); choose { A(), C() } "), " B(); choose { C() } ");
    assert_eq!(delete(" B(); choose { A() } "), " B() ");
    assert_eq!(delete(" choose { optional A(), B() } "), " choose { B() } ");
    assert_eq!(delete(" { A() }; B() "), " B() ");
    assert_eq!(delete(" A() "), " ");
}

#[test]
fn what_is_moved_takes_its_bounds_and_its_name_along() {
    let to = |text: &'static str, place: fn(Span) -> Place, what: &'static str| {
        body(text, |text| Change::Move { what: at(text, "A()"), at: place(at(text, what)) })
    };
    assert_eq!(to(" A()[1,2] as X; B(); C() ", Place::After, "C()"), " B(); C(); A()[1,2] as X ");
    assert_eq!(to(" B(); C(); A() ", Place::Before, "B()"), " A(); B(); C() ");
    assert_eq!(to("\n  B();\n  A()\n", Place::Beside, "B()"), "\n  { B(), A() }\n");
    assert_eq!(to("\n  A();\n  B();\n  C()\n", Place::After, "B()"), "\n  B();\n  A();\n  C()\n");
    assert_eq!(to(" A(), B() ", Place::After, "B()"), " { B(); A() } ");
    let parse = rmpl::parse("scenario S = { A(); B() }");
    let same = Change::Move { what: at(parse.text(), "B()"), at: Place::After(at(parse.text(), "A()")) };
    assert_eq!(draw(&parse, only_file(&parse), &same), Err("Already there".to_owned()));
    let inside = Change::Move { what: at(parse.text(), "A()"), at: Place::After(at(parse.text(), "A()")) };
    assert!(draw(&parse, only_file(&parse), &inside).is_err());
    assert_eq!(neighbor(&parse, at(parse.text(), "A()"), true), Some(at(parse.text(), "B()")));
    assert_eq!(neighbor(&parse, at(parse.text(), "A()"), false), None);
}

#[test]
fn constructs_are_put_around_statements_and_taken_away() {
    let wrap = |text: &'static str, wrapping: Wrapping| {
        body(text, |text| Change::Wrap(at(text, "A()"), wrapping.clone()))
    };
    assert_eq!(wrap(" A()[1,2]; B() ", Wrapping::Optional), " optional A()[1,2]; B() ");
    assert_eq!(wrap("\n  A();\n  B()\n", Wrapping::Choose), "\n  choose {\n    A()\n  };\n  B()\n");
    let unordered = "\n  unordered {\n    A();\n    B()\n  }\n";
    assert_eq!(wrap("\n  A();\n  B()\n", Wrapping::Unordered), unordered);
    let maintaining = Wrapping::Maintaining("P=OK".to_owned());
    assert_eq!(wrap(" A(); B() ", maintaining), " do A() maintaining P=OK; B() ");
    let unwrap = |text: &'static str| body(text, |text| Change::Unwrap(at(text, "A()")));
    assert_eq!(unwrap(" optional A()[1,2]; B() "), " A()[1,2]; B() ");
    assert_eq!(unwrap(" do A() maintaining P=OK; B() "), " A(); B() ");
    assert_eq!(unwrap(" choose { A() }[1,5]; B() "), " { A() }[1,5]; B() ");
}

#[test]
fn bounds_are_written_or_replaced_and_typed_over() {
    let bound = |text: &'static str| body(text, |text| Change::Bound(at(text, "A()"), "[3,4]".to_owned()));
    assert_eq!(bound(" A(); B() "), " A()[3,4]; B() ");
    assert_eq!(bound(" A()[1,2] as X; B() "), " A()[3,4] as X; B() ");
    let parse = rmpl::parse("scenario S = { A() }");
    let drawn = draw(&parse, only_file(&parse), &Change::Bound(at(parse.text(), "A()"), "[3,4]".to_owned()))
        .expect("bounds");
    assert_eq!(&drawn.apply(parse.text())[drawn.typed_over[0].range()], "3,4");
}

#[test]
fn activities_of_two_threads_are_connected_by_name() {
    let text = "scenario S = { { Dig-In(); A() }, { B() as Relay; C() } }\n";
    let change = Change::Connect { from: at(text, "Dig-In()"), to: at(text, "B()") };
    let expected = "scenario S = { { Dig-In() as DigIn1; A() }, { B() as Relay; C() } }\n\
                    constrain DigIn1.end to Relay.start [0,inf];\n";
    assert_eq!(changed(text, &change), expected);
}

#[test]
fn a_vehicle_is_sent_to_a_place_behind_all_else_that_it_does() {
    const WORLD: &str = "location BASE (1, 2);\nlocation ROCK (3, 4);\nvehicle R : ATRV at BASE;\n\
                         vehicle Q : ATRV at BASE;\n";
    let visit = |text: &str, vehicle: &str| {
        changed(text, &Change::Visit { vehicle: vehicle.to_owned(), location: "ROCK".to_owned() })
    };
    // Nothing is declared yet.
    let first = visit(WORLD, "R");
    let declared = "primitive Drive(rover, to)[1,inf] moves rover;\n\
                    primitive Visit(rover, site)[1,10] requires rover.at=site;\n";
    let scenario = "scenario Mission = {\n  Drive(R, ROCK);\n  Visit(R, ROCK)\n}\n";
    assert_eq!(first, format!("{WORLD}\n{declared}\n{scenario}"));
    // Another vehicle gets a thread of its own.
    let second = visit(&first, "Q");
    assert!(second.contains("  },\n  {\n    Drive(Q, ROCK);\n"), "{second}");
    let parse = rmpl::parse(&second);
    assert_eq!(
        parse.diagnostics().iter().filter(|it| it.severity == rmpl::Severity::Error).count(),
        0,
        "{second}"
    );
    // The same vehicle continues from its last place.
    let third = visit(&second, "R");
    let order: Vec<&str> = third.lines().map(str::trim).filter(|line| line.contains("(R, ")).collect();
    assert_eq!(order, ["Drive(R, ROCK);", "Visit(R, ROCK);", "Drive(R, ROCK);", "Visit(R, ROCK)"], "{third}");
    // What is not declared is not written.
    for (vehicle, location, part) in [("X", "ROCK", "Unknown vehicle X"), ("R", "Y", "Unknown location Y")] {
        let change = Change::Visit { vehicle: vehicle.to_owned(), location: location.to_owned() };
        let refused = draw(&rmpl::parse(WORLD), Span::new(0, WORLD.len() as u32), &change)
            .expect_err("it is not declared");
        assert!(refused.contains(part), "{refused}");
    }
    // The mission's own activities are used, and a choice is left as it is.
    let own = format!(
        "{WORLD}primitive Go(to)[1,9] moves R;\nprimitive Shoot(place)[1,2] requires R.at=place;\n\
         scenario S = {{\n  choose {{ Go(BASE), Go(ROCK) }};\n  Rest()\n}}\n"
    );
    let expected = own.replace("Go(ROCK) };", "Go(ROCK) };\n  Go(ROCK);\n  Shoot(ROCK);");
    assert_eq!(visit(&own, "R"), expected);
}

#[test]
fn a_new_declaration_leaves_the_comment_of_the_one_before() {
    let text = "primitive A()[1,2]; // long drive\nscenario S[0,9] = {\n  A()\n}\n";
    let parse = rmpl::parse(text);
    let edit = super::call::declare(&parse, only_file(&parse), "primitive B()[1,5];");
    let changed = super::Drawn { edits: vec![edit], ..super::Drawn::default() }.apply(text);
    assert!(changed.starts_with("primitive A()[1,2]; // long drive\nprimitive B()[1,5];\n"), "{changed}");
}
