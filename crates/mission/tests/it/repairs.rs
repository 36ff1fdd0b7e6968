//! What is offered where there is no plan: changes of the text, each of which gives one.

use kirk::Options;
use mission::{Grounds, Paths, repairs};
use rmpl::Fix;
use snapshot::Goal;

use crate::support::Mission;

/// Returns what is offered for a mission without a plan. Each is applied and planned again here.
fn offered(source: &str) -> Vec<Fix> {
    let mission = Mission::read(source);
    let fixes = mission.with_plan((Options::default(), 1), |problem, mut planned, grounds, paths| {
        assert!(planned.planning.outcome.plans.is_empty(), "it has a plan");
        repairs::add(&mut planned, (source, &Goal::Default), problem, (grounds, paths), &mut || false);
        planned.planning.repairs.clone()
    });
    for fix in &fixes {
        let text = applied(source, fix);
        Mission::read(&text).with_plan((Options::default(), 1), |_, planned, _, _| {
            assert!(planned.planning.verdict.as_ref().is_some_and(|it| it.valid), "{}: {text}", fix.label);
        });
    }
    fixes
}

fn applied(source: &str, fix: &Fix) -> String {
    let mut text = source.to_owned();
    for edit in fix.edits.iter().rev() {
        text.replace_range(edit.span.range(), &edit.text);
    }
    text
}

fn labels(fixes: &[Fix]) -> Vec<&str> {
    fixes.iter().map(|fix| fix.label.as_str()).collect()
}

#[test]
fn two_drives_of_one_rover_wait_for_each_other() {
    let source = "option time_unit = second;
        location BASE (0,0); location NORTH (0,30); location TAI (30,0);
        vehicle R1 : ATRV-Jr at BASE;
        primitive Drive(to) moves R1 speed (0.02, 0.5);
        scenario X[0,1500] = { Drive(NORTH), Drive(TAI) }";
    let fixes = offered(source);
    assert_eq!(
        labels(&fixes),
        [
            "let Drive(TAI) start after Drive(NORTH): free Drive(TAI)",
            "let Drive(NORTH) start after Drive(TAI): free Drive(NORTH)"
        ]
    );
    assert!(applied(source, &fixes[0]).contains("{ Drive(NORTH), free Drive(TAI) }"));
}

const ARM: &str = "state ARM : {IN, OUT} = IN;
    primitive Deploy()[5,10] sets ARM=OUT;
    primitive Dig()[20,30] requires ARM=OUT;
    primitive Turn(a)[1,2] sets ARM=a;
    primitive Look()[1,2];";

#[test]
fn what_meets_a_condition_is_done_first_or_waited_for() {
    let fixes = offered(&format!("{ARM} scenario X[0,100] = {{ Look(); Dig() }}"));
    assert_eq!(
        labels(&fixes),
        ["do Deploy() before Dig: it sets ARM=OUT", "do Turn(OUT) before Dig: it sets ARM=OUT"]
    );
    let source = format!("{ARM} scenario X[0,100] = {{ Dig()[20,25], {{ Look(); Deploy() }} }}");
    let fixes = offered(&source);
    assert_eq!(labels(&fixes)[0], "let Dig()[20,25] start after { Look(); Deploy() }: free Dig()[20,25]");
    let source = format!("{ARM} scenario X[0,100] = {{ Dig()[20,25], Look() }}");
    let wrapped = applied(&source, &offered(&source)[0]);
    assert!(wrapped.contains("{ { Deploy(); Dig()[20,25] }, Look() }"), "{wrapped}");
}

#[test]
fn a_vehicle_is_driven_to_where_it_has_to_be() {
    let world = "option time_unit = second; location BASE (0,0); location ROCK (0,30);
        vehicle R1 : ATRV-Jr at BASE; vehicle R2 : ATRV-Jr at BASE;
        primitive Drive(who, to) moves who speed (0, 0.5);
        primitive Sample()[5,10] requires R2.at=ROCK;";
    let fixes = offered(&format!("{world} scenario X[0,200] = {{ Sample() }}"));
    assert_eq!(labels(&fixes), ["do Drive(R2, ROCK) before Sample: it sets R2.at=ROCK"]);
    // There is no time for the drive.
    assert!(offered(&format!("{world} scenario X[0,50] = {{ Sample() }}")).is_empty());
}

