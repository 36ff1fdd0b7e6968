//! Activities that differ only in a vehicle or a location, and the fix that merges them.

use rmpl::{Severity, parse};

const WORLD: &str = "location BASE (0, 0);\nlocation ROCK (9, 9);\nlocation RIM (5, 5);\nvehicle R1, R2 : ATRV at BASE;\nvehicle R3 : ATRV at BASE;\n";

/// The messages of the notes, and the text after all their fixes.
#[track_caller]
fn merged(text: &str) -> (Vec<String>, String) {
    let mut text = format!("{WORLD}{text}");
    let mut told = Vec::new();
    while let Some(found) = parse(&text).diagnostics().into_iter().find(|it| it.code.0 == "W-COPY") {
        assert_eq!(found.severity, Severity::Note);
        told.push(found.message.clone());
        for edit in found.fixes[0].edits.iter().rev() {
            text.replace_range(edit.span.range(), &edit.text);
        }
    }
    let errors: Vec<_> =
        parse(&text).diagnostics().into_iter().filter(|it| it.severity == Severity::Error).collect();
    assert!(errors.is_empty(), "{text}\n{errors:#?}");
    assert!(rmpl::fleet::check(&parse(&text).program()).is_empty(), "{text}");
    (told, text.strip_prefix(WORLD).expect("the world stays").to_owned())
}

#[test]
fn copies_become_one_activity_and_then_what_calls_them_does() {
    let (told, text) = merged(
        "primitive Drive1(to)[5,20] moves R1;
primitive Drive2(to)[5,20] moves R2;
primitive Drive3(to)[5,20] moves R3;
Trip1() = { Drive1(ROCK); Drive1(BASE) }
Trip2() = { Drive2(ROCK); Drive2(BASE) }
scenario Day[0,99] = { Trip1(), Trip2(), Drive3(ROCK) }",
    );
    assert_eq!(
        told,
        [
            "`Drive1` and 2 other activities differ only in `R1`",
            "`Trip1` and `Trip2` differ only in `R1` and `R2`",
        ]
    );
    assert_eq!(
        text,
        "primitive Drive(r, to)[5,20] moves r;
Trip(rover) = { Drive(rover, ROCK); Drive(rover, BASE) }
scenario Day[0,99] = { Trip(R1), Trip(R2), Drive(R3, ROCK) }"
    );
}

#[test]
fn a_location_becomes_a_parameter() {
    let (_, text) = merged(
        "primitive Look-at-Rock(r)[1,2] requires r.at=ROCK;
primitive Look-at-Rim(r)[1,2] requires r.at=RIM;
scenario Day[0,99] = { Look-at-Rock(R1), Look-at-Rim(R1) }",
    );
    assert_eq!(
        text,
        "primitive Look-at(site, r)[1,2] requires r.at=site;
scenario Day[0,99] = { Look-at(ROCK, R1), Look-at(RIM, R1) }"
    );
}

#[test]
fn what_is_no_copy_or_more_than_called_stays() {
    let stays = |text: &str| assert_eq!(merged(text), (Vec::new(), text.to_owned()));
    // Another number, another activity, two differences, a name that has both.
    stays(
        "primitive A1()[1,2] requires R1.at=BASE;\nprimitive A2()[1,3] requires R2.at=BASE;\nscenario Day[0,9] = { A1(); A2() }",
    );
    stays(
        "primitive A1()[1,2] requires R1.at=BASE;\nprimitive A2()[1,2] requires R2.at=ROCK;\nscenario Day[0,9] = { A1(); A2() }",
    );
    stays(
        "primitive A1()[1,2] requires R1.at=BASE, R2.at=BASE;\nprimitive A2()[1,2] requires R2.at=BASE, R2.at=BASE;\nscenario Day[0,9] = { A1(); A2() }",
    );
    // A name alone.
    stays(
        "primitive A1()[1,2] requires R1.at=BASE;\nprimitive A2()[1,2] requires R2.at=BASE;\nscenario Day[0,9] = { A1; A2() }",
    );
}