#[test]
fn a_condition_that_is_known_only_while_it_is_told_is_made_to_last() {
    let source = "primitive Dig()[20,30]; primitive Deploy()[5,10];
        scenario X[0,100] = { Deploy(); ARM=OUT; do Dig() maintaining ARM=OUT }";
    let fixes = offered(source);
    assert_eq!(
        labels(&fixes),
        ["make ARM a state that keeps its value: state ARM : {OUT, UNKNOWN} = UNKNOWN;"],
        "{fixes:?}"
    );
    let declared = format!("var ARM : {{IN, OUT}}; {source}");
    let fixes = offered(&declared);
    assert_eq!(labels(&fixes), ["make ARM a state that keeps its value: state ARM : {IN, OUT} = IN;"]);
    assert!(applied(&declared, &fixes[0]).starts_with("state ARM : {IN, OUT} = IN; primitive"));
}

#[test]
fn of_a_resource_one_waits_or_there_is_more() {
    let source =
        "resource Antenna; primitive Send()[5,10] uses Antenna; primitive Track()[5,10] uses Antenna;
        scenario X[0,100] = { Send(), Track() }";
    let fixes = offered(source);
    assert_eq!(
        labels(&fixes),
        [
            "let Track() start after Send(): free Track()",
            "let Send() start after Track(): free Send()",
            "have 2 of Antenna at a time: resource Antenna capacity 2;"
        ]
    );
    // No one has time to wait.
    let short = offered(&source.replace("[0,100]", "[0,9]"));
    assert_eq!(labels(&short), ["have 2 of Antenna at a time: resource Antenna capacity 2;"]);
}

/// Four activities that each take 4, with time for two of them one after the other.
const CREW: &str = "resource Crew capacity 3; primitive Lift()[4,4] uses Crew 2;
    scenario X[0,8] = { { delay; Lift(); delay }, { delay; Lift(); delay }, { delay; Lift(); delay },
        { delay; Lift(); delay } }";

#[test]
fn no_more_of_a_resource_is_offered_than_it_takes() {
    // All four at a time would take 8.
    assert_eq!(labels(&offered(CREW)), ["have 4 of Crew at a time: resource Crew capacity 4;"]);
    let three = CREW.replace("[0,8]", "[0,7]");
    assert_eq!(labels(&offered(&three)), ["have 8 of Crew at a time: resource Crew capacity 8;"]);
    let parts = CREW.replace("Crew 2", "Crew 1.25").replace("capacity 3", "capacity 2");
    assert_eq!(labels(&offered(&parts)), ["have 2.5 of Crew at a time: resource Crew capacity 2.5;"]);
    // There is too little of two things, and more of one of them does not help.
    let tools = format!("resource Tool; {}", CREW.replace("uses Crew 2", "uses Crew 2, Tool"));
    assert!(offered(&tools).is_empty());
}

#[test]
fn a_battery_is_no_fuller_at_the_start_than_it_has_to_be() {
    let source = "resource Battery 0 .. 60 = 10; primitive Charge()[5,10] produces Battery 40;
        primitive Go()[5,10] consumes Battery 30; scenario X[0,100] = { Go(); Charge(); Go() }";
    let fixes = offered(source);
    assert!(
        labels(&fixes).contains(&"start with 30 of Battery: resource Battery 0 .. 60 = 30;"),
        "{fixes:?}"
    );
    // What it would have to have at the start for what comes later, it has no room for.
    let full = "resource Battery 0 .. 50 = 10; primitive Charge()[5,10] produces Battery 40;
        primitive Go()[5,10] consumes Battery 30; scenario X[0,25] = { Charge(); Go(); Go(); Go() }";
    assert!(labels(&offered(full)).iter().all(|label| !label.starts_with("start with")));
}

#[test]
fn a_battery_is_charged_first_or_fuller_at_the_start() {
    let source = "const FULL = 100; resource Battery 0 .. FULL = 50;
        primitive Charge()[5,10] produces Battery 40; primitive Go()[5,10] consumes Battery 30;
        scenario X[0,100] = { Go(); Go(); Charge() }";
    let fixes = offered(source);
    assert_eq!(
        labels(&fixes),
        [
            "do Charge() before Go#2: it gives Battery",
            "do Charge() before Go#1: it gives Battery",
            "start with 60 of Battery: resource Battery 0 .. FULL = 60;"
        ]
    );
}

#[test]
fn nothing_is_offered_that_gives_no_plan() {
    let source = format!("{ARM} scenario X[0,24] = {{ Look(); Dig()[24,30] }}");
    assert!(offered(&source).is_empty());
    let (mut grounds, mut paths) = (Grounds::default(), Paths::default());
    // Stopped at once, nothing is tried.
    let source = format!("{ARM} scenario X[0,100] = {{ Look(); Dig() }}");
    Mission::read(&source).with_plan((Options::default(), 1), |problem, mut planned, _, _| {
        let goal = Goal::Default;
        repairs::add(&mut planned, (&source, &goal), problem, (&mut grounds, &mut paths), &mut || true);
        assert!(planned.planning.repairs.is_empty());
    });
}
